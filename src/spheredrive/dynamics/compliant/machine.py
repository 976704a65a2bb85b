"""A design as the flat arrays of the compliant model (``layout`` says what stands where)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.contact import contact_modulus, hertz, relative_radii, resistance_arms
from spheredrive.design import GRAVITY
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.parameters import SMOOTHING
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.shape import kernels, nominal_height, profile
from spheredrive.shape.envelope import Envelope, touching_races
from spheredrive.shape.profile import exact_envelope
from spheredrive.wheels.base import RollerWheel

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.wheels.base import Wheel

# Rollers are looked at while their tops reach to this many static depths below the wheel's outline, at least this share of r.
REACH, REACH_SHARE = 50.0, 1e-3
# And always within so many pitches of the sphere.
NEIGHBOURS = 1.2


class Machine(NamedTuple):
    """A design for the compiled functions; rows as in ``layout``.

    body, wheels, stations, outlines   (BODY_SIZE,), (n, WHEEL_SIZE), (m, STATION_SIZE), (q, OUTLINE_SIZE)
    pieces      of all rings' outlines, (p, PIECE_POWERS + d); one row of nothing where there are none
    places      a piece of each outline that is a ring with corners, else −1, (q,)
    contacts    (wheel, race) of each outline, numbered from 1
    rollers     how many rollers turn with an inertia of their own
    """

    body: np.ndarray
    wheels: np.ndarray
    stations: np.ndarray
    outlines: np.ndarray
    pieces: np.ndarray
    places: np.ndarray
    contacts: tuple[tuple[int, int], ...]
    rollers: int

    @property
    def state_size(self) -> int:
        """How many numbers the state has."""
        return at.WHEELS + at.WHEEL_STATES * len(self.wheels) + at.STATION_STATES * len(self.stations) + self.rollers


def machine(design: Design, normal_force: float | None = None) -> Machine:
    """The arrays of the compliant model 5c.

    Hertz's resistance arms are taken at ``normal_force`` (N), by default the sphere's weight and closure force shared by the
    wheels. Raises ``SpheredriveError`` naming what the design lacks, ``DesignError`` for wheels that are not described.
    """
    _require(design)
    weight = GRAVITY * design.sphere.mass if design.stage.gravity else 0.0
    if normal_force is None:
        normal_force = (weight + float(np.linalg.norm(design.closure.force))) / design.wheel_count
    stiffness = _stiffnesses(design)
    arms = resistance_arms(design, np.full(design.wheel_count, normal_force))
    wheels, stations, outlines, contacts = [], [], [], []
    pieces: list[np.ndarray] = []
    # Wheels of one kind have the same outlines.
    known: dict[tuple, np.ndarray] = {}
    rollers = 0
    for i, wheel in enumerate(design.wheels):
        first = len(stations)
        sides = _sides(design, wheel)
        for antipodal, races in sides:
            reach, rows = _reach(design, i, stiffness[i], weight), []
            for race in races:
                if (wheel, race.number, reach) not in known:
                    known[wheel, race.number, reach] = _outline(design, wheel, race, pieces, reach)
                rows.append(known[wheel, race.number, reach].copy())
            for row, race in zip(rows, races, strict=True):
                if row[at.KIND] != at.RING and wheel.roller_inertia:
                    row[at.FIRST_ROLLER], row[at.ROLLER_COUNT] = rollers, wheel.rollers_per_race
                    rollers += wheel.rollers_per_race
                contacts.append((i + 1, race.number))
            station = _station(design, i, antipodal, races[0], stiffness[i], arms, len(sides))
            station[at.FIRST_OUTLINE], station[at.OUTLINE_COUNT] = len(outlines), len(rows)
            stations.append(station)
            outlines += rows
        wheels.append(_wheel(design, wheel, first, len(sides)))
    width = max([len(row) for row in pieces], default=at.PIECE_POWERS + 1)
    table = np.zeros((max(1, len(pieces)), width))
    for row, values in zip(table, pieces, strict=False):
        row[: len(values)] = values
    rows = np.array(outlines)
    cornered = (rows[:, at.KIND] == at.RING) & (rows[:, at.PIECE_COUNT] > 0)
    places = np.where(cornered, rows[:, at.FIRST_PIECE], -1).astype(np.int64)
    body = _body(design, weight)
    return Machine(body, np.array(wheels), np.array(stations), rows, table, places, tuple(contacts), rollers)


def _require(design: Design) -> None:
    if design.sphere.mass is None or design.sphere.inertia_tensor is None:
        raise SpheredriveError("the compliant model needs sphere.mass")
    if design.contact.friction is None:
        raise SpheredriveError("the compliant model needs contact.friction; zero is a friction too")
    if design.contact.law == "linear" and not design.contact.stiffness:
        raise SpheredriveError('the compliant model needs contact.stiffness, or contact.law = "hertz" and the bodies\' moduli')
    for wheel in design.wheels:
        if wheel.spin_inertia is None:
            raise SpheredriveError(f"the dynamics need the mass or the axial_inertia of wheels.{wheel.name}")
        if design.mount.stiffness is not None and not wheel.mass:
            raise SpheredriveError(f"wheels on mounts that give way need a mass; give that of wheels.{wheel.name}")
    if design.mount.stiffness == 0:
        raise SpheredriveError("mounts without stiffness carry nothing; give mount.stiffness, or leave it out for rigid mounts")


def _stiffnesses(design: Design) -> np.ndarray:
    """K of each wheel's contacts: as given, or Hertz's N/δ^(3/2) in N/m^(3/2)."""
    if design.contact.law == "linear":
        return np.full(design.wheel_count, design.contact.stiffness)
    sphere = design.sphere
    across, along = relative_radii(design)
    found = []
    for i, wheel in enumerate(design.wheels):
        moduli = (sphere.young_modulus, sphere.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio)
        if None in moduli:
            raise SpheredriveError(
                f"Hertz's law needs young_modulus and poisson_ratio of the sphere and of wheels.{wheel.name}"
            )
        patch = hertz(1.0, across[i], along[i], modulus=contact_modulus(*moduli))
        found.append(float(patch.approach) ** -1.5)
    return np.array(found)


def _sides(design: Design, wheel: Wheel):
    """The races of a wheel at R̂, and those at −R̂ where it has such."""
    races = design.races(wheel)
    sides = [(False, [r for r in races if not r.antipodal]), (True, [r for r in races if r.antipodal])]
    return [(antipodal, of_side) for antipodal, of_side in sides if of_side]


def _body(design: Design, weight: float) -> np.ndarray:
    sphere, closure = design.sphere, design.closure
    n_hat = design.contact_directions
    K, C = closure.stiffness * n_hat.T @ n_hat, closure.damping * n_hat.T @ n_hat
    for spring in closure.springs:
        along = np.outer(spring.direction, spring.direction)
        K, C = K + spring.stiffness * along, C + spring.damping * along
    masses = np.array([wheel.mass or 0.0 for wheel in design.wheels])
    stage = design.stage.mass or 0.0
    lateral = np.eye(3) * (stage + masses.sum())
    if design.mount.stiffness is not None:
        lateral = lateral - n_hat.T @ (masses[:, None] * n_hat)
    response = np.linalg.inv(lateral) if stage else np.zeros((3, 3))
    six = np.triu_indices(3)
    moving = sphere.mass + stage + masses.sum()
    return np.array(
        [
            sphere.radius,
            *sphere.inertia_tensor[six],
            *sphere.centre_of_mass,
            sphere.mass,
            *(0.0, 0.0, -weight),
            *closure.force,
            *K[six],
            *C[six],
            moving,
            *response[six],
            design.contact.creep_speed,
            SMOOTHING,
        ]
    )


def _wheel(design: Design, wheel: Wheel, first: int, count: int) -> np.ndarray:
    motor = design.motor
    row = np.zeros(at.WHEEL_SIZE)
    row[at.AXIAL_INERTIA] = wheel.spin_inertia
    row[at.PROPORTIONAL], row[at.INTEGRAL] = motor.proportional_gain or 0.0, motor.integral_gain or 0.0
    row[at.TORQUE_LIMIT] = math.inf if motor.torque is None else motor.torque
    row[at.FIRST_STATION], row[at.STATION_COUNT] = first, count
    row[at.ROLLER_INERTIA] = getattr(wheel, "roller_inertia", 0.0)
    row[at.ROLLER_DRAG] = getattr(wheel, "roller_drag", 0.0)
    return row


def _station(design: Design, i: int, antipodal: bool, race, stiffness: float, arms, halves: int) -> np.ndarray:
    """A station's row; the mass of a wheel in two halves is shared by both mounts."""
    wheel, contact = design.wheels[i], design.contact
    sign = 1.0 if antipodal else -1.0
    n_hat, v_hat = sign * design.contact_directions[i], -sign * design.drive_directions[i]
    row = np.zeros(at.STATION_SIZE)
    row[at.N_HAT : at.N_HAT + 3], row[at.V_HAT : at.V_HAT + 3] = n_hat, v_hat
    row[at.W_HAT : at.W_HAT + 3] = np.cross(n_hat, v_hat)
    races = touching_races(wheel, design.sphere.radius, race.number if antipodal else None)
    middle = min(races, key=lambda r: abs(r.offset))
    row[at.DISTANCE] = design.sphere.radius + nominal_height(middle, design.sphere.radius)
    if design.mount.stiffness is not None:
        row[at.MOUNT_STIFFNESS], row[at.MOUNT_DAMPING] = design.mount.stiffness, design.mount.damping
        row[at.MOUNT_MASS] = wheel.mass / halves
    row[at.STIFFNESS], row[at.DAMPING], row[at.DISSIPATION] = stiffness, contact.damping, contact.dissipation
    row[at.HERTZIAN], row[at.FRICTION] = contact.law == "hertz", contact.friction
    row[at.ROLLING_ARM], row[at.SPIN_ARM] = arms[0][i], arms[1][i]
    row[at.STATION_WHEEL] = i
    return row


