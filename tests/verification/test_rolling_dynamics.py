"""The rolling model against closed forms and laws."""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import DUAL, atlas, orthogonal, random_design
from spheredrive import kinematics as K
from spheredrive.design import Stage
from spheredrive.frames import quaternion_exponential, quaternion_matrix
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.rolling_run import Tolerance, run_rolling
from spheredrive.wheels import DualRaceWheel, IdealWheel

# Steps are held to 1e-10; over the few hundred of a run that leaves 1e-9 with room.
REACHED = 1e-9


def machine(design, wheel_mass=0.1, wheel_inertia=None, gravity=False, stage_mass=5.0, **sphere):
    """The design with masses; wheels of no inertia are as light as a value allows."""
    placements = tuple(
        replace(p, wheel=replace(p.wheel, mass=wheel_mass, axial_inertia=wheel_inertia)) for p in design.placements
    )
    return replace(
        design,
        sphere=replace(design.sphere, **{"mass": 2.0, **sphere}),
        placements=placements,
        stage=Stage(stage_mass, gravity),
    )


def light(design, **sphere):
    return machine(design, wheel_mass=1e-9, wheel_inertia=1e-15, **sphere)


def torques(values, duration, **rest):
    return Motion("wheel-torque", Series((0.0,), (tuple(values),)), duration, **rest)


def test_torque_free_body_is_where_cases_say():
    design = light(orthogonal(), inertia=(0.03, 0.02, 0.012))
    run = run_rolling(design, torques((0, 0, 0), 10.0, angular_velocity=(3, 0, 1), sample_rate=10))
    body = quaternion_matrix(run.orientation[-1]).T @ run.angular_velocity[-1]
    np.testing.assert_allclose(body, (2.98200463, -0.60275483, 0.81461569), atol=1e-8)


def test_torque_free_body_keeps_momentum_and_energy():
    design = light(orthogonal(), inertia=(0.03, 0.02, 0.012))
    run = run_rolling(design, torques((0, 0, 0), 10.0, angular_velocity=(3, 0, 1), sample_rate=10))
    A = quaternion_matrix(run.orientation)
    body = np.einsum("kji,kj->ki", A, run.angular_velocity)
    momentum = np.einsum("kij,kj->ki", A, body * [0.03, 0.02, 0.012])
    # The tiny wheels take R²/r² 1e-15 of inertia: 4e-14 beside 1e-2.
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-10)
    np.testing.assert_allclose(run.kinetic, run.kinetic[0], rtol=1e-10)


@pytest.mark.parametrize("wheel", [0, 1, 2])
def test_constant_torque_about_a_principal_axis(wheel):
    """ω = τ t / I, angle = τ t²/(2 I); one wheel of the orthogonal layout turns about one axis, with its own inertia."""
    design = machine(orthogonal(), inertia=(0.03, 0.02, 0.012), wheel_inertia=2e-5)
    T = np.zeros(3)
    T[wheel] = 0.02
    run = run_rolling(design, torques(T, 2.0, sample_rate=100))
    H = K.inverse_jacobian(design)
    axis = np.abs(H[wheel]).argmax()
    inertia = (0.03, 0.02, 0.012)[axis] + 2e-5 * H[wheel, axis] ** 2
    rate = H[wheel, axis] * 0.02 / inertia
    expected = np.zeros((len(run.time), 3))
    expected[:, axis] = rate * run.time
    np.testing.assert_allclose(run.angular_velocity, expected, atol=1e-10)
    turned = quaternion_exponential(expected * run.time[:, None] / 2)
    np.testing.assert_allclose(run.orientation, turned, atol=1e-10)
    np.testing.assert_allclose(run.wheel_angle[:, wheel], H[wheel, axis] * rate * run.time**2 / 2, atol=1e-10)


