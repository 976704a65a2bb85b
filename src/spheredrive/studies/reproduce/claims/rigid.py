"""Rows of chapter 3 on rigid machines: the "perfect world" and the shape of real wheels."""

from __future__ import annotations

import numpy as np

from spheredrive import kinematics, vibration
from spheredrive.shape import gap_depth, sphere_gap_angle
from spheredrive.studies.reproduce import assumptions, machines
from spheredrive.studies.reproduce.claims.kinematics import ROUNDING
from spheredrive.studies.reproduce.results import imperfect, perfect_world
from spheredrive.studies.reproduce.table import Row, percent, rounds_to, signed, vector

# Runs of the rolling model are integrated to 1e-10 a step; over some hundred steps that is below this.
INTEGRATED = 1e-8
INTEGRATED_RULE = "Largest deviation below 1e-8 of the largest value: the integrator's 1e-10 a step over some hundred steps."
SAMPLE_RATE = 2000.0


def rows() -> list[Row]:
    """All rows of this subject."""
    return [*_perfect_world(), _round_wheels(), _depth(), _half_percent(), *_imperfect(), _growth(), *_least_normal_forces()]


def _perfect_world() -> list[Row]:
    run = perfect_world.run()
    t, Omega = run.time, run.angular_velocity
    slope = Omega[-1] / t[-1]
    linear = np.abs(Omega - t[:, None] * slope).max() / np.abs(Omega).max()
    # A turn about a constant axis by ½|Ω̇|t²: its quaternion in closed form.
    half_angle = np.linalg.norm(slope) * t**2 / 4
    axis = slope / np.linalg.norm(slope)
    chirp = np.column_stack([np.cos(half_angle), np.sin(half_angle)[:, None] * axis])
    turned = np.abs(run.orientation - chirp).max()
    design = perfect_world.design()
    mass = design.sphere.mass + design.stage.mass + sum(wheel.mass for wheel in design.wheels)
    parabola = np.outer(t**2 / (2 * mass), perfect_world.FORCE)
    moved = np.abs(run.stage_position - parabola).max() / parabola.max()
    return [
        Row(
            "fig-3.3", "Perfect world: the components of Ω grow linearly", "straight lines",
            f"straight lines to {_below(linear)}; Ω̇ = {vector(slope)} rad/s²", linear < INTEGRATED, INTEGRATED_RULE, "E6",
        ),
        Row(
            "fig-3.4", "Perfect world: the quaternion is harmonic about a constant axis, with rising frequency",
            "chirp about a constant axis", f"cos and sin of |Ω̇|t²/4 about Ω̇/|Ω̇| to {_below(turned)}", turned < INTEGRATED,
            INTEGRATED_RULE,
        ),
        Row(
            "fig-3.5", "Perfect world: the stage moves along parabolas, uncoupled from the rotation", "parabolas",
            f"P t²/(2 · {mass:.2f} kg) to {_below(moved)}", moved < INTEGRATED, INTEGRATED_RULE,
        ),
    ]  # fmt: skip


def _below(error: float) -> str:
    return "1e-8" if error < INTEGRATED else f"{error:.1e}"


def _round_wheels() -> Row:
    motion = vibration.transient(machines.orthogonal(), imperfect.SPEEDS, 1.0)
    moved = float(np.abs(motion.displacement).max())
    return Row(
        "section-3.2.1-round",
        "Perfect world: no motion of the sphere relative to the stage",
        "none",
        f"{moved:g} m",
        moved == 0,
        "Round wheels give a displacement of exactly zero.",
    )


def _wheel_depth() -> float:
    wheel = machines.standard_wheel()
    return float(
        gap_depth(wheel.radius, machines.shipped("orthogonal").sphere.radius, wheel.roundness * 2 * np.pi / wheel.rollers)
    )


def _depth() -> Row:
    wheel, R = machines.standard_wheel(), machines.shipped("orthogonal").sphere.radius
    gap = wheel.roundness * 2 * np.pi / wheel.rollers
    theta_R = float(sphere_gap_angle(wheel.radius, R, gap))
    # [3.5], the distance of the centres at mid-gap, by itself.
    distance = R * np.cos(theta_R / 2) + wheel.radius * np.cos(gap / 2)
    depth = _wheel_depth()
    return Row(
        "eq-3.6",
        "Depth of the gaps of the demonstrator's wheel, Δr [3.4–3.6]",
        "0.407 mm (by its formulas; not printed)",
        f"{1e3 * depth:.4f} mm",
        abs(depth - (R + wheel.radius - distance)) < 1e-12 * R and rounds_to(1e3 * depth, "0.407"),
        "[3.5] to the rounding of the sphere's radius, and half a unit of the third decimal.",
    )


