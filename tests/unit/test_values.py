"""Frozen values refuse what no machine can have, and name the field."""

import math
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from layouts import DUAL, R, atlas
from spheredrive.design import Closure, Contact, Design, Motor, Placement, Sphere, Spring
from spheredrive.errors import DesignError
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.wheels import (
    TYPES,
    DualRaceWheel,
    IdealWheel,
    MeasuredWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
    TripleRaceWheel,
)


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, -math.inf, True, "1", None, 1e300, 1e-300])
def test_radius_must_be_a_positive_finite_number(bad):
    for make in (lambda: Sphere(bad), lambda: IdealWheel(radius=bad)):
        with pytest.raises(DesignError) as caught:
            make()
        assert caught.value.key == ("radius",)


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: Sphere(R, inertia="heavy"), "inertia"),
        (lambda: Sphere(R, inertia=[1, 1]), "inertia"),
        (lambda: Sphere(R, inertia=[1, 1, -1]), "inertia"),
        (lambda: Sphere(R, inertia=[1, 1, 3]), "inertia"),
        (lambda: Sphere(R, inertia=[[1, 0, 0], [0.1, 1, 0], [0, 0, 1]]), "inertia"),
        (lambda: Sphere(R, inertia=[[1, 2, 0], [2, 1, 0], [0, 0, 1]]), "inertia"),
        (lambda: Sphere(R, mass=10, inertia=[0.01, 0.01, 0.01], centre_of_mass=(0.1, 0, 0)), "inertia"),
        (lambda: Sphere(R, centre_of_mass=(R, 0, 0)), "centre_of_mass"),
        (lambda: Sphere(R, poisson_ratio=0.6), "poisson_ratio"),
        (lambda: IdealWheel(radius=1, roller_angle=0), "roller_angle"),
        (lambda: IdealWheel(radius=1, roller_angle=2), "roller_angle"),
        (lambda: StandardWheel(radius=1, roundness=1), "roundness"),
        (lambda: StandardWheel(radius=1, roller_radius=1), "roller_radius"),
        (lambda: StandardWheel(radius=1, roller_shape="egg"), "roller_shape"),
        (lambda: StandardWheel(radius=1, rollers=1), "rollers"),
        (lambda: DualRaceWheel(**{**DUAL, "rollers": 15}), "rollers"),
        (lambda: DualRaceWheel(radius=1, rollers=None, roller_radius=0.1, race_spacing=0.1), "rollers"),
        (lambda: DualRaceWheel(radius=1, rollers=8, roller_radius=0.1, race_spacing=0), "race_spacing"),
        (lambda: SplitDualRaceWheel(radius=1, rollers=3), "rollers"),
        (lambda: TripleRaceWheel(radius=1, rollers=16, roller_radius=0.1, race_spacing=0.1), "rollers"),
        (lambda: MeasuredWheel(outline=((0, 1), (1, 1))), "file"),
        (lambda: MeasuredWheel(outline=((0, 1), (2, 1), (1, 1))), "file"),
        (lambda: MeasuredWheel(outline=((0, 1), (1, 1), (2, -1))), "file"),
        (lambda: MeasuredWheel(outline=((0, 1), (1, 1), (7, 1))), "file"),
        (lambda: Contact(friction=-0.1), "friction"),
        (lambda: Spring((0, 0, 0), 1.0), "direction"),
        (lambda: Closure(force=(0, 0)), "force"),
        (lambda: Motor(torque=0), "torque"),
        (lambda: Series((0, 0), ((1,), (1,))), "time"),
        (lambda: Series((0, 1), ((1,),)), "values"),
        (lambda: Series((0, 1), ((1,), (1, 2))), "values"),
        (lambda: Series((0, 1), ((1,), (math.nan,))), "values"),
        (lambda: StageMotion("force", Series((0,), ((1, 2),))), "values"),
        (lambda: Motion("wheel-spin", Series((0,), ((1,),)), 1.0), "kind"),
        (lambda: Motion("wheel-speed", Series((0,), ((1,),)), 0.0), "duration"),
        (lambda: Motion("wheel-speed", Series((0,), ((1,),)), 1e6, sample_rate=1e6), "output"),
        (lambda: Motion("wheel-speed", Series((0,), ((1,),)), 1.0, angular_velocity=(0, 0, 1)), "initial"),
        (lambda: Motion("wheel-speed", Series((0,), ((1,),)), 1.0, orientation=(1, 1, 0, 0)), "initial"),
    ],
)
def test_impossible_values_are_refused_by_the_name_of_their_field(make, key):
    with pytest.raises(DesignError) as caught:
        make()
    assert caught.value.key[0] == key
    assert str(caught.value).startswith(key)


