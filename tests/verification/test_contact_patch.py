"""Hertz's patch against printed numbers, closed forms and its own elasticity problem; the resistances against power.

EXACT = 1e-12, relative, wherever both sides are the same formula in another form: some tens of operations on numbers without
cancellation, rounded to 1.1e-16 each.
"""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, optimize, special

from layouts import R, atlas
from spheredrive.contact import contact_modulus, hertz, relative_radii, resistance_arms, resistance_moment, wheel_hertz
from spheredrive.design import Contact, Design, Placement, Sphere
from spheredrive.wheels import IdealWheel, MecanumWheel, StandardWheel

EXACT = 1e-12
STEADY = settings(derandomize=True, deadline=None, max_examples=60)
radius_ratios = st.floats(-6, 6).map(lambda decades: 10**decades)


# Printed numbers: tolerance is half a unit of the last digit printed.


def test_ball_on_rigid_flat():
    patch = hertz(60 * math.pi, 8e-3, modulus=contact_modulus(1e9, 0.3, math.inf, 0.0))
    assert patch.a == pytest.approx(1.00964e-3, abs=0.5e-8)


def test_two_equal_spheres_of_code_aster():
    modulus = contact_modulus(20e9, 0.3, 20e9, 0.3)
    patch = hertz(586.08e3, 25e-3, modulus=modulus)
    # The force is given to five digits; a follows it with power 1/3, δ with 2/3 and p₀ with 1/3.
    assert patch.a == pytest.approx(10e-3, rel=1e-5 / 3)
    assert patch.approach == pytest.approx(4e-3, rel=2e-5 / 3)
    assert patch.peak_pressure == pytest.approx(2798.33e6, rel=1e-5 / 3 + 2e-6)
    exact_force = optimize.brentq(lambda force: hertz(force, 25e-3, modulus=modulus).approach - 4e-3, 1e5, 1e6, xtol=1e-6)
    assert exact_force == pytest.approx(586.08e3, abs=5)
    assert hertz(exact_force, 25e-3, modulus=modulus).peak_pressure == pytest.approx(2798.33e6, abs=5e3)


def test_steel_ball_on_plastic():
    patch = hertz(100.0, 25e-3, modulus=contact_modulus(190e9, 0.3, 3e9, 0.4))
    assert patch.a == pytest.approx(0.8113e-3, abs=0.5e-7)
    assert patch.approach == pytest.approx(0.026328e-3, abs=0.5e-9)


@pytest.mark.parametrize(
    ("theta_deg", "m", "n"),
    [(30, 2.731, 0.493), (45, 1.926, 0.604), (60, 1.486, 0.717), (75, 1.202, 0.846), (80, 1.128, 0.893), (90, 1.0, 1.0)],
)
def test_semi_axes_of_the_table_in_timoshenko_and_goodier(theta_deg, m, n):
    """Theory of Elasticity, art. 140: cos θ = (B − A)/(B + A), semi-axes m and n times (3N/(4 E* (A + B)))^(1/3).

    Tolerance 2e-3: three decimals, computed by hand.
    """
    A, B = 1 - math.cos(math.radians(theta_deg)), 1 + math.cos(math.radians(theta_deg))
    patch = hertz(4 / 3 * (A + B), 1 / (2 * A), 1 / (2 * B), modulus=1.0)
    assert (patch.a, patch.b) == (pytest.approx(m, abs=2e-3), pytest.approx(n, abs=2e-3))


# The circular patch.


@given(st.floats(1e-6, 1e6), st.floats(1e-4, 1e2), st.floats(1e4, 1e12))
@STEADY
def test_circular_patch_is_the_closed_form(force, radius, modulus):
    """[3.13–3.15] as model.md section 4 prints them."""
    patch = hertz(force, radius, modulus=modulus)
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    assert patch.a == pytest.approx(a, rel=EXACT) and patch.b == patch.a
    assert patch.peak_pressure == pytest.approx(3 * force / (2 * math.pi * a**2), rel=EXACT)
    assert patch.approach == pytest.approx((9 * force**2 / (16 * radius * modulus**2)) ** (1 / 3), rel=EXACT)
    assert patch.stiffness == pytest.approx(2 * modulus * a, rel=EXACT)
    np.testing.assert_allclose(hertz(force, radius, radius, modulus=modulus), patch, rtol=EXACT)


