"""The points of a study, each from its number alone."""

from __future__ import annotations

import math

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Study
from spheredrive.studies.sweep.sampling import SOBOL_BITS, latin_hypercube, sobol, uniforms


class Points:
    """``count`` points with one number a parameter: its value in SI, or the number of a choice.

    shape   values along each parameter of a grid, whose last parameter runs fastest; (count,) of other methods
    """

    def __init__(self, study: Study):
        self.parameters = study.parameters
        self.sampling = study.sampling
        self.grid = study.sampling.method == "grid"
        self._values = [p.values if p.law == "values" else None for p in self.parameters]
        lengths = [1 if v is None else len(v) for v in self._values]
        if self.grid:
            self.shape = tuple(lengths)
        elif study.sampling.method == "list":
            self.shape = (max(lengths),)
        else:
            assert study.sampling.size is not None, "the study file was checked"
            self.shape = (study.sampling.size,)
        self.count = math.prod(self.shape)
        if study.sampling.method == "sobol" and self.count > 2**SOBOL_BITS:
            raise SpheredriveError(f"a Sobol' sequence has 2^{SOBOL_BITS} points at most")

    def values(self, first: int, count: int) -> np.ndarray:
        """Points ``first`` to before ``first + count``, (count, d)."""
        index = np.arange(first, first + count)
        method, seed = self.sampling.method, self.sampling.seed
        out = np.empty((count, len(self.parameters)))
        if self.grid:
            for column, (values, place) in enumerate(zip(self._values, np.unravel_index(index, self.shape), strict=True)):
                out[:, column] = values[place]  # type: ignore[index]
        elif method == "list":
            for column, values in enumerate(self._values):
                out[:, column] = values[index % len(values)]  # type: ignore[arg-type,index]
        elif method == "sobol":
            u = sobol(seed, tuple(p.name for p in self.parameters), first, count)
            for column, p in enumerate(self.parameters):
                out[:, column] = p.from_uniform(u[:, column])
        else:
            for column, p in enumerate(self.parameters):
                random = method == "random"
                u = uniforms(seed, p.name, index) if random else latin_hypercube(seed, p.name, index, self.count)
                out[:, column] = p.from_uniform(u)
        return out
