"""Compiled: one step of a Rosenbrock method on a compliant machine, and what lies between its ends."""

from __future__ import annotations

import math

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.algebra import cross, dot, quaternion_rate, times
from spheredrive.dynamics.compliant.instant import into, motor_torque, out_of, rates, row_vector, symmetric, vector
from spheredrive.dynamics.compliant.layout import (
    ANGLE,
    AXIAL_INERTIA,
    CENTRE,
    CENTRE_VELOCITY,
    CLOSURE_STIFFNESS,
    DEFLECTION,
    DEFLECTION_RATE,
    DRIVEN,
    FIRST_STATION,
    INTEGRAL,
    LOOP,
    LOOP_ANGLE,
    MASS,
    MOUNT_MASS,
    MOUNT_STIFFNESS,
    MOVED,
    MOVING_MASS,
    OMEGA,
    PROPORTIONAL,
    QUATERNION,
    ROLLER_DRAG,
    ROLLER_INERTIA,
    SPEED,
    SPEED_OF_WHEEL,
    STAGE_POSITION,
    STAGE_RESPONSE,
    STAGE_VELOCITY,
    STATION_COUNT,
    STATION_STATES,
    STATION_WHEEL,
    TORQUE,
    WHEEL_STATES,
    WHEELS,
)
from spheredrive.dynamics.compliant.station import (
    E_JACOBIAN,
    E_ROW,
    E_SPIN,
    FORCES,
    HELD,
    LEVER,
    ROLLER_STATION,
    T_JACOBIAN,
    T_SPIN,
    TOUCHING,
)
from spheredrive.simulation.compliant.arrow import assemble, mass_frame, solve


@inlined
def slopes(drive_slope, stage_slope, drive_kind, stage_kind, limited, body, wheels, stations, out):
    """∂f/∂t into ``out``: what the inputs change by themselves."""
    n = wheels.shape[0]
    out[:] = 0.0
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        if drive_kind == TORQUE and not limited[i]:
            out[at + SPEED_OF_WHEEL] = drive_slope[i] / wheels[i, AXIAL_INERTIA]
        elif drive_kind == LOOP and not limited[i]:
            out[at + SPEED_OF_WHEEL] = wheels[i, PROPORTIONAL] * drive_slope[i] / wheels[i, AXIAL_INERTIA]
            out[at + LOOP_ANGLE] = drive_slope[i]
    jerk = (0.0, 0.0, 0.0)
    if stage_kind == MOVED:
        jerk = vector(stage_slope, 0)
    elif stage_kind == DRIVEN:
        jerk = times(symmetric(body, STAGE_RESPONSE), vector(stage_slope, 0))
    for j in range(3):
        out[STAGE_VELOCITY + j] = jerk[j]
        out[CENTRE_VELOCITY + j] = -jerk[j]
    for s in range(stations.shape[0]):
        if stations[s, MOUNT_MASS] > 0.0:
            at = WHEELS + WHEEL_STATES * n + STATION_STATES * s
            out[at + DEFLECTION_RATE] = -dot(row_vector(stations, s), jerk)


