"""The motion over time for any history of wheel speeds, exactly, in blocks of bounded size."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError, did_you_mean
from spheredrive.motion import Motion, Series
from spheredrive.values import checked_number
from spheredrive.vibration.model.equations import contacts_of
from spheredrive.vibration.model.modal import output_vectors
from spheredrive.vibration.model.system import LinearSystem, linear_system
from spheredrive.vibration.motion.history import locate, march
from spheredrive.vibration.motion.orbit import orbits, steady_states
from spheredrive.vibration.motion.response import (
    Instant,
    LostContact,
    Sizes,
    checked_wheels,
    input_shapes,
    instant,
    refuse_resonance,
)

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.vibration.model.equations import Isolator

STARTS = ("rest", "steady")
# Samples a block holds unless another number is asked for.
BLOCK = 65_536
# More samples than this in one array are refused: ask for blocks.
MOST = 20_000_000


@dataclass(frozen=True, eq=False)
class Transient:
    """Motion of the sphere's centre at k times; m contacts.

    time            s, (k,)
    displacement    from the nominal seat of round wheels, m, (k, 3)
    velocity, acceleration   m/s and m/s², (k, 3)
    contact_force   N, (k, m)
    contact_lost    (k, m), where the force would be negative
    payload         its ``displacement``, ``velocity`` and ``acceleration`` (k, 3) each, or None
    """

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    contact_force: np.ndarray
    contact_lost: np.ndarray
    payload: tuple[np.ndarray, np.ndarray, np.ndarray] | None

    @property
    def first_loss(self) -> tuple[int, float] | None:
        """Contact from 1 and time (s) of the first sample at which a contact is lost, or None."""
        rows, columns = np.nonzero(self.contact_lost)
        return None if not len(rows) else (int(columns[0]) + 1, float(self.time[rows[0]]))


def transient(
    design: Design,
    wheel_speed,
    duration: float | None = None,
    sample_rate: float | None = None,
    start: str = "rest",
    model: str = "coupled",
    wheel_angle=None,
    isolator: Isolator | None = None,
    **options,
) -> Transient:
    """The motion of the sphere's centre from t = 0 on, exact at every sample.

    wheel_speed   constant speeds (n,), rad/s; a ``Series`` of speeds; or a ``Motion`` of kind "wheel-speed"
    duration      s; a motion's own if absent
    sample_rate   Hz; a motion's own, else 1000
    start         "rest": on the seat, c = 0 and ċ = 0 in every coordinate that may differ from the shapes; "steady": already
                  in the steady motion of the first speeds
    wheel_angle   ϑ at t = 0, rad, (n,); a motion's own, else zero

    Other arguments as ``linear_system``. Speeds run straight or in steps between their times. Raises ``SpheredriveError`` for
    arguments that do not fit, and for more than 2e7 samples, which ``transient_blocks`` gives piece by piece; and what
    ``linear_system`` and, at a steady start, ``response`` raise. Source: model.md section 5b.
    """
    run = _Run.of(design, wheel_speed, duration, sample_rate, start, model, wheel_angle, isolator, options)
    if run.samples > MOST:
        raise SpheredriveError(f"{run.samples} samples are more than one array should hold; use transient_blocks")
    return next(run.blocks(run.samples))


def transient_blocks(
    design: Design,
    wheel_speed,
    duration: float | None = None,
    sample_rate: float | None = None,
    start: str = "rest",
    model: str = "coupled",
    wheel_angle=None,
    isolator: Isolator | None = None,
    *,
    block: int = BLOCK,
    **options,
) -> Iterator[Transient]:
    """``transient`` in consecutive blocks of at most ``block`` samples: memory does not grow with the duration."""
    if isinstance(block, bool) or not hasattr(block, "__index__") or block < 1:
        raise SpheredriveError(f"a block holds a whole number of samples from 1 up, not {block!r}")
    return _Run.of(design, wheel_speed, duration, sample_rate, start, model, wheel_angle, isolator, options).blocks(int(block))


@dataclass(frozen=True, eq=False)
class TransientStatistics:
    """Peaks, RMS values and least forces over the samples of a run: ``sphere`` and ``payload`` as in ``Response``.

    force_min, force_max   N, (m,)
    contact_lost           wheels whose contact would be lost, with their least force
    first_loss             contact from 1 and time, s, of the first such sample, or None
    """

    sphere: Sizes
    payload: Sizes | None
    force_min: np.ndarray
    force_max: np.ndarray
    contact_lost: tuple[LostContact, ...]
    first_loss: tuple[int, float] | None


def transient_statistics(design: Design, wheel_speed, *args, **options) -> TransientStatistics:
    """Peaks and RMS values over a transient of any length, nothing stored; arguments as ``transient_blocks``."""
    total = None
    count, first = 0, None
    for part in transient_blocks(design, wheel_speed, *args, **options):
        vectors = [part.displacement, part.velocity, part.acceleration, *(part.payload or ())]
        sums = np.stack([v.sum(axis=0) for v in vectors])
        squares = np.stack([(v**2).sum(axis=0) for v in vectors])
        peaks = np.array([np.sqrt((v**2).sum(axis=1).max()) for v in vectors])
        low, high = part.contact_force.min(axis=0), part.contact_force.max(axis=0)
        first = first or part.first_loss
        count += len(part.time)
        if total is None:
            total = [sums, squares, peaks, low, high]
            continue
        join = (np.add, np.add, np.maximum, np.minimum, np.maximum)
        new = (sums, squares, peaks, low, high)
        total = [both(old, one) for both, old, one in zip(join, total, new, strict=True)]
    assert total is not None
    sums, squares, peaks, low, high = total
    mean = sums / count
    about = np.tile([1.0, 0.0, 0.0], len(mean) // 3)[:, None]
    rms = np.sqrt(np.maximum(squares / count - about * mean**2, 0.0).sum(axis=1))
    sizes = [Sizes(*map(float, peaks[k : k + 3]), *map(float, rms[k : k + 3]), mean[k]) for k in range(0, len(mean), 3)]
    wheel = contacts_of(design).wheel
    lost = tuple(LostContact(int(w) + 1, float(f)) for w, f in zip(wheel, low, strict=True) if f < 0)
    return TransientStatistics(sizes[0], sizes[1] if len(sizes) > 1 else None, low, high, lost, first)


@dataclass(frozen=True, eq=False)
class _Run:
    """A transient that is ready to march."""

    system: LinearSystem
    shapes: object
    wheel: np.ndarray
    knots: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    start: np.ndarray
    rate: float
    samples: int

    @classmethod
    def of(cls, design, wheel_speed, duration, sample_rate, start, model, wheel_angle, isolator, options) -> _Run:
        if start not in STARTS:
            raise SpheredriveError(f"there is no start {start!r}{did_you_mean(str(start), STARTS)}")
        series, duration, rate, wheel_angle = _asked(design, wheel_speed, duration, sample_rate, wheel_angle)
        ls = linear_system(design, model, isolator, **options)
        first = series.at(0.0)
        _, angle = checked_wheels(design, first, wheel_angle)
        if ls.thesis_measure and len(series.time) > 1:
            raise SpheredriveError("the thesis's measure is for constant wheel speeds")
        shapes, wheel = input_shapes(ls, first)
        knots, angles, speeds, accelerations = _steady_pieces(series, duration, angle)
        if start == "steady":
            _, hit = orbits(ls.system, shapes, first[wheel], angle[wheel])
            refuse_resonance(ls, first, hit)
            w = steady_states(ls.system, shapes, first[wheel], angle[wheel])
        else:
            w = _at_rest(ls, shapes, wheel, angle, first)
        samples = math.floor(duration * rate * (1 + 1e-12)) + 1
        return cls(ls, shapes, wheel, knots, angles, speeds, accelerations, w, rate, samples)

    def blocks(self, size: int) -> Iterator[Transient]:
        """The samples in blocks of at most ``size``."""
        place = np.array([locate(self.shapes, i, self.angle[0, n]) for i, n in enumerate(self.wheel)])
        w, clock = self.start.copy(), np.zeros(1)
        rows = self.system.system.D0.shape[1]
        for begin in range(0, self.samples, size):
            time = np.arange(begin, min(begin + size, self.samples)) / self.rate
            out = np.empty((rows, len(time)))
            march(
                self.system.system, self.shapes, self.wheel, self.knots, self.angle, self.speed, self.acceleration,
                place, w, clock, time, out,
            )  # fmt: skip
            yield _transient(time, instant(self.system, out, (len(time),)))


def _transient(time: np.ndarray, motion: Instant) -> Transient:
    payload = None if motion.payload_displacement is None else tuple(motion[4:])
    return Transient(time, *motion[:4], motion.contact_force < 0, payload)  # type: ignore[arg-type]


def _asked(design: Design, wheel_speed, duration, sample_rate, wheel_angle):
    """Speeds as a series, duration, rate and angles, a motion's own where it has them."""
    if isinstance(wheel_speed, Motion):
        motion = wheel_speed
        if motion.kind != "wheel-speed":
            raise SpheredriveError(f'a transient takes a motion of kind "wheel-speed", not "{motion.kind}"')
        motion.check_wheel_count(design.wheel_count)
        series = motion.series
        duration = motion.duration if duration is None else duration
        sample_rate = motion.sample_rate if sample_rate is None else sample_rate
        wheel_angle = motion.wheel_angle if wheel_angle is None else wheel_angle
    elif isinstance(wheel_speed, Series):
        series = wheel_speed
    else:
        speed, _ = checked_wheels(design, wheel_speed, None)
        series = Series((0.0,), (tuple(speed.tolist()),))
    if series.columns != design.wheel_count:
        raise SpheredriveError(f"the speeds have {series.columns} columns, but the design has {design.wheel_count} wheels")
    if duration is None:
        raise SpheredriveError("a transient needs a duration, s")
    rate = checked_number(1000.0 if sample_rate is None else sample_rate, "Hz", "positive", ("sample_rate",))
    return series, checked_number(duration, "s", "non-negative", ("duration",)), rate, wheel_angle


