"""The equations of linear vibration, model.md section 5b, from a design: matrices, what holds the sphere, the seat.

Full coordinates Q are the centre's displacement c, the mounts' deflections Δ where mounts give way, and a payload's
displacement where there is one. A rigid contact ties them to the shapes h: Q = L q + P h with free coordinates q; else Q = q.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.compiled import njit
from spheredrive.design import GRAVITY
from spheredrive.errors import DesignError, SingularError, SpheredriveError
from spheredrive.values import checked_number

if TYPE_CHECKING:
    from spheredrive.design import Design

# Springs whose stiffness is below this share of the stiffest hold nothing.
SLACK = 1e-12


@dataclass(frozen=True)
class Isolator:
    """Springs and dampers between the sphere and a payload inside it, whose mass comes on top of the sphere's.

    mass        of the payload, kg
    stiffness   N/m, one number or one along each of x, y, z
    damping     N s/m, likewise
    """

    mass: float
    stiffness: float | tuple[float, float, float]
    damping: float | tuple[float, float, float] = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "mass", checked_number(self.mass, "kg", "positive", ("isolator", "mass")))
        for name, unit, sign in (("stiffness", "N/m", "positive"), ("damping", "N s/m", "non-negative")):
            value = getattr(self, name)
            axes = [value] * 3 if np.ndim(value) == 0 else list(value)
            if len(axes) != 3:
                raise DesignError("takes one number, or three along x, y and z", ("isolator", name))
            checked = tuple(checked_number(v, unit, sign, ("isolator", name)) for v in axes)
            object.__setattr__(self, name, checked)


class Equations(NamedTuple):
    """M q̈ + D q̇ + K q = B_k h + B_c ḣ + B_m ḧ, Q = L q + P h, and outputs

        y = R_q Q + R_v Q̇ + R_a Q̈ + R_h h + R_s ḣ

    d free and D full coordinates, m inputs, y: displacement, velocity and acceleration (3 each) of the sphere's centre, of the
    payload where there is one, then the change of each contact's force.
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    input_stiffness: np.ndarray
    input_damping: np.ndarray
    input_mass: np.ndarray
    free: np.ndarray
    follow: np.ndarray
    row_position: np.ndarray
    row_velocity: np.ndarray
    row_acceleration: np.ndarray
    row_input: np.ndarray
    row_slope: np.ndarray


@njit(error_model="numpy")
def contact_equations(directions, sphere_mass, mass, K, C, k, c, closure_K, closure_D, compliant):
    """M, D, K (d, d) and B_k, B_c (d, m) of the sphere on m contacts along ``directions`` (m, p), mounts where ``compliant``.

    M_s c̈ + Σ n̂ (K δ + C δ̇) + K_closure c + D_closure ċ = 0,   δ = n̂·c − Δ − h
    m Δ̈ + c Δ̇ + k Δ − C δ̇ − K δ = 0
    """
    m, p = directions.shape
    d = p + m if compliant else p
    M, D, S = np.zeros((d, d)), np.zeros((d, d)), np.zeros((d, d))
    Bk, Bc = np.zeros((d, m)), np.zeros((d, m))
    for i in range(p):
        M[i, i] = sphere_mass
        for j in range(p):
            S[i, j], D[i, j] = closure_K[i, j], closure_D[i, j]
    for j in range(m):
        for a in range(p):
            Bk[a, j], Bc[a, j] = K[j] * directions[j, a], C[j] * directions[j, a]
            for e in range(p):
                S[a, e] += K[j] * directions[j, a] * directions[j, e]
                D[a, e] += C[j] * directions[j, a] * directions[j, e]
        if compliant:
            w = p + j
            M[w, w], S[w, w], D[w, w] = mass[j], k[j] + K[j], c[j] + C[j]
            Bk[w, j], Bc[w, j] = -K[j], -C[j]
            for a in range(p):
                S[a, w] = -K[j] * directions[j, a]
                D[a, w] = -C[j] * directions[j, a]
                S[w, a], D[w, a] = S[a, w], D[a, w]
    return M, D, S, Bk, Bc


