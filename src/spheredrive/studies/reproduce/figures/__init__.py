"""The thesis's figures, drawn again: one function a figure."""

from __future__ import annotations

from collections.abc import Iterator

from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures import (
    chapter2,
    excitation,
    frequencies,
    imperfect,
    perfect_world,
    sweeps,
    transmission,
)


def figures() -> Iterator[Drawing]:
    """All figures in the thesis's order."""
    yield chapter2.figure_2_7()
    yield perfect_world.figure_3_3()
    yield perfect_world.figure_3_4()
    yield perfect_world.figure_3_5()
    yield from imperfect.rigid_figures()
    yield imperfect.figure_3_10()
    yield from imperfect.elastic_figures()
    yield from (excitation.shape_figure(number) for number in (4, 5, 6))
    yield transmission.figure_4_7()
    yield frequencies.figure_4_8()
    yield frequencies.figure_4_9()
    yield from (sweeps.contact_figure(number) for number in (10, 11))
    yield sweeps.figure_4_12()
    yield from (sweeps.rigid_closure_figure(number) for number in (13, 14))
    yield sweeps.figure_4_15()
    yield from (excitation.potential_figure(number) for number in (16, 17, 18))
