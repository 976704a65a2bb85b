"""The rolling model in time: adaptive steps that end at corners of the inputs and at changes of race.

A change of race is found by counting half roller pitches, never by a root of the wheel's shape: each wheel carries the
number of its half pitch, and a step that leaves it ends on the boundary, by its own interpolant.

Arrays go about in named tuples. Each look into one costs two counts of references, so the functions of the innermost loop
take plain arrays; the others are called once a step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import prange

from spheredrive.compiled import njit
from spheredrive.dynamics.rolling import (
    ANGLE,
    HALF_PITCH,
    OMEGA,
    ORIENTATION,
    PHASE,
    RESTING,
    ROOM,
    TORQUE,
    WHEEL_SPEED,
    energy,
    enter_state,
    impact,
    rates,
    solve,
    turned,
)
from spheredrive.simulation.dormand_prince import STAGES, C, error_norm, interpolate, interpolated, stage_state

# How a run ended, or why it stopped.
DONE, RUNNING, NO_SOLUTION, STEP_TOO_SMALL, CHATTER, EVENTS_FULL, NOT_FINITE = 0, 1, 2, 3, 4, 5, 6

# A race is changed when the wheel is this close to its boundary, rad.
AT_BOUNDARY = 1e-12
MOST_EVENTS_AT_ONCE = 100
# Room that one round of events may need.
EVENTS_AT_ONCE = 2

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

    y          state vector, see ``dynamics.rolling``, and its ``rate``
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
    """Room to work in: stages of a step, states inside and at its end, inputs and results at an instant, contact states."""

    k: np.ndarray
    trial: np.ndarray
    y_new: np.ndarray
    drive: np.ndarray
    slope: np.ndarray
    stage: np.ndarray
    out: np.ndarray
    room: np.ndarray
    state: np.ndarray
    before: np.ndarray


@njit(error_model="numpy")
def advance(machine, task, progress, record, most_steps):
    """Integrate until the run ends or ``most_steps`` more rounds are done; returns how it stands.

    Everything that a later call needs is in ``progress``, so stopping in between changes no bit of the result.
    """
    n, size = progress.pitch.size, progress.y.size
    columns = (task.pieces.shape[1] - 8) // 2
    work = Work(
        np.zeros((STAGES, size)), np.zeros(size), np.zeros(size), np.zeros(columns), np.zeros(columns), np.zeros(3),
        np.zeros(3 * n + 6), np.zeros(ROOM), np.zeros(n, np.int64), np.zeros(n, np.int64),
    )  # fmt: skip
    clock, counters, pieces, y = progress.clock, progress.counters, task.pieces, progress.y
    atol = np.full(size, task.control[ABSOLUTE])
    _set_state(machine.wheels, progress.pitch, progress.resting, work.state)
    enter_state(machine.contacts, machine.wheels, work.state, work.room)
    work.k[0] = progress.rate
    # A wheel that starts on its boundary with no speed shows only by a step that it leaves, upward (+) or downward (−).
    forced = 0
    for _ in range(most_steps):
        if clock[STARTED] == 0.0 or clock[TIME] >= pieces[int(counters[PIECE]), 1]:
            if clock[STARTED] == 1.0 and counters[PIECE] + 1 >= pieces.shape[0]:
                _sample_the_end(machine, task, progress, record, work)
                return DONE
            _enter_piece(machine, task, progress, record, work)
        if counters[EVENT] + EVENTS_AT_ONCE > record.events.shape[0]:
            return EVENTS_FULL
        leaving = _leave_rest(machine.contacts, y, progress.pitch, progress.resting)
        if leaving >= 0 and not _enter_contacts(machine, task, progress, record, work, leaving):
            return NO_SOLUTION
        # A wheel at a boundary and on its way out changes its race before any step is taken.
        changed = forced if forced != 0 else _wheel_at_boundary(machine, progress, work.state)
        if counters[STUCK] > MOST_EVENTS_AT_ONCE:
            return CHATTER
        if changed != 0:
            reference = work.y_new if forced != 0 else y
            forced = 0
            if not _change_race(machine, task, progress, record, work, changed, reference):
                return NO_SOLUTION
            continue
        if clock[RATE_KNOWN] == 0.0 and not _find_rate(machine, task, progress, work):
            return NO_SOLUTION
        status, forced = _take_step(machine, task, progress, record, work, atol)
        if status != RUNNING:
            return status
    return RUNNING


@njit(error_model="numpy")
def _find_rate(machine, task, progress, work):
    clock = progress.clock
    _inputs_at(task.pieces, int(progress.counters[PIECE]), clock[TIME], work.drive, work.slope, work.stage)
    if not rates(
        machine.body, machine.contacts, machine.wheels, task.kinds[0], task.kinds[1], work.state, work.drive, work.slope,
        work.stage, progress.y, progress.rate, work.out, work.room,
    ):  # fmt: skip
        return False
    work.k[0] = progress.rate
    clock[RATE_KNOWN] = 1.0
    return True


@njit(error_model="numpy")
def _take_step(machine, task, progress, record, work, atol):
    """One step, good or refused.

    Returns how the run stands and, for a wheel that is out of its boundary at once, ± (wheel + 1).
    """
    clock, counters, control, y, y_new, k = progress.clock, progress.counters, task.control, progress.y, work.y_new, work.k
    t, end, duration = clock[TIME], task.pieces[int(counters[PIECE]), 1], task.pieces[-1, 1]
    fixed = control[FIXED_STEP] > 0.0
    h = control[FIXED_STEP] if fixed else min(clock[STEP], control[LARGEST_STEP])
    last = h >= (end - t) * (1.0 - 1e-9)
    if last:
        h = end - t
    elif not fixed and 2.0 * h > end - t:
        h = 0.5 * (end - t)
    solved = _stages(machine, task, progress, work, t, h)
    error = error_norm(y, y_new, k, h, control[RELATIVE], atol) if solved else np.inf
    if not fixed and not error <= 1.0:
        clock[STEP] = h * (max(0.2, 0.9 * error ** (-0.2)) if np.isfinite(error) else 0.1)
        counters[REFUSED] += 1
        if clock[STEP] < 1e-15 * max(duration, t):
            return (STEP_TOO_SMALL if solved else NO_SOLUTION), 0
        return RUNNING, 0
    if not solved:
        return NO_SOLUTION, 0
    for i in range(y.size):
        if not np.isfinite(y_new[i]):
            return NOT_FINITE, 0
    wheel, share, up = _first_crossing(machine.wheels, y, y_new, k, h, progress.pitch, progress.resting)
    if wheel >= 0 and h * share < 1e-13 * max(duration, t):
        return RUNNING, (wheel + 1) if up else -(wheel + 1)
    t_new = t + share * h if wheel >= 0 else (end if last else t + h)
    _take_samples(machine, task, progress, record, work, h, t_new)
    if wheel >= 0:
        # The step ends inside itself, where the wheel reaches its boundary: the interpolant is as good as the step.
        interpolate(y, y_new, k, h, share, work.trial)
        y[:] = work.trial
        _normalise(y, y)
        _snap(machine.wheels, y, progress.pitch, wheel)
        clock[RATE_KNOWN] = 0.0
    else:
        y[:] = y_new
        progress.rate[:] = k[STAGES - 1]
        # The quaternion's rate is linear in it, and so shares its length.
        _normalise(progress.rate, y)
        _normalise(y, y)
        k[0] = progress.rate
        grown = h * min(5.0, max(0.2, 0.9 * max(error, 1e-10) ** (-0.2)))
        if not fixed and not (last and grown < clock[STEP]):
            clock[STEP] = grown
    if t_new > t:
        counters[STUCK] = 0
    clock[TIME] = t_new
    counters[STEPS] += 1
    return RUNNING, 0


@njit(error_model="numpy")
def _stages(machine, task, progress, work, t, h):
    """The stages of a step of length ``h``: k[0] is there already, k[1] to k[6] and the step's end are found."""
    body, contacts, wheels, pieces, y, k = machine.body, machine.contacts, machine.wheels, task.pieces, progress.y, work.k
    drive, slope, stage, out, room, state = work.drive, work.slope, work.stage, work.out, work.room, work.state
    drive_kind, stage_kind, piece = task.kinds[0], task.kinds[1], int(progress.counters[PIECE])
    for s in range(1, STAGES):
        goal = work.y_new if s == STAGES - 1 else work.trial
        stage_state(y, k, h, s, goal)
        _inputs_at(pieces, piece, t + C[s] * h, drive, slope, stage)
        if not rates(body, contacts, wheels, drive_kind, stage_kind, state, drive, slope, stage, goal, k[s], out, room):
            return False
    return True


