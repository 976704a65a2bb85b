"""Motion files to motions."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from spheredrive.errors import DesignError, InputError
from spheredrive.io.csv_file import read_csv
from spheredrive.io.problems import Problems, check_version, validated
from spheredrive.io.quantity import parse
from spheredrive.io.schema import motion_model
from spheredrive.io.toml_file import TomlFile, parse_toml, read_toml
from spheredrive.motion import Motion, Series, StageMotion

# What a bare number of a kind of motion is in.
UNITS = {"wheel-speed": "rad/s", "wheel-torque": "N m", "sphere-velocity": "rad/s", "force": "N", "position": "m"}


def load_motion(path: str | os.PathLike, wheel_count: int | None = None) -> Motion:
    """The motion in the TOML file at ``path``; with ``wheel_count``, one for another number of wheels is refused.

    Raises ``InputError`` with the place of the first thing in the file that is wrong and the rule it breaks.
    """
    return _motion(read_toml(path), Path(path).parent, wheel_count)


def parse_motion(
    text: str, path: str = "motion.toml", folder: str | os.PathLike | None = None, wheel_count: int | None = None
) -> Motion:
    """The motion in ``text``; messages call it ``path``, and a CSV file is sought in ``folder``, else beside ``path``."""
    return _motion(parse_toml(text, path), Path(path).parent if folder is None else Path(folder), wheel_count)


def _motion(document: TomlFile, folder: Path, wheel_count: int | None) -> Motion:
    problems = Problems(document)
    check_version(document, problems)
    content = validated(motion_model(), document.data, problems)
    given: dict[str, Any] = {}
    for part in (content.initial, content.output):
        given.update({key: getattr(part, key) for key in part.model_fields_set} if part else {})
    with problems.under("motion"):
        given["series"] = _series(content.motion, folder)
    if content.stage:
        with problems.under("stage"):
            given["stage"] = _stage(content.stage)
    problems.raise_first()
    with problems.under():
        duration = content.motion.duration
        if duration is None:
            duration = _last_time(given["series"], content.motion)
        motion = Motion(kind=content.motion.kind, duration=duration, source=document.text, **given)
        if wheel_count is not None:
            motion.check_wheel_count(wheel_count)
        return motion
    problems.raise_first()
    raise AssertionError("a motion was refused without a reason")


def _last_time(series: Series, content: Any) -> float:
    if series.time[-1] <= 0:
        raise DesignError("lacks the key duration: the last time is not after zero", ("motion",))
    return series.time[-1]


def _series(content: Any, folder: Path) -> Series:
    given = content.model_fields_set
    if "file" in given:
        if given & {"time", "values"}:
            raise DesignError("takes either time and values, or a file with both", ("file",))
        return Series(*_from_csv(folder, content.file, content.kind), content.interpolation)
    for key in ("time", "values"):
        if key not in given:
            raise DesignError(f"lacks the key {key}; give time and values, or a file with both")
    return Series(content.time, _numbers(content.values, UNITS[content.kind]), content.interpolation)


def _stage(content: Any) -> StageMotion:
    return StageMotion(content.kind, Series(content.time, _numbers(content.values, UNITS[content.kind]), content.interpolation))


def _numbers(rows: list[list[Any]], unit: str) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(_number(value, unit, i, j) for j, value in enumerate(row)) for i, row in enumerate(rows))


def _number(value: Any, unit: str, row: int, column: int) -> float:
    try:
        if isinstance(value, (list, dict)):
            raise DesignError("takes a number in each place of a row")
        return parse(value, unit, "a value")
    except DesignError as error:
        raise error.under("values", row, column) from None


def _from_csv(folder: Path, name: str, kind: str) -> tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]:
    try:
        _, rows = read_csv(folder / name, lambda header: _wrong_header(header, kind))
    except InputError as error:
        if error.place is not None:
            raise
        raise DesignError(f"{error.path!r}: {error.rule}", ("file",)) from None
    return tuple(row[0] for row in rows), tuple(row[1:] for row in rows)


def _wrong_header(header: list[str], kind: str) -> str:
    if kind == "sphere-velocity":
        return "" if header == ["time", "x", "y", "z"] else "the first line must name the columns time,x,y,z"
    expected = ["time", *(f"wheel_{i}" for i in range(1, len(header)))]
    if header == expected and len(header) > 1:
        return ""
    return "the first line must name the columns time,wheel_1,wheel_2,… one a wheel, in their order"
