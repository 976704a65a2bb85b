"""A run in a few numbers: what ``spheredrive simulate`` prints and the report tells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spheredrive.checking import Finding
from spheredrive.design import Design
from spheredrive.dynamics.loads import Loads, Preload, least_preload_of_run, loads, pressing_direction
from spheredrive.errors import SpheredriveError
from spheredrive.simulation.rolling_run import RollingRun


@dataclass(frozen=True)
class Overview:
    """The numbers of a run, SI.

    loads           loads of the run; None where it has no samples
    turn, turn_time       largest |Ω|, rad/s, and when, s
    race_changes    how often a wheel changed its race
    residual        largest residual of the energy ledger, J
    energy          largest energy that moved through the ledger, J: what the residual is to be held against
    preload         least force on top of the design's own closure that keeps every contact of this run inside its friction
                    limit, pressed towards the wheels; or the sentence that says why there is none
    """

    name: str
    model: str
    completed: bool
    reason: str
    samples: int
    end: float
    turn: float
    turn_time: float
    race_changes: int
    residual: float
    energy: float
    loads: Loads | None
    preload: Preload | str
    findings: tuple[Finding, ...]

    @property
    def works(self) -> bool:
        """Whether the run was completed and no finding says that the design does not work."""
        return self.completed and all(finding.severity != "failure" for finding in self.findings)

    def as_dict(self) -> dict:
        """Plain values for JSON, SI with units in the names; what is not finite or not known becomes null."""
        peaks = self.loads.peaks if self.loads else ()
        return {
            "name": self.name,
            "model": self.model,
            "works": self.works,
            "completed": self.completed,
            "reason": self.reason,
            "samples": self.samples,
            "end_s": self.end,
            "race_changes": self.race_changes,
            "peak_angular_velocity": {"rad_s": _finite(self.turn), "time_s": self.turn_time},
            "ledger_residual_j": _finite(self.residual),
            "friction_utilisation": _extreme(self.worst_utilisation, "utilisation", ""),
            "least_normal_force": _extreme(self.least_normal, "least_normal", "n"),
            "least_preload": self._preload_dict(),
            "wheels": [self._peak_dict(peak) for peak in peaks],
            "findings": [{"code": f.code, "severity": f.severity, "message": f.message} for f in self.findings],
        }

    def _peak_dict(self, peak) -> dict:
        units = {"torque": "n_m", "rms_torque": "n_m", "speed": "rad_s", "power": "w", "least_normal": "n",
                 "largest_friction": "n"}  # fmt: skip
        known = self.loads is not None and self.loads.normals_known
        found = {}
        for name, value in peak._asdict().items():
            unit = "s" if name.endswith("_time") else units.get(name, "")
            missing = name.startswith("least_normal") and not known
            found[f"{name}_{unit}" if unit else name] = None if missing else _finite(value)
        return found

    def _preload_dict(self) -> dict | None:
        p = self.preload
        if isinstance(p, str):
            return None
        return {"force_n": p.force, "direction": list(p.direction), "wheel": p.wheel or None, "time_s": p.time}

    @property
    def worst_utilisation(self):
        """Row of the wheel with the largest friction utilisation; None where it is not known."""
        rows = [peak for peak in (self.loads.peaks if self.loads else ()) if peak.utilisation is not None]
        return max(rows, key=lambda peak: peak.utilisation, default=None)

    @property
    def least_normal(self):
        """Row of the wheel with the least normal force; None where normal forces are not determined."""
        if self.loads is None or not self.loads.normals_known:
            return None
        return min(self.loads.peaks, key=lambda peak: peak.least_normal)


def overview(design: Design, run: RollingRun, model: str = "rolling") -> Overview:
    """The overview of a run of the rolling model; one without samples has no loads, and the reason why as its one finding."""
    sampled = len(run.time) > 0
    speed = np.linalg.norm(run.angular_velocity, axis=1) if sampled else np.zeros(1)
    peak = int(np.argmax(speed))
    found = loads(design, run) if sampled else None
    findings = found.findings if found else (Finding("incomplete", "failure", f"The run did not begin: {run.reason}."),)
    ledger = (run.kinetic, run.potential, run.heat, run.impact_loss, run.motor_work, run.stage_work)
    return Overview(
        name=design.name,
        model=model,
        completed=run.completed,
        reason=run.reason,
        samples=len(run.time),
        end=float(run.time[-1]) if sampled else 0.0,
        turn=float(speed[peak]),
        turn_time=float(run.time[peak]) if sampled else 0.0,
        race_changes=int(np.count_nonzero(run.event_wheel >= 0)),
        residual=float(np.abs(run.residual).max(initial=0.0)),
        energy=max(float(np.abs(part).max(initial=0.0)) for part in ledger),
        loads=found,
        preload=_preload(design, run) if sampled else run.reason,
        findings=findings,
    )


def _preload(design: Design, run: RollingRun) -> Preload | str:
    try:
        return least_preload_of_run(design, run, pressing_direction(design))
    except SpheredriveError as error:
        return str(error)


def _extreme(peak, name: str, unit: str) -> dict | None:
    if peak is None:
        return None
    key = f"{name}_{unit}" if unit else name
    return {"wheel": peak.wheel, key: _finite(getattr(peak, name)), "time_s": _finite(getattr(peak, f"{name}_time"))}


def _finite(value):
    return value if value is None or isinstance(value, int) or math.isfinite(value) else None
