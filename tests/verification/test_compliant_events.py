"""Contacts made and lost in a compliant run: when, at what cost in steps and energy, whatever the sampling."""

import math
from dataclasses import replace

import numpy as np
import pytest

from compliant_cases import WHEELS, G, M, R, design, evaluate, machine, ring, seat, speeds
from spheredrive.design import Closure, Motor, Mount, Placement, Stage
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.station import GAP
from spheredrive.simulation.compliant import run as run_module
from spheredrive.simulation.compliant.ledger import ledger
from spheredrive.simulation.compliant.run import Accuracy, run_compliant
from spheredrive.wheels import IdealWheel, StandardWheel

ROUND = IdealWheel(radius=0.05, mass=0.2)
SIN, COS = math.sin(math.radians(40)), math.cos(math.radians(40))
BALLS = StandardWheel(radius=0.0758, rollers=14, mass=0.25, roller_radius=0.0125, roller_shape="sphere")


def fallen(d, height, speed, duration, accuracy, rate=1e4):
    """A run of the sphere from ``height`` above its touch with all wheels, thrown up with ``speed``; wheels stand."""

    start = dict(centre_displacement=(0.0, 0.0, height), centre_velocity=(0.0, 0.0, speed))
    run = run_compliant(d, speeds((0, 0, 0), duration, sample_rate=rate, **start), accuracy)
    assert run.completed, run.reason
    return run


class Bounce:
    """A sphere on three round wheels 40° below without friction, by an independent integrator: depth h = R − D,
    M z̈ = −M g + 3 N (z + R sin 40°)/D, N = K h + C ḣ while that pushes, D² = (R cos 40°)² + (z + R sin 40°)²."""

    def __init__(self, K, C, start):
        self.K, self.C, self.state, self.time = K, C, np.array(start), 0.0
        self.presses, self.pieces, self.turns = self.depth(start) > 0, [], []

    def depth(self, state):
        return R - math.hypot(R * COS, state[0] + R * SIN)

    def force(self, state):
        rise = (state[0] + R * SIN) / (R - self.depth(state))
        return self.K * self.depth(state) - self.C * rise * state[1], rise

    def until(self, end):
        """Samples to be asked for by ``at``; ``turns`` are the times at which it begins and ceases to press."""
        from scipy.integrate import solve_ivp

        while self.time < end:

            def rates(_, state, presses=self.presses):
                N, rise = self.force(state)
                return state[1], (3 * N * rise / M if presses else 0.0) - G

            def turn(_, state, presses=self.presses):
                N = self.force(state)[0]
                return N if presses else -min(self.K * self.depth(state), N)

            turn.terminal, turn.direction = True, -1
            # Steps so short that no turn hides between two of them.
            steps = dict(method="DOP853", rtol=1e-12, atol=1e-15, first_step=min(1e-8, end - self.time), max_step=2e-4)
            piece = solve_ivp(rates, (self.time, end), self.state, events=turn, dense_output=True, **steps)
            self.pieces.append((self.time, piece.sol))
            self.time, self.state = piece.t[-1], piece.y[:, -1]
            if piece.status == 1:
                self.turns.append(self.time)
                self.presses = not self.presses
        return self

    def at(self, times):
        return np.array([[sol for begin, sol in self.pieces if begin <= t][-1](t) for t in times])


@pytest.mark.parametrize("ratio", [0.0, 0.1, 1.0])
def test_contact_ends_where_its_force_does(ratio):
    """Fall, contact and flight again against the independent integrator, at every damping; what is lost went into the damper.

    Steps are held to 1e-11 m and 1e-9 m/s. Some 100 of them in contact, and flights of 10 ms that carry on what a speed is
    off by, make 1e-9 m and 1e-7 m/s at most; energies are off by M v of that, 2e-8 J."""
    K, drop = 1e7, 5e-4
    damping = 2 * ratio * math.sqrt(K * M / 3) / SIN
    d = design(ROUND, contact=dict(stiffness=K, damping=damping, friction=0.0))
    run = fallen(d, drop, 0.0, 0.06, Accuracy(1e-11), rate=5000)
    exact = Bounce(K, damping, (drop, 0.0)).until(0.06)
    assert len(exact.turns) >= 2
    found = np.stack([run.centre_displacement[:, 2], run.centre_velocity[:, 2]], axis=1)
    expected = exact.at(run.time)
    np.testing.assert_allclose(found[:, 0], expected[:, 0], atol=1e-9)
    np.testing.assert_allclose(found[:, 1], expected[:, 1], atol=1e-7)
    # Each wheel presses between the turns and at no other time, and never pulls.
    pressing = np.searchsorted(exact.turns, run.time) % 2 == 1
    clear = np.abs(np.subtract.outer(run.time, exact.turns)).min(axis=1) > 1e-6
    np.testing.assert_array_equal(run.touches[clear, :, 0] > 0, np.tile(pressing[clear, None], 3))
    assert (run.touches[:, :, 0] >= 0).all()
    z, v = expected[-1]
    stored = 1.5 * K * max(0.0, exact.depth((z, v))) ** 2
    lost = M * G * (drop - z) - M * v * v / 2 - stored
    books = ledger(run)
    assert books.contact_damping[-1] == pytest.approx(lost, abs=2e-8)
    # Inside a step works are a parabola's: to 1e-3 of what moves in that step.
    np.testing.assert_allclose(books.residual, 0, atol=1e-4 * M * G * drop)
    assert abs(books.residual[-1]) < 2e-8


