"""What the comfort functions refuse, and the edges of what they take."""

import math

import numpy as np
import pytest

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.vibration.aboard.comfort import comfort_of_lines, comfort_words, weighting
from spheredrive.vibration.aboard.comfort_history import comfort_of_history, weighted_history
from spheredrive.vibration.spectra.lines import merged_lines, peak_bound, rms

REST = np.zeros((1000, 3))


def test_weighting_of_an_unknown_name_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'Wk'"):
        weighting("wk", 1.0)


@pytest.mark.parametrize("frequency", [-1.0, math.nan, math.inf])
def test_weighting_of_an_impossible_frequency_is_refused(frequency):
    with pytest.raises(SpheredriveError):
        weighting("Wk", frequency)


def test_weighting_of_a_constant_is_zero():
    assert weighting("Wk", 0.0) == 0


@pytest.mark.parametrize("total", [-0.1, math.nan, math.inf])
def test_words_of_an_impossible_value_are_refused(total):
    with pytest.raises(SpheredriveError):
        comfort_words(total)


def test_comfort_of_no_lines_is_comfortable():
    still = comfort_of_lines([], np.zeros((0, 3)))
    assert still.total == still.worst_total == 0 and still.words == ("not uncomfortable",)


@pytest.mark.parametrize(
    ("frequency", "lines", "up"),
    [
        ([1.0], [[1, 1]], (0, 0, 1)),
        ([1.0, 2.0], [[1, 1, 1]], (0, 0, 1)),
        ([-1.0], [[1, 1, 1]], (0, 0, 1)),
        ([1.0], [[1, math.nan, 1]], (0, 0, 1)),
        ([1.0], [[1, 1, 1]], (0, 0, 0)),
        ([1.0], [[1, 1, 1]], (0, math.nan, 1)),
    ],
)
def test_comfort_of_what_is_no_spectrum_is_refused(frequency, lines, up):
    with pytest.raises(SpheredriveError):
        comfort_of_lines(frequency, lines, up)


@pytest.mark.parametrize(
    ("record", "rate", "settling"),
    [
        (REST, 100.0, 0.0),
        (REST, math.nan, 0.0),
        (REST, 1000.0, 1.0),
        (REST, 1000.0, -1.0),
        (REST[:, :2], 1000.0, 0.0),
        (REST[:0], 1000.0, 0.0),
        (REST + math.nan, 1000.0, 0.0),
    ],
)
def test_comfort_of_what_is_no_record_is_refused(record, rate, settling):
    with pytest.raises(SpheredriveError):
        comfort_of_history(record, rate, settling=settling)


def test_comfort_of_rest_has_no_crest():
    result = comfort_of_history(REST, 1000.0)
    assert result.mean.total == 0 and not result.crest_factor.any() and not result.shocks


def test_weighted_history_keeps_leading_dimensions():
    record = np.random.default_rng(0).normal(size=(2, 3, 700))
    together = weighted_history("Wd", record, 1000.0)
    assert together.shape == record.shape
    np.testing.assert_allclose(together[1, 2], weighted_history("Wd", record[1, 2], 1000.0), atol=1e-14)


def test_merged_lines_adds_phasors_of_one_frequency():
    frequency, amplitude = merged_lines(np.array([3.0, 1.0, 3.0]), np.array([[1, 0, 0], [5, 0, 0], [1j, 0, 0]]))
    assert frequency.tolist() == [1.0, 3.0]
    assert amplitude[:, 0].tolist() == [5, 1 + 1j]


def test_rms_and_peak_of_a_sampled_motion():
    """A line on an ellipse, one on a straight line and a constant, over whole periods of fine samples.

    Two incommensurate lines come as near to their bound as the samples let them; 1e-3 for 2e5 of them.
    """
    frequency = np.array([0.0, 1.0, math.sqrt(2)])
    amplitude = np.array([[0.3, 0, 0], [2, 1j, 0], [1, 0.0, 0]])
    time = np.linspace(0, 3000, 400_001)[:-1]
    motion = sum(np.outer(np.exp(2j * math.pi * f * time), a).real for f, a in zip(frequency, amplitude, strict=True))
    np.testing.assert_allclose(rms(frequency, amplitude), np.sqrt((motion**2).mean(axis=0)), atol=1e-3)
    largest = np.linalg.norm(motion, axis=1).max()
    assert largest <= peak_bound(frequency, amplitude) <= largest * (1 + 1e-3)
