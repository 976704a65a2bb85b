"""Rows on the outlines of both wheels (Fig 4.4–4.6) and on how good either can become (Fig 4.16–4.18)."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.results.excitation import OUTLINES, at_unit_speed, outline, potential
from spheredrive.studies.reproduce.table import Row, rounds_to

# The thesis says "significantly lower" without a number.
SIGNIFICANT = 0.5
# A difference that a reader of a plot would see.
VISIBLE = 0.05
MANY = 100


def rows() -> list[Row]:
    """All rows of this subject."""
    return [_roller_radius(), *_compared(), _corners(), _passing(), _ellipse(), *_potential()]


def _roller_radius() -> Row:
    radius = machines.mecanum_wheel().roller_section
    return Row(
        "section-4.1-roller", "Radius of the rollers of a Mecanum wheel of the same diameter with 16 rollers",
        "not given; 12.37 mm by circles that touch", f"{1e3 * radius:.2f} mm", rounds_to(1e3 * radius, "12.37"),
        "Half a unit of the second decimal.", open="the radius is assumed from [4.4]'s circles.",
    )  # fmt: skip


def _compared() -> list[Row]:
    found = []
    for number, word, key, unit, scale in (
        (4, "position", "depth", "mm", 1e3),
        (5, "velocity", "velocity", "mm/s", 1e3),
        (6, "acceleration", "acceleration", "mm/s²", 1e3),
    ):
        values = {s: [float(getattr(at_unit_speed(kind, s), key)) for kind in ("standard", "Mecanum")] for s in OUTLINES}
        shares = [pair[1] / pair[0] for pair in values.values()]
        texts = [f"{name} {scale * a:.3g} and {scale * b:.3g} {unit}" for name, (a, b) in values.items()]
        found.append(
            Row(
                f"fig-4.{number}",
                f"At 1 rad/s the Mecanum wheel excites significantly less {word} than the standard wheel",
                "significantly lower",
                f"standard and Mecanum: {'; '.join(texts)}" + ("" if number < 6 else " off the corners"),
                max(shares) < SIGNIFICANT,
                "Less than half, with the thesis's half sine and with the exact outline.",
                "E7",
            )
        )
    return found


def _corners() -> Row:
    shares = {}
    for kind in ("standard", "Mecanum"):
        shape = outline(kind, "exact")
        corners = shape.breakpoints[:-1][shape.slope_jumps != 0]
        shares[kind] = float(np.max(shape.height(corners - shape.phase) / -shape.depth))
    half = {}
    for kind in ("standard", "Mecanum"):
        shape = outline(kind, "half-sine")
        corners = shape.breakpoints[:-1][shape.slope_jumps != 0]
        half[kind] = float(np.max(shape.height(corners - shape.phase) / -shape.depth))
    agrees = all(abs(half[kind] - shares[kind]) < 0.01 for kind in half)
    return Row(
        "fig-4.4-corners",
        "The corners of the shape lie where the half sine meets the rollers",
        "at height 0: edges of the rollers (standard), tops of the rollers (Mecanum)",
        f"exact outline: at the bottom of the valleys, {shares['standard']:.2f} and {shares['Mecanum']:.2f} of Δr down; half "
        f"sine {abs(half['standard']):.2f} and {abs(half['Mecanum']):.2f}",
        agrees,
        "Height of the corners equal to 1 % of Δr.",
        "E7",
    )


def _passing() -> Row:
    ratio = machines.mecanum_wheel().rollers / machines.standard_wheel().rollers
    return Row(
        "section-4.1-frequency", "The excitation frequency of the Mecanum wheel is slightly higher", "slightly higher",
        f"16/14 = {ratio:.3f} times", 1 < ratio < 1.25, "Above one, and by less than a quarter.",
    )  # fmt: skip


def _ellipse() -> Row:
    printed = float(at_unit_speed("Mecanum", "half-sine").depth)
    exact = float(at_unit_speed("Mecanum", "exact").depth)
    return Row(
        "eq-4.4",
        "Depth of the Mecanum wheel's valleys by [4.4]",
        f"{1e3 * printed:.4f} mm",
        f"{1e3 * exact:.4f} mm, rollers shaped to the wheel's cylinder (exact outline)",
        abs(exact / printed - 1) < VISIBLE,
        "Within 5 %, what a reader of Fig 4.4 could see. [4.1]'s ellipse enters neither.",
        "E9-ellipse",
    )


def _potential() -> list[Row]:
    found = []
    for number, word, key in ((16, "magnitude", "depth"), (17, "velocity", "velocity")):
        limit = _fine_limit(key, "half-sine")
        exact = _fine_limit(key, "exact")
        found.append(
            Row(
                f"fig-4.{number}",
                f"At very low η a standard wheel has a lower {word} than the best Mecanum wheel, even with {MANY} rollers",
                "lower at very low η",
                f"lower for η below {limit:.4f} (half sine) and {exact:.4f} (exact) than a Mecanum wheel of {MANY} rollers",
                limit > 0 and exact > 0,
                "A range of η above zero exists, by bisection to 1e-4.",
            )
        )
    standard, mecanum = potential("standard", "half-sine"), potential("Mecanum", "half-sine")
    least, most = float(standard.acceleration[1:].min()), float(mecanum.acceleration.max())
    found.append(
        Row(
            "fig-4.18",
            "In acceleration every Mecanum wheel is superior to every standard wheel",
            "always superior",
            f"half sine, off the corners, at 1 rad/s: standard from {least:.4f}, Mecanum up to {most:.4f} m/s²",
            most < least,
            "Largest Mecanum value below the smallest standard value over the ranges drawn.",
            "E14",
        )
    )
    limit, n = _fine_limit("impulse", "exact", machines.mecanum_wheel().rollers), machines.mecanum_wheel().rollers
    found.append(
        Row(
            "fig-4.18-corners",
            "In acceleration every Mecanum wheel is superior to every standard wheel, corners included",
            "always superior",
            f"largest velocity jump at a corner (exact outline): a standard wheel of η below {limit:.3f} has less than the "
            f"Mecanum wheel of {n} rollers",
            limit <= 0,
            "One standard wheel with smaller corners decides; by bisection to 1e-4.",
            "E14",
        )
    )
    return found


def _fine_limit(key: str, shape: str, rollers: int = MANY) -> float:
    """Largest η with which the standard wheel stays below a Mecanum wheel of ``rollers``: it grows with η, so bisection."""

    def value(kind: str, **keys) -> float:
        found = at_unit_speed(kind, shape, **keys)
        return float(np.abs(found.impulses).max(initial=0.0)) if key == "impulse" else float(getattr(found, key))

    wanted = value("Mecanum", rollers=rollers)
    low, high = 0.0, 0.98
    if value("standard", roundness=high) < wanted:
        return high
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if value("standard", roundness=middle) < wanted else (low, middle)
    return low
