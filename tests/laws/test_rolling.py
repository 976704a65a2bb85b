"""What any sphere on any wheels must obey, checked against rigid-body mechanics written out anew.

The wheel is a body that turns by ω about ŵ = −R̂ × v̂ with its centre at rest; the contact is at −r R̂ from that centre. A
roller can give way across its axis and not along it; its axis stands at α from ŵ, towards v̂. Nothing here uses the rows of
the constraint matrix but through the functions under test.
"""

import numpy as np
import pytest

from layouts import random_design, random_races
from spheredrive import kinematics as K

KINDS = [None, "ideal", "standard", "dual-race", "split-dual-race", "mecanum", "measured"]
CASES = [(kind, n, seed) for kind in KINDS for n in (3, 4, 7) for seed in range(4)]
# Products of matrices of condition ≤ 30 and R/r ≤ 200: a few hundred roundings of 1e-16, with room.
RELATIVE = 1e-11


def roller_axis(contacts):
    """Unit vector along the roller, the direction in which it cannot give way."""
    w_hat = np.cross(contacts.drive_direction, contacts.contact_direction)
    alpha = contacts.roller_angle[:, None]
    return np.cos(alpha) * w_hat + np.sin(alpha) * contacts.drive_direction


def wheel_surface_velocity(contacts, wheel_speed):
    w_hat = np.cross(contacts.drive_direction, contacts.contact_direction)
    spin = wheel_speed[contacts.wheel][:, None] * w_hat
    return np.cross(spin, -contacts.wheel_radius[:, None] * contacts.contact_direction)


@pytest.mark.parametrize(("kind", "n", "seed"), CASES)
def test_inverse_speeds_leave_no_slip_along_any_roller(kind, n, seed):
    rng = np.random.default_rng([1, seed, n])
    design = random_design(rng, n, kind)
    races = random_races(rng, design)
    Omega = rng.normal(size=3)
    omega = K.inverse(design, Omega, races)
    c = K.contacts(design, races)
    sphere = np.cross(Omega, design.sphere.radius * c.contact_direction)
    slip = np.sum(roller_axis(c) * (sphere - wheel_surface_velocity(c, omega)), axis=1)
    assert np.abs(slip).max() < RELATIVE * np.abs(sphere).max()


@pytest.mark.parametrize(("kind", "n", "seed"), CASES)
def test_forward_of_inverse_is_identity(kind, n, seed):
    rng = np.random.default_rng([2, seed, n])
    design = random_design(rng, n, kind)
    races = random_races(rng, design)
    Omega = rng.normal(size=(5, 2, 3))
    back = K.forward(design, K.inverse(design, Omega, races), races)
    np.testing.assert_allclose(back, Omega, atol=RELATIVE * np.abs(Omega).max())


@pytest.mark.parametrize(("kind", "n", "seed"), CASES)
def test_power_balances(kind, n, seed):
    """T·ω = M·Ω for forces along the rollers, torques by each wheel's lever and the moment on the sphere."""
    rng = np.random.default_rng([3, seed, n])
    design = random_design(rng, n, kind)
    races = random_races(rng, design)
    c = K.contacts(design, races)
    force = rng.normal(size=len(c.wheel))
    axis = roller_axis(c)
    on_sphere = force[:, None] * axis
    moment = np.cross(design.sphere.radius * c.contact_direction, on_sphere).sum(axis=0)
    w_hat = np.cross(c.drive_direction, c.contact_direction)
    # The motor's torque balances the contact's reaction −f û about the wheel's axis.
    arm = -c.wheel_radius[:, None] * c.contact_direction
    torque = np.zeros(n)
    np.add.at(torque, c.wheel, -np.sum(w_hat * np.cross(arm, -on_sphere), axis=1))
    Omega = rng.normal(size=3)
    omega = K.inverse(design, Omega, races)
    assert torque @ omega == pytest.approx(moment @ Omega, abs=RELATIVE * np.abs(torque) @ np.abs(omega))
    # So the torque map is the transpose of the velocity map.
    np.testing.assert_allclose(
        K.inverse_jacobian(design, races).T @ torque, moment, atol=RELATIVE * np.abs(moment).max() + 1e-12
    )


@pytest.mark.parametrize(("kind", "n", "seed"), CASES)
def test_turning_the_whole_machine_turns_the_answer(kind, n, seed):
    rng = np.random.default_rng([4, seed, n])
    design = random_design(rng, n, kind)
    races = random_races(rng, design)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    omega = rng.normal(size=n)
    expected = turn @ K.forward(design, omega, races)
    np.testing.assert_allclose(K.forward(design.rotated(turn), omega, races), expected, atol=RELATIVE * np.abs(expected).max())


@pytest.mark.parametrize(("kind", "n", "seed"), CASES)
def test_relabelling_wheels_permutes_the_answer(kind, n, seed):
    from dataclasses import replace

    rng = np.random.default_rng([5, seed, n])
    design = random_design(rng, n, kind)
    races = random_races(rng, design)
    order = rng.permutation(n)
    shuffled = replace(design, placements=tuple(design.placements[i] for i in order))
    races_shuffled = [races[i] for i in order]
    Omega, omega = rng.normal(size=3), rng.normal(size=n)
    np.testing.assert_array_equal(K.inverse(shuffled, Omega, races_shuffled), K.inverse(design, Omega, races)[order])
    np.testing.assert_allclose(
        K.forward(shuffled, omega[order], races_shuffled),
        K.forward(design, omega, races),
        rtol=0,
        atol=1e-11 * np.abs(omega).max(),
    )


