"""A payload inside the sphere on an isolator: the machine that carries it, and the isolator that keeps it still enough.

``sphere.mass`` of a design is the mass of the sphere with its payload. Here the payload is taken out of it and hung on
springs and dampers, so that the machine weighs as much as before, and the same payload fixed to the sphere is the design as
it stands.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.values import checked_number
from spheredrive.vibration.aboard import isolation
from spheredrive.vibration.model import equations
from spheredrive.vibration.model.system import LinearSystem, linear_system
from spheredrive.vibration.motion.response import checked_wheels, response
from spheredrive.vibration.spectra.spectrum import order_spectrum, shape_harmonics

if TYPE_CHECKING:
    from spheredrive.design import Design

# Harmonics of each shape that the search for an isolator follows; well above an isolator's frequency nothing passes it.
HARMONICS = 400


def without_payload(design: Design, payload_mass: float) -> Design:
    """The design whose sphere lacks a payload of ``payload_mass`` (kg): M_s − m.

    Raises ``SpheredriveError`` where the sphere's mass is not given, and ``DesignError`` where the payload is not lighter than
    the sphere with it.
    """
    mass = checked_number(payload_mass, "kg", "positive", ("payload",))
    if design.sphere.mass is None:
        raise SpheredriveError("a payload is part of sphere.mass, which is not given")
    if mass >= design.sphere.mass:
        raise DesignError(
            f"sphere.mass is {design.sphere.mass:g} kg with its payload, so a payload of {mass:g} kg leaves nothing of the "
            "sphere; raise sphere.mass, or give a lighter payload"
        )
    return replace(design, sphere=replace(design.sphere, mass=design.sphere.mass - mass))


def isolator_of_frequency(payload_mass: float, natural_frequency: float, damping_ratio: float) -> equations.Isolator:
    """Springs and dampers, alike in every direction: k = m (2πf_n)², c = 2ζ√(k m); f_n in Hz.

    Raises ``DesignError`` for a frequency that is not above zero and for a negative damping ratio.
    """
    mass = checked_number(payload_mass, "kg", "positive", ("payload",))
    f_n = checked_number(natural_frequency, "Hz", "positive", ("isolator",))
    zeta = checked_number(damping_ratio, "", "non-negative", ("isolator_damping",))
    stiffness = mass * (2 * math.pi * f_n) ** 2
    return equations.Isolator(mass, stiffness, 2 * zeta * math.sqrt(stiffness * mass))


def isolator_for_design(
    design: Design,
    wheel_speed,
    payload_mass: float,
    wanted_acceleration: float,
    damping_ratio: float = 0.1,
    *,
    wheel_angle=None,
    weighted: bool = False,
    largest_sag: float = math.inf,
    largest_stroke: float = math.inf,
) -> isolation.ChosenIsolator:
    """The stiffest isolator that brings a payload inside the sphere to a wanted RMS acceleration at constant wheel speeds.

    wheel_speed   rad/s, (n,); wheel_angle  ϑ at t = 0, rad, (n,)
    payload_mass  kg, a part of ``sphere.mass``

    Other arguments, what returns and what raises as ``isolation.isolator_for``; ``DesignError`` too for a payload that is
    heavier than its sphere. The payload's force on the sphere is in it exactly: the coupled system with and without the payload
    are one linear system. Follows 400 harmonics of each shape. Source: model.md section 5b; thesis, future work.
    """
    light = without_payload(design, payload_mass)
    system = linear_system(light)
    speed, angle = checked_wheels(light, wheel_speed, wheel_angle)
    wheel = system.contacts.wheel
    spectrum = order_spectrum(
        lambda s: system.transfer(s)[..., :3, :],
        [shape_harmonics(p, HARMONICS) for p in system.profiles],
        np.array([p.period for p in system.profiles]),
        speed[wheel],
        angle[wheel],
    )
    frequency, displacement = spectrum.combined()
    if not len(frequency):
        raise SpheredriveError("no wheel turns, so nothing shakes the payload: an isolator needs wheel speeds above zero")
    base = isolation.loaded_centre(frequency, displacement, receptance(system, frequency), payload_mass, damping_ratio)
    found = isolation.isolator_for(
        frequency,
        displacement,
        payload_mass,
        wanted_acceleration,
        damping_ratio,
        weighted=weighted,
        largest_sag=largest_sag,
        largest_stroke=largest_stroke,
        gravity=isolation.GRAVITY if design.stage.gravity else 0.0,
        base=base,
    )
    if math.isinf(found.natural_frequency) or weighted:
        return found
    # The payload fixed to the sphere is the design itself, whose RMS is known without lines.
    fixed = response(design, speed, wheel_angle=angle)
    return replace(found, bare_acceleration=math.inf if fixed.impulses else fixed.rms_acceleration)


def receptance(system: LinearSystem, frequency) -> np.ndarray:
    """Displacement of the sphere's centre by a force on it, coupled model, complex, m/N, (..., 3, 3); ``frequency`` in Hz.

        G(s) = L (s² M + s D + K)⁻¹ Lᵀ

    Nothing moves where rigid contacts leave no freedom. Source: model.md section 5b.
    """
    e = system.equations
    s = 2j * np.pi * np.asarray(frequency, float)[..., None, None]
    if not len(e.mass):
        return np.zeros((*s.shape[:-2], 3, 3), complex)
    L = e.free[:3]
    return L @ np.linalg.solve(s**2 * e.mass + s * e.damping + e.stiffness, np.broadcast_to(L.T, (*s.shape[:-2], *L.T.shape)))
