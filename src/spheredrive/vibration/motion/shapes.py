"""The contacts' shapes as flat arrays for compiled functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Shapes(NamedTuple):
    """h of m inputs; piece j of input i is Σ a_k u^k, u = (ϑ + phase − edge_j)/(edge_{j+1} − edge_j).

    period, phase (m,), rad; count of pieces (m,); edges (m, p + 1); coefficients (m, p, d + 1), m
    """

    period: np.ndarray
    phase: np.ndarray
    count: np.ndarray
    edges: np.ndarray
    coefficients: np.ndarray


def shapes_of(profiles) -> Shapes:
    """``shape.Profile`` values as one set of arrays, padded with zeros."""
    pieces = max(len(p.coefficients) for p in profiles)
    terms = max(p.coefficients.shape[1] for p in profiles)
    m = len(profiles)
    edges, coefficients = np.zeros((m, pieces + 1)), np.zeros((m, pieces, terms))
    for i, p in enumerate(profiles):
        edges[i, : len(p.breakpoints)] = p.breakpoints
        coefficients[i, : len(p.coefficients), : p.coefficients.shape[1]] = p.coefficients
    count = np.array([len(p.coefficients) for p in profiles])
    return Shapes(np.array([p.period for p in profiles]), np.array([p.phase for p in profiles]), count, edges, coefficients)


def with_rates(shapes: Shapes, speed: np.ndarray) -> Shapes:
    """Twice the inputs: h, and its rate g = ḣ at constant wheel speeds (m,), rad/s, as pieces of their own."""
    a = shapes.coefficients
    rate = np.zeros_like(a)
    rate[:, :, :-1] = a[:, :, 1:] * np.arange(1, a.shape[2])
    widths = np.diff(shapes.edges, axis=1)
    share = np.divide(speed[:, None], widths, out=np.zeros_like(widths), where=widths > 0)
    twice = [np.concatenate([field, field]) for field in shapes[:4]]
    return Shapes(*twice, np.concatenate([a, rate * share[:, :, None]]))


def excites(shapes: Shapes) -> np.ndarray:
    """Whether each input's shape varies at all, (m,)."""
    return np.abs(shapes.coefficients[:, :, 1:]).max(axis=(1, 2), initial=0.0) > 0
