"""Between wheel speeds and the sphere's angular velocity: Jacobian, forward, inverse, slip, master and slave wheels."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import NearSingularWarning, SingularError, SpheredriveError
from spheredrive.kinematics.contacts import Races, constraint, contacts
from spheredrive.kinematics.quality import NEAR_SINGULAR, describe_axes, svd3

if TYPE_CHECKING:
    from spheredrive.design import Design


def jacobian(design: Design, races: Races = None) -> np.ndarray:
    """J of Ω = J ω, shape (3, n).

        J = (Aᵀ W A)⁻¹ Aᵀ W B,   W = diag(sin² αᵢ)

    With three independent contacts this is A⁻¹ B, exact; with more it is least squares in the physical slip. Raises
    ``SingularError`` where the rows of A leave a direction undetermined (always for n < 3), and warns with
    ``NearSingularWarning`` where the least singular value is below 1 % of the largest. Source: model.md section 2,
    [2.17–2.22, 2.28–2.31].
    """
    A, B = constraint(design, races)
    require_regular(A, design.wheel_count)
    root_W = np.abs(np.sin(contacts(design, races).roller_angle))[:, None]
    # The weighted rows are unit vectors: their pseudo-inverse needs no normal equations, which would square the condition.
    return np.linalg.pinv(root_W * A) @ (root_W * B)


def inverse_jacobian(design: Design, races: Races = None) -> np.ndarray:
    """The matrix of ω = J⁻¹ Ω, shape (n, 3); it exists for every layout.

        J⁻¹ = (Bᵀ W B)⁻¹ Bᵀ W A,   W = diag(sin² αᵢ)

    With one contact a wheel this is B⁻¹ A, exact [2.27]; a wheel with several contacts at once takes the speed of least
    slip. Source: model.md section 2.
    """
    A, B = constraint(design, races)
    W = np.sin(contacts(design, races).roller_angle)[:, None] ** 2
    return (B.T @ (W * A)) / np.sum(B * W * B, axis=0)[:, None]


def forward(design: Design, wheel_speed, races: Races = None, *, out: np.ndarray | None = None) -> np.ndarray:
    """Angular velocity of the sphere, Ω = J ω: (..., n) → (..., 3), rad/s, inertial frame.

    ``out`` takes the result where it is given (C-contiguous). Errors and assumptions as ``jacobian``.
    """
    return _applied(jacobian(design, races), _vectors(wheel_speed, design.wheel_count, "wheel_speed"), out)


def inverse(design: Design, angular_velocity, races: Races = None, *, out: np.ndarray | None = None) -> np.ndarray:
    """Wheel speeds that give the sphere an angular velocity, ω = J⁻¹ Ω: (..., 3) → (..., n), rad/s.

    Errors none: any layout has them; whether they move the sphere is for ``jacobian`` to say.
    """
    return _applied(inverse_jacobian(design, races), _vectors(angular_velocity, 3, "angular_velocity"), out)


def sphere_acceleration(design: Design, wheel_acceleration, races: Races = None) -> np.ndarray:
    """Angular acceleration of the sphere, Ω̇ = J ω̇ (J is constant in a contact state): (..., n) → (..., 3), rad/s² [2.20]."""
    return forward(design, wheel_acceleration, races)


def wheel_acceleration(design: Design, angular_acceleration, races: Races = None) -> np.ndarray:
    """Wheel accelerations that give the sphere an angular acceleration, ω̇ = J⁻¹ Ω̇: (..., 3) → (..., n), rad/s² [2.22]."""
    return inverse(design, angular_acceleration, races)


class Slip(NamedTuple):
    """Slip ratios Sᵢ of the contacts, (..., m), and the overall S = √ΣSᵢ², (...)."""

    ratios: np.ndarray
    overall: np.ndarray


def slip(design: Design, wheel_speed, races: Races = None) -> Slip:
    """Slip of every contact while the sphere follows the wheels as well as it can.

        ΔVᵢ = sin αᵢ (ωᵢ rᵢ − R aᵢ · Ω) along ûᵢ,   Sᵢ = |ΔVᵢ| / |ωᵢ rᵢ|,   S = √ΣSᵢ²

    ``wheel_speed`` (..., n), rad/s. A contact of a wheel at rest has ratio 0 where it does not slip, else inf. ΔV below
    the rounding of its own two terms counts as zero. Raises as ``jacobian``. Source: model.md section 2, [2.34–2.36].
    """
    wheel_speed = _vectors(wheel_speed, design.wheel_count, "wheel_speed")
    c = contacts(design, races)
    A, _ = constraint(design, races)
    driven = wheel_speed[..., c.wheel] * c.wheel_radius
    angular_velocity = forward(design, wheel_speed, races)
    carried = design.sphere.radius * np.einsum("mk,...k->...m", A, angular_velocity)
    velocity = np.abs(np.sin(c.roller_angle) * (driven - carried))
    # Ω comes from all wheels, so its rounding is that of the fastest of them, through the conditioning of A.
    scale = np.abs(driven) + design.sphere.radius * np.linalg.norm(A, axis=1) * np.linalg.norm(
        angular_velocity, axis=-1, keepdims=True
    )
    velocity = np.where(velocity <= 64 * np.finfo(float).eps * scale, 0.0, velocity)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(velocity == 0, 0.0, velocity / np.abs(driven))
    return Slip(ratios, np.sqrt(np.sum(ratios**2, axis=-1)))


class Transmission(NamedTuple):
    """Ratio τ = |Ω| / |ω| and effectiveness ξ = R |Ω| / |(rᵢ ωᵢ)|, each (...)."""

    ratio: np.ndarray
    effectiveness: np.ndarray


def transmission(design: Design, wheel_speed, races: Races = None) -> Transmission:
    """Transmission ratio and effectiveness of wheel speeds (..., n), rad/s [4.7, 4.8]; NaN-free: wheels at rest are refused.

    Raises ``SpheredriveError`` where all wheels stand still or a wheel has several contacts, and what ``jacobian`` raises.
    """
    wheel_speed = _vectors(wheel_speed, design.wheel_count, "wheel_speed")
    speed = np.linalg.norm(wheel_speed, axis=-1)
    if not (speed > 0).all():
        raise SpheredriveError("a transmission ratio needs at least one wheel that turns, at finite speeds")
    c = contacts(design, races)
    if len(c.wheel) != design.wheel_count:
        raise SpheredriveError("a transmission ratio needs one contact a wheel; name the active races")
    turning = np.linalg.norm(forward(design, wheel_speed, races), axis=-1)
    rim = np.linalg.norm(wheel_speed * c.wheel_radius, axis=-1)
    return Transmission(turning / speed, design.sphere.radius * turning / rim)


class MasterSlave(NamedTuple):
    """Angular velocity the masters give the sphere, (..., 3), and the speeds of all wheels, (..., n), rad/s."""

    angular_velocity: np.ndarray
    wheel_speed: np.ndarray


def master_slave(design: Design, master_speed, masters=(1, 2, 3), races: Races = None) -> MasterSlave:
    """Three wheels lead, the others follow without slip: Ω = A_m⁻¹ B_m ω_m, then ω = B⁻¹ A Ω.

    ``master_speed`` (..., 3) in rad/s, ``masters`` three wheel numbers from 1. Raises ``SingularError`` where the masters'
    rows are dependent and ``SpheredriveError`` where a wheel has several contacts at once, which no slave speed frees from
    slip. Source: model.md section 2.
    """
    chosen = [int(number) - 1 if number == int(number) else -1 for number in masters]
    if len(set(chosen)) != 3 or not all(0 <= i < design.wheel_count for i in chosen):
        raise SpheredriveError(f"masters must be three different wheels from 1 to {design.wheel_count}, not {tuple(masters)}")
    A, B = constraint(design, races)
    if len(A) != design.wheel_count:
        raise SpheredriveError("master and slave wheels need one contact a wheel; name the active races")
    leading = A[chosen]
    require_regular(leading, 3)
    J = np.linalg.solve(leading, np.diag(np.sum(B, axis=1)[chosen]))
    angular_velocity = _applied(J, _vectors(master_speed, 3, "master_speed"))
    return MasterSlave(angular_velocity, inverse(design, angular_velocity, races))


def require_regular(A: np.ndarray, wheel_count: int) -> None:
    """Raise ``SingularError`` where the rows of A leave a direction undetermined; warn where they nearly do."""
    sigma, directions = svd3(A)
    missed = describe_axes(sigma, directions)[1]
    if wheel_count < 3:
        raise SingularError(
            f"{wheel_count} wheel{'s' if wheel_count > 1 else ''} cannot determine the rotation of a sphere, which takes "
            f"three; nothing drives it about {missed}"
        )
    if sigma[2] == 0.0:
        raise SingularError(f"the layout is singular: no wheel drives or holds the sphere about {missed}")
    if sigma[2] < NEAR_SINGULAR * sigma[0]:
        warnings.warn(
            f"the layout is nearly singular: errors of the wheels grow by up to {sigma[0] / sigma[2]:.3g} in rotations about "
            f"{missed}",
            NearSingularWarning,
            stacklevel=3,
        )


def _applied(matrix, vectors, out=None) -> np.ndarray:
    # Loading the compiled kernels takes longer than all of ``check``, which needs none of them.
    from spheredrive.kinematics.kernels import apply_matrix

    return apply_matrix(matrix, vectors, out)


def _vectors(values, size: int, name: str) -> np.ndarray:
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape[-1:] != (size,):
        raise SpheredriveError(f"{name} has shape {array.shape}; its last axis must hold {size} numbers")
    return array
