"""Figures of a sweep: lines over one parameter, maps over two, pairs and a tornado over more."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.io.files import write_whole
from spheredrive.io.study import Parameter
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.mixing import mixed
from spheredrive.studies.sweep.result import blocks, parameter_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spheredrive.studies.sweep.coordinator import Coordinator

# Points that pairs and the tornado are drawn of, and values along an axis of a map, at most.
DRAWN, ALONG = 4000, 300
# A parameter of so few values beside another one is told by colour.
COLOURS = 6
# Parts of a parameter's range that a tornado takes means over.
PARTS = 10
# Metrics whose largest value exceeds the middle one by more are drawn over powers of ten.
WIDE = 15.0
# More panels than these cannot be read.
MOST_ACROSS, MOST_DOWN = 6, 8


class Sample(NamedTuple):
    """Points that are drawn, (k, d), and their metrics (k, M) with NaN where there is none."""

    X: np.ndarray
    values: np.ndarray


def write_figures(coordinator: Coordinator, folder: Path) -> list[Path]:
    """Draw the figures of a finished sweep into ``folder``, SVG; their paths. Raises ``InputError`` where that fails."""
    from spheredrive.report.figures.style import svg_text
    from spheredrive.studies.reproduce.drawing import standalone

    written = []
    for name, (figure, label) in _drawings(coordinator).items():
        path = folder / f"{name}.svg"
        write_whole(path, standalone(svg_text(figure, name, label)))
        written.append(path)
    return written


def _drawings(coordinator: Coordinator) -> dict[str, tuple[Figure, str]]:
    """Figures by file name, each with what a screen reader says."""
    study, points = coordinator.study, coordinator.points
    varied = [i for i, p in enumerate(study.parameters) if p.law != "values" or len(p.values) > 1]
    names, title = study.metrics[:MOST_DOWN], ", ".join(study.metrics[:MOST_DOWN])
    parameters = [study.parameters[i] for i in varied]
    if not parameters:
        return {}
    sample = _sample(coordinator, len(varied) <= 2)
    sample = Sample(sample.X[:, varied], sample.values)
    told = " and ".join(p.name for p in parameters)
    if len(parameters) == 1:
        return {"lines": (_lines(parameters, sample, names), f"{title} over {told}")}
    if len(parameters) == 2 and points.grid:
        if min(len(p.values) for p in parameters) <= COLOURS:
            return {"lines": (_lines(parameters, sample, names), f"{title} over {told}")}
        return {"maps": (_maps(parameters, sample, names), f"maps of {title} over {told}")}
    return {
        "pairs": (_pairs(parameters, sample, names), f"{title} against each parameter"),
        "tornado": (_tornado(parameters, sample, names), f"how far each parameter moves {title}"),
    }


def _sample(coordinator: Coordinator, whole: bool) -> Sample:
    """Points to be drawn, the same for equal studies: along the axes of a grid every so many, else chosen by their numbers."""
    points = coordinator.points
    strides = [-(-n // ALONG) for n in points.shape]
    every = -(-points.count // DRAWN)
    X, values = [], []
    for block in blocks(coordinator):
        index = block.first + np.arange(len(block.X))
        if whole and points.grid:
            places = np.unravel_index(index, points.shape)
            kept = np.logical_and.reduce([place % stride == 0 for place, stride in zip(places, strides, strict=True)])
        else:
            kept = mixed(index.astype(np.uint64)) % np.uint64(every) == 0
        X.append(block.X[kept])
        values.append(block.rows.values[kept])
    return Sample(np.concatenate(X), np.concatenate(values))


def _panels(count: int, height: float = 2.3):
    from spheredrive.studies.reproduce.figures.common import panels

    across = 1 if count == 1 else 2
    down = -(-count // across)
    figure, axes = panels(max(height * down, 3.2 if count == 1 else 0) + 0.4, down, across)
    for spare in axes.ravel()[count:]:
        spare.set_axis_off()
    return figure, axes.ravel()


def _shown(p: Parameter, x: np.ndarray) -> np.ndarray:
    """Values as an axis shows them: angles in degrees."""
    return np.degrees(x) if p.unit == "rad" else x


def _name(p: Parameter) -> str:
    unit = "deg" if p.unit == "rad" else p.unit
    return f"{p.name} ({unit})" if unit else p.name


def _metric_name(name: str) -> str:
    unit = metrics()[name].unit
    return f"{name.replace('_', ' ')} ({unit})" if unit else name.replace("_", " ")


def _wide(values: np.ndarray) -> bool:
    """Whether values are better told by their powers of ten."""
    known = values[np.isfinite(values)]
    return len(known) > 0 and bool(known.min() > 0 and known.max() > WIDE * np.median(known))


def _name_choices(axes: Axes, p: Parameter, axis: str = "x") -> None:
    if p.choices:
        getattr(axes, f"set_{axis}ticks")(p.values, [word[:18] for word in parameter_text(p, p.values)])


def _label(p: Parameter, x: float) -> str:
    if p.choices:
        return parameter_text(p, np.array([x]))[0]
    unit = "°" if p.unit == "rad" else f" {p.unit}" if p.unit else ""
    return f"{_shown(p, np.array([x]))[0]:.4g}{unit}"


def _lines(parameters: list[Parameter], sample: Sample, names: tuple[str, ...]) -> Figure:
    """Each metric over the parameter with more values; the other's, where there is one, by colour."""
    from spheredrive.studies.reproduce.figures.common import WHEELS, drawn, legend_above

    long = 0 if len(parameters) == 1 or len(parameters[0].values) >= len(parameters[1].values) else 1
    p, x = parameters[long], sample.X[:, long]
    other = parameters[1 - long] if len(parameters) > 1 else None
    kinds = [np.ones(len(x), bool)] if other is None else [sample.X[:, 1 - long] == value for value in other.values]

    @drawn
    def draw():
        figure, axes = _panels(len(names))
        order = np.argsort(x, kind="stable")
        for column, (place, name) in enumerate(zip(axes, names, strict=False)):
            for k, kind in enumerate(kinds):
                chosen = order[kind[order]]
                label = "" if other is None else _label(other, other.values[k])
                style = "o" if p.choices else "o-" if len(chosen) < 30 else "-"
                line = {"color": WHEELS[k], "markersize": 3, "label": label}
                place.plot(_shown(p, x[chosen]), sample.values[chosen, column], style, **line)
            place.set_ylabel(_metric_name(name))
            _name_choices(place, p)
        for place in axes[max(len(names) - 2, 0) : len(names)]:
            place.set_xlabel(_name(p))
        if other is not None:
            legend_above(figure, axes[0], COLOURS, title=other.name, title_fontsize=8.5, alignment="left")
        return figure

    return draw()


