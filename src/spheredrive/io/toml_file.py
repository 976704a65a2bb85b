"""TOML text to plain data, with the place of every key and value for messages."""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from spheredrive.errors import InputError, Place
from spheredrive.io.files import decoded, place_at, read_text
from spheredrive.io.toml_places import Span, spans

LARGEST_FILE = 2**20
LONGEST_KEY = 64

# tomllib takes time with the square of a dotted key's length: keys of thousands of parts are refused before.
_LONG_KEY = re.compile(rf"(?<![\w\"'-])(?:[\w\"'-]++[ \t]*+\.[ \t]*+){{{LONGEST_KEY}}}")
_HUGE_NUMBER = re.compile(r"(?<![0-9_])[0-9_]{4000,}")
_PLACE = re.compile(r"(?P<rule>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", re.DOTALL)
_RULES = {
    "Cannot overwrite a value": "this key is given twice; keep one of the two",
    "Cannot mutate immutable namespace": "this table is given twice; keep one of the two",
    "Expected '=' after a key in a key/value pair": "a key is followed by = and its value",
    "Invalid statement": "this is neither a key with = and a value, nor a table in brackets",
    "Invalid initial character for a key part": "a key is made of letters, digits, _ and -",
    "Invalid value": 'this is not a value; text and quantities stand in quotes, such as "25 mm"',
    "Expected newline or end of document after a statement": (
        'the line should end here; text and quantities stand in quotes, such as "25 mm"'
    ),
    "Unclosed array": "a list that is opened by [ is closed by ]; a comma is between its entries",
    "Unclosed inline table": "a table that is opened by { is closed by }; a comma is between its entries",
    "Expected ']' at the end of a table declaration": "a table's name is closed by ]",
    "Expected ']]' at the end of an array declaration": "the name of a table in a list is closed by ]]",
    "Unterminated string": "a text that is opened by a quote is closed by the same quote",
}


@dataclass(frozen=True)
class TomlFile:
    """A TOML text that was read: ``data`` as ``tomllib`` gives it, and places on demand."""

    path: str
    text: str
    data: dict[str, Any]

    def span(self, path: tuple[str | int, ...], of: str = "value") -> tuple[int, int]:
        """Offsets of a key (``of="key"``) or of its value; of the nearest table around it where it is absent."""
        for length in range(len(path), 0, -1):
            span = self._spans.get(tuple(path[:length]))
            if span is not None:
                return span.key if of == "key" and length == len(path) else span.value
        return 0, 1

    def locate(self, path: tuple[str | int, ...], of: str = "value") -> Place:
        """The place that ``span`` tells, as a reader finds it."""
        start, end = self.span(path, of)
        # What runs over several lines is marked on its first.
        newline = self.text.find("\n", start, end)
        return place_at(self.text, start, self.path, (end if newline < 0 else newline) - start)

    @cached_property
    def _spans(self) -> dict[tuple[str | int, ...], Span]:
        try:
            return spans(self.text)
        except RecursionError:
            return {}


def read_toml(path: str | os.PathLike) -> TomlFile:
    """Read a TOML file of up to 1 MiB; raises ``InputError`` with the place of what is wrong."""
    return parse_toml(read_text(path, LARGEST_FILE), os.fspath(path))


def parse_toml(text: str, path: str) -> TomlFile:
    """TOML text as data; raises ``InputError`` with the place of what is wrong."""
    # Text made elsewhere may hold what no file can: it passes the same gate as a file's bytes.
    text = decoded(text.encode("utf-8", "replace"), path)
    if len(text) > LARGEST_FILE:
        raise InputError("is larger than 1 MiB, the most that is read", path=path)
    _refuse_long_keys(text, path)
    try:
        return TomlFile(path, text, tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(str(error), text, path) from None
    except RecursionError:
        rule = "lists or tables are nested too deeply here"
        raise InputError(rule, place_at(text, _deepest(text), path)) from None
    except ValueError:
        huge = _HUGE_NUMBER.search(text)
        start, end = huge.span() if huge else (0, 1)
        raise InputError("this number has too many digits", place_at(text, start, path, end - start)) from None


def _syntax_error(message: str, text: str, path: str) -> InputError:
    found = _PLACE.fullmatch(message)
    rule = found["rule"] if found else message
    line, column = _line_and_column(text, found)
    lines = text.split("\n")
    if rule.startswith(("Cannot declare", "Cannot overwrite", "Cannot mutate")):
        # The reader stops behind the value: what the eye looks for is the key.
        column = len(lines[line - 1]) - len(lines[line - 1].lstrip()) + 1
    start = sum(len(other) + 1 for other in lines[: line - 1]) + min(column - 1, len(lines[line - 1]))
    return InputError(_plain_rule(rule, text, start), place_at(text, start, path))


def _line_and_column(text: str, found: re.Match | None) -> tuple[int, int]:
    if found and found["line"]:
        return int(found["line"]), int(found["column"])
    last = text.rstrip("\n")
    return last.count("\n") + 1, len(last) - (last.rfind("\n") + 1) + 1


def _plain_rule(rule: str, text: str, offset: int) -> str:
    if rule.startswith("Duplicate inline table key"):
        return "this key is given twice; keep one of the two"
    if rule.startswith("Cannot declare"):
        return "this table is given twice; keep one of the two"
    if rule.startswith("Illegal character"):
        return "this text lacks its closing quote" if "n'" in rule else "this character cannot stand here"
    if rule == "Expected newline or end of document after a statement" and text[offset : offset + 1] == ",":
        return "a comma is not a decimal point; write 25.4, not 25,4"
    return _RULES.get(rule) or f"this is not TOML: {rule[:1].lower()}{rule[1:200]}"


def _refuse_long_keys(text: str, path: str) -> None:
    found = _LONG_KEY.search(text)
    if found:
        raise InputError(f"a key has {LONGEST_KEY} parts at most", place_at(text, found.start(), path))


def _deepest(text: str) -> int:
    """Offset of the bracket that is nested deepest; brackets inside of strings may mislead it, which does no harm."""
    depth = deepest = at = 0
    for found in re.finditer(r"[\[{\]}]", text):
        depth += 1 if found.group() in "[{" else -1
        if depth > deepest:
            deepest, at = depth, found.start()
    return at
