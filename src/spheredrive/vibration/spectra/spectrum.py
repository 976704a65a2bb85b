"""Order spectrum: the lines that each wheel's shape puts on the motion of the sphere's centre."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.vibration.spectra.lines import merged_lines

if TYPE_CHECKING:
    from spheredrive.shape import Profile

# Numbers worked on at a time, so that many harmonics of a wheel with many pieces need no more memory than a few.
BLOCK = 1_000_000


def shape_harmonics(profile: Profile, count: int) -> np.ndarray:
    """Fourier coefficients of a wheel's shape, exact for its polynomial pieces.

        H_k = 1/P ∫₀ᴾ h(ϑ) exp(−2πi k ϑ/P) dϑ,   h(ϑ) = H_0 + 2 Re Σ_{k≥1} H_k exp(2πi k ϑ/P)

    profile   shape of the wheel, ``shape.Profile``: period P, pieces, phase
    count     highest harmonic; with n_r rollers harmonic k is order k n_r of the wheel's turn

    Returns H_0 … H_count, (count + 1,), complex, m. At corners of the shape they fall with 1/k², by |slope jump| P/(2πk)² each.
    Raises ``SpheredriveError`` for a count that is no whole number from 0 up. Source: integration piece by piece,
    model.md section 3.
    """
    if isinstance(count, bool) or not hasattr(count, "__index__") or count < 0:
        raise SpheredriveError(f"the number of harmonics is a whole number from 0 up, not {count!r}")
    edges, P = profile.breakpoints, profile.period
    width, start = np.diff(edges) / P, (edges[:-1] - profile.phase) / P
    harmonic = np.arange(int(count) + 1)
    result = np.empty(len(harmonic), complex)
    step = max(1, BLOCK // len(width))
    for first in range(0, len(harmonic), step):
        turns = harmonic[first : first + step, None]
        pieces = _moment_sum(profile.coefficients, 2 * np.pi * turns * width)
        # Whole turns are taken off before the angle is multiplied by 2π: high harmonics keep their phase.
        result[first : first + step] = (pieces * np.exp(-2j * np.pi * np.mod(turns * start, 1)) * width).sum(axis=1)
    return result


def _moment_sum(coefficients: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Σ_m a_m ∫₀¹ uᵐ exp(−iκu) du for pieces (p, d+1) and angles κ (k, p): (k, p).

    By parts, κ I_m = i (exp(−iκ) − m I_{m−1}): upward this shrinks errors while m < κ, downward while m > κ.
    """
    degree = coefficients.shape[1] - 1
    large = angle > degree + 1
    end = np.exp(-1j * angle)
    over = np.where(large, angle, 1.0)
    moment = 1j * (end - 1) / over
    upward = coefficients[:, 0] * moment
    for m in range(1, degree + 1):
        moment = 1j * (end - m * moment) / over
        upward = upward + coefficients[:, m] * moment
    # Started from nothing this far above, the error has shrunk by κ/m at every step down to the degree: below 1e-20.
    angle = np.where(large, 0.0, angle)
    moment, downward = np.zeros_like(end), np.zeros_like(end)
    for m in range(2 * degree + 40, 0, -1):
        moment = (end + 1j * angle * moment) / m
        if m <= degree + 1:
            downward = downward + coefficients[:, m - 1] * moment
    return np.where(large, upward, downward)


