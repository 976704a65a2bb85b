"""Compiled: the rates of a compliant machine's whole state at an instant (model.md 5c)."""

from __future__ import annotations

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.algebra import cross, dot, quaternion_rate, rotation_rows, times
from spheredrive.dynamics.compliant.layout import (
    ANGLE,
    AXIAL_INERTIA,
    CENTRE,
    CENTRE_VELOCITY,
    CLOSURE_DAMPING,
    CLOSURE_FORCE,
    CLOSURE_STIFFNESS,
    CONTACT_DAMPING,
    DEFLECTION,
    DEFLECTION_RATE,
    DISTANCE,
    DRIVEN,
    FIRST_OUTLINE,
    FIRST_ROLLER,
    FIRST_STATION,
    INERTIA,
    INTEGRAL,
    LOOP,
    LOOP_ANGLE,
    MASS,
    MASS_CENTRE,
    MOTOR,
    MOUNT_DAMPING,
    MOUNT_MASS,
    MOUNT_STIFFNESS,
    MOVED,
    MOVING_MASS,
    OMEGA,
    OUTLINE_COUNT,
    POWERS,
    PROPORTIONAL,
    QUATERNION,
    RESISTANCES,
    ROLLER_COUNT,
    ROLLER_DRAG,
    ROLLER_INERTIA,
    SLIPPING,
    SPEED,
    SPEED_OF_WHEEL,
    STAGE_POSITION,
    STAGE_RESPONSE,
    STAGE_VELOCITY,
    STAGE_WORK,
    STATION_COUNT,
    STATION_STATES,
    STATION_WHEEL,
    TORQUE_LIMIT,
    WEIGHT,
    WHEEL_STATES,
    WHEELS,
)
from spheredrive.dynamics.compliant.station import (
    DAMPING_HEAT,
    FORCES,
    OTHER_HEAT,
    SLIP_HEAT,
    SPIN_RATE,
    TOUCHING,
    WHEEL_TORQUE,
    station_forces,
)


@inlined
def vector(a, i):
    """Three entries of a flat array from i on."""
    return a[i], a[i + 1], a[i + 2]


@inlined
def row_vector(a, i):
    """First three entries of row ``i``."""
    return a[i, 0], a[i, 1], a[i, 2]


@inlined
def symmetric(a, i):
    """Six entries of a flat array from i on."""
    return a[i], a[i + 1], a[i + 2], a[i + 3], a[i + 4], a[i + 5]


@inlined
def into(stations, s, a):
    """A vector of the inertial frame in the frame of station ``s``."""
    return (
        stations[s, 0] * a[0] + stations[s, 1] * a[1] + stations[s, 2] * a[2],
        stations[s, 3] * a[0] + stations[s, 4] * a[1] + stations[s, 5] * a[2],
        stations[s, 6] * a[0] + stations[s, 7] * a[1] + stations[s, 8] * a[2],
    )


@inlined
def out_of(stations, s, a, b, c):
    """A vector of the frame of station ``s`` in the inertial frame."""
    return (
        stations[s, 0] * a + stations[s, 3] * b + stations[s, 6] * c,
        stations[s, 1] * a + stations[s, 4] * b + stations[s, 7] * c,
        stations[s, 2] * a + stations[s, 5] * b + stations[s, 8] * c,
    )


@inlined
def turned_inertia(rows, I):
    """R I Rᵀ of a symmetric matrix, R given by its rows."""
    a, b, c = times(I, rows[0]), times(I, rows[1]), times(I, rows[2])
    return (
        dot(rows[0], a), dot(rows[0], b), dot(rows[0], c), dot(rows[1], b), dot(rows[1], c), dot(rows[2], c),
    )  # fmt: skip


