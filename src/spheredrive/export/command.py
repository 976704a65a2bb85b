"""What the command line asks for: a file of the machine for another program, and how far that program's answer is from ours."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.export.agreement import Agreement, Track, agreement, agreement_text
from spheredrive.io.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from spheredrive.design import Design
    from spheredrive.export.mjcf.run import MujocoRun, Settings
    from spheredrive.motion import Motion

FORMATS = ("mjcf",)


@dataclass(frozen=True)
class Check:
    """Both engines on the same motion: how far they are apart, and why they are."""

    agreement: Agreement
    reasons: tuple[str, ...]

    @property
    def works(self) -> bool:
        """Whether the engines agree."""
        return self.agreement.agrees

    def as_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {**self.agreement.as_dict(), "reasons": list(self.reasons)}


def export_text(format: str, design: Design) -> str:
    """The file of ``design`` in ``format``. Raises ``UnknownNameError`` for a format there is not, and as ``mjcf_spec``."""
    if format not in FORMATS:
        raise UnknownNameError("export format", format, FORMATS)
    from spheredrive.export.mjcf.text import mjcf_text

    return mjcf_text(design)


def export(format: str, design: Design, path: str | os.PathLike) -> None:
    """Write ``export_text`` whole to ``path``."""
    write_whole(path, export_text(format, design))


def check_motion(
    design: Design,
    motion: Motion,
    settings: Settings | None = None,
    watch: Callable[[float], None] | None = None,
) -> Check:
    """Run ``motion`` in our compliant model and in MuJoCo, and compare.

    Raises ``SpheredriveError`` for what either lacks.
    """
    import numpy as np

    from spheredrive.export.mjcf.model import linear_contact
    from spheredrive.export.mjcf.run import Settings, run_mujoco
    from spheredrive.simulation.simulate import simulate

    settings = settings or Settings()
    if motion.duration * motion.sample_rate < 8:
        raise SpheredriveError("the motion has too few samples to compare; raise its duration or its sample rate")
    # MuJoCo knows straight contact laws alone; both engines get the same one.
    design = replace(design, contact=linear_contact(design))
    ours = simulate(design, motion, "compliant", watch=watch)
    theirs = run_mujoco(design, motion, settings)
    speeds = np.abs(theirs.wheel_speed[len(theirs.time) // 4 :].mean(axis=0))
    count = np.array([wheel.rollers_per_race for wheel in design.wheels], float)
    races = np.array([len(wheel.alternation) for wheel in design.wheels])
    found = agreement(track(ours), track(theirs), design.contact_directions, count * races * speeds / (2 * np.pi))
    return Check(found, reasons(design, theirs, settings))


def track(run) -> Track:
    """What is compared of a run: of a dataset, or of ``MujocoRun``."""
    names = Track._fields
    if hasattr(run, "data_vars"):
        return Track(*(run[name].to_numpy() for name in names))
    return Track(*(getattr(run, name) for name in names))


def reasons(design: Design, run: MujocoRun, settings: Settings) -> tuple[str, ...]:
    """Where MuJoCo's model is another than ours, with its size."""
    from spheredrive.export.mjcf.contact import LAG

    share = run.added_mass / (design.sphere.mass or 1.0)
    found = [
        f"MuJoCo's contacts add a mass of {1e3 * run.added_mass:.3g} g each, {share:.2g} of the sphere's.",
        f"Its friction grows straight with the slip up to μN, ours bends; it lags by {1e6 * run.timestep / LAG:.3g} µs.",
        f"Its rollers have inertia, {100 * settings.roller_share:.3g} % of the wheel's mass; ours follow at once.",
        f"It takes fixed steps of {1e6 * run.timestep:.4g} µs of order {4 if settings.integrator == 'RK4' else 1}.",
    ]
    if any(getattr(wheel, "roller_shape", "") == "barrel" for wheel in design.wheels):
        circles, around = settings.mesh
        found.append(f"Its barrels are meshes of {circles} circles of {around} points, ours are round.")
    if not _damped(design):
        found.append("Nothing damps this machine: it rings on from its start, and each engine in its own phase.")
    if lifted := _lifted(design, run):
        found.append(
            f"A wheel is clear of the sphere in {100 * lifted:.2g} % of the samples; what follows depends on the instant."
        )
    if design.contact.rolling_arm or design.contact.spin_arm:
        found.append("Rolling and spin resistance are in our model alone.")
    return tuple(found)


def _damped(design: Design) -> bool:
    closure = design.closure
    return any((design.contact.damping, design.mount.damping, closure.damping, *(spring.damping for spring in closure.springs)))


def _lifted(design: Design, run: MujocoRun) -> float:
    """Share of the samples in which some wheel presses nowhere."""
    import numpy as np

    from spheredrive.simulation.dataset import contact_numbers

    wheel = [i for i, _ in contact_numbers(design)]
    loads = np.stack([run.normal_force[:, [i == one for i in wheel]].sum(axis=1) for one in sorted(set(wheel))])
    return float((loads == 0).any(axis=0).mean())


def check_text(found: Check) -> str:
    """The comparison as lines for a terminal, with the reasons of what is left."""
    return "\n".join([agreement_text(found.agreement), *(f"  {reason}" for reason in found.reasons)])
