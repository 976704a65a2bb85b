"""Every unit of ``units.txt`` against its published factor, NIST Special Publication 811 (2008), appendix B.8 and table 5.

Factors in bold there are exact; the others are made here from the exact ones that define them (lbf = lb × g_n, psi = lbf/in²).
Tolerance 1e-15: exact fractions rounded once; π, and the 16 digits that ``psi`` has in the file, are off by 2e-16 at most.
"""

import math
import re
from fractions import Fraction as F
from pathlib import Path

import pytest

import spheredrive.io.quantity
from spheredrive.io.quantity import parse

INCH = F("0.0254")
POUND = F("0.45359237")
G_N = F("9.80665")
LBF = POUND * G_N
DEGREE = math.pi / 180

# Names that mean the same, SI unit, factor.
UNITS = [
    ("m meter metre", "m", 1),
    ("in inch inches", "m", INCH),
    ("ft foot feet", "m", 12 * INCH),
    ("thou mil", "m", INCH / 1000),
    ("g gram gramme", "kg", F("0.001")),
    ("t tonne", "kg", 1000),
    ("lb lbs pound", "kg", POUND),
    ("oz ounce", "kg", POUND / 16),
    ("s sec second", "s", 1),
    ("min minute", "s", 60),
    ("h hr hour", "s", 3600),
    ("rad radian", "rad", 1),
    ("° deg degree", "rad", DEGREE),
    ("arcmin arcminute", "rad", DEGREE / 60),
    ("arcsec arcsecond", "rad", DEGREE / 3600),
    ("turn rev revolution", "rad", 2 * math.pi),
    ("grad gon grade", "rad", math.pi / 200),
    ("% percent", "", F("0.01")),
    ("Hz hertz", "Hz", 1),
    ("rpm revolutions_per_minute", "rad/s", math.pi / 30),
    ("rps revolutions_per_second", "rad/s", 2 * math.pi),
    ("N newton", "N", 1),
    ("kgf kilogram_force", "N", G_N),
    ("gf gram_force", "N", G_N / 1000),
    ("lbf pound_force", "N", LBF),
    ("ozf ounce_force", "N", LBF / 16),
    ("Nm newton_meter newton_metre", "N m", 1),
    ("Ns newton_second", "N s", 1),
    ("J joule", "N m", 1),
    ("W watt", "W", 1),
    ("Pa pascal", "Pa", 1),
    ("bar", "Pa", 100_000),
    ("psi", "Pa", LBF / INCH**2),
]
FACTORS = {name: (unit, factor) for names, unit, factor in UNITS for name in names.split()}
PREFIXES = {"n nano": -9, "u µ μ micro": -6, "m milli": -3, "c centi": -2, "k kilo": 3, "M mega": 6, "G giga": 9}
POWERS = {name: power for names, power in PREFIXES.items() for name in names.split()}


@pytest.mark.parametrize("name", FACTORS)
def test_parse_every_unit_has_its_published_factor(name):
    unit, factor = FACTORS[name]
    assert parse(f"1 {name}", unit) == pytest.approx(float(factor), rel=1e-15)
    assert parse(f"-2.5e3 {name}", unit) == pytest.approx(-2500 * float(factor), rel=1e-15)


def test_units_table_names_every_unit_of_the_file():
    """A unit that is added to the file needs its published factor here."""
    text = Path(spheredrive.io.quantity.__file__).with_name("units.txt").read_text(encoding="utf-8")
    names, prefixes = set(), set()
    for line in text.splitlines():
        if "=" not in line or line.startswith("#"):
            continue
        name, _value, *others = (part.strip() for part in line.split(" = "))
        kind = prefixes if name.endswith("-") else names
        kind.update(word.rstrip("-") for word in (name, *others) if word != "_")
    assert names == set(FACTORS) - {"%"}
    assert prefixes == set(POWERS)


@pytest.mark.parametrize("prefix", POWERS)
@pytest.mark.parametrize(("short", "long", "unit"), [("m", "meter", "m"), ("N", "newton", "N"), ("Pa", "pascal", "Pa")])
def test_parse_every_prefix_is_its_power_of_ten(prefix, short, long, unit):
    name = prefix + (long if re.fullmatch("[a-z]{4,}", prefix) else short)
    # float of the literal is the nearest double, as one rounding of the exact fraction must be.
    assert parse(f"3 {name}", unit) == float(f"3e{POWERS[prefix]}")


@pytest.mark.parametrize(
    ("text", "unit", "factor"),
    [
        ("1 lbf/in", "N/m", LBF / INCH),
        ("1 lbf ft", "N m", LBF * 12 * INCH),
        ("1 ozf in", "N m", LBF / 16 * INCH),
        ("1 kgf cm", "N m", G_N / 100),
        ("1 gf mm", "N m", G_N / 10**6),
        ("1 lb in^2", "kg m^2", POUND * INCH**2),
        ("1 oz·in²", "kg m^2", POUND / 16 * INCH**2),
        ("1 g cm^2", "kg m^2", F(1, 10**7)),
        ("1 ft/s", "m/s", 12 * INCH),
        ("1 in/s^2", "m/s^2", INCH),
        ("1 m/min", "m/s", F(1, 60)),
        ("1 km/h", "m/s", F(1000, 3600)),
        ("1 kgf/cm^2", "Pa", G_N * 10**4),
        ("1 N/mm^2", "Pa", 10**6),
        ("1 lbf s/in", "N s/m", LBF / INCH),
        ("1 turn/s", "rad/s", 2 * math.pi),
        ("1 deg/s", "rad/s", DEGREE),
        ("1 deg/min", "rad/s", DEGREE / 60),
        ("1 rpm/s", "rad/s^2", math.pi / 30),
        ("1 N m/deg", "N m/rad", 180 / math.pi),
        ("1 mN m s/deg", "N m s/rad", 0.18 / math.pi),
        ("1 mNm/rpm", "N m s/rad", 0.03 / math.pi),
    ],
)
def test_parse_compound_units_multiply_their_parts(text, unit, factor):
    assert parse(text, unit) == pytest.approx(float(factor), rel=1e-15)


def test_parse_decimals_of_the_publication():
    """NIST SP 811 prints psi 6.894 757 E+03, lbf 4.448 222, ozf 2.780 139 E−01, gf 9.806 65 E−03, rpm 1.047 198 E−01."""
    printed = {"psi": ("Pa", 6894.757), "lbf": ("N", 4.448222), "ozf": ("N", 0.2780139), "gf": ("N", 0.00980665)}
    for name, (unit, value) in {**printed, "rpm": ("rad/s", 0.1047198)}.items():
        # Seven digits are printed.
        assert parse(f"1 {name}", unit) == pytest.approx(value, rel=5e-7)
