"""Harmonics of a wheel's shape and the lines they make, against closed forms, quadrature and sampled sums."""

import itertools
import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import integrate

from spheredrive.errors import SpheredriveError
from spheredrive.vibration.spectra import lines
from spheredrive.vibration.spectra.spectrum import order_spectrum, shape_harmonics

COUNT = 300


def outline(breakpoints, coefficients, phase=0.0):
    """What ``shape_harmonics`` reads of a ``shape.Profile``."""
    edges = np.asarray(breakpoints, float)
    return SimpleNamespace(
        breakpoints=edges, coefficients=np.atleast_2d(coefficients), period=edges[-1] - edges[0], phase=phase
    )


def height(profile, angle):
    """The polynomial pieces, evaluated one by one."""
    edges = profile.breakpoints
    local = edges[0] + np.mod(np.asarray(angle) + profile.phase - edges[0], profile.period)
    j = np.clip(np.searchsorted(edges, local, side="right") - 1, 0, len(edges) - 2)
    u = (local - edges[j]) / np.diff(edges)[j]
    return sum(a * u**m for m, a in enumerate(profile.coefficients[j].T))


def triangle(phase=0.0):
    """Height 1 at ϑ = 0.7 + 2·0.25 and 0 at ϑ = 0.7, slopes ±2, period 1."""
    return outline([0.7, 1.2, 1.7], [[0, 1.0], [1.0, -1.0]], phase)


@pytest.mark.parametrize("phase", [0.0, 0.3, -40.1])
def test_shape_harmonics_of_a_triangle_are_the_textbooks(phase):
    """Mean ½; odd k: −2/(π²k²) from the foot, even k: none."""
    H = shape_harmonics(triangle(phase), COUNT)
    k = np.arange(1, COUNT + 1)
    expected = np.where(k % 2, -2 / (math.pi * k) ** 2, 0) * np.exp(-2j * np.pi * np.mod(k * (0.7 - phase), 1))
    assert H[0] == pytest.approx(0.5, abs=1e-15)
    # k (0.7 − φ) carries the rounding of φ and the breakpoints, k·40·1e-16·2π, on a line of 1/k².
    np.testing.assert_allclose(H[1:], expected, atol=3e-14)


@pytest.mark.parametrize("rollers", [5, 16])
def test_shape_harmonics_of_smooth_pieces_are_quadrature(rollers):
    """Sixth and eleventh degree pieces of unequal width; QUADPACK's own tolerance 1e-13."""
    rng = np.random.default_rng(4)
    P = 2 * math.pi / rollers
    profile = outline(0.1 + P * np.array([0, 0.13, 0.5, 1.0]), rng.normal(size=(3, 12)) * (np.arange(12) < 7), phase=0.21)
    profile.coefficients[2] = rng.normal(size=12)
    H = shape_harmonics(profile, 40)
    for k in (0, 1, 2, 3, 7, 13, 40):
        terms = [
            integrate.quad(
                lambda x, part=part, k=k: height(profile, x) * part(2 * math.pi * k * x / P), a, b, epsabs=1e-13, limit=200
            )[0]
            for part in (math.cos, lambda x: -math.sin(x))
            for a, b in itertools.pairwise(profile.breakpoints - profile.phase)
        ]
        assert H[k] == pytest.approx((sum(terms[:3]) + 1j * sum(terms[3:])) / P, abs=2e-12)


