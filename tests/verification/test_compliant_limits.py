"""The compliant model where simpler models hold: rolling without slip, small motion without friction, races that take turns."""

import itertools
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compliant_cases import OFFSET, M, R, design, machine, seat, speeds
from spheredrive import kinematics
from spheredrive.design import Closure, Mount, Spring
from spheredrive.dynamics.compliant import layout as at
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant.run import Accuracy, run_compliant
from spheredrive.simulation.rolling_run import Tolerance, run_rolling
from spheredrive.vibration import transient
from spheredrive.wheels import DualRaceWheel, IdealWheel, MeasuredWheel, StandardWheel

ANGLES = {"omni": math.pi / 2, "mecanum": math.radians(45), "left": math.radians(-50)}


def stiff(roller_angle, count, K, sphere):
    """Round wheels on contacts of stiffness K, moderately damped, that creep the less the stiffer they are."""
    contact = dict(stiffness=K, damping=0.6 * math.sqrt(K * M), friction=2.0, creep_speed=10 / K)
    wheel = IdealWheel(radius=0.05, mass=0.2, roller_angle=roller_angle)
    return design(wheel, count=count, heading=0.3, contact=contact, sphere=sphere)


def asked(d, drive):
    if drive == "speed":
        wanted = kinematics.inverse(d, np.array([[0.3, -0.5, 1.0], [1.0, 0.2, -0.4]]))
        return Motion("wheel-speed", Series((0.0, 0.5), tuple(map(tuple, wanted))), 0.5, sample_rate=50)
    values = np.array([[0.05, 0.0, -0.02, 0.01], [-0.02, 0.06, 0.01, 0.02], [0.03, 0.02, 0.04, -0.01]])[:, : d.wheel_count]
    series = Series((0.0, 0.2, 0.5), tuple(map(tuple, values)))
    return Motion("wheel-torque", series, 0.5, angular_velocity=(0.2, -0.1, 0.3), sample_rate=50)


def turned_apart(roller_angle, count, drive, sphere, K):
    """Largest difference of the orientation from the rolling model's, and of Ω at the end."""
    d = stiff(roller_angle, count, K, sphere)
    soft = run_compliant(d, asked(d, drive), Accuracy(1e-11))
    rigid = run_rolling(d, asked(d, drive), Tolerance(1e-11, 1e-13))
    assert soft.completed and rigid.completed, (soft.reason, rigid.reason)
    orientation = soft.states[:, at.QUATERNION : at.QUATERNION + 4] - rigid.orientation
    return np.abs(orientation).max(), np.abs(soft.states[-1, at.OMEGA : at.OMEGA + 3] - rigid.angular_velocity[-1]).max()


def kinds():
    """Every roller angle, drive and number of wheels; every other one in the long set only."""
    for k, (angle, count, drive) in enumerate(itertools.product(ANGLES, (3, 4), ("speed", "torque", "offset mass"))):
        yield pytest.param(angle, count, drive, marks=[pytest.mark.long] if k % 2 else [])


@pytest.mark.parametrize(("angle", "count", "drive"), list(kinds()))
def test_stiff_round_wheels_roll(angle, count, drive):
    """Depth N/K, creep v_s f/√((μN)² − f²) with v_s ∝ 1/K, and the seat's sag all fall as 1/K: ten times the stiffness, a tenth
    of the difference. The next order is smaller by N/(K r), some 1e-4."""
    sphere = OFFSET if drive == "offset mass" else {}
    differences = [turned_apart(ANGLES[angle], count, drive, sphere, K) for K in (1e7, 1e8)]
    assert differences[0][0] / differences[1][0] == pytest.approx(10, rel=5e-3)
    assert max(differences[-1]) < 5e-5


def small_motion(wheel, K, speed, duration, **extras):
    """Centre beside its place on round wheels less what the linear model says, over the last share of a run; and its size."""
    contact = dict(stiffness=K, damping=0.2 * math.sqrt(K * M), friction=0.0)
    d = design(wheel, contact=contact, **extras)
    motion = speeds(speed, duration, sample_rate=1000)
    run, linear = run_compliant(d, motion, Accuracy(1e-12)), transient(d, motion, start="steady")
    assert run.completed, run.reason
    assert not linear.contact_lost.any()
    still = machine(design(IdealWheel(radius=wheel.radius, mass=wheel.mass), contact=contact, **extras))
    y = np.zeros(still.state_size)
    y[at.QUATERNION] = 1.0
    sag = seat(still, y, still.places.copy(), np.zeros(len(still.outlines)))[:3]
    late = slice(int(0.6 * len(run.time)), None)
    return run.states[late, :3] - sag - linear.displacement[late], np.abs(linear.displacement[late]).max()


