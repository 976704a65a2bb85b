"""What holds for the outline of any wheel: it repeats, its derivatives are derivatives, hands mirror, races take turns."""

import dataclasses
import math

import numpy as np
import pytest

from layouts import random_wheel
from spheredrive import shape
from spheredrive.errors import DesignError
from spheredrive.shape import envelope, kernels
from spheredrive.wheels import DualRaceWheel, MecanumWheel, StandardWheel, TripleRaceWheel

KINDS = ("standard", "mecanum", "dual-race", "split-dual-race", "triple-race")
SHAPES = ("barrel", "cylinder", "sphere", "capsule")
SEEDS = range(4)


def machine(kind, seed):
    """A random wheel that can be built, and a sphere for it: draws are repeated until nothing overlaps or falls through."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    while True:
        wheel = random_wheel(rng, kind)
        wheel = dataclasses.replace(
            wheel,
            roller_shape=str(rng.choice(SHAPES)),
            roller_radius=wheel.radius * rng.uniform(0.1, 0.3),
            roller_length=wheel.radius * rng.uniform(0.2, 0.8),
            phase=rng.uniform(-4, 4),
        )
        sphere_radius = wheel.radius * 10 ** rng.uniform(0, 2)
        try:
            return wheel, sphere_radius, shape.profile(wheel, sphere_radius)
        except DesignError:
            continue


every_wheel = pytest.mark.parametrize(("kind", "seed"), [(kind, seed) for kind in KINDS for seed in SEEDS])


def off_breakpoints(outline, margin, count=200):
    """Random wheel angles at least ``margin`` away from every breakpoint."""
    angle = np.random.default_rng(count).uniform(-10, 10, count)
    place = outline.breakpoints[0] + np.mod(angle + outline.phase - outline.breakpoints[0], outline.period)
    return angle[np.abs(place[:, None] - outline.breakpoints).min(axis=1) > margin]


@every_wheel
def test_outline_repeats_and_its_pieces_meet(kind, seed):
    wheel, _, outline = machine(kind, seed)
    angle = np.linspace(-3, 3, 100)
    # Angles of some radians round at 1e-15, heights follow with slopes below the wheel's radius.
    np.testing.assert_allclose(
        outline.height(angle + 3 * outline.period), outline.height(angle), rtol=0, atol=2e-14 * wheel.radius
    )
    ends = outline.coefficients.sum(axis=1)
    np.testing.assert_allclose(ends, np.roll(outline.coefficients[:, 0], -1), rtol=0, atol=1e-13 * wheel.radius)
    assert outline.period == pytest.approx(2 * math.pi / wheel.rollers_per_race)
    assert 0 <= outline.breakpoints[0] < outline.period
    assert outline.breakpoints[-1] == outline.breakpoints[0] + outline.period and (np.diff(outline.breakpoints) > 0).all()


@every_wheel
def test_slope_and_curvature_are_those_of_the_height(kind, seed):
    """Central differences of order 4 at step 1e-4 and 1e-3 rad: h⁴/30 f⁗′ ~ 1e-13 and rounding 1e-17/1e-4 ~ 1e-12, of the
    wheel's radius and its steepest derivative."""
    wheel, _, outline = machine(kind, seed)
    angle = off_breakpoints(outline, 3e-3)
    h, f = 1e-4, outline.height
    slope = (8 * (f(angle + h) - f(angle - h)) - (f(angle + 2 * h) - f(angle - 2 * h))) / (12 * h)
    scale = max(1.0, np.abs(outline.extremes(2)).max() / wheel.radius) * wheel.radius
    np.testing.assert_allclose(outline.slope(angle), slope, rtol=0, atol=1e-10 * scale)
    h, f = 1e-3, outline.slope
    curvature = (8 * (f(angle + h) - f(angle - h)) - (f(angle + 2 * h) - f(angle - 2 * h))) / (12 * h)
    np.testing.assert_allclose(outline.curvature(angle), curvature, rtol=0, atol=1e-8 * scale)


@every_wheel
def test_polynomials_are_the_geometry_s_heights_slopes_and_curvatures(kind, seed):
    wheel, sphere_radius, outline = machine(kind, seed)
    geometry = shape.exact_envelope(wheel, sphere_radius)
    angle = off_breakpoints(outline, 1e-6)
    numbers, folded = geometry.strip_numbers(angle + wheel.phase)
    for j, strip in enumerate(geometry.strips):
        here = numbers == j
        rows = geometry.outline(strip, folded[here])
        # Where on the roller contact is was decided once for the strip; asked anew, it is the same.
        fresh = np.empty_like(rows)
        kernels.outline(
            folded[here] - strip.centre, kernels.DECIDE, geometry.bodies[strip.rank], geometry.knots, geometry.table, fresh
        )
        np.testing.assert_allclose(rows[:, :3], fresh[:, :3], rtol=0, atol=1e-9 * wheel.radius)
        scale = max(wheel.radius, np.abs(outline.extremes(2)).max())
        for order, found in enumerate((outline.height, outline.slope, outline.curvature)):
            expected = rows[:, order] - (geometry.nominal if order == 0 else 0)
            np.testing.assert_allclose(found(angle[here]), expected, rtol=0, atol=1e-12 * scale)