def test_perfect_world_of_the_thesis():
    """Figures 3.3 to 3.5: P = (0.1, 0.2, 0.3) N and T = (0.1, 0.2, 0.3) N m on the orthogonal layout, a hollow sphere."""
    design = machine(orthogonal())
    P, T = np.array([0.1, 0.2, 0.3]), np.array([0.1, 0.2, 0.3])
    stage = StageMotion("force", Series((0.0,), (tuple(P),)))
    run = run_rolling(design, torques(T, 2.0, stage=stage, sample_rate=100))
    H = K.inverse_jacobian(design)
    inertia = 2 / 3 * 2.0 * 0.15**2 + 0.5 * 0.1 * 0.025**2 * (0.15 / 0.025) ** 2
    slope = H.T @ T / inertia
    t = run.time[:, None]
    np.testing.assert_allclose(run.angular_velocity, slope * t, atol=1e-10)
    np.testing.assert_allclose(run.stage_position, P / (2 + 5 + 0.3) * t**2 / 2, atol=1e-10)
    np.testing.assert_allclose(run.orientation, quaternion_exponential(slope * t**2 / 2), atol=1e-9)


def pendulum_angle(duration, I, stiffness, start):
    """θ̈ = −(M g ρ / I) sin θ from rest at ``start``: the closed form by Jacobi's sn."""
    from scipy.special import ellipj, ellipk

    k = math.sin(start / 2)
    u = ellipk(k * k) - math.sqrt(stiffness / I) * duration
    return 2 * math.asin(k * ellipj(u, k * k)[0])


def test_offset_mass_swings_as_a_pendulum():
    """A sphere on light wheels whose mass hangs ρ beside the centre, released with ρ level and free about y."""
    rho, I, M = 0.03, 0.02, 2.0
    design = replace(
        light(atlas(IdealWheel(radius=0.025)), inertia=(I, I, I), centre_of_mass=(rho, 0, 0)), stage=Stage(5.0, True)
    )
    run = run_rolling(design, torques((0, 0, 0), 3.0, sample_rate=100))
    hanging = quaternion_matrix(run.orientation) @ [rho, 0, 0]
    # From straight down, the offset starts at 90°.
    expected = [pendulum_angle(t, I, M * 9.80665 * rho, math.pi / 2) for t in run.time]
    np.testing.assert_allclose(hanging[:, 0], rho * np.sin(expected), atol=1e-9)
    np.testing.assert_allclose(hanging[:, 2], -rho * np.cos(expected), atol=1e-9)


def test_free_stage_and_offset_mass_keep_their_momentum():
    """No force on the stage, no torque: M v + M_s Ω × ρ stays, and so does the energy."""
    design = light(atlas(IdealWheel(radius=0.025)), inertia=(0.03, 0.025, 0.02), centre_of_mass=(0.02, 0.03, -0.04))
    stage = StageMotion("force", Series((0.0,), ((0.0, 0.0, 0.0),)))
    run = run_rolling(design, torques((0, 0, 0), 4.0, stage=stage, angular_velocity=(2, -1, 3), sample_rate=50))
    rho = quaternion_matrix(run.orientation) @ np.array(design.sphere.centre_of_mass)
    momentum = (2 + 5) * run.stage_velocity + 2 * np.cross(run.angular_velocity, rho)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-8)
    np.testing.assert_allclose(run.kinetic, run.kinetic[0], rtol=1e-9)
    assert np.abs(run.stage_velocity).max() > 1e-3


def test_stage_on_a_prescribed_parabola_shakes_the_offset_mass_as_a_tilted_weight_does():
    """p̈ = a is felt as a weight −M_s a: the same run as with gravity turned into g − a."""
    design = light(atlas(IdealWheel(radius=0.025)), inertia=(0.02, 0.02, 0.02), centre_of_mass=(0.03, 0, 0))
    times = np.linspace(0, 1.5, 16)
    stage = StageMotion("position", Series(tuple(times), tuple((0.0, 0.0, 0.5 * 9.80665 * t * t) for t in times)))
    lifted = run_rolling(design, torques((0, 0, 0), 1.5, stage=stage, sample_rate=50))
    heavy = run_rolling(replace(design, stage=Stage(5.0, True)), torques((0, 0, 0), 1.5, sample_rate=50))
    np.testing.assert_allclose(lifted.angular_velocity, heavy.angular_velocity, atol=1e-8)
    np.testing.assert_allclose(lifted.stage_position[-1], (0, 0, 0.5 * 9.80665 * 1.5**2), atol=1e-9)


