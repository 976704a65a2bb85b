"""The bodies of a MuJoCo model: stage, hubs on their mounts, rollers on hinges, sphere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.export.mjcf.barrel import barrel_points
from spheredrive.export.mjcf.bodies import Hub, Inertia, RollerPlace
from spheredrive.export.mjcf.looks import UNSEEN, add_hub_disc

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.shape import Roller


def add_stage(mujoco, spec, design: Design, stage: str):
    body = spec.worldbody.add_body(name="stage")
    body.add_site(name="stage", rgba=UNSEEN)
    if stage == "free":
        for axis, direction in zip("xyz", np.eye(3), strict=True):
            body.add_joint(name=f"stage_{axis}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=direction)
        # The gantry carries the machine's weight.
        body.gravcomp = 1
        _set_inertia(body, Inertia(design.stage.mass or 0.0, (1.0, 1.0, 1.0)))
    return body


def _set_inertia(body, inertia: Inertia, position=(0.0, 0.0, 0.0)) -> None:
    body.explicitinertial = True
    # Without a place the masses are not written to the file.
    body.ipos = position
    body.mass, body.inertia = inertia.mass, inertia.moments


def hub_name(hub: Hub) -> str:
    """``wheel_1``, and ``wheel_1_far`` for the half of a split wheel at the other side."""
    return f"wheel_{hub.wheel + 1}" + ("_far" if hub.antipodal else "")


def add_hub(mujoco, carrier, design: Design, hub: Hub, barrels: dict[Roller, str]) -> None:
    name = hub_name(hub)
    body = carrier.add_body(name=name, pos=hub.position, quat=_quaternion(mujoco, hub.frame.T))
    body.gravcomp = 1
    mount = design.mount
    if mount.stiffness is not None:
        # n̂ is x of the wheel's frame.
        slide = body.add_joint(name=name.replace("wheel", "mount"), type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
        slide.stiffness[0], slide.damping[0] = mount.stiffness, mount.damping
    hinge = body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    motor = design.motor
    if motor.torque is not None and not hub.antipodal:
        hinge.actfrclimited, hinge.actfrcrange = True, [-motor.torque, motor.torque]
    _set_inertia(body, hub.inertia)
    add_hub_disc(mujoco, body, hub)
    for name, place in zip(roller_names(hub), hub.rollers, strict=True):
        _add_roller(mujoco, body, hub, place, name, barrels)


def roller_names(hub: Hub) -> list[str]:
    """``wheel_1_roller_1.1``, wheel, race and number, for each roller of a hub."""
    per_race = sum(place.race == hub.rollers[0].race for place in hub.rollers)
    return [f"{hub_name(hub)}_roller_{place.race}.{k % per_race + 1}" for k, place in enumerate(hub.rollers)]


def _add_roller(mujoco, parent, hub: Hub, place: RollerPlace, name: str, barrels: dict[Roller, str]) -> None:
    body = parent.add_body(name=name, pos=place.position, quat=_along(mujoco, place.axis))
    body.gravcomp = 1
    hinge = body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    hinge.damping[0] = hub.roller_drag
    _set_inertia(body, hub.roller_inertia)
    kinds = mujoco.mjtGeom
    ρ, L = float(place.body.radius(0.0)), place.body.half_length
    geom = body.add_geom(name=name, contype=0, conaffinity=0, material="roller")
    if place.body in barrels:
        geom.type, geom.meshname = kinds.mjGEOM_MESH, barrels[place.body]
    elif L == 0:
        geom.type, geom.size = kinds.mjGEOM_SPHERE, [ρ, 0, 0]
    else:
        geom.type, geom.size = kinds.mjGEOM_CAPSULE if place.body.rounded else kinds.mjGEOM_CYLINDER, [ρ, L, 0]


def add_meshes(spec, bodies: tuple[Hub, ...], mesh: tuple[int, int]) -> dict[Roller, str]:
    """The mesh of each kind of roller that is neither a ball nor straight."""
    kinds = dict.fromkeys(place.body for hub in bodies for place in hub.rollers)
    curved = [body for body in kinds if body.half_length and (body.barrel_radius or not body.symmetric)]
    names = {body: f"barrel_{i}" for i, body in enumerate(curved, 1)}
    for body, name in names.items():
        spec.add_mesh(name=name).uservert = barrel_points(body, *mesh).ravel()
    return names


def add_sphere(mujoco, spec, design: Design) -> None:
    sphere = design.sphere
    body = spec.worldbody.add_body(name="sphere")
    body.add_freejoint(name="sphere")
    body.add_site(name="centre", rgba=UNSEEN)
    offset = np.array(sphere.centre_of_mass)
    # The design's tensor is about the geometric centre, MuJoCo's about the centre of mass.
    assert sphere.mass is not None and sphere.inertia_tensor is not None  # the spec has asked
    tensor = sphere.inertia_tensor - sphere.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    body.explicitinertial, body.mass, body.ipos = True, sphere.mass, offset
    moments, axes = np.linalg.eigh(tensor)
    if np.allclose(tensor, np.diag(np.diag(tensor)), rtol=0, atol=1e-15 * moments[2]):
        moments, axes = np.diag(tensor), np.eye(3)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    body.inertia, body.iquat = moments, _quaternion(mujoco, axes)
    geom = body.add_geom(name="sphere", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[sphere.radius, 0, 0])
    geom.contype = geom.conaffinity = 0
    geom.material = "sphere"


def _quaternion(mujoco, matrix) -> np.ndarray:
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(matrix, float).ravel())
    return found


def _along(mujoco, axis) -> np.ndarray:
    """A turn that takes z to ``axis``."""
    found = np.zeros(4)
    mujoco.mju_quatZ2Vec(found, np.asarray(axis, float))
    return found
