"""Optimize: known fronts and optima, the same bytes however it went, and words for what stands in the way."""

import json
import os
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

import spheredrive as sd
from spheredrive.checking import check
from spheredrive.errors import InputError, SpheredriveError
from spheredrive.io import files
from spheredrive.io.study_file import parse_study
from spheredrive.studies.optimize import search as searching
from spheredrive.studies.optimize.algorithm import partitions, settled
from spheredrive.studies.optimize.command import Stopped, optimize, optimize_command
from spheredrive.studies.optimize.front import history, hypervolume, knee_of, knee_text, non_dominated, scale_of
from spheredrive.studies.optimize.goals import Goals
from spheredrive.studies.optimize.outcome import outcome
from spheredrive.studies.optimize.search import Search
from spheredrive.studies.optimize.space import Space
from spheredrive.studies.sweep.command import sweep
from spheredrive.studies.sweep.evaluate import Rows
from spheredrive.studies.sweep.metrics import metrics

DATA = Path(__file__).parents[1] / "data"
HEAD = 'schema_version = 1\ndesign = "interface-example.toml"\n'
ELEVATION = '[parameters]\n"placement.elevation" = { from = "-80 deg", to = "-10 deg" }\n'
MIXED = ELEVATION + '"placement.count" = [3, 4, 5]\n"wheels.omni.roller_shape" = ["barrel", "capsule"]\n'
TWO = '[objectives]\nisotropy = "max"\npreload = "min"\n'


def study(parameters=MIXED, objectives=TWO, constraints="", population=8, generations=5, name="nsga2", seed=2):
    algorithm = f'[algorithm]\nname = "{name}"\npopulation = {population}\ngenerations = {generations}\n'
    bounds = f"[constraints]\n{constraints}\n" if constraints else ""
    text = f"{HEAD}{parameters}{objectives}{bounds}{algorithm}[sampling]\nseed = {seed}\n"
    return parse_study(text, metrics(), folder=DATA)


def results(folder) -> dict[str, bytes]:
    kept = (".nc", ".parquet", ".toml")
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.suffix in kept}


class Formula:
    """A bench on which points are worth what a formula says of their coordinates."""

    def __init__(self, formula):
        self.formula, self.points = formula, 0

    def rows(self, X):
        self.points += len(X)
        return Rows(self.formula(X), np.zeros(len(X), np.int64), ())


def cube(count: int) -> str:
    """Parameters from 0 to 1: coordinates of a test function by the names of a machine."""
    names = ("sphere.mass", "wheels.omni.mass", "contact.friction", "contact.stiffness", "mount.stiffness", "stage.mass")
    units = (" kg", " kg", "", " N/m", " N/m", " kg")
    lines = [f'"{name}" = {{ from = {_number(0, u)}, to = {_number(1, u)} }}' for name, u in zip(names, units, strict=True)]
    return "[parameters]\n" + "\n".join(lines[:count]) + "\n"


def _number(value: int, unit: str) -> str:
    return f'"{value or 1e-9}{unit}"' if unit else str(value)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    return optimize(study(), tmp_path_factory.mktemp("undisturbed"), 0)


def test_a_known_front_is_reached(tmp_path):
    """ZDT1: f₂ = 1 − √f₁ where all other coordinates are 0 (Zitzler, Deb and Thiele 2000).

    The front's ends are (0, 1) and (1, 0), so its hypervolume to (1.1, 1.1) is 1.1² − 1 + ∫₀¹ √f df = 0.21 + 2/3. A population
    of 40 spread evenly over it lacks less than 2 % of that.
    """

    def zdt1(X):
        g = 1 + 9 * X[:, 1:].mean(axis=1)
        return np.column_stack([X[:, 0], g * (1 - np.sqrt(X[:, 0] / g))])

    s = study(cube(5), '[objectives]\nisotropy = "min"\npreload = "min"\n', population=40, generations=80)
    search, bench = Search(s, tmp_path), Formula(zdt1)
    o = outcome(search, search.run(bench), bench, polish=False)
    F = o.F[o.front]
    assert np.abs(F[:, 1] - (1 - np.sqrt(F[:, 0]))).max() < 0.02
    exact = 0.21 + 2 / 3
    scale = scale_of(np.array([[0.0, 1.0], [1.0, 0.0]]))
    assert 0.98 * exact < hypervolume(F, scale) < exact
    # On f₂ = 1 − √f₁ the depth (√f − f)/√2 is largest at f = 1/4.
    assert abs(F[o.knee.place, 0] - 0.25) < 0.03 and abs(o.knee.depth - 0.25 / np.sqrt(2)) < 0.005
    assert np.diff(o.volume).min() >= 0


