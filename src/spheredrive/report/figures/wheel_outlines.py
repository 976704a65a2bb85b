"""Outlines of the wheels as the sphere feels them: height over the wheel's angle, one pattern of each model."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from spheredrive.design import Design
from spheredrive.report.figures.style import INK, LIGHT, styled, wheel_colour, wheel_dashes
from spheredrive.shape import Profile, profile

# More outlines than these hide each other.
SHOWN = 10
SAMPLES = 361


def outlines(design: Design) -> list[tuple[str, Profile]]:
    """Name and outline of each wheel model that is not round."""
    found = [(wheel.name, profile(wheel, design.sphere.radius)) for wheel in dict.fromkeys(design.wheels)]
    return [(name, own) for name, own in found if own.depth > 0]


@styled
def wheel_outlines_figure(design: Design) -> Figure:
    """h of each wheel model over one pattern, its corners marked."""
    figure = Figure(figsize=(7.4, 2.9), layout="constrained")
    axes = figure.subplots()
    shown = outlines(design)[:SHOWN]
    for i, (name, own) in enumerate(shown):
        start = own.breakpoints[0] - own.phase
        angle = np.union1d(start + np.linspace(0, own.period, SAMPLES), own.breakpoints - own.phase)
        colour = wheel_colour(i)
        label = f"{name}, {360 / math.degrees(own.period):.4g} patterns a turn"
        axes.plot(np.degrees(angle - start), own.height(angle) * 1e6, color=colour, ls=wheel_dashes(i), lw=1.2, label=label)
        corners = own.breakpoints[:-1][own.slope_jumps != 0] - own.phase
        axes.plot(np.degrees(corners - start), own.height(corners) * 1e6, "o", ms=4, mfc="white", mec=colour, label=None)
    axes.axhline(0, color=LIGHT, lw=0.5, zorder=0)
    if any((own.slope_jumps != 0).any() for _, own in shown):
        axes.plot([], [], "o", ms=4, mfc="white", mec=INK, label="corner")
    axes.set(xlabel="wheel angle (°)", ylabel="height (µm)")
    axes.margins(x=0)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, handlelength=1.6, borderaxespad=0.2)
    return figure


def wheel_outlines_caption(design: Design) -> str:
    """What the figure shows, in numbers."""
    deepest_name, deepest = max(outlines(design), key=lambda entry: entry[1].depth)
    corners = int(np.count_nonzero(deepest.slope_jumps))
    text = (
        "How far the wheel holds the sphere's centre away as it turns, less its nominal distance. The deepest outline, that of "
        f"{deepest_name}, is {deepest.depth * 1e6:.4g} µm deep"
    )
    if corners:
        text += f"; where contact passes from roller to roller it has {corners} corner{'s' * (corners > 1)} a pattern"
    left = len(outlines(design)) - SHOWN
    return text + (f". {left} more wheel models are not drawn." if left > 0 else ".")
