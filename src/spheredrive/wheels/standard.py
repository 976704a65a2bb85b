"""The standard omnidirectional wheel: one race of rollers across the drive direction, with gaps between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.values import quantity
from spheredrive.wheels.base import RollerWheel


@dataclass(frozen=True, kw_only=True)
class StandardWheel(RollerWheel):
    """One race; ``roundness`` η is the share of the turn that falls to gaps [3.10]: 0 round, 1 all gap."""

    type: ClassVar[str] = "standard"
    gap_comes_first: ClassVar[bool] = True

    roundness: float | None = quantity("", "gap share of the turn, eta, from 0 to 1", sign="non-negative", default=None)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.roundness is not None and self.roundness >= 1:
            raise DesignError(f"is {self.roundness:g}, but must be below 1: at 1 there is no roller left", ("roundness",))

    @property
    def roller_share(self) -> float | None:
        """θ_b = (1 − η) 2π/n_r, or None where the roundness does not say."""
        if self.rollers is None or self.roundness is None:
            return None
        return (1 - self.roundness) * 2 * math.pi / self.rollers

    def half_sine(self, sphere_radius: float) -> tuple[float, float]:
        """θ_s = η 2π/n_r and the thesis's Δr [3.6]."""
        if self.rollers is None:
            raise DesignError("the half sine needs the number of rollers; give rollers", ("rollers",))
        if self.roundness is None:
            raise DesignError("the half sine of a standard wheel needs its gaps; give roundness", ("roundness",))
        gap = self.roundness * 2 * math.pi / self.rollers
        if self.radius * math.sin(gap / 2) >= sphere_radius:
            raise DesignError("the sphere is smaller than the gap between two rollers and falls into it", ("roundness",))
        return gap, float(gap_depth(self.radius, sphere_radius, gap))


def sphere_gap_angle(wheel_radius, sphere_radius, gap_angle) -> np.ndarray:
    """The angle θ_R that a gap θ_s of the wheel takes at the sphere's centre: θ_R = 2 asin((r_b/R) sin(θ_s/2)) [3.4].

    Lengths in m, angles in rad, broadcast. Raises ``SpheredriveError`` where the sphere falls into the gap.
    """
    sine = np.asarray(wheel_radius, float) / sphere_radius * np.sin(np.asarray(gap_angle, float) / 2)
    if not (np.abs(sine) < 1).all():
        raise SpheredriveError("the sphere is smaller than the gap between two rollers and falls into it")
    return 2 * np.arcsin(sine)


def gap_depth(wheel_radius, sphere_radius, gap_angle) -> np.ndarray:
    """Depth Δr (m) by which the sphere falls into the gap θ_s (rad) between two rollers of a standard wheel.

        Δr = R (1 − cos(θ_R/2)) + r_b (1 − cos(θ_s/2))

    Lengths in m, broadcast. Raises as ``sphere_gap_angle``. Source: model.md section 3, [3.6].
    """
    theta_R = sphere_gap_angle(wheel_radius, sphere_radius, gap_angle)
    # 1 − cos x = 2 sin²(x/2) keeps its digits for small gaps.
    return 2 * sphere_radius * np.sin(theta_R / 4) ** 2 + 2 * wheel_radius * np.sin(np.asarray(gap_angle, float) / 4) ** 2
