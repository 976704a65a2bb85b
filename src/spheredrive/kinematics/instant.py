"""The constraint of the contacts as they stand at given wheel angles, where rollers carry them off their nominal places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.kinematics.maps import require_regular

if TYPE_CHECKING:
    from spheredrive.design import Design


def instantaneous_constraint(design: Design, wheel_angle) -> tuple[np.ndarray, np.ndarray]:
    """A (..., n, 3) and B (..., n) of A Ω = B ω, one contact a wheel, at ``wheel_angle`` ϑ (..., n), rad.

        aᵢ = (R̂ᵢ × ûᵢ)/sin αᵢ,   Bᵢ = ûᵢ · (ŵᵢ × (R R̂ᵢ − D R̂⁰ᵢ))/(R sin αᵢ),   D = D_nominal + h

    R̂ is the contact's own direction, which wanders along the wheel's axis on inclined rollers, û the touching roller's axis in
    the tangent plane there. At a roller's middle they are the rows of ``constraint``. Needs wheels whose rollers are described;
    the sphere's centre is taken to rest, which its shaking by h changes in second order. Raises ``DesignError`` as
    ``shape.profile``, ``SpheredriveError`` for angles that do not fit. Source: model.md sections 2 and 3.
    """
    # Loads the compiler, which no other question of the kinematics takes.
    from spheredrive.shape import profile, wander

    wheel_angle = np.asarray(wheel_angle, float)
    n, R = design.wheel_count, design.sphere.radius
    if wheel_angle.shape[-1:] != (n,):
        raise SpheredriveError(f"wheel_angle takes one angle for each of the {n} wheels on its last axis")
    A, B = np.empty((*wheel_angle.shape, 3)), np.empty(wheel_angle.shape)
    for i, wheel in enumerate(design.wheels):
        try:
            touch = wander(wheel, R, wheel_angle[..., i])
            outline = profile(wheel, R, kind="exact" if wheel.rollers_per_race else None)
        except DesignError as error:
            raise error.under("wheels", wheel.name) from None
        frame = _wheel_frame(design.contact_directions[i], design.drive_directions[i])
        place = _direction(touch.tilt, touch.lean) @ frame
        axis = _roller_axis(wheel.roller_angle, touch.turn) @ frame
        u = axis - np.sum(axis * place, axis=-1, keepdims=True) * place
        u /= np.linalg.norm(u, axis=-1, keepdims=True)
        angle, piece = wheel_angle[..., i], outline.piece(wheel_angle[..., i])
        distance = (outline.sphere_lever[piece] + outline.wheel_lever[piece] + outline.height(angle))[..., None]
        lever = R * place + distance * frame[0]
        sine = np.sin(wheel.roller_angle)
        A[..., i, :] = np.cross(place, u) / sine
        B[..., i] = np.sum(u * np.cross(frame[2], lever), axis=-1) / (R * sine)
    return A, B


def instantaneous_jacobian(design: Design, wheel_angle) -> np.ndarray:
    """J of Ω = J ω at ``wheel_angle`` (n,), with the contacts where they are then: (3, n).

    Least squares in the physical slip, as ``jacobian``, whose errors it has. Source: model.md sections 2 and 3.
    """
    A, B = instantaneous_constraint(design, wheel_angle)
    if A.ndim != 2:
        raise SpheredriveError("an instantaneous Jacobian takes one angle a wheel, (n,)")
    require_regular(A, design.wheel_count)
    root_W = np.abs(np.sin([wheel.roller_angle for wheel in design.wheels]))[:, None]
    return np.linalg.pinv(root_W * A) @ (root_W * np.diag(B))


def _wheel_frame(contact_direction, drive_direction) -> np.ndarray:
    """Rows x = −R̂ (to the sphere), y = v̂, z = ŵ = v̂ × R̂."""
    return np.array([-contact_direction, drive_direction, np.cross(drive_direction, contact_direction)])


def _direction(tilt, lean) -> np.ndarray:
    """From the sphere's centre to the contact, in the wheel's frame, (..., 3)."""
    return np.stack([-np.cos(lean) * np.cos(tilt), np.sin(lean) * np.cos(tilt), np.sin(tilt)], axis=-1)


def _roller_axis(roller_angle: float, turn) -> np.ndarray:
    """Axis of a roller whose middle stands at β, in the wheel's frame: (−sin α sin β, sin α cos β, cos α), (..., 3)."""
    sine, cosine = np.sin(roller_angle), np.cos(roller_angle)
    return np.stack([-sine * np.sin(turn), sine * np.cos(turn), np.broadcast_to(cosine, np.shape(turn))], axis=-1)
