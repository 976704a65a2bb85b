"""Lines of the vibration: what each wheel puts on the sphere's centre, by frequency."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.report.figures.log_axis import label_powers
from spheredrive.report.figures.style import GREY, INK, styled, wheel_colour, wheel_dashes
from spheredrive.vibration.assessment.as_dict import line_rows
from spheredrive.vibration.assessment.assess import Assessment
from spheredrive.vibration.spectra.resonances import oscillating

# Lines below this share of the largest are not drawn, nor more than MOST of a wheel, the strongest by velocity.
LEAST = 1e-4
MOST = 300
LISTED = 14
NAMED = 3


@styled
def order_spectrum_figure(a: Assessment) -> Figure:
    """Displacement and acceleration of each line over its frequency, natural frequencies dashed."""
    figure = Figure(figsize=(7.4, 4.6), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    assert a.sphere is not None, "a motion with lines"
    s = a.sphere.spectrum
    _draw(panels[0], s, np.linalg.norm(s.displacement, axis=1) * 1e6, "displacement (µm)")
    _draw(panels[1], s, np.linalg.norm(s.acceleration, axis=1), "acceleration (m/s²)")
    drawn = _drawn_frequencies(a)
    panels[0].set_xscale("log")
    label_powers(panels[1].xaxis)
    panels[0].set_xlim(drawn.min() / 1.4, drawn.max() * 1.4)
    _mark_modes(panels, a)
    _name_lines(panels[1], a)
    panels[1].set_xlabel("frequency (Hz)")
    if len({*s.wheel.tolist()}) <= LISTED:
        panels[0].legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=7, handlelength=1.6, borderaxespad=0.2)
    return figure


def _drawn_frequencies(a: Assessment) -> np.ndarray:
    """Frequencies of the lines that stand above the floor of one of the panels."""
    assert a.sphere is not None, "a motion with lines"
    s = a.sphere.spectrum
    kept = np.zeros(len(s.frequency), bool)
    for amplitude in (np.linalg.norm(s.displacement, axis=1), np.linalg.norm(s.velocity, axis=1)):
        kept |= amplitude > LEAST * amplitude.max()
    return s.frequency[kept]


def _draw(axes: Axes, s, amplitude: np.ndarray, label: str) -> None:
    floor = LEAST * float(amplitude.max())
    velocity = np.linalg.norm(s.velocity, axis=1)
    for wheel in sorted(set(s.wheel.tolist())):
        own = np.flatnonzero((s.wheel == wheel) & (amplitude > floor))
        own = own[np.argsort(-velocity[own], kind="stable")[:MOST]]
        stems = np.full((len(own), 3, 2), np.nan)
        stems[:, :2, 0] = s.frequency[own, None]
        stems[:, 0, 1], stems[:, 1, 1] = floor, amplitude[own]
        x, y = stems.reshape(-1, 2).T
        axes.plot(x, y, color=wheel_colour(wheel - 1), ls=wheel_dashes(wheel - 1), lw=1.1, label=f"wheel {wheel}")
    axes.set_yscale("log")
    label_powers(axes.yaxis)
    axes.set_ylim(floor, 3 * float(amplitude.max()))
    axes.set_ylabel(label)


def _mark_modes(panels, a: Assessment) -> None:
    low, high = panels[0].get_xlim()
    for f in oscillating(a.modes)[0]:
        if low < f < high:
            for axes in panels:
                axes.axvline(f, color=GREY, lw=0.7, ls="--", zorder=0)


def _name_lines(axes: Axes, a: Assessment) -> None:
    """The order of the strongest lines, of different frequencies."""
    assert a.sphere is not None, "a motion with lines"
    named: list[float] = []
    for row in line_rows(a.sphere.spectrum):
        if len(named) < NAMED and all(abs(np.log(row["frequency_hz"] / f)) > 0.5 for f in named):
            named.append(row["frequency_hz"])
            place = (row["frequency_hz"], row["acceleration_m_s2"])
            axes.annotate(f"order {row['order']:.5g}", place, (0, 4), textcoords="offset points", ha="center", fontsize=7.5,
                          color=INK)  # fmt: skip


def order_spectrum_caption(a: Assessment) -> str:
    """What the figure shows, in numbers."""
    assert a.sphere is not None, "a motion with lines"
    worst = line_rows(a.sphere.spectrum)[0]
    text = (
        f"Each wheel makes lines at multiples of the frequency with which its pattern passes. By velocity the strongest is "
        f"order {worst['order']:.5g} of wheel {worst['wheel']} (harmonic {worst['harmonic']} of its pattern) at "
        f"{worst['frequency_hz']:.4g} Hz, with {worst['displacement_m'] * 1e6:.4g} µm and "
        f"{worst['acceleration_m_s2']:.4g} m/s²."
    )
    return text + (" Dashed: natural frequencies." if len(oscillating(a.modes)[0]) else "")
