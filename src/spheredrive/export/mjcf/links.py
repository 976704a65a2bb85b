"""What joins and drives the bodies of a MuJoCo model: closure, gantry, split wheels, motors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.design import GRAVITY
from spheredrive.export.mjcf.bodies import Hub
from spheredrive.export.mjcf.looks import UNSEEN
from spheredrive.export.mjcf.parts import hub_name

if TYPE_CHECKING:
    from spheredrive.design import Design


def couple_split_wheels(mujoco, spec, bodies: tuple[Hub, ...]) -> None:
    for hub in bodies:
        if hub.antipodal:
            equality = spec.add_equality(name=hub_name(hub), type=mujoco.mjtEq.mjEQ_JOINT)
            equality.name1, equality.name2 = hub_name(hub), f"wheel_{hub.wheel + 1}"
            equality.data[:5] = [0, 1, 0, 0, 0]


def add_closure(mujoco, spec, design: Design, stage: str) -> None:
    """The constant force and the springs, between the sphere's centre and the stage: a force b₀ + b₁ x + b₂ ẋ along a line."""
    closure = design.closure
    size = float(np.linalg.norm(closure.force))
    lines = []
    if size:
        lines.append(("closure_force", np.array(closure.force) / size, (size, 0.0, 0.0)))
    if closure.stiffness or closure.damping:
        pads = enumerate(-design.contact_directions, 1)
        lines += [(f"pad_{i}", n_hat, (0.0, -closure.stiffness, -closure.damping)) for i, n_hat in pads]
    for j, spring in enumerate(closure.springs, 1):
        lines.append((f"closure_spring_{j}", np.array(spring.direction), (0.0, -spring.stiffness, -spring.damping)))
    if stage == "free" and design.stage.gravity:
        # The gantry carries the sphere's weight as well, which the contacts hand on to the stage.
        weight = GRAVITY * (design.sphere.mass or 0.0)
        _add_line(mujoco, spec, "gantry", "stage", "world", np.array([0.0, 0.0, 1.0]), (weight, 0.0, 0.0))
        spec.worldbody.add_site(name="world", rgba=UNSEEN)
    for name, direction, bias in lines:
        _add_line(mujoco, spec, name, "centre", "stage", direction, bias)


def _add_line(mujoco, spec, name: str, site: str, refsite: str, direction, bias) -> None:
    line = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_SITE, target=site, refsite=refsite)
    line.gear = [*direction, 0, 0, 0]
    line.gaintype, line.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    line.gainprm[0], line.biasprm[:3] = 0.0, bias
    line.ctrllimited, line.ctrlrange = True, [-1, 1]


def add_motors(mujoco, spec, design: Design) -> None:
    """A motor a wheel: its control is the torque, or the wheel's speed where the design gives the gains of a speed loop."""
    motor = design.motor
    gains = motor.proportional_gain or motor.integral_gain
    for i in range(1, design.wheel_count + 1):
        act = spec.add_actuator(name=f"motor_{i}", trntype=mujoco.mjtTrn.mjTRN_JOINT, target=f"wheel_{i}")
        if not gains:
            act.set_to_motor()
            limit = motor.torque
        else:
            act.set_to_velocity(motor.proportional_gain or 0.0)
            limit = motor.speed
        if limit is not None:
            act.ctrllimited, act.ctrlrange = True, [-limit, limit]
        if motor.integral_gain:
            hold = spec.add_actuator(name=f"motor_{i}_integral", trntype=mujoco.mjtTrn.mjTRN_JOINT, target=f"wheel_{i}")
            hold.set_to_intvelocity(motor.integral_gain, kv=0.0)
