"""One asymmetric machine with most wheel types at once: every convention of sign and side, from formulas written out here.

Nothing is expected of the package's own formulas: directions are spelled out in azimuth φ, elevation ε and heading χ,

    R̂ = (cos φ cos ε, sin φ cos ε, sin ε),  east e = (−sin φ, cos φ, 0),  north n = (−cos φ sin ε, −sin φ sin ε, cos ε)
    v̂ = cos χ e + sin χ n,   and as R̂ × e = n, R̂ × n = −e:   Ω̂ = R̂ × v̂ = cos χ n − sin χ e

A race at offset o along ŵ = −Ω̂ leans by sin Δ = o/(R + r_r): its contact is R̂ cos Δ − Ω̂ sin Δ, and as Ω̂ × v̂ = −R̂ its own
Ω̂ is Ω̂ cos Δ + R̂ sin Δ. Rows of A are Ω̂ + cot α v̂, entries of B r/R of the contact (model.md sections 1 and 2).

Tolerance 1e-12 but where said: numbers of size 1 to 10 from some ten operations, rounded to 1.1e-16 each; A has a condition
below 5.
"""

import itertools
import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

from layouts import atlas, collinear_triple
from spheredrive import kinematics as K
from spheredrive.checking import check
from spheredrive.design import Design, Placement, Sphere
from spheredrive.errors import NearSingularWarning, SingularError
from spheredrive.io.design_file import parse_design
from spheredrive.kinematics.quality import _singular_change
from spheredrive.motion import Motion, Series
from spheredrive.report.figures.sphere_motion import body_axis
from spheredrive.wheels import IdealWheel, TripleRaceWheel

EXACT = 1e-12
R = 0.2

TEXT = """
schema_version = 1
name = "one of everything"
[sphere]
radius = "200 mm"
[wheels.dual]
type = "dual-race"
radius = "30 mm"
rollers = 16
roller_radius = "6 mm"
race_spacing = "20 mm"
roller_angle = "70 deg"
phase = "7 deg"
[wheels.triple]
type = "triple-race"
radius = "40 mm"
rollers = 30
roller_radius = "7 mm"
race_spacing = "15 mm"
outer_radius = "43 mm"
phase = "-4 deg"
[wheels.split]
type = "split-dual-race"
radius = "25 mm"
rollers = 12
roller_radius = "5 mm"
roller_angle = "-60 deg"
phase = "11 deg"
[wheels.left]
type = "mecanum"
radius = "35 mm"
rollers = 9
[wheels.right]
type = "mecanum"
radius = "33 mm"
rollers = 9
roller_angle = "-45 deg"
[wheels.outline]
type = "measured"
file = "outline.csv"
[[placement]]
wheel = "dual"
count = 3
azimuth = "20 deg"
elevation = "-35 deg"
heading = "25 deg"
[[placement]]
wheel = "triple"
count = 1
azimuth = "65 deg"
elevation = "15 deg"
heading = "-70 deg"
[[placement]]
wheel = "split"
count = 1
azimuth = "-100 deg"
elevation = "50 deg"
heading = "130 deg"
[[placement]]
wheel = "left"
count = 2
azimuth = "80 deg"
elevation = "-10 deg"
heading = "-40 deg"
[[placement]]
wheel = "right"
count = 1
azimuth = "-30 deg"
elevation = "60 deg"
heading = "10 deg"
[[placement]]
wheel = "outline"
contact = [0, 0.6, -0.8]
drive = [0, 0.8, 0.6]
[closure]
force = ["1 N", "-2 N", "-30 N"]
springs = [{ direction = [1, 2, 2], stiffness = "1e4 N/m" }, { direction = [0, -3, 4], stiffness = "2e4 N/m" }]
"""
# Angle and radius; the first angle is not zero, and the stretch over the seam, 5.9 to 0.5 + 2π, is uneven with the others.
OUTLINE = ((0.5, 0.030), (2.0, 0.034), (3.1, 0.028), (5.9, 0.037))
# A line from point to point has its mean in its middle: each radius counts with half the angle to either neighbour.
TURN = 2 * math.pi
MEAN = (
    0.030 * (1.5 + 0.5 + TURN - 5.9) / 2
    + 0.034 * (1.5 + 1.1) / 2
    + 0.028 * (1.1 + 2.8) / 2
    + 0.037 * (2.8 + 0.5 + TURN - 5.9) / 2
) / TURN
# Azimuth (a ring runs anticlockwise in equal steps from its first), elevation, heading, roller angle, radius of each wheel.
# The last stands at R̂ = (0, 0.6, −0.8): φ = 90°, sin ε = −0.8, and v̂ = (0, 0.8, 0.6) is its north.
WHEELS = (
    (20, -35, 25, 70, 0.030),
    (140, -35, 25, 70, 0.030),
    (260, -35, 25, 70, 0.030),
    (65, 15, -70, 90, 0.040),
    (-100, 50, 130, -60, 0.025),
    (80, -10, -40, 45, 0.035),
    (260, -10, -40, 45, 0.035),
    (-30, 60, 10, -45, 0.033),
    (90, math.degrees(math.asin(-0.8)), 90, 90, MEAN),
)
N = len(WHEELS)
# Lean of the dual's second race and of the triple's third.
LEAN = {"dual": math.asin(0.010 / 0.206), "triple": math.asin(0.015 / 0.207)}


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    folder = tmp_path_factory.mktemp("design")
    (folder / "outline.csv").write_text("angle,radius\n" + "".join(f"{a},{r}\n" for a, r in OUTLINE), encoding="utf-8")
    return parse_design(TEXT, folder=folder)


