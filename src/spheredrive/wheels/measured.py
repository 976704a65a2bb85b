"""A wheel whose outline was measured: a table of angle and radius over one turn."""

from __future__ import annotations

import dataclasses
import itertools
import math
from dataclasses import dataclass
from typing import ClassVar

from spheredrive.errors import DesignError
from spheredrive.values import checked_number
from spheredrive.wheels.base import Wheel


@dataclass(frozen=True, kw_only=True)
class MeasuredWheel(Wheel):
    """``outline`` holds (angle in rad, radius in m) pairs over one turn, angles rising.

    ``radius`` is the mean of the outline over the turn unless it is given.
    """

    type: ClassVar[str] = "measured"

    outline: tuple[tuple[float, float], ...] = dataclasses.field(
        metadata={"columns": ("angle", "radius"), "doc": "table of angle (rad) and radius (m) over one turn", "key": "file"}
    )
    radius: float | None = dataclasses.field(
        default=None,
        metadata={"unit": "m", "doc": "outer radius; the outline's mean if absent", "sign": "positive", "shape": ()},
    )

    def __post_init__(self) -> None:
        outline = tuple((float(angle), float(radius)) for angle, radius in self.outline)
        object.__setattr__(self, "outline", outline)
        if len(outline) < 3:
            raise DesignError("an outline needs at least three points", ("file",))
        for angle, radius in outline:
            checked_number(angle, "rad", "any", ("file",))
            checked_number(radius, "m", "positive", ("file",))
        steps = [b[0] - a[0] for a, b in itertools.pairwise(outline)]
        if min(steps) <= 0 or outline[-1][0] - outline[0][0] >= 2 * math.pi * (1 + 1e-9):
            raise DesignError("angles must rise from row to row and stay within one turn", ("file",))
        if self.radius is None:
            object.__setattr__(self, "radius", self.mean_radius)
        super().__post_init__()

    @property
    def mean_radius(self) -> float:
        """Mean of the outline over the turn, m, straight lines between the points and across the seam."""
        closed = [*self.outline, (self.outline[0][0] + 2 * math.pi, self.outline[0][1])]
        area = sum((b[0] - a[0]) * (a[1] + b[1]) / 2 for a, b in itertools.pairwise(closed))
        return area / (2 * math.pi)
