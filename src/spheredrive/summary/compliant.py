"""A compliant run as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spheredrive.summary.cells import table

if TYPE_CHECKING:
    from spheredrive.simulation.compliant.overview import CompliantOverview


def compliant_text(result: CompliantOverview) -> str:
    """What ``spheredrive simulate --model compliant`` prints of a run."""
    blocks = [_lines(result), _wheel_lines(result), _finding_lines(result)]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _lines(r: CompliantOverview) -> list[str]:
    ripple = ", ".join(f"{1e6 * x:.3g}" for x in r.ripple)
    return [
        f"{r.name}: compliant model, {r.end:g} s, {r.samples} samples, {r.steps[0]} steps and {r.steps[1]} refused",
        "",
        f"  fastest turn           |Ω| = {r.turn:.4g} rad/s at {r.turn_time:.4g} s",
        f"  ripple of the centre   {ripple} µm RMS along x, y, z",
        f"  lost by slipping       {sum(r.slip_work):.3g} J",
        f"  energy ledger          {r.residual:.2g} J off at most, of {r.energy:.3g} J",
    ]


def _wheel_lines(r: CompliantOverview) -> list[str]:
    if not r.peaks:
        return []
    rows = [("wheel", "torque", "rms", "speed", "power", "least N", "friction", "slip", "lift-offs", "open")]
    rows.append(("", "N m", "N m", "rad/s", "W", "N", "N", "J", "", "ms"))
    for i, p in enumerate(r.peaks):
        numbers = (p.torque, p.rms_torque, p.speed, p.power, p.least_normal, p.largest_friction, r.slip_work[i])
        ending = (str(r.lift_off_count[i]), f"{1e3 * r.lift_off_time[i]:.3g}")
        rows.append((str(p.wheel), *(f"{x:.4g}" for x in numbers), *ending))
    return ["  Largest amounts at each wheel", *table(rows, indent=4)]


def _finding_lines(r: CompliantOverview) -> list[str]:
    verdict = "The design works in this motion." if r.works else "The design does not work in this motion."
    return [verdict, *(f"  {f.severity}: {f.message} [{f.code}]" for f in r.findings)]
