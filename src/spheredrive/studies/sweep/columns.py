"""A batch of machines as arrays, one entry a machine: what kernels work on, without a value for each machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.wheels.base import Wheel


@dataclass(frozen=True, eq=False)
class Columns:
    """b machines of n wheels each, SI; None stands for what none of them gives.

    design             one of them: what is the same in all, such as the types of the wheels, springs and gravity
    contact_direction, drive_direction   R̂ and v̂ of each wheel, (b, n, 3)
    wheels             distinct wheel models; ``wheel_index`` (b, n) says which stands where, and what follows overrides it
    wheel_radius, roller_angle, wheel_mass   of each wheel, (b, n)
    closure_force      (b, 3); all others (b,)
    """

    design: Design
    wheels: tuple[Wheel, ...]
    wheel_index: np.ndarray
    contact_direction: np.ndarray
    drive_direction: np.ndarray
    wheel_radius: np.ndarray
    roller_angle: np.ndarray
    wheel_mass: np.ndarray | None
    sphere_radius: np.ndarray
    sphere_mass: np.ndarray | None
    contact_stiffness: np.ndarray | None
    contact_damping: np.ndarray
    friction: np.ndarray | None
    mount_stiffness: np.ndarray | None
    mount_damping: np.ndarray
    closure_stiffness: np.ndarray
    closure_damping: np.ndarray
    closure_force: np.ndarray
    motor_torque: np.ndarray | None

    def __len__(self) -> int:
        return len(self.sphere_radius)

    @property
    def wheel_count(self) -> int:
        """n."""
        return self.wheel_index.shape[1]

    def repeated(self, count: int) -> Columns:
        """The one machine in here ``count`` times, in arrays of their own."""
        return replace(self, **{name: np.repeat(getattr(self, name), count, axis=0) for name in self._arrays()})

    def _arrays(self) -> list[str]:
        return [f.name for f in fields(self) if isinstance(getattr(self, f.name), np.ndarray)]


def columns_of(designs: Sequence[Design]) -> list[tuple[np.ndarray, Columns]]:
    """Designs as columns, those together that can be: the places they had among ``designs``, and their columns."""
    singles = [_single(design) for design in designs]
    return joined([(np.array([i]), one) for i, one in enumerate(singles)])


def joined(parts: Sequence[tuple[np.ndarray, Columns]]) -> list[tuple[np.ndarray, Columns]]:
    """Columns of machines that differ in numbers and wheel models alone made one; each with the rows it stands for."""
    alike: dict[Any, list[tuple[np.ndarray, Columns]]] = {}
    for rows, one in parts:
        alike.setdefault(_kind(one), []).append((rows, one))
    return [_stacked(group) for group in alike.values()]


def _single(design: Design) -> Columns:
    wheels = tuple({id(w): w for w in design.wheels}.values())
    number = {id(w): k for k, w in enumerate(wheels)}
    masses = [wheel.mass for wheel in design.wheels]

    def one(value) -> np.ndarray | None:
        return None if value is None else np.array([value], float)

    columns: dict[str, Any] = {
        "wheel_index": np.array([[number[id(w)] for w in design.wheels]]),
        "contact_direction": design.contact_directions[None],
        "drive_direction": design.drive_directions[None],
        "wheel_radius": design.wheel_radii[None],
        "roller_angle": np.array([[w.roller_angle for w in design.wheels]]),
        "wheel_mass": None if None in masses else np.array([masses], float),
        "sphere_radius": one(design.sphere.radius),
        "sphere_mass": one(design.sphere.mass),
        "contact_stiffness": one(design.contact.stiffness),
        "contact_damping": one(design.contact.damping),
        "friction": one(design.contact.friction),
        "mount_stiffness": one(design.mount.stiffness),
        "mount_damping": one(design.mount.damping),
        "closure_stiffness": one(design.closure.stiffness),
        "closure_damping": one(design.closure.damping),
        "closure_force": np.array([design.closure.force], float),
        "motor_torque": one(design.motor.torque),
    }
    return Columns(design=design, wheels=wheels, **columns)


def _kind(one: Columns) -> Any:
    """What machines must share to stand in the same columns."""
    design = one.design
    sides = tuple(tuple((r.number, r.antipodal) for r in design.races(w)) for w in design.wheels)
    absent = tuple(f.name for f in fields(one) if getattr(one, f.name) is None)
    return sides, tuple(len(w.alternation) for w in design.wheels), absent, design.closure.springs, design.stage.gravity


def _stacked(parts: list[tuple[np.ndarray, Columns]]) -> tuple[np.ndarray, Columns]:
    rows, first = parts[0]
    if len(parts) == 1:
        return rows, first
    wheels: dict[Wheel, int] = {}
    index = []
    for _, one in parts:
        numbers = np.array([wheels.setdefault(w, len(wheels)) for w in one.wheels])
        index.append(numbers[one.wheel_index])
    arrays = {
        name: np.concatenate([getattr(one, name) for _, one in parts]) for name in first._arrays() if name != "wheel_index"
    }
    columns = replace(first, wheels=tuple(wheels), wheel_index=np.concatenate(index), **arrays)
    return np.concatenate([rows for rows, _ in parts]), columns
