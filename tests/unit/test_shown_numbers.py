"""Numbers and places as a person sees them: what ``check`` prints, what the report's tables and figures show.

Expected matrices come from the closed forms of a ring of wheels at elevation −θ with heading χ (model.md section 1), whose
Ω̂ is cos χ n − sin χ e, spelled out in ``rows``; printed numbers have six decimals, so they are 5e-7 off at most.
"""

import math
import re

import numpy as np
import pytest

from spheredrive.checking import check
from spheredrive.design import Design, Placement, Sphere
from spheredrive.report import tables
from spheredrive.report.figures.effectiveness import effectiveness_figure, extremes
from spheredrive.report.figures.layout import drawn_wheels, layout_figure
from spheredrive.report.figures.projection import FROM_ABOVE, FROM_SIDE, map_direction, map_path, mollweide
from spheredrive.summary import check_text
from spheredrive.wheels import DualRaceWheel, IdealWheel, SplitDualRaceWheel, StandardWheel, TripleRaceWheel

PRINTED = 5.001e-7
R = 0.2
# Three places without any symmetry: azimuth, elevation, heading, wheel radius.
PLACES = ((-50, -35, 30, 0.020), (75, -20, -65, 0.025), (190, 10, 100, 0.032))


def places_design(places=PLACES, name="askew"):
    placements = [
        Placement.at(StandardWheel(radius=r, rollers=12, name=f"w{i}"), *np.radians(place))
        for i, (*place, r) in enumerate(places, 1)
    ]
    return Design(name, Sphere(R), placements)


def direction(azimuth_deg, elevation_deg):
    p, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(p) * math.cos(e), math.sin(p) * math.cos(e), math.sin(e)])


def rows(places=PLACES):
    """A: Ω̂ = cos χ n − sin χ e, with e = (−sin φ, cos φ, 0) and n = (−cos φ sin ε, −sin φ sin ε, cos ε)."""
    found = []
    for place in places:
        p, e, h = (math.radians(a) for a in place[:3])
        east = np.array([-math.sin(p), math.cos(p), 0])
        north = np.array([-math.cos(p) * math.sin(e), -math.sin(p) * math.sin(e), math.cos(e)])
        found.append(math.cos(h) * north - math.sin(h) * east)
    return np.array(found)


A = rows()
RADII = np.array([place[3] for place in PLACES])
INVERSE = A * (R / RADII)[:, None]
J = np.linalg.inv(INVERSE)
SIGMA = np.sqrt(np.linalg.eigvalsh(A.T @ A))[::-1]
AXES = np.linalg.eigh(A.T @ A)[1].T[::-1]
# Nine wheels: more than six, so the page shows J with a row a wheel.
MANY = tuple((40 * i + 7, -40 + 9 * i, 25 * i - 60, 0.02 + 0.002 * i) for i in range(9))


def shown(cells):
    return np.array([[float(cell.replace("−", "-")) for cell in row] for row in cells])


def printed_block(text, title):
    """The rows of numbers under the line that starts with ``title``."""
    lines = text.splitlines()
    first = next(i for i, line in enumerate(lines) if line.strip().startswith(title)) + 1
    block = []
    for line in lines[first:]:
        if not re.fullmatch(r"[\s\d.+−-]+", line) or not line.strip():
            break
        block.append(line.split())
    return shown(block)


def line_of(text, start):
    return next(line.strip() for line in text.splitlines() if line.strip().startswith(start))


def test_places_are_of_full_use_as_a_test():
    """Three different singular values, a Jacobian that is not symmetric, and a J⁻¹ that is not A."""
    assert SIGMA[0] > 1.1 * SIGMA[1] > 1.21 * SIGMA[2] > 0.1
    assert np.abs(J - J.T).max() > 0.01 and np.abs(INVERSE - A).max() > 1


def test_check_text_matrices_are_those_they_are_called():
    design = places_design()
    text = check_text(design, check(design))
    np.testing.assert_allclose(printed_block(text, "A of A"), A, atol=PRINTED)
    np.testing.assert_allclose(printed_block(text, "inverse Jacobian"), INVERSE, atol=PRINTED)
    np.testing.assert_allclose(printed_block(text, "Jacobian"), J, atol=PRINTED)


