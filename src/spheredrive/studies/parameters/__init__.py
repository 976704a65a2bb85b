"""The studies that the thesis leaves open (its section 5.1): one parameter each, one figure, one conclusion for a designer."""

from __future__ import annotations

from collections.abc import Iterator

from spheredrive.studies.parameters import elevation, friction, heading, masses, radius_ratio, wheel_count
from spheredrive.studies.parameters.common import Study

__all__ = ["Study", "studies"]


def studies() -> Iterator[Study]:
    """All studies, one after another."""
    yield friction.study()
    yield elevation.study()
    yield heading.study()
    yield masses.sphere_study()
    yield masses.stage_study()
    yield radius_ratio.study()
    yield wheel_count.study()
