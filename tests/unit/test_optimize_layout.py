"""Room between wheels and above the sphere, mass and price, against closed forms and another way to the same number."""

from dataclasses import replace

import numpy as np
import pytest

from spheredrive.design import Design, Placement, Sphere
from spheredrive.frames import unit
from spheredrive.studies.sweep.columns import columns_of
from spheredrive.studies.sweep.metrics.base import Conditions, Machines
from spheredrive.studies.sweep.metrics.gaps import Cylinders, cylinder_gap, free_cone
from spheredrive.studies.sweep.metrics.layout import half_width, measure
from spheredrive.wheels import TYPES

R, r = 0.15, 0.03


def ring(count: int, elevation: float, heading: float, wheel=None):
    wheel = wheel or TYPES["ideal"](radius=r, mass=0.1)
    placements = tuple(Placement.at(wheel, 2 * np.pi * k / count, elevation, heading) for k in range(count))
    return Design("ring", Sphere(R, mass=2.0), placements)


def measured(*designs, names=("clearance", "opening")):
    ((_, columns),) = columns_of(designs)
    return measure(Machines(columns, designs), Conditions(), names)


def cylinders(rng, count: int) -> Cylinders:
    axis = unit(rng.normal(size=(count, 3)))
    return Cylinders(rng.normal(size=(count, 3)), axis, rng.uniform(0.05, 0.5, count), rng.uniform(0, 0.3, count))


@pytest.mark.parametrize(
    ("centre", "axis", "gap"),
    [
        ((1.0, 0, 0), (0, 0, 1), 1 - 0.2 - 0.3),  # side by side
        ((0, 0, 1.0), (0, 0, 1), 1 - 0.1 - 0.05),  # one above the other
        ((0, 0, 1.0), (1, 0, 0), 1 - 0.1 - 0.3),  # a rim above a face
        ((1.0, 0, 0), (1, 0, 0), 1 - 0.2 - 0.05),  # a face beside a mantle
        ((1.0, 0, 1.0), (0, 0, 1), np.hypot(1 - 0.2 - 0.3, 1 - 0.1 - 0.05)),  # rims across a corner
        ((0.3, 0, 0), (0, 0, 1), -(0.1 + 0.05)),  # one in the other, and least deep along the axis
    ],
)
def test_gap_of_two_cylinders(centre, axis, gap):
    """Of radius 0.2 and 0.3, half width 0.1 and 0.05, to the tolerance of the search: 1e-9 of their sizes."""
    a = Cylinders(np.zeros((1, 3)), np.array([[0.0, 0, 1]]), np.array([0.2]), np.array([0.1]))
    b = Cylinders(np.array([centre], float), np.array([axis], float), np.array([0.3]), np.array([0.05]))
    assert abs(cylinder_gap(a, b)[0] - gap) < 2e-9 and abs(cylinder_gap(b, a)[0] - gap) < 2e-9


def test_gap_agrees_with_a_general_solver(rng):
    """SLSQP on both points: min |p − q|² with each in its cylinder."""
    from scipy.optimize import minimize

    a, b = cylinders(rng, 12), cylinders(rng, 12)
    gap = cylinder_gap(a, b)
    assert (gap > 0).sum() > 8

    def inside(z, k):
        found = []
        for p, c in ((z[:3], a), (z[3:], b)):
            along = (p - c.centre[k]) @ c.axis[k]
            across = p - c.centre[k] - along * c.axis[k]
            found += [c.half[k] - along, c.half[k] + along, c.radius[k] ** 2 - across @ across]
        return np.array(found)

    for k in np.flatnonzero(gap > 0):
        start = np.r_[a.centre[k], b.centre[k]]
        constraint = {"type": "ineq", "fun": inside, "args": (k,)}
        found = minimize(lambda z: np.sum((z[:3] - z[3:]) ** 2), start, constraints=constraint, options={"ftol": 1e-15})
        assert abs(np.sqrt(found.fun) - gap[k]) < 1e-6


def test_free_cone_agrees_with_points_on_the_mantle(rng):
    """No point of the mantle lies nearer to +z, and some of a fine net lie as near as the net is fine."""
    bodies = cylinders(rng, 10)
    cone = free_cone(bodies)
    t, s = np.linspace(0, 2 * np.pi, 2001), np.linspace(-1, 1, 201)[:, None]
    for k in range(10):
        w = bodies.axis[k]
        u = unit(np.cross(w, [0.3, 0.2, 0.9]))
        rim = np.cos(t)[:, None] * u + np.sin(t)[:, None] * np.cross(w, u)
        p = bodies.centre[k] + bodies.half[k] * s[..., None] * w + bodies.radius[k] * rim
        nearest = np.arctan2(np.hypot(p[..., 0], p[..., 1]), p[..., 2]).min()
        if cone[k] > 0:
            assert -1e-12 < nearest - cone[k] < 1e-4


