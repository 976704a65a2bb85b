"""The command line as real processes: exit codes, streams, refusals."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import spheredrive as sd
from forked import PROGRAM, run
from spheredrive.cli import main

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
        ("catalogue", "nexus/1407"),
        ("catalogue", "--type", "omni"),
        ("catalogue", "--diameter", "40..110"),
        ("catalogue", "nexus/14073", "--rollers", "22"),
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


def test_catalogue_lists_filters_and_shows_one_part():
    answer = run("catalogue", "--type", "dual-race", "--diameter", "100..130 mm")
    assert answer.returncode == 0 and answer.stderr == ""
    assert "nexus/14073" in answer.stdout and "fuji" not in answer.stdout
    found = json.loads(run("catalogue", "double", "aluminium", "--rollers", "8..30", "--json").stdout)
    assert [entry["name"] for entry in found] == ["nexus/14073"]
    whole = run("catalogue", "nexus/14073")
    assert whole.returncode == 0 and 'catalogue = "nexus/14073"' in whole.stdout
    assert json.loads(run("catalogue", "nexus/14073", "--json").stdout) == found[0]


def test_demo_writes_a_report_and_prints_its_path(tmp_path):
    answer = run("demo", folder=tmp_path, DISPLAY="", WAYLAND_DISPLAY="")
    assert answer.returncode == 0, answer.stderr
    path = Path(answer.stdout.strip())
    assert path.parent == tmp_path.resolve() and "Atlas" in path.read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize("name", ["six-orthogonal", "ballbot"])
def test_demo_of_any_shipped_design(name, tmp_path):
    answer = run("demo", name, "-o", "out.html", "--no-browser", folder=tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert (tmp_path / "out.html").exists()


def test_report_with_a_motion_for_another_number_of_wheels_is_refused(tmp_path):
    answer = run("report", sd.design_path("six-orthogonal"), sd.motion_path("atlas-table-2-1"), folder=tmp_path)
    assert answer.returncode == 2 and "6 wheels" in answer.stderr
    assert not (tmp_path / "report.html").exists()


# simulate

TORQUES = """
schema_version = 1
[motion]
kind = "wheel-torque"
duration = "{duration}"
{inputs}
"""
GENTLE = "time = [0, 0.5]\nvalues = [[0.02, 0.01, 0.02], [-0.01, 0.0, 0.01]]"


def motion_file(folder, inputs=GENTLE, duration="0.5 s"):
    path = folder / "motion.toml"
    path.write_text(TORQUES.format(inputs=inputs, duration=duration), encoding="utf-8")
    return path


def test_simulate_writes_the_run_and_prints_its_path_and_peaks(tmp_path):
    design = sd.design_path("atlas-dual-race")
    answer = run("simulate", design, motion_file(tmp_path), "-o", "out.nc", folder=tmp_path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert answer.stdout.startswith("out.nc\n") and "The design works in this motion." in answer.stdout
    assert answer.stderr == ""
    found = sd.io.read_run(tmp_path / "out.nc")
    here = sd.simulate(sd.load_design(design), sd.load_motion(tmp_path / "motion.toml"))
    np.testing.assert_array_equal(found.angular_velocity, here.angular_velocity)
    assert found.attrs["design"] == design.read_text(encoding="utf-8")


def test_simulate_json_is_the_only_output_and_holds_the_runs_numbers(tmp_path):
    answer = run("simulate", sd.design_path("atlas-dual-race"), motion_file(tmp_path), "--json", folder=tmp_path)
    result = json.loads(answer.stdout)
    data = sd.io.read_run(tmp_path / result["path"])
    assert answer.stderr == "" and result["works"] and result["findings"] == []
    peak = np.abs(data.motor_torque).max("time").values.tolist()
    assert [row["torque_n_m"] for row in result["wheels"]] == peak
    assert result["race_changes"] == data.sizes["event"]


def test_simulate_design_that_breaks_a_limit_exits_1_with_wheel_and_time(tmp_path):
    hard = motion_file(tmp_path, "time = [0]\nvalues = [[0.1, 0.1, 0.1]]")
    answer = run("simulate", sd.design_path("atlas-dual-race"), hard, folder=tmp_path)
    assert answer.returncode == 1 and (tmp_path / "run.nc").exists()
    assert "Wheel 1 passes its motor's speed limit" in answer.stdout and " s on" in answer.stdout


def test_simulate_run_that_grows_without_limit_exits_1_with_its_reason(tmp_path):
    text = sd.design_path("atlas-dual-race").read_text(encoding="utf-8")
    for old, new in (('"2 kg"', '"2e-6 kg"'), ('"0.1 kg"', '"1e-6 kg"'), ('torque = "2 N m"', "")):
        text = text.replace(old, new)
    (tmp_path / "tiny.toml").write_text(text, encoding="utf-8")
    huge = motion_file(tmp_path, "time = [0]\nvalues = [[1e3, 2e3, 1e3]]", duration="1000 s")
    huge.write_text(huge.read_text(encoding="utf-8") + '[output]\nsample_rate = "1 Hz"\n', encoding="utf-8")
    answer = run("simulate", "tiny.toml", huge, "--json", folder=tmp_path)
    result = json.loads(answer.stdout)
    assert answer.returncode == 1 and not result["completed"] and "without limit" in result["reason"]


@pytest.mark.parametrize(
    ("inputs", "words", "message"),
    [
        (GENTLE, ("-o", "no/folder/run.nc"), "no such folder"),
        (GENTLE, ("--model", "rigid"), "choose from compliant, rolling"),
        ("time = [0]\nvalues = [[1, 2]]", (), "2 columns, but the design has 3 wheels"),
        ('file = "bad.csv"', (), "bad.csv:3:5"),
    ],
)
def test_simulate_bad_input_exits_2_and_leaves_no_file(inputs, words, message, tmp_path):
    (tmp_path / "bad.csv").write_text("time,wheel_1,wheel_2,wheel_3\n0,0,0,0\n0.1,none,0,0\n", encoding="utf-8")
    motion = motion_file(tmp_path, inputs)
    before = sorted(tmp_path.iterdir())
    answer = run("simulate", sd.design_path("atlas-dual-race"), motion, *words, folder=tmp_path)
    assert answer.returncode == 2 and answer.stdout == ""
    assert answer.stderr.startswith("spheredrive: ") and message in answer.stderr
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT for one process alone")
def test_simulate_stopped_by_ctrl_c_exits_130_and_leaves_no_file(tmp_path):
    # Long enough that no machine finishes it before it is stopped.
    inputs = "time = [0, 5]\nvalues = [[0.001, 0.0, 0.001], [-0.001, 0.0, -0.001]]"
    motion = motion_file(tmp_path, inputs.replace("5]", "20000]", 1), duration="20000 s")
    motion.write_text(motion.read_text(encoding="utf-8") + '[output]\nsample_rate = "1 Hz"\n', encoding="utf-8")
    words = [str(PROGRAM), "simulate", str(sd.design_path("atlas-dual-race")), str(motion)]
    # Under a shell's "&" SIGINT is ignored, and children inherit that.
    process = subprocess.Popen(
        words,
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    # Long enough to have started on a busy machine, whose imports take their time.
    time.sleep(5.0)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert output == "" and errors.startswith("Stopped") and "Traceback" not in errors
    assert list(tmp_path.iterdir()) == [motion]


def test_report_of_torques_shows_the_loads_and_exits_by_them(tmp_path):
    design = sd.design_path("atlas-dual-race")
    hard = motion_file(tmp_path, "time = [0]\nvalues = [[0.1, 0.1, 0.1]]")
    assert run("report", design, hard, folder=tmp_path).returncode == 1
    assert 'id="sizing"' in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_help_lists_every_command():
    text = run("--help").stdout
    for command in ("check", "simulate", "report", "demo", "new", "schema"):
        assert command in text


def test_version_is_printed():
    assert run("--version").stdout.strip() == sd.__version__


# Nothing that was read is written over.

MEASURED = """
schema_version = 1
name = "measured"
[sphere]
radius = "15 cm"
[wheels.round]
type = "measured"
file = "outline.csv"
[[placement]]
count = 3
elevation = "-40 deg"
"""


@pytest.mark.parametrize(
    ("command", "name"),
    [("report", "link.toml"), ("report", "outline.csv"), ("simulate", "./motion.toml"), ("report", "torques.csv")],
)
def test_output_in_the_place_of_an_input_is_refused(command, name, tmp_path):
    (tmp_path / "design.toml").write_text(MEASURED, encoding="utf-8")
    (tmp_path / "outline.csv").write_text("angle,radius\n0,0.025\n2,0.025\n4,0.025\n", encoding="utf-8")
    (tmp_path / "torques.csv").write_text("time,wheel_1,wheel_2,wheel_3\n0,0,0,0\n0.1,0,0,0\n", encoding="utf-8")
    (tmp_path / "link.toml").symlink_to("design.toml")
    motion_file(tmp_path, 'file = "torques.csv"')
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    answer = run(command, "design.toml", "motion.toml", "-o", name, folder=tmp_path)
    assert answer.returncode == 2 and answer.stdout == "" and "Traceback" not in answer.stderr
    assert answer.stderr.startswith("spheredrive: ") and "is the input" in answer.stderr
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_demo_in_the_place_of_its_design_is_refused():
    path = sd.design_path("ballbot")
    before = path.read_bytes()
    answer = run("demo", "ballbot", "-o", path, "--no-browser")
    assert answer.returncode == 2 and "is the input" in answer.stderr and path.read_bytes() == before


def test_demo_of_a_design_that_does_not_work_exits_1_as_report_does(tmp_path):
    answer = run("demo", "collinear-triple-race", "--no-browser", folder=tmp_path)
    assert answer.returncode == 1, answer.stderr
    assert (tmp_path / "spheredrive-demo.html").exists()


# Streams that are closed, full, gone or of another encoding.

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell and its devices")
ATLAS = str(sd.design_path("atlas-dual-race"))


def shell(line, folder=None, **environment):
    """``line`` in a shell: $P is the program, $D a design that works; its exit code is that of the whole line."""
    return subprocess.run(
        ["sh", "-c", line],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "P": str(PROGRAM), "D": ATLAS, **environment},
    )


@POSIX
@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("$P check $S <&- >&- 2>&-", 1),
        ("$P --help >&-", 0),
        ("$P new made.toml <&- >&- 2>&-", 0),
    ],
)
def test_closed_streams_change_no_exit_code(line, code, singular):
    answer = shell(line, folder=singular.parent, S=str(singular))
    assert answer.returncode == code and "Traceback" not in answer.stderr
    made = singular.parent / "made.toml"
    assert not made.exists() or made.read_text(encoding="utf-8") == sd.io.starting_file()


@POSIX
def test_closed_stderr_sends_no_refusal_to_stdout(tmp_path):
    answer = shell("$P check absent.toml 2>&-", folder=tmp_path)
    assert answer.returncode == 2 and answer.stdout == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("words", ["schema", "--help"])
def test_output_that_cannot_be_written_exits_2_with_a_sentence(words):
    answer = shell(f"$P {words} > /dev/full")
    assert answer.returncode == 2
    assert answer.stderr.startswith("spheredrive: the output cannot be written") and answer.stderr.count("\n") == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("words", ["check absent.toml", "schema > /dev/full"])
def test_errors_that_cannot_be_told_leave_the_exit_code(words):
    assert shell(f"$P {words} 2> /dev/full").returncode == 2


@POSIX
@pytest.mark.parametrize("words", ["--help", "schema", "check $D"])
def test_reader_that_has_gone_is_no_failure(words):
    # `true` reads nothing: the pipe is closed when the answer comes.
    answer = shell(f"{{ $P {words}; echo $? >&2; }} | true")
    assert answer.stderr == "0\n"


def test_json_loses_no_letter_where_the_stream_is_ascii(tmp_path):
    path = tmp_path / "design.toml"
    path.write_text(SINGULAR.replace("on the equator", "Kügel Ω 球"), encoding="utf-8")
    answer = run("check", path, "--json", PYTHONIOENCODING="ascii")
    assert json.loads(answer.stdout)["name"] == "Kügel Ω 球"


@POSIX
def test_file_that_is_a_pipe_is_written_to():
    code = "from spheredrive.io.files import write_whole; write_whole('/dev/stdout', 'a' * 200_000)"
    answer = shell(f'"{sys.executable}" -c "{code}" | cat')
    assert answer.stderr == "" and answer.stdout == "a" * 200_000


DEFECT = """
import spheredrive.checking
from spheredrive.cli import main

