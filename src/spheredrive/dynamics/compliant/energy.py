"""Compiled: the energy of a compliant machine in a state."""

from __future__ import annotations

from spheredrive.compiled import kernel
from spheredrive.dynamics.algebra import cross, dot, rotation_rows, times
from spheredrive.dynamics.compliant.instant import row_vector, symmetric, vector
from spheredrive.dynamics.compliant.layout import (
    AXIAL_INERTIA,
    CENTRE,
    CENTRE_VELOCITY,
    CLOSURE_FORCE,
    CLOSURE_STIFFNESS,
    DEFLECTION,
    DEFLECTION_RATE,
    FIRST_OUTLINE,
    FIRST_ROLLER,
    INERTIA,
    MASS,
    MASS_CENTRE,
    MOUNT_MASS,
    MOUNT_STIFFNESS,
    MOVING_MASS,
    OMEGA,
    OUTLINE_COUNT,
    QUATERNION,
    ROLLER_COUNT,
    ROLLER_INERTIA,
    SPEED_OF_WHEEL,
    STAGE_VELOCITY,
    STATION_STATES,
    STATION_WHEEL,
    WEIGHT,
    WHEEL_STATES,
    WHEELS,
)


@kernel
def energies(y, body, wheels, stations, outlines):
    """Kinetic energy of all that moves, and potential energy of weight, closure and mounts, J.

        T = ½ M_s v² + M_s v·(Ω×ρ) + ½ Ω·IΩ + Σ ½ I_w ω² + Σ (½ m Δ̇² + m Δ̇ n̂·ṗ_l) + ½ (M_l + Σ m) ṗ_l²,   v = ṗ_l + ċ
        V = ½ c·K′c − c·(M_s g + F_ext) − ρ·M_s g + Σ ½ k Δ²

    Gravity acts on the sphere alone: the gantry carries the rest. The contacts' elastic energy is the stations' own.
    """
    n, m = wheels.shape[0], stations.shape[0]
    rows = rotation_rows((y[QUATERNION], y[QUATERNION + 1], y[QUATERNION + 2], y[QUATERNION + 3]))
    own, Omega = vector(body, MASS_CENTRE), vector(y, OMEGA)
    rho = (dot(rows[0], own), dot(rows[1], own), dot(rows[2], own))
    c, v_c, v_l = vector(y, CENTRE), vector(y, CENTRE_VELOCITY), vector(y, STAGE_VELOCITY)
    v = (v_c[0] + v_l[0], v_c[1] + v_l[1], v_c[2] + v_l[2])
    # Ω in the body frame: by the columns of the rotation.
    turn = (
        rows[0][0] * Omega[0] + rows[1][0] * Omega[1] + rows[2][0] * Omega[2],
        rows[0][1] * Omega[0] + rows[1][1] * Omega[1] + rows[2][1] * Omega[2],
        rows[0][2] * Omega[0] + rows[1][2] * Omega[1] + rows[2][2] * Omega[2],
    )
    mass = body[MASS]
    kinetic = 0.5 * mass * dot(v, v) + mass * dot(v, cross(Omega, rho)) + 0.5 * dot(turn, times(symmetric(body, INERTIA), turn))
    kinetic += 0.5 * (body[MOVING_MASS] - mass) * dot(v_l, v_l)
    weight, force = vector(body, WEIGHT), vector(body, CLOSURE_FORCE)
    potential = 0.5 * dot(c, times(symmetric(body, CLOSURE_STIFFNESS), c)) - dot(c, weight) - dot(c, force) - dot(rho, weight)
    for i in range(n):
        speed = y[WHEELS + WHEEL_STATES * i + SPEED_OF_WHEEL]
        kinetic += 0.5 * wheels[i, AXIAL_INERTIA] * speed * speed
    at_rollers = WHEELS + WHEEL_STATES * n + STATION_STATES * m
    for s in range(m):
        at = WHEELS + WHEEL_STATES * n + STATION_STATES * s
        rate, deflection = y[at + DEFLECTION_RATE], y[at + DEFLECTION]
        kinetic += stations[s, MOUNT_MASS] * rate * (0.5 * rate + dot(row_vector(stations, s), v_l))
        potential += 0.5 * stations[s, MOUNT_STIFFNESS] * deflection * deflection
        inertia = wheels[int(stations[s, STATION_WHEEL]), ROLLER_INERTIA]
        first = int(stations[s, FIRST_OUTLINE])
        for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
            begin = int(outlines[o, FIRST_ROLLER])
            for k in range(begin, begin + int(outlines[o, ROLLER_COUNT])):
                kinetic += 0.5 * inertia * y[at_rollers + k] * y[at_rollers + k]
    return kinetic, potential


@kernel
def energies_over_time(states, body, wheels, stations, outlines, out):
    """``energies`` of each row of ``states`` (k, size) into ``out`` (k, 2)."""
    for k in range(states.shape[0]):
        out[k, 0], out[k, 1] = energies(states[k], body, wheels, stations, outlines)