def frame(azimuth_deg, elevation_deg, heading_deg):
    """R̂, v̂ and Ω̂ as spelled out at the head of this file."""
    p, e, h = (math.radians(a) for a in (azimuth_deg, elevation_deg, heading_deg))
    outward = np.array([math.cos(p) * math.cos(e), math.sin(p) * math.cos(e), math.sin(e)])
    east = np.array([-math.sin(p), math.cos(p), 0.0])
    north = np.array([-math.cos(p) * math.sin(e), -math.sin(p) * math.sin(e), math.cos(e)])
    return outward, math.cos(h) * east + math.sin(h) * north, math.cos(h) * north - math.sin(h) * east


def contact(i, race):
    """Contact direction, drive direction, row of A and wheel radius of one contact of wheel i; race 0 is the nominal one."""
    place, alpha, radius = WHEELS[i][:3], math.radians(WHEELS[i][3]), WHEELS[i][4]
    R_hat, v_hat, O_hat = frame(*place)
    lean = 0.0
    if i < 3 and race:
        lean = {1: -1, 2: +1}[race] * LEAN["dual"]
    elif i == 3 and race in (1, 3):
        lean, radius = {1: -1, 3: +1}[race] * LEAN["triple"], 0.043
    row = math.cos(lean) * O_hat + math.sin(lean) * R_hat + (0 if WHEELS[i][3] == 90 else 1 / math.tan(alpha)) * v_hat
    if i == 4 and race == 2:
        # At −R̂, driven along −v̂, rollers of the other hand: −R̂ × −v̂ = Ω̂ and cot(−α) (−v̂) = cot α v̂, the same row.
        return -R_hat, -v_hat, row, radius
    return math.cos(lean) * R_hat - math.sin(lean) * O_hat, v_hat, row, radius


def matrices(races):
    """A, B and the weights sin² α of the contacts."""
    A, B, W = [], [], []
    for i, active in enumerate(races):
        for race in active:
            _, _, row, radius = contact(i, race)
            A.append(row)
            B.append(np.eye(N)[i] * radius / R)
            W.append(math.sin(math.radians(WHEELS[i][3])) ** 2)
    return np.array(A), np.array(B), np.diag(W)


NOMINAL = ((0,),) * N
STATES = {
    "nominal": NOMINAL,
    "first": ((1,), (1,), (1,), (2,), (1,), (1,), (1,), (1,), (1,)),
    "second": ((2,), (2,), (2,), (1, 3), (2,), (1,), (1,), (1,), (1,)),
    "mixed": ((1,), (2,), (1,), (1, 3), (1,), (1,), (1,), (1,), (1,)),
    "other": ((2,), (1,), (1,), (2,), (2,), (1,), (1,), (1,), (1,)),
}


def asked(races):
    return None if races is NOMINAL else races


def test_wheels_stand_and_drive_where_the_file_says(design):
    for i, wheel in enumerate(WHEELS):
        R_hat, v_hat, _ = frame(*wheel[:3])
        np.testing.assert_allclose(design.contact_directions[i], R_hat, atol=EXACT)
        np.testing.assert_allclose(design.drive_directions[i], v_hat, atol=EXACT)
    np.testing.assert_allclose(design.wheel_radii, [wheel[4] for wheel in WHEELS], rtol=EXACT)


