"""Laws of the compliant model on every wheel type: power balances in every state, energy over every run."""

from dataclasses import replace

import numpy as np
import pytest

from compliant_cases import OFFSET, WHEELS, design, energy, evaluate, machine_of, random_state
from spheredrive.design import Closure, Motor, Mount, Spring
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.machine import machine
from spheredrive.dynamics.compliant.station import DAMPING_HEAT, OTHER_HEAT, SLIP_HEAT, STORED
from spheredrive.frames import quaternion_matrix
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.compliant.ledger import ledger
from spheredrive.simulation.compliant.run import Accuracy, run_compliant

LAWS = ("linear", "hertz")
# A central difference over 1e-7 s: rounding 1e-17 J/1e-7 s = 1e-10 W beside some 10 mW, curvature (ω h)² = 1e-9.
BALANCED = 1e-7
SLOPE = 1e-7


@pytest.mark.parametrize("stage_kind", [at.STILL, at.MOVED, at.DRIVEN])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", WHEELS)
def test_power_balances_in_every_state(name, law, stage_kind):
    """d(kinetic + potential + elastic)/dt = motors + stage − slip − damping − resistances: any state, torques and speeds."""
    rng = np.random.default_rng([5, list(WHEELS).index(name), LAWS.index(law), stage_kind])
    m = machine_of(name, law)
    for kind in (at.TORQUE, at.SPEED):
        y = random_state(m, rng)
        push = rng.normal(size=3) if stage_kind != at.STILL else np.zeros(3)
        if stage_kind == at.STILL:
            y[at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3] = 0.0
        places, turns = m.places.copy(), np.zeros(len(m.outlines))
        drive = 0.1 * rng.normal(size=3)
        now = evaluate(m, y, places, turns, drive, rng.normal(size=3), kind, push, stage_kind)
        later, sooner = (energy(m, y + sign * SLOPE * now.rate, places, turns) for sign in (1, -1))
        motor, stage, *lost = now.power
        assert min(lost) >= 0
        assert (now.wrenches[:, [SLIP_HEAT, DAMPING_HEAT, OTHER_HEAT]] >= -1e-15).all()
        size = np.abs(now.power).sum()
        assert (later - sooner) / (2 * SLOPE) == pytest.approx(motor + stage - sum(lost), abs=BALANCED * size)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", WHEELS)
def test_each_station_gives_what_it_takes(name, law):
    """F·ḋ + M·Ω + τ ω + d(stored)/dt + heat = 0 for one wheel alone, in its own frame: nothing cancels between wheels."""
    rng = np.random.default_rng([6, list(WHEELS).index(name), LAWS.index(law)])
    m = machine_of(name, law)
    if m.rollers:
        pytest.skip("turning rollers take power too; the whole machine's balance has them")
    places, turns = m.places.copy(), np.zeros(len(m.outlines))
    y = random_state(m, rng)
    now = evaluate(m, y, places, turns)
    moved = np.zeros(len(y))
    moved[: at.QUATERNION] = y[at.CENTRE_VELOCITY : at.OMEGA]
    wheels = slice(at.WHEELS, at.WHEELS + 9, 3)
    moved[wheels] = y[at.WHEELS + 1 : at.WHEELS + 9 : 3]
    mounts = at.WHEELS + 9 + 2 * np.arange(len(m.stations))
    moved[mounts] = y[mounts + 1]
    later, sooner = (evaluate(m, y + sign * SLOPE * moved, places, turns).wrenches[:, STORED] for sign in (1, -1))
    for s, station in enumerate(m.stations):
        frame = station[:9].reshape(3, 3)
        speed = frame @ y[at.CENTRE_VELOCITY : at.OMEGA]
        speed[0] -= y[mounts[s] + 1]
        wrench = now.wrenches[s]
        wheel = y[at.WHEELS + 3 * int(station[at.STATION_WHEEL]) + 1]
        given = wrench[:3] @ speed + wrench[3:6] @ frame @ y[at.OMEGA : at.OMEGA + 3] + wrench[6] * wheel
        heat = wrench[SLIP_HEAT] + wrench[DAMPING_HEAT] + wrench[OTHER_HEAT]
        size = np.abs(wrench[:3] @ np.abs(speed)) + heat + 1e-3
        assert given + (later[s] - sooner[s]) / (2 * SLOPE) == pytest.approx(-heat, abs=BALANCED * size)