def _reach(design: Design, i: int, stiffness: float, weight: float) -> float:
    """How far (m) below the outline a roller may stand and still be looked at."""
    pressing = weight + float(np.linalg.norm(design.closure.force))
    depth = (pressing / stiffness) ** (2 / 3 if design.contact.law == "hertz" else 1.0)
    return max(REACH * depth, REACH_SHARE * design.wheels[i].radius)


def _outline(design: Design, wheel: Wheel, race, pieces: list, reach: float) -> np.ndarray:
    R = design.sphere.radius
    number = race.number if race.antipodal else None
    try:
        if not isinstance(wheel, RollerWheel) or profile(wheel, R, race=number).kind != "exact":
            return _ring(wheel, R, number, pieces)
        return _rollers(wheel, race, exact_envelope(wheel, R, number), reach)
    except DesignError as error:
        raise error.under("wheels", wheel.name) from None


def _rollers(wheel: RollerWheel, race, shape: Envelope, reach: float) -> np.ndarray:
    rank = shape.races.index(race)
    body = shape.rollers[rank]
    e, sigma = body.edge() if body.half_length else (0.0, 0.0)
    row = np.zeros(at.OUTLINE_SIZE)
    barrel = body.barrel_radius > 0
    row[at.KIND] = at.BARREL if barrel else (at.ROUND_ENDS if body.rounded else at.FLAT_ENDS)
    row[at.AXIS_DISTANCE], row[at.SINE], row[at.COSINE] = body.axis_distance, body.sine, body.cosine
    row[at.OFFSET], row[at.HALF_LENGTH] = race.offset, body.half_length
    row[at.THICKEST] = float(body.radius(0.0))
    row[at.SECTION] = body.barrel_radius if barrel else row[at.THICKEST]
    row[at.EDGE_PLACE], row[at.EDGE_RADIUS] = e, sigma
    row[at.PITCH], row[at.MIDDLE] = shape.pitch, shape.centres[rank] - wheel.phase_angle
    # On either side of a dip between two rollers one of them is looked at, however deep it is.
    row[at.FARTHEST] = max(_farthest(shape, rank, reach), NEIGHBOURS * shape.pitch)
    return row