def test_mean_of_the_outline_runs_across_the_seam(design):
    """The same mean by a second way: that of the middles of two million equal steps.

    Exact on a line; a corner, where the slope turns by less than 0.02, errs by its turn times step²/8 < 1e-13 m a turn.
    """
    angle = (np.arange(2_000_000) + 0.5) * TURN / 2_000_000
    sampled = np.interp(angle, [a for a, _ in OUTLINE], [r for _, r in OUTLINE], period=TURN)
    assert design.wheels[8].radius == pytest.approx(MEAN, rel=EXACT)
    assert sampled.mean() == pytest.approx(MEAN, abs=1e-12)


@pytest.mark.parametrize("state", STATES)
def test_contacts_and_constraint_of_every_type(design, state):
    races = STATES[state]
    found = K.contacts(design, asked(races))
    expected = [(i, race, *contact(i, race)[:2]) for i, active in enumerate(races) for race in active]
    assert list(zip(found.wheel.tolist(), found.race.tolist(), strict=True)) == [(i, race) for i, race, *_ in expected]
    np.testing.assert_allclose(found.contact_direction, [e[2] for e in expected], atol=EXACT)
    np.testing.assert_allclose(found.drive_direction, [e[3] for e in expected], atol=EXACT)
    hands = [-WHEELS[i][3] if (i, race) == (4, 2) else WHEELS[i][3] for i, race, *_ in expected]
    np.testing.assert_allclose(np.degrees(found.roller_angle), hands, atol=100 * EXACT)
    A, B, _ = matrices(races)
    got = K.constraint(design, asked(races))
    np.testing.assert_allclose(got[0], A, atol=EXACT)
    np.testing.assert_allclose(got[1], B, atol=EXACT)


@pytest.mark.parametrize("state", STATES)
def test_no_contact_slips_along_its_roller_axis(design, state):
    """The rim moves by ω r v̂, the sphere by R Ω × R̂; a roller gives way square to its axis û = sin α v̂ − cos α Ω̂ alone.

    Sphere and rim move alike along û: R (Ω × R̂)·û = ω r v̂·û, which is what a row of A Ω = B ω has to say.
    """
    races = STATES[state]
    found = K.contacts(design, asked(races))
    A, B = K.constraint(design, asked(races))
    Omega = np.array([0.7, -1.1, 0.4])
    for k, i in enumerate(found.wheel):
        R_hat, v_hat, alpha = found.contact_direction[k], found.drive_direction[k], found.roller_angle[k]
        u = math.sin(alpha) * v_hat - math.cos(alpha) * np.cross(R_hat, v_hat)
        speed = (A[k] @ Omega) / B[k, i]
        assert R * np.cross(Omega, R_hat) @ u == pytest.approx(speed * found.wheel_radius[k] * (v_hat @ u), abs=EXACT)


@pytest.mark.parametrize("state", STATES)
def test_jacobian_and_inverse_of_every_state(design, state):
    """Ω = (AᵀWA)⁻¹AᵀWB ω; ω = B⁻¹AΩ, with a wheel of two contacts at equal radius and weight taking the mean of their rows."""
    races = STATES[state]
    A, B, W = matrices(races)
    J = np.linalg.solve(A.T @ W @ A, A.T @ W @ B)
    np.testing.assert_allclose(K.jacobian(design, asked(races)), J, atol=EXACT)
    inverse = [
        np.mean([contact(i, race)[2] for race in active], axis=0) * R / contact(i, active[0])[3]
        for i, active in enumerate(races)
    ]
    np.testing.assert_allclose(K.inverse_jacobian(design, asked(races)), inverse, atol=10 * EXACT)
    speeds = np.arange(1.0, N + 1) * (-1) ** np.arange(N)
    np.testing.assert_allclose(K.forward(design, speeds, asked(races)), J @ speeds, atol=10 * EXACT)
    np.testing.assert_allclose(
        K.inverse(design, [0.7, -1.1, 0.4], asked(races)), inverse @ np.array([0.7, -1.1, 0.4]), atol=1e-11
    )