@pytest.mark.parametrize("offset", [1e-16, 1e-15, 1e-13, 1e-10, 1e-8, 1e-6, 1e-5, 5e-5, 2e-4, 1e-3])
def test_elliptical_patch_passes_smoothly_into_the_circular_one(offset):
    """R_a = e^x, R_b = e^−x: ln(a/b) = (2/3) ln(R_a/R_b) + third order, and δ, K, ab are even in x."""
    stretched = hertz(1.0, math.exp(offset), math.exp(-offset), modulus=1.0)
    round_ = hertz(1.0, 1.0, modulus=1.0)
    # Third order: B/D = 1 − m/4 − m²/8 …, odd in ln(a/b) by the symmetry of exchange, with a factor below one.
    assert math.log(stretched.a / stretched.b) == pytest.approx(4 / 3 * offset, abs=offset**3 + EXACT)
    for value, limit in zip(stretched[2:], round_[2:], strict=True):
        assert value == pytest.approx(limit, rel=offset**2 + EXACT)


# The elliptical patch.


@given(radius_ratios, st.floats(0.01, 1e4))
@STEADY
def test_semi_axes_solve_hertz_by_carlsons_integrals(ratio, force):
    """Johnson (4.28) by an independent evaluation: D = R_D(0, m′, 1)/3, B = m′ R_D(0, 1, m′)/3, K = R_F(0, m′, 1)."""
    patch = hertz(force, 0.1 * ratio, 0.1, modulus=2e9)
    long, short = max(patch.a, patch.b), min(patch.a, patch.b)
    m_prime = (short / long) ** 2
    K, D, B = special.elliprf(0, m_prime, 1), special.elliprd(0, m_prime, 1) / 3, m_prime * special.elliprd(0, 1, m_prime) / 3
    assert B / (m_prime * D) == pytest.approx(max(ratio, 1 / ratio), rel=EXACT)
    R_long = 0.1 * max(ratio, 1.0)
    assert long**3 == pytest.approx(3 * force * R_long * D / (math.pi * 2e9), rel=EXACT)
    assert patch.approach == pytest.approx(3 * force * K / (2 * math.pi * long * 2e9), rel=EXACT)
    assert (patch.a > patch.b) == (ratio > 1) or ratio == pytest.approx(1)


def displacement(patch, modulus, x, y):
    """Surface displacement u of the half-space of modulus E* under the patch's pressure, at a point inside the patch.

    u = 1/(π E*) ∫ p/|distance| dA [Boussinesq]: in polar coordinates about the point the area element cancels the distance, and
    what is left is p along each chord through the point: a half ellipse, integrated by its own midpoint rule (exact).
    """
    tau = (np.arange(8) + 0.5) * np.pi / 8

    def along_chord(angle):
        c, s = math.cos(angle), math.sin(angle)
        # 1 − (x + s c)²/a² − (y + s s)²/b² = rest − 2 slope s − bend s²
        bend, slope = (c / patch.a) ** 2 + (s / patch.b) ** 2, x * c / patch.a**2 + y * s / patch.b**2
        half = math.sqrt((1 - (x / patch.a) ** 2 - (y / patch.b) ** 2) / bend + (slope / bend) ** 2)
        middle = -slope / bend
        at = middle + half * np.cos(tau)
        pressure = np.sqrt(1 - ((x + at * c) / patch.a) ** 2 - ((y + at * s) / patch.b) ** 2)
        return np.sum(pressure * half * np.sin(tau)) * np.pi / 8

    # The chord is longest, and narrowly so, along the long axis.
    turn = 0.0 if patch.a > patch.b else math.pi / 2
    width = min(patch.a, patch.b) / max(patch.a, patch.b)
    corners = [turn + f * width for f in (-10, -3, -1, 0, 1, 3, 10) if abs(f) * width < math.pi / 2]
    edges = [turn - math.pi / 2, *corners, turn + math.pi / 2]
    pieces = [integrate.quad(along_chord, *pair, epsabs=0, epsrel=1e-12)[0] for pair in itertools.pairwise(edges)]
    return patch.peak_pressure * sum(pieces) / (math.pi * modulus)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 10.0, 200.0, 1e4, 1 / 3, 1 / 50])