def _maps(parameters: list[Parameter], sample: Sample, names: tuple[str, ...]) -> Figure:
    """Each metric as colours over two parameters."""
    from spheredrive.report.figures.log_axis import label_powers
    from spheredrive.report.figures.style import LIGHT, SCALE
    from spheredrive.studies.reproduce.figures.common import drawn

    first, second = parameters
    y, rows = np.unique(sample.X[:, 0], return_inverse=True)
    x, columns = np.unique(sample.X[:, 1], return_inverse=True)

    @drawn
    def draw():
        figure, axes = _panels(len(names), 2.7)
        for column, (place, name) in enumerate(zip(axes, names, strict=False)):
            grid = np.full((len(y), len(x)), np.nan)
            grid[rows, columns] = sample.values[:, column]
            place.set_facecolor(LIGHT)
            scale = "log" if _wide(grid) else "linear"
            shade = place.pcolormesh(
                _shown(second, x),
                _shown(first, y),
                np.ma.masked_invalid(grid),
                cmap=SCALE,
                norm=scale,
                shading="nearest",
                rasterized=True,
            )
            bar = figure.colorbar(shade, ax=place, pad=0.02)
            bar.outline.set_visible(False)
            if scale == "log":
                label_powers(bar.ax.yaxis)
            place.set_title(_metric_name(name))
            place.set(xlabel=_name(second), ylabel=_name(first))
            _name_choices(place, second)
            _name_choices(place, first, "y")
        return figure

    return draw()


