"""A wheel's outline as the sphere feels it, h(ϑ) = r_w − r_b: one form for every kind of wheel and of model."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError, did_you_mean
from spheredrive.shape import half_sine, kernels, measured
from spheredrive.shape.envelope import Envelope, envelope, nominal_height, touching_races
from spheredrive.shape.pieces import Pieces
from spheredrive.shape.polynomial import derivatives_at_ends, exact_pieces, extremes
from spheredrive.wheels.base import RollerWheel
from spheredrive.wheels.measured import MeasuredWheel

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.wheels.base import Race, Wheel

KINDS = ("round", "exact", "half-sine", "measured")
# A corner below this share of the wheel's radius (m/rad) is rounding where two smooth pieces meet.
SMOOTH = 1e-12


@dataclass(frozen=True, eq=False)
class Profile:
    """h(ϑ) = r_w − r_b of one wheel: periodic, smooth pieces between breakpoints. Arrays are read-only.

    period          2π/n_r for n_r rollers a race, 2π for a measured wheel, rad
    breakpoints     (p + 1,) rising angles with phase, rad; the first in [0, period), the last one period later
    coefficients    (p, d + 1), m: h = Σ a_k u^k on piece j, u = (ϑ + phase − b_j)/(b_{j+1} − b_j) in [0, 1]
    slope_jumps     (p,) h′ after less h′ before each b_j, m/rad; zero where the outline is smooth
    phase           added to the wheel's angle, rad
    radius          r_b, from which h counts, m; of a wheel of several races, that at the wheel's middle
    kind            "round", "exact", "half-sine" or "measured"
    rolling_radius  mean r_eff over a turn, m: what an encoder should use
    sphere_lever    (p,) R cos Δθ of the race that holds the sphere on each piece, m
    wheel_lever     (p,) D_nominal − R cos Δθ, m: r for a race at the wheel's middle, r − r_r (1 − cos Δθ) beside it
    """

    period: float
    breakpoints: np.ndarray
    coefficients: np.ndarray
    slope_jumps: np.ndarray
    phase: float
    radius: float
    kind: str
    rolling_radius: float
    sphere_lever: np.ndarray
    wheel_lever: np.ndarray

    def height(self, angle) -> np.ndarray:
        """h at the wheel's angle ϑ (rad), m; any shape in, the same out."""
        return self._derivative(angle, 0)

    def slope(self, angle) -> np.ndarray:
        """dh/dϑ, m/rad; at a corner the value after it."""
        return self._derivative(angle, 1)

    def curvature(self, angle) -> np.ndarray:
        """d²h/dϑ² off the corners, m/rad²; at a breakpoint the value after it."""
        return self._derivative(angle, 2)

    @functools.cached_property
    def depth(self) -> float:
        """Largest h less the smallest, Δr, m."""
        low, high = self.extremes(0)
        return high - low

    def extremes(self, order: int) -> tuple[float, float]:
        """Least and largest value of h (``order`` 0), h′ (1) or h″ (2) over a turn, off the corners."""
        return extremes(np.diff(self.breakpoints), self.coefficients, order)

    def piece(self, angle) -> np.ndarray:
        """Number of the piece, from 0, that the wheel's angle ϑ (rad) lies on, of the same shape."""
        first = self.breakpoints[0]
        folded = first + np.mod(np.asarray(angle, float) + self.phase - first, self.period)
        found = np.searchsorted(self.breakpoints, folded, side="right") - 1
        return np.clip(found, 0, len(self.coefficients) - 1)

    def _derivative(self, angle, order: int) -> np.ndarray:
        angle = np.asarray(angle, float)
        if not np.isfinite(angle).all():
            raise SpheredriveError("a wheel angle must be finite")
        flat = np.ascontiguousarray(angle.ravel()) + self.phase
        out = np.empty_like(flat)
        kernels.polynomial_values(flat, self.period, self.breakpoints, self.coefficients, order, out)
        return out.reshape(angle.shape)[()]


