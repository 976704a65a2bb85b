"""How good a layout is: singular values of A, effectiveness ξ, isotropy, and how far it stands from a singularity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.kinematics.contacts import Races, constraint, constraint_row

if TYPE_CHECKING:
    from spheredrive.design import Design

# Below this share of the largest, a singular value is rounding of the angles that the layout was given in.
SINGULAR = 1e-12
# Below this share the layout is called nearly singular: a wheel's error grows a hundredfold in the worst direction.
NEAR_SINGULAR = 1e-2


def singular_values(A) -> np.ndarray:
    """σ₁ ≥ σ₂ ≥ σ₃ of constraint matrices A (..., m, 3), shape (..., 3); fewer than three rows count as zero rows.

    Values below 1e-12 of the largest are rounding and come back as exactly zero. Raises ``ValueError`` for entries that
    are not finite.
    """
    return _svd(A)[0]


def svd3(A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Singular values (3,) of one constraint matrix and the directions of Ω (3, 3, one a row) they belong to."""
    return _svd(A, directions=True)


def _svd(A, directions: bool = False):
    A = _three_rows(A)
    if not np.isfinite(A).all():
        raise ValueError("a constraint matrix has entries that are not finite")
    sigma, rows = np.linalg.svd(A)[1:] if directions else (np.linalg.svd(A, compute_uv=False), None)
    return np.where(sigma < SINGULAR * sigma[..., :1], 0.0, sigma), rows


def _three_rows(A) -> np.ndarray:
    """Matrices (..., m, 3) as 3x3 ones with the same singular values."""
    A = np.asarray(A, float)
    if A.shape[-1:] != (3,) or A.ndim < 2:
        raise ValueError(f"a constraint matrix has shape (..., m, 3), not {A.shape}")
    rows = A.shape[-2]
    if rows == 3:
        return A
    if rows < 3:
        padding = [(0, 0)] * (A.ndim - 2) + [(0, 3 - rows), (0, 0)]
        return np.pad(A, padding)
    # A = QR with orthonormal Q: R has A's singular values.
    return np.linalg.qr(A, mode="r")


def condition_number(A) -> np.ndarray:
    """σ₁ / σ₃ of constraint matrices (..., m, 3), shape (...); inf where the layout is singular.

    Made for millions of layouts: compiled, on all cores. Raises ``ValueError`` for entries that are not finite.
    """
    from spheredrive.kinematics.kernels import condition_number_3x3

    condition = condition_number_3x3(_three_rows(A))
    # What is not finite comes out of the kernel as NaN: checking the results reads a ninth of the memory.
    if np.isnan(condition).any():
        raise ValueError("a constraint matrix has entries that are not finite")
    return condition[()]


def isotropy(design: Design, races: Races = None) -> float:
    """σ₃ / σ₁ of A: 1 where every direction is alike, 0 where the layout is singular. Source: model.md section 2."""
    sigma = singular_values(constraint(design, races)[0])
    return float(sigma[2] / sigma[0])


def singularity_measure(design: Design, races: Races = None) -> float:
    """σ₃ of A: the distance, in the 2-norm, to the nearest singular constraint matrix (Eckart and Young)."""
    return float(singular_values(constraint(design, races)[0])[2])


def determinant(design: Design, races: Races = None) -> float | None:
    """det A, or None unless there are just three contacts. Source: model.md section 2, [2.48, 2.127, 2.132]."""
    A, _ = constraint(design, races)
    if A.shape != (3, 3):
        return None
    return float(A[0] @ np.cross(A[1], A[2]))


def effectiveness(design: Design, races: Races = None) -> tuple[float, float]:
    """Least and largest transmission effectiveness over all rotations: (1/σ₁, 1/σ₃); the second is inf where singular.

        ξ = R |Ω| / |(rᵢ ωᵢ)|   over slip-free ω = B⁻¹ A Ω

    Source: model.md section 2, [4.8].
    """
    sigma = singular_values(constraint(design, races)[0])
    return float(1 / sigma[0]), float(1 / sigma[2]) if sigma[2] > 0 else float("inf")