def _half_percent() -> Row:
    share = _wheel_depth() / machines.standard_wheel().radius
    return Row(
        "section-3.1.1-radius",
        "The wheel's radius changes by less than 0.5 % for a reasonably bad case",
        "< 0.5 %",
        percent(share),
        share < 0.005,
        "Δr/r_b of the thesis's own wheel against its bound.",
        "E10",
    )


def _imperfect() -> list[Row]:
    """One row a figure: each wheel moves its own axis by its own shape, at its own passing frequency."""
    found = []
    base = _peak_times(assumptions.ROUNDNESS_SAMPLES.value[-1])
    for number, eta in enumerate(assumptions.ROUNDNESS_SAMPLES.value, 6):
        motion = imperfect.rigid("half-sine", eta, _longest_period(), SAMPLE_RATE)
        wheel = machines.standard_wheel()
        gap = eta * 2 * np.pi / wheel.rollers
        depth = float(gap_depth(wheel.radius, machines.shipped("orthogonal").sphere.radius, gap))
        shares = motion.displacement.max(axis=0) / depth
        times = _peak_times(eta)
        same = len(times) == len(base) and np.abs(np.diff(times) - np.diff(base)).max() < 2e-3
        # A half sine of angular frequency p is cos(p Δt/2) of its peak at the nearest sample, or more.
        missed = (np.pi / gap * max(imperfect.SPEEDS) / SAMPLE_RATE) ** 2 / 8
        agrees = bool(np.abs(shares - 1).max() < missed + ROUNDING and same)
        found.append(
            Row(
                f"fig-3.{number}",
                f"Rigid, η = {eta:g}: ΔR has the magnitude of the shape, and its peaks keep their frequency",
                "same magnitude, same frequency",
                f"largest ΔR along x, y, z over Δr: {', '.join(f'{s:.4f}' for s in shares)}; {len(times)} peaks along y as for "
                f"η = {assumptions.ROUNDNESS_SAMPLES.value[-1]:g}",
                agrees,
                f"Magnitude to {missed:.1e}, what samples 0.5 ms apart can miss of a peak, (π ω Δt/θ_s)²/8; times between "
                "peaks to 2 ms, four samples.",
                open="the sampled η and the speeds are assumed.",
            )
        )
    return found


def _least_normal_forces() -> list[Row]:
    """[3.46] as printed, against the friction forces of the full equations."""
    design, run = perfect_world.design(), perfect_world.run()
    mu, radius, R = design.contact.friction, design.wheel_radii, design.sphere.radius
    Omega_hat = kinematics.contacts(design).induced_direction.T
    I_w = np.diag([wheel.spin_inertia for wheel in design.wheels])
    inner = I_w * R**2 @ np.diag(1 / radius) @ Omega_hat.T @ np.linalg.inv(design.sphere.inertia_tensor) @ Omega_hat * mu
    torque = np.array(perfect_world.TORQUE)

    def printed(T):
        return np.linalg.solve(inner + np.diag(radius) * mu, T)

    wanted = np.abs(run.friction_force[1]) / mu
    found = printed(torque)
    error = float(np.abs(found / wanted - 1).max())
    backwards = float(printed(-torque).min())
    return [
        Row(
            "eq-3.46", "Least normal forces that keep every contact from slipping, at the torques of Fig 3.3",
            f"{vector(found, 3)} N by [3.46]", f"{vector(wanted, 3)} N, |f|/μ of the full equations", error < INTEGRATED,
            "Ratio to 1e-8, the integrator's accuracy.",
        ),
        Row(
            "eq-3.46-sign", "[3.46] gives the normal forces for any torques", "N ≥ 0",
            f"N down to {signed(backwards, 2)} N with all torques reversed", backwards >= 0, "No normal force below zero.",
            "E9-negative",
        ),
    ]  # fmt: skip


def _longest_period() -> float:
    """Time in which the slowest wheel turns by one roller."""
    return 2 * np.pi / machines.standard_wheel().rollers / min(imperfect.SPEEDS)


def _peak_times(eta: float) -> np.ndarray:
    """Times of the peaks along y, the fastest wheel's axis."""
    motion = imperfect.rigid("half-sine", eta, _longest_period(), SAMPLE_RATE)
    y = motion.displacement[:, 1]
    inside = (y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])
    return motion.time[1:-1][inside]


def _growth() -> Row:
    growth = imperfect.growth()
    rising = bool((np.diff(growth.half_sine) > 0).all() and (np.diff(growth.exact) > 0).all())
    return Row(
        "fig-3.10",
        "Rigid: the largest |ΔR| grows with the roundness ratio",
        "grows",
        f"grows at every step from η = 0 to {growth.roundness[-1]:g}: 0 to {1e3 * growth.half_sine[-1]:.2f} mm (half sine), "
        f"{1e3 * growth.exact[-1]:.2f} mm (exact)"
        if rising
        else "does not grow at every step",
        rising,
        f"Rises at each of {len(growth.roundness) - 1} steps of η, with either outline.",
    )
