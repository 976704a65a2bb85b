"""Chosen points made as good as they can be by SciPy: what evolution has found to a per cent is settled to the last digits."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from spheredrive.studies.optimize.goals import Goals, Measured
from spheredrive.studies.optimize.space import Space
from spheredrive.studies.sweep.evaluate import Rows

# Side of the first simplex, of the second, which starts where the first has shrunk, and of central differences; in ranges.
SIMPLEX, AGAIN, STEP = 0.02, 1e-4, 1e-6
# Gradients that are taken, points of a simplex per free parameter at most, and how close both go, in ranges.
TURNS, POINTS, CLOSE = 25, 100, 1e-10
# What a broken constraint costs, in ranges of the goals: more than any goal can gain.
PENALTY = 1e3

Evaluate = Callable[[np.ndarray], Rows]


class Polished(NamedTuple):
    """A point that was made better: its coordinates and the point, (d,), and its row."""

    u: np.ndarray
    x: np.ndarray
    rows: Rows


class Aim(NamedTuple):
    """What is made small: the largest of (F − from) / range over ``goals``.

    For one goal that is this goal. For several a point moves towards better in all of them at once, and keeps its place on
    the front (Wierzbicki's achievement function).
    """

    goals: tuple[int, ...]
    origin: np.ndarray
    range: np.ndarray

    def parts(self, F: np.ndarray) -> np.ndarray:
        """(F − from) / range of the goals, (..., m)."""
        chosen = list(self.goals)
        return (F[..., chosen] - self.origin[chosen]) / self.range[chosen]


def polished(u: np.ndarray, aim: Aim, goals: Goals, space: Space, evaluate: Evaluate) -> Polished | None:
    """The point at coordinates ``u`` (d,) made better by ``aim`` with its constraints kept, or None where it cannot be.

    First along gradients by central differences (SLSQP with the aim as an epigraph), then by simplexes (Nelder and Mead),
    which also come to the bottom of a crease, as where two singular values meet. Choices and whole numbers stay.
    """
    free = np.flatnonzero(space.free)
    if not len(free):
        return None
    way = _Way(u, free, aim, goals, space, evaluate)
    way.along_gradients()
    way.by_simplexes(SIMPLEX)
    way.by_simplexes(AGAIN)
    return way.best()


class _Enough(Exception):
    """As many gradients are taken as may be: at a crease they lead nowhere."""


class _Way:
    """From one point to a better one; every point tried is remembered if it is the best so far."""

    def __init__(self, u, free, aim: Aim, goals: Goals, space: Space, evaluate: Evaluate):
        self.u, self.free, self.aim, self.goals, self.space, self.evaluate = u, free, aim, goals, space, evaluate
        self._best: tuple[float, np.ndarray, Rows] | None = None
        self.begin = self._merit(self._tried(u[free][None]))[0]
        self.start = u[free]

    def _full(self, v: np.ndarray) -> np.ndarray:
        U = np.repeat(self.u[None], len(v), axis=0)
        U[:, self.free] = np.clip(v, 0.0, 1.0)
        return U

    def _tried(self, v: np.ndarray) -> Measured:
        """What coordinates v (b, f) of the free parameters are worth."""
        U = self._full(v)
        rows = self.evaluate(self.space.points(U))
        found = self.goals.measured(rows)
        merit = self._merit(found)
        at = int(np.argmin(np.where(found.feasible, merit, np.inf)))
        if found.feasible[at] and (self._best is None or merit[at] < self._best[0]):
            self._best = merit[at], U[at], _row(rows, at)
        return found

    def _merit(self, found: Measured) -> np.ndarray:
        return np.minimum(self.aim.parts(found.F).max(axis=-1), WORST_PART) + PENALTY * np.minimum(found.violation, WORST_PART)

    def along_gradients(self) -> None:
        from scipy.optimize import minimize

        f = len(self.free)
        memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

        def parts(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            """What must stay below t, then what must stay below 0, at v, and their gradients."""
            key = v.tobytes()
            if key not in memory:
                if len(memory) == TURNS:
                    raise _Enough
                step = STEP * np.vstack([np.zeros(f), np.eye(f), -np.eye(f)])
                at = np.clip(v + step, 0.0, 1.0)
                found = self._tried(at)
                values = np.column_stack([self.aim.parts(found.F), found.G[:, :-1]])
                width = (at[1 : f + 1] - at[f + 1 :]).diagonal()
                gradient = (values[1 : f + 1] - values[f + 1 :]) / width[:, None]
                bad = found.G[:, -1].max() > 0
                memory[key] = values[0], np.zeros_like(gradient.T) if bad else gradient.T
            return memory[key]

        m = len(self.aim.goals)
        lid = np.r_[np.ones(m), np.zeros(len(self.goals.constraints))]
        with contextlib.suppress(_Enough):
            minimize(
                lambda z: z[-1],
                np.r_[self.start, 0.0],
                jac=lambda z: np.r_[np.zeros(f), 1.0],
                method="SLSQP",
                bounds=[*[(0.0, 1.0)] * f, (-10.0, 10.0)],
                constraints={
                    "type": "ineq",
                    "fun": lambda z: lid * z[-1] - parts(z[:-1])[0],
                    "jac": lambda z: np.column_stack([-parts(z[:-1])[1], lid]),
                },
                options={"ftol": CLOSE},
            )

    def by_simplexes(self, side: float) -> None:
        from scipy.optimize import minimize

        begin = self._best[1][self.free] if self._best else self.start
        corners = np.vstack([begin, begin + side * np.diag(np.where(begin + side > 1.0, -1.0, 1.0))])
        minimize(
            lambda v: float(self._merit(self._tried(v[None]))[0]),
            begin,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * len(begin),
            options={"initial_simplex": corners, "xatol": CLOSE, "fatol": 10 * CLOSE, "maxfev": POINTS * len(begin)},
        )

    def best(self) -> Polished | None:
        if self._best is None or not self._best[0] < self.begin:
            return None
        _, u, rows = self._best
        return Polished(u, self.space.points(u), rows)


# So that sums of what a point without numbers is told to have stay finite.
WORST_PART = 1e20


def _row(rows: Rows, i: int) -> Rows:
    reason = rows.reason[i : i + 1]
    return Rows(rows.values[i : i + 1], np.minimum(reason, 1), rows.sentences[reason[0] - 1 : reason[0]] if reason[0] else ())
