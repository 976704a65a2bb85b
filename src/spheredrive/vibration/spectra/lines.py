"""Line spectra: a vibration as a sum of sines, a(t) = Re Σ a_k exp(2πi f_k t)."""

from __future__ import annotations

import numpy as np

from spheredrive.errors import SpheredriveError

# Lines whose frequencies differ by less than this share are one line: their beat would outlast the machine.
SAME_FREQUENCY = 1e-9


def checked_lines(frequency, amplitude) -> tuple[np.ndarray, np.ndarray]:
    """``frequency`` (l,), Hz, and complex ``amplitude`` (l, 3) as arrays; ``SpheredriveError`` where they are no spectrum."""
    frequency, amplitude = np.asarray(frequency, float), np.asarray(amplitude, complex)
    if frequency.ndim != 1 or amplitude.shape != (len(frequency), 3):
        raise SpheredriveError(
            f"a spectrum takes one amplitude along x, y and z for each of its frequencies, (l,) and (l, 3), "
            f"not {frequency.shape} and {amplitude.shape}"
        )
    if not (np.isfinite(frequency) & (frequency >= 0)).all() or not np.isfinite(amplitude).all():
        raise SpheredriveError("a spectrum takes finite amplitudes at finite frequencies that are not negative")
    return frequency, amplitude


def merged_lines(frequency: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same vibration with one line a frequency, frequencies rising: equal ones are added with their phases."""
    if not len(frequency):
        return frequency, amplitude
    order = np.argsort(frequency, kind="stable")
    frequency, amplitude = frequency[order], amplitude[order]
    fresh = np.diff(frequency) > SAME_FREQUENCY * frequency[1:]
    starts = np.flatnonzero(np.concatenate([[True], fresh]))
    return frequency[starts], np.add.reduceat(amplitude, starts, axis=0)


def rms(frequency, amplitude) -> np.ndarray:
    """RMS over all time along x, y and z, (3,): √(Σ ½ |a_k|²), a line at f = 0 counted by its square.

    Exact for any frequencies, commensurate or not; equal ones are added with their phases first (Parseval).
    """
    frequency, amplitude = merged_lines(*checked_lines(frequency, amplitude))
    squares = np.where(frequency[:, None] > 0, np.abs(amplitude) ** 2 / 2, amplitude.real**2)
    return np.sqrt(squares.sum(axis=0))


def peak_bound(frequency, amplitude) -> float:
    """What the length of the vector never exceeds: Σ of the lines' largest lengths.

    A line moves on an ellipse whose long semi-axis is √((|a|² + |a·a|)/2). The bound is approached where the frequencies are
    incommensurate and the long axes parallel.
    """
    frequency, amplitude = merged_lines(*checked_lines(frequency, amplitude))
    square, turning = (np.abs(amplitude) ** 2).sum(axis=1), np.abs((amplitude**2).sum(axis=1))
    steady = np.linalg.norm(amplitude.real, axis=1)
    return float(np.where(frequency > 0, np.sqrt((square + turning) / 2), steady).sum())
