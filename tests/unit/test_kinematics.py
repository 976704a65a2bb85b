"""Refusals and edges of the kinematic functions: fewer than three wheels, singular layouts, wrong shapes."""

import math
import warnings

import numpy as np
import pytest

from layouts import R, atlas, collinear_triple, orthogonal, six_orthogonal
from spheredrive import kinematics as K
from spheredrive.design import Design, Placement, Sphere
from spheredrive.errors import NearSingularWarning, SingularError, SpheredriveError
from spheredrive.wheels import IdealWheel, TripleRaceWheel

IDEAL = IdealWheel(radius=0.025)


def ring(count: int) -> Design:
    return atlas(IDEAL, count=count)


@pytest.mark.parametrize("count", [1, 2])
def test_jacobian_of_fewer_than_three_wheels_is_refused(count):
    with pytest.raises(SingularError, match="takes three"):
        K.jacobian(ring(count))
    assert K.effectiveness(ring(count))[1] == math.inf
    assert K.isotropy(ring(count)) == 0
    assert K.inverse(ring(count), [0, 0, 1]).shape == (count,)


@pytest.mark.parametrize(("elevation", "heading"), [(0, 0), (-40, 90)])
def test_jacobian_of_a_singular_layout_is_refused_with_the_axis_it_misses(elevation, heading):
    """Wheels on the equator that drive along it turn about z alone; wheels that drive along meridians cannot."""
    design = atlas(IDEAL, elevation, heading)
    for ask in (K.jacobian, lambda d: K.forward(d, [1, 2, 3]), lambda d: K.slip(d, [1, 2, 3])):
        with pytest.raises(SingularError, match="singular: no wheel drives"):
            ask(design)
    with pytest.raises(SingularError) as caught:
        K.jacobian(design)
    if heading:
        assert "about z" in str(caught.value)
    else:
        np.testing.assert_allclose(K.worst_directions(design).weakest[2], 0, atol=1e-12)


def test_coplanar_rows_of_many_wheels_are_singular():
    """Least squares fails already for coplanar Ω̂, not only parallel ones (E9): wheels on the equator driving along z."""
    placements = [Placement.at(IDEAL, a, 0.0, math.pi / 2) for a in (0, 1, 2, 3, 4)]
    with pytest.raises(SingularError, match="about z"):
        K.jacobian(Design("coplanar", Sphere(R), placements))


def test_near_singular_layout_warns_and_answers():
    with pytest.warns(NearSingularWarning, match="grow by up to"):
        J = K.jacobian(atlas(IDEAL, -0.1))
    assert np.isfinite(J).all()


def test_regular_layout_does_not_warn():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        K.jacobian(atlas())


@pytest.mark.parametrize("races", [(1, 1), (1, 2, 3), (1, 1, ()), (1, 1, (1, 1)), (0, 1, 1)])
def test_races_a_design_does_not_have_are_refused(races):
    with pytest.raises(SpheredriveError):
        K.constraint(atlas(), races)


def test_wrong_shapes_are_refused_by_name():
    with pytest.raises(SpheredriveError, match="wheel_speed has shape"):
        K.forward(atlas(), [1, 2])
    with pytest.raises(SpheredriveError, match="angular_velocity has shape"):
        K.inverse(atlas(), np.zeros((3, 4)))
    with pytest.raises(SpheredriveError, match="last axis"):
        K.state_index(atlas(), [0, 0])


@pytest.mark.parametrize("masters", [(1, 1, 2), (0, 1, 2), (1, 2, 7), (1, 2)])
def test_masters_must_be_three_different_wheels(masters):
    with pytest.raises(SpheredriveError, match="masters"):
        K.master_slave(six_orthogonal(), [1, 2, 3], masters)


def test_dependent_masters_are_refused():
    with pytest.raises(SingularError):
        K.master_slave(six_orthogonal(), [1, 2, 3], (1, 4, 2))


