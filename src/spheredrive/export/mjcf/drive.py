"""What moves a MuJoCo model along a motion: torques or speeds of its wheels, forces on its stage or its position."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive import kinematics
from spheredrive.errors import SpheredriveError
from spheredrive.simulation.inputs import inputs_of

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

# A coordinate whose motion is prescribed carries this many times its own inertia, so that nothing holds it up.
HEAVY = 1e9


class Drive(NamedTuple):
    """What moves a prepared model: torques or speeds of the wheels, forces or accelerations of the stage.

    pieces      rows of ``inputs_of``;  columns  of the drive
    prescribed  whether wheel speeds are prescribed;  loop  whether speed loops hold them
    wheels, stage  numbers of their degrees of freedom;  motors  of their controls
    inertia     of the wheels and the stage with what is added, kg m² and kg
    """

    pieces: np.ndarray
    columns: int
    prescribed: bool
    loop: bool
    wheels: np.ndarray
    stage: np.ndarray
    motors: tuple[np.ndarray, ...]
    inertia: tuple[np.ndarray, float]


def advance(mujoco, model, data, drive: Drive, first: int, count: int) -> None:
    """``count`` steps from step number ``first`` on; inputs are taken at the middle of each."""
    dt = model.opt.timestep
    if len(drive.pieces) == 1 and (drive.pieces[0, 2 : 2 + drive.columns] == drive.pieces[0, _second(drive)]).all():
        # Nothing changes over the run, so MuJoCo may go on by itself.
        _push(drive, data, dt / 2)
        mujoco.mj_step(model, data, count)
        return
    for k in range(count):
        _push(drive, data, (first + k + 0.5) * dt)
        mujoco.mj_step(model, data)


def _second(drive: Drive) -> slice:
    return slice(2 + drive.columns, 2 + 2 * drive.columns)


def _push(drive: Drive, data, time: float) -> None:
    """Set controls and forces at ``time``."""
    row = drive.pieces[min(np.searchsorted(drive.pieces[:, 0], time, side="right"), len(drive.pieces)) - 1]
    span = row[1] - row[0]
    share = min(max((time - row[0]) / span, 0.0), 1.0)
    first, last = row[2 : 2 + drive.columns], row[_second(drive)]
    now, slope = first + share * (last - first), (last - first) / span
    if drive.prescribed and not drive.loop:
        data.qfrc_applied[drive.wheels] = drive.inertia[0] * slope
    else:
        for motors in drive.motors:
            data.ctrl[motors] = now
    if len(drive.stage):
        at = 2 + 2 * drive.columns
        stage = row[at : at + 3] + share * (row[at + 3 : at + 6] - row[at : at + 3])
        data.qfrc_applied[drive.stage] = stage * drive.inertia[1]


def drive_of(mujoco, design: Design, motion: Motion, model) -> Drive:
    """What is to be pushed; prescribed coordinates of ``model`` are made heavy."""
    pieces, _ = inputs_of(motion, design.motor.torque)
    columns = motion.series.columns
    prescribed = motion.kind != "wheel-torque"
    if motion.kind == "sphere-velocity":
        pieces = _wheel_speed_pieces(design, pieces)
        columns = design.wheel_count
    loop = prescribed and bool(design.motor.proportional_gain or design.motor.integral_gain)
    dofs = np.array([model.joint(f"wheel_{i + 1}").dofadr[0] for i in range(design.wheel_count)])
    own = np.array([wheel.spin_inertia for wheel in design.wheels])
    if prescribed and not loop:
        model.dof_armature[dofs] = HEAVY * own
    stage = np.zeros(0, int)
    carried = 1.0
    if motion.stage is not None:
        stage = np.array([model.joint(f"stage_{axis}").dofadr[0] for axis in "xyz"])
        if motion.stage.kind == "position":
            moved = (design.stage.mass or 0.0) + sum(wheel.mass or 0.0 for wheel in design.wheels)
            model.dof_armature[stage] = HEAVY * moved
            carried = (HEAVY + 1) * moved
    names = [f"motor_{i + 1}" for i in range(design.wheel_count)]
    motors = [np.array([model.actuator(name).id for name in names])]
    if design.motor.integral_gain:
        motors.append(np.array([model.actuator(f"{name}_integral").id for name in names]))
    if motion.kind == "wheel-torque" and (design.motor.proportional_gain or design.motor.integral_gain):
        # The motors are speed loops; torques go past them.
        raise SpheredriveError("wheel torques cannot drive motors that hold a speed; leave the gains out of [motor]")
    return Drive(pieces, columns, prescribed, loop, dofs, stage, tuple(motors), ((HEAVY + 1) * own, carried))


def _wheel_speed_pieces(design: Design, pieces: np.ndarray) -> np.ndarray:
    """Pieces of prescribed sphere velocity as those of the slip-free wheel speeds, which run straight as well."""
    speeds = [kinematics.inverse(design, pieces[:, k : k + 3]) for k in (2, 5)]
    return np.hstack([pieces[:, :2], *speeds, pieces[:, 8:]])


def start(mujoco, design: Design, motion: Motion, model, data, drive: Drive) -> None:
    """Angles, speeds and orientation at the start."""
    angle = motion.wheel_angle or np.zeros(design.wheel_count)
    if drive.prescribed:
        speed = drive.pieces[0, 2 : 2 + drive.columns]
        Omega = kinematics.forward(design, speed)
    else:
        Omega = np.array(motion.angular_velocity or (0.0, 0.0, 0.0))
        speed = kinematics.inverse(design, Omega)
    for i in range(design.wheel_count):
        for name in (f"wheel_{i + 1}", f"wheel_{i + 1}_far"):
            if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0:
                data.joint(name).qpos[0], data.joint(name).qvel[0] = angle[i], speed[i]
    free = data.joint("sphere")
    q = np.array(motion.orientation) / np.linalg.norm(motion.orientation)
    free.qpos[3:] = q
    _, start = inputs_of(motion)
    for k, dof in enumerate(drive.stage):
        data.qpos[model.dof_jntid[dof]] = start.position[k]
        data.qvel[dof] = start.velocity[k]
    if len(drive.stage):
        free.qpos[:3], free.qvel[:3] = start.position, start.velocity
    # MuJoCo counts a free body's angular velocity in the body's own frame.
    turned = np.zeros(3)
    mujoco.mju_rotVecQuat(turned, Omega, np.array([q[0], *-q[1:]]))
    free.qvel[3:] = turned