def test_three_goals_spread_over_a_known_front(tmp_path):
    """DTLZ2: Σ f² = 1 where the other coordinates are 1/2 (Deb, Thiele, Laumanns and Zitzler 2005), by NSGA-III."""

    def dtlz2(X):
        g = 1 + ((X[:, 2:] - 0.5) ** 2).sum(axis=1)
        a, b = np.pi / 2 * X[:, 0], np.pi / 2 * X[:, 1]
        return g[:, None] * np.column_stack([np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)])

    three = '[objectives]\nisotropy = "min"\npreload = "min"\nmass = "min"\n'
    s = study(cube(4), three, population=36, generations=50, name="nsga3")
    search, bench = Search(s, tmp_path), Formula(dtlz2)
    o = outcome(search, search.run(bench), bench, polish=False)
    last = o.F[(o.generation == 50)]
    assert np.median(np.abs(np.linalg.norm(last, axis=1) - 1)) < 0.03
    # In the corners and in the middle: a search that has lost a goal stays away from one of them.
    for corner in (*np.eye(3), np.full(3, 1 / np.sqrt(3))):
        assert np.linalg.norm(o.F[o.front] - corner, axis=1).min() < 0.15


def test_the_best_elevation_of_three_wheels_is_found_to_the_last_digits(tmp_path):
    """A ring of three has AᵀA = diag(3/2 sin²ε, 3/2 sin²ε, 3 cos²ε): all directions are alike at tan²ε = 2."""
    found = optimize(
        study(ELEVATION, '[objectives]\nisotropy = "max"\n', population=8, generations=4), tmp_path, 0, figures=False
    )
    o = found.outcome
    assert abs(o.X[o.front[0], 0] + np.arctan(np.sqrt(2))) < 1e-9 and o.rows.values[o.front[0], 0] > 1 - 1e-9
    assert o.generation[o.front[0]] == 0
    design = sd.load_design(tmp_path / "designs" / "best-isotropy.toml")
    assert check(design).isotropy > 1 - 1e-9


def test_polishing_finds_a_smooth_constrained_optimum(tmp_path):
    """min (x − 2)² + (y − 1)² with x + y ≤ 1: at (1, 0), worth 2, by the gradients (2, 2) of both."""

    def formula(X):
        return np.column_stack([(X[:, 0] - 2) ** 2 + (X[:, 1] - 1) ** 2, X[:, 0] + X[:, 1]])

    s = study(cube(2), '[objectives]\npreload = "min"\n', 'isotropy = "<= 1"', population=8, generations=3)
    search, bench = Search(s, tmp_path), Formula(formula)
    search.goals.asked = s
    o = outcome(search, search.run(bench), bench)
    np.testing.assert_allclose(o.F[o.front], [[2.0]], atol=1e-6)
    np.testing.assert_allclose(o.X[o.front[0]], [1.0, 0.0], atol=1e-6)


def test_constraints_bind(undisturbed, tmp_path):
    tight = optimize(study(constraints='opening = ">= 130 deg"'), tmp_path, 0, figures=False).outcome
    loose = undisturbed.outcome
    opening = tight.rows.values[:, 2]
    assert (opening[tight.front] >= np.radians(130)).all() and (opening < np.radians(130)).any()
    assert tight.F[tight.front, 1].min() > loose.F[loose.front, 1].min()