@njit(error_model="numpy", inline="always")
def _normalise(vector, y):
    """Divide the quaternion's place in ``vector`` by the length of the quaternion in ``y``."""
    length = 0.0
    for i in range(4):
        length += y[ORIENTATION + i] ** 2
    length = np.sqrt(length)
    for i in range(4):
        vector[ORIENTATION + i] /= length


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def _solve_now(machine, task, progress, work, t, y):
    """``solve`` at time ``t`` of the present piece."""
    _inputs_at(task.pieces, int(progress.counters[PIECE]), t, work.drive, work.slope, work.stage)
    return solve(
        machine.body, machine.contacts, machine.wheels, task.kinds[0], task.kinds[1], work.state, work.drive, work.slope,
        work.stage, y, work.out, work.room,
    )  # fmt: skip


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def _set_state(wheels, pitch, resting, state):
    for w in range(state.size):
        state[w] = RESTING if resting[w] == 1 else (pitch[w] % 2 if np.isfinite(wheels[w, HALF_PITCH]) else 0)


@njit(error_model="numpy", inline="always")
def _speed(contacts, w, k, y):
    """Speed that the ``k``-th contact state gives wheel ``w``."""
    return contacts[w, k, 0] * y[OMEGA] + contacts[w, k, 1] * y[OMEGA + 1] + contacts[w, k, 2] * y[OMEGA + 2]


