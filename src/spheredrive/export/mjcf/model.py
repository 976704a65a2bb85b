"""A design as a MuJoCo model: stage, hubs on their mounts, rollers on hinges, the sphere, what holds it and what drives it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.contact import wheel_hertz
from spheredrive.design import GRAVITY, Contact
from spheredrive.errors import SpheredriveError
from spheredrive.export.mjcf.barrel import AROUND, CIRCLES
from spheredrive.export.mjcf.bodies import ROLLER_SHARE, Hub, hubs
from spheredrive.export.mjcf.contact import IMPEDANCE, LEAST_FRICTION, ContactLaw, Written, written
from spheredrive.export.mjcf.extra import mujoco_module
from spheredrive.export.mjcf.links import add_closure, add_motors, couple_split_wheels
from spheredrive.export.mjcf.looks import add_looks
from spheredrive.export.mjcf.parts import add_hub, add_meshes, add_sphere, add_stage, roller_names

if TYPE_CHECKING:
    from spheredrive.design import Design

# Step of the exported model over the period of the sphere on its contacts.
STEPS_A_PERIOD = 300


def mjcf_spec(
    design: Design,
    *,
    stage: str = "fixed",
    timestep: float | None = None,
    roller_share: float = ROLLER_SHARE,
    impedance: float = IMPEDANCE,
    mesh: tuple[int, int] = (CIRCLES, AROUND),
) -> Any:
    """``design`` as an ``mujoco.MjSpec``, ready to compile.

    stage         "fixed", or "free" to slide along x, y and z, its weight carried
    timestep      s; by default 1/300 of the period of the sphere on its contacts
    roller_share  of a wheel's mass that its rollers have
    impedance     see ``contact``
    mesh          circles and points around of a barrel's mesh

    Names: bodies ``stage``, ``sphere``, ``wheel_1`` (``wheel_1_far`` for the half of a split wheel at the other side),
    ``wheel_1_roller_1.1`` (race.number) with a joint and a geom of the same name; joints ``wheel_1``, ``mount_1``; motors
    ``motor_1``. Raises ``SpheredriveError`` for what a model needs and the design lacks; it says which key.
    """
    mujoco = mujoco_module()
    _require(design, stage)
    spec = mujoco.MjSpec()
    spec.modelname = design.name or "spheredrive"
    _set_options(mujoco, spec, design)
    carrier = add_stage(mujoco, spec, design, stage)
    bodies = hubs(design, roller_share)
    barrels = add_meshes(spec, bodies, mesh)
    for hub in bodies:
        add_hub(mujoco, carrier, design, hub, barrels)
    couple_split_wheels(mujoco, spec, bodies)
    add_sphere(mujoco, spec, design)
    add_closure(mujoco, spec, design, stage)
    add_motors(mujoco, spec, design)
    _add_pairs(spec, design, bodies)
    add_looks(mujoco, spec, design)
    spec.option.timestep = timestep or default_timestep(design)
    _settle_contacts(spec, design, impedance)
    return spec


def default_timestep(design: Design) -> float:
    """1/300 of the period 2π √(M/K) of the sphere on one contact, s; a tenth of a millisecond where contacts are rigid."""
    K = linear_contact(design).stiffness
    return 1e-4 if not K else float(2 * np.pi * np.sqrt((design.sphere.mass or 0.0) / K) / STEPS_A_PERIOD)


def shared_load(design: Design) -> float:
    """The sphere's weight and the closure force shared by the wheels, N."""
    weight = GRAVITY * (design.sphere.mass or 0.0) if design.stage.gravity else 0.0
    return (weight + float(np.linalg.norm(design.closure.force))) / design.wheel_count


def linear_contact(design: Design) -> Contact:
    """The design's contact as MuJoCo can have it: straight in depth and rate.

        K = dN/dδ,   C + χ N     at the load N of ``shared_load``

    The stiffness of Hertz's law is that of the softest wheel. A straight law without dissipation is returned as it is.
    """
    contact, N = design.contact, shared_load(design)
    K = contact.stiffness
    if contact.law == "hertz":
        K = float(np.min(wheel_hertz(design, N).stiffness))
    if contact.stiffness == K and not contact.dissipation:
        return contact
    return replace(contact, law="linear", stiffness=K, damping=contact.damping + contact.dissipation * N, dissipation=0.0)


def contact_law(design: Design) -> ContactLaw:
    """The design's contact in MuJoCo's terms; friction grows with the slip at the slope S = μN/v_s, N of ``shared_load``."""
    contact = linear_contact(design)
    μ = contact.friction or 0.0
    return ContactLaw(contact.stiffness or 0.0, contact.damping, μ, μ * shared_load(design) / contact.creep_speed)


def pair_weights(model: Any) -> np.ndarray:
    """Â of each pair of geoms of a compiled model, 1/kg, (p,)."""
    bodies = model.geom_bodyid[np.stack([model.pair_geom1, model.pair_geom2])]
    return model.body_invweight0[bodies, 0].sum(axis=0)


def added_mass(model: Any, impedance: float = IMPEDANCE) -> float:
    """The largest 1/R of a compiled model's contacts, kg; see ``contact``."""
    return float(impedance / ((1 - impedance) * pair_weights(model).min()))


def _require(design: Design, stage: str) -> None:
    if stage not in ("fixed", "free"):
        raise SpheredriveError(f"the stage is 'fixed' or 'free', not {stage!r}")
    if design.sphere.mass is None:
        raise SpheredriveError("a body needs a mass: give sphere.mass")
    if stage == "free" and design.stage.mass is None:
        raise SpheredriveError("a stage that moves needs a mass: give stage.mass")


def _set_options(mujoco, spec, design: Design) -> None:
    option = spec.option
    option.gravity = [0, 0, -GRAVITY if design.stage.gravity else 0.0]
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.tolerance, option.iterations = 1e-12, 100
    option.ccd_tolerance = 1e-10
    # What touches is listed pair by pair.
    spec.compiler.autolimits = True


def _add_pairs(spec, design: Design, bodies: tuple[Hub, ...]) -> None:
    μ = design.contact.friction or 0.0
    for hub in bodies:
        for name in roller_names(hub):
            pair = spec.add_pair(name=name, geomname1="sphere", geomname2=name)
            pair.condim = 3 if μ else 1
            pair.friction = [max(μ, LEAST_FRICTION)] * 2 + [0.0] * 3


def _settle_contacts(spec, design: Design, impedance: float) -> None:
    """Write the contact law into the pairs; the inverse weights it needs are a compiled model's."""
    law = contact_law(design)
    if not law.stiffness:
        return
    found = written(law, pair_weights(spec.compile()), spec.option.timestep, impedance)
    spec.option.impratio = found.impratio
    for pair, solref, sliding in zip(spec.pairs, found.solref, found.solreffriction, strict=True):
        pair.solref, pair.solimp = solref, found.solimp
        pair.solreffriction = sliding if law.friction else [0.0, 0.0]


def rewrite_contacts(model: Any, law: ContactLaw, impedance: float = IMPEDANCE) -> Written:
    """Give a compiled model the contact ``law`` for its present step and inverse weights; returns what was written."""
    found = written(law, pair_weights(model), model.opt.timestep, impedance)
    model.opt.impratio = found.impratio
    model.pair_solref[:], model.pair_solimp[:] = found.solref, found.solimp
    model.pair_solreffriction[:] = found.solreffriction
    return found
