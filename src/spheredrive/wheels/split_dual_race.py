"""The split dual-race wheel: the second race sits on a wheel of its own at the other side of the sphere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from spheredrive.values import whole
from spheredrive.wheels.base import Race, RollerWheel


@dataclass(frozen=True, kw_only=True)
class SplitDualRaceWheel(RollerWheel):
    """Race 2 touches at −R̂ and drives along −v̂ at the same speed, its rollers half a pitch behind.

    Contact is continuous and the constraint row is the single-race one. Rollers that are not square to the wheel must
    have the other hand on the second wheel, else the two would hold the sphere to different motions.
    """

    type: ClassVar[str] = "split-dual-race"
    alternation: ClassVar = ((1,), (2,))
    race_count: ClassVar[int] = 2

    rollers: int = whole("number of rollers, both wheels together", least=2)

    def races(self, sphere_radius: float) -> tuple[Race, ...]:
        return (
            Race(1, 0.0, self.radius, self.roller_section),
            Race(2, 0.0, self.radius, self.roller_section, antipodal=True),
        )
