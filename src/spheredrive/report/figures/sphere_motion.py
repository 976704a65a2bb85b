"""What the sphere does along a motion: its angular velocity, and the path of an axis fixed to it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.frames import quaternion_matrix
from spheredrive.kinematics import KinematicRun
from spheredrive.report.figures.map_grid import draw_map_grid, fill_map
from spheredrive.report.figures.projection import map_direction, map_path
from spheredrive.report.figures.race_error import draw_wheel_speeds
from spheredrive.report.figures.style import AXES, INK, LIGHT, PAPER, styled
from spheredrive.report.figures.thinning import thinned
from spheredrive.simulation.rolling_run import RollingRun

# Ticks for more race changes than this would be a solid bar.
TICKED = 800


@styled
def sphere_motion_figure(run: KinematicRun | RollingRun, wheel_speeds: bool = False) -> Figure:
    """Components of Ω over time and the path of the body's x axis; wheel speeds above where no other figure has them.

    Of a run of the dynamics, changes of race are ticked at the foot of Ω.
    """
    ratios = [1.0, 1.0, 1.9] if wheel_speeds else [1.0, 1.9]
    figure = Figure(figsize=(7.4, 2.0 * sum(ratios)), layout="constrained")
    *panels, path = figure.subplots(len(ratios), 1, height_ratios=ratios)
    if wheel_speeds:
        draw_wheel_speeds(panels[0], run)
        panels[0].sharex(panels[1])
        panels[0].tick_params(labelbottom=False)
    _draw_angular_velocity(panels[-1], run)
    changes = race_changes(run)
    if len(changes) <= TICKED:
        panels[-1].vlines(changes, 0, 0.045, color=INK, lw=0.4, transform=panels[-1].get_xaxis_transform())
    _draw_path(path, run)
    return figure


def race_changes(run: KinematicRun | RollingRun) -> np.ndarray:
    """Times at which a run of the dynamics changed races; of kinematics another figure shows them."""
    return run.event_time[run.event_wheel >= 0] if isinstance(run, RollingRun) else np.zeros(0)


def _draw_angular_velocity(axes: Axes, run: KinematicRun | RollingRun) -> None:
    kept = thinned(run.time, run.angular_velocity)
    for i, name in enumerate("xyz"):
        axes.plot(run.time[kept], run.angular_velocity[kept, i], color=AXES[name], lw=0.9, label=f"Ω {name}")
    axes.axhline(0, color=LIGHT, lw=0.5, zorder=0)
    axes.set(xlabel="time (s)", ylabel="Ω (rad/s)")
    if run.time[-1] > run.time[0]:
        axes.set_xlim(run.time[0], run.time[-1])
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, handlelength=1.6, borderaxespad=0.2)


def body_axis(run: KinematicRun | RollingRun) -> np.ndarray:
    """Direction of the body's x axis in the inertial frame, (k, 3)."""
    return quaternion_matrix(run.orientation)[..., :, 0]


def _draw_path(axes: Axes, run: KinematicRun | RollingRun) -> None:
    fill_map(axes, PAPER)
    draw_map_grid(axes, LIGHT, 0.4)
    directions = body_axis(run)
    kept = thinned(run.time, directions)
    axes.plot(*map_path(directions[kept]), color=INK, lw=1.1)
    x, y = map_direction(directions[[0, -1]])
    for k, (name, face) in enumerate((("start", "white"), ("end", INK))):
        axes.plot(x[k], y[k], "o", ms=5, mfc=face, mec=INK, label=name, ls="none", zorder=4 - k)
    axes.legend(loc="lower left", bbox_to_anchor=(0.86, 0.0), handletextpad=0.2)
    axes.set_title("Path of the sphere's own x axis: azimuth to the right from −180° to 180°, elevation upward", loc="center")


def sphere_motion_caption(run: KinematicRun | RollingRun) -> str:
    """What the figure shows, in numbers."""
    speed = np.linalg.norm(run.angular_velocity, axis=1)
    peak = int(np.argmax(speed))
    first, last = body_axis(run)[[0, -1]]
    apart = np.degrees(np.arctan2(np.linalg.norm(np.cross(first, last)), first @ last))
    text = (
        f"The sphere turns fastest at {run.time[peak]:.3f} s, with |Ω| = {speed[peak]:.4g} rad/s. After {run.time[-1]:g} s its "
        f"own x axis points {apart:.2f}° away from where it began."
    )
    changes = len(race_changes(run))
    ticked = " (ticks at the foot of Ω)" if 0 < changes <= TICKED else ""
    return text + (f" Races change {changes} times{ticked}." if isinstance(run, RollingRun) else "")
