"""The steady motion that each contact's shape makes at a constant speed, over one passing of its pattern (compiled).

An orbit is a table of stretches in time, each with polynomials and exponentials (``pieces``), that closes on itself: what the
states have at the start, w₀ = w_P/(1 − e^{λP}), they have again after the period P. The steady motion of the machine is the sum
of its inputs' orbits, each at its own place.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.motion.pieces import BEYOND, TERMS, compose, difference, evaluate, expand, expm1, parts, used_terms

# A pole whose period fits into the pattern's this closely is hit by a harmonic.
HIT = 1e-13


class Orbits(NamedTuple):
    """Tables of m inputs, padded to q stretches. Times count from each orbit's origin, where the pattern's first edge passes.

    period     s, (m,); inf for an input that stands or is round
    lag        time since the origin at t = 0, s, (m,)
    count      stretches, (m,)
    start, length   of each stretch, s, (m, q)
    terms      coefficients in use, (m, q)
    Y          polynomials in v of all outputs, (m, q, y, terms)
    amplitude  of the exponentials, (m, q, R)
    rest       output of the inputs that stand or are round, (y,)
    """

    period: np.ndarray
    lag: np.ndarray
    count: np.ndarray
    start: np.ndarray
    length: np.ndarray
    terms: np.ndarray
    Y: np.ndarray
    amplitude: np.ndarray
    rest: np.ndarray


@njit(error_model="numpy")
def height(shapes, i, angle):
    """h of input i at the wheel's ``angle``, rad."""
    first = shapes.edges[i, 0]
    place = angle + shapes.phase[i] - first
    place = first + place - math.floor(place / shapes.period[i]) * shapes.period[i]
    j = 0
    while j < shapes.count[i] - 1 and place >= shapes.edges[i, j + 1]:
        j += 1
    u = (place - shapes.edges[i, j]) / (shapes.edges[i, j + 1] - shapes.edges[i, j])
    value = 0.0
    for k in range(shapes.coefficients.shape[2] - 1, -1, -1):
        value = value * u + shapes.coefficients[i, j, k]
    return value


@njit(error_model="numpy")
def varies(shapes, i):
    """Whether input i has any shape."""
    for j in range(shapes.count[i]):
        for k in range(1, shapes.coefficients.shape[2]):
            if shapes.coefficients[i, j, k] != 0.0:
                return True
    return False


@njit(error_model="numpy")
def orbits(system, shapes, speed, angle):
    """The orbits of all inputs at ``speed`` (m,), rad/s, wheels at ``angle`` (m,) at t = 0, and the (input, pole) that hits.

    The pair is (−1, −1) where none does: an undamped pole hit by a harmonic of a shape has no steady motion.
    """
    m, R, rows = shapes.period.size, system.lam.size, system.D0.shape[1]
    degree = shapes.coefficients.shape[2] - 1
    period, lag, count = np.full(m, np.inf), np.zeros(m), np.zeros(m, np.int64)
    rest = np.zeros(rows)
    most = 1
    for i in range(m):
        if speed[i] == 0.0 or not varies(shapes, i):
            h = height(shapes, i, angle[i])
            for j in range(rows):
                rest[j] += system.D0[i, j] * h
            continue
        period[i] = shapes.period[i] / abs(speed[i])
        lag[i] = _lag(shapes, i, speed[i], angle[i])
        for j in range(shapes.count[i]):
            count[i] += parts(system.lam, (shapes.edges[i, j + 1] - shapes.edges[i, j]) / abs(speed[i]), degree)
        most = max(most, count[i])
    h, x, aside, nothing = _room(system, shapes)
    answer = _tables(period, lag, count, rest, most, h.shape[1], R)
    w = np.zeros(R, np.complex128)
    for i in range(m):
        if count[i] == 0:
            continue
        w[:] = 0j
        _along(system, shapes, i, speed[i], np.inf, w, h, x, aside, nothing)
        hit = _close(system, i, period[i], w, _scale(shapes, i))
        if hit >= 0:
            return answer, (i, hit)
        _along(system, shapes, i, speed[i], np.inf, w, h, x, aside, answer)
    return answer, (-1, -1)


@njit(error_model="numpy")
def steady_states(system, shapes, speed, angle):
    """The states at t = 0 of the steady motion, (R,); only where ``orbits`` finds one."""
    w, total = np.zeros(system.lam.size, np.complex128), np.zeros(system.lam.size, np.complex128)
    h, x, aside, nothing = _room(system, shapes)
    for i in range(shapes.period.size):
        if speed[i] == 0.0 or not varies(shapes, i):
            continue
        w[:] = 0j
        _along(system, shapes, i, speed[i], np.inf, w, h, x, aside, nothing)
        _close(system, i, shapes.period[i] / abs(speed[i]), w, _scale(shapes, i))
        _along(system, shapes, i, speed[i], _lag(shapes, i, speed[i], angle[i]), w, h, x, aside, nothing)
        total += w
    return total


