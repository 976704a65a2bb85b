"""Fewer points for the same line: what a figure of a long run keeps."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

# Steps beyond this number are closer together than lines are wide.
STEPS_KEPT = 1500


def thinned(time, values, buckets: int = 600) -> np.ndarray:
    """Indices of the samples that draw ``values`` (k, c) over ``time`` (k,) as all of them would.

    Every bucket of successive samples keeps its first, its last and each column's least and largest, so no peak is lost;
    the two samples at a step (equal times) are both kept, so steps stay upright.
    """
    time, values = np.asarray(time), np.asarray(values, float).reshape(len(time), -1)
    if len(time) <= 4 * buckets:
        return np.arange(len(time))
    edges = np.linspace(0, len(time), buckets + 1).astype(int)
    kept = [edges[:-1], edges[1:] - 1]
    for begin, end in pairwise(edges):
        part = values[begin:end]
        kept += [begin + part.argmin(axis=0), begin + part.argmax(axis=0)]
    steps = np.flatnonzero(np.diff(time) == 0)
    if len(steps) <= STEPS_KEPT:
        kept += [steps, steps + 1]
    return np.unique(np.concatenate(kept))
