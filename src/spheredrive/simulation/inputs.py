"""What drives a simulation, as straight pieces between breakpoints: every corner of an input is the end of a step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spheredrive.dynamics.rolling import ACCELERATION, FORCE, SPHERE_VELOCITY, STILL, TORQUE, WHEEL_SPEED
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion, Series

KINDS = {"wheel-torque": TORQUE, "wheel-speed": WHEEL_SPEED, "sphere-velocity": SPHERE_VELOCITY}
AT_REST = Series((0.0,), ((0.0, 0.0, 0.0),))


class Start(NamedTuple):
    """Position and velocity of the stage at the start, m and m/s, (3,) each, and what is given of it afterwards."""

    stage_kind: int
    position: np.ndarray
    velocity: np.ndarray


def inputs_of(motion: Motion, torque_limit: float | None = None) -> tuple[np.ndarray, Start]:
    """The straight pieces of ``motion`` as rows: begin and end (s), drive there, force (N) or acceleration of the stage there.

    A row holds 2 + 2 c + 6 numbers, c the columns of the drive. Wheel torques beyond ``torque_limit`` (N m) are cut off at
    it, with a corner there. A stage given by its position moves along the cubic spline through it (not-a-knot), so that its
    acceleration is finite and runs straight between the given times.
    """
    drive = _limited(motion.series, torque_limit) if motion.kind == "wheel-torque" and torque_limit else motion.series
    stage, start = _stage(motion)
    knots = {0.0, motion.duration, *drive.time, *stage.time}
    knots = np.array(sorted(t for t in knots if 0.0 <= t <= motion.duration))
    return np.concatenate([knots[:-1, None], knots[1:, None], _ends(drive, knots), _ends(stage, knots)], axis=1), start


def _ends(series: Series, knots) -> np.ndarray:
    """Values at the begin and at the end of every piece between ``knots``, (pieces, 2 c)."""
    if series.interpolation == "linear":
        # Most motions have no other corners than their own.
        values = series.arrays[1] if np.array_equal(series.arrays[0], knots) else series.at(knots)
        return np.concatenate([values[:-1], values[1:]], axis=1)
    return np.hstack([series.at(knots[:-1]), series.at(knots[1:], side="left")])


def _limited(series: Series, limit: float) -> Series:
    """The series cut off at ± limit, with new times where a straight piece crosses it."""
    time, values = series.arrays
    if np.abs(values).max() <= limit:
        return series
    if series.interpolation == "step":
        return Series(series.time, _rows(np.clip(values, -limit, limit)), "step")
    crossings = []
    for bound in (-limit, limit):
        before, after = values[:-1] - bound, values[1:] - bound
        piece, column = np.nonzero(before * after < 0)
        share = before[piece, column] / (before[piece, column] - after[piece, column])
        crossings.append(time[piece] + share * (time[piece + 1] - time[piece]))
    times = np.unique(np.concatenate([time, *crossings]))
    return Series(tuple(times), _rows(np.clip(series.at(times), -limit, limit)))


def _stage(motion: Motion) -> tuple[Series, Start]:
    zero = np.zeros(3)
    if motion.stage is None:
        return AT_REST, Start(STILL, zero, zero)
    series = motion.stage.series
    if motion.stage.kind == "force":
        return series, Start(FORCE, zero, zero)
    position = np.array(series.values)
    if len(position) == 1:
        return AT_REST, Start(ACCELERATION, position[0], zero)
    if series.interpolation == "step":
        raise SpheredriveError("a stage cannot jump: give its position with linear interpolation between more times")
    if series.time[0] > 0 or series.time[-1] < motion.duration:
        raise SpheredriveError(
            f"the stage's position must be given from 0 to the duration of {motion.duration:g} s, not from "
            f"{series.time[0]:g} to {series.time[-1]:g} s"
        )
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(series.time, position)
    acceleration = Series(series.time, _rows(spline(series.time, 2)))
    return acceleration, Start(ACCELERATION, spline(0.0), spline(0.0, 1))


def _rows(values: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, values.tolist()))
