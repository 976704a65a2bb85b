"""Table 2.1 on the dual-race Atlas: the error of the single-race Jacobian, in both readings of the table (E4)."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from spheredrive import kinematics
from spheredrive.kinematics import KinematicRun
from spheredrive.studies.reproduce import machines

SAMPLE_RATE = 500.0


class Peaks(NamedTuple):
    """Largest errors: of the axis, rad; of the magnitude as a share of the corrected |Ω|, and of the single-race |Ω|."""

    angle: float
    of_corrected: float
    of_nominal: float


@lru_cache
def run(interpolation: str = "linear") -> KinematicRun:
    """The motion of Table 2.1, its speeds "linear" between the times or in "step"s."""
    motion = machines.table_2_1()
    series = replace(motion.series, interpolation=interpolation)
    return kinematics.along(machines.shipped("atlas-dual-race"), replace(motion, series=series, sample_rate=SAMPLE_RATE))


def peaks(interpolation: str = "linear") -> Peaks:
    """The largest errors along the motion."""
    moved = run(interpolation)
    share = moved.error_magnitude
    # |Ω|/|Ω_nominal| − 1 from 1 − |Ω_nominal|/|Ω|.
    of_nominal = share / (1 - share)
    return Peaks(*(float(np.abs(x).max()) for x in (moved.error_angle, share, of_nominal)))
