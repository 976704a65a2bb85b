"""Laws of linear vibration: superposition, shifts of time, turned frames, energy, one motion however it is asked for."""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import atlas, orthogonal
from spheredrive import vibration
from spheredrive.design import Closure, Contact, Mount, Sphere, Spring
from spheredrive.frames import rotation_matrix
from spheredrive.motion import Series
from spheredrive.shape import profile
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel, SplitDualRaceWheel, StandardWheel

WHEEL = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25)
MACHINES = {
    "compliant": dict(contact=Contact(188208.0, 40.0)),
    "stiff-damped": dict(contact=Contact(188208.0, 20000.0)),
    "mounts": dict(contact=Contact(188208.0, 200.0), mount=Mount(1e6, 50.0)),
    "pads": dict(contact=Contact(188208.0, 20.0), mount=Mount(1e6, 5.0), closure=Closure(2e4, 30.0)),
    "stiff": dict(contact=Contact(1e9, 2e4), mount=Mount(1e6, 80.0)),
    "rigid contacts": dict(contact=Contact(), mount=Mount(1e6, 80.0)),
    "spring": dict(contact=Contact(1e5, 20.0), closure=Closure(springs=(Spring((1, 2, 2), 5e4, 60.0),))),
}


def machine(name: str = "mounts", wheel=WHEEL, count: int = 3):
    design = atlas(wheel, radius=1.22, count=count)
    return replace(design, sphere=Sphere(1.22, 5.0), **MACHINES[name])


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("speed", [(2.0, 2.0, 2.0), (0.37, -1.9, 0.0)])
def test_a_long_transient_becomes_the_steady_motion(name, speed):
    design, angle = machine(name), [0.1, 0.2, 0.3]
    steady = vibration.response(design, speed, wheel_angle=angle)
    slowest = min(-steady.system.system.lam.real)
    settled = 30 / slowest
    run = vibration.transient(design, speed, settled + 0.5, 200.0, wheel_angle=angle)
    last = run.time > settled
    exact = steady.at(run.time[last])
    # e⁻³⁰ of the start is left.
    assert relative(run.displacement[last], exact.displacement) < 1e-9
    assert relative(run.velocity[last], exact.velocity) < 1e-9
    assert np.abs(run.contact_force[last] - exact.contact_force).max() < 1e-6


@pytest.mark.parametrize("name", MACHINES)
def test_a_steady_start_stays_steady(name):
    design, speed = machine(name), (1.3, -2.0, 0.4)
    steady = vibration.response(design, speed)
    run = vibration.transient(design, speed, 3.0, 137.0, start="steady")
    exact = steady.at(run.time)
    assert relative(run.displacement, exact.displacement) < 1e-10
    assert relative(run.velocity, exact.velocity) < 1e-9


@pytest.mark.parametrize("name", MACHINES)
def test_superposition_of_shapes(name):
    design = machine(name)
    own = profile(WHEEL, 1.22)
    none = replace(own, coefficients=0 * own.coefficients, slope_jumps=0 * own.slope_jumps)
    series = Series((0.0, 1.0, 2.0), ((1.0, -2.0, 0.5), (-1.5, 2.0, 3.0), (1.0, 1.0, 1.0)))
    runs = [
        vibration.transient(design, series, 2.0, profiles=shapes)
        for shapes in ((own, own, own), (own, none, none), (none, own, own))
    ]
    # The parts cross the same corners, so that only rounding differs.
    assert relative(runs[1].displacement + runs[2].displacement, runs[0].displacement) < 1e-11
    assert relative(runs[1].acceleration + runs[2].acceleration, runs[0].acceleration) < 1e-8
    seat = runs[0].contact_force[0] * 0 + vibration.linear_system(design).seat_force
    total = runs[1].contact_force + runs[2].contact_force - seat
    np.testing.assert_allclose(total, runs[0].contact_force, atol=1e-6)


@pytest.mark.parametrize("name", ["compliant", "mounts", "stiff-damped"])
def test_twice_the_shape_moves_twice_as_far(name):
    design, own = machine(name), profile(WHEEL, 1.22)
    double = replace(own, coefficients=2 * own.coefficients, slope_jumps=2 * own.slope_jumps)
    one, two = (vibration.response(design, [1.1, 0.6, -2.0], profiles=(p,) * 3) for p in (own, double))
    for size in ("peak_displacement", "peak_velocity", "peak_acceleration", "rms_displacement", "rms_acceleration"):
        assert getattr(two, size) == pytest.approx(2 * getattr(one, size), rel=1e-9)