def test_shape_harmonics_join_where_the_recurrence_turns():
    """uᵈ on one piece of one period at every κ = 2πk about the turn, d up to 60, against its series.

    ∫₀¹ uᵈ exp(−iκu) du = Σ_j (−iκ)ʲ/(j! (d+j+1)): summed in fractions, so that nothing cancels.
    """
    for degree in (1, 5, 20, 60):
        coefficients = np.zeros(degree + 1)
        coefficients[degree] = 1.0
        # A piece of width 1 and one without height behind it: κ = 2π/P of the first harmonic can then be chosen.
        for kappa in (Fraction(1, 8), Fraction(degree), Fraction(degree) + Fraction(5, 4), Fraction(degree + 8)):
            P = 2 * math.pi / float(kappa)
            if P <= 1:
                continue
            H = shape_harmonics(outline([0, 1, P], [coefficients, 0 * coefficients]), 1)[1] * P
            expected = _moment(degree, Fraction(2 * math.pi / P))
            assert abs(H - expected) < 1e-15 * (1 + float(kappa)) + 1e-13 * abs(expected)


def _moment(degree, kappa):
    real, imaginary, term = Fraction(0), Fraction(0), Fraction(1)
    for j in range(400):
        share = term / (degree + j + 1)
        sign = (1, -1, -1, 1)[j % 4]
        if j % 2:
            imaginary += sign * share
        else:
            real += sign * share
        term = Fraction(term * kappa / (j + 1)).limit_denominator(10**60)
    return complex(float(real), float(imaginary))


def test_shape_harmonics_fall_by_the_slope_jump():
    """At high k only the corner is left: H_k k² → −[h′] P/(4π²) exp(…); the curvature's jump is one order of k lower."""
    profile = outline([0.0, 2.0], [[0, 1.0, -1.0]])
    k = 4000
    jump = 0.5 - (-0.5)
    H = shape_harmonics(profile, k)[k]
    assert H * k**2 == pytest.approx(-jump * 2.0 / (4 * math.pi**2), rel=1e-9)


def test_shape_harmonics_do_not_depend_on_the_block(monkeypatch):
    profile = triangle(0.1)
    whole = shape_harmonics(profile, 50)
    monkeypatch.setattr("spheredrive.vibration.spectra.spectrum.BLOCK", 7)
    np.testing.assert_array_equal(shape_harmonics(profile, 50), whole)


@pytest.mark.parametrize("count", [-1, 1.5, True, math.nan])
def test_shape_harmonics_of_no_count_are_refused(count):
    with pytest.raises(SpheredriveError):
        shape_harmonics(triangle(), count)


# Lines.

DIRECTIONS = np.array([[0.6, 0, 0.8], [0, 1.0, 0], [-0.8, 0, 0.6]])


def one_resonance(s):
    """Each wheel pushes along its own direction through an oscillator of 3 Hz with 20 % of damping, excited at its foot."""
    w = 2 * math.pi * 3
    factor = (w**2 + 0.4 * w * s) / (s**2 + 0.4 * w * s + w**2)
    return factor[:, None, None] * DIRECTIONS.T


def test_order_spectrum_is_the_simulated_oscillator():
    """Each wheel's oscillator, integrated by SciPy until its start is forgotten, sums to the lines.

    exp(−0.2·2π·3·12 s) = 2e-20 of the start is left. Harmonics above 200, cut off, are each below 0.1/k², and their response
    falls by 0.4·3 Hz/f: Σ 0.3/k³ < 4e-6 in all, a wheel.
    """
    profile = outline([0.0, 0.5, 1.0], [[0, 1.0, -1.0, 0], [0, -1.0, 3.0, -2.0]])
    slope = outline([0.0, 0.5, 1.0], [[2.0, -4.0, 0], [-2.0, 12.0, -12.0]])
    H = shape_harmonics(profile, 200)
    speed, angle, w = np.array([0.8, -1.3, 0.0]), np.array([0.2, 0.7, 0.1]), 2 * math.pi * 3
    spectrum = order_spectrum(one_resonance, [H, H, H], np.ones(3), speed, angle)
    time = np.linspace(12, 14, 9)
    motion = sum(
        np.outer(np.exp(2j * math.pi * f * time), c).real
        for f, c in zip(spectrum.frequency, spectrum.displacement, strict=True)
    )
    mean = H[0].real
    for i in (0, 1):

        def rate(t, y, i=i):
            turned = angle[i] + speed[i] * t
            h, h_rate = height(profile, turned), height(slope, turned) * speed[i]
            return [y[1], w**2 * (h - mean - y[0]) + 0.4 * w * (h_rate - y[1])]

        solution = integrate.solve_ivp(rate, (0, 14), [0, 0], "DOP853", time, rtol=1e-9, atol=1e-11, max_step=0.02)
        motion = motion - np.outer(solution.y[0], DIRECTIONS[i])
    # Wheel 3 stands: no line. Steps across corners of h′ leave some 1e-6 each besides.
    assert set(spectrum.wheel) == {1, 2}
    np.testing.assert_allclose(motion, 0, atol=2e-5)


