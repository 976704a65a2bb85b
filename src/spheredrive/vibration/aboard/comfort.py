"""What vibration means to people aboard: the frequency weightings of ISO 2631-1 and its comfort scale.

The weightings are the analogue transfer functions of ISO 2631-1:1997, annex A, with the parameters of its table A.1, which
ISO 8041 repeats and Larson Davis prints in the manual of its HVM200 meter. They reproduce the standard's tables 3 and 4 to
the last digit printed, but for Wd at 10 Hz, where table 3 says 0.212 and its own formula 0.2017.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.vibration.spectra.lines import checked_lines, merged_lines

UPRIGHT = (0.0, 0.0, 1.0)


class Weighting(NamedTuple):
    """Corner frequencies (Hz) and quality factors of one weighting; band limits f₁, f₂ are of Butterworth's form."""

    f1: float
    f2: float
    f3: float
    f4: float
    Q4: float
    f5: float
    Q5: float
    f6: float
    Q6: float


WEIGHTINGS = {
    "Wk": Weighting(0.4, 100.0, 12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91),
    "Wd": Weighting(0.4, 100.0, 2.0, 2.0, 0.63, math.inf, 1.0, math.inf, 1.0),
    "Wf": Weighting(0.08, 0.63, math.inf, 0.25, 0.86, 0.0625, 0.80, 0.10, 0.80),
}

# Weighted total value (m/s²) from and to, both included: ISO 2631-1:1997, C.2.3.
COMFORT_SCALE = (
    (0.0, math.nextafter(0.315, 0.0), "not uncomfortable"),
    (0.315, 0.63, "a little uncomfortable"),
    (0.5, 1.0, "fairly uncomfortable"),
    (0.8, 1.6, "uncomfortable"),
    (1.25, 2.5, "very uncomfortable"),
    (math.nextafter(2.0, 3.0), math.inf, "extremely uncomfortable"),
)


def weighting(name: str, frequency) -> np.ndarray:
    """Complex frequency weighting at s = 2πi f: band limits, acceleration–velocity transition, upward step.

        W = s²/(s² + √2 ω₁ s + ω₁²) · 1/(1 + √2 s/ω₂ + s²/ω₂²) · (1 + s/ω₃)/(1 + s/(Q₄ω₄) + s²/ω₄²)
            · (ω₅/ω₆)² (1 + s/(Q₅ω₅) + s²/ω₅²)/(1 + s/(Q₆ω₆) + s²/ω₆²)

    name        "Wk" vertical, "Wd" horizontal (both seat surface), "Wf" motion sickness (vertical)
    frequency   Hz, (...), not negative

    Returns (...), complex; the factor of the standard's tables is its magnitude. Raises ``UnknownNameError`` for another name
    and ``SpheredriveError`` for frequencies that are negative or not finite. Source: ISO 2631-1:1997, annex A.
    """
    if name not in WEIGHTINGS:
        raise UnknownNameError("frequency weighting", name, WEIGHTINGS)
    f1, f2, f3, f4, Q4, f5, Q5, f6, Q6 = WEIGHTINGS[name]
    frequency = np.asarray(frequency, float)
    if not (np.isfinite(frequency) & (frequency >= 0)).all():
        raise SpheredriveError("a frequency weighting takes finite frequencies that are not negative, Hz")
    s = 1j * frequency
    high_pass = s**2 / (s**2 + math.sqrt(2) * f1 * s + f1**2)
    low_pass = 1 / (1 + math.sqrt(2) * s / f2 + (s / f2) ** 2)
    transition = (1 + s / f3) / (1 + s / (Q4 * f4) + (s / f4) ** 2)
    if math.isinf(f5):
        return high_pass * low_pass * transition
    step = (f5 / f6) ** 2 * (1 + s / (Q5 * f5) + (s / f5) ** 2) / (1 + s / (Q6 * f6) + (s / f6) ** 2)
    return high_pass * low_pass * transition * step


