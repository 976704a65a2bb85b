"""Means, RMS values and peaks of a steady motion (compiled): variances of groups add, see ``groups`` and ``peaks``."""

from __future__ import annotations

import numpy as np

from spheredrive.compiled import njit
from spheredrive.vibration.motion.groups import group_motion, groups
from spheredrive.vibration.motion.peaks import peak_length, support


@njit(error_model="numpy")
def statistics(system, orbit, degree, vectors):
    """Mean and variance of all outputs (y,), peak of each vector (vectors,), least and largest of the other outputs."""
    rows = system.D0.shape[1]
    group, times, joint, count = groups(orbit.period)
    mean, variance = orbit.rest.copy(), np.zeros(rows)
    first = np.zeros(count + 1, np.int64)
    nodes, node_times = np.empty((0, rows)), np.empty((0, 3))
    for g in range(count):
        m, v, own, own_times = group_motion(system, orbit, group, times, joint[g], g, degree)
        for j in range(rows):
            mean[j], variance[j] = mean[j] + m[j], variance[j] + v[j]
        k, n = nodes.shape[0], own.shape[0]
        more, more_times = np.empty((k + n, rows)), np.empty((k + n, 3))
        more[:k], more[k:], more_times[:k], more_times[k:] = nodes, own, node_times, own_times
        nodes, node_times = more, more_times
        first[g + 1] = k + n
    # Two rows more than outputs, so that one output can be looked at as if it were a vector's first.
    room = np.zeros(1), np.zeros(1), np.zeros((2, 1)), np.zeros((rows + 2, 1))
    peak = np.zeros(vectors)
    for k in range(vectors):
        peak[k] = peak_length(system, orbit, group, times, joint, count, 3 * k, orbit.rest, nodes, node_times, first, room)
    point = np.zeros(3)
    low, high = orbit.rest[3 * vectors :].copy(), orbit.rest[3 * vectors :].copy()
    for g in range(count):
        own, own_times = nodes[first[g] : first[g + 1]], node_times[first[g] : first[g + 1]]
        for j in range(rows - 3 * vectors):
            c = 3 * vectors + j
            low[j] -= support(system, orbit, group, times, joint[g], g, c, -1.0, 0.0, 0.0, own, own_times, room, point)
            high[j] += support(system, orbit, group, times, joint[g], g, c, 1.0, 0.0, 0.0, own, own_times, room, point)
    return mean, variance, peak, low, high
