"""Dual-race wheels that stand on the boundary between their races, or turn back on it.

Prescribed speeds say all of it in closed form: the angles are their integrals, the races follow from the angles by counting
half pitches, and the sphere turns by the Jacobian of these races.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import DUAL, atlas
from spheredrive import kinematics as K
from spheredrive.design import Stage
from spheredrive.dynamics.rolling import RESTING
from spheredrive.motion import Motion, Series
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.wheels import DualRaceWheel

HALF_PITCH = math.pi / 8
# Wheels are put exactly on a boundary from as far as 2e-12 rad at a change of race; here are at most 64 of them.
ANGLE = 2e-10


def machine():
    """A hollow sphere about its centre: nothing is integrated but polynomials, so that the ledger closes to rounding."""
    design = atlas(DualRaceWheel(**DUAL))
    placements = tuple(replace(p, wheel=replace(p.wheel, mass=0.1)) for p in design.placements)
    return replace(design, sphere=replace(design.sphere, mass=2.0), placements=placements, stage=Stage(5.0, False))


def asked(times, speeds, half_pitches=(0, 0, 0), **series):
    series = Series(tuple(map(float, times)), tuple(tuple(map(float, row)) for row in speeds), **series)
    return Motion("wheel-speed", series, float(times[-1]), wheel_angle=tuple(HALF_PITCH * k for k in half_pitches))


def turning_back(speed):
    """Wheels 1 and 3 turn back after one second, when they have turned by ``speed``/2; wheel 2 is held."""
    return asked((0, 2), ((speed, 0, -speed), (-speed, 0, speed)))


MOTIONS = {
    "one wheel after the other": asked((0, 1, 2, 3), ((0, 0, 0), (6, 0, 0), (6, 6, 6), (0, 0, 0))),
    "all held": asked((0, 1), ((0, 0, 0), (0, 0, 0))),
    "one held": asked((0, 1, 2), ((0, 0, 0), (6, -4, 0), (-7, 3, 0))),
    "one held on another boundary": asked((0, 1, 2), ((0, 0, 0), (6, -4, 0), (-7, 3, 0)), (3, -2, 5)),
    "two held, one backward at once": asked((0, 1), ((-3, 0, 0), (-3, 0, 0))),
    "backward from a stand": asked((0, 1, 2), ((0, 0, 0), (-6, 0, 0), (6, -6, -6))),
    # As tables of sines have it.
    "backward from a rounding": asked((0, 1), ((1e-16, 0, -1e-16), (-3, 0, 3))),
    "step by step": asked((0, 1, 2, 3, 4), HALF_PITCH * np.array(((1, 0, 0), (0, 1, -1), (0, 0, 0), (-1, 0, 1), (-1, 0, 1))),
                          interpolation="step"),
    "stand on the first boundary, then on": asked((0, 1, 2, 3), 2 * HALF_PITCH * np.array(((1, 0, -1), (0, 0, 0), (0, 0, 0),
                                                                                         (1, 0, -1)))),
    "stand on the first boundary, then back": asked((0, 1, 2, 3), 2 * HALF_PITCH * np.array(((1, 0, -1), (0, 0, 0), (0, 0, 0),
                                                                                           (-1, 0, 1)))),
    **{f"turn back {k} half pitches on, {e:g} beyond": turning_back(2 * k * HALF_PITCH * (1 + e))
       for k in (1, -1, 3) for e in (0.0, 1e-15, -1e-13, 1e-12, 4e-12, 1e-10)},
}  # fmt: skip


@pytest.mark.parametrize("name", MOTIONS)
def test_wheels_turn_as_asked_and_the_sphere_by_the_races_they_are_in(name):
    design, motion = machine(), MOTIONS[name]
    run = run_rolling(design, motion)
    assert run.completed, run.reason
    speed, angle = motion.series.at(run.time), np.array(motion.wheel_angle) + motion.series.integral(run.time)
    np.testing.assert_allclose(run.wheel_angle, angle, atol=ANGLE, rtol=0)
    # On a boundary either race may touch.
    count = angle / HALF_PITCH
    on_boundary = np.abs(count - np.round(count)) < 1e-8
    assert ((run.state == np.floor(count) % 2) | on_boundary).all() and (run.state != RESTING).all()
    # A wheel goes over to the race it leaves by at the sample that ends its stand.
    still = speed == 0
    held = still[:-2] & still[1:-1] & still[2:]
    assert (np.diff(run.state, axis=0)[:-1][held] == 0).all()
    for state in np.unique(run.state, axis=0):
        J = K.jacobian(design, [w.alternation[s] for w, s in zip(design.wheels, state, strict=True)])
        then = (run.state == state).all(axis=1)
        # Speeds to 7 rad/s through a Jacobian of some 0.2: a few hundred roundings.
        np.testing.assert_allclose(run.angular_velocity[then], speed[then] @ J.T, atol=1e-13)


@pytest.mark.parametrize("name", MOTIONS)
def test_no_energy_is_lost_or_made_on_a_boundary(name):
    """The motors' work is all in the motion and in what the changes of race took, which is booked by its own formula."""
    run = run_rolling(machine(), MOTIONS[name])
    assert run.completed, run.reason
    turnover = np.abs(np.diff(run.motor_work)).sum() + np.abs(run.event_loss).sum()
    assert np.abs(run.residual).max() <= 1e-12 * turnover
    # While every wheel stands, a change of race gives and takes nothing; a step of the asked speeds, wheel −1, may.
    still = (np.abs(MOTIONS[name].series.at(run.event_time)).max(axis=1, initial=0.0) == 0.0) & (run.event_wheel >= 0)
    assert (np.abs(run.event_loss[still]) <= 1e-12 * turnover).all()


