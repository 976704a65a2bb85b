"""Coefficient of friction: how hard the sphere has to be pressed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spheredrive.studies.parameters.common import DEMAND, Study, largest_preload, machine, runs
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import WHEELS, drawn, legend_above, panels

FRICTION = np.linspace(0.1, 1.2, 45)
SLIGHT = 1.0
DEMANDS = (SLIGHT, DEMAND / 3, DEMAND)


@drawn
def study() -> Study:
    """Least preload over μ for three accelerations."""
    found, design = {}, machine()
    for demand in DEMANDS:
        # The forces that an acceleration takes do not depend on μ.
        moved = runs(design, demand)
        rubbed = [replace(design, contact=replace(design.contact, friction=float(mu))) for mu in FRICTION]
        found[demand] = np.array([largest_preload(one, moved) for one in rubbed])
    figure, axes = panels(3.2, 1, 1)
    axes = axes[0, 0]
    for (demand, force), colour in zip(found.items(), WHEELS, strict=False):
        axes.plot(FRICTION, force, color=colour, label=f"acceleration of {demand:.3g} rad/s²")
    axes.set(xlabel="coefficient of friction μ (–)", ylabel="least preload (N)", xlim=(0, FRICTION[-1]), ylim=(0, None))
    legend_above(figure, axes)
    columns = {"friction (-)": FRICTION, **{f"preload at {demand:.3g} rad/s2 (N)": force for demand, force in found.items()}}
    at = {mu: float(np.interp(mu, FRICTION, found[DEMAND])) for mu in (0.3, 0.6, 0.9)}
    weight_does = {demand: FRICTION[force <= 0] for demand, force in found.items()}
    free = f"μ = {weight_does[SLIGHT][0]:.2f}" if len(weight_does[SLIGHT]) else "no μ drawn"
    conclusion = (
        f"For Ω̇ = {DEMAND:g} rad/s² about any axis the least preload beyond the weight is {at[0.9]:.0f} N at μ = 0.9, "
        f"{at[0.6]:.0f} N at 0.6 and {at[0.3]:.0f} N at 0.3; at {SLIGHT:g} rad/s² the weight alone does from {free}. Size the "
        "preload for the least friction to be expected in dirt and wear: it grows as 1/μ less the weight, while ξ, isotropy "
        "and the linear vibration do not depend on μ at all."
    )
    caption = "Least force towards the wheels, on top of the weight, that keeps every contact from slipping about any axis."
    return Study(Drawing("study-friction", "Coefficient of friction", caption, figure, columns), conclusion)
