"""Rows of the report's tables: what the design says, what is assumed, and what each kinematic number means."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np

from spheredrive.checking import Check
from spheredrive.design import Design
from spheredrive.simulation.overview import Overview
from spheredrive.summary import degrees, millimetres, singularity_text
from spheredrive.wheels.base import Wheel

# Units as a drawing would have them: factor from SI, and how the unit is written.
SHOWN_UNITS = {
    "m": (1e3, " mm"),
    "rad": (180 / math.pi, "°"),
    "Pa": (1e-9, " GPa"),
    "kg m^2": (1.0, " kg m²"),
    "": (1.0, ""),
}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Rows beyond these are left out, and the table says so.
MODELS_SHOWN = 20
WHEELS_SHOWN = 200


class Row(NamedTuple):
    """One line: what, how much, and a remark."""

    name: str
    value: str
    remark: str = ""


class Matrix(NamedTuple):
    """A matrix for the page: title, sentence, names of columns and rows, cells as text."""

    title: str
    meaning: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[str, ...]], ...]


class Table(NamedTuple):
    """A table of numbers for the page: names of the columns, units below them, rows as text."""

    columns: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    omitted: int


def shown_quantity(content: Any, unit: str) -> str:
    """A number or vector in SI ``unit`` as people read it: lengths in mm, angles in degrees."""
    factor, written = SHOWN_UNITS.get(unit, (1.0, f" {unit}"))
    if isinstance(content, (tuple, list)):
        # What is left of a component by rounding, beside the others, is none.
        least = 1e-12 * max(map(abs, content))
        return "(" + ", ".join(_number(factor * x if abs(x) > least else 0.0) for x in content) + ")" + written
    return _number(factor * content) + written


def _number(x: float) -> str:
    """Six digits, plain up to thousands of millions; smaller and larger ones with a power of ten."""
    text = f"{x:.6g}"
    if 1e5 <= abs(x) < 1e10:
        text = f"{float(text):.0f}"
    mantissa, _, power = text.partition("e")
    written = mantissa if not power else f"{mantissa} × 10{str(int(power)).translate(_RAISED)}"
    return "0" if x == 0 else written.replace("-", "−")


def given_rows(value: Any) -> list[Row]:
    """The quantities of a frozen value that are given: neither absent nor left at their default."""
    rows = []
    for field in dataclasses.fields(value):
        content, meta = getattr(value, field.name), field.metadata
        if content is None or content == field.default or "doc" not in meta or field.name in ("name", "inertia", "outline"):
            continue
        if "unit" in meta:
            rows.append(Row(_sentence(meta["doc"]), shown_quantity(content, meta["unit"])))
        elif "items" not in meta:
            rows.append(Row(_sentence(meta["doc"]), {True: "yes", False: "no"}.get(content, str(content))))
    return rows


def _sentence(text: str) -> str:
    """What a key is, without the part behind a semicolon that tells what holds where it is absent."""
    text = text.partition(";")[0]
    return text[:1].upper() + text[1:]


def design_sections(design: Design) -> list[tuple[str, list[Row]]]:
    """Titles and rows of everything the design gives, wheel models apart; empty ones left out."""
    springs = [
        Row(f"Spring {i} along {shown_quantity(s.direction, '')}", shown_quantity(s.stiffness, "N/m"),
            f"damping {shown_quantity(s.damping, 'N s/m')}")
        for i, s in enumerate(design.closure.springs, 1)
    ]  # fmt: skip
    sections = [
        ("Sphere", given_rows(design.sphere) + _inertia_rows(design)),
        ("Contact of wheel and sphere", given_rows(design.contact)),
        ("Mount of the wheels", given_rows(design.mount)),
        ("Closure", given_rows(design.closure) + springs),
        ("Stage", given_rows(design.stage)),
        ("Motor, at the wheel", given_rows(design.motor)),
    ]
    return [(title, rows) for title, rows in sections if rows]


def _inertia_rows(design: Design) -> list[Row]:
    tensor = design.sphere.inertia_tensor
    if tensor is None:
        return []
    if isinstance(design.sphere.inertia, str):
        return [
            Row("Inertia about every axis", shown_quantity(float(tensor[0, 0]), "kg m^2"), f"{design.sphere.inertia} sphere")
        ]
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    entries = (*np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2])
    return [
        Row(f"Inertia {name}", shown_quantity(float(entry), "kg m^2"))
        for name, entry in zip(names, entries, strict=True)
        if entry or name in names[:3]
    ]


def wheel_models(design: Design) -> list[Wheel]:
    """The different wheel models of the design, in order."""
    return list(dict.fromkeys(design.wheels))


def wheel_sections(design: Design) -> list[tuple[str, list[Row]]]:
    """Titles and rows of each wheel model."""
    return [(f"Wheel model {w.name} ({w.type})", _model_rows(w)) for w in wheel_models(design)[:MODELS_SHOWN]]


def _model_rows(wheel: Wheel) -> list[Row]:
    # What every wheel has stands first, even where it is left at its default.
    rows = [
        Row("Outer radius, at the contact", millimetres(wheel.radius)),
        Row("Roller angle", shown_quantity(wheel.roller_angle, "rad")),
    ]
    skipped = {_sentence(f.metadata.get("doc", "")) for f in dataclasses.fields(wheel) if f.name in ("radius", "roller_angle")}
    rows += [row for row in given_rows(wheel) if row.name not in skipped]
    outline = getattr(wheel, "outline", None)
    if outline is not None:
        rows.append(Row("Measured outline", f"{len(outline)} points"))
    return rows


def assumptions(design: Design) -> list[str]:
    """What the design leaves open and what is taken instead, one sentence each."""
    sphere, found = design.sphere, []
    if sphere.mass is None and isinstance(sphere.inertia, str):
        found.append("The sphere's mass is not given: kinematics needs none, loads and vibration do.")
    elif sphere.inertia == "hollow":
        found.append("The sphere is a hollow one, inertia ⅔MR²: what is taken where nothing else is given.")
    for wheel in wheel_models(design)[:MODELS_SHOWN]:
        if wheel.axial_inertia is None and wheel.mass is not None:
            inertia = shown_quantity(wheel.spin_inertia, "kg m^2")
            found.append(f"Wheel model {wheel.name} is a solid disc, axial inertia ½mr² = {inertia}.")
    for what, part in (("Contacts", design.contact), ("Mounts", design.mount)):
        if part.stiffness is None:
            found.append(f"{what} are rigid: no stiffness is given.")
    return found


def placement_rows(design: Design) -> list[tuple[str, ...]]:
    """One row a wheel: number, model, type, radius, rollers, roller angle, azimuth, elevation, heading."""
    rows = []
    for number, placement in enumerate(design.placements[:WHEELS_SHOWN], 1):
        wheel = placement.wheel
        azimuth, elevation, heading = placement.azimuth_elevation_heading
        # A rounding below zero must not read as a whole turn.
        turned = math.radians(round(math.degrees(azimuth), 9) % 360)
        angles = (degrees(a).replace("-", "−") for a in (wheel.roller_angle, turned, elevation, heading))
        rollers = str(getattr(wheel, "rollers", None) or "not given")
        roller_angle, *place = angles
        rows.append((str(number), wheel.name, wheel.type, millimetres(wheel.radius), rollers, roller_angle, *place))
    return rows


def quality_rows(result: Check) -> list[Row]:
    """The numbers of the kinematic answer, each with what it means for the designer."""
    low, high = result.effectiveness
    upper = "without limit" if math.isinf(high) else f"{high:.4f}"
    condition = "infinite" if math.isinf(result.condition_number) else f"{result.condition_number:.4g}"
    singular = result.singular_values[2] == 0.0
    determinant = (
        "none (not three contacts)" if result.determinant is None else _number(0.0 if singular else result.determinant)
    )
    return [
        Row("Determinant of A", determinant, "Zero where the layout is singular; its sign only tells the order of the wheels."),
        Row(
            "Condition number", condition, "How much a relative error of the wheel speeds can grow in the sphere's; 1 is best."
        ),
        Row(
            "Effectiveness ξ",
            f"{low:.4f} to {upper}",
            "Surface speed of the sphere for a unit of wheel rim speed, over all axes.",
        ),
        Row(
            "Isotropy",
            f"{result.isotropy:.4f}",
            "Least over largest ξ: 1 where every axis is alike, 0 where the layout is singular.",
        ),
        Row(
            "Slowest direction",
            result.slowest,
            "A turn about this axis takes most wheel speed: it limits how fast the sphere can go.",
        ),
        Row("Worst direction", result.weakest, "About this axis wheels hold the sphere least, and their errors grow most."),
        Row(
            "Nearest singularity",
            singularity_text(result).replace("-", "−"),
            "How far the layout stands from not working, and by which change.",
        ),
    ]


def matrices(result: Check) -> list[Matrix]:
    """Constraint, inverse Jacobian and Jacobian, all with one row a contact or wheel, so that many wheels fit a page."""
    axes = ("x", "y", "z")
    found = [
        Matrix("Constraint A", "A Ω = B ω: what each contact asks of the sphere's rotation, one row a contact.",
               axes, _rows("wheel", result.constraint)),
        Matrix("Inverse Jacobian J⁻¹", "ω = J⁻¹ Ω: the wheel speeds (rad/s) for one rad/s of the sphere about x, y, z.",
               axes, _rows("ω", result.inverse_jacobian)),
    ]  # fmt: skip
    J = result.jacobian
    if J is None:
        return found
    meaning = "Ω = J ω: the sphere's angular velocity (rad/s) for one rad/s of each wheel."
    if J.shape[1] <= 6:
        columns = tuple(f"wheel {i + 1}" for i in range(J.shape[1]))
        rows = tuple((f"Ω {axis}", _cells(row)) for axis, row in zip(axes, J, strict=True))
        return [*found, Matrix("Jacobian J", meaning, columns, rows)]
    return [*found, Matrix("Jacobian J, transposed", meaning + " One row a wheel.", axes, _rows("wheel", J.T))]


def _rows(name: str, matrix: np.ndarray) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((f"{name} {i}", _cells(row)) for i, row in enumerate(matrix[:WHEELS_SHOWN], 1))


def _cells(row) -> tuple[str, ...]:
    return tuple(f"{round(float(x), 9) + 0.0:.6f}".replace("-", "−") for x in row)


def sizing_table(moved: Overview) -> Table:
    """The largest amounts that each wheel, its motor and its contact have to bear in a motion, and when."""
    peaks = moved.loads.peaks if moved.loads else ()
    columns = ["Wheel", "Torque", "at", "RMS torque", "Speed", "at", "Power", "at", "Friction"]
    units = ["", "N m", "s", "N m", "rad/s", "s", "W", "s", "N"]
    known = moved.least_normal is not None
    used = moved.worst_utilisation is not None
    columns += ["Least normal", "at"] * known + ["Used", "at"] * used
    units += ["N", "s"] * known + ["of limit", "s"] * used
    rows = []
    for p in peaks[:WHEELS_SHOWN]:
        numbers = [p.torque, p.torque_time, p.rms_torque, p.speed, p.speed_time, p.power, p.power_time, p.largest_friction]
        numbers += [p.least_normal, p.least_normal_time] if known else []
        numbers += [p.utilisation, p.utilisation_time] if used else []
        rows.append((str(p.wheel), *map(_brief, numbers)))
    return Table(tuple(columns), tuple(units), tuple(rows), max(0, len(peaks) - WHEELS_SHOWN))


def _brief(x: float) -> str:
    return "not pressed" if math.isinf(x) else f"{x:.4g}".replace("-", "−")
