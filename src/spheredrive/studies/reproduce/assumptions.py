"""What the reproduction had to assume where the thesis is silent: each assumption once, with its reason."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Assumption(NamedTuple):
    """``what`` the thesis does not say, the ``value`` taken, as a reader sees it, and the ``reason``."""

    what: str
    value: Any
    shown: str
    reason: str


INERTIAS = Assumption(
    "Inertias of the demonstrator (E6)",
    "hollow",
    "sphere ⅔ M R², wheels ½ m r²",
    "A motion platform's sphere is a shell and its wheels are turned from the solid. They set how fast Ω grows in Fig 3.3 and "
    "nothing in any vibration.",
)
MECANUM_ROLLER = Assumption(
    "Radius of the Mecanum wheel's rollers, and their number's effect on it",
    "touching circles",
    "r_r = r_b s/(1 + s), s = sin(π/n_r): 12.37 mm at 16 rollers",
    "[4.4] describes two circles of radius r_r that touch under the sphere; this is the radius at which they do, on the wheel "
    "of the same diameter.",
)
NO_GRAVITY = Assumption(
    "Gravity in the figures of chapter 3",
    False,
    "none",
    "[3.37–3.46] carry no weight. Nothing linear depends on it; where normal forces matter, rows say which are taken.",
)
PERFECT_DURATION = Assumption(
    "Duration of Fig 3.3–3.5",
    10.0,
    "10 s",
    "Long enough for the quaternion to show the rising frequency that the text describes.",
)
IMPERFECT_SPEEDS = Assumption(
    "Wheel speeds of Fig 3.6–3.10",
    (0.1, 1.2, 0.3),
    "0.1, 1.2, 0.3 rad/s",
    "The speeds of Fig 3.11, which the text compares with these figures.",
)
ROUNDNESS_SAMPLES = Assumption(
    "Roundness ratios of Fig 3.6–3.9",
    (0.1, 0.2, 0.3, 0.4485),
    "η = 0.1, 0.2, 0.3 and 0.4485",
    "The text says “sample roundness ratios” and names the demonstrator's 0.4485 alone; three smaller ones show the trend.",
)
ROUNDNESS_RANGE = Assumption(
    "Range of η in Fig 3.10 and 4.16–4.18",
    np.linspace(0.0, 0.98, 50),
    "0 … 0.98",
    "From a round wheel to one with hardly any roller left; at η = 1 a standard wheel has none.",
)
FIRST_PART = Assumption(
    "Part of the motion drawn in Fig 3.6–3.9 and 3.11–3.13",
    1.5,
    "the first 1.5 s, from wheel angles 0 at rest",
    "The part the thesis magnifies.",
)
RIGID_IS_ZERO = Assumption(
    "“K = 0” and “kᵢ = 0” in captions 4.9, 4.10, 4.13 and 4.14",
    None,
    "infinitely stiff",
    "§4.3.2 says that the rigid body is seen at K = 0. Read as no stiffness at all, nothing would hold the sphere or the "
    "wheels.",
)
STIFFNESS_RANGE = Assumption(
    "Range of contact stiffness K in Fig 4.8–4.11",
    np.linspace(20e3, 300e3, 29),
    "20 to 300 kN/m",
    "Around the measured 188 208 N/m and the 170 000 and 190 000 N/m of the captions. The scan has lost the axes' exponents.",
)
MOUNT_STIFFNESS = Assumption(
    "Mount stiffnesses k of Fig 4.8",
    (50e3, 100e3, 200e3, 400e3),
    "50, 100, 200, 400 kN/m",
    "Of the size of the contact stiffness, where a mount shows.",
)
MOUNT_RANGE = Assumption(
    "Range of mount stiffness k in Fig 4.12",
    np.geomspace(20e3, 2e6, 17),
    "20 kN/m to 2 MN/m",
    "From well below the contact stiffness to practically rigid. The scan has lost the axis.",
)
CLOSURE_RANGE = Assumption(
    "Range of closure stiffness K′ in Fig 4.9 and 4.13–4.15",
    np.linspace(0.0, 30e3, 31),
    "0 to 30 kN/m",
    "The axis of Fig 4.15 reads 0.0 … 3.0 ×10ⁿ N/m with the exponent lost; with 4 it stays below every K, as [3.41]'s sign "
    "needs.",
)
DAMPING = Assumption(
    "Contact damping C of Fig 4.10–4.15",
    (0.0, 8500.0),
    "both 0 and 8500 N s/m",
    "Chapter 4 names none. Chapter 3 uses 0 first and 8500 N s/m next; without damping peaks depend on every resonance passed.",
)
SWEEP_START = Assumption(
    "From where maxima are taken in Fig 3.10 and 4.10–4.15",
    "steady",
    "the steady motion; wheels start at angle 0",
    "A maximum over an unknown stretch of a start from rest is not defined without damping.",
)
ROLLER_COUNTS = Assumption(
    "Range of the number of Mecanum rollers in Fig 4.16–4.18",
    np.arange(4, 121),
    "4 to 120",
    "The text speaks of very large numbers of rollers, N > 100.",
)
ELASTICITY = Assumption(
    "Elastic modulus in the resistances of [3.18–3.30]",
    "from K",
    "the one at which Hertz's stiffness dN/dδ is the measured 188 208 N/m at the force of the row",
    "The thesis gives no moduli.",
)
RESISTANCE_MATTERS = Assumption(
    "What “negligible” means for the resisting moments",
    0.05,
    "less than 5 % of the sphere's angular acceleration",
    "§5 gives no number. Five per cent is below what a reader sees in a plot.",
)
OFFSET = Assumption(
    "Offset of the centre of mass in “offset mass does not couple”",
    0.05,
    "50 mm along the body's x axis",
    "§3.2 names none. Any offset decides; this one is four per cent of the radius.",
)

ASSUMPTIONS = tuple(value for value in globals().values() if isinstance(value, Assumption))
