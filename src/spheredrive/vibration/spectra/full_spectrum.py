"""The order spectrum of a steady motion with as many harmonics as the motion needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.vibration.spectra import lines
from spheredrive.vibration.spectra.resonances import wheel_lines
from spheredrive.vibration.spectra.spectrum import OrderSpectrum

if TYPE_CHECKING:
    from spheredrive.vibration.motion.response import Response

COUNTS = (100, 400, 1600, 6400)
# Lines that hold this share of the mean square acceleration are enough, once they reach as far as any weighting of comfort.
ENOUGH = 0.9999
REACH = 1000.0
# Multiplications that all lines together may take.
WORK = 3e9


class FullSpectrum(NamedTuple):
    """Lines by wheel, and the share of the mean square acceleration that they hold; None on rigid contacts, whose corners put
    the same acceleration on every harmonic, so that no number of lines holds it."""

    spectrum: OrderSpectrum
    share: float | None


def full_spectrum(response: Response, of: str = "sphere") -> FullSpectrum:
    """Lines of the "sphere" or the "payload" up to 100, 400, 1600 or 6400 harmonics of each shape.

    As many as it takes to hold 99.99 % of the exact RMS acceleration and to reach 1 kHz with every wheel; fewer where a machine
    of very many wheels would take too long.
    """
    exact = (response.sphere if of == "sphere" else response.payload).rms_acceleration  # type: ignore[union-attr]
    flat = bool(response.impulses) and of == "sphere"
    passing = response.passing_frequency[response.passing_frequency > 0]
    counts = [n for n in COUNTS if n == COUNTS[0] or n * _work(response) <= WORK]
    found = FullSpectrum(response.spectrum(counts[0], of), None)
    for count in counts:
        spectrum = response.spectrum(count, of)
        frequency, displacement = spectrum.combined()
        acceleration = -((2 * np.pi * frequency[:, None]) ** 2) * displacement
        square = float((lines.rms(frequency, acceleration) ** 2).sum())
        share = None if flat else 1.0 if exact == 0 else min(square / exact**2, 1.0)
        found = FullSpectrum(wheel_lines(response.system, spectrum), share)
        reached = not len(passing) or count * passing.min() >= REACH
        if reached and (share is None or share >= ENOUGH):
            break
    return found


def _work(response: Response) -> float:
    """Multiplications for one harmonic of every contact."""
    freedoms, contacts = response.system.equations.input_stiffness.shape
    return contacts * (freedoms + 10.0) ** 2 * (freedoms + contacts + 10.0)