@pytest.mark.parametrize(("kind", "seed"), [(kind, seed) for kind in KINDS for seed in range(6)])
def test_rows_are_the_rate_of_a_finite_rotation_by_complex_step(kind, seed):
    """R a·Ω sin α is the rate at which the sphere's material point moves along the roller's axis."""
    rng = np.random.default_rng([6, seed])
    design = random_design(rng, 3, kind)
    races = random_races(rng, design)
    A, _ = K.constraint(design, races)
    c = K.contacts(design, races)
    step = 1e-30
    for axis in np.eye(3):
        cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        rotation = np.eye(3) + np.sin(1j * step) * cross + (1 - np.cos(1j * step)) * cross @ cross
        moved = design.sphere.radius * c.contact_direction @ rotation.T
        rate = np.sum(roller_axis(c) * moved.imag, axis=1) / step
        np.testing.assert_allclose(
            design.sphere.radius * np.sin(c.roller_angle) * (A @ axis), rate, atol=1e-14 * design.sphere.radius
        )


@pytest.mark.parametrize("seed", range(20))
def test_jacobian_is_the_derivative_of_forward(seed):
    """Forward is linear, so a central difference of any size is exact but for rounding."""
    rng = np.random.default_rng([7, seed])
    design = random_design(rng, int(rng.integers(3, 8)))
    omega = rng.normal(size=design.wheel_count)
    J = K.jacobian(design)
    for i, step in enumerate(np.eye(design.wheel_count)):
        difference = (K.forward(design, omega + step) - K.forward(design, omega - step)) / 2
        np.testing.assert_allclose(difference, J[:, i], atol=1e-13 * max(1.0, np.abs(J).max()) * 10)


@pytest.mark.parametrize("seed", range(20))
def test_forward_minimises_the_physical_slip(seed):
    """No nearby Ω has a smaller sum of squared slip velocities: the gradient there vanishes."""
    rng = np.random.default_rng([8, seed])
    design = random_design(rng, int(rng.integers(4, 8)))
    c = K.contacts(design)
    omega = rng.normal(size=design.wheel_count)

    def slip_energy(Omega):
        sphere = np.cross(Omega, design.sphere.radius * c.contact_direction)
        return np.sum(np.sum(roller_axis(c) * (sphere - wheel_surface_velocity(c, omega)), axis=1) ** 2)

    best = K.forward(design, omega)
    h = 1e-6 * max(1.0, np.abs(best).max())
    gradient = [(slip_energy(best + h * e) - slip_energy(best - h * e)) / (2 * h) for e in np.eye(3)]
    # A central difference of a quadratic is exact; its rounding is ε E / h.
    assert np.abs(gradient).max() < 1e-8 * max(slip_energy(best), 1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_slip_ratios_are_the_velocities_along_the_rollers(seed):
    rng = np.random.default_rng([14, seed])
    design = random_design(rng, int(rng.integers(4, 8)))
    races = random_races(rng, design)
    c = K.contacts(design, races)
    np.testing.assert_allclose(c.slip_direction, roller_axis(c), atol=1e-15)
    omega = rng.normal(size=design.wheel_count)
    sphere = np.cross(K.forward(design, omega, races), design.sphere.radius * c.contact_direction)
    velocity = np.sum(roller_axis(c) * (wheel_surface_velocity(c, omega) - sphere), axis=1)
    ratios, overall = K.slip(design, omega, races)
    expected = np.abs(velocity) / np.abs(omega[c.wheel] * c.wheel_radius)
    np.testing.assert_allclose(ratios, expected, rtol=1e-9)
    np.testing.assert_allclose(overall, np.sqrt(np.sum(expected**2)), rtol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_equivalent_contacts_have_the_same_row(seed):
    rng = np.random.default_rng([9, seed])
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    alpha = rng.choice([-1, 1]) * rng.uniform(0.3, np.pi / 2)
    angle = rng.uniform(-np.pi, np.pi, size=7)
    R_hat, v_hat = K.equivalent_contact(frame[0], frame[1], angle, alpha)
    np.testing.assert_allclose(np.sum(R_hat * v_hat, -1), 0, atol=1e-14)
    row = K.constraint_row(frame[0], frame[1], alpha)
    np.testing.assert_allclose(
        K.constraint_row(R_hat, v_hat, alpha), np.broadcast_to(row, (7, 3)), atol=1e-14 / np.sin(abs(alpha))
    )
    # The place itself does move: along the great circle perpendicular to the row, by the angle asked for.
    np.testing.assert_allclose(np.sum(R_hat * frame[0], -1), np.cos(angle), atol=1e-14)


@pytest.mark.parametrize("kind", [k for k in KINDS if k])
def test_results_do_not_depend_on_the_batch(kind):
    rng = np.random.default_rng(10)
    design = random_design(rng, 4, kind)
    omega = rng.normal(size=(70_000, 4))
    whole = K.forward(design, omega)
    np.testing.assert_array_equal(whole[:7], K.forward(design, omega[:7]))
    np.testing.assert_array_equal(whole[12345], K.forward(design, omega[12345]))
    np.testing.assert_array_equal(whole.reshape(70, 1000, 3), K.forward(design, omega.reshape(70, 1000, 4)))
