"""The energy ledger of a compliant run: what is stored, what went in, what was lost."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spheredrive.dynamics.compliant import layout as at
from spheredrive.frames import quaternion_matrix
from spheredrive.simulation.compliant.run import CompliantRun


class Ledger(NamedTuple):
    """Energies in J over time, (k,); ``residual`` is what does not add up.

        kinetic + potential + elastic + slip + contact_damping + resistances − motor_work − stage_work = constant

    kinetic          of sphere, wheels, their masses on mounts, turning rollers and the stage
    potential        of weight, closure force and springs, and mounts
    elastic          of the contacts
    slip             lost by slipping
    contact_damping  lost in the contacts' damping
    resistances      lost by roller drag, rolling and spin resistance, and the damping of mounts and closure
    """

    kinetic: np.ndarray
    potential: np.ndarray
    elastic: np.ndarray
    motor_work: np.ndarray
    stage_work: np.ndarray
    slip: np.ndarray
    contact_damping: np.ndarray
    resistances: np.ndarray
    residual: np.ndarray


def ledger(run: CompliantRun) -> Ledger:
    """The ledger at every sample of a run. Gravity acts on the sphere alone: the gantry carries the rest."""
    kinetic, potential = _kinetic(run), _potential(run)
    motor, stage, slip, damping, other = run.works[:, : at.POWERS].T
    total = kinetic + potential + run.stored + slip + damping + other - motor - stage
    residual = total - total[0] if len(total) else total
    return Ledger(kinetic, potential, run.stored, motor, stage, slip, damping, other, residual)


def _kinetic(run: CompliantRun) -> np.ndarray:
    m, y = run.machine, run.states
    body, n = m.body, len(m.wheels)
    turn = quaternion_matrix(y[:, at.QUATERNION : at.QUATERNION + 4])
    rho = turn @ body[at.MASS_CENTRE : at.MASS_CENTRE + 3]
    Omega, v_l = y[:, at.OMEGA : at.OMEGA + 3], y[:, at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3]
    v = v_l + y[:, at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3]
    own = np.einsum("kji,kj->ki", turn, Omega)
    swing = np.sum(v * np.cross(Omega, rho), axis=1)
    sphere = 0.5 * body[at.MASS] * (np.sum(v * v, axis=1) + 2 * swing) + 0.5 * np.einsum(
        "ki,ij,kj->k", own, _inertia(body), own
    )
    to = at.WHEELS + at.WHEEL_STATES * n
    speed = y[:, at.WHEELS + at.SPEED_OF_WHEEL : to : at.WHEEL_STATES]
    wheels = 0.5 * speed**2 @ m.wheels[:, at.AXIAL_INERTIA]
    stations = to + at.STATION_STATES * np.arange(len(m.stations))
    rate, mass, n_hat = y[:, stations + at.DEFLECTION_RATE], m.stations[:, at.MOUNT_MASS], m.stations[:, :3]
    along = v_l @ n_hat.T
    mounts = 0.5 * (rate**2 + 2 * rate * along) @ mass
    stage = 0.5 * (body[at.MOVING_MASS] - body[at.MASS]) * np.sum(v_l * v_l, axis=1)
    inertia = np.zeros(m.rollers)
    for outline, row in enumerate(m.outlines):
        first, count = int(row[at.FIRST_ROLLER]), int(row[at.ROLLER_COUNT])
        inertia[first : first + count] = m.wheels[m.contacts[outline][0] - 1, at.ROLLER_INERTIA]
    rollers = 0.5 * y[:, to + at.STATION_STATES * len(m.stations) :] ** 2 @ inertia
    return sphere + wheels + mounts + stage + rollers


def _potential(run: CompliantRun) -> np.ndarray:
    m, y = run.machine, run.states
    body = m.body
    c = y[:, at.CENTRE : at.CENTRE + 3]
    rho = quaternion_matrix(y[:, at.QUATERNION : at.QUATERNION + 4]) @ body[at.MASS_CENTRE : at.MASS_CENTRE + 3]
    weight, force = body[at.WEIGHT : at.WEIGHT + 3], body[at.CLOSURE_FORCE : at.CLOSURE_FORCE + 3]
    K = six(body, at.CLOSURE_STIFFNESS)
    to = at.WHEELS + at.WHEEL_STATES * len(m.wheels) + at.STATION_STATES * np.arange(len(m.stations))
    mounts = 0.5 * y[:, to + at.DEFLECTION] ** 2 @ m.stations[:, at.MOUNT_STIFFNESS]
    return 0.5 * np.einsum("ki,ij,kj->k", c, K, c) - c @ (weight + force) - rho @ weight + mounts


def _inertia(body) -> np.ndarray:
    return six(body, at.INERTIA)


def six(body, i: int) -> np.ndarray:
    """The symmetric matrix whose six entries stand in ``body`` from ``i`` on."""
    a = body[i : i + 6]
    return np.array([[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]])
