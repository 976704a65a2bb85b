"""Room, mass and price: what a layout takes before anything moves.

A wheel is a cylinder of its radius about its axle. Half its width reaches from the middle to the outer end of its outer
race's rollers; a wheel whose rollers are not described is a thin disc.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.io.study import Metric
from spheredrive.shape import nominal_height, roller
from spheredrive.studies.sweep.columns import Columns
from spheredrive.studies.sweep.metrics.base import Conditions, Family, Found, Machines, known, nowhere, one_by_one
from spheredrive.studies.sweep.metrics.gaps import Cylinders, cylinder_gap, free_cone
from spheredrive.wheels import RollerWheel, Wheel

if TYPE_CHECKING:
    from spheredrive.design import Design

METRICS = (
    Metric("clearance", "m", "least distance between two wheels as cylinders; negative where they overlap"),
    Metric("opening", "rad", "half angle of the widest cone about +z from the sphere's centre that is free of wheels"),
    Metric("mass", "kg", "mass of sphere, wheels and, where it is given, stage"),
    Metric("price", "", "sum of the wheels' prices as the study gives them"),
)
ALONE = "one wheel alone has no clearance"
NO_MASS = "needs sphere.mass and a mass of every wheel model"


def measure(machines: Machines, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    """The metrics ``names`` of a batch."""
    c = machines.columns
    found: dict[str, Found] = {}
    if {"clearance", "opening"} & set(names):
        bodies = wheel_bodies(c)
        if "clearance" in names:
            found["clearance"] = nowhere(len(c), ALONE) if len(bodies) < 2 else known(_clearance(bodies))
        if "opening" in names:
            found["opening"] = known(free_cone(_joined(bodies)).reshape(len(bodies), -1).min(axis=0))
    if "mass" in names:
        found["mass"] = _mass(c)
    if "price" in names:
        designs = machines.designs
        assert designs is not None, "whole designs were asked for"
        found["price"] = one_by_one(len(c), lambda i: _price(designs[i], dict(conditions.prices)))
    return {name: found[name] for name in names}


def wheel_bodies(c: Columns) -> list[Cylinders]:
    """The wheels of b machines, each as b cylinders; the second halves of split wheels are bodies of their own."""
    bodies = []
    for w in range(c.wheel_count):
        R_hat = c.contact_direction[:, w]
        axis = np.cross(R_hat, c.drive_direction[:, w])
        heights, halves, antipodal = _sizes(c, w)
        for sign in (1.0, -1.0) if antipodal else (1.0,):
            centre = sign * (c.sphere_radius + heights)[:, None] * R_hat
            bodies.append(Cylinders(centre, axis, c.wheel_radius[:, w], halves))
    return bodies


def _sizes(c: Columns, w: int) -> tuple[np.ndarray, np.ndarray, bool]:
    """Height of wheel w's axle above the sphere and half its width, (b,); whether it has a second half opposite."""
    keys = np.stack([c.wheel_index[:, w], c.wheel_radius[:, w], c.roller_angle[:, w], c.sphere_radius], axis=1)
    distinct, inverse = np.unique(keys, axis=0, return_inverse=True)
    sizes, antipodal = np.zeros((len(distinct), 2)), False
    for k, (number, radius, tilt, R) in enumerate(distinct.tolist()):
        wheel = c.wheels[int(number)]
        if (wheel.radius, wheel.roller_angle) != (radius, tilt):
            wheel = replace(wheel, radius=radius, roller_angle=tilt)
        races = wheel.races(R)
        antipodal = any(race.antipodal for race in races)
        nearest = min((race for race in races if not race.antipodal), key=lambda race: abs(race.offset))
        sizes[k] = nominal_height(nearest, R), half_width(wheel, R)
    return *sizes[inverse.reshape(-1)].T, antipodal


def half_width(wheel: Wheel, sphere_radius: float) -> float:
    """From the wheel's middle to the outer end of its rollers, m; zero where these are not described."""
    if not isinstance(wheel, RollerWheel):
        return 0.0
    found = 0.0
    for race in wheel.races(sphere_radius):
        try:
            body = roller(wheel, race)
            reach = float(body.radius(0.0)) * abs(body.sine) + body.half_length * abs(body.cosine)
        except DesignError:
            reach = wheel.roller_section
        found = max(found, abs(race.offset) + reach)
    return found


def _joined(bodies: list[Cylinders]) -> Cylinders:
    return Cylinders(*(np.concatenate(arrays) for arrays in zip(*bodies, strict=True)))


def _clearance(bodies: list[Cylinders]) -> np.ndarray:
    """Least gap of any two, (b,); pairs that are surely farther apart than some other pair are not looked at."""
    b, m = len(bodies[0].radius), len(bodies)
    first, second = np.triu_indices(m, 1)
    centre = np.stack([body.centre for body in bodies])
    ball = np.stack([np.hypot(body.radius, body.half) for body in bodies])
    apart = np.linalg.norm(centre[first] - centre[second], axis=2)
    least = apart - ball[first] - ball[second]
    pair, row = np.nonzero(least <= apart.min(axis=0))
    whole = _joined(bodies)
    gap = cylinder_gap(whole.take(first[pair] * b + row), whole.take(second[pair] * b + row))
    found = np.full(b, np.inf)
    np.minimum.at(found, row, gap)
    return found


def _mass(c: Columns) -> Found:
    if c.sphere_mass is None or c.wheel_mass is None:
        return nowhere(len(c), NO_MASS)
    return known(c.sphere_mass + c.wheel_mass.sum(axis=1) + (c.design.stage.mass or 0.0))


def _price(design: Design, prices: Mapping[str, float]) -> float:
    models = tomllib.loads(design.source).get("wheels", {})
    total = 0.0
    for wheel in design.wheels:
        part = models.get(wheel.name, {}).get("catalogue")
        price = prices.get(wheel.name, prices.get(part))
        if price is None:
            known_as = f"wheels.{wheel.name}" if part is None else part
            raise SpheredriveError(f"no price of {known_as} is given; add it to the table [prices] of the study")
        total += price
    return total


def _whole(conditions: Conditions, names: tuple[str, ...]) -> bool:
    return "price" in names


FAMILY = Family(METRICS, measure, _whole, lambda conditions, names: 4096)
