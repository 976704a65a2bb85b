"""An assessment as plain values for JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from spheredrive.vibration.aboard.comfort import Comfort
    from spheredrive.vibration.aboard.isolation import ChosenIsolator
    from spheredrive.vibration.assessment.assess import Assessment, Moved
    from spheredrive.vibration.spectra.spectrum import OrderSpectrum

# Lines and crossings told.
LINES = 40
CROSSINGS = 40


def assessment_dict(a: Assessment) -> dict[str, Any]:
    """See ``Assessment.as_dict``. On rigid contacts whose shapes have corners, peak and RMS acceleration are infinite: null."""
    m = a.modes
    swinging = m.poles.imag > 0
    return {
        "name": a.design.name,
        "works": a.works,
        "model": a.model,
        "wheel_speed_rad_s": a.wheel_speed.tolist(),
        "natural_frequencies_hz": m.natural_frequencies.tolist(),
        "damped_modes": [
            {"natural_frequency_hz": float(abs(pole)) / (2 * math.pi), "damping_ratio": max(float(zeta), 0.0)}
            for pole, zeta in zip(m.poles[swinging], m.damping_ratios[swinging], strict=True)
        ],
        "passing_frequencies_hz": [e.passing_frequency for e in a.excitations],
        **_moved(a.sphere, bool(a.impulses)),
        "excitation": [
            {
                "wheel": e.wheel,
                "speed_rad_s": e.speed,
                "passing_frequency_hz": e.passing_frequency,
                "depth_m": e.depth,
                "peak_velocity_m_s": e.velocity,
                "peak_acceleration_m_s2": e.acceleration,
                "corner_velocity_jump_m_s": e.corner,
            }
            for e in a.excitations
        ],
        "impulses": [
            {
                "wheel": i.wheel,
                "wheel_angle_rad": i.angle,
                "velocity_jump_m_s": i.velocity_jump.tolist(),
                "contact_impulse_n_s": i.contact_impulse.tolist(),
            }
            for i in a.impulses
        ],
        "contact_forces": [
            {"wheel": f.wheel, "seat_n": f.seat, "least_n": f.least, "largest_n": f.largest, "lost": f.least < 0}
            for f in a.forces
        ],
        "critical_speeds": [
            {
                "wheel": c.wheel,
                "harmonic": c.harmonic,
                "speed_rad_s": c.speed,
                "frequency_hz": c.frequency,
                "amplification": _finite(c.amplification),
                "displacement_m": _finite(c.severity),
            }
            for c in a.resonances.crossings[:CROSSINGS]
        ],
        "speeds_to_avoid": [
            {"wheel": b.wheel, "least_rad_s": b.least, "most_rad_s": b.most, "displacement_m": _finite(b.severity)}
            for b in a.resonances.bands
        ],
        "critical_speeds_up_to_rad_s": a.largest_speed,
        "isolator": None
        if a.isolator is None
        else {
            "payload_kg": a.isolator.mass,
            "stiffness_n_m": list(a.isolator.stiffness),  # type: ignore[arg-type]
            "damping_n_s_m": list(a.isolator.damping),  # type: ignore[arg-type]
        },
        "payload": None if a.payload is None else _moved(a.payload, False),
        "findings": [{"code": f.code, "severity": f.severity, "message": f.message} for f in a.findings],
    }


def _moved(moved: Moved | None, jumps: bool) -> dict[str, Any]:
    """Sizes, lines and comfort; ``jumps`` where corners on rigid contacts make the acceleration infinite."""
    if moved is None:
        names = ("displacement_m", "velocity_m_s", "acceleration_m_s2")
        sizes = {f"{kind}_{name}": None for kind in ("peak", "rms") for name in names}
        return {**sizes, "mean_displacement_m": None, "order_spectrum": [], "spectrum_share": None, "comfort": None}
    s = moved.sizes
    sizes = {
        "peak_displacement_m": s.peak_displacement,
        "peak_velocity_m_s": s.peak_velocity,
        "peak_acceleration_m_s2": None if jumps else s.peak_acceleration,
        "rms_displacement_m": s.rms_displacement,
        "rms_velocity_m_s": s.rms_velocity,
        "rms_acceleration_m_s2": None if jumps else s.rms_acceleration,
        "mean_displacement_m": np.asarray(s.mean_displacement).tolist(),
    }
    if jumps:
        sizes["peak_acceleration_between_corners_m_s2"] = s.peak_acceleration
        sizes["rms_acceleration_between_corners_m_s2"] = s.rms_acceleration
    return {
        **sizes,
        "order_spectrum": line_rows(moved.spectrum),
        "spectrum_share": moved.share,
        "comfort": comfort_dict(moved.comfort),
    }


def line_rows(spectrum: OrderSpectrum) -> list[dict[str, Any]]:
    """The largest lines by their velocity, largest first: amplitudes as lengths of the vectors."""
    displacement, velocity, acceleration = (
        np.linalg.norm(a, axis=1) for a in (spectrum.displacement, spectrum.velocity, spectrum.acceleration)
    )
    largest = np.argsort(-velocity, kind="stable")[:LINES]
    return [
        {
            "wheel": int(spectrum.wheel[i]),
            "harmonic": int(spectrum.harmonic[i]),
            "order": round(float(spectrum.order[i]), 9),
            "frequency_hz": float(spectrum.frequency[i]),
            "displacement_m": float(displacement[i]),
            "velocity_m_s": float(velocity[i]),
            "acceleration_m_s2": float(acceleration[i]),
        }
        for i in largest
        if velocity[i] > 1e-9 * velocity[largest[0]]
    ]


def comfort_dict(c: Comfort) -> dict[str, Any]:
    """Weighted accelerations and their words."""
    return {
        "weighted_acceleration_m_s2": c.total,
        "horizontal_m_s2": c.horizontal,
        "vertical_m_s2": c.vertical,
        "words": list(c.words),
        "worst_upright": c.worst_up.tolist(),
        "worst_weighted_acceleration_m_s2": c.worst_total,
        "worst_words": list(c.worst_words),
    }


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None


def isolator_dict(chosen: ChosenIsolator) -> dict[str, Any]:
    """An isolator that was sought; what is infinite, as for a payload that may be fixed to the sphere, becomes null."""
    units = {"natural_frequency": "hz", "damping_ratio": "", "payload_mass": "kg", "stiffness": "n_m", "damping": "n_s_m",
             "sag": "m", "stroke": "m", "acceleration": "m_s2", "bare_acceleration": "m_s2"}  # fmt: skip
    return {f"{name}_{unit}" if unit else name: _finite(getattr(chosen, name)) for name, unit in units.items()}
