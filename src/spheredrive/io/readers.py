"""Single values of a file, as ``tomllib`` gives them, to checked values; every refusal is a ``DesignError``."""

from __future__ import annotations

import math
from typing import Any

from spheredrive.errors import DesignError, did_you_mean
from spheredrive.io.quantity import parse

SCHEMA_VERSION = 1
_LONGEST_WORD = 1000


def read_quantity(value: Any, meta: Any, shape: tuple, name: str, key: tuple = ()) -> Any:
    """A number in SI, or a tuple of them of ``shape``; ``meta`` is the metadata of ``values.quantity``."""
    if not shape:
        try:
            return parse(_scalar(value), meta["unit"], name, meta["sign"])
        except DesignError as error:
            raise error.under(*key) from None
    if not isinstance(value, list) or len(value) != (shape[0] or len(value)):
        raise DesignError(f"takes a list of {shape[0] or ''} numbers".replace("  ", " "), key)
    return tuple(read_quantity(part, meta, shape[1:], name, (*key, i)) for i, part in enumerate(value))


def read_inertia(value: Any) -> Any:
    """The word, the three moments or the 3x3 table of ``design.Sphere``."""
    if isinstance(value, str):
        return read_word(value, ("hollow", "solid"))
    if not isinstance(value, list) or len(value) != 3:
        raise DesignError('takes "hollow", "solid", three moments or a 3x3 table, kg m^2')
    shape = (3, 3) if any(isinstance(row, list) for row in value) else (3,)
    return read_quantity(value, {"unit": "kg m^2", "sign": "any"}, shape, "inertia")


def read_rows(value: Any, name: str) -> Any:
    """A list of lists, its numbers as the file has them."""
    # Their unit depends on another key: the numbers are read where that key is known.
    if not isinstance(value, list) or not all(isinstance(row, list) for row in value):
        raise DesignError("takes a list of rows, such as [[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]")
    return value


def read_whole(value: Any, meta: Any) -> int:
    """A whole number in the range of ``values.whole``."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise DesignError(f"takes a whole number, not {_shown(value)}")
    if not meta["least"] <= value <= meta["most"]:
        raise DesignError(f"must be from {meta['least']} to {meta['most']}, not {_shown(value)}")
    return value


def read_flag(value: Any) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise DesignError(f"takes true or false, not {_shown(value)}")
    return value


def read_word(value: Any, choices: tuple[str, ...]) -> str:
    """One of ``choices``, or one line of text where there are none."""
    if not isinstance(value, str):
        raise DesignError(f"takes text in quotes, not {_shown(value)}")
    if choices and value not in choices:
        raise DesignError(f"{_shown(value)} is not known{did_you_mean(value[:60], choices)}")
    if len(value) > _LONGEST_WORD or not value.isprintable():
        raise DesignError(f"takes one line of text of up to {_LONGEST_WORD} characters")
    return value


def read_version(value: Any) -> int:
    """The version of the file format, where it is the one that is known."""
    if isinstance(value, bool) or value != SCHEMA_VERSION or not isinstance(value, int):
        raise DesignError(
            f"is {_shown(value)}, but this version of spheredrive reads files of schema_version = {SCHEMA_VERSION}"
        )
    return value


def _scalar(value: Any) -> Any:
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > 1e300:
        return math.inf
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise DesignError(f"takes a number, not {_shown(value)}")
    return value


def _shown(value: Any) -> str:
    """``value`` as a file has it, in short."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, dict)):
        return "a list" if isinstance(value, list) else "a table"
    if isinstance(value, int) and abs(value) > 1e15:
        return "a number of more than 15 digits"
    text = str(value)
    text = text if len(text) <= 60 else f"{text[:40]}…"
    return f'"{text}"' if isinstance(value, str) else text
