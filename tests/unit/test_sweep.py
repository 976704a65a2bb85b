"""A sweep as a whole: nothing is lost, nothing is done twice, and the same study gives the same bytes however it went."""

import errno
import json
import os
from pathlib import Path

import numpy as np
import pytest
import xarray

from spheredrive.errors import InputError, SpheredriveError
from spheredrive.io import files
from spheredrive.io.study_file import parse_study
from spheredrive.studies.sweep import coordinator as coordination
from spheredrive.studies.sweep.command import Stopped, sweep, sweep_command
from spheredrive.studies.sweep.executors import Workers, open_workers
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.result import rectangles
from spheredrive.studies.sweep.store import locked

DATA = Path(__file__).parents[1] / "data"
HEAD = 'schema_version = 1\ndesign = "interface-example.toml"\nmetrics = ["isotropy", "effectiveness_max"]\n[parameters]\n'
# Two of these points are no machines: wheels beyond a pole, and at it, where they meet.
AXES = (
    '"placement.elevation" = ["-95 deg", "-90 deg", "-60 deg", "-40 deg", "0 deg"]\n"placement.heading" = ["0 deg", "10 deg"]\n'
)


def study(parameters: str = AXES, sampling: str = ""):
    return parse_study(f"{HEAD}{parameters}\n[sampling]\n{sampling}\n", metrics(), folder=DATA)


def done(folder, s=None, chunk=3, **options):
    return sweep(study() if s is None else s, folder, 0, chunk=chunk, figures=False, **options)


def results(folder) -> tuple[bytes, bytes]:
    return (folder / "result.nc").read_bytes(), (folder / "result.parquet").read_bytes()


@pytest.fixture
def evaluated(monkeypatch):
    """How many points are worked out."""
    count = []
    original = coordination.work
    monkeypatch.setattr(coordination, "work", lambda payload, X: count.append(len(X)) or original(payload, X))
    return count


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    done(folder)
    return results(folder)


def test_results_have_units_and_provenance(tmp_path):
    found = done(tmp_path)
    assert (found.counts.points, found.counts.known, found.counts.partly, found.counts.failed) == (10, 5, 1, 4)
    with xarray.open_dataset(tmp_path / "result.nc") as data:
        assert dict(data.sizes) == {"placement.elevation": 5, "placement.heading": 2, "reasons_number": 3}
        assert data["placement.elevation"].attrs["units"] == "rad"
        np.testing.assert_array_equal(data["placement.heading"], np.radians([0, 10]))
        assert data.isotropy.attrs["long_name"].startswith("isotropy")
        assert data.attrs["study"] == study().source and data.attrs["design"].startswith("schema_version")
        np.testing.assert_array_equal(data.status[:, 0], [2, 2, 0, 0, 1])
        np.testing.assert_array_equal(np.isnan(data.isotropy[:, 0]), [True, True, False, False, False])
        reasons = [str(reason) for reason in data.reasons.values]
        assert "an elevation runs from -90 to 90 deg" in reasons[data.reason.values[0, 0] - 1]
        assert "same point" in reasons[data.reason.values[1, 1] - 1]
        assert reasons[data.reason.values[4, 0] - 1].startswith("effectiveness_max: the layout is singular")
        assert not any("date" in key or "time" in key for key in data.attrs)


def test_parquet_has_one_row_a_point(tmp_path):
    import pyarrow.parquet as pq

    done(tmp_path, study('"placement.elevation" = ["-95 deg", "-40 deg"]\n"wheels.roller_shape" = ["barrel", "capsule"]\n'))
    table = pq.read_table(tmp_path / "result.parquet")
    rows = table.to_pylist()
    assert [row["wheels.roller_shape"] for row in rows] == ["barrel", "capsule"] * 2
    assert rows[0]["isotropy"] is None and rows[0]["status"] == 2 and "elevation runs" in rows[0]["reason"]
    assert rows[3]["isotropy"] > 0.4 and rows[3]["reason"] is None
    assert table.schema.field("placement.elevation").metadata == {b"unit": b"rad"}


@pytest.mark.parametrize("chunk", [1, 4, 100])
def test_bytes_do_not_depend_on_the_size_of_chunks(tmp_path, undisturbed, chunk):
    done(tmp_path, chunk=chunk)
    assert results(tmp_path) == undisturbed


def test_a_second_sweep_works_nothing_out(tmp_path, undisturbed, evaluated):
    done(tmp_path)
    assert sum(evaluated) == 10
    done(tmp_path)
    assert sum(evaluated) == 10 and results(tmp_path) == undisturbed


