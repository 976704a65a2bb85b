"""Runs of the compliant model: order of the method, the same bits however they are cut up, and what is refused."""

import itertools
import math
from dataclasses import replace

import numba
import numpy as np
import pytest

from compliant_cases import OFFSET, WHEELS, design, run_from, speeds, torques
from spheredrive.design import Motor, Mount
from spheredrive.dynamics.compliant import layout as at
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.compliant import run as run_module
from spheredrive.simulation.compliant.run import Accuracy, run_compliant, run_compliant_batch

# Nothing here is stiff against a step of a millisecond, and nothing has a corner.
GENTLE = dict(stiffness=2e3, damping=20.0, friction=0.5, creep_speed=0.1)


def gentle(name):
    return {
        "round wheels, offset mass": design(WHEELS["ideal"], contact=GENTLE, sphere=OFFSET, mount=Mount(2e3, 5.0)),
        "inclined": design(WHEELS["ideal-inclined"], contact=GENTLE, sphere=OFFSET),
        "resistances": design(WHEELS["ideal"], contact={**GENTLE, "rolling_arm": 1e-3, "spin_arm": 1e-3}),
        "waves": design(WHEELS["measured"], contact=GENTLE),
    }[name]


def ended(d, motion, step, method):
    """The state at the end of steps of one length (but for the first few, which grow to it)."""
    run, y = run_from(d, motion, Accuracy(1e9, largest_step=step, method=method), first_step=step)
    assert run.completed, run.reason
    return y


@pytest.mark.parametrize(("method", "order"), [("rodas4", 4), ("rodas3", 3)])
@pytest.mark.parametrize("name", ["round wheels, offset mass", "inclined", "waves"])
def test_error_falls_with_the_order_of_the_method(name, method, order):
    """Halved steps: the differences of neighbours fall by 2^order or, before
    they are small, a little more; a wrong Jacobian leaves order 1 or 2."""
    motion = torques((0.05, -0.02, 0.03), 0.1, angular_velocity=(0.5, 0.3, -0.4), sample_rate=10)
    d = gentle(name)
    ends = [ended(d, motion, 0.1 / steps, method) for steps in (100, 200, 400)]
    apart = [np.abs(a - b)[: at.WHEELS].max() for a, b in itertools.pairwise(ends)]
    assert order - 0.2 < math.log2(apart[0] / apart[1]) < order + 0.7


@pytest.mark.parametrize("name", ["sphere", "mecanum", "dual-race", "half-sine", "sphere-turning"])
def test_error_follows_the_accuracy_asked_for(name):
    """A hundredth of the length asked for, at most a tenth of the error; and never far above what was asked."""
    d, motion = design(WHEELS[name], contact=dict(creep_speed=1e-3)), speeds((2.0, 1.0, 3.0), 0.05, sample_rate=100)
    fine, *coarse = (run_compliant(d, motion, Accuracy(length)) for length in (1e-11, 1e-9, 1e-7))
    errors = [np.abs(run.states[:, : at.QUATERNION] - fine.states[:, : at.QUATERNION]).max() for run in coarse]
    assert errors[0] < 0.1 * errors[1]
    assert errors[1] < 1e-5


def bits(run):
    return [run.states, run.rates, run.motor_torque, run.touches, run.stored, run.works, run.events]


def assert_same(one, other):
    for a, b in zip(bits(one), bits(other), strict=True):
        np.testing.assert_array_equal(a, b)
    assert one.steps == other.steps


def several():
    motions = [speeds((2.0, 1.0, 3.0 - 0.1 * k), 0.03, sample_rate=500) for k in range(5)]
    return [design(WHEELS["dual-race"], mount=Mount(1e6, 50.0))], motions


def test_runs_do_not_depend_on_threads_or_on_their_neighbours():
    designs, motions = several()
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        alone = [run_compliant(designs[0], motion) for motion in motions]
        numba.set_num_threads(min(2, numba.config.NUMBA_NUM_THREADS))
        together = run_compliant_batch(designs, motions)
    finally:
        numba.set_num_threads(before)
    for one, other in zip(alone, together, strict=True):
        assert_same(one, other)


@pytest.mark.parametrize("name", ["dual-race", "half-sine", "sphere-turning"])
@pytest.mark.parametrize("steps", [1, 7])
def test_runs_do_not_depend_on_how_many_steps_are_taken_at_once(name, steps, monkeypatch):
    d, motion = design(WHEELS[name]), speeds((2.0, 1.0, 3.0), 0.02, sample_rate=500)
    whole = run_compliant(d, motion)
    monkeypatch.setattr(run_module, "STEPS_AT_ONCE", steps)
    assert_same(whole, run_compliant(d, motion))


