"""The command line as real processes: exit codes, streams, refusals."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import spheredrive as sd

PROGRAM = Path(sys.executable).with_name("spheredrive")


def run(*words, folder=None, **environment):
    return subprocess.run(
        [str(PROGRAM), *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, **environment},
    )


SINGULAR = """
schema_version = 1
name = "on the equator"
[sphere]
radius = "15 cm"
[wheels.round]
type = "ideal"
radius = "25 mm"
[[placement]]
count = 3
elevation = "0 deg"
"""


@pytest.fixture
def singular(tmp_path):
    path = tmp_path / "singular.toml"
    path.write_text(SINGULAR, encoding="utf-8")
    return path


def test_check_of_a_working_design_exits_0():
    answer = run("check", sd.design_path("atlas-dual-race"))
    assert answer.returncode == 0, answer.stderr
    assert "The design works." in answer.stdout and answer.stderr == ""


def test_check_json_is_the_only_output_and_matches_python():
    answer = run("check", sd.design_path("atlas-dual-race"), "--json")
    result = json.loads(answer.stdout)
    design = sd.load_design(sd.design_path("atlas-dual-race"))
    np.testing.assert_array_equal(result["jacobian"], sd.kinematics.jacobian(design))
    assert result == json.loads(json.dumps(sd.check(design).as_dict()))
    assert answer.stderr == ""


def test_check_of_a_singular_design_exits_1(singular):
    answer = run("check", singular, "--json")
    assert answer.returncode == 1
    assert json.loads(answer.stdout)["jacobian"] is None


@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("chekc", "x.toml"),
        ("check", "x.toml", "--jsno"),
        ("check", "absent.toml"),
        ("check", "."),
        ("demo", "atlas-dualrace"),
        ("report", "absent.toml"),
        ("new", "no/such/folder/x.toml"),
    ],
)
def test_bad_input_exits_2_with_one_sentence_and_no_output(words, tmp_path):
    answer = run(*words, folder=tmp_path)
    assert answer.returncode == 2
    assert answer.stdout == "" and answer.stderr.startswith("spheredrive: ")
    assert "Traceback" not in answer.stderr


def test_wrong_value_is_told_with_file_line_column_and_caret(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(
        sd.design_path("atlas-dual-race").read_text(encoding="utf-8").replace('"25 mm"', '"25 mn"'), encoding="utf-8"
    )
    answer = run("check", "bad.toml", folder=tmp_path)
    assert answer.returncode == 2
    head, line, caret = answer.stderr.splitlines()[:3]
    place = head.removeprefix("spheredrive: ").split(":")[:3]
    assert place[0] == "bad.toml"
    assert path.read_text(encoding="utf-8").splitlines()[int(place[1]) - 1].strip() == line.strip()
    assert caret.index("^") == line.index('"25 mn"')


def test_new_writes_a_design_that_checks_and_is_not_overwritten(tmp_path):
    assert run("new", "mine.toml", folder=tmp_path).returncode == 0
    assert run("check", "mine.toml", folder=tmp_path).returncode == 0
    before = (tmp_path / "mine.toml").read_bytes()
    answer = run("new", "mine.toml", folder=tmp_path)
    assert answer.returncode == 2 and "exists" in answer.stderr
    assert (tmp_path / "mine.toml").read_bytes() == before


def test_schema_is_json():
    schema = json.loads(run("schema").stdout)
    assert schema["type"] == "object" and "sphere" in schema["properties"]


def test_demo_writes_a_report_and_prints_its_path(tmp_path):
    answer = run("demo", folder=tmp_path, DISPLAY="", WAYLAND_DISPLAY="")
    assert answer.returncode == 0, answer.stderr
    path = Path(answer.stdout.strip())
    assert path.parent == tmp_path.resolve() and "Atlas" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["six-orthogonal", "ballbot"])
def test_demo_of_any_shipped_design(name, tmp_path):
    answer = run("demo", name, "-o", "out.html", "--no-browser", folder=tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert (tmp_path / "out.html").exists()


def test_report_with_a_motion_for_another_number_of_wheels_is_refused(tmp_path):
    answer = run("report", sd.design_path("six-orthogonal"), sd.motion_path("atlas-table-2-1"), folder=tmp_path)
    assert answer.returncode == 2 and "6 wheels" in answer.stderr
    assert not (tmp_path / "report.html").exists()


def test_help_lists_every_command():
    text = run("--help").stdout
    for command in ("check", "report", "demo", "new", "schema"):
        assert command in text


def test_version_is_printed():
    assert run("--version").stdout.strip() == sd.__version__
