"""The exact propagation against the same equations written in full coordinates and integrated by SciPy, corner by corner."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from layouts import atlas
from spheredrive import vibration
from spheredrive.design import Closure, Contact, Mount, Sphere, Spring
from spheredrive.motion import Series
from spheredrive.shape import profile
from spheredrive.wheels import StandardWheel

WHEEL = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25)
SPEED = Series((0.0, 0.03, 0.08, 0.12), ((1.0, -7.0, 0.5), (1.4, 7.5, -6.0), (0.0, 6.0, -9.0), (-9.0, 6.0, 3.0)))
ANGLE = np.array([0.11, 0.2, 0.31])
TIME = np.linspace(0, 0.12, 25)
MACHINES = {
    "compliant": (dict(contact=Contact(188208.0, 40.0)), "DOP853"),
    "mounts and springs": (
        dict(
            contact=Contact(2e5, 150.0), mount=Mount(1e6, 50.0),
            closure=Closure(2e4, 30.0, springs=(Spring((1, 2, 2), 5e4, 60.0),)),
        ),
        "DOP853",
    ),
    "stiff-damped": (dict(contact=Contact(188208.0, 20000.0)), "Radau"),
    "stiff-damped on mounts": (dict(contact=Contact(188208.0, 20000.0), mount=Mount(1e6, 10.0)), "Radau"),
}  # fmt: skip


def peer(design, method):
    """(c, ċ, N) at TIME: c, Δ, ċ, Δ̇ by 5b as it is written, one contact after the other, restarted at each corner."""
    n_hat, shape = -design.contact_directions, profile(WHEEL, 1.22)
    K, C, M = design.contact.stiffness, design.contact.damping, design.sphere.mass
    k, c = design.mount.stiffness, design.mount.damping
    n = 3
    pads = [(n_hat[i], design.closure.stiffness, design.closure.damping) for i in range(n)]
    pads += [(np.array(s.direction), s.stiffness, s.damping) for s in design.closure.springs]

    def force(angle, speed, x):
        h, rate = shape.height(angle), shape.slope(angle) * speed
        p, v = x[:3], x[3:6]
        D, Dv = (x[6:9], x[9:12]) if k else (np.zeros(n), np.zeros(n))
        return K * (n_hat @ p - D - h) + C * (n_hat @ v - Dv - rate)

    def rate(t, x, middle):
        # The side of a corner that a time falls on by rounding is settled by the middle of the stretch.
        t = middle + (t - middle) * (1 - 1e-13)
        pull = force(ANGLE + SPEED.integral(t), SPEED.at(t), x)
        acceleration = -pull @ n_hat / M
        for direction, stiffness, damping in pads:
            acceleration = acceleration - direction * (stiffness * direction @ x[:3] + damping * direction @ x[3:6]) / M
        if not k:
            return np.concatenate([x[3:6], acceleration])
        wheels = (pull - c * x[9:12] - k * x[6:9]) / WHEEL.mass
        return np.concatenate([x[3:6], acceleration, x[9:12], wheels])

    zero = np.zeros(12 if k else 6)
    A = np.stack([rate(0.0, e, 0.0) - rate(0.0, zero, 0.0) for e in np.eye(len(zero))], axis=1)
    options = dict(jac=lambda t, x, middle: A) if method == "Radau" else {}
    corners = crossings(shape)
    x, out = np.zeros(12 if k else 6), np.zeros((len(TIME), 9))
    for a, b in itertools.pairwise(corners):
        inside = TIME[(a <= TIME) & (b + (b == TIME[-1]) > TIME)]
        s = solve_ivp(
            rate, (a, b), x, method, np.unique(np.append(inside, b)), rtol=1e-12, atol=1e-16, args=((a + b) / 2,), **options
        )
        assert s.success
        for j, t in enumerate(inside):
            y = s.y[:, np.searchsorted(s.t, t)]
            out[np.searchsorted(TIME, inside[j])] = [*y[:6], *force(ANGLE + SPEED.integral(t), SPEED.at(t), y)]
        x = s.y[:, -1]
    return out


def crossings(shape):
    """Times at which any wheel meets a breakpoint, by bisection on dense samples, with the speeds' own times."""
    t = np.linspace(0, TIME[-1], 2001)
    found = [*SPEED.time]
    for i in range(3):
        for edge in shape.breakpoints[:-1]:

            def pattern(t, i=i, edge=edge):
                return (ANGLE[i] + SPEED.integral(t)[..., i] - edge) / shape.period

            turns = np.floor(pattern(t))
            for j in np.flatnonzero(np.diff(turns)):
                low, high, target = t[j], t[j + 1], max(turns[j], turns[j + 1])
                rising = turns[j + 1] > turns[j]
                for _ in range(60):
                    middle = (low + high) / 2
                    low, high = (middle, high) if (pattern(middle) < target) == rising else (low, middle)
                found.append((low + high) / 2)
    found = np.unique(found)
    return np.append(found[:-1][np.diff(found) > 1e-9], found[-1])


# SciPy takes its time over stiff machines.
CASES = [pytest.param(name, marks=pytest.mark.long if name.startswith("stiff") else ()) for name in MACHINES]


@pytest.mark.parametrize("name", CASES)
def test_transient_matches_scipy(name):
    parts, method = MACHINES[name]
    design = replace(atlas(WHEEL, radius=1.22), sphere=Sphere(1.22, 5.0), **parts)
    theirs = peer(design, method)
    run = vibration.transient(design, SPEED, TIME[-1], 200.0, wheel_angle=ANGLE)
    for ours, column in ((run.displacement, 0), (run.velocity, 3)):
        reference = theirs[:, column : column + 3]
        np.testing.assert_allclose(ours, reference, atol=1e-9 * np.abs(reference).max())
    # Forces are K times small differences: what 1e-9 of the displacement leaves of them.
    seat = vibration.linear_system(design).seat_force
    change = run.contact_force - seat
    scale = design.contact.stiffness * np.abs(theirs[:, :3]).max()
    np.testing.assert_allclose(change[:-1], -theirs[:-1, 6:], atol=1e-8 * scale)
