"""The dual-race wheel: two races side by side, half a roller pitch apart, that touch the sphere in turns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from spheredrive.wheels.base import Race, SpacedRaceWheel


@dataclass(frozen=True, kw_only=True)
class DualRaceWheel(SpacedRaceWheel):
    """Race 1 at o = −d/2 and race 2 at o = +d/2 alternate each half roller pitch [2.54–2.59]."""

    type: ClassVar[str] = "dual-race"
    alternation: ClassVar = ((1,), (2,))
    race_count: ClassVar[int] = 2

    def races(self, sphere_radius: float) -> tuple[Race, ...]:
        half = self.race_spacing / 2
        return (
            Race(1, -half, self.radius, self.roller_section),
            Race(2, +half, self.radius, self.roller_section),
        )
