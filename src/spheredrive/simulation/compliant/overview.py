"""A compliant run in a few numbers: what ``spheredrive simulate --model compliant`` prints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spheredrive.checking import Finding
from spheredrive.design import Design
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.loads import Peak, limit_findings, wheel_peak
from spheredrive.simulation.compliant.ledger import ledger
from spheredrive.simulation.compliant.run import CompliantRun

# A ledger that is off by more than this share of the energy that moved is said.
LEDGER_SHARE = 0.01


@dataclass(frozen=True)
class CompliantOverview:
    """The numbers of a compliant run, SI.

    turn, turn_time    largest |Ω|, rad/s, and when, s
    ripple             RMS of the centre's displacement about its mean, x, y, z, m
    peaks              one row a wheel, as of the rolling model; utilisation is that of all its contacts together
    slip_work          energy lost by slipping at each wheel, J
    lift_off_count, lift_off_time, longest_lift_off   of each wheel: how often it lost contact, for how long in all, s
    residual, energy   largest residual of the energy ledger, J, and the energy that moved through it
    """

    name: str
    model: str
    completed: bool
    reason: str
    samples: int
    end: float
    steps: tuple[int, int]
    turn: float
    turn_time: float
    ripple: tuple[float, float, float]
    peaks: tuple[Peak, ...]
    slip_work: tuple[float, ...]
    lift_off_count: tuple[int, ...]
    lift_off_time: tuple[float, ...]
    longest_lift_off: tuple[float, ...]
    residual: float
    energy: float
    findings: tuple[Finding, ...]

    @property
    def works(self) -> bool:
        """Whether the run was completed and no finding says that the design does not work."""
        return self.completed and all(finding.severity != "failure" for finding in self.findings)

    def as_dict(self) -> dict:
        """Plain values for JSON, SI with units in the names; what is not finite becomes null."""
        wheels = [
            {
                "wheel": p.wheel,
                "torque_n_m": p.torque,
                "torque_time_s": p.torque_time,
                "rms_torque_n_m": p.rms_torque,
                "speed_rad_s": p.speed,
                "speed_time_s": p.speed_time,
                "power_w": p.power,
                "power_time_s": p.power_time,
                "least_normal_n": p.least_normal,
                "least_normal_time_s": p.least_normal_time,
                "largest_friction_n": p.largest_friction,
                "utilisation": p.utilisation if p.utilisation is None or math.isfinite(p.utilisation) else None,
                "slip_work_j": slip,
                "lift_off_count": count,
                "lift_off_time_s": open_time,
                "longest_lift_off_s": longest,
            }
            for p, slip, count, open_time, longest in zip(
                self.peaks, self.slip_work, self.lift_off_count, self.lift_off_time, self.longest_lift_off, strict=True
            )
        ]
        return {
            "name": self.name,
            "model": self.model,
            "works": self.works,
            "completed": self.completed,
            "reason": self.reason,
            "samples": self.samples,
            "end_s": self.end,
            "steps_accepted": self.steps[0],
            "steps_refused": self.steps[1],
            "peak_angular_velocity": {"rad_s": self.turn, "time_s": self.turn_time},
            "rms_centre_displacement_m": list(self.ripple),
            "ledger_residual_j": self.residual,
            "ledger_energy_j": self.energy,
            "wheels": wheels,
            "findings": [{"code": f.code, "severity": f.severity, "message": f.message} for f in self.findings],
        }


def compliant_overview(design: Design, run: CompliantRun) -> CompliantOverview:
    """The overview of a run; one without samples has the reason why as its one finding."""
    n, sampled = design.wheel_count, len(run.time) > 0
    speed = np.linalg.norm(run.angular_velocity, axis=1) if sampled else np.zeros(1)
    peak = int(np.argmax(speed))
    books = ledger(run)
    residual = float(np.abs(books.residual).max(initial=0.0))
    energy = max(float(np.abs(part).max(initial=0.0)) for part in books[:-1])
    contact_wheel = np.array([i - 1 for i, _ in run.machine.contacts])
    slip = run.works[-1, at.POWERS :] if sampled else np.zeros(len(contact_wheel))
    opened = [run.lift_offs[run.lift_offs[:, 0] == i] for i in range(n)]
    spans = [rows[:, 2] - rows[:, 1] for rows in opened]
    power, usage = run.motor_torque * run.wheel_speed, _usage(design, run)
    return CompliantOverview(
        name=design.name,
        model="compliant",
        completed=run.completed,
        reason=run.reason,
        samples=len(run.time),
        end=float(run.time[-1]) if sampled else 0.0,
        steps=run.steps,
        turn=float(speed[peak]),
        turn_time=float(run.time[peak]) if sampled else 0.0,
        ripple=tuple(map(float, run.centre_displacement.std(axis=0))) if sampled else (0.0, 0.0, 0.0),  # type: ignore[arg-type]
        peaks=tuple(wheel_peak(run, power, usage, w) for w in range(n)) if sampled else (),
        slip_work=tuple(float(slip[contact_wheel == i].sum()) for i in range(n)),
        lift_off_count=tuple(map(len, opened)),
        lift_off_time=tuple(float(span.sum()) for span in spans),
        longest_lift_off=tuple(float(span.max(initial=0.0)) for span in spans),
        residual=residual,
        energy=energy,
        findings=tuple(_findings(design, run, opened, residual, energy)),
    )


def _usage(design: Design, run: CompliantRun) -> np.ndarray | None:
    """|Σ T|/(μ Σ N) of each wheel's contacts; zero where it is not pressed."""
    mu = design.contact.friction
    if not mu:
        return None
    limit = mu * run.normal_force
    return np.divide(np.abs(run.friction_force), limit, out=np.zeros(limit.shape), where=limit > 0)


def _findings(design: Design, run: CompliantRun, opened, residual: float, energy: float):
    if not run.completed:
        yield Finding("incomplete", "failure", f"The run ended early: {run.reason}.")
    if not len(run.time):
        return
    yield from limit_findings(run, "torque", run.motor_torque, design.motor.torque, "N m")
    yield from limit_findings(run, "speed", run.wheel_speed, design.motor.speed, "rad/s")
    for w, rows in enumerate(opened):
        if len(rows):
            longest = rows[np.argmax(rows[:, 2] - rows[:, 1])]
            times = "once" if len(rows) == 1 else f"{len(rows)} times"
            yield Finding(
                "lift-off",
                "warning",
                f"Wheel {w + 1} loses contact {times}, for {1e3 * (longest[2] - longest[1]):.3g} ms at the longest, at "
                f"{longest[1]:.4g} s. More preload or more damping keeps it pressed.",
            )
    if residual > LEDGER_SHARE * energy:
        yield Finding(
            "ledger",
            "warning",
            f"The energy ledger is off by {residual:.2g} J of {energy:.2g} J: ask for a smaller error, accuracy below the "
            "present one.",
        )
