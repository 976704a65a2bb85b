"""Steady vibration at constant wheel speeds, and natural frequencies, of the coupled linear model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.design import Design, Mount
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.io.study import Metric
from spheredrive.studies.sweep.columns import Columns
from spheredrive.studies.sweep.metrics.base import Conditions, Family, Found, Machines, nowhere, one_by_one, unless

if TYPE_CHECKING:
    from spheredrive.shape import Profile

ORDERS = ("displacement", "velocity", "acceleration")
_UNITS = dict(zip(ORDERS, ("m", "m/s", "m/s^2"), strict=True))
METRICS = (
    Metric("natural_frequency_min", "Hz", "lowest natural frequency"),
    Metric("natural_frequency_max", "Hz", "highest natural frequency"),
    *(Metric(f"rms_{k}", _UNITS[k], f"RMS {k} of the sphere's centre at constant wheel speeds", ("speeds",)) for k in ORDERS),
    *(Metric(f"peak_{k}", _UNITS[k], f"peak {k} of the sphere's centre at constant wheel speeds", ("speeds",)) for k in ORDERS),
    Metric("comfort", "m/s^2", "weighted RMS acceleration of ISO 2631-1 at constant wheel speeds", ("speeds",)),
)
NO_MASS = "vibration needs sphere.mass"
NO_WHEEL_MASS = "wheels on compliant mounts vibrate by their mass: give every wheel model a mass"
RIGID = "the contacts are rigid; vibration of many designs needs contact.stiffness above zero"
RESONANT = "a harmonic of a wheel hits an undamped natural frequency: the motion grows without end"
STATUS = {
    "UNHELD": "nothing holds the sphere in some direction: it has no seat to vibrate about",
    "RESONANT": RESONANT,
    "CRAWLING": "a wheel turns so slowly that the undamped machine swings too often while one of its rollers passes",
}


def measure(machines: Machines, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    """The metrics ``names`` of a batch."""
    c = machines.columns
    found: dict[str, Found] = {}
    lacking = _lacking(c, conditions)
    if lacking:
        return {name: nowhere(len(c), lacking) for name in names}
    if "comfort" in names:
        found["comfort"] = _comfort(machines, conditions)
    others = tuple(name for name in names if name != "comfort")
    return {**found, **(_steady(c, conditions, others) if others else {})}


def _lacking(c: Columns, conditions: Conditions) -> str:
    if len(conditions.speeds) not in (0, 1, c.wheel_count):
        return f"the study gives {len(conditions.speeds)} speeds for {c.wheel_count} wheels"
    if c.sphere_mass is None:
        return NO_MASS
    if c.mount_stiffness is not None and c.wheel_mass is None:
        return NO_WHEEL_MASS
    return RIGID if c.contact_stiffness is None else ""


def _speeds(c: Columns, conditions: Conditions) -> np.ndarray:
    return np.broadcast_to(np.array(conditions.speeds or (0.0,)), (c.wheel_count,))


def _steady(c: Columns, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    from spheredrive.vibration.motion import batch

    shapes, index, shapeless, sentences = _profiles(c)
    rigid = ~(c.contact_stiffness > 0)  # type: ignore[operator]
    fit = np.flatnonzero(~rigid & (shapeless == 0))
    whys = [(rigid, RIGID), *((shapeless == k, sentence) for k, sentence in enumerate(sentences, 1))]
    if not len(fit):
        return {name: unless(np.zeros(len(c)), *whys) for name in names}
    orders = tuple(k for k in ORDERS if any(name.endswith(f"_{k}") for name in names)) or ORDERS[:1]
    peaks = any(name.startswith("peak_") for name in names)
    stats = batch.steady_statistics(
        _representative(c), _speeds(c, conditions), peaks=peaks, of=orders, profiles=shapes, **_varied(c, fit, index)
    )
    status = np.full(len(c), -1)
    status[fit] = stats.status
    whys += [(status == getattr(batch, code), sentence) for code, sentence in STATUS.items()]

    def picked(name: str) -> np.ndarray:
        if name.startswith("natural"):
            return stats.natural_frequencies[:, 0 if name.endswith("min") else -1]
        return getattr(stats, name)

    found = {}
    for name in names:
        values = np.zeros(len(c))
        values[fit] = picked(name)
        found[name] = unless(values, *whys)
    return found


def _representative(c: Columns) -> Design:
    """A design that says of all machines whether contacts and mounts give way."""
    if c.mount_stiffness is None:
        return c.design
    return replace(c.design, mount=Mount(float(c.mount_stiffness[0]), c.design.mount.damping))


def _varied(c: Columns, fit: np.ndarray, index: np.ndarray) -> dict[str, np.ndarray]:
    """What ``steady_statistics`` is told of the machines ``fit``."""
    from spheredrive.vibration.model.equations import contacts_of

    contacts = contacts_of(c.design)
    wheel = contacts.wheel
    # A split wheel's second contact is opposite its first.
    side = np.where(np.einsum("mi,mi->m", contacts.normal, c.design.contact_directions[wheel]) > 0, -1.0, 1.0)
    share = 1 / np.bincount(wheel)[wheel]
    varied: dict[str, np.ndarray] = {
        "sphere_mass": c.sphere_mass[fit],  # type: ignore[index]
        "contact_stiffness": c.contact_stiffness[fit],  # type: ignore[index]
        "contact_damping": c.contact_damping[fit],
        "closure_stiffness": c.closure_stiffness[fit],
        "closure_damping": c.closure_damping[fit],
        "contact_direction": side[:, None] * c.contact_direction[fit][:, wheel],
        "profile_index": index[fit],
    }
    if c.mount_stiffness is not None:
        varied["mount_stiffness"], varied["mount_damping"] = c.mount_stiffness[fit], c.mount_damping[fit]
        varied["wheel_mass"] = c.wheel_mass[fit][:, wheel] * share  # type: ignore[index]
    return varied


def _profiles(c: Columns) -> tuple[tuple[Profile, ...], np.ndarray, np.ndarray, tuple[str, ...]]:
    """Distinct outlines, the number of each contact's among them (b, m); which machines lack one (b,), and why."""
    from spheredrive.shape import profile
    from spheredrive.vibration.model.equations import contacts_of

    contacts = contacts_of(c.design)
    shapes: dict[Profile, int] = {}
    sentences: dict[str, int] = {}
    index = np.zeros((len(c), len(contacts.wheel)), np.int64)
    shapeless = np.zeros(len(c), np.int64)
    for k, (w, race) in enumerate(zip(contacts.wheel, contacts.race, strict=True)):
        keys = np.stack([c.wheel_index[:, w], c.wheel_radius[:, w], c.roller_angle[:, w], c.sphere_radius], axis=1)
        distinct, inverse = _distinct(keys)
        numbers, reasons = np.zeros(len(distinct), np.int64), np.zeros(len(distinct), np.int64)
        for i, (number, radius, tilt, sphere_radius) in enumerate(distinct.tolist()):
            wheel = c.wheels[int(number)]
            if (wheel.radius, wheel.roller_angle) != (radius, tilt):
                wheel = replace(wheel, radius=radius, roller_angle=tilt)
            try:
                numbers[i] = shapes.setdefault(profile(wheel, sphere_radius, race=race), len(shapes))
            except (DesignError, SpheredriveError) as error:
                reasons[i] = sentences.setdefault(str(error), len(sentences) + 1)
        index[:, k] = numbers[inverse]
        shapeless = np.where(shapeless == 0, reasons[inverse], shapeless)
    return tuple(shapes), index, shapeless, tuple(sentences)


def _distinct(keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct rows, and which of them each row is."""
    if (keys == keys[0]).all():
        # Nearly always so, and much quicker to see than to sort.
        return keys[:1], np.zeros(len(keys), np.int64)
    distinct, inverse = np.unique(keys, axis=0, return_inverse=True)
    return distinct, inverse.reshape(-1)


def _comfort(machines: Machines, conditions: Conditions) -> Found:
    from spheredrive.vibration import assess

    designs, speeds = machines.designs, _speeds(machines.columns, conditions)
    assert designs is not None, "whole designs were asked for"

    def total(i: int) -> float:
        moved = assess(designs[i], speeds).sphere
        if moved is None:
            raise SpheredriveError(RESONANT)
        return moved.comfort.total

    return one_by_one(len(designs), total)


def _whole(conditions: Conditions, names: tuple[str, ...]) -> bool:
    return "comfort" in names


FAMILY = Family(METRICS, measure, _whole, lambda conditions, names: 128 if _whole(conditions, names) else 4096)