def check(design):
    raise {error}

spheredrive.checking.check = check
main(["check", {path!r}])
"""


@pytest.mark.parametrize(("error", "debug"), [("ZeroDivisionError('seven\\nbridges')", ""), ("OSError('seven bridges')", "1")])
def test_defect_of_the_program_exits_70_and_asks_for_a_report(error, debug):
    answer = subprocess.run(
        [sys.executable, "-c", DEFECT.format(error=error, path=ATLAS)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "SPHEREDRIVE_DEBUG": debug},
    )
    assert answer.returncode == 70 and answer.stdout == ""
    last = answer.stderr.splitlines()[-1]
    assert last.startswith("spheredrive: ") and "Error: seven bridges" in last and "report" in last
    assert ("Traceback" in answer.stderr) == bool(debug) and (debug or answer.stderr.count("\n") == 1)


# vibration and compare


class Answer(NamedTuple):
    """What a process would give."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def here(capsys):
    """A command line in this process, for what needs no process of its own."""

    def answer(*words):
        with pytest.raises(SystemExit) as left:
            main([str(word) for word in words])
        return Answer(left.value.code, *capsys.readouterr())

    return answer


def test_vibration_prints_sizes_and_json_holds_the_assessment():
    words = ("vibration", sd.design_path("ballbot"), "--speeds", "12 8 -5 rad/s")
    answer = run(*words)
    assert answer.returncode == 0 and answer.stderr == ""
    assert "The design works at these speeds." in answer.stdout and "Speeds to avoid" in answer.stdout
    result = json.loads(run(*words, "--json").stdout)
    here = sd.vibration.assess(sd.load_design(sd.design_path("ballbot")), [12, 8, -5]).as_dict()
    assert result.pop("isolator_sought") is None
    assert result == json.loads(json.dumps(here))


