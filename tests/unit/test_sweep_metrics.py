"""Metrics of a sweep: what the functions for one design give, by both routes from points to machines."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spheredrive import kinematics
from spheredrive.dynamics import least_preload_of_run, normals_known, pressing_direction
from spheredrive.io.motion_file import parse_motion
from spheredrive.io.study_file import parse_study
from spheredrive.motion import Motion, Series
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.studies.sweep.evaluate import Evaluator
from spheredrive.studies.sweep.metrics import metrics, needs_designs
from spheredrive.studies.sweep.metrics.base import Conditions
from spheredrive.studies.sweep.variants import Variants

DATA = Path(__file__).parents[1] / "data"
CLOSED = ["isotropy", "condition_number", "determinant", "sigma_min", "effectiveness_min", "effectiveness_max", "preload",
          "normal_force_max", "friction_utilisation"]  # fmt: skip
ALL_ROUND = """
"placement.elevation" = { from = "-95 deg", to = "5 deg" }
"placement.heading" = { normal = ["0 deg", "20 deg"] }
"placement.azimuth" = { from = "-200 deg", to = "200 deg" }
"wheels.omni.roller_angle" = ["90 deg", "60 deg", "-45 deg"]
"wheels.omni.radius" = { from = "4 mm", to = "30 mm" }
"wheels.omni.mass" = { from = "0.05 kg", to = "0.2 kg" }
"sphere.radius" = { from = "1 mm", to = "6 mm" }
"sphere.mass" = { normal = ["2 kg", "1 kg"] }
"contact.stiffness" = { from = "1e5 N/m", to = "1e6 N/m" }
"contact.damping" = { normal = ["5 N s/m", "3 N s/m"] }
"contact.friction" = [0.0, 0.5, 0.9]
"mount.damping" = { from = "0 N s/m", to = "100 N s/m" }
"closure.stiffness" = { from = "0 N/m", to = "1e5 N/m" }
"closure.force.z" = { normal = ["-10 N", "10 N"] }
"motor.torque" = { from = "0.1 N m", to = "3 N m" }
"wheels.omni.phase" = [0, 0.1]
"""


def study(names, parameters: str, size: int = 60, head: str = "", design: str = "interface-example.toml"):
    text = f'schema_version = 1\ndesign = "{design}"\nmetrics = {list(names)}\n{head}\n[parameters]\n{parameters}'
    text += f'[sampling]\nmethod = "random"\nsize = {size}\n'
    return parse_study(text.replace("'", '"'), metrics(), folder=DATA)


def by_both_routes(s):
    """Rows by columns, and by whole designs."""
    fast, plain = Evaluator(s), Evaluator(s)
    plain.variants = Variants(s, whole=True)
    X = fast.points.values(0, fast.points.count)
    return fast, X, fast.evaluate(X), plain.evaluate(X)


def sentences(rows) -> list[str]:
    return [rows.sentences[k - 1] if k else "" for k in rows.reason]


def test_both_routes_give_the_same_bits_and_the_same_reasons():
    fast, _, quick, plain = by_both_routes(study(CLOSED, ALL_ROUND, 300))
    assert len(fast.variants._numeric) == 15 and len(fast.variants._plain) == 1
    np.testing.assert_array_equal(quick.values, plain.values)
    assert sentences(quick) == sentences(plain)
    assert (np.isfinite(quick.values).sum(axis=0)[:8] > 60).all() and np.isnan(quick.values).any(axis=0).all()
    told = " ".join(quick.sentences)
    for words in ("elevation runs from -90", "must be greater than zero", "does not fit into a wheel", "cannot touch a sphere"):
        assert words in told


def test_a_point_does_not_depend_on_its_neighbours():
    s = study(CLOSED, ALL_ROUND, 40)
    evaluator = Evaluator(s)
    X = evaluator.points.values(0, 40)
    whole = evaluator.evaluate(X)
    for i in (0, 13, 39):
        alone = evaluator.evaluate(X[i : i + 1])
        np.testing.assert_array_equal(alone.values[0], whole.values[i])
        assert sentences(alone)[0] == sentences(whole)[i]


def test_kinematic_metrics_are_those_of_each_design():
    s = study(
        CLOSED[:6], '"placement.elevation" = { from = "-80 deg", to = "-10 deg" }\n"wheels.roller_angle" = ["90 deg", 0.9]\n'
    )
    evaluator = Evaluator(s)
    X = evaluator.points.values(0, 20)
    found = evaluator.evaluate(X).values
    for row, x in zip(found, X, strict=True):
        design = evaluator.variants.design(x)
        low, high = kinematics.effectiveness(design)
        assert tuple(row[[0, 3, 4, 5]]) == (kinematics.isotropy(design), kinematics.singularity_measure(design), low, high)
        # The determinant's sums are taken in another order, the condition number has a kernel of its own.
        assert row[1] == pytest.approx(1 / kinematics.isotropy(design), rel=1e-13)
        assert row[2] == pytest.approx(kinematics.determinant(design), rel=1e-14)


def with_torque_signs(design):
    """A run whose samples are the machine at rest, its motors giving their largest torque with every combination of signs."""
    n = design.wheel_count
    still = Motion("sphere-velocity", Series((0.0,), ((0.0, 0.0, 0.0),), "step"), 2.0**n - 1, sample_rate=1.0)
    run = run_rolling(design, still)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=n)))
    f = signs * design.motor.torque / (design.wheel_radii * np.abs(np.sin([w.roller_angle for w in design.wheels])))
    contacts = kinematics.contacts(design)
    R_hat, u_hat = contacts.contact_direction, contacts.slip_direction
    # Nominal contacts for the run's: N of least squares balances weight, closure and friction.
    carried = np.array(design.closure.force) + [0.0, 0.0, -9.80665 * design.sphere.mass] + f @ u_hat
    normal = carried @ np.linalg.pinv(R_hat)
    return replace(run, friction_force=f, normal_force=normal)


@pytest.mark.parametrize("count", [3, 4])
def test_preload_at_rest_is_that_of_every_combination_of_torques(count):
    """Against the preload of a run, which looks at each sample for itself."""
    parameters = (
        '"placement.elevation" = { from = "-70 deg", to = "-10 deg" }\n"closure.force.x" = { from = "0 N", to = "9 N" }\n'
    )
    parameters += '"wheels.roller_angle" = ["90 deg", "60 deg", "-45 deg"]\n"wheels.omni.type" = ["standard"]\n'
    parameters += f'"placement.count" = [{count}]\n'
    evaluator = Evaluator(study(["preload", "normal_force_max", "friction_utilisation"], parameters))
    X = evaluator.points.values(0, 12)
    found = evaluator.evaluate(X)
    for i, x in enumerate(X):
        design = evaluator.variants.design(x)
        assert normals_known(design)
        run = with_torque_signs(design)
        asked = least_preload_of_run(design, run, pressing_direction(design))
        assert asked.force > 10
        assert found.values[i, 0] == pytest.approx(asked.force, rel=1e-12)
        assert found.values[i, 1] == pytest.approx(run.normal_force.max(), rel=1e-12)
        assert "friction_utilisation: a contact that carries friction is not pressed" in sentences(found)[i]
        pressed = replace(run, normal_force=run.normal_force + 2 * asked.force)
        assert (np.abs(pressed.friction_force) / (0.9 * pressed.normal_force)).max() < 1


def test_friction_utilisation_is_one_at_the_least_preload():
    """By its definition; the closure's own force is put along the pressing direction, straight down here."""
    one = Evaluator(study(["preload"], '"motor.torque" = ["1 N m"]\n', 1))
    force = float(one.evaluate(one.points.values(0, 1)).values[0, 0])
    s = study(["friction_utilisation", "preload"], f'"motor.torque" = [1.0]\n"closure.force.z" = [{-force!r}]\n', 1)
    used, left = Evaluator(s).evaluate(Evaluator(s).points.values(0, 1)).values[0]
    assert used == pytest.approx(1.0, rel=1e-12) and left == pytest.approx(0.0, abs=1e-9 * force)


