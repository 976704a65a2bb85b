"""What a run of the rolling model says in a few numbers, for each machine along the study's motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Metric
from spheredrive.studies.sweep.metrics.base import Conditions, Family, Found, Machines, one_by_one

if TYPE_CHECKING:
    from spheredrive.motion import Motion
    from spheredrive.simulation.overview import Overview

_TAKES: dict[Metric, Callable[[Any], float]] = {
    Metric("motor_torque", "N m", "largest torque of a motor along the motion", ("motion",)): lambda p: p.torque,
    Metric("motor_torque_rms", "N m", "largest RMS torque of a motor along the motion", ("motion",)): lambda p: p.rms_torque,
    Metric("motor_power", "W", "largest power of a motor along the motion", ("motion",)): lambda p: p.power,
    Metric("motor_speed", "rad/s", "largest wheel speed along the motion", ("motion",)): lambda p: p.speed,
    Metric("friction_force", "N", "largest friction force along the motion", ("motion",)): lambda p: p.largest_friction,
}
METRICS = (
    *_TAKES,
    Metric("normal_force_min", "N", "least normal force of a contact along the motion", ("motion",)),
    Metric("angular_velocity", "rad/s", "largest angular velocity of the sphere along the motion", ("motion",)),
    Metric("race_changes", "", "how often a wheel changes its race along the motion", ("motion",)),
    Metric("energy_residual", "J", "largest residual of the energy ledger along the motion", ("motion",)),
)
# Runs of one call: no more than are worked out side by side, so that no threads are started inside of a worker.
RUNS_AT_ONCE = 8


def measure(machines: Machines, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    """The metrics ``names`` of a batch."""
    assert conditions.motion is not None, "the study file was checked"
    return from_runs(machines, conditions.motion, names)


def from_runs(machines: Machines, motion: Motion, names: tuple[str, ...]) -> dict[str, Found]:
    """Metrics of runs along ``motion``, for every family that takes them."""
    if "runs" not in machines.memory:
        machines.memory["runs"] = _numbers(machines, motion)
    runs = machines.memory["runs"]
    return {name: one_by_one(len(runs), lambda i, name=name: _picked(runs[i], name)) for name in names}


def _picked(run: dict[str, Any] | SpheredriveError, name: str) -> float:
    if isinstance(run, SpheredriveError):
        raise run
    value = run[name]
    if isinstance(value, str):
        raise SpheredriveError(value)
    return value


def _numbers(machines: Machines, motion: Motion) -> list[dict[str, Any] | SpheredriveError]:
    """All metrics of each run, a sentence in place of what a run does not tell; or why there is no run."""
    from spheredrive.simulation.rolling_run import run_rolling_batch

    designs = list(machines.designs or ())
    found: list[dict[str, Any] | SpheredriveError] = []
    for first in range(0, len(designs), RUNS_AT_ONCE):
        some = designs[first : first + RUNS_AT_ONCE]
        try:
            runs = run_rolling_batch(some, [motion])
            found += [_of_run(*pair) for pair in zip(some, runs, strict=True)]
        except SpheredriveError:
            # One of them is at fault: each by itself, so that the others have their numbers.
            found += [_alone(design, motion) for design in some]
    return found


def _alone(design, motion: Motion) -> dict[str, Any] | SpheredriveError:
    from spheredrive.simulation.rolling_run import run_rolling

    try:
        return _of_run(design, run_rolling(design, motion))
    except SpheredriveError as error:
        return error


def _of_run(design, run) -> dict[str, Any] | SpheredriveError:
    from spheredrive.simulation.overview import overview

    if not run.completed:
        return SpheredriveError(run.reason)
    o: Overview = overview(design, run)
    assert o.loads is not None, "a run that was completed has samples"
    unknown = "the contacts lie in a plane or are fewer than three: normal forces alone cannot hold the sphere"
    numbers: dict[str, Any] = {metric.name: max(map(take, o.loads.peaks)) for metric, take in _TAKES.items()}
    numbers["normal_force_min"] = o.least_normal.least_normal if o.loads.normals_known else unknown
    numbers["normal_force_max"] = float(run.normal_force.max()) if o.loads.normals_known else unknown
    numbers["angular_velocity"], numbers["race_changes"], numbers["energy_residual"] = o.turn, float(o.race_changes), o.residual
    numbers["preload"] = o.preload if isinstance(o.preload, str) else o.preload.force
    worst = o.worst_utilisation
    if worst is None:
        numbers["friction_utilisation"] = unknown if design.contact.friction else "needs contact.friction above zero"
    else:
        used = float(worst.utilisation)
        numbers["friction_utilisation"] = used if np.isfinite(used) else "a contact that carries friction is not pressed"
    return numbers


FAMILY = Family(METRICS, measure, lambda conditions, names: True, lambda conditions, names: RUNS_AT_ONCE * 4)