def test_check_text_quality_lines_tell_the_right_singular_values():
    design = places_design()
    text = check_text(design, check(design))
    assert line_of(text, "effectiveness").split()[2:] == [f"{1 / SIGMA[0]:.4f}", "to", f"{1 / SIGMA[2]:.4f}"]
    assert line_of(text, "isotropy").split()[1] == f"{SIGMA[2] / SIGMA[0]:.4f}"
    assert line_of(text, "condition number").split()[2] == f"{SIGMA[0] / SIGMA[2]:.4g}"
    assert float(line_of(text, "determinant of A").split()[3]) == pytest.approx(np.linalg.det(A), rel=5e-6)
    for start, axis in (("worst direction", AXES[2]), ("slowest direction", AXES[0])):
        told = np.array([float(x) for x in re.search(r"\(([^)]*)\)", line_of(text, start))[1].split(",")])
        # Two decimals of each component; an axis has no sign.
        assert min(np.abs(told - axis).max(), np.abs(told + axis).max()) <= 0.00501


def test_check_text_wheels_stand_at_their_angles():
    design = places_design()
    lines = check_text(design, check(design)).splitlines()
    for number, (azimuth, elevation, heading, radius) in enumerate(PLACES, 1):
        cells = next(line.split() for line in lines if line.split()[:2] == [str(number), f"w{number}"])
        angles = [float(cell.rstrip("°")) for cell in cells if cell.endswith("°")]
        assert angles == pytest.approx([90, azimuth % 360, elevation, heading], abs=1e-4)
        assert cells[3:6] == [f"{1e3 * radius:g}", "mm", "12"]


@pytest.mark.parametrize(("theta_deg", "change"), [(40, "+40.00°"), (70, "-20.00°")])
def test_nearest_singularity_is_told_with_its_sign(theta_deg, change):
    """Atlas is singular at θ = 0 and 90°: from elevation −40° it lies 40° up, from −70° it lies 20° down.

    σ² of A: 3/2 sin² θ twice and 3 cos² θ.
    """
    theta = math.radians(theta_deg)
    sigma = sorted([math.sqrt(1.5) * math.sin(theta), math.sqrt(3) * math.cos(theta)])
    design = places_design([(120 * i, -theta_deg, 0, 0.025) for i in range(3)])
    result = check(design)
    line = line_of(check_text(design, result), "nearest singularity")
    assert f"elevation of all wheels changed by {change}" in line.replace("−", "-")
    assert line.endswith(f"(σ₃ of A now {sigma[0]:.4f})")
    assert tables.singularity_text(result).replace("−", "-") == f"elevation of all wheels changed by {change}"


def test_matrices_of_three_wheels_are_those_they_are_called():
    constraint, inverse, jacobian = tables.matrices(check(places_design()))
    assert (constraint.title, inverse.title, jacobian.title) == ("Constraint A", "Inverse Jacobian J⁻¹", "Jacobian J")
    assert constraint.columns == inverse.columns == ("x", "y", "z")
    assert [name for name, _ in inverse.rows] == ["ω 1", "ω 2", "ω 3"]
    assert jacobian.columns == ("wheel 1", "wheel 2", "wheel 3")
    assert [name for name, _ in jacobian.rows] == ["Ω x", "Ω y", "Ω z"]
    for matrix, expected in ((constraint, A), (inverse, INVERSE), (jacobian, J)):
        np.testing.assert_allclose(shown(cells for _, cells in matrix.rows), expected, atol=PRINTED)


def test_matrices_of_many_wheels_show_the_jacobian_by_wheel():
    """Nine wheels with square rollers: J = (AᵀA)⁻¹AᵀB, a row a wheel on the page."""
    many, B = rows(MANY), np.diag([place[3] / R for place in MANY])
    jacobian = tables.matrices(check(places_design(MANY)))[2]
    assert jacobian.columns == ("x", "y", "z") and [name for name, _ in jacobian.rows] == [f"wheel {i}" for i in range(1, 10)]
    expected = np.linalg.solve(many.T @ many, many.T @ B).T
    np.testing.assert_allclose(shown(cells for _, cells in jacobian.rows), expected, atol=PRINTED)


def test_quality_rows_tell_slowest_and_weakest_apart():
    """Atlas at 40°: 3 cos² θ = 1.76 about z exceeds 3/2 sin² θ = 0.62 about x and y. At 70° it is the other way round."""
    for theta, of_z in ((40, "Slowest direction"), (70, "Worst direction")):
        result = check(places_design([(120 * i, -theta, 0, 0.025) for i in range(3)]))
        found = {row.name: row.value for row in tables.quality_rows(result)}
        other = {"Slowest direction": "Worst direction", "Worst direction": "Slowest direction"}[of_z]
        assert found[of_z] == "z" and found[other].endswith(" axis perpendicular to z")
    found = {row.name: row.value for row in tables.quality_rows(check(places_design()))}
    assert found["Isotropy"] == f"{SIGMA[2] / SIGMA[0]:.4f}"
    assert found["Effectiveness ξ"] == f"{1 / SIGMA[0]:.4f} to {1 / SIGMA[2]:.4f}"
    assert found["Condition number"] == f"{SIGMA[0] / SIGMA[2]:.4g}"
    assert float(found["Determinant of A"].replace("−", "-")) == pytest.approx(np.linalg.det(A), rel=5e-6)


