"""Outlines of wheels against closed forms, printed numbers and a program that knows rollers only as points of their surface.

EXACT = 1e-14 m: a few roundings (1.1e-16) of lengths below 0.1 m times the tens of operations of both sides.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from spheredrive import shape
from spheredrive.wheels import (
    DualRaceWheel,
    IdealWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
    TripleRaceWheel,
)

EXACT = 1e-14
R = 1.22
DEMONSTRATOR = StandardWheel(radius=75.8e-3, rollers=14, roundness=0.4485)
BARRELS = MecanumWheel(radius=75.8e-3, rollers=16, roller_radius=12.37e-3)
POLYGON = StandardWheel(radius=75.9e-3, rollers=8, roller_radius=16.5e-3, roller_shape="sphere")


# Printed numbers.


def test_roller_polygon_on_a_flat():
    """cases.md: 8 spheres of radius 16.5 mm on 59.4 mm, 71.378 … 75.900 mm; printed to half a micrometre.

    A sphere of R = 1e9 m stands for the flat: the valley differs by chord²/(2 R) = 3e-13 m.
    """
    flat = shape.profile(POLYGON, 1e9)
    low, high = flat.extremes(0)
    assert flat.radius + low == pytest.approx(71.378e-3, abs=0.5e-6)
    assert flat.radius + high == pytest.approx(75.900e-3, abs=EXACT)
    assert flat.radius + low == pytest.approx(59.4e-3 * math.cos(math.pi / 8) + 16.5e-3, abs=1e-12)
    assert flat.period == pytest.approx(2 * math.pi / 8, rel=1e-15)


def test_demonstrator_depth_is_the_thesis_s():
    """0.407 mm [section 6]; [3.6] itself in the middle of the gap, at ψ = θ_s/2."""
    outline = shape.profile(DEMONSTRATOR, R)
    gap = 0.4485 * 2 * math.pi / 14
    theta_R = 2 * math.asin(0.0758 / R * math.sin(gap / 2))
    depth = R * (1 - math.cos(theta_R / 2)) + 0.0758 * (1 - math.cos(gap / 2))
    assert outline.depth == pytest.approx(0.407e-3, abs=0.5e-6)
    # R (1 − cos) rounds at 1e-16 R.
    assert -outline.height(gap / 2) == pytest.approx(depth, abs=1e-15)
    assert outline.depth == pytest.approx(depth, abs=1e-15)
    assert shape.gap_depth(0.0758, R, gap) == pytest.approx(depth, abs=1e-15)


def test_barrel_mecanum_of_the_demonstrator_s_size():
    """Page: 0.0616 mm. The page's own formula, sampled below, gives 0.06146 mm for its 12.37 mm (0.0616 for 12.30 mm)."""
    outline = shape.profile(BARRELS, R)
    assert outline.depth == pytest.approx(0.0616e-3, rel=3e-3)
    a, S = 75.8e-3 - 12.37e-3, math.sqrt(0.5)
    s, beta = np.linspace(-0.018, -0.016, 200_001), math.pi / 16
    rho = 75.8e-3 - np.sqrt(a * a + s * s / 2)
    x = a * math.cos(beta) - s * S * math.sin(beta)
    y, z = a * math.sin(beta) + s * S * math.cos(beta), s * S
    sampled = R + 75.8e-3 - (x + np.sqrt((R + rho) ** 2 - y * y - z * z)).max()
    # Samples 1e-8 m apart miss the top by 1e-16 × curvature ~ 20/m.
    assert outline.depth == pytest.approx(sampled, abs=1e-14)


def test_contact_wanders_by_the_page_s_angle():
    """R = 150, r_b = 50, r_r = 10 mm, 9 rollers at 45°: 4.3° to either side, most in the valley."""
    wheel = MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01)
    found = shape.wander(wheel, 0.15, np.linspace(-1, 1, 100) * (math.pi / 9 - 1e-9))
    assert math.degrees(found.tilt.max()) == pytest.approx(4.3, abs=0.05)
    # The sphere's contact wanders towards ŵ while the roller comes, β < 0, for the positive hand: s > 0 there.
    assert found.tilt[0] == found.tilt.max() and found.tilt[-1] == pytest.approx(-found.tilt[0], rel=1e-12)


