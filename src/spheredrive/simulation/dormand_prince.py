"""Dormand and Prince's pair of orders 5 and 4 with its free interpolant, as data and as compiled steps.

Increments hk, the step times the rates, are kept instead of rates: a step over many runs side by side, each with a step of
its own, is then a sum of blocks.

Sources: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19; the interpolant: Hairer, Nørsett and Wanner,
*Solving Ordinary Differential Equations I*, section II.6.
"""

from __future__ import annotations

import numpy as np

from spheredrive.compiled import inlined, kernel

STAGES = 7
# Nodes of the stages: where in the step each is taken.
C = np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1])
# Tuples are constants to the compiler, arrays are not.
A = (
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
# Fifth-order result less the fourth-order one.
E = (71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
# Coefficients of the θ⁴ term in the interpolant.
D = (
    -12715105075 / 11282082432,
    0,
    87487479700 / 32700410799,
    -10690763975 / 1880347072,
    701980252875 / 199316789632,
    -1453857185 / 822651844,
    69997945 / 29380423,
)


@inlined
def stage_state(room, stage, y, goal, k, block, size):
    """y + Σ a_ij hk_j: where the ``stage``-th stage is taken; the last one is the step's result.

    ``y``, ``goal`` and ``k`` are places in ``room``, the stages' increments stand ``block`` apart. Written out stage by stage,
    so that each sum is one pass of vector instructions.
    """
    if stage == 1:
        for i in range(size):
            room[goal + i] = room[y + i] + A[1][0] * room[k + i]
    elif stage == 2:
        for i in range(size):
            room[goal + i] = room[y + i] + (A[2][0] * room[k + i] + A[2][1] * room[k + block + i])
    elif stage == 3:
        for i in range(size):
            room[goal + i] = room[y + i] + (
                A[3][0] * room[k + i] + A[3][1] * room[k + block + i] + A[3][2] * room[k + 2 * block + i]
            )
    elif stage == 4:
        for i in range(size):
            room[goal + i] = room[y + i] + (
                A[4][0] * room[k + i] + A[4][1] * room[k + block + i]
                + A[4][2] * room[k + 2 * block + i] + A[4][3] * room[k + 3 * block + i]
            )  # fmt: skip
    elif stage == 5:
        for i in range(size):
            room[goal + i] = room[y + i] + (
                A[5][0] * room[k + i] + A[5][1] * room[k + block + i] + A[5][2] * room[k + 2 * block + i]
                + A[5][3] * room[k + 3 * block + i] + A[5][4] * room[k + 4 * block + i]
            )  # fmt: skip
    else:
        for i in range(size):
            room[goal + i] = room[y + i] + (
                A[6][0] * room[k + i] + A[6][2] * room[k + 2 * block + i] + A[6][3] * room[k + 3 * block + i]
                + A[6][4] * room[k + 4 * block + i] + A[6][5] * room[k + 5 * block + i]
            )  # fmt: skip


@inlined
def step_error(room, goal, k, block, size):
    """Fifth-order result less the fourth-order one, into ``room`` from ``goal`` on."""
    for i in range(size):
        room[goal + i] = (
            E[0] * room[k + i] + E[2] * room[k + 2 * block + i] + E[3] * room[k + 3 * block + i]
            + E[4] * room[k + 4 * block + i] + E[5] * room[k + 5 * block + i] + E[6] * room[k + 6 * block + i]
        )  # fmt: skip


@kernel
def interpolate(y, y_new, k, theta, out):
    """State inside a step, at the share ``theta`` of it, to fourth order; ``k`` holds the increments hk, (7, size)."""
    for i in range(y.size):
        out[i] = interpolated(y[i], y_new[i], k, theta, i)


@kernel
def interpolated(y, y_new, k, theta, i):
    """The ``i``-th component inside a step, at the share ``theta`` of it."""
    change = y_new - y
    bend = k[0, i] - change
    curve = change - k[6, i] - bend
    quartic = D[0] * k[0, i] + D[2] * k[2, i] + D[3] * k[3, i] + D[4] * k[4, i] + D[5] * k[5, i] + D[6] * k[6, i]
    rest = 1.0 - theta
    return y + theta * (change + rest * (bend + theta * (curve + rest * quartic)))
