"""From a study to finished chunks: what is done is kept, what is lost is done again."""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field

import numpy as np

from spheredrive.errors import InputError, SpheredriveError
from spheredrive.io.study import GIVEN, Study
from spheredrive.studies.sweep.evaluate import Rows, work
from spheredrive.studies.sweep.executors import Workers
from spheredrive.studies.sweep.keys import Keys, context_of, plan_of
from spheredrive.studies.sweep.metrics import batch_size
from spheredrive.studies.sweep.metrics.base import Conditions
from spheredrive.studies.sweep.points import Points
from spheredrive.studies.sweep.store import Chunk, Harvest, Store

# Pieces of work for each worker that wait or are under way: no worker waits for work, and memory stays bounded.
AHEAD = 2
# A study has at least so many chunks, where it has points enough, so that little is lost and all workers are busy to the end.
CHUNKS = 64
# How often the same chunk may be under way when workers die before it is tried alone, and how often alone.
STRIKES = 3
STRIKES_ALONE = 5

Watch = Callable[[int, int], None]


@dataclass
class _Task:
    """A chunk under way: its keys, which of its points were finished before, and their rows."""

    number: int
    keys: np.ndarray
    found: np.ndarray
    rows: Rows | None
    missing: np.ndarray = field(repr=False)


class Coordinator:
    """The points of a study in chunks, each kept as soon as it is finished."""

    def __init__(self, study: Study, folder, chunk: int | None = None):
        if not study.metrics:
            raise SpheredriveError(f"{study.path}: names no metrics; add metrics = [...] to it")
        for p in study.parameters:
            if p.law != "values" and study.sampling.method in GIVEN:
                raise SpheredriveError(f"{study.path}: {p.name} is a range for optimize; for a sweep add its key count")
        self.study = study
        self.points = Points(study)
        self.chunk = chunk or chunk_size(study, self.points.count)
        self.count = -(-self.points.count // self.chunk)
        self.store = Store(folder, context_of(study), plan_of(study, self.chunk))
        self.keys = Keys(study)
        self.payload = pickle.dumps(study)
        self.done = 0

    def span(self, number: int) -> tuple[int, int]:
        """First point and number of points of a chunk."""
        first = number * self.chunk
        return first, min(self.chunk, self.points.count - first)

    def run(self, workers: Workers, watch: Watch = lambda done, total: None) -> None:
        """Finish every chunk. Whatever stops it, what is finished stays, and the next call goes on.

        ``watch`` is told how many points are done, of how many. Raises ``InputError`` where a chunk cannot be kept,
        ``SpheredriveError`` where a chunk stops its workers again and again or a cluster is gone.
        """
        self.store.open()
        waiting = deque(n for n in range(self.count) if not self._kept(n))
        watch(self.done, self.points.count)
        if not waiting:
            return
        harvest = Harvest(self.store)
        doubtful: deque[int] = deque()
        strikes: dict[int, int] = {}
        under_way: dict[Future, _Task] = {}
        while waiting or doubtful or under_way:
            broken = self._begin(waiting, doubtful, under_way, harvest, workers, watch)
            broken += self._take(under_way, workers, watch) if under_way and not broken else []
            if broken:
                if workers.fall_together:
                    broken += self._abandoned(under_way)
                    workers.renew()
                self._sort_out(broken, strikes, waiting, doubtful)

    def _begin(self, waiting, doubtful, under_way: dict[Future, _Task], harvest, workers: Workers, watch: Watch) -> list[int]:
        """Give the workers what they have room for; chunks that could not be given, as the workers are gone.

        A doubtful chunk, which was there whenever workers died, is tried last and alone: then it is known whether it is the
        cause, and all others are kept.
        """
        line, room = (waiting, AHEAD * workers.count) if waiting else (doubtful, 1)
        while line and len(under_way) < room:
            number = line.popleft()
            task = self._task(number, harvest)
            if not len(task.missing):
                self._keep(task, None, watch)
                continue
            try:
                under_way[workers.submit(work, self.payload, task.missing)] = task
            except workers.lost:
                return [number]
        return []

    def _take(self, under_way: dict[Future, _Task], workers: Workers, watch: Watch) -> list[int]:
        """Wait for a chunk and keep all that are finished; those whose worker died."""
        broken = []
        for future in wait(under_way, return_when=FIRST_COMPLETED).done:
            task = under_way.pop(future)
            try:
                rows = future.result()
            except workers.lost:
                broken.append(task.number)
            except workers.gone:
                raise SpheredriveError(f"the Dask scheduler at {workers.where} is gone; {self._kept_words()}") from None
            else:
                self._keep(task, rows, watch)
        return broken

    def _kept(self, number: int) -> bool:
        if not self.store.has(number):
            return False
        self.done += self.span(number)[1]
        return True

    def _abandoned(self, under_way: dict[Future, _Task]) -> list[int]:
        """Chunks that were under way when the workers died."""
        numbers = [task.number for task in under_way.values()]
        under_way.clear()
        return numbers

    def _sort_out(self, broken: list[int], strikes: dict[int, int], waiting: deque[int], doubtful: deque[int]) -> None:
        """Put chunks whose workers died back in line, those behind the others that were often there."""
        alone = len(broken) == 1
        for number in sorted(broken, reverse=True):
            strikes[number] = strikes.get(number, 0) + 1
            if alone and strikes[number] >= STRIKES + STRIKES_ALONE:
                first, count = self.span(number)
                raise SpheredriveError(
                    f"points {first + 1} to {first + count} of the study stop the process that works on them again and again, "
                    f"as a lack of memory does; {self._kept_words()}"
                )
            if strikes[number] >= STRIKES:
                doubtful.append(number)
            else:
                waiting.appendleft(number)

    def _kept_words(self) -> str:
        return f"{self.done} of {self.points.count} points are kept, and the same command goes on from there"

    def _task(self, number: int, harvest: Harvest) -> _Task:
        X = self.points.values(*self.span(number))
        keys = self.keys.of(X)
        found, rows = harvest.find(keys)
        return _Task(number, keys, found, rows, X[~found])

    def _keep(self, task: _Task, rows: Rows | None, watch: Watch) -> None:
        try:
            self.store.write(task.number, Chunk(task.keys, _woven(task.found, task.rows, rows)))
        except InputError as error:
            raise InputError(f"{error.rule}; {self._kept_words()}", path=error.path) from None
        self.done += len(task.keys)
        watch(self.done, self.points.count)


def chunk_size(study: Study, count: int) -> int:
    """Points of a chunk: as many as suit the metrics, fewer where the study is small."""
    most = batch_size(study.metrics, Conditions.of(study))
    return int(min(max(-(-count // CHUNKS), 1), most))


def _woven(found: np.ndarray, old: Rows | None, new: Rows | None) -> Rows:
    """Rows that were finished before (``found``) and new ones in the order of their points."""
    if old is None or new is None:
        return old or new  # type: ignore[return-value]
    values = np.empty((len(found), old.values.shape[1]))
    values[found], values[~found] = old.values, new.values
    told = np.empty(len(found), object)
    for mask, part in ((found, old), (~found, new)):
        told[mask] = [part.sentences[k - 1] if k else "" for k in part.reason]
    numbers: dict[str, int] = {}
    reason = np.array([numbers.setdefault(said, len(numbers) + 1) if said else 0 for said in told])
    return Rows(values, reason, tuple(numbers))
