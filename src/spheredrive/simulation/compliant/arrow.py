"""Compiled: the linear system of a step, solved by its structure.

Positions follow from velocities in closed form, k_q = γh (r_q + k_v), so that only velocities are unknown: the sphere's six,
the stage's three where a force drives it, and of each wheel ω and the rates of its mounts. A wheel meets the others only
through the sphere: its block of two or three is eliminated first, what is left is a system of six or nine. The work grows in
proportion to the number of wheels.
"""

from __future__ import annotations

from spheredrive.compiled import inlined
from spheredrive.dynamics.algebra import cross, dot, rotation_rows, times
from spheredrive.dynamics.compliant.instant import out_of, symmetric, turned_inertia, vector
from spheredrive.dynamics.compliant.layout import (
    AXIAL_INERTIA,
    CENTRE_VELOCITY,
    CLOSURE_DAMPING,
    CLOSURE_STIFFNESS,
    DRIVEN,
    FIRST_STATION,
    INERTIA,
    INTEGRAL,
    LOOP,
    MASS,
    MASS_CENTRE,
    MOUNT_DAMPING,
    MOUNT_MASS,
    MOUNT_STIFFNESS,
    MOVING_MASS,
    OMEGA,
    PROPORTIONAL,
    QUATERNION,
    SPEED,
    STAGE_VELOCITY,
    STATION_COUNT,
    WEIGHT,
)

# Most unknowns the wheels share, and most a wheel has of its own.
SHARED, OWN = 9, 3


@inlined
def invert(A, size):
    """A⁻¹ of the first ``size`` rows and columns in place, by Gauss and Jordan with pivots on the diagonal; False if singular.

    The blocks are masses over γh, plus damping and stiffness: their diagonals are their largest entries.
    """
    for k in range(size):
        pivot = A[k, k]
        if pivot == 0.0:
            return False
        pivot = 1.0 / pivot
        A[k, k] = 1.0
        for j in range(size):
            A[k, j] *= pivot
        for i in range(size):
            if i != k:
                f = A[i, k]
                A[i, k] = 0.0
                for j in range(size):
                    A[i, j] -= f * A[k, j]
    return True


@inlined
def mass_frame(y, body):
    """The sphere's inertia about its geometric centre and M_s ρ, in the inertial frame."""
    rows = rotation_rows((y[QUATERNION], y[QUATERNION + 1], y[QUATERNION + 2], y[QUATERNION + 3]))
    I = turned_inertia(rows, symmetric(body, INERTIA))
    rho, mass = vector(body, MASS_CENTRE), body[MASS]
    return I, (mass * dot(rows[0], rho), mass * dot(rows[1], rho), mass * dot(rows[2], rho))


