"""Wheel speeds and isolators as they are typed at a command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.io.quantity import parse, parse_list

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.vibration.aboard.isolation import ChosenIsolator
    from spheredrive.vibration.model.equations import Isolator


def parse_speeds(text: str, wheel_count: int) -> np.ndarray:
    """``"0.1 1.2 0.9 rad/s"``, or one speed for all wheels, as (n,), rad/s; ``SpheredriveError`` for anything else."""
    try:
        speeds = parse_list(text, "rad/s", "--speeds")
    except DesignError as error:
        raise SpheredriveError(f"--speeds: {error}") from None
    if len(speeds) not in (1, wheel_count):
        raise SpheredriveError(
            f"--speeds takes one speed for each of the {wheel_count} wheels, or one for all, but {len(speeds)} are given"
        )
    return np.full(wheel_count, speeds[0]) if len(speeds) == 1 else np.array(speeds)


def parse_isolation(
    design: Design, wheel_speed, payload: str | None, isolator: str | None, damping: float | None, wanted: str | None
) -> tuple[Isolator | None, ChosenIsolator | None]:
    """The springs of a payload, and the isolator that was sought where a ``wanted`` acceleration asks for one; None without.

    ``payload`` a mass, ``isolator`` a natural frequency, ``wanted`` an acceleration, all with their units; ``damping`` a ratio,
    0.1 if absent. Raises ``SpheredriveError`` where they do not go together, and as ``vibration.isolator_for_design``.
    """
    from spheredrive.vibration.aboard.payload import isolator_for_design, isolator_of_frequency

    if payload is None:
        if (isolator, damping, wanted) != (None, None, None):
            raise SpheredriveError('an isolator carries a payload: add --payload, such as --payload "80 kg"')
        return None, None
    if (isolator is None) == (wanted is None):
        raise SpheredriveError(
            "a payload takes either --isolator, the natural frequency of what carries it, or --wanted, the acceleration it may "
            "have; a payload fixed to the sphere is in sphere.mass already"
        )
    mass, zeta = parse(payload, "kg", "--payload", "positive"), 0.1 if damping is None else damping
    if isolator is not None:
        return isolator_of_frequency(mass, parse(isolator, "Hz", "--isolator", "positive"), zeta), None
    assert wanted is not None, "one of the two is given"
    chosen = isolator_for_design(design, wheel_speed, mass, parse(wanted, "m/s^2", "--wanted", "positive"), zeta)
    if np.isinf(chosen.natural_frequency):
        return None, chosen
    return isolator_of_frequency(mass, chosen.natural_frequency, zeta), chosen
