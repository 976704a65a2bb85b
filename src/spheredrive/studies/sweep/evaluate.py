"""Points in, numbers out: what a worker does, and all it does."""

from __future__ import annotations

import pickle
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from spheredrive.io.study import Study
from spheredrive.studies.sweep.metrics import asked_of, needs_designs
from spheredrive.studies.sweep.metrics.base import Conditions, Machines
from spheredrive.studies.sweep.points import Points
from spheredrive.studies.sweep.variants import Batch, Variants


class Rows(NamedTuple):
    """Metrics of b points.

    values      (b, M), NaN where there is none
    reason      (b,): 0, or the number of the sentence that says why something is missing, from 1
    sentences   in the order in which points name them
    """

    values: np.ndarray
    reason: np.ndarray
    sentences: tuple[str, ...]


class Evaluator:
    """The metrics of a study's points. A point that fails says why; the rest go on."""

    def __init__(self, study: Study):
        self.study = study
        self.points = Points(study)
        self.conditions = Conditions.of(study)
        self.families = asked_of(study.metrics)
        self.variants = Variants(study, needs_designs(study.metrics, self.conditions))
        self._column = {name: i for i, name in enumerate(study.metrics)}

    def evaluate(self, X: np.ndarray) -> Rows:
        """The metrics of points X (b, d); what is given for a point depends on no other."""
        try:
            return self._evaluated(X)
        except Exception as defect:
            # Nobody has thought of this: each point alone, so that the one at fault is known and the others have their numbers.
            if len(X) == 1:
                what = f"a defect of spheredrive ({type(defect).__name__}: {' '.join(str(defect).split())[:200]})"
                return Rows(np.full((1, len(self._column)), np.nan), np.ones(1, np.int64), (what,))
        return joined_rows([self.evaluate(X[i : i + 1]) for i in range(len(X))])

    def _evaluated(self, X: np.ndarray) -> Rows:
        values = np.full((len(X), len(self._column)), np.nan)
        batches, missing = self.variants.batches(X)
        told: dict[int, str] = dict(missing)
        for batch in batches:
            self._measure(batch, values, told)
        return _numbered(values, told)

    def _measure(self, batch: Batch, values: np.ndarray, told: dict[int, str]) -> None:
        """Fill in the metrics of a batch, and in ``told`` by row what is missing."""
        machines = Machines(batch.columns, batch.designs)
        for family, names in self.families:
            found = family.measure(machines, self.conditions, names)
            for name in names:
                numbers, reason, sentences = found[name]
                # A number that is none has not been thought of, and must not travel as one.
                fine = (reason == 0) & np.isfinite(numbers)
                values[batch.rows[fine], self._column[name]] = numbers[fine]
                for at in np.flatnonzero(~fine):
                    why = sentences[reason[at] - 1] if reason[at] else "it came out as no finite number"
                    row = int(batch.rows[at])
                    sentence = f"{name}: {why}"
                    told[row] = f"{told[row]}; {sentence}" if row in told else sentence


def _numbered(values: np.ndarray, told: dict[int, str]) -> Rows:
    numbers: dict[str, int] = {}
    reason = np.zeros(len(values), np.int64)
    for row in sorted(told):
        reason[row] = numbers.setdefault(told[row], len(numbers) + 1)
    return Rows(values, reason, tuple(numbers))


def joined_rows(parts: list[Rows]) -> Rows:
    """Rows one after the other."""
    numbers: dict[str, int] = {}
    reasons = []
    for part in parts:
        own = np.array([0, *(numbers.setdefault(s, len(numbers) + 1) for s in part.sentences)])
        reasons.append(own[part.reason])
    return Rows(np.concatenate([part.values for part in parts]), np.concatenate(reasons), tuple(numbers))


def work(study: bytes, X: np.ndarray) -> Rows:
    """One piece of work of a worker process: points X (b, d) of a pickled study."""
    return _evaluator(study).evaluate(X)


@lru_cache(maxsize=2)
def _evaluator(study: bytes) -> Evaluator:
    return Evaluator(pickle.loads(study))