# Closed forms.


@pytest.mark.parametrize("radius", [0.1, 1.0, 50.0])
def test_gap_of_a_standard_wheel_is_the_edge_s_arc(radius):
    """D = r_b cos β + √(R² − r_b² sin² β) with β counted from the nearer edge, at ψ = 0 and ψ = θ_s; zero on the rollers."""
    outline = shape.profile(DEMONSTRATOR, radius)
    gap, r_b = 0.4485 * outline.period, 0.0758
    psi = np.linspace(0, outline.period, 301)
    beta = np.where(psi < gap, np.minimum(psi, gap - psi), 0)
    D = r_b * np.cos(beta) + np.sqrt(radius**2 - (r_b * np.sin(beta)) ** 2)
    np.testing.assert_allclose(outline.height(psi), D - radius - r_b, rtol=0, atol=4e-16 * (1 + radius))


def test_cross_section_of_square_barrels_does_not_matter():
    thick = dataclasses.replace(DEMONSTRATOR, roller_radius=5e-3)
    psi = np.linspace(0, 1, 57)
    np.testing.assert_allclose(
        shape.profile(thick, R).height(psi), shape.profile(DEMONSTRATOR, R).height(psi), rtol=0, atol=EXACT
    )


@pytest.mark.parametrize("radius", [0.06, 0.15, 1.22, 1e4])
def test_spheres_follow_their_closed_form(radius):
    """D = a cos β + √((R + ρ)² − a² sin² β), rollers at ψ = 0; valley and mean rolling radius of section 3."""
    outline = shape.profile(POLYGON, radius)
    beta = np.linspace(-math.pi / 8, math.pi / 8, 201)
    D = 59.4e-3 * np.cos(beta) + np.sqrt((radius + 16.5e-3) ** 2 - (59.4e-3 * np.sin(beta)) ** 2)
    np.testing.assert_allclose(outline.height(beta), D - radius - 75.9e-3, rtol=0, atol=4e-16 * (1 + radius))
    valley = shape.valley_of_spheres(59.4e-3, 16.5e-3, radius, 8)
    assert outline.height(math.pi / 8) + outline.radius == pytest.approx(valley, abs=EXACT)
    assert outline.rolling_radius == pytest.approx(shape.rolling_radius_of_spheres(59.4e-3, 16.5e-3, radius, 8), abs=EXACT)


def test_rolling_radius_of_spheres_on_a_flat_is_the_polygon_s():
    """On a flat the centre rolls over the corners of a polygon of perimeter 2 n a sin(π/n), and around each by 2π/n on ρ."""
    limit = shape.rolling_radius_of_spheres(59.4e-3, 16.5e-3, math.inf, 8)
    assert limit == pytest.approx((8 * 2 * 59.4e-3 * math.sin(math.pi / 8) + 2 * math.pi * 16.5e-3) / (2 * math.pi), abs=EXACT)
    assert shape.rolling_radius_of_spheres(59.4e-3, 16.5e-3, 1e6, 8) == pytest.approx(limit, abs=1e-12)
    assert shape.valley_of_spheres(59.4e-3, 16.5e-3, math.inf, 8) == pytest.approx(71.378e-3, abs=0.5e-6)


@pytest.mark.parametrize("roundness", [0.05, 0.4485, 0.9])
def test_rolling_radius_of_barrels_with_gaps(roundness):
    wheel = dataclasses.replace(DEMONSTRATOR, roundness=roundness)
    outline = shape.profile(wheel, R)
    gap = roundness * outline.period
    theta_R = 2 * math.asin(0.0758 / R * math.sin(gap / 2))
    closed = 14 / (2 * math.pi) * (0.0758 * (outline.period - gap) + R * theta_R)
    # Gauss's rule of 16 points on the 12th-degree pieces is exact to rounding.
    assert outline.rolling_radius == pytest.approx(closed, abs=EXACT)
    assert shape.rolling_radius_with_gaps(0.0758, R, 14, gap) == pytest.approx(closed, abs=1e-15)


