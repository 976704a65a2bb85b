"""Compiled: what one station does to the sphere, its mount and its wheel, and how that changes with their motion.

A contact acts through three rows: along Ĝ (normal force N), û (friction T) and f̂ (E, a roller's drag). A row j turns the
velocities (ḋ, Ω, ω) into the contact's own, and jᵀ turns its force into the wrench (F, M on the sphere, τ on the wheel), so
that power balances for every state. The derivatives are exact: a method of Rosenbrock's kind keeps its order by them alone.
Source: model.md section 5c.
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.algebra import dot
from spheredrive.dynamics.compliant.laws import drag, friction, normal_force
from spheredrive.dynamics.compliant.layout import (
    CREEP_SPEED,
    DAMPING,
    DISSIPATION,
    FARTHEST,
    FIRST_OUTLINE,
    FIRST_ROLLER,
    FRICTION,
    HERTZIAN,
    KIND,
    MIDDLE,
    OUTLINE_COUNT,
    PITCH,
    RADIUS,
    RING,
    ROLLER_COUNT,
    ROLLER_DRAG,
    ROLLER_INERTIA,
    ROLLING_ARM,
    SPIN_ARM,
    STIFFNESS,
    TURN_SPEED,
)
from spheredrive.dynamics.compliant.touch import ring_touch, roller_touch

# What a station's row of ``wrenches`` holds.
FORCE, MOMENT, WHEEL_TORQUE = 0, 3, 6
SLIP_HEAT, DAMPING_HEAT, OTHER_HEAT, STORED, PRESSED = 7, 8, 9, 10, 11
WRENCH_SIZE = 12
# What an outline's row of ``touches`` holds: forces, slip speed and gap of its rollers together, and the bits of those that
# are to act from now on and of those that are to act no more. TO_EVENT is above zero where there are none, and comes to zero
# when the next one is there, m.
NORMAL, TANGENTIAL, SLIP, GAP, SLIP_POWER, LARGEST, TO_EVENT, COMING, LEAVING = range(9)
TOUCH_SIZE = 9
# What is asked of ``station_forces``: wrenches alone; touches too; derivatives too. NumPy's numbers, as Numba would compile all
# that is handed one of Python's for each of them.
FORCES, TOUCHES, DERIVATIVES = np.arange(3)
# In ``acting``: every roller that presses the sphere.
ALL = -1
# What a turning roller's row of ``rollers`` holds: its rate; then, where it touches, what eliminates it from a step.
SPIN_RATE, TOUCHING, LEVER, T_SPIN, E_SPIN, E_ROW, T_JACOBIAN, E_JACOBIAN = 0, 1, 2, 3, 4, 5, 16, 23
HELD, ROLLER_STATION = 30, 31
ROLLER_SIZE = 32


@inlined
def _rows(touch, d, R):
    """Arm of the sphere, the contact point, and (torque row by ω) of the normal, û and f̂."""
    G, u, f = (touch[1], touch[2], touch[3]), (touch[4], touch[5], touch[6]), (touch[7], touch[8], touch[9])
    arm = R + 0.5 * touch[0]
    point = (d[0] - arm * G[0], d[1] - arm * G[1], d[2] - arm * G[2])
    return G, u, f, arm, point


@inlined
def _about_axis(a, b):
    """ẑ · (a × b) = b · (ẑ × a)."""
    return a[0] * b[1] - a[1] * b[0]


@inlined
def station_forces(
    st, i, body, wheels, stations, outlines, pieces, places, turns, acting, spins,
    d, d_rate, Omega, theta, omega, detail, gh, wrenches, touches, rollers, K, D,
):  # fmt: skip
    """Fill in what station ``st`` of wheel ``i`` does: its row of ``wrenches``, its outlines' of ``touches``.

    Rollers with inertia get their rows of ``rollers``.

    d, d_rate    sphere's centre from the wheel's, and its rate, in the station's frame
    theta        the wheel's angle with phase
    places, turns   piece that each ring's outline is on, and the angle that brings it there
    acting       a bit for each roller of an outline, its number modulo 32. Those that are set act, whatever their gap and even
                 if they pull, no others: so a step is smooth, and ends where one comes to press or ceases to. ``ALL``: those
                 that press
    spins        speed of each roller about its own axis
    detail       ``FORCES``: forces and torques alone, heats and ``touches`` are left as they are; ``TOUCHES``: those too, and
                 none pulls; ``DERIVATIVES``: also fill K (7, 4), the wrench's derivative by (d, ϑ), and D (7, 7), by (ḋ, Ω, ω)
    gh           γ h of the step, which rollers with inertia are eliminated with
    """
    R, creep, turn_speed = body[RADIUS], body[CREEP_SPEED], body[TURN_SPEED]
    mu, inertia, bearing = stations[st, FRICTION], wheels[i, ROLLER_INERTIA], wheels[i, ROLLER_DRAG]
    F_all, M_all, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0
    slip_heat = damping_heat = other_heat = stored = whole = 0.0
    stiffness, damping, dissipation = stations[st, STIFFNESS], stations[st, DAMPING], stations[st, DISSIPATION]
    hertzian, rolling_arm, spin_arm = stations[st, HERTZIAN] > 0.0, stations[st, ROLLING_ARM], stations[st, SPIN_ARM]
    if detail == DERIVATIVES:
        for r in range(7):
            for j in range(7):
                D[st, r, j] = 0.0
            for j in range(4):
                K[st, r, j] = 0.0
    first = int(stations[st, FIRST_OUTLINE])
    for o in range(first, first + int(stations[st, OUTLINE_COUNT])):
        if detail != FORCES:
            for j in range(TOUCH_SIZE):
                touches[o, j] = 0.0
            touches[o, GAP] = touches[o, TO_EVENT] = 1e300
        every, ring = acting[o] == ALL, outlines[o, KIND] == RING
        # Rollers whose middles stand at β + k · pitch, of which those within reach are looked at.
        nearest, beta, low, high, pitch = 0.0, 0.0, 0, 0, outlines[o, PITCH]
        if not ring:
            farthest = outlines[o, FARTHEST]
            nearest = math.floor((theta - outlines[o, MIDDLE]) / pitch + 0.5)
            beta = theta - outlines[o, MIDDLE] - nearest * pitch
            low, high = math.ceil((-farthest - beta) / pitch), math.floor((farthest - beta) / pitch)
        first_roller, count = int(outlines[o, FIRST_ROLLER]), int(outlines[o, ROLLER_COUNT])
        for k in range(low, high + 1):
            # Roller number −nearest − k counts against the wheel's turning.
            number = 0 if ring else int(nearest - k) & 31
            acts = not every and (acting[o] >> number) & 1 != 0
            if detail == FORCES and not (acts or every):
                continue
            if ring:
                touch = ring_touch(outlines, o, d[0], d[1], d[2], theta, places[o], turns[o], pieces, R)
            else:
                b = beta + k * pitch
                touch = roller_touch(outlines, o, d[0], d[1], d[2], math.cos(b), math.sin(b), R, acts)
            gap = touch[0]
            if detail != FORCES:
                touches[o, GAP] = min(touches[o, GAP], gap)
            if not acts and gap >= 0.0:
                if detail != FORCES:
                    touches[o, TO_EVENT] = min(touches[o, TO_EVENT], gap)
                continue
            G, u, f, arm, point = _rows(touch, d, R)
            steep = touch[17]
            # The speed of the contact: U without the sphere's turning.
            U = (
                d_rate[0] + omega * point[1], d_rate[1] - omega * point[0], d_rate[2],
            )  # fmt: skip
            gap_rate = steep * dot(G, U)
            N, N_depth, N_rate, elastic = normal_force(-gap, -gap_rate, stiffness, damping, dissipation, hertzian)
            pulls = False
            if not acts:
                # One that moves in presses from the first touch on, one that moves out when damping holds it no more.
                to_event = gap if gap_rate <= 0.0 else -N / stiffness
                if detail != FORCES:
                    touches[o, TO_EVENT] = min(touches[o, TO_EVENT], to_event)
                    if to_event <= 0.0:
                        touches[o, COMING] += float(1 << number)
                pulls = not (every and N > 0.0)
            elif detail != FORCES:
                # Damping that Hunt and Crossley turn round with the depth would push again across a gap.
                touches[o, TO_EVENT] = min(touches[o, TO_EVENT], N / stiffness, -gap)
                if N < 0.0 or gap > 0.0:
                    touches[o, LEAVING] += float(1 << number)
                    pulls = detail == TOUCHES
            if pulls:
                if gap < 0.0 < gap_rate:
                    # What its spring still holds goes into its own damper.
                    stored += elastic * -gap * (0.4 if hertzian else 0.5)
                    damping_heat += elastic * gap_rate
                continue
            pressed = N * steep
            s, t = dot(u, U) + arm * dot(f, Omega), dot(f, U) - arm * dot(u, Omega)
            lever = touch[16]
            turning = inertia > 0.0 and lever > 0.0 and count > 0
            spin, index = 0.0, 0
            if turning:
                index = first_roller + int(nearest - k) % count
                spin = spins[index]
                T, E, T_N, E_N, T_s, T_t, E_t = friction(pressed, s, t - lever * spin, mu, creep)
                E_s = T_t
                rollers[index, SPIN_RATE] = (-lever * E - bearing * spin) / inertia
                rollers[index, TOUCHING] = 1.0
            else:
                T, _, T_N, _, T_s, _, _ = friction(pressed, s, 0.0, mu, creep)
                resistance = bearing / (lever * lever) if lever > 0.0 else 0.0
                E, E_N, E_t = drag(pressed, t, mu, resistance)
                T_t = E_s = 0.0
            F = (
                N * steep * G[0] + T * u[0] + E * f[0],
                N * steep * G[1] + T * u[1] + E * f[1],
                N * steep * G[2] + T * u[2] + E * f[2],
            )  # fmt: skip
            M = (arm * (T * f[0] - E * u[0]), arm * (T * f[1] - E * u[1]), arm * (T * f[2] - E * u[2]))
            F_all = (F_all[0] + F[0], F_all[1] + F[1], F_all[2] + F[2])
            M_all = (M_all[0] + M[0], M_all[1] + M[1], M_all[2] + M[2])
            torque -= _about_axis(point, F)
            if detail != FORCES:
                slip_heat -= T * s + (E * (t - lever * spin) if turning else 0.0)
                damping_heat += (N - elastic) * -gap_rate
                other_heat += bearing * spin * spin if turning else -E * t
                stored += elastic * -gap * (0.4 if hertzian else 0.5)
                whole += pressed
                if pressed > touches[o, LARGEST]:
                    touches[o, LARGEST], touches[o, SLIP] = pressed, s
                touches[o, NORMAL] += pressed
                touches[o, TANGENTIAL] += T
                touches[o, SLIP_POWER] -= T * s
            if detail == DERIVATIVES:
                _derive(
                    st, G, u, f, arm, point, U, touch, d, d_rate, Omega, omega, N, pressed, N_depth, N_rate, T, E,
                    T_N, E_N, T_s, T_t, E_s, E_t, t, spin, F, turning, inertia, bearing, gh, rollers,
                    index, K, D,
                )  # fmt: skip
            if rolling_arm > 0.0 or spin_arm > 0.0:
                m, heat = _resist(
                    st, G, u, f, pressed, mu, rolling_arm, spin_arm, turn_speed, Omega, omega,
                    steep * N_rate, steep * N_depth, d, d_rate, touch, detail, K, D,
                )  # fmt: skip
                M_all = (M_all[0] + m[0], M_all[1] + m[1], M_all[2] + m[2])
                torque -= m[2]
                other_heat += heat
    wrenches[st, 0], wrenches[st, 1], wrenches[st, 2] = F_all
    wrenches[st, 3], wrenches[st, 4], wrenches[st, 5] = M_all
    wrenches[st, WHEEL_TORQUE] = torque
    if detail != FORCES:
        wrenches[st, SLIP_HEAT], wrenches[st, DAMPING_HEAT], wrenches[st, OTHER_HEAT] = slip_heat, damping_heat, other_heat
        wrenches[st, STORED], wrenches[st, PRESSED] = stored, whole
    if detail == DERIVATIVES:
        _by_angle(st, wrenches, d, d_rate, Omega, K, D)


@kernel
def _derive(
    st, G, u, f, arm, point, U, touch, d, d_rate, Omega, omega, N, pressed, N_depth, N_rate, T, E,
    T_N, E_N, T_s, T_t, E_s, E_t, t, spin, F, turning, inertia, bearing, gh, rollers, index, K, D,
):  # fmt: skip
    """Add the derivatives of one contact's wrench to K (by d) and D (by the velocities)."""
    kappa_u, kappa_f, kappa_x, lever, steep = touch[10], touch[11], touch[12], touch[16], touch[17]
    # Rows by (ḋ, Ω, ω).
    j_N = (steep * G[0], steep * G[1], steep * G[2], 0.0, 0.0, 0.0, -steep * _about_axis(point, G))
    j_T = (u[0], u[1], u[2], arm * f[0], arm * f[1], arm * f[2], -_about_axis(point, u))
    j_E = (f[0], f[1], f[2], -arm * u[0], -arm * u[1], -arm * u[2], -_about_axis(point, f))
    across = (d_rate[0] + omega * d[1], d_rate[1] - omega * d[0], d_rate[2])
    # A roller with inertia: its speed follows from E and is eliminated, z = (I r/… − lever dE)/held.
    share_T, share_E, held = 0.0, 1.0, 1.0
    if turning:
        held = inertia / gh + bearing - lever * lever * E_t
        share_E = (inertia / gh + bearing) / held
        share_T = lever * lever * T_t / held
    # What presses along Ĝ for each newton of N.
    grow = steep
    for i in range(7):
        N_v = -N_rate * j_N[i]
        E_v = E_N * grow * N_v + E_s * j_T[i] + E_t * j_E[i]
        T_v = T_N * grow * N_v + T_s * j_T[i] + T_t * j_E[i] + share_T * E_v
        if turning:
            rollers[index, E_ROW + i] = E_v
            rollers[index, T_JACOBIAN + i] = j_T[i]
            rollers[index, E_JACOBIAN + i] = j_E[i]
        E_v *= share_E
        for r in range(7):
            D[st, r, i] += j_N[r] * N_v + j_T[r] * T_v + j_E[r] * E_v
    for b in range(3):
        # A displacement along e turns the frame: dG = p u + q f, du = −p G + τ f, df = −q G − τ u.
        e = G if b == 0 else (u if b == 1 else f)
        p = touch[19] if b == 0 else (kappa_u if b == 1 else kappa_x)
        q = touch[20] if b == 0 else (kappa_x if b == 1 else kappa_f)
        steeper = touch[21] if b == 0 else steep * (touch[19] if b == 1 else touch[20])
        tau, arm_d = touch[13 + b], 0.5 * steep if b == 0 else 0.0
        bend = (p * u[0] + q * f[0], p * u[1] + q * f[1], p * u[2] + q * f[2])
        u_d = (tau * f[0] - p * G[0], tau * f[1] - p * G[1], tau * f[2] - p * G[2])
        f_d = (-q * G[0] - tau * u[0], -q * G[1] - tau * u[1], -q * G[2] - tau * u[2])
        move = (
            e[0] - arm_d * G[0] - arm * bend[0], e[1] - arm_d * G[1] - arm * bend[1], e[2] - arm_d * G[2] - arm * bend[2],
        )  # fmt: skip
        dN = -N_rate * (steeper * dot(G, across) + steep * (dot(bend, across) - omega * _about_axis(e, G)))
        if b == 0:
            dN -= N_depth * steep
        ds = dot(u_d, U) - omega * _about_axis(move, u) + arm_d * dot(f, Omega) + arm * dot(f_d, Omega)
        dt = dot(f_d, U) - omega * _about_axis(move, f) - arm_d * dot(u, Omega) - arm * dot(u_d, Omega)
        # The lever of the contact about the roller's axis.
        dl = touch[18] if b == 1 else 0.0
        if turning:
            dt -= spin * dl
        pressed_d = grow * dN + N * steeper
        dE = E_N * pressed_d + E_s * ds + E_t * dt
        if not turning and lever > 0.0:
            # The drag's resistance is c/lever².
            dE -= 2.0 * t * E_t * dl / lever
        E_row = dE + E * dl / lever if turning else 0.0
        dT = T_N * pressed_d + T_s * ds + T_t * dt + share_T * E_row
        dE += (share_E - 1.0) * E_row
        dF = (
            (steep * dN + N * steeper) * G[0] + steep * N * bend[0] + dT * u[0] + T * u_d[0] + dE * f[0] + E * f_d[0],
            (steep * dN + N * steeper) * G[1] + steep * N * bend[1] + dT * u[1] + T * u_d[1] + dE * f[1] + E * f_d[1],
            (steep * dN + N * steeper) * G[2] + steep * N * bend[2] + dT * u[2] + T * u_d[2] + dE * f[2] + E * f_d[2],
        )
        dM = (
            arm_d * (T * f[0] - E * u[0]) + arm * (dT * f[0] + T * f_d[0] - dE * u[0] - E * u_d[0]),
            arm_d * (T * f[1] - E * u[1]) + arm * (dT * f[1] + T * f_d[1] - dE * u[1] - E * u_d[1]),
            arm_d * (T * f[2] - E * u[2]) + arm * (dT * f[2] + T * f_d[2] - dE * u[2] - E * u_d[2]),
        )
        d_torque = -_about_axis(move, F) - _about_axis(point, dF)
        for c in range(3):
            for r in range(3):
                K[st, r, c] += dF[r] * e[c]
                K[st, 3 + r, c] += dM[r] * e[c]
            K[st, 6, c] += d_torque * e[c]
            if turning:
                if b == 0:
                    rollers[index, E_ROW + 7 + c] = 0.0
                rollers[index, E_ROW + 7 + c] += E_row * e[c]
    if turning:
        rollers[index, LEVER], rollers[index, T_SPIN], rollers[index, E_SPIN] = lever, T_t, E_t
        rollers[index, HELD], rollers[index, ROLLER_STATION] = held, st
        by_d = (rollers[index, E_ROW + 7], rollers[index, E_ROW + 8], rollers[index, E_ROW + 9])
        by_v = (rollers[index, E_ROW], rollers[index, E_ROW + 1], rollers[index, E_ROW + 2])
        by_O = (rollers[index, E_ROW + 3], rollers[index, E_ROW + 4], rollers[index, E_ROW + 5])
        rollers[index, E_ROW + 10] = -_about_axis(d, by_d) - _about_axis(d_rate, by_v) - _about_axis(Omega, by_O)


