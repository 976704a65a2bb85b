"""Smooth pieces as polynomials: fitted to a second derivative, integrated twice, halved until they are exact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev, polynomial

# Degree of the piece itself; its second derivative is interpolated at DEGREE − 1 points.
DEGREE = 12
# A piece is good where the last two coefficients of its second derivative are below this share of the largest curvature
# of the whole outline: some tens of roundings.
TAIL = 2e-14
# A half whose tail is not below this share of its parent's has only rounding left: a smooth one falls by 2^(DEGREE − 2).
GAIN = 0.3
HALVINGS = 12

_COUNT = DEGREE - 1
# Chebyshev points of the first kind, on [0, 1].
NODES = 0.5 * (1 + chebyshev.chebpts1(_COUNT))
_TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(2 * NODES - 1, _COUNT - 1))


def _to_powers() -> np.ndarray:
    """(DEGREE + 1, DEGREE − 1): Chebyshev coefficients of h″ to power coefficients in u of ∬ h″, whole number arithmetic."""
    columns = np.zeros((DEGREE + 1, _COUNT))
    for k in range(_COUNT):
        powers = np.array([0.0])
        for c in chebyshev.cheb2poly([0] * k + [1])[::-1]:
            powers = polynomial.polyadd(polynomial.polymul(powers, [-1, 2]), [c])
        for j, c in enumerate(powers[: k + 1]):
            columns[j + 2, k] = c / ((j + 1) * (j + 2))
    return columns


_TO_POWERS = _to_powers()


def exact_pieces(
    start: float, end: float, outline: Callable[[np.ndarray], np.ndarray], scale: float
) -> tuple[list[float], list[np.ndarray]]:
    """Polynomials that follow a smooth outline to rounding: the starts of the pieces and their coefficients in u ∈ [0, 1].

    ``outline`` takes angles (k,) and returns rows (k, 3) of height, slope and curvature; ``scale`` is the largest curvature
    that matters. The curvature is interpolated and integrated twice, and so slope and height have its relative accuracy; the
    two constants are the exact height and slope at the middle.
    """
    return _halved(start, end, outline, scale, np.inf, HALVINGS)


def _halved(start, end, outline, scale, parent_tail, depth):
    width = end - start
    middle = outline(np.array([start + 0.5 * width]))[0]
    series = _TO_CHEBYSHEV @ outline(start + width * NODES)[:, 2]
    tail = np.abs(series[-2:]).max()
    if TAIL * scale < tail < GAIN * parent_tail and depth > 0:
        half = start + 0.5 * width
        first = _halved(start, half, outline, scale, tail, depth - 1)
        second = _halved(half, end, outline, scale, tail, depth - 1)
        return first[0] + second[0], first[1] + second[1]
    powers = _TO_POWERS @ series * width**2
    slope = polynomial.polyval(0.5, polynomial.polyder(powers))
    powers[1] = middle[1] * width - slope
    powers[0] = middle[0] - polynomial.polyval(0.5, powers)
    return [start], [powers]


def derivatives_at_ends(widths: np.ndarray, coefficients: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope of each piece at its start and at its end, (p,) each."""
    k = np.arange(coefficients.shape[1])
    return coefficients[:, :2] @ k[:2] / widths, coefficients @ k / widths


def extremes(widths: np.ndarray, coefficients: np.ndarray, order: int) -> tuple[float, float]:
    """Least and largest value of the derivative of ``order`` over all pieces, ends and stationary points between them."""
    values = np.pad(coefficients, ((0, 0), (0, max(0, 3 - coefficients.shape[1]))))
    for _ in range(order):
        values = values[:, 1:] * np.arange(1, values.shape[1]) / widths[:, None]
    u = np.linspace(0, 1, 33)
    sampled = values @ np.vander(u, values.shape[1], increasing=True).T
    found = []
    for sign in (1, -1):
        # The best sample of each piece, led to the stationary point next to it.
        best = u[np.argmax(sign * sampled, axis=1)]
        for _ in range(4):
            best = np.clip(best - _ratio(_derivative(values, 1, best), _derivative(values, 2, best)), 0, 1)
        found.append(sign * float(max((sign * _derivative(values, 0, best)).max(), (sign * sampled).max())))
    return found[1], found[0]


def _derivative(values: np.ndarray, order: int, u: np.ndarray) -> np.ndarray:
    """Derivative by u of each row's polynomial at its own u."""
    for _ in range(order):
        values = values[:, 1:] * np.arange(1, values.shape[1])
    return np.sum(values * u[:, None] ** np.arange(values.shape[1]), axis=1)


def _ratio(value: np.ndarray, slope: np.ndarray) -> np.ndarray:
    return np.divide(value, slope, out=np.zeros_like(value), where=slope != 0)
