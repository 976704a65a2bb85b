"""Slip-free motion of contact states: its dimensions by another way of counting, and its basis by the contacts themselves."""

from fractions import Fraction

import numpy as np
import pytest

from layouts import atlas, collinear_triple, random_design, random_races
from spheredrive import kinematics as K
from spheredrive.checking import check
from spheredrive.wheels import DualRaceWheel, TripleRaceWheel

KINDS = ["triple-race", "dual-race", "split-dual-race", "ideal", None]


def rank_by_elimination(rows) -> int:
    """Rank by Gaussian elimination in exact fractions of the rounded entries, pivots below 1e-9 counted as zero."""
    matrix = [[Fraction(float(entry)) for entry in row] for row in rows]
    rank = 0
    for column in range(len(matrix[0])):
        pivot = max(range(rank, len(matrix)), key=lambda i: abs(matrix[i][column]), default=None)
        if pivot is None or abs(matrix[pivot][column]) < Fraction(1, 10**9):
            continue
        matrix[rank], matrix[pivot] = matrix[pivot], matrix[rank]
        for i in range(rank + 1, len(matrix)):
            factor = matrix[i][column] / matrix[rank][column]
            matrix[i] = [a - factor * b for a, b in zip(matrix[i], matrix[rank], strict=True)]
        rank += 1
        if rank == len(matrix):
            break
    return rank


def wheel_differences(design, races):
    """What contacts of one wheel ask of Ω: every wheel's ω can follow one contact, so only differences bind the sphere."""
    A, B = K.constraint(design, races)
    rows = []
    for i in range(design.wheel_count):
        own = np.flatnonzero(B[:, i])
        speed = A[own] / B[own, i][:, None] * B[own[0], i]
        rows += [row - speed[0] for row in speed[1:]]
    return rows


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("kind", KINDS)
def test_dimensions_match_a_rank_counted_by_elimination(kind, seed):
    rng = np.random.default_rng([11, seed])
    design = random_design(rng, int(rng.integers(1, 6)), kind, condition=200)
    races = random_races(rng, design)
    A, B = K.constraint(design, races)
    free = K.slip_free(design, races)
    assert free.dof == 3 + design.wheel_count - rank_by_elimination(np.hstack([A, -B]))
    differences = wheel_differences(design, races)
    assert free.rotation_dof == 3 - (rank_by_elimination(differences) if differences else 0)


@pytest.mark.parametrize("seed", range(30))
def test_basis_is_orthonormal_and_slips_nowhere(seed):
    rng = np.random.default_rng([12, seed])
    design = random_design(rng, int(rng.integers(1, 5)), rng.choice(["triple-race", "dual-race"]), condition=200)
    races = random_races(rng, design)
    A, B = K.constraint(design, races)
    basis = K.slip_free(design, races).basis
    np.testing.assert_allclose(basis @ basis.T, np.eye(len(basis)), atol=1e-12)
    np.testing.assert_allclose(A @ basis[:, :3].T, B @ basis[:, 3:].T, atol=1e-12)


def test_collinear_triple_race_turns_without_slip_about_one_axis_only():
    """R̂ all lie in the xy-plane, so the outer races agree for Ω along z alone (E9)."""
    free = K.slip_free(collinear_triple(), [(1, 3)] * 3)
    assert (free.dof, free.rotation_dof) == (1, 1)
    np.testing.assert_allclose(np.abs(free.basis[0, :3]) / np.linalg.norm(free.basis[0, :3]), [0, 0, 1], atol=1e-12)


def test_triple_race_states_run_from_three_to_six_contacts():
    contacts = sorted(state.contacts for state in K.contact_states(collinear_triple()))
    assert contacts == [3, 4, 4, 4, 5, 5, 5, 6]


def ranked(state):
    return state.rotation_dof, round(state.isotropy, 9)


@pytest.mark.parametrize(("kind", "n"), [("dual-race", 3), ("dual-race", 5), ("triple-race", 3), ("triple-race", 5), (None, 5)])
def test_worst_contact_state_is_the_worst_of_all(kind, n):
    rng = np.random.default_rng([13, n])
    design = random_design(rng, n, kind)
    states = list(K.contact_states(design))
    assert len(states) == K.count_contact_states(design)
    assert ranked(K.worst_contact_state(design)) == min(map(ranked, states))


@pytest.mark.parametrize("elevation_deg", [9.29, -9.29, 40])
@pytest.mark.parametrize("kind", [DualRaceWheel, TripleRaceWheel])
def test_worst_of_many_states_is_the_worst_of_all(kind, elevation_deg):
    """Nine wheels, 512 states: beyond what ``check`` lists, so the search has to find it."""
    wheel = kind(radius=0.025, rollers=18, roller_radius=4.85e-3, race_spacing=0.02)
    design = atlas(wheel, elevation_deg, count=9)
    assert ranked(K.worst_contact_state(design)) == min(map(ranked, K.contact_states(design)))


@pytest.mark.parametrize("sign", [1, -1])
def test_singular_state_among_sixteen_million_is_found(sign):
    """24 dual-race wheels at an elevation of ± Δθ: where all show the race at the equator, every row is along z."""
    wheel = DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=0.05)
    elevation = sign * np.degrees(wheel.races(0.15)[1].deflection(0.15))
    design = atlas(wheel, elevation, count=24)
    assert K.count_contact_states(design) == 2**24
    assert K.worst_contact_state(design).isotropy < 1e-12
    assert "singular-state" in {finding.code for finding in check(design).findings}