@pytest.mark.parametrize("state", STATES)
def test_quality_is_of_the_largest_and_the_least_singular_value(design, state):
    """σ² are the eigenvalues of AᵀA, here three different ones."""
    A, _, _ = matrices(STATES[state])
    low, middle, high = np.sqrt(np.linalg.eigvalsh(A.T @ A))
    assert low < 0.95 * middle and middle < 0.95 * high
    races = asked(STATES[state])
    assert K.isotropy(design, races) == pytest.approx(low / high, rel=EXACT)
    assert K.singularity_measure(design, races) == pytest.approx(low, rel=EXACT)
    assert K.effectiveness(design, races) == pytest.approx((1 / high, 1 / low), rel=EXACT)
    axes = np.linalg.eigh(A.T @ A)[1]
    slowest, weakest = K.worst_directions(design, races)
    # Axes have no sign; an eigenvector is rounded to 1e-16 over the gap of its eigenvalue, some 1e-15.
    assert abs(slowest @ axes[:, 2]) == pytest.approx(1, abs=EXACT)
    assert abs(weakest @ axes[:, 0]) == pytest.approx(1, abs=EXACT)


def spaces(degrees, phase_deg, rollers_a_race):
    """Half roller pitches behind the wheel: rollers that are ahead by the phase come to each change by so much sooner."""
    return math.floor((degrees + phase_deg) / (180 / rollers_a_race))


@pytest.mark.parametrize(
    "angles_deg", [(0, 15, 16, 17, 21, 0, 0, 0, 0), (-1, -6.9, -7.1, -15, 18.5, 5, 5, 5, 5), (37, 38, 39, 4.1, -12, 1, 2, 3, 4)]
)
def test_active_races_by_wheel_angle_and_phase(design, angles_deg):
    """Dual: 8 rollers a race, phase 7°; triple: 10 a race, −4°; split: 6 a wheel, 11°."""
    dual = [((1,), (2,))[spaces(a, 7, 8) % 2] for a in angles_deg[:3]]
    triple = ((2,), (1, 3))[spaces(angles_deg[3], -4, 10) % 2]
    split = ((1,), (2,))[spaces(angles_deg[4], 11, 6) % 2]
    assert K.active_races(design, np.radians(angles_deg)) == (*dual, triple, split, (1,), (1,), (1,), (1,))


def test_a_wheel_at_rest_that_is_ahead_changes_sooner(design):
    """By hand: the dual's first change, 22.5° of rollers from zero, comes at 22.5° − 7° = 15.5° of the wheel."""
    at = np.zeros(N)
    assert K.active_races(design, at)[0] == (1,)
    at[0] = math.radians(15.4)
    assert K.active_races(design, at)[0] == (1,)
    at[0] = math.radians(15.6)
    assert K.active_races(design, at)[0] == (2,)
    # The triple is 4° behind: from −4° it shows the outer races, since −1 half pitches are odd.
    assert K.active_races(design, np.zeros(N))[3] == (1, 3)


def test_along_changes_races_when_the_rollers_pass_their_half_pitches(design):
    """ϑ(t) = ϑ₀ + ω t passes k π/N − phase at t = (k π/N − phase − ϑ₀)/ω."""
    speed = np.array([1.0, -0.8, 0.6, 0.9, -0.7, 0.5, 0.4, -0.3, 0.2])
    start = np.radians([3.0, -8, 12, 2, 5, 0, 0, 0, 0])
    run = K.along(design, Motion("wheel-speed", Series([0.0], [tuple(speed)]), 2.0, wheel_angle=tuple(start), sample_rate=50.0))
    times = []
    for i, (phase, count) in enumerate([(7, 8)] * 3 + [(-4, 10), (11, 6)]):
        passed = (np.arange(-60, 60) * math.pi / count - math.radians(phase) - start[i]) / speed[i]
        times += [t for t in passed if 0 < t < 2.0]
    assert len(times) > 15
    np.testing.assert_allclose(run.race_changes, np.sort(times), atol=EXACT)
    # In the middle of each stretch Ω is that of the races that the formula names.
    edges = np.concatenate([[0], np.sort(times), [2.0]])
    for begin, end in itertools.pairwise(edges):
        inside = np.flatnonzero((run.time > begin + 1e-9) & (run.time < end - 1e-9))
        for k in inside[:1]:
            turned = np.degrees(start + speed * run.time[k])
            dual = [((1,), (2,))[spaces(a, 7, 8) % 2] for a in turned[:3]]
            races = (
                *dual,
                ((2,), (1, 3))[spaces(turned[3], -4, 10) % 2],
                ((1,), (2,))[spaces(turned[4], 11, 6) % 2],
                *((1,),) * 4,
            )
            A, B, W = matrices(races)
            np.testing.assert_allclose(
                run.angular_velocity[k], np.linalg.solve(A.T @ W @ A, A.T @ W @ B) @ speed, atol=10 * EXACT
            )


