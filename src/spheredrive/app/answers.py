"""What the page asks of the functions below it for a design and wheel speeds. Nothing is worked out here."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from spheredrive import kinematics
from spheredrive.checking import Check, check
from spheredrive.design import Design
from spheredrive.errors import NearSingularWarning, SpheredriveError

# A layout nearer than this to a singularity, by elevation, heading or roller angle, is marked, rad.
NEAR = math.radians(10)


@dataclass(frozen=True, eq=False)
class Answers:
    """The kinematic answer for a design, and what its sphere does at wheel speeds.

    nearness          0 far from every singularity, rising to 1 at one
    angular_velocity  Ω, (3,), rad/s, or None where the wheels do not determine it, for which ``no_motion`` says why
    effectiveness     ξ at these speeds, None at rest
    slip              S of all wheels where they are more than three, None at rest
    """

    check: Check
    nearness: float
    angular_velocity: np.ndarray | None
    no_motion: str
    effectiveness: float | None
    slip: float | None


def answers(design: Design, wheel_speed: np.ndarray, known: Check | None = None) -> Answers:
    """Everything the page shows of ``design`` at wheel speeds ω (n,), rad/s; ``known`` where it was checked before."""
    found = check(design) if known is None else known
    Omega, effectiveness, slip, why = None, None, None, ""
    with warnings.catch_warnings():
        # Near singularity is told by a finding.
        warnings.simplefilter("ignore", NearSingularWarning)
        try:
            Omega = kinematics.forward(design, wheel_speed)
            if np.abs(wheel_speed).max() > 0:
                effectiveness = float(kinematics.transmission(design, wheel_speed).effectiveness)
                slip = float(kinematics.slip(design, wheel_speed).overall) if design.wheel_count > 3 else None
        except SpheredriveError as error:
            why = str(error)
    return Answers(found, nearness(found), Omega, why, effectiveness, slip)


def nearness(found: Check) -> float:
    """How near a layout is to a singularity: 0 from ``NEAR`` on, 1 at one, and 1 for a design that does not work."""
    if not found.works:
        return 1.0
    near = found.nearest_singularity
    return 0.0 if near is None else max(0.0, 1.0 - abs(near.change) / NEAR)