def test_the_same_seed_gives_the_same_bytes(undisturbed, tmp_path):
    optimize(study(), tmp_path / "same", 0)
    assert results(tmp_path / "same") == results_of(undisturbed)
    for name in ("front.svg", "history.svg"):
        assert (tmp_path / "same" / name).read_bytes() == (undisturbed.files[0].parent / name).read_bytes()
    optimize(study(seed=3), tmp_path / "other", 0, figures=False)
    assert results(tmp_path / "other")["result.nc"] != results_of(undisturbed)["result.nc"]


def results_of(undisturbed) -> dict[str, bytes]:
    return results(undisturbed.files[0].parent)


def test_a_stopped_search_goes_on_without_a_trace(undisturbed, tmp_path, monkeypatch):
    def stop(share):
        if share >= 0.6:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match=r"3 of 5 generations are kept in .*; the same command goes on"):
        optimize(study(), tmp_path, 0, watch=stop, figures=False)
    assert not results(tmp_path)
    evaluated = []
    original = searching.work
    monkeypatch.setattr(searching, "work", lambda payload, X: evaluated.append(len(X)) or original(payload, X))
    optimize(study(), tmp_path, 0, figures=False)
    assert evaluated[:2] == [8, 8] and results(tmp_path) == results_of(undisturbed)
    before = len(evaluated)
    optimize(study(generations=6), tmp_path, 0, figures=False)
    # A longer search goes on from the shorter one.
    assert evaluated[before] == 8 and results(tmp_path)["result.nc"] != results_of(undisturbed)["result.nc"]


def test_a_generation_cut_short_or_altered_is_worked_out_again(undisturbed, tmp_path):
    optimize(study(), tmp_path, 0, figures=False, polish=False)
    chunks = sorted(tmp_path.glob("points/*/*/*.chunk"))
    whole = [chunk.read_bytes() for chunk in chunks]
    chunks[1].write_bytes(whole[1][:-20])
    chunks[2].write_bytes(whole[2][:-20] + b"x" + whole[2][-19:])
    optimize(study(), tmp_path, 0, figures=False)
    assert [chunk.read_bytes() for chunk in chunks] == whole and results(tmp_path) == results_of(undisturbed)


@pytest.mark.parametrize("room", [2, 6])
def test_a_full_disk_leaves_a_folder_that_goes_on(undisturbed, tmp_path, monkeypatch, room):
    calls = []

    def fsync(handle):
        calls.append(handle)
        if len(calls) > room:
            raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(files.os, "fsync", fsync)
        with pytest.raises(InputError, match="no space left on device"):
            optimize(study(), tmp_path, 0, figures=False)
    optimize(study(), tmp_path, 0, figures=False)
    assert results(tmp_path) == results_of(undisturbed)


def test_results_tell_what_they_are(undisturbed):
    found = undisturbed
    folder = found.files[0].parent
    with xarray.open_dataset(folder / "result.nc") as data:
        assert data.attrs["objectives"] == "isotropy: max; preload: min" and data.attrs["study"] == study().source
        assert set(data.generation.values) <= set(range(6)) and data.front.sum() == len(found.outcome.front)
        assert [str(word) for word in data["wheels.omni.roller_shape.choices"].values] == ["barrel", "capsule"]
        assert data["placement.elevation"].attrs["units"] == "rad" and len(data.hypervolume) == 5
        assert not any("date" in key or "time" in key for key in data.attrs)
    import pyarrow.parquet as pq

    rows = pq.read_table(folder / "result.parquet").to_pylist()
    assert len(rows) == len(found.outcome.X) and rows[0]["wheels.omni.roller_shape"] in ("barrel", "capsule")
    told = json.loads(json.dumps(found.as_dict()))
    assert told["front"][told["knee"]]["metrics"]["isotropy"] > 0 and "knee: isotropy" in found.text()


