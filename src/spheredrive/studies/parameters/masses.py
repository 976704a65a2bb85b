"""Mass of the sphere and mass of the stage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spheredrive import vibration
from spheredrive.report.figures.log_axis import label_powers
from spheredrive.studies.parameters.common import DEMAND, ROTATION, STIFFNESS, Study, least_preload, machine, shaken
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import MILLI, OURS, THESIS, WHEELS, drawn, legend_above, panels
from spheredrive.studies.reproduce.table import percent

SPHERE_MASS = np.geomspace(1.0, 300.0, 21)
STAGE_MASS = np.geomspace(1.0, 300.0, 21)
PUSHES = (50.0, 100.0, 200.0)
# Light damping, so that a mass can move a resonance: a share of the critical at the demonstrator's 5 kg.
LIGHT = 0.05
# At a single speed single resonances would hide the trend: means over rotations of 0.05 to 0.15 rad/s.
ROTATIONS = ROTATION * np.linspace(0.5, 1.5, 12)[:, None]


def _light(design):
    return machines.compliant(design, STIFFNESS, 2 * LIGHT * np.sqrt(STIFFNESS * 5.0))


def _mean(sizes) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(sizes))))


@drawn
def sphere_study() -> Study:
    """Natural frequency, vibration and preload over the sphere's mass."""
    designs = [machine(mass=float(mass)) for mass in SPHERE_MASS]
    frequency = np.array([vibration.modes(_light(design)).natural_frequencies[[0, 2]] for design in designs])
    moved = [[shaken(_light(design), rotation) for rotation in ROTATIONS] for design in designs]
    displacement = np.array([_mean([one.rms_displacement for one in row]) for row in moved])
    acceleration = np.array([_mean([one.rms_acceleration for one in row]) for row in moved])
    preload = np.array([least_preload(design) for design in designs])
    figure, axes = panels(5.4, 2, 2, sharex=True)
    axes[0, 0].plot(SPHERE_MASS, frequency[:, 0], color=OURS, label="lowest mode")
    axes[0, 0].plot(SPHERE_MASS, frequency[:, 1], color=THESIS, label="highest mode")
    axes[0, 0].legend(loc="upper right")
    axes[0, 1].plot(SPHERE_MASS, preload, color=OURS)
    axes[1, 0].plot(SPHERE_MASS, MILLI * displacement, color=OURS)
    axes[1, 1].plot(SPHERE_MASS, acceleration, color=OURS)
    names = ("natural frequency (Hz)", "least preload (N)", "RMS displacement (mm)", "RMS acceleration (m/s²)")
    for place, name in zip(axes.ravel(), names, strict=True):
        place.set_ylabel(name)
        place.set_ylim(0, None)
        place.set_xscale("log")
        label_powers(place.xaxis)
        place.set_xlim(SPHERE_MASS[0], SPHERE_MASS[-1])
    for place in axes[1]:
        place.set_xlabel("mass of the sphere (kg)")
    columns = {
        "sphere mass (kg)": SPHERE_MASS,
        "lowest mode (Hz)": frequency[:, 0],
        "highest mode (Hz)": frequency[:, 1],
        "least preload (N)": preload,
        "RMS displacement (mm)": MILLI * displacement,
        "RMS acceleration (m/s2)": acceleration,
    }
    ends = [f"{x:.3g}" for x in (frequency[0, 0], frequency[-1, 0], MILLI * displacement[0], MILLI * displacement[-1])]
    conclusion = (
        f"From {SPHERE_MASS[0]:g} to {SPHERE_MASS[-1]:g} kg the lowest natural frequency falls from {ends[0]} to {ends[1]} "
        f"Hz, as 1/√M, and the centre's RMS displacement goes from {ends[2]} to {ends[3]} mm; preload beyond the weight for "
        f"{DEMAND:g} rad/s² goes from {preload[0]:.0f} to {preload[-1]:.0f} N, since a shell's inertia grows with its weight. "
        "ξ and isotropy do not change. A heavier sphere does not follow the rollers less until they pass above its natural "
        "frequency: choose wheel speeds and K so that rollers pass well below it, or isolate the payload inside."
    )
    caption = (
        f"Standard wheels, K = 188208 N/m, damping {percent(LIGHT, 1)} of critical at 5 kg; RMS over steady rotations of 0.05 "
        "to 0.15 rad/s. Preload as in the other studies, with the weight of the sphere itself already pressing."
    )
    return Study(Drawing("study-sphere-mass", "Mass of the sphere", caption, figure, columns), conclusion)


@drawn
def stage_study() -> Study:
    """Preload over the stage's mass while the stage is pushed."""
    found = {}
    for push in PUSHES:
        designs = [replace(machine(), stage=replace(machine().stage, mass=float(mass))) for mass in STAGE_MASS]
        found[push] = np.array([least_preload(design, 0.0, push) for design in designs])
    figure, axes = panels(3.2, 1, 1)
    axes = axes[0, 0]
    for (push, force), colour in zip(found.items(), WHEELS, strict=False):
        axes.semilogx(STAGE_MASS, force, color=colour, label=f"P = {push:g} N")
    label_powers(axes.xaxis)
    axes.set(xlabel="mass of the stage (kg)", ylabel="least preload (N)", xlim=(STAGE_MASS[0], STAGE_MASS[-1]), ylim=(0, None))
    legend_above(figure, axes)
    columns = {"stage mass (kg)": STAGE_MASS, **{f"preload at P = {push:g} N (N)": force for push, force in found.items()}}
    five = [float(np.interp(5.0, STAGE_MASS, force)) for force in found.values()]
    top = found[PUSHES[-1]]
    enough = STAGE_MASS[top <= 0]
    words = (
        f"from {enough[0]:.0f} kg on the weight alone holds it"
        if len(enough)
        else f"at {STAGE_MASS[-1]:g} kg it is {top[-1]:.0f} N"
    )
    conclusion = (
        f"A push of {PUSHES[-1]:g} N on the stage takes {five[-1]:.0f} N of preload at the demonstrator's 5 kg and {words}: "
        "the stage hands the sphere the share M_s/(M_s + M_l + Σm) of the push. Relative to the stage, neither vibration nor "
        "ξ nor isotropy depends on the stage's mass. Make the stage heavy against the sphere, or limit its acceleration, "
        "before adding preload."
    )
    caption = (
        "Least force towards the wheels, beyond the sphere's weight, while P pushes the stage along any axis and the wheels "
        "stand."
    )
    return Study(Drawing("study-stage-mass", "Mass of the stage", caption, figure, columns), conclusion)
