"""Where on the wheel the sphere is touched while it turns, and the rolling radius that goes with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.shape import kernels
from spheredrive.shape.profile import Profile, exact_envelope, profile, rolled
from spheredrive.wheels.base import RollerWheel

if TYPE_CHECKING:
    from spheredrive.wheels.base import Wheel


class Wander(NamedTuple):
    """Where a wheel touches the sphere; every field has the shape of the angle that was asked for.

    offset   of the contact point along ŵ from the wheel's middle plane, m
    tilt     of the contact direction against R̂ towards ŵ, rad: a race's Δθ where it touches at its middle
    lean     of the contact direction against R̂ towards v̂ within the wheel's plane, rad: tan(lean) = −D′/D
    turn     β of the touching roller: angle of its middle about ŵ from the line of centres, rad
    race     number of the race that touches
    """

    offset: np.ndarray
    tilt: np.ndarray
    lean: np.ndarray
    turn: np.ndarray
    race: np.ndarray


def wander(wheel: Wheel, sphere_radius: float, angle, race: int | None = None, roller_profile=None) -> Wander:
    """How the contact point of ``wheel`` on a sphere of ``sphere_radius`` (m) wanders while the wheel turns.

        contact direction = (−cos lean cos tilt, sin lean cos tilt, sin tilt) in the wheel's frame: −R̂ … from the sphere's
        centre,   offset = R sin tilt

    It is that of the exact outline, whatever profile the wheel names; the rollers of one hand wander one way as the other hand
    the other. ``angle`` ϑ in rad, of any shape; ``race`` and ``roller_profile`` as for ``profile``. Where outer races touch
    together, the one of the lower number is given. A wheel without rollers (ideal, measured) touches at its middle; its lean
    is its outline's. Raises as ``profile``. Source: model.md section 3.
    """
    angle = np.asarray(angle, float)
    if not np.isfinite(angle).all():
        raise SpheredriveError("a wheel angle must be finite")
    if not isinstance(wheel, RollerWheel) or getattr(wheel, "roundness", None) == 0:
        outline = profile(wheel, sphere_radius)
        lean = np.arctan2(-outline.slope(angle), sphere_radius + wheel.radius + outline.height(angle))
        nothing = np.zeros(angle.shape)
        return Wander(nothing, nothing, lean, nothing, np.ones(angle.shape, int))
    rows = None if roller_profile is None else tuple(tuple(float(x) for x in row) for row in roller_profile)
    shape = exact_envelope(wheel, float(sphere_radius), race, rows)
    numbers, folded = shape.strip_numbers(angle.ravel() + wheel.phase_angle)
    along, axial, turn, touching = *np.empty((3, *folded.shape)), np.empty(folded.shape, int)
    for j, strip in enumerate(shape.strips):
        here = numbers == j
        if here.any():
            rows_here = shape.outline(strip, folded[here])
            along[here], axial[here] = rows_here[:, kernels.ALONG], rows_here[:, kernels.AXIAL]
            turn[here] = folded[here] - strip.centre
            touching[here] = shape.races[strip.rank].number
    tilt = np.arcsin(axial / sphere_radius)
    lean = np.arcsin(along / np.sqrt(sphere_radius**2 - axial**2))
    return Wander(*(field.reshape(angle.shape)[()] for field in (axial, tilt, lean, turn, touching)))


def rolling_radius(outline: Profile, angle) -> np.ndarray:
    """Instantaneous rolling radius r_roll = √((R + r_w)² + r_w′²) − R, r_w = r_b + h, at wheel angles ϑ (rad), m.

    On a race beside the wheel's middle R cos Δθ stands for R and the race's lever for r_b. The mean over a turn is
    ``outline.rolling_radius``: the length of the path of the sphere's centre around the wheel, less the sphere's own turn.
    Any shape in, the same out. Source: model.md section 3.
    """
    piece = outline.piece(angle)
    levers = outline.sphere_lever[piece], outline.wheel_lever[piece]
    return rolled(outline.height(angle), outline.slope(angle), *levers)


class Excitation(NamedTuple):
    """What a turning wheel does to the distance of the centres.

    depth         largest less smallest height, m
    velocity      largest |h′| ω, m/s
    acceleration  largest |h″| ω² off the corners, m/s²
    impulses      jump of the velocity at each corner of a period, (..., corners), m/s: an impulse per mass
    """

    depth: float
    velocity: np.ndarray
    acceleration: np.ndarray
    impulses: np.ndarray


def excitation(outline: Profile, wheel_speed) -> Excitation:
    """Depth of an outline, and the velocity, acceleration and corners that it excites at a steady ``wheel_speed`` ω (rad/s).

    ``wheel_speed`` of any shape (...). Source: model.md section 3, [4.4–4.6] and E3: a corner is an impulse in r̈_w.
    """
    speed = np.asarray(wheel_speed, float)
    if not np.isfinite(speed).all():
        raise SpheredriveError("a wheel speed must be finite")
    slope, curvature = (max(map(abs, outline.extremes(order))) for order in (1, 2))
    corners = outline.slope_jumps[outline.slope_jumps != 0]
    # Turned backwards, a corner is passed from the other side and its jump keeps its sign.
    impulses = np.abs(speed)[..., None] * corners
    return Excitation(outline.depth, slope * np.abs(speed), curvature * speed**2, impulses)