def profile(
    wheel: Wheel,
    sphere_radius: float,
    kind: str | None = None,
    race: int | None = None,
    roller_profile=None,
    smoothing: float | None = None,
) -> Profile:
    """The outline of ``wheel`` against a sphere of ``sphere_radius`` (m), as a function of the wheel's angle.

        h(ϑ) = D(ϑ) − D_nominal,   D the distance of the centres while the sphere rests on the rollers

    kind            "exact": the envelope of the rollers; "half-sine": the thesis's; "measured": a smoothed outline; "round":
                    h = 0. None: what the wheel's own keys say
    race            number of the one race to follow, from 1; None: all races at R̂ together. The second race of a split
                    dual-race wheel touches at −R̂ and is a contact of its own, asked for by race = 2: its h pushes the sphere
                    the other way, half a pitch later. Between two wheels at a fixed distance one of the two contacts is open
                    at any time but where both are on their rollers; which, is for a model of the seat to say
    roller_profile  table ((s, ρ), ...) of an uneven roller's places and radii, m (``roller.tabulated_generatrix``)
    smoothing       of a measured outline (``measured.smoothed``)

    Equal wheels share one ``Profile``. The exact pieces are polynomials fitted to the exact second derivative and integrated,
    so that h, h′ and h″ all agree with the geometry to about 1e-13 of their largest value. Raises ``DesignError`` naming the
    key for wheels that are not described, whose rollers overlap, or that let the sphere fall in between. Source: model.md
    section 3.
    """
    if not (isinstance(sphere_radius, (int, float, np.number)) and math.isfinite(sphere_radius) and sphere_radius > 0):
        raise SpheredriveError(f"the sphere's radius must be a positive number of metres, not {sphere_radius!r}")
    if kind is not None and kind not in KINDS:
        raise SpheredriveError(f"there is no kind of profile {kind!r}{did_you_mean(kind, KINDS)}")
    rows = None if roller_profile is None else tuple(tuple(float(x) for x in row) for row in roller_profile)
    return _profile(wheel, float(sphere_radius), kind, race, rows, smoothing)


def profiles(design: Design) -> tuple[Profile, ...]:
    """The outline of each wheel of a design, in the order of its wheels; equal wheels share one.

    Raises ``DesignError`` whose key leads to the wheel. Source: model.md section 3.
    """
    found = []
    for wheel in design.wheels:
        try:
            found.append(profile(wheel, design.sphere.radius))
        except DesignError as error:
            raise error.under("wheels", wheel.name) from None
    return tuple(found)


@functools.lru_cache(maxsize=1024)
def _profile(wheel, sphere_radius, kind, race, roller_profile, smoothing) -> Profile:
    races = touching_races(wheel, sphere_radius, race)
    kind = _kind(wheel, kind)
    if kind == "exact":
        return _exact(wheel, sphere_radius, race, roller_profile)
    if kind == "half-sine":
        pieces = half_sine.half_sine(wheel, sphere_radius)
    elif kind == "measured":
        pieces = measured.smoothed(wheel, smoothing)
    else:
        pieces = Pieces(2 * math.pi / (wheel.rollers_per_race or 1), np.array([0.0]), np.zeros((1, 1)))
    levers = _levers(races[0], sphere_radius, nominal_height(races[0], sphere_radius))
    return _assembled(pieces, wheel, kind, np.tile(levers, (len(pieces.starts), 1)))


def _kind(wheel: Wheel, kind: str | None) -> str:
    """The kind that is asked for, or that the wheel's keys say; without gaps a standard wheel is round [3.11]."""
    if isinstance(wheel, MeasuredWheel):
        natural = "measured"
    elif not isinstance(wheel, RollerWheel) or getattr(wheel, "roundness", None) == 0:
        natural = "round"
    else:
        return kind if kind in ("round", "half-sine") else _own(wheel, kind)
    if kind in (None, "round", natural) or (natural == "round" and kind != "measured"):
        return "round" if kind == "round" else natural
    raise DesignError(f"a {wheel.type} wheel has no profile {kind!r}; its own is {natural!r}")


def _own(wheel: RollerWheel, kind: str | None) -> str:
    if kind == "measured":
        raise DesignError("a measured profile takes a wheel of type 'measured' with its outline")
    return kind or wheel.profile


@functools.lru_cache(maxsize=1024)
def exact_envelope(wheel: RollerWheel, sphere_radius: float, race: int | None = None, roller_profile=None) -> Envelope:
    """``envelope``, kept: equal wheels share one."""
    return envelope(wheel, sphere_radius, race, roller_profile)


