"""An outline that was measured: a periodic cubic spline through its points, with their noise taken out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.shape.pieces import Pieces

if TYPE_CHECKING:
    from spheredrive.wheels.measured import MeasuredWheel

# Widest gap between neighbouring points (rad): twice that would miss a roller of an 18-roller wheel altogether.
WIDEST_GAP = math.radians(20)
# A step across the seam may be this often as steep as the steepest step elsewhere.
SEAM = 2.0
# Steps below this share of the radius are never a jump: a machined outline measured to a micrometre is that uneven.
LEVEL = 1e-5
# Points closer than this (rad) are the same place: a table that repeats its first row at 360°.
SAME = 1e-9


def smoothed(wheel: MeasuredWheel, smoothing: float | None = None) -> Pieces:
    """A periodic smoothing spline f of the wheel's outline, less its radius: cubic pieces with continuous h″.

        minimise  Σ (r_i − f(ϑ_i))² + λ ∫ f″² dϑ

    ``smoothing`` is λ, rad³; None chooses it by generalised cross-validation, zero passes through every point. A table that
    ends where it begins has its two equal places averaged. Raises ``DesignError`` where neighbouring points stand more than
    20° apart, and where the outline does not close: across the seam from the last point to the first it steps twice as steeply
    as anywhere else. Assumes errors that are independent and of one size. Source: model.md section 3.
    """
    if smoothing is not None and not (math.isfinite(smoothing) and smoothing >= 0):
        raise SpheredriveError(f"smoothing must be zero or a positive number, not {smoothing!r}")
    angle, radius = np.array(wheel.outline).T
    _refuse_gaps(angle)
    _refuse_jump(angle, radius)
    if angle[-1] - angle[0] >= 2 * math.pi - SAME:
        radius[0] = 0.5 * (radius[0] + radius[-1])
        angle, radius = angle[:-1], radius[:-1]
    from scipy.interpolate import CubicSpline

    closed_angle = np.append(angle, angle[0] + 2 * math.pi)
    widths = np.diff(closed_angle)
    if smoothing != 0:
        radius = _without_noise(widths, radius, smoothing)
    spline = CubicSpline(closed_angle, np.append(radius, radius[0]) - wheel.radius, bc_type="periodic")
    return Pieces(2 * math.pi, angle, spline.c[::-1].T * widths[:, None] ** np.arange(4))


def _without_noise(widths: np.ndarray, radius: np.ndarray, smoothing: float | None) -> np.ndarray:
    """The periodic smoothing spline at its points (m,), by Reinsch's equations with γ = f″ there:

    R γ = Qᵀ f,   (R + λ Qᵀ Q) γ = Qᵀ r,   f = r − λ Q γ
    """
    from scipy.optimize import minimize_scalar
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import spsolve

    R, Q = _spline_matrices(widths)
    bend, load = csc_array(Q @ Q), Q @ radius

    def fit(lam: float) -> np.ndarray:
        return radius - lam * (Q @ spsolve(R + lam * bend, load))

    if smoothing is not None:
        return fit(smoothing)
    stiffness = _stiffnesses(len(radius))

    def score(log_lam: float) -> float:
        lam = 10**log_lam
        left = np.sum(lam * stiffness / (1 + lam * stiffness))
        return float(np.sum((radius - fit(lam)) ** 2) / left**2)

    # From a spline that bends for every point to one that bends for the first two waves of a turn only.
    low, high = math.log10(1e-3 / stiffness.max()), math.log10(1 / stiffness[3])
    grid = np.linspace(low, high, 24)
    best = grid[int(np.argmin([score(x) for x in grid]))]
    step = grid[1] - grid[0]
    found = minimize_scalar(score, bounds=(max(low, best - step), min(high, best + step)), method="bounded")
    return fit(10**found.x)


def _spline_matrices(widths: np.ndarray):
    """R and Q of a periodic cubic spline whose intervals have these widths (m,): sparse, cyclic, symmetric."""
    from scipy.sparse import coo_array

    count, here = len(widths), np.arange(len(widths))
    after, before = (here + 1) % count, (here - 1) % count
    back = widths[before]
    rows, columns = np.tile(here, 3), np.concatenate([before, here, after])
    R = np.concatenate([back / 6, (back + widths) / 3, widths / 6])
    Q = np.concatenate([1 / back, -1 / back - 1 / widths, 1 / widths])
    return tuple(coo_array((values, (rows, columns)), shape=(count, count)).tocsc() for values in (R, Q))


def _stiffnesses(count: int) -> np.ndarray:
    """Eigenvalues of Q R⁻¹ Qᵀ of an even spacing, rising in pairs; near enough for cross-validation of an uneven one."""
    width = 2 * math.pi / count
    cosine = np.cos(2 * math.pi * np.arange(count) / count)
    return np.sort((2 - 2 * cosine) ** 2 / width**2 / (width * (2 + cosine) / 3))


def _refuse_gaps(angle: np.ndarray) -> None:
    gaps = np.diff(np.append(angle, angle[0] + 2 * math.pi))
    widest = int(np.argmax(gaps))
    if gaps[widest] > WIDEST_GAP * (1 + 1e-9):
        raise DesignError(
            f"has no point for {math.degrees(gaps[widest]):.4g} deg after {math.degrees(angle[widest]):.4g} deg; "
            f"an outline takes one every {math.degrees(WIDEST_GAP):g} deg at least, all around",
            ("file",),
        )


def _refuse_jump(angle: np.ndarray, radius: np.ndarray) -> None:
    steps, rises = np.diff(angle), np.diff(radius)
    seam = max(angle[0] + 2 * math.pi - angle[-1], 0.0)
    jump = radius[0] - radius[-1]
    allowed = SEAM * np.abs(rises / steps).max() * max(seam, float(np.median(steps)))
    if abs(jump) > max(allowed, LEVEL * radius.mean()):
        raise DesignError(
            f"jumps by {1e3 * jump:.4g} mm at its seam, from {math.degrees(angle[-1]):.4g} deg to "
            f"{math.degrees(angle[0]):.4g} deg of the next turn; the outline of one turn must close",
            ("file",),
        )