def test_order_spectrum_names_orders_of_the_wheels_own_turn():
    H = np.array([0.3, 0.2, 0.1j])
    spectrum = order_spectrum(one_resonance, [H, H, H], 2 * math.pi / np.array([8, 8, 16]), [2.0, -4.0, 1.0])
    assert spectrum.order.tolist() == [8, 16, 8, 16, 16, 32]
    np.testing.assert_allclose(spectrum.frequency, spectrum.order * np.abs([2, 2, 4, 4, 1, 1]) / (2 * math.pi), rtol=1e-15)
    assert spectrum.of_wheel(3).order.tolist() == [16, 32]
    frequency, displacement = spectrum.combined()
    np.testing.assert_allclose(frequency * 2 * math.pi, [16, 32, 64], rtol=1e-15)
    np.testing.assert_allclose(displacement.sum(axis=0), spectrum.displacement.sum(axis=0), atol=1e-16)


def test_velocity_and_acceleration_are_derivatives_of_displacement():
    H = np.array([0, 0.2 + 0.1j])
    spectrum = order_spectrum(one_resonance, [H, 0 * H, 0 * H], np.ones(3), [2.5, 0, 0])

    def motion(amplitude, t):
        return (np.exp(2j * math.pi * 2.5 * t) * amplitude).real

    step = 1e-4
    here = 0.123
    for of, derivative in ((spectrum.displacement, spectrum.velocity), (spectrum.velocity, spectrum.acceleration)):
        slope = (motion(of, here + step) - motion(of, here - step)) / (2 * step)
        # Central differences: (2π 2.5 h)²/6 = 4e-7.
        np.testing.assert_allclose(slope, motion(derivative, here), rtol=1e-5)


def test_order_spectrum_keeps_the_energy_of_the_shape():
    """Parseval, with a centre that follows wheel 2 alone: RMS of the lines is that of h about its mean.

    A triangle has variance 1/12; harmonics beyond 300 hold Σ 8/(π⁴k⁴) < 1e-8 of it.
    """
    H = shape_harmonics(triangle(), COUNT)
    follow = np.zeros((3, 3))
    follow[1, 1] = 1
    spectrum = order_spectrum(lambda s: np.broadcast_to(follow, (len(s), 3, 3)), [H, H, H], np.ones(3), [1.0, 2.0, 3.0])
    assert lines.rms(*spectrum.combined()) == pytest.approx([0, math.sqrt(1 / 12), 0], rel=1e-7)


def test_order_spectrum_of_standing_wheels_is_empty():
    spectrum = order_spectrum(one_resonance, [np.ones(3)] * 3, np.ones(3), np.zeros(3))
    assert spectrum.displacement.shape == (0, 3) and not lines.rms(*spectrum.combined()).any()


@pytest.mark.parametrize(("speed", "period"), [([1.0], 1.0), ([1, 2, math.nan], 1.0), ([1, 2, 3], 0.0)])
def test_order_spectrum_of_what_is_no_motion_is_refused(speed, period):
    with pytest.raises(SpheredriveError):
        order_spectrum(one_resonance, [np.ones(3)] * 3, period, speed)
