"""Tables that stand in files but are no values of their own: rings of wheels, and the parts of a motion file.

Declared like the value classes, so that their keys are read in the same way.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from spheredrive import motion
from spheredrive.values import quantity, whole, word

# A shape of (None,) is a list of any length.
MANY = (None,)


def rows(doc: str, *, default: Any = dataclasses.MISSING) -> Any:
    """A field holding rows of numbers whose unit depends on another key."""
    return dataclasses.field(default=default, metadata={"numbers": True, "doc": doc})


@dataclass(frozen=True)
class Ring:
    """Wheels spread evenly over a circle, counted anticlockwise from the first."""

    count: int = whole("number of wheels in the ring", least=1, most=1000)
    elevation: float = quantity("rad", "of the contact above the equator, negative below", sign="any")
    azimuth: float = quantity("rad", "of the first wheel, anticlockwise from x", sign="any", default=0.0)
    heading: float = quantity("rad", "of the drive direction, from east towards north", sign="any", default=0.0)
    wheel: str | None = word("name of the wheel model; may be left out where there is one", default=None)


@dataclass(frozen=True)
class Vectors:
    """One wheel by two directions, of any length, perpendicular to each other."""

    contact: tuple = quantity("", "from the sphere's centre to the contact", sign="any", shape=(3,))
    drive: tuple = quantity("", "in which the wheel's surface moves at the contact", sign="any", shape=(3,))
    wheel: str | None = word("name of the wheel model; may be left out where there is one", default=None)


@dataclass(frozen=True)
class Motion:
    """What is prescribed: values over time, in the file or in a CSV file."""

    kind: str = word("what is prescribed", motion.KINDS)
    interpolation: str = word("how values run between times", ("linear", "step"), default="linear")
    duration: float | None = quantity("s", "how long the motion lasts; to the last time if absent", default=None)
    time: tuple | None = quantity("s", "times, rising", sign="any", shape=MANY, default=None)
    values: Any = rows("one row a time; one column a wheel, or x, y, z; SI", default=None)
    file: str | None = word("CSV file with the times and values, beside this file", default=None)


@dataclass(frozen=True)
class Initial:
    """The state at the start."""

    angular_velocity: tuple | None = quantity("rad/s", "of the sphere, inertial frame", sign="any", shape=(3,), default=None)
    wheel_angle: tuple | None = quantity("rad", "one a wheel", sign="any", shape=MANY, default=None)
    orientation: tuple | None = quantity(
        "", "unit quaternion, scalar first, body to inertial", sign="any", shape=(4,), default=None
    )
    centre_displacement: tuple | None = quantity(
        "m", "of the sphere's centre, compliant model; its static seat if absent", sign="any", shape=(3,), default=None
    )
    centre_velocity: tuple | None = quantity(
        "m/s", "of the sphere's centre, compliant model", sign="any", shape=(3,), default=None
    )


@dataclass(frozen=True)
class Stage:
    """What moves the stage: a force beyond the weight it carries, N, or its position, m."""

    kind: str = word("what is given", ("force", "position"))
    time: tuple = quantity("s", "times, rising", sign="any", shape=MANY)
    values: Any = rows("one row a time: x, y, z; SI")
    interpolation: str = word("how values run between times", ("linear", "step"), default="linear")


@dataclass(frozen=True)
class Output:
    """What the results hold."""

    sample_rate: float = quantity("Hz", "samples a second", default=1000.0)