def test_a_stopped_sweep_goes_on(tmp_path, undisturbed, evaluated):
    def stop(finished, total):
        if finished >= 6:
            raise KeyboardInterrupt

    with pytest.raises(Stopped, match=r"Stopped: [69] of 10 points are kept in .*; the same command goes on"):
        done(tmp_path, watch=stop)
    before = sum(evaluated)
    assert before < 10 and not (tmp_path / "result.nc").exists()
    seen = []
    done(tmp_path, watch=lambda finished, total: seen.append(finished))
    assert seen[0] >= 6 and seen[-1] == 10 and results(tmp_path) == undisturbed
    assert sum(evaluated) <= 10 + 2 * 3


def test_a_chunk_cut_at_any_byte_is_worked_out_again(tmp_path, undisturbed, evaluated):
    done(tmp_path)
    *_, last = sorted(tmp_path.glob("points/*/*/*.chunk"))
    whole = last.read_bytes()
    store = coordination.Coordinator(study(), tmp_path, 3).store
    number = int(last.stem)
    assert store.has(number)
    for end in range(len(whole)):
        last.write_bytes(whole[:end])
        assert not store.has(number)
    for at in range(0, len(whole), 7):
        last.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        assert not store.has(number)
    done(tmp_path)
    assert sum(evaluated) == 10 + 1 and results(tmp_path) == undisturbed and last.read_bytes() == whole


class _Disk:
    """A disk with room for so many calls of what it stands before."""

    def __init__(self, room: int):
        self.room = room

    def before(self, original):
        def call(*arguments, **options):
            self.room -= 1
            if self.room < 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return original(*arguments, **options)

        return call

    def file(self, *arguments, fdopen=os.fdopen):
        opened = fdopen(*arguments)
        return _File(opened, self.before(opened.write))


class _File:
    def __init__(self, file, write):
        self.file, self.write = file, write

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def __getattr__(self, name):
        return getattr(self.file, name)


@pytest.mark.parametrize("step", ["open", "write", "fsync", "replace"])
def test_a_full_disk_leaves_a_folder_that_goes_on(tmp_path, undisturbed, monkeypatch, step):
    """Two chunks and two files of results: each of their writes fails in its turn."""
    for room in range(6):
        folder, disk = tmp_path / str(room), _Disk(room)
        with monkeypatch.context() as patch:
            patch.setattr(files.os, *(("fdopen", disk.file) if step == "write" else (step, disk.before(getattr(os, step)))))
            try:
                done(folder, chunk=6)
            except InputError as error:
                assert "no space left on device" in str(error) and str(folder) in str(error)
                assert "kept" in str(error) or room == 0
                assert not (folder / "result.nc").exists()
            else:
                assert disk.room == 0
                break
        done(folder, chunk=6)
        assert results(folder) == undisturbed
        assert not [left for left in folder.rglob(".*") if left.name != ".lock"]


def test_adding_an_axis_or_values_keeps_the_points(tmp_path, evaluated):
    """The base's mass is 2 kg: points with it are those that were there before."""
    elevations = '"placement.elevation" = { from = "-60 deg", to = "-20 deg", count = 5 }\n'
    done(tmp_path, study(elevations))
    assert sum(evaluated) == 5
    more = elevations.replace("count = 5", "count = 9") + '"sphere.mass" = ["1 kg", "2 kg"]\n'
    done(tmp_path, study(more))
    assert sum(evaluated) == 5 + 13
    done(tmp_path / "fresh", study(more))
    assert results(tmp_path) == results(tmp_path / "fresh")


def test_another_base_design_shares_nothing(tmp_path, evaluated):
    elevations = '"placement.elevation" = ["-60 deg", "-40 deg"]\n'
    done(tmp_path, study(elevations))
    heavier = DATA.joinpath("interface-example.toml").read_text("utf-8").replace('mass = "2 kg"', 'mass = "3 kg"')
    (tmp_path / "interface-example.toml").write_text(heavier, "utf-8")
    done(tmp_path, parse_study(f"{HEAD}{elevations}", metrics(), folder=tmp_path))
    assert sum(evaluated) == 4


def test_random_points_stand_along_one_dimension(tmp_path):
    s = study('"sphere.mass" = { normal = ["2 kg", "0.1 kg"] }\n"wheels.roller_shape" = ["barrel", "capsule"]\n',
              'method = "random"\nsize = 70')  # fmt: skip
    done(tmp_path, s, chunk=16)
    with xarray.open_dataset(tmp_path / "result.nc") as data:
        assert data.isotropy.dims == ("point",) and data.sizes["point"] == 70
        assert abs(float(data["sphere.mass"].mean()) - 2) < 0.1
        assert set(data["wheels.roller_shape"].values) == {0, 1}
        assert [str(word) for word in data["wheels.roller_shape.choices"].values] == ["barrel", "capsule"]