def test_pressure_of_the_patch_presses_the_surfaces_together(ratio):
    """Inside the patch u = δ − x²/(2 R_a) − y²/(2 R_b): the elasticity problem itself, to the quadrature's 1e-9 of δ."""
    R_a, R_b, modulus = 0.05 * ratio, 0.05, 3e9
    patch = hertz(40.0, R_a, R_b, modulus=modulus)
    for f, g in [(0, 0), (0.6, 0), (0, 0.6), (0.9, 0.3), (-0.4, 0.7)]:
        x, y = f * patch.a, g * patch.b
        expected = patch.approach - x**2 / (2 * R_a) - y**2 / (2 * R_b)
        assert displacement(patch, modulus, x, y) == pytest.approx(expected, abs=1e-9 * patch.approach)


@pytest.mark.parametrize("ratio", [1.0, 7.0, 0.02])
def test_force_is_the_integral_of_the_pressure(ratio):
    """In x = a ρ cos, y = b ρ sin: N = p₀ a b ∫∫ √(1 − ρ²) ρ, by quadrature."""
    patch = hertz(12.0, 0.03 * ratio, 0.03, modulus=5e8)
    per_turn, _ = integrate.quad(lambda rho: math.sqrt(1 - rho**2) * rho, 0, 1, epsrel=1e-12)
    # QUADPACK meets a root at the edge, where it keeps ten digits.
    assert patch.peak_pressure * patch.a * patch.b * 2 * math.pi * per_turn == pytest.approx(12.0, rel=1e-10)


@given(radius_ratios, st.floats(1e-3, 1e3))
@STEADY
def test_exchange_of_the_radii_exchanges_the_semi_axes(ratio, radius):
    one, other = hertz(3.0, ratio * radius, radius, modulus=1e9), hertz(3.0, radius, ratio * radius, modulus=1e9)
    assert (one.a, one.b) == (other.b, other.a) and one[2:] == other[2:]


@given(radius_ratios, st.floats(1e-3, 1e3), st.floats(1e-2, 1e2))
@STEADY
def test_scaling_with_force(ratio, force, factor):
    """a, b, p₀, K grow with N^(1/3), δ with N^(2/3)."""
    one = hertz(force, 0.1 * ratio, 0.1, modulus=1e9)
    more = hertz(force * factor, 0.1 * ratio, 0.1, modulus=1e9)
    powers = (1 / 3, 1 / 3, 1 / 3, 2 / 3, 1 / 3)
    np.testing.assert_allclose(np.array(more) / np.array(one), [factor**p for p in powers], rtol=EXACT)


@given(radius_ratios, st.floats(1e-3, 1e3))
@STEADY
def test_stiffness_is_the_derivative_of_force_by_approach(ratio, force):
    """Central difference of δ(N) with step h N: its own error is (h²/6) δ‴N³/δ′N = (2/27) h² relative; rounding 1e-15/h."""
    h = 1e-5

    def approach(load):
        return hertz(load, 0.1 * ratio, 0.1, modulus=1e9).approach

    compliance = (approach(force * (1 + h)) - approach(force * (1 - h))) / (2 * h * force)
    patch = hertz(force, 0.1 * ratio, 0.1, modulus=1e9)
    assert patch.stiffness == pytest.approx(1 / compliance, rel=1e-9)
    assert patch.stiffness == pytest.approx(1.5 * force / patch.approach, rel=EXACT)


# Shapes of rollers.


def test_relative_radii_of_a_standard_wheel_are_those_of_its_outline():
    """α = 90°: the barrel's meridian is the wheel's own circle, its cross-section the roller's."""
    across, along = relative_radii(atlas(StandardWheel(radius=0.03, rollers=8, roller_radius=0.006)))
    np.testing.assert_allclose(across, 1 / (1 / R + 1 / 0.006), rtol=EXACT)
    np.testing.assert_allclose(along, 1 / (1 / R + 1 / 0.03), rtol=EXACT)


