"""Wheels whose races take turns: which one touches at a wheel angle, and what a single-race Jacobian gets wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.kinematics.maps import jacobian
from spheredrive.values import LARGEST

if TYPE_CHECKING:
    from spheredrive.design import Design


def state_index(design: Design, wheel_angle) -> np.ndarray:
    """Which entry of its type's ``alternation`` each wheel shows at its angle, (..., n) → whole numbers (..., n)."""
    wheel_angle = np.asarray(wheel_angle, float)
    if wheel_angle.shape[-1:] != (design.wheel_count,):
        raise SpheredriveError(
            f"wheel_angle has shape {wheel_angle.shape}; its last axis must hold {design.wheel_count} numbers"
        )
    if not (np.abs(wheel_angle) < LARGEST).all():
        raise SpheredriveError(f"wheel_angle must be finite and below {LARGEST:g} rad")
    columns = [wheel.state_index(wheel_angle[..., i]) for i, wheel in enumerate(design.wheels)]
    return np.stack(columns, axis=-1)


def races_of(design: Design, index) -> tuple[tuple[int, ...], ...]:
    """The active races that a row (n,) of ``state_index`` stands for."""
    return tuple(wheel.alternation[int(i)] for wheel, i in zip(design.wheels, index, strict=True))


def active_races(design: Design, wheel_angle) -> tuple[tuple[int, ...], ...]:
    """The races that touch the sphere while the wheels stand at ``wheel_angle`` (n,), rad; one tuple a wheel.

    Dual-race wheels of 2N rollers: race floor(N ϑ / π) mod 2 + 1 [2.56–2.58].
    """
    return races_of(design, state_index(design, wheel_angle))


class RaceError(NamedTuple):
    """Error of the nominal Jacobian.

    angle       between the two angular velocities, rad, (...)
    magnitude   (|Ω| − |Ω_nominal|) / |Ω|, (...)
    """

    angle: np.ndarray
    magnitude: np.ndarray


def race_error(angular_velocity, nominal) -> RaceError:
    """How far ``nominal`` is from the true ``angular_velocity``, both (..., 3), in angle and in magnitude.

        angle = atan2(|Ω × Ω_nominal|, Ω · Ω_nominal)   [2.77],   magnitude = (|Ω| − |Ω_nominal|) / |Ω|

    Both are zero where the sphere stands still. Source: model.md section 2 and E4.
    """
    true, ideal = np.asarray(angular_velocity, float), np.asarray(nominal, float)
    if not (np.isfinite(true).all() and np.isfinite(ideal).all()):
        raise SpheredriveError("angular velocities must be finite")
    # The cosine alone would lose half the digits of small angles.
    angle = np.arctan2(np.linalg.norm(np.cross(true, ideal), axis=-1), np.sum(true * ideal, axis=-1))
    speed = np.linalg.norm(true, axis=-1)
    difference = speed - np.linalg.norm(ideal, axis=-1)
    magnitude = np.divide(difference, speed, out=np.zeros_like(speed), where=speed > 0)
    return RaceError(np.where(speed > 0, angle, 0.0), magnitude)


def forward_by_state(design: Design, wheel_speed, index) -> np.ndarray:
    """Ω of wheel speeds (k, n) where row i is in the contact state ``index[i]`` (k, n): one Jacobian a state that occurs."""
    from spheredrive.kinematics.kernels import apply_matrix

    wheel_speed, index = np.ascontiguousarray(wheel_speed, float), np.asarray(index)
    states, which = np.unique(index, axis=0, return_inverse=True)
    angular_velocity = np.empty((len(wheel_speed), 3))
    for k, state in enumerate(states):
        rows = np.flatnonzero(which.reshape(-1) == k)
        J = jacobian(design, races_of(design, state))
        angular_velocity[rows] = apply_matrix(J, np.ascontiguousarray(wheel_speed[rows]))
    return angular_velocity
