"""Rollers stand where the outline has them, and a wheel weighs what the design says."""

import math

import numpy as np
import pytest

from layouts import atlas
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.export.mjcf.bodies import hubs
from spheredrive.shape import profile
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel, SplitDualRaceWheel, StandardWheel, TripleRaceWheel

R = 0.15
THIN = dict(radius=0.025, roller_radius=4.5e-3, mass=0.1)
WHEELS = {
    "spheres": StandardWheel(**THIN, rollers=12, roller_shape="sphere", phase=0.03),
    "capsules": StandardWheel(**THIN, rollers=9, roller_shape="capsule", roller_length=4e-3),
    "dual": DualRaceWheel(**THIN, rollers=16, race_spacing=0.012, roller_shape="capsule", roller_length=5e-3),
    "split": SplitDualRaceWheel(**THIN, rollers=16, roller_shape="capsule", roller_length=3e-3),
    "triple": TripleRaceWheel(**THIN, rollers=24, race_spacing=0.010, roller_shape="capsule", roller_length=4e-3),
    "mecanum": MecanumWheel(radius=0.025, mass=0.1, rollers=12, phase=-0.1),
    "mecanum, left": MecanumWheel(radius=0.025, mass=0.1, rollers=12, roller_angle=-0.8),
}  # fmt: skip


def height(hub, angle):
    """D − R by the definition of model.md section 3: the largest over rollers and places on their axes."""
    turn = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
    best = -math.inf
    for place in hub.rollers:
        s = np.linspace(-place.body.half_length, place.body.half_length, 4001)
        p = (turn @ (place.position[:, None] + place.axis[:, None] * s)).T
        under = (R + place.body.radius(s)) ** 2 - p[:, 1] ** 2 - p[:, 2] ** 2
        if place.position @ turn[0] > 0 and (under > 0).any():
            best = max(best, (p[:, 0] + np.sqrt(np.maximum(under, 0)))[under > 0].max() - R)
    return best


@pytest.mark.parametrize("name", WHEELS)
def test_hubs_carry_their_rollers_where_the_outline_has_them(name, rng):
    wheel = WHEELS[name]
    design = atlas(wheel, radius=R)
    for hub in hubs(design)[:2]:
        outline = profile(wheel, R, race=2 if hub.antipodal else None)
        for angle in rng.uniform(0, 7, 8):
            found = height(hub, angle)
            nominal = np.linalg.norm(hub.position) - R
            # Places 1/4000 of the roller apart leave less than L²/(8·2000²·r_r) of the height.
            assert found == pytest.approx(nominal + outline.height(angle), abs=2e-9)


@pytest.mark.parametrize("name", WHEELS)
def test_hubs_add_up_to_the_wheel(name):
    wheel = WHEELS[name]
    mass = inertia = 0.0
    for hub in [hub for hub in hubs(atlas(wheel, radius=R), 0.2) if hub.wheel == 0]:
        one = hub.roller_inertia
        mass += hub.inertia.mass + one.mass * len(hub.rollers)
        inertia += hub.inertia.moments[2]
        for place in hub.rollers:
            own = one.moments[2] * place.axis[2] ** 2 + one.moments[0] * (1 - place.axis[2] ** 2)
            inertia += one.mass * (place.position[0] ** 2 + place.position[1] ** 2) + own
    assert mass == pytest.approx(wheel.mass, rel=1e-12)
    assert inertia == pytest.approx(wheel.spin_inertia, rel=1e-12)


def test_hubs_far_half_has_the_other_hand():
    wheel = SplitDualRaceWheel(**THIN, rollers=12, roller_angle=0.9, roller_shape="capsule", roller_length=3e-3)
    near, far = (hub for hub in hubs(atlas(wheel, radius=R)) if hub.wheel == 0)
    np.testing.assert_allclose(far.frame[2], near.frame[2], atol=1e-15)
    hands = [
        np.sign(np.cross(h.rollers[0].axis, [0, 0, 1]) @ h.rollers[0].position * h.rollers[0].axis[2]) for h in (near, far)
    ]
    assert hands[0] == -hands[1] != 0


def test_hubs_refuse_what_has_no_body():
    with pytest.raises(SpheredriveError, match="wheel 1 is of type 'ideal'"):
        hubs(atlas(IdealWheel(radius=0.025, mass=0.1), radius=R))
    with pytest.raises(SpheredriveError, match="give the mass of wheels"):
        hubs(atlas(StandardWheel(radius=0.025, roller_radius=4e-3, rollers=12, roller_shape="sphere"), radius=R))
    light = StandardWheel(**THIN, rollers=12, roller_shape="sphere", axial_inertia=1e-6)
    with pytest.raises(DesignError, match=r"wheels\.wheel\.axial_inertia: is less than"):
        hubs(atlas(light, radius=R), 0.5)
    with pytest.raises(SpheredriveError, match="between 0 and 1"):
        hubs(atlas(WHEELS["spheres"], radius=R), 0.0)
