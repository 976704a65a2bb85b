"""The rollers of a wheel as bodies: a surface of revolution, where its axis lies in the wheel, and whether they all fit in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError

if TYPE_CHECKING:
    from spheredrive.wheels.base import Race, RollerWheel

# Rollers may overlap by this share of their radius: figures of real wheels are rounded.
SLACK = 1e-3
# A roller axis nearer to square across the wheel than this (rad) is square.
SQUARE = 1e-9


@dataclass(frozen=True)
class Roller:
    """A roller, the envelope of balls of radius ρ(s) about the points s of its axis, |s| ≤ L.

    axis_distance   a, of the roller's axis from the wheel's, m
    tilt            α, between the two axes, rad; the sign is the hand
    half_length     L: the axis carries balls for |s| ≤ L, m. A flat end cuts the surface where the last ball touches it,
                    which for ρ′ ≠ 0 is not at s = L but at s = L − ρρ′
    rounded         whether the last ball is the end (capsule, sphere) or a flat cut
    barrel_radius   r_b of a barrel inscribed in the wheel's cylinder, ρ = r_b − √(a² + s² sin² α), m; zero for a table
    knots, table    else ρ as cubic pieces: ρ = Σ table[j][k] (s − knots[j])^k for knots[j] ≤ s ≤ knots[j+1]
    """

    axis_distance: float
    tilt: float
    half_length: float
    rounded: bool = False
    barrel_radius: float = 0.0
    knots: tuple[float, ...] = (0.0,)
    table: tuple[tuple[float, float, float, float], ...] = ((0.0, 0.0, 0.0, 0.0),)

    @property
    def square(self) -> bool:
        """Whether the roller stands square across the wheel, α = ±90°."""
        return abs(math.cos(self.tilt)) < SQUARE

    @property
    def sine(self) -> float:
        """sin α."""
        return math.copysign(1.0, self.tilt) if self.square else math.sin(self.tilt)

    @property
    def cosine(self) -> float:
        """cos α, zero where the roller stands square to within rounding of the angle."""
        return 0.0 if self.square else math.cos(self.tilt)

    @property
    def symmetric(self) -> bool:
        """Whether ρ(−s) = ρ(s) is known to hold."""
        return len(self.table) == 1 and self.table[0][1:] == (0.0, 0.0, 0.0)

    def radius(self, s) -> np.ndarray:
        """ρ at the place s on the axis, m, of any shape."""
        s = np.asarray(s, float)
        if self.barrel_radius:
            return self.barrel_radius - np.hypot(self.axis_distance, s * self.sine)
        j = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.table) - 1)
        c, x = np.array(self.table)[j], s - np.array(self.knots)[j]
        return c[..., 0] + x * (c[..., 1] + x * (c[..., 2] + x * c[..., 3]))

    def radius_slope(self, s) -> np.ndarray:
        """dρ/ds at the place s on the axis, of any shape."""
        s = np.asarray(s, float)
        if self.barrel_radius:
            return -s * self.sine**2 / np.hypot(self.axis_distance, s * self.sine)
        j = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.table) - 1)
        c, x = np.array(self.table)[j], s - np.array(self.knots)[j]
        return c[..., 1] + x * (2 * c[..., 2] + x * 3 * c[..., 3])

    def edge(self, side: int = 1) -> tuple[float, float]:
        """Place e along the axis and radius σ of the circle in which the ball at s = ±L touches the surface, m.

        e = s − ρρ′, σ = ρ √(1 − ρ′²): the edge of a flat end.
        """
        s = side * self.half_length
        rho, rho1 = float(self.radius(s)), float(self.radius_slope(s))
        return s - rho * rho1, rho * math.sqrt(max(0.0, 1 - rho1 * rho1))

    def body(self, offset: float, sphere_radius: float) -> np.ndarray:
        """The flat description that the kernels take, of this roller in a race at ``offset`` under a sphere."""
        return np.array(
            [
                self.axis_distance,
                self.sine,
                self.cosine,
                offset,
                sphere_radius,
                self.half_length,
                float(self.rounded),
                self.barrel_radius,
            ]
        )


def tabulated_generatrix(places, radii) -> tuple[tuple[float, ...], tuple[tuple[float, float, float, float], ...]]:
    """``knots`` and ``table`` of a cubic spline ρ(s) through a table of places s (k,) and radii ρ (k,), m.

    Two points give a straight line, three a parabola, more a spline with continuous ρ″ (not-a-knot ends). ρ is the radius of
    the ball about s that touches the roller's surface from within: at a diameter whose slope is small, half of it.
    Raises ``DesignError`` for fewer than two points, places that do not rise and radii that are not positive anywhere between.
    """
    s, rho = np.asarray(places, float), np.asarray(radii, float)
    if s.ndim != 1 or s.shape != rho.shape or len(s) < 2 or not (np.isfinite(s).all() and np.isfinite(rho).all()):
        raise DesignError("a roller's profile takes at least two points of place and radius, all finite", ("roller_profile",))
    if (np.diff(s) <= 0).any():
        raise DesignError("places along the roller must rise from row to row", ("roller_profile",))
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(s, rho)
    dense = spline(np.linspace(s[0], s[-1], 20 * len(s)))
    if dense.min() <= 0:
        raise DesignError(f"the roller's radius falls to {dense.min():g} m; it must stay positive", ("roller_profile",))
    return tuple(map(float, spline.x)), tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in spline.c[::-1].T)


def roller(wheel: RollerWheel, race: Race, roller_profile=None) -> Roller:
    """The body of one roller of ``race``.

    A barrel is inscribed in the race's cylinder. Its length, where several keys could give it, is from ``roundness`` on a
    standard wheel, L = a tan(θ_b/2); else from ``roller_length``, the length of its axis between flat end faces (without the
    round ends of a capsule); else, but for single-race standard wheels, the length that covers the roller's share φ of the
    turn on flat ground, L = a tan(φ/2)/|sin α|: a whole pitch 2π/n_r of a Mecanum wheel, half a pitch where races take turns.

    roller_profile   table ((s, ρ), ...) of places along the axis from the roller's middle and radii, m, instead of
                     ``roller_shape`` (see ``tabulated_generatrix``); flat ends at its first and last place, which must lie
                     at equal distances from the middle

    Raises ``DesignError`` naming the key that is missing, and where rollers overlap or come to a point before their ends.
    Assumes that all rollers of a race are equal. Source: model.md section 3.
    """
    count = wheel.rollers_per_race
    if count is None:
        raise DesignError("the exact outline needs the number of rollers; give rollers", ("rollers",))
    if count < 3:
        raise DesignError(f"{count} rollers a race cannot carry a sphere all around; a race needs at least three", ("rollers",))
    body = _body(wheel, race, count, roller_profile)
    _refuse_overlap(body, count)
    return body


def _body(wheel: RollerWheel, race: Race, count: int, roller_profile) -> Roller:
    shape = wheel.roller_shape
    tilt = wheel.roller_angle
    square = abs(math.cos(tilt)) < SQUARE and race.offset == 0
    r_r = race.roller_radius
    if roller_profile is not None:
        return _tabulated(race, tilt, roller_profile)
    if not r_r and not (shape == "barrel" and square):
        raise DesignError("the exact outline of this wheel needs the rollers' radius; give roller_radius", ("roller_radius",))
    if not r_r:
        # Square barrels in the wheel's own plane touch at r_b all along, whatever the radius of their cross-section.
        return Roller(*_thin_barrel(wheel, race, count), barrel_radius=race.radius)
    a = race.radius - r_r
    constant = ((0.0,), ((r_r, 0.0, 0.0, 0.0),))
    if shape == "sphere":
        return Roller(a, tilt, 0.0, True, 0.0, *constant)
    if shape == "barrel":
        return Roller(a, tilt, _barrel_length(wheel, race, a), False, race.radius)
    given = wheel.roller_length
    L = given / 2 if given is not None else _share_length(wheel, a)
    return Roller(a, tilt, L, shape == "capsule", 0.0, *constant)


def _tabulated(race: Race, tilt: float, roller_profile) -> Roller:
    rows = np.asarray(roller_profile, float)
    if rows.ndim != 2 or rows.shape[1] != 2:
        raise DesignError("a roller's profile takes rows of place and radius", ("roller_profile",))
    knots, table = tabulated_generatrix(*rows.T)
    L = knots[-1]
    if not abs(knots[0] + L) <= 1e-9 * abs(L):
        raise DesignError(
            f"places run from {knots[0]:g} to {knots[-1]:g} m; count them from the roller's middle, as far to either side",
            ("roller_profile",),
        )
    body = Roller(1.0, tilt, L, False, 0.0, knots, table)
    a = race.radius - float(body.radius(0.0))
    if a <= 0:
        raise DesignError("the roller is thicker than the wheel", ("roller_profile",))
    return Roller(a, tilt, L, False, 0.0, knots, table)


def _share(wheel: RollerWheel) -> float:
    """The angle φ (rad) about the wheel's axis that a roller should cover."""
    if wheel.roller_share is None:
        raise DesignError("the exact outline needs the length of the rollers; give roundness or roller_length", ("roundness",))
    return wheel.roller_share