def comfort_words(total: float) -> tuple[str, ...]:
    """The reactions ISO 2631-1:1997, C.2.3, expects at the vibration total value a_v, m/s².

    Its ranges overlap: one or two apply. Raises ``SpheredriveError`` where a_v is negative or not finite. Holds for public
    transport; what is accepted elsewhere depends on duration and purpose, as the standard says itself.
    """
    if not (math.isfinite(total) and total >= 0):
        raise SpheredriveError(f"a weighted acceleration is a finite number that is not negative, not {total}")
    return tuple(word for least, most, word in COMFORT_SCALE if least <= total <= most)


@dataclass(frozen=True)
class Comfort:
    """Weighted RMS acceleration of a seated occupant, m/s².

    up           direction in which the occupant sits upright, (3,)
    horizontal   √(a_wx² + a_wy²), through Wd
    vertical     a_wz along ``up``, through Wk
    total        a_v = √(a_wx² + a_wy² + a_wz²): multiplying factors k = 1, comfort on a seat
    words        what the comfort scale says to it
    worst_up     the upright direction with the largest total; the sphere turns, and the occupant may turn with it
    worst_total  that total
    worst_words  what the comfort scale says to it
    """

    up: np.ndarray
    horizontal: float
    vertical: float
    total: float
    words: tuple[str, ...]
    worst_up: np.ndarray
    worst_total: float
    worst_words: tuple[str, ...]


def comfort_of_lines(frequency, acceleration, up=UPRIGHT) -> Comfort:
    """Comfort of a vibration given by its spectral lines, exactly.

        a_w² = ½ Σ |W(f_k) a_k|²,   a(t) = Re Σ a_k exp(2πi f_k t)

    frequency      Hz, (l,), not negative
    acceleration   complex amplitudes (peak, not RMS) along x, y, z, m/s², (l, 3)
    up             direction in which the occupant sits upright, (3,); inertial z unless given

    Lines of one frequency, as wheels of one speed make them, are added with their phases before they are squared. Raises
    ``SpheredriveError`` for shapes and numbers that make no spectrum. Source: ISO 2631-1:1997, 6.1, 6.5 and 8.2.
    """
    frequency, acceleration = merged_lines(*checked_lines(frequency, acceleration))
    level, upright = (_mean_products(name, frequency, acceleration) for name in ("Wd", "Wk"))
    return comfort(level, upright, up)


def weighted_rms(name: str, frequency, acceleration) -> np.ndarray:
    """RMS along x, y and z of a line spectrum under one weighting, m/s², (3,); arguments as in ``comfort_of_lines``."""
    frequency, acceleration = merged_lines(*checked_lines(frequency, acceleration))
    return np.sqrt(np.diag(_mean_products(name, frequency, acceleration)))


def _mean_products(name: str, frequency: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    weighted = weighting(name, frequency)[:, None] * acceleration
    return (weighted.T @ weighted.conj()).real / 2


def comfort(level: np.ndarray, upright: np.ndarray, up=UPRIGHT) -> Comfort:
    """Comfort from the mean products ⟨a aᵀ⟩ (3, 3) of the acceleration under Wd, D, and under Wk, K.

    Both horizontal axes have one weighting, so a_v² = tr D + ûᵀ (K − D) û: its largest value is at an eigenvector.
    """
    up = upward(up)
    excess = upright - level
    values, directions = np.linalg.eigh(excess)
    worst = directions[:, 2] * (1 if directions[np.argmax(np.abs(directions[:, 2])), 2] > 0 else -1)
    total = _root(np.trace(level) + up @ excess @ up)
    worst_total = _root(np.trace(level) + values[2])
    horizontal, vertical = _root(np.trace(level) - up @ level @ up), _root(up @ upright @ up)
    return Comfort(up, horizontal, vertical, total, comfort_words(total), worst, worst_total, comfort_words(worst_total))


def _root(square) -> float:
    # Differences of squares may fall below zero by rounding.
    return math.sqrt(max(float(square), 0.0))


def upward(up) -> np.ndarray:
    """The unit vector along ``up``, (3,)."""
    up = np.asarray(up, float)
    if up.shape != (3,) or not np.isfinite(up).all() or not up.any():
        raise SpheredriveError("the occupant's upright direction takes three finite numbers that are not all zero")
    return up / np.linalg.norm(up)
