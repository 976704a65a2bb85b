"""Elevation of the wheels below the equator."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.parameters.angles import CAPTION, best, four_panels, measured
from spheredrive.studies.parameters.common import Study, machine
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import drawn

THETA_DEG = np.arange(10.0, 80.1, 2.5)


def variant(kind: str, theta_deg: float):
    """The demonstrator with its wheels at θ below the equator."""
    wheel = machines.standard_wheel("exact") if kind == "standard" else machines.mecanum_wheel("exact")
    return machine(wheel, -theta_deg)


@drawn
def study() -> Study:
    """ξ, isotropy, preload and vibration over θ."""
    found = measured(THETA_DEG, variant)
    figure, _, columns = four_panels(THETA_DEG, found, "wheels below the equator by θ")
    round_about = {kind: best(THETA_DEG, values["isotropy"]) for kind, values in found.items()}
    calm = {kind: best(THETA_DEG, -values["displacement"]) for kind, values in found.items()}
    preload = {kind: values["preload"][i] for kind, values in found.items() for i in [int(np.argmin(abs(THETA_DEG - 40)))]}
    there = {kind: values["preload"][round_about[kind] == THETA_DEG][0] for kind, values in found.items()}
    i = int(np.argmin(abs(THETA_DEG - 40)))
    conclusion = (
        f"Every axis is driven alike at θ = {round_about['standard']:.0f}° with standard and at {round_about['Mecanum']:.0f}° "
        f"with Mecanum wheels (isotropy at the demonstrator's 40°: {found['standard']['isotropy'][i]:.2f} and "
        f"{found['Mecanum']['isotropy'][i]:.2f}); vibration is least at {calm['standard']:.0f}° and {calm['Mecanum']:.0f}°. "
        f"Moving there from 40° takes the least preload from {preload['standard']:.0f} to {there['standard']:.0f} N "
        f"(standard) and from {preload['Mecanum']:.0f} to {there['Mecanum']:.0f} N (Mecanum). Put standard wheels near "
        f"{round_about['standard']:.0f}° where every axis counts alike, Mecanum wheels near {round_about['Mecanum']:.0f}°, "
        "which also calms them, and keep away from both ends, where the layout becomes singular."
    )
    return Study(Drawing("study-elevation", "Elevation of the wheels", CAPTION, figure, columns), conclusion)
