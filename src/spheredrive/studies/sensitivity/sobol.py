"""Sobol' indices: which share of a metric's variance comes from which parameter, alone and with the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Study
from spheredrive.studies.sweep.evaluate import Evaluator, Rows
from spheredrive.studies.sweep.sampling import sobol

# Points of one evaluation.
AT_ONCE = 4096
RESAMPLES, CONFIDENCE = 200, 0.95


@dataclass(frozen=True, eq=False)
class SobolIndices:
    """Shares of the variance of M metrics by d parameters, (M, d), each with half the width of its 95 % interval.

    first   V(E(f | x))/V(f): what fixing the parameter would take off the variance on average
    total   what is left of it with all others fixed, with every interaction
    points  how many points were evaluated
    """

    metrics: tuple[str, ...]
    parameters: tuple[str, ...]
    first: np.ndarray
    first_width: np.ndarray
    total: np.ndarray
    total_width: np.ndarray
    points: int

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        arrays = {name: getattr(self, name).tolist() for name in ("first", "first_width", "total", "total_width")}
        return {"metrics": list(self.metrics), "parameters": list(self.parameters), "points": self.points, **arrays}

    def text(self) -> str:
        """For a terminal, the parameters of each metric by their total share."""
        lines = [f"{self.points:,} points; share of the variance alone, and with interactions (± 95 % interval)"]
        for m, name in enumerate(self.metrics):
            lines.append(name)
            for k in np.argsort(-self.total[m], kind="stable"):
                alone = f"{self.first[m, k]:6.3f} ± {self.first_width[m, k]:.3f}"
                whole = f"{self.total[m, k]:6.3f} ± {self.total_width[m, k]:.3f}"
                lines.append(f"  {alone}  {whole}  {self.parameters[k]}")
        return "\n".join(lines)


def sobol_indices(study: Study, size: int, evaluate: Callable[[np.ndarray], Rows] | None = None) -> SobolIndices:
    """Sobol' indices of the metrics of ``study`` over the laws of its parameters, from ``size`` · (d + 2) points.

    The points are two independent sets A and B of the Sobol' sequence, from the study's seed, and A with one column of B at
    a time (Saltelli et al. 2010). ``size`` is rounded up to a power of two, on which the sequence is balanced.
    Raises ``SpheredriveError`` where a point has no number: shares of what is not there would mislead; and where SALib is
    not installed.
    """
    analyze = _analyze()
    if size < 2:
        raise SpheredriveError(f"Sobol' indices take two points at least, not {size}")
    evaluate = Evaluator(study).evaluate if evaluate is None else evaluate
    count = 1 << (size - 1).bit_length()
    d, names = len(study.parameters), tuple(p.name for p in study.parameters)
    X = saltelli_points(study, count)
    values = np.concatenate([_known(evaluate(X[i : i + AT_ONCE]), study) for i in range(0, len(X), AT_ONCE)])
    problem = {"num_vars": d, "names": list(names)}
    found = []
    for column in values.T:
        if np.ptp(column) == 0.0:
            # What never changes owes nothing to anybody.
            found.append(np.zeros((4, d)))
            continue
        answer = analyze(
            problem,
            column,
            calc_second_order=False,
            num_resamples=RESAMPLES,
            conf_level=CONFIDENCE,
            seed=study.sampling.seed % 2**32,
        )
        found.append(np.array([answer[key] for key in ("S1", "S1_conf", "ST", "ST_conf")], float))
    first, first_width, total, total_width = np.array(found).transpose(1, 0, 2)
    return SobolIndices(study.metrics, names, first, first_width, total, total_width, len(X))


def saltelli_points(study: Study, count: int) -> np.ndarray:
    """For each of ``count`` numbers a point of A, that point with each column of B in turn, and the point of B."""
    d = len(study.parameters)
    names = tuple(p.name for p in study.parameters)
    u = sobol(study.sampling.seed, (*names, *(f"{name} again" for name in names)), 0, count)
    A, B = u[:, :d], u[:, d:]
    rows = np.repeat(A[:, None], d + 2, axis=1)
    rows[:, -1] = B
    for k in range(d):
        rows[:, 1 + k, k] = B[:, k]
    flat = rows.reshape(-1, d)
    return np.stack([p.from_uniform(flat[:, k]) for k, p in enumerate(study.parameters)], axis=1)


def _known(rows: Rows, study: Study) -> np.ndarray:
    missing = np.isnan(rows.values).any(axis=1)
    if missing.any():
        said = rows.sentences[rows.reason[np.flatnonzero(missing)[0]] - 1]
        raise SpheredriveError(f"{study.path}: Sobol' indices need every number, but some points have none: {said}")
    return rows.values


def _analyze():
    try:
        from SALib.analyze.sobol import analyze
    except ImportError:
        raise SpheredriveError('Sobol\' indices need SALib: pip install "spheredrive[studies]"') from None
    return analyze
