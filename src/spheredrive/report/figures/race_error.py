"""Error of the nominal Jacobian along a motion of wheels whose races take turns."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.kinematics import KinematicRun
from spheredrive.report.figures.style import GREY, INK, styled, wheel_colour, wheel_dashes
from spheredrive.report.figures.thinning import thinned

# Ticks for more race changes than this would be a solid bar; more lines than LISTED need no legend.
TICKED = 800
LISTED = 14


@styled
def race_error_figure(run: KinematicRun) -> Figure:
    """Wheel speeds, error of the angle and error of the magnitude over time, their peaks marked."""
    figure = Figure(figsize=(7.4, 6.2), layout="constrained")
    speeds, angle, magnitude = figure.subplots(3, 1, sharex=True, height_ratios=[1.0, 1.1, 1.1])
    draw_wheel_speeds(speeds, run)
    degrees, percent = np.degrees(run.error_angle), 100 * run.error_magnitude
    kept = thinned(run.time, np.stack([degrees, percent], -1))
    _draw_error(angle, run.time[kept], degrees[kept], "error of the axis (°)", "°", signs=(1,))
    _draw_error(magnitude, run.time[kept], percent[kept], "error of |Ω| (%)", " %", signs=(1, -1))
    magnitude.axhline(0, color=GREY, lw=0.5)
    if len(run.race_changes) <= TICKED:
        place = angle.get_xaxis_transform()
        angle.vlines(run.race_changes, 0, 0.045, color=INK, lw=0.4, transform=place)
    magnitude.set_xlabel("time (s)")
    magnitude.set_xlim(run.time[0], run.time[-1])
    return figure


def draw_wheel_speeds(axes: Axes, run: KinematicRun) -> None:
    """One line a wheel, in the wheel's colour."""
    kept = thinned(run.time, run.wheel_speed)
    count = run.wheel_speed.shape[1]
    for i in range(count):
        axes.plot(
            run.time[kept], run.wheel_speed[kept, i], color=wheel_colour(i), ls=wheel_dashes(i), lw=1.1, label=f"wheel {i + 1}"
        )
    axes.set_ylabel("wheel speed (rad/s)")
    if count <= LISTED:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=min(count, 7), handlelength=1.6, borderaxespad=0.2)


def _draw_error(axes: Axes, time, values, label: str, unit: str, signs) -> None:
    axes.plot(time, values, color=INK, lw=0.7)
    axes.set_ylabel(label)
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    span = (high - low) or 1.0
    axes.set_ylim(low - (0.2 * span if -1 in signs else 0.07 * span), high + 0.2 * span)
    for sign in signs:
        i = int(np.argmax(sign * values))
        if sign * values[i] <= 0:
            continue
        axes.plot(time[i], values[i], "o", ms=4.5, mfc="none", mec=wheel_colour(1), mew=1.2, zorder=5)
        early = time[i] < (time[0] + time[-1]) / 2
        text = f"{_signed(values[i], len(signs) > 1)}{unit} at {time[i]:.3f} s"
        axes.annotate(
            text, (time[i], values[i]), (6 if early else -6, 5 * sign),
            textcoords="offset points", ha="left" if early else "right", va="bottom" if sign > 0 else "top", fontsize=8,
            color=wheel_colour(1),
        )  # fmt: skip


def _signed(number: float, sign: bool) -> str:
    return (f"{number:+.2f}" if sign else f"{number:.2f}").replace("-", "−")


def peaks(run: KinematicRun) -> tuple[int, int]:
    """Samples of the largest error of the angle and of the largest magnitude error of either sign."""
    return int(np.argmax(run.error_angle)), int(np.argmax(np.abs(run.error_magnitude)))


def race_error_caption(run: KinematicRun) -> str:
    """What the figure shows, in numbers."""
    angle, magnitude = peaks(run)
    count = len(run.race_changes)
    changes = f"Races change {count} times in {run.time[-1]:g} s"
    if 0 < count <= TICKED:
        changes += " (ticks at the foot of the middle panel)"
    return (
        f"{changes}. A controller that knows only the nominal Jacobian is wrong by up to "
        f"{math.degrees(run.error_angle[angle]):.2f}° in the axis of rotation (at {run.time[angle]:.3f} s) and by up to "
        f"{100 * abs(run.error_magnitude[magnitude]):.2f} % in its magnitude (at {run.time[magnitude]:.3f} s)."
    )
