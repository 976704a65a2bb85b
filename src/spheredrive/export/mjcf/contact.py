"""MuJoCo's contact law made equal to ours: what to write for a stiffness, a damping and a slope of friction.

MuJoCo asks each row of a contact for an acceleration and lets it give way: with the row's relative position r (negative when
pressed in), speed v and acceleration a, the force f of a row that is pressed obeys

    R f + a = −B v − k r,      R = Â (1 − d)/d

Â is the sum of the two bodies' inverse weights, a number of the model, and d the impedance, here one constant. Written for the
force this is a spring, a damper and a mass that joins the two bodies along the row:

    f = −(k/R) r − (B/R) v − a/R

In the direct form, ``solref = (−x, −y)``, B = y/d and k = x/d. So a row has stiffness K and damping C for

    x = K Â (1 − d),   y = C Â (1 − d)

and the mass that comes on top is 1/R = d/(Â (1 − d)): the smaller d, the less. Rows of friction have no position and
R_t = R/impratio. Up to the limit their law is a lag with time 1/B_t behind a slope: f + ḟ/B_t = −S v with S = B_t/R_t. Stepped
with dt such a row is stable for B_t dt < 2; ``LAG`` settles B_t dt, and impratio follows. The limit μN itself is ours, the way
up to it is not: ours bends, −μN v/√(v² + v_s²), and has the slope μN/v_s of the moment's N.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

# d. The mass it adds at each contact is a few ten-thousandths of the bodies'.
IMPEDANCE = 2e-4
# B_t dt of the rows of friction.
LAG = 0.5
# MuJoCo takes no friction below this.
LEAST_FRICTION = 1e-5


@dataclass(frozen=True)
class ContactLaw:
    """What a contact does, N = K·penetration + C·rate, and friction up to μN that grows with the slip at slope S.

    stiffness   K, N/m;  damping   C, N s/m
    friction    μ;  friction_slope   S, N s/m
    """

    stiffness: float
    damping: float
    friction: float
    friction_slope: float


class Written(NamedTuple):
    """What MuJoCo is told: ``impratio`` once, the others for each pair of geoms, (p, ...)."""

    solref: np.ndarray
    solreffriction: np.ndarray
    solimp: tuple[float, float, float, float, float]
    impratio: float


def written(law: ContactLaw, inverse_weight, timestep: float, impedance: float = IMPEDANCE) -> Written:
    """The numbers that give each pair of geoms the ``law``.

    ``inverse_weight`` Â of each pair, 1/kg, (p,): ``body_invweight0[..., 0]`` of the one body plus that of the other;
    ``timestep`` in s.
    """
    Â = np.asarray(inverse_weight, float)
    d = impedance
    scale = Â * (1 - d)
    impratio = 1.0
    if law.friction_slope > 0:
        # The largest B_t of any pair is LAG/dt: B_t = S R_t = S Â (1 − d)/(d impratio).
        impratio = float(law.friction_slope * scale.max() * timestep / (LAG * d))
    zero = np.zeros_like(Â)
    normal = np.stack([-law.stiffness * scale, -law.damping * scale], axis=-1)
    sliding = np.stack([zero, -law.friction_slope * scale / impratio], axis=-1)
    return Written(normal, sliding, (d, d, 1e-3, 0.5, 2.0), impratio)
