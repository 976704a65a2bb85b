"""The steady motion at constant wheel speeds: peaks, RMS values, harmonics, and the motion itself at any time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import SingularError, SpheredriveError
from spheredrive.vibration.model.system import LinearSystem, linear_system
from spheredrive.vibration.motion.orbit import Orbits, orbits, outputs_at
from spheredrive.vibration.motion.shapes import Shapes, shapes_of, with_rates
from spheredrive.vibration.motion.steady import statistics
from spheredrive.vibration.spectra.spectrum import OrderSpectrum, order_spectrum, shape_harmonics

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.vibration.model.equations import Isolator


class Sizes(NamedTuple):
    """How large a steady motion is: peaks and RMS, m, m/s, m/s²; means (3,), m. RMS displacement is about the mean."""

    peak_displacement: float
    peak_velocity: float
    peak_acceleration: float
    rms_displacement: float
    rms_velocity: float
    rms_acceleration: float
    mean_displacement: np.ndarray


class Instant(NamedTuple):
    """Motion at given times, (..., 3) and forces (..., m); the payload's are None without one."""

    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    contact_force: np.ndarray
    payload_displacement: np.ndarray | None = None
    payload_velocity: np.ndarray | None = None
    payload_acceleration: np.ndarray | None = None


class Impulse(NamedTuple):
    """What a corner of a wheel's shape does to a rigid contact: wheel from 1; its angle, rad; jump of the centre's velocity,
    m/s, (3,); impulse of every contact, N s, (m,)."""

    wheel: int
    angle: float
    velocity_jump: np.ndarray
    contact_impulse: np.ndarray


class LostContact(NamedTuple):
    """A contact that would have to pull: wheel from 1, its least force, N."""

    wheel: int
    least_force: float


# More swings of the machine than this while one roller passes are refused: a number would wait for minutes.
SWINGS = 2e5


@dataclass(frozen=True, eq=False)
class Response:
    """Steady motion of the sphere's centre about the nominal seat of round wheels, at constant wheel speeds.

    system             what was solved
    wheel_speed, wheel_angle   of each wheel, rad/s and rad at t = 0, (n,)
    sphere             peaks, RMS values and mean of the centre
    payload            the same of the payload, or None
    passing_frequency  at which each contact's pattern passes, Hz, (m,)
    force_mean, force_min, force_max   of each contact, N, (m,)
    contact_lost       contacts whose force would turn negative

    Peaks are lengths of vectors. Wheels whose patterns pass in a ratio of whole numbers up to 60 come back together and keep
    the phases given; all others meet in every combination of phases in the long run, and peaks and forces are the extremes over
    all of these. Extremes are followed between sampled places to about 1e-6 of themselves; where three or more wheels meet in
    all phases and ring, there are many tops of nearly one height, and the one found may be a few thousandths short. Where a
    corner makes the acceleration jump both values count; on rigid contacts it is the acceleration off the corners, and
    ``impulses`` has the rest.
    """

    system: LinearSystem
    wheel_speed: np.ndarray
    wheel_angle: np.ndarray
    sphere: Sizes
    payload: Sizes | None
    passing_frequency: np.ndarray
    force_mean: np.ndarray
    force_min: np.ndarray
    force_max: np.ndarray
    contact_lost: tuple[LostContact, ...]
    _orbits: Orbits

    @property
    def peak_displacement(self) -> float:
        """Of the centre from the nominal seat, m."""
        return self.sphere.peak_displacement

    @property
    def peak_velocity(self) -> float:
        """m/s."""
        return self.sphere.peak_velocity

    @property
    def peak_acceleration(self) -> float:
        """m/s²."""
        return self.sphere.peak_acceleration

    @property
    def rms_displacement(self) -> float:
        """About the mean, m."""
        return self.sphere.rms_displacement

    @property
    def rms_velocity(self) -> float:
        """m/s."""
        return self.sphere.rms_velocity

    @property
    def rms_acceleration(self) -> float:
        """m/s²."""
        return self.sphere.rms_acceleration

    def at(self, time) -> Instant:
        """The motion at ``time`` (...), s, exactly; at a corner the values after it."""
        time = np.asarray(time, float)
        if not np.isfinite(time).all():
            raise SpheredriveError("the motion is asked for at finite times")
        out = np.zeros((self.system.system.D0.shape[1], time.size))
        outputs_at(self.system.system, self._orbits, np.ascontiguousarray(time.ravel()), out)
        return instant(self.system, out, time.shape)

    def spectrum(self, count: int = 100, of: str = "sphere") -> OrderSpectrum:
        """Lines of the motion of the "sphere" or the "payload" up to harmonic ``count`` of each contact's shape.

        Not for the thesis's measure, which is no linear answer to the shape alone.
        """
        ls = self.system
        if ls.thesis_measure:
            raise SpheredriveError("the thesis's measure has no spectrum of its own; take the true motion's")
        first = {"sphere": 0, "payload": 9}.get(of)
        if first is None or first >= 3 * ls.triples:
            raise SpheredriveError(f"there is no {of!r} with a spectrum here")
        harmonics = [shape_harmonics(p, count) for p in ls.profiles]
        wheel = ls.contacts.wheel
        return order_spectrum(
            lambda s: ls.transfer(s)[..., first : first + 3, :],
            harmonics,
            np.array([p.period for p in ls.profiles]),
            self.wheel_speed[wheel],
            self.wheel_angle[wheel],
        )

    @cached_property
    def impulses(self) -> tuple[Impulse, ...]:
        """What each corner of each shape does at once: none where contacts give way."""
        found = []
        ls = self.system
        if ls.design.contact.stiffness is not None:
            return ()
        for i, shape in enumerate(ls.profiles):
            n = ls.contacts.wheel[i]
            for angle, jump in zip(shape.breakpoints[:-1], shape.slope_jumps, strict=True):
                # Backwards as forwards, the rate of h rises by |ω| times the jump of its slope.
                rate = abs(self.wheel_speed[n]) * jump
                if rate != 0.0:
                    y = 3 * ls.triples
                    found.append(
                        Impulse(int(n) + 1, float(angle - shape.phase), ls.system.D1[i, 3:6] * rate, ls.system.D2[i, y:] * rate)
                    )
        return tuple(found)


