"""The rolling model in time: adaptive steps that end at corners of the inputs and at changes of race.

A change of race is found by counting half roller pitches, never by a root of the wheel's shape: each wheel carries the
number of its half pitch, and a step that leaves it ends on the boundary, by its own interpolant.

Steps of several runs are tried side by side (``simulation.lanes``). What happens seldom, the corner of an input, a change
of race, a sample, is done for one run at a time. Arrays go about in named tuples; where references are counted, in what makes
arrays, each look into one costs two counts, so what every step does is given plain arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import prange

from spheredrive.compiled import inlined, kernel, njit
from spheredrive.dynamics.rolling import (
    ANGLE,
    HALF_PITCH,
    MOVING_MASS,
    OMEGA,
    ORIENTATION,
    PHASE,
    RESTING,
    ROOM,
    SHARE,
    SPHERE_MASS,
    TORQUE,
    WEIGHT,
    WHEEL_SPEED,
    energy,
    enter_state,
    impact,
    rates,
    resists,
    solve,
    stage_push,
    stage_share,
    turned_body,
)
from spheredrive.dynamics.rolling import OFFSET as BODY_OFFSET
from spheredrive.simulation import lanes as L
from spheredrive.simulation.dormand_prince import STAGES, C, interpolate, interpolated
from spheredrive.simulation.lanes import LANES, SIZE, get, put

# How a run ended, or why it stopped.
DONE, RUNNING, NO_SOLUTION, STEP_TOO_SMALL, CHATTER, EVENTS_FULL, NOT_FINITE = 0, 1, 2, 3, 4, 5, 6
# Attention to a run whose own arrays are newer than its lane.
FRESH = 2
# A step that is good, but has samples or a boundary in it.
CARE = 10

# A race is changed when the wheel is this close to its boundary, rad.
AT_BOUNDARY = 1e-12
MOST_EVENTS_AT_ONCE = 100
# Room for events that a run may need before it looks for room again.
EVENTS_AT_ONCE = 3
# Runs that one thread works on before it takes the next ones.
RUNS_AT_ONCE = 32

# Places in ``clock``: time, step, 1 once the first piece is entered, 1 while ``rate`` belongs to the state.
TIME, STEP, STARTED, RATE_KNOWN = 0, 1, 2, 3
# Places in ``counters``.
SAMPLE, PIECE, EVENT, STEPS, REFUSED, STUCK = 0, 1, 2, 3, 4, 5
# Places in ``control``.
RELATIVE, ABSOLUTE, LARGEST_STEP, FIXED_STEP = 0, 1, 2, 3


class Machine(NamedTuple):
    """The design, as in ``dynamics.parameters.RollingParameters``."""

    body: np.ndarray
    contacts: np.ndarray
    wheels: np.ndarray


class Task(NamedTuple):
    """What is asked: drive and stage kind; the pieces of ``inputs_of``; sample times from 0 on, s; rtol, atol, largest step,
    fixed step (0: adaptive)."""

    kinds: np.ndarray
    pieces: np.ndarray
    samples: np.ndarray
    control: np.ndarray


class Progress(NamedTuple):
    """How far a run is; a later call goes on from it.

    y          state vector, see ``dynamics.rolling``; ``rate`` that of a lane, see ``simulation.lanes``
    pitch      number of the half pitch that each wheel is in, (n,)
    resting    1 for a wheel that rests on the upper boundary of that half pitch, between its races, (n,)
    clock      see the places above
    counters   next sample, piece, events, steps taken, steps refused, events without progress
    """

    y: np.ndarray
    rate: np.ndarray
    pitch: np.ndarray
    resting: np.ndarray
    clock: np.ndarray
    counters: np.ndarray


class Record(NamedTuple):
    """What is written down: state vector, ``solve``'s results and contact states at every sample; events one a row, as time,
    wheel (from 0; −1 for a step of the input), energy lost, change of the sphere's moment of momentum."""

    sampled: np.ndarray
    results: np.ndarray
    states: np.ndarray
    events: np.ndarray


class Work(NamedTuple):
    """Room to work in: increments of a step, states inside and at its end, inputs and results at an instant, contact states
    before an event, rates of a lane; a lane's own contact states and what follows from them."""

    k: np.ndarray
    trial: np.ndarray
    y_new: np.ndarray
    drive: np.ndarray
    slope: np.ndarray
    stage: np.ndarray
    out: np.ndarray
    before: np.ndarray
    rate: np.ndarray
    state: np.ndarray
    room: np.ndarray


