"""Contact states: which races touch the sphere together, and what motion each state leaves free of slip."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.kinematics.contacts import Races, constraint
from spheredrive.kinematics.quality import SINGULAR, isotropy

if TYPE_CHECKING:
    from spheredrive.design import Design

# More states than these are not listed, and not looked at one by one.
LISTED = 256
SEARCHED = 65_536
CHUNK = 8192


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

    @property
    def races_text(self) -> str:
        """``"1 2 1+3"``: wheels apart by spaces, races that touch together joined."""
        return " ".join("+".join(map(str, active)) for active in self.races)


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

    Every state is looked at while there are no more than 65,536 of them. Beyond, the worst one *found* is returned: wheels
    change their races one by one as long as that makes it worse, from several starts.
    """
    tables = _gram_tables(design)
    sizes = [len(wheel.alternation) for wheel in design.wheels]
    count = math.prod(sizes)
    choice = _worst_of_all(tables, sizes, count) if count <= SEARCHED else _worst_found(tables, sizes)
    return contact_state(design, [w.alternation[k] for w, k in zip(design.wheels, choice, strict=True)])


def _gram_tables(design: Design) -> np.ndarray:
    """Per wheel and choice of its races: Σ a aᵀ of its rows, and the same of what its rows ask differently, (n, K, 2, 3, 3).

    A state's AᵀA is the sum over its wheels; so is the matrix whose rank is what several contacts of one wheel hold the
    sphere back by, as a wheel's own speed can follow one of them.
    """
    most = max(len(wheel.alternation) for wheel in design.wheels)
    tables = np.zeros((design.wheel_count, most, 2, 3, 3))
    for k in range(most):
        A, B = constraint(design, [wheel.alternation[k % len(wheel.alternation)] for wheel in design.wheels])
        for i in range(design.wheel_count):
            own = np.flatnonzero(B[:, i])
            rows, per_speed = A[own], A[own] / B[own, i][:, None]
            apart = (per_speed - per_speed[0]) * B[own[0], i]
            tables[i, k] = rows.T @ rows, apart.T @ apart
    return tables


def _badness(sums: np.ndarray) -> np.ndarray:
    """Order of states by sums (..., 2, 3, 3) of their tables: rotations left (0 to 3) and, below one of them, isotropy."""
    quality = np.linalg.eigvalsh(sums[..., 0, :, :])
    held = np.linalg.eigvalsh(sums[..., 1, :, :])
    rotations = 3 - np.sum(held > 1e-13 * np.maximum(held[..., -1:], 1e-12), axis=-1)
    return rotations + 0.5 * np.sqrt(np.clip(quality[..., 0] / quality[..., 2], 0, 1))


def _worst_of_all(tables: np.ndarray, sizes: list[int], count: int) -> np.ndarray:
    worst, least = np.zeros(len(sizes), int), np.inf
    for first in range(0, count, CHUNK):
        choices = np.array(np.unravel_index(np.arange(first, min(first + CHUNK, count)), sizes))
        sums = sum(tables[i, choices[i]] for i in range(len(sizes)))
        badness = _badness(sums)
        j = int(np.argmin(badness))
        if badness[j] < least:
            worst, least = choices[:, j], badness[j]
    return worst


def _worst_found(tables: np.ndarray, sizes: list[int]) -> np.ndarray:
    held = np.trace(tables[:, :, 1], axis1=2, axis2=3)
    starts = [np.zeros(len(sizes), int), np.array(sizes) - 1, np.argmax(held, axis=1) % np.array(sizes)]
    found = [_descend(tables, sizes, start) for start in starts]
    return min(found, key=lambda pair: pair[0])[1]


def _descend(tables: np.ndarray, sizes: list[int], choice: np.ndarray) -> tuple[float, np.ndarray]:
    """Change one wheel's races at a time while that makes the state worse."""
    choice = choice.copy()
    wheels = np.arange(len(sizes))
    sums = tables[wheels, choice].sum(axis=0)
    least = float(_badness(sums))
    for _ in range(50):
        before = least
        for i in wheels[np.array(sizes) > 1]:
            trials = sums - tables[i, choice[i]] + tables[i, : sizes[i]]
            badness = _badness(trials)
            k = int(np.argmin(badness))
            if badness[k] < least:
                sums, choice[i], least = trials[k], k, float(badness[k])
        if least == before:
            break
    return least, choice
