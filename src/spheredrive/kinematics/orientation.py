"""Orientation of the sphere from its angular velocity."""

from __future__ import annotations

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.frames import quaternion_exponential


def integrate_orientation(time, angular_velocity, initial=(1.0, 0.0, 0.0, 0.0)) -> np.ndarray:
    """Orientation quaternions of a body whose angular velocity runs straight between samples: (k,), (k, 3) → (k, 4).

        q̇ = ½ (0, Ω) ∘ q                                     [2.21]
        q(t + h) = exp(½ θ) ∘ q(t),   θ = h (Ω₀ + Ω₁)/2 + h² (Ω₁ × Ω₀)/12

    ``time`` in s, rising (two equal times mark a jump); ``angular_velocity`` Ω in rad/s, inertial frame; quaternions
    scalar first, body to inertial, of unit length. Fourth order in the spacing, exact while Ω keeps its axis. Raises
    ``SpheredriveError`` for times that fall, shapes that do not fit and values that are not finite. Source: Magnus
    expansion, Hairer, Lubich and Wanner, *Geometric Numerical Integration*, section IV.7.
    """
    time = np.asarray(time, float)
    Omega = np.asarray(angular_velocity, float)
    start = np.asarray(initial, float)
    if time.ndim != 1 or not len(time) or Omega.shape != (len(time), 3) or start.shape != (4,):
        raise SpheredriveError(f"shapes do not fit: time {time.shape}, angular_velocity {Omega.shape}, initial {start.shape}")
    if not (np.isfinite(time).all() and np.isfinite(Omega).all() and np.isfinite(start).all()):
        raise SpheredriveError("time, angular velocity and initial orientation must be finite")
    if (np.diff(time) < 0).any():
        raise SpheredriveError("time must not fall")
    if not 0.99 < np.linalg.norm(start) < 1.01:
        raise SpheredriveError("the initial orientation must be a unit quaternion")
    from spheredrive.kinematics.kernels import compose_rotations

    h = np.diff(time)[:, None]
    theta = h * (Omega[:-1] + Omega[1:]) / 2 + h**2 * np.cross(Omega[1:], Omega[:-1]) / 12
    orientation = np.empty((len(time), 4))
    orientation[0] = start / np.linalg.norm(start)
    compose_rotations(quaternion_exponential(theta), orientation)
    return orientation
