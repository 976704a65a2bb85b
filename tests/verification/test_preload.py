"""The least preload: the reported force keeps every contact inside its limits, one per cent less does not."""

import math
from dataclasses import replace

import numpy as np
import pytest
from test_rolling_dynamics import machine

from layouts import DUAL, atlas
from spheredrive.dynamics import least_preload_of_run, loads, thesis_closure_force
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion, Series
from spheredrive.simulation.preload import least_preload, with_preload
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.wheels import DualRaceWheel, IdealWheel


def gripping(wheel=None, friction=0.4, **rest):
    design = machine(
        atlas(wheel or IdealWheel(radius=0.025)), gravity=True, inertia=(0.03, 0.025, 0.02), centre_of_mass=(0, 0.01, -0.02)
    )
    return replace(design, contact=replace(design.contact, friction=friction, **rest))


def pushing(duration=1.0):
    return Motion(
        "wheel-torque",
        Series((0.0, 0.4, duration), ((0.3, -0.2, 0.1), (-0.4, 0.5, 0.0), (0.1, 0.2, -0.3))),
        duration,
        sample_rate=500,
    )


def worst_use(design, motion):
    found = loads(design, run_rolling(design, motion))
    return found.utilisation.max()


@pytest.mark.parametrize("direction", [(0, 0, -1), (0.1, -0.05, -1)])
@pytest.mark.parametrize("wheel", [IdealWheel(radius=0.025), DualRaceWheel(**DUAL)], ids=["round", "dual-race"])
def test_reported_preload_is_the_least(wheel, direction):
    design, motion = gripping(wheel), pushing()
    preload = least_preload(design, motion, direction)
    assert preload.force > 1.0
    assert worst_use(with_preload(design, preload.force, direction), motion) <= 1 + 1e-9
    assert worst_use(with_preload(design, 0.99 * preload.force, direction), motion) > 1 + 1e-4


def test_preload_settles_with_resistances_that_grow_with_it():
    design, motion = gripping(rolling_arm=2e-4, spin_arm=2e-4), pushing()
    preload = least_preload(design, motion)
    assert worst_use(with_preload(design, preload.force, (0, 0, -1)), motion) == pytest.approx(1, abs=1e-8)
    assert worst_use(with_preload(design, 0.99 * preload.force, (0, 0, -1)), motion) > 1 + 1e-4


def test_static_preload_of_the_atlas_in_closed_form():
    """A motor holds torque T against the sphere's inertia: |f| = T/r at every wheel, N = F/(3 sin θ) without weight."""
    design = replace(
        gripping(), stage=replace(gripping().stage, gravity=False), sphere=replace(gripping().sphere, centre_of_mass=(0, 0, 0))
    )
    design = replace(
        design, placements=tuple(replace(p, wheel=replace(p.wheel, mass=1e-9, axial_inertia=1e-15)) for p in design.placements)
    )
    motion = Motion("wheel-torque", Series((0.0,), ((0.1, 0.1, 0.1),)), 0.01, sample_rate=100)
    run = run_rolling(design, motion)
    f = 0.1 / 0.025
    np.testing.assert_allclose(run.friction_force[0], f, rtol=1e-9)
    expected = 3 * math.sin(math.radians(40)) * f / 0.4
    assert least_preload_of_run(design, run).force == pytest.approx(expected, rel=1e-9)


def test_overview_tells_the_preload_that_just_holds():
    """Wheels below the sphere: straight down presses them, and ΣR̂ of the Atlas points there."""
    from spheredrive.simulation.overview import overview

    design, motion = gripping(), pushing(0.5)
    found = overview(design, run_rolling(design, motion)).preload
    np.testing.assert_allclose(found.direction, (0, 0, -1), atol=1e-15)
    assert found.force == pytest.approx(least_preload(design, motion).force, rel=1e-12) and found.force > 0
    bare = replace(design, contact=replace(design.contact, friction=None))
    assert "friction" in overview(bare, run_rolling(bare, motion)).preload


def test_thesis_closure_force_puts_every_contact_at_its_limit():
    design, motion = gripping(), pushing(0.5)
    run = run_rolling(design, motion)
    force = thesis_closure_force(design, run)
    for sample in (0, 77, 150):
        held = replace(design, closure=replace(design.closure, force=tuple(force[sample])))
        pressed = run_rolling(held, motion)
        np.testing.assert_allclose(pressed.normal_force[sample], np.abs(run.friction_force[sample]) / 0.4, rtol=1e-9, atol=1e-9)


def test_thesis_formula_for_a_spherical_inertia():
    """{N} = ([I_w] R² [r]⁻¹ Ω̂ᵀ [I_s]⁻¹ Ω̂ μ + [r] μ)⁻¹ {T} [3.46] is N = f/μ of the full equations at rest."""
    design = machine(atlas(IdealWheel(radius=0.025)), wheel_inertia=3e-5)
    mu, R, r, I_w, I_s = 0.4, 0.15, 0.025, 3e-5, 2 / 3 * 2 * 0.15**2
    T = np.array([0.3, 0.2, 0.1])
    run = run_rolling(design, Motion("wheel-torque", Series((0.0,), (tuple(T),)), 0.01, sample_rate=100))
    from spheredrive import kinematics as K

    O = K.constraint(design)[0].T
    N = np.linalg.solve(I_w * R**2 / r * O.T @ O / I_s * mu + r * mu * np.eye(3), T)
    np.testing.assert_allclose(run.friction_force[0] / mu, N, rtol=1e-9)


def test_force_that_lifts_a_wheel_is_refused_by_its_name():
    with pytest.raises(SpheredriveError, match="does not press wheel"):
        least_preload(gripping(), pushing(), (0, 0, 1))
    with pytest.raises(SpheredriveError, match="friction"):
        least_preload(replace(gripping(), contact=replace(gripping().contact, friction=None)), pushing())
    for direction in ((0, 0, 0), (0, 1), (0, 0, math.nan)):
        with pytest.raises(SpheredriveError, match="direction"):
            least_preload(gripping(), pushing(), direction)


def test_findings_name_the_wheel_and_the_time():
    design = gripping(friction=0.05)
    design = replace(design, motor=replace(design.motor, speed=1.0, torque=0.2))
    found = loads(design, run_rolling(design, pushing()))
    codes = {finding.code for finding in found.findings}
    assert {"friction-limit", "motor-speed"} <= codes and "motor-torque" not in codes
    assert all("Wheel" in finding.message and " s on" in finding.message for finding in found.findings)
    # Torques are cut off at the limit, so the run itself never passes it.
    assert max(peak.torque for peak in found.peaks) <= 0.2 * (1 + 1e-12)