@inlined
def solve_3(M, b):
    """x of M x = b, M symmetric and positive definite, by Cramer's rule."""
    c00, c01, c02 = M[3] * M[5] - M[4] * M[4], M[2] * M[4] - M[1] * M[5], M[1] * M[4] - M[2] * M[3]
    f = 1.0 / (M[0] * c00 + M[1] * c01 + M[2] * c02)
    c11, c12, c22 = M[0] * M[5] - M[2] * M[2], M[1] * M[2] - M[0] * M[4], M[0] * M[3] - M[1] * M[1]
    return (
        f * (c00 * b[0] + c01 * b[1] + c02 * b[2]),
        f * (c01 * b[0] + c11 * b[1] + c12 * b[2]),
        f * (c02 * b[0] + c12 * b[1] + c22 * b[2]),
    )


@inlined
def motor_torque(wheels, i, drive_kind, asked, speed, loop_angle):
    """Torque of a motor that is not ideal, and whether it stands at its limit.

    T as given, or K_p (asked − ω) + K_i ∫(asked − ω) dt; |T| ≤ the limit.
    """
    torque = asked
    if drive_kind == LOOP:
        torque = wheels[i, PROPORTIONAL] * (asked - speed) + wheels[i, INTEGRAL] * loop_angle
    limit = wheels[i, TORQUE_LIMIT]
    if torque > limit:
        return limit, True
    if torque < -limit:
        return -limit, True
    return torque, False


