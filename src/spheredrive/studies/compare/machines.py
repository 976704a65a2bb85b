"""The machines of a comparison: designs as they are, or one design with other wheels at its places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from spheredrive.design import Design
from spheredrive.errors import DesignError
from spheredrive.io.catalogue import part


@dataclass(frozen=True)
class Machine:
    """One machine of a comparison.

    name      what it is called
    design    None where it cannot be built for lack of a figure
    missing   the sentence that says what is missing, else empty
    note      what was taken for granted, else empty
    """

    name: str
    design: Design | None
    missing: str = ""
    note: str = ""


def machine(design: Design, name: str = "") -> Machine:
    """A design as it is, called by its own name if no other is given."""
    return Machine(name or design.name, design)


def machines(designs: Mapping[str, Design], parts: Iterable[str] = ()) -> list[Machine]:
    """The machines of ``designs``, by the path of each, and of the first design with each of ``parts``.

    Designs of one name are told apart by their paths. Raises ``UnknownNameError`` for parts that the catalogue does not have.
    """
    names = Counter(design.name for design in designs.values())
    own = [machine(d, f"{d.name} ({path})" if names[d.name] > 1 else "") for path, d in designs.items()]
    first = next(iter(designs.values()))
    return own + [with_part(first, name) for name in parts]


def with_part(design: Design, name: str) -> Machine:
    """``design`` with each of its wheels replaced by the part ``maker/part`` of the catalogue, at the same places.

    What nothing published gives stays unknown: a figure without which there is no wheel makes a machine that says so. A mass
    that is not published is that of the wheel which the part replaces. Raises ``UnknownNameError`` for a name that the
    catalogue does not have.
    """
    chosen = part(name)
    given = {} if chosen.mass is not None else {"mass": design.wheels[0].mass}
    unknown = chosen.mass is None and design.wheels[0].mass is not None
    note = f"mass not published: {design.wheels[0].mass:g} kg, as of the wheel it replaces" if unknown else ""
    try:
        wheel = chosen.wheel(**(given if unknown else {}))
        placements = tuple(replace(place, wheel=wheel) for place in design.placements)
        return Machine(name, replace(design, name=f"{design.name}, {name}", placements=placements, source=""), "", note)
    except DesignError as error:
        return Machine(name, None, error.rule)
