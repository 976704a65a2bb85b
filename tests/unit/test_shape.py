"""Refusals, kinds, shapes and sharing of wheel outlines; measured outlines."""

import dataclasses
import math

import numpy as np
import pytest

from layouts import atlas
from spheredrive import shape
from spheredrive.design import Design, Placement, Sphere
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.wheels import (
    DualRaceWheel,
    IdealWheel,
    MeasuredWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
)

DEMONSTRATOR = StandardWheel(radius=75.8e-3, rollers=14, roundness=0.4485)
SPHERES = StandardWheel(radius=0.0759, rollers=8, roller_radius=0.0165, roller_shape="sphere")


def test_profile_of_an_equal_wheel_is_the_same_object():
    twin = dataclasses.replace(DEMONSTRATOR)
    assert shape.profile(DEMONSTRATOR, 1.22) is shape.profile(twin, 1.22)
    assert shape.profile(DEMONSTRATOR, 1.22) is not shape.profile(DEMONSTRATOR, 1.23)


def test_profiles_follow_the_wheels_of_a_design():
    odd = dataclasses.replace(DEMONSTRATOR, roundness=0.2)
    placements = [
        Placement.at(wheel, azimuth, -0.7)
        for azimuth, wheel in enumerate((DEMONSTRATOR, odd, dataclasses.replace(DEMONSTRATOR)))
    ]
    first, second, third = shape.profiles(Design("d", Sphere(1.22), placements))
    assert first is third and first is not second


def test_profiles_lead_to_the_wheel_at_fault():
    with pytest.raises(DesignError, match=r"wheels\.omni\.roundness: .*give roundness or roller_length"):
        shape.profiles(atlas(StandardWheel(radius=0.025, rollers=8, roller_radius=0.004, name="omni")))


def test_arrays_are_read_only_and_answers_have_the_angle_s_shape():
    outline = shape.profile(DEMONSTRATOR, 1.22)
    for array in (outline.breakpoints, outline.coefficients, outline.slope_jumps, outline.sphere_lever, outline.wheel_lever):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    for ask in (outline.height, outline.slope, outline.curvature, lambda x: shape.rolling_radius(outline, x)):
        assert np.ndim(ask(0.1)) == 0
        assert ask(np.zeros((2, 1, 3))).shape == (2, 1, 3)
        assert ask(np.zeros((0, 3))).shape == (0, 3)
    assert shape.wander(DEMONSTRATOR, 1.22, np.zeros((2, 3))).tilt.shape == (2, 3)
    assert shape.excitation(outline, np.zeros((2, 3))).impulses.shape == (2, 3, 1)
    assert outline.coefficients.shape == (len(outline.breakpoints) - 1, outline.coefficients.shape[1])
    assert outline.coefficients.shape[1] <= 13


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_angles_and_speeds_must_be_finite(bad):
    outline = shape.profile(DEMONSTRATOR, 1.22)
    for ask in (
        lambda: outline.height([0.0, bad]),
        lambda: shape.wander(DEMONSTRATOR, 1.22, bad),
        lambda: shape.excitation(outline, bad),
    ):
        with pytest.raises(SpheredriveError, match="must be finite"):
            ask()
    with pytest.raises(SpheredriveError, match="positive number of metres"):
        shape.profile(DEMONSTRATOR, bad)


def test_kinds_by_name():
    assert shape.profile(DEMONSTRATOR, 1.22).kind == "exact"
    assert shape.profile(dataclasses.replace(DEMONSTRATOR, profile="half-sine"), 1.22).kind == "half-sine"
    assert shape.profile(dataclasses.replace(DEMONSTRATOR, profile="half-sine"), 1.22, kind="exact").kind == "exact"
    assert shape.profile(DEMONSTRATOR, 1.22, kind="round").kind == "round"
    assert shape.profile(IdealWheel(radius=0.05), 1.22, kind="exact").kind == "round"
    assert shape.profile(dataclasses.replace(DEMONSTRATOR, roundness=0.0), 1.22, kind="half-sine").kind == "round"
    with pytest.raises(SpheredriveError, match="did you mean 'half-sine'"):
        shape.profile(DEMONSTRATOR, 1.22, kind="halfsine")
    with pytest.raises(DesignError, match="takes a wheel of type 'measured'"):
        shape.profile(DEMONSTRATOR, 1.22, kind="measured")