@inlined
def rates(
    y, drive, drive_slope, stage_input, drive_kind, stage_kind,
    body, wheels, stations, outlines, pieces, places, turns, acting,
    detail, gh, rate, power, motors, wrenches, touches, rollers, K, D,
):  # fmt: skip
    """Fill ``rate``, the derivative of the state ``y`` by time, ``power`` and the ``motors``' torques.

    drive, drive_slope   torque (N m) or speed (rad/s) asked of each wheel, and how it changes a second
    stage_input          force P on the stage (N) or its acceleration (m/s²)
    detail, gh           as for ``station_forces``
    """
    n, m = wheels.shape[0], stations.shape[0]
    at_stations = WHEELS + WHEEL_STATES * n
    at_rollers = at_stations + STATION_STATES * m
    c, v, Omega = vector(y, CENTRE), vector(y, CENTRE_VELOCITY), vector(y, OMEGA)
    spins = y[at_rollers:]
    for p in range(POWERS):
        power[p] = 0.0
    for k in range(spins.size):
        rollers[k, TOUCHING] = 0.0
    F, M = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for s in range(m):
        i = int(stations[s, STATION_WHEEL])
        here, moving, turning = into(stations, s, c), into(stations, s, v), into(stations, s, Omega)
        at, w_at = at_stations + STATION_STATES * s, WHEELS + WHEEL_STATES * i
        d = (stations[s, DISTANCE] + here[0] - y[at + DEFLECTION], here[1], here[2])
        d_rate = (moving[0] - y[at + DEFLECTION_RATE], moving[1], moving[2])
        station_forces(
            s, i, body, wheels, stations, outlines, pieces, places, turns, acting, spins,
            d, d_rate, turning, y[w_at + ANGLE], y[w_at + SPEED_OF_WHEEL], detail, gh, wrenches, touches, rollers, K, D,
        )  # fmt: skip
        f = out_of(stations, s, wrenches[s, 0], wrenches[s, 1], wrenches[s, 2])
        g = out_of(stations, s, wrenches[s, 3], wrenches[s, 4], wrenches[s, 5])
        F = (F[0] + f[0], F[1] + f[1], F[2] + f[2])
        M = (M[0] + g[0], M[1] + g[1], M[2] + g[2])
        if detail != FORCES:
            power[SLIPPING] += wrenches[s, SLIP_HEAT]
            power[CONTACT_DAMPING] += wrenches[s, DAMPING_HEAT]
            power[RESISTANCES] += (
                wrenches[s, OTHER_HEAT] + stations[s, MOUNT_DAMPING] * y[at + DEFLECTION_RATE] * y[at + DEFLECTION_RATE]
            )
    pulled, braked = times(symmetric(body, CLOSURE_STIFFNESS), c), times(symmetric(body, CLOSURE_DAMPING), v)
    F = (
        F[0] - pulled[0] - braked[0] + body[CLOSURE_FORCE] + body[WEIGHT],
        F[1] - pulled[1] - braked[1] + body[CLOSURE_FORCE + 1] + body[WEIGHT + 1],
        F[2] - pulled[2] - braked[2] + body[CLOSURE_FORCE + 2] + body[WEIGHT + 2],
    )  # fmt: skip
    power[RESISTANCES] += dot(braked, v)
    stage = (0.0, 0.0, 0.0)
    if stage_kind == MOVED:
        stage = vector(stage_input, 0)
    elif stage_kind == DRIVEN:
        P = (stage_input[0] - F[0], stage_input[1] - F[1], stage_input[2] - F[2])
        for s in range(m):
            f = (
                _mount_force(stations, s, y, at_stations + STATION_STATES * s, wrenches[s, 0])
                if stations[s, MOUNT_MASS] > 0.0
                else 0.0
            )
            P = (P[0] - f * stations[s, 0], P[1] - f * stations[s, 1], P[2] - f * stations[s, 2])
        stage = times(symmetric(body, STAGE_RESPONSE), P)
    linear, angular, rho = _sphere_acceleration(y, F, M, stage, body)
    for j in range(3):
        rate[CENTRE + j] = v[j]
        rate[CENTRE_VELOCITY + j] = linear[j]
        rate[OMEGA + j] = angular[j]
        rate[STAGE_POSITION + j] = y[STAGE_VELOCITY + j]
        rate[STAGE_VELOCITY + j] = stage[j]
    turn = quaternion_rate(Omega, (y[QUATERNION], y[QUATERNION + 1], y[QUATERNION + 2], y[QUATERNION + 3]))
    for j in range(4):
        rate[QUATERNION + j] = turn[j]
    momentum = (0.0, 0.0, 0.0)
    for s in range(m):
        at = at_stations + STATION_STATES * s
        rate[at + DEFLECTION], rate[at + DEFLECTION_RATE] = y[at + DEFLECTION_RATE], 0.0
        if stations[s, MOUNT_MASS] > 0.0:
            acceleration = _mount_force(stations, s, y, at, wrenches[s, 0]) / stations[s, MOUNT_MASS] - (
                stations[s, 0] * stage[0] + stations[s, 1] * stage[1] + stations[s, 2] * stage[2]
            )
            rate[at + DEFLECTION_RATE] = acceleration
            push = stations[s, MOUNT_MASS] * acceleration
            momentum = (
                momentum[0] + push * stations[s, 0],
                momentum[1] + push * stations[s, 1],
                momentum[2] + push * stations[s, 2],
            )
    for i in range(n):
        at = WHEELS + WHEEL_STATES * i
        torque = 0.0
        for s in range(int(wheels[i, FIRST_STATION]), int(wheels[i, FIRST_STATION]) + int(wheels[i, STATION_COUNT])):
            torque += wrenches[s, WHEEL_TORQUE]
        speed = y[at + SPEED_OF_WHEEL]
        rate[at + ANGLE] = speed
        rate[at + LOOP_ANGLE] = 0.0
        if drive_kind == SPEED:
            rate[at + SPEED_OF_WHEEL] = drive_slope[i]
            motors[i] = wheels[i, AXIAL_INERTIA] * drive_slope[i] - torque
        else:
            motors[i], limited = motor_torque(wheels, i, drive_kind, drive[i], speed, y[at + LOOP_ANGLE])
            rate[at + SPEED_OF_WHEEL] = (motors[i] + torque) / wheels[i, AXIAL_INERTIA]
            if drive_kind == LOOP and not limited:
                # The integral waits while the motor gives all it has.
                rate[at + LOOP_ANGLE] = drive[i] - speed
        power[MOTOR] += motors[i] * speed
        for s in range(int(wheels[i, FIRST_STATION]), int(wheels[i, FIRST_STATION]) + int(wheels[i, STATION_COUNT])):
            _free_rollers(s, i, wheels, stations, outlines, spins, rollers, power)
    for k in range(spins.size):
        rate[at_rollers + k] = rollers[k, SPIN_RATE]
    if stage_kind != 0 and detail != FORCES:
        # The force on the stage is what all the momentum changes by: the gantry carries the weight.
        about = cross(angular, rho)
        swing = cross(Omega, cross(Omega, rho))
        for j in range(3):
            P_j = body[MOVING_MASS] * stage[j] + body[MASS] * (linear[j] + about[j] + swing[j]) + momentum[j]
            power[STAGE_WORK] += P_j * y[STAGE_VELOCITY + j]


