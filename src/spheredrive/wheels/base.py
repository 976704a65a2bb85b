"""What every wheel type has: its keys, its races of rollers, and which races touch the sphere together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from spheredrive.errors import DesignError
from spheredrive.values import check_fields, check_poisson_ratio, quantity, whole, word


@dataclass(frozen=True)
class Race:
    """One ring of rollers.

    number          counted from 1 in the order of rising offset
    offset          o along the wheel's axis ŵ, m
    radius          outer radius of the wheel at this race, m
    roller_radius   cross-section of its rollers, m
    antipodal       whether it touches the sphere at −R̂, driven along −v̂
    """

    number: int
    offset: float
    radius: float
    roller_radius: float
    antipodal: bool = False

    def deflection(self, sphere_radius: float) -> float:
        """Angle Δθ (rad) between the wheel's and the race's contact direction: sin Δθ = o / (R + r_r) [2.59]."""
        sine = self.offset / (sphere_radius + self.roller_radius)
        if not abs(sine) < 1:
            raise DesignError(
                f"a race {abs(self.offset):g} m beside the wheel's middle cannot touch a sphere of radius "
                f"{sphere_radius:g} m; the races must stand closer together",
                ("race_spacing",),
            )
        return math.asin(sine)


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """A wheel model: what all types share. Lengths in m, angles in rad, masses in kg.

    A type is a subclass in a file of its own. It names its ``type``, adds its keys, lists its ``races`` and says in
    ``alternation`` which races touch the sphere together, by race number, in the order in which they take turns.
    """

    type: ClassVar[str]
    alternation: ClassVar[tuple[tuple[int, ...], ...]] = ((1,),)

    radius: float = quantity("m", "outer radius, at the contact")
    roller_angle: float = quantity(
        "rad", "angle between roller axis and wheel axis; the sign is the hand", sign="any", default=math.pi / 2
    )
    mass: float | None = quantity("kg", "mass of the whole wheel", default=None)
    axial_inertia: float | None = quantity(
        "kg m^2", "moment of inertia about the wheel's axis; a solid disc's if absent", default=None
    )
    young_modulus: float | None = quantity("Pa", "Young's modulus of the rollers", default=None)
    poisson_ratio: float | None = quantity("", "Poisson's ratio of the rollers", sign="any", default=None)
    name: str = word("name of the model", default="wheel")

    def __post_init__(self) -> None:
        check_fields(self)
        check_poisson_ratio(self.poisson_ratio)
        tilt = abs(self.roller_angle)
        if not math.radians(1) <= tilt <= math.pi / 2 * (1 + 1e-12):
            raise DesignError(
                f"is {math.degrees(self.roller_angle):g} deg, but a roller must stand 1 to 90 deg off the wheel's axis, "
                "to either hand",
                ("roller_angle",),
            )

    def races(self, sphere_radius: float) -> tuple[Race, ...]:
        """The wheel's races as they meet a sphere of ``sphere_radius`` (m)."""
        return (Race(1, 0.0, self.radius, self.roller_section),)

    @property
    def roller_section(self) -> float:
        """Radius of a roller's cross-section, m; zero where the wheel has no rollers to speak of."""
        return 0.0

    @property
    def rollers_per_race(self) -> int | None:
        """N, or None where the type does not say."""
        return None

    def state_index(self, wheel_angle) -> np.ndarray:
        """Which entry of ``alternation`` touches the sphere at ``wheel_angle`` (rad): floor(N ϑ / π) mod 2 [2.56]."""
        wheel_angle = np.asarray(wheel_angle, float)
        if len(self.alternation) == 1:
            return np.zeros(wheel_angle.shape, dtype=np.int64)
        return self.half_pitches(wheel_angle) % len(self.alternation)

    def half_pitches(self, wheel_angle) -> np.ndarray:
        """How many half roller pitches the wheel has turned: floor(N (ϑ + phase) / π), whole numbers."""
        return np.floor((np.asarray(wheel_angle, float) + self.phase_angle) / self.half_pitch).astype(np.int64)

    @property
    def half_pitch(self) -> float:
        """Angle of the wheel between changes of race, π / N, rad; infinite where the races never take turns."""
        if len(self.alternation) == 1 or self.rollers_per_race is None:
            return math.inf
        return math.pi / self.rollers_per_race

    @property
    def phase_angle(self) -> float:
        """Wheel angle (rad) by which the rollers are ahead of the zero position."""
        return 0.0

    @property
    def spin_inertia(self) -> float | None:
        """Moment of inertia about the wheel's axis, kg m²: as given, else a solid disc's ½ m r²."""
        if self.axial_inertia is not None or self.mass is None:
            return self.axial_inertia
        return 0.5 * self.mass * self.radius**2