def test_what_a_design_lacks_is_said_by_metric():
    s = study(["preload", "isotropy"], '"contact.friction" = [0.0, 0.5]\n"placement.elevation" = ["0 deg", "-40 deg"]\n', 40)
    evaluator = Evaluator(s)
    rows = evaluator.evaluate(evaluator.points.values(0, 40))
    assert set(sentences(rows)) >= {"", "preload: needs contact.friction above zero"}
    assert any(said.startswith("preload: the contacts lie in a plane") for said in sentences(rows))


def test_slip_free_dof_is_that_of_the_worst_contact_state():
    s = study(["slip_free_dof"], '"wheels.omni.type" = ["dual-race", "triple-race"]\n"wheels.rollers" = [24]\n', 20)
    evaluator = Evaluator(s)
    X = evaluator.points.values(0, 20)
    found = evaluator.evaluate(X).values[:, 0]
    expected = [kinematics.worst_contact_state(evaluator.variants.design(x)).rotation_dof for x in X]
    np.testing.assert_array_equal(found, expected)
    assert set(found) == {3.0, min(expected)} and min(expected) < 3


def test_metrics_along_a_motion_are_those_of_its_run():
    text = """schema_version = 1
    [motion]
    kind = "sphere-velocity"
    time = [0, 0.02]
    values = [[0, 0, 0], [0.1, 0.2, 0.4]]
    """
    s = study(["preload", "normal_force_max"], '"sphere.mass" = ["1 kg", "2 kg"]\n', 3)
    motion = parse_motion(text)
    names = ("preload", "normal_force_max", "motor_torque", "friction_utilisation", "angular_velocity")
    s = replace(s, motion=motion, metrics=names)
    assert needs_designs(names, Conditions(motion=motion)) and not needs_designs(CLOSED[:6], Conditions())
    evaluator = Evaluator(s)
    X = evaluator.points.values(0, 3)
    for x, row in zip(X, evaluator.evaluate(X).values, strict=True):
        design = evaluator.variants.design(x)
        run = run_rolling(design, motion)
        assert row[0] == least_preload_of_run(design, run, pressing_direction(design)).force
        assert tuple(row[1:3]) == (run.normal_force.max(), np.abs(run.motor_torque).max())
        assert row[4] == pytest.approx(np.sqrt(0.21), rel=1e-12)


