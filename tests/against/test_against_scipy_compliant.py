"""The compliant model against SciPy: its equations under another integrator, the same mechanics written out again."""

import math
from dataclasses import replace

import numpy as np
import pytest

from compliant_cases import OFFSET, WHEELS, R, design, evaluate, speeds, torques
from spheredrive.design import Closure, Mount, Spring
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.machine import machine
from spheredrive.frames import quaternion_matrix
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.compliant.run import Accuracy, run_compliant


def start_of(d, motion):
    """The state a run begins in."""
    return run_compliant(d, replace(motion, sample_rate=1 / motion.duration)).states[0]


def by_scipy(d, motion, method, rate=None, rtol=1e-10, atol=1e-12):
    """States at the samples of a run, by ``solve_ivp``; every roller that stands in the sphere acts."""
    from scipy.integrate import solve_ivp

    m = machine(d)
    kind = at.TORQUE if motion.kind == "wheel-torque" else at.SPEED
    stage_kind = at.STILL if motion.stage is None else at.DRIVEN
    places, turns = m.places.copy(), np.zeros(len(m.outlines))

    def compiled(t, y):
        push = None if motion.stage is None else motion.stage.series.at(t)
        return evaluate(m, y, places, turns, motion.series.at(t), None, kind, push, stage_kind).rate

    times = np.arange(round(motion.duration * motion.sample_rate) + 1) / motion.sample_rate
    found = solve_ivp(
        rate or compiled, (0, motion.duration), start_of(d, motion), method, times, rtol=rtol, atol=atol, max_step=5e-4
    )
    assert found.success, found.message
    return found.y.T


SLIPPERY = dict(friction=0.05, creep_speed=1e-3, damping=0.0, dissipation=0.5)
GRIPPING = {**SLIPPERY, "friction": 0.4}
PUSHED = StageMotion("force", Series((0.0, 0.05), ((1.0, 2.0, 3.0), (-1.0, 0.0, 1.0))))
TORQUES = Series((0.0, 0.05), ((0.05, 0.0, -0.05), (0.0, 0.05, 0.05)))
CASES = {
    "sphere rollers, mounts, slip": (
        design(WHEELS["sphere"], contact=SLIPPERY, mount=Mount(1e5, 50.0)),
        torques((0.05, -0.02, 0.08), 0.05, angular_velocity=(2.0, -1.0, 3.0), sample_rate=200),
    ),
    "dual race by speeds": (
        design(WHEELS["dual-race"], contact=GRIPPING),
        speeds((2.0, 4.0, 3.0), 0.05, sample_rate=200),
    ),
    "mecanum on a driven stage, offset mass": (
        design(
            WHEELS["mecanum"], contact=GRIPPING, sphere=OFFSET, closure=Closure(springs=(Spring((0.3, 0.2, 1.0), 2e3, 5.0),))
        ),
        Motion("wheel-torque", TORQUES, 0.05, angular_velocity=(1.0, 2.0, -1.0), stage=PUSHED, sample_rate=200),
    ),
}


def apart(run, states):
    """Largest difference of positions, of orientation times R, of wheel angles times r and of Ω R."""
    error = np.abs(run.states - states)
    return (
        error[:, : at.QUATERNION].max(),
        2 * R * error[:, at.QUATERNION : at.QUATERNION + 4].max(),
        R * error[:, at.OMEGA : at.OMEGA + 3].max(),
    )


@pytest.mark.parametrize("name", CASES)
def test_runs_agree_with_scipys_radau_on_the_same_equations(name):
    """Other steps, other method, no notion of rollers that act or of corners: 5e-9 m, 1e-7 m/s after contacts have changed."""
    d, motion = CASES[name]
    run = run_compliant(d, motion, Accuracy(1e-12))
    place, turned, turning = apart(run, by_scipy(d, motion, "Radau"))
    assert run.completed
    assert max(place, turned) < 5e-9
    assert turning < 1e-6


