"""A run of the exported model in MuJoCo along a motion, as arrays of the shape of our own runs."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.export.mjcf.barrel import FINE
from spheredrive.export.mjcf.contact import IMPEDANCE
from spheredrive.export.mjcf.drive import Drive, advance, drive_of, start
from spheredrive.export.mjcf.extra import mujoco_module
from spheredrive.export.mjcf.model import added_mass, contact_law, default_timestep, linear_contact, mjcf_spec, rewrite_contacts
from spheredrive.export.mjcf.readings import Readings, readings
from spheredrive.export.mjcf.seat import settle

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

INTEGRATORS = ("implicitfast", "implicit", "Euler", "RK4")


@dataclass(frozen=True)
class Settings:
    """How a run is stepped.

    timestep     longest step, s; None: that of the exported model
    integrator   one of ``INTEGRATORS``
    roller_share of a wheel's mass that its rollers have
    impedance    see ``contact``
    mesh         circles and points around of a barrel's mesh
    """

    timestep: float | None = None
    integrator: str = "implicitfast"
    roller_share: float = 1e-3
    impedance: float = IMPEDANCE
    mesh: tuple[int, int] = FINE


@dataclass(frozen=True, eq=False)
class MujocoRun:
    """A run in MuJoCo, k samples, n wheels, m contacts (wheel by race); SI, inertial frame.

    time                 (k,)
    angular_velocity, centre_displacement, stage_position   (k, 3); the displacement is on the stage, from the nominal centre
    orientation          scalar first, body to inertial, (k, 4)
    wheel_angle, wheel_speed   (k, n)
    normal_force         sum over the rollers of a race, (k, m)
    friction_force       of the wheel on the sphere along the roller axis, (k, m)
    slip_speed           along the roller axis, mean over the rollers of a race that touch, (k, m)
    timestep             the step taken, s
    steps                how many
    added_mass           1/R, the largest mass that MuJoCo's law adds at a contact, kg
    """

    time: np.ndarray
    angular_velocity: np.ndarray
    centre_displacement: np.ndarray
    stage_position: np.ndarray
    orientation: np.ndarray
    wheel_angle: np.ndarray
    wheel_speed: np.ndarray
    normal_force: np.ndarray
    friction_force: np.ndarray
    slip_speed: np.ndarray
    timestep: float
    steps: int
    added_mass: float


class Prepared(NamedTuple):
    """A model on its seat, ready to step."""

    model: Any
    data: Any
    drive: Drive
    readings: Readings


def run_mujoco(design: Design, motion: Motion, settings: Settings | None = None) -> MujocoRun:
    """The run of ``design`` under ``motion`` in MuJoCo, from the seat on which the sphere rests at the first wheel angles.

    Wheels whose speeds are prescribed get them exactly: their hinges carry so much inertia that nothing holds them up, unless
    the design gives the gains of a speed loop, which then drives them. The sphere starts with the slip-free angular velocity
    and a centre at rest. Samples stand at the motion's rate; the step divides it. Raises ``SpheredriveError`` for what the
    model needs, and where MuJoCo gives up.
    """
    mujoco = mujoco_module()
    settings = settings or Settings()
    ready = prepare(design, motion, settings)
    model, data = ready.model, ready.data
    samples = math.floor(motion.duration * motion.sample_rate * (1 + 1e-12) + 1e-9)
    each = round(1 / (motion.sample_rate * model.opt.timestep))
    rows = []
    for sample in range(samples + 1):
        mujoco.mj_forward(model, data)
        rows.append(ready.readings.row(model, data))
        if not np.isfinite(data.qacc).all() or any(w.number for w in data.warning):
            raise SpheredriveError(f"MuJoCo gives up at {data.time:.4g} s of the run; take a shorter time step")
        if sample < samples:
            advance(mujoco, model, data, ready.drive, sample * each, each)
    names = [field.name for field in fields(MujocoRun)][1 : 1 + len(rows[0])]
    return MujocoRun(
        time=np.arange(samples + 1) / motion.sample_rate,
        **{name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)},
        timestep=model.opt.timestep,
        steps=samples * each,
        added_mass=added_mass(model, settings.impedance),
    )


def prepare(design: Design, motion: Motion, settings: Settings | None = None) -> Prepared:
    """The compiled model of ``design`` at the start of ``motion``. Raises as ``run_mujoco``."""
    mujoco = mujoco_module()
    settings = settings or Settings()
    motion.check_wheel_count(design.wheel_count)
    if settings.integrator not in INTEGRATORS:
        raise SpheredriveError(f"MuJoCo has no integrator {settings.integrator!r}; take one of {', '.join(INTEGRATORS)}")
    if not linear_contact(design).stiffness:
        raise SpheredriveError("a run in MuJoCo needs contact.stiffness, so that both engines have the same contacts")
    timestep = dividing_step(motion.sample_rate, settings.timestep or default_timestep(design))
    spec = mjcf_spec(
        design,
        stage="fixed" if motion.stage is None else "free",
        timestep=timestep,
        roller_share=settings.roller_share,
        impedance=settings.impedance,
        mesh=settings.mesh,
    )
    model = spec.compile()
    # The solver's tolerance is relative to the mean inertia, and some are heavy.
    model.opt.tolerance = 1e-20
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{settings.integrator.upper()}")
    drive = drive_of(mujoco, design, motion, model)
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    rewrite_contacts(model, contact_law(design), settings.impedance)
    start(mujoco, design, motion, model, data, drive)
    settle(mujoco, design, model, data)
    return Prepared(model, data, drive, readings(design, model))


def dividing_step(sample_rate: float, longest: float) -> float:
    """The longest step up to ``longest`` (s) that divides the time between samples."""
    return 1 / (sample_rate * max(1, math.ceil(1 / (sample_rate * longest) * (1 - 1e-9))))
