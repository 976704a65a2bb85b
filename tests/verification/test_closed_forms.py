"""Layouts of the thesis against their closed forms; every value below is worked out from the formula beside it.

Tolerance 1e-12 throughout: each result is a handful of products of numbers of size one, rounded to 1.1e-16 each, and the
layouts have condition numbers below 5.
"""

import itertools
import math

import numpy as np
import pytest

from layouts import DUAL, R, atlas, collinear_triple, orthogonal, six_orthogonal
from spheredrive import kinematics as K
from spheredrive.errors import SingularError
from spheredrive.kinematics.quality import _singular_change
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel, SplitDualRaceWheel, TripleRaceWheel

EXACT = 1e-12
IDEAL = IdealWheel(radius=0.025)
THETA = math.radians(40)
s, c, q = math.sin(THETA), math.cos(THETA), math.sqrt(3) / 2


def test_atlas_rows_are_those_of_model_section_2():
    A, B = K.constraint(atlas(IDEAL))
    np.testing.assert_allclose(A, [[s, 0, c], [-s / 2, q * s, c], [-s / 2, -q * s, c]], atol=EXACT)
    np.testing.assert_allclose(B, np.eye(3) * 0.025 / R, atol=EXACT)


def test_atlas_jacobian_is_the_inverse_of_the_thesis():
    """Rows of [2.98], its signs reversed as E2 has it: (2, −1, −1)/(3 sin θ), (0, √3, −√3)/(3 sin θ), 1/(3 cos θ)."""
    expected = 0.025 / R / 3 * np.array([[2 / s, -1 / s, -1 / s], [0, 3**0.5 / s, -(3**0.5) / s], [1 / c, 1 / c, 1 / c]])
    np.testing.assert_allclose(K.jacobian(atlas(IDEAL)), expected, atol=EXACT)


@pytest.mark.parametrize("theta_deg", [1, 20, 40, 54.7356, 75, 89])
def test_atlas_determinant(theta_deg):
    theta = math.radians(theta_deg)
    expected = 1.5 * 3**0.5 * math.sin(theta) ** 2 * math.cos(theta)
    assert K.determinant(atlas(IDEAL, -theta_deg)) == pytest.approx(expected, abs=EXACT)


@pytest.mark.parametrize("alpha_deg", [30, 45, 60, 90, -30, -45, -60])
@pytest.mark.parametrize("theta_deg", [10, 40, 80])
def test_mecanum_atlas_determinant(alpha_deg, theta_deg):
    theta, cot = math.radians(theta_deg), 1 / math.tan(math.radians(alpha_deg))
    wheel = MecanumWheel(radius=0.025, rollers=16, roller_angle=math.radians(alpha_deg))
    expected = 1.5 * 3**0.5 * math.cos(theta) * (math.sin(theta) ** 2 + cot**2)
    assert K.determinant(atlas(wheel, -theta_deg)) == pytest.approx(expected, abs=4 * EXACT)


@pytest.mark.parametrize("alpha_deg", [20, 45, 60, 90, -20, -45, -60])
def test_orthogonal_determinant_with_roller_angle(alpha_deg):
    """det = cot³α − 1: singular at +45°, −2 at −45° (E9)."""
    alpha = math.radians(alpha_deg)
    cot = math.cos(alpha) / math.sin(alpha)
    assert K.determinant(orthogonal(alpha)) == pytest.approx(cot**3 - 1, abs=30 * EXACT)


def test_orthogonal_layout_is_singular_for_one_hand_only():
    with pytest.raises(SingularError, match="singular"):
        K.jacobian(orthogonal(math.pi / 4))
    assert K.determinant(orthogonal(-math.pi / 4)) == pytest.approx(-2, abs=EXACT)
    assert K.jacobian(orthogonal(-math.pi / 4)).shape == (3, 3)


def test_orthogonal_jacobian_is_the_one_of_the_thesis():
    """[2.93]: J = (r/R) [[0, 0, −1], [−1, 0, 0], [0, −1, 0]]."""
    expected = 0.025 / R * np.array([[0, 0, -1], [-1, 0, 0], [0, -1, 0]])
    np.testing.assert_allclose(K.jacobian(orthogonal()), expected, atol=EXACT)


def dual_race_inverse_jacobian_of_the_thesis(*numbers):
    """[2.72], the thesis's matrix written out entry by entry; ``numbers`` l, m, n are the races from 1."""
    d, reach = DUAL["race_spacing"], 2 * (R + DUAL["roller_radius"])
    ideal = np.array([[s, 0, c], [-s / 2, q * s, c], [-s / 2, -q * s, c]])
    sl, sm, sn = ((-1) ** number for number in numbers)
    correction = np.array([[sl * c, 0, -sl * s], [-sm * c / 2, sm * q * c, -sm * s], [-sn * c / 2, -sn * q * c, -sn * s]])
    return R / DUAL["radius"] * (math.sqrt(reach**2 - d**2) / reach * ideal + d / reach * correction)


