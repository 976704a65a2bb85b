"""Rows of chapter 2 on layouts: determinants, singular angles, slip of redundant wheels."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design, Placement
from spheredrive.errors import SingularError
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.table import Row, rounds_to

# Closed forms are compared in sums of a few numbers of order one: rounding stays below this.
ROUNDING = 1e-12
ROUNDING_RULE = "Largest difference of the two formulas below 1e-12, the rounding of a few sums of numbers of order one."
ANGLES_DEG = np.arange(1, 90)


def same(error: float) -> str:
    """How far apart two numbers are, in words: rounding itself differs from processor to processor."""
    return "to rounding" if error < ROUNDING else f"to {error:.1e}"


def rows() -> list[Row]:
    """All rows of this subject."""
    return [
        _orthogonal(),
        _determinant(),
        _singular_elevations(),
        _least_squares(),
        _six(),
        _six_jacobian(),
        _enslaved(),
        _three(),
    ]


def ring(elevation_deg: float, wheel=None, count: int = 3, heading_deg: float = 0.0) -> Design:
    """The Atlas layout at another elevation, with ``count`` wheels."""
    design = machines.shipped("orthogonal")
    wheel = wheel or design.wheels[0]
    places = [
        Placement.at(wheel, 2 * math.pi * i / count, math.radians(elevation_deg), math.radians(heading_deg))
        for i in range(count)
    ]
    return replace(design, name=f"ring of {count}", placements=tuple(places))


def _orthogonal() -> Row:
    design = machines.shipped("orthogonal")
    A, _ = kinematics.constraint(design)
    printed = np.array([[0, -1, 0], [0, 0, -1], [-1, 0, 0]])
    error = np.abs(A - printed).max()
    return Row(
        "eq-2.43", "The orthogonal layout's rows Ω̂ᵀ", "−j, −k, −i", f"the same {same(error)}", error < ROUNDING, ROUNDING_RULE
    )


def _determinant() -> Row:
    theta = np.radians(ANGLES_DEG)
    found = np.array([kinematics.determinant(ring(-angle)) for angle in ANGLES_DEG])
    error = np.abs(found - 1.5 * math.sqrt(3) * np.sin(theta) ** 2 * np.cos(theta)).max()
    at_40 = kinematics.determinant(ring(-40))
    return Row(
        "eq-2.48",
        "Determinant of the Atlas layout at elevation θ",
        "(3√3/2) sin²θ cos θ",
        f"the same at θ = 1° … 89° {same(error)}; {at_40:.4f} at 40°",
        error < ROUNDING,
        ROUNDING_RULE,
    )


def _singular_elevations() -> Row:
    least = min(kinematics.singularity_measure(ring(-angle)) for angle in ANGLES_DEG)
    below, above = (kinematics.nearest_singularity(ring(-angle)) for angle in (20, 70))
    ends = [20 - math.degrees(below.change), 70 - math.degrees(above.change)]  # type: ignore[union-attr]
    agrees = least > 0 and max(abs(ends[0]), abs(ends[1] - 90)) < 1e-6
    return Row(
        "eq-2.48-singular",
        "The only singular elevations of the Atlas layout",
        "θ = 0° and ±90°",
        f"θ = {abs(ends[0]):.4f}° and {ends[1]:.4f}°; between them σ₃ ≥ {least:.4f}",
        agrees,
        "σ₃ of A above zero at every whole degree between, and the singular ends found to 1e-6°, the search's own accuracy.",
    )


def _least_squares() -> Row:
    coplanar = ring(0, count=4, heading_deg=90)
    A, _ = kinematics.constraint(coplanar)
    parallel = np.linalg.matrix_rank(A, tol=1e-9) == 1
    try:
        kinematics.jacobian(coplanar)
        exists = True
    except SingularError:
        exists = False
    return Row(
        "eq-2.31",
        "The least-squares Jacobian of n > 3 wheels fails only if all Ω̂ are parallel",
        "exists unless all Ω̂ are parallel",
        f"four wheels on the equator that drive upward, Ω̂ {'parallel' if parallel else 'coplanar, not parallel'}: "
        f"{'exists' if exists else 'no Jacobian'}",
        exists or parallel,
        "One layout without a Jacobian whose Ω̂ are not parallel decides.",
        "E9-coplanar",
    )


SIX_SPEEDS = (1.0, 1.0, 1.0, 1.5, 1.5, 1.5)


def _six() -> Row:
    overall = float(kinematics.slip(machines.shipped("six-orthogonal"), SIX_SPEEDS).overall)
    return Row(
        "section-2.2.3-six",
        "Slip of six orthogonal wheels at ω = (1, 1, 1, 1.5, 1.5, 1.5)",
        "S = 0.52",
        f"S = {overall:.4f}",
        rounds_to(overall, "0.52"),
        "Half a unit of the last printed digit, 0.005.",
    )


def _six_jacobian() -> Row:
    design = machines.shipped("six-orthogonal")
    scale = design.wheels[0].radius / design.sphere.radius
    half = np.array([[0, 0, -0.5], [-0.5, 0, 0], [0, -0.5, 0]])
    error = np.abs(kinematics.jacobian(design) / scale - np.hstack([half, half])).max()
    return Row(
        "eq-2.107", "Least-squares Jacobian of the six wheels", "entries −½ r/R", f"the same {same(error)}", error < ROUNDING,
        ROUNDING_RULE,
    )  # fmt: skip


def _enslaved() -> Row:
    design = machines.shipped("six-orthogonal")
    speeds = kinematics.master_slave(design, (0.7, -1.1, 0.4)).wheel_speed
    equal = np.abs(speeds[3:] - speeds[:3]).max()
    free = kinematics.slip_free(design).dof
    return Row(
        "eq-2.109",
        "The six wheels slip nowhere only if each turns as its opposite",
        "ω₄ = ω₁, ω₅ = ω₂, ω₆ = ω₃",
        f"slaves turn as their masters {same(equal)}; {free} independent motions without slip",
        equal < ROUNDING and free == 3,
        "Slaves to rounding, and no more motions without slip than the three of the masters.",
    )


def _three() -> Row:
    free = {n: kinematics.slip_free(ring(-40, count=n)).dof for n in (2, 3, 4, 6)}
    turns = {n: kinematics.slip_free(ring(-40, count=n)).rotation_dof for n in (2, 3, 4, 6)}
    driven = {n: np.linalg.matrix_rank(kinematics.constraint(ring(-40, count=n))[0], tol=1e-9) for n in (2, 3, 4, 6)}
    only_three = all((n == 3) == (free[n] == n and driven[n] == 3) for n in free)
    return Row(
        "section-5-three",
        "Three wheels are superior to more or fewer, from the standpoint of slip",
        "three",
        "any speeds without slip and every rotation driven: "
        + ", ".join(f"n = {n} {'yes' if free[n] == n and driven[n] == 3 else 'no'}" for n in free)
        + f" (at n = 2 the wheels drive {driven[2]} of {turns[2]} rotations, at n = 4 speeds keep to {free[4]} of 4)",
        only_three,
        "Ranks of A and of [A | −B] on rings of 2, 3, 4 and 6 wheels at θ = 40°: counts, without tolerance.",
    )
