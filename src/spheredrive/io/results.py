"""Runs in NetCDF-4 files: written entirely or not at all, equal runs as equal bytes."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

from spheredrive.errors import InputError
from spheredrive.io.files import write_whole

if TYPE_CHECKING:
    import xarray

# What a file must have to be a run.
_ATTRIBUTES = ("model", "completed", "design")
_VARIABLES = ("time", "angular_velocity", "orientation", "wheel_speed")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def write_run(dataset: xarray.Dataset, path: str | os.PathLike) -> Path:
    """Write a run of ``simulate`` to a NetCDF-4 file, whole or not at all, and return the path.

    Raises ``InputError`` where it cannot be written; a file that was there before is then left as it was.
    """
    image = io.BytesIO()
    dataset.to_netcdf(image, engine="h5netcdf")
    write_whole(path, image.getvalue())
    return Path(path)


def require_writable(path: str | os.PathLike) -> None:
    """Raise ``InputError`` where no file can be written at ``path``: to be asked before long work, not after it."""
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise InputError("is a folder; name a file", path=os.fspath(path))
    if not target.parent.exists():
        raise InputError("there is no such folder", path=os.fspath(path))
    if not target.parent.is_dir():
        raise InputError("cannot be written: a part of its path is not a folder", path=os.fspath(path))
    if not os.access(target if target.exists() and not target.is_file() else target.parent, os.W_OK):
        raise InputError("cannot be written: permission denied", path=os.fspath(path))


def read_run(path: str | os.PathLike) -> xarray.Dataset:
    """The run in a file that ``write_run`` has written, in memory as a whole.

    Raises ``InputError`` for a file that is missing, damaged or holds something else.
    """
    import xarray

    shown = os.fspath(path)
    _require_hdf5(path, shown)
    try:
        with xarray.open_dataset(path, engine="h5netcdf", decode_times=False) as file:
            dataset = file.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        # The library's own words name its internals, which help nobody here.
        raise InputError("is damaged: it begins as a NetCDF-4 file but cannot be read to its end", path=shown) from error
    missing = [name for name in _ATTRIBUTES if name not in dataset.attrs]
    missing += [name for name in _VARIABLES if name not in dataset.variables]
    if missing:
        raise InputError(f"is a NetCDF-4 file but no run of spheredrive: it lacks {', '.join(missing)}", path=shown)
    return dataset


def _require_hdf5(path: str | os.PathLike, shown: str) -> None:
    if os.path.isdir(path):
        raise InputError("is a folder, not a file", path=shown)
    try:
        with open(path, "rb") as file:
            begin = file.read(len(_SIGNATURE))
    except FileNotFoundError:
        raise InputError("there is no such file", path=shown) from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {getattr(error, 'strerror', None) or error}".lower(), path=shown) from None
    if begin != _SIGNATURE:
        raise InputError("is not a NetCDF-4 file, which is what a run is kept in", path=shown)
