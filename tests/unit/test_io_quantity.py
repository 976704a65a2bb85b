"""Units: what converts, to which double, and what is refused in which words."""

import math
import time

import pytest

from spheredrive.errors import DesignError
from spheredrive.io.quantity import parse, parse_list


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("25 mm", "m", 0.025),
        ("25mm", "m", 0.025),
        (" 25  mm ", "m", 0.025),
        ("4.85 mm", "m", 0.00485),
        ("12.5 mm", "m", 0.0125),
        ("75.8 mm", "m", 0.0758),
        ("15 cm", "m", 0.15),
        ("1 µm", "m", 1e-6),
        ("1 um", "m", 1e-6),
        ("3 millimeters", "m", 0.003),
        ("1 in", "m", 0.0254),
        ("5 ft", "m", 1.524),
        ("40 g", "kg", 0.04),
        ("1 lb", "kg", 0.45359237),
        ("3e-5 kg m^2", "kg m^2", 3e-5),
        ("3e-5 kg*m**2", "kg m^2", 3e-5),
        ("300 g·cm²", "kg m^2", 3e-5),
        ("188208 N/m", "N/m", 188208.0),
        ("1e6 N/m", "N/m", 1e6),
        ("188.208 N/mm", "N/m", 188208.0),
        ("8500 N s/m", "N s/m", 8500.0),
        ("2 N m", "N m", 2.0),
        ("2 Nm", "N m", 2.0),
        ("20 mNm", "N m", 0.02),
        ("2 J", "N m", 2.0),
        ("2 GPa", "Pa", 2e9),
        ("50 MPa", "Pa", 5e7),
        ("2 min", "s", 120.0),
        ("5 ms", "s", 0.005),
        ("1000 Hz", "Hz", 1000.0),
        ("1 kHz", "Hz", 1000.0),
        ("0.9", "", 0.9),
        ("45 %", "", 0.45),
        ("40 deg", "rad", math.radians(40)),
        ("\N{MINUS SIGN}40 deg", "rad", math.radians(-40)),
        ("90°", "rad", math.pi / 2),
        ("1 turn", "rad", 2 * math.pi),
        ("60 arcmin", "rad", math.pi / 180),
        ("100 mrad", "rad", 0.1),
        ("300 rpm", "rad/s", 31.41592653589793),
        ("300 rev/min", "rad/s", 31.41592653589793),
        ("180 deg/s", "rad/s", math.pi),
        ("0.1 N m s/rad", "N m s/rad", 0.1),
        ("0 mm", "m", 0.0),
        ("0e0 mm", "m", 0.0),
        (0.15, "m", 0.15),
        (3, "m", 3.0),
    ],
)
def test_parse_a_quantity_is_the_nearest_double(text, unit, expected):
    assert parse(text, unit) == expected


def test_parse_degrees_agree_with_math_radians_to_the_last_digit():
    for tenth in range(-7200, 7201, 7):
        assert parse(f"{tenth / 10} deg", "rad") == math.radians(tenth / 10)


def test_parse_decimal_prefixes_agree_with_the_literal_to_the_last_digit():
    for i in range(1, 3000, 7):
        assert parse(f"{i / 100} mm", "m") == float(f"{i / 100}e-3")


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("25,4 mm", "m", ['write "25.4 mm"', "a comma is not a decimal point"]),
        ("1,000.5 mm", "m", ['write "1000.5 mm"']),
        ("25", "m", ["lacks a unit", "a length", '"25 mm"']),
        ("40", "rad", ["lacks a unit", "an angle", '"40 deg"']),
        ("25 kg", "m", ["is a mass", "radius takes a length", '"25 mm"']),
        ("25 milimeter", "m", ["unknown unit 'milimeter'", "did you mean 'millimeter'"]),
        ("25 MM", "m", ["unknown unit 'MM'", "did you mean 'mm'"]),
        ("2 Kg", "kg", ["did you mean 'kg'"]),
        ("2 kkg", "kg", ["unknown unit"]),
        ("2 N m/ss", "N s/m", ["unknown unit 'ss'"]),
        ("nan mm", "m", ["finite"]),
        ("NaN", "m", ["finite"]),
        ("inf", "m", ["finite"]),
        ("-Infinity m", "m", ["finite"]),
        (math.nan, "m", ["finite"]),
        (math.inf, "m", ["finite"]),
        (True, "m", ["takes a number"]),
        ("1e30 m", "m", ["not a size that a machine can have"]),
        ("1e999 m", "m", ["not a size that a machine can have"]),
        ("1e-400 mm", "m", ["not a size that a machine can have"]),
        ("1e9999999 m", "m", ["not a number with a unit"]),
        ("1 m**9**9**9", "m", ["not a number with a unit"]),
        ("1 __import__('os')", "m", ["not a number with a unit"]),
        ("1 " + "m " * 500, "m", ["not a number with a unit"]),
        ("mm 25", "m", ["not a number with a unit"]),
        ("", "m", ["not a number with a unit"]),
        ("25 mm²", "m", ["an area"]),
        ("1 m^9", "m", ["of another kind"]),
        ("1 N/m s", "N s/m", ["two ways"]),
        ("20 degC", "rad", ["unknown unit 'degC'"]),
        ("5 deg", "", ["an angle", "a plain number"]),
        ("2 rad", "m", ["an angle", "a length"]),
        ("0.5 %", "rad", ["a plain number", "an angle"]),
        ("300 Hz", "rad/s", ["a frequency", "an angular speed", '"300 rpm" or "300 rad/s"']),
        ("300 rpm", "Hz", ["an angular speed", "a frequency", '"300 Hz"']),
        ("2 N m", "N m/rad", ["a torque", "a torque by angle"]),
    ],
)
def test_parse_what_is_no_quantity_is_refused_in_words(text, unit, words):
    begin = time.perf_counter()
    with pytest.raises(DesignError) as refusal:
        parse(text, unit, "radius")
    assert time.perf_counter() - begin < 2
    for word in words:
        assert word in str(refusal.value)


def test_parse_sign_is_checked():
    with pytest.raises(DesignError, match="greater than zero"):
        parse("-5 mm", "m", "radius", "positive")


def test_parse_list_numbers_share_the_unit():
    assert parse_list("0.1 1.2 0.9 rad/s", "rad/s") == [0.1, 1.2, 0.9]
    assert parse_list("60 120rpm", "rad/s") == pytest.approx([2 * math.pi, 4 * math.pi], rel=1e-15)
    assert parse_list("1 2 3", "") == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("2, 2, 2 rad/s", "comma"),
        ("2 2 2", "lacks a unit"),
        ("2 2 Hz", "a frequency"),
        ("", "not a list"),
        ("nan 1 rad/s", "finite"),
        ("1 2 rads/s/s", "angular acceleration"),
        ("1 1e99 rad/s", "not a size"),
    ],
)
def test_parse_list_what_is_no_list_is_refused_in_words(text, word):
    with pytest.raises(DesignError, match=word):
        parse_list(text, "rad/s", "speeds")