@inlined
def _mount_force(stations, s, y, at, pressing):
    """Force on a wheel's mass along n̂, m (Δ̈ + n̂·p̈_l)."""
    return -stations[s, MOUNT_STIFFNESS] * y[at + DEFLECTION] - stations[s, MOUNT_DAMPING] * y[at + DEFLECTION_RATE] - pressing


@kernel
def _sphere_acceleration(y, F, M, stage, body):
    """c̈ and Ω̇ from the force and the moment about the geometric centre, and the mass centre ρ in the inertial frame.

    M_s (p̈ + Ω̇×ρ + Ω×(Ω×ρ)) = F,   I Ω̇ + M_s ρ×p̈ = M − Ω×IΩ + ρ×M_s g,   p̈ = p̈_l + c̈
    """
    Omega, mass = vector(y, OMEGA), body[MASS]
    I = symmetric(body, INERTIA)
    rho = vector(body, MASS_CENTRE)
    offset = rho[0] != 0.0 or rho[1] != 0.0 or rho[2] != 0.0
    if not offset and I[1] == 0.0 and I[2] == 0.0 and I[4] == 0.0 and I[0] == I[3] and I[0] == I[5]:
        f = 1.0 / I[0]
        return (
            (F[0] / mass - stage[0], F[1] / mass - stage[1], F[2] / mass - stage[2]),
            (M[0] * f, M[1] * f, M[2] * f),
            rho,
        )
    rows = rotation_rows((y[QUATERNION], y[QUATERNION + 1], y[QUATERNION + 2], y[QUATERNION + 3]))
    I = turned_inertia(rows, I)
    rho = (dot(rows[0], rho), dot(rows[1], rho), dot(rows[2], rho))
    swing = cross(Omega, cross(Omega, rho))
    # What the centre's acceleration would be without Ω̇, on the whole.
    A = (F[0] / mass - swing[0], F[1] / mass - swing[1], F[2] / mass - swing[2])
    gyration, weight = cross(Omega, times(I, Omega)), cross(rho, vector(body, WEIGHT))
    lag = cross(rho, A)
    b = (
        M[0] - gyration[0] + weight[0] - mass * lag[0],
        M[1] - gyration[1] + weight[1] - mass * lag[1],
        M[2] - gyration[2] + weight[2] - mass * lag[2],
    )
    square = mass * dot(rho, rho)
    about_mass_centre = (
        I[0] - square + mass * rho[0] * rho[0], I[1] + mass * rho[0] * rho[1], I[2] + mass * rho[0] * rho[2],
        I[3] - square + mass * rho[1] * rho[1], I[4] + mass * rho[1] * rho[2], I[5] - square + mass * rho[2] * rho[2],
    )  # fmt: skip
    angular = solve_3(about_mass_centre, b)
    about = cross(angular, rho)
    return (A[0] - about[0] - stage[0], A[1] - about[1] - stage[1], A[2] - about[2] - stage[2]), angular, rho


@kernel
def _free_rollers(s, i, wheels, stations, outlines, spins, rollers, power):
    """Rollers with inertia that touch nothing run out on their bearings."""
    from_outline = int(stations[s, FIRST_OUTLINE])
    if wheels[i, ROLLER_INERTIA] == 0.0:
        return
    for o in range(from_outline, from_outline + int(stations[s, OUTLINE_COUNT])):
        first = int(outlines[o, FIRST_ROLLER])
        for k in range(first, first + int(outlines[o, ROLLER_COUNT])):
            if rollers[k, TOUCHING] == 0.0:
                rollers[k, SPIN_RATE] = -wheels[i, ROLLER_DRAG] * spins[k] / wheels[i, ROLLER_INERTIA]
                power[RESISTANCES] += wheels[i, ROLLER_DRAG] * spins[k] * spins[k]
