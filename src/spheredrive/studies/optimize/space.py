"""Where is sought: the parameters of a study as a unit cube, numbers along their range and choices side by side."""

from __future__ import annotations

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Parameter, Study
from spheredrive.studies.sweep.sampling import latin_hypercube


class Space:
    """The unit cube that stands for the parameters.

    free    which coordinates run on without steps, (d,)
    words   which stand for choices that have no order, (d,)
    """

    def __init__(self, study: Study):
        for p in study.parameters:
            if p.law not in ("values", "uniform"):
                raise SpheredriveError(
                    f"{study.path}: {p.name} is scattered ({p.law}); to be chosen it takes from and to, or values"
                )
        self.parameters = study.parameters
        self.seed = study.sampling.seed
        self.steps = np.array([_steps(p) for p in self.parameters])
        self.free = self.steps == 0
        self.words = np.array([bool(p.choices) for p in self.parameters])
        self.low, self.high = np.array([p.numbers[:2] if p.law == "uniform" else (0.0, 1.0) for p in self.parameters]).T

    def __len__(self) -> int:
        return len(self.parameters)

    @property
    def size(self) -> float:
        """How many points there are."""
        return float("inf") if self.free.any() else float(np.prod(self.steps.astype(float)))

    def first(self, count: int) -> np.ndarray:
        """``count`` coordinates to begin with, spread evenly over each parameter, (count, d)."""
        index = np.arange(count)
        columns = [latin_hypercube(self.seed, f"optimize {p.name}", index, count) for p in self.parameters]
        return self.snapped(np.stack(columns, axis=1))

    def snapped(self, U: np.ndarray) -> np.ndarray:
        """Coordinates with those of choices and whole numbers in the middle of their step, (..., d)."""
        steps = np.where(self.free, 1, self.steps)
        return np.where(self.free, U, (self._number(U, steps) + 0.5) / steps)

    def points(self, U: np.ndarray) -> np.ndarray:
        """The points, as an evaluator takes them, of coordinates (..., d)."""
        steps = np.where(self.free, 1, self.steps)
        number = self._number(U, steps)
        out = (1.0 - U) * self.low + U * self.high
        for k, p in enumerate(self.parameters):
            if p.law == "values":
                out[..., k] = p.values[number[..., k].astype(np.int64)]
            elif not self.free[k]:
                out[..., k] = self.low[k] + number[..., k]
        # Rounding must not lead beyond an end.
        return np.where(self.free, np.clip(out, self.low, self.high), out)

    def _number(self, U: np.ndarray, steps: np.ndarray) -> np.ndarray:
        return np.clip(np.floor(U * steps), 0, steps - 1)


def _steps(p: Parameter) -> int:
    """How many values a parameter has; 0 for a range of numbers."""
    if p.law == "values":
        return len(p.values)
    return int(p.numbers[1] - p.numbers[0]) + 1 if p.path.whole else 0
