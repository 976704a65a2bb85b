"""MuJoCo on the exported machine, timed: its largest step within 2 % of its own limit, and the time a second of it takes.

    python benchmarks/mujoco_engine.py

Only MuJoCo's own loop in C is timed: no forces are read, nothing is sampled, controls are constant.
"""

import math
from typing import NamedTuple

from spheredrive.design import Contact, Design, Placement, Sphere
from spheredrive.export.mjcf.run import INTEGRATORS, Settings, prepare
from spheredrive.export.mjcf.steps import largest_step
from spheredrive.motion import Motion, Series
from spheredrive.wheels import StandardWheel
from timing import best

SPEED = (0.6, 0.9, 0.3)


class MujocoTime(NamedTuple):
    """What MuJoCo takes for one run: seconds, its step (s), steps, and how many times real time it ran."""

    seconds: float
    timestep: float
    steps: int
    real_time_factor: float


def machine(rollers: int = 14) -> Design:
    """A sphere of 2.44 m on three wheels of ball rollers."""
    section = 0.9 * 0.0758 * math.sin(math.pi / rollers) / (1 + math.sin(math.pi / rollers))
    wheel = StandardWheel(radius=0.0758, rollers=rollers, roller_radius=section, roller_shape="sphere", mass=0.25)
    places = [Placement.at(wheel, 2 * math.pi * i / 3, math.radians(-40)) for i in range(3)]
    return Design("benchmark", Sphere(1.22, 5.0), tuple(places), Contact(188208.0, 200.0, 0.9))


def motion(duration: float = 1.5, sample_rate: float = 250.0) -> Motion:
    """Constant wheel speeds."""
    return Motion("wheel-speed", Series((0.0,), (SPEED,)), duration=duration, sample_rate=sample_rate)


def mujoco_time(design: Design, motion: Motion, settings: Settings, repeat: int = 3) -> MujocoTime:
    """The time of ``motion`` (constant inputs) in MuJoCo's own loop; the start is put back between runs."""
    import mujoco
    import numpy as np

    ready = prepare(design, motion, settings)
    model, data = ready.model, ready.data
    steps = round(motion.duration / model.opt.timestep)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION)
    start = np.zeros(size)
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_INTEGRATION)

    def once():
        mujoco.mj_setState(model, data, start, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_step(model, data, steps)

    seconds = best(once, repeat)
    return MujocoTime(seconds, model.opt.timestep, steps, motion.duration / seconds)


def fastest_within(design: Design, motion: Motion, within: float = 0.02, by: str = "samples") -> dict[str, MujocoTime]:
    """The time with the largest step ``within`` its own limit, by integrator; ``by`` as for ``largest_step``."""
    found = {}
    for integrator in INTEGRATORS:
        settings = Settings(integrator=integrator)
        step = largest_step(design, motion, within, settings, by).largest
        found[integrator] = mujoco_time(design, motion, Settings(timestep=step, integrator=integrator))
    return found


def main() -> None:
    design, asked = machine(), motion()
    for by in ("samples", "statistics"):
        print(f"within 2 % of its own limit by {by}:")
        for name, time in fastest_within(design, asked, by=by).items():
            took = 1e3 * time.seconds / asked.duration
            factor = f"{time.real_time_factor:8.1f} times real time"
            print(f"  {name:12s}  step {1e6 * time.timestep:7.1f} µs  {took:8.1f} ms a second  {factor}")


if __name__ == "__main__":
    main()
