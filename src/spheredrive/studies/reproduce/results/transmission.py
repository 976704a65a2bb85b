"""Transmission ratio and effectiveness of both wheels over the speeds of Fig 4.7."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from spheredrive import kinematics
from spheredrive.studies.reproduce import machines

# The figure's axis: every combination of these speeds, but all at rest.
SPEEDS = np.linspace(0.0, 2.5, 11)


class Transmissions(NamedTuple):
    """Norm |ω| of the speeds (k,), rad/s, and τ and ξ of each wheel, (k,)."""

    norm: np.ndarray
    ratio: dict[str, np.ndarray]
    effectiveness: dict[str, np.ndarray]


def layouts():
    """The Atlas layout with both wheels, by name."""
    return {"standard": machines.atlas(machines.standard_wheel()), "Mecanum": machines.atlas(machines.mecanum_wheel())}


def combinations() -> np.ndarray:
    """All combinations of speeds but rest, (k, 3), rad/s."""
    return np.stack(np.meshgrid(SPEEDS, SPEEDS, SPEEDS, indexing="ij"), -1).reshape(-1, 3)[1:]


@lru_cache
def transmissions() -> Transmissions:
    """Of all combinations of speeds."""
    grid = combinations()
    found = {name: kinematics.transmission(design, grid) for name, design in layouts().items()}
    return Transmissions(
        np.linalg.norm(grid, axis=-1),
        {name: t.ratio for name, t in found.items()},
        {name: t.effectiveness for name, t in found.items()},
    )