@pytest.mark.parametrize("alpha_deg", [90, 60, 45, -45, 20])
def test_meridian_of_a_barrel_is_that_of_the_roller_cut_to_the_wheels_cylinder(alpha_deg):
    """A roller turns about its own axis inside the wheel's cylinder, so its radius at each section is the least distance from
    its axis to the cylinder within that section. The curvature of this meridian at mid-roller, by central difference.

    Step x = 1e-3 a: error of order (x/a)² = 1e-6 from the fourth derivative.
    """
    r, r_r, alpha = 0.05, 0.011, math.radians(alpha_deg)
    a = r - r_r
    axis = np.array([0.0, math.sin(alpha), math.cos(alpha)])
    radial, side = np.array([1.0, 0, 0]), np.array([0.0, math.cos(alpha), -math.sin(alpha)])

    def section_radius(x):
        origin = a * radial + x * axis

        def reach(angle):
            direction = math.cos(angle) * radial + math.sin(angle) * side
            # |origin + t direction| = r in the plane square to the wheel's axis z
            d, o = direction[:2], origin[:2]
            return (-(d @ o) + math.sqrt((d @ o) ** 2 + (d @ d) * (r * r - o @ o))) / (d @ d)

        return optimize.minimize_scalar(reach, bounds=(-0.5, 0.5), method="bounded", options={"xatol": 1e-9}).fun

    x = 1e-3 * a
    curvature = -(section_radius(x) - 2 * section_radius(0.0) + section_radius(-x)) / x**2
    wheel = MecanumWheel(radius=r, rollers=9, roller_radius=r_r, roller_angle=alpha)
    across, along = relative_radii(atlas(wheel))
    assert section_radius(0.0) == pytest.approx(r_r, rel=EXACT)
    # Second difference of r_r = 0.011, rounded to 2e-18, over x² = 1.5e-9: 4e-9/m, far below 1e-5 of the curvature.
    np.testing.assert_allclose(1 / along, 1 / R + curvature, rtol=1e-5)
    np.testing.assert_allclose(1 / across, 1 / R + 1 / r_r, rtol=EXACT)


@pytest.mark.parametrize(("shape", "along"), [("cylinder", R), ("capsule", R), ("sphere", 1 / (1 / R + 1 / 0.006))])
def test_relative_radii_of_other_roller_shapes(shape, along):
    wheel = StandardWheel(radius=0.03, rollers=8, roller_radius=0.006, roller_shape=shape)
    np.testing.assert_allclose(relative_radii(atlas(wheel))[1], along, rtol=EXACT)


ELASTIC = dict(young_modulus=4e6, poisson_ratio=0.45)


def elastic_machine(wheel, contact=None) -> Design:
    placed = [Placement.at(wheel, 2 * math.pi * i / 3, math.radians(-40)) for i in range(3)]
    return Design("elastic", Sphere(R, young_modulus=2e9, poisson_ratio=0.35), placed, contact or Contact())


