"""The room that a compliant run is worked out in: arrays that ``engine.advance`` writes before it reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.dynamics.compliant.layout import POWERS
from spheredrive.dynamics.compliant.station import ROLLER_SIZE, TOUCH_SIZE, WRENCH_SIZE
from spheredrive.simulation.compliant.arrow import OWN, SHARED

if TYPE_CHECKING:
    from spheredrive.dynamics.compliant.machine import Machine


class Room(NamedTuple):
    """Arrays, or their shapes, in the order in which ``engine.advance`` takes them."""

    states: object
    H: object
    frame: object
    sides: object
    by_turn: object
    pushes: object
    to_own: object
    from_own: object
    own: object
    own_sides: object
    wrenches: object
    touches: object
    spins: object
    Ks: object
    Ds: object
    powers: object
    drives: object
    pushing: object
    limited: object
    coming: object


def room_shapes(machine: Machine, stages: int) -> Room:
    """How much room a run of ``machine`` needs, by a method of so many stages."""
    n, m, q = len(machine.wheels), len(machine.stations), len(machine.outlines)
    return Room(
        states=(10 + stages, machine.state_size),
        H=(SHARED, SHARED),
        frame=(7, 7),
        sides=(2, SHARED),
        by_turn=(6, 3),
        pushes=(m, 8, 5),
        to_own=(n, SHARED, OWN),
        from_own=(n, OWN, SHARED),
        own=(n, OWN, OWN),
        own_sides=(2, n, OWN),
        wrenches=(m, WRENCH_SIZE),
        touches=(q, TOUCH_SIZE),
        # No array is empty: a graphics card has none.
        spins=(3, max(machine.rollers, 1), ROLLER_SIZE),
        Ks=(2, m, 7, 4),
        Ds=(2, m, 7, 7),
        powers=(4, POWERS + q),
        drives=(4, n),
        pushing=(3, 3),
        limited=(n,),
        coming=(q,),
    )


ROOM_KINDS = Room(*[np.float64] * 18, limited=np.bool_, coming=np.int64)


def room(machine: Machine, stages: int, make=np.empty, runs: tuple[int, ...] = ()) -> Room:
    """Room for a run, or with ``runs`` on the first axis for so many, made by ``make(shape, kind)``; not filled."""
    shapes = room_shapes(machine, stages)
    return Room(*(make(runs + shape, kind) for shape, kind in zip(shapes, ROOM_KINDS, strict=True)))
