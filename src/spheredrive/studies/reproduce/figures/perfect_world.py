"""Fig 3.3–3.5: the "perfect world" of round wheels on a rigid machine."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import AXES, drawn, legend_above, panels
from spheredrive.studies.reproduce.results import perfect_world

XYZ = "xyz"


def _lines(values: np.ndarray, names, colours, label: str):
    run = perfect_world.run()
    figure, axes = panels(2.9, 1, 1)
    axes = axes[0, 0]
    for column, name, colour in zip(values.T, names, colours, strict=True):
        axes.plot(run.time, column, color=colour, label=name)
    axes.set_xlabel("time (s)")
    axes.set_ylabel(label)
    axes.set_xlim(run.time[0], run.time[-1])
    legend_above(figure, axes)
    return figure, {
        "time (s)": run.time,
        **{f"{name} {label[label.index('(') :]}": values[:, i] for i, name in enumerate(names)},
    }


@drawn
def figure_3_3() -> Drawing:
    """Ω over time."""
    run = perfect_world.run()
    figure, columns = _lines(run.angular_velocity, [f"Ω {a}" for a in XYZ], AXES.values(), "angular velocity Ω (rad/s)")
    return Drawing(
        "fig-3.3",
        "Ω over time, orthogonal layout",
        f"Constant torques give straight lines: after {run.time[-1]:g} s |Ω| is {np.linalg.norm(run.angular_velocity[-1]):.2f} "
        "rad/s. The slope rests on the assumed inertias.",
        figure,
        columns,
    )


@drawn
def figure_3_4() -> Drawing:
    """The quaternion over time."""
    run = perfect_world.run()
    names = ["q₀ (scalar)", "q₁", "q₂", "q₃"]
    figure, columns = _lines(run.orientation, names, ("#000000", *AXES.values()), "quaternion (–)")
    turns = np.linalg.norm(run.angular_velocity[-1]) * run.time[-1] / (4 * np.pi)
    return Drawing(
        "fig-3.4",
        "The quaternion over time, orthogonal layout",
        f"Harmonic with rising frequency about a constant axis: {turns:.1f} turns in {run.time[-1]:g} s.",
        figure,
        columns,
    )


@drawn
def figure_3_5() -> Drawing:
    """The stage's position over time."""
    run = perfect_world.run()
    figure, columns = _lines(run.stage_position, [f"stage {a}" for a in XYZ], AXES.values(), "stage position (m)")
    return Drawing(
        "fig-3.5",
        "Position of the stage over time, orthogonal layout",
        f"Constant forces give parabolas; nothing of the rotation shows. After {run.time[-1]:g} s the stage is at "
        f"({', '.join(f'{x:.3f}' for x in run.stage_position[-1])}) m.",
        figure,
        columns,
    )
