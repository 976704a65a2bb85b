"""What is read off a MuJoCo state: positions, speeds and the forces of each race, in our names and signs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.export.mjcf.bodies import hubs
from spheredrive.export.mjcf.extra import mujoco_module
from spheredrive.export.mjcf.parts import hub_name, roller_names
from spheredrive.simulation.labels import contact_numbers

if TYPE_CHECKING:
    from spheredrive.design import Design


@dataclass(frozen=True, eq=False)
class Readings:
    """Where in MuJoCo's arrays a machine's numbers are; see ``readings``.

    sphere      number of the sphere's geom
    hub         body that carries each geom's roller, −1 for geoms that are none
    contact     contact (wheel by race) of each geom;  contacts  how many there are
    wheel_qpos, wheel_dof   places of the wheels in qpos and qvel
    stage       its body
    free_qpos, free_dof     places of the sphere's free joint
    """

    mujoco: Any
    sphere: int
    hub: np.ndarray
    contact: np.ndarray
    contacts: int
    wheel_qpos: np.ndarray
    wheel_dof: np.ndarray
    stage: int
    free_qpos: int
    free_dof: int

    def row(self, model, data) -> tuple[np.ndarray, ...]:
        """Ω, centre, stage, orientation, angles and speeds of the wheels, normal and friction forces, slip speeds."""
        q, v = self.free_qpos, self.free_dof
        stage = data.xpos[self.stage].copy()
        centre, orientation = data.qpos[q : q + 3], data.qpos[q + 3 : q + 7].copy()
        Omega = np.zeros(3)
        self.mujoco.mju_rotVecQuat(Omega, data.qvel[v + 3 : v + 6], orientation)
        motion = (Omega, centre - stage, stage, orientation, data.qpos[self.wheel_qpos], data.qvel[self.wheel_dof])
        return (*motion, *self._forces(model, data, centre, data.qvel[v : v + 3], Omega))

    def _forces(self, model, data, centre, velocity, Omega) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        normal, friction, slip, touching = (np.zeros(self.contacts) for _ in range(4))
        force, surface = np.zeros(6), np.zeros(6)
        kind = self.mujoco.mjtObj.mjOBJ_BODY
        for k in range(data.ncon):
            contact = data.contact[k]
            if contact.efc_address < 0:
                continue
            # The force is that on the second geom, in axes that start with the normal from the first to the second.
            first, second = contact.geom
            roller, sign = (first, 1.0) if second == self.sphere else (second, -1.0)
            self.mujoco.mj_contactForce(model, data, k, force)
            axes = contact.frame.reshape(3, 3)
            on_sphere = sign * axes.T @ force[:3]
            j = self.contact[roller]
            axis = data.geom_xmat[roller].reshape(3, 3) @ self._axis(model, roller)
            u = axis - (axis @ axes[0]) * axes[0]
            u /= np.linalg.norm(u)
            self.mujoco.mj_objectVelocity(model, data, kind, self.hub[roller], surface, 0)
            of_wheel = surface[3:] + np.cross(surface[:3], contact.pos - data.xpos[self.hub[roller]])
            of_sphere = velocity + np.cross(Omega, contact.pos - centre)
            normal[j] += force[0]
            friction[j] += on_sphere @ u
            slip[j] += u @ (of_sphere - of_wheel)
            touching[j] += 1
        return normal, friction, slip / np.maximum(touching, 1)

    def _axis(self, model, geom: int) -> np.ndarray:
        """The roller's axis in its geom's frame: a mesh is turned when it is compiled."""
        axis = np.zeros(3)
        q = model.geom_quat[geom]
        self.mujoco.mju_rotVecQuat(axis, np.array([0.0, 0.0, 1.0]), np.array([q[0], *-q[1:]]))
        return axis


def readings(design: Design, model: Any) -> Readings:
    """``Readings`` of a compiled model of ``design``."""
    mujoco = mujoco_module()
    numbers = contact_numbers(design)
    hub, contact = np.full(model.ngeom, -1), np.full(model.ngeom, -1)
    for one in hubs(design):
        body = model.body(hub_name(one)).id
        for name, place in zip(roller_names(one), one.rollers, strict=True):
            geom = model.geom(name).id
            hub[geom], contact[geom] = body, numbers.index((one.wheel + 1, place.race))
    wheels = [model.joint(f"wheel_{i + 1}") for i in range(design.wheel_count)]
    free = model.joint("sphere")
    return Readings(
        mujoco,
        model.geom("sphere").id,
        hub,
        contact,
        len(numbers),
        np.array([joint.qposadr[0] for joint in wheels]),
        np.array([joint.dofadr[0] for joint in wheels]),
        model.body("stage").id,
        int(free.qposadr[0]),
        int(free.dofadr[0]),
    )