def test_drive_must_be_perpendicular_to_contact():
    with pytest.raises(DesignError, match="45 deg"):
        Placement(IdealWheel(radius=1), (1, 0, 0), (1, 1, 0))


def test_two_wheels_at_one_place_are_refused():
    wheel = IdealWheel(radius=0.02)
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    with pytest.raises(DesignError, match="wheels 1 and 3"):
        Design("twice", Sphere(R), [Placement(wheel, x, y), Placement(wheel, y, z), Placement(wheel, x, z)])


def test_wheel_on_the_second_wheel_of_a_split_pair_is_refused():
    split, single = SplitDualRaceWheel(radius=0.02, rollers=8), IdealWheel(radius=0.02)
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    with pytest.raises(DesignError, match="wheels 1 and 2"):
        Design("antipode", Sphere(R), [Placement(split, x, y), Placement(single, (-1, 0, 0), z)])
    with pytest.raises(DesignError, match="same point"):
        atlas(split, 0, count=4)


def test_elevation_beyond_the_pole_is_refused_as_radians():
    with pytest.raises(DesignError, match="bare numbers are radians"):
        Placement.at(IdealWheel(radius=0.02), 0.0, -40.0)


def test_races_too_far_apart_for_the_sphere_are_refused():
    with pytest.raises(DesignError, match="closer together"):
        atlas(DualRaceWheel(**{**DUAL, "race_spacing": 0.4}))


def test_design_without_wheels_is_refused():
    with pytest.raises(DesignError, match="at least one wheel"):
        Design("bare", Sphere(R), [])


def test_values_are_frozen_and_arrays_read_only():
    design = atlas()
    with pytest.raises(FrozenInstanceError):
        design.name = "other"
    with pytest.raises(ValueError, match="read-only"):
        design.contact_directions[0, 0] = 0


def test_placement_angles_round_trip(rng):
    for _ in range(50):
        azimuth, elevation, heading = rng.uniform(-3, 3), rng.uniform(-1.5, 1.5), rng.uniform(-3, 3)
        placement = Placement.at(IdealWheel(radius=1), azimuth, elevation, heading)
        np.testing.assert_allclose(placement.azimuth_elevation_heading, (azimuth, elevation, heading), atol=1e-12)


def test_headings_run_from_east_to_north():
    east = Placement.at(IdealWheel(radius=1), 0.0, 0.0, 0.0).drive_direction
    north = Placement.at(IdealWheel(radius=1), 0.0, 0.0, math.pi / 2).drive_direction
    np.testing.assert_allclose([east, north], [[0, 1, 0], [0, 0, 1]], atol=1e-15)


def test_inertia_of_named_bodies():
    """Hollow 2/3 M R², solid 2/5 M R²; unknown while the mass is."""
    assert Sphere(2.0, mass=3.0).inertia_tensor[0, 0] == pytest.approx(8)
    assert Sphere(2.0, mass=3.0, inertia="solid").inertia_tensor[2, 2] == pytest.approx(4.8)
    assert Sphere(2.0).inertia_tensor is None
    np.testing.assert_array_equal(Sphere(2.0, inertia=[1, 2, 2]).inertia_tensor, np.diag([1, 2, 2]))


def test_mecanum_rollers_touch_each_other():
    """r_r = r_b s/(1 + s), s = sin(π/n): 12.37 mm for 16 rollers on 75.8 mm."""
    assert round(MecanumWheel(radius=0.0758, rollers=16).roller_section * 1e3, 2) == 12.37
    assert MecanumWheel(radius=0.0758).roller_angle == math.pi / 4


def test_measured_radius_is_the_mean_over_the_turn():
    """A linear tooth between 0.9 and 1.1 has mean 1 whatever the spacing of its points."""
    outline = ((0.0, 0.9), (math.pi, 1.1))
    closed = MeasuredWheel(outline=(*outline[:1], (1.0, 0.9 + 0.2 / math.pi), *outline[1:]))
    assert closed.radius == pytest.approx(1.0)


def test_axial_inertia_defaults_to_a_solid_disc():
    assert IdealWheel(radius=0.1, mass=2.0).spin_inertia == pytest.approx(0.01)
    assert IdealWheel(radius=0.1, mass=2.0, axial_inertia=0.5).spin_inertia == 0.5
    assert IdealWheel(radius=0.1).spin_inertia is None


def test_every_type_is_listed_under_its_own_name():
    assert set(TYPES) == {"ideal", "standard", "dual-race", "split-dual-race", "triple-race", "mecanum", "measured"}
    assert all(name == wheel.type for name, wheel in TYPES.items())


def test_design_prints_its_wheels_worst_direction_and_nearest_singularity():
    text = str(atlas())
    for words in ("Atlas", "dual-race", "240°", "-40°", "worst direction", "perpendicular to z", "+40.00°"):
        assert words in text
