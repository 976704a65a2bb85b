"""Campbell diagram: roller-passing lines over natural frequencies against speed, and the speeds to keep away from."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError


class Crossing(NamedTuple):
    """Where harmonic ``harmonic`` of the shape of ``wheel`` meets ``mode`` (all numbered from 1).

    speed           of that wheel, rad/s
    frequency       of the mode, Hz
    amplification   centre's displacement over the shape's there, m/m
    severity        shape's amplitude times amplification: the centre's displacement amplitude there, m; infinite undamped
    """

    wheel: int
    harmonic: int
    mode: int
    speed: float
    frequency: float
    amplification: float
    severity: float


class SpeedBand(NamedTuple):
    """Speeds of ``wheel`` (from 1) to avoid, from ``least`` to ``most``, rad/s, and the crossings inside, worst first."""

    wheel: int
    least: float
    most: float
    severity: float
    crossings: tuple[Crossing, ...]


def passing_lines(wheel_speed, period, count: int) -> np.ndarray:
    """Frequencies at which the harmonics of a wheel's shape pass: the rising lines of the Campbell diagram.

        f = k |ω|/P = k n_r |ω|/2π

    wheel_speed   rad/s, (...)
    period        P of the shape, rad, 2π/n_r for n_r equal rollers, (...)
    count         harmonics, from 1

    Returns (..., count), Hz. Source: model.md section 3.
    """
    first = np.abs(np.asarray(wheel_speed, float)) / np.asarray(period, float)
    return first[..., None] * np.arange(1, count + 1)


def resonance(damping_ratio) -> np.ndarray:
    """Largest amplification of one mode, 1/(2ζ√(1 − ζ²)); infinite at ζ = 0, 1 from ζ = 1/√2 on, where nothing stands out."""
    zeta = np.minimum(np.asarray(damping_ratio, float), math.sqrt(0.5))
    with np.errstate(divide="ignore"):
        return 1 / (2 * zeta * np.sqrt(1 - zeta**2))


def resonant_band(damping_ratio: float, limit: float | None = None) -> tuple[float, float] | None:
    """Frequencies over the natural one between which one mode amplifies by more than ``limit``.

        1/√((1 − r²)² + (2ζr)²) ≥ A  ⇔  |r² − (1 − 2ζ²)| ≤ √(1/A² − 4ζ²(1 − ζ²))

    damping_ratio   ζ
    limit           A above 1; left out, the half-power band: A = 1/√2 of the resonance

    Returns (r₁, r₂), or None where the mode never does. An undamped mode has an empty half-power band (1, 1). Source: the
    forced oscillator.
    """
    zeta = float(damping_ratio)
    peak = float(resonance(zeta))
    A = peak / math.sqrt(2) if limit is None else limit
    if zeta >= math.sqrt(0.5) or peak < A:
        return None
    middle, half = 1 - 2 * zeta**2, math.sqrt(max(0.0, 1 / A**2 - 4 * zeta**2 * (1 - zeta**2)))
    # With much damping the half-power band reaches down to standing still.
    return math.sqrt(max(0.0, middle - half)), math.sqrt(middle + half)


def critical_speeds(
    natural_frequency,
    damping_ratio,
    harmonics: Sequence[np.ndarray],
    period,
    transfer: Callable[[np.ndarray], np.ndarray] | None = None,
    largest_speed: float = math.inf,
) -> tuple[Crossing, ...]:
    """Speeds at which a harmonic of a wheel's shape meets a mode, the worst first.

        ω = 2π f_j/(k n_r) = f_j P/k

    natural_frequency   of the modes, Hz, (m,)
    damping_ratio       of the modes, (m,); modes without resonance, ζ ≥ 1/√2, are left out
    harmonics           Fourier coefficients of each wheel's shape, n arrays; see ``spectrum.shape_harmonics``
    period              P of each wheel's shape, rad, (n,) or one for all
    transfer            s (l,) → (l, 3, n), from shape to centre; it knows which wheel moves which mode. Left out, the
                        amplification is that of one mode alone, 1/(2ζ√(1 − ζ²))
    largest_speed       crossings above it are left out, rad/s

    Returns crossings by falling severity. Raises ``SpheredriveError`` for numbers that are no modes. Source: model.md 5b.
    """
    f, zeta = (np.atleast_1d(np.asarray(a, float)) for a in (natural_frequency, damping_ratio))
    if f.shape != zeta.shape or f.ndim != 1 or not (np.isfinite(f) & (f >= 0) & np.isfinite(zeta) & (zeta >= 0)).all():
        raise SpheredriveError("modes take one natural frequency and one damping ratio each, finite and not negative")
    period = np.broadcast_to(np.asarray(period, float), (len(harmonics),))
    gain = np.repeat(resonance(zeta)[:, None], len(harmonics), axis=1)
    if transfer is not None and len(f):
        gain = np.linalg.norm(np.asarray(transfer(2j * np.pi * f)), axis=1)
        gain = np.where(np.isfinite(gain), gain, math.inf)
    found = []
    for j in np.flatnonzero((zeta < math.sqrt(0.5)) & (f > 0)):
        for i, shape in enumerate(harmonics):
            for k in range(1, len(shape)):
                speed, size = f[j] * period[i] / k, 2 * abs(shape[k])
                if speed <= largest_speed and size > 0:
                    severity = size * gain[j, i] if gain[j, i] else 0.0
                    found.append(Crossing(i + 1, k, int(j) + 1, float(speed), float(f[j]), float(gain[j, i]), float(severity)))
    return tuple(sorted(found, key=lambda c: (-c.severity, c.wheel, c.speed)))


def speeds_to_avoid(
    crossings: Sequence[Crossing], damping_ratio, margin: float = 0.05, limit: float | None = None, least_share: float = 0.05
) -> tuple[SpeedBand, ...]:
    """Bands of wheel speed around critical speeds, the worst first; those that overlap are one.

        r₁ (1 − margin) ω … r₂ (1 + margin) ω

    crossings       from ``critical_speeds``
    damping_ratio   of the modes, (m,), as given there
    margin          share by which natural frequencies may be off
    limit           amplification a band must exceed; left out, bands are half-power bands
    least_share     crossings less severe than this share of the worst are passed over: high harmonics would otherwise fill
                    all low speeds. Undamped modes are infinitely severe at every harmonic: none of theirs is passed over

    Returns bands by falling severity, that of their worst crossing. A mode that amplifies less than ``limit`` has none.
    Raises ``SpheredriveError`` for a margin outside 0 to 1,
    a limit that is not above 1 and a share outside 0 to 1.
    """
    if not 0 <= margin < 1 or not (limit is None or limit > 1) or not 0 <= least_share <= 1:
        raise SpheredriveError("speeds to avoid take a margin from 0 up to 1, a limit above 1 and a least share from 0 to 1")
    ratio = [resonant_band(zeta, limit) for zeta in np.atleast_1d(np.asarray(damping_ratio, float))]
    least_severity = least_share * max((crossing.severity for crossing in crossings), default=0.0)
    bands = []
    for crossing in crossings:
        band = ratio[crossing.mode - 1]
        if band is not None and crossing.severity >= least_severity:
            least, most = band[0] * (1 - margin) * crossing.speed, band[1] * (1 + margin) * crossing.speed
            bands.append(SpeedBand(crossing.wheel, least, most, crossing.severity, (crossing,)))
    return tuple(sorted(_merged(bands), key=lambda b: (-b.severity, b.wheel, b.least)))


def _merged(bands: list[SpeedBand]) -> list[SpeedBand]:
    merged: list[SpeedBand] = []
    for band in sorted(bands, key=lambda b: (b.wheel, b.least)):
        if merged and merged[-1].wheel == band.wheel and band.least <= merged[-1].most:
            last = merged.pop()
            inside = tuple(sorted(last.crossings + band.crossings, key=lambda c: -c.severity))
            band = SpeedBand(band.wheel, last.least, max(last.most, band.most), inside[0].severity, inside)
        merged.append(band)
    return merged
