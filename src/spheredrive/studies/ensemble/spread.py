"""Machines as they are really made: a design with its parameters scattered, member by member."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.frames import quaternion_exponential, quaternion_matrix
from spheredrive.studies.sweep.sampling import uniforms
from spheredrive.values import check_fields, quantity

if TYPE_CHECKING:
    from spheredrive.design import Design, Placement
    from spheredrive.wheels import Wheel


@dataclass(frozen=True)
class Spread:
    """How far machines scatter about their design; what is zero does not.

    friction    relative standard deviation of μ, one number for a machine: log-normal with the design's value as its mean
    alignment   standard deviation, rad, of a small rotation of each wheel about each of the three axes
    radius      relative standard deviation of each wheel's radius, normal
    wear        of each wheel's rollers, m: half-normal, |z| times this is gone from their radius and from the wheel's
    """

    friction: float = quantity("", "relative standard deviation of the friction", sign="non-negative", default=0.0)
    alignment: float = quantity("rad", "standard deviation of each wheel's rotations", sign="non-negative", default=0.0)
    radius: float = quantity("", "relative standard deviation of each wheel's radius", sign="non-negative", default=0.0)
    wear: float = quantity("m", "scale of the wear of each wheel's rollers", sign="non-negative", default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)


def varied_designs(design: Design, spread: Spread, count: int, seed: int = 1) -> list[Design]:
    """Members 0 … ``count`` − 1 of the ensemble. Raises as ``varied_design``."""
    return [varied_design(design, spread, seed, member) for member in range(count)]


def varied_design(design: Design, spread: Spread, seed: int, member: int) -> Design:
    """Member ``member``, from 0, of the ensemble about ``design``; it follows from the seed and its number alone.

    A wheel that is turned takes its contact and its drive direction with it. A wheel of another radius, or worn, still touches
    where it is drawn to touch: its axle is set so.
    Raises ``DesignError`` where the numbers drawn make no machine, as wear beyond a roller's radius does.
    """
    draw = _Draw(seed, member)
    friction = design.contact.friction
    if friction and spread.friction:
        # Of a log-normal number with mean 1 and standard deviation s: ln(1 + s²) is the variance of its logarithm.
        width = math.sqrt(math.log1p(spread.friction**2))
        friction *= math.exp(width * draw("friction") - width**2 / 2)
    placements = tuple(_varied(p, spread, draw, i) for i, p in enumerate(design.placements, 1))
    return replace(design, placements=placements, contact=replace(design.contact, friction=friction))


class _Draw:
    """Standard normal numbers of one member, each by its name."""

    def __init__(self, seed: int, member: int):
        self.seed, self.member = seed, member

    def __call__(self, name: str) -> float:
        from scipy.special import ndtri

        return float(ndtri(uniforms(self.seed, f"ensemble {name}", np.array([self.member])))[0])


def _varied(placement: Placement, spread: Spread, draw: _Draw, wheel: int) -> Placement:
    worn = _worn(placement.wheel, spread, draw, wheel)
    if not spread.alignment:
        return replace(placement, wheel=worn)
    turned = spread.alignment * np.array([draw(f"alignment {wheel} {axis}") for axis in "xyz"])
    turn = quaternion_matrix(quaternion_exponential(turned))
    contact, drive = turn @ placement.contact_direction, turn @ placement.drive_direction
    return replace(placement, wheel=worn, contact_direction=tuple(contact), drive_direction=tuple(drive))


def _worn(wheel: Wheel, spread: Spread, draw: _Draw, number: int) -> Wheel:
    radius, rollers = wheel.radius, getattr(wheel, "roller_radius", None)
    if spread.radius:
        radius *= 1.0 + spread.radius * draw(f"radius {number}")
    if spread.wear:
        gone = spread.wear * abs(draw(f"wear {number}"))
        radius, rollers = radius - gone, rollers and rollers - gone
    if radius == wheel.radius:
        return wheel
    changed = {"radius": radius} if rollers is None else {"radius": radius, "roller_radius": rollers}
    if hasattr(wheel, "outline"):
        # A measured outline grows and shrinks as a whole.
        changed["outline"] = tuple((angle, r + radius - wheel.radius) for angle, r in wheel.outline)
    return replace(wheel, **changed)