@dataclass(frozen=True, kw_only=True)
class RollerWheel(Wheel):
    """A wheel whose rollers are described: what all types but the ideal and the measured one share."""

    race_count: ClassVar[int] = 1
    # Whether a turn starts with a gap between two rollers [3.8], not on top of one [4.6], where races do not take turns.
    gap_comes_first: ClassVar[bool] = False

    rollers: int | None = whole("number of rollers, all races together", least=2, default=None)
    roller_radius: float | None = quantity("m", "radius of a roller's cross-section", default=None)
    roller_shape: str = word("shape of a roller", ("barrel", "cylinder", "sphere", "capsule"), default="barrel")
    roller_length: float | None = quantity("m", "length of a roller along its axis, without round ends", default=None)
    phase: float = quantity("rad", "wheel angle by which the rollers are ahead", sign="any", default=0.0)
    roller_drag: float = quantity(
        "N m s/rad", "drag torque of a roller's bearing by its speed", sign="non-negative", default=0.0
    )
    roller_inertia: float = quantity(
        "kg m^2", "moment of inertia of a roller about its own axis; zero: it follows at once", sign="non-negative", default=0.0
    )
    profile: str = word("radial profile of the wheel", ("exact", "half-sine"), default="exact")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.roller_radius is not None and self.roller_radius >= self.radius:
            raise DesignError(
                f"a roller of radius {self.roller_radius:g} m does not fit into a wheel of radius {self.radius:g} m",
                ("roller_radius",),
            )
        if self.rollers is not None and (self.rollers % self.race_count or self.rollers < 2 * self.race_count):
            raise DesignError(
                f"{self.rollers} rollers do not share out over {self.race_count} equal races of at least two; "
                "count the rollers of all races together",
                ("rollers",),
            )

    @property
    def roller_section(self) -> float:
        return self.roller_radius or 0.0

    @property
    def rollers_per_race(self) -> int | None:
        return None if self.rollers is None else self.rollers // self.race_count

    @property
    def roller_share(self) -> float | None:
        """Angle of the turn (rad) that one roller should cover: a pitch, shared with the races that take turns with it."""
        return None if self.rollers_per_race is None else 2 * math.pi / (self.rollers_per_race * len(self.alternation))

    def half_sine(self, sphere_radius: float) -> tuple[float, float]:
        """Width (rad of the wheel's angle) and depth (m) of the half sine that stands for a valley in the thesis."""
        raise DesignError(
            f"the half sine is defined for standard and mecanum wheels, not for {self.type}; take the exact profile",
            ("profile",),
        )

    @property
    def phase_angle(self) -> float:
        return self.phase


@dataclass(frozen=True, kw_only=True)
class SpacedRaceWheel(RollerWheel):
    """A wheel with races side by side, which cannot do without what places them and tells when they take turns."""

    rollers: int = whole("number of rollers, all races together", least=2)
    roller_radius: float = quantity("m", "radius of a roller's cross-section")
    race_spacing: float = quantity("m", "distance between neighbouring races, d")
