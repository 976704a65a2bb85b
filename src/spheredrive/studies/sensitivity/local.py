"""Derivatives of metrics by parameters at one point, with the error that they are known to."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.design_path import resolve
from spheredrive.io.design_text import design_text
from spheredrive.io.study import Parameter, Sampling, Study
from spheredrive.studies.sweep.evaluate import Evaluator, Rows
from spheredrive.studies.sweep.metrics import metrics

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

# The largest step as a share of a parameter's scale, how many steps are tried, each half of the one before.
LARGEST, LEVELS = 0.02, 8
# A slope that jumps by more than this share of itself is a crease, of which there is no derivative.
CREASE = 1e-2
# What the last digit of a metric is worth.
ROUNDING = 2.0**-52

Evaluate = Callable[[np.ndarray], Rows]


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives at one point, SI: of M metrics by d parameters.

    at          the point, (d,); ``base`` the metrics there, (M,)
    values      ∂metric/∂parameter, (M, d), NaN where there is none
    error       how far off they may be, by how the last steps agree, (M, d)
    reasons     why one is missing: (metric, parameter, sentence)
    """

    metrics: tuple[str, ...]
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    at: np.ndarray
    base: np.ndarray
    values: np.ndarray
    error: np.ndarray
    reasons: tuple[tuple[str, str, str], ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI; what is missing is null."""

        def plain(array):
            return [[None if np.isnan(x) else float(x) for x in row] for row in array]

        return {
            "metrics": list(self.metrics),
            "parameters": list(self.parameters),
            "at": self.at.tolist(),
            "base": plain(self.base[None])[0],
            "gradient": plain(self.values),
            "error": plain(self.error),
            "reasons": [list(reason) for reason in self.reasons],
        }

    def text(self) -> str:
        """For a terminal: by how much each metric changes with one per cent more of a parameter, or one degree."""
        lines = []
        for row, name in enumerate(self.metrics):
            unit = metrics()[name].unit
            lines.append(f"{name} = {self.base[row]:.6g} {unit}".rstrip())
            for column, parameter in enumerate(self.parameters):
                angle = self.units[column] == "rad"
                step, words = (np.radians(1.0), "1 deg") if angle else (0.01 * abs(self.at[column]), "1 %")
                change = self.values[row, column] * step
                told = f"{change:+.4g} {unit}".rstrip() if np.isfinite(change) else self._reason(name, parameter)
                lines.append(f"  {parameter} {words} more: {told}")
        return "\n".join(lines)

    def _reason(self, metric: str, parameter: str) -> str:
        return next(said for m, p, said in self.reasons if (m, p) == (metric, parameter))


def study_of(
    design: Design, names: Sequence[str], paths: Sequence[str], motion: Motion | None = None, speeds: Sequence[float] = ()
) -> Study:
    """A study of ``design`` with metrics ``names`` and the parameters at ``paths``, such as ``placement.elevation``.

    Raises ``DesignError`` for a path that leads nowhere, or to what is no number.
    """
    text = design_text(design)
    data = tomllib.loads(text)
    parameters = []
    for path in paths:
        found = resolve(path, data)
        if not found.numeric or found.whole:
            raise SpheredriveError(f"{path} is no number that can change a little")
        parameters.append(Parameter(found, "values", tuple(float(x) for x in found.base[:1] if x is not None)))
    given = {"motion": motion, "speeds": tuple(map(float, speeds))}
    for name in names:
        if name not in metrics():
            raise SpheredriveError(f"there is no metric {name!r}")
        for need in metrics()[name].needs:
            if not given[need]:
                raise SpheredriveError(f"{name} needs {need}")
    return Study(design, data, ".", tuple(names), tuple(parameters), Sampling("list"), motion, given["speeds"])


def gradient(study: Study, at: Sequence[float] | None = None, evaluate: Evaluate | None = None) -> Gradient:
    """Derivatives of the metrics of ``study`` by its parameters, at the values of its base design or ``at``, SI.

    Central differences (f(x + h) − f(x − h))/2h with h halved from step to step, extrapolated to h = 0 (Richardson; Ridders
    1982): the entry of the table that changed least is taken, and by how much is its error. A slope that jumps at the point
    is told as a crease, with both slopes.
    Raises ``SpheredriveError`` where a parameter is no number or has no value to be changed.
    """
    evaluate = Evaluator(study).evaluate if evaluate is None else evaluate
    x = np.array([_start(p) for p in study.parameters] if at is None else at, float)
    h = LARGEST * np.array([_scale(p, value) for p, value in zip(study.parameters, x, strict=True)])
    steps = h[:, None] * 0.5 ** np.arange(LEVELS)
    X = np.concatenate([x[None], *(_moved(x, k, side * steps[k]) for k in range(len(x)) for side in (1.0, -1.0))])
    rows = evaluate(X)
    f = rows.values[1:].reshape(len(x), 2, LEVELS, -1)
    base = rows.values[0]
    shape = (len(study.metrics), len(x))
    values, error, reasons = np.full(shape, np.nan), np.full(shape, np.nan), []
    for k, p in enumerate(study.parameters):
        for m, name in enumerate(study.metrics):
            up, down = f[k, 0, :, m], f[k, 1, :, m]
            said = _why_none(rows, base[m], up, down) or _crease(steps[k], base[m], up, down)
            if said:
                reasons.append((name, p.name, said))
                continue
            values[m, k], error[m, k] = _extrapolated(
                (up - down) / (2 * steps[k]), ROUNDING * max(abs(up[0]), abs(down[0])) / steps[k]
            )
    named = tuple(p.name for p in study.parameters)
    return Gradient(study.metrics, named, tuple(p.unit for p in study.parameters), x, base, values, error, tuple(reasons))


def _start(p: Parameter) -> float:
    if not p.numeric or p.path.whole:
        raise SpheredriveError(f"{p.name} is no number that can change a little")
    own = set(p.path.base)
    if len(own) != 1 or None in own:
        raise SpheredriveError(f"{p.name} has no single value in the design to be changed; give the point with at")
    return float(own.pop())


def _scale(p: Parameter, value: float) -> float:
    """What steps are shares of: an angle's radian, else the value, else the width of the parameter's law."""
    if p.unit == "rad":
        return 1.0
    width = max(p.numbers) - min(p.numbers) if p.numbers else 0.0
    scale = abs(value) or width
    if not scale:
        raise SpheredriveError(f"{p.name} is zero, so it has no scale to be changed on; give it a range")
    return scale


def _moved(x: np.ndarray, column: int, steps: np.ndarray) -> np.ndarray:
    out = np.repeat(x[None], len(steps), axis=0)
    out[:, column] += steps
    return out


def _why_none(rows: Rows, base: float, up: np.ndarray, down: np.ndarray) -> str:
    if np.isfinite([base, *up, *down]).all():
        return ""
    first = int(rows.reason[np.flatnonzero(rows.reason)[0]])
    return f"there is no number nearby: {rows.sentences[first - 1]}"


def _crease(h: np.ndarray, base: float, up: np.ndarray, down: np.ndarray) -> str:
    """Both slopes in words where they differ: the second difference over h does not vanish with h."""
    right, left = (up - base) / h, (base - down) / h
    # Extrapolated linearly in h from steps that are small, but not yet noise.
    a, b = 2 * right[4] - right[3], 2 * left[4] - left[3]
    size = max(abs(a), abs(b))
    if size == 0.0 or abs(a - b) <= CREASE * size or abs(a - b) * h[4] < 1e-12 * abs(base):
        return ""
    return f"has a crease here: its slope is {b:.6g} below and {a:.6g} above"


def _extrapolated(D: np.ndarray, noise: np.ndarray) -> tuple[float, float]:
    """The limit of differences D over halved steps, whose error is even in the step, and how far off it may be; ``noise`` is
    what rounding leaves in each."""
    best, error = float(D[0]), np.inf
    row = [D[0]]
    for k in range(1, len(D)):
        new = [D[k]]
        for j in range(1, k + 1):
            new.append(new[j - 1] + (new[j - 1] - row[j - 1]) / (4.0**j - 1.0))
            off = max(abs(new[j] - new[j - 1]), abs(new[j] - row[j - 1])) + noise[k]
            if off < error:
                best, error = float(new[j]), float(off)
        row = new
    return best, error
