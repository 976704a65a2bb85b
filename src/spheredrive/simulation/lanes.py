"""Several runs side by side: one step of each, tried together with vector instructions.

A lane holds what one run's step needs, all numbers of one kind beside each other, so that each operation works on
``LANES`` runs at once. Which runs are in the other lanes changes no bit of a result: every lane goes through the same
operations. The wheels' angles are no part of it, for their rates are rows times Ω: the lane integrates ∫Ω dt instead, and
so is equally long for any number of wheels.
"""

from __future__ import annotations

import numpy as np

from spheredrive.compiled import inlined, kernel, njit
from spheredrive.dynamics.algebra import add, dot, quaternion_rate
from spheredrive.dynamics.rolling import driven
from spheredrive.simulation.dormand_prince import STAGES, stage_state, step_error

LANES = 8
# State of a lane: that of ``dynamics.rolling`` up to its ledger, then ∫Ω dt since the step's beginning.
TURN, SIZE = 16, 19
# So much of it the equations look at: Ω, quaternion, velocity of the stage.
LOOKED_AT = 10

# Places of rows in a lane's room: the machine; its drive at the beginning of the piece and by the second; time since then;
# rates at the step's beginning and the step length, once for each of them; the step's beginning, end, increments and error;
# 1 while every stage has had a solution, else 0. What ``driven_rates`` writes comes last, a stage's rates and whether they
# solve the equations: the compiler then sees at a glance that it is apart from all that is read.
# All of them NumPy's numbers: of Python's, Numba would compile the functions that are handed them for each anew.
OWN, FELT, OFFSET, MASS, MOVING, STAGE_SHARE, GRAVITY = np.array((0, 6, 12, 15, 16, 17, 18))
MOMENT, MOMENT_SLOPE, PUSH, PUSH_SLOPE, TIME = np.array((21, 24, 27, 30, 33))
FIRST_RATE, STEP, Y, Y_NEW, K = np.array((34, 53, 72, 91, 110))
ERROR = K + STAGES * SIZE
SOLVED = ERROR + SIZE
RATE, FINE = SOLVED + 1, SOLVED + 1 + SIZE
ROWS = FINE + 1

# Error of a step that is not finite.
ENDLESS = 1e30


