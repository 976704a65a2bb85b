"""Designs to the text of design files, in the units people use; reading it back gives an equal design."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
import os
import re
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

from spheredrive.design import Design, Placement
from spheredrive.errors import DesignError
from spheredrive.io.files import write_whole
from spheredrive.io.quantity import parse
from spheredrive.io.readers import SCHEMA_VERSION
from spheredrive.wheels import Wheel

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_FILE_NAME = re.compile(r"[^A-Za-z0-9_.-]+")
# A direction whose components have the ratio of whole numbers up to this is written as these.
_WHOLE = 12
# Other multiples of a unit vector that are tried until one is read back to the last bit.
_MULTIPLES = 400
# What people write instead of the SI unit, how many make one, and up to how many decimal places it is tried.
_USUAL = {"rad": ("deg", 180 / math.pi, 16), "rad/s": ("rpm", 30 / math.pi, 7)}


class DesignFiles(NamedTuple):
    """The text of a design file, and the texts of the CSV files that it names, by their names."""

    text: str
    tables: dict[str, str]


def design_text(design: Design) -> str:
    """The text of a design file that is read back as an equal design.

    Lengths stand in mm, angles in degrees, speeds in rpm where that is exact, all else in SI; a number is the shortest that is
    read back to the last bit, and keys that have their default are left out. Wheels spread evenly over a circle are written
    as a ring again. The exceptions: a direction that no file can give exactly may come back a last bit off, and different
    wheels of one name are numbered.
    Raises ``DesignError`` for a measured wheel, whose outline is a file of its own: see ``design_files``.
    """
    text, tables = design_files(design)
    if tables:
        raise DesignError("the outline of a measured wheel is a file of its own, which a single text cannot hold", ("wheels",))
    return text


def design_files(design: Design) -> DesignFiles:
    """``design_text`` for any design: the text, and a CSV file for the outline of each measured wheel."""
    names = _wheel_names(design)
    tables: dict[str, str] = {}
    blocks = [[f"schema_version = {SCHEMA_VERSION}", f"name = {_quoted(design.name)}"]]
    blocks += _section("sphere", design.sphere)
    blocks += [_wheel_lines(name, wheel, tables) for wheel, name in names.items()]
    for run in _runs(design):
        blocks += _placement_blocks(run, names[run[0].wheel] if len(names) > 1 else None)
    for name in ("contact", "mount", "closure", "stage", "motor"):
        blocks += _section(name, getattr(design, name))
    return DesignFiles("\n\n".join("\n".join(block) for block in blocks) + "\n", tables)


def write_design(design: Design, path: str | os.PathLike) -> list[Path]:
    """Write ``design`` to the file ``path``, and the tables of measured wheels beside it; returns what was written.

    Every file is written whole or not at all. Raises ``InputError`` where one cannot be written.
    """
    text, tables = design_files(design)
    contents = {Path(path).parent / name: table for name, table in tables.items()} | {Path(path): text}
    for target, content in contents.items():
        write_whole(target, content)
    return list(contents)


def quantity_text(value: float, unit: str) -> str:
    """A number in SI ``unit`` as a file has it: ``"25 mm"``; the shortest that is read back to the last bit."""
    if not unit:
        return _decimal(value)
    if unit == "m" and abs(value) < 1:
        # A decimal number moved by three places is read back as the very number.
        return f'"{_decimal(Decimal(repr(value)).scaleb(3))} mm"'
    if unit in _USUAL:
        name, factor, most = _USUAL[unit]
        for digits in range(most):
            text = f"{_decimal(round(value * factor, digits))} {name}"
            if parse(text, unit) == value:
                return f'"{text}"'
    return f'"{_decimal(value)} {unit}"'


def _decimal(number: float | Decimal) -> str:
    text = repr(number) if isinstance(number, float) else format(number, "f" if 1e-6 < abs(number) < 1e16 else "")
    if "e" not in text.lower() and "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "0E-14", "0.0") or float(text) == 0 else text


def _section(name: str, value: Any) -> list[list[str]]:
    """The table of one of the design's parts, and those of the values it holds; nothing where all is at its default."""
    lines = [f"{key} = {text}" for key, text in _entries(value)]
    blocks = [[f"[{name}]", *lines]] if lines else []
    for field in dataclasses.fields(value):
        if "items" in field.metadata:
            for item in getattr(value, field.name):
                blocks.append([f"[[{name}.{field.name}]]", *(f"{key} = {text}" for key, text in _entries(item))])
    return blocks


def _entries(value: Any) -> list[tuple[str, str]]:
    """The keys of a value's declared fields and their text, without those at their default."""
    found = []
    for field in dataclasses.fields(value):
        meta, content = field.metadata, getattr(value, field.name)
        if not meta or content == field.default or "items" in meta or "columns" in meta:
            continue
        if field.name == "direction":
            content = _exact_direction(content)
        found.append((field.name, _field_text(content, meta)))
    return found


def _field_text(content: Any, meta: Any) -> str:
    if "inertia" in meta:
        return _inertia_text(content)
    if "unit" in meta:
        return _quantities_text(content, meta["unit"])
    if "flag" in meta:
        return str(content).lower()
    return str(int(content)) if "least" in meta else _quoted(content)


def _quantities_text(content: Any, unit: str) -> str:
    if isinstance(content, tuple):
        return f"[{', '.join(_quantities_text(part, unit) for part in content)}]"
    return quantity_text(content, unit)


