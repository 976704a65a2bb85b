"""Text for the terminal: the catalogue of real wheels as a table, and one part whole."""

from __future__ import annotations

from collections.abc import Sequence

from spheredrive.io.catalogue import Part
from spheredrive.summary import degrees, millimetres, table

UNPUBLISHED = "-"
_BLANKS = {"type": '"?"', "rollers": "?", "roller_radius": '"? mm"', "race_spacing": '"? mm"'}


def parts_text(parts: Sequence[Part]) -> str:
    """What ``spheredrive catalogue`` prints: one line a part, and what the dashes mean."""
    if not parts:
        return "No part of the catalogue fits."
    rows: list[tuple[str, ...]] = [("part", "type", "diameter", "rollers", "roller", "load", "mass")]
    rows.append(("", "", "mm", "", "mm", "kg", "kg"))
    for p in parts:
        roller = None if p.roller_radius is None else 2e3 * p.roller_radius
        numbers = (p.diameter and 1e3 * p.diameter, p.rollers, roller, p.load, p.mass)
        rows.append((p.name, p.type or UNPUBLISHED, *(_number(x) for x in numbers)))
    count = "1 part" if len(parts) == 1 else f"{len(parts)} parts"
    end = f"{count}; {UNPUBLISHED}: not published. `spheredrive catalogue maker/part` shows one whole, with its sources."
    return "\n".join([*table(rows, indent=0, left=(0, 1)), "", end])


def part_text(part: Part) -> str:
    """What ``spheredrive catalogue maker/part`` prints: figures, the source of each, and the lines for a design file."""
    addresses = list(dict.fromkeys(address for read in part.sources.values() for address in read))
    blocks = [
        [part.name, f"  {part.maker}: {part.part}"],
        _figure_lines(part, addresses),
        *([[f"  {part.note}"]] if part.note else []),
        [f"  [{number}] {address}" for number, address in enumerate(addresses, 1)],
        ["In a design file:", "", *_design_lines(part)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks)


def _figure_lines(part: Part, addresses: list[str]) -> list[str]:
    figures = (
        ("type", "type", part.type),
        ("diameter", "radius", _length(part.diameter)),
        ("rollers", "rollers", part.rollers),
        ("roller diameter", "roller_radius", _length(part.roller_radius and 2 * part.roller_radius)),
        ("roller angle", "roller_angle", None if part.roller_angle is None else degrees(part.roller_angle)),
        ("race spacing", "race_spacing", _length(part.race_spacing)),
        ("width", "width", _length(part.width)),
        ("mass", "mass", _mass(part.mass)),
        ("load a wheel", "load", _mass(part.load)),
    )
    beside_the_point = {"race_spacing"} if part.type in ("standard", "mecanum") else set()
    beside_the_point |= {"roller_angle"} if part.type != "mecanum" else set()
    rows = []
    for words, figure, value in figures:
        if value is None and figure in beside_the_point:
            continue
        marks = " ".join(f"[{addresses.index(address) + 1}]" for address in part.sources.get(figure, ()))
        rows.append((words, "not published" if value is None else str(value), marks))
    return table(rows, left=(0, 1, 2))


def _design_lines(part: Part) -> list[str]:
    """A wheel table to paste; what it still needs stands in it as remarks."""
    lines = ["[wheels.omni]", f'catalogue = "{part.name}"']
    if part.missing:
        lines += ["# Not published; add before use:", *(f"# {key} = {_BLANKS[key]}" for key in part.missing)]
    return lines


def _number(value: float | None) -> str:
    return UNPUBLISHED if value is None else f"{value:.4g}"


def _length(value: float | None) -> str | None:
    return None if value is None else millimetres(value)


def _mass(value: float | None) -> str | None:
    return None if value is None else f"{value:.4g} kg"
