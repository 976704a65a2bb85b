"""What the datasets of all models share: how variables are labelled, and where a run says it comes from."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray

import spheredrive

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion


class Variable(NamedTuple):
    """A variable that is an array of the run as it stands: its name, dimensions, unit, meaning and the array's name."""

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    source: str


def variable(dims: tuple[str, ...], values, units: str, long_name: str) -> xarray.Variable:
    """Values with their unit and meaning."""
    # Compression without a choice of its own gives the same bytes every time; NaN stays what it is.
    encoding = {"_FillValue": None, "zlib": True, "complevel": 1, "shuffle": True}
    return xarray.Variable(dims, values, {"units": units, "long_name": long_name}, encoding)


def coordinates(design: Design, time) -> dict[str, xarray.Variable]:
    """Coordinates that every run has: time (k,), axes, wheels, contacts."""
    pairs = contact_numbers(design)
    numbers = np.array(pairs, np.int32).reshape(-1, 2)
    return {
        "time": variable(("time",), time, "s", "time"),
        "axis": words("axis", ["x", "y", "z"], "axis of the inertial frame"),
        "quat_wxyz": words("quat_wxyz", ["w", "x", "y", "z"], "component of a quaternion"),
        "wheel": variable(("wheel",), np.arange(1, design.wheel_count + 1, dtype=np.int32), "1", "wheel, numbered from 1"),
        "contact": words("contact", [f"{wheel}.{race}" for wheel, race in pairs], "contact: wheel.race, numbered from 1"),
        "contact_wheel": variable(("contact",), numbers[:, 0], "1", "wheel of the contact, numbered from 1"),
        "contact_race": variable(("contact",), numbers[:, 1], "1", "race of the contact, numbered from 1"),
    }


def words(dim: str, labels: list[str], long_name: str) -> xarray.Variable:
    """Labels of a dimension."""
    # Rows of characters: strings of any length are a type that not every reader of NetCDF-4 knows.
    return xarray.Variable((dim,), np.array(labels), {"units": "1", "long_name": long_name}, {"dtype": "S1"})


def contact_numbers(design: Design) -> list[tuple[int, int]]:
    """(wheel, race) of every contact that any state of the wheels can have, numbered from 1, wheel by wheel."""
    return [(i, number) for i, wheel in enumerate(design.wheels, 1) for number in race_numbers(design, wheel)]


def race_numbers(design: Design, wheel) -> list[int]:
    """Numbers of a wheel's races, from 1."""
    return [race.number for race in design.races(wheel)]


def attributes(design: Design, motion: Motion, model: str, completed: bool, reason: str, solver: dict) -> dict[str, object]:
    """Attributes of a run: program, model, how it ended, the ``solver``'s settings, design and motion with their hashes."""
    return {
        "title": _plain(design.name),
        "program": "spheredrive",
        "version": spheredrive.__version__,
        "model": model,
        "completed": np.int32(completed),
        "reason": reason,
        "duration": motion.duration,
        **solver,
        "sample_rate": motion.sample_rate,
        "seed": np.int32(-1),
        "design": _plain(design.source),
        "design_sha256": _sha256(design.source),
        # Texts do not hold the tables that they name, nor what was changed in code: the values do.
        "design_values_sha256": _sha256(repr(design)),
        "motion": _plain(motion.source),
        "motion_sha256": _sha256(motion.source),
        "motion_values_sha256": _sha256(repr(motion)),
    }


def _plain(text: str) -> str:
    """Text as a file can hold it: without what is no character, and without NUL, which would end it."""
    return text.encode("utf-8", "replace").decode("utf-8").replace("\0", "\N{REPLACEMENT CHARACTER}")


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
