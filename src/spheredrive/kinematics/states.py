"""Contact states: which races touch the sphere together, and what motion each state leaves free of slip."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.kinematics.contacts import Races, constraint
from spheredrive.kinematics.quality import SINGULAR, isotropy, singular_values

if TYPE_CHECKING:
    from spheredrive.design import Design

# More states than this are neither listed nor searched one by one.
LISTED = 256
SEARCHED = 65_536


class SlipFree(NamedTuple):
    """Slip-free motion of a contact state.

    basis          orthonormal basis of the motions (Ω, ω), one a row, (dof, 3 + n), rad/s
    dof            how many independent motions there are
    rotation_dof   how many independent rotations Ω among them: 3 means that every rotation is free of slip
    """

    basis: np.ndarray
    dof: int
    rotation_dof: int


def slip_free(design: Design, races: Races = None) -> SlipFree:
    """The motions (Ω, ω) that slip at no contact: the null space of [A | −B], A Ω = B ω.

    Source: model.md section 2; it gives the thesis's triple-race rule [2.85]. Rank is counted to 1e-12 of the largest
    singular value, rows and columns scaled to unit length first.
    """
    A, B = constraint(design, races)
    # Columns of B are as small as r / R: in units of rim speed they count like those of A.
    column = np.concatenate([np.ones(3), 1 / np.linalg.norm(B, axis=0)])
    rows = np.hstack([A, -B]) * column
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    sigma, directions = np.linalg.svd(rows)[1:]
    rank = int(np.sum(sigma > SINGULAR * sigma[0]))
    motions = directions[rank:] * column
    basis = np.linalg.qr(motions.T)[0].T if len(motions) else motions
    rotation = np.linalg.svd(basis[:, :3], compute_uv=False) if len(basis) else np.zeros(0)
    # |ω| of a rotation is R/r times |Ω|: against that size a projection of 1e-9 is still rounding.
    return SlipFree(basis, len(basis), int(np.sum(rotation > 1e-9 * (rotation.max() if len(rotation) else 0))))


@dataclass(frozen=True)
class ContactState:
    """One combination of active races.

    races           race numbers in contact, of each wheel
    contacts        how many contacts that makes, m
    slip_free_dof   independent slip-free motions of sphere and wheels
    rotation_dof    independent slip-free rotations of the sphere among them
    isotropy        σ₃ / σ₁ of this state's constraint matrix
    """

    races: tuple[tuple[int, ...], ...]
    contacts: int
    slip_free_dof: int
    rotation_dof: int
    isotropy: float


def count_contact_states(design: Design) -> int:
    """How many combinations of active races the wheels can show."""
    return math.prod(len(wheel.alternation) for wheel in design.wheels)


def contact_state(design: Design, races) -> ContactState:
    """The contact state in which ``races`` (race numbers of each wheel) touch."""
    races = tuple(tuple(int(n) for n in np.atleast_1d(np.asarray(active))) for active in races)
    free = slip_free(design, races)
    return ContactState(races, sum(map(len, races)), free.dof, free.rotation_dof, isotropy(design, races))


def contact_states(design: Design) -> Iterator[ContactState]:
    """Every contact state, the last wheel's races changing fastest."""
    for races in itertools.product(*(wheel.alternation for wheel in design.wheels)):
        yield contact_state(design, races)


def worst_contact_state(design: Design) -> ContactState:
    """The state with fewest slip-free rotations and, among equals, the least isotropy.

    More contacts at once only take motion away, so no state has fewer slip-free rotations than one in which every wheel
    shows the most contacts it can. The search for the least isotropy goes through those states alone, and through the
    first 65,536 of them where there are more.
    """
    most = [max(map(len, wheel.alternation)) for wheel in design.wheels]
    fullest = itertools.product(
        *([a for a in wheel.alternation if len(a) == m] for wheel, m in zip(design.wheels, most, strict=True))
    )
    candidates = list(itertools.islice(fullest, SEARCHED))
    return contact_state(design, candidates[int(np.argmin(_isotropies(design, candidates)))])


def _isotropies(design: Design, candidates) -> np.ndarray:
    # Each wheel's rows for each choice of its races, found once; a state's matrix is then put together from them.
    first = candidates[0]
    rows = []
    for i, wheel in enumerate(design.wheels):
        by_choice = {}
        for active in wheel.alternation:
            state = (*first[:i], active, *first[i + 1 :])
            A, B = constraint(design, state)
            by_choice[active] = A[B[:, i] != 0]
        rows.append(by_choice)
    stacked = np.array([np.vstack([rows[i][active] for i, active in enumerate(state)]) for state in candidates])
    sigma = singular_values(stacked)
    return sigma[:, 2] / sigma[:, 0]
