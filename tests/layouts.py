"""Designs the tests share: the thesis's layouts by their formulas, and random ones of every wheel type."""

from __future__ import annotations

import math

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design, Placement, Sphere
from spheredrive.wheels import (
    DualRaceWheel,
    IdealWheel,
    MeasuredWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
    TripleRaceWheel,
)

R = 0.15
DUAL = dict(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3)


def atlas(wheel=None, elevation_deg: float = -40.0, heading_deg: float = 0.0, radius: float = R, count: int = 3) -> Design:
    """A ring of wheels at azimuths 0, 120, 240 degrees."""
    wheel = wheel or DualRaceWheel(**DUAL)
    placements = [
        Placement.at(wheel, 2 * math.pi * i / count, math.radians(elevation_deg), math.radians(heading_deg))
        for i in range(count)
    ]
    return Design("Atlas", Sphere(radius), placements)


def orthogonal(roller_angle: float = math.pi / 2) -> Design:
    """R̂ = i, j, k; v̂ = k, i, j [2.37–2.41]."""
    wheel = IdealWheel(radius=0.025, roller_angle=roller_angle)
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    return Design("orthogonal", Sphere(R), [Placement(wheel, *pair) for pair in ((x, z), (y, x), (z, y))])


def six_orthogonal() -> Design:
    """R̂ = ±i, ±j, ±k; v̂ = ±k, ±i, ±j."""
    wheel = IdealWheel(radius=0.025)
    axes = np.eye(3)
    pairs = [(s * axes[i], s * axes[(i + 2) % 3]) for s in (1, -1) for i in range(3)]
    return Design("six", Sphere(R), [Placement(wheel, tuple(c), tuple(d)) for c, d in pairs])


def collinear_triple() -> Design:
    """R̂ = i, (i + j)/√2, j and Ω̂ = j, k, i [2.99–2.100], so v̂ = Ω̂ × R̂."""
    wheel = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=10e-3)
    x, y, z = np.eye(3)
    contacts = [x, (x + y) / math.sqrt(2), y]
    induced = [y, z, x]
    return Design(
        "collinear",
        Sphere(R),
        [Placement(wheel, tuple(c), tuple(np.cross(o, c))) for c, o in zip(contacts, induced, strict=True)],
    )


def random_wheel(rng: np.random.Generator, kind: str | None = None):
    """A wheel of a random or given type, with any roller angle and hand."""
    kind = kind or rng.choice(["ideal", "standard", "dual-race", "split-dual-race", "mecanum", "measured"])
    common = dict(radius=rng.uniform(0.01, 0.1), roller_angle=rng.choice([-1, 1]) * rng.uniform(0.5, math.pi / 2))
    rollers = dict(rollers=12, roller_radius=common["radius"] * rng.uniform(0.1, 0.4))
    races = dict(race_spacing=common["radius"] * rng.uniform(0.2, 0.6))
    if kind == "measured":
        turn = np.linspace(0, 2 * math.pi, 20, endpoint=False)
        outline = tuple((a, common["radius"] * (1 + 0.01 * math.cos(5 * a))) for a in turn)
        return MeasuredWheel(outline=outline, roller_angle=common["roller_angle"])
    return {
        "ideal": lambda: IdealWheel(**common),
        "standard": lambda: StandardWheel(**common, **rollers),
        "mecanum": lambda: MecanumWheel(**common, **rollers),
        "dual-race": lambda: DualRaceWheel(**common, **rollers, **races),
        "split-dual-race": lambda: SplitDualRaceWheel(**common, **rollers),
        "triple-race": lambda: TripleRaceWheel(**common, **rollers, **races),
    }[kind]()


def random_directions(rng: np.random.Generator) -> tuple[tuple, tuple]:
    """A random perpendicular pair of unit vectors."""
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return tuple(frame[0]), tuple(frame[1])


def random_design(rng: np.random.Generator, n: int, kind: str | None = None, condition: float = 30.0) -> Design:
    """A design of n random wheels whose constraint matrix has at most the given condition number."""
    while True:
        placements = [Placement(random_wheel(rng, kind), *random_directions(rng)) for _ in range(n)]
        design = Design("random", Sphere(rng.uniform(0.05, 2.0)), placements)
        if n < 3 or np.linalg.cond(kinematics.constraint(design)[0]) < condition:
            return design


def random_races(rng: np.random.Generator, design: Design):
    """A random contact state of the design."""
    return tuple(w.alternation[rng.integers(len(w.alternation))] for w in design.wheels)