@njit(error_model="numpy", inline="always")
def _boundary(wheels, pitch, w, upper):
    return (pitch[w] + (1 if upper else 0)) * wheels[w, HALF_PITCH] - wheels[w, PHASE]


@njit(error_model="numpy")
def _leave_rest(contacts, y, pitch, resting):
    """Let go of a wheel that its races no longer drive back to the boundary between them; −1 where there is none."""
    for w in range(pitch.size):
        if resting[w] == 1:
            below, above = _speed(contacts, w, pitch[w] % 2, y), _speed(contacts, w, (pitch[w] + 1) % 2, y)
            if below >= 0.0 >= above:
                continue
            resting[w] = 0
            pitch[w] += 1 if above > -below else 0
            return w
    return -1


@njit(error_model="numpy")
def _wheel_at_boundary(machine, progress, state):
    """± (wheel + 1) of a wheel that stands on its boundary and moves out of it, up or down; 0 where there is none."""
    contacts, wheels, y, pitch = machine.contacts, machine.wheels, progress.y, progress.pitch
    for w in range(pitch.size):
        if np.isfinite(wheels[w, HALF_PITCH]) and state[w] != RESTING:
            speed = _speed(contacts, w, state[w], y)
            near = AT_BOUNDARY * max(1.0, abs(y[ANGLE + w]))
            if speed > 0.0 and y[ANGLE + w] >= _boundary(wheels, pitch, w, True) - near:
                return w + 1
            if speed < 0.0 and y[ANGLE + w] <= _boundary(wheels, pitch, w, False) + near:
                return -(w + 1)
    return 0


@njit(error_model="numpy")
def _first_crossing(wheels, y, y_new, k, h, pitch, resting):
    """The wheel that leaves its half pitch first in a step (−1: none), at which share of it, and whether upward."""
    first_wheel, first_share, first_up = -1, 2.0, True
    for w in range(pitch.size):
        if not np.isfinite(wheels[w, HALF_PITCH]) or resting[w] == 1:
            continue
        i = ANGLE + w
        # A wheel that turns back within the step may have been outside in between.
        turn = k[0, i] / (k[0, i] - k[6, i]) if k[0, i] * k[6, i] < 0.0 else 1.0
        for end in (turn, 1.0):
            angle = y_new[i] if end == 1.0 else interpolated(y[i], y_new[i], k, h, end, i)
            upper, lower = _boundary(wheels, pitch, w, True), _boundary(wheels, pitch, w, False)
            if lower <= angle <= upper:
                continue
            goal = upper if angle > upper else lower
            share = _share_at(y[i], y_new[i], k, h, i, goal, end, angle > goal)
            if share < first_share:
                first_wheel, first_share, first_up = w, share, angle > upper
            break
    return first_wheel, first_share, first_up


@njit(error_model="numpy")
def _share_at(y, y_new, k, h, i, goal, end, rising):
    """Where in the step the interpolant of component i passes ``goal``, between its start and ``end``: by halving."""
    inside, outside = 0.0, end
    for _ in range(60):
        middle = 0.5 * (inside + outside)
        if (interpolated(y, y_new, k, h, middle, i) > goal) == rising:
            outside = middle
        else:
            inside = middle
    return outside


