"""Refusals, edges and shapes of the contact functions."""

import dataclasses
import math

import numpy as np
import pytest

from layouts import R, atlas
from spheredrive.contact import Hertz, contact_modulus, hertz, relative_radii, resistance_arms, resistance_moment, wheel_hertz
from spheredrive.design import Contact, Design, Placement, Sphere
from spheredrive.errors import SpheredriveError
from spheredrive.wheels import IdealWheel, MeasuredWheel, MecanumWheel, StandardWheel

SKIN = Sphere(R, young_modulus=2e9, poisson_ratio=0.35)
ELASTIC = dict(young_modulus=4e6, poisson_ratio=0.45)
ROLLERS = dict(radius=0.03, rollers=8, roller_radius=0.006)


def machine(wheel, sphere=SKIN, contact=None) -> Design:
    return dataclasses.replace(atlas(wheel), sphere=sphere, contact=contact or Contact())


def test_contact_modulus_of_a_rigid_and_an_elastic_body_is_the_elastic_ones():
    assert contact_modulus(1e9, 0.5, math.inf, 0.2) == pytest.approx(1e9 / 0.75, rel=1e-15)
    np.testing.assert_allclose(contact_modulus([1e9, 2e9], 0.0, 2e9, [[0.0], [0.5]]), [[2e9 / 3, 1e9], [8e9 / 11, 8e9 / 7]])


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan])
def test_contact_modulus_refuses_impossible_bodies(bad):
    with pytest.raises(ValueError, match="Young's modulus must be greater than zero"):
        contact_modulus(bad, 0.3, 1e9, 0.3)
    with pytest.raises(ValueError, match="Poisson's ratio"):
        contact_modulus(1e9, 0.51 if bad == 0 else bad, 1e9, 0.3)
    with pytest.raises(ValueError, match="two rigid bodies"):
        contact_modulus(math.inf, 0.3, math.inf, 0.3)


def test_hertz_without_force_is_a_point():
    for patch in (hertz(0.0, 0.1, modulus=1e9), hertz(0, 0.1, 1e-6, modulus=1e9)):
        assert isinstance(patch, Hertz) and patch == (0, 0, 0, 0, 0)
    mixed = hertz([0.0, 1.0], 0.1, 0.2, modulus=1e9)
    assert all(field[0] == 0 and field[1] > 0 for field in mixed)


@pytest.mark.parametrize("force", [-1e-300, -1.0, math.nan, math.inf])
def test_hertz_refuses_forces_that_do_not_press(force):
    with pytest.raises(ValueError, match="normal force"):
        hertz([1.0, force], 0.1, modulus=1e9)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_hertz_refuses_radii_and_moduli_that_leave_no_patch(bad):
    for ask in (
        lambda: hertz(1.0, bad, modulus=1e9),
        lambda: hertz(1.0, 0.1, bad, modulus=1e9),
        lambda: hertz(1.0, 0.1, modulus=bad),
    ):
        with pytest.raises(ValueError, match="finite and greater than zero"):
            ask()


def test_hertz_broadcasts_force_radii_and_modulus():
    force, radius = np.arange(6.0).reshape(2, 1, 3), np.array([[0.1], [0.2]])
    patch = hertz(force, radius, [0.1, 0.05, 1.0], modulus=[1e9, 2e9, 3e9])
    assert {field.shape for field in patch} == {(2, 2, 3)}
    one = hertz(4.0, 0.2, 0.05, modulus=2e9)
    np.testing.assert_allclose([field[1, 1, 1] for field in patch], one, rtol=1e-14)
    assert np.ndim(one.a) == 0
    assert {field.shape for field in hertz(np.zeros((0, 3)), 0.1, modulus=1.0)} == {(0, 3)}


@pytest.mark.parametrize("wheel", [IdealWheel(radius=0.03), StandardWheel(radius=0.03), MecanumWheel(radius=0.03)])
def test_relative_radii_of_a_wheel_without_roller_radius_are_a_spheres(wheel):
    np.testing.assert_allclose(relative_radii(atlas(wheel)), np.full((2, 3), 1 / (1 / R + 1 / 0.03)), rtol=1e-15)


def test_relative_radii_of_measured_and_touching_rollers():
    outline = tuple((a, 0.03) for a in (0, 1, 2, 4))
    np.testing.assert_allclose(relative_radii(atlas(MeasuredWheel(outline=outline))), 1 / (1 / R + 1 / 0.03), rtol=1e-14)
    wheel = MecanumWheel(radius=0.03, rollers=12)
    np.testing.assert_allclose(relative_radii(atlas(wheel))[0], 1 / (1 / R + 1 / wheel.roller_section), rtol=1e-14)


