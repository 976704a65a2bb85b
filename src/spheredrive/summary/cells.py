"""Cells and columns of a table for the terminal."""

from __future__ import annotations

import math


def table(rows, indent: int = 2, left: tuple[int, ...] = ()) -> list[str]:
    """Rows of text as aligned columns, right-aligned but for the columns in ``left``."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = [cell.ljust(w) if i in left else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))]
        lines.append((" " * indent + "  ".join(cells)).rstrip())
    return lines


def millimetres(length: float) -> str:
    """A length (m) in mm, as on a drawing."""
    return f"{length * 1e3:.6g} mm"


def full_turn(angle: float) -> str:
    """An angle (rad) in degrees from 0 to below 360."""
    return f"{round(math.degrees(angle), 4) % 360 + 0.0:.6g}°"


def degrees(angle: float) -> str:
    """An angle (rad) in degrees, without a negative zero."""
    return f"{round(math.degrees(angle), 4) + 0.0:.6g}°"