@njit(error_model="numpy")
def _snap(wheels, y, pitch, wheel):
    """Put a wheel that has reached its boundary exactly on it."""
    upper, lower = _boundary(wheels, pitch, wheel, True), _boundary(wheels, pitch, wheel, False)
    angle = y[ANGLE + wheel]
    y[ANGLE + wheel] = upper if abs(angle - upper) < abs(angle - lower) else lower


@njit(error_model="numpy")
def _change_race(machine, task, progress, record, work, changed, reference):
    """Let a wheel at its boundary change its race, up (+) or down (−).

    Where the next race would drive it straight back, it comes to rest between the two. ``reference`` is the state that
    tells this: the present one, or the one a moment later for a wheel that is only about to move.
    """
    w, up, pitch = abs(changed) - 1, changed > 0, progress.pitch
    _snap(machine.wheels, progress.y, pitch, w)
    pitch[w] += 1 if up else -1
    back = _speed(machine.contacts, w, pitch[w] % 2, reference)
    if task.kinds[0] != WHEEL_SPEED and ((up and back < 0.0) or (not up and back > 0.0)):
        progress.resting[w] = 1
        pitch[w] -= 1 if up else 0
    return _enter_contacts(machine, task, progress, record, work, w)


@njit(error_model="numpy")
def _enter_contacts(machine, task, progress, record, work, w):
    """Go over to the contact state that ``pitch`` and ``resting`` tell, because of wheel ``w``, and write the event down.

    It is an impact of free wheels, and a jump of Ω or of the wheel where speeds are prescribed.
    """
    y, state, before = progress.y, work.state, work.before
    before[:] = state
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


@njit(error_model="numpy")
def _write_event(machine, progress, record, work, w, energy_before, old):
    """Write an event down; its impulse is what the sphere's moment of momentum about its centre changes by, I ΔΩ."""
    y, row = progress.y, record.events[int(progress.counters[EVENT])]
    kinetic, potential = energy(machine.body, machine.contacts, machine.wheels, work.state, y)
    inertia, _ = turned(machine.body, y)
    d0, d1, d2 = y[OMEGA] - old[0], y[OMEGA + 1] - old[1], y[OMEGA + 2] - old[2]
    row[0], row[1], row[2] = progress.clock[TIME], w, energy_before - kinetic - potential
    row[3] = inertia[0] * d0 + inertia[1] * d1 + inertia[2] * d2
    row[4] = inertia[1] * d0 + inertia[3] * d1 + inertia[4] * d2
    row[5] = inertia[2] * d0 + inertia[4] * d1 + inertia[5] * d2
    progress.counters[EVENT] += 1


@njit(error_model="numpy")
def _take_samples(machine, task, progress, record, work, h, t_new):
    """Write down the samples before ``t_new``: the state from the step's interpolant, forces from the equations."""
    t, counters, samples = progress.clock[TIME], progress.counters, task.samples
    while counters[SAMPLE] < samples.size and samples[int(counters[SAMPLE])] < t_new:
        at = samples[int(counters[SAMPLE])]
        interpolate(progress.y, work.y_new, work.k, h, (at - t) / h, work.trial)
        _sample(machine, task, progress, record, work, at, work.trial)


@njit(error_model="numpy")
def _sample_the_end(machine, task, progress, record, work):
    while progress.counters[SAMPLE] < task.samples.size:
        work.trial[:] = progress.y
        _sample(machine, task, progress, record, work, task.pieces[-1, 1], work.trial)


@njit(error_model="numpy")
def _sample(machine, task, progress, record, work, t, y):
    row = int(progress.counters[SAMPLE])
    _solve_now(machine, task, progress, work, t, y)
    _normalise(y, y)
    record.results[row] = work.out
    record.states[row] = work.state
    record.sampled[row] = y
    progress.counters[SAMPLE] += 1


@njit(parallel=True, error_model="numpy")
def advance_all(
    body, contacts, wheels, kinds, pieces, samples, control, y, rate, pitch, resting, clock, counters, sampled, results, states,
    events, most_steps, status,
):  # fmt: skip
    """``advance`` for many runs side by side; all arrays but ``kinds``, ``samples`` and ``control`` have the run first."""
    for b in prange(y.shape[0]):
        if status[b] == RUNNING:
            machine = Machine(body[b], contacts[b], wheels[b])
            task = Task(kinds, pieces[b], samples, control)
            progress = Progress(y[b], rate[b], pitch[b], resting[b], clock[b], counters[b])
            record = Record(sampled[b], results[b], states[b], events[b])
            status[b] = advance(machine, task, progress, record, most_steps)
