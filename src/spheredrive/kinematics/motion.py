"""Kinematics along a motion: what the sphere does as the races take turns, and what a single-race Jacobian would say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.kinematics.maps import forward, inverse_jacobian
from spheredrive.kinematics.orientation import integrate_orientation
from spheredrive.kinematics.races import forward_by_state, race_error, state_index
from spheredrive.motion import Motion, Series

if TYPE_CHECKING:
    from spheredrive.design import Design

# Changes of race that one run follows; each stands twice in its samples.
MOST_CHANGES = 1_000_000


@dataclass(frozen=True)
class KinematicRun:
    """A motion without slip, k samples; times at which a race changes stand twice, before and after the change.

    time                (k,), s
    wheel_speed         (k, n), rad/s
    wheel_angle         (k, n), rad
    state               entry of each wheel's alternation in contact, (k, n)
    angular_velocity    Ω by the active races, (k, 3), rad/s, inertial frame
    nominal             Ω by the nominal (single-race) Jacobian, (k, 3), rad/s
    orientation         scalar-first quaternions, body to inertial, (k, 4)
    error_angle         between the two Ω, (k,), rad
    error_magnitude     (|Ω| − |Ω_nominal|) / |Ω|, (k,)
    race_changes        times at which any wheel's races changed, (c,), s
    """

    time: np.ndarray
    wheel_speed: np.ndarray
    wheel_angle: np.ndarray
    state: np.ndarray
    angular_velocity: np.ndarray
    nominal: np.ndarray
    orientation: np.ndarray
    error_angle: np.ndarray
    error_magnitude: np.ndarray
    race_changes: np.ndarray


def along(design: Design, motion: Motion) -> KinematicRun:
    """Follow ``motion`` by kinematics alone.

    Wheel speeds are taken as prescribed; a prescribed motion of the sphere is turned into wheel speeds by the nominal
    inverse Jacobian, as a controller would that does not know which race touches. Samples are the motion's own, its
    breakpoints and every change of race, which is found from the wheel angle's whole half pitches. Raises
    ``SpheredriveError`` for a motion of torques, which takes dynamics, and what ``jacobian`` raises.
    """
    motion.check_wheel_count(design.wheel_count)
    speeds = _wheel_speeds(design, motion)
    start = np.zeros(design.wheel_count) if motion.wheel_angle is None else np.array(motion.wheel_angle)
    _refuse_endless_changes(design, speeds, motion.duration)
    turns = [_half_pitch_times(w, speeds, i, start[i], motion.duration) for i, w in enumerate(design.wheels)]
    knots = np.array([t for t in speeds.time if 0 < t < motion.duration])
    count = int(np.floor(motion.duration * motion.sample_rate + 1e-9)) + 1
    grid = np.arange(count) / motion.sample_rate
    edges = np.unique(np.concatenate([[0.0], *turns, knots, [motion.duration]]))
    inner = np.setdiff1d(grid[(grid > 0) & (grid < motion.duration)], edges)
    time = np.sort(np.concatenate([inner, edges, edges[1:-1]]))
    # Of the two samples at an edge the first belongs to what was before, the second to what comes after.
    after = np.concatenate([[True], time[1:] == time[:-1]]) | ~np.isin(time, edges)
    after[-1] = False
    wheel_speed = np.where(after[:, None], speeds.at(time), speeds.at(time, side="left"))
    wheel_angle = start + speeds.integral(time)
    states = _states_between(design, speeds, start, edges)
    state = states[_interval(time, after, edges)]
    changes = edges[1:-1][(states[1:] != states[:-1]).any(axis=1)]
    angular_velocity = forward_by_state(design, wheel_speed, state)
    nominal = forward(design, wheel_speed)
    error = race_error(angular_velocity, nominal)
    orientation = integrate_orientation(time, angular_velocity, motion.orientation)
    return KinematicRun(
        time, wheel_speed, wheel_angle, state, angular_velocity, nominal, orientation, error.angle, error.magnitude, changes
    )


def _wheel_speeds(design: Design, motion: Motion) -> Series:
    if motion.kind == "wheel-speed":
        return motion.series
    if motion.kind == "sphere-velocity":
        values = np.array(motion.series.values) @ inverse_jacobian(design).T
        return Series(motion.series.time, tuple(map(tuple, values)), motion.series.interpolation)
    raise SpheredriveError(
        "a motion given by wheel torques has no kinematics of its own: it takes the dynamics to know its speeds"
    )


def _refuse_endless_changes(design: Design, speeds: Series, duration: float) -> None:
    """Count the changes of race by the way each wheel turns, before any room is made for them."""
    knots = np.unique([0.0, *(t for t in speeds.time if 0 < t < duration), duration])
    # Straight pieces that change sign turn less than this; it is a bound, not the count.
    rate = np.maximum(np.abs(speeds.at(knots[:-1])), np.abs(speeds.at(knots[1:], side="left")))
    way = np.sum(rate * np.diff(knots)[:, None], axis=0)
    changes = float(sum(w / wheel.half_pitch for w, wheel in zip(way, design.wheels, strict=True)))
    if changes > MOST_CHANGES:
        raise SpheredriveError(
            f"the wheels change races up to {changes:.3g} times in {duration:g} s; at most {MOST_CHANGES:,} are followed, so "
            "take a shorter motion"
        )


def _half_pitch_times(wheel, speeds: Series, column: int, start: float, duration: float) -> np.ndarray:
    """Times in (0, duration) at which the wheel has turned through a whole half pitch: roots of a quadratic a piece."""
    pitch = wheel.half_pitch
    if not np.isfinite(pitch):
        return np.zeros(0)
    knots = np.unique([0.0, *(t for t in speeds.time if 0 < t < duration), duration])
    first, last = speeds.at(knots[:-1])[:, column], speeds.at(knots[1:], side="left")[:, column]
    angle = start + wheel.phase_angle + speeds.integral(knots)[:, column]
    # A piece without a turning point that stays strictly between two multiples of the half pitch has nothing to find.
    low, high = np.minimum(angle[:-1], angle[1:]) / pitch - 1e-9, np.maximum(angle[:-1], angle[1:]) / pitch + 1e-9
    busy = np.flatnonzero((np.floor(low) != np.floor(high)) | (first * last < 0))
    found = [knots[i] + _crossings(angle[i], first[i], last[i], knots[i + 1] - knots[i], pitch) for i in busy]
    times = np.concatenate(found) if found else np.zeros(0)
    return times[(times > 0) & (times < duration)]


def _crossings(angle: float, first: float, last: float, span: float, pitch: float) -> np.ndarray:
    """Times in [0, span] at which angle + first t + (last − first) t²/(2 span) is a whole multiple of ``pitch``."""
    slope = (last - first) / span
    # The angle is monotone up to the turning point and after it: on each part the multiples are counted, not searched.
    turn = -first / slope if slope != 0 and 0 < -first / slope < span else None
    times = []
    for begin, end in ((0.0, turn), (turn, span)) if turn is not None else ((0.0, span),):
        a = angle + first * begin + slope * begin**2 / 2
        b = angle + first * end + slope * end**2 / 2
        speed = first + slope * begin
        low, high = sorted((a, b))
        multiples = np.arange(np.ceil(low / pitch - 1e-12), np.floor(high / pitch + 1e-12) + 1) * pitch
        rise = multiples - a
        # Of the quadratic's roots the one that follows its start, in the form that has no cancellation. The start's speed
        # can be the rounding of a turning point: the way to the end tells the direction.
        root = np.sqrt(np.maximum(speed**2 + 2 * slope * rise, 0.0))
        denominator = speed + np.copysign(root, b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(rise == 0, 0.0, 2 * rise / denominator)
        times.append(begin + np.clip(t[np.isfinite(t)], 0.0, end - begin))
    return np.concatenate(times)


def _states_between(design, speeds, start, edges) -> np.ndarray:
    """Contact state of each interval between edges, (e − 1, n), read at its middle.

    At an edge rounding of the wheel angle could count either way, and a wheel that only touches a whole half pitch and
    turns back changes nothing.
    """
    middles = (edges[1:] + edges[:-1]) / 2
    return state_index(design, start + speeds.integral(middles))


def _interval(time, after, edges) -> np.ndarray:
    """Which interval between edges each sample belongs to."""
    interval = np.searchsorted(edges, time, side="right") - 1
    interval = np.where(np.isin(time, edges) & ~after, interval - 1, interval)
    return np.clip(interval, 0, len(edges) - 2)