@inlined
def assemble(
    y,
    f0,
    gh,
    body,
    wheels,
    stations,
    drive_kind,
    stage_kind,
    limited,
    I,
    first,
    K,
    D,
    H,
    to_own,
    from_own,
    own,
    frame,
    pushes,
    by_turn,
):
    """Fill ``H`` (9, 9) with the inverse of the shared system, ``own``, ``to_own`` and ``from_own`` with the wheels' blocks.

    f0         the state's rate at the begin of the step
    I, first   what ``mass_frame`` gives
    pushes     (m, 8, 5), filled with γh times what a station does to the sphere (force, moment), its wheel (torque) and its
               mount when the centre, the mount and the wheel are displaced by (c, Δ, ϑ)
    by_turn    (6, 3), filled with the derivative of the sphere's rows, force less mass times acceleration, by a small turn
    limited    whether each motor stands at its limit
    Returns False where the system is singular.
    """
    f = 1.0 / gh
    mass = body[MASS]
    size = 9 if stage_kind == DRIVEN else 6
    H[:, :] = 0.0
    stiff, damp = symmetric(body, CLOSURE_STIFFNESS), symmetric(body, CLOSURE_DAMPING)
    at = 0
    for i in range(3):
        for j in range(i, 3):
            H[i, j] = damp[at] + gh * stiff[at]
            H[j, i] = H[i, j]
            H[3 + i, 3 + j] = H[3 + j, 3 + i] = f * I[at]
            at += 1
        H[i, i] += f * mass
    # Rows of M_s [ρ]×.
    skew = ((0.0, -first[2], first[1]), (first[2], 0.0, -first[0]), (-first[1], first[0], 0.0))
    for i in range(3):
        for j in range(3):
            H[i, 3 + j] -= f * skew[i][j]
            H[3 + i, j] += f * skew[i][j]
            if size == 9:
                H[3 + i, 6 + j] += f * skew[i][j]
                H[6 + i, 3 + j] -= f * skew[i][j]
        if size == 9:
            H[i, 6 + i] = H[6 + i, i] = f * mass
            H[6 + i, 6 + i] = f * body[MOVING_MASS]
    _sphere_derivatives(y, f0, f, size, I, first, body, H, by_turn)
    for i in range(wheels.shape[0]):
        start, count = int(wheels[i, FIRST_STATION]), int(wheels[i, STATION_COUNT])
        rank = 1 + count
        A, B, C = own[i], to_own[i], from_own[i]
        A[:, :] = 0.0
        B[:, :] = 0.0
        C[:, :] = 0.0
        A[0, 0] = f * wheels[i, AXIAL_INERTIA]
        if drive_kind == LOOP and not limited[i]:
            A[0, 0] += wheels[i, PROPORTIONAL] + gh * wheels[i, INTEGRAL]
        for s in range(start, start + count):
            p = 1 + s - start
            # S: the wrench's change by (ḋ, Ω, ω), positions with it.
            for r in range(7):
                for q in range(3):
                    frame[r, q] = D[s, r, q] + gh * K[s, r, q]
                    frame[r, 3 + q] = D[s, r, 3 + q]
                frame[r, 6] = D[s, r, 6] + gh * K[s, r, 3]
            _push_rows(s, gh, stations, K, pushes)
            for b in range(4):
                # Blocks of the sphere by pairs (force or moment, velocity or turning), turned into the inertial frame.
                r0, q0 = 3 * (b // 2), 3 * (b % 2)
                for q in range(3):
                    column = out_of(stations, s, frame[r0, q0 + q], frame[r0 + 1, q0 + q], frame[r0 + 2, q0 + q])
                    for r in range(3):
                        for j in range(3):
                            H[r0 + r, q0 + j] -= column[r] * stations[s, 3 * q + j]
            for b in range(2):
                r0 = 3 * b
                by_omega = out_of(stations, s, frame[r0, 6], frame[r0 + 1, 6], frame[r0 + 2, 6])
                by_mount = out_of(stations, s, frame[r0, 0], frame[r0 + 1, 0], frame[r0 + 2, 0])
                on_wheel = out_of(stations, s, frame[6, r0], frame[6, r0 + 1], frame[6, r0 + 2])
                on_mount = out_of(stations, s, frame[0, r0], frame[0, r0 + 1], frame[0, r0 + 2])
                for j in range(3):
                    B[r0 + j, 0] -= by_omega[j]
                    B[r0 + j, p] += by_mount[j]
                    C[0, r0 + j] -= on_wheel[j]
                    C[p, r0 + j] += on_mount[j]
            A[0, 0] -= frame[6, 6]
            A[0, p] += frame[6, 0]
            A[p, 0] += frame[0, 6]
            A[p, p] = (
                -frame[0, 0] + f * stations[s, MOUNT_MASS] + stations[s, MOUNT_DAMPING] + gh * stations[s, MOUNT_STIFFNESS]
            )
            if size == 9:
                for j in range(3):
                    C[p, 6 + j] += f * stations[s, MOUNT_MASS] * stations[s, j]
                    B[6 + j, p] += f * stations[s, MOUNT_MASS] * stations[s, j]
            if stations[s, MOUNT_MASS] == 0.0:
                _hold(A, B, C, p)
        if drive_kind == SPEED:
            _hold(A, B, C, 0)
        if not invert(A, rank):
            return False
        # The size is told as a number, so that the loops over it are unrolled.
        if size == 6:
            _eliminate(6, rank, A, B, C, H)
        else:
            _eliminate(9, rank, A, B, C, H)
    return invert(H, 6) if size == 6 else invert(H, 9)


@inlined
def _eliminate(size, rank, A, B, C, H):
    """B ← B A⁻¹, and the shared system without this wheel."""
    for r in range(size):
        b0, b1, b2 = B[r, 0], B[r, 1], B[r, 2]
        for p in range(rank):
            B[r, p] = b0 * A[0, p] + b1 * A[1, p] + (b2 * A[2, p] if rank == 3 else 0.0)
        for p in range(rank):
            share = B[r, p]
            for j in range(size):
                H[r, j] -= share * C[p, j]


@inlined
def _push_rows(s, gh, stations, K, pushes):
    """Fill a station's ``pushes``: its K by displacements in the inertial frame, of all that it acts on."""
    for j in range(5):
        if j < 3:
            a, b, c, d = gh * stations[s, j], gh * stations[s, 3 + j], gh * stations[s, 6 + j], 0.0
        else:
            a, b, c, d = (-gh if j == 3 else 0.0), 0.0, 0.0, (gh if j == 4 else 0.0)
        f = (
            a * K[s, 0, 0] + b * K[s, 0, 1] + c * K[s, 0, 2] + d * K[s, 0, 3],
            a * K[s, 1, 0] + b * K[s, 1, 1] + c * K[s, 1, 2] + d * K[s, 1, 3],
            a * K[s, 2, 0] + b * K[s, 2, 1] + c * K[s, 2, 2] + d * K[s, 2, 3],
        )
        force = out_of(stations, s, f[0], f[1], f[2])
        moment = out_of(
            stations,
            s,
            a * K[s, 3, 0] + b * K[s, 3, 1] + c * K[s, 3, 2] + d * K[s, 3, 3],
            a * K[s, 4, 0] + b * K[s, 4, 1] + c * K[s, 4, 2] + d * K[s, 4, 3],
            a * K[s, 5, 0] + b * K[s, 5, 1] + c * K[s, 5, 2] + d * K[s, 5, 3],
        )
        for r in range(3):
            pushes[s, r, j], pushes[s, 3 + r, j] = force[r], moment[r]
        pushes[s, 6, j] = a * K[s, 6, 0] + b * K[s, 6, 1] + c * K[s, 6, 2] + d * K[s, 6, 3]
        pushes[s, 7, j] = -f[0]


@inlined
def _sphere_derivatives(y, f0, f, size, I, first, body, H, by_turn):
    """Add to ``H`` what the sphere's own rows change by with Ω and, through it, with the orientation; fill ``by_turn``.

    A small turn θ moves M_s ρ by θ × M_s ρ and the inertia by δI x = θ×(I x) − I (θ×x). Within a step the orientation turns by
    k_θ = s (k_Ω/(γh) + ½ Ω×k_Ω) with s = 1/(1/(γh)² + ¼ |Ω|²).
    """
    Omega, turning = vector(y, OMEGA), vector(f0, OMEGA)
    fall = (
        body[WEIGHT] / body[MASS] - f0[CENTRE_VELOCITY] - f0[STAGE_VELOCITY],
        body[WEIGHT + 1] / body[MASS] - f0[CENTRE_VELOCITY + 1] - f0[STAGE_VELOCITY + 1],
        body[WEIGHT + 2] / body[MASS] - f0[CENTRE_VELOCITY + 2] - f0[STAGE_VELOCITY + 2],
    )
    momentum, whirl = times(I, Omega), times(I, turning)
    share = 1.0 / (f * f + 0.25 * dot(Omega, Omega))
    for j in range(3):
        e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
        # By Ω: of Ω×(Ω×M_s ρ) and of Ω×IΩ.
        swing, spin = cross(Omega, cross(e, first)), cross(e, cross(Omega, first))
        gyration, lag = cross(Omega, times(I, e)), cross(e, momentum)
        # By the orientation.
        moved = cross(e, first)
        I_turning, I_Omega = times(I, cross(e, turning)), times(I, cross(e, Omega))
        held, spun = cross(e, whirl), cross(e, momentum)
        pulled, swung = cross(turning, moved), cross(Omega, cross(Omega, moved))
        weighed = cross(moved, fall)
        twisted = cross(Omega, (spun[0] - I_Omega[0], spun[1] - I_Omega[1], spun[2] - I_Omega[2]))
        for i in range(3):
            H[i, 3 + j] += swing[i] + spin[i]
            H[3 + i, 3 + j] += gyration[i] + lag[i]
            if size == 9:
                H[6 + i, 3 + j] += swing[i] + spin[i]
            by_turn[i, j] = -pulled[i] - swung[i]
            by_turn[3 + i, j] = weighed[i] - held[i] + I_turning[i] - twisted[i]
    for j in range(3):
        e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
        half = cross(Omega, e)
        for i in range(6):
            total = 0.0
            for k in range(3):
                total += by_turn[i, k] * share * (f * e[k] + 0.5 * half[k])
            H[i, 3 + j] -= total
            if size == 9 and i < 3:
                H[6 + i, 3 + j] -= total


@inlined
def _hold(A, B, C, p):
    """Take unknown ``p`` of a wheel out of the system: its row says that it is what stands on the right, over γh."""
    for j in range(OWN):
        A[p, j] = 0.0
    A[p, p] = 1.0
    for j in range(SHARED):
        C[p, j] = 0.0


@inlined
def solve(size, wheels, H, to_own, from_own, own, b, x, b_own, z):
    """x (9,) and z (n, 3) from right sides b (9,) and b_own (n, 3)."""
    # The size is told as a number, so that the loops over it are unrolled.
    if size == 6:
        _solve(6, wheels, H, to_own, from_own, own, b, x, b_own, z)
    else:
        _solve(9, wheels, H, to_own, from_own, own, b, x, b_own, z)


@inlined
def _solve(size, wheels, H, to_own, from_own, own, b, x, b_own, z):
    for i in range(wheels.shape[0]):
        for p in range(1 + int(wheels[i, STATION_COUNT])):
            share = b_own[i, p]
            if share != 0.0:
                for r in range(size):
                    b[r] -= to_own[i, r, p] * share
    for r in range(size):
        total = 0.0
        for j in range(size):
            total += H[r, j] * b[j]
        x[r] = total
    for i in range(wheels.shape[0]):
        rank = 1 + int(wheels[i, STATION_COUNT])
        for p in range(rank):
            total = b_own[i, p]
            for j in range(size):
                total -= from_own[i, p, j] * x[j]
            b_own[i, p] = total
        for p in range(rank):
            total = 0.0
            for q in range(rank):
                total += own[i, p, q] * b_own[i, q]
            z[i, p] = total
