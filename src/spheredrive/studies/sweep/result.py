"""Finished chunks as one NetCDF and one Parquet file: block by block, whole or not at all, equal studies as equal bytes."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import spheredrive
from spheredrive.errors import InputError
from spheredrive.io.study import Parameter, Study
from spheredrive.studies.sweep.evaluate import Rows, joined_rows
from spheredrive.studies.sweep.metrics import metrics
from spheredrive.studies.sweep.points import Points

if TYPE_CHECKING:
    from spheredrive.studies.sweep.coordinator import Coordinator

# Points of a block, and of a row group of the Parquet file.
BLOCK = 65_536
# Different sentences that the NetCDF file lists; a study in which more points fail, each for its own reason, lists the first.
MOST_SENTENCES = 10_000
STATUS = ("all metrics are known", "some metrics are missing", "no metric is known")


class Block(NamedTuple):
    """Points ``first`` and on: values of the parameters (b, d), and their rows."""

    first: int
    X: np.ndarray
    rows: Rows

    @property
    def status(self) -> np.ndarray:
        """0, 1 or 2, as ``STATUS`` tells, (b,)."""
        missing = np.isnan(self.rows.values).sum(axis=1)
        return ((missing > 0).astype(np.int8) + (missing == self.rows.values.shape[1])).astype(np.int8)

    @property
    def told(self) -> list[str]:
        """Why something is missing, by point; "" where nothing is."""
        return [self.rows.sentences[k - 1] if k else "" for k in self.rows.reason]


class Counts(NamedTuple):
    """How many points there are, and how many of each status."""

    points: int
    known: int
    partly: int
    failed: int
    sentences: dict[str, int]


def blocks(coordinator: Coordinator) -> Iterator[Block]:
    """All points in order, in blocks of ``BLOCK``. Raises ``InputError`` where a chunk is not there any more."""
    points, waiting, first = coordinator.points, [], 0
    held = 0
    for number in range(coordinator.count):
        chunk = coordinator.store.read(number)
        if chunk is None:
            raise InputError("was finished, but cannot be read any more; run again", path=str(coordinator.store.path(number)))
        waiting.append(chunk.rows)
        held += len(chunk.keys)
        while held >= BLOCK or (number == coordinator.count - 1 and held):
            rows = joined_rows(waiting)
            count = min(BLOCK, held)
            yield Block(first, points.values(first, count), _part(rows, 0, count))
            waiting = [_part(rows, count, held)] if held > count else []
            first, held = first + count, held - count


def _part(rows: Rows, begin: int, end: int) -> Rows:
    return Rows(rows.values[begin:end], rows.reason[begin:end], rows.sentences)


def write_results(coordinator: Coordinator, folder: Path, parquet: bool = True) -> Counts:
    """Write ``result.nc`` and, where ``parquet`` says so, ``result.parquet`` into ``folder``.

    Raises ``InputError`` where they cannot be written; files that were there before are then left as they were.
    """
    study, points = coordinator.study, coordinator.points
    numbers: dict[str, int] = {}
    counts = np.zeros(3, np.int64)
    with contextlib.ExitStack() as stack:
        # The library that writes NetCDF is lost where a disk fills up under it: the room is asked for before.
        _require_room(folder / ".room", points.count * (9 + 4 + 8 * (len(study.metrics) + len(study.parameters))) + 2**16)
        writers: list[Any] = [stack.enter_context(_replacing(folder / "result.nc", lambda p: _NetCDF(p, study, points)))]
        if parquet:
            writers.append(stack.enter_context(_replacing(folder / "result.parquet", lambda p: _Parquet(p, study))))
        for block in blocks(coordinator):
            for writer in writers:
                writer.add(block, numbers)
            counts += np.bincount(block.status, minlength=3)
        for writer in writers:
            writer.finish(numbers)
    return Counts(points.count, *map(int, counts), numbers)


@contextlib.contextmanager
def _replacing(target: Path, opened) -> Iterator[Any]:
    """A writer to a file beside ``target`` that takes its place when all is well."""
    beside = target.with_name(f".{target.name}.part")
    try:
        try:
            writer = opened(beside)
            try:
                yield writer
            finally:
                writer.close()
            with open(beside, "rb") as file:
                os.fsync(file.fileno())
            os.replace(beside, target)
        except (OSError, RuntimeError) as error:
            raise InputError(_not_written(error), path=str(target)) from None
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()


def _not_written(error: Exception) -> str:
    why = (getattr(error, "strerror", None) or str(error)).lower()
    return f"cannot be written: {why}; all points are kept, and the same command goes on from there"


def _require_room(path: Path, size: int) -> None:
    """Raise ``InputError`` where there is no room for ``size`` bytes."""
    zeros = bytes(2**20)
    try:
        with open(path, "wb") as file:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(file.fileno(), 0, size)
            else:
                for _ in range(-(-size // len(zeros))):
                    file.write(zeros)
    except OSError as error:
        raise InputError(_not_written(error), path=str(path.parent)) from None
    finally:
        with contextlib.suppress(OSError):
            path.unlink()


def provenance(study: Study) -> dict[str, str]:
    """What the results come from, without clock or machine."""
    given = {
        "title": f"Study of {study.design.name}",
        "program": f"spheredrive {spheredrive.__version__}",
        "study": study.source,
        "design": study.design.source,
        "design_hash": hashlib.sha256(study.design.source.encode()).hexdigest(),
        "motion": study.motion.source if study.motion else "",
        "method": study.sampling.method,
        "seed": str(study.sampling.seed),
    }
    return {key: value for key, value in given.items() if value}


def parameter_text(parameter: Parameter, numbers: np.ndarray) -> list[str]:
    """Choices by their numbers, in words."""
    words = [choice if isinstance(choice, str) else json.dumps(choice) for choice in parameter.choices]
    return [words[int(k)] for k in numbers]


class _NetCDF:
    """One dimension a parameter for a grid, else ``point``; the reasons why something is missing as a table beside."""

    def __init__(self, path: Path, study: Study, points: Points):
        import h5netcdf

        self.study, self.points = study, points
        self.file = h5netcdf.File(path, "w")
        self.names = [p.name.replace("/", "_") for p in study.parameters]
        self.dims = tuple(self.names) if points.grid else ("point",)
        self.file.dimensions = dict(zip(self.dims, points.shape, strict=True))
        for key, value in provenance(study).items():
            self.file.attrs[key] = value
        self.variables = {}
        if points.grid:
            for p, name in zip(study.parameters, self.names, strict=True):
                self._coordinate(p, name)
        else:
            for p, name in zip(study.parameters, self.names, strict=True):
                kind = np.dtype(np.int32 if p.choices else float)
                self.variables[name] = self._variable(name, self.dims, kind, p.unit, f"{p.name} of the design")
                if p.choices:
                    self._words(f"{name}.choices", parameter_text(p, p.values))
        for name in study.metrics:
            metric = metrics()[name]
            self.variables[name] = self._variable(name, self.dims, np.dtype(float), metric.unit, metric.long_name)
        meanings = "; ".join(f"{code}: {meaning}" for code, meaning in enumerate(STATUS))
        self.status = self._variable("status", self.dims, np.dtype(np.int8), "", meanings)
        which = "number, from 1, of the sentence in reasons that says what is missing; 0 where nothing is"
        self.reason = self._variable("reason", self.dims, np.dtype(np.int32), "", which)

    def _coordinate(self, p: Parameter, name: str) -> None:
        if p.choices:
            self._words(name, parameter_text(p, p.values), name)
            return
        self._variable(name, (name,), np.dtype(float), p.unit, f"{p.name} of the design")[...] = p.values

    def _variable(self, name, dims, kind: np.dtype, unit: str, long_name: str):
        variable = self.file.create_variable(name, dims, kind)
        variable.attrs["units"] = unit or "1"
        variable.attrs["long_name"] = long_name
        return variable

    def _words(self, name: str, words: list[str], dim: str | None = None) -> None:
        """Text as rows of characters, which every reader of NetCDF-4 knows."""
        coded = [word.encode() for word in words]
        width = max(map(len, coded), default=1) or 1
        length = dim or f"{name}_number"
        if length not in self.file.dimensions:
            self.file.dimensions[length] = len(words)
        self.file.dimensions[f"{name}_letter"] = width
        variable = self.file.create_variable(name, (length, f"{name}_letter"), np.dtype("S1"))
        variable.attrs["_Encoding"] = "utf-8"
        variable[...] = np.array(coded, f"S{width}").view("S1").reshape(len(words), width)

    def add(self, block: Block, numbers: dict[str, int]) -> None:
        own = np.zeros(len(block.rows.sentences) + 1, np.int32)
        for k in dict.fromkeys(block.rows.reason[block.rows.reason > 0].tolist()):
            sentence = block.rows.sentences[k - 1]
            if sentence not in numbers and len(numbers) < MOST_SENTENCES:
                numbers[sentence] = len(numbers) + 1
            own[k] = numbers.get(sentence, MOST_SENTENCES + 1)
        if not self.points.grid:
            for column, name in enumerate(self.names):
                self._put(self.variables[name], block.first, block.X[:, column])
        for column, name in enumerate(self.study.metrics):
            self._put(self.variables[name], block.first, block.rows.values[:, column])
        self._put(self.status, block.first, block.status)
        self._put(self.reason, block.first, own[block.rows.reason])

    def _put(self, variable, first: int, values: np.ndarray) -> None:
        for place, begin, end in rectangles(self.points.shape, first, first + len(values)):
            shape = tuple(part.stop - part.start for part in place)
            variable[place] = values[begin - first : end - first].reshape(shape)

    def finish(self, numbers: dict[str, int]) -> None:
        sentences = list(numbers)
        more = ["another reason; result.parquet tells it"] if len(sentences) == MOST_SENTENCES else []
        self._words("reasons", [*sentences, *more] or ["nothing is missing"])

    def close(self) -> None:
        self.file.close()


def rectangles(shape: tuple[int, ...], begin: int, end: int) -> Iterator[tuple[tuple, int, int]]:
    """Numbers ``begin`` to before ``end`` of an array's entries, the last axis running fastest, as boxes: slices, from, to."""
    if len(shape) == 1:
        if begin < end:
            yield (slice(begin, end),), begin, end
        return
    size = int(np.prod(shape[1:]))
    row = begin // size
    while begin < end:
        if begin == row * size and end - begin >= size:
            rows = (end - begin) // size
            yield (slice(row, row + rows), *(slice(0, n) for n in shape[1:])), begin, begin + rows * size
            begin, row = begin + rows * size, row + rows
            continue
        stop = min(end, (row + 1) * size)
        for inner, a, b in rectangles(shape[1:], begin - row * size, stop - row * size):
            yield (slice(row, row + 1), *inner), a + row * size, b + row * size
        begin, row = stop, row + 1