@pytest.mark.parametrize("races", list(itertools.product((1, 2), repeat=3)))
def test_eight_dual_race_jacobians(races):
    expected = dual_race_inverse_jacobian_of_the_thesis(*races)
    np.testing.assert_allclose(K.inverse_jacobian(atlas(), races), expected, atol=R / 0.025 * EXACT)
    np.testing.assert_allclose(K.jacobian(atlas(), races), np.linalg.inv(expected), atol=EXACT)


def test_split_dual_race_has_the_single_race_rows():
    split = SplitDualRaceWheel(radius=0.025, rollers=16)
    for alpha in (math.pi / 2, 0.8, -0.8):
        wheel = SplitDualRaceWheel(radius=split.radius, rollers=split.rollers, roller_angle=alpha)
        single = K.constraint(atlas(IdealWheel(radius=0.025, roller_angle=alpha)))[0]
        for races in [(1, 1, 1), (2, 1, 2), (2, 2, 2)]:
            np.testing.assert_allclose(K.constraint(atlas(wheel), races)[0], single, atol=EXACT)
    np.testing.assert_allclose(K.contacts(atlas(split), (2, 2, 2)).contact_direction, -atlas(split).contact_directions)


def test_six_wheels_slip_as_the_thesis_says():
    """Each pair shares an axis and turns it at 1.25 rad/s: ratios 1/4 and 1/6, S = √(3/16 + 3/36) = 0.5204."""
    ratios, overall = K.slip(six_orthogonal(), [1, 1, 1, 1.5, 1.5, 1.5])
    np.testing.assert_allclose(ratios, [1 / 4] * 3 + [1 / 6] * 3, atol=EXACT)
    assert overall == pytest.approx(math.sqrt(3 / 16 + 3 / 36), abs=EXACT)
    assert round(float(overall), 4) == 0.5204


def test_six_wheels_led_by_three_do_not_slip():
    angular_velocity, speeds = K.master_slave(six_orthogonal(), [1, 2, 3])
    np.testing.assert_allclose(speeds, [1, 2, 3, 1, 2, 3], atol=EXACT)
    np.testing.assert_allclose(angular_velocity, 0.025 / R * np.array([-3, -1, -2]), atol=EXACT)
    assert K.slip(six_orthogonal(), speeds).overall == 0


def test_wheel_at_rest_that_slips_has_infinite_ratio():
    ratios, overall = K.slip(six_orthogonal(), [0, 1, 1, 1, 1, 1])
    assert np.isinf(ratios[0]) and np.isinf(overall) and ratios[3] == pytest.approx(0.5, abs=EXACT)
    ratios, overall = K.slip(six_orthogonal(), [0, 1, 1, 0, 1, 1])
    assert overall == 0 and (ratios == 0).all()


def test_effectiveness_of_standard_and_mecanum_atlas():
    """AᵀA is diagonal: 3/2 sin²θ twice and 3 cos²θ for α = 90°; for 45° the rows add cot α v̂ at right angles to Ω̂.

    With Ω̂ and v̂ orthogonal, Σ(Ω̂ + v̂)(Ω̂ + v̂)ᵀ = diag(3/2 (sin²θ + 1), same, 3 cos²θ) as the mixed sums cancel.
    """
    low, high = K.effectiveness(atlas(IDEAL))
    assert (low, high) == pytest.approx((1 / math.sqrt(3 * c * c), 1 / math.sqrt(1.5 * s * s)), abs=EXACT)
    assert (round(low, 3), round(high, 3)) == (0.754, 1.270)
    low45, high45 = K.effectiveness(atlas(MecanumWheel(radius=0.025, rollers=16)))
    assert (low45, high45) == pytest.approx((1 / math.sqrt(1.5 * (s * s + 1)), 1 / math.sqrt(3 * c * c)), abs=EXACT)
    assert (round(low45, 3), round(high45, 3)) == (0.687, 0.754)
    # The worst standard is the best Mecanum.
    assert high45 == pytest.approx(low, abs=EXACT)


def octant_range(wheel):
    """Range of ξ over non-negative wheel speeds, on a grid of the octant with its corners and edges."""
    steps = np.linspace(0, 1, 201)
    a, b = np.meshgrid(steps, steps)
    inside = a + b <= 1 + 1e-12
    speeds = np.stack([a[inside], b[inside], np.maximum(0, 1 - a[inside] - b[inside])], -1)
    xi = K.transmission(atlas(wheel), speeds).effectiveness
    return xi.min(), xi.max()


