"""A comparison as text for the terminal."""

from __future__ import annotations

import math

from spheredrive.studies.compare.comparison import Comparison, Row
from spheredrive.summary import table
from spheredrive.summary.vibration import comfort_phrase

UNKNOWN = "-"
COLUMNS = (
    ("machine", ""),
    ("ξ least", ""),
    ("ξ most", ""),
    ("isotropy", ""),
    ("preload", "N"),
    ("depth", "µm"),
    ("peak", "µm"),
    ("RMS", "µm"),
    ("peak", "m/s²"),
    ("RMS", "m/s²"),
    ("weighted", "m/s²"),
    ("comfort", ""),
)


def comparison_text(c: Comparison) -> str:
    """What ``spheredrive compare`` prints: one line a machine, what is not known, and findings."""
    rows = [tuple(name for name, _ in COLUMNS), tuple(unit for _, unit in COLUMNS), *(cells(row) for row in c.rows)]
    lines = [*table(rows, indent=0, left=(0, 11)), "", basis_sentence(c), preload_sentence(c)]
    remarks = [f"  {name}: {text}" for row in c.rows for name, text in remarks_of(row)]
    return "\n".join([*lines, *([""] if remarks else []), *remarks])


def cells(row: Row) -> tuple[str, ...]:
    """The cells of a machine; a dash stands for what is not known."""
    sizes, comfort = row.sizes(), row.comfort()
    low, high = (None, None) if row.check is None else row.check.effectiveness
    motion = [None] * 4
    if sizes is not None:
        motion = [sizes.peak_displacement * 1e6, sizes.rms_displacement * 1e6, sizes.peak_acceleration, sizes.rms_acceleration]
    if row.jumps:
        motion[2:] = [math.inf, math.inf]
    return (
        row.machine.name,
        _fixed(low),
        _fixed(high),
        _fixed(None if row.check is None else row.check.isotropy),
        _number(row.preload),
        _number(None if row.depth is None else row.depth * 1e6),
        *map(_number, motion),
        _number(None if comfort is None else comfort.total),
        UNKNOWN if comfort is None else comfort_phrase(comfort.words),
    )


def _fixed(value: float | None) -> str:
    return UNKNOWN if value is None else "no limit" if math.isinf(value) else f"{value:.4f}"


def _number(value: float | None) -> str:
    return UNKNOWN if value is None else "no limit" if math.isinf(value) else f"{value:.4g}"


def basis_sentence(c: Comparison) -> str:
    """At what speeds the machines are compared."""
    speeds = " ".join(f"{omega:.4g}" for omega in c.wheel_speed[:12]) + (" …" if len(c.wheel_speed) > 12 else "")
    given = "" if c.chosen else ", as no speeds are given"
    return (
        f"At the same speed of the sphere's surface everywhere: the wheels of {c.first.name} turn at {speeds} rad/s{given}; "
        "other wheels turn so that the sphere moves alike."
    )


def preload_sentence(c: Comparison) -> str:
    """What the preload is for."""
    if c.motion is not None:
        return "Preload: the least force towards the wheels, beyond the closure's, with which no contact slips in the motion."
    return "Preload: the least force towards the wheels, beyond the closure's, with which the vibration lifts no contact."


def remarks_of(row: Row) -> list[tuple[str, str]]:
    """What is missing, assumed or wrong of a machine: its name and a sentence each. Warnings are for ``vibration`` to tell."""
    name = row.machine.name
    found = [(name, f"{what} not known: {why}") for what, why in row.reasons]
    if row.machine.note:
        found.append((name, row.machine.note))
    if row.jumps:
        found.append((name, "on rigid contacts the acceleration has no limit at the corners of the wheels' outlines"))
    for finding in (*(row.check.findings if row.check else ()), *(row.vibration.findings if row.vibration else ())):
        if finding.severity == "failure":
            found.append((name, f"{finding.message} [{finding.code}]"))
    return found
