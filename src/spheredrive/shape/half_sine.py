"""The thesis's outline: half a sine wave across each gap, kept for its reproduction and for comparison (model.md E7)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.shape.pieces import Pieces
from spheredrive.shape.polynomial import exact_pieces

if TYPE_CHECKING:
    from spheredrive.wheels.base import RollerWheel


def half_sine(wheel: RollerWheel, sphere_radius: float) -> Pieces:
    """r_w = r_b − Δr sin(n_r ψ/(2η)) for ψ < θ_s, r_b otherwise; a Mecanum wheel has η = 1 and its own Δr.

    Width and depth come from the wheel type. Raises ``DesignError`` where a key they need is missing, and for the types the
    thesis gives no half sine for. Source: model.md section 3, [3.6–3.11], [4.4–4.6].
    """
    gap, depth = wheel.half_sine(sphere_radius)
    pitch = 2 * math.pi / (wheel.rollers_per_race or 1)
    k = math.pi / gap

    def wave(x: np.ndarray) -> np.ndarray:
        sine = depth * np.sin(k * x)
        return np.stack([-sine, -depth * k * np.cos(k * x), k * k * sine], axis=-1)

    starts, rows = exact_pieces(0.0, gap, wave, depth * k * k)
    if gap < pitch:
        starts, rows = [*starts, gap], [*rows, np.zeros_like(rows[0])]
    return Pieces(pitch, np.array(starts), np.array(rows))