@njit(error_model="numpy")
def contact_rows(directions, to_centre, K, C, compliant):
    """Rows R_q, R_v, R_a (9 + m, d) and R_h, R_s (9 + m, m) of the centre's motion and of N − N⁰ = −(K δ + C δ̇)."""
    m, p = directions.shape
    d = p + m if compliant else p
    Rq, Rv, Ra = np.zeros((9 + m, d)), np.zeros((9 + m, d)), np.zeros((9 + m, d))
    Rh, Rs = np.zeros((9 + m, m)), np.zeros((9 + m, m))
    for a in range(3):
        for e in range(p):
            Rq[a, e] = Rv[3 + a, e] = Ra[6 + a, e] = to_centre[a, e]
    for j in range(m):
        for a in range(p):
            Rq[9 + j, a], Rv[9 + j, a] = -K[j] * directions[j, a], -C[j] * directions[j, a]
        if compliant:
            Rq[9 + j, p + j], Rv[9 + j, p + j] = K[j], C[j]
        Rh[9 + j, j], Rs[9 + j, j] = K[j], C[j]
    return Rq, Rv, Ra, Rh, Rs


class Contacts(NamedTuple):
    """The m contacts: index of the wheel, n̂ = −R̂ (m, 3), race that shapes it (None: all at R̂), mass that rides on the mount."""

    wheel: np.ndarray
    normal: np.ndarray
    race: tuple
    mass: np.ndarray | None


def contacts_of(design: Design) -> Contacts:
    """One contact a wheel at its nominal place; two of a split dual-race wheel, at R̂ and −R̂.

    The second wheel of a split dual race is a wheel of its own on a mount of its own with half of the mass given, and both
    touch all along: what presses them together is not in these equations, give it as ``normal_force``.
    """
    wheel, normal, race, mass = [], [], [], []
    for i, placement in enumerate(design.placements):
        races = design.races(placement.wheel)
        sides = sorted({r.antipodal for r in races})
        for antipodal in sides:
            wheel.append(i)
            sign = 1.0 if antipodal else -1.0
            normal.append(sign * np.array(placement.contact_direction))
            numbers = [r.number for r in races if r.antipodal == antipodal]
            race.append(numbers[0] if len(sides) > 1 else None)
            mass.append(None if placement.wheel.mass is None else placement.wheel.mass / len(sides))
    masses = None if any(x is None for x in mass) else np.array(mass, float)
    return Contacts(np.array(wheel), np.array(normal), tuple(race), masses)


def equations(
    design: Design, contacts: Contacts, model: str, isolator: Isolator | None, closure_sign: str, measure: str
) -> Equations:
    """The equations of ``model`` "coupled" or "independent"; see ``system.linear_system`` for the arguments and errors."""
    if design.sphere.mass is None:
        raise SpheredriveError("vibration needs sphere.mass")
    compliant = design.mount.stiffness is not None
    if compliant and contacts.mass is None:
        missing = next(w.name for w in design.wheels if w.mass is None)
        raise SpheredriveError(f"wheels on compliant mounts vibrate by their mass: give wheels.{missing} a mass")
    m = len(contacts.normal)
    coupled = model == "coupled"
    directions = contacts.normal if coupled else np.eye(m)
    to_centre = np.eye(3) if coupled else np.ascontiguousarray(contacts.normal.T)
    closure = closure_matrices(design, directions if coupled else None, m, -1.0 if closure_sign == "thesis" else 1.0)
    rigid = design.contact.stiffness is None
    K = np.full(m, 0.0 if rigid else design.contact.stiffness)
    C = np.full(m, 0.0 if rigid else design.contact.damping)
    k, c = np.full(m, design.mount.stiffness or 0.0), np.full(m, design.mount.damping)
    mass = contacts.mass if compliant else np.zeros(m)
    M, D, S, Bk, Bc = contact_equations(directions, design.sphere.mass, mass, K, C, k, c, *closure, compliant)
    rows = contact_rows(directions, to_centre, K, C, compliant)
    if isolator is not None:
        M, D, S, Bk, Bc, rows = _with_payload(isolator, M, D, S, Bk, Bc, rows)
    L, P = np.eye(len(M)), np.zeros((len(M), m))
    if rigid:
        L, P, rows = _tied(directions, compliant, M, D, S, rows)
    answer = _reduced(M, D, S, Bk, Bc, L, P, rows)
    _require_held(answer, coupled, closure_sign, to_centre)
    return _thesis_measure(answer, to_centre, design.sphere.mass, closure, compliant) if measure == "thesis" else answer