def response(
    design: Design,
    wheel_speed,
    model: str = "coupled",
    wheel_angle=None,
    isolator: Isolator | None = None,
    **options,
) -> Response:
    """The steady motion of the sphere's centre at constant wheel speeds, exactly.

        c(t) = Σ_i c_i(t),   c_i of period P_i/|ω_i|, from the periodic solution of every pole

    wheel_speed   ω, rad/s, (n,), either sign; a wheel that stands holds its shape still
    wheel_angle   ϑ at t = 0, rad, (n,); zero if absent

    Other arguments as ``linear_system`` (``closure_sign``, ``measure``, ``normal_force``, ``profiles``). An undamped machine
    keeps what it starts with for ever; its steady motion is the one with the periods of the wheels alone. Raises
    ``SingularError`` where a harmonic of a wheel hits an undamped natural frequency, ``SpheredriveError`` where the machine
    would ring too often while one roller passes, and what ``linear_system`` raises. Source: model.md section 5b.
    """
    ls = linear_system(design, model, isolator, **options)
    speed, angle = checked_wheels(design, wheel_speed, wheel_angle)
    shapes, per_input = input_shapes(ls, speed)
    _refuse_crawling(ls, speed)
    orbit, hit = orbits(ls.system, shapes, speed[per_input], angle[per_input])
    refuse_resonance(ls, speed, hit)
    degree = shapes.coefficients.shape[2] - 1
    mean, variance, peak, low, high = statistics(ls.system, orbit, degree, ls.triples)
    spread = variance.reshape(-1)[: 3 * ls.triples].reshape(ls.triples, 3)
    centre = mean[: 3 * ls.triples].reshape(ls.triples, 3)
    force = ls.seat_force
    y = 3 * ls.triples
    lost = tuple(LostContact(int(w) + 1, float(f)) for w, f in zip(ls.contacts.wheel, force + low, strict=True) if f < 0)
    return Response(
        system=ls,
        wheel_speed=speed,
        wheel_angle=angle,
        sphere=_sizes(peak[:3], spread[:3], centre[:3]),
        payload=None if ls.isolator is None else _sizes(peak[3:], spread[3:], centre[3:]),
        passing_frequency=np.abs(speed)[ls.contacts.wheel] / np.array([p.period for p in ls.profiles]),
        force_mean=force + mean[y:],
        force_min=force + low,
        force_max=force + high,
        contact_lost=lost,
        _orbits=orbit,
    )


