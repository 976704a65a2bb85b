"""The least preload of a motion, where the motion itself may depend on it through rolling and spin resistance."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.dynamics.loads import Preload, least_preload_of_run, preload_direction, preload_gain
from spheredrive.errors import SpheredriveError
from spheredrive.simulation.rolling_run import Tolerance, run_rolling

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

DOUBLINGS = 20


def with_preload(design: Design, force: float, direction) -> Design:
    """The design with a closure force (N) along ``direction`` added to its own."""
    total = np.array(design.closure.force) + force * preload_direction(direction)
    return replace(design, closure=replace(design.closure, force=tuple(map(float, total))))


def least_preload(design: Design, motion: Motion, direction=(0.0, 0.0, -1.0), tolerance: Tolerance | None = None) -> Preload:
    """The least force along ``direction`` that keeps every contact of ``motion`` pressed and inside its friction limit.

    Without resistances one run tells it. With them the preload slows the very motion it is for: then the force is sought at
    which a run asks for just the preload it has. Raises ``SpheredriveError`` where no force in this direction does. Source:
    model.md section 5a.
    """
    tolerance = tolerance or Tolerance()
    asked = {}

    def missing(force: float) -> float:
        asked[force] = _needed(design, motion, direction, force, tolerance)
        return asked[force].force - force

    if missing(0.0) == 0.0:
        return asked[0.0]
    low, high = 0.0, asked[0.0].force
    for _ in range(DOUBLINGS):
        gap = missing(high)
        if abs(gap) <= 1e-12 * high:
            return asked[high]
        if gap < 0:
            return _settled(missing, asked, low, high)
        low, high = high, 2 * asked[high].force
    raise SpheredriveError("no preload is enough: resistance grows faster than the grip it buys")


def _settled(missing, asked: dict[float, Preload], low: float, high: float) -> Preload:
    from scipy.optimize import brentq

    root = float(brentq(missing, low, high, xtol=1e-13 * high, rtol=1e-14))
    return replace(asked.get(root) or asked[high], force=root)


def _needed(design: Design, motion: Motion, direction, force: float, tolerance: Tolerance) -> Preload:
    """What preload a run with ``force`` asks for in all, its own share of the normal forces taken out first."""
    pressed = with_preload(design, force, direction)
    run = run_rolling(pressed, motion, tolerance)
    if not run.completed:
        raise SpheredriveError(f"the preload is not known, as the run ended early: {run.reason}")
    bare = replace(run, normal_force=run.normal_force - force * preload_gain(pressed, run, direction))
    return least_preload_of_run(pressed, bare, direction)
