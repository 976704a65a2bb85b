"""How much of a wheel's shape reaches the sphere's centre, by frequency."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from spheredrive.report.figures.log_axis import label_powers
from spheredrive.report.figures.style import GREY, LIGHT, styled, wheel_colour, wheel_dashes
from spheredrive.vibration.assessment.assess import Assessment
from spheredrive.vibration.model.modes import transmissibility

SAMPLES = 500
LISTED = 14
# Undamped resonances are drawn no higher than this, and nothing lower than LEAST.
MOST, LEAST = 100.0, 1e-3


def frequencies(a: Assessment) -> np.ndarray:
    """From a tenth of the lowest natural frequency to three times the highest, Hz, close together near each of them."""
    f = a.modes.natural_frequencies
    near = [f_n * (1 + sign * np.geomspace(1e-3, 0.1, 20)) for f_n in f for sign in (-1, 1)]
    return np.unique(np.concatenate([np.geomspace(f[0] / 10, 3 * f[-1], SAMPLES), *near]))


@styled
def transmissibility_figure(a: Assessment) -> Figure:
    """|T| of each wheel over frequency, on logarithmic axes; natural frequencies dashed."""
    figure = Figure(figsize=(7.4, 3.3), layout="constrained")
    axes = figure.subplots()
    f = frequencies(a)
    carrier = a.design if a.response is None else a.response.system.design
    T = np.clip(np.abs(transmissibility(carrier, f, a.model, a.isolator)), LEAST / 2, MOST)
    count = T.shape[-1]
    alike = np.ptp(T, axis=1).max() < 1e-3 * T.max()
    for j in range(1 if alike else count):
        label = "every wheel" if alike else f"contact {j + 1}" if count <= LISTED else None
        axes.plot(f, T[:, j], color=wheel_colour(j), ls=wheel_dashes(j), label=label)
    for f_n in a.resonances.frequency:
        axes.axvline(f_n, color=GREY, lw=0.7, ls="--", zorder=0)
    axes.axhline(1, color=LIGHT, lw=0.6, zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="|T|", xlim=(f[0], f[-1]))
    label_powers(axes.xaxis)
    label_powers(axes.yaxis)
    axes.set_ylim(max(LEAST, float(T.min()) / 1.5), min(MOST, 2 * float(T.max())))
    if alike or count <= LISTED:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=7, handlelength=1.6, borderaxespad=0.2)
    return figure


def transmissibility_caption(a: Assessment) -> str:
    """What the figure shows, in numbers."""
    low, high = a.modes.natural_frequencies[[0, -1]]
    text = (
        "How much of a wheel's shape reaches the sphere's centre, against rigid contacts. Well below the lowest natural "
        f"frequency, {low:.4g} Hz, the centre follows the shape; above the highest, {high:.4g} Hz, it stays behind."
    )
    return text + (f" Resonances without damping are cut at {MOST:g}." if (a.resonances.damping_ratio < 1e-6).any() else "")