def test_placement_rows_show_the_angles_of_the_file():
    for row, (azimuth, elevation, heading, radius) in zip(tables.placement_rows(places_design()), PLACES, strict=True):
        angles = [float(cell.rstrip("°").replace("−", "-")) for cell in row[5:]]
        assert angles == pytest.approx([90, azimuth % 360, elevation, heading], abs=1e-4)
        assert row[3] == f"{1e3 * radius:g} mm"


# Figures: where things are drawn.

DUAL = DualRaceWheel(radius=0.03, rollers=16, roller_radius=0.006, race_spacing=0.04)


def drawn(wheel):
    return drawn_wheels(Design("one", Sphere(R), [Placement.at(wheel, *np.radians((-50, -35, 30)))]))


def test_drawn_wheels_a_dual_race_wheel_stands_lower_than_a_single_one():
    """Height of the centre (R + r_r) cos Δ + r − r_r with sin Δ = 20/206, in mm; R + r is 0.97 mm more."""
    (wheel,) = drawn(DUAL)
    lean = math.asin(20 / 206)
    height = 206 * math.cos(lean) + 30 - 6
    assert 0.9 < 230 - height < 1.0
    np.testing.assert_allclose(wheel.centre, height * direction(-50, -35), atol=1e-9)
    # Discs stand at ∓20 mm along ŵ = −Ω̂, contacts at R (R̂ cos Δ ± ŵ sin Δ); the rim passes ŵ at r.
    axle = -rows([(-50, -35, 30)])[0]
    for (centre, _), contact, side in zip(wheel.discs, wheel.contacts, (-1, 1), strict=True):
        np.testing.assert_allclose(centre, height * direction(-50, -35) + side * 20 * axle, atol=1e-9)
        expected = 200 * (math.cos(lean) * direction(-50, -35) + side * math.sin(lean) * axle)
        np.testing.assert_allclose(contact, expected, atol=1e-9)
    # The roller's own centre, r − r_r towards the sphere from the disc's centre, is R + r_r from the sphere's.
    for centre, _ in wheel.discs:
        assert np.linalg.norm(centre - 24 * direction(-50, -35)) == pytest.approx(206, abs=1e-9)


def test_drawn_wheels_of_other_types_stand_at_their_heights():
    """Single race: R + r. Level triple race: R + r of the centre race. Outer races 2 mm larger than level: 2 mm higher."""
    (single,) = drawn(StandardWheel(radius=0.03, rollers=12, roller_radius=0.006))
    assert np.linalg.norm(single.centre) == pytest.approx(230, abs=1e-9)
    triple = dict(radius=0.03, rollers=24, roller_radius=0.006, race_spacing=0.02)
    assert np.linalg.norm(drawn(TripleRaceWheel(**triple))[0].centre) == pytest.approx(230, abs=1e-9)
    level = 0.03 + 0.206 * (1 - math.cos(math.asin(20 / 206)))
    assert np.linalg.norm(drawn(TripleRaceWheel(**triple, outer_radius=level + 0.002))[0].centre) == pytest.approx(
        232, abs=1e-9
    )
    first, second = drawn(SplitDualRaceWheel(radius=0.03, rollers=12))
    np.testing.assert_allclose(first.centre, 230 * direction(-50, -35), atol=1e-9)
    np.testing.assert_allclose(second.centre, -230 * direction(-50, -35), atol=1e-9)
    np.testing.assert_allclose(second.drive_direction, -first.drive_direction, atol=1e-12)


def test_views_show_the_machine_unmirrored():
    """From above x runs right and y up; from −y x runs right and z up. Right × up looks at the viewer: +z and −y."""
    point = [1.0, 2, 3]
    np.testing.assert_allclose(FROM_ABOVE.project(point), [1, 2])
    np.testing.assert_allclose(FROM_SIDE.project(point), [1, 3])
    assert (FROM_ABOVE.depth(point), FROM_SIDE.depth(point)) == (3, -2)


