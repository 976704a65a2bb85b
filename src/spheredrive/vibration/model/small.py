"""Small dense matrices as plain loops (compiled): sums in index order, so results do not depend on a library's choices."""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit


@njit(error_model="numpy")
def product(A, B):
    """A B, real."""
    out = np.zeros((A.shape[0], B.shape[1]))
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@njit(error_model="numpy")
def transposed(A):
    """Aᵀ, contiguous."""
    out = np.empty((A.shape[1], A.shape[0]))
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[j, i] = A[i, j]
    return out


@njit(error_model="numpy")
def inverse_factor(M):
    """The lower triangular X with X M Xᵀ = 1 of a symmetric positive matrix: the inverse of its Cholesky factor."""
    d = M.shape[0]
    L, X = np.zeros((d, d)), np.zeros((d, d))
    for i in range(d):
        for j in range(i + 1):
            s = M[i, j]
            for k in range(j):
                s -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(s) if i == j else s / L[j, j]
    for j in range(d):
        for i in range(j, d):
            s = 1.0 if i == j else 0.0
            for k in range(j, i):
                s -= L[i, k] * X[k, j]
            X[i, j] = s / L[i, i]
    return X


@njit(error_model="numpy")
def scaled(X, K):
    """X K Xᵀ, symmetric to the last digit."""
    A = product(product(X, K), transposed(X))
    for i in range(A.shape[0]):
        for j in range(i):
            A[i, j] = 0.5 * (A[i, j] + A[j, i])
            A[j, i] = A[i, j]
    return A


@njit(error_model="numpy")
def size(A):
    """Root of the sum of squares."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * A[i, j]
    return math.sqrt(total)


@njit(error_model="numpy")
def solve(A, B):
    """A⁻¹ B of a symmetric positive matrix, in variables scaled by its diagonal; one step of refinement."""
    X = inverse_factor(A)
    first = product(transposed(X), product(X, B))
    rest = product(A, first)
    for i in range(B.shape[0]):
        for j in range(B.shape[1]):
            rest[i, j] = B[i, j] - rest[i, j]
    more = product(transposed(X), product(X, rest))
    for i in range(B.shape[0]):
        for j in range(B.shape[1]):
            first[i, j] += more[i, j]
    return first