@inlined
def solve_stage(
    y, r, k, gh, drive_kind, stage_kind, limited, I, first, body, wheels, stations, rollers, pushes,
    H, by_turn, to_own, from_own, own, b, x, b_own, z,
):  # fmt: skip
    """k of (1/(γh) − J) k = r, by ``arrow.solve``."""
    n, m = wheels.shape[0], stations.shape[0]
    at_stations = WHEELS + WHEEL_STATES * n
    at_rollers = at_stations + STATION_STATES * m
    size = 9 if stage_kind == DRIVEN else 6
    mass = body[MASS]
    r_v, r_O, r_l = vector(r, CENTRE_VELOCITY), vector(r, OMEGA), vector(r, STAGE_VELOCITY)
    whole = r_v
    if stage_kind == DRIVEN:
        whole = (r_v[0] + r_l[0], r_v[1] + r_l[1], r_v[2] + r_l[2])
    about, lag, turned = cross(r_O, first), cross(first, whole), times(I, r_O)
    pulled = times(symmetric(body, CLOSURE_STIFFNESS), vector(r, CENTRE))
    for j in range(3):
        b[j] = mass * whole[j] + about[j] - gh * pulled[j]
        b[3 + j] = turned[j] + lag[j]
        b[6 + j] = body[MOVING_MASS] * r_l[j] + mass * r_v[j] + about[j]
    turn = _turn_by_right_side(y, r, gh)
    for j in range(3):
        pushed = by_turn[j, 0] * turn[0] + by_turn[j, 1] * turn[1] + by_turn[j, 2] * turn[2]
        b[j] += pushed
        b[3 + j] += by_turn[3 + j, 0] * turn[0] + by_turn[3 + j, 1] * turn[1] + by_turn[3 + j, 2] * turn[2]
        b[6 + j] += pushed
    r_c = vector(r, CENTRE)
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        torque = wheels[i, AXIAL_INERTIA] * r[at + SPEED_OF_WHEEL]
        if drive_kind == LOOP and not limited[i]:
            torque += gh * wheels[i, INTEGRAL] * r[at + LOOP_ANGLE]
        start = int(wheels[i, FIRST_STATION])
        for s in range(start, start + int(wheels[i, STATION_COUNT])):
            p, to = 1 + s - start, at_stations + STATION_STATES * s
            c0, c1, c2, c3, c4 = r_c[0], r_c[1], r_c[2], r[to + DEFLECTION], r[at + ANGLE]
            for j in range(6):
                b[j] += (
                    pushes[s, j, 0] * c0 + pushes[s, j, 1] * c1 + pushes[s, j, 2] * c2 + pushes[s, j, 3] * c3
                    + pushes[s, j, 4] * c4
                )  # fmt: skip
            torque += (
                pushes[s, 6, 0] * c0 + pushes[s, 6, 1] * c1 + pushes[s, 6, 2] * c2 + pushes[s, 6, 3] * c3 + pushes[s, 6, 4] * c4
            )
            b_own[i, p] = 0.0
            if stations[s, MOUNT_MASS] > 0.0:
                pull = r[to + DEFLECTION_RATE]
                for j in range(3):
                    b[6 + j] += stations[s, MOUNT_MASS] * stations[s, j] * pull
                if stage_kind == DRIVEN:
                    pull += dot(row_vector(stations, s), r_l)
                b_own[i, p] = stations[s, MOUNT_MASS] * pull - gh * stations[s, MOUNT_STIFFNESS] * c3 + (
                    pushes[s, 7, 0] * c0 + pushes[s, 7, 1] * c1 + pushes[s, 7, 2] * c2 + pushes[s, 7, 3] * c3
                    + pushes[s, 7, 4] * c4
                )  # fmt: skip
        b_own[i, 0] = gh * r[at + SPEED_OF_WHEEL] if drive_kind == SPEED else torque
    for q in range(rollers.shape[0]):
        if rollers[q, TOUCHING] > 0.0:
            # What a turning roller's own right side does through its eliminated speed.
            s = int(rollers[q, ROLLER_STATION])
            i = int(stations[s, STATION_WHEEL])
            pace = wheels[i, ROLLER_INERTIA] * r[at_rollers + q] / rollers[q, HELD]
            T, E = -rollers[q, LEVER] * rollers[q, T_SPIN] * pace, -rollers[q, LEVER] * rollers[q, E_SPIN] * pace
            part = (
                T * rollers[q, T_JACOBIAN] + E * rollers[q, E_JACOBIAN],
                T * rollers[q, T_JACOBIAN + 1] + E * rollers[q, E_JACOBIAN + 1],
                T * rollers[q, T_JACOBIAN + 2] + E * rollers[q, E_JACOBIAN + 2],
            )
            out_f = out_of(stations, s, part[0], part[1], part[2])
            out_m = out_of(
                stations,
                s,
                T * rollers[q, T_JACOBIAN + 3] + E * rollers[q, E_JACOBIAN + 3],
                T * rollers[q, T_JACOBIAN + 4] + E * rollers[q, E_JACOBIAN + 4],
                T * rollers[q, T_JACOBIAN + 5] + E * rollers[q, E_JACOBIAN + 5],
            )
            for j in range(3):
                b[j] += out_f[j]
                b[3 + j] += out_m[j]
            if drive_kind != SPEED:
                b_own[i, 0] += T * rollers[q, T_JACOBIAN + 6] + E * rollers[q, E_JACOBIAN + 6]
            if stations[s, MOUNT_MASS] > 0.0:
                b_own[i, 1 + s - int(wheels[i, FIRST_STATION])] -= part[0]
    solve(size, wheels, H, to_own, from_own, own, b, x, b_own, z)
    k_O = (x[3], x[4], x[5])
    for j in range(3):
        k[CENTRE_VELOCITY + j], k[OMEGA + j] = x[j], x[3 + j]
        k[CENTRE + j] = gh * (r[CENTRE + j] + x[j])
        k[STAGE_VELOCITY + j] = x[6 + j] if stage_kind == DRIVEN else gh * r_l[j]
        k[STAGE_POSITION + j] = gh * (r[STAGE_POSITION + j] + k[STAGE_VELOCITY + j])
    _quaternion_stage(y, r, k, k_O, gh)
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        k[at + SPEED_OF_WHEEL] = z[i, 0]
        k[at + ANGLE] = gh * (r[at + ANGLE] + z[i, 0])
        k[at + LOOP_ANGLE] = 0.0
        if drive_kind == LOOP and not limited[i]:
            k[at + LOOP_ANGLE] = gh * (r[at + LOOP_ANGLE] - z[i, 0])
        start = int(wheels[i, FIRST_STATION])
        for s in range(start, start + int(wheels[i, STATION_COUNT])):
            to = at_stations + STATION_STATES * s
            k[to + DEFLECTION_RATE] = z[i, 1 + s - start]
            k[to + DEFLECTION] = gh * (r[to + DEFLECTION] + k[to + DEFLECTION_RATE])
    for q in range(rollers.shape[0]):
        s = int(rollers[q, ROLLER_STATION])
        i = int(stations[s, STATION_WHEEL])
        inertia = wheels[i, ROLLER_INERTIA]
        if rollers[q, TOUCHING] == 0.0:
            k[at_rollers + q] = r[at_rollers + q] * gh / (1.0 + gh * wheels[i, ROLLER_DRAG] / inertia)
            continue
        to, at = at_stations + STATION_STATES * s, WHEELS + WHEEL_STATES * i
        d, v, O = into(stations, s, vector(k, CENTRE)), into(stations, s, vector(k, CENTRE_VELOCITY)), into(stations, s, k_O)
        pull = (
            rollers[q, E_ROW] * (v[0] - k[to + DEFLECTION_RATE]) + rollers[q, E_ROW + 1] * v[1] + rollers[q, E_ROW + 2] * v[2]
            + rollers[q, E_ROW + 3] * O[0] + rollers[q, E_ROW + 4] * O[1] + rollers[q, E_ROW + 5] * O[2]
            + rollers[q, E_ROW + 6] * k[at + SPEED_OF_WHEEL]
            + rollers[q, E_ROW + 7] * (d[0] - k[to + DEFLECTION]) + rollers[q, E_ROW + 8] * d[1] + rollers[q, E_ROW + 9] * d[2]
            + rollers[q, E_ROW + 10] * k[at + ANGLE]
        )  # fmt: skip
        k[at_rollers + q] = (inertia * r[at_rollers + q] - rollers[q, LEVER] * pull) / rollers[q, HELD]