@njit(error_model="numpy")
def _lag(shapes, i, speed, angle):
    """Time since input i's pattern passed its origin, s."""
    place = (angle + shapes.phase[i] - shapes.edges[i, 0]) / shapes.period[i]
    place -= math.floor(place)
    return (place if speed > 0 else 1.0 - place) * shapes.period[i] / abs(speed)


@njit(error_model="numpy")
def _tables(period, lag, count, rest, stretches, terms, R):
    """Orbits with nothing in their tables yet."""
    m, rows = period.size, rest.size
    start, length, used = np.zeros((m, stretches)), np.zeros((m, stretches)), np.ones((m, stretches), np.int64)
    Y, amplitude = np.zeros((m, stretches, rows, terms)), np.zeros((m, stretches, R), np.complex128)
    return Orbits(period, lag, count, start, length, used, Y, amplitude, rest)


@njit(error_model="numpy")
def _room(system, shapes):
    """Room for the shapes' polynomials, the states', the exponentials', and orbits that keep nothing."""
    m, R = shapes.period.size, system.lam.size
    terms = max(TERMS, shapes.coefficients.shape[2] - 1 + BEYOND) + 1
    none = np.zeros(m)
    nothing = _tables(none, none, np.zeros(m, np.int64), np.zeros(0), 0, terms, R)
    return np.zeros((m, terms)), np.zeros((2, terms), np.complex128), np.zeros(R, np.complex128), nothing


@njit(error_model="numpy")
def _along(system, shapes, i, speed, until, w, h, x, aside, orbit):
    """Carry w through one pattern of input i, or to the time ``until``; the outputs go into ``orbit``, if it has room."""
    t, q = 0.0, 0
    pieces, degree = shapes.count[i], shapes.coefficients.shape[2] - 1
    keep = orbit.start.shape[1] > 0
    nothing = np.zeros((0, h.shape[1]))
    h[:] = 0.0
    for step in range(pieces):
        j = step if speed > 0 else pieces - 1 - step
        whole = (shapes.edges[i, j + 1] - shapes.edges[i, j]) / abs(speed)
        duration = min(whole, until - t)
        if not duration > 0.0:
            return
        cuts = parts(system.lam, duration, degree)
        T, share = duration / cuts, duration / whole / cuts
        for cut in range(cuts):
            u0, u1 = (cut * share, share) if speed > 0 else (1.0 - cut * share, -share)
            compose(shapes.coefficients[i, j], u0, u1, 0.0, h[i])
            Y = orbit.Y[i, q] if keep else nothing
            expand(system, h, i, i + 1, T, w, x, Y, orbit.amplitude[i, q] if keep else aside)
            if keep:
                orbit.start[i, q], orbit.length[i, q], orbit.terms[i, q] = t + cut * T, T, used_terms(Y)
            q += 1
        t += whole


@njit(error_model="numpy")
def _scale(shapes, i):
    """How far the shape's pieces rise and fall, m."""
    total = 0.0
    for j in range(shapes.count[i]):
        for k in range(1, shapes.coefficients.shape[2]):
            total += abs(shapes.coefficients[i, j, k])
    return total


@njit(error_model="numpy")
def _close(system, i, P, w, scale):
    """From what rest becomes over a period to the state that comes back after it; the number of a pole without one, else −1."""
    lam, link, b = system.lam, system.link, system.b
    for r in range(lam.size):
        missing = -expm1(lam[r] * P)
        if link[r] == 1:
            w[r] += w[r - 1] * difference(lam[r - 1], lam[r], P)
        if abs(missing) <= HIT * (1.0 + abs(lam[r]) * P):
            if abs(w[r]) > 1e-11 * scale * abs(b[r, i]):
                return r
            w[r] = 0j
        else:
            w[r] /= missing
    return -1


@njit(error_model="numpy")
def stretch_at(orbit, i, local):
    """Number of the stretch of input i's orbit that holds ``local`` time."""
    low, high = 0, orbit.count[i] - 1
    while low < high:
        middle = (low + high + 1) // 2
        if orbit.start[i, middle] <= local:
            low = middle
        else:
            high = middle - 1
    return low


@njit(error_model="numpy")
def outputs_at(system, orbit, time, out):
    """All outputs at ``time`` (k,), s, into ``out`` (y, k)."""
    rows = out.shape[0]
    one, v, wave = np.zeros((rows, 1)), np.zeros(1), np.zeros((2, 1))
    for s in range(time.size):
        one[:, 0] = orbit.rest
        for i in range(orbit.period.size):
            if orbit.count[i] > 0:
                P = orbit.period[i]
                turns = time[s] / P
                local = (turns - math.floor(turns)) * P + orbit.lag[i]
                local = local - P if local >= P else local
                q = stretch_at(orbit, i, local)
                T = orbit.length[i, q]
                v[0] = min(max((local - orbit.start[i, q]) / T, 0.0), 1.0)
                evaluate(system, orbit.Y[i, q], orbit.terms[i, q], orbit.amplitude[i, q], v, 1, T, wave, 0, rows, one)
        for j in range(rows):
            out[j, s] = one[j, 0]
