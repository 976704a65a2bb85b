"""``simulate``: what a run is called, measured in and made of."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray

import spheredrive as sd
from layouts import DUAL, R, atlas, collinear_triple
from spheredrive.design import GRAVITY, Contact, Design, Motor, Placement, Sphere, Stage
from spheredrive.motion import Motion, Series
from spheredrive.simulation.labels import contact_numbers
from spheredrive.simulation.overview import overview
from spheredrive.simulation.rolling_run import FASTEST, run_rolling
from spheredrive.simulation.simulate import simulate_run
from spheredrive.wheels import DualRaceWheel, IdealWheel, SplitDualRaceWheel

NAMES = {
    "angular_velocity": (("time", "axis"), "rad/s"),
    "angular_acceleration": (("time", "axis"), "rad/s^2"),
    "orientation": (("time", "quat_wxyz"), "1"),
    "wheel_speed": (("time", "wheel"), "rad/s"),
    "wheel_angle": (("time", "wheel"), "rad"),
    "motor_torque": (("time", "wheel"), "N m"),
    "stage_position": (("time", "axis"), "m"),
    "stage_velocity": (("time", "axis"), "m/s"),
    "stage_acceleration": (("time", "axis"), "m/s^2"),
    "centre_displacement": (("time", "axis"), "m"),
    "normal_force": (("time", "contact"), "N"),
    "friction_force": (("time", "contact"), "N"),
    "slip_speed": (("time", "contact"), "m/s"),
    "active_race": (("time", "wheel"), "1"),
    "motor_work": (("time",), "J"),
    "stage_work": (("time",), "J"),
    "heat": (("time",), "J"),
    "kinetic_energy": (("time",), "J"),
    "potential_energy": (("time",), "J"),
    "impact_loss": (("time",), "J"),
    "ledger_residual": (("time",), "J"),
    "event_time": (("event",), "s"),
    "event_wheel": (("event",), "1"),
    "event_loss": (("event",), "J"),
    "event_impulse": (("event", "axis"), "N m s"),
}


def heavy(design: Design, **rest) -> Design:
    """The layout with masses, friction and weight, so that it has dynamics."""
    placements = tuple(replace(p, wheel=replace(p.wheel, mass=0.1)) for p in design.placements)
    sphere = Sphere(R, mass=2.0)
    return replace(design, sphere=sphere, placements=placements, contact=Contact(friction=0.9), **rest)


def torques(*rows, duration=0.5, **rest):
    time = np.linspace(0, duration, len(rows))
    return Motion("wheel-torque", Series(tuple(time), rows), duration, **rest)


PUSH = torques((0.03, 0.01, 0.02), (-0.02, 0.02, 0.01))


@pytest.fixture(scope="module")
def dual():
    return simulate_run(heavy(atlas()), PUSH)


def test_simulate_dataset_has_the_names_dimensions_and_units_of_the_interface(dual):
    data = dual.dataset
    assert {name: (v.dims, v.attrs["units"]) for name, v in data.data_vars.items()} == NAMES
    assert all(v.attrs["long_name"] for v in data.variables.values())
    assert all("units" in v.attrs for v in data.variables.values())
    assert list(data.axis.values) == ["x", "y", "z"] and list(data.quat_wxyz.values) == list("wxyz")
    assert data.wheel.values.tolist() == [1, 2, 3]
    assert data.sizes["time"] == 501


def test_simulate_contacts_are_wheel_by_race_and_carry_their_wheels_force(dual):
    run, data = dual
    assert data.contact.values.tolist() == ["1.1", "1.2", "2.1", "2.2", "3.1", "3.2"]
    assert data.contact_wheel.values.tolist() == [1, 1, 2, 2, 3, 3]
    assert data.contact_race.values.tolist() == [1, 2, 1, 2, 1, 2]
    for name in ("normal_force", "friction_force"):
        force = data[name].values
        np.testing.assert_array_equal(force[:, ::2] + force[:, 1::2], getattr(run, name))
        for i, (wheel, race) in enumerate(contact_numbers(heavy(atlas()))):
            off = data.active_race.sel(wheel=wheel).values != race
            assert off.any() and not off.all()
            assert (force[off, i] == 0).all()


def test_simulate_active_race_is_the_one_that_kinematics_finds_at_the_wheel_angle(dual):
    data, design = dual.dataset, heavy(atlas())
    wheel = design.wheels[0]
    angle = data.wheel_angle.values
    clear = np.abs(angle / wheel.half_pitch - np.round(angle / wheel.half_pitch)) > 1e-6
    np.testing.assert_array_equal(data.active_race.values[clear], 1 + wheel.state_index(angle)[clear])
    assert not data.slip_speed.any() and not data.centre_displacement.any()


def test_simulate_weight_is_carried_by_the_contacts(dual):
    """At rest under its weight alone, Σ N (−R̂) = M g: three wheels at elevation θ carry M g / (3 sin 40°) each."""
    rest = sd.simulate(heavy(atlas(IdealWheel(radius=0.025))), torques((0.0, 0.0, 0.0), duration=0.01))
    expected = 2.0 * GRAVITY / (3 * math.sin(math.radians(40)))
    np.testing.assert_allclose(rest.normal_force.values, expected, rtol=1e-12)


def test_simulate_events_count_wheels_from_1_and_input_steps_as_0(dual):
    data = dual.dataset
    assert set(data.event_wheel.values.tolist()) == {1, 2, 3}
    assert (np.diff(data.event_time.values) >= 0).all()
    step = Motion("sphere-velocity", Series((0.0, 0.1), ((0, 0, 1.0), (0, 0, 2.0)), "step"), 0.2)
    jump = sd.simulate(heavy(atlas(IdealWheel(radius=0.025))), step)
    assert jump.event_wheel.values.tolist() == [0] and jump.event_time.values.tolist() == [0.1]


def test_simulate_attributes_tell_where_the_run_comes_from():
    design = sd.load_design(sd.design_path("atlas-dual-race"))
    data = sd.simulate(design, PUSH)
    attributes = data.attrs
    assert attributes["design"] == design.source and attributes["version"] == sd.__version__
    assert attributes["model"] == "rolling" and attributes["seed"] == -1
    assert attributes["completed"] == 1 and attributes["reason"] == ""
    assert attributes["relative_tolerance"] == 1e-10
    heavier = replace(design, sphere=replace(design.sphere, mass=3.0))
    other = sd.simulate(heavier, PUSH).attrs
    assert other["design_sha256"] == attributes["design_sha256"]
    assert other["design_values_sha256"] != attributes["design_values_sha256"]


def test_simulate_is_repeatable(dual):
    xarray.testing.assert_identical(sd.simulate(heavy(atlas()), PUSH), dual.dataset)


@pytest.mark.parametrize(
    "design",
    [
        atlas(IdealWheel(radius=0.025), elevation_deg=0.0, heading_deg=30.0),
        atlas(IdealWheel(radius=0.025), count=2),
        atlas(DualRaceWheel(**DUAL), elevation_deg=0.0, heading_deg=30.0),
    ],
    ids=["equator", "two wheels", "dual-race on the equator"],
)
def test_simulate_undetermined_normal_forces_are_left_out_with_a_reason(design):
    row = (0.01,) * design.wheel_count
    data = sd.simulate(heavy(design), torques(row, row, duration=0.1))
    assert "normal_force" not in data and "plane" in data.attrs["normal_force_missing"]
    assert "friction_force" in data


def test_simulate_split_wheel_has_both_of_its_races():
    wheel = SplitDualRaceWheel(radius=0.025, rollers=16)
    data = sd.simulate(heavy(atlas(wheel)), torques((0.02, 0.01, 0.0), duration=0.3))
    assert data.sizes["contact"] == 6 and set(np.unique(data.active_race)) == {1, 2}


def test_simulate_unknown_model_names_those_there_are():
    with pytest.raises(sd.SpheredriveError, match=r"no model 'rigid'.*compliant, rolling"):
        sd.simulate(heavy(atlas()), PUSH, model="rigid")


@pytest.mark.parametrize(
    ("design", "motion", "message"),
    [
        (atlas(), PUSH, "mass"),
        (heavy(collinear_triple()), PUSH, "triple-race"),
        (heavy(atlas(count=4)), PUSH, "3 columns, but the design has 4 wheels"),
    ],
)
def test_simulate_refuses_what_it_cannot_run(design, motion, message):
    with pytest.raises(sd.SpheredriveError, match=message):
        sd.simulate(design, motion)


def test_simulate_watch_sees_progress_and_can_stop():
    shares = []
    sd.simulate(heavy(atlas()), PUSH, watch=shares.append)
    assert shares and shares[-1] == pytest.approx(1.0)

    def stop(share):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sd.simulate(heavy(atlas()), PUSH, watch=stop)


def test_simulate_motion_that_grows_without_limit_ends_with_its_reason():
    wheel = DualRaceWheel(**DUAL, axial_inertia=1e-12)
    design = replace(atlas(wheel), sphere=Sphere(R, inertia=(1e-9, 1e-9, 1e-9)), stage=Stage(gravity=False))
    data = sd.simulate(design, torques((1e3, 2e3, 1e3), duration=1000.0, sample_rate=1.0))
    assert data.attrs["completed"] == 0 and "without limit" in data.attrs["reason"]
    assert FASTEST > 1e4 and data.sizes["event"] < 1e6


def test_overview_numbers_are_the_runs_own(dual):
    design = heavy(atlas())
    result = overview(design, dual.run)
    speed = np.linalg.norm(dual.run.angular_velocity, axis=1)
    assert result.works and result.turn == speed.max() and result.turn_time == dual.run.time[speed.argmax()]
    assert result.race_changes == len(dual.run.event_time)
    answer = result.as_dict()
    assert answer["least_normal_force"]["least_normal_n"] == dual.run.normal_force.min()
    assert [row["torque_n_m"] for row in answer["wheels"]] == np.abs(dual.run.motor_torque).max(axis=0).tolist()
    assert result.residual < 1e-9 * result.energy


def test_overview_broken_limit_does_not_work():
    design = heavy(atlas(), motor=Motor(speed=1.0))
    result = overview(design, run_rolling(design, PUSH))
    assert not result.works and any(f.code == "motor-speed" for f in result.findings)


def test_overview_undetermined_normal_forces_are_null():
    design = heavy(atlas(IdealWheel(radius=0.025), elevation_deg=0.0, heading_deg=30.0))
    answer = overview(design, run_rolling(design, PUSH)).as_dict()
    assert answer["least_normal_force"] is None and answer["friction_utilisation"] is None
    assert all(row["least_normal_n"] is None for row in answer["wheels"])


def test_simulate_one_wheel_runs():
    wheel = IdealWheel(radius=0.025, mass=0.1)
    design = Design("one", Sphere(R, mass=1.0), (Placement(wheel, (1, 0, 0), (0, 1, 0)),))
    data = sd.simulate(design, torques((0.01,), duration=0.1))
    assert data.attrs["completed"] == 1 and data.angular_velocity.values[-1, 2] != 0