REFUSED = [
    (StandardWheel(radius=0.05, roundness=0.3), "number of rollers; give rollers"),
    (StandardWheel(radius=0.05, rollers=2, roundness=0.3), "at least three"),
    (DualRaceWheel(radius=0.05, rollers=4, roller_radius=0.01, race_spacing=0.03), "at least three"),
    (StandardWheel(radius=0.05, rollers=9, roller_radius=0.01), "give roundness or roller_length"),
    (StandardWheel(radius=0.05, rollers=9), "give roundness or roller_length"),
    (StandardWheel(radius=0.05, rollers=9, roller_shape="cylinder", roller_length=0.01), "give roller_radius"),
    (StandardWheel(radius=0.05, rollers=9, roundness=0.3, roller_angle=1.0), "give roller_radius"),
    (dataclasses.replace(SPHERES, roller_radius=0.0225), "overlap each other, by 10.1 %"),
    (MecanumWheel(radius=0.05, rollers=16, roller_radius=0.01), "overlap"),
    (StandardWheel(radius=0.05, rollers=9, roller_radius=0.01, roller_length=0.033), "overlap"),
    (
        StandardWheel(radius=0.05, rollers=9, roller_radius=0.01, roller_length=0.02, roller_shape="capsule"),
        "overlap",
    ),
    (StandardWheel(radius=0.05, rollers=9, roller_length=0.04), "do not fit around"),
    (StandardWheel(radius=0.05, rollers=9, roller_length=0.2), "does not fit into a wheel"),
    (StandardWheel(radius=0.05, rollers=9, roller_radius=0.002, roller_length=0.03), "come to a point"),
    (MecanumWheel(radius=0.05, rollers=4, roller_radius=0.004), "come to a point before"),
    (StandardWheel(radius=0.05, rollers=4, roller_radius=0.01, roller_shape="sphere"), "down to their axes"),
    (StandardWheel(radius=0.5, rollers=3, roundness=0.9), "falls through"),
]


@pytest.mark.parametrize(("wheel", "rule"), REFUSED, ids=range(len(REFUSED)))
def test_wheels_that_cannot_be_built_are_refused(wheel, rule):
    with pytest.raises(DesignError, match=rule) as error:
        shape.profile(wheel, 0.15)
    assert error.value.key


def test_neighbours_that_just_touch_are_allowed():
    """Spheres one ring apart by two radii, ρ = a sin(π/n): the touching circles of [4.4]."""
    s = math.sin(math.pi / 8)
    touching = dataclasses.replace(SPHERES, roller_radius=0.0759 * s / (1 + s))
    assert shape.profile(touching, 0.15).depth > 0


def test_length_of_a_square_barrel_is_that_of_its_share():
    """Between the end faces a barrel of half share φ/2 measures 2 r_b sin(φ/2), with or without a known cross-section."""
    length = 2 * 0.05 * math.sin(0.7 * math.pi / 9)
    by_roundness = shape.profile(StandardWheel(radius=0.05, rollers=9, roundness=0.3), 0.15)
    for known in ({}, {"roller_radius": 0.005}):
        by_length = shape.profile(StandardWheel(radius=0.05, rollers=9, roller_length=length, **known), 0.15)
        np.testing.assert_allclose(by_length.breakpoints, by_roundness.breakpoints, rtol=1e-13)
        assert by_length.depth == pytest.approx(by_roundness.depth, rel=1e-12)


def test_mecanum_without_length_is_covered_all_around():
    """The default length reaches the valley on flat ground, so no part of the outline lies on a roller's end."""
    wheel = MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01)
    assert shape.roller(wheel, wheel.races(0.15)[0]).half_length == pytest.approx(0.04 * math.tan(math.pi / 9) * math.sqrt(2))
    assert {strip.region for strip in shape.exact_envelope(wheel, 0.15).strips} == {0}
    assert len(shape.exact_envelope(dataclasses.replace(wheel, roller_length=0.03), 0.15).strips) == 3


def test_half_sine_needs_what_the_thesis_gives():
    for wheel, rule in (
        (StandardWheel(radius=0.05, rollers=9, roller_length=0.02), "give roundness"),
        (StandardWheel(radius=0.05, roundness=0.2), "give rollers"),
        (SplitDualRaceWheel(radius=0.05, rollers=18), "standard and mecanum"),
    ):
        with pytest.raises(DesignError, match=rule):
            shape.profile(wheel, 0.15, kind="half-sine")


def test_races_are_asked_for_by_number():
    with pytest.raises(DesignError, match=r"no race 3; its races are \[1, 2\]"):
        shape.profile(SplitDualRaceWheel(radius=0.05, rollers=18), 0.15, race=3)


@pytest.mark.parametrize(
    ("rows", "rule"),
    [
        ([(0, 0.01)], "at least two points"),
        ([(0, 0.01), (0, 0.01)], "must rise"),
        ([(-0.01, 0.01), (0.02, 0.01)], "from the roller's middle"),
        ([(-0.01, 0.01), (0, -0.01), (0.01, 0.01)], "must stay positive"),
        ([(-0.01, 0.01, 1), (0.01, 0.01, 1)], "rows of place and radius"),
        ([(-0.01, 0.06), (0.01, 0.06)], "thicker than the wheel"),
        ([(-0.01, 0.01), (0.01, math.nan)], "all finite"),
    ],
)
def test_roller_profiles_that_are_no_roller_are_refused(rows, rule):
    with pytest.raises(DesignError, match=rule):
        shape.profile(StandardWheel(radius=0.05, rollers=9, roller_radius=0.01), 0.15, roller_profile=rows)


