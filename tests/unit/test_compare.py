"""Machines side by side: the same motion of the sphere's surface, rows that say what is missing, the page."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from layouts import atlas, six_orthogonal
from spheredrive import kinematics
from spheredrive.design import Contact, Design, Placement, Sphere, Stage
from spheredrive.dynamics import pressing_direction
from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.motion import Motion, Series
from spheredrive.simulation.preload import least_preload
from spheredrive.studies.compare import compare, machine, machines, motion_alike, speeds_alike, with_part
from spheredrive.studies.compare.page import comparison_page
from spheredrive.studies.compare.text import cells, comparison_text
from spheredrive.vibration.assessment.assess import assess
from spheredrive.wheels import IdealWheel, MecanumWheel, StandardWheel

SPEEDS = np.array([2.0, 1.0, -0.5])


def built(wheel, radius=0.15, **placed) -> Design:
    design = replace(atlas(wheel, radius=radius, **placed), sphere=Sphere(radius, 2.0), stage=Stage(5.0))
    return replace(design, contact=Contact(2e5, 40.0, 0.9))


def omni(radius=0.025):
    return StandardWheel(radius=radius, rollers=16, roundness=0.3, mass=0.1)


FIRST = built(omni())


# The same motion.


@pytest.mark.parametrize(
    "other",
    [built(omni(0.05)), built(MecanumWheel(radius=0.03, rollers=9)), built(omni(), radius=0.3), built(omni(), elevation_deg=30),
     six_orthogonal()],
    ids=["larger wheels", "mecanum", "larger sphere", "other places", "six wheels"],
)  # fmt: skip
def test_speeds_alike_move_the_spheres_surface_alike(other):
    speed = speeds_alike(FIRST, SPEEDS, other)
    want = kinematics.forward(FIRST, SPEEDS) * FIRST.sphere.radius
    np.testing.assert_allclose(kinematics.forward(other, speed) * other.sphere.radius, want, rtol=1e-12, atol=1e-14)


def test_speeds_alike_wheels_of_twice_the_radius_turn_half_as_fast():
    np.testing.assert_allclose(speeds_alike(FIRST, SPEEDS, built(omni(0.05))), SPEEDS / 2, rtol=1e-12)
    np.testing.assert_array_equal(speeds_alike(FIRST, SPEEDS, FIRST), SPEEDS)


def test_speeds_alike_without_a_jacobian_keeps_the_speed_of_the_rims():
    first, other = built(omni(), elevation_deg=0.0), built(omni(0.05), elevation_deg=0.0)
    np.testing.assert_allclose(speeds_alike(first, SPEEDS, other), SPEEDS / 2, rtol=1e-12)
    with pytest.raises(SpheredriveError, match="not as many"):
        speeds_alike(first, SPEEDS, six_orthogonal())


def test_motion_alike_torques_do_the_same_work_at_the_same_motion():
    other = built(MecanumWheel(radius=0.03, rollers=9))
    torque = Motion("wheel-torque", Series((0.0, 1.0), ((0.1, 0.2, 0.3), (-0.3, 0.1, 0.2))), 1.0)
    turned = motion_alike(FIRST, torque, other)
    for Omega in np.eye(3):
        work = [t.series.arrays[1] @ kinematics.inverse(d, Omega) for t, d in ((torque, FIRST), (turned, other))]
        np.testing.assert_allclose(work[0], work[1], rtol=1e-12, atol=1e-15)


def test_motion_alike_velocities_of_a_larger_sphere_are_slower():
    other = built(omni(), radius=0.3)
    spin = Motion("sphere-velocity", Series((0.0, 1.0), ((0.0, 0.0, 1.0), (2.0, 0.0, 0.0))), 1.0)
    np.testing.assert_allclose(motion_alike(FIRST, spin, other).series.arrays[1], spin.series.arrays[1] / 2, rtol=1e-12)
    speeds = Motion("wheel-speed", Series((0.0,), (tuple(SPEEDS),)), 1.0, wheel_angle=(0.0, 0.1, 0.2))
    turned = motion_alike(FIRST, speeds, six_orthogonal())
    np.testing.assert_allclose(turned.series.arrays[1][0], speeds_alike(FIRST, SPEEDS, six_orthogonal()), rtol=1e-12)
    assert turned.wheel_angle is None


# Rows.


def test_compare_rows_hold_what_the_functions_give():
    other = built(MecanumWheel(radius=0.03, rollers=9, mass=0.1))
    result = compare([machine(FIRST), machine(other)], SPEEDS)
    for row, design in zip(result.rows, (FIRST, other), strict=True):
        own = speeds_alike(FIRST, SPEEDS, design)
        alone = assess(design, own)
        np.testing.assert_array_equal(row.wheel_speed, own)
        assert row.sizes()[:6] == alone.sphere.sizes[:6]
        assert row.comfort().total == alone.sphere.comfort.total
        assert row.check.effectiveness == kinematics.effectiveness(design)
    assert result.rows[0].depth == pytest.approx(max(e.depth for e in assess(FIRST, SPEEDS).excitations))
    json.dumps(result.as_dict(), allow_nan=False)


def test_compare_preload_of_the_vibration_is_told_by_the_forces():
    light = replace(FIRST, sphere=Sphere(0.15, 0.05))
    (row,) = compare([machine(light)], 30 * SPEEDS).rows
    least = [f.least for f in row.vibration.forces]
    # Three wheels alike around the axis: one newton along it presses each with 1/(3 sin 40°).
    assert min(least) < 0
    assert row.preload == pytest.approx(-min(least) * 3 * math.sin(math.radians(40)), rel=1e-9)
    assert not row.works


def test_compare_preload_of_a_motion_is_that_of_the_simulation():
    spin = Motion("sphere-velocity", Series((0.0, 0.1), ((0.0, 0.0, 0.0), (0.0, 40.0, 0.0))), 0.1)
    other = built(omni(0.05))
    result = compare([machine(FIRST), machine(other)], SPEEDS, spin)
    for row, design in zip(result.rows, (FIRST, other), strict=True):
        assert row.preload == least_preload(design, spin, pressing_direction(design)).force > 0


def test_compare_keeps_the_trouble_of_a_machine_in_its_row():
    flat = built(omni(), elevation_deg=0.0)
    single = Design("one", Sphere(0.1), [Placement(IdealWheel(radius=0.02), (1, 0, 0), (0, 1, 0))])
    result = compare([machine(FIRST), machine(flat), machine(single)])
    reasons = [dict(row.reasons) for row in result.rows]
    assert not result.chosen and result.works
    assert reasons[0] == {} and "nothing holds the sphere" in reasons[1]["vibration"]
    assert not result.rows[2].works and "one: " in comparison_text(result)


def test_with_part_keeps_the_places_and_takes_the_figures_of_the_catalogue():
    whole = with_part(FIRST, "sunfounder/zeus-60mm-mecanum")
    np.testing.assert_array_equal(whole.design.contact_directions, FIRST.contact_directions)
    np.testing.assert_array_equal(whole.design.drive_directions, FIRST.drive_directions)
    assert set(whole.design.wheel_radii) == {0.03} and whole.design.wheels[0].mass == 0.1
    assert "mass not published: 0.1 kg" in whole.note


def test_compare_part_without_figures_is_a_row_that_says_so():
    result = compare(machines({"a": FIRST, "b": FIRST}, ["nexus/14073", "vex/4in-mecanum"]), SPEEDS)
    names = [row.machine.name for row in result.rows]
    assert names == ["Atlas (a)", "Atlas (b)", "nexus/14073", "vex/4in-mecanum"]
    assert "race_spacing" in dict(result.rows[2].reasons)["wheel"]
    # Without a number of rollers there is no outline, but kinematics needs none.
    assert "rollers" in dict(result.rows[3].reasons)["excitation"] and result.rows[3].check is not None
    assert cells(result.rows[2])[1:] == ("-",) * 11
    np.testing.assert_equal(cells(result.rows[0])[1:], cells(result.rows[1])[1:])
    with pytest.raises(UnknownNameError, match="did you mean"):
        with_part(FIRST, "nexus/14074")


@pytest.mark.parametrize(
    ("chosen", "speeds", "message"),
    [([with_part(FIRST, "nexus/14073")], None, "no machine to compare"), ([machine(FIRST)], [1.0, 2.0], "each of the 3"),
     ([machine(FIRST)], math.nan, "finite")],
)  # fmt: skip
def test_compare_what_has_no_answer_is_refused(chosen, speeds, message):
    with pytest.raises(SpheredriveError, match=message):
        compare(chosen, speeds)


def test_comparison_page_is_one_file_and_the_same_each_time():
    hostile = replace(FIRST, name="<script>x</script>")
    result = compare([machine(FIRST), machine(hostile), with_part(FIRST, "nexus/14073")], SPEEDS)
    page = comparison_page(result)
    assert page == comparison_page(compare([r.machine for r in result.rows], SPEEDS))
    assert "<script" not in page and not re.search(r"https?:|\bsrc\s*=|@import|<link|<img|xmlns|mathdefault", page)
    names = re.findall(r'\bid="([^"]*)"', page)
    assert len(names) == len(set(names)) and page.count('role="img"') == 3
    assert set(re.findall(r'(?:href="|url\()#([^")]+)', page)) <= set(names)
