"""How far two runs of the same motion are apart: means, spread, frequency and ripple over whole common periods."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError

# What is asked of two engines, as shares: of mean Ω, of mean N, of the spread of N, of the ripple of the centre.
LIMITS = {"angular_velocity": 0.002, "normal_force": 0.01, "normal_spread": 0.05, "ripple": 0.02}
# Share of a run that is left out at its start: it still rings from there.
WARM_UP = 0.25
# A contact that carries less than this share of the mean load is not compared by its own size.
IDLE = 1e-3


class Track(NamedTuple):
    """What is compared of a run: time (k,), Ω (k, 3), displacement of the centre (k, 3), N (k, m); SI."""

    time: np.ndarray
    angular_velocity: np.ndarray
    centre_displacement: np.ndarray
    normal_force: np.ndarray


@dataclass(frozen=True)
class Agreement:
    """Differences between run a and run b over a window of whole common periods, as shares of b's amounts.

    begin, end          of the window, s;  samples  in it
    periods             common periods of all wheels in the window; None where they have none and the window is all there is
    angular_velocity    |mean Ω_a − mean Ω_b| / |mean Ω_b|
    normal_force        of the mean N, largest of the contacts
    normal_spread       of the standard deviation of N over time, largest of the contacts
    ripple              of the rms of the centre's displacement about its mean
    ripple_range        of its peak-to-peak value along each wheel's R̂, largest of the wheels
    frequency           the strongest line of the centre's ripple along each wheel's R̂ within a third of its passage frequency,
                        in a and in b, Hz
    passage             n_r ω/2π of each wheel by its mean speed, Hz
    bin_width           1/window, Hz
    values              the amounts themselves, (a, b)
    """

    begin: float
    end: float
    samples: int
    periods: int | None
    angular_velocity: float
    normal_force: float
    normal_spread: float
    ripple: float
    ripple_range: float
    frequency: tuple[tuple[float, float], ...]
    passage: tuple[float, ...]
    bin_width: float
    values: dict[str, tuple]

    @property
    def same_bins(self) -> bool:
        """Whether every wheel's strongest line is in the same bin in both runs."""
        return all(abs(a - b) < 0.5 * self.bin_width for a, b in self.frequency)

    @property
    def agrees(self) -> bool:
        """Whether every difference is within ``LIMITS`` and the lines are in the same bins."""
        return self.same_bins and all(getattr(self, name) <= limit for name, limit in LIMITS.items())

    def as_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {**asdict(self), "same_bins": self.same_bins, "agrees": self.agrees, "limits": dict(LIMITS)}


def common_period(passage, longest: float, slack: float = 1e-3) -> float | None:
    """The shortest time up to ``longest`` (s) that holds a whole number of periods of every frequency ``passage`` (Hz).

    Whole to within ``slack`` of a period; frequencies below 1/longest · slack stand still and do not count. None where there
    is no such time.
    """
    moving = sorted(abs(f) for f in passage if abs(f) * longest > slack)
    if not moving:
        return None
    fastest = moving[-1]
    most = int(longest * fastest * (1 + 1e-9))
    shares = [Fraction(f / fastest).limit_denominator(max(1, min(most, 10_000))) for f in moving]
    turns = math.lcm(*(share.denominator for share in shares))
    period = turns / fastest
    whole = all(abs(f * period - round(f * period)) <= slack for f in moving)
    return period if turns <= most and whole else None


def agreement(a: Track, b: Track, contact_directions, passage, warm_up: float = WARM_UP) -> Agreement:
    """How far run ``a`` is from run ``b``.

    Both have the same times, evenly spaced. ``contact_directions`` R̂ (n, 3); ``passage`` frequencies of the wheels' rollers,
    Hz, (n,). ``warm_up`` is the least share of the run left out at its start. Raises ``SpheredriveError`` for runs that cannot
    be compared.
    """
    if a.time.shape != b.time.shape or not np.allclose(a.time, b.time, rtol=0, atol=1e-9):
        raise SpheredriveError("two runs are compared sample by sample: give both the same duration and sample rate")
    if a.normal_force.shape != b.normal_force.shape:
        raise SpheredriveError("two runs are compared contact by contact, but they have other contacts")
    passage = np.abs(np.asarray(passage, float))
    window, periods = _window(a.time, passage, warm_up)
    one, two = (Track(*(np.asarray(field)[window] for field in run)) for run in (a, b))
    Omega = one.angular_velocity.mean(axis=0), two.angular_velocity.mean(axis=0)
    force = one.normal_force.mean(axis=0), two.normal_force.mean(axis=0)
    spread = one.normal_force.std(axis=0), two.normal_force.std(axis=0)
    about = [run.centre_displacement - run.centre_displacement.mean(axis=0) for run in (one, two)]
    rms = tuple(float(np.sqrt((x**2).sum(axis=1).mean())) for x in about)
    along = [x @ np.asarray(contact_directions).T for x in about]
    reach = tuple(np.ptp(x, axis=0) for x in along)
    dt = float(a.time[1] - a.time[0])
    width = 1 / (dt * len(one.time))
    lines = [_strongest(x, width, passage) for x in along]
    idle = IDLE * max(force[1].max(), 1e-300)
    return Agreement(
        begin=float(one.time[0]),
        end=float(one.time[-1] + dt),
        samples=len(one.time),
        periods=periods,
        angular_velocity=_apart(float(np.linalg.norm(Omega[0] - Omega[1])), float(np.linalg.norm(Omega[1]))),
        normal_force=float(np.max(np.abs(force[0] - force[1]) / np.maximum(force[1], idle))),
        normal_spread=float(np.max(np.abs(spread[0] - spread[1]) / np.maximum(spread[1], idle))),
        ripple=_apart(abs(rms[0] - rms[1]), rms[1]),
        ripple_range=max(map(_apart, np.abs(reach[0] - reach[1]), reach[1])),
        frequency=tuple(zip(*lines, strict=True)),
        passage=tuple(passage.tolist()),
        bin_width=width,
        values={
            "angular_velocity": (Omega[0].tolist(), Omega[1].tolist()),
            "normal_force": (force[0].tolist(), force[1].tolist()),
            "normal_spread": (spread[0].tolist(), spread[1].tolist()),
            "ripple": rms,
            "ripple_range": (reach[0].tolist(), reach[1].tolist()),
        },
    )


