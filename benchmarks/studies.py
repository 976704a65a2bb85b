"""What a sweep costs: a million closed-form designs from the study file to the result files, and what workers and Dask add.

    python benchmarks/studies.py [POINTS]

Each design: isotropy, condition number and effectiveness (kinematics), least preload at the motors' largest torque, RMS
acceleration at constant wheel speeds of the compliant, damped machine. Random points over seven parameters. Overhead is the
time that one core spends outside of the kernels: points, machines, keys, chunks, results.
"""

from __future__ import annotations

import os
import platform
import resource
import socket
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from spheredrive.designs import design_path
from spheredrive.io.study_file import parse_study
from spheredrive.studies.sweep import evaluate
from spheredrive.studies.sweep.command import sweep
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.metrics.base import Family

STUDY = """
schema_version = 1
design = "{design}"
speeds = "2 2 2 rad/s"
metrics = ["isotropy", "condition_number", "effectiveness_max", "preload", "rms_acceleration"]
[parameters]
"placement.elevation" = {{ from = "-70 deg", to = "-20 deg" }}
"placement.heading" = {{ normal = ["0 deg", "2 deg"] }}
"sphere.mass" = {{ from = "3 kg", to = "10 kg" }}
"contact.stiffness" = {{ from = "1e5 N/m", to = "3e5 N/m" }}
"contact.damping" = {{ from = "1e4 N s/m", to = "3e4 N s/m" }}
"contact.friction" = {{ from = 0.4, to = 1.0 }}
"motor.torque" = {{ from = "0.1 N m", to = "2 N m" }}
[sampling]
method = "random"
size = {size}
"""


def study(size: int):
    path = design_path("atlas-demonstrator")
    return parse_study(STUDY.format(design=path.name, size=size), metrics(), folder=path.parent)


class Taken(NamedTuple):
    """Seconds by the clock, and of all cores of this process and those it started and has seen end."""

    clock: float
    cores: float


def seconds(size: int, workers: int | None, dask: str | None = None) -> Taken:
    """A whole sweep into a fresh folder, figures left out."""
    with tempfile.TemporaryDirectory() as folder:
        begin, busy = time.perf_counter(), cores()
        done = sweep(study(size), folder, workers, dask, figures=False)
        taken = Taken(time.perf_counter() - begin, cores() - busy)
    assert done.counts.known > 0.999 * size, done.text()
    return taken


def cores() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def linear() -> None:
    print("\nsize, two processes")
    for size in (POINTS // 16, POINTS // 4, POINTS):
        clock, busy = seconds(size, 2)
        print(f"  {size:>9,} points {clock:8.2f} s, {busy:8.2f} s of cores: {busy / size * 1e6:6.1f} µs a point")
    peak = [resource.getrusage(who).ru_maxrss / 1024 for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    print(f"  most memory of the coordinator {peak[0]:.0f} MiB, of a worker {peak[1]:.0f} MiB")


def overhead(size: int) -> None:
    """All in this process on one core, the kernels' calls under a clock."""
    clock = [0.0]
    original = evaluate.asked_of

    def timed(names):
        def wrapped(measure):
            def call(*arguments):
                begin = time.process_time()
                found = measure(*arguments)
                clock[0] += time.process_time() - begin
                return found

            return call

        return [(Family(f.metrics, wrapped(f.measure), f.whole, f.batch), its) for f, its in original(names)]

    evaluate.asked_of = timed
    try:
        taken = seconds(size, 0).cores
    finally:
        evaluate.asked_of = original
    print(f"\noverhead, {size:,} points: {taken:.2f} s of cores, of which kernels {clock[0]:.2f} s")
    print(f"  the study layer adds {(taken - clock[0]) / clock[0]:.1%}")


def scaling(size: int) -> None:
    one, two = seconds(size, 1).clock, seconds(size, 2).clock
    print(f"\nprocesses, {size:,} points: one {one:.2f} s, two {two:.2f} s, ratio {one / two:.2f}")
    taken = dask_seconds(size)
    if taken is not None:
        print(f"  Dask with two processes on this machine {taken:.2f} s, {taken / two:.2f} of the pool's")


def dask_seconds(size: int) -> float | None:
    """The same on a Dask scheduler and two workers, which are started and ended here."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        return None
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [
        sys.executable,
        "-m",
        "distributed.cli.dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        str(port),
        "--no-dashboard",
    ]
    processes = [subprocess.Popen(command, **quiet)]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard"]
    processes += [subprocess.Popen(worker, **quiet) for _ in range(2)]
    try:
        from distributed import Client

        with Client(address, timeout=60) as client:
            client.wait_for_workers(2, timeout=60)
        seconds(1000, None, address)
        return seconds(size, None, address).clock
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait()


if __name__ == "__main__":
    POINTS = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    names = ", ".join(f"{name} {version(name)}" for name in ("spheredrive", "numpy", "numba"))
    print(f"{platform.machine()}, {os.cpu_count()} cores; Python {platform.python_version()}, {names}; {Path(__file__).name}")
    seconds(1000, 0)
    overhead(min(POINTS // 10, 100_000))
    scaling(min(POINTS // 4, 250_000))
    linear()