@pytest.mark.parametrize("name", MACHINES)
def test_shift_of_time(name):
    design, speed, later = machine(name), np.array([1.7, -0.9, 0.3]), 1.234
    first = vibration.response(design, speed)
    second = vibration.response(design, speed, wheel_angle=speed * later)
    t = np.linspace(0, 3, 200)
    assert relative(second.at(t).displacement, first.at(t + later).displacement) < 1e-11
    assert second.peak_displacement == pytest.approx(first.peak_displacement, rel=1e-6)


@pytest.mark.parametrize("name", MACHINES)
def test_a_turned_frame_turns_the_motion(name):
    design, speed = machine(name), [1.7, -0.9, 0.3]
    turn = rotation_matrix(np.array([0.6, 0.0, 0.8]), 1.1)
    here, there = vibration.response(design, speed), vibration.response(design.rotated(turn), speed)
    t = np.linspace(0, 3, 50)
    assert relative(there.at(t).displacement, here.at(t).displacement @ turn.T) < 1e-10
    assert there.peak_acceleration == pytest.approx(here.peak_acceleration, rel=1e-5)
    assert there.rms_acceleration == pytest.approx(here.rms_acceleration, rel=1e-9)
    np.testing.assert_allclose(
        vibration.modes(design.rotated(turn)).natural_frequencies, vibration.modes(design).natural_frequencies, rtol=1e-9
    )


@pytest.mark.parametrize("name", ["compliant", "stiff-damped", "mounts", "pads"])
def test_orthogonal_contacts_are_independent(name):
    design = replace(orthogonal(), sphere=Sphere(0.15, 5.0), **MACHINES[name])
    design = replace(design, placements=[replace(p, wheel=WHEEL) for p in design.placements])
    speed, t = [1.7, -0.9, 0.3], np.linspace(0, 2, 100)
    coupled, alone = (vibration.response(design, speed, model).at(t) for model in ("coupled", "independent"))
    assert relative(coupled.displacement, alone.displacement) < 1e-11
    assert relative(coupled.acceleration, alone.acceleration) < 1e-8
    tilted = machine(name)
    coupled, alone = (vibration.response(tilted, speed, model).at(t) for model in ("coupled", "independent"))
    assert relative(coupled.displacement, alone.displacement) > 0.1


@pytest.mark.parametrize("name", ["compliant", "mounts"])
def test_energy_balance(name):
    # The sphere gains what the contact forces of the result do on it: M_s c̈ = Σ n̂ (N − N⁰), times ċ, over the run.
    design = machine(name)
    run = vibration.transient(design, [1.5, -0.8, 0.6], 0.4, 40_000.0)
    n_hat = -design.contact_directions
    ls = vibration.linear_system(design)
    pull = -(run.contact_force - ls.seat_force)
    power = -(pull @ n_hat * run.velocity).sum(axis=1)
    kinetic = 2.5 * (run.velocity**2).sum(axis=1)
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2) / 40_000])
    # Trapezoids of 25 µs of a power that rings at some hundred rad/s and jumps at corners.
    np.testing.assert_allclose(kinetic, work, atol=3e-3 * kinetic.max())


def test_peaks_and_rms_are_those_of_the_motion():
    for name in MACHINES:
        for speed in ((2.0, 2.0, 2.0), (1.0, 2.0, -1.5)):
            steady = vibration.response(machine(name), speed, wheel_angle=[0.0, 0.1, 0.17])
            # One joint period: the slowest of the patterns, twice where speeds stand as 2 to 3.
            joint = 2 * 2 * math.pi / 14
            edges = profile(WHEEL, 1.22).breakpoints[:-1]
            angle = np.array([0.0, 0.1, 0.17])[:, None, None]
            passes = np.arange(-20, 20)[:, None] * 2 * math.pi / 14
            corners = ((edges + passes - angle) / np.array(speed)[:, None, None]).ravel()
            corners = corners[(corners > 0) & (corners < joint)]
            t = np.concatenate([np.linspace(0, joint, 20_001), corners - 1e-10, corners + 1e-10])
            motion = steady.at(t)
            for vectors, peak, rms in (
                (motion.displacement, steady.peak_displacement, None),
                (motion.velocity, steady.peak_velocity, steady.rms_velocity),
                (motion.acceleration, steady.peak_acceleration, None),
            ):
                length = np.linalg.norm(vectors, axis=1)
                assert length.max() <= peak * (1 + 2e-6)
                # Between samples 45 µs apart a motion of 2e3 rad/s at most, off the corners, hides 1e-3 of itself.
                assert length.max() > peak * (1 - 1e-3)
                if rms is not None:
                    # Rectangles over a period, with two per cent of the samples put at corners.
                    assert math.sqrt((length[:20_000] ** 2).mean()) == pytest.approx(rms, rel=1e-4)
            assert (motion.contact_force.min(axis=0) >= steady.force_min - 1e-5).all()


