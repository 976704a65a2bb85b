"""A compliant run in the numbers that an ensemble keeps of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.station import SLIP

if TYPE_CHECKING:
    from spheredrive.simulation.compliant.run import CompliantRun


class Number(NamedTuple):
    """One number of a member: its name, SI unit and meaning."""

    name: str
    unit: str
    long_name: str


NUMBERS = (
    Number("orientation_error", "rad", "angle between the orientations of member and design as drawn, at the end"),
    Number("orientation_error_peak", "rad", "largest angle between the orientations of member and design as drawn"),
    Number("centre_rms", "m", "RMS displacement of the sphere's centre about its mean"),
    Number("centre_peak", "m", "largest displacement of the sphere's centre from its mean"),
    Number("acceleration_rms", "m/s^2", "RMS acceleration of the sphere's centre on the stage"),
    Number("slip_work", "J", "energy lost by slipping"),
    Number("slip_speed_peak", "m/s", "largest slip speed of a contact"),
    Number("lift_offs", "1", "how often a wheel loses contact"),
    Number("normal_force_min", "N", "least normal force of a wheel"),
)


# What people read in place of SI.
_SHOWN = {"rad": (180 / np.pi, "deg"), "m": (1e6, "µm"), "m/s": (1e3, "mm/s")}


def shown_unit(number: Number) -> tuple[float, str]:
    """The unit in which people read a number, and how many of it make the SI unit."""
    return _SHOWN.get(number.unit, (1.0, number.unit))


def numbers_of(run: CompliantRun, drawn: CompliantRun) -> np.ndarray:
    """``NUMBERS`` of a completed run, beside the run of the design as drawn along the same motion, (9,)."""
    error = angle_between(run.orientation, drawn.orientation)
    off = run.centre_displacement - run.centre_displacement.mean(axis=0)
    squared = np.sum(off * off, axis=1)
    acceleration = run.rates[:, at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3]
    return np.array(
        [
            error[-1],
            error.max(),
            np.sqrt(squared.mean()),
            np.sqrt(squared.max()),
            np.sqrt(np.mean(np.sum(acceleration * acceleration, axis=1))),
            run.works[-1, at.SLIPPING],
            run.touches[:, :, SLIP].max(),
            len(run.lift_offs),
            run.normal_force.min(),
        ]
    )


def angle_between(p, q) -> np.ndarray:
    """Angle (rad, 0 to π) of the rotation between unit quaternions p and q, (..., 4) → (...).

        γ = 2 atan2(|v|, |w|),   (w, v) = p* ∘ q

    which keeps its digits for small angles, where arccos w has none.
    """
    p, q = np.asarray(p, float), np.asarray(q, float)
    w = np.sum(p * q, axis=-1)
    v = p[..., :1] * q[..., 1:] - q[..., :1] * p[..., 1:] - np.cross(p[..., 1:], q[..., 1:])
    return 2.0 * np.arctan2(np.sqrt(np.sum(v * v, axis=-1)), np.abs(w))
