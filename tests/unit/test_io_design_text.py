"""Designs to text and back: nothing is lost, and the text is one a person would write."""

import dataclasses
import math
import tomllib

import numpy as np
import pytest

from layouts import DUAL, atlas, random_wheel
from spheredrive.design import Closure, Contact, Design, Motor, Placement, Sphere, Spring, Stage
from spheredrive.designs import design_path, shipped_designs
from spheredrive.errors import DesignError
from spheredrive.io.design_file import load_design, parse_design
from spheredrive.io.design_text import design_files, design_text, quantity_text, write_design
from spheredrive.io.quantity import parse
from spheredrive.wheels import DualRaceWheel, IdealWheel, MeasuredWheel


@pytest.mark.parametrize("name", shipped_designs())
def test_design_text_of_a_shipped_design_reads_back_equal(name):
    design = load_design(design_path(name))
    # Values are compared, floats by ==: equal means equal to the last bit.
    assert parse_design(design_text(design)) == design


@pytest.mark.parametrize("name", shipped_designs())
def test_design_text_of_a_shipped_design_has_the_numbers_of_its_file(name):
    given = tomllib.loads(design_path(name).read_text(encoding="utf-8"))
    written = tomllib.loads(design_text(load_design(design_path(name))))
    rings = [
        {key: entry[key] for key in ("count", "elevation", "contact", "drive") if key in entry} for entry in given["placement"]
    ]
    assert [{key: entry[key] for key in entry if key not in ("heading", "azimuth")} for entry in written["placement"]] == rings


def test_design_text_every_key_survives():
    spring = Spring((1.0, 2.0, 3.0), 1e4, 3.5)
    wheel = DualRaceWheel(**DUAL, roller_angle=-math.radians(50), roller_shape="capsule", phase=0.1, mass=0.1, name='a "b" ü')
    design = dataclasses.replace(
        atlas(wheel, -37.3, 12.0),
        sphere=Sphere(0.15, 2.0, ((0.03, 1e-4, 0.0), (1e-4, 0.03, 0.0), (0.0, 0.0, 0.04)), (1e-3, 0.0, -2e-3), 1.1e11, 0.3),
        contact=Contact(188208.0, 12.5, 0.9, 1e-4, 2e-4),
        closure=Closure(10.0, 0.5, (0.0, -1.0, 2.0), (spring, Spring((0.0, 0.0, 1.0), 5.0))),
        stage=Stage(5.0, False),
        motor=Motor(2.0, 31.41592653589793, 0.1, 0.01),
    )
    assert parse_design(design_text(design)) == design


def test_design_text_random_numbers_come_back_to_the_last_bit(rng):
    for kind in ("ideal", "standard", "dual-race", "split-dual-race", "mecanum"):
        wheel = random_wheel(rng, kind)
        design = atlas(wheel, rng.uniform(-80, 80), rng.uniform(-180, 180), radius=rng.uniform(0.3, 2), count=4)
        again = parse_design(design_text(design))
        assert (again.sphere, again.wheels) == (design.sphere, design.wheels)
        # A direction is divided by its length when it is read, which may leave a last bit.
        assert np.abs(again.contact_directions - design.contact_directions).max() < 3e-16
        assert np.abs(again.drive_directions - design.drive_directions).max() < 3e-16


def test_design_text_a_turned_layout_falls_back_to_vectors():
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    design = atlas().rotated(turn)
    again = parse_design(design_text(design))
    assert np.abs(again.contact_directions - design.contact_directions).max() < 3e-16
    assert "contact = [" in design_text(design)


def test_design_text_of_two_models_names_them_at_each_place():
    small, large = IdealWheel(radius=0.02, name="wheel"), IdealWheel(radius=0.03, name="wheel")
    places = [Placement.at(wheel, i, -0.5) for i, wheel in enumerate((small, large, small))]
    again = parse_design(design_text(Design("two", Sphere(0.15), places)))
    assert [(wheel.name, wheel.radius) for wheel in again.wheels] == [("wheel", 0.02), ("wheel-2", 0.03), ("wheel", 0.02)]


def test_write_design_puts_a_measured_outline_beside_it(tmp_path):
    outline = tuple((0.1 * i, 0.025 + 1e-4 * math.sin(i)) for i in range(60))
    design = atlas(MeasuredWheel(outline=outline, name="wheel 1"))
    written = write_design(design, tmp_path / "a.toml")
    assert [path.name for path in written] == ["wheel-1.csv", "a.toml"]
    assert load_design(tmp_path / "a.toml") == design
    assert list(design_files(design).tables) == ["wheel-1.csv"]
    with pytest.raises(DesignError, match="file of its own"):
        design_text(design)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.025, "m", '"25 mm"'),
        (0.00485, "m", '"4.85 mm"'),
        (1.22, "m", '"1.22 m"'),
        (0.0, "m", '"0 mm"'),
        (math.radians(-40), "rad", '"-40 deg"'),
        (0.1, "rad", None),
        (300 * math.pi / 30, "rad/s", None),
        (parse("250 rpm", "rad/s"), "rad/s", '"250 rpm"'),
        (188208.0, "N/m", '"188208 N/m"'),
        (1e-5, "kg m^2", None),
        (3e-11, "m", None),
        (0.9, "", "0.9"),
    ],
)
def test_quantity_text_is_short_and_exact(value, unit, text):
    written = quantity_text(value, unit)
    assert text is None or written == text
    assert parse(written.strip('"') if unit else float(written), unit) == value
