"""Loads along a run of the dynamics: what the motors give, and what the contacts carry."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.dynamics.loads import Loads
from spheredrive.report.figures.style import GREY, INK, LIGHT, styled, wheel_colour, wheel_dashes
from spheredrive.report.figures.thinning import thinned
from spheredrive.simulation.overview import Overview
from spheredrive.simulation.rolling_run import RollingRun
from spheredrive.summary import preload_phrase, ratio

# More lines than these need no legend, and more wheels are drawn as a band from the least to the largest.
LISTED = 14
LINES = 30
# A utilisation beyond this is drawn at the edge: the contact is hardly pressed any more.
USED_SHOWN = 1.5


@styled
def motor_figure(run: RollingRun, loads: Loads) -> Figure:
    """Torque, speed and power of each wheel's motor over time."""
    figure = Figure(figsize=(7.4, 5.6), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True)
    for axes, values, label in (
        (panels[0], run.motor_torque, "torque (N m)"),
        (panels[1], run.wheel_speed, "speed (rad/s)"),
        (panels[2], loads.power, "power (W)"),
    ):
        _draw_wheels(axes, run.time, values, label)
    _finish(panels, run)
    return figure


@styled
def contact_force_figure(run: RollingRun, loads: Loads) -> Figure:
    """Normal force and friction of each wheel over time, and friction as a share of its limit where that is known."""
    rows: list[tuple[np.ndarray, str]] = [(run.friction_force, "friction (N)")]
    if loads.normals_known:
        rows.insert(0, (run.normal_force, "normal force (N)"))
    if loads.utilisation is not None:
        rows.append((loads.utilisation, "share of the limit"))
    figure = Figure(figsize=(7.4, 0.8 + 1.6 * len(rows)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(rows), 1, sharex=True))
    for axes, (values, label) in zip(panels, rows, strict=True):
        _draw_wheels(axes, run.time, np.clip(values, None, USED_SHOWN) if values is loads.utilisation else values, label)
    if loads.utilisation is not None:
        _draw_limit(panels[-1], loads.utilisation)
    _finish(panels, run)
    return figure


def _draw_wheels(axes: Axes, time: np.ndarray, values: np.ndarray, label: str) -> None:
    """One line a wheel in the wheel's colour; a band for many wheels. Every corner of every line is kept."""
    axes.axhline(0, color=LIGHT, lw=0.5, zorder=0)
    axes.set_ylabel(label)
    if values.shape[1] > LINES:
        low, high = values.min(axis=1), values.max(axis=1)
        kept = thinned(time, np.stack([low, high], -1))
        axes.fill_between(time[kept], low[kept], high[kept], color=LIGHT, lw=0, label="all wheels, least to largest")
        return
    for i in range(values.shape[1]):
        # Line by line: what one wheel needs for its peaks, another would draw for nothing.
        kept = thinned(time, values[:, i], 400)
        axes.plot(time[kept], values[kept, i], color=wheel_colour(i), ls=wheel_dashes(i), lw=0.9, label=f"wheel {i + 1}")


def _draw_limit(axes: Axes, utilisation: np.ndarray) -> None:
    axes.axhline(1, color=INK, lw=0.8, ls="--")
    worst = float(utilisation.max())
    axes.set_ylim(0, USED_SHOWN * 1.02 if worst > 1.2 else 1.2)
    axes.annotate("friction limit", (1, 1), (-2, 2), xycoords=("axes fraction", "data"), textcoords="offset points",
                  ha="right", va="bottom", fontsize=8, color=GREY)  # fmt: skip


def _finish(panels, run: RollingRun) -> None:
    count = run.motor_torque.shape[1]
    if count <= LISTED or count > LINES:
        panels[0].legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=min(count, 7), handlelength=1.6, borderaxespad=0.2)
    panels[-1].set_xlabel("time (s)")
    if run.time[-1] > run.time[0]:
        panels[-1].set_xlim(run.time[0], run.time[-1])


def motor_caption(loads: Loads) -> str:
    """What the figure of the motors shows, in numbers."""
    torque = max(loads.peaks, key=lambda peak: peak.torque)
    speed = max(loads.peaks, key=lambda peak: peak.speed)
    power = max(loads.peaks, key=lambda peak: peak.power)
    return (
        f"Largest torque: {torque.torque:.4g} N m, wheel {torque.wheel} at {torque.torque_time:.4g} s. Largest speed: "
        f"{speed.speed:.4g} rad/s, wheel {speed.wheel} at {speed.speed_time:.4g} s. Largest power: {power.power:.4g} W, wheel "
        f"{power.wheel} at {power.power_time:.4g} s. Power is negative where a motor brakes."
    )


def contact_force_caption(result: Overview) -> str:
    """What the figure of the contacts shows, in numbers."""
    low, used = result.least_normal, result.worst_utilisation
    if low is None:
        return "The contacts lie in a plane, so their normal forces are not determined; friction alone is shown."
    least = f"{low.least_normal:.4g}".replace("-", "−")
    text = (
        f"The least normal force is {least} N, at wheel {low.wheel} after {low.least_normal_time:.4g} s; a contact is pressed "
        "where it is above zero."
    )
    if used is None:
        return text + " The design gives no coefficient of friction, so no limit is drawn."
    text += f" Most of the friction limit μN is used by wheel {used.wheel} at {used.utilisation_time:.4g} s: "
    text += f"{ratio(used.utilisation)}; above 1 it would slip."
    return text + (f" What lies above {USED_SHOWN:g} is drawn there." if used.utilisation > USED_SHOWN else "")


def preload_sentence(result: Overview) -> str:
    """What preload the run asks for."""
    return f"Least preload that keeps every contact from slipping: {preload_phrase(result)}."


def ledger_sentence(result: Overview) -> str:
    """How well the energy of the run adds up."""
    return (
        "Energy ledger: the work of motors and stage, the energy of the machine, heat and the losses of race changes agree "
        f"within {result.residual:.2g} J over the run; the largest of them reaches {result.energy:.3g} J."
    )