def test_a_wheel_across_the_axis_leaves_no_cone():
    lid = Cylinders(np.array([[0.05, 0, 1.0]]), np.array([[0.0, 0, 1]]), np.array([0.2]), np.array([0.1]))
    assert free_cone(lid)[0] == 0.0
    below = replace_centre(lid, [[0.05, 0, -1.0]])
    assert abs(free_cone(below)[0] - (np.pi - np.arctan2(0.25, 0.9))) < 1e-9


def replace_centre(bodies: Cylinders, centre) -> Cylinders:
    return bodies._replace(centre=np.array(centre))


@pytest.mark.parametrize("count", [2, 3, 5, 12])
def test_clearance_of_a_ring_on_the_equator(count):
    """Driven eastward the axles stand upright: discs in one plane, 2 (R + r) sin(π/n) − 2 r apart."""
    found = measured(ring(count, 0.0, 0.0))
    expected = 2 * (R + r) * np.sin(np.pi / count) - 2 * r
    # Discs in one plane that overlap are told as touching: they have no thickness to be deep in.
    assert abs(found["clearance"].values[0] - max(expected, 0.0)) < 1e-8 or (expected < 0 and found["clearance"].values[0] <= 0)
    assert abs(found["opening"].values[0] - np.pi / 2) < 1e-9


@pytest.mark.parametrize("elevation", [-0.9, -0.2, 0.6])
def test_opening_above_wheels_in_meridian_planes(elevation):
    """Driven northward a disc stands in the plane of z: it reaches asin(r/(R + r)) above its middle."""
    found = measured(ring(3, elevation, np.pi / 2))
    assert abs(found["opening"].values[0] - (np.pi / 2 - elevation - np.arcsin(r / (R + r)))) < 1e-9


def test_width_is_that_of_the_outer_rollers():
    dual = TYPES["dual-race"](radius=0.025, rollers=16, roller_radius=0.004, race_spacing=0.012)
    assert abs(half_width(dual, R) - 0.010) < 1e-15
    mecanum = TYPES["mecanum"](radius=0.0758, rollers=16, roller_angle=np.pi / 4)
    assert 0.01 < half_width(mecanum, 1.22) < 0.0758 and half_width(TYPES["ideal"](radius=r), R) == 0.0


def test_a_split_wheel_takes_room_on_both_sides():
    split = TYPES["split-dual-race"](radius=0.025, rollers=16, roller_radius=0.004)
    above, below = ring(2, -0.4, 0.0, split), ring(2, -0.4, 0.0)
    assert measured(above)["opening"].values[0] < np.pi / 2 < measured(below)["opening"].values[0]


def test_mass_price_and_what_is_missing():
    heavy = measured(ring(3, -0.7, 0.0), names=("mass", "price"))
    assert abs(heavy["mass"].values[0] - 2.3) < 1e-15
    assert "no price of wheels.wheel is given" in heavy["price"].sentences[0]
    design = ring(3, -0.7, 0.0)
    ((_, columns),) = columns_of([design])
    bought = measure(Machines(columns, [design]), Conditions(prices=(("wheel", 12.5),)), ("price",))["price"]
    assert bought.values[0] == 37.5 and bought.reason[0] == 0
    light = ring(3, -0.7, 0.0, TYPES["ideal"](radius=r))
    assert "wheel model" in measured(light, names=("mass",))["mass"].sentences[0]
    alone = measured(ring(1, -0.7, 0.0))["clearance"]
    assert alone.reason[0] == 1 and "one wheel alone" in alone.sentences[0]


def test_numbers_do_not_depend_on_neighbours():
    designs = [
        ring(4, e, h, TYPES["ideal"](radius=q, mass=0.1))
        for e, h, q in ((-0.5, 0.1, 0.02), (-0.9, 0.7, 0.04), (0.1, 0.3, 0.03))
    ]
    together = measured(*designs)
    for k, design in enumerate(designs):
        alone = measured(replace(design))
        for name in ("clearance", "opening"):
            assert together[name].values[k] == alone[name].values[0]
