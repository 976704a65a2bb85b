"""Searches whose process is killed: whenever it dies, the same command goes on, and the results are the undisturbed ones."""

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from spheredrive.studies.optimize.command import optimize
from spheredrive.studies.sweep.command import read_study

DATA = Path(__file__).parents[1] / "data"
STUDY = """schema_version = 1
design = "interface-example.toml"
[parameters]
"placement.elevation" = { from = "-80 deg", to = "-10 deg" }
"wheels.omni.radius" = { from = "20 mm", to = "120 mm" }
"placement.count" = [3, 4, 5]
[objectives]
isotropy = "max"
preload = "min"
[constraints]
clearance = ">= 5 mm"
[algorithm]
population = 12
generations = 6
"""
# Kills itself at the n-th call of a step of writing: before it, so that the file beside is there and the real one is not.
COMMAND = """
import os, signal, sys
from spheredrive.studies.optimize.command import optimize
from spheredrive.studies.sweep.command import read_study
step, room = sys.argv[3], int(sys.argv[4])
original = getattr(os, step)
def mortal(*arguments, **options):
    global room
    room -= 1
    if room < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return original(*arguments, **options)
setattr(os, step, mortal)
optimize(read_study(sys.argv[1]), sys.argv[2], 0, figures=False)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("killing")
    (folder / "interface-example.toml").write_bytes((DATA / "interface-example.toml").read_bytes())
    (folder / "study.toml").write_text(STUDY, "utf-8")
    optimize(read_study(folder / "study.toml"), folder / "undisturbed", 0, figures=False)
    return folder


def results(folder) -> dict[str, bytes]:
    kept = (".nc", ".parquet", ".toml", ".chunk")
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.suffix in kept}


def start(folder, out, step="replace", room=1000) -> subprocess.Popen:
    command = [sys.executable, "-c", COMMAND, str(folder / "study.toml"), str(out), step, str(room)]
    return subprocess.Popen(command, stderr=subprocess.PIPE)


@pytest.mark.parametrize(("step", "room"), [("replace", 3)])
def test_a_search_killed_while_it_writes_goes_on(folder, tmp_path, step, room):
    process = start(folder, tmp_path / "out", step, room)
    process.communicate()
    assert process.returncode == -signal.SIGKILL
    assert len(list((tmp_path / "out").glob("points/*/*/*.chunk"))) == 3 and not (tmp_path / "out" / "result.nc").exists()
    optimize(read_study(folder / "study.toml"), tmp_path / "out", 0, figures=False)
    assert results(tmp_path / "out") == results(folder / "undisturbed")


@pytest.mark.long
@pytest.mark.parametrize("step", ["replace", "fsync", "open"])
def test_a_search_killed_at_every_write_goes_on(folder, tmp_path, step):
    for room in range(0, 14, 2):
        out = tmp_path / str(room)
        start(folder, out, step, room).communicate()
        optimize(read_study(folder / "study.toml"), out, 0, figures=False)
        assert results(out) == results(folder / "undisturbed")


@pytest.mark.long
def test_a_search_killed_at_any_time_goes_on(folder, tmp_path):
    rng, kills = random.Random(7), 0
    out = tmp_path / "out"
    while kills < 20:
        process = start(folder, out)
        time.sleep(rng.uniform(0.5, 4.0))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        kills += process.returncode == -signal.SIGKILL
        if process.returncode == 0:
            out = tmp_path / f"out-{kills}"
    optimize(read_study(folder / "study.toml"), out, 0, figures=False)
    assert results(out) == results(folder / "undisturbed")


@pytest.mark.long
def test_a_pool_of_processes_gives_the_same_bytes(folder, tmp_path):
    optimize(read_study(folder / "study.toml"), tmp_path / "out", 2, figures=False)
    assert results(tmp_path / "out") == results(folder / "undisturbed")
