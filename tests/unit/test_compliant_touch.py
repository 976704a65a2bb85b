"""Contacts of the compliant model against bodies that are searched point by point, finite differences and dense algebra."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from compliant_cases import OFFSET, WHEELS, R, design, evaluate, everything, machine_of, random_state, run_from, speeds, torques
from spheredrive.design import Closure, Motor, Mount, Placement
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.machine import machine
from spheredrive.dynamics.compliant.station import GAP, STORED
from spheredrive.motion import Series, StageMotion
from spheredrive.shape import exact_envelope, profile, roller
from spheredrive.simulation.compliant import methods
from spheredrive.simulation.compliant.run import Accuracy

SHAPES = ["sphere", "capsule", "cylinder", "barrel", "mecanum", "mecanum-left", "dual-race"]
INCLINED = {
    "capsule inclined": replace(WHEELS["capsule"], roller_angle=math.radians(60), phase=0.1),
    "cylinder inclined": replace(WHEELS["cylinder"], roller_angle=math.radians(-70), roller_drag=0.0),
}
BODIES = {**{name: WHEELS[name] for name in SHAPES}, **INCLINED}


def frictionless(wheel):
    """One of three wheels at the bottom of the sphere, so that its frame is (x up, y along v̂, z along ŵ)."""
    d = design(wheel, contact=dict(friction=0.0))
    places = tuple(Placement(wheel, direction, (0.0, 1.0, 0.0)) for direction in ((0, 0, -1), (1, 0, 0.3), (-1, 0, 0.3)))
    return machine(replace(d, placements=places))


def state(m, displacement, angle):
    """The sphere's centre moved in the frame of the first station, the wheels at an angle."""
    y = np.zeros(m.state_size)
    y[at.QUATERNION] = 1.0
    y[at.CENTRE : at.CENTRE + 3] = m.stations[0, :9].reshape(3, 3).T @ displacement
    y[at.WHEELS : at.WHEELS + 9 : 3] = angle
    return y


def searched_gap(wheel, centre, angle):
    """Least distance of a point from all rollers less R, by search along each roller's axis and around its edges, in space.

    ``centre`` from the wheel's centre in (x to the sphere, y along v̂, z along ŵ). A roller is the envelope of balls ρ(s) about
    its axis; where the nearest is its last ball and the end is cut flat, the edge circle is what is near.
    """
    shape = exact_envelope(wheel, R)
    alpha, best = wheel.roller_angle, math.inf
    around = np.linspace(0, 2 * math.pi, 36001)
    for race, middle_angle in zip(shape.races, shape.centres, strict=True):
        body = roller(wheel, race)
        L, a = body.half_length, race.radius - race.roller_radius
        for k in range(wheel.rollers_per_race):
            beta = angle + wheel.phase_angle - middle_angle + k * shape.pitch
            if math.cos(beta) < 0.7:
                continue
            turned = np.array([[math.cos(beta), -math.sin(beta), 0], [math.sin(beta), math.cos(beta), 0], [0, 0, 1]])
            middle, axis = turned @ [a, 0, race.offset], turned @ [0, math.sin(alpha), math.cos(alpha)]

            def clear(s, middle=middle, axis=axis, body=body):
                points = middle + np.multiply.outer(s, axis)
                return np.linalg.norm(centre - points, axis=-1) - body.radius(s) - R

            places = np.linspace(-L, L, 401)
            nearest = places[np.argmin(clear(places))]
            step = 2 * L / 400
            found = minimize_scalar(
                clear, bounds=(max(-L, nearest - step), min(L, nearest + step)), method="bounded", options=dict(xatol=1e-12)
            ) if L else None  # fmt: skip
            least = min(clear(0.0), found.fun, *clear(np.array([-L, L]))) if L else clear(0.0)
            end = clear(np.array([-L, L])).min() <= least + 1e-15
            if L and end and not body.rounded:
                place, radius = body.edge()
                side = np.cross(axis, turned @ [1.0, 0, 0])
                side /= np.linalg.norm(side)
                circle = np.multiply.outer(np.cos(around), side) + np.multiply.outer(np.sin(around), np.cross(axis, side))
                ends = [middle + sign * place * axis + radius * circle for sign in (-1, 1)]
                least = min(np.linalg.norm(centre - edge, axis=1).min() for edge in ends) - R
            best = min(best, least)
    return best


@pytest.mark.parametrize("name", BODIES)
def test_gap_is_the_least_distance_in_space(name):
    """At any place of the sphere, with the wheel at any angle: pressed in deep enough that the nearest roller is looked at.

    The edge circle is searched in steps of 0.01°, which leaves σ/2 · (9e-5)² = 5e-11 m; sides are found to 1e-14 m."""
    rng = np.random.default_rng(4)
    wheel = BODIES[name]
    m = frictionless(wheel)
    for _ in range(12):
        angle = rng.uniform(0, 2 * math.pi)
        moved = np.array([rng.uniform(-6e-3, -2e-3), *rng.uniform(-2e-3, 2e-3, 2)])
        now = evaluate(m, state(m, moved, angle))
        counts = int(m.stations[0, at.OUTLINE_COUNT])
        centre = moved + np.array([m.stations[0, at.DISTANCE], 0, 0])
        expected = searched_gap(wheel, centre, angle)
        assert expected < 0
        assert now.touches[:counts, GAP].min() == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("name", WHEELS)