def test_rolling_radius_is_the_path_of_the_centre():
    """Chords of the path of the sphere's centre around the wheel, R + r_eff their length over 2π; no derivative is used.

    1e5 chords a pitch of a path of curvature ~ 1 fall short by (Δψ)²/24 relative: 1e-12.
    """
    wheel = MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01)
    outline = shape.profile(wheel, 0.15)
    psi = np.linspace(math.pi / 9, math.pi / 3, 100_001)
    D = 0.15 + 0.05 + outline.height(psi)
    length = np.hypot(np.diff(D * np.cos(psi)), np.diff(D * np.sin(psi))).sum()
    assert length / outline.period - 0.15 == pytest.approx(outline.rolling_radius, abs=1e-12)
    assert shape.rolling_radius(outline, psi).mean() == pytest.approx(outline.rolling_radius, abs=1e-7)


def test_races_beside_the_middle_roll_on_their_exact_lever():
    """Dual race with rollers just long enough: h ≈ 0, and r_eff is the page's r − r_r (1 − cos Δθ)."""
    wheel = DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3)
    cosine = math.sqrt(1 - (6.25e-3 / (0.15 + 4.85e-3)) ** 2)
    outline = shape.profile(wheel, 0.15)
    assert outline.wheel_lever == pytest.approx(0.025 - 4.85e-3 * (1 - cosine), abs=EXACT)
    # Off its middle a barrel beside the wheel's middle falls away, by 0.3 µm at most.
    assert outline.depth < 0.4e-6
    assert outline.rolling_radius == pytest.approx(0.025 - 4.85e-3 * (1 - cosine), abs=outline.depth)


# The half sine.


def test_half_sine_of_the_demonstrator():
    """r_b − Δr sin(n_r ψ/(2η)) in the gap, which comes first; r_b on the roller [3.8, 3.11]."""
    outline = shape.profile(DEMONSTRATOR, R, kind="half-sine")
    pitch = 2 * math.pi / 14
    psi = np.linspace(-pitch, pitch, 401)
    local = psi % pitch
    depth = shape.gap_depth(0.0758, R, 0.4485 * pitch)
    expected = np.where(local < 0.4485 * pitch, -depth * np.sin(14 * local / (2 * 0.4485)), 0.0)
    np.testing.assert_allclose(outline.height(psi), expected, rtol=0, atol=1e-17)
    k = math.pi / (0.4485 * pitch)
    corners = outline.slope_jumps[outline.slope_jumps != 0]
    np.testing.assert_allclose(corners, [-depth * k, -depth * k], rtol=1e-13)


def test_half_sine_of_a_mecanum_wheel_and_its_harmonics():
    """−Δr |sin(n_r ϑ/2)| = −Δr (2/π − (4/π) Σ cos(k n_r ϑ)/(4k² − 1)); Δr of the touching circles [4.4–4.6]."""
    wheel = dataclasses.replace(BARRELS, profile="half-sine")
    outline = shape.profile(wheel, R)
    depth = R + 12.37e-3 - math.sqrt(R * (R + 2 * 12.37e-3))
    assert outline.kind == "half-sine"
    assert outline.depth == pytest.approx(depth, abs=5e-16)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    angle = outline.period * (nodes + 1) / 2
    for k in range(6):
        found = np.sum(weights * outline.height(angle) * np.cos(16 * k * angle)) / (1 if k else 2)
        expected = -depth * 2 / math.pi if k == 0 else depth * 4 / math.pi / (4 * k * k - 1)
        # The depth above is the difference of two lengths of 1.2 m: 2e-16 m.
        assert found == pytest.approx(expected, abs=3e-16)
    assert outline.slope_jumps[0] == pytest.approx(-16 * depth, rel=1e-12)


