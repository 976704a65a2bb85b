"""The linear system of a design: one form for rigid, compliant and stiff-damped machines alike.

    Y(s) = (D₀ + D₁ s + D₂ s²) H(s) + Σ_r O_r W_r(s),   W_r = (s b_r·H + W_{r−1} where linked)/(s − λ_r)

from the shapes h of the contacts to the motion of the sphere's centre, of a payload, and to the contact forces. The states are
driven by ḣ, so that D₀ is the static answer itself, and what is static is not the difference of large numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.compiled import njit
from spheredrive.errors import SpheredriveError, did_you_mean
from spheredrive.shape import profile
from spheredrive.vibration.model.equations import Contacts, Equations, Isolator, contacts_of, equations, seat_force
from spheredrive.vibration.model.links import linked_form
from spheredrive.vibration.model.modal import ILL, modal_form, output_vectors
from spheredrive.vibration.model.small import product, solve, transposed

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.shape import Profile

MODELS = ("coupled", "independent", "thesis")
MEASURES = ("true", "thesis")
SIGNS = ("restoring", "thesis")


class System(NamedTuple):
    """Flat arrays for compiled functions: R states, m inputs, y outputs.

    lam, link    poles λ (R,), 1/s; 1 where a state is driven by the one before it, (R,)
    b            (R, m)
    real, imag   parts of O, (R, y)
    D0, D1, D2   (m, y)
    """

    lam: np.ndarray
    link: np.ndarray
    b: np.ndarray
    real: np.ndarray
    imag: np.ndarray
    D0: np.ndarray
    D1: np.ndarray
    D2: np.ndarray


@njit(error_model="numpy")
def strict_inputs(M, D, K, Bk, Bc, Bm):
    """B_k, B_c of what is left when q follows h by M⁻¹B_m at once, and that matrix."""
    at_once = solve(M, Bm)
    k, c = product(K, at_once), product(D, at_once)
    left_k, left_c = np.empty(Bk.shape), np.empty(Bk.shape)
    for i in range(Bk.shape[0]):
        for j in range(Bk.shape[1]):
            left_k[i, j], left_c[i, j] = Bk[i, j] - k[i, j], Bc[i, j] - c[i, j]
    return left_k, left_c, at_once


@njit(error_model="numpy")
def outputs(form, static, at_once, kick, L, P, Rq, Rv, Ra, Rh, Rs):
    """The system of the poles ``form`` (λ, link, b, V); ``static`` K⁻¹B_k, ``at_once`` M⁻¹B_m, ``kick`` M⁻¹B_c, (d, m) each."""
    lam, link, b, V = form
    Vq, Va = output_vectors(lam, link, V)
    y, R, m = Rq.shape[0], lam.size, P.shape[1]
    Sq, Sv, Sa = product(Rq, L), product(Rv, L), product(Ra, L)
    real, imag = np.zeros((R, y)), np.zeros((R, y))
    for r in range(R):
        for j in range(y):
            total = 0j
            for i in range(V.shape[0]):
                total += Sq[j, i] * Vq[i, r] + Sv[j, i] * V[i, r] + Sa[j, i] * Va[i, r]
            real[r, j], imag[r, j] = total.real, total.imag
    follow = product(L, at_once)
    for i in range(follow.shape[0]):
        for j in range(m):
            follow[i, j] += P[i, j]
    D0, D1, D2 = product(Rq, follow), product(Rv, follow), product(Ra, follow)
    more0, more1 = product(Sq, static), product(Sa, kick)
    for i in range(y):
        for j in range(m):
            D0[i, j] += more0[i, j] + Rh[i, j]
            D1[i, j] += more1[i, j] + Rs[i, j]
    return System(lam, link, b, real, imag, transposed(D0), transposed(D1), transposed(D2))


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """A design's linear vibration: what ``linear_system`` returns.

    design, model, isolator   as they were given
    equations      matrices, rows and what follows the shapes at once
    system         poles and outputs as flat arrays
    modal          λ, link, V of the free coordinates, what they follow statically, K⁻¹B_k, and at once, M⁻¹B_m
    contacts       wheel and normal n̂ of each contact
    profiles       shape of each contact
    seat_force     N⁰, N, (m,)
    thesis_measure whether outputs are the thesis's (E3)
    """

    design: Design
    model: str
    isolator: Isolator | None
    equations: Equations
    system: System
    modal: tuple[np.ndarray, ...]
    contacts: Contacts
    profiles: tuple[Profile, ...]
    seat_force: np.ndarray
    thesis_measure: bool

    @property
    def triples(self) -> int:
        """Vectors among the outputs: displacement, velocity, acceleration of the centre, and of a payload."""
        return 3 if self.isolator is None else 6

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the full coordinates, as mode shapes list them."""
        m = len(self.contacts.wheel)
        names = [f"sphere {axis}" for axis in "xyz"] if self.model == "coupled" else _numbered("contact", m)
        if self.design.mount.stiffness is not None:
            names += _numbered("mount", m)
        if self.isolator is not None:
            names += [f"payload {axis}" for axis in "xyz"]
        return tuple(names)

    def transfer(self, s) -> np.ndarray:
        """Y(s), complex, from each contact's shape to all outputs, (..., y, m), at ``s`` (...), 1/s.

        By solving the matrices at s, not by the poles. Raises nothing; at an undamped pole entries are infinite.
        """
        e = self.equations
        s = np.asarray(s, complex)[..., None, None]
        drive = e.input_stiffness + s * e.input_damping + s**2 * e.input_mass
        if len(e.mass):
            q = np.linalg.solve(s**2 * e.mass + s * e.damping + e.stiffness, drive)
            Q = e.free @ q + e.follow
        else:
            Q = e.follow + 0 * s
        rows = e.row_position + s * e.row_velocity + s**2 * e.row_acceleration
        return rows @ Q + e.row_input + s * e.row_slope