def test_vibration_one_speed_in_rpm_is_for_every_wheel(here):
    answer = json.loads(here("vibration", sd.design_path("ballbot"), "--speeds", "30 rpm", "--json").stdout)
    np.testing.assert_allclose(answer["wheel_speed_rad_s"], np.full(3, np.pi), rtol=1e-12)


def test_vibration_wanted_acceleration_finds_an_isolator(here):
    words = ("--speeds", "100 80 30 rpm", "--payload", "0.5 kg", "--wanted", "0.003 m/s^2", "--isolator-damping", "0.2")
    result = json.loads(here("vibration", sd.design_path("ballbot"), *words, "--json").stdout)
    assert result["payload"]["rms_acceleration_m_s2"] == pytest.approx(0.003, rel=1e-4)
    assert result["isolator_sought"]["stiffness_n_m"] == pytest.approx(result["isolator"]["stiffness_n_m"][0])
    assert "Isolator of a payload of 0.5 kg" in here("vibration", sd.design_path("ballbot"), *words).stdout


@pytest.mark.parametrize("name", ["orthogonal", "six-orthogonal", "atlas-mecanum", "atlas-demonstrator", "atlas-dual-race"])
def test_vibration_of_any_shipped_design(name, here):
    answer = here("vibration", sd.design_path(name), "--speeds", "0.7 rad/s")
    assert answer.returncode in (0, 1) and answer.stderr == ""
    assert ("does not work" in answer.stdout) == bool(answer.returncode)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--speeds requires"),
        (("--speeds", "1 2 rad/s"), "each of the 3 wheels, or one for all, but 2 are given"),
        (("--speeds", "1 2 3"), "lacks a unit"),
        (("--speeds", "nan rad/s"), "finite number"),
        (("--speeds", "1, 2, 3 rad/s"), "comma"),
        (("--speeds", "3 m"), "is a length"),
        (("--speeds", "1 rad/s", "--model", "rigid"), "choose from coupled"),
        (("--speeds", "1 rad/s", "--isolator", "3 Hz"), "add --payload"),
        (("--speeds", "1 rad/s", "--payload", "80 kg", "--isolator", "3 Hz"), "leaves nothing of the sphere"),
        (("--speeds", "1 rad/s", "--payload", "1 kg"), "--isolator"),
        (("--speeds", "1 rad/s", "--payload", "1 kg", "--isolator", "0 Hz"), "greater than zero"),
        (("--speeds", "1 rad/s", "--payload", "1 kg", "--wanted", "1e-12 m/s^2"), "no isolator"),
    ],
)
def test_vibration_bad_input_exits_2_with_a_sentence(words, message, here):
    answer = here("vibration", sd.design_path("ballbot"), *words)
    assert answer.returncode == 2 and answer.stdout == ""
    assert answer.stderr.startswith("spheredrive: ") and message in answer.stderr


