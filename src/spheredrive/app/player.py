"""What turns, by the clock: wheels at constant speeds, or a run that was worked out before."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.errors import NearSingularWarning, SpheredriveError
from spheredrive.frames import quaternion_exponential, quaternion_product
from spheredrive.scene.track import Track, touching_at

# Wheels turn by no more than this between two looks at which race touches, rad.
STEP = 0.05
_STEPS = 40


@dataclass(frozen=True, eq=False)
class Turning:
    """Wheels that turn at constant speeds, at an instant: wheel angles (n,), rad, and the sphere's orientation (4,)."""

    wheel_angle: np.ndarray
    orientation: np.ndarray

    @classmethod
    def at_rest(cls, design: Design) -> Turning:
        """As a design is drawn: all wheels at angle zero, the sphere upright."""
        return cls(np.zeros(design.wheel_count), np.array([1.0, 0.0, 0.0, 0.0]))


def angular_velocity_now(design: Design, wheel_speed: np.ndarray, wheel_angle: np.ndarray) -> np.ndarray:
    """Ω with the races that touch at ``wheel_angle``, (3,), rad/s; zero where the wheels do not determine it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NearSingularWarning)
        try:
            return kinematics.forward(design, wheel_speed, kinematics.active_races(design, wheel_angle))
        except SpheredriveError:
            return np.zeros(3)


def advanced(design: Design, turning: Turning, wheel_speed: np.ndarray, time: float) -> Turning:
    """``turning`` after ``time`` s at wheel speeds ω (n,), rad/s, in steps that see the races change."""
    largest = float(np.abs(wheel_speed).max()) * abs(time)
    count = int(np.clip(np.ceil(largest / STEP), 1, _STEPS))
    for _ in range(count):
        middle = turning.wheel_angle + wheel_speed * time / count / 2
        turn = quaternion_exponential(angular_velocity_now(design, wheel_speed, middle) * time / count)
        orientation = quaternion_product(turn, turning.orientation)
        orientation = orientation / np.linalg.norm(orientation)
        turning = replace(turning, wheel_angle=turning.wheel_angle + wheel_speed * time / count, orientation=orientation)
    return turning


def instant(design: Design, turning: Turning, wheel_speed: np.ndarray) -> Track:
    """A track of the one sample that ``turning`` is."""
    still = np.zeros((1, 3))
    return Track(
        np.zeros(1),
        turning.orientation[None],
        angular_velocity_now(design, wheel_speed, turning.wheel_angle)[None],
        turning.wheel_angle[None],
        np.asarray(wheel_speed, float)[None],
        touching_at(design, turning.wheel_angle)[None],
        still,
        still,
    )


@dataclass(frozen=True)
class Playback:
    """Where a run stands on the page.

    time     in the run, s
    playing  whether the clock moves it
    rate     seconds of the run a second; negative backwards
    gain     how many times the displacement of the sphere's centre is drawn
    """

    time: float
    playing: bool = False
    rate: float = 1.0
    gain: float = 1.0

    def after(self, passed: float, track: Track) -> Playback:
        """The same a while later; at its end a run begins anew."""
        if not self.playing:
            return self
        first, last = float(track.time[0]), float(track.time[-1])
        time = self.time + passed * self.rate
        return replace(self, time=first if time > last else time)

    def stepped(self, by: int, track: Track) -> Playback:
        """Paused, ``by`` samples on, no further than the run's ends."""
        i = int(np.clip(track.index(self.time) + by, 0, len(track.time) - 1))
        return replace(self, time=float(track.time[i]), playing=False)