def test_excitation_is_the_half_sine_s():
    """Displacement Δr, velocity Δr n ω/2, acceleration Δr (n ω/2)², one corner of −Δr n ω a roller."""
    outline = shape.profile(BARRELS, R, kind="half-sine")
    found = shape.excitation(outline, np.array([3.0, -2.0]))
    k = 8 * np.array([3.0, 2.0])
    np.testing.assert_allclose(found.velocity, outline.depth * k, rtol=1e-12)
    np.testing.assert_allclose(found.acceleration, outline.depth * k**2, rtol=1e-12)
    np.testing.assert_allclose(found.impulses, -2 * outline.depth * k[:, None], rtol=1e-12)


# A program that knows a roller only as points of its surface: turned about its axis, placed in the wheel, and each point an
# obstacle from which the sphere's centre, on the x axis, keeps the distance R.


def barrel_section(wheel_radius, a, alpha, x):
    """Radius at x of the largest body of revolution about the roller's axis inside the wheel's cylinder: the least way from
    the axis to the cylinder, square to the axis, over all directions."""
    S, C = math.sin(alpha), math.cos(alpha)
    middle, half = np.zeros_like(x), math.pi
    for _ in range(14):
        phi = middle[:, None] + half * np.linspace(-1, 1, 61)
        c, s = np.cos(phi), np.sin(phi)
        A, B = c * c + (C * s) ** 2, a * c + (x * S)[:, None] * C * s
        way = (-B + np.sqrt(B * B - A * (a * a + (x * S)[:, None] ** 2 - wheel_radius**2))) / A
        best = np.argmin(way, axis=1)
        middle, half = np.take_along_axis(phi, best[:, None], 1)[:, 0], half / 20
    return way.min(axis=1)


def surface(wheel, race, half_length):
    """A function from rows (x, φ) in [−1, 1] × angle to the points of a roller in its own frame, axis along the first."""
    a = race.radius - race.roller_radius

    def points(x, phi):
        along = x * half_length
        if wheel.roller_shape == "barrel":
            if abs(math.cos(wheel.roller_angle)) < 1e-12:
                radius = np.sqrt(race.radius**2 - along**2) - a
            else:
                # Rows of the grid stand at one x each.
                radius = barrel_section(race.radius, a, wheel.roller_angle, along[:, 0])[:, None] + 0 * phi
        elif wheel.roller_shape == "cylinder":
            radius = np.full_like(along, race.roller_radius)
        elif half_length == 0:
            along, radius = race.roller_radius * np.sin(x * math.pi / 2), race.roller_radius * np.cos(x * math.pi / 2)
        else:
            # x runs over the round ends too: their angle from the axis is the excess over one.
            r = race.roller_radius
            turn = np.clip(np.abs(x) - 1, 0, 1) * math.pi / 2
            along = np.sign(x) * (half_length * np.minimum(np.abs(x), 1) + r * np.sin(turn))
            radius = r * np.cos(turn)
        return np.stack([along, radius * np.cos(phi), radius * np.sin(phi)])

    return points


