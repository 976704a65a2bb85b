"""Contacts that wander along the wheel: the constraint as the touching roller makes it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import DUAL, atlas
from spheredrive import kinematics as K
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel, StandardWheel, TripleRaceWheel

R = 0.15
MECANUM = MecanumWheel(radius=0.05, rollers=9, roller_radius=0.01)
WHEELS = {
    "ideal": IdealWheel(radius=0.025),
    "standard": StandardWheel(radius=0.05, rollers=8, roller_radius=0.006, roundness=0.45),
    "dual-race": DualRaceWheel(**DUAL),
    "triple-race": TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=10e-3),
    "mecanum": MECANUM,
    "other hand": replace(MECANUM, roller_angle=-math.pi / 4),
    "60 deg": replace(MECANUM, roller_angle=math.radians(60), rollers=10),
}


@pytest.mark.parametrize("name", ["ideal", "mecanum", "other hand"])
def test_at_a_rollers_middle_the_rows_are_the_nominal_ones(name):
    """A barrel Mecanum's roller stands in the line of centres at angle 0."""
    design = atlas(WHEELS[name])
    A, B = K.instantaneous_constraint(design, np.zeros(3))
    nominal_A, nominal_B = K.constraint(design)
    np.testing.assert_allclose(A, nominal_A, atol=1e-12)
    np.testing.assert_allclose(np.diag(B), nominal_B, atol=1e-12)


def test_a_dual_races_rows_are_those_of_its_races():
    """Middle of the first and second half pitch: Δθ of race 1 and of race 2, lever r − r_r (1 − cos Δθ) instead of r."""
    design = atlas(WHEELS["dual-race"])
    pitch = math.pi / 8
    for race, angle in ((1, pitch / 2), (2, 1.5 * pitch)):
        A, B = K.instantaneous_constraint(design, np.full(3, angle))
        np.testing.assert_allclose(A, K.constraint(design, [race] * 3)[0], atol=1e-12)
        tilt = math.asin(DUAL["race_spacing"] / 2 / (R + DUAL["roller_radius"]))
        lever = DUAL["radius"] - DUAL["roller_radius"] * (1 - math.cos(tilt))
        np.testing.assert_allclose(B, lever / R, rtol=1e-12)


@pytest.mark.parametrize("name", [name for name in WHEELS if name != "ideal"])
def test_touching_point_slips_only_across_the_roller(name):
    """Power of a force along the touching roller's axis: what the sphere takes, Ω · (p × f), the wheel gives, ω ŵ · (l × f).

    Written with the mechanics of two rigid bodies and the roller's place in space: the axis at distance a from the wheel's,
    turned by ϑ, its point nearest to the contact found by a search that knows nothing of envelopes.
    """
    wheel, rng = WHEELS[name], np.random.default_rng(70)
    design = atlas(wheel)
    angles = rng.uniform(0, 2 * math.pi, (20, 3))
    A, B = K.instantaneous_constraint(design, angles)
    compared = 0
    for k in range(20):
        for i in range(3):
            R_hat, v_hat = design.contact_directions[i], design.drive_directions[i]
            found = _nearest_roller(wheel, angles[k, i], R_hat, v_hat)
            if found is None:
                continue
            compared += 1
            normal, axis, arm = found
            u = axis - (axis @ normal) * normal
            u /= np.linalg.norm(u)
            scale = R * math.sin(wheel.roller_angle)
            np.testing.assert_allclose(A[k, i], np.cross(R * normal, u) / scale, atol=2e-6)
            np.testing.assert_allclose(B[k, i], np.cross(v_hat, R_hat) @ np.cross(arm, u) / scale, atol=2e-6)
    assert compared > 20


def _nearest_roller(wheel, angle, R_hat, v_hat):
    """Contact direction, roller axis and arm from the wheel's centre, by pressing the sphere on every roller in turn.

    Barrels: the radius about the axis point s is r_b − √(a² + s² sin² α) of a ball centred there. None where the end of a
    roller, which is no ball, holds the sphere.
    """
    w_hat, best = np.cross(v_hat, R_hat), None
    alpha, N = wheel.roller_angle, wheel.rollers_per_race
    from spheredrive.shape import roller

    turns = len(wheel.alternation)
    for race in wheel.races(R):
        body = roller(wheel, race)
        place = next(j for j, together in enumerate(wheel.alternation) if race.number in together)
        first = (place + 0.5) * 2 * math.pi / N / turns if turns > 1 else 0.0
        if wheel.gap_comes_first:
            first = 2 * math.pi / N * (1 + wheel.roundness) / 2
        a, L = race.radius - race.roller_radius, body.half_length
        for j in range(-1, 2):
            beta = (angle - first + math.pi / N) % (2 * math.pi / N) - math.pi / N + 2 * math.pi / N * j
            s = np.linspace(-L, L, 200_001)
            rho = race.radius - np.sqrt(a * a + (s * math.sin(alpha)) ** 2)
            x = a * math.cos(beta) - s * math.sin(alpha) * math.sin(beta)
            y = a * math.sin(beta) + s * math.sin(alpha) * math.cos(beta)
            z = s * math.cos(alpha) + race.offset
            D = x + np.sqrt((R + rho) ** 2 - y * y - z * z)
            m = int(np.argmax(D))
            if best is None or D[m] > best[0] + 1e-12:
                centre = D[m] * R_hat
                point = centre - x[m] * R_hat + y[m] * v_hat + z[m] * w_hat
                normal = point / np.linalg.norm(point)
                axis = math.sin(alpha) * (math.sin(beta) * R_hat + math.cos(beta) * v_hat) + math.cos(alpha) * w_hat
                edge = abs(m - len(s) // 2) == len(s) // 2
                best = D[m], normal, axis, R * normal - centre, edge
    return None if best[4] else best[1:4]


def test_wander_tilts_the_rows_of_a_mecanum_wheel_by_4_degrees():
    """model.md section 3: R = 150, r_b = 50, r_r = 10 mm, n_r = 9: more than a dual race on small machines."""
    design = atlas(MECANUM)
    angles = np.linspace(0, 2 * math.pi / 9, 400)
    A, _ = K.instantaneous_constraint(design, np.repeat(angles[:, None], 3, axis=1))
    nominal = K.constraint(design)[0]
    cosine = np.sum(A[:, 0] * nominal[0], axis=1) / np.linalg.norm(A[:, 0], axis=1) / np.linalg.norm(nominal[0])
    assert 3.0 < math.degrees(np.arccos(cosine.min())) < 6.5


def test_instantaneous_jacobian_maps_wheel_speeds_without_slip():
    design, angle = atlas(MECANUM), np.array([0.1, 0.2, 0.3])
    A, B = K.instantaneous_constraint(design, angle)
    J = K.instantaneous_jacobian(design, angle)
    omega = np.array([1.0, -2.0, 0.5])
    np.testing.assert_allclose(A @ (J @ omega), B * omega, atol=1e-12)


def test_rollers_that_are_not_described_and_angles_that_do_not_fit_are_refused():
    with pytest.raises(DesignError):
        K.instantaneous_constraint(atlas(MecanumWheel(radius=0.05)), np.zeros(3))
    with pytest.raises(SpheredriveError, match="one angle for each of the 3 wheels"):
        K.instantaneous_constraint(atlas(MECANUM), np.zeros(4))
