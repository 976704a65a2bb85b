"""A search from its study to evaluated generations: each is kept when it is finished, and never worked out again.

The evolution is not stored. It follows from the seed and from what its points are worth, so a search that goes on asks for
the same points again, finds those generations on disk, and goes on with the next: an interruption leaves no trace.
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from spheredrive.errors import InputError, SpheredriveError
from spheredrive.io.study import Study
from spheredrive.studies.optimize.algorithm import Evolution, settled
from spheredrive.studies.optimize.goals import Goals
from spheredrive.studies.optimize.space import Space
from spheredrive.studies.sweep.evaluate import Rows, joined_rows, work
from spheredrive.studies.sweep.executors import Workers
from spheredrive.studies.sweep.keys import Keys, context_of
from spheredrive.studies.sweep.metrics import batch_size
from spheredrive.studies.sweep.metrics.base import Conditions
from spheredrive.studies.sweep.store import Chunk, Store

# How often a generation is tried when workers die.
STRIKES = 5


class Generations(NamedTuple):
    """Everything that was evaluated: coordinates U and points X (k, d), their rows, and the generation of each from 1, (k,)."""

    U: np.ndarray
    X: np.ndarray
    rows: Rows
    generation: np.ndarray


class Bench:
    """Where points are evaluated: a study's metrics by the workers of an executor."""

    def __init__(self, asked: Study, workers: Workers):
        self.workers = workers
        self.payload = pickle.dumps(asked)
        self.most = batch_size(asked.metrics, Conditions.of(asked))

    def rows(self, X: np.ndarray) -> Rows:
        """Rows of points X (b, d), shared out among the workers. Raises ``SpheredriveError`` where these are lost."""
        for _ in range(STRIKES):
            try:
                return self._rows(X)
            except self.workers.lost:
                if self.workers.fall_together:
                    self.workers.renew()
            except self.workers.gone:
                raise SpheredriveError(
                    f"the Dask scheduler at {self.workers.where} is gone; finished generations are kept"
                ) from None
        raise SpheredriveError("a generation stops the processes that work on it again and again, as a lack of memory does")

    def _rows(self, X: np.ndarray) -> Rows:
        piece = min(max(-(-len(X) // self.workers.count), 1), self.most)
        pieces = [X[i : i + piece] for i in range(0, len(X), piece)]
        return joined_rows([future.result() for future in [self.workers.submit(work, self.payload, part) for part in pieces]])


class Search:
    """The search that a study asks for, in a folder."""

    def __init__(self, study: Study, folder):
        self.study = study
        self.goals, self.space = Goals(study), Space(study)
        self.name, self.population, self.generations = settled(study)
        asked = self.goals.asked
        laws = [(p.path.places, p.law, p.numbers, p.choices) for p in study.parameters]
        # Not how many generations: a longer search goes on from a shorter one.
        sought = (study.objectives, study.constraints, study.sampling.seed, self.name, self.population)
        plan = hashlib.blake2b(repr((context_of(asked), laws, sought)).encode(), digest_size=16).hexdigest()
        self.store = Store(folder, context_of(asked), plan)
        self.keys = Keys(asked)
        self.done = 0

    def run(self, bench: Bench, watch: Callable[[float], None] = lambda share: None) -> Generations:
        """Every generation, those that are kept taken from disk. ``watch`` is told the share that is done."""
        self.store.open()
        evolution = Evolution(
            self.name, self.population, self.space, len(self.goals.objectives), len(self.goals.constraints) + 1
        )
        U, X, rows, generation = [], [], [], []
        for number in range(self.generations):
            u = evolution.ask()
            if not len(u):
                break
            x = self.space.points(u)
            found = self._found(number, x, bench)
            evolution.tell(self.goals.measured(found))
            U.append(u), X.append(x), rows.append(found), generation.append(np.full(len(u), number + 1))
            self.done = number + 1
            watch(self.done / self.generations)
        return Generations(np.concatenate(U), np.concatenate(X), joined_rows(rows), np.concatenate(generation))

    def _found(self, number: int, x: np.ndarray, bench: Bench) -> Rows:
        keys = self.keys.of(x)
        kept = self.store.read(number)
        if kept is not None and np.array_equal(kept.keys, keys):
            return kept.rows
        rows = bench.rows(x)
        try:
            self.store.write(number, Chunk(keys, rows))
        except InputError as error:
            said = f"{error.rule}; {number} generations are kept, and the same command goes on from there"
            raise InputError(said, path=error.path) from None
        return rows
