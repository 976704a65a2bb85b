"""Compiled batch kernels: one small matrix on many vectors, condition numbers of many 3x3 matrices, chains of rotations.

Every sample is worked out alone and in the same order of operations, so results do not depend on the size of the batch
or on the number of threads.
"""

from __future__ import annotations

import math

import numpy as np
from numba import float32, float64, prange

from spheredrive.compiled import njit
from spheredrive.kinematics.quality import SINGULAR

# Samples a thread takes at a time; below one such piece no threads are started.
PIECE = 32_768
# Matrices that are worked on side by side, so that the compiler can use the widest vector instructions. The steps of a sweep
# are inlined for the same reason: called as functions, each would first ask whether its columns overlap in memory.
LANES = 32


def apply_matrix(matrix, vectors: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
    """y = M x for every x in ``vectors``: (p, q), (..., q) → (..., p). ``out`` is filled where given.

    Plain sums in index order, so a result's bits do not depend on its neighbours. Raises ``ValueError`` for an ``out`` of
    another shape, type or layout.
    """
    matrix = np.ascontiguousarray(matrix, dtype=float)
    p, q = matrix.shape
    shape = (*vectors.shape[:-1], p)
    if out is None:
        out = np.empty(shape)
    elif out.shape != shape or out.dtype != np.float64 or not out.flags.c_contiguous:
        raise ValueError(f"out must be a C-contiguous array of float64 and shape {shape}")
    elif np.may_share_memory(out, vectors):
        raise ValueError("out must not share memory with the input")
    flat, result = vectors.reshape(-1, q), out.reshape(-1, p)
    if len(flat) <= PIECE:
        kernel = _apply_3x3 if p == q == 3 else _apply
    else:
        kernel = _apply_3x3_threads if p == q == 3 else _apply_threads
    kernel(matrix, flat, result)
    return out


@njit()
def _apply_3x3(M, x, y):
    m00, m01, m02 = M[0, 0], M[0, 1], M[0, 2]
    m10, m11, m12 = M[1, 0], M[1, 1], M[1, 2]
    m20, m21, m22 = M[2, 0], M[2, 1], M[2, 2]
    for i in range(x.shape[0]):
        a, b, c = x[i, 0], x[i, 1], x[i, 2]
        y[i, 0] = m00 * a + m01 * b + m02 * c
        y[i, 1] = m10 * a + m11 * b + m12 * c
        y[i, 2] = m20 * a + m21 * b + m22 * c


@njit()
def _apply(M, x, y):
    for i in range(x.shape[0]):
        for j in range(M.shape[0]):
            total = M[j, 0] * x[i, 0]
            for k in range(1, M.shape[1]):
                total += M[j, k] * x[i, k]
            y[i, j] = total


@njit(parallel=True)
def _apply_3x3_threads(M, x, y):
    pieces = (x.shape[0] + PIECE - 1) // PIECE
    for piece in prange(pieces):
        first, last = piece * PIECE, min((piece + 1) * PIECE, x.shape[0])
        _apply_3x3(M, x[first:last], y[first:last])


@njit(parallel=True)
def _apply_threads(M, x, y):
    pieces = (x.shape[0] + PIECE - 1) // PIECE
    for piece in prange(pieces):
        first, last = piece * PIECE, min((piece + 1) * PIECE, x.shape[0])
        _apply(M, x[first:last], y[first:last])


def condition_number_3x3(A) -> np.ndarray:
    """σ₁ / σ₃ of real 3x3 matrices, (..., 3, 3) → (...), by one-sided Jacobi rotations of the columns.

    The relative error is a few ε times the condition number, as the entries' own rounding makes it; clustered values are no
    harder. inf where σ₃ is below ``SINGULAR`` σ₁; entries that are not finite give NaN. Source: Demmel and Veselić, SIAM J.
    Matrix Anal. Appl. 13 (1992) 1204.
    """
    A = np.ascontiguousarray(A, dtype=float)
    flat = A.reshape(-1, 3, 3)
    out = np.empty(len(flat))
    (_condition_number if len(flat) <= PIECE else _condition_number_threads)(flat, out)
    return out.reshape(A.shape[:-2])


@njit(parallel=True, error_model="numpy")
def _condition_number_threads(A, out):
    pieces = (A.shape[0] + PIECE - 1) // PIECE
    for piece in prange(pieces):
        first, last = piece * PIECE, min((piece + 1) * PIECE, A.shape[0])
        _condition_number(A[first:last], out[first:last])


@njit(error_model="numpy")
def _condition_number(A, out):
    x, sigma = _workspace()
    for first in range(0, A.shape[0], LANES):
        lanes = min(LANES, A.shape[0] - first)
        _solve(A, first, lanes, x, sigma)
        for lane in range(lanes):
            out[first + lane] = sigma[0, lane] / sigma[2, lane] if sigma[2, lane] != 0.0 else np.inf


@njit(error_model="numpy", inline="always")
def _workspace():
    """Room for the columns (column, row, lane) and singular values (3, lane) of LANES matrices.

    It begins on a 64-byte line: vector loads across lines made the whole kernel a third slower.
    """
    room = np.zeros(12 * LANES + 8)
    skip = (-(room.ctypes.data // 8)) % 8
    x = room[skip : skip + 9 * LANES].reshape((3, 3, LANES))
    sigma = room[skip + 9 * LANES : skip + 12 * LANES].reshape((3, LANES))
    return x, sigma


@njit(error_model="numpy")
def _solve(A, first, lanes, x, sigma):
    """Singular values of A[first : first + lanes] into ``sigma`` (3, LANES); ``x`` is room to work in."""
    for lane in range(lanes):
        for i in range(3):
            for j in range(3):
                x[j, i, lane] = A[first + lane, i, j]
    for _ in range(4):
        _sweep(x)
    _lengths(x, sigma)
    if _count_unfinished(x, 0, LANES) > 0:
        # Each of these is done again by itself, so that no matrix is touched by what another one needs.
        for lane in range(lanes):
            if _count_unfinished(x, lane, lane + 1) > 0:
                _solve_one(A[first + lane], sigma[:, lane])
    _order(sigma)


@njit(error_model="numpy", inline="always")
def _sweep(x):
    _rotate(x, 0, 1)
    _rotate(x, 0, 2)
    _rotate(x, 1, 2)


@njit(error_model="numpy", inline="always")
def _rotate(x, p, q):
    """Turn columns p and q of every lane in their plane until they are orthogonal, the longer one first."""
    p0, p1, p2 = x[p, 0], x[p, 1], x[p, 2]
    q0, q1, q2 = x[q, 0], x[q, 1], x[q, 2]
    for lane in range(LANES):
        a0, a1, a2, b0, b1, b2 = p0[lane], p1[lane], p2[lane], q0[lane], q1[lane], q2[lane]
        overlap = a0 * b0 + a1 * b1 + a2 * b2
        # |a|² − |b|² as one product keeps its digits where the two are nearly equal.
        excess = (a0 - b0) * (a0 + b0) + (a1 - b1) * (a1 + b1) + (a2 - b2) * (a2 + b2)
        c, s = _rotation(excess, overlap)
        p0[lane], p1[lane], p2[lane] = c * a0 + s * b0, c * a1 + s * b1, c * a2 + s * b2
        q0[lane], q1[lane], q2[lane] = c * b0 - s * a0, c * b1 - s * a1, c * b2 - s * a2


@njit(error_model="numpy", inline="always")
def _rotation(excess, overlap):
    """Cosine and sine that diagonalise [[excess, overlap], [overlap, 0]], the larger value first.

    The angle is found in single precision, which costs a sweep none of its convergence; the pair is then brought back to
    unit length in double precision, so that the rotation is orthogonal to the last digit.
    """
    h, g = float32(excess), float32(overlap)
    square = h * h + float32(4) * g * g
    tiny = square < float32(1e-34)
    w = math.sqrt(float32(1) if tiny else square)
    large = math.sqrt(float32(0.5) + float32(0.5) * abs(h) / w)
    small = g / (w * large)
    hand = float32(1) if g >= float32(0) else float32(-1)
    c = large if h >= float32(0) else small * hand
    s = small if h >= float32(0) else large * hand
    c, s = float64(float32(1) if tiny else c), float64(float32(0) if tiny else s)
    too_long = c * c + s * s - 1.0
    correction = 1.0 + too_long * (-0.5 + 0.375 * too_long)
    return c * correction, s * correction


@njit(error_model="numpy")
def _lengths(x, sigma):
    for k in range(3):
        x0, x1, x2, length = x[k, 0], x[k, 1], x[k, 2], sigma[k]
        for lane in range(LANES):
            length[lane] = math.sqrt(x0[lane] * x0[lane] + x1[lane] * x1[lane] + x2[lane] * x2[lane])


@njit(error_model="numpy")
def _count_unfinished(x, first, last):
    """In how many lanes the columns still overlap so far that it matters, or are too large or small for the sweeps.

    An overlap g takes the share g²/(|a||b|)² off the square of the shorter column b. Enough is 1e-16 |a|/|b|, the share
    that rounding of the longer column takes anyway.
    """
    a0, a1, a2, b0, b1, b2, c0, c1, c2 = (
        x[0, 0], x[0, 1], x[0, 2], x[1, 0], x[1, 1], x[1, 2], x[2, 0], x[2, 1], x[2, 2],
    )  # fmt: skip
    count = 0
    for lane in range(first, last):
        aa = a0[lane] * a0[lane] + a1[lane] * a1[lane] + a2[lane] * a2[lane]
        bb = b0[lane] * b0[lane] + b1[lane] * b1[lane] + b2[lane] * b2[lane]
        cc = c0[lane] * c0[lane] + c1[lane] * c1[lane] + c2[lane] * c2[lane]
        ab = a0[lane] * b0[lane] + a1[lane] * b1[lane] + a2[lane] * b2[lane]
        ac = a0[lane] * c0[lane] + a1[lane] * c1[lane] + a2[lane] * c2[lane]
        bc = b0[lane] * c0[lane] + b1[lane] * c1[lane] + b2[lane] * c2[lane]
        ab, ac, bc = ab * ab, ac * ac, bc * bc
        fine = (
            (ab * ab <= 1e-32 * (aa * aa) * (aa * bb))
            & (ac * ac <= 1e-32 * (aa * aa) * (aa * cc))
            & (bc * bc <= 1e-32 * (bb * bb) * (bb * cc))
            & (aa > 1e-12)
            & (aa < 1e12)
        )
        count += 0 if fine else 1
    return count


@njit(error_model="numpy")
def _solve_one(matrix, sigma):
    """Jacobi sweeps of one matrix in double precision throughout, for entries of any size."""
    size = 0.0
    for i in range(3):
        for j in range(3):
            size = max(size, abs(matrix[i, j]))
    if not 0.0 < size < np.inf:
        sigma[:] = 0.0 if size == 0.0 else np.nan
        return
    columns = matrix.T / size
    for _ in range(30):
        turned = False
        for p in range(2):
            for q in range(p + 1, 3):
                a, b = columns[p], columns[q]
                long = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
                short = b[0] * b[0] + b[1] * b[1] + b[2] * b[2]
                overlap = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
                if short <= long and abs(overlap) <= 1e-16 * math.sqrt(long) * math.sqrt(short):
                    continue
                turned = True
                half = 0.5 * math.atan2(2.0 * overlap, long - short)
                c, s = math.cos(half), math.sin(half)
                for i in range(3):
                    a[i], b[i] = c * a[i] + s * b[i], c * b[i] - s * a[i]
        if not turned:
            break
    for k in range(3):
        sigma[k] = size * math.sqrt(columns[k, 0] ** 2 + columns[k, 1] ** 2 + columns[k, 2] ** 2)


@njit(error_model="numpy")
def _order(sigma):
    """Put each lane's values in falling order, which rounding can upset, and make the negligible ones zero."""
    s0, s1, s2 = sigma[0], sigma[1], sigma[2]
    for lane in range(LANES):
        a, b, c = s0[lane], s1[lane], s2[lane]
        # NaN must come through the comparisons.
        spoilt = 0.0 * (a + b + c)
        a, b = (a, b) if a >= b else (b, a)
        b, c = (b, c) if b >= c else (c, b)
        a, b = (a, b) if a >= b else (b, a)
        s0[lane] = a + spoilt
        s1[lane] = (b if b >= SINGULAR * a else 0.0) + spoilt
        s2[lane] = (c if c >= SINGULAR * a else 0.0) + spoilt


@njit()
def compose_rotations(steps, orientation):
    """orientation[i + 1] = steps[i] ∘ orientation[i], kept at unit length."""
    for i in range(steps.shape[0]):
        pw, px, py, pz = steps[i, 0], steps[i, 1], steps[i, 2], steps[i, 3]
        qw, qx, qy, qz = orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3]
        w = pw * qw - px * qx - py * qy - pz * qz
        x = pw * qx + px * qw + py * qz - pz * qy
        y = pw * qy - px * qz + py * qw + pz * qx
        z = pw * qz + px * qy - py * qx + pz * qw
        length = np.sqrt(w * w + x * x + y * y + z * z)
        orientation[i + 1, 0], orientation[i + 1, 1] = w / length, x / length
        orientation[i + 1, 2], orientation[i + 1, 3] = y / length, z / length