def _numbered(name: str, count: int) -> list[str]:
    return [f"{name} {i + 1}" for i in range(count)]


def linear_system(
    design: Design,
    model: str = "coupled",
    isolator: Isolator | None = None,
    *,
    closure_sign: str | None = None,
    measure: str = "true",
    normal_force=None,
    profiles=None,
) -> LinearSystem:
    """The linear vibration of a design about its loaded seat.

        M_s c̈ + Σ n̂ (K δ + C δ̇) + closure = 0,   m Δ̈ + c Δ̇ + k Δ − C δ̇ − K δ = 0,   δ = n̂·c − Δ − h

    model          "coupled": the centre on all contacts at once; "independent": the thesis's, each contact alone and their
                   y n̂ summed [3.33]; "thesis": that with its sign of K′
    isolator       springs and dampers of a payload inside the sphere; coupled model only
    closure_sign   "restoring", or "thesis" (E1), for the independent model only
    measure        "true" motion of the centre, or "thesis" (E3): the elastic deflection y − h in its place, impulses at the
                   rollers' edges left out; for the independent model with contact stiffness only
    normal_force   N⁰ of each contact, N, (m,), where it is not weight and closure force shared by least squares
    profiles       a ``shape.Profile`` a contact in place of the wheels' own

    ``contact.stiffness`` and ``mount.stiffness`` that are absent mean rigid. Raises ``SpheredriveError`` for a mass that is
    missing and for rigid contacts that contradict each other; ``SingularError`` naming the direction in which nothing holds the
    sphere. Source: model.md section 5b; [3.41–3.42], E1, E3, E8.
    """
    sign = _checked(model, closure_sign, measure)
    if isolator is not None and model != "coupled":
        raise SpheredriveError('an isolator needs the sphere as one body; use model="coupled"')
    if measure == "thesis" and design.contact.stiffness is None:
        raise SpheredriveError("the thesis's measure is the deflection of elastic contacts: give contact.stiffness")
    contacts = contacts_of(design)
    shapes = _profiles(design, contacts, profiles)
    e = equations(design, contacts, "coupled" if model == "coupled" else "independent", isolator, sign, measure)
    force = seat_force(design, contacts, isolator.mass if isolator else 0.0) if normal_force is None else normal_force
    force = np.broadcast_to(np.asarray(force, float), len(contacts.wheel)).copy()
    if not np.isfinite(force).all():
        raise SpheredriveError("normal_force must be finite")
    name = "coupled" if model == "coupled" else "independent"
    arrays = [np.ascontiguousarray(a, dtype=float) for a in e]
    form, static, at_once, kick = _modal(*arrays[:6])
    system = outputs(form, static, at_once, kick, *arrays[6:])
    modal = form[0], form[1], form[3], static, at_once
    return LinearSystem(design, name, isolator, e, system, modal, contacts, shapes, force, measure == "thesis")


def _checked(model: str, closure_sign: str | None, measure: str) -> str:
    if model not in MODELS:
        raise SpheredriveError(f"there is no vibration model {model!r}{did_you_mean(model, MODELS)}")
    sign = closure_sign or ("thesis" if model == "thesis" else "restoring")
    if sign not in SIGNS:
        raise SpheredriveError(f"there is no sign of the closure {sign!r}{did_you_mean(sign, SIGNS)}")
    if measure not in MEASURES:
        raise SpheredriveError(f"there is no measure {measure!r}{did_you_mean(measure, MEASURES)}")
    if model == "coupled" and (sign == "thesis" or measure == "thesis"):
        raise SpheredriveError('the thesis\'s sign and measure are for its own model; use model="independent"')
    return sign


def _profiles(design: Design, contacts: Contacts, given) -> tuple[Profile, ...]:
    if given is not None:
        given = tuple(given)
        if len(given) != len(contacts.wheel):
            raise SpheredriveError(f"{len(given)} profiles are given for {len(contacts.wheel)} contacts")
        return given
    radius = design.sphere.radius
    return tuple(profile(design.wheels[w], radius, race=r) for w, r in zip(contacts.wheel, contacts.race, strict=True))


def _modal(M, D, K, Bk, Bc, Bm):
    """The poles (λ, link, b, V), K⁻¹B_k, M⁻¹B_m and M⁻¹B_c."""
    d, m = Bk.shape
    if d == 0:
        empty = np.zeros((0, m))
        none = np.zeros(0, complex), np.zeros(0, np.int64), np.zeros((0, m), complex), np.zeros((0, 0), complex)
        return none, empty, empty, empty
    left_k, left_c, at_once = strict_inputs(M, D, K, Bk, Bc, Bm)
    *form, worst = modal_form(M, D, K, left_k, left_c)
    if not worst < ILL:
        form = linked_form(M, D, K, left_k, left_c)
    return tuple(form), solve(K, left_k), at_once, solve(M, left_c)
