"""The coupled compliant model against MuJoCo with every roller a body of its own, and both against a plain SciPy program."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import spheredrive as sd
from layouts import atlas
from spheredrive.design import Closure, Contact, Motor, Mount, Sphere, Spring
from spheredrive.motion import Motion, Series
from spheredrive.wheels import DualRaceWheel, MecanumWheel, StandardWheel

pytest.importorskip("mujoco")

from spheredrive.export.command import check_motion, check_text, track
from spheredrive.export.mjcf.run import Settings, run_mujoco

R, M, K, C, MU, CREEP = 1.22, 5.0, 188208.0, 200.0, 0.9, 1e-5
SPHERES = StandardWheel(radius=0.0758, rollers=14, roller_radius=0.012, roller_shape="sphere", mass=0.25)
CAPSULES = StandardWheel(radius=0.0758, rollers=14, roller_radius=0.009, roller_shape="capsule", roller_length=0.012, mass=0.25)
MECANUM = MecanumWheel(radius=0.0758, rollers=14, mass=0.25)
LEFT = MecanumWheel(
    radius=0.0758,
    rollers=14,
    mass=0.25,
    roller_angle=-math.pi / 4,
    roller_shape="capsule",
    roller_length=0.03,
    roller_radius=0.01,
)
SPEED = (0.6, 0.9, 0.3)
# Of 14 rollers at 0.3 rad/s and its multiples.
PERIOD = 2 * math.pi / (14 * 0.3)


def machine(wheel, **parts):
    parts = {"sphere": Sphere(R, M), "contact": Contact(K, C, MU, creep_speed=CREEP), **parts}
    return replace(atlas(wheel, radius=R), **parts)


def at_speed(duration=PERIOD / 0.74) -> Motion:
    return Motion("wheel-speed", Series((0.0,), (SPEED,)), duration=duration, sample_rate=1000.0)


@pytest.mark.parametrize("wheel", [SPHERES, CAPSULES, MECANUM, LEFT], ids=["spheres", "capsules", "mecanum", "left mecanum"])
def test_check_on_42_rollers_agrees(wheel):
    found = check_motion(machine(wheel), at_speed(), Settings(timestep=2e-4))
    result = found.agreement
    assert result.periods == 1 and result.agrees, check_text(found)
    # Round rollers leave nothing but MuJoCo's straight slope of friction and its step: well within what is asked.
    if wheel is not MECANUM:
        assert result.angular_velocity < 2e-4 and result.normal_force < 1e-3 and result.ripple < 1e-3
        assert result.normal_spread < 0.01
    np.testing.assert_allclose(np.array(result.frequency)[:, 0], result.passage, atol=0.6 * result.bin_width)


@pytest.mark.long
@pytest.mark.parametrize("share", [1e-3, 0.1])
@pytest.mark.parametrize("wheel", [SPHERES, CAPSULES, MECANUM, LEFT], ids=["spheres", "capsules", "mecanum", "left mecanum"])
def test_check_over_long_runs_agrees(wheel, share):
    found = check_motion(machine(wheel), at_speed(4 * PERIOD / 0.74), Settings(timestep=5e-5, roller_share=share))
    assert found.agreement.periods == 4
    assert found.agreement.agrees, check_text(found)


def together(design, motion, **settings):
    ours = track(sd.simulate(design, motion, "compliant"))
    return ours, track(run_mujoco(design, motion, Settings(**settings)))


def test_everything_that_holds_a_machine_acts_the_same_way():
    # Mounts, pads, a spring, a force off the axis, a full inertia with its mass off the centre, two races of rollers.
    wheel = DualRaceWheel(
        radius=0.05, rollers=20, roller_radius=8e-3, race_spacing=0.018, roller_shape="capsule", roller_length=8e-3, mass=0.3
    )
    tensor = ((0.03, 0.002, 0.0), (0.002, 0.035, 0.001), (0.0, 0.001, 0.04))
    design = replace(
        atlas(wheel, radius=0.15, elevation_deg=-50, heading_deg=15),
        sphere=Sphere(0.15, 2.0, tensor, (0.02, -0.01, 0.015)),
        contact=Contact(1e5, 150.0, 0.8, creep_speed=CREEP),
        mount=Mount(3e5, 60.0),
        closure=Closure(2e3, 20.0, (4.0, -3.0, -60.0), (Spring((0.6, 0.0, 0.8), 5e3, 30.0),)),
    )
    speeds = Series((0.0, 0.1, 0.3), ((0.0, 0.0, 0.0), (3.0, -2.0, 1.0), (1.0, 2.0, 4.0)))
    ours, theirs = together(design, Motion("wheel-speed", speeds, duration=0.3, sample_rate=1000.0), timestep=2e-5)
    for name, slack in (("angular_velocity", 0.01), ("centre_displacement", 0.01), ("normal_force", 0.05)):
        a, b = getattr(ours, name), getattr(theirs, name)
        # Races change at other instants by a step, so single samples of N may be far apart.
        assert np.sqrt(((a - b) ** 2).mean()) < slack * np.sqrt((b**2).mean()), name


@pytest.mark.parametrize("drive", ["torque", "loop"])
def test_motors_drive_the_same_way(drive):
    design = machine(LEFT, closure=Closure(force=(0.0, 0.0, -40.0)))
    if drive == "torque":
        motion = Motion(
            "wheel-torque", Series((0.0, 0.4), ((0.4, -0.25, 0.12), (0.0, 0.4, 0.25))), duration=0.4, sample_rate=1000.0
        )
    else:
        design = replace(design, motor=Motor(torque=0.9, proportional_gain=2.0, integral_gain=10.0))
        motion = Motion(
            "wheel-speed", Series((0.0, 0.4), ((0.0, 0.0, 0.0), (1.0, -0.6, 0.8))), duration=0.4, sample_rate=1000.0
        )
    ours, theirs = together(design, motion, timestep=2e-5)
    apart = np.sqrt(((ours.angular_velocity - theirs.angular_velocity) ** 2).mean())
    assert apart < 0.01 * np.sqrt((theirs.angular_velocity**2).mean())
    assert np.abs(theirs.angular_velocity).max() > 0.02


def plain(design, wheel, duration, rate, start, Omega):
    """The same machine, round rollers at prescribed speeds, written out in NumPy and stepped by LSODA: c, Ω and N by wheel."""
    R_hat, v_hat = design.contact_directions, design.drive_directions
    w_hat, omega = np.cross(v_hat, R_hat), np.array(SPEED)
    a, ρ, L, α, n = (
        wheel.radius - wheel.roller_radius,
        wheel.roller_radius,
        (wheel.roller_length or 0.0) / 2,
        wheel.roller_angle,
        14,
    )
    hub, I = R_hat * (R + a + ρ), 2 / 3 * M * R * R

    def contacts(t, y):
        c, v, Om = y[:3], y[3:6], y[6:9]
        # At wheel angle 0 a ball or a Mecanum roller stands on top.
        β = ((omega * t)[:, None] + np.arange(n) * 2 * np.pi / n)[..., None]
        out = -np.cos(β) * R_hat[:, None] + np.sin(β) * v_hat[:, None]
        on = np.sin(β) * R_hat[:, None] + np.cos(β) * v_hat[:, None]
        middle, axis = hub[:, None] + a * out, np.sin(α) * on + np.cos(α) * w_hat[:, None]
        s = np.clip(np.sum((c - middle) * axis, -1), -L, L)
        way = c - middle - s[..., None] * axis
        depth = R + ρ - np.linalg.norm(way, axis=-1)
        i, j = np.nonzero(depth > 0)
        normal, depth, axis = way[i, j] / np.linalg.norm(way[i, j], axis=-1)[:, None], depth[i, j], axis[i, j]
        x = c - normal * (R - depth / 2)[:, None]
        slip = v + np.cross(Om, x - c) - np.cross((omega[:, None] * w_hat)[i], x - hub[i])
        N = np.maximum(0.0, K * depth - C * np.sum(normal * slip, -1))
        u = axis - np.sum(axis * normal, -1)[:, None] * normal
        u /= np.linalg.norm(u, axis=-1)[:, None]
        along = np.sum(u * slip, -1)
        F = normal * N[:, None] - u * (MU * N * along / np.hypot(along, CREEP))[:, None]
        return F, x - c, np.bincount(i, N, 3)

    def rate_of(t, y):
        F, arm, _ = contacts(t, y)
        return np.concatenate([y[3:6], F.sum(0) / M + [0, 0, -9.80665], np.cross(arm, F).sum(0) / I])

    ts = np.arange(round(duration * rate) + 1) / rate
    first = np.concatenate([start, np.zeros(3), Omega])
    solved = solve_ivp(rate_of, (0, ts[-1]), first, "LSODA", ts, rtol=1e-8, atol=1e-10, max_step=5e-4)
    assert solved.success
    return solved.y[:3].T, solved.y[6:9].T, np.array([contacts(t, y)[2] for t, y in zip(ts, solved.y.T, strict=True)])


@pytest.mark.parametrize("wheel", [SPHERES, LEFT], ids=["spheres", "left mecanum"])
def test_both_engines_match_a_plain_program(wheel):
    design, motion = machine(wheel), at_speed(0.4)
    ours, theirs = together(design, motion, timestep=5e-5)
    c, Omega, N = plain(design, wheel, 0.4, 1000.0, ours.centre_displacement[0], ours.angular_velocity[0])
    # Where a roller is met N jumps by C times its rate, at instants that differ by a step: single samples may be far apart.
    for run, slack in ((ours, 1e-3), (theirs, 2e-3)):
        for found, exact in ((run.centre_displacement, c), (run.angular_velocity, Omega), (run.normal_force, N)):
            assert np.sqrt(((found - exact) ** 2).mean()) < slack * np.sqrt((exact**2).mean())