def test_slaves_cannot_follow_where_a_wheel_has_several_contacts():
    with pytest.raises(SpheredriveError, match="one contact a wheel"):
        K.master_slave(collinear_triple(), [1, 2, 3], races=[(1, 3), 2, 2])


def test_transmission_needs_a_turning_wheel():
    with pytest.raises(SpheredriveError, match="turns"):
        K.transmission(atlas(), [0, 0, 0])


@pytest.mark.parametrize(
    "ask",
    [
        lambda d: K.transmission(d, [1, 1, math.nan]),
        lambda d: K.transmission(d, [1, 1]),
        lambda d: K.race_error([math.nan, 0, 0], [1, 0, 0]),
        lambda d: K.effectiveness_about(d, [0, 0, 0]),
        lambda d: K.effectiveness_about(d, [0, math.nan, 0]),
        lambda d: K.state_index(d, [1e20, 0, 0]),
        lambda d: K.state_index(d, [math.nan, 0, 0]),
        lambda d: K.constraint(d, (1.5, 1, 1)),
        lambda d: K.constraint(d, (True, 1, 1)),
        lambda d: K.constraint(d, ("a", 1, 1)),
        lambda d: K.constraint(d, (None, 1, 1)),
        lambda d: K.master_slave(d, [1, 2, 3], (1.5, 2, 3)),
        lambda d: K.integrate_orientation([], np.zeros((0, 3))),
        lambda d: d.rotated(2 * np.eye(3)),
        lambda d: d.rotated(-np.eye(3)),
    ],
)
def test_senseless_arguments_are_refused_with_a_sentence(ask):
    with pytest.raises(SpheredriveError):
        ask(atlas())


def test_transmission_goes_by_the_radius_at_the_contact():
    """ξ = R|Ω| / |(rᵢ ωᵢ)| over slip-free motion is |Ω| / |A Ω|, whatever races touch."""
    wheel = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=30e-3)
    design, races = atlas(wheel), (1, 3, 1)
    Omega = np.array([0.3, -0.4, 0.5])
    found = K.transmission(design, K.inverse(design, Omega, races), races).effectiveness
    A, _ = K.constraint(design, races)
    assert found == pytest.approx(np.linalg.norm(Omega) / np.linalg.norm(A @ Omega), rel=1e-12)
    with pytest.raises(SpheredriveError, match="one contact a wheel"):
        K.transmission(design, [1, 1, 1], ((1, 3), 2, 2))


def test_accelerations_follow_the_same_maps(rng):
    wheel = rng.normal(size=(4, 3))
    np.testing.assert_array_equal(K.sphere_acceleration(atlas(), wheel), K.forward(atlas(), wheel))
    np.testing.assert_array_equal(K.wheel_acceleration(atlas(), wheel), K.inverse(atlas(), wheel))


def test_worst_directions_of_a_mixed_layout_are_the_ends_of_the_range(rng):
    """No sampled axis has a ξ outside of the two named ones."""
    design = atlas(IDEAL, -25)
    worst = K.worst_directions(design)
    sampled = K.effectiveness_about(design, rng.normal(size=(2000, 3)))
    assert K.effectiveness_about(design, worst.slowest) <= sampled.min()
    assert K.effectiveness_about(design, worst.weakest) >= sampled.max()
    np.testing.assert_allclose(K.effectiveness(design), [K.effectiveness_about(design, w) for w in worst])


def test_orientation_refuses_what_it_cannot_integrate():
    for time, Omega in ([[0, 1], np.zeros((3, 3))], [[1, 0], np.zeros((2, 3))], [[0, np.nan], np.zeros((2, 3))]):
        with pytest.raises(SpheredriveError):
            K.integrate_orientation(time, Omega)
    with pytest.raises(SpheredriveError, match="unit"):
        K.integrate_orientation([0, 1], np.zeros((2, 3)), (0, 0, 0, 0))


def test_orthogonal_layout_is_isotropic_and_has_no_worst_direction():
    from spheredrive.checking import check

    assert check(orthogonal()).weakest == "all axes alike"
