"""Dormand and Prince's pair of orders 5 and 4 with its free interpolant, as data and as three compiled steps.

Sources: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19; the interpolant: Hairer, Nørsett and Wanner,
*Solving Ordinary Differential Equations I*, section II.6.
"""

from __future__ import annotations

import numpy as np

from spheredrive.compiled import njit

STAGES = 7
# Nodes of the stages: where in the step each is taken.
C = np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1])
A = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0],
    ]
)
# Fifth-order result less the fourth-order one.
E = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
# Coefficients of θ⁴-type term in the interpolant.
D = np.array(
    [
        -12715105075 / 11282082432,
        0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        69997945 / 29380423,
    ]
)


@njit(error_model="numpy")
def stage_state(y, k, h, stage, out):
    """y + h Σ a_ij k_j: where the ``stage``-th stage is taken; the last one is the step's result.

    Written out stage by stage, so that each sum is one pass of vector instructions.
    """
    if stage == 1:
        a0 = h * A[1, 0]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i]
    elif stage == 2:
        a0, a1 = h * A[2, 0], h * A[2, 1]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i] + a1 * k[1, i]
    elif stage == 3:
        a0, a1, a2 = h * A[3, 0], h * A[3, 1], h * A[3, 2]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i] + a1 * k[1, i] + a2 * k[2, i]
    elif stage == 4:
        a0, a1, a2, a3 = h * A[4, 0], h * A[4, 1], h * A[4, 2], h * A[4, 3]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i] + a1 * k[1, i] + a2 * k[2, i] + a3 * k[3, i]
    elif stage == 5:
        a0, a1, a2, a3, a4 = h * A[5, 0], h * A[5, 1], h * A[5, 2], h * A[5, 3], h * A[5, 4]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i] + a1 * k[1, i] + a2 * k[2, i] + a3 * k[3, i] + a4 * k[4, i]
    else:
        a0, a2, a3, a4, a5 = h * A[6, 0], h * A[6, 2], h * A[6, 3], h * A[6, 4], h * A[6, 5]
        for i in range(y.size):
            out[i] = y[i] + a0 * k[0, i] + a2 * k[2, i] + a3 * k[3, i] + a4 * k[4, i] + a5 * k[5, i]


@njit(error_model="numpy")
def error_norm(y, y_new, k, h, rtol, atol):
    """Largest error of the step over its tolerance atol + rtol |y|; a step is good below 1, NaN never is."""
    worst, total = 0.0, 0.0
    e0, e2, e3, e4, e5, e6 = h * E[0], h * E[2], h * E[3], h * E[4], h * E[5], h * E[6]
    for i in range(y.size):
        error = e0 * k[0, i] + e2 * k[2, i] + e3 * k[3, i] + e4 * k[4, i] + e5 * k[5, i] + e6 * k[6, i]
        share = abs(error) / (atol[i] + rtol * max(abs(y[i]), abs(y_new[i])))
        worst = max(worst, share)
        total += share
    # A comparison with NaN is false, so the largest alone could miss it.
    return worst if total == total else total


@njit(error_model="numpy")
def interpolate(y, y_new, k, h, theta, out):
    """State inside a step, at the share ``theta`` of it, to fourth order."""
    for i in range(y.size):
        out[i] = interpolated(y[i], y_new[i], k, h, theta, i)


@njit(error_model="numpy")
def interpolated(y, y_new, k, h, theta, i):
    """The ``i``-th component inside a step, at the share ``theta`` of it."""
    change = y_new - y
    bend = h * k[0, i] - change
    curve = change - h * k[6, i] - bend
    quartic = 0.0
    for j in range(STAGES):
        quartic += D[j] * k[j, i]
    rest = 1.0 - theta
    return y + theta * (change + rest * (bend + theta * (curve + rest * h * quartic)))
