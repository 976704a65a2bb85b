"""A study as frozen values: a design, what is varied in it, how points are taken, and which numbers are wanted of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.values import whole, word

if TYPE_CHECKING:
    from collections.abc import Mapping

    from spheredrive.design import Design
    from spheredrive.io.design_path import DesignPath
    from spheredrive.motion import Motion

METHODS = ("grid", "list", "random", "latin-hypercube", "sobol")
# Methods whose points are the given values themselves.
GIVEN = ("grid", "list")


@dataclass(frozen=True)
class Metric:
    """One number wanted of a design.

    name        as a study writes it
    unit        SI; "" for a plain number
    long_name   what it is, for people
    needs       what of the study it cannot do without: "motion", "speeds"
    """

    name: str
    unit: str
    long_name: str
    needs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Parameter:
    """What is varied: a path into the design and the law its values follow, SI.

    law       "values": those in ``numbers`` (or ``choices``); "uniform" (from, to), "normal" (mean, standard deviation),
              "tolerance" (middle, largest deviation: normal with a third of it as its standard deviation, cut off there),
              "triangular" (from, most likely, to)
    numbers   SI; empty where values are words, flags or vectors
    choices   these values, each by its number from 0
    """

    path: DesignPath
    law: str
    numbers: tuple[float, ...] = ()
    choices: tuple[Any, ...] = ()

    @property
    def name(self) -> str:
        """The path as it is written."""
        return self.path.text

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers with a unit; else a point holds the number of a choice."""
        return not self.choices

    @property
    def unit(self) -> str:
        """SI unit; "" for plain numbers and choices."""
        return self.path.unit

    @property
    def values(self) -> np.ndarray:
        """What a point may hold where the law is "values", (k,)."""
        return np.arange(len(self.choices), dtype=float) if self.choices else np.array(self.numbers)

    def value(self, number: float) -> Any:
        """What ``number`` of a point stands for in the design: itself, a whole number, or a choice."""
        if self.choices:
            return self.choices[int(number)]
        return int(number) if self.path.whole and float(number).is_integer() else float(number)

    def from_uniform(self, u) -> np.ndarray:
        """Values of the law for ``u`` (...), uniform in (0, 1): the inverse of its distribution function."""
        from scipy.special import ndtr, ndtri

        u = np.asarray(u, float)
        if self.law == "values":
            values = self.values
            return values[np.minimum((u * len(values)).astype(np.int64), len(values) - 1)]
        a, b, *rest = self.numbers
        if self.law == "normal":
            return a + b * ndtri(u)
        if self.law == "tolerance":
            low = ndtr(-3.0)
            return a + b / 3.0 * ndtri(low + u * (1.0 - 2.0 * low))
        if self.law == "triangular":
            c = rest[0]
            share = (b - a) / (c - a)
            rising = a + np.sqrt(u * (c - a) * (b - a))
            return np.where(u < share, rising, c - np.sqrt((1.0 - u) * (c - a) * (c - b)))
        return np.floor(a + u * (b - a + 1)) if self.path.whole else a + u * (b - a)


@dataclass(frozen=True)
class Sampling:
    """How points are taken: every combination of values, values side by side, or ``size`` points of a sequence."""

    method: str = word("how points are taken", METHODS, default="grid")
    size: int | None = whole("number of points, where the method does not say", least=1, most=10**9, default=None)
    seed: int = whole("start of the random numbers", least=0, most=2**63 - 1, default=1)


@dataclass(frozen=True)
class Objective:
    """A metric to be made as small ("min") or as large ("max") as can be."""

    metric: str
    sense: str


@dataclass(frozen=True)
class Constraint:
    """A metric that must be at least (">=") or at most ("<=") ``bound``, SI."""

    metric: str
    relation: str
    bound: float


@dataclass(frozen=True)
class Algorithm:
    """How the best design is sought."""

    name: str = word("name of the algorithm", default="nsga2")
    population: int | None = whole("designs of one generation", least=2, most=1_000_000, default=None)
    generations: int | None = whole("number of generations", least=1, most=1_000_000, default=None)


@dataclass(frozen=True)
class Study:
    """A study file, read.

    design, motion   as their files give them; ``data`` is the design file as plain data, ``folder`` where files it names lie
    speeds           of the wheels, rad/s: one each, or one for all; empty where none are given
    metrics          names of what is wanted
    prices           of parts of the catalogue and of wheel models, by name, all in one currency
    source           text of the study file
    """

    design: Design
    data: Mapping[str, Any]
    folder: str
    metrics: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    sampling: Sampling
    motion: Motion | None = None
    speeds: tuple[float, ...] = ()
    objectives: tuple[Objective, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    algorithm: Algorithm | None = None
    prices: tuple[tuple[str, float], ...] = ()
    source: str = ""
    path: str = "study.toml"
