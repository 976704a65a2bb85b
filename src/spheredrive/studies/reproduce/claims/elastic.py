"""Rows on the orthogonal machine with elastic contacts (Fig 3.11–3.13): the thesis's measure and the centre itself."""

from __future__ import annotations

import numpy as np

from spheredrive import vibration
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.results import imperfect
from spheredrive.studies.reproduce.table import Row

# The steady motion repeats after the slowest wheel's pitch, 4.5 s; four of them contain every meeting of the three.
LONG = 18.0
RULE = "Largest |ΔR| over 18 s from rest, samples 0.5 ms apart; “orders of magnitude” means a factor above 10."


def rows() -> list[Row]:
    """All rows of this subject."""
    return [*_isolation(), *_damping(), _ringing(), _frequency()]


def _sizes(measure: str) -> list[float]:
    return [imperfect.largest(imperfect.elastic("half-sine", C, LONG, measure)) for C in imperfect.DAMPINGS]


def _rigid() -> float:
    return imperfect.largest(imperfect.rigid("half-sine", imperfect.ROUNDNESS, LONG))


def _isolation() -> list[Row]:
    rigid, deflection, true = _rigid(), _sizes("thesis")[0], _sizes("true")[0]
    return [
        Row(
            "fig-3.11",
            "K = 188208 N/m: the plotted vibration is orders of magnitude below that of the rigid machine",
            "orders of magnitude lower",
            f"elastic deflection y − h (the thesis's measure): {1e6 * deflection:.2f} µm, 1/{rigid / deflection:.0f} of the "
            f"rigid {1e3 * rigid:.3f} mm",
            rigid / deflection > 10,
            RULE,
            "E3",
        ),
        Row(
            "fig-3.11-centre",
            "K = 188208 N/m: the centre of the sphere vibrates orders of magnitude less than on rigid contacts",
            "orders of magnitude lower",
            f"the centre itself: {1e3 * true:.3f} mm, {true / rigid:.2f} of the rigid {1e3 * rigid:.3f} mm",
            rigid / true > 10,
            RULE,
            "E3",
        ),
    ]


def _damping() -> list[Row]:
    found = []
    for number, i in ((12, 1), (13, 2)):
        measured, true = _sizes("thesis"), _sizes("true")
        share = measured[i] / measured[0]
        found.append(
            Row(
                f"fig-3.{number}",
                f"C = {imperfect.DAMPINGS[i]:g} N s/m: the magnitude falls, but only a little next to the effect of stiffness",
                "noticeable, secondary",
                f"measure: {1e6 * measured[i]:.2f} µm, {share:.2f} of that without damping; centre: {1e3 * true[i]:.3f} mm, "
                f"{true[i] / true[0]:.2f}",
                0.1 < share < 1,
                "Falls, and by less than the factor of 10 that counts as an order of magnitude.",
            )
        )
    return found


def _ringing() -> Row:
    natural = float(vibration.modes(machines.orthogonal(stiffness=imperfect.STIFFNESS)).natural_frequencies[0])
    sizes = []
    for C in imperfect.DAMPINGS[:2]:
        frequency, line = _lines(imperfect.elastic("half-sine", C, LONG, "thesis"))
        near = np.abs(frequency / natural - 1) < 0.05
        sizes.append(float(np.sqrt(np.sum(line[near] ** 2) / 2)))
    undamped, damped = sizes
    return Row(
        "fig-3.12-ringing",
        "Damping takes away the secondary vibration of higher frequency",
        "dampened",
        f"RMS of the deflection along y within 5 % of the natural {natural:.1f} Hz: {1e6 * undamped:.2f} µm without damping, "
        f"{1e6 * damped:.3f} µm with C = 8500 N s/m",
        damped < 0.5 * undamped,
        "Falls to less than half.",
    )


def _frequency() -> Row:
    passing = machines.standard_wheel().rollers * imperfect.SPEEDS[1] / (2 * np.pi)
    rigid = _strongest(imperfect.rigid("half-sine", imperfect.ROUNDNESS, LONG))
    elastic = _strongest(imperfect.elastic("half-sine", imperfect.DAMPINGS[1], LONG))
    deflection = _strongest(imperfect.elastic("half-sine", imperfect.DAMPINGS[1], LONG, "thesis"))
    return Row(
        "section-3.2.1-frequency",
        "Elastic contacts lower the frequency of the sphere's motion",
        "significantly reduced",
        f"strongest line along y: {rigid:.3f} Hz rigid, {elastic:.3f} Hz elastic (the thesis's measure: "
        f"{deflection:.3f} Hz); rollers pass at {passing:.3f} Hz",
        elastic < rigid * 0.95,
        f"Lower by more than 5 %; lines of {LONG:g} s lie 0.06 Hz apart, 2 % of the frequency.",
        "E12",
    )


def _lines(motion) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and amplitudes, m, of the motion along y about its mean."""
    y = motion.displacement[:, 1]
    return np.fft.rfftfreq(len(y), motion.time[1]), np.abs(np.fft.rfft(y - y.mean())) * 2 / len(y)


def _strongest(motion) -> float:
    frequency, line = _lines(motion)
    return float(frequency[int(line.argmax())])
