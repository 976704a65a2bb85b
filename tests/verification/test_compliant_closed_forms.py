"""The compliant model against closed forms: the seat, slide to roll, the friction cone, bounces."""

import math

import numpy as np
import pytest

from compliant_cases import G, M, R, design, machine, ring, run_from, seat, speeds, torques
from spheredrive.design import Closure, Mount
from spheredrive.dynamics.compliant import layout as at
from spheredrive.errors import SpheredriveError
from spheredrive.simulation.compliant import run as run_module
from spheredrive.simulation.compliant import seat as seat_module
from spheredrive.simulation.compliant.ledger import ledger
from spheredrive.simulation.compliant.run import Accuracy, run_compliant
from spheredrive.wheels import IdealWheel

r = 0.05
ROUND = IdealWheel(radius=r, mass=0.2)
SIN, COS = math.sin(math.radians(40)), math.cos(math.radians(40))


def seated(d):
    m = machine(d)
    y = np.zeros(m.state_size)
    y[at.QUATERNION] = 1.0
    return m, seat(m, y, m.places.copy(), np.zeros(len(m.outlines)))


def sunk(K, weight=M * G):
    """(N, z, direction's sine) of the sphere on three round wheels that stay where they are, by bisection.

    A round wheel of no section touches with its rim, R (cos 40°, −sin 40°) off; 3 K (R − D) (z + R sin 40°)/D = weight."""
    from scipy.optimize import brentq

    def lifted(z):
        D = math.hypot(R * COS, z + R * SIN)
        return 3 * K * (R - D) * (z + R * SIN) / D - weight

    z = brentq(lifted, -3 * weight / K, 0.0, xtol=1e-18, rtol=1e-15)
    D = math.hypot(R * COS, z + R * SIN)
    return K * (R - D), z, (z + R * SIN) / D


def test_static_seat_is_where_the_cases_say():
    """N = M g/(3 sin 40°) and a sag of N/(K sin 40°), to the share N/(K r) = 2e-3 by which the wheels stand otherwise then."""
    _, y = seated(design(ROUND))
    sag = M * G / (3 * SIN) / (1e5 * SIN)
    np.testing.assert_allclose(y[at.CENTRE : at.CENTRE + 3], (0, 0, -sag), atol=2e-3 * sag)
    assert pytest.approx(10.174, abs=5e-4) == M * 9.81 / (3 * SIN)


@pytest.mark.parametrize("K", [1e4, 1e5, 1e8])
def test_static_seat_is_exact(K):
    m, y = seated(design(ROUND, contact=dict(stiffness=K)))
    N, z, _ = sunk(K)
    assert y[at.CENTRE + 2] == pytest.approx(z, rel=1e-10)
    run = run_compliant(design(ROUND, contact=dict(stiffness=K)), torques((0, 0, 0), 0.05, sample_rate=100))
    np.testing.assert_allclose(run.touches[0, :, 0], N, rtol=1e-9)
    assert m.stations[0, at.STIFFNESS] == K


@pytest.mark.parametrize("K", [1e3, 1e6, 1e8])
def test_seat_is_found_in_few_looks(K, monkeypatch):
    """Newton's method on springs that are all but linear: a handful of steps, and no more of them where stiffness makes newtons
    of the last bits of a place."""
    looks, evaluated = [], seat_module.instant
    monkeypatch.setattr(seat_module, "instant", lambda *given: looks.append(1) or evaluated(*given))
    seated(design(ROUND, contact=dict(stiffness=K)))
    assert len(looks) < 20


def test_mounts_stand_in_series_with_contacts():
    """Both give way along R̂: a sag of N (1/K + 1/k)/sin 40°, the mount's share N/k."""
    K, k = 1e8, 4e7
    _, y = seated(design(ROUND, contact=dict(stiffness=K), mount=Mount(stiffness=k)))
    N = M * G / (3 * SIN)
    assert y[at.CENTRE + 2] == pytest.approx(-N * (1 / K + 1 / k) / SIN, rel=1e-5)
    np.testing.assert_allclose(y[at.WHEELS + 9 :: 2], -N / k, rtol=1e-5)


def test_closure_springs_pull_towards_the_nominal_place():
    """A pad K′ opposite every wheel stands beside the contact: sag M g/(3 (K + K′) sin² 40°)."""
    K, pad = 1e8, 5e7
    _, y = seated(design(ROUND, contact=dict(stiffness=K), closure=Closure(stiffness=pad)))
    assert y[at.CENTRE + 2] == pytest.approx(-M * G / (3 * (K + pad) * SIN**2), rel=1e-5)


