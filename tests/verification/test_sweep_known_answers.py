"""Sweeps that must come out at answers known in closed form."""

import math

import numpy as np
import pytest
import xarray

from spheredrive.designs import design_path
from spheredrive.io.study_file import parse_study
from spheredrive.studies.sweep.command import sweep
from spheredrive.studies.sweep.metrics import metrics


def swept(folder, design: str, names: list[str], parameters: str):
    path = design_path(design)
    text = f'schema_version = 1\ndesign = "{path.name}"\nmetrics = {names}\n[parameters]\n{parameters}\n'.replace("'", '"')
    sweep(parse_study(text, metrics(), folder=path.parent), folder, 0, figures=False)
    with xarray.open_dataset(folder / "result.nc") as data:
        return data.load()


def test_three_wheels_are_isotropic_where_the_elevation_is_that_of_a_cubes_edges(tmp_path):
    """σ = √(3/2) sin θ, twice, and √3 cos θ: equal where tan θ = √2. Steps of 1e-4° are 1.7e-6 rad, half of it the farthest."""
    data = swept(
        tmp_path, "atlas-demonstrator", ["isotropy", "sigma_min", "condition_number", "effectiveness_min"],
        '"placement.elevation" = { from = "-54.8 deg", to = "-54.7 deg", count = 1001 }',
    )  # fmt: skip
    best = data.isel({"placement.elevation": int(np.argmax(data.isotropy.values))})
    assert float(best["placement.elevation"]) == pytest.approx(-math.atan(math.sqrt(2)), abs=1e-6)
    # There σ₃/σ₁ falls as 1 − (tan θ + cot θ) |Δθ|, which is 2.12 |Δθ|.
    assert 1 - 2.2e-6 < float(best.isotropy) <= 1
    assert float(best.condition_number) == pytest.approx(1, abs=2.2e-6)
    assert float(best.sigma_min) == pytest.approx(1, abs=2e-6) and float(best.effectiveness_min) == pytest.approx(1, abs=2e-6)


def test_the_orthogonal_layout_is_isotropic(tmp_path):
    """A = 1 but for the order of its rows; with roller angle α its determinant is cot³α − 1, singular at 45°."""
    data = swept(
        tmp_path, "orthogonal", ["isotropy", "determinant", "effectiveness_max"],
        '"wheels.roller_angle" = ["90 deg", "60 deg", "-45 deg", "45 deg"]',
    )  # fmt: skip
    alpha = data["wheels.roller_angle"].values
    assert float(data.isotropy[0]) == pytest.approx(1, abs=1e-15)
    assert abs(float(data.determinant[0])) == pytest.approx(1, abs=1e-15)
    cot = [0.0, *(1 / math.tan(a) for a in alpha[1:])]
    for found, c in zip(data.determinant.values, cot, strict=True):
        assert found == pytest.approx(c**3 - 1, abs=1e-14)
    assert data.status.values.tolist() == [0, 0, 0, 1] and float(data.isotropy[3]) == 0


def test_natural_frequencies_follow_the_root_of_stiffness_over_mass(tmp_path):
    """0.938 and 1.112 × √(K/M) at Atlas 40° with rigid mounts and round contacts (model.md section 5b)."""
    data = swept(
        tmp_path, "atlas-demonstrator", ["natural_frequency_min", "natural_frequency_max"],
        '"sphere.mass" = ["2 kg", "5 kg", "80 kg"]\n"contact.stiffness" = ["1e4 N/m", "188208 N/m", "1e7 N/m"]',
    )  # fmt: skip
    scale = (data["contact.stiffness"] / data["sphere.mass"]) ** 0.5 / (2 * math.pi)
    # cos θ √(3/2) and sin θ √3 with θ = 40°.
    for found, factor in (
        (data.natural_frequency_min, math.cos(math.radians(40)) * math.sqrt(1.5)),
        (data.natural_frequency_max, math.sin(math.radians(40)) * math.sqrt(3)),
    ):
        assert float(abs(found / scale / factor - 1).max()) < 1e-12
