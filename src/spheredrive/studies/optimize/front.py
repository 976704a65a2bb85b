"""Of many points those that no other beats, how the search came to them, and which of them is the knee."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# How far beyond the worst end of the front hypervolume is measured, in its ranges.
BEYOND = 0.1
# A point so much less far below the plane of the ends is no knee.
FLAT = 1e-3


def non_dominated(F: np.ndarray) -> np.ndarray:
    """Which points F (k, M), all to be made small, no other beats: is as good in every goal and better in one; (k,).

    Of equal points the first stands for all.
    """
    from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

    best = np.zeros(len(F), bool)
    if len(F):
        _, first = np.unique(F, axis=0, return_index=True)
        best[first[NonDominatedSorting().do(F[first], only_non_dominated_front=True)]] = True
    return best


class Scale(NamedTuple):
    """The ends of a front: its best and its worst value in each goal, (M,)."""

    ideal: np.ndarray
    nadir: np.ndarray

    @property
    def range(self) -> np.ndarray:
        """Worst less best; one where they are the same."""
        width = self.nadir - self.ideal
        return np.where(width > 0, width, 1.0)

    def of(self, F: np.ndarray) -> np.ndarray:
        """0 at the best and 1 at the worst end of each goal, (..., M)."""
        return (F - self.ideal) / self.range


def scale_of(front: np.ndarray) -> Scale:
    """The ends of a front (k, M)."""
    return Scale(front.min(axis=0), front.max(axis=0))


def hypervolume(front: np.ndarray, scale: Scale) -> float:
    """The share of goals, as volume between ``BEYOND`` the worst end and the front, that points beat; (k, M)."""
    from pymoo.indicators.hv import HV

    normal = scale.of(front)
    inside = normal[(normal < 1.0 + BEYOND).all(axis=1)]
    return float(HV(ref_point=np.full(front.shape[1], 1.0 + BEYOND))(inside)) if len(inside) else 0.0


def history(F: np.ndarray, feasible: np.ndarray, generation: np.ndarray, scale: Scale) -> np.ndarray:
    """Hypervolume of the best up to and with each generation, (g,)."""
    best = np.zeros((0, F.shape[1]))
    volumes = []
    for number in range(1, int(generation.max(initial=0)) + 1):
        best = np.concatenate([best, F[feasible & (generation == number)]])
        best = best[non_dominated(best)]
        volumes.append(hypervolume(best, scale) if len(best) else 0.0)
    return np.array(volumes)


class Knee(NamedTuple):
    """The point of a front that lies farthest below the plane of its ends.

    place     among the front's points
    depth     distance from the plane Σ f = 1 of goals from 0 (best) to 1 (worst); of a straight front 0, at most 1/√2 for two
    goals     of the knee, from 0 to 1, (M,)
    costs   for two goals, what a unit gained in each, on the way to its best end, costs of the other, in ranges: (1 − f₂)/f₁
            and (1 − f₁)/f₂, both above 1 where there is a knee
    """

    place: int
    depth: float
    goals: np.ndarray
    costs: tuple[float, ...]


def knee_of(front: np.ndarray) -> Knee:
    """The knee of a front (k, M); of equal depths the first.

    With goals f from 0 to 1 between the front's ends, the plane through these is Σ f = 1 and a point lies (1 − Σ f)/√M below.
    Source: Das 1999, "On characterizing the knee of the Pareto curve", for the line through the ends.
    """
    normal = scale_of(front).of(front)
    depth = (1.0 - normal.sum(axis=1)) / np.sqrt(front.shape[1])
    place = int(np.argmax(depth))
    at = normal[place]
    costs = tuple(float((1 - at[1 - k]) / at[k]) for k in (0, 1)) if front.shape[1] == 2 and (at > 0).all() else ()
    return Knee(place, float(depth[place]), at, costs)


def knee_text(knee: Knee, names: tuple[str, ...]) -> str:
    """Why the knee is the knee, in a few sentences; ``names`` of the goals."""
    if len(names) == 1:
        return f"There is one goal, {names[0]}: the knee is its best point."
    if not knee.goals.any():
        return "One design is best in every goal: there is nothing to trade."
    shares = ", ".join(f"{100 * (1 - g):.0f} % of what {name} can gain" for g, name in zip(knee.goals, names, strict=True))
    if knee.depth < FLAT:
        return f"The front has no knee: no point lies below the plane of its ends. Shown is one that has {shares}."
    line = "line" if len(names) == 2 else "plane"
    text = f"The knee lies farthest below the {line} through the ends of the front, by {knee.depth:.3f} of its ranges: "
    text += f"it has {shares}."
    if knee.costs:
        a, b = names
        text += (
            f" From it, 1 % more of {a} costs {knee.costs[0]:.3g} % of {b} on the way to the best {a}, and 1 % more of {b} "
            f"costs {knee.costs[1]:.3g} % of {a} on the way to the best {b}."
        )
    return text
