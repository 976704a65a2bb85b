"""Contacts and their constraint rows: A Ω = B ω, one row a contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.frames import rotation_matrix

if TYPE_CHECKING:
    from spheredrive.design import Design

# Active races of each wheel: a race number, or several where they touch together. None stands for nominal contacts.
Races = Sequence["int | Sequence[int]"] | None


@dataclass(frozen=True)
class Contacts:
    """The m contacts of one contact state.

    wheel               index of the contact's wheel, from 0, (m,)
    race                number of its race, from 1; 0 for a nominal contact, (m,)
    contact_direction   R̂ of the contact itself, (m, 3)
    drive_direction     v̂, (m, 3)
    roller_angle        α with the hand of the contact, rad, (m,)
    wheel_radius        r at the contact, m, (m,)
    """

    wheel: np.ndarray
    race: np.ndarray
    contact_direction: np.ndarray
    drive_direction: np.ndarray
    roller_angle: np.ndarray
    wheel_radius: np.ndarray

    @property
    def induced_direction(self) -> np.ndarray:
        """Ω̂ = R̂ × v̂ [2.11], (m, 3)."""
        return np.cross(self.contact_direction, self.drive_direction)

    @property
    def slip_direction(self) -> np.ndarray:
        """û = sin α v̂ − cos α Ω̂: where a roller cannot give way, so friction and slip act along it (section 5a), (m, 3)."""
        alpha = self.roller_angle[:, None]
        return np.sin(alpha) * self.drive_direction - np.sin(alpha) * cotangent(alpha) * self.induced_direction


def cotangent(roller_angle) -> np.ndarray:
    """cot α, exactly zero at ±90°, where cos of the rounded angle is not."""
    roller_angle = np.asarray(roller_angle, float)
    square = np.abs(np.abs(roller_angle) - np.pi / 2) < 1e-15
    return np.where(square, 0.0, np.cos(roller_angle) / np.sin(roller_angle))


def constraint_row(contact_direction, drive_direction, roller_angle=np.pi / 2) -> np.ndarray:
    """The row a of one contact, a · Ω = (r / R) ω, shape (..., 3).

        a = Ω̂ + cot α v̂,   Ω̂ = R̂ × v̂

    ``contact_direction`` R̂ and ``drive_direction`` v̂ (..., 3) are perpendicular unit vectors; ``roller_angle`` α (...)
    in rad. Its length is 1/|sin α|. Assumes that the roller turns freely. Source: model.md section 2, [2.118].
    """
    R_hat = np.asarray(contact_direction, float)
    v_hat = np.asarray(drive_direction, float)
    return np.cross(R_hat, v_hat) + cotangent(roller_angle)[..., None] * v_hat


def contacts(design: Design, races: Races = None) -> Contacts:
    """The contacts of ``design`` while ``races`` touch the sphere; each wheel's nominal contact where ``races`` is None.

    ``races`` has one entry a wheel: a race number from 1, or several for races that touch together (``(1, 2, (1, 3))``).
    A race at offset o touches at R̂ cos Δθ + ŵ sin Δθ, ŵ = −R̂ × v̂; an antipodal one at −R̂, driving along −v̂ with
    rollers of the other hand. v̂ is the same for all races of a wheel [2.53]. Raises ``SpheredriveError`` for a race that
    the wheel does not have. Source: model.md section 1.
    """
    chosen = _chosen_races(design, races)
    rows = []
    for i, (placement, active) in enumerate(zip(design.placements, chosen, strict=True)):
        wheel = placement.wheel
        R_hat, v_hat = np.array(placement.contact_direction), np.array(placement.drive_direction)
        if active is None:
            rows.append((i, 0, R_hat, v_hat, wheel.roller_angle, wheel.radius))
            continue
        by_number = {race.number: race for race in design.races(wheel)}
        for number in active:
            race = by_number[number]
            if race.antipodal:
                rows.append((i, number, -R_hat, -v_hat, -wheel.roller_angle, race.radius))
                continue
            delta = race.deflection(design.sphere.radius)
            w_hat = -np.cross(R_hat, v_hat)
            direction = np.cos(delta) * R_hat + np.sin(delta) * w_hat
            rows.append((i, number, direction, v_hat, wheel.roller_angle, race.radius))
    wheel_index, race_number, R_hats, v_hats, alphas, radii = (np.array(column) for column in zip(*rows, strict=True))
    return Contacts(wheel_index, race_number, R_hats, v_hats, alphas, radii)


def constraint(design: Design, races: Races = None) -> tuple[np.ndarray, np.ndarray]:
    """Constraint matrices of A Ω = B ω: A (m, 3), B (m, n), without unit.

    Row i of A is Ω̂ + cot α v̂ of contact i; B holds r / R of the contact in the column of its wheel. ``races`` as in
    ``contacts``. Source: model.md section 2, [2.118–2.119].
    """
    c = contacts(design, races)
    A = constraint_row(c.contact_direction, c.drive_direction, c.roller_angle)
    B = np.zeros((len(c.wheel), design.wheel_count))
    B[np.arange(len(c.wheel)), c.wheel] = c.wheel_radius / design.sphere.radius
    return A, B


def equivalent_contact(contact_direction, drive_direction, angle, roller_angle=np.pi / 2) -> tuple[np.ndarray, np.ndarray]:
    """Another place for the same wheel with the same constraint row: the placement turned by ``angle`` (rad) about its row.

    Turning R̂ and v̂ together about a = Ω̂ + cot α v̂ moves the wheel along the great circle perpendicular to a and leaves
    a as it is, for rollers of any angle. At α = 90° that circle is the one perpendicular to Ω̂, and half a turn is the
    antipodal contact (−R̂, −v̂). Shapes (..., 3), (...). Returns R̂ and v̂. Source: model.md section 1.
    """
    row = constraint_row(contact_direction, drive_direction, roller_angle)
    turn = rotation_matrix(row / np.linalg.norm(row, axis=-1, keepdims=True), angle)
    R_hat, v_hat = np.asarray(contact_direction, float), np.asarray(drive_direction, float)
    return (turn @ R_hat[..., None])[..., 0], (turn @ v_hat[..., None])[..., 0]


def _chosen_races(design: Design, races: Races) -> list[tuple[int, ...] | None]:
    if races is None:
        return [None] * design.wheel_count
    entries = list(races)
    if len(entries) != design.wheel_count:
        raise SpheredriveError(f"races has {len(entries)} entries, but the design has {design.wheel_count} wheels")
    chosen: list[tuple[int, ...] | None] = []
    for i, entry in enumerate(entries):
        known = [race.number for race in design.races(design.wheels[i])]
        numbers = entry if isinstance(entry, (tuple, list, np.ndarray)) else (entry,)
        for number in numbers:
            if isinstance(number, (bool, np.bool_)) or number not in known:
                raise SpheredriveError(f"wheel {i + 1} has no race {number!r}; its races are {known}")
        active = tuple(int(number) for number in numbers)
        if not active or len(set(active)) != len(active):
            raise SpheredriveError(f"wheel {i + 1} needs at least one active race, each named once, not {entry}")
        chosen.append(active)
    return chosen
