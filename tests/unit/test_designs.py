"""The designs that come with the package load and are what their names say."""

import math

import numpy as np
import pytest

from spheredrive.designs import design_path, motion_path, shipped_designs, shipped_motions
from spheredrive.errors import UnknownNameError
from spheredrive.io.design_file import load_design
from spheredrive.io.motion_file import load_motion


@pytest.mark.parametrize("name", shipped_designs())
def test_shipped_designs_load_and_say_what_they_are(name):
    design = load_design(design_path(name))
    assert design.wheel_count >= 3
    assert design.source.startswith("# ")


def test_shipped_designs_are_those_of_the_model():
    assert {
        "atlas-demonstrator",
        "atlas-dual-race",
        "atlas-mecanum",
        "ballbot",
        "collinear-triple-race",
        "orthogonal",
        "six-orthogonal",
    } <= set(shipped_designs())


def spin_axes(name):
    design = load_design(design_path(name))
    return np.cross(design.contact_directions, design.drive_directions)


def test_orthogonal_is_the_benchmark():
    design = load_design(design_path("orthogonal"))
    assert np.array_equal(design.contact_directions, np.eye(3))
    assert np.array_equal(design.drive_directions, np.eye(3)[[2, 0, 1]])


def test_collinear_triple_race_drives_about_three_axes():
    # model.md section 2: R̂ = i, (i+j)/√2, j and Ω̂ = j, k, i.
    assert np.allclose(spin_axes("collinear-triple-race"), np.eye(3)[[1, 2, 0]], atol=1e-15)
    assert np.linalg.matrix_rank(load_design(design_path("collinear-triple-race")).contact_directions) == 2


def test_six_orthogonal_wheels_stand_in_opposite_pairs():
    design = load_design(design_path("six-orthogonal"))
    assert np.array_equal(design.contact_directions[3:], -design.contact_directions[:3])
    assert np.array_equal(spin_axes("six-orthogonal")[3:], spin_axes("six-orthogonal")[:3])


def test_atlas_mecanum_rollers_have_the_radius_of_the_model():
    # model.md section 3: 12.37 mm for 16 rollers on 75.8 mm.
    assert load_design(design_path("atlas-mecanum")).wheels[0].roller_section == pytest.approx(12.37e-3, abs=5e-6)


def test_ballbot_stands_on_its_ball():
    design = load_design(design_path("ballbot"))
    assert all(p.azimuth_elevation_heading[1] == pytest.approx(math.pi / 4) for p in design.placements)
    wheels = sum(wheel.mass for wheel in design.wheels)
    # The floor carries all there is.
    weight = 9.81 * (design.sphere.mass + design.stage.mass + wheels)
    assert design.closure.force == pytest.approx((0, 0, weight), rel=1e-3)


def test_atlas_table_2_1_is_the_table():
    motion = load_motion(motion_path("atlas-table-2-1"), 3)
    speeds = np.array(motion.series.values)
    assert motion.series.time == (0, 0.1, *range(1, 14))
    assert speeds[:, 0].tolist() == [1, 1, 1, 2, 2, 0, 1, 0, 1, 2, 1, 2, 3, 3, 0]
    assert speeds[:, 1].tolist() == [0, 1, 2, 1, 1, 0, 0, 1, 2, 1, 3, 3, 1, 2, 0]
    assert speeds[:, 2].tolist() == [0, 1, 2, 1, 2, 1, 0, 0, 3, 3, 2, 1, 2, 1, 0]
    assert shipped_motions() == ["atlas-table-2-1"]


def test_design_path_another_name_is_refused_with_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'ballbot'"):
        design_path("balbot")
    with pytest.raises(UnknownNameError, match="atlas-table-2-1"):
        motion_path("../atlas-table-2-1")
