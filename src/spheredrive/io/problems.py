"""Problems of a file, gathered with their paths, and told as one error at the first of them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError

from spheredrive.errors import DesignError, InputError, did_you_mean
from spheredrive.io.files import printable
from spheredrive.io.readers import SCHEMA_VERSION, read_version
from spheredrive.io.schema import keys_at
from spheredrive.io.toml_file import TomlFile
from spheredrive.wheels import TYPES

Path = tuple[str | int, ...]


class Problem(NamedTuple):
    """``path`` into the document, the rule it breaks, and whether its ``"key"`` or its ``"value"`` is to be marked.

    A rule that takes time to word is worded when it is told: a file can have thousands of problems.
    """

    path: Path
    rule: str | Callable[[], str]
    of: str = "value"


class Problems:
    """The problems of one document."""

    def __init__(self, document: TomlFile):
        self.document = document
        self.found: list[Problem] = []

    def add(self, path: Path, rule: str, of: str = "value") -> None:
        self.found.append(Problem(path, rule, of))

    @contextmanager
    def under(self, *prefix: str | int) -> Iterator[None]:
        """Gather a ``DesignError`` raised inside, its key seen from ``prefix``."""
        try:
            yield
        except DesignError as error:
            self.add((*prefix, *error.key), error.rule)

    def raise_first(self) -> None:
        """Raise ``InputError`` for the problem that stands first in the file, if there is one."""
        if not self.found:
            return
        first = min(self.found, key=lambda problem: self.document.span(problem.path, problem.of))
        more = len(self.found) - 1
        rest = f" ({more} more problem{'s' if more > 1 else ''} in this file)" if more else ""
        rule = first.rule if isinstance(first.rule, str) else first.rule()
        raise InputError(printable(f"{named(first.path)}{rule}{rest}"), self.document.locate(first.path, first.of))


def named(path: Path) -> str:
    """A path as words before a rule: ``sphere.radius: ``; counted entries are told by their line."""
    words = ".".join(part for part in path if isinstance(part, str))
    return f"{words[:100]}: " if words else ""


def check_version(document: TomlFile, problems: Problems) -> None:
    """Refuse a file of another format before its keys are looked at: they would only mislead."""
    version = document.data.get("schema_version")
    if version is None:
        problems.add((), f"this file lacks schema_version; write schema_version = {SCHEMA_VERSION} in its first line")
    else:
        with problems.under("schema_version"):
            read_version(version)
    problems.raise_first()


def validated(model: type[BaseModel], data: dict[str, Any], problems: Problems) -> Any:
    """``data`` as an instance of ``model``, or the first of its problems."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        entries = error.errors(include_url=False, include_input=False)
        # A misspelt key is missing too: it is told once, by the word that is there.
        misspelt = {entry["loc"][:-1] for entry in entries if entry["type"] == "extra_forbidden"}
        for entry in entries:
            if entry["type"] != "missing" or entry["loc"][:-1] not in misspelt:
                problems.found.append(_problem(entry, model))
    problems.raise_first()
    raise AssertionError("a refusal without a problem")


def _problem(entry: Any, model: type[BaseModel]) -> Problem:
    """A pydantic error in the words of the file."""
    kind, context = entry["type"], entry.get("ctx", {})
    # A union's branch is part of pydantic's path, not of the file's.
    loc: Sequence[str | int] = entry["loc"]
    path: Path = (*loc[:2], *loc[3:]) if loc[0] in ("wheels", "placement") else tuple(loc)
    if kind == "value_error":
        cause = context["error"]
        return Problem((*path, *cause.key), cause.rule)
    if kind == "extra_forbidden":
        return Problem(path, functools.partial(_unknown_key, loc, model), "key")
    if kind == "missing":
        return Problem(path[:-1], f"lacks the key {loc[-1]}" if len(path) > 1 else f"this file lacks {loc[-1]}")
    if kind == "union_tag_not_found":
        return Problem(path, f"lacks the key type, which is one of {', '.join(TYPES)}")
    if kind == "union_tag_invalid":
        tag = context["tag"][:60]
        return Problem((*path, "type"), f"{tag!r} is no wheel type{did_you_mean(tag, TYPES)}")
    return Problem(path, str(_SENTENCES.get(kind, entry["msg"])))


def _unknown_key(loc: Sequence[str | int], model: type[BaseModel]) -> str:
    key = str(loc[-1])[:60]
    choices, others = keys_at(model, loc[:-1])
    if key in others:
        return "a placement is either a ring (count, azimuth, elevation, heading) or one wheel (contact, drive), not both"
    return f"unknown key {key!r}{did_you_mean(key, choices, limit=20)}"


_SENTENCES = {
    "model_type": "takes a table of keys",
    "model_attributes_type": "takes a table of keys",
    "dict_type": "takes tables, each under a name of its own",
    "list_type": "takes a list of tables, each under a header in double brackets",
    "too_short": "names no wheel model",
}
