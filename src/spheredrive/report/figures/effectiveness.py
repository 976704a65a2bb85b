"""Transmission effectiveness ξ over all axes of rotation, as an equal-area map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.frames import outward
from spheredrive.kinematics.quality import describe_axes, svd3
from spheredrive.report.figures.map_grid import MERIDIANS, degree_text, draw_map_grid, fill_map
from spheredrive.report.figures.projection import map_direction, map_path, mollweide, perpendicular_circle
from spheredrive.report.figures.style import GREY, INK, SCALE, styled

# Above this multiple of the least ξ colours no longer change: near a singularity ξ grows without limit.
CAP = 10.0
# A smaller spread of ξ is rounding, not structure; a smaller range of colours would make much of little.
ALIKE = 1e-6
LEAST_RANGE = 0.02
NUMBERED = 30
BANDS = 32


@dataclass(frozen=True)
class Extremes:
    """ξ from ``low`` to ``high``; the axes where they are reached, (k, 3) a point or a path, and in words.

    ``shown_high`` is where colours end. No axes where all are alike.
    """

    low: float
    high: float
    shown_high: float
    slowest: np.ndarray
    weakest: np.ndarray
    slowest_text: str
    weakest_text: str

    @property
    def uniform(self) -> bool:
        """Whether ξ is the same about every axis."""
        return self.high - self.low <= ALIKE * self.low

    @property
    def capped(self) -> bool:
        """Whether ξ exceeds what colours show."""
        return self.high > self.shown_high


def extremes(design: Design) -> Extremes:
    """The range of ξ of ``design`` and where it ends."""
    low, high = kinematics.effectiveness(design)
    shown_high = min(high, CAP * low)
    sigma, directions = svd3(kinematics.constraint(design)[0])
    texts = describe_axes(sigma, directions)
    slowest, weakest = directions[:1], directions[2:]
    # Two equal singular values share a plane: any axis in it would do, so the whole circle is marked.
    if sigma[0] - sigma[1] <= ALIKE * sigma[0]:
        slowest = perpendicular_circle(directions[2])
    elif sigma[1] - sigma[2] <= ALIKE * sigma[0]:
        weakest = perpendicular_circle(directions[0])
    return Extremes(low, high, shown_high, slowest, weakest, *texts)


@styled
def effectiveness_figure(design: Design) -> Figure:
    """ξ of slip-free rotation about each axis; azimuth −180..180° to the right, elevation upward, Mollweide's map."""
    found = extremes(design)
    figure = Figure(figsize=(7.4, 4.2), layout="constrained")
    axes = figure.subplots()
    colours = _draw_field(axes, design, found)
    draw_map_grid(axes, "white", 0.35, alpha=0.6)
    _name_places(axes)
    if not found.uniform:
        _mark(axes, found.slowest, "v", f"least ξ = {found.low:.4g}: slowest")
        high = "no limit" if math.isinf(found.high) else f"{found.high:.4g}"
        _mark(axes, found.weakest, "^", f"largest ξ = {high}: weakest hold")
    _mark_wheels(axes, design)
    bar = figure.colorbar(
        colours, ax=axes, location="right", shrink=0.75, pad=0.02, extend="max" if found.capped else "neither"
    )
    bar.set_label("transmission effectiveness ξ")
    bar.outline.set_linewidth(0.4)
    if bar.solids is not None:
        bar.solids.set_edgecolor("face")
    figure.legend(loc="outside lower center", ncols=3, handletextpad=0.3, columnspacing=1.6)
    return figure


def _draw_field(axes: Axes, design: Design, found: Extremes) -> ScalarMappable:
    azimuth, elevation = np.meshgrid(np.radians(np.linspace(-180, 180, 145)), np.radians(np.linspace(-90, 90, 73)))
    x, y = mollweide(azimuth, elevation)
    if found.uniform:
        xi = np.full(x.shape, found.low)
    else:
        xi = np.minimum(kinematics.effectiveness_about(design, outward(azimuth, elevation)), found.shown_high)
    middle = (found.low + found.shown_high) / 2
    half = max((found.shown_high - found.low) / 2, LEAST_RANGE / 2 * middle)
    levels = np.linspace(middle - half, middle + half, BANDS + 1)
    colours = matplotlib.colormaps[SCALE].resampled(BANDS)
    # Each band is laid over the one below it: bands side by side would show hairlines of paper between them.
    lowest = int(np.clip((xi.min() - levels[0]) / (levels[1] - levels[0]), 0, BANDS - 1))
    fill_map(axes, colours(lowest))
    for band, level in enumerate(levels[1:-1], 1):
        if xi.min() < level < xi.max():
            axes.contourf(x, y, xi, [level, 2 * levels[-1]], colors=[colours(band)])
    return ScalarMappable(Normalize(levels[0], levels[-1]), colours)


def _name_places(axes: Axes) -> None:
    for degrees in MERIDIANS:
        x, y = (float(c) for c in mollweide(math.radians(degrees), math.radians(-60)))
        axes.text(x, y + 0.02, degree_text(degrees), ha="center", va="bottom", fontsize=7, color="white", zorder=2)
    axes.text(0, 1.56, "elevation 90°: axis z", ha="center", va="bottom", fontsize=7.5, color=GREY)
    axes.text(0, -1.56, "azimuth along the −60° parallel, 0° is axis x", ha="center", va="top", fontsize=7.5, color=GREY)


def _mark(axes: Axes, places: np.ndarray, marker: str, label: str) -> None:
    """An axis as a marker at both its ends, or a circle of axes as a line."""
    style = {"color": "black", "zorder": 4}
    if len(places) > 1:
        x, y = map_path(places)
        axes.plot(x, y, color="white", lw=2.6, zorder=3)
        axes.plot(x, y, ls="-" if marker == "v" else "--", lw=1.3, label=label, **style)
        return
    x, y = map_direction(np.concatenate([places, -places]))
    axes.plot(x, y, marker, ms=10, mfc="black", mec="white", mew=1.0, ls="none", label=label, zorder=4, clip_on=False)


def _mark_wheels(axes: Axes, design: Design) -> None:
    x, y = map_direction(design.contact_directions)
    numbered = design.wheel_count <= NUMBERED
    size = 11 if numbered else 3
    axes.plot(x, y, "o", ms=size, mfc="white", mec=INK, mew=0.8, ls="none", label="contact of a wheel", zorder=5, clip_on=False)
    if numbered:
        for i, place in enumerate(zip(x, y, strict=True), 1):
            axes.text(*place, str(i), ha="center", va="center_baseline", fontsize=7.5, color=INK, zorder=6)


def effectiveness_caption(design: Design) -> str:
    """What the map shows, in numbers."""
    found = extremes(design)
    if found.uniform:
        return (
            f"ξ = {found.low:.4f} about every axis: the layout is isotropic, so a turn about any axis asks for the same "
            "wheel speed."
        )
    least = f"ξ runs from {found.low:.4f} ({_axis(found.slowest_text)}: most wheel speed for a turn)"
    most = "up without limit" if math.isinf(found.high) else f"to {found.high:.4f}"
    text = f"{least} {most} ({_axis(found.weakest_text)}: wheels hold least, and their errors grow most)."
    if found.capped:
        text += f" Colours end at ξ = {found.shown_high:.4g}; what lies above is drawn in the last one."
    return text + " An axis and its opposite are the same rotation, so the map repeats itself at the opposite point."


def _axis(text: str) -> str:
    return text if text.startswith(("any", "all")) else f"axis {text}"
