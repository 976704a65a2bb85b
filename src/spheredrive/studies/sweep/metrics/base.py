"""What a family of metrics is: names and units, and one function from columns to numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.io.study import Metric

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.io.study import Study
    from spheredrive.motion import Motion
    from spheredrive.studies.sweep.columns import Columns


class Found(NamedTuple):
    """A metric of b machines: its values (b,), and for those without one the number of a sentence that says why, from 1.

    ``values`` where ``reason`` is not 0 say nothing.
    """

    values: np.ndarray
    reason: np.ndarray
    sentences: tuple[str, ...] = ()


@dataclass(frozen=True)
class Conditions:
    """What is the same for all machines of a study: wheel speeds (rad/s; one each, one for all, or none), motion, prices."""

    speeds: tuple[float, ...] = ()
    motion: Motion | None = None
    prices: tuple[tuple[str, float], ...] = ()

    @classmethod
    def of(cls, study: Study) -> Conditions:
        """Those of a study."""
        return cls(study.speeds, study.motion, study.prices)


@dataclass(frozen=True)
class Machines:
    """A batch to be measured: columns, and the designs themselves where ``Family.whole`` asks for them.

    ``memory`` keeps what several families take from the same long work.
    """

    columns: Columns
    designs: Sequence[Design] | None = None
    memory: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Family:
    """Metrics that are worked out together.

    metrics   those it has
    measure   from machines, conditions and the names asked for to what was found
    whole     whether it needs whole designs, by conditions and the names asked for
    batch     points that one piece of work should hold: long enough to be worth sending, short enough to be lost
    """

    metrics: tuple[Metric, ...]
    measure: Callable[[Machines, Conditions, tuple[str, ...]], dict[str, Found]]
    whole: Callable[[Conditions, tuple[str, ...]], bool]
    batch: Callable[[Conditions, tuple[str, ...]], int]


def known(values: np.ndarray) -> Found:
    """Values that every machine has."""
    return Found(values, np.zeros(len(values), np.int64))


def unless(values: np.ndarray, *whys: tuple[np.ndarray | bool, str]) -> Found:
    """Values but where one of the masks (b,) holds, by the sentence of the first that does."""
    reason = np.zeros(len(values), np.int64)
    for number, (mask, _) in enumerate(whys, 1):
        reason[(reason == 0) & mask] = number
    return Found(values, reason, tuple(sentence for _, sentence in whys))


def nowhere(count: int, sentence: str) -> Found:
    """What no machine of the batch has."""
    return unless(np.zeros(count), (np.ones(count, bool), sentence))


def one_by_one(count: int, measure: Callable[[int], float]) -> Found:
    """``measure`` of each machine alone; what it raises as a ``SpheredriveError`` is the reason why there is no number."""
    from spheredrive.errors import SpheredriveError

    values, reason, sentences = np.zeros(count), np.zeros(count, np.int64), {}
    for i in range(count):
        try:
            values[i] = measure(i)
        except SpheredriveError as error:
            reason[i] = sentences.setdefault(str(error), len(sentences) + 1)
    return Found(values, reason, tuple(sentences))