@dataclass(frozen=True)
class OrderSpectrum:
    """Lines of the centre's motion, c(t) = Re Σ displacement exp(2πi frequency t) about its mean; l lines.

    wheel          number of the wheel that makes the line, from 1, (l,)
    harmonic       of that wheel's shape, from 1, (l,)
    order          multiples of that wheel's turn, frequency/(|ω|/2π), (l,)
    frequency      Hz, (l,)
    displacement   complex amplitude along x, y, z, m, (l, 3)
    """

    wheel: np.ndarray
    harmonic: np.ndarray
    order: np.ndarray
    frequency: np.ndarray
    displacement: np.ndarray

    @property
    def velocity(self) -> np.ndarray:
        """Complex amplitude of the centre's velocity, m/s, (l, 3)."""
        return 2j * np.pi * self.frequency[:, None] * self.displacement

    @property
    def acceleration(self) -> np.ndarray:
        """Complex amplitude of the centre's acceleration, m/s², (l, 3)."""
        return -((2 * np.pi * self.frequency[:, None]) ** 2) * self.displacement

    def of_wheel(self, number: int) -> OrderSpectrum:
        """The lines of one wheel, counted from 1."""
        own = self.wheel == number
        return OrderSpectrum(
            *(field[own] for field in (self.wheel, self.harmonic, self.order, self.frequency, self.displacement))
        )

    def combined(self) -> tuple[np.ndarray, np.ndarray]:
        """Frequency (m,), Hz, rising, and displacement (m, 3) of all wheels together, equal frequencies added with phase."""
        return merged_lines(self.frequency, self.displacement)


def order_spectrum(
    transfer: Callable[[np.ndarray], np.ndarray],
    harmonics: Sequence[np.ndarray],
    period,
    wheel_speed,
    wheel_angle=0.0,
) -> OrderSpectrum:
    """Lines of the steady motion of the centre at constant wheel speeds, ordered by wheel and harmonic.

        c(t) = Re Σ_i Σ_k 2 Y_i(2πi f) H_ik exp(2πi k ϑ_i(t)/P_i),   ϑ_i = ϑ_i0 + ω_i t,   f = k |ω_i|/P_i

    transfer      s (l,), 1/s → (l, 3, n): from the shape of each wheel to the centre's displacement, m/m
    harmonics     Fourier coefficients of each wheel's shape, n arrays of any length; see ``shape_harmonics``
    period        P of each wheel's shape, rad, (n,)
    wheel_speed   ω, rad/s, (n,), either sign; a wheel that stands makes no line
    wheel_angle   ϑ at t = 0, rad, (n,) or one for all

    Returns ``OrderSpectrum``; the mean (k = 0) is left out. Raises ``SpheredriveError`` where the numbers of wheels differ or
    numbers are not finite. Source: model.md section 5b.
    """
    count = len(harmonics)
    period, speed, angle = (
        np.broadcast_to(np.asarray(a, float), (count,)) for a in (period, _each(wheel_speed, count), wheel_angle)
    )
    if not (np.isfinite(speed).all() and np.isfinite(angle).all() and np.isfinite(period).all() and (period > 0).all()):
        raise SpheredriveError("an order spectrum takes finite wheel speeds and angles and periods above zero")
    turning = [i for i in range(count) if speed[i]]
    wheel = np.concatenate([np.full(len(harmonics[i]) - 1, i) for i in turning] or [[]]).astype(int)
    harmonic = np.concatenate([np.arange(1, len(harmonics[i])) for i in turning] or [[]]).astype(int)
    shape = np.concatenate([np.asarray(harmonics[i])[1:] for i in turning] or [[]]).astype(complex)
    # Backwards the same shape passes in reverse: as seen at a positive frequency, its conjugate.
    shape = shape * np.exp(2j * np.pi * np.mod(harmonic * (angle / period)[wheel], 1))
    shape = np.where(speed[wheel] > 0, shape, shape.conj())
    frequency = harmonic * np.abs(speed[wheel]) / period[wheel]
    response = np.asarray(transfer(2j * np.pi * frequency), complex).reshape(len(wheel), 3, count)
    own = np.take_along_axis(response, wheel[:, None, None], axis=2)[..., 0]
    order = harmonic * 2 * np.pi / period[wheel]
    return OrderSpectrum(wheel + 1, harmonic, order, frequency, 2 * own * shape[:, None])


def _each(wheel_speed, count: int) -> np.ndarray:
    speed = np.asarray(wheel_speed, float)
    if speed.shape != (count,):
        raise SpheredriveError(f"an order spectrum takes one speed for each of its {count} wheels, not an array {speed.shape}")
    return speed
