"""What the figures share: colours, panels side by side, legends above the panels."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.report.figures.style import AXES, GREY, INK, WHEELS, house_style

# A wheel kind keeps its colour in every figure; so do the two versions where both stand in one panel.
KIND = {"standard": WHEELS[0], "Mecanum": WHEELS[1]}
THESIS, OURS = WHEELS[1], WHEELS[0]
DASHED = (0, (4, 2))
WIDTH = 7.4
MICRO, MILLI, KILO = 1e6, 1e3, 1e-3

__all__ = [
    "AXES", "DASHED", "GREY", "INK", "KILO", "KIND", "MICRO", "MILLI", "OURS", "THESIS", "WHEELS", "WIDTH", "both_ways",
    "canvas", "drawn", "legend_above", "panels",
]  # fmt: skip


def drawn(draw: Callable) -> Callable:
    """A function that draws in the house style, whatever it returns."""

    @functools.wraps(draw)
    def styled(*args, **kwargs):
        with house_style():
            return draw(*args, **kwargs)

    return styled


def canvas(height: float) -> Figure:
    """An empty figure of the page's width."""
    return Figure(figsize=(WIDTH, height), layout="constrained")


def panels(height: float, rows: int, columns: int, **options) -> tuple[Figure, np.ndarray]:
    """A figure of ``rows`` × ``columns`` panels, always a two-dimensional array."""
    figure = canvas(height)
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def both_ways(height: float, rows: int, left: str, right: str, **options) -> tuple[Figure, np.ndarray]:
    """Two columns of panels: what the thesis plotted, and what it should be."""
    figure, axes = panels(height, rows, 2, **options)
    axes[0, 0].set_title(left)
    axes[0, 1].set_title(right)
    return figure, axes


def legend_above(figure: Figure, axes: Axes, columns: int = 4, **options) -> None:
    """The legend of ``axes``, above all panels, where it covers nothing."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=columns, handlelength=2.2, **options)
