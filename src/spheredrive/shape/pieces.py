"""Polynomial pieces of one period, on their way into a ``Profile``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Pieces(NamedTuple):
    """A periodic outline. ``starts`` (p,) of the pieces, rising, rad; ``coefficients`` (p, d + 1) of h in u ∈ [0, 1], m."""

    period: float
    starts: np.ndarray
    coefficients: np.ndarray