def _share_length(wheel: RollerWheel, a: float) -> float:
    return a * math.tan(_share(wheel) / 2) / abs(math.sin(wheel.roller_angle))


def _barrel_length(wheel: RollerWheel, race: Race, a: float) -> float:
    r_b, S2 = race.radius, math.sin(wheel.roller_angle) ** 2
    longest = math.sqrt(r_b * r_b - a * a) / math.sqrt(S2)
    key = "roundness" if getattr(wheel, "roundness", None) is not None else "roller_length"
    if key == "roundness" or wheel.roller_length is None:
        L = _share_length(wheel, a)
        if longest <= L:
            raise DesignError(
                "barrels this thin come to a point before they have covered their share of the turn; "
                "take more or thicker rollers, or another roller_shape",
                ("roller_radius",) if wheel.roller_length is None else (key,),
            )
        return L
    # Half of the length between the end faces: e(L) = L − ρρ′ = L cos² α + r_b L sin² α/√(a² + L² sin² α), which rises.
    half = wheel.roller_length / 2
    if half >= longest:
        raise DesignError(
            f"barrels of this wheel come to a point {2 * longest:g} m apart; roller_length must be less", ("roller_length",)
        )
    low, high = 0.0, longest
    for _ in range(100):
        L = (low + high) / 2
        if L * (1 - S2) + r_b * L * S2 / math.sqrt(a * a + L * L * S2) < half:
            low = L
        else:
            high = L
    return (low + high) / 2