def effectiveness_about(design: Design, direction, races: Races = None) -> np.ndarray:
    """ξ of a slip-free rotation about ``direction`` (..., 3), which need not be of unit length: |Ω| / |A Ω|, shape (...).

    Infinite where no wheel has to turn, which a singular layout allows.
    """
    A, _ = constraint(design, races)
    direction = np.asarray(direction, float)
    needed = np.linalg.norm(direction @ A.T, axis=-1)
    turning = np.linalg.norm(direction, axis=-1)
    if not (np.isfinite(turning) & (turning > 0)).all():
        raise SpheredriveError("a direction takes three finite numbers, not all zero")
    with np.errstate(divide="ignore"):
        return np.where(needed > SINGULAR * turning, turning / needed, np.inf)


class WorstDirections(NamedTuple):
    """Unit axes of the sphere's rotation, (3,) each.

    slowest   needs most wheel speed for a turn: ξ is least
    weakest   the wheels hold and drive the sphere least: ξ is largest, torque and error amplification are worst
    """

    slowest: np.ndarray
    weakest: np.ndarray


def worst_directions(design: Design, races: Races = None) -> WorstDirections:
    """The axes at both ends of the range of ξ: right singular vectors of A for σ₁ and σ₃, signed upward."""
    _, directions = svd3(constraint(design, races)[0])
    return WorstDirections(_upward(directions[0]), _upward(directions[2]))


def _upward(direction: np.ndarray) -> np.ndarray:
    # A rotation axis has no sign of its own: take the one whose last large component is positive.
    cleaned = np.where(np.abs(direction) < 1e-12, 0.0, direction)
    last = cleaned[np.flatnonzero(np.abs(cleaned) > 1e-6)[-1]]
    return cleaned if last > 0 else 0.0 - cleaned


def describe_direction(direction: np.ndarray) -> str:
    """An axis in words: ``"z"`` or ``"(0.60, 0.00, 0.80)"``."""
    d = _upward(np.asarray(direction, float))
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        if np.linalg.norm(d - axis) < 1e-6:
            return name
    return "(" + ", ".join(f"{x:.2f}" for x in d + 0.0) + ")"


def describe_axes(sigma: np.ndarray, directions: np.ndarray) -> tuple[str, str]:
    """The axes of most wheel speed (σ₁) and of weakest hold (σ₃) in words; equal singular values share a plane of axes."""
    alike = 1e-9 * sigma[0]
    if sigma[0] - sigma[2] <= alike:
        return "all axes alike", "all axes alike"
    slowest, weakest = describe_direction(directions[0]), describe_direction(directions[2])
    if sigma[0] - sigma[1] <= alike:
        slowest = f"any axis perpendicular to {weakest}"
    elif sigma[1] - sigma[2] <= alike:
        weakest = f"any axis perpendicular to {slowest}"
    return slowest, weakest


@dataclass(frozen=True)
class Singularity:
    """The nearest singular layout in one angle: ``parameter`` would have to change by ``change`` (rad) for all wheels."""

    parameter: str
    change: float


def nearest_singularity(design: Design) -> Singularity | None:
    """The least common change of elevation, heading or roller angle that makes the nominal layout singular.

    Each angle is changed by the same amount for every wheel, the others kept: elevations until a wheel is at a pole, headings
    by up to 90°, roller angles within 1° to 90° of their hand. σ₃ of A is sampled every half degree and its minima refined;
    the layout counts as singular where σ₃ ≤ 1e-9 σ₁. None where no such change exists, as for n > 3 it often does not.
    """
    if design.wheel_count < 3:
        return None
    found = [s for name in ("elevation", "heading", "roller_angle") if (s := _singular_change(design, name)) is not None]
    # Of equally near ones the first named angle is told: rounding must not choose.
    return min(found, key=lambda s: round(abs(s.change), 9), default=None)


