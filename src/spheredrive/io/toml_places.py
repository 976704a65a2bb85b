"""Where every key and value of a TOML text stands. Only for text that a TOML reader has accepted."""

from __future__ import annotations

import re
from typing import NamedTuple

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\n]+|#[^\n]*)*")
_BASIC = r'"(?:[^"\\\n]|\\.)*"'
_LITERAL = r"'[^'\n]*'"
_LONG = r'"""(?:[^\\]|\\.)*?"{3,5}' + "|" + r"'''.*?'{3,5}"
_KEY_PART = re.compile(rf"{_BASIC}|{_LITERAL}|[A-Za-z0-9_-]+")
_STRING = re.compile(rf"{_LONG}|{_BASIC}|{_LITERAL}", re.DOTALL)
# A date and a time may have a space between them.
_SCALAR = re.compile(r"\d{4}-\d\d-\d\d \d\d:[^\s,\]}#]*|[^\s,\]}#]+")


class Span(NamedTuple):
    """Offsets of a key and of its value; a table's value is its header, a list's entry has no key of its own."""

    key: tuple[int, int]
    value: tuple[int, int]


class _Scanner:
    def __init__(self, text: str):
        self.text = text
        self.at = 0
        self.spans: dict[Path, Span] = {}
        self.lengths: dict[Path, int] = {}

    def scan(self) -> dict[Path, Span]:
        table: Path = ()
        while self._skip_blank():
            if self.text[self.at] == "[":
                table = self._header()
            else:
                self._pair(table)
        return self.spans

    def _skip_blank(self) -> bool:
        self._take(_BLANK)
        return self.at < len(self.text)

    def _take(self, pattern: re.Pattern[str]) -> re.Match[str]:
        found = pattern.match(self.text, self.at)
        assert found is not None, "the text is not TOML"
        self.at = found.end()
        return found

    def _header(self) -> Path:
        start, double = self.at, self.text.startswith("[[", self.at)
        self.at += 2 if double else 1
        parts = self._key()
        self.at += 2 if double else 1
        whole = (start, self.at)
        path: Path = ()
        for i, (name, span) in enumerate(parts):
            path = (*path, name)
            last = i == len(parts) - 1
            self._remember(path, span, whole if last else span)
            if last and double:
                self.lengths[path] = self.lengths.get(path, 0) + 1
            if path in self.lengths:
                path = (*path, self.lengths[path] - 1)
                self._remember(path, span, whole if last else span)
        return path

    def _pair(self, table: Path) -> None:
        parts = self._key()
        self.at = self.text.index("=", self.at) + 1
        path = table
        for name, span in parts[:-1]:
            path = (*path, name)
            self._remember(path, span, span)
        path = (*path, parts[-1][0])
        self._skip_blank()
        start = self.at
        self.spans[path] = Span(parts[-1][1], (start, start + 1))
        self._value(path)
        self.spans[path] = Span(parts[-1][1], (start, self.at))

    def _key(self) -> list[tuple[str, tuple[int, int]]]:
        parts = []
        while True:
            self._skip_blank()
            found = self._take(_KEY_PART)
            parts.append((_unquoted(found.group()), found.span()))
            self._skip_blank()
            if not self.text.startswith(".", self.at):
                return parts
            self.at += 1

    def _value(self, path: Path) -> None:
        opening = self.text[self.at]
        if opening in "\"'":
            self._take(_STRING)
        elif opening in "[{":
            self._entries(path, "]" if opening == "[" else "}")
        else:
            self._take(_SCALAR)

    def _entries(self, path: Path, closing: str) -> None:
        self.at += 1
        count = 0
        while True:
            self._skip_blank()
            if self.text[self.at] == ",":
                self.at += 1
            elif self.text[self.at] == closing:
                self.at += 1
                return
            elif closing == "}":
                self._pair(path)
            else:
                start = self.at
                self._value((*path, count))
                self.spans[(*path, count)] = Span((start, self.at), (start, self.at))
                count += 1

    def _remember(self, path: Path, key: tuple[int, int], value: tuple[int, int]) -> None:
        # A table may be named by several headers; the first one that is its own stands for it.
        known = self.spans.get(path)
        if known is None or (known.value == known.key and value != key):
            self.spans[path] = Span(key, value)


def spans(text: str) -> dict[Path, Span]:
    """Where every key and value of ``text`` stands, by its path into the document."""
    return _Scanner(text).scan()


def _unquoted(part: str) -> str:
    if part[0] == "'":
        return part[1:-1]
    if part[0] == '"' and "\\" in part:
        import tomllib

        return next(iter(tomllib.loads(f"{part} = 0")))
    return part.strip('"') if part[0] == '"' else part
