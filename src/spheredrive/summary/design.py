"""A design and its kinematic answer as text."""

from __future__ import annotations

import math

from spheredrive.checking import Check, check
from spheredrive.design import Design
from spheredrive.kinematics.states import SEARCHED
from spheredrive.summary.cells import degrees, full_turn, millimetres, table

SHOWN_STATES = 16


def design_table(design: Design) -> str:
    """The design in one table, with the worst direction and the nearest singularity."""
    return "\n".join([*_design_lines(design), "", *_quality_lines(check(design))])


def check_text(design: Design, result: Check) -> str:
    """What ``spheredrive check`` prints: design, matrices, quality, contact states and findings."""
    blocks = [
        _design_lines(design),
        _matrix_lines(result),
        _quality_lines(result),
        _state_lines(result),
        _finding_lines(result),
    ]
    return "\n\n".join("\n".join(block) for block in blocks)


def _design_lines(design: Design) -> list[str]:
    sphere = design.sphere
    mass = "mass not given" if sphere.mass is None else f"{sphere.mass:g} kg"
    inertia = sphere.inertia if isinstance(sphere.inertia, str) else "inertia as given"
    lines = [design.name, f"  sphere   radius {millimetres(sphere.radius)}, {mass}, {inertia}", ""]
    rows = [("wheel", "model", "type", "radius", "rollers", "roller angle", "azimuth", "elevation", "heading")]
    for number, placement in enumerate(design.placements, 1):
        wheel = placement.wheel
        azimuth, elevation, heading = placement.azimuth_elevation_heading
        rollers = str(getattr(wheel, "rollers", None) or "-")
        angle = degrees(wheel.roller_angle)
        place = (full_turn(azimuth), degrees(elevation), degrees(heading))
        rows.append((str(number), wheel.name, wheel.type, millimetres(wheel.radius), rollers, angle, *place))
    return lines + table(rows, left=(1, 2))


def _quality_lines(result: Check) -> list[str]:
    low, high = result.effectiveness
    upper = "without limit" if math.isinf(high) else f"{high:.4f}"
    condition = "infinite" if math.isinf(result.condition_number) else f"{result.condition_number:.4g}"
    determinant = "none (not three contacts)" if result.determinant is None else f"{result.determinant:.6g}"
    return [
        f"  effectiveness ξ       {low:.4f} to {upper}",
        f"  isotropy              {result.isotropy:.4f}   (1: all directions alike, 0: singular)",
        f"  condition number      {condition}",
        f"  determinant of A      {determinant}",
        f"  worst direction       {result.weakest}: weakest hold, largest error",
        f"  slowest direction     {result.slowest}: most wheel speed for a turn",
        f"  nearest singularity   {singularity_text(result)}   (σ₃ of A now {result.singular_values[2]:.4f})",
    ]


def singularity_text(result: Check) -> str:
    """The nearest singularity in words."""
    if result.singular_values[2] == 0.0:
        return "the layout itself is singular"
    near = result.nearest_singularity
    if near is None:
        return "none by elevation, heading or roller angle of all wheels"
    name = near.parameter.replace("_", " ")
    return f"{name} of all wheels changed by {math.degrees(near.change):+.2f}°"


def _matrix_lines(result: Check) -> list[str]:
    lines = ["  A of A Ω = B ω, one row a contact"]
    lines += table([_numbers(row) for row in result.constraint], indent=4)
    lines += ["", "  inverse Jacobian, ω = J⁻¹ Ω"]
    lines += table([_numbers(row) for row in result.inverse_jacobian], indent=4)
    lines += ["", "  Jacobian, Ω = J ω"]
    if result.jacobian is None:
        return [*lines, "    none: the wheels do not determine the sphere's rotation"]
    return lines + table([_numbers(row) for row in result.jacobian], indent=4)


def _state_lines(result: Check) -> list[str]:
    count = result.contact_state_count
    states = result.contact_states
    worst_first = sorted(states, key=lambda s: (s.rotation_dof, round(s.isotropy, 12)))[:SHOWN_STATES]
    title = f"  {count} contact state{'' if count == 1 else 's'}"
    if len(worst_first) < count:
        alone = ", the worst" if count <= SEARCHED else ", the worst found"
        title += f", the worst {len(worst_first)}" if len(worst_first) > 1 else alone
    rows = [("races", "contacts", "slip-free motions", "of these rotations", "isotropy")]
    for s in worst_first:
        rows.append((s.races_text, str(s.contacts), str(s.slip_free_dof), str(s.rotation_dof), f"{s.isotropy:.4f}"))
    return [title, *table(rows, indent=4, left=(0,))]


def _finding_lines(result: Check) -> list[str]:
    verdict = "The design works." if result.works else "The design does not work."
    return [verdict, *(f"  {f.severity}: {f.message} [{f.code}]" for f in result.findings)]


def _numbers(row) -> tuple[str, ...]:
    return tuple(f"{round(x, 9) + 0.0:.6f}" for x in row)
