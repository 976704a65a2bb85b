"""Campbell diagram: crossings, bands and their order."""

import math

import numpy as np
import pytest

from spheredrive.errors import SpheredriveError
from spheredrive.vibration.spectra.campbell import critical_speeds, passing_lines, resonance, resonant_band, speeds_to_avoid

P = 2 * math.pi / 16


def gain(r, zeta):
    """The forced oscillator, one mode."""
    return 1 / math.sqrt((1 - r**2) ** 2 + (2 * zeta * r) ** 2)


def test_passing_lines_of_sixteen_rollers():
    """16 rollers at one turn a second pass 16 times a second, whichever way round."""
    np.testing.assert_allclose(passing_lines([2 * math.pi, -math.pi], P, 3), [[16, 32, 48], [8, 16, 24]], rtol=1e-15)


@pytest.mark.parametrize("zeta", [0.01, 0.2, 0.5, 0.7])
def test_resonance_is_the_largest_gain(zeta):
    assert resonance(zeta) == pytest.approx(max(gain(r, zeta) for r in np.linspace(0, 1.2, 100_001)), rel=1e-6)


def test_resonance_of_extreme_damping():
    assert np.isinf(resonance(0.0)) and resonance(1.5) == pytest.approx(1)


@pytest.mark.parametrize(("zeta", "limit"), [(0.01, None), (0.2, None), (0.05, 3.0), (0.0, 4.0), (0.3, 1.5)])
def test_resonant_band_ends_where_the_gain_is_the_limit(zeta, limit):
    level = resonance(zeta) / math.sqrt(2) if limit is None else limit
    low, high = resonant_band(zeta, limit)
    assert low < 1 < high
    assert gain(low, zeta) == pytest.approx(level, rel=1e-9) and gain(high, zeta) == pytest.approx(level, rel=1e-9)


def test_resonant_band_of_light_damping_is_twice_the_damping_wide():
    """Half power, (r₂ − r₁) = 2ζ to second order."""
    low, high = resonant_band(1e-3)
    assert high - low == pytest.approx(2e-3, rel=1e-5)


def test_resonant_band_is_none_where_nothing_stands_out():
    assert resonant_band(0.8) is None and resonant_band(0.2, limit=3.0) is None
    assert resonant_band(0.0) == (1.0, 1.0)


def test_critical_speeds_meet_the_lines():
    """Every crossing lies on its line, and all lines up to the largest speed are there."""
    f, zeta = np.array([7.0, 11.0]), np.array([0.05, 0.02])
    shapes = [np.array([0, 3e-4, 1e-4j]), np.array([0, 2e-4])]
    found = critical_speeds(f, zeta, shapes, [P, 2 * P])
    assert len(found) == 6
    for c in found:
        period = (P, 2 * P)[c.wheel - 1]
        assert passing_lines(c.speed, period, 2)[c.harmonic - 1] == pytest.approx(f[c.mode - 1], rel=1e-14)
        amplitude = 2 * abs(shapes[c.wheel - 1][c.harmonic])
        assert c.severity == pytest.approx(
            amplitude * gain(math.sqrt(1 - 2 * zeta[c.mode - 1] ** 2), zeta[c.mode - 1]), rel=1e-12
        )
    assert [c.severity for c in found] == sorted((c.severity for c in found), reverse=True)
    assert (found[0].wheel, found[0].harmonic, found[0].mode) == (1, 1, 2)
    assert {c.speed for c in critical_speeds(f, zeta, shapes, [P, 2 * P], largest_speed=2.0)} == {
        c.speed for c in found if c.speed <= 2.0
    }


def test_critical_speeds_ask_the_transfer_which_wheel_moves_which_mode():
    """Mode 1 along z is moved by wheel 1 alone, mode 2 along x by wheel 2 alone."""

    def transfer(s):
        w = 2 * math.pi * np.array([7.0, 11.0])
        Y = np.zeros((len(s), 3, 2), complex)
        for i in (0, 1):
            Y[:, 2 - 2 * i, i] = w[i] ** 2 / (s**2 + 0.04 * w[i] * s + w[i] ** 2)
        return Y

    found = critical_speeds([7.0, 11.0], [0.02, 0.02], [np.array([0, 1e-4])] * 2, P, transfer)
    assert {(c.wheel, c.mode) for c in found[:2]} == {(1, 1), (2, 2)}
    # At its natural frequency an oscillator amplifies by 1/(2ζ).
    assert found[0].amplification == pytest.approx(25, rel=1e-12)
    assert all(c.amplification < 3 for c in found[2:])


