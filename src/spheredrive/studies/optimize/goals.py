"""What is sought: a study's objectives and constraints as numbers that are better when they are smaller."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Study
from spheredrive.studies.sweep.evaluate import Rows
from spheredrive.studies.sweep.metrics import metrics

# What a point that has no numbers is told to have: worse than any machine, and finite.
WORST = 1e30
# By how much such a point breaks its constraints: more than any machine does.
HOPELESS = 1e12


class Measured(NamedTuple):
    """Points as goals see them.

    F         objectives, all to be made small, (b, M); ``WORST`` where a point has none
    G         by how much each constraint is broken, in units of its bound; the last by lacking numbers; (b, C + 1)
    """

    F: np.ndarray
    G: np.ndarray

    @property
    def violation(self) -> np.ndarray:
        """Σ of all that is broken, (b,); zero where nothing is."""
        return np.maximum(self.G, 0.0).sum(axis=1)

    @property
    def feasible(self) -> np.ndarray:
        """Which points have all numbers and keep all constraints, (b,)."""
        return self.violation == 0.0


class Goals:
    """The objectives and constraints of a study, and ``asked``: the study with every metric that they need."""

    def __init__(self, study: Study):
        if not study.objectives:
            raise SpheredriveError(f'{study.path}: names no objectives; add a table such as [objectives] isotropy = "max"')
        named = (*study.metrics, *(o.metric for o in study.objectives), *(c.metric for c in study.constraints))
        self.asked = replace(study, metrics=tuple(dict.fromkeys(named)))
        self.objectives, self.constraints = study.objectives, study.constraints
        for name in self.asked.metrics:
            for need, given in (("motion", study.motion), ("speeds", study.speeds)):
                if need in metrics()[name].needs and not given:
                    raise SpheredriveError(f"{study.path}: {name} needs {need}; add the key {need} to this file")
        column = {name: k for k, name in enumerate(self.asked.metrics)}
        self._objective = [column[o.metric] for o in self.objectives]
        self._constraint = [column[c.metric] for c in self.constraints]
        self.sign = np.array([1.0 if o.sense == "min" else -1.0 for o in self.objectives])

    def measured(self, rows: Rows) -> Measured:
        """Rows of ``asked`` as goals see them."""
        F = self.sign * rows.values[:, self._objective]
        bounds = np.array([c.bound for c in self.constraints])
        side = np.array([1.0 if c.relation == "<=" else -1.0 for c in self.constraints])
        scale = np.where(bounds == 0.0, 1.0, np.abs(bounds))
        G = side * (rows.values[:, self._constraint] - bounds) / scale
        lacking = np.isnan(F).any(axis=1) | np.isnan(G).any(axis=1)
        F[lacking], G[lacking] = WORST, 0.0
        return Measured(F, np.column_stack([G, np.where(lacking, HOPELESS, -1.0)]))

    def values(self, F: np.ndarray) -> np.ndarray:
        """Objectives as they are, (..., M)."""
        return self.sign * F