def _farthest(shape: Envelope, rank: int, reach: float) -> float:
    """Angle from a roller's middle at which it stands ``reach`` (m) below the outline and lower with every step, rad."""
    row, step = np.empty(7), shape.pitch / 16
    beta, lower = 0.0, 0
    while lower < 4 and beta < 1.5:
        beta += step
        for side in (-beta, beta):
            kernels.touch(side, kernels.DECIDE, shape.bodies[rank], shape.knots, shape.table, row)
            if row[kernels.HEIGHT] > shape.nominal - reach:
                lower = -1
        lower += 1
    return beta


def _ring(wheel: Wheel, R: float, number: int | None, pieces: list) -> np.ndarray:
    """A wheel that is given by its profile alone: one ring of its outline, cross-section r_r."""
    outline = profile(wheel, R, race=number)
    row = np.zeros(at.OUTLINE_SIZE)
    row[at.KIND], row[at.SECTION] = at.RING, wheel.roller_section
    row[at.AXIS_DISTANCE] = wheel.radius - wheel.roller_section
    row[at.SINE], row[at.COSINE] = math.sin(wheel.roller_angle), math.cos(wheel.roller_angle)
    row[at.FIRST_PIECE], row[at.PERIOD] = len(pieces), outline.period
    corners = np.flatnonzero(outline.slope_jumps)
    count = len(outline.coefficients)
    # Begin at a corner, so that no smooth stretch runs over the end of the period.
    order = np.roll(np.arange(count), -corners[0]) if len(corners) else np.arange(count)
    starts = outline.breakpoints[:-1][order] + np.where(order < order[0], outline.period, 0.0) - outline.phase
    ends = [*(np.flatnonzero(outline.slope_jumps[order])[1:] if len(corners) else []), count]
    begin = 0
    for end in ends:
        for k in range(begin, end):
            width = np.diff(outline.breakpoints)[order[k]]
            stretch = (len(pieces) - k + begin, len(pieces) - k + end - 1)
            pieces.append(np.array([starts[k], width, *stretch, *outline.coefficients[order[k]]]))
        begin = end
    row[at.PIECE_COUNT] = count if len(corners) else 0
    return row
