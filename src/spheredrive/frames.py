"""Frames: unit vectors, tangent frames on the sphere, rotations and quaternions.

Quaternions are scalar first (``quat_wxyz``) and turn body coordinates into inertial ones. Every function takes leading
batch dimensions.
"""

from __future__ import annotations

import numpy as np


def unit(vector) -> np.ndarray:
    """The vector over its length, shape (..., 3); a zero vector gives NaN, so refuse it before."""
    vector = np.asarray(vector, dtype=float)
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def east(azimuth) -> np.ndarray:
    """Unit vector of increasing azimuth, ê_φ = (−sin φ, cos φ, 0); azimuth in rad, (...) → (..., 3)."""
    azimuth = np.asarray(azimuth, dtype=float)
    return np.stack([-np.sin(azimuth), np.cos(azimuth), np.zeros_like(azimuth)], axis=-1)


def outward(azimuth, elevation) -> np.ndarray:
    """Unit vector R̂ from the centre to the point at azimuth φ and elevation ε (rad, negative below the equator).

    R̂ = (cos φ cos ε, sin φ cos ε, sin ε). Broadcasts, (...) → (..., 3). Source: model.md section 1.
    """
    azimuth, elevation = np.broadcast_arrays(np.asarray(azimuth, float), np.asarray(elevation, float))
    level = np.cos(elevation)
    return np.stack([np.cos(azimuth) * level, np.sin(azimuth) * level, np.sin(elevation)], axis=-1)


def heading_direction(azimuth, elevation, heading) -> np.ndarray:
    """Unit tangent v̂ at heading χ (rad) from east towards north: v̂ = cos χ ê_φ + sin χ R̂ × ê_φ, (..., 3).

    Source: model.md section 1.
    """
    azimuth, elevation, heading = np.broadcast_arrays(*(np.asarray(angle, float) for angle in (azimuth, elevation, heading)))
    eastward = east(azimuth)
    northward = np.cross(outward(azimuth, elevation), eastward)
    return np.cos(heading)[..., None] * eastward + np.sin(heading)[..., None] * northward


def angles(contact_direction, drive_direction) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Azimuth, elevation and heading (rad) of a placement: the inverse of ``outward`` and ``heading_direction``.

    At a pole the azimuth is taken as zero, so that the heading alone tells the drive direction.
    """
    R_hat = np.asarray(contact_direction, float)
    v_hat = np.asarray(drive_direction, float)
    level = np.hypot(R_hat[..., 0], R_hat[..., 1])
    azimuth = np.where(level > 1e-12, np.arctan2(R_hat[..., 1], R_hat[..., 0]), 0.0)
    elevation = np.arctan2(R_hat[..., 2], level)
    eastward = east(azimuth)
    northward = np.cross(R_hat, eastward)
    heading = np.arctan2(np.sum(v_hat * northward, -1), np.sum(v_hat * eastward, -1))
    return azimuth, elevation, heading


def rotation_matrix(axis, angle) -> np.ndarray:
    """Rotation by ``angle`` (rad) about the unit vector ``axis``, (..., 3, 3) (Rodrigues)."""
    axis = np.asarray(axis, float)
    angle = np.asarray(angle, float)[..., None, None]
    x, y, z = axis[..., 0], axis[..., 1], axis[..., 2]
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(*axis.shape[:-1], 3, 3)
    # 1 - cos loses all digits at small angles; 2 sin^2 of the half angle does not.
    return np.eye(3) + np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * (cross @ cross)


def quaternion_product(p, q) -> np.ndarray:
    """Hamilton product p ∘ q of scalar-first quaternions, (..., 4)."""
    p, q = np.asarray(p, float), np.asarray(q, float)
    scalar = p[..., :1] * q[..., :1] - np.sum(p[..., 1:] * q[..., 1:], -1, keepdims=True)
    vector = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:])
    return np.concatenate([scalar, vector], -1)


def quaternion_exponential(rotation_vector) -> np.ndarray:
    """Unit quaternion of a rotation vector θ (rad): (cos |θ|/2, θ̂ sin |θ|/2), (..., 3) → (..., 4)."""
    rotation_vector = np.asarray(rotation_vector, float)
    half = np.linalg.norm(rotation_vector, axis=-1, keepdims=True) / 2
    # sinc is smooth through zero: no division by a small angle.
    return np.concatenate([np.cos(half), rotation_vector / 2 * np.sinc(half / np.pi)], -1)


def quaternion_matrix(q) -> np.ndarray:
    """Rotation matrix, body to inertial, of a scalar-first unit quaternion, (..., 4) → (..., 3, 3)."""
    q = np.asarray(q, float)
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return np.stack(rows, -1).reshape(*q.shape[:-1], 3, 3)
