"""The frame of a map of directions: outline, meridians, parallels and their names."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from spheredrive.report.figures.projection import mollweide
from spheredrive.report.figures.style import GREY

PARALLELS = (-60, -30, 0, 30, 60)
MERIDIANS = (-120, -60, 0, 60, 120)


def fill_map(axes: Axes, colour) -> None:
    """The whole map in one colour."""
    edge = np.radians(np.linspace(-90, 90, 181))
    outline = np.concatenate([np.stack(mollweide(side * np.pi, side * edge), -1) for side in (-1, 1)])
    axes.fill(*outline.T, fc=colour, ec="none")


def draw_map_grid(axes: Axes, colour: str, width: float, alpha: float = 1.0) -> None:
    """Take the axes' own frame off and draw the map's: every 60° of azimuth and 30° of elevation, parallels named."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    line = {"color": colour, "lw": width, "alpha": alpha, "zorder": 2}
    span = np.radians(np.linspace(-90, 90, 61))
    for azimuth in np.radians(MERIDIANS):
        axes.plot(*mollweide(azimuth, span), **line)
    for degrees in PARALLELS:
        x, y = mollweide([-np.pi, np.pi], np.radians(degrees))
        axes.plot(x, y, **line)
        axes.text(float(x[0]) - 0.12, float(y[0]), degree_text(degrees), ha="right", va="center", fontsize=7.5, color=GREY)
    for edge in (-np.pi, np.pi):
        axes.plot(*mollweide(edge, span), color=GREY, lw=0.7, zorder=2)


def degree_text(degrees: int) -> str:
    """Whole degrees as a map writes them."""
    return f"{degrees}°".replace("-", "−")
