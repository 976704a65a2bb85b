"""The figures of a comparison."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.report.figures.log_axis import label_powers
from spheredrive.report.figures.style import GREY, INK, LIGHT, PAPER, styled, wheel_colour, wheel_dashes
from spheredrive.shape import Profile, profile
from spheredrive.studies.compare.comparison import Comparison, Row

# Names longer than this are cut in a figure; the table has them whole.
NAME = 26
# Outlines beyond these hide each other.
OUTLINES = 14
SAMPLES = 241


@styled
def kinematics_figure(c: Comparison) -> Figure:
    """Range of ξ and least preload of each machine."""
    figure, (xi, preload) = _panels(c, 2)
    for y, row in enumerate(c.rows):
        if row.check is None:
            _unknown(xi, y)
            continue
        low, high = row.check.effectiveness
        shown = min(high, 10 * low)
        xi.plot([low, shown], [y, y], color=wheel_colour(0), lw=5, solid_capstyle="butt")
        if shown - low < 1e-3 * low:
            xi.plot(low, y, "o", color=wheel_colour(0), ms=5)
        xi.annotate(f"isotropy {row.check.isotropy:.3f}", (shown, y), (5, 0), textcoords="offset points", va="center",
                    fontsize=7.5, color=GREY)  # fmt: skip
    xi.margins(x=0.12)
    left, right = xi.get_xlim()
    xi.set_xlim(left, right + 0.45 * (right - left))
    xi.set_xlabel("effectiveness ξ, least to most")
    _bars(preload, [row.preload for row in c.rows], "least preload (N)", logarithmic=False)
    return figure


@styled
def vibration_figure(c: Comparison) -> Figure:
    """Depth, RMS motion, RMS and weighted acceleration of each machine."""
    figure, panels = _panels(c, 4)
    sizes = [row.sizes() for row in c.rows]
    comfort = [row.comfort() for row in c.rows]
    depth = [None if row.depth is None else row.depth * 1e6 for row in c.rows]
    _bars(panels[0], depth, "depth of shape (µm)")
    _bars(panels[1], [None if s is None else s.rms_displacement * 1e6 for s in sizes], "RMS motion (µm)")
    accelerations = [
        None if s is None else math.inf if row.jumps else s.rms_acceleration for row, s in zip(c.rows, sizes, strict=True)
    ]
    _bars(panels[2], accelerations, "RMS (m/s²)")
    _bars(panels[3], [None if k is None else k.total for k in comfort], "weighted (m/s²)")
    left, right = panels[3].get_xlim()
    # Where discomfort begins, and where it is extreme (ISO 2631-1, C.2.3).
    for limit in (0.315, 2.0):
        if left < limit < right:
            panels[3].axvline(limit, color=GREY, lw=0.6, ls=":", zorder=0)
    return figure


def _panels(c: Comparison, count: int) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(7.4, 0.9 + 0.27 * len(c.rows)), layout="constrained")
    panels = list(figure.subplots(1, count, sharey=True))
    names = [row.machine.name if len(row.machine.name) <= NAME else row.machine.name[: NAME - 1] + "…" for row in c.rows]
    panels[0].set_yticks(range(len(names)), names)
    panels[0].set_ylim(len(names) - 0.4, -0.6)
    for axes in panels:
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        for y in range(0, len(names), 2):
            axes.axhspan(y - 0.5, y + 0.5, color=PAPER, lw=0, zorder=-1)
    return figure, panels


def _bars(axes: Axes, values: list[float | None], label: str, logarithmic: bool = True) -> None:
    """One bar a machine with its number; on a logarithmic axis where the values differ much."""
    finite = [v for v in values if v is not None and math.isfinite(v) and v > 0]
    spread = logarithmic and len(finite) > 1 and max(finite) > 30 * min(finite)
    least = 10 ** math.floor(math.log10(min(finite)) - 0.3) if spread else 0.0
    most = (max(finite) * (max(finite) / least) ** 0.75 if spread else 1.75 * max(finite)) if finite else 1.0
    if spread:
        axes.set_xscale("log")
    axes.set_xlim(least, most)
    for y, value in enumerate(values):
        if value is None:
            _unknown(axes, y)
            continue
        if math.isfinite(value) and value > least:
            axes.barh(y, value - least, left=least, height=0.55, color=wheel_colour(0))
        text = "no limit" if math.isinf(value) else f"{value:.0f}" if value >= 999.5 else f"{value:.3g}"
        axes.annotate(text, (max(value, least) if math.isfinite(value) else least, y), (3, 0), textcoords="offset points",
                      va="center", fontsize=7.5, color=INK)  # fmt: skip
    axes.set_xlabel(label)
    if spread:
        label_powers(axes.xaxis, most=4, minor=False)
    else:
        axes.locator_params(axis="x", nbins=3)


def _unknown(axes: Axes, y: int) -> None:
    axes.annotate("not known", (0.02, y), xycoords=("axes fraction", "data"), va="center", fontsize=7.5, color=GREY)


def outlines(c: Comparison) -> list[tuple[Row, Profile]]:
    """Each machine with the deepest outline among its wheels, where it has any depth."""
    found = []
    for row in c.rows:
        if row.depth:
            design = row.machine.design
            assert design is not None, "a depth is that of a design"
            own = max((profile(w, design.sphere.radius) for w in dict.fromkeys(design.wheels)), key=lambda p: p.depth)
            found.append((row, own))
    return found[:OUTLINES]


@styled
def outline_figure(c: Comparison) -> Figure:
    """h over the way rolled, one pattern of each machine's wheel, from its highest place."""
    figure = Figure(figsize=(7.4, 3.4), layout="constrained")
    axes = figure.subplots()
    shown = outlines(c)
    for i, (row, own) in enumerate(shown):
        angle = own.breakpoints[0] - own.phase + np.linspace(0, own.period, SAMPLES)
        height = own.height(angle)
        top = int(np.argmax(height[:-1]))
        height = np.append(np.roll(height[:-1], -top), height[top])
        way = (angle - angle[0]) * own.rolling_radius
        name = row.machine.name if len(row.machine.name) <= NAME else row.machine.name[: NAME - 1] + "…"
        axes.plot(way * 1e3, (height - height.max()) * 1e6, color=wheel_colour(i), ls=wheel_dashes(i), label=name)
    axes.axhline(0, color=LIGHT, lw=0.5, zorder=0)
    axes.set(xlabel="way rolled (mm)", ylabel="height (µm)")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handlelength=1.8)
    return figure
