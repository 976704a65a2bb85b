"""Fields of the frozen values: what a quantity is called, its unit, and the range it can have.

A field is declared once, where the value is defined. The design file's schema, its unit conversion and its error
sentences are all made from that declaration (see ``io/schema.py``), so a new key is one line.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from spheredrive.errors import DesignError, did_you_mean

# No machine has a number beyond this in SI units; products of a few larger ones could overflow.
LARGEST = 1e15
# Nor a positive one below this, which could not be divided by.
SMALLEST = 1e-15


def quantity(unit: str, doc: str, *, default: Any = dataclasses.MISSING, sign: str = "positive", shape=()) -> Any:
    """A field holding a number (or a vector of ``shape``) in SI ``unit``.

    ``sign`` is ``"positive"``, ``"non-negative"`` or ``"any"``; zero is allowed by the last two.
    """
    metadata = {"unit": unit, "doc": doc, "sign": sign, "shape": tuple(shape)}
    return dataclasses.field(default=default, metadata=metadata)


def word(doc: str, choices: tuple[str, ...] = (), *, default: Any = dataclasses.MISSING) -> Any:
    """A field holding one of ``choices``, or any text where none are given."""
    return dataclasses.field(default=default, metadata={"choices": choices, "doc": doc})


def whole(doc: str, *, least: int, most: int = 100_000, default: Any = dataclasses.MISSING) -> Any:
    """A field holding a whole number."""
    return dataclasses.field(default=default, metadata={"least": least, "most": most, "doc": doc})


def check_fields(value: Any) -> None:
    """Refuse NaN, infinities, wrong signs, wrong choices and wrong shapes in a frozen value.

    Raises ``DesignError`` whose key names the field.
    """
    for field in dataclasses.fields(value):
        content = getattr(value, field.name)
        if content is None and field.default is None:
            continue
        meta = field.metadata
        if "unit" in meta:
            object.__setattr__(value, field.name, _checked_quantity(content, meta, (field.name,)))
        elif "least" in meta:
            _check_whole(content, meta, field.name)
        elif meta.get("choices") and content not in meta["choices"]:
            raise DesignError(f"{content!r} is not known{did_you_mean(str(content), meta['choices'])}", (field.name,))
        elif "choices" in meta and not isinstance(content, str):
            raise DesignError(f"takes text, not {content!r}", (field.name,))
        elif "flag" in meta and not isinstance(content, bool):
            raise DesignError(f"takes true or false, not {content!r}", (field.name,))


def _checked_quantity(content: Any, meta: Any, key: tuple[str | int, ...]) -> Any:
    shape = meta["shape"]
    if shape:
        if not hasattr(content, "__len__") or isinstance(content, str) or len(content) != shape[0]:
            raise DesignError(f"takes {shape[0]} numbers", key)
        rest = {**meta, "shape": shape[1:]}
        return tuple(_checked_quantity(part, rest, (*key, i)) for i, part in enumerate(content))
    return checked_number(content, meta["unit"], meta["sign"], key)


def checked_number(content: Any, unit: str, sign: str, key: tuple[str | int, ...] = ()) -> float:
    """``content`` as a float that is finite, of the sign asked for and of a size a machine can have."""
    if isinstance(content, (bool, str)) or not hasattr(content, "__float__"):
        raise DesignError(f"takes a number, not {content!r}", key)
    number = float(content)
    if not math.isfinite(number):
        raise DesignError(f"must be a finite number, not {number}", key)
    shown = f"{number:g} {unit}".rstrip()
    if sign == "positive" and number <= 0:
        raise DesignError(f"must be greater than zero, not {shown}", key)
    if sign == "non-negative" and number < 0:
        raise DesignError(f"cannot be negative, but is {shown}", key)
    if abs(number) > LARGEST or (sign == "positive" and number < SMALLEST):
        raise DesignError(f"{shown} is not a size that a machine can have", key)
    return number


def check_poisson_ratio(ratio: float | None) -> None:
    """Refuse a Poisson's ratio that no elastic body has; ``None`` passes."""
    if ratio is not None and not -1 < ratio <= 0.5:
        raise DesignError(f"is {ratio:g}, but lies above -1 and up to 0.5 for every elastic body", ("poisson_ratio",))


def _check_whole(content: Any, meta: Any, name: str) -> None:
    if isinstance(content, bool) or not hasattr(content, "__index__"):
        raise DesignError(f"takes a whole number, not {content!r}", (name,))
    if not meta["least"] <= content <= meta["most"]:
        raise DesignError(f"must be from {meta['least']} to {meta['most']}, not {content}", (name,))