def test_two_sweeps_do_not_share_a_folder(tmp_path):
    with locked(tmp_path), pytest.raises(InputError, match="another sweep is writing"):
        done(tmp_path)


def test_a_study_without_metrics_is_refused(tmp_path):
    s = parse_study(HEAD.replace('"isotropy", "effectiveness_max"', "") + AXES, metrics(), folder=DATA)
    with pytest.raises(SpheredriveError, match="names no metrics"):
        done(tmp_path, s)


class _Mortal(Workers):
    """Workers that die with chosen points: an executor in this process that breaks as a pool does."""

    def __init__(self, deadly):
        from concurrent.futures import ThreadPoolExecutor
        from concurrent.futures.process import BrokenProcessPool

        self.deadly, self.deaths, self.renewed = deadly, 0, 0
        super().__init__(lambda: ThreadPoolExecutor(1), 2, lost=(BrokenProcessPool,))

    def submit(self, function, payload, X):
        def mortal():
            if self.deadly(X, self.deaths):
                self.deaths += 1
                raise self.lost[0]("died")
            return function(payload, X)

        return self._executor.submit(mortal)

    def renew(self):
        self.renewed += 1
        super().renew()


def finish(folder, deadly):
    workers = _Mortal(deadly)
    c = coordination.Coordinator(study(), folder, 3)
    try:
        c.run(workers)
    finally:
        workers.stop()
    return workers, c


def test_work_of_dead_workers_is_done_again(tmp_path, undisturbed):
    workers, c = finish(tmp_path, lambda X, deaths: deaths < 7)
    assert workers.renewed >= 3 and c.done == 10
    done(tmp_path)
    assert results(tmp_path) == undisturbed


def test_points_that_kill_their_worker_again_and_again_are_named(tmp_path):
    deadly = np.radians(-40)
    with pytest.raises(SpheredriveError, match=r"points 7 to 9 of the study stop the process .* 7 of 10 points are kept"):
        finish(tmp_path, lambda X, deaths: deadly in X[:, 0])


def test_a_pool_of_processes_gives_the_same_bytes(tmp_path, undisturbed):
    sweep(study(), tmp_path, 1, chunk=3, figures=False)
    assert results(tmp_path) == undisturbed


def test_figures_are_drawn_for_one_two_and_more_parameters(tmp_path):
    elevation = '"placement.elevation" = { from = "-60 deg", to = "-20 deg", count = 9 }\n'
    heading = '"placement.heading" = { from = "0 deg", to = "20 deg", count = 8 }\n'
    mass = '"sphere.mass" = ["1 kg", "2 kg"]\n'
    for name, parameters, expected in (
        ("one", elevation, {"lines.svg"}),
        ("colours", elevation + mass, {"lines.svg"}),
        ("two", elevation + heading, {"maps.svg"}),
        ("three", elevation + heading + mass, {"pairs.svg", "tornado.svg"}),
    ):
        found = sweep(study(parameters), tmp_path / name, 0)
        drawn = {file.name for file in found.files if file.suffix == ".svg"}
        assert drawn == expected
        for file in drawn:
            assert (tmp_path / name / file).read_text("utf-8").count("<path") > 10


def test_command_refuses_what_does_not_go_together(tmp_path):
    (tmp_path / "interface-example.toml").write_bytes((DATA / "interface-example.toml").read_bytes())
    (tmp_path / "study.toml").write_text(HEAD + AXES, "utf-8")
    with pytest.raises(SpheredriveError, match="one of the two"):
        sweep_command(tmp_path / "study.toml", tmp_path / "out", 2, "tcp://127.0.0.1:1")
    with pytest.raises(SpheredriveError, match="number of processes"):
        sweep_command(tmp_path / "study.toml", tmp_path / "out", -1, None)
    found = sweep_command(tmp_path / "study.toml", tmp_path / "out", 0, None)
    assert found.works and json.loads(json.dumps(found.as_dict()))["points"] == 10
    assert "10 points: 5 with all metrics, 1 with some, 4 with none" in found.text()


def test_without_a_pool_work_is_done_here():
    with open_workers(0) as workers:
        assert workers.count == 1 and workers.submit(os.getpid).result() == os.getpid()


@pytest.mark.parametrize("shape", [(7,), (3, 4), (2, 3, 4), (5, 1, 2)])
def test_rectangles_cover_a_stretch_in_order(shape):
    numbers = np.arange(np.prod(shape)).reshape(shape)
    for begin in range(numbers.size):
        for end in range(begin + 1, numbers.size + 1):
            parts = [(numbers[place].ravel(), np.arange(a, b)) for place, a, b in rectangles(shape, begin, end)]
            assert all(np.array_equal(*part) for part in parts)
            np.testing.assert_array_equal(np.concatenate([part[0] for part in parts]), np.arange(begin, end))
