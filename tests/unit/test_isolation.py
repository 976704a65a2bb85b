"""The isolated payload against closed forms and SciPy, and the isolator that is asked for."""

import math

import numpy as np
import pytest
from scipy import integrate, signal

from spheredrive.errors import SpheredriveError
from spheredrive.vibration.aboard.comfort import comfort_of_lines
from spheredrive.vibration.aboard.isolation import (
    GRAVITY,
    _highest_that_does,
    isolator_for,
    loaded_centre,
    payload_lines,
    relative_motion,
    transmissibility,
)

# One line along z: 1 m/s² of RMS at 20 Hz.
FREQUENCY = np.array([20.0])
CENTRE = np.array([[0, 0, math.sqrt(2) / (40 * math.pi) ** 2]], complex)


@pytest.mark.parametrize("zeta", [0.01, 0.1, 0.7, 2.0])
def test_transmissibility_is_the_textbooks(zeta):
    r = np.geomspace(0.01, 100, 41)
    expected = np.sqrt((1 + (2 * zeta * r) ** 2) / ((1 - r**2) ** 2 + (2 * zeta * r) ** 2))
    np.testing.assert_allclose(np.abs(transmissibility(r, zeta)), expected, rtol=1e-12)
    assert abs(transmissibility(math.sqrt(2), zeta)) == pytest.approx(1, rel=1e-12)
    np.testing.assert_allclose(relative_motion(r, zeta), transmissibility(r, zeta) - 1, atol=1e-12 * (1 + 1 / zeta))


def test_transmissibility_is_scipys_frequency_response():
    """Sign of the phase too: the payload lags."""
    w = np.geomspace(0.1, 10, 21)
    _, expected = signal.freqs([0.6, 1.0], [1.0, 0.6, 1.0], w)
    np.testing.assert_allclose(transmissibility(w, 0.3), expected, rtol=1e-12)


def test_undamped_isolator_at_resonance_is_infinite():
    assert np.isinf(transmissibility(1.0, 0.0)) and np.isinf(relative_motion(1.0, 0.0))


def test_payload_lines_are_the_integrated_motion():
    """k (x − y) + c (ẋ − ẏ) = m ÿ under two lines, by SciPy; exp(−0.2·2π·3·8) = 8e-14 of the start is left."""
    f, x = np.array([2.0, 5.0]), np.array([[0, 0, 1.0 + 0.5j], [0, 0, -0.3j]])
    w, zeta = 2 * math.pi * 3.0, 0.2

    def at(amplitude, t):
        return sum((np.exp(2j * math.pi * a * t) * b[2]).real for a, b in zip(f, amplitude, strict=True))

    def rate(t, y):
        return [y[1], w**2 * (at(x, t) - y[0]) + 2 * zeta * w * (at(2j * math.pi * f[:, None] * x, t) - y[1])]

    time = np.linspace(8, 9, 7)
    solution = integrate.solve_ivp(rate, (0, 9), [0, 0], "DOP853", time, rtol=1e-10, atol=1e-11)
    payload = payload_lines(f, x, 3.0, zeta)
    np.testing.assert_allclose([at(payload, t) for t in time], solution.y[0], atol=1e-7)


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.5])
def test_isolator_for_one_line_is_the_closed_form(zeta):
    """|T|² = τ² is quadratic in q = r²: τ² q² − (2τ² + 4ζ²(1 − τ²)) q + τ² − 1 = 0, and r is its root above √2."""
    tau = 0.2
    (q,) = (x for x in np.roots([tau**2, -2 * tau**2 - 4 * zeta**2 * (1 - tau**2), tau**2 - 1]) if x > 0)
    found = isolator_for(FREQUENCY, CENTRE, 1.5, tau, zeta)
    f_n = 20 / math.sqrt(q)
    assert found.natural_frequency == pytest.approx(f_n, rel=1e-9)
    assert found.acceleration == pytest.approx(tau, rel=1e-9) and found.acceleration <= tau
    assert found.bare_acceleration == pytest.approx(1, rel=1e-12)
    assert found.stiffness == pytest.approx(1.5 * (2 * math.pi * f_n) ** 2, rel=1e-9)
    assert found.damping == pytest.approx(2 * zeta * math.sqrt(found.stiffness * 1.5), rel=1e-9)
    assert found.sag == pytest.approx(GRAVITY / (2 * math.pi * f_n) ** 2, rel=1e-9)
    assert found.stroke == pytest.approx(abs(relative_motion(math.sqrt(q), zeta)) * CENTRE[0, 2].real, rel=1e-9)


def test_isolator_is_the_stiffest_of_all():
    """Three lines, little damping: the RMS rises and falls with f_n. No stiffer one on a grid a hundred times finer does."""
    f = np.array([5.0, 11.0, 40.0])
    x = np.array([[3e-4, 0, 0], [0, 2e-5j, 0], [0, 0, 4e-6]], complex)
    acceleration = -((2 * math.pi * f[:, None]) ** 2) * x

    def size(f_n):
        gain = np.abs(transmissibility(f / np.asarray(f_n)[..., None], 0.02))
        return np.sqrt((gain**2 * (np.abs(acceleration) ** 2).sum(axis=1) / 2).sum(axis=-1))

    for wanted in (0.25, 0.24, 0.2, 0.05):
        found = isolator_for(f, x, 1.0, wanted, 0.02).natural_frequency
        assert size(found) == pytest.approx(wanted, rel=1e-9)
        assert size(found * np.geomspace(1 + 1e-9, 1e3, 100_000)).min() > wanted * (1 - 1e-9)