def _steady_pieces(series: Series, duration: float, angle: np.ndarray):
    """Knots between which every speed runs straight and keeps its sign, with angle, speed and acceleration at each."""
    knots = [0.0, duration, *(t for t in series.time if 0.0 < t < duration)]
    time, values = series.arrays
    if series.interpolation == "linear":
        for column in values.T:
            turns = np.flatnonzero(column[:-1] * column[1:] < 0)
            share = column[turns] / (column[turns] - column[turns + 1])
            knots += [t for t in time[turns] + share * np.diff(time)[turns] if 0.0 < t < duration]
    knots = np.unique(knots)
    if len(knots) == 1:
        knots = np.array([knots[0], knots[0] + 1.0])
    begin, span = knots[:-1], np.diff(knots)[:, None]
    speed, after = series.at(begin), series.at(knots[1:], side="left")
    acceleration = (after - speed) / span if series.interpolation == "linear" else np.zeros_like(speed)
    # At a turning point the speed is zero, not the rounding of a difference.
    reach = np.abs(acceleration) * span
    speed = np.where(np.abs(speed) <= 1e-13 * reach, 0.0, speed)
    return knots, angle + series.integral(begin), speed, acceleration


def _at_rest(ls: LinearSystem, shapes, wheel, angle, speed) -> np.ndarray:
    """States with q = 0 and q̇ = 0 in the free coordinates, the wheels at ``angle``."""
    lam, link, V, static, at_once = ls.modal
    if not len(lam):
        return np.zeros(0, complex)
    m = len(ls.profiles)
    h = np.array([p.height(angle[n]) for p, n in zip(ls.profiles, ls.contacts.wheel, strict=True)])
    rate = np.array([p.slope(angle[n]) * speed[n] for p, n in zip(ls.profiles, ls.contacts.wheel, strict=True)])
    if ls.thesis_measure:
        # The deflection itself is at rest: shape and rate together stand for the seat that moves away.
        h, rate = np.concatenate([h, rate]), np.zeros(2 * m)
    Vq, _ = output_vectors(lam, link, V)
    scale = np.abs(lam).max()
    position, velocity = -(static + at_once) @ h, -at_once @ rate / scale
    real = lam.imag == 0
    A = np.block([[Vq.real, -Vq.imag[:, ~real]], [V.real / scale, -V.imag[:, ~real] / scale]])
    width = np.linalg.norm(A, axis=0)
    wanted, solution = np.concatenate([position, velocity]), np.zeros(len(width))
    # Twice more on what is left: the states of a stiff machine are large and nearly cancel.
    inverse = np.linalg.pinv(A / width, rcond=1e-14) if link.any() else np.linalg.inv(A / width)
    for _ in range(3):
        solution += inverse @ (wanted - A @ solution) / width
    w = solution[: len(lam)].astype(complex)
    w[~real] += 1j * solution[len(lam) :]
    return w