def test_design_files_are_the_points(undisturbed):
    """Each is accepted, has the point's numbers, and keeps its ring as a ring."""
    folder = undisturbed.files[0].parent / "designs"
    assert {"knee.toml", "best-isotropy.toml", "best-preload.toml"} <= {p.name for p in folder.iterdir()}
    for path in folder.glob("*.toml"):
        result = check(sd.load_design(path))
        (line,) = [line for line in path.read_text("utf-8").splitlines() if line.startswith("# isotropy")]
        assert abs(result.isotropy - float(line.split("=")[1])) < 1e-5
        assert len(tomllib.loads(path.read_text("utf-8"))["placement"]) == 1


def test_points_are_in_range_and_stepped():
    space = Space(study())
    rng = np.random.default_rng(1)
    U = space.snapped(np.vstack([np.zeros(3), np.ones(3), rng.random((200, 3))]))
    X = space.points(U)
    np.testing.assert_array_equal(X[:2, 0], np.radians([-80, -10]))
    assert set(X[:, 1]) == {3.0, 4.0, 5.0} and set(X[:, 2]) == {0.0, 1.0}
    np.testing.assert_array_equal(space.snapped(U), U)
    first = Space(study()).first(6)
    assert sorted(np.floor(6 * first[:, 0])) == list(range(6))


def test_a_small_space_is_tried_whole(tmp_path):
    s = study('[parameters]\n"placement.count" = [3, 4, 5, 6]\n"placement.elevation" = ["-50 deg", "-40 deg"]\n', generations=9)
    found = optimize(s, tmp_path, 0, figures=False).outcome
    assert len(np.unique(found.X, axis=0)) == 8


def test_non_dominated_by_definition(rng):
    F = np.round(rng.random((60, 3)), 1)
    beaten = [any((f >= G).all() and (f > G).any() for G in F) for f in F]
    best = non_dominated(F)
    assert not best[beaten].any()
    assert set(map(tuple, F[best])) == set(map(tuple, F[~np.array(beaten)])) and len(np.unique(F[best], axis=0)) == best.sum()


def test_knee_of_a_corner_and_of_a_line():
    """Of (0, 1), (1/4, 1/4), (1, 0) the middle lies (1 − 1/2)/√2 deep; a unit of either goal costs 3 of the other."""
    knee = knee_of(np.array([[0.0, 100.0], [0.25, 25.0], [1.0, 0.0]]))
    assert knee.place == 1 and abs(knee.depth - 0.5 / np.sqrt(2)) < 1e-15 and knee.costs == (3.0, 3.0)
    assert "1 % more of a costs 3 % of b" in knee_text(knee, ("a", "b"))
    straight = knee_of(np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]))
    assert "no knee" in knee_text(straight, ("a", "b"))


