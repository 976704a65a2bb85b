"""What the outlines of both wheels excite: Fig 4.4–4.6 over the wheel's angle, Fig 4.16–4.18 over η and n_r."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from spheredrive.shape import Excitation, Profile, excitation, profile
from spheredrive.studies.reproduce import assumptions, machines
from spheredrive.wheels.base import Wheel

WHEELS = ("standard", "Mecanum")
OUTLINES = ("half-sine", "exact")


def wheel(kind: str, **keys) -> Wheel:
    """The wheel of that name."""
    return machines.standard_wheel(**keys) if kind == "standard" else machines.mecanum_wheel(**keys)


def outline(kind: str, shape: str, **keys) -> Profile:
    """The outline of a wheel on the demonstrator's sphere, "half-sine" or "exact"."""
    return profile(wheel(kind, **keys), machines.shipped("atlas-demonstrator").sphere.radius, shape)


@lru_cache(maxsize=16)
def at_unit_speed(kind: str, shape: str, **keys) -> Excitation:
    """Depth, velocity, acceleration and impulses of a wheel at 1 rad/s."""
    return excitation(outline(kind, shape, **keys), 1.0)


class Potential(NamedTuple):
    """Over a parameter (k,): depth, m; at 1 rad/s largest velocity, m/s, acceleration off the corners, m/s², and the largest
    jump of velocity at a corner, m/s."""

    parameter: np.ndarray
    depth: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    impulse: np.ndarray


@lru_cache
def potential(kind: str, shape: str) -> Potential:
    """Of the standard wheel over η, of the Mecanum wheel over n_r."""
    key, values = ("roundness", assumptions.ROUNDNESS_RANGE.value) if kind == "standard" else (
        "rollers", assumptions.ROLLER_COUNTS.value
    )  # fmt: skip
    found = [excitation(outline(kind, shape, **{key: value.item()}), 1.0) for value in values]
    return Potential(
        values,
        np.array([e.depth for e in found]),
        np.array([float(e.velocity) for e in found]),
        np.array([float(e.acceleration) for e in found]),
        np.array([np.abs(e.impulses).max(initial=0.0) for e in found]),
    )
