"""How well must the wheels of a pointing stand be aligned? The tolerance at which most machines point well enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.simulation.compliant.run import Accuracy
from spheredrive.studies.ensemble import Spread, ensemble

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

# The spread that is tried first, rad: small enough that errors grow in proportion to it.
TRIAL = 1e-3
USUAL = Accuracy(length=1e-8)


@dataclass(frozen=True)
class Alignment:
    """How well wheels must be aligned.

    spread    standard deviation of each wheel's rotations, rad, at which ``share`` of the machines stay within ``limit``
    limit     of the orientation error at the end of the motion, rad
    share     of machines that must keep it
    found     that quantile of the error in an ensemble with ``spread``, rad: what the proportion that was taken is worth
    members   machines of each ensemble
    """

    spread: float
    limit: float
    share: float
    found: float
    members: int

    def text(self) -> str:
        """For a terminal."""
        spread, limit, found = np.degrees([self.spread, self.limit, self.found])
        return (
            f"Each wheel may be turned off by {spread:.3g} deg (standard deviation, about each axis): "
            f"then {100 * self.share:g} % of machines point within {limit:g} deg; by {self.members} runs, {found:.3g} deg."
        )


def alignment_tolerance(
    design: Design,
    motion: Motion,
    limit: float,
    share: float = 0.95,
    count: int = 64,
    seed: int = 1,
    accuracy: Accuracy = USUAL,
) -> Alignment:
    """The spread of wheel alignment with which ``share`` of machines end ``motion`` within ``limit``, rad, of the one drawn.

    The error grows in proportion to small misalignments, so one ensemble with a trial spread tells the answer, and a second
    one with that answer checks it. Raises ``SpheredriveError`` as ``ensemble``, and where a machine does not come through.
    Source: model.md sections 2 and 5c.
    """
    trial = _quantile(design, motion, TRIAL, share, count, seed, accuracy)
    spread = float(TRIAL * limit / trial)
    return Alignment(spread, float(limit), share, _quantile(design, motion, spread, share, count, seed, accuracy), count)


def _quantile(design, motion, alignment: float, share: float, count: int, seed: int, accuracy: Accuracy) -> float:
    data = ensemble(design, motion, Spread(alignment=alignment), count, seed, accuracy)
    failed = data.reason.values[data.reason.values != ""]
    if len(failed):
        raise SpheredriveError(f"{len(failed)} of {count} machines do not come through: {failed[0]}")
    return float(np.quantile(data.orientation_error.values, share))
