"""The perfectly round wheel: one contact that never moves, and no excitation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from spheredrive.wheels.base import Wheel


@dataclass(frozen=True, kw_only=True)
class IdealWheel(Wheel):
    """A round outline that drives along v̂ and gives way as its rollers would."""

    type: ClassVar[str] = "ideal"