def test_speeds_to_avoid_merge_what_overlaps_and_only_that():
    f, zeta = np.array([10.0, 10.3, 20.0]), np.array([0.02, 0.02, 0.02])
    shapes = [np.array([0, 1e-4])]
    bands = speeds_to_avoid(critical_speeds(f, zeta, shapes, P), zeta, margin=0.0)
    assert len(bands) == 2
    low, high = resonant_band(0.02)
    joined = min(bands, key=lambda band: band.least)
    assert joined.least == pytest.approx(low * 10.0 * P, rel=1e-12) and joined.most == pytest.approx(high * 10.3 * P, rel=1e-12)
    assert {c.mode for c in joined.crossings} == {1, 2}
    wider = speeds_to_avoid(critical_speeds(f, zeta, shapes, P), zeta, margin=0.1)
    assert min(band.least for band in wider) == pytest.approx(0.9 * joined.least, rel=1e-12)


def test_speeds_to_avoid_swallow_a_narrow_band_in_a_wide_one():
    zeta = np.array([0.3, 0.001])
    crossings = critical_speeds([10.0, 10.5], zeta, [np.array([0, 1e-4])], P)
    (band,) = speeds_to_avoid(crossings, zeta, margin=0.0, least_share=0.0)
    assert (band.least, band.most) == pytest.approx(tuple(r * 10.0 * P for r in resonant_band(0.3)), rel=1e-12)
    assert [c.mode for c in band.crossings] == [2, 1] and band.severity == crossings[0].severity


def test_speeds_to_avoid_keep_wheels_apart_and_start_with_the_worst():
    f, zeta = np.array([10.0]), np.array([0.02])
    bands = speeds_to_avoid(critical_speeds(f, zeta, [np.array([0, 1e-4]), np.array([0, 3e-4])], P), zeta)
    assert [band.wheel for band in bands] == [2, 1]
    assert bands[0].severity == pytest.approx(3 * bands[1].severity, rel=1e-12)


def test_speeds_to_avoid_pass_over_small_harmonics():
    """1/k² shape: harmonics beyond the fourth are below 5 % of the first."""
    f, zeta = np.array([10.0]), np.array([0.01])
    crossings = critical_speeds(f, zeta, [np.concatenate([[0], 1e-4 / np.arange(1, 200) ** 2.0])], P)
    kept = {c.harmonic for band in speeds_to_avoid(crossings, zeta) for c in band.crossings}
    assert kept == {1, 2, 3, 4}


def test_speeds_to_avoid_of_a_damped_machine_are_none():
    crossings = critical_speeds([10.0], [0.9], [np.array([0, 1e-4])], P)
    assert crossings == () and speeds_to_avoid(crossings, [0.9]) == ()


def test_undamped_modes_are_infinitely_severe():
    (only,) = critical_speeds([10.0], [0.0], [np.array([0, 1e-4])], P)
    (band,) = speeds_to_avoid([only], [0.0])
    assert math.isinf(only.severity)
    assert (band.least, band.most) == pytest.approx((0.95 * only.speed, 1.05 * only.speed), rel=1e-12)


@pytest.mark.parametrize("modes", [([math.nan], [0.1]), ([1.0, 2.0], [0.1]), ([1.0], [-0.1])])
def test_critical_speeds_of_what_are_no_modes_are_refused(modes):
    with pytest.raises(SpheredriveError):
        critical_speeds(*modes, [np.ones(2)], P)


@pytest.mark.parametrize("options", [{"margin": -0.1}, {"margin": 1.0}, {"limit": 1.0}, {"least_share": math.nan}])
def test_speeds_to_avoid_with_senseless_options_are_refused(options):
    with pytest.raises(SpheredriveError):
        speeds_to_avoid((), [0.1], **options)
