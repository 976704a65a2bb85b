"""Real outlines on a rigid machine (Fig 3.6–3.10) and on elastic contacts (Fig 3.11–3.13), orthogonal layout."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from spheredrive import vibration
from spheredrive.studies.reproduce import assumptions, machines
from spheredrive.vibration import Transient

SPEEDS = assumptions.IMPERFECT_SPEEDS.value
STIFFNESS = 188208.0
DAMPINGS = (0.0, 8500.0, 20000.0)
ROUNDNESS = 0.4485


@lru_cache(maxsize=64)
def rigid(profile: str, roundness: float, duration: float, sample_rate: float = 2000.0) -> Transient:
    """ΔR over time with everything rigid: N⁻¹h and its derivatives."""
    wheel = machines.standard_wheel(profile, roundness=roundness)
    return vibration.transient(machines.orthogonal(wheel), SPEEDS, duration, sample_rate)


@lru_cache(maxsize=64)
def elastic(profile: str, damping: float, duration: float, measure: str = "true", sample_rate: float = 2000.0) -> Transient:
    """ΔR over time on elastic contacts: the "true" displacement of the centre, or the "thesis"'s measure (E3)."""
    wheel = machines.standard_wheel(profile, roundness=ROUNDNESS)
    design = machines.orthogonal(wheel, STIFFNESS, damping)
    return vibration.transient(design, SPEEDS, duration, sample_rate, model="independent", measure=measure)


class Growth(NamedTuple):
    """Largest |ΔR| (m) by the roundness ratio, of both outlines, and the wheel's own Δr, each (k,)."""

    roundness: np.ndarray
    half_sine: np.ndarray
    exact: np.ndarray
    depth: np.ndarray


@lru_cache
def growth() -> Growth:
    """Fig 3.10."""
    from spheredrive.shape import gap_depth

    eta = assumptions.ROUNDNESS_RANGE.value
    wheel = machines.standard_wheel()
    largest = {profile: np.array([_largest(profile, float(one)) for one in eta]) for profile in ("half-sine", "exact")}
    depth = gap_depth(wheel.radius, machines.shipped("orthogonal").sphere.radius, eta * 2 * np.pi / wheel.rollers)
    return Growth(eta, largest["half-sine"], largest["exact"], depth)


def _largest(profile: str, roundness: float) -> float:
    design = machines.orthogonal(machines.standard_wheel(profile, roundness=roundness))
    return vibration.response(design, SPEEDS).peak_displacement


def largest(motion: Transient) -> float:
    """Largest |ΔR| of the samples, m."""
    return float(np.linalg.norm(motion.displacement, axis=1).max())
