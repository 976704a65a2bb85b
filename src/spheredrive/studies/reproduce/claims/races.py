"""Rows of chapter 2 on wheels of several races: the eight Jacobians, Table 2.1 and Fig 2.7, triple races."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from spheredrive import kinematics
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.claims.kinematics import ROUNDING, ROUNDING_RULE, same
from spheredrive.studies.reproduce.results import race_error
from spheredrive.studies.reproduce.table import Row, percent, rounds_to, signed

# Table 2.1 as printed: time, s, and the three wheel speeds, rad/s.
TABLE_2_1 = (
    (0, 0.1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13),
    (1, 1, 1, 2, 2, 0, 1, 0, 1, 2, 1, 2, 3, 3, 0),
    (0, 1, 2, 1, 1, 0, 0, 1, 2, 1, 3, 3, 1, 2, 0),
    (0, 1, 2, 1, 2, 1, 0, 0, 3, 3, 2, 1, 2, 1, 0),
)
STATES = list(itertools.product((1, 2), repeat=3))


def rows() -> list[Row]:
    """All rows of this subject."""
    return [
        *_jacobians(), _printed_roots(), _numbering(), _table(), *_peaks(), _reading(), _summary(), _zero_error(), *_triple(),
    ]  # fmt: skip


def _jacobians() -> list[Row]:
    design = machines.shipped("atlas-dual-race")
    wheel = design.wheels[0]
    R, r = design.sphere.radius, wheel.radius
    sine = wheel.race_spacing / (2 * (R + wheel.roller_radius))
    R_hat, v_hat = design.contact_directions, design.drive_directions
    error, change = 0.0, 0.0
    nominal = kinematics.inverse_jacobian(design)
    for state in STATES:
        sign = np.array([(-1.0) ** number for number in state])[:, None]
        formula = R / r * (math.sqrt(1 - sine**2) * np.cross(R_hat, v_hat) + sine * sign * np.cross(_axial(design), v_hat))
        found = kinematics.inverse_jacobian(design, _races(state))
        error = max(error, np.abs(found - formula).max() * r / R)
        change = max(change, np.abs(found - nominal).max() * r / R)
    return [
        Row(
            "eq-2.78",
            "The eight inverse Jacobians of the dual-race Atlas",
            "(R/r)(cos Δθ Ω̂ᵀ ± sin Δθ R̂ᵀ) row by row",
            f"the same {same(error)}; they differ from the single-race one by up to {percent(change)} of R/r",
            error < ROUNDING,
            ROUNDING_RULE,
        )
    ]


def _axial(design) -> np.ndarray:
    """ŵ = −Ω̂ of each wheel."""
    return np.cross(design.drive_directions, design.contact_directions)


def _races(state) -> tuple:
    return tuple((number,) for number in state)


def _printed_roots() -> Row:
    design = machines.shipped("atlas-dual-race")
    wheel = design.wheels[0]
    reach, d = design.sphere.radius + wheel.roller_radius, wheel.race_spacing
    lengths = {sign: math.sqrt((4 * reach**2 + sign * d**2) + d**2) / (2 * reach) for sign in (1, -1)}
    return Row(
        "eq-2.71",
        "The induced angular velocities of [2.71] are unit vectors with the roots as printed, √(4(R + r_r)² + d²)",
        "length 1",
        f"length {lengths[1]:.5f} with +d², {lengths[-1]:.5f} with −d²",
        abs(lengths[1] - 1) < ROUNDING,
        "Lengths compared to 1e-12, their rounding.",
        "E2",
    )


def _numbering() -> Row:
    design = machines.with_wheel(machines.shipped("orthogonal"), machines.shipped("atlas-dual-race").wheels[0])
    design = replace(design, sphere=machines.shipped("atlas-dual-race").sphere)
    wheel = design.wheels[0]
    sine = wheel.race_spacing / (2 * (design.sphere.radius + wheel.roller_radius))
    # [2.63]: race 1 of wheel i leans by +Δθ towards the next axis.
    next_axis = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], float)
    printed = math.sqrt(1 - sine**2) * np.eye(3) + sine * next_axis
    found = {n: kinematics.contacts(design, _races((n,) * 3)).contact_direction for n in (1, 2)}
    as_printed, swapped = (np.abs(found[n] - printed).max() for n in (1, 2))
    return Row(
        "eq-2.63",
        "Race 1 of the orthogonal dual-race example is race 1 as numbered for the Atlas [2.69]",
        "race 1",
        f"the directions printed for race 1 are those of race {1 if as_printed < swapped else 2}, "
        f"{same(min(as_printed, swapped))}",
        as_printed < ROUNDING,
        "Contact directions of both races compared to 1e-12, their rounding.",
        "E9-numbering",
    )


def _table() -> Row:
    series = machines.table_2_1().series
    printed = np.array(TABLE_2_1, float).T
    found = np.column_stack([series.time, series.values])
    different = int(np.sum(printed != found)) if printed.shape == found.shape else printed.size
    return Row(
        "table-2.1",
        "Table 2.1: wheel speeds at 15 times",
        "60 numbers",
        f"{printed.size - different} of {printed.size} equal in the shipped motion atlas-table-2-1",
        different == 0,
        "Equal numbers, no tolerance.",
    )


def _peaks() -> list[Row]:
    found = race_error.peaks()
    rule = "Half a unit of the last printed digit; race changes are met exactly and samples between them are 2 ms apart."
    return [
        Row(
            "fig-2.7", "Largest error of |Ω| along Table 2.1", "3.8 %", percent(found.of_corrected),
            rounds_to(100 * found.of_corrected, "3.8"), rule,
        ),
        Row(
            "fig-2.7-angle", "Largest error of the direction of Ω along Table 2.1", "3.2°", f"{math.degrees(found.angle):.2f}°",
            rounds_to(math.degrees(found.angle), "3.2"), rule,
        ),
    ]  # fmt: skip


def _reading() -> Row:
    readings = {}
    for interpolation in ("linear", "step"):
        found = race_error.peaks(interpolation)
        for name, share in (("corrected", found.of_corrected), ("single-race", found.of_nominal)):
            readings[interpolation, name] = (100 * share, math.degrees(found.angle))
    fits = [key for key, (size, angle) in readings.items() if rounds_to(size, "3.8") and rounds_to(angle, "3.2")]
    names = {"linear": "straight lines", "step": "steps"}
    shown = "; ".join(f"{names[i]}, share of {n} |Ω|: {s:.2f} %, {a:.2f}°" for (i, n), (s, a) in readings.items())
    return Row(
        "table-2.1-reading",
        "Between the times of Table 2.1 speeds run along straight lines, and the error is a share of the corrected |Ω|",
        "not said",
        shown,
        fits == [("linear", "corrected")],
        "The one reading of the four that rounds to both printed peaks.",
        "E4",
        open="neither is stated; the printed peaks decide.",
    )


def _summary() -> Row:
    found = race_error.peaks()
    return Row(
        "section-5-dual",
        "Chapter 5: a correction of up to 4 % and 3°",
        "4 % and 3°",
        f"{percent(found.of_corrected)} and {math.degrees(found.angle):.2f}°",
        rounds_to(100 * found.of_corrected, "4") and rounds_to(math.degrees(found.angle), "3"),
        "Half a unit of the last printed digit.",
    )


def _zero_error() -> Row:
    design = machines.shipped("atlas-dual-race")
    nominal = kinematics.forward(design, (1.0, 1.0, 1.0))
    angles, sizes = [], []
    for n in (1, 2):
        error = kinematics.race_error(kinematics.forward(design, (1.0, 1.0, 1.0), _races((n,) * 3)), nominal)
        angles.append(float(error.angle))
        sizes.append(float(error.magnitude))
    return Row(
        "section-2.2.2-zero",
        "With equal speeds and all wheels on the same race both errors are zero",
        "0° and 0 %",
        f"0° {same(max(angles))}, but {signed(100 * sizes[0])} % on race 1 and {signed(100 * sizes[1])} % on race 2",
        max(angles) < 1e-9 and max(map(abs, sizes)) < 1e-9,
        "Zero to rounding.",
        "E9-magnitude",
    )


def _triple() -> list[Row]:
    triple = machines.shipped("collinear-triple-race")
    found = {}
    for name, layout in (
        ("orthogonal", "orthogonal"), ("Atlas", "atlas-demonstrator"), ("collinear", "collinear-triple-race"),
    ):  # fmt: skip
        design = replace(machines.with_wheel(machines.shipped(layout), triple.wheels[0]), sphere=triple.sphere)
        states = kinematics.contact_states(design)
        found[name] = {state.contacts: state.rotation_dof for state in states}
    benchmarks = [found["orthogonal"][6], found["Atlas"][6]]
    rule = "Dimension of the null space of [A | −B] of every contact state: a count, without tolerance."
    return [
        Row(
            "eq-2.85",
            "On triple-race wheels the orthogonal and the Atlas layout are not free of slip",
            "not slip-free",
            f"rotations without slip while all outer races touch: {benchmarks[0]} and {benchmarks[1]} of 3",
            max(benchmarks) < 3,
            rule,
        ),
        Row(
            "eq-2.99",
            "The collinear layout of triple-race wheels meets the conditions for no slip",
            "slip-free",
            f"rotations without slip: {found['collinear'][3]} of 3 on the centre races, {found['collinear'][6]} of 3 on the "
            "outer",
            min(found["collinear"].values()) == 3,
            rule,
            "E9-collinear",
        ),
        Row(
            "section-5-triple",
            "Chapter 5: no singularity-free motion without slip at all on triple-race wheels",
            "none",
            "all three rotations in every contact state: "
            + ", ".join(f"{name} {'yes' if min(states.values()) == 3 else 'no'}" for name, states in found.items()),
            all(min(states.values()) < 3 for states in found.values()),
            rule,
        ),
    ]
