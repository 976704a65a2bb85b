"""Largest displacement of the centre over the stiffnesses of contact, mount and closure (Fig 4.10–4.15), Atlas at 40°."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from spheredrive import vibration
from spheredrive.design import Design
from spheredrive.errors import SingularError
from spheredrive.studies.reproduce import assumptions, machines

SLOW, FAST = (0.1, 1.2, 0.9), (2.0, 2.0, 2.0)
KINDS = ("standard", "Mecanum")


class Sweep(NamedTuple):
    """Largest |ΔR| (m) of both wheels over a stiffness (k,), N/m."""

    stiffness: np.ndarray
    standard: np.ndarray
    mecanum: np.ndarray

    @property
    def ratio(self) -> np.ndarray:
        """κ [4.10]."""
        return self.mecanum / self.standard


def largest(design: Design, speeds, thesis: bool) -> float:
    """Largest |ΔR| of the steady motion: in the thesis's model and measure, or of the true centre; NaN at a resonance."""
    options: dict[str, Any] = {}
    if thesis:
        options = {"model": "independent", "closure_sign": "thesis"}
        if design.contact.stiffness is not None:
            options["measure"] = "thesis"
    try:
        return vibration.response(design, speeds, **options).peak_displacement
    except SingularError:
        return float("nan")


def wheels(thesis: bool):
    """Standard and Mecanum wheel, with the outline that goes with the model."""
    shape = "half-sine" if thesis else "exact"
    return machines.standard_wheel(shape), machines.mecanum_wheel(shape)


def _sweep(values, speeds, thesis: bool, machine) -> Sweep:
    found = [[largest(machine(wheel, float(value)), speeds, thesis) for value in values] for wheel in wheels(thesis)]
    return Sweep(np.asarray(values, float), *map(np.array, found))


@lru_cache
def over_contact(speeds: tuple, damping: float, thesis: bool) -> Sweep:
    """Over K, Fig 4.10 and 4.11."""
    values = assumptions.STIFFNESS_RANGE.value
    return _sweep(values, speeds, thesis, lambda wheel, K: machines.atlas(wheel, K, damping))


@lru_cache
def over_mount(stiffness: float, speeds: tuple, damping: float, thesis: bool) -> Sweep:
    """Over k, Fig 4.12."""
    values = assumptions.MOUNT_RANGE.value
    return _sweep(values, speeds, thesis, lambda wheel, k: machines.mounted(machines.atlas(wheel, stiffness, damping), k))


@lru_cache
def over_closure(stiffness: float | None, speeds: tuple, damping: float, thesis: bool) -> Sweep:
    """Over K′, Fig 4.13 to 4.15; rigid contacts without ``stiffness``."""
    values = assumptions.CLOSURE_RANGE.value
    damping = 0.0 if stiffness is None else damping
    return _sweep(values, speeds, thesis, lambda wheel, k: machines.closed(machines.atlas(wheel, stiffness, damping), k))


@lru_cache
def rigid(speeds: tuple, thesis: bool) -> tuple[float, float]:
    """Largest |ΔR| (m) of both wheels with everything rigid."""
    standard, mecanum = (largest(machines.atlas(wheel), speeds, thesis) for wheel in wheels(thesis))
    return standard, mecanum
