"""A search from its study file to a folder of results: what ``spheredrive optimize`` calls."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spheredrive.errors import InputError, SpheredriveError

if TYPE_CHECKING:
    from spheredrive.io.study import Study
    from spheredrive.studies.optimize.outcome import Outcome
    from spheredrive.studies.optimize.search import Search


class Stopped(KeyboardInterrupt):
    """Ctrl-C in a search; its text says what is kept."""


@dataclass(frozen=True)
class Optimum:
    """A search that is finished: where its files are, and what it has found."""

    search: Search
    outcome: Outcome
    files: tuple[Path, ...]
    notes: tuple[str, ...]

    @property
    def works(self) -> bool:
        """Whether there is a design that keeps all constraints: without one there is no outcome."""
        return True

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI."""
        from spheredrive.studies.optimize.outcome import knee_words

        o = self.outcome
        return {
            "files": [str(file) for file in self.files],
            "evaluated": len(o.X),
            "feasible": int(o.feasible.sum()),
            "objectives": {g.metric: g.sense for g in self.search.goals.objectives},
            "front": [self._point(int(k)) for k in o.front],
            "knee": o.knee.place,
            "best": {g.metric: k for g, k in zip(self.search.goals.objectives, o.best, strict=True)},
            "knee_words": knee_words(self.search, o),
            "hypervolume": o.volume.tolist(),
            "notes": list(self.notes),
        }

    def _point(self, k: int) -> dict[str, Any]:
        asked, o = self.search.goals.asked, self.outcome
        parameters = {p.name: p.value(x) for p, x in zip(asked.parameters, o.X[k], strict=True)}
        return {"parameters": parameters, "metrics": dict(zip(asked.metrics, o.rows.values[k].tolist(), strict=True))}

    def text(self) -> str:
        """For a terminal: the knee and the best in each goal."""
        from spheredrive.studies.optimize.outcome import knee_words

        o, asked = self.outcome, self.search.goals.asked
        lines = [str(file) for file in self.files if file.parent.name != "designs"]
        lines.append(f"{self.files[-1].parent.parent / 'designs'}")
        lines.append(
            f"{len(o.X):,} designs tried, {int(o.feasible.sum()):,} keep all constraints, {len(o.front):,} on the front"
        )
        shown = {f"best {g.metric}": k for g, k in zip(self.search.goals.objectives, o.best, strict=True)}
        if len(self.search.goals.objectives) > 1:
            shown = {"knee": o.knee.place, **shown}
        for name, place in shown.items():
            k = int(o.front[place])
            lines.append(f"{name}: " + ", ".join(f"{m} {v:.6g}" for m, v in zip(asked.metrics, o.rows.values[k], strict=True)))
            lines.append("  at " + ", ".join(_told(p, x) for p, x in zip(asked.parameters, o.X[k], strict=True)))
        return "\n".join([*lines, knee_words(self.search, o)])


def _told(parameter, x: float) -> str:
    """A parameter and its value as people read it: angles in degrees."""
    import math

    value = parameter.value(x)
    if not parameter.numeric:
        return f"{parameter.name} = {value}"
    number, unit = (math.degrees(value), "deg") if parameter.unit == "rad" else (value, parameter.unit)
    return f"{parameter.name} = {number:.8g} {unit}".rstrip()


def optimize(
    study: Study,
    folder,
    workers: int | None = None,
    dask: str | None = None,
    *,
    figures: bool = True,
    polish: bool = True,
    watch: Callable[[float], None] = lambda share: None,
) -> Optimum:
    """The designs of ``study`` that no other beats, written into ``folder``; goes on where an earlier search there stopped.

    ``workers`` and ``dask`` as of ``sweep``; ``polish`` says whether the knee and the best points are settled by SciPy, which
    takes some hundred points each; ``watch`` is told the share that is done. The same study gives the same bytes,
    whatever the workers are and however often it was stopped.
    Raises ``SpheredriveError`` where the study has no objectives, where no design keeps all constraints, and as ``sweep``;
    ``Stopped`` at Ctrl-C.
    """
    from spheredrive.studies.optimize.outcome import outcome
    from spheredrive.studies.optimize.result import write_results
    from spheredrive.studies.optimize.search import Bench, Search
    from spheredrive.studies.sweep.executors import open_workers
    from spheredrive.studies.sweep.store import locked

    folder = Path(folder)
    search = Search(study, folder)
    with locked(folder):
        try:
            with open_workers(workers, dask) as pool:
                bench = Bench(search.goals.asked, pool)
                found = outcome(search, search.run(bench, watch), bench, polish)
        except KeyboardInterrupt:
            kept = f"{search.done} of {search.generations} generations are kept in {folder}"
            raise Stopped(f"Stopped: {kept}; the same command goes on from there.") from None
        parquet = importlib.util.find_spec("pyarrow") is not None
        try:
            files = write_results(search, found, folder, parquet)
            if figures:
                from spheredrive.studies.optimize.figures import write_figures

                files = write_figures(search, found, folder) + files
        except OSError as error:
            raise InputError(f"cannot be written: {(error.strerror or str(error)).lower()}", path=str(folder)) from None
    notes = () if parquet else ('result.parquet is left out: pip install "spheredrive[studies]" brings what writes it.',)
    return Optimum(search, found, tuple(files), notes)


def optimize_command(
    study: Path,
    output: Path,
    workers: int | None,
    dask: str | None,
    watch: Callable[[float], None] = lambda share: None,
) -> Optimum:
    """``spheredrive optimize``. Raises as ``optimize``."""
    from spheredrive.studies.sweep.command import read_study

    if workers is not None and dask is not None:
        raise SpheredriveError("--workers starts processes here, --dask uses those of a cluster; give one of the two")
    if workers is not None and workers < 0:
        raise SpheredriveError(f"--workers takes a number of processes, not {workers}")
    return optimize(read_study(study), output, workers, dask, watch=watch)