def brute_distance(wheel, sphere_radius, race, beta, half_length):
    """D over one roller at β and the touched point: the highest of its surface points, by a grid drawn together nine times."""
    S, C = math.sin(wheel.roller_angle), math.cos(wheel.roller_angle)
    a = race.radius - race.roller_radius
    turn = np.array([[math.cos(beta), -math.sin(beta), 0], [math.sin(beta), math.cos(beta), 0], [0, 0, 1]])
    # Columns: the roller's axis, the outward radius of the wheel, and what completes them.
    frame = turn @ np.array([[0, 1, 0], [S, 0, -C], [C, 0, S]])
    middle = turn @ np.array([a, 0, 0]) + np.array([0, 0, race.offset])
    ends = 2.0 if wheel.roller_shape == "capsule" else 1.0
    points = surface(wheel, race, half_length)
    centre, span = np.array([0.0, 0.0]), np.array([ends, math.pi / 2])
    for _ in range(9):
        x = np.clip(centre[0] + span[0] * np.linspace(-1, 1, 41), -ends, ends)
        phi = centre[1] + span[1] * np.linspace(-1, 1, 41)
        x_grid, phi_grid = np.meshgrid(x, phi, indexing="ij")
        q = np.tensordot(frame, points(x_grid, phi_grid), 1) + middle[:, None, None]
        room = sphere_radius**2 - q[1] ** 2 - q[2] ** 2
        D = np.where(room > 0, q[0] + np.sqrt(np.maximum(room, 0)), -np.inf)
        i, j = np.unravel_index(np.argmax(D), D.shape)
        centre, span = np.array([x[i], phi[j]]), span / 8
    return D[i, j], q[:, i, j]


def barrel_ends(wheel):
    return wheel.roller_length / 2 if wheel.roller_length else 0.0


def wheels():
    tilted = dict(radius=0.05, rollers=9, roller_radius=0.01)
    races = dict(radius=0.04, roller_radius=0.007, race_spacing=0.018, roller_length=0.014)
    return {
        "barrel": StandardWheel(radius=0.05, rollers=9, roller_radius=0.012, roller_length=0.018),
        "barrel-off-square": StandardWheel(radius=0.05, rollers=9, roller_radius=0.009, roller_length=0.021, roller_angle=-1.2),
        "cylinder": StandardWheel(radius=0.05, rollers=9, roller_radius=0.012, roller_length=0.018, roller_shape="cylinder"),
        "capsule": StandardWheel(radius=0.05, rollers=9, roller_radius=0.01, roller_length=0.005, roller_shape="capsule"),
        "sphere": StandardWheel(radius=0.05, rollers=9, roller_radius=0.011, roller_shape="sphere"),
        "mecanum": MecanumWheel(**tilted, roller_length=0.05),
        "mecanum-other-hand": MecanumWheel(**tilted, roller_length=0.05, roller_angle=-0.6),
        "mecanum-short": MecanumWheel(**tilted, roller_length=0.028),
        "mecanum-cylinder": MecanumWheel(**tilted, roller_length=0.02, roller_shape="cylinder"),
        "mecanum-capsule": MecanumWheel(**tilted, roller_length=0.02, roller_shape="capsule"),
        "dual": DualRaceWheel(**races, rollers=14),
        "dual-tilted": DualRaceWheel(**races, rollers=14, roller_angle=1.1),
        "dual-spheres": DualRaceWheel(**races, rollers=14, roller_shape="sphere"),
        "triple": TripleRaceWheel(**races, rollers=21),
        "triple-tilted": TripleRaceWheel(**races, rollers=21, roller_angle=-1.0),
        "split": SplitDualRaceWheel(radius=0.04, rollers=14, roller_radius=0.007, roller_length=0.014),
    }


# 1e-10 m: the last grid is 1/8⁸ of the body wide, 1e-9 m for x and 1e-7 rad for φ, so the top of a curved surface is met to
# far less; on an edge or a point of the table's first order, by 1e-9 m × a slope below 0.1.
BRUTE = 1e-10