def _inertia_text(inertia: Any) -> str:
    if isinstance(inertia, str):
        return _quoted(inertia)
    moments = tuple(inertia[i][i] for i in range(3))
    diagonal = all(inertia[i][j] == 0 for i in range(3) for j in range(3) if i != j)
    return _quantities_text(moments if diagonal else inertia, "kg m^2")


def _quoted(text: str) -> str:
    # A JSON string is one of TOML but for the control character that JSON leaves alone.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")


def _wheel_names(design: Design) -> dict[Wheel, str]:
    """A name for each different wheel model, in the order of the wheels: its own, numbered where it is taken."""
    names: dict[Wheel, str] = {}
    for wheel in design.wheels:
        if wheel not in names:
            numbered = itertools.chain([wheel.name], (f"{wheel.name}-{k}" for k in itertools.count(2)))
            names[wheel] = next(name for name in numbered if name not in names.values())
    return names


def _wheel_lines(name: str, wheel: Wheel, tables: dict[str, str]) -> list[str]:
    key = name if _BARE_KEY.fullmatch(name) else _quoted(name)
    lines = [f"[wheels.{key}]", f"type = {_quoted(wheel.type)}"]
    for field in dataclasses.fields(wheel):
        if "columns" in field.metadata:
            file = _table_name(name, tables)
            tables[file] = _csv_text(field.metadata["columns"], getattr(wheel, field.name))
            lines.append(f"{field.metadata['key']} = {_quoted(file)}")
    return lines + [f"{key} = {text}" for key, text in _entries(wheel) if key != "name"]


def _table_name(name: str, tables: dict[str, str]) -> str:
    plain = _FILE_NAME.sub("-", name).strip("-.") or "wheel"
    numbered = itertools.chain([f"{plain}.csv"], (f"{plain}-{k}.csv" for k in itertools.count(2)))
    return next(file for file in numbered if file.lower() not in {taken.lower() for taken in tables})


def _csv_text(columns: tuple[str, ...], rows: tuple) -> str:
    return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"


def _runs(design: Design) -> list[list[Placement]]:
    """The wheels in runs that may have been one entry of a file: neighbours of one model and one entry's number."""
    grouped = itertools.groupby(design.placements, key=lambda placement: (placement.ring, placement.wheel))
    return [list(group) for _, group in grouped]


def _placement_blocks(run: list[Placement], wheel_name: str | None) -> list[list[str]]:
    """The entries of a run of wheels: one ring where it is one to the last bit, else each wheel for itself."""
    ring = _ring_lines(run) if len(run) > 1 else None
    entries = [ring] if ring else [_vector_lines(one, whole=True) or _ring_lines([one]) or _vector_lines(one) for one in run]
    named = [] if wheel_name is None else [f"wheel = {_quoted(wheel_name)}"]
    return [["[[placement]]", *named, *(entry or [])] for entry in entries]


def _ring_lines(run: list[Placement]) -> list[str] | None:
    """The keys of a ring that is ``run``, or None: degrees are tried from whole ones to all digits."""
    first = [math.degrees(angle) for angle in run[0].azimuth_elevation_heading]
    for digits, turn in itertools.product(range(15), (0, 360)):
        degrees = [_decimal(round(angle, digits)) for angle in (first[0] + turn, *first[1:])]
        azimuth, elevation, heading = (math.radians(float(text)) for text in degrees)
        if abs(elevation) > math.pi / 2:
            continue
        count = len(run)
        made = (Placement.at(p.wheel, azimuth + 2 * math.pi * i / count, elevation, heading) for i, p in enumerate(run))
        if all(one == other for one, other in zip(made, run, strict=True)):
            texts = zip(("azimuth", "elevation", "heading"), degrees, strict=True)
            angles = [f'{key} = "{text} deg"' for key, text in texts if text != "0" or key == "elevation"]
            return [f"count = {count}", *angles]
    return None


def _vector_lines(placement: Placement, whole: bool = False) -> list[str] | None:
    """The keys of a wheel by two directions; with ``whole``, None unless both are whole numbers."""
    directions = placement.contact_direction, placement.drive_direction
    written = [_whole_direction(direction) for direction in directions]
    if whole and (None in written or Placement(placement.wheel, *written) != placement):  # type: ignore[arg-type]
        return None
    if not whole:
        written = [_exact_direction(direction) for direction in directions]
    keys = zip(("contact", "drive"), written, strict=True)
    return [f"{key} = [{', '.join(_decimal(float(number)) for number in numbers)}]" for key, numbers in keys]  # type: ignore[union-attr]


def _whole_direction(direction: tuple) -> tuple | None:
    """The least whole numbers in the direction of a unit vector, or None."""
    largest = max(map(abs, direction))
    for k in range(1, _WHOLE + 1):
        numbers = tuple(round(k * number / largest) for number in direction)
        length = math.hypot(*numbers)
        if all(abs(number / length - given) < 1e-15 for number, given in zip(numbers, direction, strict=True)):
            return numbers
    return None


def _exact_direction(direction: tuple) -> tuple:
    """A vector that becomes ``direction`` to the last bit when it is divided by its length, where one is found."""
    whole = _whole_direction(direction)
    multiples = (tuple(k * number / 16 for number in direction) for k in range(16, 16 + _MULTIPLES))
    for vector in itertools.chain([whole] if whole else [], multiples):
        length = math.hypot(*vector)
        if tuple(number / length for number in vector) == tuple(direction):
            return tuple(map(float, vector))
    return direction
