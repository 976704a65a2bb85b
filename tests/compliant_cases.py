"""Machines of every wheel type for the tests of the compliant model, and what acts in one of their states."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spheredrive.design import Closure, Contact, Design, Motor, Mount, Placement, Sphere, Spring, Stage
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.energy import energies
from spheredrive.dynamics.compliant.instant import rates
from spheredrive.dynamics.compliant.machine import Machine, machine
from spheredrive.dynamics.compliant.station import ALL, DERIVATIVES, ROLLER_SIZE, STORED, TOUCH_SIZE, WRENCH_SIZE
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant import run as run_module
from spheredrive.simulation.compliant.engine import settle
from spheredrive.simulation.compliant.run import Accuracy
from spheredrive.simulation.compliant.seat import Instant, seat
from spheredrive.wheels import (
    DualRaceWheel,
    IdealWheel,
    MeasuredWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
    TripleRaceWheel,
)

M, R = 2.0, 0.15
G = 9.80665
OMNI = dict(radius=0.0758, rollers=14, mass=0.25)
_TURN = np.linspace(0, 2 * math.pi, 40, endpoint=False)
WHEELS = {
    "ideal": IdealWheel(radius=0.05, mass=0.2),
    "ideal-inclined": IdealWheel(radius=0.05, mass=0.2, roller_angle=math.radians(50)),
    "sphere": StandardWheel(**OMNI, roller_radius=0.0125, roller_shape="sphere", roller_drag=1e-4),
    "sphere-turning": StandardWheel(**OMNI, roller_radius=0.0125, roller_shape="sphere", roller_drag=1e-5, roller_inertia=1e-6),
    "capsule": StandardWheel(**OMNI, roller_radius=0.010, roller_shape="capsule", roller_length=0.007),
    "cylinder": StandardWheel(**OMNI, roller_radius=0.010, roller_shape="cylinder", roller_length=0.015, roller_drag=1e-4),
    "barrel": StandardWheel(**OMNI, roller_radius=0.012, roundness=0.3),
    "half-sine": StandardWheel(**OMNI, roundness=0.4485, profile="half-sine"),
    "mecanum": MecanumWheel(radius=0.0758, rollers=16, mass=0.25, roller_drag=1e-4),
    "mecanum-left": MecanumWheel(radius=0.0758, rollers=16, mass=0.25, roller_angle=math.radians(-45), roller_inertia=1e-6),
    "mecanum-half-sine": MecanumWheel(radius=0.0758, rollers=16, mass=0.25, profile="half-sine"),
    "measured": MeasuredWheel(outline=tuple((a, 0.05 * (1 + 1e-3 * math.cos(5 * a))) for a in _TURN), mass=0.2),
    "dual-race": DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3, mass=0.1),
    "split-dual-race": SplitDualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, mass=0.1),
    "triple-race": TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=8e-3, mass=0.1),
}
UNEQUAL = ((0.03, 0.002, 0.0), (0.002, 0.025, -0.001), (0.0, -0.001, 0.02))
OFFSET = dict(inertia=UNEQUAL, centre_of_mass=(0.01, 0.02, -0.02))


def ring(wheel, count: int = 3, elevation_deg: float = -40.0, heading: float = 0.0):
    """Wheels at equal azimuths."""
    return tuple(Placement.at(wheel, 2 * math.pi * i / count, math.radians(elevation_deg), heading) for i in range(count))


def design(wheel, *, count=3, heading=0.0, contact=None, sphere=None, **rest) -> Design:
    """A 2 kg hollow sphere of 0.15 m on a ring of wheels 40 degrees below; K = 10⁵ N/m, C = 200 N s/m, μ = 0.9."""
    contact = Contact(**{"stiffness": 1e5, "damping": 200.0, "friction": 0.9, **(contact or {})})
    sphere = Sphere(R, **{"mass": M, "young_modulus": 1e9, "poisson_ratio": 0.3, **(sphere or {})})
    return Design("compliant", sphere, ring(wheel, count, heading=heading), contact=contact, **{"stage": Stage(5.0), **rest})


def everything(wheel, law: str = "linear") -> Design:
    """All at once: resistances, mounts, closure springs, an offset mass; by Hertz and Hunt and Crossley if asked for."""
    contact = dict(rolling_arm=1e-4, spin_arm=2e-4, creep_speed=1e-3)
    if law == "hertz":
        contact.update(law="hertz", damping=0.0, dissipation=0.5)
        wheel = replace(wheel, young_modulus=1e8, poisson_ratio=0.3)
    return design(
        wheel,
        contact=contact,
        sphere=OFFSET,
        mount=Mount(stiffness=1e6, damping=50.0),
        closure=Closure(force=(1.0, 2.0, -10.0), springs=(Spring((0.3, 0.2, 1.0), 2e3, 5.0),)),
        motor=Motor(torque=3.0),
    )


def evaluate(
    m: Machine, y, places=None, turns=None, drive=None, slope=None, kind=at.TORQUE, stage=None, stage_kind=at.STILL, acting=ALL
) -> Instant:
    """Rates and forces in the state ``y``; every roller that stands in the sphere acts unless ``acting`` says otherwise."""
    n, q = len(m.wheels), len(m.outlines)
    places, turns = m.places.copy() if places is None else places, np.zeros(q) if turns is None else turns
    settle(y, n, m.stations, m.outlines, m.pieces, places, turns)
    found = Instant(
        np.zeros(len(y)), np.zeros(at.POWERS), np.zeros(n), np.zeros((len(m.stations), WRENCH_SIZE)), np.zeros((q, TOUCH_SIZE)),
        np.zeros((len(m.stations), 7, 4)), np.zeros((len(m.stations), 7, 7)),
    )  # fmt: skip
    rates(
        y, *(np.zeros(k) if x is None else np.asarray(x, float) for x, k in ((drive, n), (slope, n), (stage, 3))),
        kind, stage_kind, m.body, m.wheels, m.stations, m.outlines, m.pieces, places, turns, np.full(q, acting),
        DERIVATIVES, 1.0, *found[:5], np.zeros((m.rollers, ROLLER_SIZE)), *found[5:],
    )  # fmt: skip
    return found


def random_state(m: Machine, rng: np.random.Generator, depth: float = 3e-5, speed: float = 0.02) -> np.ndarray:
    """A state near the seat at random wheel angles: pressed in unevenly, slipping, everything in motion."""
    y = np.zeros(m.state_size)
    y[at.QUATERNION : at.QUATERNION + 4] = rng.normal(size=4)
    y[at.QUATERNION : at.QUATERNION + 4] /= np.linalg.norm(y[at.QUATERNION : at.QUATERNION + 4])
    wheels = slice(at.WHEELS, at.WHEELS + at.WHEEL_STATES * len(m.wheels), at.WHEEL_STATES)
    y[wheels] = rng.uniform(0, 2 * math.pi, len(m.wheels))
    y = seat(m, y, m.places.copy(), np.zeros(len(m.outlines)))
    y[at.CENTRE : at.CENTRE + 3] += depth * rng.uniform(-1, 1, 3)
    y[at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3] = speed * rng.normal(size=3)
    y[at.OMEGA : at.OMEGA + 3] = rng.normal(size=3)
    y[at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3] = speed * rng.normal(size=3)
    y[at.WHEELS + 1 : wheels.stop : at.WHEEL_STATES] = rng.normal(size=len(m.wheels))
    mounts = wheels.stop + at.STATION_STATES * np.flatnonzero(m.stations[:, at.MOUNT_MASS])
    y[mounts + 1] = 0.1 * speed * rng.normal(size=len(mounts))
    y[len(y) - m.rollers :] = 5 * rng.normal(size=m.rollers)
    return y


def energy(m: Machine, y, places=None, turns=None) -> float:
    """All that is stored in a state, J."""
    now = evaluate(m, y, places, turns)
    kinetic, potential = energies(y, m.body, m.wheels, m.stations, m.outlines)
    return float(kinetic + potential + now.wrenches[:, STORED].sum())


def machine_of(name: str, law: str = "linear") -> Machine:
    """``everything`` on wheels of that name as flat arrays."""
    return machine(everything(WHEELS[name], law))


def run_from(d: Design, motion: Motion, accuracy: Accuracy | None = None, change=None, first_step: float = 1e-6):
    """A run that starts in the state that ``change`` makes of the seat, in place."""
    arrays = run_module._Arrays([d], [motion], accuracy or Accuracy())
    if change is not None:
        change(arrays.y[0])
    arrays.clock[0, 1] = first_step
    arrays.advance(None)
    return arrays.run(0), arrays.y[0]


def speeds(values, duration: float, **rest) -> Motion:
    """Wheel speeds that do not change."""
    return Motion("wheel-speed", Series((0.0,), (tuple(values),)), duration, **rest)


def torques(values, duration: float, **rest) -> Motion:
    """Wheel torques that do not change."""
    return Motion("wheel-torque", Series((0.0,), (tuple(values),)), duration, **rest)