@inlined
def _turn_by_right_side(y, r, gh):
    """The turn k_θ = 2 vec(k_q∘q*) that the quaternion's own right side makes, whatever k_Ω: of b = r_q∘q*."""
    Omega, q, v = vector(y, OMEGA), y[QUATERNION], vector(y, QUATERNION + 1)
    r_w, r_v = r[QUATERNION], vector(r, QUATERNION + 1)
    f = 1.0 / gh
    share = 2.0 / (f * f + 0.25 * dot(Omega, Omega))
    along, whirl = r_w * q + dot(r_v, v), cross(r_v, v)
    b = (
        q * r_v[0] - r_w * v[0] - whirl[0],
        q * r_v[1] - r_w * v[1] - whirl[1],
        q * r_v[2] - r_w * v[2] - whirl[2],
    )
    side = cross(Omega, b)
    return (
        share * (f * b[0] + 0.5 * (along * Omega[0] + side[0])),
        share * (f * b[1] + 0.5 * (along * Omega[1] + side[1])),
        share * (f * b[2] + 0.5 * (along * Omega[2] + side[2])),
    )


@inlined
def _quaternion_stage(y, r, k, k_O, gh):
    """k_q of (1/(γh) − ½ [Ω∘]) k_q = r_q + ½ k_Ω∘q, as [Ω∘]² = −|Ω|²."""
    Omega, q = vector(y, OMEGA), (y[QUATERNION], y[QUATERNION + 1], y[QUATERNION + 2], y[QUATERNION + 3])
    turn = quaternion_rate(k_O, q)
    b = (r[QUATERNION] + turn[0], r[QUATERNION + 1] + turn[1], r[QUATERNION + 2] + turn[2], r[QUATERNION + 3] + turn[3])
    turned = quaternion_rate(Omega, b)
    f = 1.0 / gh
    share = 1.0 / (f * f + 0.25 * dot(Omega, Omega))
    for j in range(4):
        k[QUATERNION + j] = share * (f * b[j] + turned[j])


