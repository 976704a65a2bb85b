"""Fig 4.4–4.6 and 4.16–4.18: what the outlines of both wheels excite, and how good either can become."""

from __future__ import annotations

import numpy as np

from spheredrive.report.figures.log_axis import label_powers
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import (
    DASHED,
    INK,
    KIND,
    MILLI,
    OURS,
    THESIS,
    both_ways,
    drawn,
    legend_above,
)
from spheredrive.studies.reproduce.results.excitation import OUTLINES, WHEELS, at_unit_speed, outline, potential

TITLES = {"half-sine": "half sine of the thesis", "exact": "exact outline"}
QUANTITIES = {
    4: ("height", "position", "depth", "mm"),
    5: ("slope", "velocity", "velocity", "mm/s"),
    6: ("curvature", "acceleration", "acceleration", "mm/s²"),
}


@drawn
def shape_figure(number: int) -> Drawing:
    """Fig 4.4–4.6: h and its derivatives over the wheel's angle at 1 rad/s."""
    method, word, key, unit = QUANTITIES[number]
    angle = np.linspace(0, 2 * np.pi / 4, 4001)
    figure, axes = both_ways(3.2, 1, *TITLES.values(), sharey=True, sharex=True)
    columns = {"wheel angle (deg)": np.degrees(angle)}
    for place, shape in zip(axes[0], OUTLINES, strict=True):
        for kind in WHEELS:
            profile = outline(kind, shape)
            values = MILLI * getattr(profile, method)(angle)
            place.plot(np.degrees(angle), values, color=KIND[kind], label=f"{kind} wheel")
            columns[f"{kind} {shape} ({unit})"] = values
            if number == 6:
                _mark_corners(place, profile, KIND[kind])
        place.set_xlabel("wheel angle (°)")
        place.set_xlim(0, 90)
    axes[0, 0].set_ylabel(f"{word} at 1 rad/s ({unit})" if number > 4 else f"h = r_w − r_b ({unit})")
    legend_above(figure, axes[0, 0])
    return Drawing(
        f"fig-4.{number}", f"Excitation at 1 rad/s: {word}", _shape_caption(number, word, key, unit), figure, columns
    )


def _mark_corners(axes, profile, colour) -> None:
    """Ticks at the foot where the slope jumps: an impulse that no curve shows."""
    corners = profile.breakpoints[:-1][profile.slope_jumps != 0] - profile.phase
    places = (corners[:, None] + profile.period * np.arange(-1, 20)).ravel()
    places = places[(places >= 0) & (places <= np.pi / 2)]
    axes.vlines(np.degrees(places), 0, 0.05, color=colour, lw=1.4, transform=axes.get_xaxis_transform())


def _shape_caption(number: int, word: str, key: str, unit: str) -> str:
    values = {shape: [MILLI * float(getattr(at_unit_speed(kind, shape), key)) for kind in WHEELS] for shape in OUTLINES}
    text = "; ".join(f"{TITLES[shape]}: standard {a:.3g} {unit}, Mecanum {b:.3g} {unit}" for shape, (a, b) in values.items())
    what = "Depth" if number == 4 else f"Largest {word}"
    if number < 6:
        return f"{what}, {text}."
    jumps = [MILLI * float(np.abs(at_unit_speed(kind, "exact").impulses).max()) for kind in WHEELS]
    return (
        f"{what} off the corners, {text}. Ticks at the foot mark corners: there the velocity jumps, by {jumps[0]:.1f} and "
        f"{jumps[1]:.2f} mm/s on the exact outlines, an impulse that no curve of the acceleration shows."
    )


POTENTIALS = {
    16: ("depth", "largest excitation magnitude", "Δr (mm)", MILLI),
    17: ("velocity", "largest excitation velocity", "velocity at 1 rad/s (mm/s)", MILLI),
    18: ("acceleration", "largest excitation acceleration", "off the corners, at 1 rad/s (mm/s²)", MILLI),
}


@drawn
def potential_figure(number: int) -> Drawing:
    """Fig 4.16–4.18: the standard wheel over η, the Mecanum wheel over its number of rollers."""
    key, title, label, scale = POTENTIALS[number]
    rows = 2 if number == 18 else 1
    figure, axes = both_ways(3.1 * rows - 0.4 * (rows - 1), rows, "standard wheel, 14 rollers", "Mecanum wheel", sharey="row")
    columns = {}
    for row, (field, what) in enumerate(_rows(number, key, label)):
        for column, kind in enumerate(WHEELS):
            place = axes[row, column]
            for shape, colour, style in (("half-sine", THESIS, DASHED), ("exact", OURS, "-")):
                found = potential(kind, shape)
                values = np.where(getattr(found, field) > 0, getattr(found, field), np.nan)
                place.semilogy(found.parameter, scale * values, color=colour, ls=style, label=TITLES[shape])
                columns.setdefault("eta (-)" if kind == "standard" else "rollers (-)", found.parameter)
                columns[f"{kind} {shape} {field} {what[what.index('(') :]}"] = scale * getattr(found, field)
            mark = demonstrator_mark(kind)
            place.axvline(mark, color=INK, lw=0.6, ls=":", label="demonstrator")
            place.set_xlabel("roundness ratio η (–)" if kind == "standard" else "number of rollers (–)")
            label_powers(place.yaxis)
        axes[row, 0].set_ylabel(what)
    legend_above(figure, axes[0, 0])
    return Drawing(
        f"fig-4.{number}", f"Potential of both wheels: {title}", _potential_caption(number, key, scale), figure, columns
    )


def demonstrator_mark(kind: str) -> float:
    """η or the number of rollers of the demonstrator's wheels."""
    return machines.standard_wheel().roundness if kind == "standard" else machines.mecanum_wheel().rollers


def _rows(number: int, key: str, label: str):
    yield key, label
    if number == 18:
        yield "impulse", "jump at a corner, at 1 rad/s (mm/s)"


def _potential_caption(number: int, key: str, scale: float) -> str:
    best = scale * float(getattr(potential("Mecanum", "half-sine"), key)[-1])
    standard = potential("standard", "half-sine")
    low = scale * float(getattr(standard, key)[1])
    text = (
        f"Half sine: a standard wheel of η = {standard.parameter[1]:g} has {low:.3g}, a Mecanum wheel of "
        f"{potential('Mecanum', 'half-sine').parameter[-1]} rollers {best:.3g}, in the units of the axis."
    )
    if number < 18:
        return text + " Both sides share their scale."
    return (
        text
        + " Above, off the corners, η changes nothing and the Mecanum wheel always wins. Below, the corners: their impulse "
        "falls with η to nothing, and a round enough standard wheel wins (E14)."
    )
