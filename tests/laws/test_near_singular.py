"""Rings of wheels on their way to a singular layout: answers stay true to their conditioning until they are refused."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from layouts import atlas
from spheredrive import kinematics as K
from spheredrive.checking import check
from spheredrive.errors import NearSingularWarning, SingularError
from spheredrive.wheels import IdealWheel

EPS = np.finfo(float).eps
decades = st.floats(-14, 0)
alphas = st.sampled_from([90, 60, 45, -45])


def near_the_equator(decade: float, alpha_deg: float = 90):
    return atlas(IdealWheel(radius=0.025, roller_angle=math.radians(alpha_deg)), -math.degrees(10**decade))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(decades)
def test_forward_of_inverse_is_identity_to_the_condition_number_or_refused(decade):
    """θ → 0: σ = √3 cos θ, √(3/2) sin θ twice, so κ = √2 cot θ and the error of Ω is a few ε κ."""
    design, Omega = near_the_equator(decade), np.array([0.3, -0.7, 0.2])
    kappa = math.sqrt(2) / math.tan(10**decade) if 10**decade < 0.9 else 2.0
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            back = K.forward(design, K.inverse(design, Omega))
        except SingularError:
            assert kappa > 0.9e12
            return
    assert kappa < 1.1e12
    assert (kappa > 100 * 1.001) <= any(issubclass(w.category, NearSingularWarning) for w in caught)
    assert np.abs(back - Omega).max() < 50 * EPS * max(kappa, 1)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.floats(-11, -0.2))
def test_condition_number_follows_its_closed_form(decade):
    """κ = √2 cot θ; the angle itself is given to ε of 1 rad or better, and σ₃ to a few ε σ₁."""
    theta = 10**decade
    A, _ = K.constraint(near_the_equator(decade))
    expected = max(math.sqrt(2) / math.tan(theta), math.tan(theta) / math.sqrt(2))
    assert K.condition_number(A) == pytest.approx(expected, rel=40 * EPS * expected + 1e-13)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(decades, alphas)
def test_check_never_gives_a_jacobian_without_saying_that_it_is_singular(decade, alpha_deg):
    result = check(near_the_equator(decade, alpha_deg))
    codes = {finding.code for finding in result.findings}
    sigma = np.linalg.svd(result.constraint, compute_uv=False)
    share = sigma[2] / sigma[0]
    if share < 0.99e-12:
        assert result.jacobian is None and "singular" in codes and not result.works
    elif 1.01e-12 < share < 0.99e-2:
        assert result.jacobian is not None and "near-singular" in codes and not result.works
    elif share > 1.01e-2:
        assert result.jacobian is not None and result.works
