"""Machines side by side: kinematics, preload and vibration of each, at the same motion of the sphere's surface."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spheredrive.checking import Check, check
from spheredrive.design import Design
from spheredrive.dynamics.loads import pressing_direction
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion
from spheredrive.shape import profiles
from spheredrive.simulation.preload import least_preload
from spheredrive.studies.compare.machines import Machine
from spheredrive.studies.compare.motions import motion_alike, speeds_alike
from spheredrive.vibration.assessment.assess import Assessment, assess
from spheredrive.vibration.assessment.pressing import pressing_force

# The speed of every wheel of the first design where none is given, rad/s.
DEFAULT_SPEED = 1.0


@dataclass(frozen=True, eq=False)
class Row:
    """One machine of a comparison; what is not known is None, and ``reasons`` says why, by what it concerns.

    check         its kinematics
    wheel_speed   at which its sphere's surface moves as that of the first, rad/s, (n,)
    depth         largest depth of a wheel's shape, m
    preload       least force along its pressing direction, N, on top of its own closure
    vibration     at those speeds
    reasons       (("vibration", sentence), …)
    """

    machine: Machine
    check: Check | None
    wheel_speed: np.ndarray | None
    depth: float | None
    preload: float | None
    vibration: Assessment | None
    reasons: tuple[tuple[str, str], ...]

    @property
    def works(self) -> bool:
        """Whether the layout works, and the machine at these speeds as far as that is known."""
        return self.check is not None and self.check.works and (self.vibration is None or self.vibration.works)

    @property
    def jumps(self) -> bool:
        """Whether corners on rigid contacts make the acceleration infinite."""
        return self.vibration is not None and bool(self.vibration.impulses)

    def sizes(self):
        """Sizes of the centre's motion, or None."""
        return None if self.vibration is None or self.vibration.sphere is None else self.vibration.sphere.sizes

    def comfort(self):
        """Comfort aboard the sphere, or None."""
        return None if self.vibration is None or self.vibration.sphere is None else self.vibration.sphere.comfort

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; what is infinite or not known becomes null."""
        sizes, comfort = self.sizes(), self.comfort()
        known = sizes is not None
        findings = (*(self.check.findings if self.check else ()), *(self.vibration.findings if self.vibration else ()))
        return {
            "name": self.machine.name,
            "works": self.works,
            "effectiveness": None if self.check is None else [_finite(bound) for bound in self.check.effectiveness],
            "isotropy": None if self.check is None else self.check.isotropy,
            "wheel_speed_rad_s": None if self.wheel_speed is None else self.wheel_speed.tolist(),
            "excitation_depth_m": self.depth,
            "preload_n": self.preload,
            "natural_frequencies_hz": None if self.vibration is None else self.vibration.modes.natural_frequencies.tolist(),
            "peak_displacement_m": sizes.peak_displacement if known else None,
            "rms_displacement_m": sizes.rms_displacement if known else None,
            "peak_velocity_m_s": sizes.peak_velocity if known else None,
            "peak_acceleration_m_s2": sizes.peak_acceleration if known and not self.jumps else None,
            "rms_acceleration_m_s2": sizes.rms_acceleration if known and not self.jumps else None,
            "weighted_acceleration_m_s2": None if comfort is None else comfort.total,
            "comfort": None if comfort is None else list(comfort.words),
            "missing": self.machine.missing or None,
            "note": self.machine.note or None,
            "reasons": dict(self.reasons),
            "findings": [{"code": f.code, "severity": f.severity, "message": f.message} for f in findings],
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """Rows of machines; the first design and its wheel speeds are what the others are held to.

    chosen        whether the speeds were given, or are 1 rad/s of every wheel
    motion        what the preload is for; None for the steady vibration
    """

    first: Design
    wheel_speed: np.ndarray
    chosen: bool
    motion: Motion | None
    rows: tuple[Row, ...]

    @property
    def works(self) -> bool:
        """Whether one of the machines works at least."""
        return any(row.works for row in self.rows)

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "reference": self.first.name,
            "reference_wheel_speed_rad_s": self.wheel_speed.tolist(),
            "preload_of": "vibration" if self.motion is None else "motion",
            "machines": [row.as_dict() for row in self.rows],
        }


def compare(machines: Sequence[Machine], wheel_speed=None, motion: Motion | None = None) -> Comparison:
    """Kinematics, preload and vibration of ``machines``, at the same motion of the sphere's surface.

    wheel_speed   of the first machine that is a design, rad/s, (n,), or one number; 1 rad/s of every wheel if absent. Other
                  machines turn their wheels so that the surface of the sphere moves alike (``motions.speeds_alike``)
    motion        for the first machine: the preload is then the least that keeps every contact of the motion inside its
                  friction limit; if absent it is the least that keeps every contact pressed in the steady vibration

    Trouble of one machine stays in its row. Raises ``SpheredriveError`` where there is no machine to compare, and for speeds
    and motions that do not fit the first.
    """
    designs = [m.design for m in machines if m.design is not None]
    if not designs:
        raise SpheredriveError("there is no machine to compare: " + "; ".join(f"{m.name}: {m.missing}" for m in machines))
    first = designs[0]
    speed = np.asarray(DEFAULT_SPEED if wheel_speed is None else wheel_speed, float)
    if speed.shape not in ((), (first.wheel_count,)) or not np.isfinite(speed).all():
        raise SpheredriveError(f"wheel_speed takes one finite number, or one for each of the {first.wheel_count} wheels")
    speed = np.broadcast_to(speed, first.wheel_count).copy()
    if motion is not None:
        motion.check_wheel_count(first.wheel_count)
    rows = tuple(_row(m, first, speed, motion) for m in machines)
    return Comparison(first, speed, wheel_speed is not None, motion, rows)


def _row(m: Machine, first: Design, speed: np.ndarray, motion: Motion | None) -> Row:
    if m.design is None:
        return Row(m, None, None, None, None, None, (("wheel", m.missing),))
    design, reasons = m.design, []

    def known(what: str, work):
        """What ``work`` gives, or None with the reason kept."""
        try:
            return work()
        except SpheredriveError as error:
            reasons.append((what, str(error)))
            return None

    depth = known("excitation", lambda: max(p.depth for p in profiles(design)))
    own = known("speeds", lambda: speeds_alike(first, speed, design))
    # A wheel that is not described is told once.
    vibration = None if own is None or depth is None else known("vibration", lambda: assess(design, own))
    preload = known("preload", lambda: _preload(design, first, vibration, motion))
    return Row(m, check(design), own, depth, preload, vibration, tuple(reasons))


def _preload(design: Design, first: Design, vibration: Assessment | None, motion: Motion | None) -> float | None:
    if motion is not None:
        return least_preload(design, motion_alike(first, motion, design), pressing_direction(design)).force
    if vibration is None or not vibration.forces:
        return None
    return pressing_force(design, [f.least for f in vibration.forces]).force


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None
