"""The door to the compliant model: datasets, overview, command line, refusals."""

import json
import math

import numpy as np
import pytest
import xarray

import spheredrive as sd
from forked import run as run_program
from spheredrive.design import Closure, Contact, Design, Motor, Placement, Sphere, Stage
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant.overview import compliant_overview
from spheredrive.simulation.compliant.run import Accuracy, run_compliant
from spheredrive.simulation.rolling_run import Tolerance
from spheredrive.wheels import DualRaceWheel, IdealWheel, SplitDualRaceWheel

OMNI = DualRaceWheel(radius=0.025, rollers=16, roller_radius=0.00485, race_spacing=0.0125, mass=0.1)
ROUND = IdealWheel(radius=0.025, mass=0.1)
SPEEDS = Motion("wheel-speed", Series((0.0,), ((2.0, 1.0, 3.0),)), 0.1)


def machine(wheel=OMNI, **keys) -> Design:
    places = tuple(Placement.at(wheel, 2 * math.pi * i / 3, math.radians(-40)) for i in range(3))
    contact = keys.pop("contact", Contact(1e5, 200.0, 0.9))
    return Design("machine", keys.pop("sphere", Sphere(0.15, 2.0)), places, contact, **keys)


@pytest.fixture(scope="module")
def run():
    return sd.simulate(machine(), SPEEDS, model="compliant")


def test_simulate_compliant_names_and_dims_are_those_of_every_run(run):
    rolling = sd.simulate(machine(), SPEEDS)
    same = ("angular_velocity", "orientation", "wheel_speed", "wheel_angle", "motor_torque", "stage_position",
            "centre_displacement", "normal_force", "friction_force", "slip_speed")  # fmt: skip
    for name in same:
        assert run[name].dims == rolling[name].dims and run[name].attrs["units"] == rolling[name].attrs["units"]
    assert all("units" in variable.attrs for variable in run.variables.values())
    assert run.attrs["model"] == "compliant" and run.attrs["completed"] == 1
    assert list(run.contact.values) == list(rolling.contact.values)


def test_simulate_compliant_forces_carry_the_sphere_on_the_whole(run):
    # Over the run the mean force on the sphere is M g but for what its momentum changed by.
    weight = 2.0 * 9.80665
    held = float(run.normal_force.sum("contact").mean()) * math.sin(math.radians(40))
    assert held == pytest.approx(weight, rel=0.05)
    assert float(run.normal_force.min()) >= 0.0
    assert (run.gap.values[run.normal_force.values > 0] < 0).all()


def test_simulate_compliant_writes_netcdf_that_reads_back(run, tmp_path):
    from spheredrive.io.results import write_run

    write_run(run, tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as back:
        np.testing.assert_array_equal(back.normal_force, run.normal_force)
        assert back.attrs["design_values_sha256"] == run.attrs["design_values_sha256"]


def test_simulate_compliant_patch_and_pressure_need_moduli():
    wheel = DualRaceWheel(
        radius=0.025, rollers=16, roller_radius=0.00485, race_spacing=0.0125, mass=0.1, young_modulus=1e9, poisson_ratio=0.4
    )
    sphere = Sphere(0.15, 2.0, young_modulus=3e9, poisson_ratio=0.35)
    short = Motion("wheel-speed", Series((0.0,), ((2.0, 1.0, 3.0),)), 0.01)
    found = sd.simulate(machine(wheel, sphere=sphere), short, model="compliant")
    pressed = found.normal_force.values > 0
    # p₀ = 3 N/(2 π a b), one roller a race while the gap of its neighbours is open.
    a, b, p = (found[name].values[pressed] for name in ("patch_across", "patch_along", "peak_pressure"))
    np.testing.assert_allclose(p, 1.5 * found.normal_force.values[pressed] / (math.pi * a * b), rtol=1e-9)
    assert "peak_pressure" not in sd.simulate(machine(), short, model="compliant")


def test_compliant_overview_says_lift_off_with_wheel_and_time():
    # Thrown up at 0.2 m/s, the sphere is in the air for 2 v/g; every wheel loses it at once and gets it back together.
    design = machine(ROUND)
    thrown = Motion("wheel-speed", Series((0.0,), ((0.0, 0.0, 0.0),)), 0.045, centre_velocity=(0.0, 0.0, 0.2))
    run = run_compliant(design, thrown, Accuracy(1e-10))
    found = compliant_overview(design, run)
    assert [f.code for f in found.findings].count("lift-off") == 3
    assert found.lift_off_count == (1, 1, 1)
    first = run.lift_offs[0]
    assert 2 * 0.2 / 9.80665 * 0.9 < first[2] - first[1] < 2 * 0.2 / 9.80665 * 1.1
    assert found.works


def test_compliant_split_wheel_presses_from_both_sides():
    wheel = SplitDualRaceWheel(radius=0.025, rollers=16, roller_radius=0.00485, mass=0.1, axial_inertia=1e-4)
    found = sd.simulate(machine(wheel), SPEEDS, model="compliant")
    assert found.sizes["mount"] == 6 and found.sizes["contact"] == 6
    assert (found.normal_force.sum("time").values > 0).any()


@pytest.mark.parametrize(
    ("design", "words"),
    [
        (machine(contact=Contact(None, 0.0, 0.9)), "contact.stiffness"),
        (machine(contact=Contact(1e5)), "contact.friction"),
        (machine(contact=Contact(1e5, 0.0, 0.9, law="hertz")), "young_modulus"),
        (machine(sphere=Sphere(0.15)), "sphere.mass"),
        (machine(stage=Stage(gravity=False)), "nothing presses the sphere"),
        (machine(closure=Closure(force=(0.0, 0.0, 100.0))), "cannot sit"),
    ],
)
def test_simulate_compliant_refuses_with_a_sentence(design, words):
    with pytest.raises(sd.SpheredriveError, match=words):
        sd.simulate(design, SPEEDS, model="compliant")


def test_simulate_tolerance_of_the_other_model_is_refused():
    with pytest.raises(sd.SpheredriveError, match="takes Accuracy"):
        sd.simulate(machine(), SPEEDS, model="compliant", tolerance=Tolerance())


def test_motor_limit_holds_a_speed_loop_back():
    # A loop that asks for more than the limit gives the limit, and no more.
    motor = Motor(torque=0.01, proportional_gain=5.0)
    found = sd.simulate(machine(ROUND, motor=motor), SPEEDS, model="compliant")
    assert float(abs(found.motor_torque).max()) <= 0.01 * (1 + 1e-12)


def test_simulate_batch_of_compliant_runs_is_each_run_to_the_last_bit():
    designs = [machine(ROUND, contact=Contact(K, 200.0, 0.9)) for K in (1e5, 2e5, 4e5)]
    batch = sd.simulate_batch(designs, SPEEDS, model="compliant")
    for i, design in enumerate(designs):
        xarray.testing.assert_identical(batch[i], sd.simulate(design, SPEEDS, model="compliant"))


def test_command_line_runs_the_compliant_model(tmp_path):
    motion = tmp_path / "motion.toml"
    motion.write_text(
        'schema_version = 1\n[motion]\nkind = "wheel-speed"\nduration = "0.05 s"\ntime = [0]\nvalues = [[1, 2, 3]]\n'
    )
    design = sd.design_path("atlas-dual-race")
    done = run_program("simulate", design, motion, "--model", "compliant", "-o", tmp_path / "run.nc", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["model"] == "compliant" and len(found["wheels"]) == 3 and (tmp_path / "run.nc").exists()
