"""Where every hub and every roller of a design stands, and which share of its wheel's mass each has.

The wheel's frame is that of the outline (model.md section 3): x from the wheel's centre to the sphere's, y = v̂, z = ŵ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.shape import Roller, exact_envelope, roller
from spheredrive.wheels.base import RollerWheel

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.wheels.base import Race, Wheel

# Share of a wheel's mass that its rollers have together: of an omni wheel's, rollers of plastic on a hub of metal.
ROLLER_SHARE = 0.1


@dataclass(frozen=True)
class Inertia:
    """Mass (kg) and principal moments (kg m²) of a body about its middle, in its own frame."""

    mass: float
    moments: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class RollerPlace:
    """One roller in its hub at wheel angle zero.

    race      number of its race, from 1
    body      its shape
    position  of its middle in the wheel's frame, m, (3,)
    axis      unit vector along its axis, (3,): (−sin α sin β, sin α cos β, cos α)
    """

    race: int
    body: Roller
    position: np.ndarray
    axis: np.ndarray


@dataclass(frozen=True, eq=False)
class Hub:
    """A turning body that carries rollers: a wheel, or one half of a split one.

    wheel       index of the wheel, from 0
    antipodal   whether it is the half at −R̂
    frame       rows x (to the sphere's centre), y = v̂ and z = ŵ in the stage's frame, (3, 3)
    position    of its middle in the stage's frame, whose origin is the sphere's nominal centre, m, (3,)
    normal      n̂ = −R̂ of the contact: the way its mount gives, (3,)
    inertia     of what does not roll: axial moment last; with the rollers in place the wheel has the design's
    roller_inertia   of each roller, its axis last
    rollers     race by race
    """

    wheel: int
    antipodal: bool
    frame: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    inertia: Inertia
    roller_inertia: Inertia
    roller_drag: float
    rollers: tuple[RollerPlace, ...]


def hubs(design: Design, roller_share: float = ROLLER_SHARE) -> tuple[Hub, ...]:
    """Every hub of ``design`` with its rollers, at wheel angle zero.

    The rollers have ``roller_share`` of the wheel's mass, equally; the hub has the rest, and of the axial inertia what the
    rollers on their places leave. A hub's other moments are as its axial one: no motion of the machine asks for them. A split
    wheel's two hubs share its mass and inertia. Raises ``SpheredriveError`` for wheels whose rollers or mass are not described,
    ``DesignError`` where the rollers alone have more than the wheel's axial inertia.
    """
    if not 0 < roller_share < 1:
        raise SpheredriveError(f"the rollers' share of a wheel's mass lies between 0 and 1, not at {roller_share:g}")
    found = []
    for i, wheel in enumerate(design.wheels):
        try:
            found += _hubs_of(design, i, wheel, roller_share)
        except DesignError as error:
            raise error.under("wheels", wheel.name) from None
    return tuple(found)


def _hubs_of(design: Design, i: int, wheel: Wheel, roller_share: float) -> list[Hub]:
    if not isinstance(wheel, RollerWheel):
        raise SpheredriveError(
            f"wheel {i + 1} is of type {wheel.type!r} and has no rollers to export; take a type whose rollers are described"
        )
    if wheel.mass is None or wheel.spin_inertia is None:
        raise SpheredriveError(f"a body needs a mass: give the mass of wheels.{wheel.name}")
    races = design.races(wheel)
    sides = [[race for race in races if race.antipodal is antipodal] for antipodal in (False, True)]
    sides = [side for side in sides if side]
    found = []
    for side in sides:
        sign = -1.0 if side[0].antipodal else 1.0
        R_hat, v_hat = sign * design.contact_directions[i], sign * design.drive_directions[i]
        frame = np.array([-R_hat, v_hat, np.cross(v_hat, R_hat)])
        shape = exact_envelope(wheel, design.sphere.radius, side[0].number if side[0].antipodal else None)
        rollers = tuple(place for race in side for place in _places(wheel, race, shape, sign))
        share = 1 / len(sides)
        part = roller_share * wheel.mass * share / len(rollers)
        one, hub = _shared_inertia(wheel, rollers, part, share)
        position = (design.sphere.radius + shape.nominal) * R_hat
        found.append(Hub(i, side[0].antipodal, frame, position, -R_hat, hub, one, wheel.roller_drag, rollers))
    return found


def _places(wheel: RollerWheel, race: Race, shape, hand: float) -> list[RollerPlace]:
    body = roller(wheel, race)
    sine, cosine = body.sine, hand * body.cosine
    middle = shape.centres[shape.races.index(race)]
    found = []
    for k in range(wheel.rollers_per_race or 0):
        β = wheel.phase_angle - middle + k * shape.pitch
        position = np.array([body.axis_distance * math.cos(β), body.axis_distance * math.sin(β), race.offset])
        axis = np.array([-sine * math.sin(β), sine * math.cos(β), cosine])
        found.append(RollerPlace(race.number, body, position, axis))
    return found


def _shared_inertia(wheel: RollerWheel, rollers: tuple[RollerPlace, ...], mass: float, share: float) -> tuple[Inertia, Inertia]:
    """A roller's and the hub's inertia; a roller counts as a solid ball, or as a cylinder of its middle's radius, unless the
    design gives its moment."""
    body = rollers[0].body
    ρ = float(body.radius(0.0))
    along = across = 0.4 * mass * ρ**2
    if body.half_length:
        length = 2 * (body.half_length + body.rounded * ρ)
        along, across = mass * ρ**2 / 2, mass * (ρ**2 / 4 + length**2 / 12)
    # Across may not be less than half of along, which no body has.
    along = wheel.roller_inertia or along
    across = max(across, along)
    about = sum(mass * (p.position[0] ** 2 + p.position[1] ** 2) for p in rollers)
    about += sum(along * p.axis[2] ** 2 + across * (1 - p.axis[2] ** 2) for p in rollers)
    axial = share * wheel.spin_inertia - about  # type: ignore[operator]
    if not axial > 0:
        raise DesignError(
            f"is less than the {about / share:.3g} kg m^2 that rollers of {len(rollers) * mass / share:.3g} kg have about the "
            "wheel's axis; give the rollers less of the wheel's mass, or the wheel more inertia",
            ("axial_inertia",),
        )
    rest = share * wheel.mass - len(rollers) * mass  # type: ignore[operator]
    return Inertia(mass, (across, across, along)), Inertia(rest, (axial, axial, axial))