def closure_matrices(design: Design, directions, m: int, sign: float):
    """Stiffness and damping of pads opposite every wheel and of springs, on the centre or on each contact alone."""
    pad = design.closure
    if directions is None:
        if pad.springs:
            raise SpheredriveError('closure.springs have no place where each contact stands alone; use model="coupled"')
        return sign * pad.stiffness * np.eye(m), pad.damping * np.eye(m)
    # A split wheel has its other half where the pad would be; its axis is held once.
    n_hat = -design.contact_directions
    K, D = pad.stiffness * n_hat.T @ n_hat, pad.damping * n_hat.T @ n_hat
    for spring in pad.springs:
        along = np.outer(spring.direction, spring.direction)
        K, D = K + spring.stiffness * along, D + spring.damping * along
    return sign * K, D


def _with_payload(isolator: Isolator, M, D, S, Bk, Bc, rows):
    """Three more coordinates, the payload's displacement, and three more triples of rows after the centre's."""
    d, m = Bk.shape

    def grown(A, link):
        out = np.zeros((d + 3, d + 3))
        out[:d, :d] = A
        for a, value in enumerate(link):
            out[a, a] += value
            out[d + a, d + a] += value
            out[a, d + a] -= value
            out[d + a, a] -= value
        return out

    M, D, S = grown(M, (0, 0, 0)), grown(D, isolator.damping), grown(S, isolator.stiffness)
    M[d:, d:] = isolator.mass * np.eye(3)
    still = np.zeros((3, m))
    Rq, Rv, Ra, Rh, Rs = rows
    wide = [np.hstack([R, np.zeros((len(R), 3))]) for R in (Rq, Rv, Ra)]
    new = [np.zeros((9, d + 3)) for _ in range(3)]
    for order in range(3):
        new[order][3 * order : 3 * order + 3, d:] = np.eye(3)
    joined = [np.vstack([W[:9], N, W[9:]]) for W, N in zip(wide, new, strict=True)]
    joined += [np.vstack([W[:9], np.zeros((9, m)), W[9:]]) for W in (Rh, Rs)]
    return M, D, S, np.vstack([Bk, still]), np.vstack([Bc, still]), joined


def _tied(directions, compliant: bool, M, D, S, rows):
    """L and P of rigid contacts, n̂·c − Δ = h, and the rows of the contact forces by the balance of what they push."""
    m, p = directions.shape
    d = len(M)
    Rq, Rv, Ra, Rh, Rs = rows
    first = len(Rq) - m
    force = slice(first, first + m)
    if compliant:
        wheel = slice(p, p + m)
        rest = [i for i in range(d) if not p <= i < p + m]
        L, P = np.zeros((d, d - m)), np.zeros((d, m))
        L[rest, np.arange(d - m)] = 1.0
        L[wheel, :p] = directions
        P[wheel] = -np.eye(m)
        # What mount and inertia leave: N − N⁰ = −(m Δ̈ + c Δ̇ + k Δ).
        balance = -np.eye(d)[wheel]
    else:
        sigma = np.linalg.svd(directions, compute_uv=False)
        if m > p or sigma[-1] < 1e-9:
            raise SpheredriveError(
                f"{m} rigid contacts on rigid mounts do not fit a sphere that moves in {min(p, np.sum(sigma > 1e-9))} "
                "directions: their shapes contradict each other; give contact.stiffness or mount.stiffness"
            )
        inverse = np.linalg.pinv(directions)
        L, P = np.zeros((d, d - m)), np.zeros((d, m))
        null = np.linalg.svd(directions)[2][m:].T
        L[:p, : p - m] = null
        L[p:, p - m :] = np.eye(d - p)
        P[:p] = inverse
        balance = np.zeros((m, d))
        balance[:, :p] = inverse.T
    Rq[force], Rv[force], Ra[force] = balance @ S, balance @ D, balance @ M
    return L, P, (Rq, Rv, Ra, Rh, Rs)


