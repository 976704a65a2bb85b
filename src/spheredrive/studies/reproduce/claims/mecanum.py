"""Rows on inclined rollers: determinants, singular roller angles, transmission effectiveness."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spheredrive import kinematics
from spheredrive.frames import heading_direction, outward
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.claims.kinematics import ROUNDING, ROUNDING_RULE, ring, same
from spheredrive.studies.reproduce.results.transmission import layouts, transmissions
from spheredrive.studies.reproduce.table import Row, rounds_to, signed, span

ROLLER_ANGLES_DEG = np.arange(20, 91, 5)


def rows() -> list[Row]:
    """All rows of this subject."""
    return [_orthogonal(), _hands(), _orthogonal_jacobian(), _atlas(), _atlas_singular(), *_effectiveness()]


def _inclined(angle_deg: float):
    return machines.with_wheel_keys(machines.shipped("orthogonal"), roller_angle=math.radians(angle_deg))


def _orthogonal() -> Row:
    cot = 1 / np.tan(np.radians(ROLLER_ANGLES_DEG))
    found = np.array([kinematics.determinant(_inclined(angle)) for angle in ROLLER_ANGLES_DEG])
    # cot³ reaches 21 at 20°: rounding is counted against the larger of the two terms.
    error = (np.abs(found - (cot**3 - 1)) / (cot**3 + 1)).max()
    at_45 = abs(kinematics.determinant(_inclined(45)))
    return Row(
        "eq-2.127",
        "Orthogonal layout with roller angle α: determinant, and its zero",
        "cot³α − 1, zero at α = 45°",
        f"the same at α = 20° … 90° {same(error)}; 0 at 45° {same(at_45)}",
        error < ROUNDING and at_45 < ROUNDING,
        ROUNDING_RULE,
    )


def _hands() -> Row:
    right, left = (kinematics.determinant(_inclined(sign * 45)) for sign in (1, -1))
    return Row(
        "eq-2.127-hand",
        "Mecanum wheels (45°) on the orthogonal layout cannot avoid slip",
        "determinant 0",
        f"{abs(right):.1f} with rollers at +45°, {signed(left)} at −45°",
        max(abs(right), abs(left)) < ROUNDING,
        "Zero to rounding for both hands of roller.",
        "E9-hand",
    )


def _orthogonal_jacobian() -> Row:
    design = _inclined(60)
    t = math.tan(math.radians(60))
    printed = np.array([[t**2, t, t**3], [t**3, t**2, t], [t, t**3, t**2]]) / (1 - t**3)
    found = kinematics.jacobian(design) * design.sphere.radius / design.wheels[0].radius
    error = np.abs(found - printed).max()
    return Row(
        "eq-2.128",
        "Jacobian of the orthogonal layout with inclined rollers, at α = 60°",
        "r/(R(1 − tan³α)) × (tan²α, tan α, tan³α; …)",
        f"the same {same(error)}",
        error < ROUNDING,
        ROUNDING_RULE,
    )


def _atlas() -> Row:
    wheel = machines.shipped("orthogonal").wheels[0]
    worst = 0.0
    for theta_deg in range(10, 90, 10):
        for alpha_deg in (20, 30, 45, 60, 90):
            theta, cot = math.radians(theta_deg), 1 / math.tan(math.radians(alpha_deg))
            formula = 1.5 * math.sqrt(3) * math.cos(theta) * (math.sin(theta) ** 2 + cot**2)
            found = kinematics.determinant(ring(-theta_deg, replace(wheel, roller_angle=math.radians(alpha_deg))))
            worst = max(worst, abs(found - formula) / (1 + cot**2))  # type: ignore[operator]
    return Row(
        "eq-2.132",
        "Determinant of the Atlas layout with roller angle α",
        "(3√3/2) cos θ (sin²θ + cot²α)",
        f"the same over θ and α {same(worst)}",
        worst < ROUNDING,
        ROUNDING_RULE,
    )


def _least_singular_value(theta_deg: float, alpha_deg: float) -> float:
    """σ₃ of the Atlas layout's rows; at θ = 90°, where no three wheels fit, of the rows alone."""
    azimuth, elevation = np.radians([0.0, 120.0, 240.0]), math.radians(-theta_deg)
    R_hat, v_hat = outward(azimuth, elevation), heading_direction(azimuth, elevation, 0.0)
    return float(kinematics.singular_values(kinematics.constraint_row(R_hat, v_hat, math.radians(alpha_deg)))[2])


def _atlas_singular() -> Row:
    cases = {
        "θ = 90°, α = 45°": (90, 45), "θ = 0°, α = 90°": (0, 90), "θ = 0°, α = 45°": (0, 45), "θ = 40°, α = 45°": (40, 45),
    }  # fmt: skip
    measure = {name: _least_singular_value(*angles) for name, angles in cases.items()}
    singular = [name for name, value in measure.items() if value < 1e-9]
    return Row(
        "eq-2.132-singular",
        "The Atlas layout with inclined rollers is singular only at θ = 90°, or at θ = 0° with α = 90°",
        "θ = 90°; θ = 0° with α = 90°",
        "σ₃ of A: " + "; ".join(f"{value:.3f} at {name}" for name, value in measure.items()),
        singular == ["θ = 90°, α = 45°", "θ = 0°, α = 90°"],
        "σ₃ below 1e-9, the rounding of the angles, at the two named and at neither of the others.",
    )


def _effectiveness() -> list[Row]:
    limits = {name: kinematics.effectiveness(design) for name, design in layouts().items()}
    grid = transmissions()
    drawn = {name: (xi.min(), xi.max()) for name, xi in grid.effectiveness.items()}
    gap = drawn["standard"][0] - drawn["Mecanum"][1]
    wins = (grid.effectiveness["standard"] >= grid.effectiveness["Mecanum"] - ROUNDING).all()
    wins &= (grid.ratio["standard"] >= grid.ratio["Mecanum"] - ROUNDING).all()
    return [
        Row(
            "fig-4.7",
            "Standard wheels have the higher transmission ratio and effectiveness at every combination of speeds",
            "consistently higher",
            f"higher or equal at {'all' if wins else 'not all'} {grid.norm.size} combinations of 0 … 2.5 rad/s: ξ "
            f"{span(*drawn['standard'])} against {span(*drawn['Mecanum'])}",
            bool(wins),
            "Every combination of 11 speeds a wheel, to rounding (1e-12); the two meet where all three speeds are equal.",
        ),
        Row(
            "fig-4.7-limit",
            "The worst standard result is the upper limit of the Mecanum wheels",
            "equal",
            f"{drawn['standard'][0]:.4f} and {drawn['Mecanum'][1]:.4f}",
            abs(gap) < ROUNDING,
            "Equal to rounding: both are 1/(√3 cos 40°), rotation about z.",
        ),
        Row(
            "fig-4.7-range",
            "Range of ξ over all directions of ω at θ = 40°",
            "standard 0.754 … 1.270, Mecanum 0.687 … 0.754 (closed forms 1/(√3 cos θ), 1/(√1.5 sin θ), 1/√(1.5(sin²θ + 1)))",
            f"standard {span(*limits['standard'])}, Mecanum {span(*limits['Mecanum'])}",
            all(
                rounds_to(value, printed)
                for name, pair in (("standard", ("0.754", "1.270")), ("Mecanum", ("0.687", "0.754")))
                for value, printed in zip(limits[name], pair, strict=True)
            ),
            "Half a unit of the third decimal.",
        ),
    ]
