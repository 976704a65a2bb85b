"""The bodies of a design: sphere, wheels with every roller where it stands, and what carries them.

A wheel's own frame has x from its centre towards the sphere's, y along the drive direction v̂ and z along its axis ŵ: the
frame of ``shape``. A wheel that turns by ϑ > 0 turns about z, which moves its surface at the contact along +v̂.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spheredrive.design import Design
from spheredrive.errors import DesignError
from spheredrive.frames import outward, rotation_matrix
from spheredrive.kinematics import Contacts, contacts
from spheredrive.scene.mesh import Mesh, cylinder, disc, joined, prism, revolved
from spheredrive.shape import Roller, exact_envelope, nominal_height, roller
from spheredrive.wheels import Race, RollerWheel, Wheel

# Sides of a roller and points of its generatrix, where there are up to so many rollers; beyond, the last.
DETAIL = ((60, 14, 9), (150, 10, 7), (10**9, 8, 5))
# A wheel without rollers to speak of is a disc this wide, as a share of its radius.
WIDTH = 0.3


@dataclass(frozen=True, eq=False)
class RollerRace:
    """The rollers of one race: a body about its own axis z, and where each of the N stands at wheel angle zero.

    number   of the race, from 1
    body     one roller, its axis along z
    place    of the rollers' middles in the wheel's frame, (N, 3), m
    turn     rotation of each into the wheel's frame, (N, 3, 3)
    angle    β of each middle, about ŵ from the line of centres, (N,), rad
    """

    number: int
    body: Mesh
    place: np.ndarray
    turn: np.ndarray
    angle: np.ndarray


@dataclass(frozen=True, eq=False)
class WheelBody:
    """A wheel where it stands; the second wheel of a split pair is one of its own.

    wheel    index of the wheel, from 0
    label    its number as people read it
    centre   of the wheel from the sphere's centre, (3,), m
    frame    rotation from the wheel's frame to the inertial one, (3, 3): columns x, y, z
    radius   outer radius, m
    hub      the body that carries the rollers, or the whole wheel where it has none, in the wheel's frame
    races    its races of rollers
    missing  why the rollers are not drawn, or ""
    """

    wheel: int
    label: str
    centre: np.ndarray
    frame: np.ndarray
    radius: float
    hub: Mesh
    races: tuple[RollerRace, ...]
    missing: str


@dataclass(frozen=True, eq=False)
class Machine:
    """All bodies of a design, in m, from the sphere's nominal centre in the inertial frame.

    contacts   of every race of every wheel, in the order of the contacts of a run
    cage       polylines (k, 3) of what carries the wheels: the stage, as a sketch
    """

    sphere_radius: float
    wheels: tuple[WheelBody, ...]
    contacts: Contacts
    cage: tuple[np.ndarray, ...]

    @property
    def roller_count(self) -> int:
        """Rollers in all."""
        return sum(len(race.angle) for wheel in self.wheels for race in wheel.races)

    @property
    def extent(self) -> tuple[float, float]:
        """Height z of the middle of everything above the sphere's centre, and its reach from there, m."""
        R, points = self.sphere_radius, np.vstack(self.cage)
        low, high = min(-R, float(points[:, 2].min())), max(1.6 * R, float(points[:, 2].max()))
        middle = (low + high) / 2
        return middle, max((high - low) / 2, float(np.hypot(points[:, 0], points[:, 1]).max()), 1.25 * R)


def machine(design: Design) -> Machine:
    """The bodies of ``design``. Source: model.md sections 1 and 3."""
    rollers = sum(getattr(wheel, "rollers", None) or 0 for wheel in design.wheels)
    detail = next((sides, points) for most, sides, points in DETAIL if rollers <= most)
    wheels = tuple(
        body
        for i in range(design.wheel_count)
        for antipodal in (False, True)
        if (body := _wheel_body(design, i, antipodal, detail)) is not None
    )
    everything = [tuple(race.number for race in design.races(wheel)) for wheel in design.wheels]
    return Machine(design.sphere.radius, wheels, contacts(design, everything), _cage(design.sphere.radius, wheels))


def _wheel_body(design: Design, i: int, antipodal: bool, detail: tuple[int, int]) -> WheelBody | None:
    wheel, R = design.wheels[i], design.sphere.radius
    races = [race for race in design.races(wheel) if race.antipodal == antipodal]
    if not races:
        return None
    sign = -1.0 if antipodal else 1.0
    R_hat, v_hat = sign * design.contact_directions[i], sign * design.drive_directions[i]
    height = nominal_height(min(races, key=lambda race: abs(race.offset)), R)
    frame = np.stack([-R_hat, v_hat, np.cross(v_hat, R_hat)], axis=-1)
    label = f"{i + 1}b" if antipodal else str(i + 1)
    placed, missing = (), ""
    try:
        placed = tuple(_roller_race(wheel, race, R, detail) for race in races if isinstance(wheel, RollerWheel))
    except DesignError as error:
        missing = str(error)
    hub = _hub(wheel, races) if placed else _plain(wheel, races)
    return WheelBody(i, label, (R + height) * R_hat, frame, races[0].radius, hub, placed, missing)


