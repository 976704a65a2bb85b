"""Paths into a design file: ``placement.elevation``, ``wheels.omni.roundness``, ``closure.force.3``.

A path is resolved once, against the file it leads into: to the places that it writes, and to what a value there must be. The
keys are those of the value classes (see ``values.quantity``); none is listed here.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from spheredrive.design import Design
from spheredrive.errors import DesignError, did_you_mean
from spheredrive.io import sections
from spheredrive.io.catalogue import catalogue
from spheredrive.io.readers import read_flag, read_inertia, read_quantity, read_whole, read_word
from spheredrive.wheels import TYPES

Place = tuple["str | int", ...]

_DESIGN = {field.name: field for field in dataclasses.fields(Design)}
_PARTS: dict[str, Any] = {
    name: field.default_factory for name, field in _DESIGN.items() if field.default_factory is not dataclasses.MISSING
}
_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class DesignPath:
    """A path, resolved.

    text      as it was written
    places    what it writes, each a path into the file's data, counted from 0
    base      what stands at each place, SI; None where nothing does
    meta      what was declared of the key
    unit      SI unit of a number, "" otherwise
    numeric   whether values are single numbers, with a unit or not
    whole     whether they are whole numbers
    """

    text: str
    places: tuple[Place, ...]
    base: tuple[Any, ...]
    meta: Mapping[str, Any] = dataclasses.field(compare=False, repr=False)
    unit: str = ""
    numeric: bool = False
    whole: bool = False

    def read(self, value: Any) -> Any:
        """``value`` as a file gives it, in SI and checked as far as it can be alone. Raises ``DesignError``."""
        return _read(self.meta, value, self.places[0])


def resolve(text: str, data: Mapping[str, Any]) -> DesignPath:
    """The path ``text`` into the design file whose plain data are ``data``.

    Rings and wheel models are told by number from 1, models also by name; without either, all of them are meant. Components of
    vectors are told by number from 1 or by x, y, z. Raises ``DesignError`` with the nearest word for a path that leads nowhere.
    """
    head, _, rest = text.partition(".")
    parts = rest.split(".") if rest else []
    if head == "placement":
        found = _in_placements(parts, data)
    elif head == "wheels":
        found = _in_wheels(parts, data)
    elif head == "sphere" or head in _PARTS:
        kind = dataclasses.fields(_class_of(head))
        found = _in_table({f.name: f for f in kind if f.metadata}, parts, ((head,),), data)
    else:
        raise DesignError(f"a design has no {head[:60]!r}{did_you_mean(head[:60], ['sphere', 'wheels', 'placement', *_PARTS])}")
    meta, places, defaults = found
    single = ("unit" in meta and not meta["shape"]) or "least" in meta
    base = tuple(_base(meta, data, place, default) for place, default in zip(places, defaults, strict=True))
    return DesignPath(text, places, base, dict(meta), meta.get("unit", ""), single, "least" in meta)


def _class_of(section: str) -> type:
    from spheredrive.design import Sphere

    return Sphere if section == "sphere" else _PARTS[section]


def _in_table(keys: Mapping[str, Any], parts: list[str], tables: tuple[Place, ...], data):
    """Declaration, places and defaults of the key ``parts`` in each of ``tables``, which have the same ``keys``."""
    if not parts:
        raise DesignError(f"leads to a whole table; add a key: {', '.join(list(keys)[:20])}")
    key, *rest = parts
    if key not in keys:
        raise DesignError(f"there is no key {key[:60]!r}{did_you_mean(key[:60], keys, limit=20)}")
    field = keys[key]
    meta = field.metadata
    places = tuple((*table, key) for table in tables)
    default = None if field.default is dataclasses.MISSING else field.default
    if "items" in meta and rest:
        return _in_items(meta, rest, places, data)
    if rest:
        return _component(meta, rest, places, default)
    return meta, places, (default,) * len(places)


def _component(meta, rest: list[str], places, default):
    shape = meta.get("shape") or ()
    if not shape or len(rest) > 1:
        raise DesignError("the path goes on where the design has a single value; leave its end out")
    index = _AXES.get(rest[0], -1) if not rest[0].isdecimal() else int(rest[0]) - 1
    if not 0 <= index < shape[0]:
        raise DesignError(f"a component is told by a number from 1 to {shape[0]}, or x, y, z, not {rest[0][:60]!r}")
    meta = {**meta, "shape": tuple(shape[1:])}
    value = None if default is None else default[index]
    return meta, tuple((*place, index) for place in places), (value,) * len(places)


def _in_items(meta, rest: list[str], places, data):
    entries = _at(data, places[0]) or []
    index = _number(rest[0], len(entries), "spring")
    keys = {f.name: f for f in dataclasses.fields(meta["items"])}
    return _in_table(keys, rest[1:], ((*places[0], index),), data)


def _in_placements(parts: list[str], data):
    entries = data["placement"]
    chosen = range(len(entries))
    if parts and parts[0].isdecimal():
        chosen = [_number(parts[0], len(entries), "placement")]
        parts = parts[1:]
    kinds = {sections.Vectors if "contact" in entries[i] else sections.Ring for i in chosen}
    if len(kinds) > 1:
        raise DesignError("some placements are rings and some single wheels; tell them by number, such as placement.1")
    (kind,) = kinds
    keys = {f.name: f for f in dataclasses.fields(kind)}
    return _in_table(keys, parts, tuple(("placement", i) for i in chosen), data)


def _in_wheels(parts: list[str], data):
    models = data["wheels"]
    names = list(models)
    # A model's name may have points of its own.
    named = [n for n in names if parts[: len(n.split("."))] == n.split(".")]
    if named:
        chosen, parts = named[:1], parts[len(named[0].split(".")) :]
    elif parts and parts[0].isdecimal():
        chosen, parts = [names[_number(parts[0], len(names), "wheel model")]], parts[1:]
    elif len(parts) > 1:
        raise DesignError(f"there is no wheel model {parts[0][:60]!r}{did_you_mean(parts[0][:60], names)}")
    else:
        chosen = names
    declared = [wheel_keys(wheel_type(models[name])) for name in chosen]
    common = {key: field for key, field in declared[0].items() if all(key in other for other in declared)}
    return _in_table(common, parts, tuple(("wheels", name) for name in chosen), data)


def wheel_type(table: Mapping[str, Any]) -> str:
    """The type of a wheel model's table, its catalogue part's where it names one."""
    entry = catalogue().get(table.get("catalogue", ""))
    return str(table.get("type") or (entry.type if entry else None))


def wheel_keys(kind: str) -> dict[str, Any]:
    """The keys of a type of wheel, as fields, with ``type`` and ``catalogue``."""
    fields = {f.metadata.get("key", f.name): f for f in dataclasses.fields(TYPES[kind]) if f.metadata and f.name != "name"}
    return {**fields, "type": _word(tuple(TYPES)), "catalogue": _word(tuple(catalogue()))}


def _word(choices: tuple[str, ...]) -> Any:
    return dataclasses.field(default=None, metadata={"choices": choices, "doc": ""})


def _number(text: str, count: int, what: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= count:
        raise DesignError(f"there is no {what} {text[:60]!r}; this design has {count}, counted from 1")
    return int(text) - 1


def _at(data: Any, place: Place) -> Any:
    for part in place:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def _base(meta, data, place: Place, default) -> Any:
    if place[0] == "wheels":
        table = data["wheels"][place[1]]
        entry = catalogue().get(table.get("catalogue", ""))
        data = {"wheels": {place[1]: table if entry is None else entry.merged(table)}}
    found = _at(data, place)
    return default if found is None else _read(meta, found, place)


def _read(meta, value: Any, place: Place) -> Any:
    name = str(place[-1])
    if "unit" in meta:
        return read_quantity(value, meta, meta["shape"], name)
    if "least" in meta:
        return read_whole(value, meta)
    if "flag" in meta:
        return read_flag(value)
    if "inertia" in meta:
        return read_inertia(value)
    if "items" in meta:
        raise DesignError("takes a path into one of its entries, such as closure.springs.1.stiffness")
    return read_word(value, meta.get("choices", ()))


def assigned(data: Mapping[str, Any], values: Iterable[tuple[DesignPath, Any]]) -> dict[str, Any]:
    """``data`` with each value, SI, put at its path; what is not touched is shared."""
    out: dict[str, Any] = dict(data)
    for path, value in values:
        for place in path.places:
            if place[0] == "wheels" and place[2] in ("type", "catalogue"):
                out["wheels"] = {**out["wheels"], place[1]: _other_wheel(out["wheels"][place[1]], str(place[2]), value)}
            else:
                out = _put(out, place, value, path.meta)
    return out


def _put(node: Any, place: Place, value: Any, meta: Mapping[str, Any]) -> Any:
    """A copy of ``node`` with ``value`` at ``place``."""
    if not place:
        return value
    key, *rest = place
    if isinstance(key, int):
        # A vector that the file leaves out is zero.
        entries = list(node) if node else [0.0, 0.0, 0.0]
        return [_put(e, tuple(rest), value, meta) if i == key else e for i, e in enumerate(entries)]
    table = dict(node or {})
    table[key] = _put(table.get(key), tuple(rest), value, meta)
    return table


def _other_wheel(table: Mapping[str, Any], key: str, value: str) -> dict[str, Any]:
    """A wheel's table for another type or part: what the new one does not have, or says itself, is left out."""
    entry = catalogue()[value] if key == "catalogue" else None
    kind = value if entry is None else (entry.type or table.get("type"))
    known = wheel_keys(str(kind)) if kind else {}
    said = {} if entry is None else entry.keys
    kept = {k: v for k, v in table.items() if k in known and k not in said and k not in ("type", "catalogue")}
    return {**({} if entry is not None and entry.type else {"type": kind}), **kept, **({key: value} if entry else {})}
