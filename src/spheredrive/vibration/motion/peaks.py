"""Peaks of a steady motion (compiled): the longest vector of one group, or of several in all combinations of their phases.

Groups stand in no ratio of small whole numbers to each other: over all time every combination of their phases comes as near
as one likes, so that a peak is the largest over all phases, max over û of Σ_g max_t û · y_g(t).
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.motion.groups import group_outputs

# Directions in which the largest joint excursion is looked for: evenly spread (a golden spiral), so that none is farther than
# ``APART`` from one of them, rad.
_k = np.arange(128) + 0.5
_z = 1 - _k / 64
_turn = 2.399963229728653 * _k
DIRECTIONS = np.stack([np.sqrt(1 - _z**2) * np.cos(_turn), np.sqrt(1 - _z**2) * np.sin(_turn), _z])
APART = 0.241
# How many of them are climbed from at most.
STARTS = 12
# Places near which a peak is followed up to its top.
CANDIDATES = 4
# How often the direction of a joint peak is turned towards the refined peak.
TURNS = 4


@njit(error_model="numpy")
def _reaches(nodes, first, count, column, base):
    """max û · Σ y_g over all nodes of all groups for each of ``DIRECTIONS``."""
    ux, uy, uz = DIRECTIONS
    total = base[column] * ux + base[column + 1] * uy + base[column + 2] * uz
    most = np.empty(total.size)
    for g in range(count):
        most[:] = -np.inf
        for k in range(first[g], first[g + 1]):
            x, y, z = nodes[k, column], nodes[k, column + 1], nodes[k, column + 2]
            # Directions go innermost, so that the compiler uses vector instructions.
            for d in range(most.size):
                value = x * ux[d] + y * uy[d] + z * uz[d]
                most[d] = value if value > most[d] else most[d]
        total += most
    return total


@njit(error_model="numpy")
def _climb(nodes, first, count, column, base, x, y, z, place):
    """Climb from a direction to a farthest joint point: every group its farthest node along it, then towards their sum.

    ``place`` holds each group's node; returns the distance.
    """
    size = 0.0
    for _ in range(30):
        length = math.sqrt(x * x + y * y + z * z)
        if length == 0.0:
            return size
        ux, uy, uz = x / length, y / length, z / length
        x, y, z = base[column], base[column + 1], base[column + 2]
        moved = False
        for g in range(count):
            best, where = -np.inf, first[g]
            for k in range(first[g], first[g + 1]):
                value = ux * nodes[k, column] + uy * nodes[k, column + 1] + uz * nodes[k, column + 2]
                if value > best:
                    best, where = value, k
            moved = moved or place[g] != where
            place[g] = where
            x, y, z = x + nodes[where, column], y + nodes[where, column + 1], z + nodes[where, column + 2]
        size = math.sqrt(x * x + y * y + z * z)
        if not moved:
            return size
    return size


@njit(error_model="numpy")
def _rises(f, node_times, best):
    """How high the curve through each node and its neighbours goes, where it has a top there that may pass ``best``."""
    n = f.size
    rises = np.full(n, -np.inf)
    for k in range(n):
        before, after = max(k - 1, 0), min(k + 1, n - 1)
        if f[k] < f[before] or f[k] < f[after]:
            continue
        rises[k] = f[k]
        t = node_times[k, 0]
        if node_times[k, 1] < t < node_times[k, 2]:
            d1 = (f[k] - f[k - 1]) / (t - node_times[k - 1, 0])
            d2 = (f[k + 1] - f[k]) / (node_times[k + 1, 0] - t)
            bend = (d2 - d1) / (node_times[k + 1, 0] - node_times[k - 1, 0])
            slope = d1 + bend * (t - node_times[k - 1, 0])
            if bend < 0.0:
                rises[k] -= 0.25 * slope * slope / bend
        elif f[k] == best:
            # An end of a step: what lies beside it is looked at where it is the largest node itself.
            rises[k] = np.inf
    return rises


@njit(error_model="numpy")
def _value(system, orbit, group, times, joint, g, column, ux, uy, uz, t, middle, room):
    """u · y of group g at t."""
    at, v, wave, out = room
    at[0] = t
    group_outputs(
        system, orbit, group, times, joint, g, at, 1, middle, v, wave, column, min(column + 3, system.D0.shape[1]), out
    )
    return ux * out[column, 0] + uy * out[column + 1, 0] + uz * out[column + 2, 0]


@njit(error_model="numpy")
def _refined(system, orbit, group, times, joint, g, column, ux, uy, uz, nodes, node_times, k, room, point):
    """The largest u · y near node k of group g, by parabolas within its step; ``point`` gets y there."""
    begin, end = node_times[k, 1], node_times[k, 2]
    middle = 0.5 * (begin + end)
    a, c = k - 1 if node_times[k, 0] > begin else k, k + 1 if node_times[k, 0] < end else k
    t0, t1, t2 = node_times[a, 0], node_times[k, 0], node_times[c, 0]
    f0, f1, f2 = (
        _along(nodes, a, column, ux, uy, uz),
        _along(nodes, k, column, ux, uy, uz),
        _along(nodes, c, column, ux, uy, uz),
    )
    for e in range(3):
        point[e] = nodes[k, min(column + e, nodes.shape[1] - 1)]
    best = f1
    if a == k or c == k:
        t1 = 0.5 * (t0 + t2)
        f1 = _value(system, orbit, group, times, joint, g, column, ux, uy, uz, t1, middle, room)
    for _ in range(6):
        # The top of the parabola through the three; where it has none inside, an end is the largest.
        d1, d2 = (f1 - f0) / (t1 - t0), (f2 - f1) / (t2 - t1)
        bend = (d2 - d1) / (t2 - t0)
        if not bend < 0.0:
            break
        t = 0.5 * (t0 + t1) - 0.5 * d1 / bend
        if not t0 < t < t2 or t == t1:
            break
        f = _value(system, orbit, group, times, joint, g, column, ux, uy, uz, t, middle, room)
        if f > best:
            best = f
            for e in range(3):
                point[e] = room[3][column + e, 0]
        # Close to the top the value differs by the square of the distance.
        if abs(t - t1) < 3e-4 * (end - begin):
            break
        if (t < t1) == (f > f1):
            t2, f2 = (t1, f1) if t < t1 else (t, f)
            if t < t1:
                t1, f1 = t, f
        else:
            t0, f0 = (t, f) if t < t1 else (t1, f1)
            if t > t1:
                t1, f1 = t, f
    return best


@njit(error_model="numpy")
def _along(nodes, k, column, ux, uy, uz):
    """u · y at node k; a single output has uy = uz = 0."""
    value = ux * nodes[k, column]
    return value + uy * nodes[k, column + 1] + uz * nodes[k, column + 2] if uy != 0.0 or uz != 0.0 else value


@njit(error_model="numpy")
def _next_candidate(f, rises, best):
    """Take the node whose curve rises highest off the list; −1 where none beats ``best``."""
    where, most = -1, best
    for k in range(f.size):
        if rises[k] > most:
            most, where = rises[k], k
    if where >= 0:
        for k in range(max(0, where - 1), min(f.size, where + 2)):
            rises[k] = -np.inf
    return where


@njit(error_model="numpy")
def support(system, orbit, group, times, joint, g, column, ux, uy, uz, nodes, node_times, room, point):
    """The largest u · y of a group over its period; ``point`` gets y there."""
    n = nodes.shape[0]
    f, trial = np.empty(n), np.zeros(3)
    best = -np.inf
    for k in range(n):
        f[k] = _along(nodes, k, column, ux, uy, uz)
        if f[k] > best:
            best = f[k]
            for e in range(3):
                point[e] = nodes[k, min(column + e, nodes.shape[1] - 1)]
    rises = _rises(f, node_times, best)
    for _ in range(CANDIDATES):
        k = _next_candidate(f, rises, best)
        if k < 0:
            break
        value = _refined(system, orbit, group, times, joint, g, column, ux, uy, uz, nodes, node_times, k, room, trial)
        if value > best:
            best = value
            point[:] = trial
    return best


@njit(error_model="numpy")
def _single_peak(system, orbit, group, times, joint, column, base, nodes, node_times, room, point):
    """One group: its longest vector, refined where the curve through the nodes rises highest."""
    n = nodes.shape[0]
    f = np.empty(n)
    best = 0.0
    b0, b1, b2 = base[column], base[column + 1], base[column + 2]
    for k in range(n):
        x, y, z = b0 + nodes[k, column], b1 + nodes[k, column + 1], b2 + nodes[k, column + 2]
        f[k] = math.sqrt(x * x + y * y + z * z)
        best = max(best, f[k])
    rises = _rises(f, node_times, best)
    for _ in range(CANDIDATES):
        k = _next_candidate(f, rises, best)
        if k < 0:
            break
        x, y, z = b0 + nodes[k, column], b1 + nodes[k, column + 1], b2 + nodes[k, column + 2]
        for _ in range(2):
            size = math.sqrt(x * x + y * y + z * z)
            if size == 0.0:
                break
            x, y, z = x / size, y / size, z / size
            _refined(system, orbit, group, times, joint, 0, column, x, y, z, nodes, node_times, k, room, point)
            x, y, z = b0 + point[0], b1 + point[1], b2 + point[2]
        best = max(best, math.sqrt(x * x + y * y + z * z))
    return best


@njit(error_model="numpy")
def peak_length(system, orbit, group, times, joint, count, column, base, nodes, node_times, first, room):
    """The largest length of a vector output, over the joint period of one group or over all phases of several."""
    b0, b1, b2 = base[column], base[column + 1], base[column + 2]
    if count == 0:
        return math.sqrt(b0 * b0 + b1 * b1 + b2 * b2)
    point = np.zeros(3)
    if count == 1:
        return _single_peak(system, orbit, group, times, joint[0], column, base, nodes, node_times, room, point)
    place, best_place = np.full(count, -1), np.full(count, -1)
    reach = _reaches(nodes, first, count, column, base)
    best = 0.0
    for _ in range(STARTS):
        d = np.argmax(reach)
        # No direction near this one reaches beyond reach/cos APART: the largest has been found.
        if reach[d] < best * math.cos(APART):
            break
        reach[d] = -np.inf
        place[:] = -1
        size = _climb(nodes, first, count, column, base, DIRECTIONS[0, d], DIRECTIONS[1, d], DIRECTIONS[2, d], place)
        if size > best:
            best = size
            best_place[:] = place
    if best == 0.0:
        return best
    x, y, z = b0, b1, b2
    for g in range(count):
        k = best_place[g]
        x, y, z = x + nodes[k, column], y + nodes[k, column + 1], z + nodes[k, column + 2]
    for _ in range(TURNS):
        size = math.sqrt(x * x + y * y + z * z)
        ux, uy, uz = x / size, y / size, z / size
        x, y, z = b0, b1, b2
        for g in range(count):
            own, own_times = nodes[first[g] : first[g + 1]], node_times[first[g] : first[g + 1]]
            support(system, orbit, group, times, joint[g], g, column, ux, uy, uz, own, own_times, room, point)
            x, y, z = x + point[0], y + point[1], z + point[2]
        size = math.sqrt(x * x + y * y + z * z)
        best = max(best, size)
        # The peak grows by the square of what the direction still turns.
        if size == 0.0 or ux * x + uy * y + uz * z > (1.0 - 1e-9) * size:
            break
    return best