def _roller_race(wheel: RollerWheel, race: Race, sphere_radius: float, detail: tuple[int, int]) -> RollerRace:
    body = roller(wheel, race)
    # On the second wheel of a split pair the rollers have the other hand.
    tilt = -body.tilt if race.antipodal else body.tilt
    sine, cosine = math.copysign(body.sine, tilt), body.cosine
    count = wheel.rollers_per_race or 1
    beta = wheel.phase_angle - middle_angle(wheel, race, sphere_radius) + 2 * math.pi / count * np.arange(count)
    place = np.stack([body.axis_distance * np.cos(beta), body.axis_distance * np.sin(beta), np.full(count, race.offset)], -1)
    # Of a roller at β = 0: z along its axis (0, sin α, cos α), x outward.
    rest = np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]])
    turn = rotation_matrix(np.broadcast_to([0.0, 0.0, 1.0], (count, 3)), beta) @ rest
    return RollerRace(race.number, roller_mesh(body, *detail), place, turn, beta)


def middle_angle(wheel: RollerWheel, race: Race, sphere_radius: float) -> float:
    """Wheel angle, with its phase, at which the middle of a roller of ``race`` stands on the line of centres, rad.

    Races that take turns do so in the middle of their half pitch [2.56]; else where the exact outline has it.
    """
    turns = wheel.alternation
    if len(turns) > 1:
        return next(k for k, together in enumerate(turns) if race.number in together) * wheel.half_pitch + wheel.half_pitch / 2
    if getattr(wheel, "roundness", None) == 0:
        return 0.0
    return exact_envelope(wheel, float(sphere_radius)).strips[0].centre


def roller_mesh(body: Roller, sides: int = 14, points: int = 9) -> Mesh:
    """The surface of a roller, its axis along z: the envelope of the balls of radius ρ(s) about the points of its axis.

    A ball touches the surface at the place s − ρρ′ with the radius ρ √(1 − ρ′²). Source: model.md section 3.
    """
    L = body.half_length
    if L == 0.0:
        return _ball(float(body.radius(0.0)), sides, points)
    s = np.linspace(-L, L, points)
    rho, slope = body.radius(s), body.radius_slope(s)
    place, radius = s - rho * slope, rho * np.sqrt(np.maximum(0.0, 1 - slope**2))
    if body.rounded:
        angle = np.linspace(0, math.pi / 2, points // 2 + 1)[1:]
        cap = np.sin(angle) * rho[-1], np.maximum(np.cos(angle), 1e-6) * rho[-1]
        places = [place[0] - cap[0][::-1], place, place[-1] + cap[0]]
        return revolved(np.concatenate(places), np.concatenate([cap[1][::-1], radius, cap[1]]), sides)
    ends = disc(place[0], radius[0], False, sides), disc(place[-1], radius[-1], True, sides)
    return joined(revolved(place, radius, sides), *ends)


def _ball(radius: float, sides: int, points: int) -> Mesh:
    angle = np.linspace(-math.pi / 2, math.pi / 2, points)
    return revolved(radius * np.sin(angle), np.maximum(radius * np.cos(angle), 1e-6 * radius), sides)


def _hub(wheel: Wheel, races: list[Race]) -> Mesh:
    """A core that reaches to the rollers' axes, and a web beside each race: a sketch, but clear of the sphere."""
    bodies = [(race, roller(wheel, race)) for race in races]  # type: ignore[arg-type]
    core = max(0.2 * wheel.radius, min(body.axis_distance - 0.8 * float(body.radius(0.0)) for _, body in bodies))
    half = max(abs(race.offset) + 0.75 * _half_width(body) for race, body in bodies)
    return cylinder(-half, half, core, 32)


def _half_width(body: Roller) -> float:
    return float(body.radius(0.0)) * abs(body.sine) + body.half_length * abs(body.cosine)


def _plain(wheel: Wheel, races: list[Race]) -> Mesh:
    half = 0.5 * WIDTH * wheel.radius
    outline = getattr(wheel, "outline", None)
    if outline is None:
        return joined(*(cylinder(race.offset - half, race.offset + half, race.radius, 48) for race in races))
    angle, radius = np.array(outline).T
    # The point that is measured at angle ϑ touches the sphere when the wheel has turned by ϑ: it stands at −ϑ.
    points = np.stack([radius * np.cos(-angle), radius * np.sin(-angle)], axis=-1)
    return prism(points[::-1], -half, half)


def _cage(R: float, wheels: tuple[WheelBody, ...]) -> tuple[np.ndarray, ...]:
    """A ring on the wheels' side of the sphere, an arc from it to each wheel and a fork to its axle: a sketch."""
    radius = max(float(np.linalg.norm(wheel.centre)) + 1.35 * wheel.radius for wheel in wheels)
    elevations = np.array([math.asin(float(np.clip(-wheel.frame[2, 0], -1, 1))) for wheel in wheels])
    side = -1.0 if elevations.mean() <= 1e-9 else 1.0
    ring = side * min(max(float(side * elevations.mean()), 0.0) + math.radians(25), math.radians(65))
    lines = [radius * outward(np.linspace(0, 2 * math.pi, 73), ring)]
    for wheel, elevation in zip(wheels, elevations, strict=True):
        R_hat, w_hat = -wheel.frame[:, 0], wheel.frame[:, 2]
        azimuth = math.atan2(R_hat[1], R_hat[0]) if math.hypot(*R_hat[:2]) > 1e-9 else 0.0
        lines.append(radius * outward(azimuth, np.linspace(ring, elevation, 25)))
        half = 1.2 * float(np.abs(wheel.hub.vertices[:, 2]).max()) * w_hat
        shoulder = wheel.centre + 1.15 * wheel.radius * R_hat
        corners = [wheel.centre - half, shoulder - half, shoulder + half, wheel.centre + half, wheel.centre - half]
        lines += [np.array(corners), np.array([radius * R_hat, shoulder])]
    return tuple(lines)