def test_normal_forces_of_the_static_seat():
    """N = M_s g / (3 sin 40°) each, with g of this package; cases.md has 10.174 N for g = 9.81."""
    design = machine(atlas(IdealWheel(radius=0.025)), gravity=True)
    run = run_rolling(design, torques((0, 0, 0), 0.1, sample_rate=10))
    np.testing.assert_allclose(run.normal_force, 2 * 9.80665 / (3 * math.sin(math.radians(40))), rtol=1e-12)
    assert run.normal_force[0, 0] * 9.81 / 9.80665 == pytest.approx(10.174, abs=5e-4)


@pytest.mark.parametrize("seed", range(6))
def test_forces_balance_on_the_sphere_at_every_sample(seed):
    """Newton and Euler written out: F_ext − ΣN R̂ + Σf û + M_s g = M_s a, and the moments about the centre."""
    rng = np.random.default_rng([60, seed])
    design = machine(random_design(rng, 3 + seed % 3, "mecanum" if seed % 2 else "ideal"), gravity=True, wheel_inertia=1e-4)
    R = design.sphere.radius
    design = replace(
        design,
        sphere=replace(
            design.sphere, inertia=tuple(R * R * np.array([1.4, 1.2, 1.0])), centre_of_mass=(0.1 * R, -0.2 * R, 0.1 * R)
        ),
        closure=replace(design.closure, force=(1.0, -2.0, -30.0)),
    )
    stage = StageMotion("force", Series((0.0, 1.0), ((1.0, 2.0, 3.0), (-3.0, 0.0, 1.0))))
    T = tuple(map(tuple, rng.normal(size=(2, design.wheel_count))))
    run = run_rolling(design, Motion("wheel-torque", Series((0.0, 1.0), T), 1.0, stage=stage, sample_rate=20))
    c = K.contacts(design)
    A = quaternion_matrix(run.orientation)
    rho = A @ np.array(design.sphere.centre_of_mass)
    I = A @ np.array(design.sphere.inertia_tensor) @ A.swapaxes(1, 2)
    O, dO, a = run.angular_velocity, run.angular_acceleration, run.stage_acceleration
    weight = 2.0 * np.array([0, 0, -9.80665])
    contact = -run.normal_force @ c.contact_direction + run.friction_force @ c.slip_direction
    force = np.array(design.closure.force) + contact + weight
    np.testing.assert_allclose(force, 2.0 * (a + np.cross(dO, rho) + np.cross(O, np.cross(O, rho))), atol=1e-9 * 30)
    moment = run.friction_force @ np.cross(R * c.contact_direction, c.slip_direction) + np.cross(rho, weight - 2.0 * a)
    change = np.einsum("kij,kj->ki", I, dO) + np.cross(O, np.einsum("kij,kj->ki", I, O))
    np.testing.assert_allclose(moment, change, atol=1e-9 * max(1.0, np.abs(change).max()))
    wheel = run.motor_torque - run.friction_force * np.sum(c.slip_direction * c.drive_direction, 1) * c.wheel_radius
    np.testing.assert_allclose(wheel, 1e-4 * K.inverse(design, dO), atol=1e-9 * np.abs(run.motor_torque).max())


def offset_case(duration=1.0, **motion):
    """An offset mass under gravity, unequal moments of inertia, torques that ramp."""
    design = machine(
        atlas(IdealWheel(radius=0.025)), gravity=True, inertia=(0.03, 0.025, 0.02), centre_of_mass=(0.01, 0.02, -0.02)
    )
    series = Series((0.0, duration), ((0.02, 0.0, -0.01), (-0.01, 0.03, 0.0)))
    return design, Motion(
        "wheel-torque", series, duration, **{"angular_velocity": (1.0, 0.5, -0.5), "sample_rate": 10, **motion}
    )


