"""A search as its outcome: all points with those polished, the front among them, its knee and its best points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.studies.optimize.front import Knee, Scale, history, knee_of, knee_text, non_dominated, scale_of
from spheredrive.studies.optimize.polish import Aim, polished
from spheredrive.studies.optimize.search import Bench, Generations, Search
from spheredrive.studies.sweep.evaluate import Rows, joined_rows


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a search has found.

    U, X, rows    coordinates, points and metrics of everything that was evaluated, (k, ...)
    generation    of each point, from 1; 0 for polished ones, (k,)
    F, feasible   objectives to be made small, (k, M), and which points keep all constraints, (k,)
    front         numbers of the points that no other beats, by rising first objective
    volume        hypervolume after each generation, in ranges of the front
    knee, best    places in ``front``: of the knee, and of the best point in each objective
    """

    U: np.ndarray
    X: np.ndarray
    rows: Rows
    generation: np.ndarray
    F: np.ndarray
    feasible: np.ndarray
    front: np.ndarray
    volume: np.ndarray
    knee: Knee
    best: tuple[int, ...]

    @property
    def scale(self) -> Scale:
        """The ends of the front."""
        return scale_of(self.F[self.front])


def outcome(search: Search, found: Generations, bench: Bench, polish: bool = True) -> Outcome:
    """The outcome of finished generations, its knee and best points polished.

    Raises ``SpheredriveError`` with what stands in the way most where no point keeps all constraints.
    """
    measured = search.goals.measured(found.rows)
    if not measured.feasible.any():
        raise SpheredriveError(_why_none(search, found.rows))
    U, X, rows, generation = found
    if polish:
        first = _outcome(search, U, X, rows, generation)
        better = [
            p
            for p in (polished(first.U[first.front[k]], aim, search.goals, search.space, bench.rows) for k, aim in _aims(first))
            if p
        ]
        if better:
            U, X = np.vstack([U, *(p.u for p in better)]), np.vstack([X, *(p.x for p in better)])
            rows = joined_rows([rows, *(p.rows for p in better)])
            generation = np.r_[generation, np.zeros(len(better), np.int64)]
    return _outcome(search, U, X, rows, generation)


def _aims(o: Outcome) -> list[tuple[int, Aim]]:
    """Places in the front that are polished, and by what: its best points each in its goal, then the knee in all."""
    width, M = o.scale.range, o.F.shape[1]
    aims = [(k, Aim((j,), o.F[o.front[k]], width)) for j, k in enumerate(o.best)]
    if M > 1:
        aims.append((o.knee.place, Aim(tuple(range(M)), o.F[o.front[o.knee.place]], width)))
    return aims


def _outcome(search: Search, U, X, rows: Rows, generation) -> Outcome:
    measured = search.goals.measured(rows)
    F, feasible = measured.F, measured.feasible
    fine = np.flatnonzero(feasible)
    front = fine[non_dominated(F[fine])]
    front = front[np.lexsort(F[front].T[::-1])]
    volume = history(F, feasible, generation, scale_of(F[front]))
    best = tuple(int(k) for k in np.argmin(F[front], axis=0))
    return Outcome(U, X, rows, generation, F, feasible, front, volume, knee_of(F[front]), best)


def _why_none(search: Search, rows: Rows) -> str:
    G = search.goals.measured(rows).G
    lacking = G[:, -1] > 0
    head = f"none of {len(G)} designs keeps all constraints"
    if lacking.all():
        common = int(np.argmax(np.bincount(rows.reason[rows.reason > 0])))
        return f"{head}: all lack numbers, most of them as {rows.sentences[common - 1]}"
    broken = (G[~lacking, :-1] > 0).sum(axis=0)
    worst = int(np.argmax(broken))
    c = search.goals.constraints[worst]
    nearest = float(G[~lacking, worst].min())
    more = "" if nearest > 0 else "; some keep it, but break another"
    told = f"{c.metric} {c.relation} {c.bound:g} is broken by {broken[worst]} of {int((~lacking).sum())} with numbers"
    return f"{head}: {told}{more}"


def knee_words(search: Search, o: Outcome) -> str:
    """Why the knee is the knee."""
    return knee_text(o.knee, tuple(objective.metric for objective in search.goals.objectives))