def test_rigid_contact_is_the_profile(name):
    """Lifted by h(ϑ) = r_w − r_b of the wheel's own profile the sphere just touches, at every wheel angle; then no deeper."""
    wheel = WHEELS[name]
    m = frictionless(wheel)
    race = 1 if any(race.antipodal for race in wheel.races(R)) else None
    outline = profile(wheel, R, race=race)
    counts = int(m.stations[0, at.OUTLINE_COUNT])
    for angle in np.random.default_rng(5).uniform(0, 2 * math.pi, 40):
        y = state(m, np.array([float(outline.height(angle)) - 1e-9, 0.0, 0.0]), angle)
        # 1e-9 m deeper, so that what is looked at touches; a tilted contact is as deep times cos τ, 1 − 3e-3.
        gap = evaluate(m, y).touches[:counts, GAP].min()
        assert -1e-9 - 2e-13 < gap < -0.95e-9


@pytest.mark.parametrize("name", WHEELS)
def test_force_faces_where_the_gap_opens(name):
    """Without friction a contact pushes along the gradient of its gap, found by differences; K gap is its size."""
    m = frictionless(WHEELS[name])
    rng = np.random.default_rng(6)
    outline = profile(WHEELS[name], R, race=1 if name == "split-dual-race" else None)
    counts = int(m.stations[0, at.OUTLINE_COUNT])
    for angle in rng.uniform(0, 2 * math.pi, 10):
        moved = np.array([float(outline.height(angle)) - 2e-5, *rng.uniform(-1e-5, 1e-5, 2)])

        def stored(move, moved=moved, angle=angle):
            return evaluate(m, state(m, moved + move, angle)).wrenches[0, STORED]

        force = evaluate(m, state(m, moved, angle)).wrenches[0, :3]
        found = [(stored(-1e-8 * e) - stored(1e-8 * e)) / 2e-8 for e in np.eye(3)]
        np.testing.assert_allclose(force, found, atol=1e-6)
        assert force[0] > 1.0 or counts > 1


@pytest.mark.parametrize("name", ["sphere", "barrel", "mecanum", "half-sine", "measured"])
def test_wheel_feels_the_cogging_torque(name):
    """−N r_w′ cos τ with tan τ = −D′/D, here D = R + r_w: the wheel would turn to where the sphere sinks.

    N cos τ is the force along the line of centres; an inclined roller leans it sideways besides."""
    wheel = WHEELS[name]
    m, outline = frictionless(wheel), profile(wheel, R)
    for angle in np.random.default_rng(7).uniform(0, 2 * math.pi, 20):
        height, slope = float(outline.height(angle)), float(outline.slope(angle))
        now = evaluate(m, state(m, np.array([height - 1e-8, 0, 0]), angle))
        force, N = now.wrenches[0, 0], np.linalg.norm(now.wrenches[0, :3])
        # Depth 1e-8 m beside levers of centimetres, and r_w′ moves by r_w″ times as much.
        assert now.wrenches[0, 6] == pytest.approx(-force * slope, abs=2e-6 * force * wheel.radius)
        if abs(wheel.roller_angle) == math.pi / 2:
            tilt = math.atan2(slope, R + wheel.radius + height)
            assert force == pytest.approx(N * math.cos(tilt), rel=1e-6)


COLUMNS = [*((at.CENTRE, k, 1e-8) for k in range(3)), *((at.CENTRE_VELOCITY, k, 1e-7) for k in range(3))]
COLUMNS += [(at.OMEGA, k, 1e-6) for k in range(3)]


