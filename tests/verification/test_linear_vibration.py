"""Linear vibration against closed forms: oscillators, seats, harmonics, impulses, isolation."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from layouts import atlas, orthogonal
from spheredrive import vibration
from spheredrive.design import Closure, Contact, Design, Mount, Placement, Sphere, Spring, Stage
from spheredrive.shape import Profile, profile
from spheredrive.vibration.model.links import linked_form
from spheredrive.vibration.model.modal import modal_form, output_vectors
from spheredrive.wheels import IdealWheel, MecanumWheel, StandardWheel

THETA = math.radians(40)
DEMO = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25)
HALF_SINE = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25, profile="half-sine")


def demonstrator(wheel=DEMO, stiffness=188208.0, damping=0.0, **parts) -> Design:
    design = atlas(wheel, radius=1.22)
    return replace(design, sphere=Sphere(1.22, 5.0), contact=Contact(stiffness, damping), stage=Stage(5.0, True), **parts)


def sine(amplitude: float, rollers: int = 1, pieces: int = 16, degree: int = 18) -> Profile:
    """h = A sin(n ϑ): Taylor polynomials about the middle of each piece, to the last digit."""
    period = 2 * math.pi / rollers
    edges = np.linspace(0, period, pieces + 1)
    width = period / pieces
    u = np.polynomial.Polynomial([-0.5, 1.0]) * (rollers * width)
    rows = np.zeros((pieces, degree + 1))
    for row, middle in zip(rows, (edges[:-1] + edges[1:]) / 2, strict=True):
        series = sum((math.sin(rollers * middle + k * math.pi / 2) / math.factorial(k)) * u**k for k in range(degree + 1))
        row[: len(series.coef)] = amplitude * series.coef
    return replace(flat(), period=period, breakpoints=edges, coefficients=rows, slope_jumps=np.zeros(pieces))


def flat() -> Profile:
    return profile(IdealWheel(radius=0.05), 0.15)


def one_axis(stiffness, damping) -> Design:
    """Three orthogonal wheels: the first moves the sphere along −x as a plain oscillator."""
    design = replace(orthogonal(), sphere=Sphere(0.15, 1.0), contact=Contact(stiffness, damping))
    return replace(design, stage=Stage(5.0, False))


def test_natural_frequencies_atlas_rigid_mounts():
    # Σ n̂n̂ᵀ of a ring of three: (3/2) cos²θ twice in the plane, 3 sin²θ along the axis.
    modes = vibration.modes(demonstrator(IdealWheel(radius=0.0758)))
    ratio = modes.natural_frequencies * 2 * math.pi / math.sqrt(188208 / 5)
    plane, axis = math.sqrt(1.5) * math.cos(THETA), math.sqrt(3) * math.sin(THETA)
    np.testing.assert_allclose(ratio, [plane, plane, axis], rtol=1e-12)
    np.testing.assert_allclose(np.abs(modes.shapes[2]), [0, 0, 1], atol=1e-12)
    np.testing.assert_array_equal(modes.damping_ratios, 0)


def test_natural_frequencies_rise_with_a_restoring_closure_and_fall_with_the_thesis_sign():
    # One contact alone on a rigid mount: ω² = (K ± K′)/M_s (E1).
    design = demonstrator(closure=Closure(stiffness=2e4))
    for model, stiffness in (("independent", 188208 + 2e4), ("thesis", 188208 - 2e4)):
        modes = vibration.modes(design, model)
        np.testing.assert_allclose((2 * math.pi * modes.natural_frequencies) ** 2, stiffness / 5, rtol=1e-12)


def test_damping_ratio_of_one_axis():
    modes = vibration.modes(one_axis(25.0, 0.4))
    np.testing.assert_allclose(modes.damping_ratios, 0.4 / (2 * math.sqrt(25.0)), rtol=1e-12)
    np.testing.assert_allclose(modes.damped_frequencies, math.sqrt(25 - 0.04) / (2 * math.pi), rtol=1e-12)


def test_forced_oscillator_of_the_cases():
    # m = 1, c = 0.4, k = 25, F = 3 cos 4t from rest: F = K h + C ḣ of a shape h = |h| sin(4t + β).
    drive = 25 + 0.4j * 4
    amplitude, beta = 3 / abs(drive), math.pi / 2 - np.angle(drive)
    design = one_axis(25.0, 0.4)
    profiles = (sine(amplitude), flat(), flat())
    options = dict(profiles=profiles, wheel_angle=[beta, 0, 0])
    # n̂ of the first wheel is −x. The start at rest differs from the case's by nothing: c = ċ = 0 there.
    run = vibration.transient(design, [4.0, 0, 0], 5.0, 1000.0, **options)
    assert -run.displacement[-1, 0] == pytest.approx(0.0701158166, abs=5e-11)
    steady = vibration.response(design, [4.0, 0, 0], **options)
    assert steady.peak_displacement == pytest.approx(0.3281875026, abs=5e-11)
    t = np.linspace(0, 3, 50)
    np.testing.assert_allclose(-steady.at(t).displacement[:, 0], 0.3281875026 * np.cos(4 * t - 0.1759396255), atol=1e-10)
    assert steady.rms_displacement == pytest.approx(0.3281875026 / math.sqrt(2), abs=1e-10)


@pytest.mark.parametrize("damping", [0.0, 1e-6, 1.0, 9.999, 10.0, 10.0000001, 11.0, 1e4, 1e8])
def test_free_decay_of_one_axis_at_any_damping(damping):
    # A step in h from rest: the oscillator's own solution by a matrix exponential of two rows, exact for critical damping too.
    step = 1e-3
    h = replace(flat(), coefficients=np.array([[step]]))
    design = one_axis(25.0, damping)
    run = vibration.transient(design, [0.0, 0, 0], 2.0, 10.0, profiles=(h, flat(), flat()))
    if damping == 10.0:
        # Critical: 1 − (1 + λt) e^{−λt}.
        exact = 1 - (1 + 5 * run.time) * np.exp(-5 * run.time)
    elif damping < 1e3:
        A = np.array([[0, 1], [-25.0, -damping]])
        exact = np.array([1 - (expm(A * t) @ [1, 0])[0] for t in run.time])
    else:
        # Far overdamped: λ₁ ≈ −c at once and λ₂ = 25/λ₁; expm loses the slow one.
        quick = -damping / 2 * (1 + math.sqrt(1 - 100 / damping**2))
        slow = 25 / quick
        exact = -np.expm1(slow * run.time) - slow / (quick - slow) * (np.exp(slow * run.time) - np.exp(quick * run.time))
    np.testing.assert_allclose(-run.displacement[:, 0], step * exact, atol=1e-13 * step)


def test_two_poles_that_meet_without_common_modes():
    # A wheel on its mount under a sphere, damped to where two real poles meet: there eigenvectors have no digits left.
    M, K = np.diag([5.0, 0.25]), np.array([[2e5, -1.9e5], [-1.9e5, 1.2e6]])
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
    low, high = 100.0, 1e5

    def complex_poles(c):
        A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, c * pair)]])
        return int(np.sum(np.abs(np.linalg.eigvals(A).imag) > 1e-12))

    assert complex_poles(low) == 4 > complex_poles(high)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if complex_poles(middle) == 4 else (low, middle)
    D, Bk, Bc = high * pair, np.array([[1.0, 2], [3, -1]]), np.array([[0.1, 0.2], [0, 0.1]])
    *_, worst = modal_form(M, D, K, Bk, Bc)
    assert worst > 1e4
    lam, link, b, V = linked_form(M, D, K, Bk, Bc)
    Vq, _ = output_vectors(lam, link, V)
    for s in (20j, 400j, 3 + 5000j):
        exact = np.linalg.solve(s**2 * M + s * D + K, Bk + s * Bc)
        static = np.linalg.solve(K, Bk)
        total = static.astype(complex)
        # Re of the states: half the sum with the conjugate system.
        for poles, drive, out in ((lam, b, Vq), (lam.conj(), b.conj(), Vq.conj())):
            w = np.zeros((len(lam), 2), complex)
            for r in range(len(lam)):
                w[r] = (s * drive[r] + (w[r - 1] if link[r] else 0)) / (s - poles[r])
            total += out @ w / 2
        np.testing.assert_allclose(total, exact, atol=1e-11 * np.abs(static).max())


def test_static_seat():
    # cases.md: N = M_s g/(3 sin 40°) with g = 9.81 there, 9.80665 here.
    design = replace(atlas(IdealWheel(radius=0.025)), sphere=Sphere(0.15, 2.0), contact=Contact(1e5))
    steady = vibration.response(design, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(steady.force_mean, 2 * 9.80665 / (3 * math.sin(THETA)), rtol=1e-13)
    assert 2 * 9.81 / (3 * math.sin(THETA)) == pytest.approx(10.174, abs=5e-4)
    assert steady.peak_displacement == 0 and not steady.contact_lost


@pytest.mark.parametrize("damping", [0.0, 2e4])
@pytest.mark.parametrize("wheel", [DEMO, HALF_SINE], ids=["exact", "half-sine"])
@pytest.mark.parametrize("speed", [(2.0, 2.0, 2.0), (0.9, 1.2, 0.9), (1.1, -1.9, 0.7)])
def test_parseval(wheel, speed, damping):
    # Squares of the lines against the integral over time. The shape's lines fall with k⁻², the machine's answer with k⁻¹ or
    # faster above a few hundred harmonics: beyond 2000 the squares of displacement leave less than 1e-9, of velocity 1e-5.
    steady = vibration.response(demonstrator(wheel, damping=damping), speed, wheel_angle=[0.0, 0.05, 0.13])
    frequency, amplitude = steady.spectrum(2000).combined()
    lines = 0.5 * np.sum(np.abs(amplitude) ** 2)
    assert lines == pytest.approx(steady.rms_displacement**2, rel=1e-9)
    rate = 0.5 * np.sum(np.abs(2 * np.pi * frequency[:, None] * amplitude) ** 2)
    assert rate == pytest.approx(steady.rms_velocity**2, rel=1e-5)


def test_rigid_contacts_on_rigid_mounts_follow_the_shapes():
    design = demonstrator(stiffness=None)
    steady = vibration.response(design, [2.0, -1.3, 0.7], wheel_angle=[0.1, 0.2, 0.3])
    t = np.linspace(0, 4, 301)
    n_hat = -design.contact_directions
    angle = np.array([0.1, 0.2, 0.3]) + t[:, None] * [2.0, -1.3, 0.7]
    shape = steady.system.profiles[0]
    c = np.linalg.solve(n_hat, shape.height(angle).T).T
    np.testing.assert_allclose(steady.at(t).displacement, c, atol=1e-14)
    velocity = np.linalg.solve(n_hat, (shape.slope(angle) * [2.0, -1.3, 0.7]).T).T
    np.testing.assert_allclose(steady.at(t).velocity, velocity, atol=1e-13)
    assert len(steady.system.system.lam) == 0


def test_impulse_at_the_edge_of_a_roller_on_rigid_contacts():
    # Momentum: M_s Δċ = Σ n̂ ∫N dt, and n̂·Δċ = |ω| × the slope's jump at the wheel that passes its corner.
    speed = [2.0, -1.3, 0.7]
    steady = vibration.response(demonstrator(stiffness=None), speed)
    assert steady.impulses
    n_hat = -steady.system.design.contact_directions
    for impulse in steady.impulses:
        shape = steady.system.profiles[0]
        jump = np.zeros(3)
        jump[impulse.wheel - 1] = abs(speed[impulse.wheel - 1]) * np.abs(shape.slope_jumps).max()
        np.testing.assert_allclose(n_hat @ impulse.velocity_jump, jump, atol=1e-14)
        np.testing.assert_allclose(n_hat.T @ impulse.contact_impulse, 5.0 * impulse.velocity_jump, atol=1e-14)
        # The same seen from the motion: just before and after the corner.
        w = impulse.wheel - 1
        period = shape.period / abs(speed[w])
        at = (impulse.angle / speed[w]) % period
        before, after = steady.at(at - 1e-9).velocity, steady.at(at + 1e-9).velocity
        np.testing.assert_allclose(after - before, impulse.velocity_jump, atol=1e-8)


def test_impulse_on_compliant_contacts_by_momentum():
    # Between any two times M_s Δċ = ∫(Σ n̂ N + M_s g) dt: the force through a corner by fine samples.
    design = demonstrator(damping=300.0)
    steady = vibration.response(design, [2.0, 2.0, 2.0])
    t = np.linspace(0.03, 0.08, 20001)
    motion = steady.at(t)
    n_hat = -design.contact_directions
    force = motion.contact_force @ n_hat + [0, 0, -5 * 9.80665]
    # Trapezoids of 2.5 µs of a force that jumps at one corner by less than 20 N.
    total = np.trapezoid(force, t, axis=0)
    np.testing.assert_allclose(total, 5 * (motion.velocity[-1] - motion.velocity[0]), atol=1e-4)
    np.testing.assert_allclose(5 * motion.acceleration, force, atol=1e-7)


def test_transmissibility_is_one_far_below_resonance():
    for parts in (dict(), dict(mount=Mount(1e6)), dict(damping=2e4)):
        T = vibration.transmissibility(demonstrator(**parts), [1e-3, 1e-2])
        np.testing.assert_allclose(T, 1.0, atol=1e-5)
    # One contact alone: kK/(kK + K′(k + K)).
    k, K, pad = 1e6, 188208.0, 4e4
    T = vibration.transmissibility(demonstrator(mount=Mount(k), closure=Closure(pad)), 0.0, "independent")
    np.testing.assert_allclose(T, k * K / (k * K + pad * (k + K)), rtol=1e-12)


def test_transmissibility_falls_above_resonance():
    # Far above: −(ω_n/ω)², along the axis with ω_n² = 3 sin²θ K/M_s.
    design = demonstrator()
    f = 3000.0
    Y = vibration.frequency_response(design, f)
    vertical = Y[2].sum() / vibration.frequency_response(design, 0.0)[2].sum()
    natural = 3 * math.sin(THETA) ** 2 * 188208 / 5
    assert vertical.real == pytest.approx(natural / (natural - (2 * math.pi * f) ** 2), rel=1e-12)


def test_payload_on_its_isolator_is_a_base_driven_oscillator():
    # On rigid contacts the sphere is the base: T = (1 + 2iζr)/(1 − r² + 2iζr).
    mass, k, c = 2.0, 800.0, 12.0
    isolator = vibration.Isolator(mass, k, c)
    design = demonstrator(stiffness=None)
    f = np.array([0.5, 3.0, 3.2, 20.0])
    base = vibration.frequency_response(design, f, isolator=isolator)
    carried = vibration.frequency_response(design, f, isolator=isolator, of="payload")
    s = 2j * math.pi * f[:, None, None]
    np.testing.assert_allclose(carried, base * (k + c * s) / (mass * s**2 + c * s + k), atol=1e-15)
    # Rollers pass at 13 Hz, four times the isolator's 3.2 Hz.
    steady = vibration.response(design, [6.0, 6.0, 6.0], isolator=isolator)
    assert steady.payload.rms_acceleration < 0.2 * steady.rms_acceleration


def test_thesis_measure_is_orders_of_magnitude_below_the_rigid_motion():
    # Section 6: orthogonal wheels, η = 0.4485, ω = (0.1, 1.2, 0.3); E3.
    design = demonstrator(HALF_SINE)
    design = replace(
        design, placements=[Placement(HALF_SINE, p.contact_direction, p.drive_direction) for p in orthogonal().placements]
    )
    speed = [0.1, 1.2, 0.3]
    rigid = vibration.response(replace(design, contact=Contact()), speed).peak_displacement
    for damping in (0.0, 8500.0, 20000.0):
        damped = replace(design, contact=Contact(188208.0, damping))
        thesis = vibration.response(damped, speed, "independent", measure="thesis").peak_displacement
        assert thesis < rigid / 50
        # The centre itself follows the shape, whatever the damping.
        assert vibration.response(damped, speed).peak_displacement == pytest.approx(rigid, rel=0.05)


def test_thesis_measure_of_a_stiff_contact_is_the_inertia_over_the_stiffness():
    # Damped hard enough that little rings and slowly enough that it follows: δ = −M_s ḧ/K, off the corners.
    design = demonstrator(HALF_SINE, damping=400.0)
    steady = vibration.response(design, [0.05] * 3, "independent", measure="thesis")
    shape = steady.system.profiles[0]
    # The middle of the gap, where the half sine is flat and damping delays nothing.
    middle = 0.4485 * math.pi / 14
    expected = -5 * shape.curvature(middle) * 0.05**2 / 188208 * (-design.contact_directions).sum(axis=0)
    np.testing.assert_allclose(steady.at(middle / 0.05).displacement, expected, rtol=2e-3, atol=1e-13)


def test_mecanum_moves_the_sphere_less_than_the_standard_wheel():
    speed = [0.1, 1.2, 0.9]
    standard = vibration.response(demonstrator(damping=8500.0), speed).peak_displacement
    mecanum = vibration.response(demonstrator(MecanumWheel(radius=0.0758, rollers=16, mass=0.25), damping=8500.0), speed)
    assert mecanum.peak_displacement < 0.3 * standard


def test_closure_spring_along_the_axis_adds_its_stiffness_there():
    spring = Closure(springs=(Spring((0, 0, 1), 5e4),))
    modes = vibration.modes(demonstrator(closure=spring))
    axis = math.sqrt((3 * math.sin(THETA) ** 2 * 188208 + 5e4) / 5) / (2 * math.pi)
    assert modes.natural_frequencies[2] == pytest.approx(axis, rel=1e-12)


def test_rigid_contacts_on_mounts_shake_the_wheels_mass_too():
    """Δ = n̂·c − h: M_s c̈ + Σ n̂ (m (n̂·c̈ − ḧ) + c (n̂·ċ − ḣ) + k (n̂·c − h)) = 0, written out for one frequency after another."""
    mass, m, k, c = 5.0, 0.25, 1e6, 80.0
    wheel = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=m)
    design = replace(atlas(wheel, radius=1.22), sphere=Sphere(1.22, mass), contact=Contact(), mount=Mount(k, c))
    n_hat = -design.contact_directions
    held = n_hat.T @ n_hat
    frequency = np.array([0.1, 30.0, 85.0, 110.0, 400.0, 5000.0])
    found = vibration.frequency_response(design, frequency)
    for f, response in zip(frequency, found, strict=True):
        s = 2j * np.pi * f
        mount = m * s * s + c * s + k
        expected = np.linalg.solve(mass * s * s * np.eye(3) + mount * held, mount * n_hat.T)
        np.testing.assert_allclose(response, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