def test_seat_of_hertz_grows_with_two_thirds():
    """N = k δ^(3/2): eight times the weight, four times the depth."""
    wheel = IdealWheel(radius=r, mass=0.2, young_modulus=1e11, poisson_ratio=0.3)
    stiff = dict(young_modulus=1e11, poisson_ratio=0.3)
    hertz = dict(law="hertz", damping=0.0, stiffness=None)
    one, eight = (
        seated(design(wheel, contact=hertz, sphere=stiff, closure=Closure(force=(0, 0, -share * M * G))))[1][at.CENTRE + 2]
        for share in (0, 7)
    )
    # Some 1e-6 of the radius deep: the wheels stand otherwise by that much.
    assert eight / one == pytest.approx(4, rel=1e-4)


@pytest.mark.parametrize(
    ("count", "elevation", "rest", "words"),
    [
        (3, -40, dict(closure=Closure(force=(0, 0, 3 * M * G))), "pushes it off"),
        (3, 0, {}, "pushes it off them or lets it move along"),
        (3, 40, {}, "pushes it off"),
        (2, -40, {}, "lets it move along"),
    ],
    ids=["pulled up", "wheels in a plane", "wheels above", "two wheels"],
)
def test_sphere_that_cannot_sit_is_refused(count, elevation, rest, words):
    from dataclasses import replace

    d = replace(design(ROUND, **rest), placements=ring(ROUND, count, elevation))
    with pytest.raises(SpheredriveError, match=words):
        seated(d)


def test_sphere_that_nothing_presses_is_refused():
    from dataclasses import replace

    d = design(ROUND)
    with pytest.raises(SpheredriveError, match="nothing presses the sphere"):
        seated(replace(d, stage=replace(d.stage, gravity=False)))


# Three wheels turn alike: the sphere turns about the vertical, friction is level, and N and the centre stay. Friction turns
# a sideways push into one across it, so that the centre whirls itself up unless contacts are damped by a share of some μ/2.
K = 1e7
DAMPED = dict(stiffness=K, damping=math.sqrt(K * M))
N, z, tilt_sine = sunk(K)
DEPTH = N / K
# Arms of friction about the vertical and about the wheels' axes, to mid-depth; inertias as masses at the contact.
LEVEL = math.sqrt(1 - tilt_sine**2)
ARM, LEVER = (R - DEPTH / 2) * LEVEL, r - DEPTH / 2 * (COS * LEVEL + SIN * tilt_sine)
SPHERE_MASS = 2 / 3 * M * R * R / ARM**2


def slipping(state_change, contact, wheel, motion):
    # Steps by the motion's error alone: the tests look at the ledger themselves.
    run, _ = run_from(design(wheel, contact={**DAMPED, **contact}), motion, Accuracy(1e-12, ledger=1e9), state_change)
    assert run.completed, run.reason
    return run


def slip_after(time, first, slowing, creep):
    """s of ṡ = −a s/√(s² + v_s²): √(s² + v_s²) − v_s artanh(v_s/√(s² + v_s²)) falls by a t."""
    from scipy.optimize import brentq

    def fallen(speed):
        return speed - creep * math.atanh(creep / speed)

    start = fallen(math.hypot(first, creep))
    speed = brentq(lambda x: fallen(x) - (start - slowing * time), creep * (1 + 1e-15), math.hypot(first, creep) * 2)
    return math.sqrt(max(0.0, (speed - creep) * (speed + creep)))


def spun(speed):
    def change(y):
        y[at.WHEELS + 1 : at.WHEELS + 9 : 3] = speed

    return change


def test_wheels_at_constant_speed_drag_the_sphere_until_it_rolls():
    """Ω grows by 3 μ N · arm/I until s = 0 at t* = s₀ I/(3 μ N arm²); what slip takes is ½ I Ω² of the end, as on a belt."""
    mu, creep, speed = 0.2, 1e-7, 20.0
    slowing = 3 * mu * N / SPHERE_MASS
    end = speed * LEVER / slowing
    motion = speeds((0.0, 0.0, 0.0), 1.5 * end, sample_rate=20 / end)
    run = slipping(spun(speed), dict(friction=mu, creep_speed=creep), ROUND, motion)
    Omega = run.states[:, at.OMEGA + 2]
    expected = np.minimum(slowing * run.time, speed * LEVER) / ARM
    # v_s rounds the corner at t* by v_s ln(4 s₀/v_s)/a of time, 1e-6 of t*.
    np.testing.assert_allclose(Omega, expected, atol=2e-6 * expected[-1])
    np.testing.assert_allclose(run.states[:, at.OMEGA : at.OMEGA + 2], 0, atol=1e-9)
    assert ledger(run).slip[-1] == pytest.approx(0.5 * SPHERE_MASS * (speed * LEVER) ** 2, rel=2e-6)