@inlined
def trial(
    y, f0, h, drive, drive_slope, stage_input, stage_slope, drive_kind, stage_kind,
    body, wheels, stations, outlines, pieces, places, turns, acting, method, stages, limited,
    rollers, K, D, vectors, ks, H, frame, pushes, by_turn, b, x, to_own, from_own, own, b_own, z,
    wrenches, touches, motors, power, spare_rollers, weights, y_new,
):  # fmt: skip
    """A step of length ``h`` from ``y``, where ``f0`` and the Jacobian K, D stand, into ``y_new``; its error over tolerance.

    drive, stage_input   at the begin of the step, with their slopes
    method               the method's coefficients, one row of (γ, −) and s rows of a, c, α, γ_i, m, e: see ``packed``
    weights              of each entry's error, 1/tolerance; those of velocities are multiplied by h
    """
    n, size = wheels.shape[0], y.size
    gamma = method[0, 0]
    gh = gamma * h
    r, time_slope, rate = vectors[0], vectors[1], vectors[2]
    asked, pushed = vectors[3, 0:n], vectors[4, 0:3]
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        _, limited[i] = motor_torque(wheels, i, drive_kind, drive[i], y[at + SPEED_OF_WHEEL], y[at + LOOP_ANGLE])
    I, first = mass_frame(y, body)
    fine = assemble(
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
    )
    if not fine:
        return math.inf
    slopes(drive_slope, stage_slope, drive_kind, stage_kind, limited, body, wheels, stations, time_slope)
    for s in range(stages):
        row = 1 + s
        same = True
        for j in range(s):
            same = same and method[row, j] == 0.0
        if not same:
            for i in range(size):
                total = y[i]
                for j in range(s):
                    total += method[row, j] * ks[j, i]
                y_new[i] = total
            later = method[row, 2 * stages] * h
            for i in range(n):
                asked[i] = drive[i] + later * drive_slope[i]
            for j in range(3):
                pushed[j] = stage_input[j] + later * stage_slope[j]
            if not _equal(method, s, stages):
                rates(
                    y_new, asked, drive_slope, pushed, drive_kind, stage_kind, body, wheels, stations, outlines, pieces,
                    places, turns, acting, FORCES, gh, rate, power, motors, wrenches, touches, spare_rollers, K, D,
                )  # fmt: skip
        later = method[row, 2 * stages + 1] * h
        begin = f0 if same else rate
        for i in range(size):
            total = 0.0
            for j in range(s):
                total += method[row, stages + j] * ks[j, i]
            r[i] = begin[i] + later * time_slope[i] + total / h
        solve_stage(
            y, r, ks[s], gh, drive_kind, stage_kind, limited, I, first, body, wheels, stations, rollers, pushes,
            H, by_turn, to_own, from_own, own, b, x, b_own, z,
        )  # fmt: skip
    last = 1 + stages
    worst = 0.0
    for i in range(size):
        total, miss = y[i], 0.0
        for j in range(stages):
            total += method[last, j] * ks[j, i]
            miss += method[last, stages + j] * ks[j, i]
        y_new[i] = total
        wrong = abs(miss) * weights[0, i] * (max(h, 0.01) if weights[1, i] > 0.0 else 1.0)
        # NaN is the worst of all.
        if not wrong <= worst:
            worst = wrong if wrong == wrong else math.inf
    return worst


