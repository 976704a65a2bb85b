"""Poles of M q̈ + D q̇ + K q = B_k h + B_c ḣ and what each contributes (compiled).

q follows from states that each obey one scalar equation, w′ = λ w + b · ḣ:

    q = K⁻¹B_k h + Re Σ w V/λ,   q̇ = Re Σ w V,   q̈ = M⁻¹B_c ḣ + Re Σ w λ V

Of a complex pair only the pole of positive imaginary part is kept, its V doubled. Two poles that are close to each other and
share one vector, as at critical damping, are kept linked, w₂′ = λ₂ w₂ + w₁ + b₂ · ḣ, which holds where they are equal; then
q̇ = Re (w₁ V₁ + w₂ V₂) and the others follow from it (see ``output_vectors``).
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.model.small import inverse_factor, product, scaled, size, transposed

# Poles closer than this share of their size are kept linked.
CLOSE = 0.01
# Eigenvectors worse conditioned than this lose too many digits: see ``links``.
ILL = 1e4
# How far from diagonal, as a share of their size, matrices are that share their modes.
SHARED = 1e-12


@njit(error_model="numpy")
def undamped_modes(M, K):
    """ω² (d,) rising and the modes (d, d), columns with φᵀMφ = 1."""
    X = inverse_factor(M)
    squared, turn = np.linalg.eigh(scaled(X, K))
    return squared, product(transposed(X), turn)


@njit(error_model="numpy")
def modal_form(M, D, K, Bk, Bc):
    """Poles λ (R,), link (R,), b (R, m), V (d, R) and the worst condition of an eigenvector; 1 where none was needed.

    D and K that share their modes (classical damping) give one scalar oscillator a mode, poles by the quadratic formula. All
    else goes through the eigenvectors of the companion matrix, in variables scaled by mass and by the stiffest spring; beyond
    ``ILL`` their poles must be linked by ``links.linked_form``.
    """
    X = inverse_factor(M)
    K_, D_, bk, bc = scaled(X, K), scaled(X, D), product(X, Bk), product(X, Bc)
    k, c = size(K_), size(D_)
    # An uneven mixture has the modes of both wherever both share them, also where one of them alone has equal values.
    mixed = K_.copy()
    if c > 0:
        for i in range(K_.shape[0]):
            for j in range(K_.shape[0]):
                mixed[i, j] = K_[i, j] / k + 0.37 * D_[i, j] / c
    _, turn = np.linalg.eigh(mixed)
    back = transposed(turn)
    K_turned, D_turned = scaled(back, K_), scaled(back, D_)
    apart = 0.0
    for i in range(K_.shape[0]):
        for j in range(i):
            apart = max(apart, abs(K_turned[i, j]) / k, abs(D_turned[i, j]) / c if c > 0 else 0.0)
    if apart <= SHARED:
        modes = product(transposed(X), turn)
        lam, link, b, V = _oscillators(K_turned, D_turned, product(back, bk), product(back, bc), modes)
        return lam, link, b, V, 1.0
    return _companion(K_, D_, bk, bc, transposed(X))


@njit(error_model="numpy")
def _oscillators(K, D, bk, bc, modes):
    """One oscillator η̈ + d η̇ + k η = b_k h + b_c ḣ a mode, k and d on the diagonals."""
    d, m = bk.shape
    lam, link, b = np.zeros(2 * d, np.complex128), np.zeros(2 * d, np.int64), np.zeros((2 * d, m), np.complex128)
    V = np.zeros((d, 2 * d), np.complex128)
    R = 0
    for i in range(d):
        half = 0.5 * D[i, i]
        spread = half * half - K[i, i]
        root = math.sqrt(abs(spread))
        if root < CLOSE * half:
            nu = complex(0.0, root) if spread < 0 else complex(root, 0.0)
            lam[R], lam[R + 1], link[R + 1] = -half - nu, -half + nu, 1
            for j in range(m):
                b[R, j], b[R + 1, j] = bk[i, j] + lam[R] * bc[i, j], bc[i, j]
            for j in range(d):
                V[j, R + 1] = modes[j, i]
            R += 2
        elif spread < 0:
            lam[R] = complex(-half, root)
            for j in range(m):
                b[R, j] = (bk[i, j] + lam[R] * bc[i, j]) / complex(0.0, 2.0 * root)
            for j in range(d):
                V[j, R] = 2.0 * modes[j, i]
            R += 1
        else:
            # The slow pole by the product of the two: their sum has no digits left for it.
            quick = -half - root
            slow = K[i, i] / quick
            for s in range(2):
                own, other = (quick, slow) if s == 0 else (slow, quick)
                lam[R] = own
                for j in range(m):
                    b[R, j] = (bk[i, j] + own * bc[i, j]) / (own - other)
                for j in range(d):
                    V[j, R] = modes[j, i]
                R += 1
    return lam[:R].copy(), link[:R].copy(), b[:R].copy(), V[:, :R].copy()


@njit(error_model="numpy")
def _companion(K, D, bk, bc, back):
    """The general case with mass-scaled matrices; ``back`` turns into the coordinates asked for."""
    d, m = bk.shape
    f = 1.0 / math.sqrt(size(K))
    A = np.zeros((2 * d, 2 * d), np.complex128)
    for i in range(d):
        A[i, d + i] = 1.0
        for j in range(d):
            A[d + i, j], A[d + i, d + j] = -K[i, j] * f * f, -D[i, j] * f
    values, vectors = np.linalg.eig(A)
    inverse = np.linalg.inv(vectors)
    worst, norm = 1.0, 1.0 + size(D) * f
    condition = np.zeros(2 * d)
    for r in range(2 * d):
        for j in range(2 * d):
            condition[r] += abs(inverse[r, j]) ** 2
        condition[r] = math.sqrt(condition[r])
        worst = condition[r] if not condition[r] < worst else worst
        # Real poles come with an imaginary part of rounding.
        if abs(values[r].imag) <= 1e-14 * norm * condition[r]:
            values[r] = values[r].real
    if worst < ILL:
        for _ in range(2):
            inverse = _sharpened(A, values, vectors, inverse)
    lam, b, V = np.zeros(2 * d, np.complex128), np.zeros((2 * d, m), np.complex128), np.zeros((d, 2 * d), np.complex128)
    R = 0
    for r in range(2 * d):
        if values[r].imag < 0:
            continue
        lam[R] = values[r] / f
        share = 1.0 if values[r].imag == 0 else 2.0
        for i in range(d):
            # By the pencil's left vector: the companion's own product would be a difference of large numbers.
            for j in range(m):
                b[R, j] += inverse[r, d + i] * (f * bk[i, j] + values[r] * bc[i, j])
            for j in range(d):
                V[j, R] += share * back[j, i] * vectors[i, r]
        R += 1
    return lam[:R].copy(), np.zeros(R, np.int64), b[:R].copy(), V[:, :R].copy(), worst


@njit(error_model="numpy")
def _sharpened(A, values, vectors, inverse):
    """Improve eigenvalues and vectors in place by one step of Newton; returns the new inverse.

    The residual is that of the quadratic pencil, (λ² + λ D + K) ψ with vectors (ψ, λ ψ): slow poles of a stiffly damped machine
    then keep their digits, which the companion matrix loses in the size of its damping.
    """
    count = values.size
    d = count // 2
    residual, old = np.zeros((d, count), np.complex128), np.zeros((count, count), np.complex128)
    for r in range(count):
        for i in range(d):
            vectors[d + i, r] = values[r] * vectors[i, r]
    inverse = np.linalg.inv(vectors)
    for r in range(count):
        for i in range(d):
            residual[i, r] = -values[r] * vectors[d + i, r]
            for j in range(d):
                residual[i, r] += A[d + i, j] * vectors[j, r] + A[d + i, d + j] * vectors[d + j, r]
        for i in range(count):
            old[i, r] = vectors[i, r]
    shift = np.zeros(count, np.complex128)
    for r in range(count):
        for s in range(count):
            error = 0j
            for i in range(d):
                error += inverse[s, d + i] * residual[i, r]
            if s == r:
                shift[r] = error
                continue
            gap = values[r] - values[s]
            # Vectors of one pole, met twice, need no turning against each other.
            if abs(gap) > 1e-6 * abs(values[r]):
                for i in range(d):
                    vectors[i, r] += old[i, s] * (error / gap)
    for r in range(count):
        values[r] += shift[r].real if values[r].imag == 0 else shift[r]
        for i in range(d):
            vectors[d + i, r] = values[r] * vectors[i, r]
    return np.linalg.inv(vectors)


@njit(error_model="numpy")
def output_vectors(lam, link, V):
    """What the states give to q and q̈, (d, R) each; V is what they give to q̇."""
    d, R = V.shape
    Vq, Va = np.zeros((d, R), np.complex128), np.zeros((d, R), np.complex128)
    for r in range(R):
        leads = r + 1 < R and link[r + 1] == 1
        for j in range(d):
            after = V[j, r + 1] if leads else 0j
            Vq[j, r] = V[j, r] / lam[r] - (after / (lam[r] * lam[r + 1]) if leads else 0j)
            Va[j, r] = V[j, r] * lam[r] + after
    return Vq, Va
