"""Designs with one thing changed: that thing is changed and nothing else, and what cannot be built is refused."""

import dataclasses
import math

import numpy as np
import pytest

from layouts import DUAL, atlas, collinear_triple, orthogonal
from spheredrive.app.editing import edited, of_type, rings
from spheredrive.design import Design, Placement, Sphere
from spheredrive.designs import design_path, shipped_designs
from spheredrive.errors import DesignError
from spheredrive.io.design_file import load_design, parse_design
from spheredrive.io.design_text import design_text
from spheredrive.wheels import TYPES, DualRaceWheel, IdealWheel, MeasuredWheel, MecanumWheel


def test_rings_finds_rings_and_single_wheels():
    (ring,) = rings(atlas(elevation_deg=-37.3, heading_deg=12.0, count=5))
    assert (ring.count, ring.elevation, ring.heading) == (5, math.radians(-37.3), math.radians(12.0))
    assert [ring.count for ring in rings(orthogonal())] == [1, 1, 1]


@pytest.mark.parametrize("key", ["azimuth", "elevation", "heading"])
def test_edited_an_angle_changes_that_angle_of_every_wheel_alone(key):
    design = atlas(elevation_deg=-40.0, heading_deg=10.0)
    moved = edited(design, 0, key, math.radians(25.0))
    place = ["azimuth", "elevation", "heading"].index(key)
    for before, after in zip(design.placements, moved.placements, strict=True):
        angles, new = np.array(before.azimuth_elevation_heading), np.array(after.azimuth_elevation_heading)
        angles[place] = math.radians(25.0) + (angles[place] if key == "azimuth" else 0.0)
        assert np.cos(new - angles) == pytest.approx(1.0, abs=1e-14)
    assert moved.sphere == design.sphere and moved.wheels == design.wheels


def test_edited_one_wheel_of_several_leaves_the_others():
    design = collinear_triple()
    moved = edited(design, 1, "elevation", 0.1)
    assert moved.placements[0] == design.placements[0]
    assert moved.placements[2].contact_direction == pytest.approx(design.placements[2].contact_direction, abs=1e-15)
    assert moved.placements[1].azimuth_elevation_heading[1] == pytest.approx(0.1, abs=1e-15)


def test_edited_a_wheel_model_changes_wherever_it_stands():
    one, other = IdealWheel(radius=0.02, name="a"), IdealWheel(radius=0.03, name="b")
    design = Design("mixed", Sphere(0.15), [Placement.at(w, i, -0.5, ring=i) for i, w in enumerate((one, other, one), 1)])
    assert edited(design, 0, "radius", 0.025).wheel_radii.tolist() == [0.025, 0.03, 0.025]


def test_edited_count_and_type_and_parts():
    design = atlas()
    assert edited(design, 0, "count", 4).wheel_count == 4
    assert edited(design, 0, "type", "mecanum").wheels[0].roller_angle == math.pi / 4
    assert edited(design, 0, "sphere.radius", 0.2).sphere.radius == 0.2
    assert edited(design, 0, "contact.stiffness", 1e5).contact.stiffness == 1e5
    assert edited(design, 0, "motor.torque", None).motor.torque is None


@pytest.mark.parametrize("old", [kind for kind in TYPES if kind != "measured"])
@pytest.mark.parametrize("new", [kind for kind in TYPES if kind != "measured"])
def test_of_type_every_type_becomes_every_other_and_keeps_what_both_have(old, new):
    wheel = of_type(DualRaceWheel(**DUAL, mass=0.1, name="omni"), old)
    changed = of_type(wheel, new)
    assert (changed.type, changed.radius, changed.mass, changed.name) == (new, 0.025, 0.1, "omni")
    assert math.isfinite(changed.roller_angle)


def test_of_type_takes_back_what_was_remembered():
    wheel = of_type(IdealWheel(radius=0.025), "dual-race", {"race_spacing": 0.011, "rollers": 20})
    assert (wheel.race_spacing, wheel.rollers) == (0.011, 20)


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("radius", 0.001, "does not fit into a wheel"),
        ("roller_angle", 0.0, "1 to 90 deg"),
        ("rollers", 7, "do not share out"),
        ("type", "measured", "comes from a file"),
        ("sphere.radius", -1.0, "greater than zero"),
        ("elevation", 2.0, "runs from -90 to 90 deg"),
    ],
)
def test_edited_what_cannot_be_built_is_refused_with_a_sentence(key, value, sentence):
    with pytest.raises(DesignError, match=sentence):
        edited(atlas(), 0, key, value)


@pytest.mark.parametrize("name", shipped_designs())
def test_edited_designs_are_saved_and_loaded_again(name):
    design = load_design(design_path(name))
    changed = edited(edited(design, 0, "elevation", math.radians(-33.5)), 0, "radius", 1.1 * design.wheels[0].radius)
    assert parse_design(design_text(changed)) == changed


def test_edited_keeps_a_measured_wheel():
    wheel = MeasuredWheel(outline=tuple((0.1 * i, 0.025) for i in range(60)))
    assert edited(atlas(wheel), 0, "elevation", -0.5).wheels[0] == wheel
    assert isinstance(edited(atlas(wheel), 0, "type", "mecanum").wheels[0], MecanumWheel)
    assert dataclasses.is_dataclass(wheel)
