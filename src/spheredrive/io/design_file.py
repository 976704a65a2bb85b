"""Design files to designs."""

from __future__ import annotations

import dataclasses
import math
import os
from pathlib import Path
from typing import Any

from spheredrive.design import Design, Placement, Sphere
from spheredrive.errors import DesignError, InputError, did_you_mean
from spheredrive.io.catalogue import catalogue
from spheredrive.io.csv_file import read_csv
from spheredrive.io.problems import Problems, check_version, validated
from spheredrive.io.schema import design_model
from spheredrive.io.toml_file import TomlFile, parse_toml, read_toml
from spheredrive.wheels import TYPES, Wheel

MOST_WHEELS = 1000
LONGEST_NAME = 100
_PARTS: dict[str, Any] = {
    "sphere": Sphere,
    **{f.name: f.default_factory for f in dataclasses.fields(Design) if f.default_factory is not dataclasses.MISSING},
}


def load_design(path: str | os.PathLike) -> Design:
    """The design in the TOML file at ``path``.

    Raises ``InputError`` with the place of the first thing in the file that is wrong, the rule it breaks and the nearest
    valid word.
    """
    return _design(read_toml(path), Path(path).parent)


def parse_design(text: str, path: str = "design.toml", folder: str | os.PathLike | None = None) -> Design:
    """The design in ``text``; messages call it ``path``, and files it names are sought in ``folder``, else beside ``path``."""
    return _design(parse_toml(text, path), Path(path).parent if folder is None else Path(folder))


def _design(document: TomlFile, folder: Path) -> Design:
    problems = Problems(document)
    check_version(document, problems)
    content = validated(design_model(), _with_catalogue(document.data, problems), problems)
    parts = {key: _made(kind, getattr(content, key), problems, key) for key, kind in _PARTS.items() if getattr(content, key)}
    wheels = {name: _wheel(name, table, folder, problems) for name, table in content.wheels.items()}
    placements = _placements(content.placement, wheels, problems)
    problems.raise_first()
    with problems.under():
        return Design(name=content.name, placements=tuple(placements), source=document.text, **parts)
    problems.raise_first()
    raise AssertionError("a design was refused without a reason")


def _with_catalogue(data: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """``data`` with the keys of the catalogue put under those of each wheel that names a part."""
    wheels = data.get("wheels")
    if not isinstance(wheels, dict):
        return data
    merged = {}
    for name, table in wheels.items():
        part = table.get("catalogue") if isinstance(table, dict) else None
        entry = catalogue().get(part) if isinstance(part, str) else None
        merged[name] = table
        if entry is not None:
            with problems.under("wheels", name):
                merged[name] = entry.merged(table)
        elif isinstance(part, str):
            rule = f"{part[:60]!r} is no part of the catalogue{did_you_mean(part[:60], catalogue())}"
            problems.add(("wheels", name, "catalogue"), rule)
    problems.raise_first()
    return {**data, "wheels": merged}


def _made(kind: type, content: Any, problems: Problems, *path: str | int) -> Any:
    """A value of the dataclass ``kind`` from what a file gives of it, or None where that is refused."""
    given: dict[str, Any] = {}
    for field in dataclasses.fields(kind):
        if field.name in content.model_fields_set:
            given[field.name] = getattr(content, field.name)
        if "items" in field.metadata:
            entries = enumerate(given.get(field.name, ()))
            given[field.name] = tuple(_made(field.metadata["items"], e, problems, *path, field.name, i) for i, e in entries)
    with problems.under(*path):
        return kind(**given)
    return None


def _wheel(name: str, content: Any, folder: Path, problems: Problems) -> Wheel | None:
    kind = TYPES[content.type]
    given = {key: getattr(content, key) for key in content.model_fields_set - {"type", "catalogue"}}
    with problems.under("wheels", name):
        if not name.strip() or not name.isprintable() or len(name) > LONGEST_NAME:
            raise DesignError(f"the name of a wheel model is one line of text of up to {LONGEST_NAME} characters")
        for field in dataclasses.fields(kind):
            if "columns" in field.metadata:
                given[field.name] = _table(folder, given.pop(field.metadata["key"]), field.metadata)
        return kind(name=name, **given)
    return None


def _table(folder: Path, name: str, meta: Any) -> tuple:
    """The rows of a CSV file named by a key."""

    def check(header: list[str]) -> str:
        return "" if tuple(header) == meta["columns"] else f"the first line must name the columns {','.join(meta['columns'])}"

    try:
        return tuple(read_csv(folder / name, check)[1])
    except InputError as error:
        if error.place is not None:
            raise
        raise DesignError(f"{error.path!r}: {error.rule}", (meta["key"],)) from None


def _placements(entries: list[Any], wheels: dict[str, Wheel | None], problems: Problems) -> list[Placement]:
    total = sum(getattr(entry, "count", 1) for entry in entries)
    if total > MOST_WHEELS:
        problems.add(("placement",), f"the design has {total} wheels; it takes {MOST_WHEELS} at most")
        return []
    placements: list[Placement] = []
    for i, entry in enumerate(entries):
        with problems.under("placement", i):
            wheel = _chosen(entry.wheel, wheels)
            if wheel is not None:
                placements.extend(_placed(entry, wheel, i + 1))
    return placements


def _chosen(name: str | None, wheels: dict[str, Wheel | None]) -> Wheel | None:
    if name is None and len(wheels) > 1:
        raise DesignError(f"lacks the key wheel: there are several models, {', '.join(sorted(wheels))[:200]}")
    if name is not None and name not in wheels:
        raise DesignError(f"there is no wheel model {name[:60]!r}{did_you_mean(name[:60], wheels)}", ("wheel",))
    return wheels[name] if name is not None else next(iter(wheels.values()))


def _placed(entry: Any, wheel: Wheel, ring: int) -> list[Placement]:
    if hasattr(entry, "contact"):
        return [Placement(wheel, entry.contact, entry.drive, ring)]
    return [
        Placement.at(wheel, entry.azimuth + 2 * math.pi * i / entry.count, entry.elevation, entry.heading, ring)
        for i in range(entry.count)
    ]