def test_observed_order_of_convergence_is_five():
    """Energy lost by a swinging offset mass over four halvings of a fixed step: a pure fifth-order error of Dormand and Prince.

    The last halving reaches 1e-13 J, where rounding shows; the slope over all four and each of the first three is 5.
    """
    design = machine(atlas(IdealWheel(radius=0.025)), gravity=True, inertia=(0.02, 0.02, 0.02), centre_of_mass=(0.03, 0, 0))
    motion = torques((0, 0, 0), 20.0, angular_velocity=(0.2, 1, 0.3), sample_rate=1)
    steps = 1 / (70 * 2.0 ** np.arange(5))
    lost = np.array([abs(run_rolling(design, motion, Tolerance(fixed_step=h)).residual[-1]) for h in steps])
    orders = np.log2(lost[:-1] / lost[1:])
    np.testing.assert_allclose(orders[:3], 5, atol=0.1)
    assert orders.mean() == pytest.approx(5, abs=0.1)


def test_samples_do_not_change_the_motion():
    design, motion = offset_case()
    few, many = (run_rolling(design, replace(motion, sample_rate=rate)) for rate in (1.0, 1000.0))
    np.testing.assert_array_equal(few.angular_velocity[-1], many.angular_velocity[-1])


def test_inverse_dynamics_fed_back_forward_returns_the_motion():
    """Torques of a prescribed motion, sampled at 20 kHz: straight lines between them err by T̈ h²/8, some 1e-9 of T."""
    design, _ = offset_case()
    wanted = Series((0.0, 0.5), ((0.2, -0.1, 0.3), (-0.3, 0.4, 0.1)))
    asked = run_rolling(design, Motion("sphere-velocity", wanted, 0.5, sample_rate=20_000))
    given = Series(tuple(asked.time), tuple(map(tuple, asked.motor_torque)))
    back = run_rolling(design, Motion("wheel-torque", given, 0.5, angular_velocity=(0.2, -0.1, 0.3), sample_rate=100))
    np.testing.assert_allclose(back.angular_velocity, wanted.at(back.time), atol=1e-8)
    np.testing.assert_allclose(back.orientation, asked.orientation[::200], atol=1e-8)


def test_wheel_speeds_and_sphere_velocity_ask_for_the_same_torques():
    design, _ = offset_case()
    wanted = Series((0.0, 1.0), ((0.2, -0.1, 0.3), (-0.3, 0.4, 0.1)))
    speeds = Series(wanted.time, tuple(map(tuple, K.inverse(design, np.array(wanted.values)))))
    a = run_rolling(design, Motion("sphere-velocity", wanted, 1.0, sample_rate=50))
    b = run_rolling(design, Motion("wheel-speed", speeds, 1.0, sample_rate=50))
    np.testing.assert_allclose(a.motor_torque, b.motor_torque, atol=1e-12)
    np.testing.assert_allclose(a.orientation, b.orientation, atol=1e-12)


def dual(**rest):
    design = machine(atlas(DualRaceWheel(**DUAL)), gravity=True, inertia=(0.03, 0.025, 0.02), centre_of_mass=(0.0, 0.01, -0.02))
    return replace(design, **rest)


@pytest.mark.parametrize("wheel", [DualRaceWheel(**DUAL), IdealWheel(radius=0.025)], ids=["dual-race", "round"])
def test_momentum_of_a_free_stage_is_what_the_force_on_it_gives(wheel):
    """M v + M_s Ω × ρ = ∫ P dt: wheels, motors, impacts and closure act within the machine, the gantry carries its weight."""
    design = replace(dual(), placements=tuple(replace(p, wheel=replace(wheel, mass=0.1)) for p in dual().placements))
    push = Series((0.0, 0.5, 1.0), ((2.0, -1.0, 0.5), (-3.0, 4.0, 1.0), (1.0, 1.0, -6.0)))
    run = run_rolling(design, torques((0.02, -0.03, 0.01), 1.0, stage=StageMotion("force", push), sample_rate=50))
    rho = quaternion_matrix(run.orientation) @ np.array(design.sphere.centre_of_mass)
    M_s, M = design.sphere.mass, design.sphere.mass + design.stage.mass + 0.3
    momentum = M * run.stage_velocity + M_s * np.cross(run.angular_velocity, rho)
    np.testing.assert_allclose(momentum, push.integral(run.time), atol=1e-10)
    assert isinstance(wheel, IdealWheel) or len(run.event_time) > 10


