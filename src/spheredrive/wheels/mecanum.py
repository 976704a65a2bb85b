"""The Mecanum wheel: one race of long rollers set askew, so that they overlap around the turn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

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
