"""Sensitivities against closed forms, another method, and a function whose indices are known."""

import json
from pathlib import Path

import numpy as np
import pytest

import spheredrive as sd
from spheredrive.errors import SpheredriveError
from spheredrive.io.study_file import parse_study
from spheredrive.studies.sensitivity import gradient, sobol_indices, study_of
from spheredrive.studies.sensitivity.command import sensitivity_command
from spheredrive.studies.sweep.evaluate import Evaluator, Rows
from spheredrive.studies.sweep.metrics import metrics

DATA = Path(__file__).parents[1] / "data"
HEAD = 'schema_version = 1\ndesign = "interface-example.toml"\n'
# Angles of any sign: coordinates of a test function by the names of a machine.
CUBE = '[parameters]\n"placement.azimuth" = {0}\n"placement.heading" = {0}\n"wheels.omni.phase" = {0}\n'


def study(parameters: str, names='["isotropy"]', sampling='method = "sobol"\nsize = 8\n'):
    return parse_study(f"{HEAD}metrics = {names}\n{parameters}\n[sampling]\n{sampling}", metrics(), folder=DATA)


def formula(f):
    return lambda X: Rows(np.column_stack(f(*X.T)), np.zeros(len(X), np.int64), ())


@pytest.fixture(scope="module")
def atlas():
    return sd.load_design(DATA / "interface-example.toml")


def test_gradient_of_isotropy_is_that_of_its_closed_form(atlas):
    """A ring of three is tan|ε|/√2 isotropic up to tan ε = √2, so ∂/∂ε = −sec²ε/√2 below the equator; masses do nothing."""
    found = gradient(study_of(atlas, ["isotropy", "sigma_min"], ["placement.elevation", "sphere.mass"]))
    e = np.radians(-40)
    assert abs(found.base[0] - np.tan(-e) / np.sqrt(2)) < 1e-15
    # σ_min = √(3/2) |sin ε|.
    exact = np.array([[-1 / (np.sqrt(2) * np.cos(e) ** 2), 0], [-np.sqrt(1.5) * np.cos(e), 0]])
    np.testing.assert_allclose(found.values, exact, rtol=1e-10, atol=1e-13)
    assert (np.abs(found.values - exact) <= found.error + 1e-13).all() and found.error.max() < 1e-9
    assert found.at.tolist() == [e, 2.0] and not found.reasons


def test_gradient_agrees_with_a_fit(atlas):
    """Of preload and natural frequencies by a polynomial through 15 Chebyshev points around: another way to the same slope."""
    names = ["preload", "natural_frequency_min", "clearance"]
    s = study_of(atlas, names, ["placement.elevation"])
    found = gradient(s)
    span = 0.05
    x = found.at[0] + span * np.cos(np.pi * (np.arange(15) + 0.5) / 15)
    values = Evaluator(s).evaluate(x[:, None]).values
    for column in range(3):
        fit = np.polynomial.Chebyshev.fit(x, values[:, column], 14).deriv()(found.at[0])
        assert abs(found.values[column, 0] / fit - 1) < 1e-6


def test_error_is_honest_on_what_is_known():
    """Of exp, sin and 1/x at 0.3: each within its own estimate, and that is small."""
    s = study(CUBE.format('["17 deg"]'), '["isotropy", "preload", "mass"]', 'method = "list"\n')
    found = gradient(s, [0.3, 0.4, 0.5], formula(lambda x, y, z: (np.exp(x) * y, np.sin(5 * x) + z**2, 1 / (x + y))))
    x, y, z = 0.3, 0.4, 0.5
    exact = [
        [np.exp(x) * y, np.exp(x), 0],
        [5 * np.cos(5 * x), 0, 2 * z],
        [-1 / (x + y) ** 2, -1 / (x + y) ** 2, 0],
    ]
    off = np.abs(found.values - exact)
    assert (off <= found.error + 1e-14).all() and found.error.max() < 2e-12


def test_a_crease_is_told_with_both_slopes(atlas):
    """At tan ε = −√2 isotropy turns from tan|ε|/√2 to its inverse: slopes ±sec²ε/√2 = ±3/√2."""
    found = gradient(study_of(atlas, ["isotropy"], ["placement.elevation"]), [-np.arctan(np.sqrt(2))])
    assert np.isnan(found.values[0, 0])
    ((_, _, said),) = found.reasons
    assert "crease" in said and "its slope is 2.12" in said and "-2.12" in said
    assert "crease" in found.text()


