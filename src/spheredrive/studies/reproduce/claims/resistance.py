"""Rows on what chapter 3 leaves out or calls negligible: resistances, offset mass, contact patch, cogging."""

from __future__ import annotations

import math

import numpy as np

from spheredrive import vibration
from spheredrive.contact import hertz, relative_radii, resistance_arms
from spheredrive.studies.reproduce import assumptions, machines
from spheredrive.studies.reproduce.results import excitation, perfect_world, resistance
from spheredrive.studies.reproduce.table import Row, percent


def rows() -> list[Row]:
    """All rows of this subject."""
    return [*_resistance(), _spin_arm(), _patch(), *_offset(), _cogging()]


def _resistance() -> list[Row]:
    limit = assumptions.RESISTANCE_MATTERS.value
    found = []
    for name, where, one in (
        ("", "pressed by the least closure force [3.46]", resistance.at_least_preload()),
        ("-weight", "pressed by its own weight, Atlas at 40°", resistance.under_weight()),
    ):
        found.append(
            Row(
                f"section-5-resistance{name}",
                f"Spin and rolling resistance are negligible; {where}",
                "negligible",
                f"take {percent(one.share)} of the angular acceleration at N = {one.normal_force:.2f} N, l_r = a = "
                f"{1e3 * one.rolling_arm:.2f} mm, l_s = {1e3 * one.spin_arm:.2f} mm",
                one.share < limit,
                f"Less than {percent(limit)} of the angular acceleration under the torques of Fig 3.3.",
                "E13",
                open="neither moduli nor normal forces are given.",
            )
        )
    return found


def _spin_arm() -> Row:
    from dataclasses import replace

    design = machines.shipped("atlas-demonstrator")
    moduli = {"young_modulus": 1e7, "poisson_ratio": 0.4}
    design = replace(machines.with_wheel_keys(design, **moduli), sphere=replace(design.sphere, **moduli))
    rolling, spin = resistance_arms(design, 10.0, circular=True)
    ratio = float(spin[0] / rolling[0])
    return Row(
        "eq-3.28",
        "Spin lever of a Hertzian patch over its radius, l_s/a",
        "3π/16 = 0.5890",
        f"{ratio:.4f}",
        abs(ratio - 3 * math.pi / 16) < 1e-9,
        "Closed form to rounding.",
    )


def _patch() -> Row:
    design = machines.shipped("atlas-dual-race")
    across, along = (float(x[0]) for x in relative_radii(design))
    circular = 1 / (1 / design.sphere.radius + 1 / design.wheels[0].radius)
    real = hertz(10.0, across, along, modulus=1e7)
    taken = hertz(10.0, circular, modulus=1e7)
    longer = max(real.a, real.b) / min(real.a, real.b)
    share = float(real.stiffness / taken.stiffness)
    return Row(
        "eq-3.17",
        "The contact patch of a wheel is that of a sphere of its radius",
        "a circle",
        f"dual-race wheel of Fig 2.7 (r_r = 4.85 mm): an ellipse of {float(longer):.1f} : 1, stiffness {share:.2f} of the "
        "circle's",
        bool(abs(longer - 1) < 0.01),
        "Axes equal to 1 %. Stiffness and axes in ratio do not depend on force and moduli.",
        "E5",
    )


def _offset() -> list[Row]:
    plain = perfect_world.run()
    shaken, heavy = perfect_world.run_with_offset(), perfect_world.run_with_heavy_offset()
    moved = float(np.abs(shaken.stage_position - plain.stage_position).max())
    turned = float(np.abs(heavy.angular_velocity - plain.angular_velocity).max())
    where = assumptions.OFFSET.shown
    return [
        Row(
            "section-3.2-offset",
            "A centre of mass beside the middle does not couple the rotation to the stage's motion",
            "no coupling",
            f"offset {where}: the stage leaves its parabola by up to {1e3 * moved:.1f} mm",
            moved < 1e-9,
            "The stage's path with and without offset, driven alike, equal to 1e-9 m, above the integrator's error.",
            "E11",
        ),
        Row(
            "section-3.2-offset-weight",
            "Moments on the wheels are the only means to turn the sphere, offset mass or not",
            "no effect on Ω",
            f"offset {where}, under gravity: Ω differs by up to {turned:.2f} rad/s in {plain.time[-1]:g} s",
            turned < 1e-6,
            "Ω with weight and offset against Ω without, equal to 1e-6 rad/s, above the integrator's error.",
            "E11",
            open="its equations carry no weight; with the wheels' speeds prescribed instead of torques the claim would hold.",
        ),
    ]


def _cogging() -> Row:
    design = machines.atlas(machines.standard_wheel("exact"))
    normal = vibration.linear_system(design).seat_force.max()
    steepest = max(map(abs, excitation.outline("standard", "exact").extremes(1)))
    torque = normal * steepest
    drive = max(perfect_world.TORQUE)
    return Row(
        "eq-3.39",
        "A wheel's torque goes into traction, rolling resistance and inertia alone",
        "no torque of the shape",
        f"−N r_w′ reaches {torque:.2f} N m at the weight's N = {normal:.1f} N; the thesis drives with up to {drive:g} N m",
        torque < 0.01 * drive,
        "Less than 1 % of the drive torque.",
        "E9-cogging",
    )
