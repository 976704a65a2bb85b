"""The sweep of a study from its file to a folder of results: what ``spheredrive sweep`` calls."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spheredrive.errors import SpheredriveError

if TYPE_CHECKING:
    from spheredrive.io.study import Study
    from spheredrive.studies.sweep.result import Counts


class Stopped(KeyboardInterrupt):
    """Ctrl-C in a sweep; its text says what is kept."""


@dataclass(frozen=True)
class Sweep:
    """A sweep that is finished: where its files are, and how its points went."""

    study: Study
    folder: Path
    files: tuple[Path, ...]
    counts: Counts
    notes: tuple[str, ...]

    @property
    def works(self) -> bool:
        """Whether any point has any metric."""
        return self.counts.failed < self.counts.points

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        c = self.counts
        return {
            "folder": str(self.folder),
            "files": [str(file) for file in self.files],
            "points": c.points,
            "known": c.known,
            "partly_known": c.partly,
            "failed": c.failed,
            "reasons": list(c.sentences),
            "parameters": [p.name for p in self.study.parameters],
            "metrics": list(self.study.metrics),
            "notes": list(self.notes),
        }

    def text(self) -> str:
        """For a terminal."""
        c = self.counts
        lines = [*map(str, self.files), f"{c.points:,} points: {c.known:,} with all metrics"]
        if c.partly or c.failed:
            lines[-1] += f", {c.partly:,} with some, {c.failed:,} with none"
            shown = list(c.sentences)[:5]
            lines += [f"  {sentence}" for sentence in shown]
            lines += [f"  … and {len(c.sentences) - len(shown):,} other reasons"] if len(c.sentences) > len(shown) else []
        return "\n".join(lines)


def read_study(path) -> Study:
    """The study in a file, with every metric there is to choose from. Raises ``InputError``."""
    from spheredrive.io.study_file import load_study
    from spheredrive.studies.sweep.metrics import metrics

    return load_study(path, metrics())


def sweep(
    study: Study,
    folder,
    workers: int | None = None,
    dask: str | None = None,
    *,
    chunk: int | None = None,
    figures: bool = True,
    watch: Callable[[int, int], None] = lambda done, total: None,
) -> Sweep:
    """Work out every point of ``study`` and write the results into ``folder``, going on where an earlier sweep there stopped.

    workers   processes, one a core if None; 0 for none but this one; ``dask`` the address of a running scheduler instead
    chunk     points of one piece of work, chosen to suit if None
    watch     is told how many points are done, of how many; what it raises stops the sweep

    The results do not depend on workers, chunks or interruptions, to the last byte. Raises ``SpheredriveError`` with what
    stopped it, and ``Stopped`` at Ctrl-C; finished points are kept.
    """
    from spheredrive.studies.sweep.coordinator import Coordinator
    from spheredrive.studies.sweep.executors import open_workers
    from spheredrive.studies.sweep.result import write_results
    from spheredrive.studies.sweep.store import locked

    folder = Path(folder)
    coordinator = Coordinator(study, folder, chunk)
    with locked(folder):
        try:
            with open_workers(workers, dask) as pool:
                coordinator.run(pool, watch)
        except KeyboardInterrupt:
            kept = f"{coordinator.done:,} of {coordinator.points.count:,} points are kept in {folder}"
            raise Stopped(f"Stopped: {kept}; the same command goes on from there.") from None
        parquet = importlib.util.find_spec("pyarrow") is not None
        counts = write_results(coordinator, folder, parquet)
        files = [folder / "result.nc", *([folder / "result.parquet"] if parquet else [])]
        if figures:
            from spheredrive.studies.sweep.figures import write_figures

            files += write_figures(coordinator, folder)
    notes = () if parquet else ('result.parquet is left out: pip install "spheredrive[studies]" brings what writes it.',)
    return Sweep(study, folder, tuple(files), counts, notes)


def sweep_command(study: Path, output: Path, workers: int | None, dask: str | None) -> Sweep:
    """``spheredrive sweep``: progress to standard error. Raises as ``sweep``."""
    if workers is not None and dask is not None:
        raise SpheredriveError("--workers starts processes here, --dask uses those of a cluster; give one of the two")
    if workers is not None and workers < 0:
        raise SpheredriveError(f"--workers takes a number of processes, not {workers}")
    read = read_study(study)
    with _bar() as watch:
        return sweep(read, output, workers, dask, watch=watch)


@contextmanager
def _bar() -> Iterator[Callable[[int, int], None]]:
    """A function to be told how many points are done; it draws a bar with rate and time left where somebody watches."""
    import sys

    if not sys.stderr.isatty():
        yield lambda done, total: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    rate = TextColumn("{task.fields[rate]}")
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), rate, TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, speed_estimate_period=30.0) as bar:
        task = bar.add_task("Sweeping", total=None, rate="")

        def watch(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)
            speed = bar.tasks[0].speed
            bar.update(task, rate=f"{speed:,.0f} points/s" if speed else "")

        yield watch