def _exact(wheel: RollerWheel, sphere_radius: float, race: int | None, roller_profile) -> Profile:
    shape = exact_envelope(wheel, sphere_radius, race, roller_profile)
    columns = [kernels.HEIGHT, kernels.SLOPE, kernels.CURVATURE]
    scale = _largest_curvature(shape)
    starts, rows, levers = [], [], []
    for strip in shape.strips:
        body, held_by = shape.rollers[strip.rank], shape.races[strip.rank]
        if strip.region == kernels.SIDE and body.barrel_radius and body.square and held_by.offset == 0:
            # A square barrel in the wheel's plane holds the sphere at R + r_b all along.
            new = [strip.start], [np.array([held_by.radius])]
        else:
            new = exact_pieces(strip.start, strip.end, lambda x, strip=strip: shape.outline(strip, x)[:, columns], scale)
        starts += new[0]
        rows += new[1]
        levers += [_levers(held_by, sphere_radius, shape.nominal)] * len(new[0])
    coefficients = np.zeros((len(rows), max(map(len, rows))))
    for row, powers in zip(coefficients, rows, strict=True):
        row[: len(powers)] = powers
    coefficients[:, 0] -= shape.nominal
    return _assembled(Pieces(shape.pitch, np.array(starts), coefficients), wheel, "exact", np.array(levers))


def _largest_curvature(shape: Envelope) -> float:
    """Largest |r_w″| at the ends and middles of the strips, at least a tenth of the wheel's radius.

    The terms that r_w″ is the difference of are of the size of the radius, so their rounding is too.
    """
    found = [abs(shape.nominal) * 0.1]
    for strip in shape.strips:
        angles = np.array([strip.start, 0.5 * (strip.start + strip.end), strip.end])
        found.append(np.abs(shape.outline(strip, angles)[:, kernels.CURVATURE]).max())
    return max(found)


def _levers(race: Race, sphere_radius: float, nominal: float) -> tuple[float, float]:
    """R cos Δθ and D_nominal − R cos Δθ at a race, m."""
    sine = math.sin(race.deflection(sphere_radius))
    drop = sphere_radius * sine * sine / (1 + math.sqrt(1 - sine * sine))
    return sphere_radius - drop, nominal + drop


def _assembled(pieces: Pieces, wheel: Wheel, kind: str, levers: np.ndarray) -> Profile:
    """A ``Profile`` of pieces: starts brought into the first period, corners and the mean rolling radius found."""
    period, starts, coefficients = pieces
    starts = starts - period * math.floor(starts[0] / period)
    if starts[0] >= period:
        starts = starts - period
    breakpoints = np.append(starts, starts[0] + period)
    widths = np.diff(breakpoints)
    after, before = derivatives_at_ends(widths, coefficients)
    jumps = after - np.roll(before, 1)
    jumps[np.abs(jumps) < SMOOTH * wheel.radius] = 0.0
    mean = _mean_rolling_radius(widths, coefficients, levers)
    sphere_lever, wheel_lever = np.ascontiguousarray(levers.T)
    coefficients = np.ascontiguousarray(coefficients)
    for array in (breakpoints, coefficients, jumps, sphere_lever, wheel_lever):
        array.flags.writeable = False
    fields = (breakpoints, coefficients, jumps, wheel.phase_angle, wheel.radius, kind, mean, sphere_lever, wheel_lever)
    return Profile(period, *fields)


def _mean_rolling_radius(widths: np.ndarray, coefficients: np.ndarray, levers: np.ndarray) -> float:
    """Mean of ``rolled`` over the period, by Gauss's rule on each piece."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    powers = (0.5 * (nodes + 1))[:, None] ** np.arange(coefficients.shape[1])
    k = np.arange(1, coefficients.shape[1])
    h, slope = coefficients @ powers.T, (coefficients[:, 1:] * k) @ powers[:, :-1].T / widths[:, None]
    radii = rolled(h, slope, *levers.T[:, :, None])
    return float(widths @ (radii @ weights) / 2 / widths.sum())


def rolled(h, slope, sphere_lever, wheel_lever) -> np.ndarray:
    """r_roll = √(D² + h′²) − R cos Δθ with D = R cos Δθ + lever + h, all in m; broadcast.

    Source: model.md section 3; beside the wheel's middle R cos Δθ and the race's lever stand for R and r.
    """
    radius = wheel_lever + h
    D = sphere_lever + radius
    # √(D² + h′²) − D, without the loss of digits.
    return radius + slope**2 / (D + np.hypot(D, slope))