def test_history_rises_to_the_volume_of_the_front():
    """Boxes from (1, 1), then from (0.5, 0.5), to 1.1 times the range of a front from 0 to 1."""
    F = np.array([[1.0, 1.0], [0.5, 0.5], [0.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    scale = scale_of(np.array([[0.0, 1.0], [1.0, 0.0]]))
    volumes = history(F, np.array([True, True, True, True, False]), np.array([1, 2, 3, 3, 3]), scale)
    np.testing.assert_allclose(volumes, [0.01, 0.36, 0.36 + 2 * 0.5 * 0.1], rtol=1e-12)


def test_points_without_numbers_are_worst():
    goals = Goals(study(constraints='clearance = ">= 5 mm"'))
    rows = Rows(np.array([[0.5, 10.0, 0.01], [0.5, np.nan, 0.01], [0.5, 10.0, 0.0]]), np.array([0, 1, 0]), ("why",))
    found = goals.measured(rows)
    assert found.feasible.tolist() == [True, False, False] and found.violation[1] > found.violation[2] == 1.0


@pytest.mark.parametrize(("objectives", "population", "expected"), [(3, 64, 9), (3, 2, 1), (4, 64, 5), (2, 64, 63), (1, 9, 1)])
def test_partitions_fit_the_population(objectives, population, expected):
    from math import comb

    p = partitions(objectives, population)
    assert p == expected
    if p > 1:
        assert comb(objectives + p - 1, p) <= population < comb(objectives + p, p + 1)


def test_nsga3_is_taken_from_three_goals_on():
    three = SimpleNamespace(algorithm=None, objectives=(1, 2, 3))
    assert settled(three)[0] == "nsga3" and settled(SimpleNamespace(algorithm=None, objectives=(1, 2)))[0] == "nsga2"


def test_equal_violations_are_told_apart_by_the_seed(tmp_path):
    """NSGA-III tosses a coin between points that break constraints alike: nothing but the seed may know it."""
    impossible = study(MIXED, TWO, 'opening = ">= 179 deg"\nclearance = ">= 10 m"', name="nsga3", population=10, generations=6)
    runs = [Search(impossible, tmp_path / str(k)) for k in (0, 1)]
    points = []
    for search in runs:
        formula = Formula(lambda X: np.column_stack([X[:, 0], X[:, 1], 0 * X[:, 0], 0 * X[:, 0]]))
        points.append(search.run(formula).X)
    np.testing.assert_array_equal(*points)


def test_what_is_wrong_is_said(tmp_path):
    with pytest.raises(SpheredriveError, match="names no objectives"):
        optimize(study('[parameters]\n"placement.count" = [3, 4]\n', ""), tmp_path)
    with pytest.raises(SpheredriveError, match=r"no algorithm 'nsga4'; choose from nsga2, nsga3"):
        optimize(study(name="nsga4"), tmp_path)
    with pytest.raises(SpheredriveError, match="motor_torque needs motion"):
        optimize(study(objectives='[objectives]\nmotor_torque = "min"\n'), tmp_path)
    with pytest.raises(SpheredriveError, match=r"none of 40 designs keeps all constraints: clearance >= 9 is broken by \d+ of"):
        optimize(study(constraints='clearance = ">= 9 m"'), tmp_path / "a", 0)
    with pytest.raises(SpheredriveError, match=r"all lack numbers, most of them as price: no price of wheels\.omni is given"):
        optimize(study(objectives='[objectives]\nprice = "min"\n'), tmp_path / "b", 0)
    scattered = HEAD + '[parameters]\n"sphere.mass" = { normal = ["2 kg", "0.1 kg"] }\n' + TWO
    scattered = parse_study(scattered + '[sampling]\nmethod = "random"\nsize = 3\n', metrics(), folder=DATA)
    with pytest.raises(SpheredriveError, match=r"sphere\.mass is scattered \(normal\)"):
        optimize(scattered, tmp_path)
    ranges = study().source.replace("[parameters]", 'metrics = ["mass"]\n[parameters]', 1)
    with pytest.raises(SpheredriveError, match="is a range for optimize"):
        sweep(parse_study(ranges, metrics(), folder=DATA), tmp_path / "c", 0)


def test_the_cheaper_part_is_chosen(tmp_path):
    """Two catalogue parts that fit: the price decides, and the study says what they cost."""
    parts = '[parameters]\n"wheels.omni.catalogue" = ["nexus/14148", "nexus/14182"]\n"placement.count" = [3, 4]\n'
    prices = '[prices]\n"nexus/14148" = 30.0\n"nexus/14182" = 20\n'
    s = study(parts + prices, '[objectives]\nprice = "min"\n', population=4, generations=2)
    o = optimize(s, tmp_path, 0, figures=False).outcome
    assert o.F[o.front, 0] == [60.0] and o.X[o.front[0]].tolist() == [1.0, 3.0]
    with pytest.raises(InputError, match=r"prices\.nexus/14183: there is no such part or wheel model; did you mean"):
        study(parts + prices.replace("14182", "14183"))


def test_command_reads_a_file(tmp_path):
    (tmp_path / "interface-example.toml").write_bytes((DATA / "interface-example.toml").read_bytes())
    (tmp_path / "study.toml").write_text(study(ELEVATION, generations=2).source, "utf-8")
    with pytest.raises(SpheredriveError, match="one of the two"):
        optimize_command(tmp_path / "study.toml", tmp_path / "out", 1, "tcp://127.0.0.1:1")
    found = optimize_command(tmp_path / "study.toml", tmp_path / "out", 0, None)
    assert found.works and os.path.exists(tmp_path / "out" / "front.svg")
