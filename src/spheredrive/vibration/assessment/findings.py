"""What a designer should know of a vibration, as findings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.checking import Finding
from spheredrive.vibration.model.equations import contacts_of

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.vibration.aboard.comfort import Comfort
    from spheredrive.vibration.assessment.assess import ContactForce
    from spheredrive.vibration.motion.response import Impulse
    from spheredrive.vibration.spectra.resonances import Excited

# A force below this share of the largest is none.
NONE = 1e-9


def of_forces(design: Design, forces: tuple[ContactForce, ...], turning: bool) -> Iterator[Finding]:
    """Contacts that are not pressed at rest, and those that the motion would lift; one finding a kind, with the worst."""
    scale = max((max(abs(f.seat), abs(f.least), abs(f.largest)) for f in forces), default=0.0)
    loose = [f.seat <= NONE * scale for f in forces]
    lifted = [turning and f.least <= 0 and not apart for f, apart in zip(forces, loose, strict=True)]
    if not any(loose) and not any(lifted):
        return
    held = _clamped(contacts_of(design).normal)
    if held.any():
        yield Finding(
            "clamped",
            "note",
            "Wheels that face each other can be pressed on the sphere from both sides. How hard is not in the design, so their "
            "contact forces are told about no such preload, and no loss of contact is.",
        )
    apart = [f for f, one, firm in zip(forces, loose, held, strict=True) if one and not firm]
    if apart:
        yield Finding(
            "not-pressed",
            "failure",
            f"{_wheels(apart)} not pressed at rest: {_least(apart, 'seat')}. The sphere needs a closure force, closure.force.",
        )
    lost = [f for f, one, firm in zip(forces, lifted, held, strict=True) if one and not firm]
    if lost:
        yield Finding(
            "loss-of-contact",
            "failure",
            f"{_wheels(lost)} lifted by the vibration: {_least(lost, 'least')}. The sphere needs more preload, rounder wheels "
            "or other speeds; beyond the loss of contact these numbers do not hold.",
        )


def _clamped(normal: np.ndarray) -> np.ndarray:
    """Whether each contact can be pressed by the others alone: some N ≥ 0 with Σ n̂ N = 0 has N_i > 0, (m,)."""
    from scipy.optimize import linprog

    m = len(normal)
    # t_i ≤ N_i and t_i ≤ 1: the largest Σ t is the number of contacts that can be pressed, all at once as N may be scaled.
    balance = np.hstack([normal.T, np.zeros((3, m))])
    found = linprog(
        np.concatenate([np.zeros(m), -np.ones(m)]),
        A_ub=np.hstack([-np.eye(m), np.eye(m)]),
        b_ub=np.zeros(m),
        A_eq=balance,
        b_eq=np.zeros(3),
        bounds=[(0, None)] * m + [(0, 1)] * m,
    )
    return found.x[m:] > 0.5 if found.success else np.zeros(m, bool)


def _wheels(forces) -> str:
    wheels = sorted({f.wheel for f in forces})
    if len(wheels) == 1:
        return f"Wheel {wheels[0]} is"
    *first, last = map(str, wheels if len(wheels) <= 8 else [*wheels[:7], f"{len(wheels) - 7} more"])
    return f"Wheels {', '.join(first)} and {last} are"


def _least(forces, name: str) -> str:
    worst = min(forces, key=lambda f: getattr(f, name))
    force = getattr(worst, name)
    if abs(force) < 5e-10 * (1 + abs(worst.largest)):
        return f"nothing presses wheel {worst.wheel}"
    return f"wheel {worst.wheel} would have to pull with {-force:.4g} N"


def of_impulses(design: Design, impulses: tuple[Impulse, ...], wheel: np.ndarray) -> Iterator[Finding]:
    """That a corner on rigid contacts tears other contacts loose, which no preload prevents."""
    worst, least = None, 0.0
    for impulse in impulses:
        i = int(np.argmin(impulse.contact_impulse))
        if impulse.contact_impulse[i] < min(least, -NONE * np.abs(impulse.contact_impulse).max()):
            worst, least = (impulse.wheel, int(wheel[i])), float(impulse.contact_impulse[i])
    if worst is not None:
        yield Finding(
            "rigid-impulse",
            "warning",
            f"On rigid contacts a corner of wheel {worst[0]} is an impulse that wheel {worst[1]} would have to hold by "
            f"pulling, {-least:.3g} N s: no preload prevents that. Give contact.stiffness to see what a real contact does.",
        )


def of_resonance(excited: tuple[Excited, ...]) -> Iterator[Finding]:
    """Modes that a strong line meets."""
    for mode in excited:
        yield Finding(
            "resonance",
            "warning",
            f"Harmonic {mode.harmonic} of wheel {mode.wheel}, {mode.line_frequency:.4g} Hz, lies within 5 % of the natural "
            f"frequency {mode.frequency:.4g} Hz and makes {100 * min(mode.share, 1):.0f} % of the mean square acceleration.",
        )


def of_comfort(comfort: Comfort, what: str) -> Iterator[Finding]:
    """That people aboard would not like it."""
    if comfort.words != ("not uncomfortable",):
        yield Finding(
            "comfort",
            "warning",
            f"For people aboard the {what} is {' to '.join(comfort.words)}: the weighted acceleration is {comfort.total:.3g} "
            "m/s² (ISO 2631-1, seated, upright along z), and 0.315 m/s² is where discomfort begins.",
        )


def round_wheels() -> Finding:
    """That nothing shakes."""
    return Finding("round-wheels", "note", "All wheels are round, so nothing shakes the sphere.")


def standing() -> Finding:
    """That no wheel turns."""
    return Finding("standing", "note", "No wheel turns, so nothing shakes the sphere; the displacement is that of its seat.")


def general(design: Design) -> Iterator[Finding]:
    """What the design leaves open."""
    if design.contact.stiffness is None:
        yield Finding(
            "rigid-contact",
            "note",
            "No contact.stiffness is given: contacts are rigid, the sphere follows the wheels' outlines, and at each of their "
            "corners its velocity jumps.",
        )
    elif not any(part.damping for part in (design.contact, design.mount, design.closure, *design.closure.springs)):
        yield Finding(
            "undamped",
            "note",
            "No damping is given: near a resonance the numbers are larger than a real machine's.",
        )
