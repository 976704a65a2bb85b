"""What a MuJoCo model looks like: nothing of it touches or weighs anything."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.export.mjcf.bodies import Hub

if TYPE_CHECKING:
    from spheredrive.design import Design

# Colour of the points that forces act on.
UNSEEN = (0.0, 0.0, 0.0, 0.0)


def add_hub_disc(mujoco, body, hub: Hub) -> None:
    """A disc inside the rollers, for the eye: it touches nothing and weighs nothing."""
    reach = min(np.hypot(*place.position[:2]) - float(place.body.radius(0.0)) for place in hub.rollers)
    thick = max(abs(place.position[2]) for place in hub.rollers) + 0.3 * float(hub.rollers[0].body.radius(0.0))
    geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[max(reach, 1e-4), thick, 0], material="hub")
    geom.contype = geom.conaffinity = 0


def add_looks(mujoco, spec, design: Design) -> None:
    """Light, colours and a camera; the sphere is checked, so that one sees it turn, and clear, so that one sees the wheels."""
    R = design.sphere.radius
    spec.stat.center, spec.stat.extent = [0, 0, 0], 2 * R
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.35] * 3, [0.55] * 3
    spec.visual.quality.numslices, spec.visual.quality.numstacks = 96, 48
    spec.visual.map.znear = 0.002
    kinds, looks = mujoco.mjtTexture, mujoco.mjtBuiltin
    sky = dict(builtin=looks.mjBUILTIN_GRADIENT, rgb1=[0.93, 0.95, 0.97], rgb2=[0.72, 0.78, 0.85], width=64, height=384)
    spec.add_texture(name="sky", type=kinds.mjTEXTURE_SKYBOX, **sky)
    squares = dict(builtin=looks.mjBUILTIN_CHECKER, rgb1=[0.55, 0.66, 0.80], rgb2=[0.85, 0.90, 0.95], width=256, height=1536)
    spec.add_texture(name="squares", type=kinds.mjTEXTURE_CUBE, **squares)
    sphere = spec.add_material(name="sphere", rgba=[1, 1, 1, 0.45], texrepeat=[2, 2])
    sphere.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "squares"
    spec.add_material(name="hub", rgba=[0.25, 0.27, 0.30, 1])
    spec.add_material(name="roller", rgba=[0.85, 0.45, 0.20, 1], specular=0.3)
    light = spec.worldbody.add_light(name="light", pos=[2 * R, -3 * R, 5 * R], dir=[-0.35, 0.5, -0.8])
    light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    spec.worldbody.add_camera(name="machine", pos=[2.1 * R, -2.1 * R, 0.2 * R], xyaxes=[1, 1, 0, -0.05, 0.05, 1])
