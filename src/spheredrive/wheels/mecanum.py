"""The Mecanum wheel: one race of long rollers set askew, so that they overlap around the turn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from spheredrive.errors import DesignError
from spheredrive.values import quantity
from spheredrive.wheels.base import RollerWheel


@dataclass(frozen=True, kw_only=True)
class MecanumWheel(RollerWheel):
    """Rollers at 45° unless ``roller_angle`` says otherwise; +45° and −45° are the two hands [2.118]."""

    type: ClassVar[str] = "mecanum"

    roller_angle: float = quantity(
        "rad", "angle between roller axis and wheel axis; the sign is the hand", sign="any", default=math.pi / 4
    )

    @property
    def roller_section(self) -> float:
        """As given, else that of rollers that just touch each other: r_r = r s/(1 + s), s = sin(π/n_r) [4.4]."""
        if self.roller_radius is not None or self.rollers is None:
            return self.roller_radius or 0.0
        s = math.sin(math.pi / self.rollers)
        return self.radius * s / (1 + s)

    def half_sine(self, sphere_radius: float) -> tuple[float, float]:
        """A whole pitch 2π/n_r and the Δr of two rollers' circles that touch under the sphere [4.4, 4.6]."""
        if self.rollers is None:
            raise DesignError("the half sine needs the number of rollers; give rollers", ("rollers",))
        return 2 * math.pi / self.rollers, float(touching_circles_depth(sphere_radius, self.roller_section))


def touching_circles_depth(sphere_radius, roller_radius) -> np.ndarray:
    """Depth Δr (m) of the valley between two circles of radius r_r that touch each other under the sphere.

        Δr = R + r_r − √(R (R + 2 r_r))

    Lengths in m, broadcast. Source: model.md section 3, [4.4].
    """
    R, r_r = np.asarray(sphere_radius, float), np.asarray(roller_radius, float)
    # The difference of the two squares is r_r².
    return r_r**2 / (R + r_r + np.sqrt(R * (R + 2 * r_r)))