def test_roller_profile_of_a_constant_radius_is_the_cylinder():
    cylinder = StandardWheel(radius=0.05, rollers=9, roller_radius=0.01, roller_shape="cylinder", roller_length=0.018)
    table = shape.profile(cylinder, 0.15, roller_profile=[(-0.009, 0.01), (0.009, 0.01)])
    angle = np.linspace(0, 1, 50)
    np.testing.assert_allclose(table.height(angle), shape.profile(cylinder, 0.15).height(angle), rtol=0, atol=1e-16)


# Measured outlines.


def waves(angle):
    return 0.05 + 1e-4 * np.cos(9 * angle)


def measured(angle, radius):
    return MeasuredWheel(outline=tuple(zip(angle.tolist(), radius.tolist(), strict=True)))


@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("noise", [0.0, 1e-6, 2e-5])
def test_measured_outline_is_followed_and_its_noise_left(noise, uneven):
    rng = np.random.default_rng(3)
    angle = np.linspace(0, 2 * math.pi, 720, endpoint=False)
    if uneven:
        angle = np.sort(angle + rng.uniform(-3e-3, 3e-3, 720)) + 0.5
        angle = angle - angle[0]
    outline = shape.profile(measured(angle, waves(angle) + noise * rng.normal(size=720)), 0.15)
    error = outline.height(angle) + outline.radius - waves(angle)
    # 720 points on some 60 degrees of freedom: noise falls to a third or better; without noise the spline's own error, h⁴.
    assert np.std(error) < 0.5 * noise + 1e-9
    assert outline.kind == "measured" and outline.period == 2 * math.pi and not outline.slope_jumps.any()


def test_measured_outline_without_smoothing_passes_through_its_points():
    angle = np.linspace(0.1, 2 * math.pi + 0.1, 90, endpoint=False)
    wheel = measured(angle, waves(angle))
    outline = shape.profile(wheel, 0.15, smoothing=0)
    np.testing.assert_allclose(outline.height(angle) + wheel.radius, waves(angle), rtol=0, atol=1e-16)
    # Much smoothing leaves the mean alone.
    np.testing.assert_allclose(
        shape.profile(wheel, 0.15, smoothing=1e6).height(angle), waves(angle).mean() - wheel.radius, atol=1e-8
    )
    for bad in (-1.0, math.nan):
        with pytest.raises(SpheredriveError, match="smoothing must be"):
            shape.profile(wheel, 0.15, smoothing=bad)


def test_smoothing_spline_is_the_reference_s_in_the_middle_of_a_long_table():
    """SciPy's natural smoothing spline over three turns agrees with the periodic one in the middle turn."""
    from scipy.interpolate import make_smoothing_spline

    rng = np.random.default_rng(5)
    angle = np.linspace(0, 2 * math.pi, 200, endpoint=False)
    radius = waves(angle) + 1e-5 * rng.normal(size=200)
    wheel = measured(angle, radius)
    turns = np.concatenate([angle - 2 * math.pi, angle, angle + 2 * math.pi])
    reference = make_smoothing_spline(turns, np.tile(radius, 3), lam=1e-5)
    found = shape.profile(wheel, 0.15, smoothing=1e-5)
    dense = np.linspace(0, 6, 500)
    # What the far ends still do here, and the rounding of SciPy's banded solve.
    np.testing.assert_allclose(found.height(dense) + wheel.radius, reference(dense), rtol=0, atol=1e-12)


def test_measured_outline_may_repeat_its_first_row():
    angle = np.linspace(0, 2 * math.pi, 73)
    outline = shape.profile(measured(angle, waves(angle)), 0.15, smoothing=0)
    assert len(outline.coefficients) == 72
    np.testing.assert_allclose(outline.height(angle) + outline.radius, waves(angle), rtol=0, atol=1e-15)


def test_measured_outline_with_a_hole_is_refused():
    angle = np.radians(np.delete(np.arange(0, 360, 5.0), slice(10, 14)))
    with pytest.raises(DesignError, match=r"no point for 25 deg after 45 deg; .* every 20 deg"):
        shape.profile(measured(angle, waves(angle)), 0.15)
    half = np.linspace(0, math.pi, 100)
    with pytest.raises(DesignError, match=r"no point for 180 deg after 180 deg"):
        shape.profile(measured(half, waves(half)), 0.15)


@pytest.mark.parametrize("closed", [False, True])
def test_measured_outline_that_does_not_close_is_refused(closed):
    angle = np.linspace(0, 2 * math.pi, 181, endpoint=closed)
    with pytest.raises(DesignError, match=r"jumps by -0\.\d+ mm at its seam, from 3\d\d(\.\d+)? deg to 0 deg of the next turn"):
        shape.profile(measured(angle, waves(angle) + 1e-4 * angle), 0.15)


def test_constant_measured_outline_is_round():
    angle = np.linspace(0, 2 * math.pi, 36, endpoint=False)
    outline = shape.profile(measured(angle, np.full(36, 0.05)), 0.15)
    assert np.abs(outline.height(angle)).max() < 1e-16 and outline.rolling_radius == pytest.approx(0.05, rel=1e-14)
    path = shape.wander(measured(angle, np.full(36, 0.05)), 0.15, angle)
    assert not path.offset.any() and not path.tilt.any()
