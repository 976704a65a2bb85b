"""The compiled kernels against LAPACK and against matrices made with known singular values."""

import numpy as np
import pytest

from spheredrive import kinematics as K
from spheredrive.kinematics.kernels import LANES, PIECE, apply_matrix, condition_number_3x3

EPS = np.finfo(float).eps


def made(rng, sigma, count=500):
    """Matrices U diag(σ) Vᵀ with random orthogonal U and V."""
    left, right = (np.linalg.qr(rng.normal(size=(count, 3, 3)))[0] for _ in range(2))
    return left * np.asarray(sigma) @ right


@pytest.mark.parametrize(
    "sigma",
    [
        (1, 1, 1), (1, 1, 0.5), (1, 0.5, 0.5), (3, 2, 1), (1, 1 - 1e-9, 1 - 2e-9), (1, 1e-4, 1e-4), (1, 1, 1e-7),
        (1, 1e-5, 1.0000001e-5), (1, 1e-8, 1e-11), (1e12, 1e8, 1e3), (1e-12, 1e-13, 1e-14), (1e200, 1e199, 1e199),
        (1e-200, 1e-201, 1e-203),
    ],
)  # fmt: skip
def test_condition_numbers_of_made_matrices_are_found_to_rounding(rng, sigma):
    # Each entry of the made matrix is rounded to ε σ₁, which changes σ₃ by ε κ of itself: 40 ε κ with room.
    expected = max(sigma) / min(sigma)
    np.testing.assert_allclose(condition_number_3x3(made(rng, sigma)), expected, rtol=40 * EPS * expected)


def test_condition_numbers_of_random_matrices_match_lapack(rng):
    A = rng.normal(size=(20_000, 3, 3))
    reference = np.linalg.cond(A)
    # σ₃ carries a relative error of a few ε κ, in LAPACK as here.
    assert (np.abs(condition_number_3x3(A) / reference - 1) < 20 * EPS * reference).all()


@pytest.mark.parametrize("sigma", [(1, 1, 0), (1, 0, 0), (0, 0, 0), (1, 1, 1e-13)])
def test_singular_matrices_have_infinite_condition(rng, sigma):
    A = made(rng, sigma)
    assert np.isinf(condition_number_3x3(A)).all()
    np.testing.assert_array_equal(K.singular_values(A)[:, 2], 0)


@pytest.mark.parametrize("rows", [1, 2, 3, 4, 6, 11])
def test_singular_values_take_any_number_of_rows(rng, rows):
    A = rng.normal(size=(5, 4, rows, 3))
    expected = np.zeros((5, 4, 3))
    expected[..., : min(rows, 3)] = np.linalg.svd(A, compute_uv=False)
    np.testing.assert_allclose(K.singular_values(A), expected, atol=1e-13)
    kappa = np.full((5, 4), np.inf) if rows < 3 else expected[..., 0] / expected[..., 2]
    np.testing.assert_allclose(K.condition_number(A), kappa, rtol=1e-11)


def test_results_do_not_depend_on_neighbours_or_threads(rng):
    """Ill-conditioned, huge and singular neighbours share vector lanes and pieces with the rest."""
    A = rng.normal(size=(PIECE + 3 * LANES + 7, 3, 3))
    A[::5] = made(rng, (1, 1e-9, 1e-11), len(A[::5]))
    A[::7] *= 1e150
    A[::11, :, 2] = A[::11, :, 1]
    whole = condition_number_3x3(A)
    for i in (0, 1, LANES - 1, LANES, 35, 77, PIECE - 1, PIECE, len(A) - 1):
        np.testing.assert_array_equal(condition_number_3x3(A[i]), whole[i])
    np.testing.assert_array_equal(condition_number_3x3(A[::-1]), whole[::-1])
    np.testing.assert_array_equal(condition_number_3x3(A[: PIECE // 2]), whole[: PIECE // 2])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(9))
def test_entries_that_are_not_finite_are_refused(bad, place):
    A = np.tile(np.eye(3), (50, 1, 1))
    A[17].flat[place] = bad
    for function in (K.singular_values, K.condition_number):
        with pytest.raises(ValueError, match="not finite"):
            function(A)


@pytest.mark.parametrize("shape", [(3, 3), (3, 5), (7, 3), (4, 2)])
@pytest.mark.parametrize("count", [0, 1, PIECE + 5])
def test_apply_matrix_matches_numpy(rng, shape, count):
    M, x = rng.normal(size=shape), rng.normal(size=(count, shape[1]))
    np.testing.assert_allclose(apply_matrix(M, x), x @ M.T, atol=1e-13)


def test_apply_matrix_fills_the_array_it_is_given(rng):
    M, x, out = rng.normal(size=(3, 3)), rng.normal(size=(4, 5, 3)), np.empty((4, 5, 3))
    assert apply_matrix(M, x, out) is out
    np.testing.assert_array_equal(out, apply_matrix(M, x))
    for wrong in (np.empty((4, 5)), np.empty((4, 5, 3), np.float32), np.empty((4, 3, 5)).swapaxes(1, 2), x):
        with pytest.raises(ValueError, match="out must"):
            apply_matrix(M, x, wrong)


def test_kernels_run_as_plain_python(rng):
    """The uncompiled source gives the same bits: nothing rests on what a compiler does to it."""
    from spheredrive.kinematics import kernels

    M, x = rng.normal(size=(3, 3)), rng.normal(size=(40, 3))
    plain = np.empty_like(x)
    kernels._apply_3x3.py_func(M, x, plain)
    np.testing.assert_array_equal(plain, apply_matrix(M, x))
