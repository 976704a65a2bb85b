"""What of a wheel's shape can be written down: the rolling radii of simple rollers and the valley between spheres."""

from __future__ import annotations

import numpy as np

from spheredrive.wheels.standard import sphere_gap_angle


def rolling_radius_with_gaps(wheel_radius, sphere_radius, rollers, gap_angle) -> np.ndarray:
    """Mean rolling radius of a standard wheel of barrels: r_eff = (n_r/2π)(r_b θ_b + R θ_R), θ_b = 2π/n_r − θ_s.

    Lengths in m, ``gap_angle`` θ_s in rad, broadcast. Raises as ``sphere_gap_angle``. Source: model.md section 3.
    """
    theta_b = 2 * np.pi / np.asarray(rollers) - np.asarray(gap_angle, float)
    theta_R = sphere_gap_angle(wheel_radius, sphere_radius, gap_angle)
    return np.asarray(rollers) / (2 * np.pi) * (wheel_radius * theta_b + sphere_radius * theta_R)


def rolling_radius_of_spheres(axis_distance, roller_radius, sphere_radius, rollers) -> np.ndarray:
    """Mean rolling radius of a race of n_r spheres of radius ρ whose centres lie at distance a from the wheel's axis.

        r_eff = ρ + (n_r/π)(R + ρ) asin(a sin(π/n_r)/(R + ρ)),   on a flat (R = ∞):  ρ + a (n_r/π) sin(π/n_r)

    Lengths in m, broadcast. Source: model.md section 3.
    """
    a, rho, n = (np.asarray(x, float) for x in (axis_distance, roller_radius, rollers))
    chord = a * np.sin(np.pi / n)
    reach = np.asarray(sphere_radius, float) + rho
    with np.errstate(invalid="ignore"):
        arc = np.where(np.isinf(reach), chord, reach * np.arcsin(chord / reach))
    return rho + n / np.pi * arc


def valley_of_spheres(axis_distance, roller_radius, sphere_radius, rollers) -> np.ndarray:
    """Height r_w (m) at which a sphere rests between two spherical rollers.

        r_w = a cos(π/n_r) + √((R + ρ)² − a² sin²(π/n_r)) − R,   on a flat (R = ∞):  a cos(π/n_r) + ρ

    Lengths in m, broadcast. Source: model.md section 3, D(β) with L = 0 at β = π/n_r.
    """
    a, rho, n = (np.asarray(x, float) for x in (axis_distance, roller_radius, rollers))
    R = np.asarray(sphere_radius, float)
    chord = a * np.sin(np.pi / n)
    with np.errstate(invalid="ignore"):
        rise = (2 * R * rho + rho**2 - chord**2) / (np.sqrt((R + rho) ** 2 - chord**2) + R)
    return a * np.cos(np.pi / n) + np.where(np.isinf(R), rho, rise)