def test_rotated_turns_everything_that_is_fixed_to_the_stage(design):
    """A third of a turn about (1, 1, 1) takes x to y, y to z, z to x: components move on by one place."""
    turn = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])
    turned = design.rotated(turn)
    np.testing.assert_allclose(turned.contact_directions, np.roll(design.contact_directions, 1, axis=1), atol=EXACT)
    np.testing.assert_allclose(turned.drive_directions, np.roll(design.drive_directions, 1, axis=1), atol=EXACT)
    np.testing.assert_allclose(turned.closure.force, [-30, 1, -2], atol=100 * EXACT)
    # (1, 2, 2)/3 and (0, −3, 4)/5, moved on.
    np.testing.assert_allclose(turned.closure.springs[0].direction, [2 / 3, 1 / 3, 2 / 3], atol=EXACT)
    np.testing.assert_allclose(turned.closure.springs[1].direction, [0.8, 0, -0.6], atol=EXACT)
    assert [s.stiffness for s in turned.closure.springs] == [1e4, 2e4]
    np.testing.assert_allclose(K.constraint(turned)[0], np.roll(K.constraint(design)[0], 1, axis=1), atol=EXACT)


def test_slip_free_rotations_of_every_state(design):
    """Rows Ω̂ cos Δ ± R̂ sin Δ at one speed and radius differ by 2 R̂ sin Δ: the outer races leave only Ω ⟂ R̂, a plane.

    All other wheels have one contact and follow any rotation; ω follows from Ω, so motions and rotations are as many.
    """
    result = check(design)
    assert result.contact_state_count == 32
    for state in result.contact_states:
        outer = state.races[3] == (1, 3)
        assert (state.contacts, state.slip_free_dof, state.rotation_dof) == ((10, 2, 2) if outer else (9, 3, 3))
        A, _, _ = matrices(state.races)
        low, _, high = np.sqrt(np.linalg.eigvalsh(A.T @ A))
        assert state.isotropy == pytest.approx(low / high, rel=EXACT)
    motions = K.slip_free(design, STATES["second"])
    np.testing.assert_allclose(motions.basis[:, :3] @ frame(*WHEELS[3][:3])[0], 0, atol=EXACT)


# What `check` says, in numbers and axes.


def finding(design, code):
    return next(f for f in check(design).findings if f.code == code)


def triples(places):
    wheel = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=10e-3)
    return Design("triples", Sphere(0.15), [Placement.at(wheel, *np.radians(place)) for place in places])


def test_slip_finding_counts_states_and_rotations(design):
    # Three independent R̂: the state of all outer races asks Ω ⟂ each of them. All but the one of centre races slip.
    text = finding(triples([(0, -40, 0), (120, -40, 0), (240, -40, 0)]), "slip").message
    assert "In 7 of 8 contact states" in text and "1+3 1+3 1+3" in text and text.endswith("free of slip are: none.")
    # R̂ in the plane of x and y [2.99]: two or three wheels on their outer races leave Ω ∥ z.
    text = finding(collinear_triple(), "slip").message
    assert "In 7 of 8 contact states" in text and text.endswith("are: those about one axis.")
    # One triple wheel among eight others: half of the states, Ω ⟂ its R̂.
    text = finding(design, "slip").message
    assert "In 16 of 32 contact states" in text and text.endswith("are: those about the axes of one plane.")


def test_race_offset_finding_names_the_widest_race(design):
    """The triple's outer races: asin(15/207) = 4.16°, more than the dual's asin(10/206) = 2.78°."""
    assert f"{math.degrees(LEAN['triple']):.2f}" == "4.16"
    assert "up to 4.16° beside" in finding(design, "race-offset").message


def vectors(pairs, alpha_deg=90.0):
    wheel = IdealWheel(radius=0.025, roller_angle=math.radians(alpha_deg))
    return Design("vectors", Sphere(0.15), [Placement(wheel, *pair) for pair in pairs])


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
ORTHOGONAL = ((X, Z), (Y, X), (Z, Y))
MIRRORED = ((X, Y), (Y, Z), (Z, X))


