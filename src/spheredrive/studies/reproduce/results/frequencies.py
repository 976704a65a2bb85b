"""Natural frequencies over the stiffnesses of contact, mount and closure (Fig 4.8, 4.9), in the thesis's model and in ours."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from spheredrive import vibration
from spheredrive.studies.reproduce import assumptions, machines

MOUNTS = (*assumptions.MOUNT_STIFFNESS.value, None)


def design(stiffness: float, mount: float | None = None, closure: float = 0.0):
    """The demonstrator with these stiffnesses, N/m."""
    machine = machines.atlas(machines.standard_wheel(), stiffness)
    return machines.closed(machines.mounted(machine, mount), closure)


def lowest(stiffness: float, mount: float | None = None, closure: float = 0.0, **options) -> float:
    """Lowest natural frequency, Hz; ``options`` as ``vibration.modes`` takes them."""
    return float(vibration.modes(design(stiffness, mount, closure), **options).natural_frequencies[0])


@lru_cache
def over_contact(mount: float | None, model: str) -> np.ndarray:
    """Lowest and highest mode below the wheels' own, over the range of K, (k, 2), Hz."""
    rows = []
    for K in assumptions.STIFFNESS_RANGE.value:
        frequencies = vibration.modes(design(float(K), mount), model=model).natural_frequencies[:3]
        rows.append((frequencies[0], frequencies[-1]))
    return np.array(rows)


@lru_cache
def over_closure(stiffness: float, sign: str, model: str = "independent") -> np.ndarray:
    """Lowest and third natural frequency over the range of K′ on rigid mounts, (k, 2), Hz."""
    options: dict[str, Any] = {"closure_sign": sign} if model == "independent" else {}
    rows = []
    for K_closure in assumptions.CLOSURE_RANGE.value:
        found = vibration.modes(design(stiffness, None, float(K_closure)), model=model, **options).natural_frequencies
        rows.append((found[0], found[2]))
    return np.array(rows)