def test_relative_radii_are_each_wheels_own():
    wheels = [IdealWheel(radius=0.03), StandardWheel(**ROLLERS)]
    design = Design("two", SKIN, [Placement.at(wheel, i, -0.5) for i, wheel in enumerate(wheels)])
    across, along = relative_radii(design)
    np.testing.assert_allclose(1 / across - 1 / R, [1 / 0.03, 1 / 0.006])
    np.testing.assert_allclose(1 / along - 1 / R, [1 / 0.03, 1 / 0.03])


def test_wheel_hertz_names_the_moduli_it_lacks():
    wheel = StandardWheel(**ROLLERS, young_modulus=4e6, name="omni")
    with pytest.raises(SpheredriveError, match=r"needs wheels\.omni\.poisson_ratio, which"):
        wheel_hertz(machine(wheel), 1.0)
    with pytest.raises(SpheredriveError) as caught:
        wheel_hertz(machine(wheel, Sphere(R)), 1.0)
    text = str(caught.value)
    assert text.count("sphere.young_modulus") == 1 and "sphere.poisson_ratio" in text and "wheels.omni.young" not in text


@pytest.mark.parametrize("ask", [wheel_hertz, resistance_arms])
def test_forces_of_the_wrong_number_of_wheels_are_refused(ask):
    design = machine(StandardWheel(**ROLLERS, **ELASTIC))
    with pytest.raises(ValueError, match="one normal force a wheel"):
        ask(design, [1.0, 2.0])
    with pytest.raises(ValueError, match="finite"):
        ask(design, [1.0, math.nan, 1.0])
    assert ask(design, 1.0)[0].shape == (3,) and ask(design, np.ones((4, 2, 3)))[0].shape == (4, 2, 3)


def test_wheel_hertz_refuses_a_pulling_force():
    with pytest.raises(ValueError, match="not negative"):
        wheel_hertz(machine(StandardWheel(**ROLLERS, **ELASTIC)), [1.0, -1.0, 1.0])


def test_resistance_arms_given_by_the_design_are_taken():
    elastic = StandardWheel(**ROLLERS, **ELASTIC)
    free = resistance_arms(machine(elastic), [0.0, 1.0, 2.0])
    rolling, spin = resistance_arms(machine(elastic, contact=Contact(rolling_arm=1e-3)), [0.0, 1.0, 2.0])
    assert (rolling == 1e-3).all() and (spin == free[1]).all() and spin[0] == 0 and spin[2] > spin[1] > 0
    rolling, spin = resistance_arms(machine(elastic, contact=Contact(rolling_arm=0.0, spin_arm=2e-4)), 1.0)
    assert (rolling == 0).all() and (spin == 2e-4).all()


def test_resistance_arms_are_zero_where_moduli_are_unknown_or_contact_is_open():
    assert not np.any(resistance_arms(machine(StandardWheel(**ROLLERS)), [1.0, 2.0, 3.0]))
    assert not np.any(resistance_arms(machine(StandardWheel(**ROLLERS, **ELASTIC), Sphere(R)), 1.0))
    wheels = [StandardWheel(**ROLLERS, **ELASTIC), StandardWheel(**ROLLERS)]
    design = Design("mixed", SKIN, [Placement.at(wheel, i, -0.5) for i, wheel in enumerate(wheels)])
    for arm in resistance_arms(design, [[3.0, 3.0], [-3.0, 3.0]]):
        assert arm[0, 0] > 0 and arm[0, 1] == 0 and not arm[1].any()


AT = dict(contact_direction=np.eye(3), drive_direction=np.roll(np.eye(3), 1, 0))


def test_resistance_moment_broadcasts_and_opens():
    args = dict(**AT, rolling_arm=1e-3, spin_arm=np.full(3, 1e-3), friction=0.5)
    Omega, omega = np.ones((5, 1, 3)), np.zeros((2, 3))
    M = resistance_moment(Omega, omega, normal_force=[1.0, -1.0, 0.0], **args)
    assert M.shape == (5, 2, 3, 3) and (M[..., 0, :] != 0).all() and not M[..., 1:, :].any()


@pytest.mark.parametrize("smoothing", [0.0, -1e-3, math.nan])
def test_resistance_moment_refuses_to_jump_at_rest(smoothing):
    with pytest.raises(ValueError, match="smoothing"):
        resistance_moment(
            [0, 0, 0], np.zeros(3), **AT, normal_force=1, rolling_arm=1, spin_arm=1, friction=1, smoothing=smoothing
        )
