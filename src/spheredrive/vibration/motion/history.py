"""The motion that follows any history of wheel speeds, exactly, from corner to corner (compiled).

Wheel speeds run straight between knots, so that angles are quadratic in time and a shape's polynomial of the angle is one of
time, of twice the degree. The corner a wheel meets next is known by counting: each input carries the number of its piece and
of its pattern, and the time it takes to the piece's end is the root of a quadratic equation.
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.motion.pieces import BEYOND, TERMS, compose, evaluate, expand, parts, used_terms

# Samples taken together.
BATCH = 64


@njit(error_model="numpy")
def locate(shapes, i, angle):
    """Piece and pattern number of input i at the wheel's ``angle``."""
    place = angle + shapes.phase[i] - shapes.edges[i, 0]
    turns = math.floor(place / shapes.period[i])
    place = shapes.edges[i, 0] + place - turns * shapes.period[i]
    j = 0
    while j < shapes.count[i] - 1 and place >= shapes.edges[i, j + 1]:
        j += 1
    return j, int(turns)


@njit(error_model="numpy")
def _until_edge(target, angle, speed, acceleration):
    """Time at which a wheel that starts at ``angle`` and does not turn back meets ``target``; inf where it does not."""
    sense = 1.0 if speed > 0 or (speed == 0 and acceleration > 0) else -1.0
    way = target - angle
    under = speed * speed + 2.0 * acceleration * way
    if way * sense <= 0.0:
        return 0.0
    if under < 0.0:
        return np.inf
    below = speed + sense * math.sqrt(under)
    return 2.0 * way / below if below != 0.0 else np.inf


@njit(error_model="numpy")
def _meet(shapes, i, place, angle, speed, acceleration):
    """When input i meets the end of its piece, and in what sense it moves (0: it stands)."""
    if speed == 0.0 and acceleration == 0.0:
        return np.inf, 0
    j, turns = place[i, 0], place[i, 1]
    forward = speed > 0 or (speed == 0 and acceleration > 0)
    edge = shapes.edges[i, j + 1] if forward else shapes.edges[i, j]
    # Whole patterns are taken off before the angles are subtracted.
    start = angle + shapes.phase[i] - turns * shapes.period[i]
    return _until_edge(edge, start, speed, acceleration), 1 if forward else -1


@njit(error_model="numpy")
def march(system, shapes, wheel, knots, angle, speed, acceleration, place, w, clock, time, out):
    """Carry the states w from ``clock[0]`` to the last of ``time`` (s,), outputs at these times into ``out`` (y, s).

    ``knots`` (k + 1,) are times between which wheels move steadily, ``angle``, ``speed``, ``acceleration`` (k, n) theirs at
    each knot; no wheel turns back between two knots. ``wheel`` (m,) is each input's wheel, ``place`` (m, 2) its piece and
    pattern. ``w``, ``place`` and ``clock`` are left as they are at the end. At a corner outputs are those after it.
    """
    m, rows = wheel.size, out.shape[0]
    degree = shapes.coefficients.shape[2] - 1
    for k in range(acceleration.shape[0]):
        for i in range(acceleration.shape[1]):
            if acceleration[k, i] != 0.0:
                degree = 2 * (shapes.coefficients.shape[2] - 1)
    terms = max(TERMS, degree + BEYOND) + 1
    h, x = np.zeros((m, terms)), np.zeros((2, terms), np.complex128)
    Y, nothing, amplitude = np.zeros((rows, terms)), np.zeros((0, terms)), np.zeros(w.size, np.complex128)
    ends, senses = np.zeros(m), np.zeros(m, np.int64)
    v, wave, some = np.zeros(BATCH), np.zeros((2, BATCH)), np.zeros((rows, BATCH))
    t, last = clock[0], time[time.size - 1]
    s, k = 0, 0
    while s < time.size:
        while k < knots.size - 2 and t >= knots[k + 1]:
            k += 1
        stop = min(knots[k + 1], last) if k < knots.size - 2 else last
        for i in range(m):
            n = wheel[i]
            since, senses[i] = _meet(shapes, i, place, angle[k, n], speed[k, n], acceleration[k, n])
            ends[i] = max(knots[k] + since, t)
            stop = min(stop, ends[i])
        T = stop - t
        if T > 0.0:
            cuts = parts(system.lam, T, degree)
            T /= cuts
            for cut in range(cuts):
                begin = t + cut * T
                _shapes_along(shapes, wheel, place, angle[k], speed[k], acceleration[k], begin - knots[k], T, h)
                end = stop if cut == cuts - 1 else begin + T
                here = s
                while here < time.size and (time[here] < end or (end == last and time[here] <= end)):
                    here += 1
                if here == s:
                    expand(system, h, 0, m, T, w, x, nothing, amplitude)
                    continue
                expand(system, h, 0, m, T, w, x, Y, amplitude)
                used = used_terms(Y)
                while s < here:
                    count = min(BATCH, here - s)
                    for p in range(count):
                        v[p] = min(max((time[s + p] - begin) / T, 0.0), 1.0)
                    some[:] = 0.0
                    evaluate(system, Y, used, amplitude, v, count, T, wave, 0, rows, some)
                    for j in range(rows):
                        for p in range(count):
                            out[j, s + p] = some[j, p]
                    s += count
        elif stop == last and ends.min() > t:
            # The last sample falls on a corner that has just been passed.
            _shapes_along(shapes, wheel, place, angle[k], speed[k], acceleration[k], t - knots[k], 1e-9, h)
            expand(system, h, 0, m, 1e-9, w.copy(), x, Y, amplitude)
            v[0] = 0.0
            some[:] = 0.0
            evaluate(system, Y, terms, amplitude, v, 1, 1e-9, wave, 0, rows, some)
            while s < time.size:
                for j in range(rows):
                    out[j, s] = some[j, 0]
                s += 1
        t = stop
        for i in range(m):
            if ends[i] <= t and senses[i] != 0:
                _cross(shapes, i, place, senses[i])
    clock[0] = t


@njit(error_model="numpy")
def _cross(shapes, i, place, sense):
    """Take input i into the next piece."""
    place[i, 0] += sense
    if place[i, 0] == shapes.count[i]:
        place[i, 0] = 0
        place[i, 1] += 1
    elif place[i, 0] < 0:
        place[i, 0] = shapes.count[i] - 1
        place[i, 1] -= 1


@njit(error_model="numpy")
def _shapes_along(shapes, wheel, place, angle, speed, acceleration, since, T, h):
    """Each input's h as a polynomial in v over T s from ``since`` the knot, in ``h`` (m, terms)."""
    for i in range(wheel.size):
        n, j = wheel[i], place[i, 0]
        first, width = shapes.edges[i, j], shapes.edges[i, j + 1] - shapes.edges[i, j]
        start = angle[n] + shapes.phase[i] - place[i, 1] * shapes.period[i]
        u0 = (start + since * (speed[n] + 0.5 * since * acceleration[n]) - first) / width
        u1 = (speed[n] + since * acceleration[n]) * T / width
        u2 = 0.5 * acceleration[n] * T * T / width
        compose(shapes.coefficients[i, j], u0, u1, u2, h[i])