MOUNTED = dict(mount=Mount(stiffness=2e6, damping=200.0))
HELD = dict(closure=Closure(stiffness=1e4, damping=10.0, springs=(Spring((0.3, 0.2, 1.0), 2e5, 100.0),)))


@pytest.mark.parametrize("extras", [{}, MOUNTED, {**MOUNTED, **HELD}], ids=["rigid", "mounts", "mounts and springs"])
def test_small_motion_is_the_linear_models(extras):
    """Without friction, near the resonances at 5 waves a turn. What the linear model leaves out is of first order in the
    amplitude only where a contact's force turns with the outline, N κ beside K: 10 N · 27 1/m/1e6 N/m = 3e-4. All else is of
    second order: D(2ε) − 2 D(ε) grows fourfold when ε doubles."""
    turn = np.linspace(0, 2 * math.pi, 60, endpoint=False)

    def difference(amplitude):
        outline = tuple((a, 0.05 * (1 + amplitude * math.cos(5 * a))) for a in turn)
        wheel = MeasuredWheel(outline=outline, radius=0.05, mass=0.2)
        return small_motion(wheel, 1e6, (90.0, 70.0, 110.0), 0.4, **extras)

    (one, size), (two, _), (four, _) = (difference(amplitude) for amplitude in (1e-5, 2e-5, 4e-5))
    assert np.abs(one).max() < 1e-3 * size
    assert np.abs(four - 2 * two).max() / np.abs(two - 2 * one).max() == pytest.approx(4, abs=0.05)


def test_half_sine_outline_is_felt_as_the_linear_model_says():
    """Corners and all: valleys 7 µm deep, whose slopes of 1e-3 m a radian tilt the contact by 4 mrad. That is N τ/K = 8e-8 m of
    N = 17 N, and a little amplified, as corners ring: within 4 % of the motion. The wrong phase would be all of it."""
    wheel = StandardWheel(radius=0.0758, rollers=14, roundness=0.05, mass=0.25, profile="half-sine")
    apart, size = small_motion(wheel, 1e6, (2.0, 1.5, 2.7), 0.6, closure=Closure(force=(0.0, 0.0, -30.0)))
    assert np.abs(apart).max() < 0.04 * size


def test_dual_race_wheels_turn_the_sphere_as_their_races_by_turns():
    """Over whole periods the sphere turns as the Jacobians of the races that take turns, the more so the stiffer contacts are:
    this outline is 0.3 µm deep, so that both races touch at once over a part of a turn that N/K makes, 1 µm at 10⁷ N/m.

    The nominal single-race Jacobian is off by 1.3e-3, either race alone by 4 %.
    """
    wheel = DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3, mass=0.1)
    speed, start = np.array([0.2, 0.1, 0.1]), np.array([0.05, 0.1, 0.2])
    period = 2 * math.pi / 8 / 0.1
    nominal = design(wheel)
    # Races change where an angle passes a multiple of the half pitch.
    changes = [(k * wheel.half_pitch - a) / w for a, w in zip(start, speed, strict=True) for k in range(40)]
    times = np.unique([0.0, period, *(t for t in changes if 0 < t < period)])
    # The page's exact lever of a race, r − r_r (1 − cos Δθ), beside the r of the kinematics.
    lever = 1 - wheel.roller_radius / wheel.radius * (1 - math.cos(wheel.races(R)[1].deflection(R)))
    turned = Rotation.identity()
    for begin, end in itertools.pairwise(times):
        races = kinematics.active_races(nominal, start + speed * (begin + end) / 2)
        turned = Rotation.from_rotvec(kinematics.forward(nominal, speed, races=races) * lever * (end - begin)) * turned
    by_nominal = Rotation.from_rotvec(kinematics.forward(nominal, speed) * period)

    def off(other):
        return (other * turned.inv()).magnitude() / turned.magnitude()

    errors = []
    for K in (1e5, 1e7):
        contact = dict(stiffness=K, damping=math.sqrt(K * M), creep_speed=10 / K)
        motion = speeds(speed, 1.001 * period, sample_rate=1 / period, wheel_angle=tuple(start))
        run = run_compliant(design(wheel, contact=contact), motion, Accuracy(1e-10))
        assert run.completed, run.reason
        w, x, y, z = run.states[1, at.QUATERNION : at.QUATERNION + 4]
        errors.append(off(Rotation.from_quat([x, y, z, w])))
    assert errors[0] > 3 * errors[1]
    assert errors[1] < 7e-4 < 1.2e-3 < off(by_nominal)
    assert min(off(Rotation.from_rotvec(kinematics.forward(nominal, speed, races=((k,),) * 3) * period)) for k in (1, 2)) > 0.02