def test_what_a_spring_holds_when_it_is_left_goes_into_its_damper():
    """Thrown off a contact in which K h + C ḣ is below zero from the start: free flight, and the ½ K h² of each of the three
    springs is heat when the gap opens, after some h/ḣ = 1 ms."""
    K, z, v = 1e5, -8e-5, 0.08
    rise = (z + R * SIN) / math.hypot(R * COS, z + R * SIN)
    depth = R - math.hypot(R * COS, z + R * SIN)
    # A little more than K h/ḣ, so that it pulls.
    d = design(ROUND, contact=dict(stiffness=K, damping=1.001 * K * depth / (rise * v), friction=0.0))
    run = fallen(d, z, v, 0.005, Accuracy(1e-10))
    t = run.time
    np.testing.assert_allclose(run.centre_displacement[:, 2], z + v * t - G * t * t / 2, atol=1e-12)
    assert (run.touches[:, :, 0] == 0).all()
    books, held = ledger(run), 1.5 * K * depth**2
    assert books.elastic[0] == pytest.approx(held, rel=1e-9)
    assert books.elastic[-1] == 0.0
    # The ledger of a step is held to 1e-3 of what moves in it.
    assert books.contact_damping[-1] == pytest.approx(held, rel=1e-3)
    np.testing.assert_allclose(books.residual, 0, atol=1e-3 * held)


@pytest.mark.parametrize("law", ["linear", "hertz"])
@pytest.mark.parametrize("share", [0.5, 3.0])
def test_hunt_and_crossley_give_back_what_their_equation_says(law, share):
    """M v̇ = −k h^p (1 + χ v) begins and ends at h = 0, where x − ln(1 + x), x = χ v, has one value: whatever k and p.

    With χ sin 40° along the vertical. The wheels stand otherwise by h/R, 7e-5 at most."""
    from scipy.optimize import brentq

    speed = 0.05
    chi = share / (speed * SIN)
    contact = dict(damping=0.0, dissipation=chi, friction=0.0, stiffness=1e8)
    wheel = ROUND
    if law == "hertz":
        wheel = replace(ROUND, young_modulus=1e11, poisson_ratio=0.3)
        contact.update(law="hertz", stiffness=None)
    d = design(wheel, contact=contact, sphere=dict(young_modulus=1e11), stage=Stage(5.0, gravity=False))
    run = fallen(d, 1e-6, -speed, 0.02, Accuracy(1e-11))
    begin = share - math.log1p(share)
    back = brentq(lambda x: -x - math.log1p(-x) - begin, 1e-9, 1 - 1e-12) / share * speed
    assert run.centre_velocity[-1, 2] == pytest.approx(back, rel=1e-4)
    assert run.centre_displacement[-1, 2] > 0
    assert ledger(run).contact_damping[-1] == pytest.approx(M / 2 * (speed**2 - back**2), rel=1e-4)


def just_touching():
    """The sphere on three wheels, pushed sideways until it just touches a fourth one at its equator."""
    from scipy.optimize import brentq

    way = math.radians(60)
    placements = (*ring(ROUND), Placement.at(ROUND, way, 0.0, 0.0))

    def pushed(force):
        closure = Closure(force=(force * math.cos(way), force * math.sin(way), 0.0))
        return replace(design(ROUND, closure=closure), placements=placements)

    def gap(force):
        m = machine(pushed(force))
        y = np.zeros(m.state_size)
        y[at.QUATERNION] = 1.0
        y = seat(m, y, m.places.copy(), np.zeros(len(m.outlines)))
        return evaluate(m, y).touches[3, GAP]

    return pushed(brentq(gap, 0.0, 5.0, xtol=1e-14))


@pytest.mark.parametrize("motion", ["rest", "turning"])
def test_a_wheel_that_just_touches_takes_no_more_steps(motion):
    """Its force is zero to rounding, of either sign: that must not make events. A run at rest takes steps of 50 ms in the end,
    five times longer each from 1 µs: 10 to the longest and 20 more; wheels that begin to turn shake it a little."""
    d = just_touching()
    drive = speeds((0, 0, 0, 0) if motion == "rest" else (1e-3, 1e-3, 1e-3, 0), 1.0, sample_rate=20)
    run = run_compliant(d, drive)
    assert run.completed
    assert abs(run.touches[-1, 3, 3]) < 1e-7
    assert sum(run.steps) < 60, run.steps