def test_incommensurate_peak_is_the_largest_over_all_phases():
    # Rigid contacts: c = n̂⁻¹ h, so the peak is the largest |n̂⁻¹ h| over the corners of the box of shapes' extremes.
    design = replace(machine(), contact=Contact(), mount=Mount())
    steady = vibration.response(design, [1.0, math.sqrt(2), math.pi])
    low, high = profile(WHEEL, 1.22).extremes(0)
    inverse = np.linalg.inv(-design.contact_directions)
    corners = np.array([[low if i >> k & 1 else high for k in range(3)] for i in range(8)])
    assert steady.peak_displacement == pytest.approx(np.linalg.norm(corners @ inverse.T, axis=1).max(), rel=1e-9)
    # And where speeds are equal, wheels set together never reach it.
    together = vibration.response(design, [1.0, 1.0, 1.0])
    assert together.peak_displacement == pytest.approx(np.linalg.norm(inverse @ [low, low, low]), rel=1e-9)


@pytest.mark.parametrize("ratio", [(1, 1, 1), (2, 3, 1), (1, 12, 9)])
def test_commensurate_speeds_keep_their_phases(ratio):
    # Variance by lines: equal frequencies are added with phase first.
    steady = vibration.response(machine("pads"), 0.1 * np.array(ratio), wheel_angle=[0.0, 0.03, 0.4])
    _, amplitude = steady.spectrum(1500).combined()
    assert math.sqrt(0.5 * np.sum(np.abs(amplitude) ** 2)) == pytest.approx(steady.rms_displacement, rel=1e-8)


@pytest.mark.parametrize("wheel", [
    WHEEL,
    replace(WHEEL, profile="half-sine"),
    MecanumWheel(radius=0.0758, rollers=16, mass=0.25),
    DualRaceWheel(radius=0.05, rollers=16, roller_radius=0.008, race_spacing=0.02, mass=0.2),
    SplitDualRaceWheel(radius=0.05, rollers=16, roller_radius=0.008, mass=0.2),
    IdealWheel(radius=0.05, mass=0.1),
], ids=["standard", "half-sine", "mecanum", "dual", "split", "ideal"])  # fmt: skip
def test_every_wheel_vibrates(wheel):
    design = machine("pads", wheel)
    steady = vibration.response(design, [1.0, -2.0, 0.5])
    assert math.isfinite(steady.peak_acceleration)
    assert (steady.peak_displacement > 0) == (not isinstance(wheel, IdealWheel))
    assert len(steady.force_mean) == (6 if isinstance(wheel, SplitDualRaceWheel) else 3)


@pytest.mark.parametrize("count", [3, 4, 6])
def test_any_number_of_wheels(count):
    design = machine("mounts", count=count)
    steady = vibration.response(design, np.linspace(0.5, 2, count))
    run = vibration.transient(design, np.linspace(0.5, 2, count), 0.5, start="steady")
    assert relative(run.displacement, steady.at(run.time).displacement) < 1e-10


@pytest.mark.parametrize("seed", range(6))
def test_peaks_of_incommensurate_wheels_are_the_largest_over_all_phases(seed):
    """Speeds in no ratio: max |Σ c_i| over all phases, sought here over 4000 directions on curves of each wheel alone.

    2000 places a curve miss a top by less than 1e-4 of it; from each direction the farthest points are one joint point.
    """
    rng = np.random.default_rng([81, seed])
    design = atlas(StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25), radius=1.22)
    # Little damping: the motion rings, and there are many tops of nearly one height.
    contact = Contact(float(rng.uniform(5e4, 5e5)), float(10 ** rng.uniform(0.5, 2)))
    design = replace(design, sphere=replace(design.sphere, mass=5.0), contact=contact)
    speed = rng.uniform(0.5, 3.0, 3)
    whole = vibration.response(design, speed)
    directions = rng.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    rest = vibration.response(design, np.zeros(3)).at(0.0)
    for name, found in (("displacement", whole.peak_displacement), ("velocity", whole.peak_velocity)):
        joint = getattr(rest, name) * np.ones((4000, 1))
        for i in range(3):
            alone = vibration.response(design, np.where(np.arange(3) == i, speed, 0.0))
            time = np.linspace(0, 2 * np.pi / 14 / speed[i], 2000)
            curve = getattr(alone.at(time), name) - getattr(rest, name)
            joint = joint + curve[np.argmax(directions @ curve.T, axis=1)]
        brute = np.linalg.norm(joint, axis=1).max()
        assert brute * (1 - 2e-3) <= found <= brute * (1 + 1e-2)
