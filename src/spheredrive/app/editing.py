"""A design with one thing changed: what a slider asks for, as a new design. No browser in it.

Wheels that stand in a ring are changed together; others one by one. A wheel model is changed wherever it stands.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from spheredrive.design import Design, Placement
from spheredrive.errors import DesignError
from spheredrive.wheels import TYPES, MeasuredWheel, RollerWheel, Wheel

# Angles this close (rad) are those of one ring: rounding of the directions they come from.
SAME = 1e-9


class Ring(NamedTuple):
    """``count`` wheels of one model spread evenly over a circle, the first at ``azimuth``; angles in rad."""

    wheel: Wheel
    count: int
    azimuth: float
    elevation: float
    heading: float

    def placements(self, number: int) -> list[Placement]:
        """Its wheels, as the ``number``-th entry of a design file, from 1."""
        step = 2 * math.pi / self.count
        places = [(self.azimuth + step * i, self.elevation, self.heading) for i in range(self.count)]
        return [Placement.at(self.wheel, *place, ring=number) for place in places]


def rings(design: Design) -> list[Ring]:
    """The design's wheels as rings, in their order; a wheel that is in none is a ring of one."""
    return [ring for ring, _ in _parts(design)]


def edited(design: Design, ring: int, key: str, value: Any, remembered: Mapping[str, Any] | None = None) -> Design:
    """``design`` with one value changed, SI.

    key   "count", "azimuth", "elevation" or "heading" of the ring of that index; "type" of its wheel model, or one of the
          model's own keys; else a path into the design such as "sphere.radius" or "contact.stiffness"
    remembered   what keys were before, for a change of type that needs them again

    Raises ``DesignError`` where no machine can have it. Other wheels stay as they are.
    """
    if "." in key:
        part, name = key.split(".")
        return dataclasses.replace(design, **{part: dataclasses.replace(getattr(design, part), **{name: value})})
    standing = _parts(design)
    chosen = standing[ring][0]
    if key in ("count", "azimuth", "elevation", "heading"):
        return dataclasses.replace(design, placements=_replaced(standing, ring, chosen._replace(**{key: value})))
    old = chosen.wheel
    try:
        new = of_type(old, value, remembered) if key == "type" else dataclasses.replace(old, **{key: value})
    except DesignError as error:
        raise error.under("wheels", old.name) from None
    placements = tuple(dataclasses.replace(p, wheel=new) if p.wheel == old else p for p in design.placements)
    return dataclasses.replace(design, placements=placements)


def of_type(wheel: Wheel, kind: str, remembered: Mapping[str, Any] | None = None) -> Wheel:
    """A wheel of another type with as much of ``wheel`` as the type has keys for.

    What is missing is taken from ``remembered``, else a usual share of the radius. The roller angle is the type's own.
    """
    if kind == wheel.type:
        return wheel
    new = TYPES[kind]
    if new is MeasuredWheel:
        raise DesignError("a measured outline comes from a file; write it into the design file", ("type",))
    known = {**usual(wheel.radius or 0.0, new), **dict(remembered or {}), **_given(wheel)}
    fields = {field.name: known[field.name] for field in dataclasses.fields(new) if known.get(field.name) is not None}
    fields["roller_angle"] = next(field.default for field in dataclasses.fields(new) if field.name == "roller_angle")
    if issubclass(new, RollerWheel):
        races = new.race_count
        fields["rollers"] = max(3 * races, round(fields.get("rollers", 12) / races) * races)
    return new(**fields)


def usual(radius: float, kind: type[Wheel]) -> dict[str, Any]:
    """Values for the keys that a wheel type cannot be drawn without, as wheels of ``radius`` usually have them."""
    turns = 8 * getattr(kind, "race_count", 1)
    found: dict[str, Any] = {"rollers": turns, "roller_radius": round(0.19 * radius, 5), "race_spacing": round(0.5 * radius, 5)}
    return {**found, "roundness": 0.3} if kind.type == "standard" else found


def _given(wheel: Wheel) -> dict[str, Any]:
    return {field.name: getattr(wheel, field.name) for field in dataclasses.fields(wheel)}


def _parts(design: Design) -> list[tuple[Ring, list[Placement]]]:
    """``rings``, each with its wheels as they stand."""
    found: list[tuple[Ring, list[Placement]]] = []
    for group in _groups(design):
        whole = _ring(group)
        found += [(whole, group)] if whole else [(_alone(placement), [placement]) for placement in group]
    return found


def _replaced(standing: list[tuple[Ring, list[Placement]]], index: int, ring: Ring) -> tuple[Placement, ...]:
    """All wheels with those of one ring replaced; the others keep every bit, and each ring has its own number."""
    placements: list[Placement] = []
    for i, (_, group) in enumerate(standing):
        number = i + 1
        if i == index:
            placements += ring.placements(number)
        else:
            placements += [p if p.ring == number else dataclasses.replace(p, ring=number) for p in group]
    return tuple(placements)


def _groups(design: Design) -> list[list[Placement]]:
    groups: list[list[Placement]] = []
    for placement in design.placements:
        if groups and groups[-1][0].ring == placement.ring and groups[-1][0].wheel == placement.wheel:
            groups[-1].append(placement)
        else:
            groups.append([placement])
    return groups


def _alone(placement: Placement) -> Ring:
    return Ring(placement.wheel, 1, *(_settled(angle) for angle in placement.azimuth_elevation_heading))


def _ring(group: list[Placement]) -> Ring | None:
    """The ring that ``group`` is, or None."""
    whole = _alone(group[0])._replace(count=len(group))
    for made, given in zip(whole.placements(1), group, strict=True):
        pairs = ((made.contact_direction, given.contact_direction), (made.drive_direction, given.drive_direction))
        if any(math.dist(one, other) > SAME for one, other in pairs):
            return None
    return whole


def _settled(angle: float) -> float:
    """An angle without the rounding of the direction it was found from: the nearest to a millionth of a degree."""
    rounded = math.radians(round(math.degrees(angle), 6))
    return rounded if abs(rounded - angle) < 1e-12 else angle