def test_under_actuated_finding_names_the_axis_without_a_wheel():
    """Ω̂ = x × z = −y and y × x = −z: nothing turns about x. One wheel turns about y alone."""
    two = vectors(ORTHOGONAL[:2])
    assert finding(two, "under-actuated").message.endswith("Nothing drives it about x.")
    with pytest.raises(SingularError, match=r"nothing drives it about x$"):
        K.jacobian(two)
    # Two that are not alike: rows (0, −1, 0) + cot 45° z and −z: still nothing about x, and most speed elsewhere.
    skew = Design(
        "skew", Sphere(0.15),
        [Placement(IdealWheel(radius=0.02, roller_angle=math.pi / 4), X, Z), Placement(IdealWheel(radius=0.02), Y, X)],
    )  # fmt: skip
    assert finding(skew, "under-actuated").message.endswith("Nothing drives it about x.")
    assert finding(vectors(ORTHOGONAL[:1]), "under-actuated").message.endswith("axis perpendicular to y.")


def test_singular_finding_names_the_axis_that_is_lost():
    """Orthogonal at 45°: rows −y + z, x − z, y − x, all square to (1, 1, 1)."""
    design = vectors(ORTHOGONAL, 45)
    assert "about (0.58, 0.58, 0.58), so there is no Jacobian" in finding(design, "singular").message
    with pytest.raises(SingularError, match=r"about \(0\.58, 0\.58, 0\.58\)"):
        K.jacobian(design)
    result = check(design)
    assert result.weakest == "(0.58, 0.58, 0.58)" and result.slowest.endswith(" axis perpendicular to (0.58, 0.58, 0.58)")


def test_near_singular_finding_tells_the_growth_and_the_axis():
    """Atlas: AᵀA = diag(3/2 sin² θ, 3/2 sin² θ, 3 cos² θ): at θ = 89.7° σ₁/σ₃ = tan θ/√2 = 135.04, lost about z.

    At 0.3° below the equator it is √2/tan θ = 270.1, lost about every axis square to z.
    """
    high = atlas(IdealWheel(radius=0.025), -89.7)
    assert f"{math.tan(math.radians(89.7)) / math.sqrt(2):.3g}" == "135"
    assert "grows up to 135 times in rotations about z." in finding(high, "near-singular").message
    with pytest.warns(NearSingularWarning, match=r"by up to 135 in rotations about z$"):
        K.jacobian(high)
    low = atlas(IdealWheel(radius=0.025), -0.3)
    assert f"{math.sqrt(2) / math.tan(math.radians(0.3)):.3g}" == "270"
    assert re.search(r"up to 270 times in rotations about \w+ axis perpendicular to z\.", finding(low, "near-singular").message)


@pytest.mark.parametrize("alpha_deg", [90, -90])
@pytest.mark.parametrize(("pairs", "change_deg"), [(ORTHOGONAL, -45), (MIRRORED, 45)])
def test_square_rollers_may_lean_to_either_side(alpha_deg, pairs, change_deg):
    """c = cot α. For v̂ = z, x, y det = c³ − 1: c = 1. The mirror image v̂ = y, z, x has Ω̂ = z, x, y and det = c³ + 1: c = −1.

    cot(±90° + β) = −tan β, so c = 1 takes β = −45° and c = −1 takes β = +45°. 1e-6°: the change is refined until σ₃ ≤ 1e-9 σ₁.
    """
    found = _singular_change(vectors(pairs, alpha_deg), "roller_angle")
    assert math.degrees(found.change) == pytest.approx(change_deg, abs=1e-6)


def test_rollers_of_a_hand_stay_on_their_side():
    """det = c³ − 1 from α = 60° is zero at 45°, change −15°; from −60° (c < 0 up to −90°) it never is."""
    assert math.degrees(_singular_change(vectors(ORTHOGONAL, 60), "roller_angle").change) == pytest.approx(-15, abs=1e-6)
    assert _singular_change(vectors(ORTHOGONAL, -60), "roller_angle") is None
    assert math.degrees(_singular_change(vectors(MIRRORED, -60), "roller_angle").change) == pytest.approx(15, abs=1e-6)


def test_body_axis_is_the_first_column_of_body_to_inertial():
    """A quarter turn about z takes x to y, about y takes x to −z, about x leaves it; 30° about z: (cos 30°, sin 30°, 0)."""
    h = math.sqrt(0.5)
    a = math.radians(15)
    turns = np.array([[1, 0, 0, 0], [h, 0, 0, h], [h, 0, h, 0], [h, h, 0, 0], [math.cos(a), 0, 0, math.sin(a)]])
    expected = [[1, 0, 0], [0, 1, 0], [0, 0, -1], [1, 0, 0], [math.sqrt(0.75), 0.5, 0]]
    np.testing.assert_allclose(body_axis(SimpleNamespace(orientation=turns)), expected, atol=EXACT)