@every_wheel
def test_no_roller_stands_above_the_outline(kind, seed):
    """Every roller of every race, all around: the outline is the upper envelope, and one of them carries it."""
    wheel, sphere_radius, outline = machine(kind, seed)
    geometry = shape.exact_envelope(wheel, sphere_radius)
    angle = np.linspace(0, outline.period, 301)
    centres = {strip.rank: strip.centre for strip in geometry.strips}
    best = np.full(angle.shape, -np.inf)
    for rank, centre in centres.items():
        for j in range(-3, 4):
            beta = angle + wheel.phase - centre - j * outline.period
            beta -= round(float(np.mean(beta)) / outline.period) * outline.period - j * outline.period
            near = np.abs(beta) < min(1.5, 1.2 * outline.period)
            rows = np.full((len(beta), 7), -np.inf)
            found = np.empty((int(near.sum()), 7))
            kernels.outline(beta[near], kernels.DECIDE, geometry.bodies[rank], geometry.knots, geometry.table, found)
            rows[near] = found
            best = np.maximum(best, rows[:, kernels.HEIGHT])
    np.testing.assert_allclose(outline.height(angle), best - geometry.nominal, rtol=0, atol=1e-12 * wheel.radius)


@every_wheel
def test_slope_jumps_are_the_differences_across_corners(kind, seed):
    """Differences of three points on one side each, none on the corner itself: error 11/6 h² f‴, and rounding 1e-17/h."""
    wheel, _, outline = machine(kind, seed)
    h, b = 1e-5, outline.breakpoints[:-1] - outline.phase
    after, before = (
        sign * (-5 * outline.height(b + sign * h) + 8 * outline.height(b + 2 * sign * h) - 3 * outline.height(b + 3 * sign * h))
        for sign in (1, -1)
    )
    scale = max(wheel.radius, np.abs(outline.extremes(2)).max())
    np.testing.assert_allclose(outline.slope_jumps, (after - before) / (2 * h), rtol=0, atol=1e-8 * scale)
    # An upper envelope turns upwards where rollers change; on a roller it is smooth.
    assert (outline.slope_jumps >= 0).all() and (outline.slope_jumps > 0).any()


@every_wheel
def test_the_other_hand_mirrors_the_wander_and_keeps_the_height(kind, seed):
    wheel, sphere_radius, outline = machine(kind, seed)
    other = dataclasses.replace(wheel, roller_angle=-wheel.roller_angle)
    angle = off_breakpoints(outline, 1e-6)
    here, there = shape.wander(wheel, sphere_radius, angle), shape.wander(other, sphere_radius, angle)
    np.testing.assert_allclose(here.tilt, np.arcsin(here.offset / sphere_radius), atol=1e-15)
    np.testing.assert_allclose(np.tan(here.lean), -outline.slope(angle) / centre_distance(outline, angle), atol=1e-10)
    if len(wheel.alternation) == 1 or kind == "split-dual-race":
        # D comes by another path of roundings; a place on the axis is known to the root of a height's.
        np.testing.assert_allclose(shape.profile(other, sphere_radius).height(angle), outline.height(angle), atol=1e-14)
        np.testing.assert_allclose(there.offset, -here.offset, rtol=0, atol=1e-9 * wheel.radius)


def centre_distance(outline, angle):
    piece = outline.piece(angle)
    return outline.sphere_lever[piece] + outline.wheel_lever[piece] + outline.height(angle)


@pytest.mark.parametrize("alpha", [math.pi / 2, 1.1, -0.8])
@pytest.mark.parametrize("roller_shape", ["barrel", "sphere", "capsule"])
def test_races_take_over_where_the_kinematics_say(alpha, roller_shape):
    """Dual race: floor(N (ϑ + phase)/π) even for race 1, found here by the heights alone. 1e-9 rad: Newton's step on two
    heights of 1e-17 m that part by 1e-8 m/rad at least."""
    wheel = DualRaceWheel(
        radius=0.04,
        rollers=14,
        roller_radius=0.006,
        race_spacing=0.018,
        roller_angle=alpha,
        roller_shape=roller_shape,
        roller_length=0.012,
        phase=0.3,
    )
    geometry = shape.exact_envelope(wheel, 0.15)
    starts = np.array([s.start for s, before in pairs(geometry.strips) if s.rank != before.rank])
    np.testing.assert_allclose(np.mod(starts + 1, wheel.half_pitch), np.mod(1, wheel.half_pitch), rtol=0, atol=1e-9)
    angle = np.linspace(0, 3, 331)
    expected = np.array(wheel.alternation)[wheel.state_index(angle), 0]
    np.testing.assert_array_equal(shape.wander(wheel, 0.15, angle).race, expected)


