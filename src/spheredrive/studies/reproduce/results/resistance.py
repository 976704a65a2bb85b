"""What rolling and spin resistance do to the demonstrator under small torques, at two sizes of the normal forces."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from spheredrive.contact import Hertz, hertz
from spheredrive.design import Design
from spheredrive.dynamics import thesis_closure_force
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.results import perfect_world

STIFFNESS = 188208.0


class Slowed(NamedTuple):
    """A mean normal force, N; the lever arms that follow from it, m; the share of |Ω̇| that resistance takes."""

    normal_force: float
    rolling_arm: float
    spin_arm: float
    share: float


def patch(normal_force: float, radius: float, other_radius: float) -> Hertz:
    """The circular patch at the modulus that gives the measured stiffness at this force [3.12–3.17]."""
    relative = 1 / (1 / radius + 1 / other_radius)

    def stiffness(log_modulus: float) -> float:
        return float(hertz(normal_force, relative, modulus=math.exp(log_modulus)).stiffness) - STIFFNESS

    return hertz(normal_force, relative, modulus=math.exp(brentq(stiffness, math.log(1e3), math.log(1e13), xtol=1e-12)))


@lru_cache
def at_least_preload() -> Slowed:
    """Orthogonal layout without weight, pressed by the thesis's least closure force [3.45–3.46]."""
    design, run = perfect_world.design(), perfect_world.run()
    force = thesis_closure_force(design, run)[1]
    normal = float(np.abs(run.friction_force[1]).mean() / design.contact.friction)  # type: ignore[operator]
    return _slowed(replace(design, closure=replace(design.closure, force=tuple(map(float, force)))), normal)


@lru_cache
def under_weight() -> Slowed:
    """Atlas layout, pressed by the sphere's own weight."""
    design = machines.with_wheel(machines.shipped("atlas-demonstrator"), machines.shipped("orthogonal").wheels[0])
    run = run_rolling(design, perfect_world.motion(1.0))
    return _slowed(design, float(run.normal_force[1].mean()))


def _slowed(design: Design, normal: float) -> Slowed:
    p = patch(normal, design.sphere.radius, design.wheels[0].radius)
    rolling_arm, spin_arm = float(p.a), 3 * math.pi * float(p.a) / 16
    resisting = replace(design, contact=replace(design.contact, rolling_arm=rolling_arm, spin_arm=spin_arm))
    motion = perfect_world.motion(1.0)
    free, held = (np.linalg.norm(run_rolling(one, motion).angular_velocity[-1]) for one in (design, resisting))
    return Slowed(normal, rolling_arm, spin_arm, float(1 - held / free))
