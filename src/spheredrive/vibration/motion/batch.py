"""Steady statistics of many machines at once (compiled), by the functions that serve one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numba
import numpy as np

from spheredrive.compiled import njit
from spheredrive.errors import SpheredriveError
from spheredrive.vibration.model.equations import closure_matrices, contact_equations, contact_rows, contacts_of
from spheredrive.vibration.model.links import linked_form
from spheredrive.vibration.model.modal import ILL, modal_form, undamped_modes
from spheredrive.vibration.model.small import solve
from spheredrive.vibration.model.system import linear_system, outputs
from spheredrive.vibration.motion.groups import group_motion, groups
from spheredrive.vibration.motion.orbit import orbits, varies
from spheredrive.vibration.motion.response import SWINGS
from spheredrive.vibration.motion.shapes import Shapes, shapes_of
from spheredrive.vibration.motion.steady import statistics

if TYPE_CHECKING:
    from spheredrive.design import Design

# How a machine went; LINKED ones are done again, one by one.
DONE, RESONANT, UNHELD, LINKED, CRAWLING = 0, 1, 2, 3, 4
ORDERS = ("displacement", "velocity", "acceleration")
# Machines a thread takes at a time.
PIECE = 256


@dataclass(frozen=True, eq=False)
class SteadyStatistics:
    """Statistics of a batch (...); d modes.

    natural_frequencies   Hz, rising, (..., d)
    peak_displacement, peak_velocity, peak_acceleration   of the centre, m, m/s, m/s², (...)
    rms_displacement      about the mean, m, (...)
    rms_velocity, rms_acceleration   m/s, m/s², (...)
    mean_displacement     m, (..., 3)
    valid                 whether a machine has a steady motion, (...); NaN stands in the others' entries
    status                why not, (...): ``UNHELD``, nothing holds the sphere in some direction; ``RESONANT``, an undamped
                          natural frequency is hit; ``CRAWLING``, it would ring too often while one roller passes; else ``DONE``

    What was not asked for is None.
    """

    natural_frequencies: np.ndarray
    peak_displacement: np.ndarray | None
    peak_velocity: np.ndarray | None
    peak_acceleration: np.ndarray | None
    rms_displacement: np.ndarray | None
    rms_velocity: np.ndarray | None
    rms_acceleration: np.ndarray | None
    mean_displacement: np.ndarray | None
    valid: np.ndarray
    status: np.ndarray


def steady_statistics(
    design: Design,
    wheel_speed,
    *,
    wheel_angle=0.0,
    sphere_mass=None,
    contact_stiffness=None,
    contact_damping=None,
    mount_stiffness=None,
    mount_damping=None,
    closure_stiffness=None,
    closure_damping=None,
    wheel_mass=None,
    contact_direction=None,
    profiles=None,
    profile_index=None,
    peaks: bool = True,
    of: Sequence[str] = ORDERS,
) -> SteadyStatistics:
    """RMS, peak and natural frequencies of many variants of a design at constant wheel speeds, coupled model.

    wheel_speed         ω, rad/s, (..., n)
    wheel_angle         ϑ at t = 0, rad, (..., n)
    sphere_mass         M_s, kg, (...); stiffnesses N/m and dampings N s/m of contact, mount and pads of the closure, (...); the
                        design's if absent
    wheel_mass          mass that rides on each contact's mount, kg, (..., n)
    contact_direction   R̂ of each contact, (..., n, 3); made unit vectors; pads stand opposite
    profiles            ``shape.Profile`` values to choose from, the design's own if absent
    profile_index       number of each contact's profile among them, from 0, (..., n)
    peaks               whether peaks are sought
    of                  which of "displacement", "velocity" and "acceleration" are looked at; what is left out saves time

    All broadcast. Every entry is what ``response`` and ``modes`` give for that design, to the same bits for any batch and any
    number of threads; where ``of`` leaves something out, to rounding. Contacts must give way; the design says whether mounts
    do. Raises ``SpheredriveError`` for values that no machine has. Source: model.md section 5b.
    """
    contacts = contacts_of(design)
    m = len(contacts.wheel)
    if not of or not set(of) <= set(ORDERS):
        raise SpheredriveError(f"statistics are of {', '.join(ORDERS)}, not {', '.join(map(str, of))}")
    if design.contact.stiffness is None and contact_stiffness is None:
        raise SpheredriveError("steady_statistics needs contacts that give way: contact.stiffness or contact_stiffness")
    compliant = design.mount.stiffness is not None
    if not compliant and (mount_stiffness is not None or mount_damping is not None):
        raise SpheredriveError("the design's mounts are rigid; give it mount.stiffness to vary it")
    if design.sphere.mass is None and sphere_mass is None:
        raise SpheredriveError("vibration needs sphere.mass")
    if compliant and contacts.mass is None and wheel_mass is None:
        raise SpheredriveError("wheels on compliant mounts vibrate by their mass: give it, or wheel_mass")
    given = [
        design.sphere.mass if sphere_mass is None else sphere_mass,
        design.contact.stiffness if contact_stiffness is None else contact_stiffness,
        design.contact.damping if contact_damping is None else contact_damping,
        (design.mount.stiffness or 0.0) if mount_stiffness is None else mount_stiffness,
        design.mount.damping if mount_damping is None else mount_damping,
        design.closure.stiffness if closure_stiffness is None else closure_stiffness,
        design.closure.damping if closure_damping is None else closure_damping,
    ]
    scalars = [np.asarray(a, float) for a in given]
    speed, angle = np.asarray(wheel_speed, float), np.asarray(wheel_angle, float)
    if speed.ndim == 0 or speed.shape[-1] != design.wheel_count:
        raise SpheredriveError(f"wheel_speed takes one speed for each of the {design.wheel_count} wheels, (..., n)")
    speed, angle = np.broadcast_arrays(speed, angle)
    normal = contacts.normal if contact_direction is None else -np.asarray(contact_direction, float)
    if normal.shape[-2:] != (m, 3):
        raise SpheredriveError(f"contact_direction takes three components for each of {m} contacts")
    mass = np.zeros(m) if not compliant else np.asarray(contacts.mass if wheel_mass is None else wheel_mass, float)
    if mass.shape[-1:] != (m,):
        raise SpheredriveError(f"wheel_mass takes a mass for each of {m} contacts")
    own = linear_system(design).profiles if profiles is None else tuple(profiles)
    index = np.arange(m) if profile_index is None else np.asarray(profile_index)
    if profile_index is None and len(own) != m:
        raise SpheredriveError(f"say by profile_index which of {len(own)} profiles each of {m} contacts has")
    if index.shape[-1:] != (m,) or index.dtype.kind != "i" or index.min() < 0 or index.max() >= len(own):
        raise SpheredriveError("profile_index takes the number, from 0, of a profile for each contact")
    shape = np.broadcast_shapes(
        *(a.shape for a in scalars), speed.shape[:-1], normal.shape[:-2], index.shape[:-1], mass.shape[:-1]
    )
    count = int(np.prod(shape, dtype=int))
    S = np.stack([np.broadcast_to(a, shape).reshape(count) for a in scalars], axis=1)
    positive, rest = S[:, [0, 1]], S[:, 2:]
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    if not (np.isfinite(S).all() and (positive > 0).all() and (rest >= 0).all() and np.isfinite(speed).all()):
        raise SpheredriveError("masses and contact stiffnesses are above zero, the other constants not negative, speeds finite")
    if compliant and not (np.isfinite(mass).all() and (mass > 0).all()):
        raise SpheredriveError("wheels on compliant mounts have masses above zero")
    if not (np.isfinite(normal).all() and np.isfinite(angle).all() and (length > 0).all()):
        raise SpheredriveError("directions must point somewhere and angles be finite")
    wheel = contacts.wheel
    # Copies all: to Numba an array that cannot be written is another kind, to be compiled for anew.
    flat = [
        np.array(np.broadcast_to(a, (*shape, *a.shape[a.ndim - k :])).reshape(count, *a.shape[a.ndim - k :]), order="C")
        for a, k in ((normal / length, 2), (speed[..., wheel], 1), (angle[..., wheel], 1), (index, 1), (mass, 1))
    ]
    # A split wheel has its other half where its pad would be: a wheel's first contact alone has one.
    pads = np.unique(wheel, return_index=True)[1]
    springs = replace(design, closure=replace(design.closure, stiffness=0.0, damping=0.0))
    orders = np.array([k for k in range(3) if ORDERS[k] in of])
    common = (pads, *closure_matrices(springs, contacts.normal, m, 1.0), shapes_of(own), compliant, peaks, orders)
    result = np.zeros((count, 9 + (3 + m if compliant else 3)))
    status = np.zeros(count, np.int64)
    _in_threads(S, *flat, *common, result, status)
    for b in np.flatnonzero(status == LINKED):
        result[b], status[b] = _linked(S[b], *(a[b] for a in flat), *common)
    result[status != DONE] = np.nan
    parts = result.reshape(*shape, -1)
    tops = [parts[..., k] if peaks and k in orders else None for k in range(3)]
    spread = [parts[..., 3 + k] if k in orders else None for k in range(3)]
    fields = [parts[..., 9:], *tops, *spread, parts[..., 6:9] if 0 in orders else None]
    return SteadyStatistics(*fields, (status == DONE).reshape(shape), status.reshape(shape))


def _in_threads(S, *per_machine_and_common):
    """``_some`` over all rows, in pieces that threads share: rows do not touch each other."""
    count = len(S)
    pieces = [(first, min(first + PIECE, count)) for first in range(0, count, PIECE)]
    if len(pieces) <= 1:
        _some(0, count, S, *per_machine_and_common)
        return
    # Threads of Python's own: compiled for numba's, the loop takes a quarter of a minute to compile.
    with ThreadPoolExecutor(numba.get_num_threads()) as pool:
        list(pool.map(lambda piece: _some(*piece, S, *per_machine_and_common), pieces))


@njit(error_model="numpy", nogil=True)
def _some(
    first,
    last,
    S,
    normal,
    speed,
    angle,
    index,
    mass,
    pads,
    closure_K,
    closure_D,
    shapes,
    compliant,
    peaks,
    orders,
    result,
    status,
):
    """Rows ``first`` to ``last``: peaks (3), RMS (3), mean (3), natural frequencies (d) of each; and how it went."""
    for b in range(first, last):
        status[b] = _one(
            S[b], normal[b], speed[b], angle[b], index[b], mass[b], pads, closure_K, closure_D, shapes, compliant, peaks,
            orders, result[b],
        )  # fmt: skip


@njit(error_model="numpy")
def _matrices(S, n_hat, mass, pads, closure_K, closure_D, compliant):
    """Equations of one machine whose contacts are alike."""
    one = np.ones(n_hat.shape[0])
    if S[5] != 0.0 or S[6] != 0.0:
        closure_K, closure_D = closure_K.copy(), closure_D.copy()
        for i in pads:
            for a in range(3):
                for e in range(3):
                    closure_K[a, e] += S[5] * n_hat[i, a] * n_hat[i, e]
                    closure_D[a, e] += S[6] * n_hat[i, a] * n_hat[i, e]
    M, D, K, Bk, Bc = contact_equations(
        n_hat, S[0], mass, S[1] * one, S[2] * one, S[3] * one, S[4] * one, closure_K, closure_D, compliant
    )  # fmt: skip
    rows = contact_rows(n_hat, np.eye(3), S[1] * one, S[2] * one, compliant)
    return M, D, K, Bk, Bc, rows


@njit(error_model="numpy")
def _one(S, n_hat, speed, angle, index, mass, pads, closure_K, closure_D, shapes, compliant, peaks, orders, result):
    M, D, K, Bk, Bc, rows = _matrices(S, n_hat, mass, pads, closure_K, closure_D, compliant)
    squared, _ = undamped_modes(M, K)
    if not squared[0] > 1e-12 * squared[-1]:
        return UNHELD
    for k in range(squared.size):
        result[9 + k] = np.sqrt(squared[k]) / (2.0 * np.pi)
    lam, link, b, V, worst = modal_form(M, D, K, Bk, Bc)
    if not worst < ILL:
        return LINKED
    return _measured((lam, link, b, V), M, K, Bk, Bc, rows, speed, angle, index, shapes, peaks, orders, result)


@njit(error_model="numpy")
def _measured(form, M, K, Bk, Bc, rows, speed, angle, index, shapes, peaks, orders, result):
    """Statistics of the centre, with the rows of the contact forces and of what is not asked for left out."""
    d, m = Bk.shape
    kept = np.empty(3 * orders.size, np.int64)
    for k in range(orders.size):
        for e in range(3):
            kept[3 * k + e] = 3 * orders[k] + e
    Rq, Rv, Ra, Rh, Rs = rows
    system = outputs(
        form, solve(K, Bk), np.zeros((d, m)), solve(M, Bc), np.eye(d), np.zeros((d, m)),
        Rq[kept], Rv[kept], Ra[kept], Rh[kept], Rs[kept],
    )  # fmt: skip
    own = Shapes(
        shapes.period[index], shapes.phase[index], shapes.count[index], shapes.edges[index], shapes.coefficients[index]
    )
    if _crawls(system.lam, own, speed):
        return CRAWLING
    orbit, hit = orbits(system, own, speed, angle)
    if hit[0] >= 0:
        return RESONANT
    degree, vectors = shapes.coefficients.shape[2] - 1, system.D0.shape[1] // 3
    if peaks:
        mean, variance, peak, _, _ = statistics(system, orbit, degree, vectors)
    else:
        mean, variance = _mean_and_variance(system, orbit, degree)
        peak = np.zeros(vectors)
    for k in range(orders.size):
        order, total = orders[k], 0.0
        for e in range(3):
            total += variance[3 * k + e] + (mean[3 * k + e] ** 2 if order > 0 else 0.0)
        result[order], result[3 + order] = peak[k], np.sqrt(total)
    if orders[0] == 0:
        result[6:9] = mean[:3]
    return DONE


@njit(error_model="numpy")
def _mean_and_variance(system, orbit, degree):
    """What ``statistics`` finds of them, without its search for peaks."""
    group, times, joint, count = groups(orbit.period)
    mean, variance = orbit.rest.copy(), np.zeros(orbit.rest.size)
    for g in range(count):
        m, v, _, _ = group_motion(system, orbit, group, times, joint[g], g, degree)
        for j in range(mean.size):
            mean[j], variance[j] = mean[j] + m[j], variance[j] + v[j]
    return mean, variance


@njit(error_model="numpy")
def _crawls(lam, shapes, speed):
    """Whether the machine would swing more than ``SWINGS`` times while one roller passes, as ``response`` refuses it."""
    longest = 0.0
    for i in range(speed.size):
        if speed[i] != 0.0 and varies(shapes, i):
            longest = max(longest, shapes.period[i] / abs(speed[i]))
    for r in range(lam.size):
        decay = max(-lam[r].real, 0.0)
        lasting = longest if decay * longest <= 40.0 else 40.0 / decay
        if abs(lam[r].imag) / (2.0 * math.pi) * lasting > SWINGS:
            return True
    return False


def _linked(S, n_hat, speed, angle, index, mass, pads, closure_K, closure_D, shapes, compliant, peaks, orders):
    """One machine whose poles must be linked."""
    M, D, K, Bk, Bc, rows = _matrices(S, n_hat, mass, pads, closure_K, closure_D, compliant)
    squared, _ = undamped_modes(M, K)
    result = np.zeros(9 + len(M))
    result[9:] = np.sqrt(squared) / (2 * np.pi)
    form = linked_form(M, D, K, Bk, Bc)
    status = _measured(tuple(form), M, K, Bk, Bc, rows, speed, angle, index, shapes, peaks, orders, result)
    return result, status