@pytest.mark.parametrize("name", wheels())
def test_outline_is_that_of_the_surface_s_points(name):
    wheel = dataclasses.replace(wheels()[name], phase=0.1)
    sphere_radius = 0.15
    outline = shape.profile(wheel, sphere_radius)
    races = [race for race in wheel.races(sphere_radius) if not race.antipodal]
    pitch = 2 * math.pi / wheel.rollers_per_race
    nominal = min(races, key=lambda race: abs(race.offset))
    D_nominal = (sphere_radius + nominal.roller_radius) * math.cos(nominal.deflection(sphere_radius))
    D_nominal += nominal.radius - nominal.roller_radius
    half = 0.0 if wheel.roller_shape == "sphere" else barrel_ends(wheel)
    for angle in np.random.default_rng(7).uniform(-1, 1, 6):
        found = []
        for race in races:
            middle = roller_middle(wheel, race, pitch, sphere_radius)
            for j in range(-1, 2):
                beta = (angle + 0.1 - middle) - pitch * (round((angle + 0.1 - middle) / pitch) + j)
                found.append((*brute_distance(wheel, sphere_radius, race, beta, half), race.number))
        D, point, race_number = max(found, key=lambda entry: entry[0])
        assert outline.height(angle) == pytest.approx(D - D_nominal, abs=BRUTE)
        path = shape.wander(wheel, sphere_radius, angle)
        # The place of a flat top is known to the root of its height's error only.
        assert path.offset == pytest.approx(point[2], abs=3e-6)
        assert math.tan(path.lean) == pytest.approx(point[1] / (D - point[0]), abs=3e-5)
        if len(races) < 3 or "tilted" in name or race_number == 2:
            assert path.race == race_number


def roller_middle(wheel, race, pitch, sphere_radius):
    """Where a roller's middle stands, by the conventions of the page: from the gap's or the race's place, not from our code."""
    if isinstance(wheel, MecanumWheel):
        return 0.0
    if not isinstance(wheel, StandardWheel):
        turn = {1: 0, 2: 1} if len(wheel.races(sphere_radius)) == 2 else {2: 0, 1: 1, 3: 1}
        return (turn[race.number] + 0.5) * pitch / 2
    # θ_b/2: where contact leaves the roller's side, from the least angle at which the surface's end is the point touched.
    if wheel.roller_shape == "sphere":
        return 0.0
    half = wheel.roller_length / 2
    if wheel.roller_shape == "barrel" and wheel.roller_angle == math.pi / 2:
        return pitch - math.asin(half / wheel.radius)
    a, r = wheel.radius - wheel.roller_radius, wheel.roller_radius
    if wheel.roller_shape in ("cylinder", "capsule"):
        # The sphere's centre stands square over the end's place on the axis: at distances a + R + r and L from the middle.
        return pitch - math.atan(half / (a + sphere_radius + r))
    # The highest place passes 1 − δ/2 where D is equal at 1 − δ and 1; two δ lead to δ = 0, but for δ² ~ 1e-9 rad.
    passed = [brentq(lambda beta, d=d: end_margin(wheel, sphere_radius, race, beta, half, d), 1e-3, pitch / 2) for d in DELTAS]
    return pitch - (2 * passed[0] - passed[1])


DELTAS = (2e-5, 4e-5)


def end_margin(wheel, sphere_radius, race, beta, half, delta):
    """Positive where the end of the roller is higher than the place δ within it."""
    inside = brute_distance_at(wheel, sphere_radius, race, beta, half, 1 - delta)
    return brute_distance_at(wheel, sphere_radius, race, beta, half, 1.0) - inside


def brute_distance_at(wheel, sphere_radius, race, beta, half, place):
    """D over the better of the two circles at x = ± ``place`` of the half length."""
    S, C = math.sin(wheel.roller_angle), math.cos(wheel.roller_angle)
    a = race.radius - race.roller_radius
    turn = np.array([[math.cos(beta), -math.sin(beta), 0], [math.sin(beta), math.cos(beta), 0], [0, 0, 1]])
    frame = turn @ np.array([[0, 1, 0], [S, 0, -C], [C, 0, S]])
    best = -np.inf
    for side in (-1, 1):
        x = np.array([side * place * half])
        radius = barrel_section(race.radius, a, wheel.roller_angle, x)[0]
        middle, span = 0.0, math.pi / 2
        for _ in range(9):
            phi = middle + span * np.linspace(-1, 1, 81)
            q = frame @ np.stack([np.full_like(phi, x[0]), radius * np.cos(phi), radius * np.sin(phi)])
            q += (turn @ np.array([a, 0, 0]))[:, None]
            D = q[0] + np.sqrt(sphere_radius**2 - q[1] ** 2 - q[2] ** 2)
            middle, span = phi[np.argmax(D)], span / 10
        best = max(best, D.max())
    return best