@kernel
def _resist(
    st, G, u, f, pressed, mu, rolling, spinning, smooth, Omega, omega, N_rate, N_depth, d, d_rate, touch, detail, K, D
):  # fmt: skip
    """Moment of rolling and spin resistance on the sphere (``contact.resistance_moment``), and its heat; the wheel gets the
    opposite."""
    w = (Omega[0], Omega[1], Omega[2] - omega)
    along = dot(w, G)
    flat = (w[0] - along * G[0], w[1] - along * G[1], w[2] - along * G[2])
    roll = math.sqrt(dot(flat, flat) + smooth * smooth)
    spin = math.sqrt(along * along + smooth * smooth)
    r, q = rolling / roll, mu * spinning * along / spin
    m = (-r * flat[0] - q * G[0], -r * flat[1] - q * G[1], -r * flat[2] - q * G[2])
    if detail == DERIVATIVES:
        spin_slope = pressed * mu * spinning * smooth * smooth / (spin * spin * spin)
        for i in range(3):
            for j in range(3):
                same = 1.0 if i == j else 0.0
                value = -pressed * r * (same - G[i] * G[j] - flat[i] * flat[j] / (roll * roll)) - spin_slope * G[i] * G[j]
                D[st, 3 + i, 3 + j] += value
                if i == 2:
                    D[st, 6, 3 + j] -= value
                if j == 2:
                    D[st, 3 + i, 6] -= value
                if i == 2 and j == 2:
                    D[st, 6, 6] += value
        for b in range(1, 3):
            # The axes turn with the normal: dG = p u + t f along u and along f.
            along_u, along_f = (touch[10], touch[12]) if b == 1 else (touch[12], touch[11])
            e = u if b == 1 else f
            bend = (along_u * u[0] + along_f * f[0], along_u * u[1] + along_f * f[1], along_u * u[2] + along_f * f[2])
            spun, rolled = dot(w, bend), r * along * dot(flat, bend) / (roll * roll)
            slope = mu * spinning * smooth * smooth / (spin * spin * spin)
            # The normal force itself changes by the rate of the gap.
            across = (d_rate[0] + omega * d[1], d_rate[1] - omega * d[0], d_rate[2])
            dN = -N_rate * (dot(bend, across) - omega * _about_axis(e, G))
            for i in range(3):
                dm = pressed * (r * (spun * G[i] + along * bend[i]) - rolled * flat[i] - slope * spun * G[i] - q * bend[i])
                dm += m[i] * dN
                for j in range(3):
                    K[st, 3 + i, j] += dm * e[j]
                    if i == 2:
                        K[st, 6, j] -= dm * e[j]
        turned = -_about_axis(d, G)
        for i in range(3):
            for j in range(3):
                K[st, 3 + i, j] -= m[i] * N_depth * G[j]
                D[st, 3 + i, j] -= m[i] * N_rate * G[j]
            D[st, 3 + i, 6] -= m[i] * N_rate * turned
        for j in range(3):
            K[st, 6, j] += m[2] * N_depth * G[j]
            D[st, 6, j] += m[2] * N_rate * G[j]
        D[st, 6, 6] += m[2] * N_rate * turned
    return (pressed * m[0], pressed * m[1], pressed * m[2]), -pressed * dot(m, w)


@kernel
def _by_angle(st, wrenches, d, d_rate, Omega, K, D):
    """The derivative by ϑ: sphere and wheel turned together about the axis turn the wrench with them."""
    z_d, z_v, z_O = (-d[1], d[0]), (-d_rate[1], d_rate[0]), (-Omega[1], Omega[0])
    for r in range(7):
        K[st, r, 3] = -(
            K[st, r, 0] * z_d[0] + K[st, r, 1] * z_d[1]
            + D[st, r, 0] * z_v[0] + D[st, r, 1] * z_v[1]
            + D[st, r, 3] * z_O[0] + D[st, r, 4] * z_O[1]
        )  # fmt: skip
    K[st, 0, 3] -= wrenches[st, 1]
    K[st, 1, 3] += wrenches[st, 0]
    K[st, 3, 3] -= wrenches[st, 4]
    K[st, 4, 3] += wrenches[st, 3]