def test_forces_do_not_depend_on_how_the_machine_stands():
    """Turn machine, weight aside, and state: forces turn with them. A frame mixed up anywhere breaks it."""
    rng = np.random.default_rng(8)
    turn = quaternion_matrix(np.array([0.5, 0.5, -0.1, 0.7]) / np.linalg.norm([0.5, 0.5, -0.1, 0.7]))
    d = design(WHEELS["mecanum"], closure=Closure(force=(0.0, 0.0, -20.0)), mount=Mount(1e6, 50.0))
    d = replace(d, stage=replace(d.stage, gravity=False))
    one, two = machine(d), machine(d.rotated(turn))
    y = random_state(one, rng)
    z = y.copy()
    for place in (at.CENTRE, at.CENTRE_VELOCITY, at.OMEGA, at.STAGE_VELOCITY):
        z[place : place + 3] = turn @ y[place : place + 3]
    a, b = evaluate(one, y), evaluate(two, z)
    np.testing.assert_allclose(b.wrenches, a.wrenches, rtol=1e-9, atol=1e-12)
    for place in (at.CENTRE_VELOCITY, at.OMEGA):
        np.testing.assert_allclose(b.rate[place : place + 3], turn @ a.rate[place : place + 3], rtol=1e-9, atol=1e-9)


def ways():
    """Machines and motions that use everything the ledger books."""
    sphere, mecanum, dual = WHEELS["sphere"], WHEELS["mecanum"], WHEELS["dual-race"]
    soft = dict(law="hertz", damping=0.0, dissipation=0.5, rolling_arm=1e-4, spin_arm=1e-4, creep_speed=1e-3)
    pushed = StageMotion("force", Series((0.0, 0.1), ((0.1, 2.0, 0.3), (1.0, -2.0, 0.3))))
    held = Closure(force=(1.0, 2.0, -10.0), springs=(Spring((0.3, 0.2, 1.0), 2e3, 5.0),))
    hertzian = replace(sphere, young_modulus=1e8, poisson_ratio=0.3)
    turning = Motion(
        "wheel-torque", Series((0.0, 0.1), ((0.05, 0.0, -0.05), (0.0, 0.05, 0.05))), 0.1, angular_velocity=(0.2, -0.3, 0.5)
    )
    moving = Motion("wheel-speed", Series((0.0, 0.05, 0.1), ((2.0, 1.0, 3.0), (-1.0, 2.0, 0.5), (0.0, 2.0, -2.0))), 0.1)
    return {
        **{name: (design(wheel), moving) for name, wheel in WHEELS.items()},
        "offset mass by torques": (design(sphere, sphere=OFFSET), turning),
        "mounts and springs": (design(mecanum, mount=Mount(1e6, 50.0), closure=held), moving),
        "hertz and hunt-crossley": (design(hertzian, contact=soft), moving),
        "driven stage": (design(dual, mount=Mount(1e6, 50.0)), replace(moving, stage=pushed)),
        "speed loops": (design(sphere, motor=Motor(proportional_gain=2.0, integral_gain=10.0, torque=0.5)), moving),
    }


@pytest.mark.parametrize("way", ways())
def test_energy_is_accounted_for(way):
    """What does not add up is below 1e-6 of what went through, at an accuracy of 1e-12 m a step."""
    d, motion = ways()[way]
    run = run_compliant(d, replace(motion, sample_rate=200), Accuracy(2e-13, ledger=1e-8))
    assert run.completed, run.reason
    book = ledger(run)
    for lost in (book.slip, book.contact_damping, book.resistances):
        assert (np.diff(lost) >= -1e-15).all()
    through = max(
        np.abs(x).max() for x in (book.motor_work, book.slip, book.contact_damping, book.resistances, book.stage_work)
    )
    assert np.abs(book.residual).max() <= 1e-6 * through