def _pairs(parameters: list[Parameter], sample: Sample, names: tuple[str, ...]) -> Figure:
    """Each metric (down) against each parameter (across), those first that move metrics most."""
    from spheredrive.report.figures.log_axis import label_powers
    from spheredrive.studies.reproduce.figures.common import OURS, drawn, panels

    reach = np.nansum([_reach(p, sample.X[:, i], sample.values) for i, p in enumerate(parameters)], axis=2).max(axis=1)
    chosen = sorted(np.argsort(-reach, kind="stable")[:MOST_ACROSS])

    @drawn
    def draw():
        figure, axes = panels(1.5 * len(names) + 0.5, len(names), len(chosen), sharey="row", sharex="col")
        for row, name in enumerate(names):
            for column, i in enumerate(chosen):
                place = axes[row, column]
                x = _shown(parameters[i], sample.X[:, i])
                place.plot(x, sample.values[:, row], ".", color=OURS, ms=1.5, alpha=0.35, mec="none", rasterized=True)
                _name_choices(place, parameters[i])
            if _wide(sample.values[:, row]):
                axes[row, 0].set_yscale("log")
                label_powers(axes[row, 0].yaxis)
            axes[row, 0].set_ylabel("\n(".join(_metric_name(name).split(" (")), fontsize=7.5)
        for column, i in enumerate(chosen):
            axes[-1, column].set_xlabel("\n(".join(_name(parameters[i]).split(" (")), fontsize=7.5)
        return figure

    return draw()


def _reach(p: Parameter, x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Least and largest mean of each metric over the parts of a parameter's range, (M, 2).

    Less the mean of all, over the spread of all; zero where a metric is the same everywhere.
    """
    known = np.where(np.isfinite(values), values, 0.0)
    there = np.isfinite(values).astype(float)
    few = p.law == "values" and len(p.values) <= PARTS
    rank = np.argsort(np.argsort(x, kind="stable"), kind="stable")
    _, part = np.unique(x if few else rank * PARTS // len(x), return_inverse=True)
    total = np.array([[known[part == k].sum(axis=0), there[part == k].sum(axis=0)] for k in range(part.max() + 1)])
    means = np.where(total[:, 1] > 0, total[:, 0] / np.maximum(total[:, 1], 1.0), np.nan)
    count = np.maximum(there.sum(axis=0), 1.0)
    middle = known.sum(axis=0) / count
    spread = np.sqrt((there * (known - middle) ** 2).sum(axis=0) / count)
    off = (means - middle) / np.where(spread > 0, spread, math.inf)
    return np.stack([np.nanmin(off, axis=0, initial=0.0), np.nanmax(off, axis=0, initial=0.0)], axis=-1)


def _tornado(parameters: list[Parameter], sample: Sample, names: tuple[str, ...]) -> Figure:
    """How far the mean of each metric moves from one end of a parameter to the other, in its own spread."""
    from spheredrive.studies.reproduce.figures.common import GREY, OURS, drawn

    reach = np.array([_reach(p, sample.X[:, i], sample.values) for i, p in enumerate(parameters)])

    @drawn
    def draw():
        shown = min(len(parameters), 2 * MOST_ACROSS)
        figure, axes = _panels(len(names), 0.6 + 0.24 * shown)
        for column, (place, name) in enumerate(zip(axes, names, strict=False)):
            low, high = reach[:, column].T
            order = np.argsort(high - low, kind="stable")[-shown:]
            place.barh(np.arange(shown), (high - low)[order], left=low[order], color=OURS, height=0.6)
            place.axvline(0.0, color=GREY, lw=0.6)
            place.set_yticks(np.arange(shown), [parameters[i].name for i in order])
            place.set_title(_metric_name(name))
        for place in axes[max(len(names) - 2, 0) : len(names)]:
            place.set_xlabel("shift of the mean (deviations)")
        return figure

    return draw()