def _sizes(peak, variance, mean) -> Sizes:
    rms = np.sqrt(variance.sum(axis=1) + np.array([0.0, 1.0, 1.0]) * (mean**2).sum(axis=1))
    return Sizes(*map(float, peak), *map(float, rms), mean[0])


def checked_wheels(design: Design, wheel_speed, wheel_angle) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and angles of each wheel as arrays; ``SpheredriveError`` where they do not fit."""
    n = design.wheel_count
    speed = np.asarray(wheel_speed, float)
    angle = np.zeros(n) if wheel_angle is None else np.asarray(wheel_angle, float)
    for name, array in (("wheel_speed", speed), ("wheel_angle", angle)):
        if array.shape != (n,) or not np.isfinite(array).all():
            raise SpheredriveError(f"{name} takes one finite number for each of the {n} wheels")
    return speed, angle


def input_shapes(ls: LinearSystem, speed: np.ndarray) -> tuple[Shapes, np.ndarray]:
    """The inputs' shapes and the wheel of each input; with the thesis's measure also the rates of the shapes."""
    shapes, wheel = shapes_of(ls.profiles), ls.contacts.wheel
    if ls.thesis_measure:
        return with_rates(shapes, speed[wheel]), np.concatenate([wheel, wheel])
    return shapes, wheel


def _refuse_crawling(ls: LinearSystem, speed: np.ndarray) -> None:
    """Raise where the machine would swing too often while one roller passes: each swing has to be followed."""
    periods = np.array([shape.period for shape in ls.profiles])
    turning = np.abs(speed[ls.contacts.wheel]) * [shape.depth > 0 for shape in ls.profiles]
    if not turning.any() or not len(ls.system.lam):
        return
    longest = np.where(turning > 0, periods / np.where(turning > 0, turning, 1.0), 0.0)
    slowest = int(np.argmax(longest))
    with np.errstate(divide="ignore"):
        # What a mode does to a corner has died after some forty of its time constants.
        lasting = np.minimum(longest[slowest], 40 / np.maximum(-ls.system.lam.real, 0.0))
    swinging = np.abs(ls.system.lam.imag) / (2 * math.pi)
    swings = float((swinging * lasting).max())
    if swings > SWINGS:
        raise SpheredriveError(
            f"wheel {ls.contacts.wheel[slowest] + 1} turns so slowly that the machine swings {swings:.2g} times while one of "
            f"its rollers passes, and nothing damps it; a roller has to pass within {SWINGS / swinging.max():.2g} s: give more "
            "speed, or contact.damping"
        )


def refuse_resonance(ls: LinearSystem, speed: np.ndarray, hit) -> None:
    """Raise where ``orbits`` found a pole without a periodic solution."""
    i, r = hit
    if i < 0:
        return
    wheel = int(ls.contacts.wheel[i % len(ls.contacts.wheel)])
    passing = abs(speed[wheel]) / ls.profiles[i % len(ls.profiles)].period
    natural = abs(ls.system.lam[r]) / (2 * math.pi)
    raise SingularError(
        f"at {speed[wheel]:g} rad/s harmonic {round(natural / passing)} of wheel {wheel + 1}, whose rollers pass at "
        f"{passing:.6g} Hz, hits the undamped natural frequency {natural:.6g} Hz: the motion grows without end and has no "
        "steady state; add damping or change the speed"
    )


def instant(ls: LinearSystem, out: np.ndarray, shape) -> Instant:
    """Outputs (y, k) as motion of ``shape``."""
    parts = [out[3 * a : 3 * a + 3].T.reshape(*shape, 3) for a in range(ls.triples)]
    force = (out[3 * ls.triples :] + ls.seat_force[:, None]).T.reshape(*shape, -1)
    return Instant(*parts[:3], force, *parts[3:])
