"""Text with a unit to a number in SI: the one place where units are converted.

Pint resolves the unit names, from the short list in ``units.txt``; numbers are exact fractions until the last step, so
that ``"25 mm"`` is the same double as ``0.025``.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from spheredrive.errors import DesignError, did_you_mean
from spheredrive.values import checked_number

NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
NAME = r"[A-Za-zµμ°%_]{1,30}"
_ATOM = rf"{NAME}(?:(?:\^|\*\*)-?[0-9]|[²³])?"
_QUANTITY = re.compile(rf"({NUMBER})\s*(.*)", re.DOTALL)
_QUANTITIES = re.compile(rf"({NUMBER}(?:\s+{NUMBER})*)\s*(.*)", re.DOTALL)
_UNIT = re.compile(rf"{_ATOM}(?:\s*[*·/]\s*{_ATOM}|\s+{_ATOM}){{0,7}}")
_TERM = re.compile(rf"(?P<sign>[*·/]?)\s*(?P<name>{NAME})(?:(?:\^|\*\*)(?P<power>-?[0-9])|(?P<raised>[²³]))?")
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)\b", re.IGNORECASE)
_LONGEST = 80

# What a reader calls a quantity of the dimension of each of these units.
_KINDS = {
    "m": "a length",
    "kg": "a mass",
    "s": "a time",
    "rad": "an angle",
    "rad/s": "an angular speed",
    "rad/s^2": "an angular acceleration",
    "Hz": "a frequency",
    "N": "a force",
    "N m": "a torque",
    "N/m": "a stiffness",
    "N s/m": "a damping",
    "kg m^2": "a moment of inertia",
    "Pa": "a pressure",
    "m/s": "a speed",
    "m/s^2": "an acceleration",
    "m^2": "an area",
    "m^3": "a volume",
    "W": "a power",
    "N m/rad": "a torque by angle",
    "N m s/rad": "a torque by angular speed",
    "": "a plain number",
}
_USUAL = {"m": "mm", "rad": "deg", "rad/s": "rpm"}


def parse(value: Any, unit: str, name: str = "it", sign: str = "any") -> float:
    """``value`` in SI ``unit`` ("" for a plain number): text such as ``"25 mm"``, or a number that is SI already.

    ``name`` is what messages call the value, ``sign`` as in ``values.quantity``. Energy units pass for a torque, which
    has the same dimension. Raises ``DesignError`` for anything else, a comma, a missing or wrong unit, NaN or infinity,
    and sizes that no machine has.
    """
    if not isinstance(value, str):
        return checked_number(value, unit, sign)
    number, unit_text = _split(value, unit, name)
    return checked_number(_converted(number, unit_text, unit, value, name), unit, sign)


def parse_list(text: str, unit: str, name: str = "it", sign: str = "any") -> list[float]:
    """Numbers that share one unit, such as ``"0.1 1.2 0.9 rad/s"``, in SI ``unit``. Raises ``DesignError`` as ``parse``."""
    if "," in text:
        raise DesignError(f"{_shown(text)} has a comma; write spaces between the numbers, such as {_example(unit, '1 2 3')}")
    parts = _QUANTITIES.fullmatch(text.strip()) if len(text) < 100_000 else None
    if parts is None:
        _refuse_not_finite(text)
        raise DesignError(f"{_shown(text)} is not a list of numbers with a unit, such as {_example(unit, '1 2 3')}")
    numbers, unit_text = parts.groups()
    return [parse(f"{number} {unit_text}", unit, name, sign) for number in numbers.split()]


def _split(text: str, unit: str, name: str) -> tuple[str, str]:
    """The number and the unit in ``text``, both checked for form alone."""
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    parts = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if "," in text and re.match(r"[+-]?[0-9]", text):
        raise DesignError(f"write {_without_comma(text)}: a comma is not a decimal point here")
    _refuse_not_finite(text)
    if parts is None:
        raise DesignError(f"{_shown(text)} is not {_number_and_unit(unit)}, such as {_example(unit)}")
    number, unit_text = parts.groups()
    if not unit_text and unit:
        bare = f" (a number without quotes is in {unit})"
        raise DesignError(f"{_shown(text)} lacks a unit; {name} takes {_kind(unit)}, such as {_example(unit, number)}{bare}")
    if unit_text and not _UNIT.fullmatch(unit_text):
        raise DesignError(f"{_shown(text)} is not {_number_and_unit(unit)}, such as {_example(unit)}")
    return number, unit_text


def _converted(number: str, unit_text: str, unit: str, text: str, name: str) -> float:
    """``number`` in ``unit_text`` as a number in SI ``unit``, rounded once."""
    try:
        factor, dimension = _meaning(unit_text)
    except KeyError as error:
        unknown = error.args[0]
        raise DesignError(f"{_shown(text)} has the unknown unit '{unknown}'{_nearest(unknown, unit)}") from None
    except _AmbiguousUnit:
        raise DesignError(
            f"{_shown(text)} can be read in two ways; write the unit with each divisor behind a stroke of its own"
        ) from None
    si_factor, si_dimension = _meaning(unit)
    if dimension != si_dimension:
        other = _kinds().get(dimension, "of another kind")
        raise DesignError(f"{_shown(text)} is {other}, but {name} takes {_kind(unit)}, such as {_example(unit, number)}")
    size = abs(float(number))
    if not (1e-40 < size < 1e40 or re.fullmatch(r"[+-]?[0.]+(e.*)?", number, re.IGNORECASE)):
        raise DesignError(f"{_shown(text)} is not a size that a machine can have")
    if size == 0:
        return 0.0
    if factor / si_factor == _meaning("deg")[0]:
        return math.radians(float(number))
    return float(Fraction(number) * (factor / si_factor))


class _AmbiguousUnit(ValueError):
    """Something multiplied after a division: "N/m s"."""


@lru_cache(maxsize=1024)
def _meaning(unit_text: str) -> tuple[Fraction, frozenset]:
    """Factor to base units and powers of the base dimensions; ``KeyError`` names the first unknown unit."""
    factor, powers, divided = Fraction(1), {}, False
    for term in _TERM.finditer(unit_text):
        if divided and term["sign"] != "/":
            raise _AmbiguousUnit
        divided = divided or term["sign"] == "/"
        power = int(term["power"] or {"²": 2, "³": 3}.get(term["raised"], 1))
        power = -power if term["sign"] == "/" else power
        term_factor, dimensions = _named(term["name"])
        factor *= term_factor**power
        for dimension, exponent in dimensions.items():
            powers[dimension] = powers.get(dimension, 0) + exponent * power
    return factor, frozenset((d, p) for d, p in powers.items() if p)


@lru_cache(maxsize=1024)
def _named(name: str) -> tuple[Fraction, dict[str, int]]:
    import pint

    registry = _registry()
    try:
        unit = registry.parse_units("percent" if name == "%" else name)
    except (pint.PintError, AttributeError, AssertionError, ValueError, TypeError, SyntaxError):
        raise KeyError(name) from None
    factor, _ = registry.get_base_units(unit)
    return Fraction(factor), {d: int(p) for d, p in registry.get_dimensionality(unit).items()}


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(None, non_int_type=Fraction)  # type: ignore[arg-type]
    registry.load_definitions(str(Path(__file__).with_name("units.txt")))
    return registry


@lru_cache(maxsize=1)
def _kinds() -> dict[frozenset, str]:
    return {_meaning(unit)[1]: kind for unit, kind in _KINDS.items()}


def _kind(unit: str) -> str:
    return _KINDS.get(unit) or _kinds().get(_meaning(unit)[1], f"a quantity in {unit}")


def _nearest(unknown: str, unit: str) -> str:
    """What to write instead of an unknown unit: first among those of the dimension asked for, then among all."""
    words = _vocabulary()
    wanted = _meaning(unit)[1]
    fitting = sorted((word for word in words if _meaning(word)[1] == wanted), key=lambda word: (len(word), word))
    for word in fitting:
        if word.lower() == unknown.lower():
            return f"; did you mean '{word}'?"
    if "/" not in unit and " " not in unit:
        return did_you_mean(unknown, fitting)
    # A part of a compound unit has another dimension than the whole.
    near = did_you_mean(unknown, words)
    return near if "did you mean" in near else f"; write it as {_example(unit)}"


@lru_cache(maxsize=1)
def _vocabulary() -> tuple[str, ...]:
    """Units to suggest, in words and symbols."""
    words = {word for word in _registry() if "_" not in word}
    words |= {prefix + word for word in ("m", "g", "N", "s", "Hz", "rad", "Nm") for prefix in ("", "m", "u", "k")}
    words |= {"cm", "kPa", "MPa", "GPa", "MN", "kHz"}
    words |= {prefix + word for word in ("meter", "gram", "newton", "pascal") for prefix in ("milli", "centi", "micro", "kilo")}
    return tuple(sorted(words))


def _refuse_not_finite(text: str) -> None:
    if _NOT_FINITE.match(text.strip()):
        raise DesignError(f"must be a finite number, not {_shown(text)}")


def _without_comma(text: str) -> str:
    whole, _, rest = text.partition(",")
    # A second comma or a point can only be meant after thousands: then all commas go.
    plain = text.replace(",", "") if "," in rest or "." in rest else f"{whole}.{rest}"
    return _shown(plain)


def _number_and_unit(unit: str) -> str:
    return "a number with a unit" if unit else "a plain number"


def _example(unit: str, number: str = "") -> str:
    if not unit:
        return number or "0.9"
    number = number or {"m": "25", "rad": "40", "rad/s": "300"}.get(unit, "2")
    first = f'"{number} {_USUAL.get(unit, unit)}"'
    return f'{first} or "{number} rad/s"' if unit == "rad/s" else first


def _shown(text: str) -> str:
    return f'"{text}"' if len(text) <= _LONGEST else f'"{text[:40]}…"'
