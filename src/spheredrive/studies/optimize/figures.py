"""Figures of a search: the front among all points, and how the search came to it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.io.files import write_whole
from spheredrive.studies.sweep.metrics import metrics

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from spheredrive.studies.optimize.outcome import Outcome
    from spheredrive.studies.optimize.search import Search

# Points that are drawn behind the front, at most, and by how many ranges beyond its ends the picture reaches.
BEHIND, MARGIN = 4000, 0.6


def write_figures(search: Search, o: Outcome, folder: Path) -> list[Path]:
    """Draw the front and the history into ``folder``, SVG; their paths. Raises ``InputError`` where that fails."""
    from spheredrive.report.figures.style import svg_text
    from spheredrive.studies.reproduce.drawing import standalone

    goals = ", ".join(objective.metric for objective in search.goals.objectives)
    drawings = {"history": (_history(o), f"how far the search for {goals} has come after each generation")}
    if len(search.goals.objectives) == 2:
        drawings["front"] = _plane(search, o), f"designs by {goals}, with those that no other beats"
    elif len(search.goals.objectives) > 2:
        drawings["front"] = _parallel(search, o), f"designs that no other beats, by {goals}"
    written = []
    for name, (figure, label) in drawings.items():
        written.append(folder / f"{name}.svg")
        write_whole(written[-1], standalone(svg_text(figure, name, label)))
    return written


def _title(name: str) -> str:
    unit = "deg" if metrics()[name].unit == "rad" else metrics()[name].unit
    return f"{name.replace('_', ' ')} ({unit})" if unit else name.replace("_", " ")


def _people(search: Search, F: np.ndarray) -> np.ndarray:
    """Objectives as figures show them, angles in degrees, (..., M)."""
    many = [180 / np.pi if metrics()[g.metric].unit == "rad" else 1.0 for g in search.goals.objectives]
    return search.goals.values(F) * many


def _shown(search: Search, o: Outcome) -> dict[str, int]:
    """Points that are named in a figure: the knee and the best in each goal."""
    named = {f"best {g.metric.replace('_', ' ')}": o.front[k] for g, k in zip(search.goals.objectives, o.best, strict=True)}
    return {**named, "knee": o.front[o.knee.place]}


def _history(o: Outcome) -> Figure:
    from spheredrive.studies.reproduce.figures.common import OURS, drawn, panels

    @drawn
    def draw():
        figure, axes = panels(2.8, 1, 1)
        axes[0, 0].plot(np.arange(1, len(o.volume) + 1), o.volume, "o-" if len(o.volume) < 40 else "-", color=OURS, ms=3)
        axes[0, 0].set(xlabel="generation", ylabel="hypervolume (ranges of the front)", ylim=(0, None))
        axes[0, 0].xaxis.get_major_locator().set_params(integer=True)
        return figure

    return draw()


def _plane(search: Search, o: Outcome) -> Figure:
    from spheredrive.studies.reproduce.figures.common import GREY, OURS, WHEELS, drawn, legend_above, panels

    values = _people(search, o.F)
    front = values[o.front]
    ends = front[[0, -1]]
    # The front and as much around it: designs far away would make it a dot.
    low, high = front.min(axis=0), front.max(axis=0)
    room = MARGIN * np.where(high > low, high - low, np.maximum(np.abs(high), 1e-12))
    near = o.feasible & ((values >= low - room) & (values <= high + room)).all(axis=1)
    behind = np.flatnonzero(near)[:: -(-int(near.sum()) // BEHIND) or 1]

    @drawn
    def draw():
        figure, axes = panels(4.2, 1, 1)
        place = axes[0, 0]
        place.plot(*values[behind].T, ".", color=GREY, ms=2, alpha=0.5, mec="none", label="designs", rasterized=True)
        place.plot(*ends.T, ":", color=GREY, lw=0.8, label="line of the ends")
        place.plot(*front.T, "o", color=OURS, ms=3, label="front")
        for k, (name, point) in enumerate(_shown(search, o).items()):
            place.plot(*values[point], "s^D"[k], color=WHEELS[1 + k], ms=6, mfc="none", mew=1.4, label=name)
        place.set(xlabel=_title(search.goals.objectives[0].metric), ylabel=_title(search.goals.objectives[1].metric))
        legend_above(figure, place, 3)
        return figure

    return draw()


def _parallel(search: Search, o: Outcome) -> Figure:
    """One upright axis for each goal, best above; a line for each design of the front."""
    from spheredrive.studies.reproduce.figures.common import GREY, INK, OURS, WHEELS, drawn, legend_above, panels

    height = 1.0 - o.scale.of(o.F[o.front])
    worst, best = _people(search, o.scale.nadir), _people(search, o.scale.ideal)
    names = [g.metric for g in search.goals.objectives]
    across = np.arange(len(names))

    @drawn
    def draw():
        figure, axes = panels(3.8, 1, 1)
        place = axes[0, 0]
        place.plot(across, height[:: -(-len(height) // BEHIND)].T, color=OURS, lw=0.5, alpha=0.4)
        for k, (name, point) in enumerate(_shown(search, o).items()):
            line = height[np.flatnonzero(o.front == point)[0]]
            place.plot(across, line, "o-", color=WHEELS[(1 + k) % len(WHEELS)], lw=1.6, ms=4, label=name)
        for k in across:
            place.axvline(k, color=GREY, lw=0.6, zorder=0)
            place.text(k, 1.03, f"{best[k]:.4g}", ha="center", va="bottom", color=INK, fontsize=8)
            place.text(k, -0.03, f"{worst[k]:.4g}", ha="center", va="top", color=INK, fontsize=8)
        place.set_xticks(across, [_title(name).replace(" (", "\n(") for name in names])
        place.tick_params(axis="x", length=0, pad=14)
        place.set(ylim=(-0.02, 1.02), yticks=[])
        for side in place.spines.values():
            side.set_visible(False)
        legend_above(figure, place, 3)
        return figure

    return draw()
