"""The catalogue of real wheels: published figures by maker and part, each with the addresses it was read at."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from types import MappingProxyType
from typing import Any

from spheredrive.errors import DesignError, UnknownNameError, did_you_mean
from spheredrive.io.quantity import NUMBER, parse
from spheredrive.values import quantity, whole, word
from spheredrive.wheels import TYPES, Wheel

# What is there to choose a part by, and no key of a wheel model.
_ABOUT = ("maker", "part", "note", "sources", "width", "load")
_SUFFIXES = {"m": "_m", "rad": "_rad", "kg": "_kg"}


@dataclass(frozen=True)
class Part:
    """One wheel that can be bought, in SI; a figure is None where nothing published gives it.

    ``keys`` are those of a wheel model, as a design file writes them; ``sources`` hold, by figure, the addresses at which it
    was read.
    """

    name: str
    maker: str
    part: str
    note: str
    keys: Mapping[str, Any] = dataclasses.field(repr=False, hash=False)
    sources: Mapping[str, tuple[str, ...]] = dataclasses.field(repr=False, hash=False)
    type: str | None = word("wheel type", tuple(TYPES), default=None)
    radius: float | None = quantity("m", "outer radius, at the contact", default=None)
    rollers: int | None = whole("number of rollers, all races together", least=2, default=None)
    roller_radius: float | None = quantity("m", "radius of a roller's cross-section, where it is thickest", default=None)
    roller_angle: float | None = quantity("rad", "angle between roller axis and wheel axis", sign="any", default=None)
    race_spacing: float | None = quantity("m", "distance between neighbouring races", default=None)
    width: float | None = quantity("m", "overall width", default=None)
    mass: float | None = quantity("kg", "mass of the whole wheel", default=None)
    load: float | None = quantity("kg", "what one wheel may bear", default=None)

    @property
    def diameter(self) -> float | None:
        """Twice the radius, m."""
        return None if self.radius is None else 2 * self.radius

    @property
    def missing(self) -> tuple[str, ...]:
        """The keys that a wheel of this type needs and that nothing published gives."""
        return _missing(self.keys)

    def merged(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """``given`` over those keys of this part that the type of wheel has.

        Raises ``DesignError`` where the types differ, or a key is missing in both.
        """
        if self.type is not None and given.get("type", self.type) != self.type:
            raise DesignError(f"{self.name} is a {self.type} wheel in the catalogue", ("type",))
        keys = {**self.keys, **given}
        missing = _missing(keys)
        if missing:
            *others, last = missing
            words, these = (f"{', '.join(others)} and {last}", "these keys") if others else (last, "this key")
            raise DesignError(f"no source of the catalogue gives the {words} of {self.name}; add {these}", ("catalogue",))
        # Only a part of unpublished type can hold a key too many.
        own = {"type", *(_field_keys(keys["type"]) if self.type is None else keys)}
        return {key: value for key, value in keys.items() if key in own or key in given}

    def wheel(self, **more: Any) -> Wheel:
        """The wheel model of this part; ``more`` adds or overrides keys, in SI. Raises ``DesignError`` as ``merged``."""
        keys = self.merged(more)
        kind = keys.pop("type")
        if kind not in TYPES:
            raise UnknownNameError("wheel type", str(kind), TYPES)
        unknown = [key for key in keys if key not in _field_keys(kind)]
        if unknown:
            raise DesignError(f"a {kind} wheel has no such key{did_you_mean(unknown[0], _field_keys(kind))}", (unknown[0],))
        figures = {key: more[key] if key in more else getattr(self, key) for key in keys}
        return TYPES[kind](**{"name": self.name, **figures})

    def as_dict(self) -> dict[str, Any]:
        """Everything in plain types, figures in SI with their unit in the name; null where unpublished."""
        figures = {}
        for field in _FIGURES:
            figures[field.name + _SUFFIXES.get(field.metadata.get("unit", ""), "")] = getattr(self, field.name)
        about = {"name": self.name, "maker": self.maker, "part": self.part}
        sources = {figure: list(addresses) for figure, addresses in self.sources.items()}
        return {**about, **figures, "missing": list(self.missing), "sources": sources, "note": self.note}


_FIGURES = tuple(field for field in dataclasses.fields(Part) if field.metadata)


@lru_cache(maxsize=1)
def catalogue() -> MappingProxyType[str, Part]:
    """Every part by its name, ``maker/part``, in alphabetical order."""
    text = resources.files("spheredrive.wheels").joinpath("catalogue.toml").read_text("utf-8")
    return MappingProxyType({name: _part(name, table) for name, table in sorted(tomllib.loads(text).items())})


def part(name: str) -> Part:
    """The part called ``name``, ``maker/part``; raises ``UnknownNameError`` with the nearest name for any other."""
    if name not in catalogue():
        raise UnknownNameError("part of the catalogue called", name, catalogue())
    return catalogue()[name]


def parts(
    *,
    wheel_type: str | None = None,
    maker: str | None = None,
    diameter: tuple[float, float] | None = None,
    rollers: tuple[float, float] | None = None,
    text: str | None = None,
) -> tuple[Part, ...]:
    """The parts that fit everything asked for, by name; all of them where nothing is asked.

    ``wheel_type`` and ``maker`` in words, ``diameter`` (m) and ``rollers`` from and to, both included; each word of ``text``
    must stand somewhere in the names or the note. A part without the figure asked for does not fit.
    Raises ``UnknownNameError`` for a type or a maker that does not exist.
    """
    if wheel_type is not None and wheel_type not in TYPES:
        raise UnknownNameError("wheel type", wheel_type, TYPES)
    if maker is not None and not any(maker.lower() in _maker_words(p) for p in catalogue().values()):
        raise UnknownNameError("maker", maker, {name.partition("/")[0] for name in catalogue()})
    return tuple(
        p
        for p in catalogue().values()
        if wheel_type in (None, p.type)
        and (maker is None or maker.lower() in _maker_words(p))
        and _within(p.diameter, diameter)
        and _within(p.rollers, rollers)
        and _mentions(p, text)
    )


def parse_range(text: str, unit: str, name: str) -> tuple[float, float]:
    """``"40..110 mm"``, ``"40 mm.."``, ``"..110 mm"`` or ``"100 mm"`` as two numbers in SI ``unit``.

    Raises ``DesignError`` for anything else.
    """
    low, dots, high = (side.strip() for side in text.partition(".."))
    if not dots:
        value = parse(text, unit, name)
        return value, value
    if not low and not high:
        raise DesignError(f'"{text[:60]}" is no range; write it as 8..12, with its unit, or leave out one of its ends', (name,))
    if re.fullmatch(NUMBER, low):
        # The first number may borrow the unit of the second.
        low = f"{low} {re.sub(NUMBER, '', high, count=1)}".strip()
    ends = parse(low, unit, name) if low else 0.0, parse(high, unit, name) if high else float("inf")
    if ends[0] > ends[1]:
        raise DesignError(f'"{text[:60]}" runs downwards; write the smaller end first', (name,))
    return ends


def _part(name: str, table: dict[str, Any]) -> Part:
    figures = {field.name: _read(table[field.name], field) for field in _FIGURES if field.name in table}
    sources: dict[str, tuple[str, ...]] = {figure: () for figure in figures}
    for address, read_there in table["sources"].items():
        for figure in read_there.split():
            sources[figure] = (*sources[figure], address)
    return Part(
        name=name,
        maker=table["maker"],
        part=table["part"],
        note=table.get("note", ""),
        keys=MappingProxyType({key: value for key, value in table.items() if key not in _ABOUT}),
        sources=MappingProxyType(sources),
        **figures,
    )


def _read(value: Any, field: dataclasses.Field) -> Any:
    unit = field.metadata.get("unit")
    return value if unit is None else parse(value, unit, field.name, field.metadata["sign"])


def _missing(keys: Mapping[str, Any]) -> tuple[str, ...]:
    """What a wheel of the type in ``keys`` cannot do without and ``keys`` lack."""
    if "type" not in keys:
        return ("type",)
    return tuple(key for key, needed in _field_keys(keys["type"]).items() if needed and key not in keys)


def _field_keys(kind: Any) -> dict[str, bool]:
    """The keys of a type of wheel, and whether it needs them; none where the type does not exist."""
    cls = TYPES.get(kind) if isinstance(kind, str) else None
    fields = () if cls is None else dataclasses.fields(cls)
    return {field.metadata.get("key", field.name): field.default is dataclasses.MISSING for field in fields}


def _maker_words(p: Part) -> tuple[str, str]:
    return p.maker.lower(), p.name.partition("/")[0].lower()


def _within(value: float | None, ends: tuple[float, float] | None) -> bool:
    # A hair of room: twice a radius in metres need not be the number that was typed.
    return ends is None or (value is not None and ends[0] * (1 - 1e-9) <= value <= ends[1] * (1 + 1e-9))


def _mentions(p: Part, text: str | None) -> bool:
    told = " ".join((p.name, p.maker, p.part, p.type or "", p.note)).lower()
    return all(asked in told for asked in (text or "").lower().split())
