"""The force that keeps all contacts pressed while the machine vibrates."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.dynamics.loads import preload_direction, pressing_direction
from spheredrive.errors import SpheredriveError
from spheredrive.vibration.model.equations import contacts_of

if TYPE_CHECKING:
    from spheredrive.design import Design

# Contacts that a newton presses by less than this are not pressed by it.
IDLE = 1e-9


class PressingForce(NamedTuple):
    """The least force (N) along a unit vector, on top of the design's own closure, and the wheel that sets it, from 1, or 0."""

    force: float
    direction: tuple[float, float, float]
    wheel: int


def pressing_force(design: Design, least_force, direction=None) -> PressingForce:
    """The least force on the sphere along ``direction`` with which no contact of a steady motion would have to pull.

        F = max over i of −N_i,min/g_i,   g = R̂ᵀ(R̂R̂ᵀ)⁺ d

    least_force   of each contact, N, (m,): ``Response.force_min``, or the forces at the seat where nothing shakes
    direction     (3,), of any length; ``dynamics.pressing_direction`` of the design if absent

    g_i is what one newton presses contact i at the seat. The motion itself does not depend on the force, as the equations are
    linear. Raises ``SpheredriveError`` where no force along it does, and for forces that are not one a contact. Source:
    model.md section 5b.
    """
    contacts = contacts_of(design)
    least = np.asarray(least_force, float)
    if least.shape != contacts.wheel.shape or not np.isfinite(least).all():
        raise SpheredriveError(f"least_force takes one finite number for each of the {len(contacts.wheel)} contacts")
    d = pressing_direction(design) if direction is None else preload_direction(direction)
    gain = np.linalg.pinv(-contacts.normal.T) @ d
    scale = np.abs(least).max(initial=0.0)
    short, pressing = least < -1e-12 * scale, gain > IDLE
    needed = np.where(pressing & short, -least / np.where(pressing, gain, 1.0), 0.0)
    force = float(needed.max(initial=0.0))
    loose = (short & ~pressing) | (least + force * gain < -1e-9 * (scale + force))
    if loose.any():
        along = ", ".join(f"{round(float(x), 4) + 0.0:g}" for x in d)
        wheel = int(contacts.wheel[np.flatnonzero(loose)[0]]) + 1
        raise SpheredriveError(f"no force along ({along}) keeps every contact pressed: it does not press wheel {wheel}")
    wheel = int(contacts.wheel[np.argmax(needed)]) + 1 if force > 0 else 0
    return PressingForce(force, tuple(map(float, d)), wheel)  # type: ignore[arg-type]
