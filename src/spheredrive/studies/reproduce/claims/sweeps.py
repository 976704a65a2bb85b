"""Rows on the largest displacement of the centre over stiffnesses (Fig 4.10–4.15)."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.reproduce import assumptions, machines
from spheredrive.studies.reproduce.results import sweeps
from spheredrive.studies.reproduce.results.sweeps import FAST, SLOW
from spheredrive.studies.reproduce.table import Row, percent, span

DAMPED = assumptions.DAMPING.value[1]
NO_DAMPING_GIVEN = "neither the damping nor the range of the stiffness is given."
# What a reader would call "no effect" in a plot.
VISIBLE = 0.05


def rows() -> list[Row]:
    """All rows of this subject."""
    return [*_ratio(), _many_speeds(), _stiffness(), *_mount(), *_closure_rigid(), *_closure_elastic(), _closure_measure()]


def _ratio() -> list[Row]:
    found = []
    for figure, speeds, printed in ((10, SLOW, ("0.04", "0.11")), (11, FAST, ("0.06", "0.12"))):
        low, high = map(float, printed)
        damped = sweeps.over_contact(speeds, DAMPED, True)
        bare = sweeps.over_contact(speeds, 0.0, True).ratio
        true = sweeps.over_contact(speeds, DAMPED, False).ratio
        inside = (damped.ratio >= low - 0.005) & (damped.ratio <= high + 0.005)
        where = damped.stiffness[inside]
        reach = (
            f"; inside the printed range for K = {where.min() / 1e3:.0f} … {where.max() / 1e3:.0f} kN/m" if len(where) else ""
        )
        found.append(
            Row(
                f"fig-4.{figure}",
                f"Ratio κ of Mecanum to standard displacement at ω = {_shown(speeds)} rad/s, in the thesis's measure",
                f"{printed[0]} < κ < {printed[1]}",
                f"{span(damped.ratio.min(), damped.ratio.max())} with C = {DAMPED:g} N s/m{reach}; "
                f"{span(np.nanmin(bare), np.nanmax(bare))} without damping",
                bool(inside.all()),
                f"All of {len(damped.ratio)} values with damping inside the printed range, widened by half a unit of its last "
                "digit.",
                open=NO_DAMPING_GIVEN,
            )
        )
        found.append(
            Row(
                f"fig-4.{figure}-centre",
                f"Ratio κ at ω = {_shown(speeds)} rad/s for the centre of the sphere itself",
                f"{printed[0]} < κ < {printed[1]}",
                f"{span(true.min(), true.max())}, {percent(float(np.ptp(true) / true.mean()), 1)} apart over all K",
                bool(((true >= low - 0.005) & (true <= high + 0.005)).all()),
                f"All of {len(true)} values inside the printed range; coupled model, exact outlines, C = {DAMPED:g} N s/m.",
                "E3",
            )
        )
    return found


# Speeds of §4.3.2 up to 12 rad/s, alike and unlike.
MANY_SPEEDS = ((0.5, 1.0, 2.0), (4.0, 4.0, 4.0), (6.0, 3.0, 9.0), (12.0, 12.0, 12.0), (12.0, 1.0, 5.0))


def _many_speeds() -> Row:
    designs = [machines.atlas(wheel, 188208.0, DAMPED) for wheel in sweeps.wheels(True)]
    ratios = []
    for speeds in MANY_SPEEDS:
        standard, mecanum = (sweeps.largest(design, speeds, True) for design in designs)
        ratios.append(mecanum / standard)
    return Row(
        "eq-4.11",
        "Ratio κ for a variety of speeds from 0 to 12 rad/s",
        "0.04 < κ < 0.12",
        f"{span(min(ratios), max(ratios))} at {len(ratios)} sets of speeds in the thesis's measure, K = 188208 N/m, "
        f"C = {DAMPED:g} N s/m",
        min(ratios) >= 0.035 and max(ratios) <= 0.125,
        "All inside the printed range, widened by half a unit of its last digit.",
        open="neither the speeds nor the damping are given.",
    )


def _stiffness() -> Row:
    sizes = {thesis: sweeps.over_contact(SLOW, DAMPED, thesis).standard for thesis in (True, False)}
    factors = [values.max() / values.min() for values in sizes.values()]
    low, high = (f"{assumptions.STIFFNESS_RANGE.value[i] / 1e3:g}" for i in (0, -1))
    return Row(
        "section-5-stiffness",
        "The vibration of the centre varies little with the stiffness of the contacts",
        "little",
        f"from {low} to {high} kN/m the thesis's measure varies by a factor of {factors[0]:.1f}, the centre itself by "
        f"{factors[1]:.3f} (standard wheel, C = {DAMPED:g} N s/m)",
        factors[0] < 2,
        "The measure that chapter 5 speaks of varies by less than a factor of two.",
        "E3",
        open="chapter 5 says that it varies little and, a page on, that this stiffness is the dominant factor.",
    )


def _shown(speeds) -> str:
    return "(" + ", ".join(f"{speed:g}" for speed in speeds) + ")"


def _mount() -> list[Row]:
    sweep = sweeps.over_mount(190e3, SLOW, DAMPED, True)
    true = sweeps.over_mount(190e3, SLOW, DAMPED, False)
    change = sweep.standard[-1] / sweep.standard[0] - 1
    lower = max(float((s.mecanum / s.standard).max()) for s in (sweep, true))
    return [
        Row(
            "fig-4.12",
            "A stiffer mount raises the largest displacement, K = 190000 N/m",
            "raises it a little",
            f"from k = {sweep.stiffness[0] / 1e3:g} kN/m to {sweep.stiffness[-1] / 1e6:g} MN/m the thesis's measure goes from "
            f"{1e6 * sweep.standard[0]:.1f} to {1e6 * sweep.standard[-1]:.2f} µm, the centre itself from "
            f"{1e3 * true.standard[0]:.3f} to {1e3 * true.standard[-1]:.3f} mm (standard wheel)",
            bool(change > 0),
            f"Sign of the change over the range, thesis's measure, C = {DAMPED:g} N s/m.",
            "E15",
            open=NO_DAMPING_GIVEN,
        ),
        Row(
            "fig-4.12-mecanum",
            "On any mount the Mecanum wheel's displacement is significantly lower",
            "significantly lower",
            f"at most {lower:.2f} of the standard wheel's, in either measure",
            lower < 0.5,
            f"Less than half at each of {len(sweep.stiffness)} values of k.",
        ),
    ]


def _closure_rigid() -> list[Row]:
    found = []
    for number, speeds in ((13, FAST), (14, SLOW)):
        change = max(_change(sweeps.over_closure(None, speeds, 0.0, thesis)) for thesis in (True, False))
        found.append(
            Row(
                f"fig-4.{number}",
                f"Rigid contacts, ω = {_shown(speeds)} rad/s: the closure's stiffness does not change the displacement",
                "no change",
                "no change: rigid contacts settle where the centre is" if change < 1e-9 else f"changes by {percent(change)}",
                change < 1e-9,
                "Equal to rounding over the range of K′, both wheels, thesis's model and coupled model.",
            )
        )
    return found


def _change(sweep) -> float:
    return max(float(np.abs(x / x[0] - 1).max()) for x in (sweep.standard, sweep.mecanum))


def _closure_elastic() -> list[Row]:
    found = []
    for name, K in (("", 170e3), ("-1700000", 1.7e6)):
        true = sweeps.over_closure(K, SLOW, DAMPED, False)
        tenth = int(np.searchsorted(true.stiffness, true.stiffness[-1] / 10))
        share = true.standard / true.standard[0]
        found.append(
            Row(
                f"fig-4.15{name}",
                f"K = {K / 1e3:g} kN/m: the closure's stiffness has little to no effect on the displacement of the centre",
                "minor",
                f"at K′ = {true.stiffness[-1] / 1e3:g} kN/m the centre moves {share[-1]:.3f} of what it does without, at "
                f"{true.stiffness[tenth] / 1e3:g} kN/m {share[tenth]:.3f}",
                abs(share[-1] - 1) < VISIBLE,
                f"Change of the true displacement below {percent(VISIBLE)} over the range of K′.",
                "E16",
                open="text and caption print K = 170000 and 1700000 N/m, and the exponent of the axis of K′ is lost.",
            )
        )
    return found


def _closure_measure() -> Row:
    """[3.41] as printed also drives the deflection by K′(r_w − Z_c)."""
    design = machines.atlas(sweeps.wheels(True)[0], 170e3, DAMPED)
    sweep = sweeps.over_closure(170e3, SLOW, DAMPED, True)
    low, high = 0.0, float(sweep.stiffness[-1])
    while high - low > 1.0:
        middle = 0.5 * (low + high)
        seen = sweeps.largest(machines.closed(design, middle), SLOW, True) / sweep.standard[0] - 1
        low, high = (low, middle) if abs(seen) > VISIBLE else (middle, high)
    factor = sweep.standard[-1] / sweep.standard[0]
    return Row(
        "fig-4.15-measure",
        "K = 170 kN/m: the closure's stiffness has little to no effect on the plotted displacement, by [3.41] as printed",
        "minor",
        f"{factor:.1f} times at K′ = {sweep.stiffness[-1] / 1e3:g} kN/m; within {percent(VISIBLE)} only up to {low:.0f} N/m",
        abs(factor - 1) < VISIBLE,
        f"Change of the thesis's measure, with its sign, below {percent(VISIBLE)} over the range of K′.",
        "E17",
        open="the exponent of the axis of K′ is lost.",
    )
