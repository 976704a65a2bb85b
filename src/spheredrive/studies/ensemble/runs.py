"""Runs of an ensemble: in pieces, each member the same bits whatever it runs beside; what fails says why."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.simulation.compliant.run import Accuracy, run_compliant, run_compliant_batch, wheel_motion
from spheredrive.studies.ensemble.numbers import NUMBERS, numbers_of, shown_unit
from spheredrive.studies.ensemble.spread import Spread, varied_design

if TYPE_CHECKING:
    import xarray

    from spheredrive.design import Design
    from spheredrive.motion import Motion
    from spheredrive.simulation.compliant.run import CompliantRun
    from spheredrive.studies.sweep.store import Store

# Runs that are held in memory at once.
RUNS_AT_ONCE = 32
USUAL = Accuracy()
# What the summary tells of each number.
QUANTILES = (0.05, 0.5, 0.95, 1.0)

Member = tuple[np.ndarray, str]


def ensemble(
    design: Design,
    motion: Motion,
    spread: Spread,
    count: int,
    seed: int = 1,
    accuracy: Accuracy = USUAL,
    *,
    chunk: int = RUNS_AT_ONCE,
    watch: Callable[[float], None] = lambda share: None,
    store: Store | None = None,
    device: str = "cpu",
) -> xarray.Dataset:
    """How ``count`` machines scattered about ``design`` by ``spread`` go through ``motion``.

    A velocity of the sphere becomes wheel speeds by the Jacobian of the design as drawn, which is all that a controller
    knows. The dataset has one value a member of each of ``numbers.NUMBERS``, NaN where its run failed, and ``reason``, "" or
    a sentence. ``device`` is "cpu" or "gpu". On the processor it depends neither on ``chunk``, the runs held at once, nor on
    the number of threads. ``watch`` is told the share that is done. With a ``store`` finished chunks are kept and found
    again. Raises ``SpheredriveError`` where the design as drawn does not come through.
    """
    if count < 1:
        raise SpheredriveError(f"an ensemble has at least one member, not {count}")
    asked = wheel_motion(design, motion)
    drawn = run_compliant(design, asked, accuracy)
    if not drawn.completed:
        raise SpheredriveError(f"the design as drawn does not come through the motion: {drawn.reason}")
    rows: list[Member] = []
    for first in range(0, count, chunk):
        numbers = range(first, min(first + chunk, count))
        found = _kept(store, first // chunk, numbers)
        if found is None:
            found = list(members(design, asked, spread, seed, accuracy, drawn, numbers, device=device))
            _keep(store, first // chunk, numbers, found)
        rows += found
        watch(len(rows) / count)
    return _labelled(design, motion, spread, seed, accuracy, rows)


def _kept(store: Store | None, number: int, members: range) -> list[Member] | None:
    chunk = store.read(number) if store is not None else None
    if chunk is None or len(chunk.keys) != len(members):
        return None
    told = ["", *chunk.rows.sentences]
    return [(row, told[k]) for row, k in zip(chunk.rows.values, chunk.rows.reason, strict=True)]


def _keep(store: Store | None, number: int, members: range, rows: list[Member]) -> None:
    if store is None:
        return
    from spheredrive.studies.sweep.evaluate import Rows
    from spheredrive.studies.sweep.store import Chunk

    sentences = list(dict.fromkeys(why for _, why in rows if why))
    reason = np.array([sentences.index(why) + 1 if why else 0 for _, why in rows])
    keys = np.array([[member, 0] for member in members], np.uint64)
    store.write(number, Chunk(keys, Rows(np.array([row for row, _ in rows]), reason, tuple(sentences))))


def members(
    design, asked: Motion, spread: Spread, seed: int, accuracy: Accuracy, drawn, numbers: range, device: str = "cpu"
) -> Iterator[Member]:
    """The numbers of some members, each with "" or why there are none."""
    made: dict[int, Design] = {}
    failed: dict[int, str] = {}
    for member in numbers:
        try:
            made[member] = varied_design(design, spread, seed, member)
        except SpheredriveError as error:
            failed[member] = str(error)
    runs = dict(zip(made, _runs(list(made.values()), asked, accuracy, device), strict=True))
    for member in numbers:
        run = runs.get(member)
        if run is None or isinstance(run, SpheredriveError):
            yield np.full(len(NUMBERS), np.nan), failed.get(member) or str(run)
        elif not run.completed:
            yield np.full(len(NUMBERS), np.nan), f"the run ended early: {run.reason}"
        else:
            yield numbers_of(run, drawn), ""


def _runs(designs: list[Design], asked: Motion, accuracy: Accuracy, device: str) -> list[CompliantRun | SpheredriveError]:
    if not designs:
        return []
    try:
        return list(run_compliant_batch(designs, [asked], accuracy, device=device))
    except SpheredriveError:
        # One of them is at fault: each by itself, so that the others have their runs.
        return [_alone(design, asked, accuracy) for design in designs]


def _alone(design: Design, asked: Motion, accuracy: Accuracy) -> CompliantRun | SpheredriveError:
    try:
        return run_compliant(design, asked, accuracy)
    except SpheredriveError as error:
        return error


def _labelled(design, motion, spread: Spread, seed: int, accuracy: Accuracy, rows: list[Member]) -> xarray.Dataset:
    import xarray

    from spheredrive.simulation.labels import attributes, variable

    values = np.array([row for row, _ in rows])
    data = {n.name: variable(("member",), values[:, k], n.unit, n.long_name) for k, n in enumerate(NUMBERS)}
    why = np.array([reason for _, reason in rows])
    data["reason"] = xarray.Variable(
        ("member",), why, {"units": "1", "long_name": "why a member has no numbers"}, {"dtype": "S1"}
    )
    known = int(np.sum(why == ""))
    settings = {
        "accuracy": accuracy.length,
        "largest_step": accuracy.largest_step,
        **{f"spread_{key}": value for key, value in asdict(spread).items()},
    }
    attrs = attributes(design, motion, "compliant", known > 0, f"{known} of {len(rows)} members came through", settings)
    attrs["seed"] = np.int64(seed)
    number = variable(("member",), np.arange(1, len(rows) + 1, dtype=np.int64), "1", "member, numbered from 1")
    return xarray.Dataset(data, coords={"member": number}, attrs=attrs)


def quantiles(data: xarray.Dataset) -> dict[str, tuple[float, ...]]:
    """The ``QUANTILES`` of each number over the members that have it; empty where none has."""
    known = data.reason.values == ""
    if not known.any():
        return {}
    return {n.name: tuple(map(float, np.quantile(data[n.name].values[known], QUANTILES))) for n in NUMBERS}


def ensemble_text(data: xarray.Dataset) -> str:
    """An ensemble for a terminal: quantiles of every number, and what failed."""
    reasons = data.reason.values
    found, failed = quantiles(data), reasons[reasons != ""]
    lines = [f"{len(reasons) - len(failed)} of {len(reasons)} machines come through"]
    if found:
        heads = [*(f"{100 * q:g} %" for q in QUANTILES[:-1]), "largest"]
        lines.append(f"{'':26s}" + "".join(f"{head:>12s}" for head in heads))
    for n in NUMBERS if found else ():
        scale, unit = shown_unit(n)
        name = f"{n.name.replace('_', ' ')} ({unit})" if unit != "1" else n.name.replace("_", " ")
        lines.append(f"{name:26s}" + "".join(f"{scale * value:12.4g}" for value in found[n.name]))
    for reason, times in zip(*np.unique(failed, return_counts=True), strict=True):
        lines.append(f"{times} failed: {reason}")
    return "\n".join(lines)
