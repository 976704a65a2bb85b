"""The standard omnidirectional wheel: one race of rollers across the drive direction, with gaps between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from spheredrive.errors import DesignError
from spheredrive.values import quantity
from spheredrive.wheels.base import RollerWheel


@dataclass(frozen=True, kw_only=True)
class StandardWheel(RollerWheel):
    """One race; ``roundness`` η is the share of the turn that falls to gaps [3.10]: 0 round, 1 all gap."""

    type: ClassVar[str] = "standard"

    roundness: float | None = quantity("", "gap share of the turn, eta, from 0 to 1", sign="non-negative", default=None)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.roundness is not None and self.roundness >= 1:
            raise DesignError(f"is {self.roundness:g}, but must be below 1: at 1 there is no roller left", ("roundness",))
