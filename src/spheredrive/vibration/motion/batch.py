"""Steady statistics of many machines at once (compiled), by the functions that serve one."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
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
from spheredrive.vibration.motion.orbit import orbits
from spheredrive.vibration.motion.shapes import Shapes, shapes_of
from spheredrive.vibration.motion.steady import statistics

if TYPE_CHECKING:
    from spheredrive.design import Design

DONE, RESONANT, UNHELD, LINKED = 0, 1, 2, 3
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
    valid                 whether a machine has a steady motion, (...); NaN stands in the others' entries: nothing holds the
                          sphere in some direction, or an undamped natural frequency is hit
    """

    natural_frequencies: np.ndarray
    peak_displacement: np.ndarray
    peak_velocity: np.ndarray
    peak_acceleration: np.ndarray
    rms_displacement: np.ndarray
    rms_velocity: np.ndarray
    rms_acceleration: np.ndarray
    mean_displacement: np.ndarray
    valid: np.ndarray


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
    contact_direction=None,
    profiles=None,
    profile_index=None,
) -> SteadyStatistics:
    """RMS, peak and natural frequencies of many variants of a design at constant wheel speeds, coupled model.

    wheel_speed         ω, rad/s, (..., n)
    wheel_angle         ϑ at t = 0, rad, (..., n)
    sphere_mass         M_s, kg, (...); stiffnesses N/m and dampings N s/m of contact and mount, (...); the design's if absent
    contact_direction   R̂ of each contact, (..., n, 3); made unit vectors
    profiles            ``shape.Profile`` values to choose from, the design's own if absent
    profile_index       number of each contact's profile among them, from 0, (..., n)

    All broadcast. Every entry is what ``response`` and ``modes`` give for that design, to the same bits for any batch and any
    number of threads. Contacts must give way; the design says whether mounts do. Raises ``SpheredriveError`` for values that no
    machine has. Source: model.md section 5b.
    """
    base = linear_system(design)
    contacts = contacts_of(design)
    m = len(contacts.wheel)
    if design.contact.stiffness is None and contact_stiffness is None:
        raise SpheredriveError("steady_statistics needs contacts that give way: contact.stiffness or contact_stiffness")
    compliant = design.mount.stiffness is not None
    if not compliant and (mount_stiffness is not None or mount_damping is not None):
        raise SpheredriveError("the design's mounts are rigid; give it mount.stiffness to vary it")
    given = [
        design.sphere.mass if sphere_mass is None else sphere_mass,
        design.contact.stiffness if contact_stiffness is None else contact_stiffness,
        design.contact.damping if contact_damping is None else contact_damping,
        (design.mount.stiffness or 0.0) if mount_stiffness is None else mount_stiffness,
        design.mount.damping if mount_damping is None else mount_damping,
    ]
    scalars = [np.asarray(a, float) for a in given]
    speed, angle = np.asarray(wheel_speed, float), np.asarray(wheel_angle, float)
    if speed.ndim == 0 or speed.shape[-1] != design.wheel_count:
        raise SpheredriveError(f"wheel_speed takes one speed for each of the {design.wheel_count} wheels, (..., n)")
    speed, angle = np.broadcast_arrays(speed, angle)
    normal = contacts.normal if contact_direction is None else -np.asarray(contact_direction, float)
    if normal.shape[-2:] != (m, 3):
        raise SpheredriveError(f"contact_direction takes three components for each of {m} contacts")
    own = base.profiles if profiles is None else tuple(profiles)
    index = np.arange(m) if profile_index is None else np.asarray(profile_index)
    if profile_index is None and len(own) != m:
        raise SpheredriveError(f"say by profile_index which of {len(own)} profiles each of {m} contacts has")
    if index.shape[-1:] != (m,) or index.dtype.kind != "i" or index.min() < 0 or index.max() >= len(own):
        raise SpheredriveError("profile_index takes the number, from 0, of a profile for each contact")
    shape = np.broadcast_shapes(*(a.shape for a in scalars), speed.shape[:-1], normal.shape[:-2], index.shape[:-1])
    count = int(np.prod(shape, dtype=int))
    S = np.stack([np.broadcast_to(a, shape).reshape(count) for a in scalars], axis=1)
    positive, rest = S[:, [0, 1]], S[:, 2:]
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    if not (np.isfinite(S).all() and (positive > 0).all() and (rest >= 0).all() and np.isfinite(speed).all()):
        raise SpheredriveError("masses and contact stiffnesses are above zero, the other constants not negative, speeds finite")
    if not (np.isfinite(normal).all() and np.isfinite(angle).all() and (length > 0).all()):
        raise SpheredriveError("directions must point somewhere and angles be finite")
    wheel = contacts.wheel
    flat = [
        np.ascontiguousarray(np.broadcast_to(a, (*shape, *a.shape[a.ndim - k :])).reshape(count, *a.shape[a.ndim - k :]))
        for a, k in ((normal / length, 2), (speed[..., wheel], 1), (angle[..., wheel], 1), (index, 1))
    ]
    mass = contacts.mass if compliant else np.zeros(m)
    closure = closure_matrices(design, contacts.normal, m, 1.0)
    result = np.zeros((count, 9 + (3 + m if compliant else 3)))
    status = np.zeros(count, np.int64)
    _in_threads(S, *flat, mass, *closure, shapes_of(own), compliant, result, status)
    for b in np.flatnonzero(status == LINKED):
        result[b], status[b] = _linked(S[b], *(a[b] for a in flat), mass, *closure, shapes_of(own), compliant)
    result[status != DONE] = np.nan
    parts = result.reshape(*shape, -1)
    fields = [parts[..., 9:], *(parts[..., k] for k in range(6)), parts[..., 6:9]]
    return SteadyStatistics(*fields, (status == DONE).reshape(shape))


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
def _some(first, last, S, normal, speed, angle, index, mass, closure_K, closure_D, shapes, compliant, result, status):
    """Rows ``first`` to ``last``: peaks (3), RMS (3), mean (3), natural frequencies (d) of each; and how it went."""
    for b in range(first, last):
        status[b] = _one(
            S[b], normal[b], speed[b], angle[b], index[b], mass, closure_K, closure_D, shapes, compliant, result[b]
        )  # fmt: skip


