"""Motion files: the example of the interface, CSV inputs, and what each kind of mistake is told as."""

from pathlib import Path

import numpy as np
import pytest

from spheredrive.errors import InputError
from spheredrive.io.motion_file import load_motion, parse_motion

EXAMPLE = Path(__file__).parents[1] / "data" / "interface-motion.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")
TABLED = 'schema_version = 1\n[motion]\nkind = "wheel-speed"\nfile = "in.csv"\n'


def changed(old: str, new: str) -> str:
    assert old in TEXT
    return TEXT.replace(old, new, 1)


def test_load_motion_the_interface_example_gives_its_values():
    motion = load_motion(EXAMPLE, 3)
    assert (motion.kind, motion.series.interpolation, motion.duration, motion.sample_rate) == (
        "wheel-torque",
        "linear",
        2,
        1000,
    )
    assert motion.series.time == (0, 1, 2)
    assert motion.series.values == ((0.1, 0.2, 0.3), (0.1, 0.2, 0.3), (0, 0, 0))
    assert (motion.angular_velocity, motion.wheel_angle, motion.orientation) == ((0, 0, 0), (0, 0, 0), (1, 0, 0, 0))
    assert (motion.stage.kind, motion.stage.series.time) == ("force", (0, 2))
    assert motion.source == TEXT


def test_parse_motion_it_lasts_to_its_last_time_unless_said():
    assert parse_motion(changed('duration = "2 s"', "")).duration == 2
    assert parse_motion(changed('duration = "2 s"', "duration = 1.5")).duration == 1.5


def test_parse_motion_values_may_carry_the_unit_of_their_kind():
    motion = parse_motion(changed("[[0.1, 0.2, 0.3]", '[["100 mNm", 0.2, 0.3]'))
    assert motion.series.values[0] == (0.1, 0.2, 0.3)


def test_load_motion_a_table_beside_the_file_is_read(tmp_path):
    (tmp_path / "m.toml").write_text(TABLED)
    (tmp_path / "in.csv").write_bytes(b"\xef\xbb\xbftime,wheel_1,wheel_2\r\n0, 1, 2\r\n1.5,3,4\r\n\r\n")
    motion = load_motion(tmp_path / "m.toml", 2)
    assert motion.series.time == (0, 1.5)
    assert np.array_equal(motion.series.values, [[1, 2], [3, 4]])
    assert motion.duration == 1.5


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ('kind = "wheel-torque"', 'kind = "wheel-torqe"', "3:8", "did you mean 'wheel-torque'"),
        ('kind = "wheel-torque"', "", "2:1", "lacks the key kind"),
        ('interpolation = "linear"', 'interpolation = "cubic"', "4:17", "linear"),
        ('duration = "2 s"', 'duration = "2 m"', "5:12", "is a length"),
        ("time = [0, 1, 2]", "time = [0, 1, 1]", "6:15", "must rise"),
        ("time = [0, 1, 2]", "time = [0, 1]", "7:10", "3 rows for 2 times"),
        ("time = [0, 1, 2]", "", "2:1", "lacks the key time"),
        ("time = [0, 1, 2]", "time = []", "6:8", "at least one time"),
        ("[[0.1, 0.2, 0.3]", "[[0.1, nan, 0.3]", "7:17", "finite"),
        ("[[0.1, 0.2, 0.3]", '[[0.1, "2 m", 0.3]', "7:17", "a torque"),
        ("[[0.1, 0.2, 0.3]", "[[0.1, [2], 0.3]", "7:17", "takes a number"),
        ("[[0.1, 0.2, 0.3]", "[[0.1, 0.2]", "7:23", "has 3 entries"),
        ("[[0.1, 0.2, 0.3]", "[5", "7:10", "list of rows"),
        ('# file = "inputs.csv"', 'file = "inputs.csv"', "8:8", "either time and values, or a file"),
        ("orientation = [1, 0, 0, 0]", "orientation = [1, 1, 0, 0]", "12:15", "unit quaternion"),
        ("wheel_angle = [0, 0, 0]", "wheel_angle = [0, 0]", "11:15", "the design has 3 wheels"),
        ('kind = "wheel-torque"', 'kind = "wheel-speed"', "10:20", "settled"),
        ('kind = "force"', 'kind = "forse"', "14:8", "did you mean 'force'"),
        ("time = [0, 2]", "time = [2, 0]", "15:12", "must rise"),
        ("values = [[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]", "values = [[1, 2], [1, 2]]", "16:11", "three values"),
        ('sample_rate = "1000 Hz"', 'sample_rate = "1000 rpm"', "18:15", "a frequency"),
        ('sample_rate = "1000 Hz"', 'sample_rate = "1e12 Hz"', "18:15", "1e9 samples"),
        ("[output]", "[outptu]", "17:2", "did you mean 'output'"),
    ],
)
def test_parse_motion_a_mistake_is_told_with_its_place_and_rule(old, new, place, words):
    with pytest.raises(InputError) as caught:
        parse_motion(changed(old, new), wheel_count=3)
    assert str(caught.value).startswith(f"motion.toml:{place}: ")
    assert words in str(caught.value)


def test_parse_motion_for_another_number_of_wheels_is_refused():
    with pytest.raises(InputError, match=r"motion.toml:7:11: .*3 columns, but the design has 4 wheels"):
        parse_motion(TEXT, wheel_count=4)


@pytest.mark.parametrize(
    ("table", "place", "words"),
    [
        ("time,wheel_1,wheel_3\n0,1,2\n", "in.csv:1:1", "wheel_1,wheel_2"),
        ("time\n0\n", "in.csv:1:1", "wheel_1"),
        ("time,x,y,z\n0,1,2,3\n", "in.csv:1:1", "wheel_1"),
        ("", "in.csv:1:1", "wheel_1"),
        ("time,wheel_1\n0,1\n0,1\n", "in.csv:3:1", "must rise"),
        ("time,wheel_1\n0,1\n1,inf\n", "in.csv:3:3", "finite"),
        ("time,wheel_1\n0,1\n1,1e99\n", "in.csv:3:3", "not a size"),
        ("time,wheel_1\n0,1\n1,2,3\n", "in.csv:3:5", "3 entries"),
        ("time,wheel_1\n0,1\n1,2 rad/s\n", "in.csv:3:3", "without a unit"),
        ("time,wheel_1\n0,1\n  ,2\n", "in.csv:3:1", "time is missing"),
    ],
)
def test_load_motion_a_faulty_table_is_told_with_its_place(tmp_path, table, place, words):
    (tmp_path / "m.toml").write_text(TABLED)
    (tmp_path / "in.csv").write_text(table)
    with pytest.raises(InputError) as caught:
        load_motion(tmp_path / "m.toml")
    assert str(caught.value).startswith(f"{tmp_path / place}: ")
    assert words in str(caught.value)


def test_load_motion_no_table_is_told_at_its_key(tmp_path):
    (tmp_path / "m.toml").write_text(TABLED)
    with pytest.raises(InputError, match=r"m.toml:4:8: motion.file: .*no such file"):
        load_motion(tmp_path / "m.toml")
