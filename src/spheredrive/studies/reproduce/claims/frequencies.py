"""Rows on natural frequencies (§4.3.1): what raises and lowers them, in the thesis's model and in ours."""

from __future__ import annotations

import math

import numpy as np

from spheredrive import vibration
from spheredrive.studies.reproduce import assumptions
from spheredrive.studies.reproduce.results import frequencies
from spheredrive.studies.reproduce.table import Row, percent, signed

MEASURED = 188208.0


def rows() -> list[Row]:
    """All rows of this subject."""
    return [_rising(), _closed_form(), *_closure(), _one_body()]


def _rising() -> Row:
    rising = []
    for model in ("independent", "coupled"):
        table = np.array([frequencies.over_contact(mount, model)[:, 0] for mount in frequencies.MOUNTS])
        rising.append((np.diff(table, axis=0) > 0).all() and (np.diff(table, axis=1) > 0).all())
    low, high = (frequencies.over_contact(None, "independent")[i, 0] for i in (0, -1))
    return Row(
        "fig-4.8",
        "The natural frequency rises with the stiffness of the contact and with that of the mounts",
        "rises with both",
        f"rises at every step of K and of k, in the thesis's model and in the coupled one; rigid mounts {low:.1f} … "
        f"{high:.1f} Hz"
        if all(rising)
        else "does not rise at every step",
        all(rising),
        f"Differences of {len(assumptions.STIFFNESS_RANGE.value)} values of K and {len(frequencies.MOUNTS)} of k, all "
        "positive.",
    )


def _closed_form() -> Row:
    """[4.9] on rigid mounts without closure."""
    found = frequencies.lowest(MEASURED, model="independent")
    mass = frequencies.design(MEASURED).sphere.mass
    wanted = math.sqrt(MEASURED / mass) / (2 * math.pi)  # type: ignore[operator]
    return Row(
        "eq-4.9",
        "Natural frequency by [4.9] on rigid mounts, K = 188208 N/m",
        f"√(K/M_s)/2π = {wanted:.3f} Hz",
        f"{found:.3f} Hz (the thesis's model)",
        abs(found / wanted - 1) < 1e-9,
        "Closed form of the determinant with k → ∞, to rounding.",
    )


def _closure() -> list[Row]:
    thesis, restoring = (frequencies.over_closure(MEASURED, sign)[:, 0] for sign in ("thesis", "restoring"))
    changes = [curve[-1] / curve[0] - 1 for curve in (thesis, restoring)]
    top = assumptions.CLOSURE_RANGE.value[-1]
    rule = f"Sign of every difference from K′ = 0 to {top:g} N/m at K = 188208 N/m, rigid mounts."
    return [
        Row(
            "fig-4.9",
            "With the sign of [3.41], the natural frequency falls with the closure's stiffness",
            "falls",
            f"falls, by {percent(-changes[0])}, with −K′",
            bool((np.diff(thesis) < 0).all()),
            rule,
            "E1",
            open="the range of K′ is lost; the direction does not depend on it.",
        ),
        Row(
            "fig-4.9-sign",
            "A stiffer closure lowers the natural frequency",
            "falls",
            f"rises, by {percent(changes[1])}, with a spring that restores (+K′)" if changes[1] > 0 else "falls",
            bool((np.diff(restoring) < 0).all()),
            rule,
            "E1",
            open="the range of K′ is lost; the direction does not depend on it.",
        ),
        Row(
            "fig-4.9-small",
            "The effect of K′ on the natural frequency is negligible",
            "negligible",
            f"{signed(100 * changes[0])} % at K′ = {top / 1e3:g} kN/m (thesis's sign), {signed(100 * changes[1])} % "
            "(restoring)",
            max(map(abs, changes)) < 0.05,
            "Less than 5 %.",
            "E16",
            open="it holds for K′ ≪ K, and the range of K′ is lost.",
        ),
    ]


def _one_body() -> Row:
    design = frequencies.design(MEASURED)
    unit = math.sqrt(MEASURED / design.sphere.mass)  # type: ignore[operator]
    found = vibration.modes(design).natural_frequencies * 2 * math.pi / unit
    return Row(
        "section-4.3.1-independent",
        "Each contact of the Atlas layout has one natural frequency of its own",
        "√(K/M_s) at each contact",
        f"the sphere's three modes: {', '.join(f'{x:.3f}' for x in found)} × √(K/M_s)",
        float(np.ptp(found)) < 1e-6,
        "All three modes equal to 1e-6, as on orthogonal contacts.",
        "E8",
    )