def test_races_change_once_at_each_boundary_and_at_no_other_time():
    """∫ω passes a multiple of the half pitch at each event, upward throughout: ⌊12/h⌋ + 2 ⌊6/h⌋ of them, h = π/8."""
    motion = MOTIONS["one wheel after the other"]
    run = run_rolling(machine(), motion)
    angle = motion.series.integral(run.event_time)[np.arange(len(run.event_time)), run.event_wheel]
    assert len(run.event_time) == math.floor(12 / HALF_PITCH) + 2 * math.floor(6 / HALF_PITCH)
    np.testing.assert_allclose(angle / HALF_PITCH, np.round(angle / HALF_PITCH), atol=1e-9)
    assert (angle > 0.5 * HALF_PITCH).all()


@pytest.mark.parametrize("upward", [1.0, -1.0])
def test_sphere_that_turns_back_when_a_wheel_is_on_its_boundary(upward):
    """Ω falls from Ω₀ to −Ω₀ about the axis that turns one wheel alone: it stands on its first boundary where Ω is zero."""
    design = machine()
    races = [design.wheels[0].alternation[0 if upward > 0 else 1], *(w.alternation[0] for w in design.wheels[1:])]
    # The wheel turns by half its first speed until then.
    first = K.jacobian(design, races) @ [2 * upward * HALF_PITCH, 0.0, 0.0]
    run = run_rolling(
        design, Motion("sphere-velocity", Series((0.0, 2.0), (tuple(first), tuple(-first))), 2.0, sample_rate=100)
    )
    assert run.completed, run.reason
    np.testing.assert_allclose(run.wheel_angle[100, 0], upward * HALF_PITCH, atol=ANGLE)
    np.testing.assert_allclose(run.wheel_angle[100:, 0], run.wheel_angle[100::-1, 0], atol=1e-9)
    assert np.abs(run.residual).max() <= 1e-12 * np.abs(np.diff(run.motor_work)).sum()


@pytest.mark.parametrize("speed", [1e-8, -1e-8, 1e-13, -1e-13, 1e-16, -1e-16])
def test_driven_wheel_on_its_boundary_may_have_the_speed_of_a_rounding(speed):
    """It makes no difference: the torque turns the wheel back after |speed|/2 s or less, before it is 1e-16 rad away."""
    design = machine()
    torque = Series((0.0,), ((-math.copysign(0.01, speed), 0.0, 0.0),))
    start = tuple(K.jacobian(design) @ [speed, 0.0, 0.0])
    still, rounding = (
        run_rolling(design, Motion("wheel-torque", torque, 0.5, angular_velocity=Omega, sample_rate=20))
        for Omega in ((0.0, 0.0, 0.0), start)
    )
    assert rounding.completed, rounding.reason
    # The speed at the start goes on for half a second.
    np.testing.assert_allclose(rounding.wheel_angle, still.wheel_angle, atol=abs(speed) + 1e-10)
    assert abs(still.wheel_angle[-1, 0]) > HALF_PITCH and len(still.event_time) == len(rounding.event_time)
