"""How the numbers of an ensemble are distributed: one panel each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.studies.ensemble.numbers import NUMBERS, shown_unit

if TYPE_CHECKING:
    import xarray


def distribution_svg(data: xarray.Dataset) -> str:
    """The share of members at or below each value, SVG; the medians are marked."""
    from spheredrive.report.figures.style import svg_text
    from spheredrive.studies.reproduce.drawing import standalone
    from spheredrive.studies.reproduce.figures.common import GREY, OURS, drawn, panels

    known = data.reason.values == ""

    @drawn
    def draw():
        figure, axes = panels(5.6, 3, 3, sharey=True)
        for place, n in zip(axes.ravel(), NUMBERS, strict=True):
            scale, unit = shown_unit(n)
            values = np.sort(scale * data[n.name].values[known])
            place.step(values, np.arange(1, len(values) + 1) / len(values), where="post", color=OURS)
            place.axvline(float(np.median(values)), color=GREY, lw=0.6, ls=":")
            place.set_xlabel(f"{n.name.replace('_', ' ')} ({unit})" if unit != "1" else n.name.replace("_", " "))
            place.ticklabel_format(axis="x", useOffset=False)
            place.locator_params(axis="x", nbins=4)
        for place in axes[:, 0]:
            place.set_ylabel("share of machines")
        return figure

    return standalone(svg_text(draw(), "distribution", "distribution of each number over the machines of the ensemble"))