def test_patch_of_a_wheel_is_flat_across_its_roller():
    """The roller is thin across û and long along it, so is the patch: b (along) exceeds a (across)."""
    design = elastic_machine(StandardWheel(radius=0.03, rollers=8, roller_radius=0.006, **ELASTIC))
    across, along = relative_radii(design)
    modulus = contact_modulus(2e9, 0.35, 4e6, 0.45)
    patch = wheel_hertz(design, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(patch, hertz([1.0, 2.0, 3.0], across, along, modulus=modulus), rtol=EXACT)
    assert (patch.b > patch.a).all()


def test_circular_patch_of_a_wheel_is_the_thesis():
    design = elastic_machine(StandardWheel(radius=0.03, rollers=8, roller_radius=0.006, **ELASTIC))
    patch = wheel_hertz(design, 5.0, circular=True)
    expected = hertz(5.0, 1 / (1 / R + 1 / 0.03), modulus=contact_modulus(2e9, 0.35, 4e6, 0.45))
    np.testing.assert_allclose(patch, np.repeat(np.array(expected)[:, None], 3, 1), rtol=EXACT)
    np.testing.assert_allclose(wheel_hertz(elastic_machine(IdealWheel(radius=0.03, **ELASTIC)), 5.0), patch, rtol=EXACT)


# Arms.


def test_arms_of_a_circular_patch_are_those_of_the_thesis():
    """l_r = a, l_s = 3π a/16 [3.30]."""
    design = elastic_machine(MecanumWheel(radius=0.03, rollers=8, roller_radius=0.006, **ELASTIC))
    force = np.array([[1.0, 2.0, 3.0], [0.0, 20.0, 1e-6]])
    a = wheel_hertz(design, force, circular=True).a
    rolling, spin = resistance_arms(design, force, circular=True)
    np.testing.assert_allclose(rolling, a, rtol=EXACT)
    np.testing.assert_allclose(spin, 3 * math.pi / 16 * a, rtol=EXACT)


@pytest.mark.parametrize("roller_radius", [0.003, 0.012, 0.0299])
def test_spin_arm_is_the_moment_of_the_pressure(roller_radius):
    """l_s = ∫ p |r| dA / N over the ellipse, by quadrature (ten digits, for the root at the edge)."""
    design = elastic_machine(StandardWheel(radius=0.03, rollers=8, roller_radius=roller_radius, **ELASTIC))
    patch = wheel_hertz(design, 7.0)
    a, b, p0 = patch.a[0], patch.b[0], patch.peak_pressure[0]
    radial, _ = integrate.quad(lambda rho: math.sqrt(1 - rho**2) * rho**2, 0, 1, epsrel=1e-12)
    angular, _ = integrate.quad(lambda u: math.hypot(a * math.cos(u), b * math.sin(u)), 0, 2 * math.pi, epsrel=1e-12)
    np.testing.assert_allclose(resistance_arms(design, 7.0)[1], p0 * a * b * radial * angular / 7.0, rtol=1e-10)


@pytest.mark.parametrize("alpha_deg", [90, 45, -45, 20])
def test_rolling_arm_is_the_reach_of_the_patch_along_the_drive_direction(alpha_deg):
    """The patch lies along û = sin α v̂ − cos α Ω̂; its outline is walked round in the frame (v̂, Ω̂).

    2000 points: the largest is missed by (π/2000)²/2 = 1.2e-6 at most.
    """
    alpha = math.radians(alpha_deg)
    design = elastic_machine(MecanumWheel(radius=0.03, rollers=8, roller_radius=0.006, roller_angle=alpha, **ELASTIC))
    patch = wheel_hertz(design, 4.0)
    u_hat, across = np.array([math.sin(alpha), -math.cos(alpha)]), np.array([math.cos(alpha), math.sin(alpha)])
    turn = np.linspace(0, 2 * math.pi, 2000)[:, None]
    outline = patch.b[0] * np.cos(turn) * u_hat + patch.a[0] * np.sin(turn) * across
    rolling = resistance_arms(design, 4.0)[0]
    np.testing.assert_allclose(rolling, outline[:, 0].max(), rtol=2e-6)
    if alpha_deg == 90:
        np.testing.assert_allclose(rolling, patch.b, rtol=EXACT)


# Resistance.


def random_motion(seed, batch=()):
    rng = np.random.default_rng(seed)
    n = 4
    frames = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    R_hat, v_hat = frames[:, 0], frames[:, 1]
    speeds = 10.0 ** rng.uniform(-5, 2)
    Omega, omega = speeds * rng.normal(size=(*batch, 3)), speeds * rng.normal(size=(*batch, n))
    N, l_r, l_s = rng.uniform(0, 50, (*batch, n)), rng.uniform(0, 1e-2, n), rng.uniform(0, 1e-2, n)
    return Omega, omega, R_hat, v_hat, N, l_r, l_s, rng.uniform(0, 1)


@given(st.integers(0, 2**32 - 1))
@STEADY
def test_resistance_takes_power_and_never_gives_it(seed):
    """M · Ω on the sphere and −M · ŵ ω on the wheel add up to −(N l_r |w_⊥|²/… + μ N l_s w_n²/…), written out here."""
    Omega, omega, R_hat, v_hat, N, l_r, l_s, mu = random_motion(seed, (3, 2))
    M = resistance_moment(Omega, omega, R_hat, v_hat, N, l_r, l_s, mu)
    w_hat = np.cross(v_hat, R_hat)
    sphere_power = np.sum(M * Omega[..., None, :], -1)
    wheel_power = -np.sum(M * w_hat, -1) * omega
    relative = Omega[..., None, :] - omega[..., None] * w_hat
    spin = np.einsum("...ij,ij->...i", relative, R_hat)
    roll_squared = np.sum(relative**2, -1) - spin**2
    loss = N * l_r * roll_squared / np.sqrt(roll_squared + 1e-6) + mu * N * l_s * spin**2 / np.sqrt(spin**2 + 1e-6)
    # Powers of either sign cancel to the loss: rounding is measured on their own size.
    size = np.max(np.abs(sphere_power) + np.abs(wheel_power), initial=1e-300)
    np.testing.assert_allclose(sphere_power + wheel_power, -loss, rtol=0, atol=1e-13 * size + EXACT * loss.max())
    assert (loss >= 0).all() and loss.max() > 0


def test_resistance_of_a_turning_sphere_on_a_wheel_at_rest():
    """Contact below (R̂ = −z), wheel driving east (v̂ = x, ŵ = −R̂ × v̂ = y), at speeds far above the smoothing.

    Rolling about x at Ω_x > 0 gets −N l_r along x; spinning about +z gets −μ N l_s along +z; both at once share nothing.
    """
    at = dict(contact_direction=[[0, 0, -1]], drive_direction=[[1, 0, 0]], normal_force=[10.0], rolling_arm=[2e-3])
    rest = dict(**at, spin_arm=[1e-3], friction=0.5, smoothing=1e-9, wheel_speed=[0.0])
    # (ε/w)² / 2 = 5e-19 short of the full value.
    np.testing.assert_allclose(resistance_moment([1, 0, 0], **rest), [[-0.02, 0, 0]], atol=EXACT)
    np.testing.assert_allclose(resistance_moment([0, -1, 0], **rest), [[0, 0.02, 0]], atol=EXACT)
    np.testing.assert_allclose(resistance_moment([0, 0, 1], **rest), [[0, 0, -0.005]], atol=EXACT)
    np.testing.assert_allclose(resistance_moment([0, 3, -4], **rest), [[0, -0.02, 0.005]], atol=EXACT)


def test_resistance_is_of_the_relative_motion():
    """Gears: ω > 0 turns the wheel about ŵ = y and the sphere about −y: both add to w = Ω − ω ŵ. Turned as one, w = 0."""
    below = dict(contact_direction=[[0, 0, -1]], drive_direction=[[1, 0, 0]], normal_force=[10.0])
    arms = dict(rolling_arm=[2e-3], spin_arm=[1e-3], friction=0.5)
    M = resistance_moment([0, -0.5, 0], [2.0], **below, **arms, smoothing=1e-9)
    np.testing.assert_allclose(M, [[0, 0.02, 0]], atol=EXACT)
    # The wheel's motor feels a brake: −M · ŵ opposes ω.
    assert -(M[0] @ [0, 1, 0]) < 0
    np.testing.assert_allclose(resistance_moment([0, 2.0, 0], [2.0], **below, **arms), [[0, 0, 0]], atol=0)


@given(st.integers(0, 2**32 - 1))
@STEADY
def test_resistance_vanishes_at_rest_and_is_linear_near_it(seed):
    """At rest zero; for |w| ≪ ε, M = −(N l_r w_⊥ + μ N l_s w_n R̂)/ε to (|w|/ε)²/2."""
    Omega, omega, R_hat, v_hat, N, l_r, l_s, mu = random_motion(seed)
    assert (resistance_moment(0 * Omega, 0 * omega, R_hat, v_hat, N, l_r, l_s, mu) == 0).all()
    w_hat = np.cross(v_hat, R_hat)
    relative = Omega - omega[:, None] * w_hat
    epsilon = 1e4 * np.abs(relative).max()
    spin = np.sum(relative * R_hat, -1)[:, None] * R_hat
    linear = -(N * l_r)[:, None] * (relative - spin) / epsilon - (mu * N * l_s)[:, None] * spin / epsilon
    M = resistance_moment(Omega, omega, R_hat, v_hat, N, l_r, l_s, mu, smoothing=epsilon)
    np.testing.assert_allclose(M, linear, atol=3e-8 * np.abs(linear).max())


def test_resistance_at_a_race_beside_the_middle_spins_with_the_wheel():
    """R̂ tilted by Δθ towards ŵ: a wheel that turns at ω under a sphere at rest spins at −ω sin Δθ about R̂."""
    tilt, w_hat = 0.1, np.array([0.0, 1.0, 0.0])
    R_hat = math.cos(tilt) * np.array([0, 0, -1.0]) + math.sin(tilt) * w_hat
    M = resistance_moment([0, 0, 0], [2.0], [R_hat], [[1, 0, 0]], [10.0], [0.0], [1e-3], 0.5, 1e-9, wheel_axis=[w_hat])
    np.testing.assert_allclose(M[0], 0.005 * R_hat, atol=EXACT)