def test_a_defect_costs_one_point_and_says_so(monkeypatch):
    s = study(["isotropy"], '"placement.elevation" = { from = "-80 deg", to = "-10 deg" }\n', 5)
    evaluator = Evaluator(s)
    X = evaluator.points.values(0, 5)
    original = Variants.batches

    def broken(self, points):
        if X[3, 0] in points[:, 0]:
            raise ZeroDivisionError("so it is")
        return original(self, points)

    monkeypatch.setattr(Variants, "batches", broken)
    rows = evaluator.evaluate(X)
    assert np.isnan(rows.values[:, 0]).tolist() == [False, False, False, True, False]
    assert sentences(rows)[3] == "a defect of spheredrive (ZeroDivisionError: so it is)"


@pytest.mark.parametrize("kind", ["dual-race", "split-dual-race"])
def test_vibration_is_that_of_each_design(kind):
    """On both routes, and against the response of one design; pads stand opposite the wheels wherever these are."""
    from spheredrive import vibration

    names = ["rms_acceleration", "rms_displacement", "natural_frequency_min", "natural_frequency_max"]
    parameters = '"placement.elevation" = { from = "-70 deg", to = "-10 deg" }\n"closure.stiffness" = { from = 0, to = 1e5 }\n'
    parameters += f'"wheels.omni.type" = ["{kind}"]\n'
    parameters += (
        '"contact.damping" = { from = "100 N s/m", to = "900 N s/m" }\n"wheels.omni.mass" = { from = 0.1, to = 0.3 }\n'
    )
    fast, X, quick, plain = by_both_routes(study(names, parameters, 6, 'speeds = "2 2.5 1 rad/s"'))
    np.testing.assert_array_equal(quick.values, plain.values)
    for x, row in zip(X[:3], quick.values, strict=False):
        design = fast.variants.design(x)
        moved = vibration.response(design, [2.0, 2.5, 1.0])
        natural = vibration.modes(design).natural_frequencies
        expected = (moved.rms_acceleration, moved.rms_displacement, natural[0], natural[-1])
        assert tuple(row) == pytest.approx(expected, rel=1e-12)


def test_vibration_says_why_there_is_none():
    parameters = '"contact.stiffness" = [0.0, 188208.0]\n"placement.count" = [2, 3]\n'
    evaluator = Evaluator(study(["natural_frequency_min"], parameters, 30))
    told = set(sentences(evaluator.evaluate(evaluator.points.values(0, 30))))
    assert any("nothing holds the sphere" in said for said in told) and any("contacts are rigid" in said for said in told)
    assert "" in told
