"""The seat: where the sphere rests on its contacts, its mounts and its closure at given wheel angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.design import GRAVITY
from spheredrive.errors import SpheredriveError
from spheredrive.export.mjcf.model import linear_contact

if TYPE_CHECKING:
    from spheredrive.design import Design

# Contacts up to this far off (m, times the sphere's radius) are looked at.
REACH = 0.5
ROUNDS = 60
# A stiffness matrix of a larger condition number holds nothing.
FIRM = 1e10


def settle(mujoco, design: Design, model, data) -> None:
    """Put the sphere of ``data`` and its mounts where all forces balance, at the wheel angles that stand in it.

        sphere   F + Σ N n̂ − Σ K′ ĉ ĉᵀ c = 0,   mount i   −Σ N n̂·n̂ᵢ − k Δᵢ = 0,   N = K · penetration

    Newton's method. While those that touch do not hold the sphere, the nearest roller of every hub pulls as well, so that the
    way to the contacts is seen. Raises ``SpheredriveError`` where nothing holds it.
    """
    free = model.joint("sphere").qposadr[0]
    slides = _slides(model)
    places = [model.jnt_qposadr[j] for j, _ in slides.values()]
    margin = model.pair_margin.copy()
    model.pair_margin[:] = REACH * design.sphere.radius
    origin = data.qpos[free : free + 3].copy()
    unknown = np.zeros(3 + len(slides))
    try:
        for _ in range(ROUNDS):
            data.qpos[free : free + 3] = origin + unknown[:3]
            data.qpos[places] = unknown[3:]
            mujoco.mj_fwdPosition(model, data)
            change = _change(design, model, data, unknown, slides)
            unknown += change
            if np.abs(change).max() < 1e-12:
                break
    finally:
        model.pair_margin[:] = margin
    mujoco.mj_forward(model, data)


def _change(design: Design, model, data, unknown, slides: dict[int, tuple[int, int]]) -> np.ndarray:
    """Newton's step of the displacements of the sphere and the mounts."""
    K, k = linear_contact(design).stiffness or 0.0, design.mount.stiffness or 0.0
    load, springs = _load(design)
    pressed, near = _near(model, data)
    for contacts in (pressed, near):
        rest, stiffness = np.zeros(len(unknown)), np.zeros((len(unknown), len(unknown)))
        rest[:3], stiffness[:3, :3] = load - springs @ unknown[:3], springs
        if slides:
            rest[3:], stiffness[3:, 3:] = -k * unknown[3:], k * np.eye(len(slides))
        for penetration, normal, hub in contacts:
            row = np.zeros(len(unknown))
            row[:3] = normal
            if hub in slides:
                j, place = slides[hub]
                row[3 + place] = -normal @ data.xaxis[j]
            rest += K * penetration * row
            stiffness += K * np.outer(row, row)
        if np.linalg.cond(stiffness) < FIRM:
            return np.linalg.solve(stiffness, rest)
    raise SpheredriveError("the contacts do not hold the sphere in every direction, so it has no seat to start from")


def _load(design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Weight and closure force (N, (3,)) and the stiffness of the closure's springs (N/m, (3, 3))."""
    weight = GRAVITY * (design.sphere.mass or 0.0) if design.stage.gravity else 0.0
    closure = design.closure
    lines = [(n_hat, closure.stiffness) for n_hat in design.contact_directions]
    lines += [(np.array(spring.direction), spring.stiffness) for spring in closure.springs]
    return np.array(closure.force) - [0, 0, weight], sum((s * np.outer(c, c) for c, s in lines), np.zeros((3, 3)))


def _slides(model) -> dict[int, tuple[int, int]]:
    """Joint and number of each mount, by the body of its hub."""
    joints = [j for j in range(model.njnt) if model.joint(j).name.startswith("mount_")]
    return {int(model.jnt_bodyid[j]): (j, place) for place, j in enumerate(joints)}


def _near(model, data) -> tuple[list, list]:
    """Penetration, normal on the sphere and hub of every contact that is pressed, and of those and every hub's nearest."""
    sphere = model.geom("sphere").id
    found: dict[int, list] = {}
    for contact in data.contact:
        first, second = contact.geom
        roller, sign = (first, 1.0) if second == sphere else (second, -1.0)
        hub = int(model.body_parentid[model.geom_bodyid[roller]])
        found.setdefault(hub, []).append((-contact.dist, sign * contact.frame[:3].copy(), hub))
    pressed = [one for near in found.values() for one in near if one[0] > 0]
    nearest = [max(near, key=lambda one: one[0]) for near in found.values()]
    return pressed, pressed + [one for one in nearest if one[0] <= 0]