def test_vibration_of_a_sphere_without_a_seat_is_refused_with_a_sentence(here):
    answer = here("vibration", sd.design_path("collinear-triple-race"), "--speeds", "1 rad/s")
    assert answer.returncode == 2 and "contact.stiffness" in answer.stderr


def test_compare_sets_designs_and_parts_side_by_side(tmp_path):
    designs = [sd.design_path(name) for name in ("ballbot", "atlas-dual-race")]
    words = (*designs, "--wheel", "sunfounder/zeus-60mm-mecanum", "nexus/14073", "--speeds", "3 2 1 rad/s")
    answer = run("compare", *words, "-o", "compare.html", folder=tmp_path)
    assert answer.returncode == 0 and answer.stderr == "" and answer.stdout.startswith("compare.html\n")
    assert "nexus/14073: wheel not known" in answer.stdout
    assert "outlines" in (tmp_path / "compare.html").read_text(encoding="utf-8")
    result = json.loads(run("compare", *words, "--json", folder=tmp_path).stdout)
    assert [row["name"] for row in result["machines"]][2:] == ["sunfounder/zeus-60mm-mecanum", "nexus/14073"]
    assert result["machines"][3]["missing"] and result["machines"][0]["preload_n"] == 0.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "nothing to compare"),
        (("ballbot", "--wheel", "nexus/14074"), "did you mean"),
        (("ballbot", "--speeds", "1 2 rad/s"), "3 wheels"),
        (("ballbot", "-o", "no/folder/x.html"), "no such folder"),
    ],
)
def test_compare_bad_input_exits_2_with_a_sentence(words, message, tmp_path, here, monkeypatch):
    named = [sd.design_path(word) if word == "ballbot" else word for word in words]
    monkeypatch.chdir(tmp_path)
    answer = here("compare", *named)
    assert answer.returncode == 2 and answer.stdout == "" and message in answer.stderr
    assert list(tmp_path.iterdir()) == []


def test_report_at_given_speeds_shows_the_vibration_and_exits_by_it(tmp_path, here, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert here("report", sd.design_path("ballbot"), "--speeds", "12 8 -5 rad/s").returncode == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'id="campbell"' in page and "--speeds" in page
    lifted = here("report", sd.design_path("atlas-demonstrator"), "--speeds", "0.1 1.2 0.9 rad/s")
    assert lifted.returncode == 1
