"""The rolling model against the same mechanics written a second time, in the body frame, and integrated by SciPy."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from layouts import DUAL, atlas
from spheredrive.design import Stage
from spheredrive.frames import quaternion_matrix
from spheredrive.motion import Motion, Series
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from peers.numpy_rolling import Machine

WHEELS = {
    "ideal": IdealWheel(radius=0.025, mass=0.1),
    "mecanum": MecanumWheel(radius=0.03, rollers=12, mass=0.2, roller_angle=-0.7),
    "dual-race": DualRaceWheel(**DUAL, mass=0.3),
}


@pytest.mark.parametrize("kind", WHEELS)
def test_torque_driven_offset_mass_matches_scipy(kind):
    design = atlas(WHEELS[kind])
    sphere = replace(design.sphere, mass=2.0, inertia=((0.03, 0.002, 0), (0.002, 0.025, -0.001), (0, -0.001, 0.02)))
    design = replace(design, sphere=replace(sphere, centre_of_mass=(0.01, 0.02, -0.02)), stage=Stage(5.0, True))
    series = Series((0.0, 0.7, 2.0), ((0.05, 0.0, -0.02), (-0.02, 0.06, 0.01), (0.03, 0.02, 0.04)))
    Omega0 = np.array([1.0, 0.5, 2.0])
    run = run_rolling(design, Motion("wheel-torque", series, 2.0, angular_velocity=tuple(Omega0), sample_rate=10))
    assert run.completed, run.reason
    Omega, q, angle, changes = Machine(design).run(series.at, (0.0, 0.7, 2.0), Omega0)
    # Both are held to 1e-10 a step or better over some hundred steps.
    np.testing.assert_allclose(run.angular_velocity[-1], Omega, atol=2e-8)
    np.testing.assert_allclose(run.wheel_angle[-1], angle, atol=2e-7)
    np.testing.assert_allclose(quaternion_matrix(run.orientation[-1]), quaternion_matrix(q), atol=2e-8)
    assert len(run.event_time) == changes
    assert changes > 20 or kind != "dual-race"