def test_what_has_no_derivative_is_said(atlas):
    with pytest.raises(SpheredriveError, match="no number that can change"):
        study_of(atlas, ["isotropy"], ["placement.count"])
    with pytest.raises(SpheredriveError, match="rms_acceleration needs speeds"):
        study_of(atlas, ["rms_acceleration"], ["sphere.mass"])
    with pytest.raises(SpheredriveError, match="is zero, so it has no scale"):
        gradient(study_of(atlas, ["preload"], ["contact.damping"]))
    flat = gradient(study_of(atlas, ["preload"], ["placement.elevation"]), [-np.pi / 2 + 0.01])
    assert np.isnan(flat.values).all() and "no number nearby" in flat.reasons[0][2]


def test_indices_of_ishigami():
    """f = sin x + 7 sin² y + 0.1 z⁴ sin x over (−π, π)³ (Ishigami and Homma 1990).

    With V = 49/8 + 0.1 π⁴/5 + 0.01 π⁸/18 + 1/2: S = ((1 + 0.1 π⁴/5)²/2, 49/8, 0)/V, and z acts with x alone, by
    8 · 0.01 π⁸/225 /V. 2048 points know them to a few per cent, within twice the interval that they tell.
    """
    s = study(CUBE.format('{ from = "-180 deg", to = "180 deg" }'))
    found = sobol_indices(s, 2048, formula(lambda x, y, z: (np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x),)))
    V = 49 / 8 + 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5
    first = np.array([(1 + 0.1 * np.pi**4 / 5) ** 2 / 2, 49 / 8, 0]) / V
    together = 8 * 0.01 * np.pi**8 / 225 / V
    total = first + np.array([together, 0, together])
    np.testing.assert_allclose(found.first[0], first, atol=0.03)
    np.testing.assert_allclose(found.total[0], total, atol=0.03)
    assert (np.abs(found.first[0] - first) < 2 * found.first_width[0]).all() and found.points == 2048 * 5


def test_indices_of_a_sum_are_shares_of_variance():
    """f = N(0, 1)·1 + N(0, 2): shares 1/5 and 4/5, alone as in all; a uniform coordinate that is not in it has none."""
    laws = (
        '[parameters]\n"placement.azimuth" = { normal = ["0 rad", "1 rad"] }\n'
        '"placement.heading" = { normal = ["0 rad", "2 rad"] }\n"sphere.mass" = { from = "1 kg", to = "2 kg" }\n'
    )
    found = sobol_indices(study(laws), 1000, formula(lambda x, y, m: (x + y,)))
    np.testing.assert_allclose(found.first[0], [0.2, 0.8, 0.0], atol=0.02)
    np.testing.assert_allclose(found.total[0], [0.2, 0.8, 0.0], atol=0.02)
    assert found.points == 1024 * 5


def test_the_same_seed_gives_the_same_indices():
    ranges = '"placement.elevation" = { from = "-60 deg", to = "-30 deg" }\n"sphere.mass" = { from = "1 kg", to = "3 kg" }\n'
    s = study(f"[parameters]\n{ranges}", '["isotropy", "preload", "mass"]')
    one, two = sobol_indices(s, 64), sobol_indices(s, 64)
    np.testing.assert_array_equal(one.first, two.first)
    np.testing.assert_array_equal(one.total_width, two.total_width)
    # Isotropy comes from the elevation alone, the mass from the sphere's alone.
    assert one.total[0, 0] > 0.9 and one.total[0, 1] == 0 and one.total[2, 0] == 0 and one.total[2, 1] > 0.9


def test_a_point_without_a_number_is_refused():
    s = study('[parameters]\n"placement.elevation" = { from = "-89.9 deg", to = "-100 deg", count = 5 }\n')
    with pytest.raises(SpheredriveError, match=r"need every number, but some points have none: .*elevation runs"):
        sobol_indices(s, 16)


def test_command_reads_a_file(tmp_path):
    (tmp_path / "interface-example.toml").write_bytes((DATA / "interface-example.toml").read_bytes())
    path = tmp_path / "study.toml"
    path.write_text(study('[parameters]\n"placement.elevation" = { from = "-60 deg", to = "-30 deg" }\n').source, "utf-8")
    local, shares = sensitivity_command(path), sensitivity_command(path, 16)
    assert "placement.elevation 1 deg more: -0.0" in local.text() and "1.0" in shares.text()
    assert json.loads(json.dumps(local.as_dict()))["sobol"] is None
    assert json.loads(json.dumps(shares.as_dict()))["sobol"]["points"] == 48
