"""Wheel types, one a file. To change a wheel type, change its file; to add one, add a file and its line here."""

from spheredrive.wheels.base import Race, RollerWheel, Wheel
from spheredrive.wheels.dual_race import DualRaceWheel
from spheredrive.wheels.ideal import IdealWheel
from spheredrive.wheels.measured import MeasuredWheel
from spheredrive.wheels.mecanum import MecanumWheel
from spheredrive.wheels.split_dual_race import SplitDualRaceWheel
from spheredrive.wheels.standard import StandardWheel
from spheredrive.wheels.triple_race import TripleRaceWheel

TYPES: dict[str, type[Wheel]] = {
    wheel.type: wheel
    for wheel in (
        IdealWheel,
        StandardWheel,
        DualRaceWheel,
        SplitDualRaceWheel,
        TripleRaceWheel,
        MecanumWheel,
        MeasuredWheel,
    )
}

__all__ = ["TYPES", "Race", "RollerWheel", "Wheel", *(wheel.__name__ for wheel in TYPES.values())]
