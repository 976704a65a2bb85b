"""What other wheels have to do for the sphere's surface to move alike."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.errors import NearSingularWarning, SingularError, SpheredriveError
from spheredrive.motion import Motion


def speeds_alike(first: Design, wheel_speed, other: Design) -> np.ndarray:
    """Wheel speeds (n′,), rad/s, with which ``other`` moves its sphere's surface as ``wheel_speed`` (n,) moves the first's.

        ω′ = J′⁻¹ (R/R′) J ω

    So wheels of half the radius turn twice as fast. The design itself keeps its speeds. Where ``first`` has no Jacobian and as
    many wheels as ``other``, rims move alike instead: ω′ = ω r/r′. Raises ``SpheredriveError`` where neither can be. Source:
    model.md section 2.
    """
    speed = np.asarray(wheel_speed, float)
    if other == first:
        return speed
    try:
        return _between(first, other) @ speed
    except SingularError:
        if first.wheel_count != other.wheel_count:
            raise SpheredriveError(
                f"{first.name} does not determine how its sphere turns, so wheels that are not as many cannot be "
                "made to turn it alike"
            ) from None
        return speed * first.wheel_radii / other.wheel_radii


def motion_alike(first: Design, motion: Motion, other: Design) -> Motion:
    """The motion for ``other`` that does to its sphere what ``motion`` does to that of ``first``.

        ω′ = J′⁻¹ (R/R′) J ω;   Ω′ = (R/R′) Ω;   T′ = J′ᵀ J⁻ᵀ T, the same moment on the sphere

    Raises ``SingularError`` where a Jacobian is asked for that does not exist. Source: model.md sections 2 and 5a.
    """
    if other == first:
        return motion
    motion.check_wheel_count(first.wheel_count)
    if motion.kind == "sphere-velocity":
        turn = np.eye(3) * first.sphere.radius / other.sphere.radius
    elif motion.kind == "wheel-speed":
        turn = _between(first, other)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NearSingularWarning)
            turn = kinematics.jacobian(other).T @ kinematics.inverse_jacobian(first).T
    values = tuple(tuple(row) for row in (motion.series.arrays[1] @ turn.T).tolist())
    angle = motion.wheel_angle if first.wheel_count == other.wheel_count else None
    return replace(motion, series=replace(motion.series, values=values), wheel_angle=angle, source="")


def _between(first: Design, other: Design) -> np.ndarray:
    """From wheel speeds of ``first`` to those of ``other``, (n′, n)."""
    with warnings.catch_warnings():
        # A layout that is nearly singular says so in its own row.
        warnings.simplefilter("ignore", NearSingularWarning)
        J = kinematics.jacobian(first)
    return kinematics.inverse_jacobian(other) @ J * (first.sphere.radius / other.sphere.radius)