def test_a_sphere_that_has_come_to_roll_is_not_stepped_through_its_creep(monkeypatch):
    """Friction is stiff there, 1e9 1/s; the ledger's part in the step control must not ask for steps as short as that."""
    monkeypatch.setattr(run_module, "STEPS_AT_ONCE", 5000)
    arrays = run_module._Arrays(
        [design(ROUND, contact={**DAMPED, "friction": 0.2, "creep_speed": 1e-7})],
        [speeds((0.0, 0.0, 0.0), 0.6, sample_rate=50)],
        Accuracy(1e-10),
    )
    spun(20.0)(arrays.y[0])

    def watch(share):
        assert share == 1.0, f"5,000 steps end at {share:.3f} of the run"

    arrays.advance(watch)


def test_regularised_slide_follows_its_own_closed_form():
    mu, creep, speed = 0.2, 0.05, 20.0
    slowing = 3 * mu * N / SPHERE_MASS
    end = speed * LEVER / slowing
    run = slipping(spun(speed), dict(friction=mu, creep_speed=creep), ROUND, speeds((0, 0, 0), 1.2 * end, sample_rate=20 / end))
    slip = speed * LEVER - run.states[:, at.OMEGA + 2] * ARM
    expected = [slip_after(t, speed * LEVER, slowing, creep) for t in run.time]
    np.testing.assert_allclose(slip, expected, atol=1e-8)


def test_slide_to_roll_takes_the_time_and_the_loss_of_the_cases():
    """Free wheels of mass m at the contact, a sphere of 2/5 m there, and 3 μ N = 0.2 · 9.81 · m: the case's equations.
    From v₀ = 1 m/s: t* = 2 v₀/(7 · 0.2 g) = 0.1456240 s, v = 5/7 m/s, loss m v₀²/7."""
    m = 2.5 * SPHERE_MASS
    wheel = IdealWheel(radius=r, mass=0.2, axial_inertia=m / 3 * LEVER**2)
    mu = 0.2 * 9.81 * m / (3 * N)
    start = 1.0 / LEVER
    run = slipping(spun(start), dict(friction=mu, creep_speed=1e-7), wheel, torques((0, 0, 0), 0.3, sample_rate=1e4))
    speed, turning = run.states[:, at.WHEELS + 1] * LEVER, run.states[:, at.OMEGA + 2] * ARM
    assert speed[-1] == pytest.approx(5 / 7, rel=1e-6)
    assert turning[-1] == pytest.approx(5 / 7, rel=1e-6)
    assert ledger(run).slip[-1] == pytest.approx(m / 7, rel=2e-6)
    # The slip runs straight to zero at t*: where its line through two early samples meets zero.
    slip = speed - turning
    assert run.time[1000] * slip[0] / (slip[0] - slip[1000]) == pytest.approx(0.1456240, abs=1.5e-7)
    assert slip[run.time > 0.14563].max() < 1e-5


@pytest.mark.parametrize("share", [0.5, 0.9, 0.999])
def test_a_wheel_creeps_by_what_friction_asks(share):
    """Torque T speeds wheel and sphere up together; friction carries f = T/r · m_s/(m_s + m_w): s = v_s f/√((μN)² − f²)."""
    mu, creep = 0.3, 1e-5
    inertia = ROUND.spin_inertia
    passed = SPHERE_MASS / 3 / (SPHERE_MASS / 3 + inertia / LEVER**2)
    f = share * mu * N
    drive = torques([f / passed * LEVER] * 3, 0.2, sample_rate=50)
    run = slipping(None, dict(friction=mu, creep_speed=creep), ROUND, drive)
    np.testing.assert_allclose(run.touches[-1, :, 1], f, rtol=1e-8)
    slip = run.states[-1, at.WHEELS + 1] * LEVER - run.states[-1, at.OMEGA + 2] * ARM
    assert slip == pytest.approx(creep * share / math.sqrt(1 - share**2), rel=1e-5)
    np.testing.assert_allclose(-run.touches[-1, :, 2], slip, rtol=1e-6)