def test_search_follows_a_dip_between_two_tries():
    """Below zero over a thousandth of the frequency, far less than a step, and again further down."""

    def excess(f):
        return min(abs(math.log(f / 3.456)) - 5e-4, abs(math.log(f / 0.2)) - 0.1)

    assert _highest_that_does(excess, 0.1, 100.0) == pytest.approx(3.456 * math.exp(5e-4), rel=1e-9)
    assert _highest_that_does(lambda f: excess(f) + 6e-4 if f > 1 else excess(f), 0.1, 100.0) == pytest.approx(
        0.2 * math.exp(0.1), rel=1e-9
    )
    assert _highest_that_does(lambda f: 1.0, 0.1, 100.0) is None


def test_weighted_isolator_meets_the_worst_total_value():
    f, x = np.array([6.0, 12.0]), np.array([[1e-4, 2e-4, 5e-4], [0, 1e-4j, 1e-4]], complex)
    found = isolator_for(f, x, 70.0, 0.3, 0.3, weighted=True)
    acceleration = -((2 * math.pi * f[:, None]) ** 2) * payload_lines(f, x, found.natural_frequency, 0.3)
    assert comfort_of_lines(f, acceleration).worst_total == pytest.approx(0.3, rel=1e-9)


def test_no_isolator_is_needed_where_the_sphere_is_quiet():
    found = isolator_for(FREQUENCY, CENTRE, 1.0, 1.01, 0.0)
    assert math.isinf(found.natural_frequency) and found.sag == found.stroke == found.damping == 0
    assert found.acceleration == found.bare_acceleration == pytest.approx(1)


def test_isolator_without_room_says_what_the_softest_leaves():
    """1 mm of sag is √(9807)/2π = 15.76 Hz, too near to 20 Hz: r = 1.269, |T| = 1.032/√(0.610² + 0.254²) = 1.56."""
    with pytest.raises(SpheredriveError, match=r"sag up to 0\.001 m .* softest, 15\.8 Hz, leaves 1\.56 m/s²"):
        isolator_for(FREQUENCY, CENTRE, 1.0, 0.2, largest_sag=1e-3)
    with pytest.raises(SpheredriveError, match="stroke up to 1e-06 m"):
        isolator_for(FREQUENCY, CENTRE, 1.0, 0.2, largest_stroke=1e-6)


def test_sag_that_suffices_changes_nothing():
    free = isolator_for(FREQUENCY, CENTRE, 1.0, 0.2)
    assert isolator_for(FREQUENCY, CENTRE, 1.0, 0.2, largest_sag=free.sag * 1.01).stiffness == pytest.approx(
        free.stiffness, rel=1e-9
    )


@pytest.mark.parametrize("f_n", [3.0, 15.0, math.inf])
def test_loaded_centre_is_the_two_mass_system(f_n):
    """Sphere on a spring, payload on an isolator inside: (K₂ − ω² M + iω C₂) (c, y) = (force, 0), solved as it stands."""
    M, m, K, zeta, f, force = 3.0, 2.0, 4e4, 0.15, np.array([4.0, 17.0]), 5.0
    w = 2 * math.pi * f
    receptance = (1 / (K - M * w**2))[:, None, None] * np.eye(3)
    bare = np.zeros((2, 3), complex)
    bare[:, 1] = force * receptance[:, 1, 1]
    loaded = loaded_centre(f, bare, receptance, m, zeta)(f_n)
    for i in (0, 1):
        if math.isinf(f_n):
            expected = force / (K - (M + m) * w[i] ** 2)
        else:
            k, c = m * (2 * math.pi * f_n) ** 2, 2 * zeta * m * 2 * math.pi * f_n
            z = k + 1j * w[i] * c
            expected = np.linalg.solve([[K + z - M * w[i] ** 2, -z], [-z, z - m * w[i] ** 2]], [force, 0])[0]
        assert loaded[i] == pytest.approx([0, expected, 0], rel=1e-12)


def test_isolator_for_a_heavy_payload_uses_the_loaded_centre():
    """The answer, put back into the two masses, leaves the wanted acceleration."""
    M, m, K, zeta, wanted = 3.0, 2.0, 4e4, 0.1, 0.1
    w = 2 * math.pi * FREQUENCY
    receptance = (1 / (K - M * w**2))[:, None, None] * np.eye(3)
    found = isolator_for(FREQUENCY, CENTRE, m, wanted, zeta, base=loaded_centre(FREQUENCY, CENTRE, receptance, m, zeta))
    force = CENTRE[0, 2] / receptance[0, 2, 2]
    z = found.stiffness + 1j * w[0] * found.damping
    _, y = np.linalg.solve([[K + z - M * w[0] ** 2, -z], [-z, z - m * w[0] ** 2]], [force, 0])
    assert abs(y) * w[0] ** 2 / math.sqrt(2) == pytest.approx(wanted, rel=1e-9)
    light = isolator_for(FREQUENCY, CENTRE, m, wanted, zeta)
    assert light.natural_frequency != pytest.approx(found.natural_frequency, rel=1e-2)


@pytest.mark.parametrize(
    "arguments",
    [(0.0, 0.1, 0.1), (1.0, 0.0, 0.1), (1.0, math.nan, 0.1), (1.0, 0.1, -0.1), (1.0, 0.1, math.nan), (math.inf, 0.1, 0.1)],
)
def test_isolator_of_impossible_numbers_is_refused(arguments):
    with pytest.raises(SpheredriveError):
        isolator_for(FREQUENCY, CENTRE, *arguments)