def test_effectiveness_over_the_figures_speeds():
    """One wheel alone: ξ² = Σ of the first column of A⁻¹ squared = (4/9)/s² + (1/9)/c²; all alike: the z axis, 1/(√3 c)."""
    low, high = octant_range(IDEAL)
    assert high == pytest.approx(math.sqrt(4 / 9 / s**2 + 1 / 9 / c**2), abs=EXACT)
    assert low == pytest.approx(1 / (math.sqrt(3) * c), abs=1e-4)
    assert (round(low, 3), round(high, 3)) == (0.754, 1.125)
    low45, high45 = octant_range(MecanumWheel(radius=0.025, rollers=16))
    assert (round(low45, 3), round(high45, 3)) == (0.710, 0.754)


def test_transmission_ratio_is_effectiveness_by_the_radii():
    """ξ = (R / r) τ [4.8]."""
    ratio, xi = K.transmission(atlas(IDEAL), [[1.0, 2, 3], [1, 0, 0]])
    np.testing.assert_allclose(xi, R / 0.025 * ratio, rtol=EXACT)


def test_isotropic_elevation_of_the_three_wheel_atlas():
    """σ₁ = σ₃ where 3 cos²θ = 3/2 sin²θ: tan θ = √2."""
    design = atlas(IDEAL, -math.degrees(math.atan(math.sqrt(2))))
    assert K.isotropy(design) == pytest.approx(1, abs=EXACT)
    assert K.isotropy(orthogonal()) == pytest.approx(1, abs=EXACT)


def test_triple_race_outer_races_stay_level_with_the_centre_race():
    """Every race of a wheel whose centre is fixed touches the same sphere: |centre + o ŵ + (r_o − r_r) …| as in section 1."""
    wheel = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=10e-3)
    outer, centre, _ = wheel.races(R)
    delta = outer.deflection(R)
    assert math.sin(delta) == pytest.approx(-0.01 / (R + 0.004), abs=EXACT)
    # Height of the wheel's centre above the sphere's, seen from each race: (R + r_r) cos Δθ + r − r_r.
    heights = [(R + 4e-3) * math.cos(race.deflection(R)) + race.radius - 4e-3 for race in (outer, centre)]
    assert heights[0] == pytest.approx(heights[1], abs=EXACT)


def test_nearest_singularity_of_known_layouts():
    """Atlas: det vanishes at θ = 0 and 90°; its heading at ±90° (rows then lie in a plane). Orthogonal: α = 45°."""
    near = K.nearest_singularity(atlas(IDEAL, -40))
    assert near.parameter == "elevation" and math.degrees(near.change) == pytest.approx(40, abs=1e-6)
    near = K.nearest_singularity(atlas(IDEAL, -70))
    assert near.parameter == "elevation" and math.degrees(near.change) == pytest.approx(-20, abs=1e-6)
    wheel = IdealWheel(radius=0.025, roller_angle=math.radians(52))
    near = K.nearest_singularity(atlas(wheel, -40))
    assert near.parameter == "elevation" and math.degrees(near.change) == pytest.approx(-50, abs=1e-6)
    # Heading and roller angle turn a row in the same plane: 5° of either makes the orthogonal layout singular.
    assert abs(math.degrees(K.nearest_singularity(orthogonal(math.radians(50))).change)) == pytest.approx(5, abs=1e-6)
    lean = _singular_change(orthogonal(math.radians(50)), "roller_angle")
    assert math.degrees(lean.change) == pytest.approx(-5, abs=1e-6)
    assert K.nearest_singularity(six_orthogonal()) is None


def test_collinear_layout_has_independent_rows():
    """Ω̂ = j, k, i [2.100]."""
    A, _ = K.constraint(collinear_triple())
    np.testing.assert_allclose(A, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=EXACT)


def test_dual_race_wheels_at_equal_speeds_keep_direction_but_not_magnitude():
    """All on race 1: Ω = (r/R) ω z/(cos(θ + Δθ)) against 1/cos θ, −3.3 % and +3.5 % of magnitude (E9)."""
    delta = DualRaceWheel(**DUAL).races(R)[1].deflection(R)
    for race, tilt in ((1, -delta), (2, delta)):
        Omega = K.forward(atlas(), [1, 1, 1], [race] * 3)
        np.testing.assert_allclose(Omega[:2], 0, atol=EXACT)
        assert Omega[2] == pytest.approx(0.025 / R / math.cos(THETA + tilt), abs=EXACT)
        magnitude = K.race_error(Omega, K.forward(atlas(), [1, 1, 1])).magnitude
        assert magnitude == pytest.approx(1 - math.cos(THETA + tilt) / math.cos(THETA), abs=EXACT)