@njit(error_model="numpy")
def new_room():
    """Room for ``LANES`` runs, flat; it begins on a 64-byte line, as vector loads across lines are slow."""
    room = np.zeros(ROWS * LANES + 8)
    skip = (-(room.ctypes.data // 8)) % 8
    return room[skip : skip + ROWS * LANES]


@inlined
def get(room, row, lane):
    return room[row * LANES + lane]


@inlined
def put(room, row, lane, value):
    room[row * LANES + lane] = value


@inlined
def _three(room, row, lane):
    return get(room, row, lane), get(room, row + 1, lane), get(room, row + 2, lane)


@inlined
def _six(room, row, lane):
    a, b = _three(room, row, lane), _three(room, row + 3, lane)
    return a[0], a[1], a[2], b[0], b[1], b[2]


@inlined
def _put_three(room, row, lane, a):
    put(room, row, lane, a[0])
    put(room, row + 1, lane, a[1])
    put(room, row + 2, lane, a[2])


@kernel
def driven_rates(room, node):
    """Rates at the share ``node`` of the step for wheels driven by torques, without resistances, in every lane."""
    for lane in range(LANES):
        t = get(room, TIME, lane) + node * get(room, STEP, lane)
        moment = add(_three(room, MOMENT, lane), t, _three(room, MOMENT_SLOPE, lane))
        push = add(_three(room, PUSH, lane), t, _three(room, PUSH_SLOPE, lane))
        Omega, v = _three(room, Y_NEW, lane), _three(room, Y_NEW + 7, lane)
        w, u = get(room, Y_NEW + 3, lane), _three(room, Y_NEW + 4, lane)
        q = (w, u[0], u[1], u[2])
        x, p_rate, motors, stage, fine = driven(
            _six(room, OWN, lane), _three(room, OFFSET, lane), _six(room, FELT, lane), get(room, MASS, lane),
            get(room, MOVING, lane), get(room, STAGE_SHARE, lane), _three(room, GRAVITY, lane), push, moment, Omega, q, v,
        )  # fmt: skip
        turning = quaternion_rate(Omega, q)
        _put_three(room, RATE, lane, x)
        put(room, RATE + 3, lane, turning[0])
        _put_three(room, RATE + 4, lane, (turning[1], turning[2], turning[3]))
        _put_three(room, RATE + 7, lane, p_rate)
        _put_three(room, RATE + 10, lane, v)
        _put_three(room, RATE + 13, lane, (motors, stage, 0.0))
        _put_three(room, RATE + TURN, lane, Omega)
        put(room, FINE, lane, 1.0 if fine else 0.0)


@kernel
def spread_step(room):
    """The step length of each lane, once for each of its rates."""
    for lane in range(LANES):
        h = get(room, STEP, lane)
        for row in (1, 4, 7, 10, 13, 16):
            _put_three(room, STEP + row, lane, (h, h, h))


@kernel
def take(room):
    """The end of the step becomes the beginning of the next one in every lane, its quaternion brought back to unit length.

    A quaternion's rate is linear in it, and so shares its length.
    """
    y, first = Y * LANES, FIRST_RATE * LANES
    for i in range(TURN * LANES):
        room[y + i] = room[Y_NEW * LANES + i]
    for i in range(SIZE * LANES):
        room[first + i] = room[RATE * LANES + i]
    for lane in range(LANES):
        w, u = get(room, Y + 3, lane), _three(room, Y + 4, lane)
        a, b = get(room, FIRST_RATE + 3, lane), _three(room, FIRST_RATE + 4, lane)
        f = 1.0 / np.sqrt(w * w + dot(u, u))
        put(room, Y + 3, lane, f * w)
        put(room, FIRST_RATE + 3, lane, f * a)
        _put_three(room, Y + 4, lane, (f * u[0], f * u[1], f * u[2]))
        _put_three(room, FIRST_RATE + 4, lane, (f * b[0], f * b[1], f * b[2]))


@kernel
def refuse(room, lane):
    """Make a lane's step one of no length, for ``take`` to leave the lane as it was."""
    for i in range(SIZE):
        put(room, RATE + i, lane, get(room, FIRST_RATE + i, lane))
        put(room, Y_NEW + i, lane, get(room, Y + i, lane))


@inlined
def keep_increments(room, stage):
    """hk of the rates just found; of stage 0, of those at the step's beginning."""
    source, goal = (FIRST_RATE if stage == 0 else RATE) * LANES, (K + stage * SIZE) * LANES
    for i in range(SIZE * LANES):
        room[goal + i] = room[STEP * LANES + i] * room[source + i]
    if stage > 0:
        for i in range(LANES):
            room[SOLVED * LANES + i] *= room[FINE * LANES + i]


@kernel
def next_stage(room, stage):
    """The state at which a stage is taken, into the rows of the step's end; the last one is the step's end."""
    size = SIZE if stage == STAGES - 1 else LOOKED_AT
    stage_state(room, stage, Y * LANES, Y_NEW * LANES, K * LANES, SIZE * LANES, size * LANES)


@inlined
def _larger(a, b):
    return a if a > b else b


@kernel
def find_error(room, relative, absolute):
    """Largest error of each lane's step over its tolerance, into the first error row: good below 1.

    A step whose error or end is not finite gets ``ENDLESS``. The error of ∫Ω dt stays as it is, for the wheels' angles.
    """
    e, y, y_new = ERROR * LANES, Y * LANES, Y_NEW * LANES
    step_error(room, e, K * LANES, SIZE * LANES, SIZE * LANES)
    for i in range(TURN * LANES):
        largest = _larger(abs(room[y + i]), abs(room[y_new + i]))
        share = abs(room[e + i]) / (absolute + relative * largest) + 0.0 * room[y_new + i]
        # A comparison with NaN is false.
        room[e + i] = share if share < ENDLESS else ENDLESS
    # Folding in halves leaves the largest of the 16 rows in the first one.
    for i in range(8 * LANES):
        room[e + i] = _larger(room[e + i], room[e + 8 * LANES + i])
    for i in range(4 * LANES):
        room[e + i] = _larger(room[e + i], room[e + 4 * LANES + i])
    for i in range(2 * LANES):
        room[e + i] = _larger(room[e + i], room[e + 2 * LANES + i])
    for i in range(LANES):
        room[e + i] = _larger(room[e + i], room[e + LANES + i])
