"""Points of a study: any part of a sequence is the same wherever it is made, and follows the law it was given."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from spheredrive.io.study_file import parse_study
from spheredrive.studies.sweep.keys import Keys, context_of, plan_of
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.mixing import mixed
from spheredrive.studies.sweep.points import Points
from spheredrive.studies.sweep.sampling import permuted, uniforms

DATA = Path(__file__).parents[1] / "data"
HEAD = 'schema_version = 1\ndesign = "interface-example.toml"\nmetrics = ["isotropy"]\n[parameters]\n'
LAWS = """"sphere.mass" = { normal = ["2 kg", "0.1 kg"] }
"placement.elevation" = { from = "-60 deg", to = "-20 deg" }
"contact.friction" = { triangular = [0.5, 0.8, 0.9] }
"mount.damping" = [1.0, 2.0, 4.0]
"wheels.rollers" = { from = 8, to = 10 }
"""


def study(parameters: str, sampling: str = ""):
    return parse_study(f"{HEAD}{parameters}\n[sampling]\n{sampling}\n", metrics(), folder=DATA)


@pytest.mark.parametrize("method", ["random", "latin-hypercube", "sobol"])
def test_any_part_of_a_sequence_is_a_part_of_the_whole(method):
    points = Points(study(LAWS, f'method = "{method}"\nsize = 333\nseed = 5'))
    whole = points.values(0, 333)
    parts = [points.values(first, min(50, 333 - first)) for first in range(0, 333, 50)]
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    other = Points(study(LAWS, f'method = "{method}"\nsize = 333\nseed = 6')).values(0, 333)
    assert (other[:, :3] != whole[:, :3]).all()


@pytest.mark.parametrize("method", ["random", "latin-hypercube", "sobol"])
def test_points_follow_their_laws(method):
    """Kolmogorov and Smirnov's distance of n random numbers exceeds 2.2/√n once in 10⁴; evenly spread ones stay far below."""
    n = 4096
    X = Points(study(LAWS, f'method = "{method}"\nsize = {n}')).values(0, n)
    low, high = np.radians([-60, -20])
    for column, law in (
        (0, stats.norm(2.0, 0.1)),
        (1, stats.uniform(low, high - low)),
        (2, stats.triang(0.75, 0.5, 0.4)),
    ):
        assert stats.kstest(X[:, column], law.cdf).statistic < (2.2 if method == "random" else 0.5) / np.sqrt(n)
    for column, values in ((3, (1.0, 2.0, 4.0)), (4, (8.0, 9.0, 10.0))):
        share = [(X[:, column] == value).mean() for value in values]
        assert sum(share) == 1.0 and np.abs(np.array(share) - 1 / 3).max() < 4 * np.sqrt(2 / 9 / n)
    correlation = np.corrcoef(X.T) - np.eye(5)
    assert np.abs(correlation).max() < 5 / np.sqrt(n)


def test_a_tolerance_is_cut_off_at_its_ends():
    X = Points(study('"sphere.mass" = { tolerance = "0.3 kg" }', 'method = "sobol"\nsize = 4096')).values(0, 4096)[:, 0]
    assert 1.7 < X.min() < 1.71 and 2.29 < X.max() < 2.3
    assert X.std() == pytest.approx(0.1 * stats.truncnorm(-3, 3).std(), rel=1e-3)


def test_latin_hypercube_has_one_point_in_every_part():
    X = Points(study('"sphere.mass" = { from = "1 kg", to = "2 kg" }', 'method = "latin-hypercube"\nsize = 1000')).values(
        0, 1000
    )
    np.testing.assert_array_equal(np.sort(np.floor((X[:, 0] - 1) * 1000)), np.arange(1000))


@pytest.mark.parametrize("count", [1, 2, 3, 17, 1000])
def test_permuted_is_a_permutation(count):
    for key in (1, 2**63):
        np.testing.assert_array_equal(np.sort(permuted(np.arange(count), count, key)), np.arange(count))


def test_mixing_turns_half_of_the_bits():
    """Each of 64 bits turned in the input turns 32 ± 4 σ/√n of the output's, σ = 4."""
    x = np.arange(2000, dtype=np.uint64) * np.uint64(12345678901)
    for bit in range(0, 64, 7):
        turned = np.bitwise_count(mixed(x) ^ mixed(x ^ np.uint64(1 << bit)))
        assert abs(turned.mean() - 32) < 4 * 4 / np.sqrt(len(x))


def test_sequences_of_two_names_have_nothing_to_do_with_each_other():
    a, b = (uniforms(1, name, np.arange(10_000)) for name in ("a", "b"))
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.04 and a.min() > 0 and a.max() < 1


def test_a_grid_runs_through_its_last_parameter_fastest():
    points = Points(study('"sphere.mass" = ["1 kg", "2 kg"]\n"mount.damping" = [1, 2, 3]'))
    assert points.shape == (2, 3)
    np.testing.assert_array_equal(points.values(2, 3), [[1, 3], [2, 1], [2, 2]])


def test_a_list_goes_side_by_side():
    points = Points(study('"sphere.mass" = ["1 kg", "2 kg"]\n"mount.damping" = [7]', 'method = "list"'))
    np.testing.assert_array_equal(points.values(0, 2), [[1, 7], [2, 7]])


def keys_of(parameters: str) -> dict:
    s = study(parameters)
    points = Points(s)
    X = points.values(0, points.count)
    return {tuple(key): tuple(x) for key, x in zip(Keys(s).of(X).tolist(), X, strict=True)}


def test_keys_tell_points_by_what_they_are():
    """The base's mass is 2 kg, its elevation −40°: whatever is at the base's own value is as if it were not varied."""
    coarse = keys_of('"placement.elevation" = ["-60 deg", "-40 deg", "-20 deg"]')
    finer = keys_of('"placement.elevation" = { from = "-60 deg", to = "-20 deg", count = 5 }\n"sphere.mass" = ["2 kg", "3 kg"]')
    other_way = keys_of('"sphere.mass" = ["3 kg", "2 kg"]\n"placement.1.elevation" = ["-20 deg", "-60 deg"]')
    assert len(finer) == 10 and set(coarse) < set(finer)
    assert all(finer[key][0] == x[0] and finer[key][1] == 2.0 for key, x in coarse.items())
    assert set(other_way) < set(finer)
    assert {x[::-1] for x in other_way.values()} == {x for key, x in finer.items() if key in other_way}


def test_keys_of_choices_go_by_their_text():
    shapes = '"wheels.omni.roller_shape" = '
    there, back = keys_of(f'{shapes}["barrel", "capsule"]'), keys_of(f'{shapes}["capsule", "barrel"]')
    assert set(there) == set(back) and (0, 0) in there
    assert all(there[key][0] == 1 - back[key][0] for key in there)


def test_keys_of_many_points_are_all_different():
    s = study(LAWS, 'method = "random"\nsize = 20000')
    keys = Keys(s).of(Points(s).values(0, 20000))
    assert len(np.unique(keys[:, 0])) == len(np.unique(keys[:, 1])) == 20000


def test_context_is_what_points_share_and_plan_what_makes_them():
    one, more = study('"sphere.mass" = ["1 kg"]'), study('"sphere.mass" = ["1 kg", "2 kg"]')
    text = (DATA / "interface-example.toml").read_text("utf-8")
    assert tomllib.loads(text)["sphere"]["mass"] == "2 kg"
    assert context_of(one) == context_of(more) and plan_of(one, 8) != plan_of(more, 8)
    assert plan_of(one, 8) != plan_of(one, 9)