def test_samples_do_not_change_the_motion():
    d = design(WHEELS["sphere"])
    few, many = (run_compliant(d, speeds((2.0, 1.0, 3.0), 0.05, sample_rate=rate)) for rate in (20.0, 2000.0))
    np.testing.assert_array_equal(few.states[-1], many.states[-1])
    assert few.steps == many.steps


def test_orientation_stays_a_unit_quaternion():
    run = run_compliant(design(WHEELS["mecanum"]), speeds((2.0, 1.0, 3.0), 0.1, sample_rate=500), Accuracy(1e-7))
    np.testing.assert_allclose(np.linalg.norm(run.states[:, at.QUATERNION : at.QUATERNION + 4], axis=1), 1, atol=1e-13)


def test_speeds_are_the_slopes_of_positions():
    """Samples between steps belong together: central differences of c and of wheel angles are their speeds, to h² c‴/6 and
    what the method's extension of order 3 leaves of speeds between its steps, once friction has built up (some 1e-5 s)."""
    run = run_compliant(design(WHEELS["ideal"], mount=Mount(1e5, 50.0)), torques((0.05, 0.0, 0.0), 0.02, sample_rate=1e5))
    for place, speed in ((at.CENTRE + 2, at.CENTRE_VELOCITY + 2), (at.WHEELS, at.WHEELS + 1)):
        found = (run.states[2:, place] - run.states[:-2, place]) / 2e-5
        np.testing.assert_allclose(found[20:], run.states[21:-1, speed], atol=5e-6 * np.abs(run.states[:, speed]).max() + 1e-9)


def test_speed_loop_holds_its_torque_limit_and_comes_to_the_speed():
    """|T| ≤ limit at every sample; with an integral the error of the speed dies out."""
    d = design(WHEELS["ideal"], motor=Motor(proportional_gain=0.2, integral_gain=2.0, torque=0.05))
    motion = Motion(
        "wheel-speed", Series((0.0, 0.01, 1.0), ((0.0,) * 3, (2.0, 1.0, 3.0), (2.0, 1.0, 3.0))), 1.0, sample_rate=200
    )
    run = run_compliant(d, motion)
    assert run.completed, run.reason
    assert np.abs(run.motor_torque).max() <= 0.05 * (1 + 1e-12)
    assert np.abs(run.motor_torque).max() == pytest.approx(0.05, rel=1e-9)
    np.testing.assert_allclose(run.states[-1, at.WHEELS + 1 : at.WHEELS + 9 : 3], (2.0, 1.0, 3.0), rtol=1e-2)


def test_stage_pushed_off_at_rest_carries_everything_along():
    """P on a stage with nothing that turns: all masses move by P/Σm, once contacts have settled."""
    d = design(WHEELS["ideal"], contact=dict(damping=800.0))
    pushed = StageMotion("force", Series((0.0,), ((0.5, -0.3, 0.2),)))
    run = run_compliant(d, replace(torques((0, 0, 0), 0.4, sample_rate=100), stage=pushed))
    total = 2.0 + 5.0 + 3 * 0.2
    # Momentum of all together is P t at every instant: M v_l + M_s ċ.
    momentum = total * run.states[:, at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3]
    momentum = momentum + 2.0 * run.states[:, at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3]
    np.testing.assert_allclose(momentum, run.time[:, None] * np.array([0.5, -0.3, 0.2]), atol=5e-8)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: replace(d, contact=replace(d.contact, friction=None)), "needs contact.friction"),
        (lambda d: replace(d, contact=replace(d.contact, stiffness=None)), "needs contact.stiffness"),
        (lambda d: replace(d, contact=replace(d.contact, law="hertz")), "needs young_modulus"),
        (lambda d: replace(d, sphere=replace(d.sphere, mass=None)), "needs sphere.mass"),
        (lambda d: replace(d, mount=Mount(stiffness=0.0)), "mounts without stiffness"),
    ],
)
def test_designs_that_lack_something_are_refused_by_name(change, words):
    with pytest.raises(SpheredriveError, match=words):
        run_compliant(change(design(WHEELS["ideal"])), torques((0, 0, 0), 0.01))


def test_force_on_a_stage_without_mass_is_refused():
    d = design(WHEELS["ideal"])
    pushed = StageMotion("force", Series((0.0,), ((0.5, 0.0, 0.0),)))
    with pytest.raises(SpheredriveError, match=r"needs stage\.mass"):
        run_compliant(replace(d, stage=replace(d.stage, mass=None)), replace(torques((0, 0, 0), 0.01), stage=pushed))


def test_sphere_that_leaves_its_wheels_is_said():
    """A stage that falls away: the run ends where the sphere is a radius off, and keeps what was before."""

    def thrown(y):
        y[at.CENTRE_VELOCITY + 2] = 3.0

    run, _ = run_from(design(WHEELS["ideal"]), torques((0, 0, 0), 0.5, sample_rate=100), change=thrown)
    assert not run.completed
    assert "left its wheels" in run.reason
    assert 3 < len(run.time) < 20
