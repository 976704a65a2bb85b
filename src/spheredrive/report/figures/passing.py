"""The steady motion over time while a pattern passes: displacement, velocity, acceleration, contact forces."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from spheredrive.report.figures.style import AXES, LIGHT, styled, wheel_colour, wheel_dashes
from spheredrive.report.figures.thinning import thinned
from spheredrive.vibration.assessment.assess import Assessment

SAMPLES = 2400
# No more passings than these of the fastest pattern, nor swings of the slowest mode: beyond, lines would be solid areas.
PASSINGS = 6
SWINGS = 40
LISTED = 14
LINES = 30


def duration(a: Assessment) -> float:
    """One passing of the slowest pattern that turns, s; of a faster one where that takes too long to be drawn."""
    passing = [e.passing_frequency for e in a.excitations if e.speed and e.depth]
    swings = SWINGS / a.resonances.frequency[0] if len(a.resonances.frequency) else 1 / min(passing)
    return max(1 / max(passing), min(1 / min(passing), PASSINGS / max(passing), swings))


@styled
def passing_figure(a: Assessment) -> Figure:
    """Components of the centre's motion and the force of every contact while a pattern passes."""
    assert a.response is not None, "a motion to draw"
    figure = Figure(figsize=(7.4, 6.8), layout="constrained")
    panels = figure.subplots(4, 1, sharex=True)
    time = np.linspace(0, duration(a), SAMPLES + 1)
    motion = a.response.at(time)
    shown = ((motion.displacement, "displacement", "m"), (motion.velocity, "velocity", "m/s"),
             (motion.acceleration, "acceleration", "m/s²"))  # fmt: skip
    for axes, (values, what, unit) in zip(panels, shown, strict=False):
        factor, label = _scale(values, what, unit)
        for i, name in enumerate("xyz"):
            kept = thinned(time, values[:, i], 400)
            axes.plot(time[kept], values[kept, i] * factor, color=AXES[name], lw=0.9, label=name)
        axes.axhline(0, color=LIGHT, lw=0.5, zorder=0)
        axes.set_ylabel(label)
    _draw_forces(panels[3], a, time, motion.contact_force)
    panels[0].legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, handlelength=1.6, borderaxespad=0.2)
    panels[3].set_xlabel("time (s)")
    panels[3].set_xlim(0, time[-1])
    return figure


def _scale(values: np.ndarray, what: str, unit: str) -> tuple[float, str]:
    """Factor and label with which the values read as plain numbers: in m, mm, µm or nm."""
    largest = float(np.abs(values).max(initial=0.0))
    for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "µ"), (1e9, "n")):
        if largest * factor >= 0.5:
            return factor, f"{what} ({prefix}{unit})"
    return 1.0, f"{what} ({unit})"


def _draw_forces(axes, a: Assessment, time: np.ndarray, force: np.ndarray) -> None:
    """Forces of all contacts; their change from the seat where that is what can be seen."""
    assert a.response is not None, "a motion to draw"
    change = force - a.response.system.seat_force
    small = np.abs(change).max() < 0.02 * np.abs(force).max()
    values = change if small else force
    factor, label = _scale(values, "change of force" if small else "contact force", "N")
    values = values * factor
    wheels = a.response.system.contacts.wheel
    if values.shape[1] > LINES:
        low, high = values.min(axis=1), values.max(axis=1)
        axes.fill_between(time, low, high, color=LIGHT, lw=0, label="all contacts, least to largest")
    else:
        for j, wheel in enumerate(wheels.tolist()):
            kept = thinned(time, values[:, j], 400)
            axes.plot(time[kept], values[kept, j], color=wheel_colour(wheel), ls=wheel_dashes(wheel), lw=0.9,
                      label=f"wheel {wheel + 1}" if wheel not in wheels[:j] else None)  # fmt: skip
    axes.set_ylabel(label)
    low, high = axes.get_ylim()
    if low < 0 < high:
        axes.axhline(0, color=LIGHT, lw=0.8, zorder=0)
    if force.shape[1] <= LISTED or force.shape[1] > LINES:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=7, handlelength=1.6, borderaxespad=0.2)


def passing_caption(a: Assessment) -> str:
    """What the figure shows, in numbers."""
    least = min(a.forces, key=lambda f: f.least)
    assert a.sphere is not None, "a motion to tell of"
    s = a.sphere.sizes
    text = (
        f"The sphere's centre, from its seat on round wheels, over {duration(a):.4g} s. In the long run it goes up to "
        f"{s.peak_displacement * 1e6:.4g} µm and {s.peak_acceleration:.4g} m/s², and the least contact force is "
        f"{least.least:.4g} N, at wheel {least.wheel}."
    ).replace(" -", " −")
    if a.impulses:
        text += " On rigid contacts the velocity jumps at corners; the acceleration shown is that between them."
    return text