def test_races_of_a_split_wheel_are_half_a_pitch_apart():
    wheel = wheels()["split"]
    one, two = (shape.profile(wheel, 0.15, race=number) for number in (1, 2))
    angle = np.linspace(0, 2, 77)
    np.testing.assert_allclose(two.height(angle), one.height(angle - math.pi / 7), rtol=0, atol=EXACT)
    assert shape.profile(wheel, 0.15).height(0.3) == one.height(0.3)


def test_round_wheels_do_not_excite():
    for wheel in (IdealWheel(radius=0.05), StandardWheel(radius=0.05, rollers=9, roundness=0.0)):
        outline = shape.profile(wheel, R)
        assert outline.kind == "round" and outline.depth == 0
        assert outline.rolling_radius == pytest.approx(0.05, rel=1e-15)
        assert not outline.height(np.linspace(0, 9, 5)).any() and not outline.slope_jumps.any()


@pytest.mark.parametrize("name", ["mecanum", "dual-tilted"])
def test_uneven_roller_with_the_generatrix_of_a_barrel_is_the_barrel(name):
    """A table of the barrel's own ρ(s): the not-a-knot spline of 41 points is off by 5/384 h⁴ ρ⁗ ~ 1e-11 m inside and
    ten times that at its ends, where its slope moves the edge."""
    wheel = wheels()[name]
    body = shape.roller(wheel, wheel.races(0.15)[0])
    s = np.linspace(-body.half_length, body.half_length, 41)
    table = np.stack([s, wheel.radius - np.hypot(body.axis_distance, s * math.sin(wheel.roller_angle))], axis=1)
    angle = np.linspace(0, 1, 60)
    spline = shape.profile(wheel, 0.15, roller_profile=table)
    np.testing.assert_allclose(spline.height(angle), shape.profile(wheel, 0.15).height(angle), rtol=0, atol=1e-9)


def test_cone_holds_the_sphere_as_its_own_line_does():
    """Conical rollers square across the wheel: D to the surface's points, two cones ρ = 10 mm ± s/10."""
    wheel = StandardWheel(radius=0.05, rollers=9, roller_radius=0.01)
    L, k = 0.009, 0.1
    outline = shape.profile(wheel, 0.15, roller_profile=[(-L, 0.01 - k * L), (L, 0.01 + k * L)])
    # The meridian line that envelops the balls lies at slope k/√(1 − k²), at distance ρ from p(s); all in the wheel's plane.
    n = np.array([-k, math.sqrt(1 - k * k)])
    s = np.linspace(-L, L, 400_001)
    along, out = s + (0.01 + k * s) * n[0], (0.01 + k * s) * n[1]
    top = outline.breakpoints[0] + 0.3 * outline.period
    angle = np.linspace(0, outline.period, 9) + top
    rows = []
    for middle in np.arange(-2, 3) * outline.period:
        centre = shape.exact_envelope(wheel, 0.15, None, ((-L, 0.01 - k * L), (L, 0.01 + k * L))).strips[0].centre
        beta = angle[:, None] - centre - middle
        x = (0.04 + out) * np.cos(beta) - along * np.sin(beta)
        y = (0.04 + out) * np.sin(beta) + along * np.cos(beta)
        rows.append((x + np.sqrt(np.maximum(0.15**2 - y * y, 0))).max(axis=1))
    expected = np.max(rows, axis=0) - 0.2
    # Samples 4.5e-8 m apart: (2e-8)² × curvature ~ 30/m; nearest to an edge by 4.5e-8 × slope, so edges are sampled themselves.
    np.testing.assert_allclose(outline.height(angle), expected, rtol=0, atol=1e-13)
