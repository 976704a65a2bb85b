"""Docstrings as they are written for a terminal, made into what Sphinx reads.

Ours are plain text: paragraphs, formulas set off by four spaces, and tables of names, two spaces and what each is.
"""

from __future__ import annotations

import dataclasses
import re

# ``code`` is kept; of all else, what would mean something to docutils is not to.
_CODE = re.compile(r"(``.+?``)")
_MARKUP = re.compile(r"([\\*|`]|(?<=\w)_(?=\W|$))")
_ENTRY = re.compile(r"(\S(?:[^ ]| (?! ))*?) {2,}(\S.*)")


def formatted(lines: list[str]) -> list[str]:
    """reStructuredText of a docstring's lines."""
    return [line for block in _blocks(lines) for line in [*_formatted_block(block), ""]]


def _blocks(lines: list[str]) -> list[list[str]]:
    """Lines between empty lines; a formula stays whole where empty lines part it."""
    found: list[list[str]] = [[]]
    for line in lines:
        if line.strip():
            found[-1].append(line)
        elif found[-1]:
            found.append([])
    return [block for block in found if block]


def _formatted_block(block: list[str]) -> list[str]:
    if all(line.startswith(" ") for line in block):
        return ["::", "", *(f"    {line.strip()}" if i == 0 else f"    {line[4:].rstrip()}" for i, line in enumerate(block))]
    if _ENTRY.fullmatch(block[0]):
        return _entries(block)
    return [escaped(line) for line in block]


def _entries(block: list[str]) -> list[str]:
    """A definition list of lines "name  what it is", which may go on in lines set in."""
    found: list[str] = []
    for line in block:
        entry = _ENTRY.fullmatch(line)
        if entry and not line.startswith(" "):
            names = ", ".join(f"``{name.strip()}``" for name in entry[1].split(","))
            found += [names, f"    {escaped(entry[2])}"]
        else:
            found.append(f"    {escaped(line.strip())}")
    return found


def escaped(text: str) -> str:
    """``text`` with nothing in it that docutils takes for markup, but for ``code``."""
    return "".join(part if i % 2 else _MARKUP.sub(r"\\\1", part) for i, part in enumerate(_CODE.split(text)))


def declared_fields(value: type) -> list[str]:
    """Keys of a value as they are declared: unit, meaning and default of each."""
    fields = [field for field in dataclasses.fields(value) if "doc" in field.metadata]
    found: list[str] = []
    for field in fields:
        default = "" if field.default in (dataclasses.MISSING, None, "") else f"``{field.default}`` if absent"
        parts = [escaped(field.metadata["doc"]), field.metadata.get("unit"), default]
        found += [f"``{field.name}``", f"    {'; '.join(filter(None, parts))}"]
    return found


def process_docstring(app, what, name, value, options, lines) -> None:
    """Sphinx's event: ``lines`` are changed in place."""
    # Pages say themselves what a module is for.
    new = [] if what == "module" else formatted(lines)
    if what == "class" and dataclasses.is_dataclass(value):
        new += [*declared_fields(value), ""]
    lines[:] = new


def process_signature(app, what, name, value, options, signature, returned):
    """Values and errors are read, not made, by those who read here: their signature would be a list of all fields."""
    return ("", None) if signature and what in ("class", "exception") else None


def skip_member(app, what, name, value, skip, options):
    """Fields of named tuples are in the docstring already; those of a dataclass in its table."""
    return True if type(value).__name__ in ("_tuplegetter", "member_descriptor") else None


def setup(app):
    """Register the events."""
    app.connect("autodoc-process-docstring", process_docstring)
    app.connect("autodoc-process-signature", process_signature)
    app.connect("autodoc-skip-member", skip_member)
    return {"parallel_read_safe": True}