@inlined
def _equal(method, s, stages):
    """Whether stage s stands where the one before it does."""
    for j in range(stages):
        if method[1 + s, j] != method[s, j]:
            return False
    return method[1 + s, 2 * stages] == method[s, 2 * stages]


@inlined
def between(share, h, y0, f0, y1, f1, ks, method, stages, n, m, out):
    """The state at ``share`` of a step of length h with the stages ``ks``.

    Positions by the quintic through position, speed and acceleration at both ends, the quaternion by a cubic, speeds by the
    method's own continuous extension: it damps what is stiff, as the method does, where rates at the ends are no guide.
    """
    x = share
    # Cubic Hermite.
    h00, h10 = 1.0 + x * x * (2.0 * x - 3.0), x * (1.0 + x * (x - 2.0))
    h01, h11 = x * x * (3.0 - 2.0 * x), x * x * (x - 1.0)
    for i in range(y0.size):
        out[i] = h00 * y0[i] + h01 * y1[i] + h * (h10 * f0[i] + h11 * f1[i])
    for j in range(3):
        _quintic(x, h, y0, f0, y1, f1, CENTRE + j, CENTRE_VELOCITY + j, out)
        _quintic(x, h, y0, f0, y1, f1, STAGE_POSITION + j, STAGE_VELOCITY + j, out)
        _extended(x, y0, y1, ks, method, stages, CENTRE_VELOCITY + j, out)
        _extended(x, y0, y1, ks, method, stages, OMEGA + j, out)
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        _quintic(x, h, y0, f0, y1, f1, at + ANGLE, at + SPEED_OF_WHEEL, out)
        _extended(x, y0, y1, ks, method, stages, at + SPEED_OF_WHEEL, out)
    at = WHEELS + WHEEL_STATES * n
    for _ in range(m):
        _quintic(x, h, y0, f0, y1, f1, at + DEFLECTION, at + DEFLECTION_RATE, out)
        _extended(x, y0, y1, ks, method, stages, at + DEFLECTION_RATE, out)
        at += STATION_STATES
    for i in range(at, y0.size):
        _extended(x, y0, y1, ks, method, stages, i, out)
    normalise(out)


@inlined
def _extended(x, y0, y1, ks, method, stages, i, out):
    """Entry i by the continuous extension."""
    d = g = 0.0
    for j in range(stages):
        d += method[stages + 2, j] * ks[j, i]
        g += method[stages + 2, stages + j] * ks[j, i]
    out[i] = (1.0 - x) * y0[i] + x * (y1[i] + (1.0 - x) * (d + x * g))


@inlined
def _quintic(x, h, y0, f0, y1, f1, q, v, out):
    p0, p1, d0, d1 = y0[q], y1[q], h * y0[v], h * y1[v]
    c0, c1 = 0.5 * h * h * f0[v], 0.5 * h * h * f1[v]
    # q = p0 + d0 x + c0 x² + x³ (a + b x + c x²), matched at x = 1.
    A, B, C = p1 - p0 - d0 - c0, d1 - d0 - 2.0 * c0, c1 - c0
    a, b, c = 10.0 * A - 4.0 * B + C, -15.0 * A + 7.0 * B - 2.0 * C, 6.0 * A - 3.0 * B + C
    out[q] = p0 + x * (d0 + x * (c0 + x * (a + x * (b + x * c))))
    out[v] = (d0 + x * (2.0 * c0 + x * (3.0 * a + x * (4.0 * b + x * 5.0 * c)))) / h


@kernel
def normalise(y):
    """Bring the quaternion of a state back to length 1."""
    size = 0.0
    for j in range(4):
        size += y[QUATERNION + j] * y[QUATERNION + j]
    size = 1.0 / math.sqrt(size)
    for j in range(4):
        y[QUATERNION + j] *= size
