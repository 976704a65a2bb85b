"""Radius of the sphere over that of its wheels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spheredrive import kinematics
from spheredrive.shape import profile
from spheredrive.studies.parameters.common import Study, least_preload, machine, shaken
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import KIND, MILLI, OURS, drawn, legend_above, panels

RATIO = np.arange(3.0, 20.5, 1.0)


def _wheel(kind: str):
    return machines.standard_wheel("exact") if kind == "standard" else machines.mecanum_wheel("exact")


@drawn
def study() -> Study:
    """Transmission, depth of the shape, race error and preload over R/r."""
    radius = RATIO * machines.standard_wheel().radius
    tau, depth, moved, preload = {}, {}, {}, {}
    for kind in KIND:
        designs = [machine(_wheel(kind), radius=float(R)) for R in radius]
        tau[kind] = np.array([np.array(kinematics.effectiveness(d)) / q for d, q in zip(designs, RATIO, strict=True)])
        depth[kind] = np.array([profile(_wheel(kind), float(R)).depth for R in radius])
        moved[kind] = np.array([shaken(design).rms_displacement for design in designs])
        preload[kind] = np.array([least_preload(design) for design in designs])
    races = np.degrees([_race_error(ratio) for ratio in RATIO])
    figure, axes = panels(5.4, 2, 2, sharex=True)
    columns = {"R/r (-)": RATIO}
    for kind, colour in KIND.items():
        axes[0, 0].fill_between(RATIO, *tau[kind].T, color=colour, alpha=0.2, lw=0)
        axes[0, 0].plot(RATIO, tau[kind][:, 0], color=colour, label=f"{kind} wheels")
        axes[0, 0].plot(RATIO, tau[kind][:, 1], color=colour)
        axes[0, 1].plot(RATIO, MILLI * depth[kind], color=colour)
        axes[1, 1].plot(RATIO, preload[kind], color=colour)
        columns[f"least ratio {kind} (-)"], columns[f"largest ratio {kind} (-)"] = tau[kind].T
        columns[f"depth {kind} (mm)"], columns[f"RMS displacement {kind} (mm)"] = MILLI * depth[kind], MILLI * moved[kind]
        columns[f"least preload {kind} (N)"] = preload[kind]
    axes[1, 0].plot(RATIO, races, color=OURS)
    columns["direction error of dual-race wheels (deg)"] = races
    names = (
        "|Ω|/|ω|, from and to (–)", "depth of the outline Δr (mm)", "direction error, dual race (°)",
        "least preload (N)",
    )  # fmt: skip
    for place, name in zip(axes.ravel(), names, strict=True):
        place.set_ylabel(name)
        place.set_ylim(0, None)
        place.set_xlim(RATIO[0], RATIO[-1])
    for place in axes[1]:
        place.set_xlabel("R/r, sphere over wheel (–)")
    legend_above(figure, axes[0, 0])
    i = [int(np.argmin(abs(RATIO - q))) for q in (4, 16)]
    shown = {kind: [f"{MILLI * depth[kind][j]:.3f}" for j in i] for kind in KIND}
    conclusion = (
        f"From R/r = 4 to 16 the outline's depth changes from {shown['standard'][0]} to {shown['standard'][1]} mm (standard) "
        f"and from {shown['Mecanum'][0]} to {shown['Mecanum'][1]} mm (Mecanum), the direction error of dual-race wheels from "
        f"{races[i[0]]:.2f}° to {races[i[1]]:.2f}°, and the least preload from {preload['standard'][i[0]]:.0f} to "
        f"{preload['standard'][i[1]]:.0f} N (standard); the transmission ratio falls as r/R, while ξ and isotropy do not "
        "change. Take wheels as small as their rollers and motors allow: a large ratio calms the outline and makes races "
        "matter less, and is paid for in motor speed and preload."
    )
    caption = (
        "Wheels of 75.8 mm; the sphere grows, its mass kept at 5 kg, so that the preload rises with its inertia. Lower left, "
        "largest angle between Ω and that of the single-race Jacobian over all states and axes, wheels of Fig 2.7."
    )
    return Study(Drawing("study-radius-ratio", "Radius ratio", caption, figure, columns), conclusion)


# Speeds with which the direction error is looked for: every sign and size of a coarse grid.
_GRID = np.stack(np.meshgrid(*[np.linspace(-1, 1, 7)] * 3, indexing="ij"), -1).reshape(-1, 3)
_SPEEDS = _GRID[np.abs(_GRID).max(axis=1) == 1]


def _race_error(ratio: float) -> float:
    """Largest error of the direction of Ω over the eight contact states, rad, of the dual-race Atlas at another R/r."""
    design = machines.shipped("atlas-dual-race")
    design = replace(design, sphere=replace(design.sphere, radius=float(ratio * design.wheels[0].radius)))
    nominal = kinematics.forward(design, _SPEEDS)
    states = [state.races for state in kinematics.contact_states(design)]
    return max(float(kinematics.race_error(kinematics.forward(design, _SPEEDS, s), nominal).angle.max()) for s in states)