@pytest.mark.parametrize("law", ["linear", "hertz"])
@pytest.mark.parametrize("name", [name for name in WHEELS if WHEELS[name].__dict__.get("roller_inertia", 0) == 0])
def test_derivatives_are_those_of_the_forces(name, law):
    """K by (d, ϑ) and D by (ḋ, Ω, ω) against central differences, with drag, resistances and two rollers in contact.

    Each entry to 1e-5 of its column's largest, in like units (forces, moments/R, wheel torque/r); rounding of the gap, 5e-17 m,
    leaves K 5e-17 m = 3e-11 N over the step. Every term matters: with one left out a method of order four has order one or two.
    """
    m = machine_of(name, law)
    rng = np.random.default_rng([9, list(WHEELS).index(name)])
    places, turns = m.places.copy(), np.zeros(len(m.outlines))
    for _ in range(2):
        y = random_state(m, rng)
        now = evaluate(m, y, places, turns)
        for s, station in enumerate(m.stations):
            wheel = at.WHEELS + at.WHEEL_STATES * int(station[at.STATION_WHEEL])
            ways = [(np.eye(len(y))[place : place + 3].T @ station[3 * k : 3 * k + 3], step) for place, k, step in COLUMNS]
            ways += [(np.eye(len(y))[wheel + 1], 1e-6), (np.eye(len(y))[wheel], 1e-7)]

            def wrench(z, s=s):
                return evaluate(m, z, places.copy(), turns.copy()).wrenches[s, :7]

            found = np.transpose([(wrench(y + step * way) - wrench(y - step * way)) / (2 * step) for way, step in ways])
            units = np.array([1, 1, 1, R, R, R, WHEELS[name].radius])
            said = np.concatenate([now.K[s, :, :3], now.D[s], now.K[s, :, 3:]], axis=1)
            rounding = 3e-11 * np.array([1.0 / step for _, step in ways])
            allowed = 1e-5 * np.abs(found / units[:, None]).max(axis=0) + 1e-5 + rounding
            assert (np.abs(said - found) / units[:, None] <= allowed).all(), (said - found) / units[:, None] / allowed


# A step of implicit Euler made linear: (1/h − J) k = f, y₁ = y + k.
EULER = methods.Method(
    1.0,
    np.zeros((1, 1)),
    np.zeros((1, 1)),
    alpha=np.zeros(1),
    gammas=np.zeros(1),
    m=np.ones(1),
    e=np.zeros(1),
    order=1,
    dense=np.zeros((2, 1)),
)


def machines_for_the_step():
    sphere = everything(WHEELS["sphere"])
    return {
        "offset mass, mounts": (sphere, torques((0.1, -0.2, 0.05), 1e-4)),
        "speeds": (sphere, speeds((1.0, -2.0, 0.5), 1e-4)),
        "speed loops": (
            replace(sphere, motor=Motor(proportional_gain=2.0, integral_gain=10.0)),
            speeds((1.0, -2.0, 0.5), 1e-4),
        ),
        "driven stage": (
            sphere,
            replace(torques((0.1, -0.2, 0.05), 1e-4), stage=StageMotion("force", Series((0.0,), ((1.0, 2.0, 3.0),)))),
        ),
        "turning rollers": (design(WHEELS["sphere-turning"]), torques((0.1, -0.2, 0.05), 1e-4)),
        "turning rollers at speeds": (
            design(WHEELS["mecanum-left"], mount=Mount(1e6, 50.0)),
            speeds((1.0, -2.0, 0.5), 1e-4),
        ),
        "halves at the antipode": (
            design(WHEELS["split-dual-race"], closure=Closure(force=(0, 0, -5.0))),
            torques((0.1, -0.2, 0.05), 1e-4),
        ),
        "four inclined rings": (
            design(WHEELS["ideal-inclined"], count=4, sphere=OFFSET),
            torques((0.1, -0.2, 0.05, 0.02), 1e-4),
        ),
    }


@pytest.mark.parametrize("name", machines_for_the_step())
def test_step_solves_the_whole_system(name, monkeypatch):
    """Elimination by wheels, positions, rollers and quaternion against (1/h − J) k = f with all of J by differences."""
    d, motion = machines_for_the_step()[name]
    monkeypatch.setitem(methods.METHODS, "euler", EULER)
    m = machine(d)
    h = motion.duration
    start = random_state(m, np.random.default_rng(11), speed=0.005)
    looped = d.motor.proportional_gain is not None
    kind = at.TORQUE if motion.kind == "wheel-torque" else (at.LOOP if looped else at.SPEED)
    stage_kind = at.STILL if motion.stage is None else at.DRIVEN
    if stage_kind == at.STILL:
        start[at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3] = 0.0

    def change(y):
        y[:] = start

    _, reached = run_from(d, motion, Accuracy(1e9, largest_step=h, method="euler"), change, first_step=h)
    drive = np.array(motion.series.values[0])
    push = np.zeros(3) if motion.stage is None else np.array(motion.stage.series.values[0])
    places, turns = m.places.copy(), np.zeros(len(m.outlines))

    def rate(y):
        return evaluate(m, y, places, turns, drive, None, kind, push, stage_kind).rate

    steps = np.full(len(start), 1e-6)
    steps[: at.CENTRE + 3] = steps[at.WHEELS + 3 * len(m.wheels) :: 2] = 1e-9
    J = np.transpose([(rate(start + e) - rate(start - e)) / (2 * e.max()) for e in np.diag(steps)])
    k = np.linalg.solve(np.eye(len(start)) / h - J, rate(start))
    expected = start + k
    q = slice(at.QUATERNION, at.QUATERNION + 4)
    expected[q] /= np.linalg.norm(expected[q])
    np.testing.assert_allclose(reached - start, expected - start, rtol=2e-6, atol=1e-7 * np.abs(k).max() + 1e-13)
