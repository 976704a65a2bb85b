"""The results of a sweep or an optimisation as points to choose from, and the machine of each."""

from __future__ import annotations

import json
import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.design import Design
from spheredrive.errors import DesignError, InputError
from spheredrive.io.design_file import parse_design
from spheredrive.io.design_path import assigned, resolve
from spheredrive.io.toml_text import toml_text

if TYPE_CHECKING:
    import xarray

RESULT = "result.nc"
# What a result file has beside parameters and metrics.
_OTHER = ("status", "reason", "reasons")


@dataclass(frozen=True, eq=False)
class StudyResult:
    """P points of a study.

    title       what the file calls itself
    parameters  value of each parameter at each point, (P,): SI numbers, or words
    metrics     value of each metric at each point, (P,), NaN where there is none
    units       of both
    senses      "min" or "max" of the metrics that are objectives
    data        the base design's file, as plain data
    folder      where files that it names are sought
    """

    title: str
    parameters: dict[str, np.ndarray]
    metrics: dict[str, np.ndarray]
    units: dict[str, str]
    senses: dict[str, str]
    data: dict[str, Any]
    folder: Path

    @property
    def count(self) -> int:
        """P."""
        return len(next(iter(self.metrics.values())))

    def base(self) -> Design:
        """The machine that the study varies."""
        return parse_design(toml_text(self.data), "the study's design", self.folder)

    def design(self, point: int) -> Design:
        """The machine of a point. Raises ``InputError`` or ``DesignError`` where it cannot be."""
        values = [(resolve(name, self.data), _plain(column[point])) for name, column in self.parameters.items()]
        shown = " ".join(f"{name}={_shown(column[point])}" for name, column in self.parameters.items())
        return parse_design(toml_text(assigned(self.data, values)), f"point {point + 1}: {shown}", self.folder)

    def front(self, one: str, other: str) -> np.ndarray:
        """Points that no other beats in both metrics, by their senses, ordered along ``one``; all where a sense is missing."""
        x, y = self.metrics[one], self.metrics[other]
        known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        if one not in self.senses or other not in self.senses:
            return known[np.argsort(x[known], kind="stable")]
        signs = [1.0 if self.senses[name] == "min" else -1.0 for name in (one, other)]
        order = known[np.lexsort((signs[1] * y[known], signs[0] * x[known]))]
        best, kept = np.inf, []
        for point in order:
            if signs[1] * y[point] < best:
                best = signs[1] * y[point]
                kept.append(point)
        return np.array(sorted(kept, key=lambda point: x[point]), int)


def is_study(path: str | os.PathLike) -> bool:
    """Whether ``path`` is a folder of results, or the result file in one."""
    return os.path.isdir(path) or os.path.basename(os.fspath(path)) == RESULT


def read_study_result(path: str | os.PathLike) -> StudyResult:
    """The results in a folder that ``sweep`` or ``optimize`` has written. Raises ``InputError`` for anything else."""
    import xarray

    file = Path(path) / RESULT if os.path.isdir(path) else Path(path)
    shown = os.fspath(file)
    if not file.is_file():
        raise InputError(
            f"there is no {RESULT} in this folder; name a folder that sweep or optimize has written", path=os.fspath(path)
        )
    try:
        with xarray.open_dataset(file, engine="h5netcdf", decode_times=False) as opened:
            found = opened.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise InputError("is damaged, or is not a file of results", path=shown) from error
    for name in ("design", "study"):
        if name not in found.attrs:
            raise InputError(f"is no result of a study: it lacks {name}", path=shown)
    return _result(found, file)


def _result(found: xarray.Dataset, file: Path) -> StudyResult:
    study = tomllib.loads(str(found.attrs["study"]))
    data = tomllib.loads(str(found.attrs["design"]))
    names = [name for name in study.get("parameters", {}) if name.replace("/", "_") in found.variables]
    dims = found["status"].dims
    parameters = {name: _parameter(found, name.replace("/", "_"), dims) for name in names}
    metrics = {
        str(name): np.asarray(variable.values, float).ravel()
        for name, variable in found.data_vars.items()
        if variable.dims == dims and str(name) not in (*_OTHER, *parameters) and variable.dtype.kind == "f"
    }
    if not metrics or not found["status"].size:
        raise InputError("has no points or no metrics to show", path=str(file))
    units = {str(name): _unit(found[name].attrs) for name in [*metrics, *(n.replace("/", "_") for n in names)]}
    return StudyResult(
        str(found.attrs.get("title", "Study")), parameters, metrics, units, dict(study.get("objectives", {})), data, file.parent
    )


def _parameter(found: xarray.Dataset, name: str, dims: tuple) -> np.ndarray:
    """Values of a parameter at every point: a coordinate of a grid spread over it, or a column with its choices."""
    variable = found[name]
    if variable.dims == (name,) and dims != (name,):
        shape = [found.sizes[dim] for dim in dims]
        along = np.arange(found.sizes[name]).reshape([-1 if dim == name else 1 for dim in dims])
        return variable.values[np.broadcast_to(along, shape).ravel()]
    values = variable.values.ravel()
    return found[f"{name}.choices"].values[values.astype(int)] if f"{name}.choices" in found else values


def _plain(value: Any) -> Any:
    """A parameter's value as a file has it: a number, a word, or what stands in JSON."""
    if isinstance(value, (bytes, np.bytes_)):
        value = value.decode()
    if isinstance(value, str):
        try:
            return json.loads(value) if value[:1] in "[{tf" else value
        except ValueError:
            return value
    number = float(value)
    if not np.isfinite(number):
        raise DesignError("this point has no value for one of its parameters")
    return (
        int(number) if number == int(number) and abs(number) < 2**31 and not isinstance(value, (float, np.floating)) else number
    )


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def _unit(attrs: dict) -> str:
    unit = str(attrs.get("units", ""))
    return "" if unit == "1" else unit