def test_a_wheel_slips_at_the_edge_of_the_cone():
    """Past T = μ N r (m_s + m_w)/m_s slip grows by (T − T_edge)/I_w · r a second; drawn back to none, that finds the edge."""
    mu, creep = 0.3, 1e-9
    inertia = ROUND.spin_inertia
    edge = mu * N * LEVER * (1 + 3 * inertia / LEVER**2 / SPHERE_MASS)
    torque = np.array([1.2, 1.4]) * edge
    growth = []
    for T in torque:
        run = slipping(None, dict(friction=mu, creep_speed=creep), ROUND, torques([T] * 3, 0.2, sample_rate=100))
        slip = run.states[:, at.WHEELS + 1] * LEVER - run.states[:, at.OMEGA + 2] * ARM
        growth.append((slip[-1] - slip[5]) / (run.time[-1] - run.time[5]))
        np.testing.assert_allclose(run.touches[5:, :, 1], mu * N, rtol=1e-6)
    found = torque[0] - growth[0] * (torque[1] - torque[0]) / (growth[1] - growth[0])
    assert found == pytest.approx(edge, rel=1e-6)


def bounces(stiffness, damping, drop, times):
    """Height of a mass let fall from ``drop`` above a spring that only pushes: N = max(0, −k z − c ż), piece by piece."""
    from scipy.linalg import expm
    from scipy.optimize import brentq

    def flight(state, t):
        z, v = state
        return np.array([z + v * t - G * t * t / 2, v - G * t])

    A = np.array([[0, 1, 0], [-stiffness / M, -damping / M, -G], [0, 0, 0]])

    def contact(state, t):
        return (expm(A * t) @ np.append(state, 1.0))[:2]

    def pushing(state):
        return -stiffness * state[0] - damping * state[1]

    period = math.pi / math.sqrt(stiffness / M)
    pieces, at_time, state = [], 0.0, np.array([drop, 0.0])
    while at_time < times[-1]:
        down = (state[1] + math.sqrt(state[1] ** 2 + 2 * G * state[0])) / G
        pieces.append((at_time, flight, state))
        at_time, state = at_time + down, flight(state, down)
        pieces.append((at_time, contact, state))
        left = brentq(lambda t, state=state: pushing(contact(state, t)), 0.2 * period, 1.2 * period, xtol=1e-16)
        at_time, state = at_time + left, contact(state, left)
        # It leaves c v/k deep, where nothing pushes any more, and flies from there.
    out = []
    for t in times:
        begin, rule, state = [p for p in pieces if p[0] <= t][-1]
        out.append(rule(state, t - begin))
    return np.array(out)


def test_a_sphere_bounces_as_a_damped_oscillator_that_only_pushes():
    """Three contacts of K and C below 40°: 3 K sin² 40° and 3 C sin² 40° along the vertical, as stiff as to stand 1e-6 deep."""
    stiff, drop = 1e9, 1e-5
    damping = 0.1 * math.sqrt(stiff * M)
    d = design(ROUND, contact=dict(stiffness=stiff, damping=damping, friction=0.0))

    def lifted(y):
        y[at.CENTRE + 2] = drop

    run, _ = run_from(d, torques((0, 0, 0), 0.006, sample_rate=1e4), Accuracy(1e-13), lifted)
    expected = bounces(3 * stiff * SIN**2, 3 * damping * SIN**2, drop, run.time)
    assert run.completed
    assert (np.diff(np.sign(expected[:, 1])) > 0).sum() >= 2
    fast = np.abs(expected[:, 1]).max()
    np.testing.assert_allclose(run.states[:, at.CENTRE + 2], expected[:, 0], atol=1e-4 * drop)
    away = expected[:, 0] > 1e-7
    np.testing.assert_allclose(run.states[away, at.CENTRE_VELOCITY + 2], expected[away, 1], atol=1e-4 * fast)


def test_a_sphere_in_flight_keeps_its_momentum():
    """Thrown off its wheels: a parabola, the same Ω, and wheels that turn on as they were."""

    def thrown(y):
        y[at.CENTRE + 2] = 1e-3
        y[at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3] = (0.02, -0.01, 0.5)
        y[at.OMEGA : at.OMEGA + 3] = (1.0, 2.0, 3.0)

    run, _ = run_from(design(ROUND), torques((0, 0, 0), 0.09, sample_rate=100), Accuracy(1e-10), thrown)
    t = run.time[:, None]
    v0 = np.array([0.02, -0.01, 0.5])
    fallen = v0 * t - np.array([0, 0, G / 2]) * t * t + np.array([0, 0, 1e-3])
    np.testing.assert_allclose(run.states[:, at.CENTRE : at.CENTRE + 3], fallen, atol=1e-12)
    np.testing.assert_allclose(run.states[:, at.OMEGA : at.OMEGA + 3], np.tile((1.0, 2.0, 3.0), (len(t), 1)), atol=1e-13)
    assert (run.touches[:, :, 0] == 0).all()