@pytest.mark.parametrize("view", [FROM_ABOVE, FROM_SIDE])
def test_layout_figure_marks_contacts_where_they_are(view):
    figure = layout_figure(places_design(), view)
    marks = np.concatenate([line.get_xydata() for line in figure.axes[0].lines if line.get_markersize() == 3.2])
    third = 1 if view is FROM_ABOVE else 2
    expected = np.array([200 * direction(*place[:2]) for place in PLACES])[:, [0, third]]
    # Wheels are drawn by depth: compare without order.
    np.testing.assert_allclose(np.array(sorted(map(tuple, marks))), np.array(sorted(map(tuple, expected))), atol=1e-9)


def on_map(azimuth_deg, elevation_deg):
    """Mollweide's place: 2θ + sin 2θ = π sin ε, x = 2√2 φ cos θ/π, y = √2 sin θ."""
    theta = 0.0
    for _ in range(200):
        # Newton's method, which converges away from the poles: θ ← θ − f/f′, f′ = 2 + 2 cos 2θ.
        f = 2 * theta + math.sin(2 * theta) - math.pi * math.sin(math.radians(elevation_deg))
        theta -= f / (2 + 2 * math.cos(2 * theta))
    return 2 * math.sqrt(2) / 180 * azimuth_deg * math.cos(theta), math.sqrt(2) * math.sin(theta)


@pytest.mark.parametrize("place", [(0, 0), (90, 0), (-90, 0), (50, 40), (-50, 40), (130, -25), (-130, -60)])
def test_map_direction_azimuth_runs_to_the_right_and_elevation_up(place):
    np.testing.assert_allclose(map_direction(direction(*place)), on_map(*place), atol=1e-9)
    np.testing.assert_allclose(mollweide(*np.radians(place)), on_map(*place), atol=1e-9)
    np.testing.assert_allclose(np.array(map_path([direction(*place)] * 2))[:, 0], on_map(*place), atol=1e-9)


def test_map_direction_of_the_axes():
    """x in the middle, y to the right of it, −y to the left, z on top; a quarter turn is half of the half axis 2√2."""
    x, y = map_direction([[1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    np.testing.assert_allclose(x, [0, math.sqrt(2), -math.sqrt(2), 0, 0], atol=1e-9)
    np.testing.assert_allclose(y, [0, 0, 0, math.sqrt(2), -math.sqrt(2)], atol=1e-9)


def test_effectiveness_figure_marks_wheels_and_extreme_axes_at_their_places():
    found = extremes(places_design())
    assert (found.low, found.high) == pytest.approx((1 / SIGMA[0], 1 / SIGMA[2]), rel=1e-12)
    axes = effectiveness_figure(places_design()).axes[0]
    by_label = {line.get_label(): line.get_xydata() for line in axes.lines}
    wheels = by_label["contact of a wheel"]
    expected = [on_map((azimuth + 180) % 360 - 180, elevation) for azimuth, elevation, *_ in PLACES]
    np.testing.assert_allclose(wheels, expected, atol=1e-9)
    for start, axis in (("least", AXES[0]), ("largest", AXES[2])):
        marks = next(data for label, data in by_label.items() if label.startswith(start))
        ends = [on_map(math.degrees(math.atan2(d[1], d[0])), math.degrees(math.asin(d[2]))) for d in (axis, -axis)]
        np.testing.assert_allclose(np.array(sorted(map(tuple, marks))), np.array(sorted(ends)), atol=1e-9)


def test_effectiveness_figure_colours_the_field_the_same_way_round():
    """The highest band of ξ holds the weakest axis, and not its image in the plane of x and z, where ξ = |Ω|/|A Ω| is less."""
    axes = effectiveness_figure(places_design()).axes[0]
    weakest = AXES[2]
    mirrored = weakest * [1, -1, 1]
    assert 1 / np.linalg.norm(A @ mirrored) < 0.8 / SIGMA[2]
    highest = max((c for c in axes.collections if hasattr(c, "levels")), key=lambda c: c.levels[0])

    def inside(d):
        place = on_map(math.degrees(math.atan2(d[1], d[0])), math.degrees(math.asin(d[2])))
        return any(path.contains_point(place) for path in highest.get_paths())

    assert inside(weakest) and not inside(mirrored)


def test_ideal_wheels_are_printed_without_rollers():
    design = Design("bare", Sphere(R), [Placement.at(IdealWheel(radius=0.03, name="w1"), 0.1, -0.5)])
    cells = next(line.split() for line in check_text(design, check(design)).splitlines() if line.split()[:2] == ["1", "w1"])
    assert cells[2:6] == ["ideal", "30", "mm", "-"]