def pairs(strips):
    return zip(strips, [strips[-1], *strips[:-1]], strict=True)


@pytest.mark.parametrize("seed", range(6))
def test_a_coarse_search_finds_the_rollers_in_between(seed, monkeypatch):
    """Rollers that hold the sphere for less than a step of the search show up above the takeover of their neighbours."""
    wheel, sphere_radius, _ = machine("dual-race", seed)
    fine = envelope.envelope(wheel, sphere_radius)
    monkeypatch.setattr(envelope, "SEARCH", 1)
    coarse = envelope.envelope(wheel, sphere_radius)
    assert [strip.rank for strip in coarse.strips] == [strip.rank for strip in fine.strips]
    np.testing.assert_allclose([strip.start for strip in coarse.strips], [strip.start for strip in fine.strips], atol=1e-9)


def test_long_straight_rollers_hold_the_sphere_with_their_ends_out_of_turn():
    """Tilted cylinders longer than their share are thickest around the wheel at their ends: |p(L)| > a. On a flat the end of
    one roller stands above the middle of its neighbour, and the corner is where those two ends change."""
    wheel = StandardWheel(
        radius=0.05, rollers=9, roller_radius=0.01, roller_shape="capsule", roller_length=0.06, roller_angle=1.2
    )
    outline = shape.profile(wheel, 10.0)
    assert outline.extremes(0)[1] > 1e-3
    assert (outline.slope_jumps >= 0).all() and (outline.slope_jumps > 0).any()


def test_races_of_a_triple_wheel_take_over_near_the_half_pitch():
    """The outer races are level at their tops only and fall away from there, so the centre race keeps the sphere a little
    longer than half a pitch: by about 1 % of the pitch on the package's example wheel."""
    wheel = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4.85e-3, race_spacing=12.5e-3)
    outline, geometry = shape.profile(wheel, 0.15), shape.exact_envelope(wheel, 0.15)
    starts = np.array([s.start for s, before in pairs(geometry.strips) if s.rank != before.rank])
    off = np.mod(starts + wheel.half_pitch / 2, wheel.half_pitch) - wheel.half_pitch / 2
    assert len(starts) == 2 and (np.abs(off) < 0.015 * outline.period).all()
    # Level at the tops: the outer roller's middle stands at three quarters of the pitch.
    assert outline.height(0.75 * outline.period) == pytest.approx(0, abs=1e-15)
    assert outline.height(0.25 * outline.period) == pytest.approx(0, abs=1e-15)
    assert shape.wander(wheel, 0.15, 0.75 * outline.period).tilt == pytest.approx(
        -math.asin(0.0125 / (0.15 + 4.85e-3)), abs=1e-12
    )


def test_tops_and_valleys_stand_where_the_thesis_has_them():
    standard = StandardWheel(radius=0.05, rollers=9, roundness=0.3)
    outline = shape.profile(standard, 0.15)
    gap = 0.3 * outline.period
    assert outline.breakpoints[0] == pytest.approx(gap / 2, rel=1e-15)
    assert -outline.height(gap / 2) == pytest.approx(outline.depth, rel=1e-14)
    np.testing.assert_allclose(outline.height(np.linspace(gap, outline.period, 20)), 0, atol=1e-16)
    mecanum = shape.profile(MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01), 0.15)
    assert mecanum.height(0.0) == pytest.approx(0, abs=1e-16) and mecanum.slope(0.0) == pytest.approx(0, abs=1e-16)
    assert mecanum.breakpoints[0] == pytest.approx(math.pi / 9, rel=1e-15)
    turned = shape.profile(MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01, phase=0.2), 0.15)
    assert turned.height(-0.2) == pytest.approx(0, abs=1e-16) and turned.height(0.0) == mecanum.height(0.2)


@pytest.mark.parametrize("alpha", [math.pi / 2, 0.7])
def test_spheres_have_no_direction(alpha):
    """Spherical rollers hold the sphere alike whichever way their axes stand."""
    wheel = StandardWheel(radius=0.05, rollers=9, roller_radius=0.011, roller_shape="sphere", roller_angle=alpha)
    square = dataclasses.replace(wheel, roller_angle=math.pi / 2)
    angle = np.linspace(0, 1, 50)
    np.testing.assert_array_equal(shape.profile(wheel, 0.15).height(angle), shape.profile(square, 0.15).height(angle))
    assert not shape.wander(wheel, 0.15, angle).offset.any()