def test_change_of_race_is_an_impact_that_keeps_the_momentum_it_should():
    """I ΔΩ = −J₂⁻ᵀ I_w Δω, all of it seen from outside; energy only falls."""
    design = machine(atlas(DualRaceWheel(**DUAL)), wheel_mass=1.0)
    run = run_rolling(design, torques((0, 0, 0), 3.0, angular_velocity=(0.5, 0.2, 0.8), sample_rate=2000))
    assert len(run.event_time) > 10 and (run.event_loss > 0).all()
    inertia, I_w = 2 / 3 * 2 * 0.15**2, 0.5 * 1.0 * 0.025**2
    for i in range(5):
        before, after = np.searchsorted(run.time, run.event_time[i]) + np.array([-1, 0])
        # A hollow sphere coasts between changes, so the samples beside an event have the speeds just before and after it.
        H1, H2 = (
            K.inverse_jacobian(design, [w.alternation[s] for w, s in zip(design.wheels, run.state[k], strict=True)])
            for k in (before, after)
        )
        dOmega = run.angular_velocity[after] - run.angular_velocity[before]
        dw = H2 @ run.angular_velocity[after] - H1 @ run.angular_velocity[before]
        np.testing.assert_allclose(inertia * dOmega, -H2.T @ (I_w * dw), atol=1e-12)
        np.testing.assert_allclose(run.event_impulse[i], inertia * dOmega, atol=1e-12)


def test_races_change_where_the_wheels_pass_their_half_pitches():
    run = run_rolling(dual(), torques((0.02, -0.01, 0.015), 3.0, sample_rate=1000))
    pitch = math.pi / 8
    expected = np.floor(run.wheel_angle / pitch).astype(int) % 2
    near = np.abs(run.wheel_angle / pitch - np.round(run.wheel_angle / pitch)) < 1e-9
    assert ((run.state == expected) | near).all() and len(run.event_time) > 20


