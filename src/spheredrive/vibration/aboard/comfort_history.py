"""Weighted acceleration over time: what ISO 2631-1 asks of a record that holds shocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.vibration.aboard.comfort import UPRIGHT, WEIGHTINGS, Comfort, comfort, upward, weighting

# MTVV is the largest RMS over this time, s (ISO 2631-1:1997, 6.3.1).
RUNNING_TIME = 1.0
# After this many periods of its lowest corner a weighting has forgotten its past: exp(−2π·8/√2) = 4e-16.
MEMORY = 8.0


@dataclass(frozen=True)
class ComfortHistory:
    """Comfort of a record, and how much its shocks weigh.

    mean           the comfort of the whole record
    peak           largest weighted acceleration at any instant, horizontal and vertical, m/s², (2,)
    crest_factor   that over the RMS, (2,); zero where nothing moves
    mtvv           maximum transient vibration value: the largest RMS over one second, m/s², (2,)
    vdv            fourth-power vibration dose value (∫ a_w⁴ dt)^¼, m/s^1.75, (2,)
    shocks         whether the RMS alone says too little: crest factor above 9, MTVV above 1.5 times the RMS, or VDV above 1.75
                   times RMS T^¼ (6.2.1, 6.3.3)

    "Horizontal" is the length of the vector of both horizontal axes.
    """

    mean: Comfort
    peak: np.ndarray
    crest_factor: np.ndarray
    mtvv: np.ndarray
    vdv: np.ndarray
    shocks: bool


def weighted_history(name: str, acceleration, sample_rate: float) -> np.ndarray:
    """The acceleration under one weighting of ISO 2631-1, sample by sample.

    name           "Wk", "Wd" or "Wf"; see ``comfort.weighting``
    acceleration   m/s², (..., t), evenly spaced
    sample_rate    Hz

    Returns (..., t). The weighting is applied to the spectrum of the record, padded with rest until the filter's memory has
    died, so its magnitude and phase are the analogue ones at every frequency below half the sample rate: no warping. What the
    samples cannot show, content above half the sample rate, is lost; before the record everything is at rest, so the filter
    starts with a transient of some 1/f₁ seconds where the record starts abruptly. Raises ``SpheredriveError`` where the sample
    rate leaves out part of the weighting (below 2.5 f₂) and for numbers that are not finite.
    """
    acceleration, sample_rate = _checked_record(acceleration, sample_rate)
    if name not in WEIGHTINGS:
        raise UnknownNameError("frequency weighting", name, WEIGHTINGS)
    corners = WEIGHTINGS[name]
    if sample_rate < 2.5 * corners.f2:
        raise SpheredriveError(
            f"{name} reaches to {corners.f2:g} Hz, so the record needs at least {2.5 * corners.f2:g} samples a second, "
            f"not {sample_rate:g}"
        )
    from scipy import fft

    count = acceleration.shape[-1]
    length = fft.next_fast_len(count + int(np.ceil(MEMORY / corners.f1 * sample_rate)), real=True)
    spectrum = fft.rfft(acceleration, length) * weighting(name, fft.rfftfreq(length, 1 / sample_rate))
    return fft.irfft(spectrum, length)[..., :count]


def comfort_of_history(acceleration, sample_rate: float, up=UPRIGHT, settling: float = 0.0) -> ComfortHistory:
    """Comfort of a record of acceleration, with its peaks and doses.

    acceleration   along x, y, z, m/s², (t, 3), evenly spaced, without gravity
    sample_rate    Hz, at least 250
    up             direction in which the occupant sits upright, (3,); inertial z unless given
    settling       s at the start to leave out of every value, while the filters swing in

    Returns ``ComfortHistory``. Raises ``SpheredriveError`` for a record that is not (t, 3), shorter than its settling, sampled
    too slowly or not finite. Source: ISO 2631-1:1997, 6.1 to 6.3. See ``weighted_history`` for the filter's limits.
    """
    record, rate = _checked_record(acceleration, sample_rate)
    first = round(settling * rate) if np.isfinite(settling) and settling >= 0 else -1
    if record.ndim != 2 or record.shape[1] != 3 or not 0 <= first < len(record):
        raise SpheredriveError(
            f"a record of acceleration takes rows of x, y and z over more than its settling time, not an array "
            f"{record.shape} with {settling} s to settle"
        )
    up = upward(up)
    level, upright = (weighted_history(name, record.T, rate)[:, first:] for name in ("Wd", "Wk"))
    mean = comfort(_mean_products(level), _mean_products(upright), up)
    squares = np.stack([((level - np.outer(up, up @ level)) ** 2).sum(axis=0), (up @ upright) ** 2])
    rms = np.sqrt(squares.mean(axis=1))
    peak, duration = np.sqrt(squares.max(axis=1)), squares.shape[1] / rate
    mtvv = np.sqrt(_largest_running_mean(squares, max(1, round(RUNNING_TIME * rate))))
    vdv = ((squares**2).mean(axis=1) * duration) ** 0.25
    crest = np.divide(peak, rms, out=np.zeros(2), where=rms > 0)
    shocks = (crest > 9) | (mtvv > 1.5 * rms) | (vdv > 1.75 * rms * duration**0.25)
    return ComfortHistory(mean, peak, crest, mtvv, vdv, bool(shocks.any()))


def _mean_products(history: np.ndarray) -> np.ndarray:
    return history @ history.T / history.shape[1]


def _largest_running_mean(squares: np.ndarray, window: int) -> np.ndarray:
    """Largest mean over ``window`` samples; the whole record where it is shorter."""
    window = min(window, squares.shape[1])
    sums = np.concatenate([np.zeros((len(squares), 1)), np.cumsum(squares, axis=1)], axis=1)
    return (sums[:, window:] - sums[:, :-window]).max(axis=1).clip(min=0) / window


def _checked_record(acceleration, sample_rate) -> tuple[np.ndarray, float]:
    acceleration, sample_rate = np.asarray(acceleration, float), float(sample_rate)
    if not np.isfinite(acceleration).all() or not acceleration.ndim or not acceleration.shape[-1]:
        raise SpheredriveError("a record of acceleration takes finite numbers, at least one sample")
    if not (np.isfinite(sample_rate) and sample_rate > 0):
        raise SpheredriveError(f"a sample rate is a finite number of samples a second above zero, not {sample_rate}")
    return acceleration, sample_rate