def _window(time: np.ndarray, passage: np.ndarray, warm_up: float) -> tuple[slice, int | None]:
    """The samples to take, to the end of the run and without its last one, and the common periods in them."""
    dt = (time[-1] - time[0]) / (len(time) - 1)
    room = (1 - warm_up) * (time[-1] - time[0])
    period = common_period(passage, room)
    if period is None:
        count, periods = max(2, round(room / dt)), None
    else:
        periods = int(room / period * (1 + 1e-9))
        count = round(periods * period / dt)
    return slice(len(time) - 1 - count, len(time) - 1), periods


def _strongest(signals: np.ndarray, width: float, passage: np.ndarray) -> list[float]:
    """Frequency (Hz) of each column's strongest line near its passage frequency; of all its lines where none is near."""
    power = np.abs(np.fft.rfft(signals, axis=0)) ** 2
    frequency = width * np.arange(len(power))
    found = []
    for column, f in zip(power.T, passage, strict=True):
        near = (frequency > 2 / 3 * f) & (frequency < 4 / 3 * f)
        band = np.flatnonzero(near) if near[1:].any() else np.arange(1, len(power))
        found.append(float(frequency[band[column[band].argmax()]]))
    return found


def _apart(difference: float, size: float) -> float:
    """A difference as a share; nothing of nothing is no difference."""
    return 0.0 if difference == 0 else float(difference / max(size, 1e-300))


def agreement_text(found: Agreement, names: tuple[str, str] = ("spheredrive", "MuJoCo")) -> str:
    """The comparison as lines for a terminal."""
    whole = {None: "no common period: the end of the run", 1: "1 common period"}.get(
        found.periods, f"{found.periods} common periods"
    )
    v = found.values
    norm = [float(np.linalg.norm(x)) for x in v["angular_velocity"]]
    rows = [
        ("", *names, "apart", "limit"),
        ("mean |Ω|, rad/s", *(f"{x:.6g}" for x in norm), *_shares(found, "angular_velocity")),
        ("mean N, N", *map(_most, v["normal_force"]), *_shares(found, "normal_force")),
        ("spread of N, N", *map(_most, v["normal_spread"]), *_shares(found, "normal_spread")),
        ("ripple of the centre, rms, µm", *(f"{1e6 * x:.5g}" for x in v["ripple"]), *_shares(found, "ripple")),
        (
            "  along R̂, peak to peak, µm",
            *(_most([1e6 * y for y in x]) for x in v["ripple_range"]),
            _share(found.ripple_range),
            "",
        ),
        ("  passage frequency, Hz", *(_list(x) for x in zip(*found.frequency, strict=True)), _bins(found), "same bin"),
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(5)]
    head = f"Over {found.begin:.4g} to {found.end:.4g} s, {whole}, {found.samples} samples; largest difference of all contacts:"
    lines = [
        "  ".join(cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True)))
        for row in rows
    ]
    verdict = "The two engines agree." if found.agrees else "The two engines do not agree."
    return "\n".join([head, "", *(f"  {line}".rstrip() for line in lines), "", verdict])


def _shares(found: Agreement, name: str) -> tuple[str, str]:
    return _share(getattr(found, name)), _share(LIMITS[name])


def _share(x: float) -> str:
    return f"{100 * x:.2g} %"


def _most(values) -> str:
    return _list(values)


def _list(values) -> str:
    values = list(values)
    shown = ", ".join(f"{x:.4g}" for x in values[:3])
    return shown if len(values) <= 3 else f"{shown}, …"


def _bins(found: Agreement) -> str:
    return "same bin" if found.same_bins else "other bins"
