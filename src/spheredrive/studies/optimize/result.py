"""An outcome as files: every point in NetCDF and Parquet, and designs of the front as design files. Equal studies give equal
bytes."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.io.design_path import assigned
from spheredrive.io.design_text import design_files
from spheredrive.io.files import write_whole
from spheredrive.io.quantity import parse
from spheredrive.io.results import write_run
from spheredrive.io.toml_text import toml_text
from spheredrive.studies.optimize.outcome import Outcome, knee_words
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.result import parameter_text, provenance
from spheredrive.studies.sweep.variants import Variants

if TYPE_CHECKING:
    import xarray

    from spheredrive.studies.optimize.search import Search

# Designs of the front that are written, besides its knee and its best points.
DESIGNS = 20


def dataset(search: Search, o: Outcome) -> xarray.Dataset:
    """Every point that was evaluated, along ``point``, and the history of the search along ``generation_number``."""
    import xarray

    from spheredrive.simulation.labels import variable, words

    asked = search.goals.asked
    front = np.zeros(len(o.X), np.int8)
    front[o.front] = 1
    point = ("point",)
    sentences = list(o.rows.sentences) or ["nothing is missing"]
    data: dict[str, Any] = {
        "generation": variable(point, o.generation.astype(np.int32), "1", "generation of the point, from 1; 0: polished"),
        "front": variable(point, front, "1", "1 where no other point is as good in every objective and better in one"),
        "feasible": variable(point, o.feasible.astype(np.int8), "1", "1 where all numbers are known and all constraints kept"),
        "reason": variable(point, o.rows.reason.astype(np.int32), "1", "number, from 1, of the sentence in reasons; 0: none"),
        "reasons": words("reasons_number", sentences, "why something is missing"),
        "hypervolume": variable(
            ("generation_number",), o.volume, "1", "hypervolume of the front after each generation, in its ranges"
        ),
    }
    names = {p.name: p.name.replace("/", "_") for p in asked.parameters}
    for column, p in enumerate(asked.parameters):
        values = o.X[:, column].astype(np.int32) if p.choices else o.X[:, column]
        data[names[p.name]] = variable(point, values, p.unit or "1", f"{p.name} of the design")
        if p.choices:
            choices = f"{names[p.name]}.choices"
            data[choices] = words(f"{choices}_number", parameter_text(p, p.values), f"choices of {p.name}, by number from 0")
    for column, name in enumerate(asked.metrics):
        data[name] = variable(point, o.rows.values[:, column], metrics()[name].unit or "1", metrics()[name].long_name)
    attrs = {
        **provenance(asked),
        "method": search.name,
        "objectives": "; ".join(f"{g.metric}: {g.sense}" for g in search.goals.objectives),
        "constraints": "; ".join(f"{c.metric} {c.relation} {c.bound!r}" for c in search.goals.constraints),
        "population": np.int32(search.population),
        "generations": np.int32(len(o.volume)),
        "knee": np.int64(o.front[o.knee.place]),
        "knee_words": knee_words(search, o),
    }
    return xarray.Dataset(data, attrs=attrs)


def write_results(search: Search, o: Outcome, folder: Path, parquet: bool) -> list[Path]:
    """Write ``result.nc``, ``result.parquet`` and ``designs/*.toml`` into ``folder``; their paths. Raises ``InputError``."""
    data = dataset(search, o)
    files = [write_run(data, folder / "result.nc")]
    if parquet:
        files.append(folder / "result.parquet")
        write_whole(files[-1], _parquet(search, data))
    return files + _write_designs(search, o, folder / "designs")


def _parquet(search: Search, data: xarray.Dataset) -> bytes:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns: dict[str, Any] = {}
    for p in search.goals.asked.parameters:
        values = data[p.name.replace("/", "_")].values
        columns[p.name] = pa.array(parameter_text(p, values) if p.choices else values)
    for name in search.goals.asked.metrics:
        values = data[name].values
        columns[name] = pa.array(values, mask=np.isnan(values))
    for name in ("generation", "front", "feasible"):
        columns[name] = pa.array(data[name].values)
    told = [str(data.reasons.values[k - 1]) if k else None for k in data.reason.values]
    columns["reason"] = pa.array(told, pa.string())
    table = pa.table(columns).replace_schema_metadata({key: str(value) for key, value in data.attrs.items()})
    image = io.BytesIO()
    pq.write_table(table, image)
    return image.getvalue()


def chosen(search: Search, o: Outcome) -> dict[str, int]:
    """Points of the front that become design files, by the files' names: the knee, the best in each goal, others between."""
    named = {"knee": o.knee.place} if len(search.goals.objectives) > 1 else {}
    for objective, place in zip(search.goals.objectives, o.best, strict=True):
        named[f"best-{objective.metric.replace('_', '-')}"] = place
    between = np.unique(np.linspace(0, len(o.front) - 1, min(DESIGNS, len(o.front))).astype(int))
    places = {**named, **{f"front-{k + 1:03d}": int(k) for k in between if k not in named.values()}}
    return {name: int(o.front[place]) for name, place in places.items()}


def _write_designs(search: Search, o: Outcome, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    variants = Variants(search.goals.asked)
    files = []
    for name, point in chosen(search, o).items():
        text, tables = _design_file(variants, o.X[point], name)
        files.append(folder / f"{name}.toml")
        write_whole(files[-1], f"{_head(search, o, name, point)}{text}")
        for table, content in tables.items():
            files.append(folder / table)
            write_whole(files[-1], content)
    return files


def _design_file(variants: Variants, row: np.ndarray, name: str) -> tuple[str, dict[str, str]]:
    """The study's design file with the point's values in it; where it names files of its own, a text that stands alone."""
    title = f"{variants.study.design.name}, {name.replace('-', ' ')}"
    if any("file" in model for model in variants.study.data["wheels"].values()):
        return design_files(replace(variants.design(row), name=title))
    values = [(p.path, _written(p.value(x), p.unit)) for p, x in zip(variants.parameters, row, strict=True)]
    return toml_text({**assigned(variants.study.data, values), "name": title}), {}


def _written(value: Any, unit: str) -> Any:
    """A number in the unit people use, with as few digits as are read back to the last bit; else as it is, SI."""
    usual, many = _USUAL.get(unit, (unit, 1.0))
    if not unit or not isinstance(value, float):
        return value
    texts = (f"{value * many:.{digits}g} {usual}" for digits in range(1, 18))
    return next((text for text in texts if parse(text, unit) == value), value)


_USUAL = {"rad": ("deg", 180 / np.pi), "m": ("mm", 1e3)}


def _head(search: Search, o: Outcome, name: str, point: int) -> str:
    """What the design is, as a comment."""
    lines = [f"{name.replace('-', ' ').capitalize()} of a search over {len(o.X)} designs."]
    for metric, value in zip(search.goals.asked.metrics, o.rows.values[point], strict=True):
        lines.append(f"{metric} = {value:.6g} {metrics()[metric].unit}".rstrip())
    if name == "knee":
        lines.append(knee_words(search, o))
    return "".join(f"# {line}\n" for line in lines) + "\n"
