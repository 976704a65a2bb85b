"""What finished work is found again by: its content, not its place.

A study's *context* is what all its points share: the base design, motion, speeds, metrics, and the version of this program.
A point's key is, within a context, the set of values in which its machine differs from the base: each place of the design file
and its value are mixed to 128 bits, and these are added up. A parameter that is at the base's own value adds nothing. So a
point that a study already had is found again when an axis is added, refined, reordered or taken away, whatever its number is.

A *plan* is a context with the law of all points: where it is the same, finished chunks are found by their number alone.
"""

from __future__ import annotations

import hashlib
import json

import numpy as np

import spheredrive
from spheredrive.io.study import Parameter, Study
from spheredrive.studies.sweep.mixing import key_of, mixed

# Raised with every change that makes other numbers of the same study.
NUMBERS = 1


def context_of(study: Study) -> str:
    """What all points share, as text of 32 letters."""
    shared = (study.design, study.motion, study.speeds, study.prices, study.metrics, spheredrive.__version__, NUMBERS)
    return _digest(*map(repr, shared))


def plan_of(study: Study, chunk: int) -> str:
    """The context with the law of all points and the size of a chunk, as text of 32 letters."""
    laws = [(p.path.places, p.law, p.numbers, p.choices) for p in study.parameters]
    return _digest(context_of(study), repr(laws), repr(study.sampling), str(chunk))


def _digest(*words: str) -> str:
    return hashlib.blake2b("\0".join(words).encode(), digest_size=16).hexdigest()


class Keys:
    """Keys of a study's points."""

    def __init__(self, study: Study):
        self._terms = [_Terms(p) for p in study.parameters]

    def of(self, X: np.ndarray) -> np.ndarray:
        """Keys of points X (b, d), (b, 2) of 64 bits."""
        total = np.zeros((len(X), 2), np.uint64)
        for column, terms in enumerate(self._terms):
            terms.add(X[:, column], total)
        return total


class _Terms:
    """What one parameter adds to a key: at each of its places, unless the value is the base's."""

    def __init__(self, parameter: Parameter):
        self.choices = parameter.choices
        self.salts = [(key_of("low", place), key_of("high", place)) for place in parameter.path.places]
        self.base = parameter.path.base
        self.coded = np.array([key_of(_text(choice)) for choice in self.choices], np.uint64)

    def add(self, values: np.ndarray, total: np.ndarray) -> None:
        number = values.astype(np.int64) if self.choices else None
        # Minus zero is zero.
        bits = (values + 0.0).view(np.uint64) if number is None else self.coded[number]
        for (low, high), base in zip(self.salts, self.base, strict=True):
            if number is None:
                differs = values != base if base is not None else np.ones(len(values), bool)
            else:
                differs = np.array([choice != base for choice in self.choices])[number]
            # Twice: once with the place, so that no two places and values make up for each other.
            first = mixed(mixed(bits ^ np.uint64(low)) + np.uint64(high))
            second = mixed(mixed(bits + np.uint64(high)) ^ np.uint64(low))
            total[:, 0] += np.where(differs, first, np.uint64(0))
            total[:, 1] += np.where(differs, second, np.uint64(0))


def _text(choice) -> str:
    return json.dumps(choice, default=repr)