@pytest.mark.parametrize("seed", range(8))
def test_energy_ledger_closes(seed):
    """Residual below 1e-9 of what was turned over, impacts, resistances, moving stages and offset masses included."""
    rng = np.random.default_rng([61, seed])
    design = dual(
        contact=replace(atlas().contact, friction=0.8, rolling_arm=2e-4, spin_arm=3e-4) if seed % 2 else atlas().contact
    )
    T = tuple(map(tuple, 0.03 * rng.normal(size=(4, 3))))
    stage = None
    if seed % 4 >= 2:
        stage = StageMotion("force", Series((0.0, 1.0, 2.0), tuple(map(tuple, rng.normal(size=(3, 3))))))
    elif seed % 4 == 1:
        stage = StageMotion("position", Series((0.0, 0.7, 1.4, 2.0), tuple(map(tuple, 0.1 * rng.normal(size=(4, 3))))))
    kind = ("wheel-torque", "wheel-torque", "sphere-velocity", "wheel-speed")[seed // 2]
    run = run_rolling(design, Motion(kind, Series((0.0, 0.6, 1.3, 2.0), T), 2.0, stage=stage, sample_rate=200))
    assert run.completed, run.reason
    turnover = np.abs(np.diff(run.motor_work)).sum() + np.abs(np.diff(run.stage_work)).sum() + run.heat[-1]
    turnover += np.abs(run.event_loss).sum()
    assert np.abs(run.residual).max() <= 1e-9 * turnover
    assert (np.diff(run.heat) >= 0).all()


def test_resistance_slows_a_coasting_sphere_by_the_heat_it_makes():
    """Rolling about z on three wheels: N l_r of each contact against the tangential part of Ω − ω ŵ."""
    arm = 1e-4
    design = machine(atlas(IdealWheel(radius=0.025)), gravity=True, wheel_mass=1e-9, wheel_inertia=1e-15)
    design = replace(design, contact=replace(design.contact, friction=0.8, rolling_arm=arm))
    run = run_rolling(design, torques((0, 0, 0), 0.5, angular_velocity=(0, 0, 2.0), sample_rate=10))
    c = K.contacts(design)
    R_hat, w_hat = c.contact_direction[0], -c.induced_direction[0]
    relative = np.array([0, 0, 1.0]) - K.inverse(design, [0, 0, 1.0])[0] * w_hat
    tangential = relative - (relative @ R_hat) * R_hat
    N = 2 * 9.80665 / (3 * math.sin(math.radians(40)))
    # Power of the three contacts over Ω: the moment about z that brakes the sphere; constant but for the fading at rest.
    moment = 3 * N * arm * np.linalg.norm(tangential)
    inertia = 2 / 3 * 2 * 0.15**2
    # The smoothing at 1e-3 rad/s takes (1e-3/|Ω_t|)²/2, here 1e-8 of it.
    np.testing.assert_allclose(run.angular_velocity[:, 2], 2 - moment / inertia * run.time, rtol=2e-7)


@pytest.mark.parametrize("wheel", [DualRaceWheel(**DUAL), IdealWheel(radius=0.025)], ids=["dual-race", "round"])
@pytest.mark.parametrize("threads", [1, 2])
def test_runs_do_not_depend_on_the_batch_they_are_in_nor_on_threads(wheel, threads):
    """Runs of unlike lengths of step share lanes, and lanes are taken over when a run ends."""
    import numba

    from spheredrive import simulate_batch

    design = replace(dual(), placements=tuple(replace(p, wheel=replace(wheel, mass=0.1)) for p in dual().placements))
    motions = [torques((0.02, 0.001 * i, -0.01 + 0.002 * (i % 5)), 0.5, sample_rate=20) for i in range(41)]
    before = numba.get_num_threads()
    try:
        numba.set_num_threads(min(threads, before))
        batch = simulate_batch(design, motions)
    finally:
        numba.set_num_threads(before)
    for i in (0, 7, 8, 31, 32, 40):
        alone = run_rolling(design, motions[i])
        for name in ("angular_velocity", "orientation", "wheel_angle", "motor_work", "normal_force", "event_time"):
            np.testing.assert_array_equal(getattr(alone, name), getattr(batch.runs[i], name))
    assert batch[40].attrs["motion_values_sha256"] != batch[39].attrs["motion_values_sha256"]


def test_stopping_to_look_changes_no_bit(monkeypatch):
    from spheredrive.simulation import rolling_run

    design, motion = dual(), torques((0.02, -0.01, 0.015), 1.0, sample_rate=100)
    whole = run_rolling(design, motion)
    monkeypatch.setattr(rolling_run, "STEPS_AT_ONCE", 7)
    seen = []
    pieces = run_rolling(design, motion, watch=seen.append)
    np.testing.assert_array_equal(whole.orientation, pieces.orientation)
    assert len(seen) > 5 and seen == sorted(seen) and seen[-1] == 1.0


def test_turning_the_machine_about_the_vertical_turns_the_run():
    design, motion = offset_case()
    from spheredrive.frames import rotation_matrix

    turn = rotation_matrix(np.array([0, 0, 1.0]), 0.7)
    turned = replace(
        motion, angular_velocity=tuple(turn @ motion.angular_velocity), orientation=tuple(quaternion_exponential([0, 0, 0.7]))
    )
    a, b = run_rolling(design, motion), run_rolling(design.rotated(turn), turned)
    np.testing.assert_allclose(b.angular_velocity, a.angular_velocity @ turn.T, atol=REACHED)
    np.testing.assert_allclose(b.normal_force, a.normal_force, atol=1e-7)


def test_heavy_wheels_hold_the_sphere_still_and_light_ones_leave_it_free():
    """Limits of I_s + J⁻ᵀ I_w J⁻¹: Ω̇ → J I_w⁻¹ T as wheels grow, I_s⁻¹ J⁻ᵀ T as they vanish."""
    T = np.array([0.1, -0.2, 0.3])
    heavy = machine(atlas(IdealWheel(radius=0.025)), wheel_inertia=1e6)
    run = run_rolling(heavy, torques(T, 0.1, sample_rate=10))
    np.testing.assert_allclose(run.angular_acceleration[0], K.jacobian(heavy) @ (T / 1e6), rtol=1e-6)
    free = light(atlas(IdealWheel(radius=0.025)))
    run = run_rolling(free, torques(T, 0.1, sample_rate=10))
    np.testing.assert_allclose(run.angular_acceleration[0], K.inverse_jacobian(free).T @ T / (2 / 3 * 2 * 0.15**2), rtol=1e-9)