def test_states_do_not_depend_on_when_they_are_recorded(monkeypatch):
    """To the bit: rollers that come and go at 5 to 10 rad/s, recorded seldom and often, in one go and by seven steps."""

    def run(rate, at_once=20_000):
        monkeypatch.setattr(run_module, "STEPS_AT_ONCE", at_once)
        return run_compliant(design(BALLS), speeds((5.0, -10.0, 3.0), 0.1, sample_rate=rate))

    often = run(5000)
    assert len(often.events) > 4
    for other, every in ((run(50), 100), (run(5000, at_once=7), 1)):
        assert other.steps == often.steps
        np.testing.assert_array_equal(other.events, often.events)
        for name in ("states", "rates", "motor_torque", "touches", "stored", "works"):
            np.testing.assert_array_equal(getattr(other, name), getattr(often, name)[::every], err_msg=name)


@pytest.mark.parametrize("contact", [dict(damping=200.0), dict(damping=0.0, dissipation=5.0), dict(friction=0.0)])
def test_rollers_that_pass_at_speed_only_push_and_only_heat(contact):
    """Balls at 30 rad/s hit the sphere 67 times a second: no pull, no heat given back, and the ledger closes.

    A step's ledger is held to 1e-3 of what moves in it, of either sign; heat falls by the parabola's misfit alone."""
    run = run_compliant(design(BALLS, contact=contact), speeds((30.0, -20.0, 10.0), 0.1, sample_rate=5000), Accuracy(1e-9))
    assert run.completed, run.reason
    assert len(run.events) >= 10
    assert run.touches[:, :, 0].min() >= 0
    for station in range(3):
        kinds = run.events[run.events[:, 1] == station, 2]
        assert (np.diff(kinds) != 0).all()
    books = ledger(run)
    moved = np.ptp(books.kinetic) + np.ptp(books.motor_work) + np.ptp(books.elastic)
    np.testing.assert_allclose(books.residual, 0, atol=1e-3 * moved)
    for heat in (books.slip, books.contact_damping, books.resistances):
        assert np.diff(heat).min() >= -1e-4 * moved


@pytest.mark.parametrize("stiffness", [1e6, 1e7, 1e8])
def test_a_sphere_does_not_fall_through_between_balls(stiffness):
    """It sinks between two balls by what the outline says, 2.2 mm, and by some N/K; nothing gives it energy."""
    contact = dict(stiffness=stiffness, damping=0.3 * math.sqrt(stiffness * M))
    run = run_compliant(design(BALLS, contact=contact), speeds((1.0, -2.0, 0.5), 0.5, sample_rate=1000))
    assert run.completed, run.reason
    assert run.centre_displacement[:, 2].min() > -2.3e-3
    books = ledger(run)
    assert np.abs(books.residual).max() < 1e-3 * (np.ptp(books.motor_work) + np.ptp(books.potential))


def test_hunt_and_crossley_do_not_push_across_a_gap():
    """1 + χ ḋ below zero and a depth below zero make no force."""
    contact = dict(stiffness=22275937.03264874, damping=0.0, dissipation=95.88984229088535, friction=0.1)
    d = design(
        WHEELS["split-dual-race"],
        contact=contact,
        mount=Mount(stiffness=2763240.70442676, damping=50.0),
        motor=Motor(torque=2.0, proportional_gain=0.5, integral_gain=20.0),
    )
    asked = speeds((4.772561630899094, 12.95410722989862, -5.27789292291123), 0.1, sample_rate=20000)
    run = run_compliant(d, asked, Accuracy(1.3136859586143487e-07))
    assert run.completed, run.reason
    assert (run.touches[:, :, 0][run.touches[:, :, 3] > 0] == 0).all()


@pytest.mark.parametrize("share", [1.01, 1.05, 1.5])
def test_contact_is_lost_and_made_when_the_force_is(share):
    """A damped contact lets go where its force vanishes, here at the start, C v/K deep; it presses again when it has fallen
    back to z = z0 + v t − g t²/2 = 0, even if it was clear for 0.4 ms alone."""
    K, C = 1e5, 100.0
    v = 2 * G * C / K * share
    z = -C * v / K
    run = fallen(design(ROUND, contact=dict(stiffness=K, damping=C, friction=0.0)), z, v, 0.008, Accuracy(1e-9))
    root = math.sqrt(v * v + 2 * G * z)
    mine = run.events[run.events[:, 1] == 0]
    np.testing.assert_array_equal(mine[:2, 2], [0, 1])
    np.testing.assert_allclose(mine[:2, 0], [0.0, (v + root) / G], atol=1e-6)


def test_events_are_in_order():
    run = run_compliant(design(WHEELS["mecanum"]), speeds((30.0, -20.0, 10.0), 0.1, sample_rate=1000), Accuracy(1e-8))
    assert (np.diff(run.events[:, 0]) >= 0).all(), np.diff(run.events[:, 0]).min()


def test_a_landing_makes_no_heat_below_zero():
    """C = 0: no heat at all, whatever the accuracy."""
    run = fallen(design(ROUND, contact=dict(stiffness=1e8, damping=0.0, friction=0.0)), 2e-3, 0.3, 0.1, Accuracy(1e-6))
    assert np.abs(ledger(run).contact_damping).max() < 1e-15
