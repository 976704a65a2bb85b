"""The "perfect world" of Fig 3.3–3.5: round wheels, everything rigid, steps of force and torque."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from spheredrive.design import Design
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.simulation.rolling_run import RollingRun, run_rolling
from spheredrive.studies.reproduce import assumptions, machines

FORCE = (0.1, 0.2, 0.3)
TORQUE = (0.1, 0.2, 0.3)


def motion(duration: float = assumptions.PERFECT_DURATION.value) -> Motion:
    """Steps of P and T at t = 0 from rest."""
    force = StageMotion("force", Series((0.0,), (FORCE,), "step"))
    return Motion("wheel-torque", Series((0.0,), (TORQUE,), "step"), duration, stage=force, sample_rate=50.0)


def design() -> Design:
    """The orthogonal benchmark without weight."""
    return machines.weightless(machines.orthogonal())


@lru_cache
def run() -> RollingRun:
    """The motion."""
    return run_rolling(design(), motion())


@lru_cache
def run_with_offset() -> RollingRun:
    """The same with the sphere's centre of mass beside its middle."""
    machine = design()
    sphere = replace(machine.sphere, centre_of_mass=(assumptions.OFFSET.value, 0.0, 0.0))
    return run_rolling(replace(machine, sphere=sphere), motion())


@lru_cache
def run_with_heavy_offset() -> RollingRun:
    """The same under gravity."""
    machine = replace(
        machines.orthogonal(), sphere=replace(design().sphere, centre_of_mass=(assumptions.OFFSET.value, 0.0, 0.0))
    )
    return run_rolling(machine, motion())
