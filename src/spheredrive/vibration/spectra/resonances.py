"""Which speeds of a design meet its natural frequencies, worked out from its linear system."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spheredrive.vibration.model.modes import Modes
from spheredrive.vibration.model.system import LinearSystem
from spheredrive.vibration.spectra.campbell import Crossing, SpeedBand, critical_speeds, speeds_to_avoid
from spheredrive.vibration.spectra.lines import SAME_FREQUENCY
from spheredrive.vibration.spectra.spectrum import OrderSpectrum, shape_harmonics

# Harmonics of a shape that are looked at; those of a valley's corner fall with the square of their number.
HARMONICS = 20
# Share by which natural frequencies and speeds may be off.
MARGIN = 0.05
# A mode with less damping than this has no finite resonance that could be believed.
UNDAMPED = 1e-6
# Modes closer than this share of their frequency are met together.
TOGETHER = 1e-6


class Resonances(NamedTuple):
    """Modes that can resonate, frequencies (Hz) and damping ratios (m,), each frequency once; what meets them, what to avoid.

    Crossings and bands carry numbers of wheels; a crossing's ``mode`` counts these modes from 1. The amplification of an
    undamped mode is that at ``MARGIN`` above its frequency: at the frequency itself there is none to tell.
    """

    frequency: np.ndarray
    damping_ratio: np.ndarray
    crossings: tuple[Crossing, ...]
    bands: tuple[SpeedBand, ...]


def resonances(system: LinearSystem, modes: Modes, largest_speed: float) -> Resonances:
    """Critical speeds up to ``largest_speed`` (rad/s) and the bands around them; source: model.md section 5b."""
    frequency, zeta = oscillating(modes)
    harmonics = [shape_harmonics(p, HARMONICS) for p in system.profiles]
    period = np.array([p.period for p in system.profiles])

    def transfer(s):
        beside = np.where(zeta < UNDAMPED, 1 + MARGIN, 1.0)
        return system.transfer(s * beside)[:, :3]

    found = critical_speeds(frequency, zeta, harmonics, period, transfer, largest_speed)
    wheel = system.contacts.wheel
    # Both halves of a split wheel meet a mode at once: the harder one stands for it.
    named = {}
    for crossing in found:
        crossing = crossing._replace(wheel=int(wheel[crossing.wheel - 1]) + 1)
        named.setdefault((crossing.wheel, crossing.harmonic, crossing.mode), crossing)
    crossings = tuple(c for c in named.values() if c.severity > 0)
    return Resonances(frequency, zeta, crossings, speeds_to_avoid(crossings, zeta, MARGIN))


def oscillating(modes: Modes) -> tuple[np.ndarray, np.ndarray]:
    """|λ|/2π, Hz, and damping ratio of the modes that swing, rising; those that meet are one, with the least damping."""
    swinging = modes.poles.imag > 0
    frequency, zeta = np.abs(modes.poles[swinging]) / (2 * np.pi), modes.damping_ratios[swinging]
    order = np.argsort(frequency)
    frequency, zeta = frequency[order], np.maximum(zeta[order], 0.0)
    fresh = np.flatnonzero(np.concatenate([[True], np.diff(frequency) > TOGETHER * frequency[1:]])) if len(zeta) else []
    if not len(fresh):
        return np.zeros(0), np.zeros(0)
    return frequency[fresh], np.minimum.reduceat(zeta, fresh)


def first_meeting(system: LinearSystem, modes: Modes) -> float:
    """The highest speed, rad/s, at which the first harmonic of a shape meets the lowest mode; 0 where there is none."""
    frequency, _ = oscillating(modes)
    return 0.0 if not len(frequency) else float(frequency[0] * max(p.period for p in system.profiles))


class Excited(NamedTuple):
    """A mode that the wheels excite at their speeds: its frequency (Hz), the strongest line near it with the wheel (from 1) and
    harmonic that make most of it, and the line's share of the mean square acceleration."""

    frequency: float
    wheel: int
    harmonic: int
    line_frequency: float
    share: float


def excited_modes(modes: Modes, spectrum: OrderSpectrum, mean_square: float, least_share: float = 0.1) -> tuple[Excited, ...]:
    """Modes with a line within ``MARGIN`` that holds at least ``least_share`` of the acceleration's mean square."""
    if not mean_square > 0 or not len(spectrum.frequency):
        return ()
    frequency, zeta = oscillating(modes)
    line, displacement = spectrum.combined()
    acceleration = (2 * np.pi * line[:, None]) ** 2 * displacement
    share = (np.abs(acceleration) ** 2).sum(axis=1) / 2 / mean_square
    own = np.linalg.norm(spectrum.displacement, axis=1)
    found = []
    for f in frequency[zeta < np.sqrt(0.5)]:
        near = np.where(np.abs(line / f - 1) <= MARGIN, share, 0.0)
        i = int(np.argmax(near))
        if near[i] >= least_share:
            j = int(np.argmax(np.where(np.abs(spectrum.frequency / line[i] - 1) <= SAME_FREQUENCY, own, -1.0)))
            most = int(spectrum.wheel[j]), int(spectrum.harmonic[j])
            found.append(Excited(float(f), *most, float(line[i]), float(share[i])))
    return tuple(found)


def wheel_lines(system: LinearSystem, spectrum: OrderSpectrum) -> OrderSpectrum:
    """The same lines by wheel: those of both halves of a split wheel added, with their phases."""
    wheel = system.contacts.wheel[spectrum.wheel - 1] + 1
    if np.array_equal(wheel, spectrum.wheel):
        return spectrum
    order = np.lexsort((spectrum.harmonic, wheel))
    wheel, harmonic = wheel[order], spectrum.harmonic[order]
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(wheel) != 0) | (np.diff(harmonic) != 0)]))
    first = order[starts]
    total = np.add.reduceat(spectrum.displacement[order], starts, axis=0)
    return OrderSpectrum(wheel[starts], harmonic[starts], spectrum.order[first], spectrum.frequency[first], total)