class Side(NamedTuple):
    """What belongs to the lanes besides their rows of numbers, the lane on the first axis.

    run          which run is in the lane, −1 for none; ``rounds`` it has had
    attention    1 where something other than a step may be due, ``FRESH`` where the lane has to be loaded
    generic      whether its rates take more than ``lanes.driven_rates``: prescribed speeds, resistances, a resting wheel
    ends         whether the step reaches the end of its piece
    state, room  contact states and what follows from them
    rows         ωᵢ = row · Ω in the present contact state, zero for a wheel that rests, (LANES, n, 3); of prescribed speeds,
                 ωᵢ = row · (1, t, 0) with the time t since the piece began
    """

    run: np.ndarray
    rounds: np.ndarray
    attention: np.ndarray
    generic: np.ndarray
    ends: np.ndarray
    state: np.ndarray
    room: np.ndarray
    rows: np.ndarray


@njit(parallel=True, error_model="numpy")
def advance_on_all_cores(machine, task, progress, record, most_steps, status):
    """``advance`` for many runs on all cores, ``RUNS_AT_ONCE`` at a time."""
    runs = status.size
    for piece in prange((runs + RUNS_AT_ONCE - 1) // RUNS_AT_ONCE):
        first, last = piece * RUNS_AT_ONCE, min((piece + 1) * RUNS_AT_ONCE, runs)
        advance(machine, task, progress, record, first, last, most_steps, status)


@njit(error_model="numpy")
def advance(machine, task, progress, record, first, last, most_steps, status):
    """Integrate the runs from ``first`` to before ``last`` until each ends or has had ``most_steps`` more steps.

    All arrays but ``kinds``, ``samples`` and ``control`` have the run first; ``status`` receives how the runs stand. Each lane
    takes the next run when its own is done. Everything that a later call needs is in ``progress``, so stopping in between
    changes no bit of the result.
    """
    n = progress.pitch.shape[1]
    room, side, shared = L.new_room(), _new_side(n), _new_work(n, (task.pieces.shape[2] - 8) // 2)
    pieces, control, samples, wheels = task.pieces, task.control, task.samples, machine.wheels
    y, rate, clock, counters, pitch = progress.y, progress.rate, progress.clock, progress.counters, progress.pitch
    runs, rounds, attention, generic, ends = side.run, side.rounds, side.attention, side.generic, side.ends
    state, rows = side.state, side.rows
    waiting = first
    while True:
        busy = special = 0
        for lane in range(LANES):
            while True:
                if runs[lane] < 0:
                    while waiting < last and status[waiting] != RUNNING:
                        waiting += 1
                    if waiting >= last:
                        break
                    runs[lane], rounds[lane], attention[lane] = waiting, 0, FRESH
                    waiting += 1
                stand = RUNNING
                if attention[lane] == 1:
                    _store(y, rate, room, lane, runs[lane])
                if attention[lane] > 0:
                    stand = _attend(machine, task, progress, record, side, shared, room, lane, runs[lane])
                if stand == RUNNING and rounds[lane] < most_steps:
                    break
                if stand == RUNNING:
                    _store(y, rate, room, lane, runs[lane])
                status[runs[lane]], runs[lane] = stand, -1
            if runs[lane] >= 0:
                busy += 1
                special += generic[lane]
                rounds[lane] += 1
                ends[lane] = _set_step(pieces, control, clock, counters, room, lane, runs[lane])
        if busy == 0:
            return
        L.spread_step(room)
        L.keep_increments(room, 0)
        for stage in range(1, STAGES):
            L.next_stage(room, stage)
            if busy > special:
                L.driven_rates(room, C[stage])
            if special > 0:
                _generic_rates(machine, task, progress, side, shared, room, C[stage])
            L.keep_increments(room, stage)
        L.find_error(room, control[RELATIVE], control[ABSOLUTE])
        for lane in range(LANES):
            if runs[lane] >= 0:
                b = runs[lane]
                stand = _judge(
                    pieces,
                    control,
                    samples,
                    wheels,
                    y,
                    clock,
                    counters,
                    pitch,
                    attention,
                    ends,
                    state,
                    rows,
                    room,
                    lane,
                    b,
                )
                if stand == CARE:
                    stand = _take_with_care(machine, task, progress, record, side, shared, room, lane, b)
                if stand != RUNNING:
                    status[b], runs[lane] = stand, -1
        L.take(room)


@njit(error_model="numpy")
def _new_side(n):
    counts = np.zeros((4, LANES), np.int64)
    return Side(
        np.full(LANES, -1), counts[0], counts[1], counts[2], counts[3], np.zeros((LANES, n), np.int64), np.zeros((LANES, ROOM)),
        np.zeros((LANES, n, 3)),
    )  # fmt: skip


@njit(error_model="numpy")
def _new_work(n, columns):
    size = ANGLE + n
    return Work(
        np.zeros((STAGES, size)), np.zeros(size), np.zeros(size), np.zeros(columns), np.zeros(columns), np.zeros(3),
        np.zeros(3 * n + 6), np.zeros(n, np.int64), np.zeros(SIZE), np.zeros(n, np.int64), np.zeros(ROOM),
    )  # fmt: skip


@kernel
def _alone(machine, task, progress, record, b):
    """The tuples of one run."""
    return (
        Machine(machine.body[b], machine.contacts[b], machine.wheels[b]),
        Task(task.kinds, task.pieces[b], task.samples, task.control),
        Progress(
            progress.y[b], progress.rate[b], progress.pitch[b], progress.resting[b], progress.clock[b], progress.counters[b]
        ),
        Record(record.sampled[b], record.results[b], record.states[b], record.events[b]),
    )


@kernel
def _work_of(shared, side, lane):
    """Room to work in with the contact state of a lane."""
    return Work(
        shared.k, shared.trial, shared.y_new, shared.drive, shared.slope, shared.stage, shared.out, shared.before, shared.rate,
        side.state[lane], side.room[lane],
    )  # fmt: skip


@kernel
def _attend(machines, tasks, progresses, records, side, shared, room, lane, b):
    """Do all that is due before the next step of a run, and put it into its lane; returns how it stands."""
    machine, task, progress, record = _alone(machines, tasks, progresses, records, b)
    work = _work_of(shared, side, lane)
    clock, counters, pieces = progress.clock, progress.counters, task.pieces
    _set_state(machine.wheels, progress.pitch, progress.resting, work.state)
    enter_state(machine.contacts, machine.wheels, work.state, work.room)
    while True:
        if clock[STARTED] == 0.0 or clock[TIME] >= pieces[int(counters[PIECE]), 1]:
            if clock[STARTED] == 1.0 and counters[PIECE] + 1 >= pieces.shape[0]:
                _sample_the_end(machine, task, progress, record, work)
                return DONE
            _enter_piece(machine, task, progress, record, work)
        if counters[EVENT] + EVENTS_AT_ONCE > record.events.shape[0]:
            return EVENTS_FULL
        if counters[STUCK] > MOST_EVENTS_AT_ONCE:
            return CHATTER
        if not _find_rate(machine, task, progress, work):
            return NO_SOLUTION
        # A wheel at a boundary and on its way out changes its race before any step is taken.
        leaving = _leave_rest(machine, task, progress, work)
        changed = _wheel_at_boundary(machine, task, progress, work) if leaving < 0 else 0
        if leaving >= 0:
            fine = _enter_contacts(machine, task, progress, record, work, leaving)
        elif changed != 0:
            fine = _change_race(machine, task, progress, record, work, changed, progress.y)
        else:
            break
        if not fine:
            return NO_SOLUTION
    _load(machine, task, progress, side, work.state, work.room, room, lane)
    return RUNNING


@kernel
def _load(machine, task, progress, side, state, state_room, room, lane):
    """Put a run into its lane: machine, drive of the present piece, state and rate."""
    body, kinds, n = machine.body, task.kinds, state.size
    row, c = task.pieces[int(progress.counters[PIECE])], (task.pieces.shape[1] - 8) // 2
    long = row[1] - row[0]
    resting = False
    for w in range(n):
        resting = resting or state[w] == RESTING
        for i in range(3):
            side.rows[lane, w, i] = 0.0 if state[w] == RESTING else machine.contacts[w, state[w], i]
        if kinds[0] == WHEEL_SPEED:
            side.rows[lane, w, 0], side.rows[lane, w, 1] = row[2 + w], (row[2 + c + w] - row[2 + w]) / long
    side.generic[lane] = 1 if kinds[0] != TORQUE or resting or resists(body, machine.wheels) else 0
    side.attention[lane] = 1 if resting else 0
    for i in range(6):
        put(room, L.OWN + i, lane, body[i])
        put(room, L.FELT + i, lane, state_room[SHARE + i])
    put(room, L.MASS, lane, body[SPHERE_MASS])
    put(room, L.MOVING, lane, body[MOVING_MASS])
    put(room, L.STAGE_SHARE, lane, stage_share(body, kinds[1]))
    begin, end = stage_push(body, kinds[1], row[2 + 2 * c :]), stage_push(body, kinds[1], row[5 + 2 * c :])
    for i in range(3):
        put(room, L.OFFSET + i, lane, body[BODY_OFFSET + i])
        put(room, L.GRAVITY + i, lane, body[WEIGHT + i])
        put(room, L.PUSH + i, lane, begin[i])
        put(room, L.PUSH_SLOPE + i, lane, (end[i] - begin[i]) / long)
        first = slope = 0.0
        if side.generic[lane] == 0:
            for w in range(n):
                first += side.rows[lane, w, i] * row[2 + w]
                slope += side.rows[lane, w, i] * (row[2 + c + w] - row[2 + w])
        put(room, L.MOMENT + i, lane, first)
        put(room, L.MOMENT_SLOPE + i, lane, slope / long)
    for i in range(SIZE):
        put(room, L.Y + i, lane, progress.y[i] if i < ANGLE else 0.0)
        put(room, L.FIRST_RATE + i, lane, progress.rate[i])


@kernel
def _find_rate(machine, task, progress, work):
    """Inputs at the present time and, unless they are known, rates; False where the equations have no solution."""
    clock = progress.clock
    _inputs_at(task.pieces, int(progress.counters[PIECE]), clock[TIME], work.drive, work.slope, work.stage)
    if clock[RATE_KNOWN] == 1.0:
        return True
    clock[RATE_KNOWN] = 1.0
    fine = rates(
        machine.body, machine.contacts, machine.wheels, task.kinds[0], task.kinds[1], work.state, work.drive, work.slope,
        work.stage, progress.y, progress.rate, work.out, work.room,
    )  # fmt: skip
    if task.kinds[0] == WHEEL_SPEED:
        _turn_as_asked(progress.rate, clock[TIME] - task.pieces[int(progress.counters[PIECE]), 0])
    return fine


@inlined
def _turn_as_asked(rate, t):
    """Have the lane integrate (1, t, 0) in place of Ω: wheels of prescribed speeds turn by these, free of Ω's rounding.

    A wheel that is held on the boundary between its races then stays there.
    """
    rate[L.TURN], rate[L.TURN + 1], rate[L.TURN + 2] = 1.0, t, 0.0


@inlined
def _set_step(pieces, control, clock, counters, room, lane, b):
    """Choose the length of the next step; returns 1 where it ends the piece."""
    t, begin, end = clock[b, TIME], pieces[b, int(counters[b, PIECE]), 0], pieces[b, int(counters[b, PIECE]), 1]
    fixed = control[FIXED_STEP] > 0.0
    h = control[FIXED_STEP] if fixed else min(clock[b, STEP], control[LARGEST_STEP])
    last = h >= (end - t) * (1.0 - 1e-9)
    if last:
        h = end - t
    elif not fixed and 2.0 * h > end - t:
        h = 0.5 * (end - t)
    put(room, L.TIME, lane, t - begin)
    put(room, L.SOLVED, lane, 1.0)
    put(room, L.STEP, lane, h)
    return 1 if last else 0


@kernel
def _generic_rates(machine, task, progress, side, shared, room, node):
    """Rates by the full equations where a lane takes them; a prescribed Ω is put into the lane's state."""
    y, dy = shared.y_new, shared.rate
    for lane in range(LANES):
        b = side.run[lane]
        if b < 0 or side.generic[lane] == 0:
            continue
        t = progress.clock[b, TIME] + node * get(room, L.STEP, lane)
        _inputs_at(task.pieces[b], int(progress.counters[b, PIECE]), t, shared.drive, shared.slope, shared.stage)
        for i in range(L.LOOKED_AT):
            y[i] = get(room, L.Y_NEW + i, lane)
        fine = rates(
            machine.body[b], machine.contacts[b], machine.wheels[b], task.kinds[0], task.kinds[1], side.state[lane],
            shared.drive, shared.slope, shared.stage, y, dy, shared.out, side.room[lane],
        )  # fmt: skip
        if task.kinds[0] == WHEEL_SPEED:
            _turn_as_asked(dy, t - task.pieces[b, int(progress.counters[b, PIECE]), 0])
        for i in range(3):
            put(room, L.Y_NEW + OMEGA + i, lane, y[OMEGA + i])
        for i in range(SIZE):
            put(room, L.RATE + i, lane, dy[i])
        put(room, L.FINE, lane, 1.0 if fine else 0.0)


@inlined
def _judge(pieces, control, samples, wheels, y, clock, counters, pitch, attention, ends, state, rows, room, lane, b):
    """Take the step that was tried, or refuse it; returns how the run stands, ``CARE`` where more is in the step."""
    t, h, fixed = clock[b, TIME], get(room, L.STEP, lane), control[FIXED_STEP] > 0.0
    solved = get(room, L.SOLVED, lane) == 1.0
    error = _error_with_angles(room, rows, y, control, lane, b) if solved else L.ENDLESS
    put(room, L.ERROR, lane, error)
    if not fixed and error > 1.0:
        clock[b, STEP] = h * (max(0.2, 0.9 * error ** (-0.2)) if error < L.ENDLESS else 0.1)
        counters[b, REFUSED] += 1
        L.refuse(room, lane)
        if clock[b, STEP] < 1e-15 * max(pieces[b, -1, 1], t):
            return STEP_TOO_SMALL if solved else NO_SOLUTION
        return RUNNING
    if error >= L.ENDLESS:
        return NOT_FINITE if solved else NO_SOLUTION
    t_new = pieces[b, int(counters[b, PIECE]), 1] if ends[lane] == 1 else t + h
    if _near_a_boundary(wheels, state, rows, y, pitch, room, lane, b):
        attention[lane] = 1
        return CARE
    sample = int(counters[b, SAMPLE])
    if sample < samples.size and samples[sample] < t_new:
        return CARE
    _finish(clock, counters, control, y, attention, ends, rows, room, lane, b, t_new)
    return RUNNING


@inlined
def _error_with_angles(room, rows, y, control, lane, b):
    """The larger of the lane's error and that of the wheels' angles."""
    worst = get(room, L.ERROR, lane)
    e0, e1, e2 = get(room, L.ERROR + L.TURN, lane), get(room, L.ERROR + L.TURN + 1, lane), get(room, L.ERROR + L.TURN + 2, lane)
    for w in range(rows.shape[1]):
        error = rows[lane, w, 0] * e0 + rows[lane, w, 1] * e1 + rows[lane, w, 2] * e2
        angle = y[b, ANGLE + w]
        largest = max(abs(angle), abs(angle + _turn(room, rows, L.Y_NEW, lane, w)))
        worst = max(worst, abs(error) / (control[ABSOLUTE] + control[RELATIVE] * largest))
    return worst


@inlined
def _turn(room, rows, block, lane, w):
    """row · the three places of ∫Ω dt in a block: a wheel's part of it."""
    place = block + L.TURN
    a, b, c = get(room, place, lane), get(room, place + 1, lane), get(room, place + 2, lane)
    return rows[lane, w, 0] * a + rows[lane, w, 1] * b + rows[lane, w, 2] * c


@inlined
def _near_a_boundary(wheels, state, rows, y, pitch, room, lane, b):
    """Whether a wheel with races leaves its half pitch in the step, or turns back in it, or comes close to its boundary."""
    for w in range(rows.shape[1]):
        half = wheels[b, w, HALF_PITCH]
        if np.isfinite(half) and state[lane, w] != RESTING:
            angle = y[b, ANGLE + w] + _turn(room, rows, L.Y_NEW, lane, w)
            near = AT_BOUNDARY * max(1.0, abs(angle))
            lower = pitch[b, w] * half - wheels[b, w, PHASE]
            if not lower + near < angle < lower + half - near:
                return True
            if _turn(room, rows, L.K, lane, w) * _turn(room, rows, L.K + (STAGES - 1) * SIZE, lane, w) < 0.0:
                return True
    return False


@inlined
def _store(y, rate, room, lane, b):
    """Put a lane's state and rate into the run's own arrays; the wheels' angles are always there."""
    for i in range(SIZE):
        rate[b, i] = get(room, L.FIRST_RATE + i, lane)
        if i < ANGLE:
            y[b, i] = get(room, L.Y + i, lane)


@inlined
def _finish(clock, counters, control, y, attention, ends, rows, room, lane, b, t_new):
    """Note that a whole step is taken, turn the wheels, and choose the next step's length."""
    for w in range(rows.shape[1]):
        y[b, ANGLE + w] += _turn(room, rows, L.Y_NEW, lane, w)
    if control[FIXED_STEP] == 0.0:
        grown = get(room, L.STEP, lane) * min(5.0, max(0.2, 0.9 * max(get(room, L.ERROR, lane), 1e-10) ** (-0.2)))
        if ends[lane] == 0 or grown >= clock[b, STEP]:
            clock[b, STEP] = grown
    if ends[lane] == 1:
        attention[lane] = 1
    clock[b, TIME] = t_new
    counters[b, STEPS] += 1
    counters[b, STUCK] = 0


@kernel
def _take_with_care(machines, tasks, progresses, records, side, shared, room, lane, b):
    """Take a step that has samples in it or a wheel at its boundary, where it ends; returns how the run stands."""
    machine, task, progress, record = _alone(machines, tasks, progresses, records, b)
    work = _work_of(shared, side, lane)
    clock, counters, y, y_new, k = progress.clock, progress.counters, progress.y, work.y_new, work.k
    t, h = clock[TIME], get(room, L.STEP, lane)
    _store(progresses.y, progresses.rate, room, lane, b)
    _unload(room, side.rows, y, y_new, k, lane)
    wheel, share, up = _first_crossing(machine.wheels, y, y_new, k, progress.pitch, progress.resting)
    if wheel >= 0 and h * share < 1e-13 * max(task.pieces[-1, 1], t):
        # A wheel that starts on its boundary with no speed shows only by the step how it leaves.
        changed = (wheel + 1) if up else -(wheel + 1)
        side.attention[lane] = FRESH
        return RUNNING if _change_race(machine, task, progress, record, work, changed, y_new) else NO_SOLUTION
    t_end = task.pieces[int(counters[PIECE]), 1] if side.ends[lane] == 1 else t + h
    t_new = t + share * h if wheel >= 0 else t_end
    _take_samples(machine, task, progress, record, work, h, t_new)
    if wheel < 0:
        _finish(
            progresses.clock, progresses.counters, task.control, progresses.y, side.attention, side.ends, side.rows, room, lane,
            b, t_new,
        )  # fmt: skip
    else:
        # The step ends inside itself, where the wheel reaches its boundary: the interpolant is as good as the step.
        interpolate(y, y_new, k, share, work.trial)
        _copy(work.trial, y)
        _normalise(y)
        _snap(machine.wheels, y, progress.pitch, wheel)
        side.attention[lane] = FRESH
        clock[RATE_KNOWN], clock[TIME] = 0.0, t_new
        counters[STEPS] += 1
        counters[STUCK] = 0 if t_new > t else counters[STUCK]
    return RUNNING


@kernel
def _unload(room, rows, y, y_new, k, lane):
    """State at the step's end and the increments, with the wheels' angles, out of the lane."""
    for i in range(ANGLE):
        y_new[i] = get(room, L.Y_NEW + i, lane)
        for s in range(STAGES):
            k[s, i] = get(room, L.K + s * SIZE + i, lane)
    for w in range(rows.shape[1]):
        y_new[ANGLE + w] = y[ANGLE + w] + _turn(room, rows, L.Y_NEW, lane, w)
        for s in range(STAGES):
            k[s, ANGLE + w] = _turn(room, rows, L.K + s * SIZE, lane, w)


@inlined
def _copy(source, goal):
    """A loop, as an assignment of arrays makes room for one in between."""
    for i in range(source.size):
        goal[i] = source[i]


@kernel
def _normalise(y):
    """Bring the quaternion in ``y`` to unit length."""
    length = 0.0
    for i in range(4):
        length += y[ORIENTATION + i] ** 2
    length = np.sqrt(length)
    for i in range(4):
        y[ORIENTATION + i] /= length


@kernel
def _inputs_at(pieces, piece, t, drive, slope, stage):
    """Drive, its slope and the stage's input at ``t`` of a piece: its ends, then first and last values of both."""
    first, last = pieces[piece, 0], pieces[piece, 1]
    share = (t - first) / (last - first)
    c = drive.size
    for i in range(c):
        rise = pieces[piece, 2 + c + i] - pieces[piece, 2 + i]
        drive[i] = pieces[piece, 2 + i] + share * rise
        slope[i] = rise / (last - first)
    for i in range(3):
        begin = pieces[piece, 2 + 2 * c + i]
        stage[i] = begin + share * (pieces[piece, 5 + 2 * c + i] - begin)


@kernel
def _solve_now(machine, task, progress, work, t, y):
    """``solve`` at time ``t`` of the present piece."""
    _inputs_at(task.pieces, int(progress.counters[PIECE]), t, work.drive, work.slope, work.stage)
    return solve(
        machine.body, machine.contacts, machine.wheels, task.kinds[0], task.kinds[1], work.state, work.drive, work.slope,
        work.stage, y, work.out, work.room, True,
    )  # fmt: skip


@kernel
def _enter_piece(machine, task, progress, record, work):
    """Go on to the next piece; a jump of a prescribed Ω there takes or gives energy, which is written down."""
    clock, y = progress.clock, progress.y
    first = clock[STARTED] == 0.0
    if not first:
        progress.counters[PIECE] += 1
    clock[STARTED], clock[RATE_KNOWN] = 1.0, 0.0
    if task.kinds[0] == TORQUE:
        return
    old = (y[OMEGA], y[OMEGA + 1], y[OMEGA + 2])
    kinetic, potential = energy(machine.body, machine.contacts, machine.wheels, work.state, y)
    _solve_now(machine, task, progress, work, clock[TIME], y)
    jump = abs(y[OMEGA] - old[0]) + abs(y[OMEGA + 1] - old[1]) + abs(y[OMEGA + 2] - old[2])
    if not first and jump > 1e-12 * (abs(old[0]) + abs(old[1]) + abs(old[2])):
        _write_event(machine, progress, record, work, -1, kinetic + potential, old)


@kernel
def _set_state(wheels, pitch, resting, state):
    for w in range(state.size):
        state[w] = RESTING if resting[w] == 1 else (pitch[w] % 2 if np.isfinite(wheels[w, HALF_PITCH]) else 0)


@inlined
def _speed(contacts, w, k, y):
    """Speed that the ``k``-th contact state gives wheel ``w``; of ``y`` that begins with Ω̇, its acceleration."""
    return contacts[w, k, 0] * y[OMEGA] + contacts[w, k, 1] * y[OMEGA + 1] + contacts[w, k, 2] * y[OMEGA + 2]


@inlined
def _boundary(wheels, pitch, w, upper):
    return (pitch[w] + (1 if upper else 0)) * wheels[w, HALF_PITCH] - wheels[w, PHASE]


@kernel
def _heading(machine, task, progress, work, w, k, y):
    """Speed of wheel ``w`` in its ``k``-th contact state, or what stands for it on a boundary: the way the wheel leaves.

    A speed that turns back before the wheel is off the boundary tells nothing: the acceleration does, where it is prescribed,
    as where there is no speed. That of driven wheels depends on the race they are in: 0, a step has to show their way.
    """
    asked = task.kinds[0] == WHEEL_SPEED
    speed = work.drive[w] if asked else _speed(machine.contacts, w, k, y)
    gained = work.slope[w] if asked else _speed(machine.contacts, w, k, progress.rate)
    near = AT_BOUNDARY * max(1.0, abs(y[ANGLE + w]))
    if speed != 0.0 and (speed * gained >= 0.0 or speed * speed >= 2.0 * near * abs(gained)):
        return speed
    return 0.0 if task.kinds[0] == TORQUE else gained


@kernel
def _leave_rest(machine, task, progress, work):
    """Let go of a wheel that its races no longer drive back to the boundary between them; −1 where there is none."""
    y, pitch, resting = progress.y, progress.pitch, progress.resting
    for w in range(pitch.size):
        if resting[w] == 1:
            below = _heading(machine, task, progress, work, w, pitch[w] % 2, y)
            above = _heading(machine, task, progress, work, w, (pitch[w] + 1) % 2, y)
            if below >= 0.0 >= above:
                continue
            resting[w] = 0
            pitch[w] += 1 if above > -below else 0
            return w
    return -1


@kernel
def _wheel_at_boundary(machine, task, progress, work):
    """± (wheel + 1) of a wheel that stands on its boundary and moves out of it, up or down; 0 where there is none."""
    wheels, y, pitch = machine.wheels, progress.y, progress.pitch
    for w in range(pitch.size):
        if np.isfinite(wheels[w, HALF_PITCH]) and work.state[w] != RESTING:
            speed = _heading(machine, task, progress, work, w, work.state[w], y)
            near = AT_BOUNDARY * max(1.0, abs(y[ANGLE + w]))
            if speed > 0.0 and y[ANGLE + w] >= _boundary(wheels, pitch, w, True) - near:
                return w + 1
            if speed < 0.0 and y[ANGLE + w] <= _boundary(wheels, pitch, w, False) + near:
                return -(w + 1)
    return 0


@kernel
def _first_crossing(wheels, y, y_new, k, pitch, resting):
    """The wheel that leaves its half pitch first in a step (−1: none), at which share of it, and whether upward."""
    first_wheel, first_share, first_up = -1, 2.0, True
    for w in range(pitch.size):
        if not np.isfinite(wheels[w, HALF_PITCH]) or resting[w] == 1:
            continue
        i = ANGLE + w
        # A wheel that turns back within the step may have been outside in between.
        turn = k[0, i] / (k[0, i] - k[6, i]) if k[0, i] * k[6, i] < 0.0 else 1.0
        for end in (turn, 1.0):
            angle = y_new[i] if end == 1.0 else interpolated(y[i], y_new[i], k, end, i)
            upper, lower = _boundary(wheels, pitch, w, True), _boundary(wheels, pitch, w, False)
            # Rounding takes no wheel out; twice the width in which ``_heading`` looks for one that turns back.
            width = 2.0 * AT_BOUNDARY * max(1.0, abs(angle))
            if lower - width <= angle <= upper + width:
                continue
            goal = upper if angle > upper else lower
            share = _share_at(y[i], y_new[i], k, i, goal, end, angle > goal)
            if share < first_share:
                first_wheel, first_share, first_up = w, share, angle > upper
            break
    return first_wheel, first_share, first_up


@kernel
def _share_at(y, y_new, k, i, goal, end, rising):
    """Where in the step the interpolant of component i passes ``goal``, between its start and ``end``: by halving."""
    inside, outside = 0.0, end
    for _ in range(60):
        middle = 0.5 * (inside + outside)
        if (interpolated(y, y_new, k, middle, i) > goal) == rising:
            outside = middle
        else:
            inside = middle
    return outside


@kernel
def _snap(wheels, y, pitch, wheel):
    """Put a wheel that has reached its boundary exactly on it."""
    upper, lower = _boundary(wheels, pitch, wheel, True), _boundary(wheels, pitch, wheel, False)
    angle = y[ANGLE + wheel]
    y[ANGLE + wheel] = upper if abs(angle - upper) < abs(angle - lower) else lower


@kernel
def _change_race(machine, task, progress, record, work, changed, reference):
    """Let a wheel at its boundary change its race, up (+) or down (−).

    Where the next race would drive it straight back, it comes to rest between the two. ``reference`` is the state that
    tells this: the present one, or the one a moment later for a wheel that is only about to move.
    """
    w, up, pitch = abs(changed) - 1, changed > 0, progress.pitch
    _snap(machine.wheels, progress.y, pitch, w)
    pitch[w] += 1 if up else -1
    back = _heading(machine, task, progress, work, w, pitch[w] % 2, reference)
    if task.kinds[0] != WHEEL_SPEED and ((up and back < 0.0) or (not up and back > 0.0)):
        progress.resting[w] = 1
        pitch[w] -= 1 if up else 0
    return _enter_contacts(machine, task, progress, record, work, w)


@kernel
def _enter_contacts(machine, task, progress, record, work, w):
    """Go over to the contact state that ``pitch`` and ``resting`` tell, because of wheel ``w``, and write the event down.

    It is an impact of free wheels, and a jump of Ω or of the wheel where speeds are prescribed.
    """
    y, state, before = progress.y, work.state, work.before
    _copy(state, before)
    _set_state(machine.wheels, progress.pitch, progress.resting, state)
    kinetic, potential = energy(machine.body, machine.contacts, machine.wheels, before, y)
    old = (y[OMEGA], y[OMEGA + 1], y[OMEGA + 2])
    enter_state(machine.contacts, machine.wheels, state, work.room)
    if task.kinds[0] == TORQUE:
        fine = impact(machine.body, machine.contacts, machine.wheels, task.kinds[1], before, state, y, work.room)
    else:
        fine = _solve_now(machine, task, progress, work, progress.clock[TIME], y)
    if fine:
        _write_event(machine, progress, record, work, w, kinetic + potential, old)
    progress.clock[RATE_KNOWN] = 0.0
    progress.counters[STUCK] += 1
    return fine


@kernel
def _write_event(machine, progress, record, work, w, energy_before, old):
    """Write an event down; its impulse is what the sphere's moment of momentum about its centre changes by, I ΔΩ."""
    y, row = progress.y, record.events[int(progress.counters[EVENT])]
    kinetic, potential = energy(machine.body, machine.contacts, machine.wheels, work.state, y)
    inertia, _ = turned_body(machine.body, y)
    d0, d1, d2 = y[OMEGA] - old[0], y[OMEGA + 1] - old[1], y[OMEGA + 2] - old[2]
    row[0], row[1], row[2] = progress.clock[TIME], w, energy_before - kinetic - potential
    row[3] = inertia[0] * d0 + inertia[1] * d1 + inertia[2] * d2
    row[4] = inertia[1] * d0 + inertia[3] * d1 + inertia[4] * d2
    row[5] = inertia[2] * d0 + inertia[4] * d1 + inertia[5] * d2
    progress.counters[EVENT] += 1


@kernel
def _take_samples(machine, task, progress, record, work, h, t_new):
    """Write down the samples before ``t_new``: the state from the step's interpolant, forces from the equations."""
    t, counters, samples = progress.clock[TIME], progress.counters, task.samples
    while counters[SAMPLE] < samples.size and samples[int(counters[SAMPLE])] < t_new:
        at = samples[int(counters[SAMPLE])]
        interpolate(progress.y, work.y_new, work.k, (at - t) / h, work.trial)
        _sample(machine, task, progress, record, work, at, work.trial)


@kernel
def _sample_the_end(machine, task, progress, record, work):
    while progress.counters[SAMPLE] < task.samples.size:
        _copy(progress.y, work.trial)
        _sample(machine, task, progress, record, work, task.pieces[-1, 1], work.trial)


@kernel
def _sample(machine, task, progress, record, work, t, y):
    row = int(progress.counters[SAMPLE])
    _solve_now(machine, task, progress, work, t, y)
    _normalise(y)
    _copy(work.out, record.results[row])
    _copy(work.state, record.states[row])
    _copy(y, record.sampled[row])
    progress.counters[SAMPLE] += 1
