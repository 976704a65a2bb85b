"""The triple-race wheel: the centre race takes turns with the two outer races, which touch together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from spheredrive.values import quantity
from spheredrive.wheels.base import Race, SpacedRaceWheel


@dataclass(frozen=True, kw_only=True)
class TripleRaceWheel(SpacedRaceWheel):
    """Races 1, 2, 3 at o = −d, 0, +d; race 2 alternates with races 1 and 3 together [2.79–2.86].

    With one radius for all races the sphere would drop by (R + r_r)(1 − cos Δθ) at each change, so the outer races are
    larger by that much unless ``outer_radius`` says otherwise.
    """

    type: ClassVar[str] = "triple-race"
    alternation: ClassVar = ((2,), (1, 3))
    race_count: ClassVar[int] = 3

    outer_radius: float | None = quantity("m", "radius of the outer races; level with the centre race if absent", default=None)

    def races(self, sphere_radius: float) -> tuple[Race, ...]:
        d = self.race_spacing
        outer = Race(1, -d, self.radius, self.roller_section)
        drop = (sphere_radius + self.roller_section) * (1 - math.cos(outer.deflection(sphere_radius)))
        outer_radius = self.radius + drop if self.outer_radius is None else self.outer_radius
        return (
            Race(1, -d, outer_radius, self.roller_section),
            Race(2, 0.0, self.radius, self.roller_section),
            Race(3, +d, outer_radius, self.roller_section),
        )