def _singular_change(design: Design, parameter: str) -> Singularity | None:
    limits = _range_of_change(design, parameter)

    def measure(change):
        sigma = singular_values(_changed_rows(design, parameter, np.asarray(change, float)))
        return sigma[..., 2] / sigma[..., 0]

    step = np.radians(0.5)
    below, above = int(np.floor(-limits[0] / step + 1e-9)), int(np.floor(limits[1] / step + 1e-9))
    grid = np.unique(np.concatenate([np.arange(-below, above + 1) * step, limits]))
    values = measure(grid)
    for i in np.argsort(np.abs(grid), kind="stable"):
        around = slice(max(i - 1, 0), i + 2)
        if values[i] == values[around].min() and values[i] <= _fall(design, parameter, grid[i], step):
            change = _least(measure, grid[around][0], grid[i], grid[around][-1])
            if measure(change) <= 1e-9:
                return Singularity(parameter, change)
    return None


def _fall(design: Design, parameter: str, change: float, step: float) -> float:
    """How far σ₃/σ₁ can fall over ``step`` at most.

    A row turns by the change of elevation or heading, so the rows of A move by |A| step ≤ √3 σ₁ step; a roller angle moves
    them 1/sin α times as fast. Twice that, as the bound itself changes on the way.
    """
    steepness = 1.0
    if parameter == "roller_angle":
        steepness = 1 / min(np.sin(abs(wheel.roller_angle + change)) for wheel in design.wheels)
    return 2 * np.sqrt(3) * step * steepness


def _least(measure, lower: float, start: float, upper: float) -> float:
    """Where ``measure``, V-shaped about its zero, is least between ``lower`` and ``upper``: 60 rounds of narrowing."""
    best = start
    for _ in range(60):
        grid = np.linspace(lower, upper, 9)
        grid[np.argmin(np.abs(grid - best))] = best
        values = measure(grid)
        i = int(np.argmin(values))
        best = grid[i]
        if values[i] == 0 or upper - lower < 1e-15:
            break
        lower, upper = grid[max(i - 1, 0)], grid[min(i + 1, 8)]
    return float(best)


def _range_of_change(design: Design, parameter: str) -> tuple[float, float]:
    if parameter == "heading":
        return -np.pi / 2, np.pi / 2
    if parameter == "elevation":
        elevation = np.array([p.azimuth_elevation_heading[1] for p in design.placements])
        return -np.pi / 2 - elevation.min(), np.pi / 2 - elevation.max()
    alpha = np.array([wheel.roller_angle for wheel in design.wheels])
    least, most = np.radians(1), np.pi / 2
    lower = np.where(alpha > 0, least - alpha, -most - alpha)
    upper = np.where(alpha > 0, most - alpha, -least - alpha)
    # A square roller has no hand: it may lean to either side.
    square = np.abs(np.abs(alpha) - np.pi / 2) < 1e-12
    lower, upper = np.where(square, least - most, lower), np.where(square, most - least, upper)
    return float(min(lower.max(), 0)), float(max(upper.min(), 0))


def _changed_rows(design: Design, parameter: str, change: np.ndarray) -> np.ndarray:
    """Constraint rows (..., n, 3) of the nominal layout with one angle of every wheel changed by ``change`` (...)."""
    from spheredrive.frames import heading_direction, outward

    angle = np.array([p.azimuth_elevation_heading for p in design.placements]).T
    azimuth, elevation, heading = (np.broadcast_to(a, (*change.shape, len(a))) for a in angle)
    alpha = np.broadcast_to([wheel.roller_angle for wheel in design.wheels], azimuth.shape)
    change = change[..., None]
    if parameter == "elevation":
        elevation = elevation + change
    elif parameter == "heading":
        heading = heading + change
    else:
        alpha = alpha + change
    return constraint_row(outward(azimuth, elevation), heading_direction(azimuth, elevation, heading), alpha)
