"""A run of the dynamics as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from spheredrive.summary.cells import table

if TYPE_CHECKING:
    from spheredrive.simulation.overview import Overview


def run_text(result: Overview) -> str:
    """What ``spheredrive simulate`` prints of a run: peaks, what each wheel has to bear, and findings."""
    blocks = [_run_lines(result), _peak_lines(result), _run_finding_lines(result)]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _run_lines(result: Overview) -> list[str]:
    changes = "1 change" if result.race_changes == 1 else f"{result.race_changes} changes"
    lines = [f"{result.name}: {result.model} model, {result.end:g} s, {result.samples} samples, {changes} of race", ""]
    lines.append(f"  fastest turn           |Ω| = {result.turn:.4g} rad/s at {result.turn_time:.4g} s")
    used, low = result.worst_utilisation, result.least_normal
    if used is not None:
        lines.append(f"  friction utilisation   {ratio(used.utilisation)}, wheel {used.wheel} at {used.utilisation_time:.4g} s")
    if low is not None:
        place = f"wheel {low.wheel} at {low.least_normal_time:.4g} s"
        lines.append(f"  least normal force     {low.least_normal:.4g} N, {place}")
    lines.append(f"  least preload          {preload_phrase(result)}")
    lines.append(f"  energy ledger          {result.residual:.2g} J off at most, of {result.energy:.3g} J")
    return lines


def _peak_lines(result: Overview) -> list[str]:
    if result.loads is None:
        return []
    rows = [("wheel", "torque", "at", "rms", "speed", "at", "power", "at")]
    rows.append(("", "N m", "s", "N m", "rad/s", "s", "W", "s"))
    for p in result.loads.peaks:
        numbers = (p.torque, p.torque_time, p.rms_torque, p.speed, p.speed_time, p.power, p.power_time)
        rows.append((str(p.wheel), *(f"{x:.4g}" for x in numbers)))
    return ["  Largest amounts at each wheel", *table(rows, indent=4)]


def _run_finding_lines(result: Overview) -> list[str]:
    verdict = "The design works in this motion." if result.works else "The design does not work in this motion."
    return [verdict, *(f"  {f.severity}: {f.message} [{f.code}]" for f in result.findings)]


def preload_phrase(result: Overview) -> str:
    """The least preload of a run, or why there is none."""
    p = result.preload
    if isinstance(p, str):
        return f"not known: {p}"
    along = ", ".join(f"{round(x, 4) + 0.0:g}" for x in p.direction)
    if p.force == 0.0:
        return f"none needed along ({along}) on top of the closure force"
    return f"{p.force:.4g} N along ({along}) on top of the closure force, for wheel {p.wheel} at {p.time:.4g} s"


def ratio(utilisation: float) -> str:
    """A friction utilisation; beyond every number where a contact is not pressed."""
    return "beyond any limit (not pressed)" if math.isinf(utilisation) else f"{utilisation:.3f}"
