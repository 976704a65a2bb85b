"""Tables of numbers in CSV files: a header, then rows whose first column rises."""

from __future__ import annotations

import math
import os
from collections.abc import Callable

from spheredrive.errors import InputError, Place
from spheredrive.io.files import place_at, read_text
from spheredrive.values import LARGEST

LARGEST_FILE = 64 * 2**20

Row = tuple[float, ...]


def read_csv(path: str | os.PathLike, check_header: Callable[[list[str]], str]) -> tuple[list[str], list[Row]]:
    """Header and rows of a CSV file of up to 64 MiB.

    ``check_header`` returns what is wrong with the column names, or "". Raises ``InputError`` with the place of a cell
    that is no finite number, a row of another length than the header, and a first column that does not rise.
    """
    shown = os.fspath(path)
    lines = read_text(path, LARGEST_FILE).split("\n")
    while len(lines) > 1 and not lines[-1].strip():
        lines.pop()
    header = [cell.strip().strip('"') for cell in lines[0].split(",")]
    wrong = check_header(header)
    if wrong:
        hint = "; columns are parted by commas" if len(header) == 1 and (";" in lines[0] or "\t" in lines[0]) else ""
        raise InputError(f"{wrong}{hint}", place_at(lines[0], 0, shown, len(lines[0])))
    if len(lines) == 1:
        raise InputError("has a header but no rows", place_at(lines[0], 0, shown, len(lines[0])))
    rows: list[Row] = []
    for number, line in enumerate(lines[1:], 2):
        row = _row(line, number, header, shown)
        if rows and row[0] <= rows[-1][0]:
            rule = f"{header[0]} must rise from row to row, but {row[0]:g} follows {rows[-1][0]:g}"
            raise InputError(rule, _place(line, number, 0, shown))
        rows.append(row)
    return header, rows


def _row(line: str, number: int, header: list[str], path: str) -> Row:
    cells = line.split(",")
    try:
        row = tuple(map(float, cells))
    except ValueError:
        row = ()
    # NaN fails the comparison too.
    if len(row) == len(header) and all(abs(value) <= LARGEST for value in row) and "_" not in line:
        return row
    raise _refusal(cells, line, number, header, path)


def _refusal(cells: list[str], line: str, number: int, header: list[str], path: str) -> InputError:
    if not line.strip():
        return InputError("this row is empty", Place(path, number, 1))
    if len(cells) != len(header):
        rule = f"this row has {len(cells)} entries, the header {len(header)}"
        return InputError(rule, _place(line, number, min(len(cells), len(header) + 1) - 1, path))
    for i, cell in enumerate(cells):
        wrong = _wrong_cell(cell)
        if wrong:
            return InputError(f"{header[i][:60]} {wrong}", _place(line, number, i, path))
    raise AssertionError("a row without fault was refused")


def _wrong_cell(cell: str) -> str:
    if not cell.strip():
        return "is missing here"
    try:
        value = float(cell)
    except ValueError:
        value = None
    if value is None or "_" in cell:
        return f"takes a number in SI without a unit, not {cell.strip()[:40]!r}"
    if not math.isfinite(value):
        return f"must be a finite number, not {cell.strip()[:40]}"
    return f"is {value:g}, which is not a size that a machine can have" if abs(value) > LARGEST else ""


def _place(line: str, number: int, cell: int, path: str) -> Place:
    cells = line.split(",")
    start = sum(len(other) + 1 for other in cells[:cell])
    blank = len(cells[cell]) - len(cells[cell].lstrip())
    place = place_at(line, start + (0 if blank == len(cells[cell]) else blank), path, len(cells[cell].strip()))
    return Place(path, number, place.column, place.text, place.length)