@njit(error_model="numpy")
def _matrices(S, n_hat, mass, closure_K, closure_D, compliant):
    """Equations of one machine whose contacts are alike."""
    one = np.ones(n_hat.shape[0])
    M, D, K, Bk, Bc = contact_equations(
        n_hat, S[0], mass, S[1] * one, S[2] * one, S[3] * one, S[4] * one, closure_K, closure_D, compliant
    )  # fmt: skip
    rows = contact_rows(n_hat, np.eye(3), S[1] * one, S[2] * one, compliant)
    return M, D, K, Bk, Bc, rows


@njit(error_model="numpy")
def _one(S, n_hat, speed, angle, index, mass, closure_K, closure_D, shapes, compliant, result):
    M, D, K, Bk, Bc, rows = _matrices(S, n_hat, mass, closure_K, closure_D, compliant)
    squared, _ = undamped_modes(M, K)
    if not squared[0] > 1e-12 * squared[-1]:
        return UNHELD
    for k in range(squared.size):
        result[9 + k] = np.sqrt(squared[k]) / (2.0 * np.pi)
    lam, link, b, V, worst = modal_form(M, D, K, Bk, Bc)
    if not worst < ILL:
        return LINKED
    return _measured((lam, link, b, V), M, K, Bk, Bc, rows, speed, angle, index, shapes, result)


@njit(error_model="numpy")
def _measured(form, M, K, Bk, Bc, rows, speed, angle, index, shapes, result):
    """Statistics of the centre, with the contact forces' rows left out."""
    d, m = Bk.shape
    Rq, Rv, Ra, Rh, Rs = rows
    eye, none = np.eye(d), np.zeros((d, m))
    system = outputs(
        form, solve(K, Bk), none, solve(M, Bc), eye, none,
        Rq[:9].copy(), Rv[:9].copy(), Ra[:9].copy(), Rh[:9].copy(), Rs[:9].copy(),
    )  # fmt: skip
    own = Shapes(
        shapes.period[index], shapes.phase[index], shapes.count[index], shapes.edges[index], shapes.coefficients[index]
    )
    orbit, hit = orbits(system, own, speed, angle)
    if hit[0] >= 0:
        return RESONANT
    mean, variance, peak, _, _ = statistics(system, orbit, shapes.coefficients.shape[2] - 1, system.D0.shape[1] // 3)
    for k in range(3):
        total = 0.0
        for e in range(3):
            total += variance[3 * k + e] + (mean[3 * k + e] ** 2 if k > 0 else 0.0)
        result[k], result[3 + k], result[6 + k] = peak[k], np.sqrt(total), mean[k]
    return DONE


def _linked(S, n_hat, speed, angle, index, mass, closure_K, closure_D, shapes, compliant):
    """One machine whose poles must be linked."""
    M, D, K, Bk, Bc, rows = _matrices(S, n_hat, mass, closure_K, closure_D, compliant)
    squared, _ = undamped_modes(M, K)
    result = np.zeros(9 + len(M))
    result[9:] = np.sqrt(squared) / (2 * np.pi)
    form = linked_form(M, D, K, Bk, Bc)
    status = _measured(tuple(form), M, K, Bk, Bc, rows, speed, angle, index, shapes, result)
    return result, status
