"""The static seat: where the sphere rests on its wheels at given wheel angles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.instant import rates
from spheredrive.dynamics.compliant.station import ALL, DERIVATIVES, GAP, ROLLER_SIZE, STORED, TOUCH_SIZE, WRENCH_SIZE
from spheredrive.errors import SpheredriveError
from spheredrive.simulation.compliant.engine import settle

if TYPE_CHECKING:
    from spheredrive.dynamics.compliant.machine import Machine

# Newton steps, and the force (as a share of what presses the sphere) that may be left over.
STEPS, LEFT_OVER = 200, 1e-12
# Looks at the outlines before Newton's method.
APPROACHES = 8
# A direction in which the seat is this much softer than in its stiffest is not held.
SOFT = 1e-9


class Instant(NamedTuple):
    """What acts in a state at rest or in motion: see ``dynamics.compliant``."""

    rate: np.ndarray
    power: np.ndarray
    motors: np.ndarray
    wrenches: np.ndarray
    touches: np.ndarray
    K: np.ndarray
    D: np.ndarray


def instant(machine: Machine, y, places, turns, drive=None, drive_kind: int = at.TORQUE) -> Instant:
    """Rates, forces and derivatives of a machine in the state ``y`` on a stage at rest; ``drive`` as the kind says."""
    n, m, q = len(machine.wheels), len(machine.stations), len(machine.outlines)
    found = Instant(
        np.zeros(len(y)), np.zeros(at.POWERS), np.zeros(n), np.zeros((m, WRENCH_SIZE)), np.zeros((q, TOUCH_SIZE)),
        np.zeros((m, 7, 4)), np.zeros((m, 7, 7)),
    )  # fmt: skip
    rate, power, motors, wrenches, touches, K, D = found
    rates(
        y, np.zeros(n) if drive is None else np.asarray(drive, float), np.zeros(n), np.zeros(3), drive_kind, at.STILL,
        machine.body, machine.wheels, machine.stations, machine.outlines, machine.pieces, places, turns,
        np.full(q, ALL), DERIVATIVES, 1.0,
        rate, power, motors, wrenches, touches, np.zeros((machine.rollers, ROLLER_SIZE)), K, D,
    )  # fmt: skip
    return found


def seat(machine: Machine, y: np.ndarray, places, turns) -> np.ndarray:
    """The state ``y`` at rest (wheel angles and orientation kept) with the sphere in its static seat; rings are settled.

    Minimises the energy of contacts, mounts, closure and gravity over the centre c and the mounts' deflections Δ by Newton's
    method. It starts pressed in, R̂ᵢ·c = Nᵢ/K − h: from open contacts Newton's method has nothing to go by. Raises
    ``SpheredriveError`` where nothing presses the sphere on its wheels, where what presses it pushes it off them, or where
    some direction is not held. Friction and the sphere's orientation play no part: at rest friction is zero.
    """
    y = y.copy()
    y[at.CENTRE_VELOCITY : at.OMEGA + 3] = 0.0
    n, m = len(machine.wheels), len(machine.stations)
    to = at.WHEELS + at.WHEEL_STATES * n + at.STATION_STATES * np.arange(m)
    y[at.WHEELS + at.SPEED_OF_WHEEL : to[0] : at.WHEEL_STATES] = 0.0
    load = machine.body[at.WEIGHT : at.WEIGHT + 3] + machine.body[at.CLOSURE_FORCE : at.CLOSURE_FORCE + 3]
    size = float(np.linalg.norm(load))
    normals = machine.stations[:, at.N_HAT : at.N_HAT + 3]
    free = np.flatnonzero(machine.stations[:, at.MOUNT_MASS] > 0)
    y[at.CENTRE : at.CENTRE + 3] = _pressed_in(machine, y, places, turns, normals, load, size)

    def residual(y):
        settle(y, n, machine.stations, machine.outlines, machine.pieces, places, turns)
        now = instant(machine, y, places, turns)
        F = load - _six(machine.body, at.CLOSURE_STIFFNESS) @ y[at.CENTRE : at.CENTRE + 3]
        F = F + _rotated(machine, now.wrenches[:, :3]).sum(axis=0)
        pushed = -machine.stations[:, at.MOUNT_STIFFNESS] * y[to + at.DEFLECTION] - now.wrenches[:, 0]
        return np.concatenate([F, pushed[free]]), now

    def energy(y, now):
        c, delta = y[at.CENTRE : at.CENTRE + 3], y[to + at.DEFLECTION]
        stiff = _six(machine.body, at.CLOSURE_STIFFNESS)
        mounts = 0.5 * machine.stations[:, at.MOUNT_STIFFNESS] @ delta**2
        return now.wrenches[:, STORED].sum() + 0.5 * c @ stiff @ c - load @ c + mounts

    force, now = residual(y)
    here = energy(y, now)
    scale = max(size, float(np.abs(now.wrenches[:, :3]).max(initial=0.0)))
    for _ in range(STEPS):
        H = _stiffness(machine, now, free)
        # A place is known to a few roundings of the sphere's size, a force no better than the stiffness makes of it.
        rounding = 4 * np.finfo(float).eps * machine.body[at.RADIUS] * np.abs(H).max() if size else 0.0
        if np.abs(force).max() <= LEFT_OVER * max(scale, 1e-30) + rounding:
            break
        # A little softness everywhere, so that a direction that is not held yet is no fault of arithmetic.
        step = np.linalg.solve(H + 1e-9 * np.trace(H) / len(H) * np.eye(len(H)) + 1e-30 * np.eye(len(H)), force)
        share = 1.0
        while share > 1e-10:
            trial = y.copy()
            trial[at.CENTRE : at.CENTRE + 3] += share * step[:3]
            trial[to[free] + at.DEFLECTION] += share * step[3:]
            if np.linalg.norm(trial[at.CENTRE : at.CENTRE + 3]) < machine.body[at.RADIUS]:
                new_force, new = residual(trial)
                there = energy(trial, new)
                if there <= here - 1e-4 * share * (force @ step) or np.abs(new_force).max() < 0.5 * np.abs(force).max():
                    break
            share *= 0.5
        else:
            break
        y, force, now, here = trial, new_force, new, there
    _require_seat(machine, force, now, size, free)
    return y


def _require_seat(machine: Machine, force, now: Instant, size: float, free) -> None:
    pressed = now.wrenches[:, 0].sum()
    if size == 0.0 and pressed <= 0.0:
        raise SpheredriveError(
            "nothing presses the sphere on its wheels: give it a closure.force, closure springs that hold it, or gravity"
        )
    left = float(np.abs(force).max())
    H = _stiffness(machine, now, free)[:3, :3]
    held = np.linalg.eigvalsh(H)
    if left > 1e-6 * max(size, 1e-30) or held[0] <= SOFT * abs(held[2]):
        axis = np.linalg.eigh(H)[1][:, 0]
        way = " ".join(f"{x:+.2f}" for x in axis)
        raise SpheredriveError(
            "the sphere cannot sit on its wheels: what presses it (weight and closure.force) pushes it off them or lets it "
            f"move along ({way}); let the wheels reach further around it, or press it otherwise with closure.force or springs"
        )


def _pressed_in(machine: Machine, y, places, turns, normals, load, size: float) -> np.ndarray:
    """A first guess of c: every wheel that carries load pressed in by its share of it."""
    from scipy.optimize import nnls

    shares, _ = nnls(normals.T, -load) if size else (np.zeros(len(normals)), 0.0)
    held = shares > 1e-9 * size if size else np.ones(len(normals), bool)
    least = max(0.1 * size / len(normals), 1e-9)
    power = np.where(machine.stations[:, at.HERTZIAN] > 0, 2 / 3, 1.0)
    depth = (np.maximum(shares, least) / machine.stations[:, at.STIFFNESS]) ** power
    y = y.copy()
    y[at.CENTRE : at.CENTRE + 3] = 0.0
    begins, counts = (machine.stations[:, column].astype(int) for column in (at.FIRST_OUTLINE, at.OUTLINE_COUNT))
    for _ in range(APPROACHES):
        # The outlines stand below their tops: go where they are. A far roller says less than its gap, so none is passed.
        settle(y, len(machine.wheels), machine.stations, machine.outlines, machine.pieces, places, turns)
        gap = instant(machine, y, places, turns).touches[:, GAP]
        gaps = np.array([gap[begin : begin + count].min() for begin, count in zip(begins, counts, strict=True)])
        nearer = np.linalg.lstsq(normals[held], -(gaps + depth)[held], rcond=None)[0]
        y[at.CENTRE : at.CENTRE + 3] += nearer
        if np.abs(nearer).max() < 1e-3 * depth.min():
            break
    return y[at.CENTRE : at.CENTRE + 3]


def _stiffness(machine: Machine, now: Instant, free) -> np.ndarray:
    """Second derivative of the energy by (c, Δ of the mounts that give way)."""
    H = np.zeros((3 + len(free), 3 + len(free)))
    H[:3, :3] = _six(machine.body, at.CLOSURE_STIFFNESS)
    place = {s: 3 + k for k, s in enumerate(free)}
    for s, st in enumerate(machine.stations):
        Q = st[:9].reshape(3, 3).T
        k = -now.K[s, :3, :3]
        H[:3, :3] += Q @ k @ Q.T
        if s in place:
            j = place[s]
            H[:3, j] -= Q @ k[:, 0]
            H[j, :3] -= k[0] @ Q.T
            H[j, j] += k[0, 0] + st[at.MOUNT_STIFFNESS]
    return 0.5 * (H + H.T)


def _rotated(machine: Machine, vectors) -> np.ndarray:
    frames = machine.stations[:, :9].reshape(-1, 3, 3)
    return np.einsum("sij,si->sj", frames, vectors)


def _six(body, i: int) -> np.ndarray:
    a = body[i : i + 6]
    return np.array([[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]])
