"""Campbell diagram: frequencies at which patterns pass, against natural frequencies, over the speed of a wheel."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spheredrive.report.figures.style import GREY, INK, LIGHT, styled, wheel_colour, wheel_dashes
from spheredrive.vibration.assessment.assess import Assessment

BAND = "#f6c28b"
# Harmonics weaker than this share of a shape's strongest are left out, and all above MOST that meet nothing.
STRONG = 0.02
MOST = 8
LISTED = 14


@styled
def campbell_figure(a: Assessment) -> Figure:
    """Passing lines, natural frequencies, bands to avoid, and the speeds of the wheels."""
    figure = Figure(figsize=(7.4, 4.4), layout="constrained")
    axes = figure.subplots()
    top = _top(a)
    axes.set(xlim=(0, a.largest_speed), ylim=(0, top), xlabel="wheel speed (rad/s)", ylabel="frequency (Hz)")
    for band in a.resonances.bands:
        axes.axvspan(band.least, min(band.most, a.largest_speed), color=BAND, alpha=0.22, lw=0, zorder=0)
    _draw_passing(axes, a, top)
    for f in a.resonances.frequency:
        if f <= top:
            axes.axhline(f, color=INK, lw=0.9, ls="--")
            axes.annotate(f"{f:.4g} Hz", (1, f), (3, 0), xycoords=("axes fraction", "data"), textcoords="offset points",
                          va="center", fontsize=7.5, color=INK)  # fmt: skip
    told = {c for band in a.resonances.bands for c in band.crossings}
    places = sorted({(round(c.speed, 6), round(c.frequency, 6)) for c in told if c.speed <= a.largest_speed})
    if places:
        axes.plot(*np.array(places).T, "o", ms=5, mfc="white", mec=INK, mew=1.0, ls="none", zorder=4, label="meeting")
    _mark_speeds(axes, a)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=5, handlelength=1.6, borderaxespad=0.2)
    return figure


def _top(a: Assessment) -> float:
    """The highest frequency shown: above every meeting that is told, else above the lowest modes and passings."""
    met = [c.frequency for band in a.resonances.bands for c in band.crossings]
    passing = max((e.passing_frequency for e in a.excitations), default=1.0)
    lowest = a.resonances.frequency[:3].tolist()
    return 1.2 * max(met or [*lowest, 3 * passing, 1e-9])


def patterns(a: Assessment) -> list[tuple[float, list[int]]]:
    """Period of each different pattern, rad, and the harmonics that it has in any strength or that meet a mode."""
    from spheredrive.shape import profiles
    from spheredrive.vibration.spectra.spectrum import shape_harmonics

    found: dict[float, list[int]] = {}
    wheels = profiles(a.design)
    met = [(wheels[c.wheel - 1], c.harmonic) for band in a.resonances.bands for c in band.crossings]
    for own in dict.fromkeys(wheels):
        size = np.abs(shape_harmonics(own, MOST))
        size[0] = 0.0
        if own.depth > 0:
            strong = [k for k in range(1, MOST + 1) if size[k] >= STRONG * size.max()]
            found[own.period] = sorted({*found.get(own.period, []), *strong, *(k for shape, k in met if shape is own)})
    return list(found.items())


def _draw_passing(axes: Axes, a: Assessment, top: float) -> None:
    for i, (period, harmonics) in enumerate(patterns(a)):
        for k in harmonics:
            end = min(a.largest_speed, top * period / k)
            axes.plot([0, end], [0, k * end / period], color=GREY, ls=wheel_dashes(7 * i), lw=0.8, zorder=1)
            # The number of the harmonic stands where its line leaves the diagram.
            above = k * a.largest_speed / period > top
            axes.annotate(f"{k}×", (end, k * end / period), (-6, -3) if above else (-3, 3), textcoords="offset points",
                          ha="right", va="top" if above else "bottom", fontsize=7.5, color=GREY)  # fmt: skip


def _mark_speeds(axes: Axes, a: Assessment) -> None:
    turning = [e for e in a.excitations if e.speed]
    for e in turning:
        label = f"wheel {e.wheel} now" if len(turning) <= LISTED else None
        i = e.wheel - 1
        axes.axvline(abs(e.speed), color=wheel_colour(i), ls=wheel_dashes(i), lw=1.3, label=label, zorder=3)
    if len(turning) > LISTED:
        axes.plot([], [], color=LIGHT, label="wheels now")


def campbell_caption(a: Assessment) -> str:
    """What the figure shows, in numbers."""
    text = (
        "Rising lines: harmonics of the frequency with which a wheel's pattern passes. Dashed: natural frequencies. Where they "
        "meet, the wheel shakes the sphere in resonance; shaded speeds are better passed through than kept."
    )
    if not a.resonances.bands:
        return f"{text} Up to {a.largest_speed:.4g} rad/s there is none to avoid."
    worst = a.resonances.bands[0].crossings[0]
    beside = " 5 % beside it, as there is no damping" if a.resonances.damping_ratio[worst.mode - 1] < 1e-6 else ""
    return (
        f"{text} Worst is {worst.speed:.4g} rad/s, where harmonic {worst.harmonic} of wheel {worst.wheel} meets "
        f"{worst.frequency:.4g} Hz: {worst.severity * 1e6:.4g} µm{beside}."
    )
