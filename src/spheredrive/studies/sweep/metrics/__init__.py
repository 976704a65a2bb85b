"""What can be wanted of a design: one family of metrics a file. A new family is a file and a line here."""

from __future__ import annotations

import importlib
from functools import lru_cache

from spheredrive.io.study import Metric
from spheredrive.studies.sweep.metrics.base import Conditions, Family

_FAMILIES = ("kinematics", "layout", "load", "vibration", "simulated")


@lru_cache(maxsize=1)
def families() -> tuple[Family, ...]:
    """Every family."""
    return tuple(importlib.import_module(f"{__name__}.{name}").FAMILY for name in _FAMILIES)


@lru_cache(maxsize=1)
def metrics() -> dict[str, Metric]:
    """Every metric by its name."""
    return {metric.name: metric for family in families() for metric in family.metrics}


def asked_of(names: tuple[str, ...]) -> list[tuple[Family, tuple[str, ...]]]:
    """The families that have ``names``, each with its own among them."""
    own = [(family, tuple(n for n in names if any(n == m.name for m in family.metrics))) for family in families()]
    return [(family, its) for family, its in own if its]


def needs_designs(names: tuple[str, ...], conditions: Conditions) -> bool:
    """Whether ``names`` take whole designs, not columns alone."""
    return any(family.whole(conditions, its) for family, its in asked_of(names))


def batch_size(names: tuple[str, ...], conditions: Conditions) -> int:
    """Points that one piece of work should hold."""
    return min(family.batch(conditions, its) for family, its in asked_of(names))