def _reduced(M, D, S, Bk, Bc, L, P, rows) -> Equations:
    """The equations of the free coordinates."""
    return Equations(
        L.T @ M @ L, L.T @ D @ L, L.T @ S @ L,
        L.T @ (Bk - S @ P), L.T @ (Bc - D @ P), -L.T @ M @ P, L, P, *rows,
    )  # fmt: skip


def _require_held(e: Equations, coupled: bool, closure_sign: str, to_centre) -> None:
    """Raise where a free coordinate has no spring, or one that pushes away."""
    if not len(e.stiffness):
        return
    values, vectors = np.linalg.eigh(e.stiffness)
    most = np.abs(values).max()
    if values[0] > SLACK * most:
        return
    if values[0] < -SLACK * most and closure_sign == "thesis":
        raise SingularError(
            "with the thesis's sign the closure pushes the sphere off its wheels harder than they hold it; lower "
            "closure.stiffness"
        )
    moved = to_centre @ (e.free @ vectors[:, 0])[: to_centre.shape[1]]
    length = np.linalg.norm(moved)
    if length < 1e-9:
        raise SingularError("nothing holds a wheel on its mount: give mount.stiffness or contact.stiffness above zero")
    x, y, z = np.where(np.abs(moved / length) < 1e-9, 0.0, moved / length)
    raise SingularError(
        f"nothing holds the sphere along ({x:.4g}, {y:.4g}, {z:.4g}): no contact or closure spring acts in that direction, so "
        "it has no seat to vibrate about; add closure.springs there or place the wheels otherwise"
    )


def _thesis_measure(e: Equations, to_centre, sphere_mass: float, closure, compliant: bool) -> Equations:
    """In the thesis's variables y − h [3.41], with a second set of inputs, g = ḣ whose jumps at corners are left out (E3).

    M_s (ÿ − ḧ) + … = −M_s ġ − C′ ḣ − K′ h
    """
    p, m = to_centre.shape[1], e.input_stiffness.shape[1]
    d = len(e.mass)
    Bk, Bc = np.zeros((d, 2 * m)), np.zeros((d, 2 * m))
    Bk[:p, :m], Bc[:p, :m] = -closure[0], -closure[1]
    Bc[:p, m:] = -sphere_mass * np.eye(m)
    none, still = np.zeros((d, 2 * m)), np.zeros((len(e.row_input), 2 * m))
    return e._replace(
        input_stiffness=Bk, input_damping=Bc, input_mass=none, follow=none, row_input=still, row_slope=still.copy()
    )


def seat_force(design: Design, contacts: Contacts, payload_mass: float = 0.0) -> np.ndarray:
    """N⁰ of each contact on the seat, N, (m,): weight and closure force, shared by contacts that are equally stiff.

    Least squares of Σ n̂ N⁰ + F + M g = 0; what the contacts cannot balance rests on the closure springs, which carry nothing
    else at the seat.
    """
    load = np.array(design.closure.force, float)
    if design.stage.gravity:
        load[2] -= GRAVITY * ((design.sphere.mass or 0.0) + payload_mass)
    return np.linalg.pinv(contacts.normal.T) @ -load
