"""Fig 4.7: transmission ratio and effectiveness of both wheels."""

from __future__ import annotations

import numpy as np

from spheredrive import kinematics
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import KIND, drawn, legend_above, panels
from spheredrive.studies.reproduce.results.transmission import combinations, layouts, transmissions


@drawn
def figure_4_7() -> Drawing:
    """τ and ξ over the norm of the speeds."""
    found = transmissions()
    figure, axes = panels(3.5, 1, 2)
    # Every second speed: all of them would be a solid block.
    kept = np.flatnonzero((np.round(combinations() / 0.5) * 0.5 == combinations()).all(axis=1))
    columns = {"norm of speeds (rad/s)": found.norm}
    for place, (name, values) in zip(
        axes[0], (("transmission ratio τ", found.ratio), ("effectiveness ξ", found.effectiveness)), strict=True
    ):
        for kind, marker in (("standard", "x"), ("Mecanum", "+")):
            place.plot(found.norm[kept], values[kind][kept], marker, ms=3, mew=0.6, color=KIND[kind], label=f"{kind} wheels")
            columns[f"{name} {kind} (-)"] = values[kind]
        place.set_xlabel("|ω| (rad/s)")
        place.set_ylabel(f"{name} (–)")
        place.set_xlim(0, 1.05 * found.norm.max())
    axes[0, 0].set_ylim(0, 0.085)
    axes[0, 1].set_ylim(0, 1.4)
    for name, design in layouts().items():
        for limit in kinematics.effectiveness(design):
            axes[0, 1].axhline(limit, color=KIND[name], lw=0.8, ls=":")
    legend_above(figure, axes[0, 0])
    ranges = {name: (xi.min(), xi.max()) for name, xi in found.effectiveness.items()}
    return Drawing(
        "fig-4.7",
        "Transmission ratio and effectiveness over the norm of the wheel speeds, Atlas at θ = 40°",
        f"ξ of standard wheels {ranges['standard'][0]:.3f} … {ranges['standard'][1]:.3f}, of Mecanum wheels "
        f"{ranges['Mecanum'][0]:.3f} … {ranges['Mecanum'][1]:.3f} over speeds of 0 … 2.5 rad/s; dotted, the limits over all "
        "directions. The worst standard result is the best Mecanum one.",
        figure,
        columns,
    )