def written_out(d, motion):
    """The right-hand side for sphere rollers on mounts, from model.md alone, in plain NumPy and the inertial frame.

    Every roller of every wheel is looked at. N = K pen (1 + χ rate); friction along û, the roller's axis laid into the tangent
    plane; the contact half way into the penetration.
    """
    n, contact, mount = d.wheel_count, d.contact, d.mount
    wheel = d.wheels[0]
    a, r_r = wheel.radius - wheel.roller_radius, wheel.roller_radius
    I_b, rho_b, M = d.sphere.inertia_tensor, np.array(d.sphere.centre_of_mass), d.sphere.mass
    weight = np.array([0, 0, -9.80665 * M])
    pitch = 2 * math.pi / wheel.rollers
    numbers = np.arange(wheel.rollers)

    def rate(t, y):
        c, q, v, Omega = y[:3], y[3:7], y[7:10], y[10:13]
        out = np.zeros(len(y))
        F, moment = weight.copy(), np.zeros(3)
        for i, placement in enumerate(d.placements):
            R_hat, v_hat = np.array(placement.contact_direction), np.array(placement.drive_direction)
            w_hat = -np.cross(R_hat, v_hat)
            theta, omega = y[19 + 3 * i], y[20 + 3 * i]
            sunk, sinking = y[19 + 3 * n + 2 * i : 21 + 3 * n + 2 * i]
            hub, hub_speed = (R + wheel.radius) * R_hat - sunk * R_hat, -sinking * R_hat
            # At ϑ = 0 a roller's middle faces the sphere. Angles from the line to the sphere, −R̂, towards +v̂.
            beta = theta - numbers * pitch
            out_of_hub = np.outer(np.cos(beta), -R_hat) + np.outer(np.sin(beta), v_hat)
            along = np.outer(-np.sin(beta), -R_hat) + np.outer(np.cos(beta), v_hat)
            middles = hub + a * out_of_hub
            apart = c - middles
            far = np.linalg.norm(apart, axis=1)
            torque = 0.0
            pressed = 0.0
            for k in np.flatnonzero(far < R + r_r):
                G = apart[k] / far[k]
                pen = R + r_r - far[k]
                point = c - (R - pen / 2) * G
                wheel_speed = hub_speed + omega * np.cross(w_hat, point - hub)
                closing = -G @ (v - hub_speed - omega * np.cross(w_hat, middles[k] - hub))
                N = max(0.0, contact.stiffness * pen * (1 + contact.dissipation * closing))
                u = along[k] - (along[k] @ G) * G
                u /= np.linalg.norm(u)
                f = np.cross(u, G)
                between = v + np.cross(Omega, point - c) - wheel_speed
                slip, rolling = u @ between, f @ between
                lever = r_r * math.sqrt(1 - (along[k] @ G) ** 2)
                drag = wheel.roller_drag / lever**2 * rolling
                limit = contact.friction * N
                drag = drag / math.sqrt(1 + (drag / limit) ** 2) if limit else 0.0
                force = N * G - contact.friction * N * slip / math.hypot(slip, contact.creep_speed) * u - drag * f
                F += force
                moment += np.cross(point - c, force)
                torque -= w_hat @ np.cross(point - hub, force)
                pressed += force @ -R_hat
            to = 19 + 3 * n + 2 * i
            out[to] = sinking
            out[to + 1] = (-mount.stiffness * sunk - mount.damping * sinking - pressed) / wheel.mass
            out[19 + 3 * i] = omega
            out[20 + 3 * i] = (motion.series.at(t)[i] + torque) / wheel.spin_inertia
        A = quaternion_matrix(q)
        I, rho = A @ I_b @ A.T, A @ rho_b
        cross = np.array([[0, -rho[2], rho[1]], [rho[2], 0, -rho[0]], [-rho[1], rho[0], 0]])
        left = np.block([[M * np.eye(3), -M * cross], [M * cross, I]])
        right = np.concatenate([
            F - M * np.cross(Omega, np.cross(Omega, rho)), moment + np.cross(rho, weight) - np.cross(Omega, I @ Omega)
        ])  # fmt: skip
        out[7:13] = np.linalg.solve(left, right)
        out[:3] = v
        w, x = q[0], q[1:]
        out[3:7] = 0.5 * np.concatenate([[-Omega @ x], w * Omega + np.cross(Omega, x)])
        return out

    return rate


def spheres(duration):
    d = design(WHEELS["sphere"], contact=SLIPPERY, mount=Mount(1e5, 50.0), sphere=OFFSET)
    return d, torques((0.05, -0.02, 0.08), duration, angular_velocity=(2.0, -1.0, 3.0), sample_rate=2 / duration)


def test_rates_are_those_written_out_a_second_time():
    """Along a run, with one or two rollers a wheel in contact, slip, drag, mounts and an offset mass: to rounding."""
    d, motion = spheres(0.2)
    motion = replace(motion, sample_rate=400)
    run = run_compliant(d, motion, Accuracy(1e-9))
    m, again = machine(d), written_out(d, motion)
    assert run.completed
    for t, y in zip(run.time, run.states, strict=True):
        now = evaluate(m, y, drive=motion.series.at(t)).rate
        np.testing.assert_allclose(now, again(t, y), rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("duration", [0.01, pytest.param(0.3, marks=pytest.mark.long)])
def test_run_agrees_with_lsoda_on_the_equations_written_out(duration):
    """Nothing shared but the design and the state at the start."""
    d, motion = spheres(duration)
    run = run_compliant(d, motion, Accuracy(1e-12))
    place, turned, turning = apart(run, by_scipy(d, motion, "LSODA", written_out(d, motion), 1e-9, 1e-11))
    assert max(place, turned) < 1e-7
    assert turning < 1e-5
