"""Natural frequencies, mode shapes, damping, and the answer to a single frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.vibration.model.system import LinearSystem, linear_system

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.vibration.model.equations import Isolator


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a machine; d of them, of D coordinates.

    natural_frequencies   without damping, rising, Hz, (d,)
    shapes                rows, one a mode, over ``labels``, largest entry 1, (d, D)
    labels                what the entries of a shape are, (D,)
    poles                 of the damped machine: of each complex pair the upper one, then the real ones, 1/s
    damping_ratios        −Re λ/|λ| of each pole; 1 for a real one
    damped_frequencies    Im λ/2π of each pole, Hz; 0 for a real one
    """

    natural_frequencies: np.ndarray
    shapes: np.ndarray
    labels: tuple[str, ...]
    poles: np.ndarray
    damping_ratios: np.ndarray
    damped_frequencies: np.ndarray


def modes(design: Design, model: str = "coupled", isolator: Isolator | None = None, **options) -> Modes:
    """Natural frequencies and modes of a design about its loaded seat.

        K φ = ω² M φ;   (λ² M + λ D + K) ψ = 0

    Arguments and errors as ``linear_system``. Rigid contacts on rigid mounts leave no modes. The three wheels of the Atlas
    layout at elevation −θ give ω² = (K/M_s)(3/2) cos² θ twice and (K/M_s) 3 sin² θ. Source: model.md section 5b; [4.9] for the
    independent model.
    """
    ls = linear_system(design, model, isolator, **options)
    e = ls.equations
    if not len(e.mass):
        none = np.zeros(0)
        return Modes(none, np.zeros((0, len(ls.labels))), ls.labels, none.astype(complex), none, none)
    from scipy.linalg import eigh

    squared, vectors = eigh(e.stiffness, e.mass)
    shapes = (e.free @ vectors).T
    largest = shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)]
    # Poles that meet stand in the system once for each input.
    lam = ls.system.lam
    if ls.system.link.any():
        d = len(e.mass)
        M = np.linalg.inv(e.mass)
        lam = np.linalg.eigvals(np.block([[np.zeros((d, d)), np.eye(d)], [-M @ e.stiffness, -M @ e.damping]]))
        lam = np.where(np.abs(lam.imag) < 1e-6 * np.abs(lam), lam.real + 0j, lam)
        lam = lam[lam.imag >= 0]
    lam = lam[np.lexsort((np.abs(lam), lam.imag == 0))]
    size = np.abs(lam)
    return Modes(
        np.sqrt(squared) / (2 * np.pi), shapes / largest[:, None], ls.labels, lam, -lam.real / size, lam.imag / (2 * np.pi)
    )


def frequency_response(
    design: Design, frequency, model: str = "coupled", isolator: Isolator | None = None, *, of: str = "sphere", **options
) -> np.ndarray:
    """Displacement of the sphere's centre by each contact's shape, complex, m/m, (..., 3, m).

        Y(s) = (s² M + s D + K)⁻¹ (B_k + s B_c + s² B_m),   s = 2πi f

    ``frequency`` (...) in Hz; ``of`` "sphere" or "payload". Other arguments and errors as ``linear_system``; m contacts, one a
    wheel but for split dual races. Source: model.md section 5b.
    """
    ls = linear_system(design, model, isolator, **options)
    first = _rows(ls, of)
    frequency = np.asarray(frequency, float)
    if not np.isfinite(frequency).all():
        raise SpheredriveError("a frequency response takes finite frequencies")
    return ls.transfer(2j * np.pi * frequency)[..., first : first + 3, :]


def transmissibility(
    design: Design, frequency, model: str = "coupled", isolator: Isolator | None = None, *, of: str = "sphere", **options
) -> np.ndarray:
    """How much of what rigid contacts would give reaches the centre, complex, (..., m).

        T_i(f) = g_i · Y_i(f)/(g_i · g_i),   g_i = column i of (n̂ᵀ)⁺: the centre's motion by h_i on rigid contacts

    At low frequency 1 without closure springs and with independent n̂; for the independent model g_i = n̂_i and the static value
    is kK/(kK + K′(k + K)). Shapes and arguments as ``frequency_response``. Source: model.md section 5b.
    """
    ls = linear_system(design, model, isolator, **options)
    n_hat = ls.contacts.normal
    rigid = np.linalg.pinv(n_hat) if ls.model == "coupled" else n_hat.T
    Y = frequency_response(design, frequency, model, isolator, of=of, **options)
    return (rigid * Y[..., : len(n_hat)]).sum(axis=-2) / (rigid**2).sum(axis=0)


def _rows(ls: LinearSystem, of: str) -> int:
    if of == "sphere":
        return 0
    if of != "payload":
        raise SpheredriveError(f"there is the response of the 'sphere' or of the 'payload', not of {of!r}")
    if ls.isolator is None:
        raise SpheredriveError("there is no payload without an isolator")
    return 9
