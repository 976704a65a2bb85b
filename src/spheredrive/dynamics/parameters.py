"""A design as the flat arrays that the rolling model's compiled functions work on."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.contact import resistance_arms
from spheredrive.design import GRAVITY
from spheredrive.errors import SpheredriveError
from spheredrive.kinematics.contacts import constraint_row, contacts

if TYPE_CHECKING:
    from spheredrive.design import Design

# Angular speed below which resistances fade, rad/s.
SMOOTHING = 1e-3


class RollingParameters(NamedTuple):
    """What the equations of motion need, SI; wheels on the first axis, their contact states on the second.

    A wheel's third state is that it rests on the boundary between its races (see ``dynamics.rolling.blend_rows``); its row
    is then worked out anew at every instant, its contact is the nominal one.

    body       I_s in the body frame as (xx, xy, xz, yy, yz, zz), kg m²; centre of mass ρ in the body frame, m; M_s and
               M_s + M_l + Σmᵢ, kg (zero where it is not given); gravity, m/s²; constant closure force F_ext on the sphere, N;
               μ (zero where it is not given); angular speed below which resistances fade, rad/s; (19,)
    contacts   R/r · a, so that ωᵢ = row · Ω; R̂; û, along which friction acts; û·v̂ r = r sin α, m; (n, 3, 10)
    wheels     ŵ; I_w, kg m²; wheel angle between changes of race, rad, inf where there are none; phase, rad; l_r and l_s, m;
               (n, 8)
    """

    body: np.ndarray
    contacts: np.ndarray
    wheels: np.ndarray


def rolling_parameters(design: Design, normal_force: float | None = None) -> RollingParameters:
    """The parameters of the rolling model 5a.

    Resistance arms that come from Hertz depend on the normal force; they are taken at ``normal_force`` (N), by default
    the sphere's weight and closure force shared by the wheels. Raises ``SpheredriveError`` naming what the design lacks:
    a sphere's mass or inertia, a wheel's mass; and for races of one wheel that touch together, which slip.
    """
    _require(design)
    weight = GRAVITY * (design.sphere.mass or 0.0) if design.stage.gravity else 0.0
    if normal_force is None:
        normal_force = (weight + float(np.linalg.norm(design.closure.force))) / design.wheel_count
    arms = resistance_arms(design, np.full(design.wheel_count, normal_force))
    axis = -np.cross(design.contact_directions, design.drive_directions)
    each = [(w.spin_inertia, w.half_pitch, w.phase_angle) for w in design.wheels]
    return RollingParameters(
        _body(design),
        np.stack([_contacts_of_state(design, races) for races in (*_alternating(design), None)], axis=1),
        np.column_stack([axis, np.array(each, float), *arms]),
    )


def _body(design: Design) -> np.ndarray:
    sphere = design.sphere
    masses = [sphere.mass, design.stage.mass, *(wheel.mass for wheel in design.wheels)]
    moving = 0.0 if any(mass is None for mass in masses) else sum(masses)  # type: ignore[arg-type]
    inertia = sphere.inertia_tensor
    assert inertia is not None  # _require has asked
    gravity = [0.0, 0.0, -GRAVITY if design.stage.gravity else 0.0]
    friction = design.contact.friction or 0.0
    own = [*inertia[np.triu_indices(3)], *sphere.centre_of_mass, sphere.mass or 0.0, moving]
    return np.array([*own, *gravity, *design.closure.force, friction, SMOOTHING])


def _alternating(design: Design):
    """The races of every wheel in its first and in its second state; a wheel with one state has the same in both."""
    return [[wheel.alternation[k % len(wheel.alternation)] for wheel in design.wheels] for k in (0, 1)]


def _contacts_of_state(design: Design, races) -> np.ndarray:
    """Row, R̂, û and lever of each wheel's contact while ``races`` touch, (n, 10)."""
    c = contacts(design, races)
    row = constraint_row(c.contact_direction, c.drive_direction, c.roller_angle)
    ratio = (design.sphere.radius / c.wheel_radius)[:, None]
    lever = (np.sin(c.roller_angle) * c.wheel_radius)[:, None]
    return np.hstack([ratio * row, c.contact_direction, c.slip_direction, lever])


def _require(design: Design) -> None:
    for i, wheel in enumerate(design.wheels):
        if max(map(len, wheel.alternation)) > 1:
            raise SpheredriveError(
                f"wheel {i + 1} is a {wheel.type} wheel: races of it that touch together slip, so the rolling model does not "
                "hold for it"
            )
        if wheel.spin_inertia is None:
            raise SpheredriveError(f"the dynamics need the mass or the axial_inertia of wheels.{wheel.name}")
    if design.sphere.inertia_tensor is None:
        raise SpheredriveError("the dynamics need sphere.mass, or sphere.inertia as numbers")
    offset_matters = any(design.sphere.centre_of_mass)
    if design.sphere.mass is None and (offset_matters or design.stage.gravity):
        raise SpheredriveError("the dynamics need sphere.mass")
