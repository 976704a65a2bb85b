"""Sweeps whose processes are killed: whatever dies and whenever, the results are those of an undisturbed sweep, to the byte."""

import contextlib
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from spheredrive.io.study_file import load_study
from spheredrive.studies.sweep.command import sweep
from spheredrive.studies.sweep.coordinator import Coordinator
from spheredrive.studies.sweep.metrics import metrics

DATA = Path(__file__).parents[1] / "data"
STUDY = """schema_version = 1
design = "interface-example.toml"
metrics = ["isotropy", "effectiveness_max", "preload"]
[parameters]
"placement.elevation" = {{ from = "-95 deg", to = "-1 deg", count = {elevations} }}
"placement.heading" = {{ from = "-20 deg", to = "20 deg", count = 11 }}
"wheels.omni.roller_angle" = ["90 deg", "60 deg", "45 deg"]
"""
COMMAND = """
import sys
from spheredrive.studies.sweep.command import read_study, sweep
workers, dask = (None, sys.argv[3]) if "://" in sys.argv[3] else (int(sys.argv[3]), None)
sweep(read_study(sys.argv[1]), sys.argv[2], workers, dask, chunk=int(sys.argv[4]), figures=False)
"""


class Killing:
    """A study in a folder, and a coordinator of it as a process of its own."""

    def __init__(self, folder: Path, elevations: int, chunk: int):
        self.folder, self.chunk = folder, chunk
        (folder / "interface-example.toml").write_bytes((DATA / "interface-example.toml").read_bytes())
        (folder / "study.toml").write_text(STUDY.format(elevations=elevations), "utf-8")
        self.study = load_study(folder / "study.toml", metrics())
        sweep(self.study, folder / "undisturbed", 0, chunk=16 * chunk, figures=False)

    def start(self, place="2") -> subprocess.Popen:
        files = [str(self.folder / "study.toml"), str(self.folder / "out")]
        command = [sys.executable, "-c", COMMAND, *files, place, str(self.chunk)]
        return subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True)

    def results(self, name: str) -> tuple[bytes, bytes]:
        return tuple((self.folder / name / f"result.{end}").read_bytes() for end in ("nc", "parquet"))

    def finished_chunks(self) -> int:
        return len(list(self.folder.glob("out/points/*/*/*.chunk")))

    def assert_same(self):
        """Every chunk is there once, and results are those of the undisturbed sweep."""
        coordinator = Coordinator(self.study, self.folder / "out", self.chunk)
        assert self.finished_chunks() == coordinator.count
        assert sum(len(coordinator.store.read(n).keys) for n in range(coordinator.count)) == coordinator.points.count
        assert self.results("out") == self.results("undisturbed")


def kill_rounds(killing: Killing, kills: int, rng: random.Random) -> int:
    """SIGKILL ``kills`` times, now a worker, now the coordinator with whatever it does; the coordinators that were started."""
    started, process = 0, None
    while kills:
        if process is None or process.poll() is not None:
            if process is not None:
                assert process.returncode in (0, -signal.SIGKILL), process.stderr.read()
                end(process)
                if process.returncode == 0:
                    # It came through: the rest of the kills are for another one.
                    killing.assert_same()
                    shutil.rmtree(killing.folder / "out")
            process, started = killing.start(), started + 1
            # Half of the time while a coordinator starts, half while it works.
            time.sleep(rng.uniform(0.0, 1.2))
        victims = [process.pid] if rng.random() < 0.5 else children(process.pid) or [process.pid]
        with contextlib.suppress(ProcessLookupError):
            os.kill(rng.choice(victims), signal.SIGKILL)
            kills -= 1
        time.sleep(rng.uniform(0.0, 0.15))
    end(process)
    return started


def children(pid: int) -> list[int]:
    """Processes that ``pid`` has started."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += map(int, task.read_text().split())
    return found


def end(process: subprocess.Popen) -> None:
    with contextlib.suppress(ProcessLookupError):
        process.kill()
    process.wait()
    process.stderr.close()


needs_proc = pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds the workers by /proc")


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> Killing:
    return Killing(tmp_path_factory.mktemp("kills"), 60, 25)


@needs_proc
def test_a_few_kills_change_no_byte(small):
    """First a worker, then the coordinator, whose other workers end with it; then the sweep goes on to its end."""
    killing = small
    process = killing.start()
    wait_for(lambda: killing.finished_chunks() > 3, process)
    os.kill(workers_of(process.pid)[0], signal.SIGKILL)
    so_far = killing.finished_chunks()
    # Its place is taken by another, and the rest go on.
    wait_for(lambda: killing.finished_chunks() > so_far and len(workers_of(process.pid)) == 2, process)
    workers = workers_of(process.pid)
    assert len(workers) == 2 and not (killing.folder / "out" / "result.nc").exists()
    end(process)
    wait_for(lambda: not any(alive(worker) for worker in workers), seconds=20)
    process = killing.start("0")
    assert process.wait(60) == 0, process.stderr.read()
    process.stderr.close()
    killing.assert_same()


def workers_of(pid: int) -> list[int]:
    """Worker processes of a coordinator."""
    return [child for child in children(pid) if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except OSError:
        return False


@needs_proc
@pytest.mark.long
def test_two_hundred_kills_at_random_moments_change_no_byte(tmp_path):
    killing = Killing(tmp_path, 300, 7)
    rng = random.Random(20261122)
    assert kill_rounds(killing, 200, rng) > 20
    process = killing.start()
    assert process.wait(300) == 0, process.stderr.read()
    process.stderr.close()
    killing.assert_same()


def wait_for(condition, process=None, seconds: float = 60.0) -> None:
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, process and process.poll()
        time.sleep(0.005)


@pytest.fixture(scope="module")
def cluster():
    """A Dask scheduler and two workers on this machine: its address, and the workers' processes."""
    pytest.importorskip("distributed")
    from distributed import Client

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler = [sys.executable, "-m", "dask", "scheduler", "--port", str(port), *local]
    worker = [sys.executable, "-m", "dask", "worker", address, "--nthreads", "1", "--no-nanny", *local]
    processes = [subprocess.Popen(scheduler, **quiet), *(subprocess.Popen(worker, **quiet) for _ in range(2))]
    try:
        with Client(address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, processes[1:]
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()


@pytest.mark.long
def test_a_dask_cluster_that_loses_a_worker_gives_the_same_bytes(small, cluster):
    address, workers = cluster
    killing = small
    shutil.rmtree(killing.folder / "out", ignore_errors=True)
    process = killing.start(address)
    wait_for(lambda: killing.finished_chunks() > 5, process)
    workers[0].kill()
    assert process.wait(60) == 0, process.stderr.read()
    process.stderr.close()
    killing.assert_same()
