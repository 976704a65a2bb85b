"""Rosenbrock methods as data, in the form that needs no product with the Jacobian (Hairer and Wanner, section IV.7).

(1/(γh) − J) k_i = f(t + α_i h, y + Σ a_ij k_j) + Σ (c_ij/h) k_j + γ_i h ∂f/∂t,     y₁ = y + Σ m_j k_j,  error = Σ e_j k_j
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Method(NamedTuple):
    """Coefficients of a method of ``order`` with s stages.

    dense   (2, s) rows d, g of its continuous extension, y(t + θh) = (1 − θ) y + θ (y₁ + (1 − θ)(Σ d_j k_j + θ Σ g_j k_j));
            all zero where it has none: a straight line, which damps what is stiff
    """

    gamma: float
    a: np.ndarray
    c: np.ndarray
    alpha: np.ndarray
    gammas: np.ndarray
    m: np.ndarray
    e: np.ndarray
    order: int
    dense: np.ndarray


def _lower(rows, size: int) -> np.ndarray:
    out = np.zeros((size, size))
    for i, row in enumerate(rows):
        out[i, : len(row)] = row
    return out


_A5 = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
# Hairer and Wanner's RODAS: six stages, order 4(3), stiffly accurate.
RODAS4 = Method(
    gamma=0.25,
    a=_lower(
        [
            (),
            (1.544,),
            (0.9466785280815826, 0.2557011698983284),
            (3.314825187068521, 2.896124015972201, 0.9986419139977817),
            _A5,
            (*_A5, 1.0),
        ],
        6,
    ),
    c=_lower(
        [
            (),
            (-5.6688,),
            (-2.430093356833875, -0.2063599157091915),
            (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
            (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
            (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
        ],
        6,
    ),
    alpha=np.array([0.0, 0.386, 0.21, 0.63, 1.0, 1.0]),
    gammas=np.array([0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0]),
    m=np.array([*_A5, 1.0, 1.0]),
    e=np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    order=4,
    dense=np.array(
        [
            [10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662, 0.0],
            [-0.6762803392806898, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872, 0.0],
        ]
    ),
)
_P5 = (-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401)
# Steinebach's RODASP: as RODAS, and of order 4 too where a stiff part is driven.
RODAS4P = Method(
    gamma=0.25,
    a=_lower(
        [
            (),
            (3.0,),
            (1.831036793486759, 0.4955183967433795),
            (2.304376582692669, -0.05249275245743001, -1.176798761832782),
            _P5,
            (*_P5, 1.0),
        ],
        6,
    ),
    c=_lower(
        [
            (),
            (-12.0,),
            (-8.791795173947035, -2.207865586973518),
            (10.81793056857153, 6.780270611428266, 19.53485944642410),
            (34.19095006749676, 15.49671153725963, 54.74760875964130, 14.16005392148534),
            (34.62605830930532, 15.30084976114473, 56.99955578662667, 18.40807009793095, -5.714285714285717),
        ],
        6,
    ),
    alpha=np.array([0.0, 0.75, 0.21, 0.63, 1.0, 1.0]),
    gammas=np.array([0.25, -0.5, -0.023504, -0.0362, 0.0, 0.0]),
    m=np.array([*_P5, 1.0, 1.0]),
    e=np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    order=4,
    dense=np.array(
        [
            [25.09876703708589, 11.62013104361867, 28.49148307714626, -5.664021568594133, 0.0, 0.0],
            [1.638054557396973, -0.7373619806678748, 8.477918219238990, 15.99253148779520, -1.882352941176471, 0.0],
        ]
    ),
)
# Sandu et al.: four stages, three evaluations, order 3(2), stiffly accurate.
RODAS3 = Method(
    gamma=0.5,
    a=_lower([(), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0)], 4),
    c=_lower([(), (4.0,), (1.0, -1.0), (1.0, -1.0, -8.0 / 3.0)], 4),
    alpha=np.array([0.0, 0.0, 1.0, 1.0]),
    gammas=np.array([0.5, 1.5, 0.0, 0.0]),
    m=np.array([2.0, 0.0, 1.0, 1.0]),
    e=np.array([0.0, 0.0, 0.0, 1.0]),
    order=3,
    dense=np.zeros((2, 4)),
)
METHODS = {"rodas4": RODAS4, "rodas4p": RODAS4P, "rodas3": RODAS3}
