"""The machine the studies vary, what they ask of it, and the measures they compare it by."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from spheredrive import kinematics, vibration
from spheredrive.design import Design
from spheredrive.dynamics import least_preload_of_run, pressing_direction
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.rolling_run import RollingRun, run_rolling_batch
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.claims.kinematics import ring
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.vibration import Response
from spheredrive.wheels.base import Wheel

# The demonstrator's contact, with the thesis's first damping, so that no resonance hides the trend.
STIFFNESS, DAMPING = 188208.0, 8500.0
# What is asked of every variant: this angular acceleration of the sphere about any axis, rad/s², …
DEMAND = 10.0
# … where any axis stands for these: to and fro along the edges, faces' and corners' diagonals of a cube; …
AXES = np.array([axis for axis in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(axis)])
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)
# … and a steady rotation of this speed about an axis along which no wheel is special, rad/s.
ROTATION = 0.1 * np.array([1.0, 2.0, 3.0]) / np.sqrt(14)


class Study(NamedTuple):
    """A figure, and the sentence that a designer should take from it, made from its numbers."""

    drawing: Drawing
    conclusion: str


def machine(
    wheel: Wheel | None = None, elevation_deg: float = -40.0, count: int = 3, heading_deg: float = 0.0, **sphere
) -> Design:
    """The demonstrator with exact outlines, friction 0.9 and the damping above, one thing changed."""
    design = ring(elevation_deg, wheel or machines.standard_wheel("exact"), count, heading_deg)
    design = replace(design, sphere=replace(design.sphere, **sphere))
    return machines.compliant(design, STIFFNESS, DAMPING)


def least_preload(design: Design, demand: float = DEMAND, stage_force: float = 0.0) -> float:
    """Least force (N) towards the wheels, on top of the weight, for ``demand`` rad/s² about any axis; NaN if none does.

    ``stage_force`` pushes the stage along each axis at the same time, N.
    """
    return largest_preload(design, runs(design, demand, stage_force))


def runs(design: Design, demand: float, stage_force: float = 0.0) -> list[RollingRun]:
    """Short runs with ``demand`` and ``stage_force`` along each of ``AXES``."""
    return run_rolling_batch([design], [ramp(demand * axis, stage_force * axis) for axis in AXES])


def largest_preload(design: Design, moved: list[RollingRun]) -> float:
    """The largest of the least preloads of runs, N; NaN where no force towards the wheels does."""
    # One run of all samples: what a sample needs does not depend on the others.
    fields = ("time", "state", "friction_force", "normal_force")
    joined = replace(moved[0], **{name: np.concatenate([getattr(run, name) for run in moved]) for name in fields})
    try:
        return least_preload_of_run(design, joined, pressing_direction(design)).force
    except SpheredriveError:
        return float("nan")


def ramp(acceleration, force) -> Motion:
    """A short ramp of the sphere's angular velocity from rest; short, so that it says what the acceleration takes."""
    duration = 0.02
    series = Series((0.0, duration), ((0.0, 0.0, 0.0), tuple((acceleration * duration).tolist())))
    push = StageMotion("force", Series((0.0,), (tuple(force.tolist()),), "step"))
    return Motion("sphere-velocity", series, duration, stage=push, sample_rate=250.0)


def shaken(design: Design, rotation: np.ndarray = ROTATION) -> Response:
    """The steady vibration while the sphere turns at ``rotation``."""
    return vibration.response(design, kinematics.inverse(design, rotation))


def quality(design: Design) -> tuple[float, float, float]:
    """ξ from, ξ to (NaN where infinite), isotropy."""
    low, high = kinematics.effectiveness(design)
    return low, high if np.isfinite(high) else float("nan"), kinematics.isotropy(design)
