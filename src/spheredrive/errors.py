"""What can go wrong, as sentences a designer can act on."""

from __future__ import annotations

from dataclasses import dataclass


class SpheredriveError(Exception):
    """Base of the errors that say what is wrong with a design, a motion, a file or a question asked of them."""


class DesignError(SpheredriveError, ValueError):
    """A value that no machine can have.

    ``key`` is the path of the value at fault, in the words of the design file (``("sphere", "radius")``), so that a
    reader of files can point at its place.
    """

    def __init__(self, rule: str, key: tuple[str | int, ...] = ()):
        super().__init__(rule)
        self.rule = rule
        self.key = key

    def under(self, *prefix: str | int) -> DesignError:
        """The same error, its key seen from further outside."""
        return type(self)(self.rule, (*prefix, *self.key))

    def __str__(self) -> str:
        where = ".".join(str(part) for part in self.key)
        return f"{where}: {self.rule}" if where else self.rule


@dataclass(frozen=True)
class Place:
    """A place in a text file; ``line`` and ``column`` count from 1, ``text`` is the whole line."""

    path: str
    line: int
    column: int
    text: str = ""
    length: int = 1

    def __str__(self) -> str:
        return f"{self.path}:{self.line}:{self.column}"


class InputError(SpheredriveError, ValueError):
    """A file that cannot be used: where, by which rule, and what to write instead."""

    def __init__(self, rule: str, place: Place | None = None, path: str = ""):
        super().__init__(rule)
        self.rule = rule
        self.place = place
        self.path = path or (place.path if place else "")

    def __str__(self) -> str:
        if self.place is None:
            return f"{self.path}: {self.rule}" if self.path else self.rule
        head = f"{self.place}: {self.rule}"
        if not self.place.text:
            return head
        # A caret under a tab-indented line stays under its word only if the tabs are repeated.
        before = self.place.text[: self.place.column - 1]
        indent = "".join(c if c == "\t" else " " for c in before)
        return f"{head}\n  {self.place.text}\n  {indent}{'^' * max(1, self.place.length)}"


class SingularError(SpheredriveError, ArithmeticError):
    """The wheels do not determine the sphere's motion; the message names the direction they miss."""


class NearSingularWarning(UserWarning):
    """The answer exists but small errors of the wheels become large errors of the sphere."""


class UnknownNameError(SpheredriveError, KeyError):
    """A name that is not in the list it was looked up in."""

    def __init__(self, what: str, name: str, choices):
        choices = sorted(choices)
        super().__init__(f"there is no {what} {name!r}{did_you_mean(name, choices)}")

    def __str__(self) -> str:
        return str(self.args[0])


def did_you_mean(word: str, choices, limit: int = 12) -> str:
    """``"; did you mean 'x'?"`` where a choice is near ``word``, else ``"; choose from …"``."""
    import difflib

    choices = [str(c) for c in choices]
    near = difflib.get_close_matches(str(word), choices, n=1, cutoff=0.6)
    if not near:
        lowered = {c.lower(): c for c in choices}
        near = [lowered[n] for n in difflib.get_close_matches(str(word).lower(), list(lowered), n=1, cutoff=0.6)]
    if near:
        return f"; did you mean '{near[0]}'?"
    if not choices:
        return ""
    shown = ", ".join(choices[:limit])
    return f"; choose from {shown}{', …' if len(choices) > limit else ''}"
