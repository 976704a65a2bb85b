"""Findings of ``check``: which designs work, which do not, and in what words."""

import json
import math
import re

import numpy as np
import pytest

from layouts import R, atlas, collinear_triple, orthogonal, random_design, six_orthogonal
from spheredrive import kinematics as K
from spheredrive.checking import check
from spheredrive.design import Design, Placement, Sphere
from spheredrive.summary import check_text
from spheredrive.wheels import DualRaceWheel, IdealWheel

IDEAL = IdealWheel(radius=0.025)


def codes(design):
    return {finding.code for finding in check(design).findings}


@pytest.mark.parametrize(
    ("design", "expected", "works"),
    [
        (atlas(IDEAL), set(), True),
        (atlas(), {"race-offset"}, True),
        (six_orthogonal(), {"over-actuated"}, True),
        (atlas(IDEAL, count=2), {"under-actuated"}, False),
        (atlas(IDEAL, 0), {"singular"}, False),
        (atlas(IDEAL, -0.3), {"near-singular"}, False),
        (orthogonal(math.pi / 4), {"singular"}, False),
        (collinear_triple(), {"slip", "race-offset"}, False),
    ],
)
def test_findings_say_what_is_wrong(design, expected, works):
    result = check(design)
    assert {f.code for f in result.findings} == expected
    assert result.works is works


def test_singular_designs_have_no_jacobian_and_null_numbers():
    result = check(atlas(IDEAL, 0)).as_dict()
    assert result["jacobian"] is None and result["condition_number"] is None and result["effectiveness"][1] is None
    assert result["isotropy"] == 0


def test_design_regular_at_its_middle_and_singular_on_a_race_is_told():
    """Wheels so far down that the outer race stands on the pole: θ + Δθ = 90°."""
    wheel = DualRaceWheel(radius=0.02, rollers=12, roller_radius=4e-3, race_spacing=0.04)
    delta = math.degrees(wheel.races(R)[1].deflection(R))
    assert "singular-state" in codes(atlas(wheel, -(90 - delta)))


def test_json_holds_every_fixed_key_and_plain_numbers():
    result = check(atlas()).as_dict()
    fixed = {
        "constraint", "jacobian", "inverse_jacobian", "determinant", "condition_number", "effectiveness", "isotropy",
        "contact_states", "findings",
    }  # fmt: skip
    assert fixed <= set(result)
    json.dumps(result, allow_nan=False)
    assert set(result["contact_states"][0]) >= {"races", "contacts", "slip_free_dof", "rotation_dof"}
    assert len(result["contact_states"]) == 8 and result["contact_states"][0]["races"] == [[1], [1], [1]]
    assert {"code", "message"} <= set(result["findings"][0])
    np.testing.assert_array_equal(result["inverse_jacobian"], K.inverse_jacobian(atlas()))


def test_determinant_is_null_unless_there_are_three_contacts():
    assert check(six_orthogonal()).as_dict()["determinant"] is None


def test_more_than_256_states_are_told_by_their_worst_and_their_count(rng):
    wheel = DualRaceWheel(radius=0.02, rollers=12, roller_radius=4e-3, race_spacing=0.01)
    placements = [p for p in atlas(wheel, count=9).placements]
    result = check(Design("nine", Sphere(R), placements)).as_dict()
    assert result["contact_state_count"] == 512 and len(result["contact_states"]) == 1


def test_forty_dual_race_wheels_are_answered():
    """2⁴⁰ states cannot be listed; the answer still comes, and says how many there are."""
    wheel = DualRaceWheel(radius=0.005, rollers=12, roller_radius=1e-3, race_spacing=0.002)
    placements = [Placement.at(wheel, 2 * math.pi * i / 40, 0.5 * (-1) ** i) for i in range(40)]
    result = check(Design("forty", Sphere(R), placements))
    assert result.contact_state_count == 2**40 and result.works


@pytest.mark.parametrize("seed", range(10))
def test_text_of_any_design_is_printable(seed):
    rng = np.random.default_rng([30, seed])
    design = random_design(rng, int(rng.integers(1, 7)), condition=1e9)
    text = check_text(design, check(design))
    assert not re.search(r"\bnan\b", text) and "-0.000000" not in text and "contact state" in text
