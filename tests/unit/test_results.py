"""Runs in files: whole or not at all, the same bytes for the same run, and sentences for files that are none."""

import os
import resource
import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray
from test_simulate import PUSH, heavy

import spheredrive as sd
from layouts import atlas
from spheredrive.errors import InputError
from spheredrive.io.results import read_run, require_writable, write_run


@pytest.fixture(scope="module")
def run():
    return sd.simulate(heavy(atlas()), PUSH)


@pytest.fixture
def path(run, tmp_path):
    return write_run(run, tmp_path / "run.nc")


def test_write_run_reads_back_identical(run, path):
    xarray.testing.assert_identical(read_run(path), run)


def test_write_run_is_a_netcdf_file_that_xarray_opens_alone(run, path):
    with xarray.open_dataset(path) as data:
        np.testing.assert_array_equal(data.angular_velocity.sel(axis="z"), run.angular_velocity.sel(axis="z"))
        assert data.time.dtype == float and data.contact.values.tolist()[1] == "1.2"


def test_write_run_has_only_plain_types(path):
    """Doubles, 32-bit integers and characters: what every reader of NetCDF-4 knows, MATLAB's among them."""
    with h5py.File(path) as file:
        kinds = {name: (file[name].dtype.kind, file[name].dtype.itemsize) for name in file}
    assert set(kinds.values()) <= {("f", 8), ("i", 4), ("S", 1), ("f", 4)}
    assert kinds["angular_velocity"] == ("f", 8) and kinds["axis"] == ("S", 1)


@pytest.mark.long
def test_write_run_same_run_gives_same_bytes_in_every_process(path, tmp_path):
    code = (
        "import sys; from layouts import atlas; from test_simulate import PUSH, heavy; import spheredrive as sd;"
        "from spheredrive.io.results import write_run; write_run(sd.simulate(heavy(atlas()), PUSH), sys.argv[1])"
    )
    folders = [str(p) for p in sys.path if p]
    again = tmp_path / "again.nc"
    begin = f"import sys; sys.path[:0] = {folders!r};"
    subprocess.run([sys.executable, "-c", begin + code, str(again)], check=True, env={**os.environ, "PYTHONHASHSEED": "7"})
    assert again.read_bytes() == path.read_bytes()


def test_write_run_holds_long_texts_and_empty_runs(run, tmp_path):
    long = run.assign_attrs(design="# é\n" * 100_000)
    assert read_run(write_run(long, tmp_path / "long.nc")).attrs["design"] == "# é\n" * 100_000
    empty = run.isel(time=slice(0), event=slice(0))
    assert read_run(write_run(empty, tmp_path / "empty.nc")).sizes["time"] == 0


def test_write_run_full_disk_leaves_what_was_there_and_nothing_else(run, path):
    before = path.read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    try:
        with pytest.raises(InputError, match="cannot be written"):
            write_run(run, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_bytes() == before and list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(28, "No space left on device")])
def test_write_run_stopped_while_writing_leaves_nothing(run, tmp_path, monkeypatch, error):
    def fail(handle):
        raise error

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises((KeyboardInterrupt, InputError)):
        write_run(run, tmp_path / "run.nc")
    assert list(tmp_path.iterdir()) == []


def test_write_run_into_no_folder_is_refused(run, tmp_path):
    for target, words in ((tmp_path / "no" / "run.nc", "no such folder"), (tmp_path, "is a folder")):
        with pytest.raises(InputError, match=words):
            write_run(run, target)
        with pytest.raises(InputError, match=words):
            require_writable(target)
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="not a folder"):
        require_writable(tmp_path / "file" / "run.nc")


def test_read_run_refuses_what_is_no_run(path, tmp_path):
    (tmp_path / "text.nc").write_text("time, x\n")
    (tmp_path / "cut.nc").write_bytes(path.read_bytes()[:5000])
    with h5py.File(tmp_path / "other.nc", "w") as file:
        file["x"] = 1.0
    xarray.Dataset({"x": ("k", [1.0])}).to_netcdf(tmp_path / "foreign.nc", engine="h5netcdf")
    for name, words in {
        "absent.nc": "no such file",
        "text.nc": "not a NetCDF-4 file",
        "cut.nc": "is damaged",
        "other.nc": "damaged|lacks",
        "foreign.nc": "no run of spheredrive: it lacks model",
        ".": "is a folder",
    }.items():
        with pytest.raises(InputError, match=words):
            read_run(tmp_path / name)
