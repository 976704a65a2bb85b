"""Wheels whose patterns come back together, and their joint motion over the time this takes (compiled).

Inputs whose patterns pass at frequencies in a ratio of small whole numbers form a group: they come back together after a joint
period, with the phases given, and their cross terms count.
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.motion.orbit import stretch_at
from spheredrive.vibration.motion.pieces import SLOW, evaluate

# Ratios of frequencies closer than this to a fraction are that fraction; larger whole numbers are none: what two inputs then
# share are harmonics beyond this number.
RATIO = 1e-9
WHOLE = 60
# An exponential below e to this power of its start needs no places of its own.
FADED = -25.0
# Gauss-Legendre's ten places and weights on [0, 1], with the two ends, which are weighed nothing but looked at.
_x, _w = np.polynomial.legendre.leggauss(10)
PLACES = np.concatenate([[0.0], 0.5 * (_x + 1), [1.0]])
WEIGHTS = np.concatenate([[0.0], 0.5 * _w, [0.0]])


@njit(error_model="numpy")
def fraction(x):
    """Whole numbers p, q up to ``WHOLE`` with x = p/q within ``RATIO``; (0, 0) where there are none."""
    p0, q0, p1, q1 = 0, 1, 1, 0
    rest = x
    for _ in range(20):
        a = math.floor(rest) if rest < 1e6 else 1_000_000
        p0, q0, p1, q1 = p1, q1, a * p1 + p0, a * q1 + q0
        if p1 > WHOLE or q1 > WHOLE:
            return 0, 0
        if abs(x - p1 / q1) <= RATIO * x:
            return p1, q1
        if rest == a:
            return 0, 0
        rest = 1.0 / (rest - a)
    return 0, 0


@njit(error_model="numpy")
def groups(period):
    """Group of each input (m,), −1 for one without motion; its passings in a joint period (m,); joint periods (m,), s."""
    m = period.size
    group, times, joint = np.full(m, -1), np.zeros(m, np.int64), np.full(m, np.inf)
    count = 0
    for i in range(m):
        if not math.isfinite(period[i]):
            continue
        for g in range(count):
            p, q = fraction(joint[g] / period[i])
            if p > 0:
                # p passings of the new one are q joint periods.
                fits = True
                for j in range(i):
                    fits = fits and (group[j] != g or times[j] * q <= WHOLE)
                if fits:
                    for j in range(i):
                        if group[j] == g:
                            times[j] *= q
                    joint[g] *= q
                    group[i], times[i] = g, p
                    break
        if group[i] < 0:
            group[i], times[i], joint[count] = count, 1, period[i]
            count += 1
    return group, times, joint, count


@njit(error_model="numpy")
def _local(orbit, i, t, joint, times):
    """Time in input i's orbit at t of its group's joint period."""
    turns = t / joint * times + orbit.lag[i] / orbit.period[i]
    return (turns - math.floor(turns)) * orbit.period[i]


@njit(error_model="numpy")
def group_outputs(system, orbit, group, times, joint, g, at, count, middle, v, wave, low, high, out):
    """Outputs ``low`` to before ``high`` of group g at the first ``count`` of ``at``.

    These are times in the stretch of every input that ``middle`` lies in.
    """
    out[low:high] = 0.0
    for i in range(group.size):
        if group[i] != g:
            continue
        local = _local(orbit, i, middle, joint, times[i])
        q = stretch_at(orbit, i, local)
        T = orbit.length[i, q]
        for s in range(count):
            # Rounding may put an end outside.
            v[s] = min(max((local - orbit.start[i, q] + (at[s] - middle)) / T, 0.0), 1.0)
        evaluate(system, orbit.Y[i, q], orbit.terms[i, q], orbit.amplitude[i, q], v, count, T, wave, low, high, out)


@njit(error_model="numpy")
def _corners(orbit, group, times, joint, g):
    """Times in [0, joint] at which any input of the group begins a stretch, rising, with both ends."""
    count = 2
    for i in range(group.size):
        if group[i] == g:
            count += times[i] * orbit.count[i]
    found = np.empty(count)
    found[0], found[1] = 0.0, joint
    k = 2
    for i in range(group.size):
        if group[i] == g:
            for n in range(times[i]):
                for q in range(orbit.count[i]):
                    turns = (orbit.start[i, q] - orbit.lag[i]) / orbit.period[i] + n
                    turns = turns + times[i] if turns < 0 else turns
                    found[k] = min(turns / times[i] * joint, joint)
                    k += 1
    return np.sort(found)


@njit(error_model="numpy")
def _step(system, orbit, group, times, joint, g, t, end, degree):
    """How far from t the motion is smooth enough for ten places: SLOW of the quickest exponential that is left."""
    length = end - t
    rate = 0.0
    probe = t + 1e-9 * length
    for i in range(group.size):
        if group[i] != g:
            continue
        local = _local(orbit, i, probe, joint, times[i])
        q = stretch_at(orbit, i, local)
        since = local - orbit.start[i, q]
        length = min(length, orbit.length[i, q] / (1 + degree // 14) * 1.000001)
        for r in range(system.lam.size):
            if orbit.amplitude[i, q, r] != 0j and system.lam[r].real * since > FADED:
                # The further it has decayed, the less exactly its shape must be met.
                rate = max(rate, abs(system.lam[r]) / (1.0 - 0.125 * system.lam[r].real * since))
    if rate > 0.0:
        length = min(length, SLOW / rate)
    return end if t + 1.0001 * length >= end else t + length


@njit(error_model="numpy")
def group_motion(system, orbit, group, times, joint, g, degree):
    """Walk through group g's joint period.

    Returns the mean and the mean square about it of all outputs, (y,) each, the outputs (k, y) at k places, and the places'
    times with the first and last time of each place's step, (k, 3).
    """
    rows = system.D0.shape[1]
    room = 512
    nodes, times_of = np.empty((room, rows)), np.empty((room, 3))
    first, mean, square = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    n = PLACES.size
    at, v, wave, out = np.zeros(n), np.zeros(n), np.zeros((2, n)), np.zeros((rows, n))
    corners = _corners(orbit, group, times, joint, g)
    k = 0
    for c in range(corners.size - 1):
        t, end = corners[c], corners[c + 1]
        if end - t <= 1e-13 * joint:
            continue
        while t < end:
            stop = _step(system, orbit, group, times, joint, g, t, end, degree)
            middle, span = 0.5 * (t + stop), stop - t
            for p in range(n):
                at[p] = t + span * PLACES[p]
            group_outputs(system, orbit, group, times, joint, g, at, n, middle, v, wave, 0, rows, out)
            if k == 0:
                first[:] = out[:, 0]
            if k + n > room:
                room *= 2
                more, more_times = np.empty((room, rows)), np.empty((room, 3))
                more[:k], more_times[:k] = nodes[:k], times_of[:k]
                nodes, times_of = more, more_times
            for j in range(rows):
                for p in range(n):
                    value = out[j, p] - first[j]
                    weight = WEIGHTS[p] * span / joint
                    mean[j] += weight * value
                    square[j] += weight * value * value
            for p in range(n):
                for j in range(rows):
                    nodes[k + p, j] = out[j, p]
                times_of[k + p, 0], times_of[k + p, 1], times_of[k + p, 2] = at[p], t, stop
            k += n
            t = stop
    for j in range(rows):
        square[j] = max(square[j] - mean[j] * mean[j], 0.0)
        mean[j] += first[j]
    return mean, square, nodes[:k], times_of[:k]