class _Parquet:
    """One row a point; what is missing is null, and ``reason`` says why."""

    def __init__(self, path: Path, study: Study):
        import pyarrow as pa
        import pyarrow.parquet as pq

        self.pa, self.study = pa, study
        words = pa.dictionary(pa.int32(), pa.string())
        fields = [pa.field(p.name, words if p.choices else pa.float64(), metadata={"unit": p.unit}) for p in study.parameters]
        fields += [pa.field(name, pa.float64(), metadata={"unit": metrics()[name].unit}) for name in study.metrics]
        fields += [pa.field("status", pa.int8()), pa.field("reason", pa.string())]
        self.schema = pa.schema(fields, metadata=provenance(study))
        self.writer = pq.ParquetWriter(path, self.schema)

    def add(self, block: Block, numbers: dict[str, int]) -> None:
        pa = self.pa
        columns: list[Any] = []
        for p, x in zip(self.study.parameters, block.X.T, strict=True):
            if p.choices:
                columns.append(pa.DictionaryArray.from_arrays(pa.array(x.astype(np.int32)), parameter_text(p, p.values)))
            else:
                columns.append(pa.array(x))
        columns += [pa.array(v, mask=np.isnan(v)) for v in block.rows.values.T]
        columns += [pa.array(block.status), pa.array([said or None for said in block.told], pa.string())]
        self.writer.write_table(pa.table(columns, schema=self.schema), row_group_size=BLOCK)

    def finish(self, numbers: dict[str, int]) -> None:
        """Nothing is left to be written."""

    def close(self) -> None:
        self.writer.close()