def _thin_barrel(wheel: RollerWheel, race: Race, count: int) -> tuple[float, float, float]:
    """a, α, L of square barrels of unknown cross-section, which is taken so thin that neighbours do not touch."""
    r_b, given = race.radius, wheel.roller_length
    if given is not None and getattr(wheel, "roundness", None) is None:
        if given >= 2 * r_b:
            raise DesignError(f"a roller {given:g} m long does not fit into a wheel of radius {r_b:g} m", ("roller_length",))
        half_share = math.asin(given / (2 * r_b))
    else:
        half_share = _share(wheel) / 2
    if half_share > math.pi / count * (1 + 1e-9):
        raise DesignError(f"{count} rollers of this length do not fit around the wheel", ("roller_length",))
    # The last ball must have some radius left: r_b cos φ < a < r_b with φ the half share.
    a = r_b * math.cos(half_share) * (1 - 1e-3 * half_share**2)
    return a, wheel.roller_angle, a * math.tan(half_share)


def _refuse_overlap(body: Roller, count: int) -> None:
    """Refuse rollers that cut into their neighbours.

    Round ends and spheres: the last balls' centres stand two radii apart or more. Flat ends, square rollers: the inner
    corner of the end lies within half a pitch, atan(e/(a − σ)) ≤ π/n. Flat ends, tilted rollers: their middles, seen as
    circles of radius ρ(0) around the wheel, do not overlap, a sin(π/n) ≥ ρ(0), the touching circles of [4.4].
    """
    a, half_pitch, rho = body.axis_distance, math.pi / count, float(body.radius(0.0))
    if body.half_length == 0.0 or not body.square:
        room = a * math.sin(half_pitch) / rho
    elif body.rounded:
        reach = math.atan2(body.half_length, a)
        room = math.hypot(a, body.half_length) * math.sin(half_pitch - reach) / rho
    else:
        e, sigma = (max(part) for part in zip(body.edge(1), (-body.edge(-1)[0], body.edge(-1)[1]), strict=True))
        room = half_pitch / math.atan2(e, a - sigma)
    if room < 1 - SLACK:
        raise DesignError(
            f"{count} rollers a race overlap each other, by {100 * (1 / room - 1):.3g} %; take fewer, thinner or shorter ones"
            if room > 0
            else f"{count} rollers a race overlap each other; take fewer or shorter ones",
            ("rollers",),
        )
