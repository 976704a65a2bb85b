"""The comparison of two runs: what it finds of signals whose differences are known."""

import json

import numpy as np
import pytest

from spheredrive.errors import SpheredriveError
from spheredrive.export.agreement import Track, agreement, agreement_text, common_period

DIRECTIONS = np.eye(3)
PASSAGE = (2.0, 3.0, 5.0)


def signals(mean=1.0, load=1.0, spread=1.0, ripple=1.0, shift=0.0, noise=0.0):
    """A run of 4 s at 500 Hz: three contacts, each with a line at its wheel's frequency."""
    time = np.arange(2001) / 500.0
    wave = np.sin(2 * np.pi * time[:, None] * (np.array(PASSAGE) + shift))
    Omega = mean * np.array([0.1, 0.2, -0.3]) + 0.01 * wave
    ring = noise * np.exp(-8 * time)[:, None]
    return Track(
        time, Omega + ring, 1e-3 * ripple * wave + 5e-3 + ring, load * np.array([20.0, 30.0, 25.0]) + spread * 4 * wave + ring
    )


def test_agreement_finds_each_difference():
    found = agreement(signals(1.01, 1.02, 1.03, 1.04), signals(), DIRECTIONS, PASSAGE)
    assert found.periods == 3 and found.samples == 1500
    # The waves average out over whole periods, so the shares are exact.
    assert found.angular_velocity == pytest.approx(0.01, rel=1e-9)
    assert found.normal_force == pytest.approx(0.02, rel=1e-9)
    assert found.normal_spread == pytest.approx(0.03, rel=1e-9)
    assert found.ripple == pytest.approx(0.04, rel=1e-9)
    assert found.ripple_range == pytest.approx(0.04, rel=1e-9)
    assert pytest.approx(np.array([PASSAGE, PASSAGE])) == np.array(found.frequency).T
    assert found.same_bins and not found.agrees


def test_agreement_leaves_the_start_out():
    found = agreement(signals(noise=100.0), signals(), DIRECTIONS, PASSAGE, warm_up=0.5)
    assert found.begin == pytest.approx(2.0) and found.periods == 2
    assert found.agrees


def test_agreement_tells_other_frequencies():
    found = agreement(signals(shift=0.5), signals(), DIRECTIONS, PASSAGE)
    assert not found.same_bins and not found.agrees


def test_agreement_refuses_other_times():
    short = Track(*(field[:-1] for field in signals()))
    with pytest.raises(SpheredriveError, match="same duration"):
        agreement(short, signals(), DIRECTIONS, PASSAGE)


def test_agreement_is_plain_and_readable():
    found = agreement(signals(), signals(), DIRECTIONS, PASSAGE)
    assert json.loads(json.dumps(found.as_dict()))["agrees"] is True
    text = agreement_text(found)
    assert "The two engines agree." in text and "3 common periods" in text
    assert "no common period" in agreement_text(agreement(signals(), signals(), DIRECTIONS, (2.0, 2.0 * 2**0.5, 5.0)))


@pytest.mark.parametrize(
    ("frequencies", "longest", "period"),
    [
        ((2.0, 3.0, 5.0), 3.0, 1.0),
        ((1.4, -2.1, 0.7), 10.0, 10 / 7),
        ((2.0, 3.0, 5.0), 0.9, None),
        ((1.0, 2**0.5), 20.0, None),
        ((0.0, 4.0), 1.0, 0.25),
        ((0.0, 0.0), 1.0, None),
    ],
)
def test_common_period_holds_whole_numbers(frequencies, longest, period):
    assert common_period(frequencies, longest) == (None if period is None else pytest.approx(period))
