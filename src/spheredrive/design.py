"""The machine as frozen values: a sphere, the wheels placed around it, and what holds and moves them.

Everything is SI and radians. Values check themselves when they are made, so that a ``Design`` that exists is one that
can be built; what it is good for is asked of the functions that take it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from spheredrive.errors import DesignError
from spheredrive.frames import angles, heading_direction, outward
from spheredrive.values import check_fields, check_poisson_ratio, checked_number, quantity, word
from spheredrive.wheels.base import Wheel

Vector = tuple[float, float, float]

# Standard acceleration of free fall, m/s².
GRAVITY = 9.80665

# Directions closer than this (rad) are the same direction: far below what can be built, far above rounding.
SAME_DIRECTION = 1e-9


def _spherical(moment: float) -> tuple[Vector, Vector, Vector]:
    return ((moment, 0.0, 0.0), (0.0, moment, 0.0), (0.0, 0.0, moment))


@dataclass(frozen=True)
class Sphere:
    """The driven sphere. ``inertia``: ``"hollow"`` (2/3 M R²), ``"solid"`` (2/5 M R²), three principal moments or a
    3x3 table, kg m², about the geometric centre, in the body frame."""

    radius: float = quantity("m", "radius of the sphere")
    mass: float | None = quantity("kg", "mass of the sphere with its payload", default=None)
    inertia: str | tuple = field(
        default="hollow",
        metadata={"inertia": True, "doc": '"hollow", "solid", [Ixx, Iyy, Izz] or a 3x3 table, about the geometric centre'},
    )
    centre_of_mass: Vector = quantity("m", "centre of mass in the body frame", sign="any", shape=(3,), default=(0.0, 0.0, 0.0))
    young_modulus: float | None = quantity("Pa", "Young's modulus of the sphere's skin", default=None)
    poisson_ratio: float | None = quantity("", "Poisson's ratio of the sphere's skin", sign="any", default=None)

    def __post_init__(self) -> None:
        check_fields(self)
        check_poisson_ratio(self.poisson_ratio)
        if math.hypot(*self.centre_of_mass) >= self.radius:
            raise DesignError("the centre of mass must lie inside the sphere", ("centre_of_mass",))
        if not isinstance(self.inertia, str):
            object.__setattr__(self, "inertia", _inertia_table(self.inertia))
            self._check_inertia()
        elif self.inertia not in ("hollow", "solid"):
            raise DesignError(
                f'{self.inertia!r} is not known; write "hollow", "solid", three moments or a 3x3 table', ("inertia",)
            )

    @property
    def inertia_tensor(self) -> np.ndarray | None:
        """Inertia tensor about the geometric centre, body frame, (3, 3), kg m²; None where it needs an unknown mass."""
        if not isinstance(self.inertia, str):
            return np.array(self.inertia)
        if self.mass is None:
            return None
        share = {"hollow": 2 / 3, "solid": 2 / 5}[self.inertia]
        return share * self.mass * self.radius**2 * np.eye(3)

    def _check_inertia(self) -> None:
        tensor = np.array(self.inertia)
        offset = np.array(self.centre_of_mass)
        if self.mass is not None:
            # Only the part about the mass centre has to be a body's: the offset's own share comes on top of it.
            tensor = tensor - self.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
        moments = np.linalg.eigvalsh(tensor)
        slack = 1e-9 * abs(moments[2])
        if moments[0] < -slack or moments[2] <= 0:
            raise DesignError("has a negative moment about the centre of mass, which no body can have", ("inertia",))
        if moments[0] + moments[1] < moments[2] - slack:
            raise DesignError(
                "no body can have these moments: the largest principal moment about the centre of mass exceeds the sum of "
                "the other two",
                ("inertia",),
            )


def _inertia_table(entries) -> tuple[Vector, Vector, Vector]:
    entries = list(entries)
    nested = [hasattr(entry, "__len__") and not isinstance(entry, str) for entry in entries]
    if len(entries) != 3 or any(nested) != all(nested):
        raise DesignError("takes three moments or a 3x3 table, kg m^2", ("inertia",))
    if not nested[0]:
        moments = [checked_number(e, "kg m^2", "non-negative", ("inertia", i)) for i, e in enumerate(entries)]
        return tuple(tuple(m if i == j else 0.0 for j in range(3)) for i, m in enumerate(moments))  # type: ignore[return-value]
    if any(len(row) != 3 for row in entries):
        raise DesignError("a table of inertia has three rows of three", ("inertia",))
    table = [
        [checked_number(e, "kg m^2", "any", ("inertia", i, j)) for j, e in enumerate(row)] for i, row in enumerate(entries)
    ]
    if not np.allclose(table, np.transpose(table), rtol=1e-9, atol=0):
        raise DesignError("must be symmetric", ("inertia",))
    return tuple(tuple(row) for row in table)  # type: ignore[return-value]


@dataclass(frozen=True)
class Placement:
    """One wheel at its place: ``contact_direction`` R̂ and ``drive_direction`` v̂, unit vectors, perpendicular.

    ``ring`` counts the entry of the design file that the wheel came from, from 1, for messages.
    """

    wheel: Wheel
    contact_direction: Vector
    drive_direction: Vector
    ring: int = field(default=1, compare=False)

    def __post_init__(self) -> None:
        R_hat = _direction(self.contact_direction, "contact")
        v_hat = _direction(self.drive_direction, "drive")
        along = sum(a * b for a, b in zip(R_hat, v_hat, strict=True))
        if abs(along) > 1e-6:
            angle = math.degrees(math.acos(min(1.0, max(-1.0, along))))
            raise DesignError(f"must be perpendicular to contact, but the two stand {angle:.6g} deg apart", ("drive",))
        # Only rounding is left to remove: the caller's perpendicular is kept to the last digit where it is exact.
        if along != 0.0:
            v_hat = _unit([b - along * a for a, b in zip(R_hat, v_hat, strict=True)])
        object.__setattr__(self, "contact_direction", R_hat)
        object.__setattr__(self, "drive_direction", v_hat)

    @classmethod
    def at(cls, wheel: Wheel, azimuth: float, elevation: float, heading: float = 0.0, ring: int = 1) -> Placement:
        """The wheel at azimuth φ and elevation ε (rad) with heading χ (rad) from east towards north."""
        if abs(elevation) > math.pi / 2 * (1 + 1e-12):
            raise DesignError(
                f"is {math.degrees(elevation):.6g} deg, but an elevation runs from -90 to 90 deg; bare numbers are radians",
                ("elevation",),
            )
        R_hat = outward(azimuth, elevation)
        v_hat = heading_direction(azimuth, elevation, heading)
        return cls(wheel, tuple(R_hat), tuple(v_hat), ring)

    @property
    def azimuth_elevation_heading(self) -> Vector:
        """φ, ε and χ of the placement, rad."""
        return tuple(float(a) for a in angles(self.contact_direction, self.drive_direction))  # type: ignore[return-value]


def _direction(entries, name: str) -> Vector:
    numbers = [checked_number(e, "", "any", (name, i)) for i, e in enumerate(entries)]
    if len(numbers) != 3:
        raise DesignError("takes three components, x, y and z", (name,))
    if math.hypot(*numbers) < 1e-9:
        raise DesignError("points nowhere: all its components are zero", (name,))
    return _unit(numbers)


def _unit(numbers: list[float]) -> Vector:
    # In plain numbers: the sums of a linear algebra library differ from processor to processor in their last digit.
    length = math.hypot(*numbers)
    return tuple(number / length for number in numbers)  # type: ignore[return-value]


@dataclass(frozen=True)
class Contact:
    """The wheel-sphere interface; resistance arms in m."""

    stiffness: float | None = quantity("N/m", "contact stiffness K; rigid if absent", sign="non-negative", default=None)
    damping: float = quantity("N s/m", "contact damping C", sign="non-negative", default=0.0)
    friction: float | None = quantity("", "coefficient of friction", sign="non-negative", default=None)
    rolling_arm: float | None = quantity("m", "lever arm of rolling resistance", sign="non-negative", default=None)
    spin_arm: float | None = quantity("m", "lever arm of spin resistance", sign="non-negative", default=None)
    law: str = word(
        "normal force by depth: straight, or with Hertz's power 3/2 by the moduli", ("linear", "hertz"), default="linear"
    )
    dissipation: float = quantity(
        "s/m", "damping after Hunt and Crossley: share of the normal force by rate of depth", sign="non-negative", default=0.0
    )
    creep_speed: float = quantity("m/s", "slip speed at which friction has 71 % of its full size", default=1e-4)

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Mount:
    """The wheel-stage interface: what each wheel is mounted on, along its contact direction."""

    stiffness: float | None = quantity("N/m", "mount stiffness k; rigid if absent", sign="non-negative", default=None)
    damping: float = quantity("N s/m", "mount damping c", sign="non-negative", default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Spring:
    """One closure spring along ``direction``."""

    direction: Vector = quantity("", "direction of the spring", sign="any", shape=(3,))
    stiffness: float = quantity("N/m", "stiffness of the spring", sign="non-negative")
    damping: float = quantity("N s/m", "damping of the spring", sign="non-negative", default=0.0)

    def __post_init__(self) -> None:
        check_fields(self)
        object.__setattr__(self, "direction", _direction(self.direction, "direction"))


@dataclass(frozen=True)
class Closure:
    """What holds the sphere on its wheels; it sits on the stage."""

    stiffness: float = quantity("N/m", "stiffness K' of a pad opposite every wheel", sign="non-negative", default=0.0)
    damping: float = quantity("N s/m", "damping C' of the pads", sign="non-negative", default=0.0)
    force: Vector = quantity("N", "constant force on the sphere", sign="any", shape=(3,), default=(0.0, 0.0, 0.0))
    springs: tuple[Spring, ...] = field(default=(), metadata={"items": Spring, "doc": "springs at given directions"})

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Stage:
    """The translational stage that carries the machine."""

    mass: float | None = quantity("kg", "mass of the stage without wheels", default=None)
    gravity: bool = field(default=True, metadata={"flag": True, "doc": "whether gravity acts"})

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Motor:
    """Limits of one wheel's motor, at the wheel."""

    torque: float | None = quantity("N m", "largest torque", default=None)
    speed: float | None = quantity("rad/s", "largest speed", default=None)
    proportional_gain: float | None = quantity(
        "N m s/rad", "speed loop: torque by speed error", sign="non-negative", default=None
    )
    integral_gain: float | None = quantity("N m/rad", "speed loop: torque by angle error", sign="non-negative", default=None)

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Design:
    """A whole machine. Wheels are numbered by their place in ``placements``, from 1 in what people read."""

    name: str = word("name of the design")
    sphere: Sphere = field()
    placements: tuple[Placement, ...] = field()
    contact: Contact = field(default_factory=Contact)
    mount: Mount = field(default_factory=Mount)
    closure: Closure = field(default_factory=Closure)
    stage: Stage = field(default_factory=Stage)
    motor: Motor = field(default_factory=Motor)
    source: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "placements", tuple(self.placements))
        if not self.placements:
            raise DesignError("a design needs at least one wheel", ("placement",))
        if len(self.placements) > 1000:
            raise DesignError(f"has {len(self.placements)} wheels; a design takes 1000 at most", ("placement",))
        for placement in self.placements:
            wheel = placement.wheel
            for race in self.races(wheel):
                try:
                    race.deflection(self.sphere.radius)
                except DesignError as error:
                    raise error.under("wheels", wheel.name) from None
        self._refuse_shared_places()

    def _refuse_shared_places(self) -> None:
        wheels = list(range(self.wheel_count))
        split = [i for i in wheels if any(race.antipodal for race in self.races(self.wheels[i]))]
        places = np.vstack([self.contact_directions, -self.contact_directions[split]])
        for a, b in _close_pairs(places):
            i, j = sorted(((wheels + split)[a], (wheels + split)[b]))
            raise DesignError(
                f"wheels {i + 1} and {j + 1} touch the sphere at the same point; no two wheels fit there",
                ("placement", self.placements[j].ring - 1),
            )

    def races(self, wheel: Wheel):
        """The races of ``wheel`` as they meet this design's sphere."""
        try:
            return wheel.races(self.sphere.radius)
        except DesignError as error:
            raise error.under("wheels", wheel.name) from None

    @property
    def wheel_count(self) -> int:
        """n."""
        return len(self.placements)

    @cached_property
    def wheels(self) -> tuple[Wheel, ...]:
        """The wheel model at each place."""
        return tuple(placement.wheel for placement in self.placements)

    @cached_property
    def contact_directions(self) -> np.ndarray:
        """R̂ of each wheel, (n, 3), read-only."""
        return _frozen(np.array([placement.contact_direction for placement in self.placements]))

    @cached_property
    def drive_directions(self) -> np.ndarray:
        """v̂ of each wheel, (n, 3), read-only."""
        return _frozen(np.array([placement.drive_direction for placement in self.placements]))

    @cached_property
    def wheel_radii(self) -> np.ndarray:
        """r of each wheel, (n,), m, read-only."""
        return _frozen(np.array([wheel.radius for wheel in self.wheels]))

    def rotated(self, rotation) -> Design:
        """The same machine turned by a rotation matrix (3, 3), everything fixed to the stage with it."""
        turn = np.asarray(rotation, float)
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-9) or np.linalg.det(turn) < 0:
            raise DesignError("a rotation takes an orthogonal 3x3 matrix of determinant 1")
        placements = tuple(
            replace(
                p,
                contact_direction=tuple(turn @ p.contact_direction),
                drive_direction=tuple(turn @ p.drive_direction),
            )
            for p in self.placements
        )
        springs = tuple(replace(s, direction=tuple(turn @ s.direction)) for s in self.closure.springs)
        closure = replace(self.closure, force=tuple(turn @ self.closure.force), springs=springs)
        return replace(self, placements=placements, closure=closure)

    def __str__(self) -> str:
        # A value that can describe itself: the one import that runs upward, when it is asked for.
        from spheredrive.summary import design_table

        return design_table(self)


def _frozen(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


def _close_pairs(directions: np.ndarray):
    gap = np.linalg.norm(directions[:, None, :] - directions[None, :, :], axis=-1)
    pairs = np.argwhere(np.triu(gap < SAME_DIRECTION, k=1))
    return [(int(i), int(j)) for i, j in pairs]
