"""NSGA-II and NSGA-III by pymoo, asked for coordinates and told what they are worth."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.io.study import Study
from spheredrive.studies.optimize.goals import Measured
from spheredrive.studies.optimize.space import Space

NAMES = ("nsga2", "nsga3")
# Designs of a generation, and generations, where the study does not say.
POPULATION, GENERATIONS = 64, 60
# How closely children resemble their parents, and the share of choices that change by chance (Deb and Agrawal 1995).
LIKENESS, CHANGE = 15, 20


def settled(study: Study) -> tuple[str, int, int]:
    """Name, population and generations; NSGA-III from three objectives on. Raises ``SpheredriveError`` for another name."""
    given = study.algorithm
    name = given.name if given else ("nsga2" if len(study.objectives) < 3 else "nsga3")
    if name not in NAMES:
        raise SpheredriveError(f"{study.path}: there is no algorithm {name!r}; choose from {', '.join(NAMES)}")
    population = (given and given.population) or POPULATION
    return name, population, (given and given.generations) or GENERATIONS


class Evolution:
    """An algorithm on its way. The same seed and the same answers lead along the same way, to the last bit."""

    def __init__(self, name: str, population: int, space: Space, objectives: int, constraints: int):
        pymoo = _pymoo()
        population = int(min(population, space.size))
        options: dict[str, Any] = {
            "pop_size": population,
            "sampling": space.first(population),
            "repair": pymoo.snap(space),
            "crossover": pymoo.crossover(space),
            "mutation": pymoo.mutation(space),
            "seed": space.seed % 2**32,
        }
        self._evaluate = pymoo.evaluate
        if name == "nsga3":
            options["selection"] = pymoo.tournament
            directions = pymoo.directions("das-dennis", objectives, n_partitions=partitions(objectives, population))
            self._algorithm = pymoo.NSGA3(directions, **options)
        else:
            self._algorithm = pymoo.NSGA2(**options)
        self._problem = pymoo.Problem(n_var=len(space), n_obj=objectives, n_ieq_constr=constraints, xl=0.0, xu=1.0)
        self._algorithm.setup(self._problem, termination=pymoo.NoTermination())
        self._asked: Any = None

    def ask(self) -> np.ndarray:
        """Coordinates of the next generation, (b, d); none where nothing new is left to try."""
        self._asked = self._algorithm.ask()
        return np.zeros((0, self._problem.n_var)) if self._asked is None else self._asked.get("X").astype(float)

    def tell(self, found: Measured) -> None:
        """What the coordinates that were asked for are worth."""
        self._evaluate(self._problem, self._asked, found)
        self._algorithm.tell(self._asked)


def partitions(objectives: int, population: int) -> int:
    """Into how many parts each edge of the simplex of goals is cut for at most ``population`` directions."""
    p = 1
    while objectives > 1 and math.comb(objectives + p, p + 1) <= population:
        p += 1
    return p


def _pymoo():
    """What is taken of pymoo. Raises ``SpheredriveError`` where it is not installed."""
    try:
        from types import SimpleNamespace

        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.algorithms.moo.nsga3 import NSGA3
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.core.repair import Repair
        from pymoo.core.termination import NoTermination
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM
        from pymoo.operators.selection.tournament import TournamentSelection
        from pymoo.problems.static import StaticProblem
        from pymoo.util.ref_dirs import get_reference_directions
    except ImportError:
        raise SpheredriveError('optimize needs pymoo: pip install "spheredrive[studies]"') from None

    class Snap(Repair):
        def __init__(self, space: Space):
            super().__init__()
            self.space = space

        def _do(self, problem, X, **_):
            return self.space.snapped(X.astype(float))

    class Crossover(SBX):
        """Numbers between their parents' and beyond; a choice from either parent."""

        def __init__(self, space: Space):
            super().__init__(eta=LIKENESS, prob=0.9)
            self.words = space.words

        def _do(self, problem, X, *args, random_state=None, **kwargs):
            Q = super()._do(problem, X, *args, random_state=random_state, **kwargs)
            swapped = random_state.random(X.shape[1:]) < 0.5
            Q[..., self.words] = np.where(swapped, X[::-1], X)[..., self.words]
            return Q

    class Mutation(PM):
        """Numbers to others nearby; a choice to any other."""

        def __init__(self, space: Space):
            super().__init__(eta=CHANGE)
            self.words = space.words

        def _do(self, problem, X, *args, random_state=None, **kwargs):
            Xp = super()._do(problem, X, *args, random_state=random_state, **kwargs)
            changed = random_state.random(X.shape) < min(0.5, 1 / problem.n_var)
            Xp[:, self.words] = np.where(changed, random_state.random(X.shape), X)[:, self.words]
            return Xp

    def by_violation_then_chance(pop, P, random_state=None, **_):
        # pymoo's own tosses a coin that no seed knows where two points break the constraints alike.
        broken = pop.get("CV")[:, 0]
        a, b = P.T
        coin = random_state.random(len(P)) < 0.5
        first = np.where(broken[a] == broken[b], coin, broken[a] < broken[b])
        return np.where(first, a, b)[:, None]

    def evaluate(problem, asked, found: Measured) -> None:
        Evaluator().eval(StaticProblem(problem, F=found.F, G=found.G), asked)

    return SimpleNamespace(
        NSGA2=NSGA2,
        NSGA3=NSGA3,
        Problem=Problem,
        NoTermination=NoTermination,
        directions=get_reference_directions,
        tournament=TournamentSelection(func_comp=by_violation_then_chance),
        evaluate=evaluate,
        snap=Snap,
        crossover=Crossover,
        mutation=Mutation,
    )
