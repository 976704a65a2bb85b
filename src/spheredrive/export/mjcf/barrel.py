"""The points of a barrel's convex mesh.

MuJoCo has no barrel. An ellipsoid with a barrel's two curvatures leaves it in fourth order towards its ends and has no flat
end: under 16 Mecanum barrels on 75.8 mm it stands 55 µm too high in the valley, nine tenths of the valley's depth. A mesh of
51 circles of 256 points keeps within 1 µm of the exact outline everywhere. Its corners are felt all the same: the contact jumps
from one to the next while a roller rolls, which holds it up with up to π/256 of the normal force. Where numbers count, 1024
points are taken.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from spheredrive.shape import Roller

CIRCLES, AROUND = 51, 256
FINE = (51, 1024)


def barrel_points(body: Roller, circles: int = CIRCLES, around: int = AROUND) -> np.ndarray:
    """Points on the surface of a roller whose axis is z, (circles × around, 3), m.

        e = s − ρρ′, σ = ρ √(1 − ρ′²):   the circle in which the ball at s touches the surface

    Neighbouring circles are turned by half a step against each other, so that no edge runs along the roller. The first and the
    last circle are the edges of its flat ends.
    """
    s = np.linspace(-body.half_length, body.half_length, circles)
    ρ, slope = body.radius(s), body.radius_slope(s)
    e, σ = s - ρ * slope, ρ * np.sqrt(1 - slope**2)
    turn = 2 * np.pi * (np.arange(around) + 0.5 * (np.arange(circles)[:, None] % 2)) / around
    ring = np.broadcast_to(e[:, None], turn.shape)
    return np.stack([σ[:, None] * np.cos(turn), σ[:, None] * np.sin(turn), ring], axis=-1).reshape(-1, 3)
