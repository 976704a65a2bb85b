"""The report: what is on the page, that nothing else gets onto it, and that figures show where things are."""

import html
import math
import re

import numpy as np
import pytest

from spheredrive import kinematics
from spheredrive.checking import check
from spheredrive.design import Contact, Design, Motor, Placement, Sphere
from spheredrive.errors import DesignError, InputError
from spheredrive.motion import Motion, Series
from spheredrive.report import render_report, write_report
from spheredrive.report.figures.campbell import campbell_figure
from spheredrive.report.figures.contact_states import (
    contact_states_caption,
    contact_states_sentence,
    shown_states,
)
from spheredrive.report.figures.effectiveness import effectiveness_caption, extremes
from spheredrive.report.figures.layout import drawn_wheels, layout_figure
from spheredrive.report.figures.loads import contact_force_caption, contact_force_figure
from spheredrive.report.figures.log_axis import power_text
from spheredrive.report.figures.passing import passing_figure
from spheredrive.report.figures.projection import (
    FROM_ABOVE,
    FROM_SIDE,
    disc_outline,
    map_direction,
    mollweide,
    near_face,
    perpendicular_circle,
)
from spheredrive.report.figures.race_error import peaks, race_error_caption, race_error_figure
from spheredrive.report.figures.style import house_style, svg_text
from spheredrive.report.figures.thinning import thinned
from spheredrive.report.tables import shown_quantity, sizing_table
from spheredrive.report.vibration import mean_speeds
from spheredrive.scene.page import script_hash
from spheredrive.simulation.overview import overview
from spheredrive.simulation.rolling_run import run_rolling
from spheredrive.vibration.assessment.assess import assess
from spheredrive.wheels import DualRaceWheel, IdealWheel, SplitDualRaceWheel, StandardWheel, TripleRaceWheel

HOSTILE = "<script>alert('&\"$x^2$\x00\x1b[31m')</script>"


def ring(wheel, elevation_deg=-40.0, count=3, name="ring", radius=0.15, heading=0.0, **rest):
    places = [
        Placement.at(wheel, 2 * math.pi * i / count, math.radians(elevation_deg), math.radians(heading)) for i in range(count)
    ]
    return Design(name, Sphere(radius, mass=2.0), places, **rest)


def dual_race(name="omni"):
    return DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3, name=name)


def orthogonal():
    wheel = IdealWheel(radius=0.02)
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    return Design("orthogonal", Sphere(0.1), [Placement(wheel, x, z), Placement(wheel, y, x), Placement(wheel, z, y)])


def table_2_1():
    speeds = ("111220101212330", "012110012133120", "012121003321210")
    return Motion(
        "wheel-speed", Series([0, 0.1, *range(1, 14)], list(zip(*([*map(int, s)] for s in speeds), strict=True))), 13.0
    )


@pytest.fixture(scope="module")
def atlas_page():
    return render_report(ring(dual_race(), name="Atlas"), table_2_1())


def without_scene(page: str) -> tuple[str, str]:
    """The page without its framed scene, and the scene as the frame's own page."""
    (frame,) = re.findall(r'<iframe sandbox="allow-scripts" [^>]*></iframe>', page)
    return page.replace(frame, ""), html.unescape(re.search(r'srcdoc="([^"]*)"', frame).group(1))


def test_render_report_page_asks_for_nothing_from_outside(atlas_page):
    outside = r"https?:|//[a-z]|\bsrc\s*=|@import|<link|<script|<img|<image|xmlns"
    page, scene = without_scene(atlas_page)
    assert not re.search(outside + "|<iframe", page)
    # The scene may run its one script, which both pages name by its hash, and asks for nothing either.
    assert not re.search(r"https?:|\bsrc\s*=|@import|<link|<img|<iframe|fetch\(|XMLHttpRequest|WebSocket", scene)
    assert script_hash() in page and script_hash() in scene and scene.count("<script") == 2
    # What is referred to is a part of the same page, and is there once.
    targets = re.findall(r'(?:href="|url\()#([^")]+)', page)
    names = re.findall(r'\bid="([^"]*)"', page)
    assert targets and set(targets) <= set(names)
    assert len(names) == len(set(names))


def test_render_report_dual_race_motion_has_every_figure_within_size(atlas_page):
    page, _ = without_scene(atlas_page)
    assert page.count('role="img"') == 9
    assert page.count("aria-label=") == 9
    assert len(atlas_page.encode()) < 1_500_000
    assert "spheredrive report DESIGN.toml MOTION.toml -o report.html" in atlas_page


def test_render_report_hostile_names_are_escaped():
    design = ring(dual_race(HOSTILE), name=HOSTILE)
    object.__setattr__(design, "source", f"name = '{HOSTILE}'\ud800")
    page = render_report(design)
    page, scene = without_scene(page)
    assert "<script" not in page and "\x00" not in page and "\x1b" not in page
    assert page.count("&lt;script&gt;") >= 5
    assert "alert(" not in re.sub(r"&lt;script.*?&lt;/script&gt;", "", scene) and "\x1b" not in scene
    page.encode()


def test_svg_text_hostile_words_stay_words():
    from matplotlib.figure import Figure

    with house_style():
        figure = Figure()
        figure.text(0.5, 0.5, "<script>$\\frac{1}{2}$</script>--> 漢")
    svg = svg_text(figure, "key", 'a "label" <b>')
    assert "&lt;script&gt;$\\frac{1}{2}$&lt;/script&gt;" in svg and "<script" not in svg
    assert 'aria-label="a &quot;label&quot; &lt;b&gt;"' in svg


def test_render_report_same_input_gives_same_bytes(atlas_page):
    assert render_report(ring(dual_race(), name="Atlas"), table_2_1()) == atlas_page


def test_write_report_writes_the_page(tmp_path):
    design = orthogonal()
    path = write_report(design, tmp_path / "report.html")
    assert path == tmp_path / "report.html"
    assert path.read_text(encoding="utf-8") == render_report(design)


def test_write_report_missing_folder_leaves_nothing(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        write_report(orthogonal(), tmp_path / "none" / "report.html")
    assert list(tmp_path.iterdir()) == []


def test_render_report_motion_for_other_wheel_count_is_refused():
    with pytest.raises(DesignError, match="2 columns, but the design has 3 wheels"):
        render_report(orthogonal(), Motion("wheel-speed", Series([0], [[1, 2]]), 1.0))


# What is said where there is nothing to draw.


def sentence(page, part):
    found = re.search(rf'<p id="{part}">(.*?)</p>', page, re.DOTALL)
    return found and found[1]


def test_render_report_single_wheel_says_that_it_does_not_work():
    page = render_report(Design("one", Sphere(0.1), [Placement(IdealWheel(radius=0.02), (1, 0, 0), (0, 1, 0))]))
    assert "The design does not work." in page and "under-actuated" in page
    assert "None: the wheels do not determine" in page
    assert "there is one contact state" in sentence(page, "states")


def test_render_report_singular_design_says_why_motion_is_not_followed():
    page = render_report(ring(dual_race(), elevation_deg=0.0), table_2_1())
    assert "The motion cannot be followed: the layout is singular" in sentence(page, "motion")
    assert "up without limit" in page and "what lies above is drawn in the last one" in page


def test_render_report_torques_are_not_followed():
    torques = Motion("wheel-torque", Series([0], [[1, 1, 1]]), 1.0)
    assert "Kinematics cannot follow it" in sentence(render_report(orthogonal(), torques), "motion")


def test_render_report_wheels_without_alternation_have_no_error_figure():
    page = render_report(orthogonal(), Motion("sphere-velocity", Series([0, 1], [[0, 0, 1], [1, 0, 0]]), 1.0))
    assert "No wheel of this design has races that take turns" in sentence(page, "error")
    assert 'id="motion"' in page and "wheel speed (rad/s)" in page


def test_render_report_split_races_say_that_the_nominal_jacobian_is_exact():
    page = render_report(ring(SplitDualRaceWheel(radius=0.04, rollers=16)), table_2_1())
    assert "the nominal Jacobian is exact" in sentence(page, "error")


def test_render_report_assumptions_are_named():
    page = render_report(ring(StandardWheel(radius=0.03, mass=0.2)))
    assert "hollow" in page and "solid disc" in page and "Contacts are rigid" in page and "Mounts are rigid" in page


# Numbers in captions are those of the kinematics.


def test_race_error_caption_has_the_peaks_of_the_run():
    run = kinematics.along(ring(dual_race()), table_2_1())
    caption = race_error_caption(run)
    assert f"{math.degrees(run.error_angle.max()):.2f}°" in caption and "3.15°" in caption
    assert f"{100 * np.abs(run.error_magnitude).max():.2f} %" in caption and "3.79 %" in caption
    assert f"Races change {len(run.race_changes)} times in 13 s" in caption
    for i in peaks(run):
        assert f"at {run.time[i]:.3f} s" in caption


def test_effectiveness_caption_has_the_range():
    design = ring(dual_race())
    low, high = kinematics.effectiveness(design)
    caption = effectiveness_caption(design)
    assert f"{low:.4f} (axis z" in caption and f"to {high:.4f} (any axis perpendicular to z" in caption


def test_effectiveness_isotropic_design_is_one_colour():
    design = orthogonal().rotated(np.linalg.qr([[1.0, 2, 3], [4, 5, 6], [7, 8, 10]])[0])
    assert extremes(design).uniform
    assert "ξ = 1.0000 about every axis" in effectiveness_caption(design)


def test_extremes_marked_axes_have_the_extreme_effectiveness():
    for design in (ring(dual_race()), ring(StandardWheel(radius=0.03), heading=25.0, elevation_deg=30.0)):
        found = extremes(design)
        np.testing.assert_allclose(kinematics.effectiveness_about(design, found.slowest), found.low, rtol=1e-9)
        np.testing.assert_allclose(kinematics.effectiveness_about(design, found.weakest), found.high, rtol=1e-9)


def test_contact_states_caption_has_the_worst_state():
    result = check(ring(dual_race()))
    worst = min(result.contact_states, key=lambda state: state.isotropy)
    assert f"from {worst.isotropy:.3f} (state 1, races 1 1 1)" in contact_states_caption(result)
    assert "In 8 of 8 contact states" in contact_states_caption(result)


def test_contact_states_slipping_states_are_counted():
    x, y, xy = np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.array([1.0, 1, 0]) / math.sqrt(2)
    wheel = TripleRaceWheel(radius=0.02, rollers=24, roller_radius=3e-3, race_spacing=8e-3)
    turns = (y, np.array([0, 0, 1.0]), x)
    places = [Placement(wheel, tuple(R), tuple(np.cross(turn, R))) for R, turn in zip((x, xy, y), turns, strict=True)]
    assert "In 1 of 8 contact states" in contact_states_caption(check(Design("collinear", Sphere(0.1), places)))


def test_contact_states_many_show_the_worst_and_say_so():
    result = check(ring(dual_race(), count=7, elevation_deg=-30.0))
    shown = [state.isotropy for _, state in shown_states(result)]
    assert len(shown) == 32 and shown == sorted(shown)
    assert shown[-1] <= sorted(state.isotropy for state in result.contact_states)[31]
    assert "The worst 32 of 128 states are shown" in contact_states_caption(result)


def test_contact_states_too_many_to_list_is_a_sentence():
    result = check(ring(dual_race(), count=10, elevation_deg=-30.0))
    assert contact_states_sentence(result).startswith("There are 1024 contact states, too many to list.")


# Loads of a run of the dynamics.


def driven(friction=0.9, **rest):
    wheel = DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3, mass=0.1)
    return ring(wheel, name="Atlas", contact=Contact(friction=friction), **rest)


def pushed(*rows, duration=0.5):
    return Motion("wheel-torque", Series(tuple(np.linspace(0, duration, len(rows))), rows), duration)


GENTLE = pushed((0.02, 0.01, 0.02), (-0.01, 0.0, 0.01))


@pytest.fixture(scope="module")
def driven_page():
    return render_report(driven(), GENTLE)


def test_render_report_torques_show_motion_motors_forces_and_sizing(driven_page):
    for key in ("motion", "motors", "forces"):
        assert f'<figure id="{key}">' in driven_page
    assert "Energy ledger" in sentence(driven_page, "sizing") and "RMS torque" in driven_page
    assert "Kinematics cannot follow it" not in driven_page and "The design works." in driven_page
    names = re.findall(r'\bid="([^"]*)"', driven_page)
    assert len(names) == len(set(names)) and len(driven_page.encode()) < 1_500_000


def test_render_report_torques_same_input_gives_same_bytes(driven_page):
    assert render_report(driven(), GENTLE) == driven_page


def test_render_report_broken_limits_are_findings_with_wheel_and_time():
    text = render_report(driven(motor=Motor(speed=1.0)), GENTLE)
    assert "The layout works, but the design does not in this motion." in text
    assert re.search(r"Wheel 1 passes its motor&#39;s speed limit of 1 rad/s from 0\.\d+ s on", text)


def test_render_report_sizing_table_holds_the_peaks_of_the_run(driven_page):
    result = overview(driven(), run_rolling(driven(), GENTLE))
    table = sizing_table(result)
    assert len(table.columns) == len(table.units) == len(table.rows[0]) == 13
    for row, peak in zip(table.rows, result.loads.peaks, strict=True):
        assert row[:2] == (str(peak.wheel), f"{peak.torque:.4g}")
        assert f'<td class="number">{peak.speed:.4g}</td>' in driven_page


def test_render_report_prescribed_velocity_keeps_kinematics_and_gains_loads():
    text = render_report(driven(), Motion("sphere-velocity", Series((0.0, 0.3), ((0.1, 0.2, 0.3), (1, -1, 2))), 0.3))
    for key in ("motion", "error", "motors", "forces"):
        assert f'<figure id="{key}">' in text


def test_render_report_without_masses_says_why_there_are_no_loads(atlas_page):
    assert "The loads are not worked out: the dynamics need the mass" in sentence(atlas_page, "loads")
    triple = TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4e-3, race_spacing=10e-3, mass=0.1)
    assert "touch together slip" in sentence(render_report(ring(triple), GENTLE), "loads")


@pytest.mark.parametrize(
    ("design", "motion", "panels"),
    [
        (driven(), GENTLE, 3),
        (driven(friction=None), GENTLE, 2),
        (driven(elevation_deg=0.0, heading=30.0), GENTLE, 1),
        (driven(count=40, elevation_deg=-30.0), pushed((0.01,) * 40), 3),
    ],
    ids=["all known", "no friction", "normal forces unknown", "forty wheels"],
)
def test_contact_force_figure_shows_what_is_known(design, motion, panels):
    run = run_rolling(design, motion)
    result = overview(design, run)
    figure = contact_force_figure(run, result.loads)
    assert len(figure.axes) == panels and contact_force_caption(result)
    if design.wheel_count == 3:
        force = run.normal_force if panels > 1 else run.friction_force
        drawn = [line for line in figure.axes[0].lines if line.get_label().startswith("wheel")]
        assert [line.get_ydata().min() for line in drawn] == force.min(axis=0).tolist()


# Where things are drawn.


def test_views_have_the_right_hand_of_the_machine():
    x, y, z = np.eye(3)
    np.testing.assert_array_equal(FROM_ABOVE.project([x, y, z]), [[1, 0], [0, 1], [0, 0]])
    np.testing.assert_array_equal(FROM_SIDE.project([x, y, z]), [[1, 0], [0, 0], [0, 1]])
    # The viewer stands above, and at −y: there y points away.
    np.testing.assert_array_equal(FROM_ABOVE.towards, z)
    np.testing.assert_array_equal(FROM_SIDE.towards, -y)


def test_drawn_wheels_atlas_places_and_drives_by_the_formulas():
    design = ring(StandardWheel(radius=0.025))
    first, second, _ = drawn_wheels(design)
    c, s = math.cos(math.radians(40)), math.sin(math.radians(40))
    # Wheel 1 at azimuth 0: contact to the right and below, driving towards +y, which is up as seen from above.
    np.testing.assert_allclose(FROM_ABOVE.project(first.contacts), [[150 * c, 0]], atol=1e-12)
    np.testing.assert_allclose(FROM_SIDE.project(first.contacts), [[150 * c, -150 * s]])
    np.testing.assert_allclose(FROM_ABOVE.project(first.centre), [175 * c, 0], atol=1e-12)
    np.testing.assert_allclose(FROM_ABOVE.project(first.drive_direction), [0, 1], atol=1e-12)
    assert FROM_SIDE.depth(first.drive_direction) == pytest.approx(-1)
    # Wheel 2 at azimuth 120°: up and to the left from above, driving anticlockwise: to the left and down.
    np.testing.assert_allclose(FROM_ABOVE.project(second.contacts)[0], [-75 * c, 75 * math.sqrt(3) * c])
    np.testing.assert_allclose(FROM_ABOVE.project(second.drive_direction), [-math.sqrt(3) / 2, -0.5])
    assert not first.in_front(FROM_ABOVE) and not second.in_front(FROM_SIDE)


def test_drawn_wheels_dual_races_touch_where_the_kinematics_says():
    design = ring(dual_race())
    wheels = drawn_wheels(design)
    for number in (0, 1):
        found = kinematics.contacts(design, [number + 1] * 3).contact_direction
        np.testing.assert_allclose([wheel.contacts[number] for wheel in wheels], 150 * found, atol=1e-9)
    R_hat, v_hat = wheels[0].contact_direction, wheels[0].drive_direction
    # Race 1 lies at −d/2 along the wheel's axis ŵ = −R̂ × v̂.
    offset = wheels[0].discs[0][0] - wheels[0].centre
    np.testing.assert_allclose(offset, 6.25 * np.cross(R_hat, v_hat), atol=1e-9)


def test_drawn_wheels_split_pair_has_a_second_wheel_opposite():
    wheels = drawn_wheels(ring(SplitDualRaceWheel(radius=0.04, rollers=16)))
    assert [wheel.label for wheel in wheels] == ["1", "1b", "2", "2b", "3", "3b"]
    np.testing.assert_allclose(wheels[1].centre, -wheels[0].centre)
    np.testing.assert_allclose(wheels[1].drive_direction, -wheels[0].drive_direction)


def test_disc_outline_edge_on_and_face_on():
    x, y, z = np.eye(3)
    # Axis z, from above: a circle. From the side: a rectangle as wide as the disc and twice its radius long.
    above = disc_outline(FROM_ABOVE, 10 * x, x, y, 3.0, 2.0)
    np.testing.assert_allclose(np.hypot(*(above - [10, 0]).T), 3.0)
    side = disc_outline(FROM_SIDE, 10 * x, x, y, 3.0, 2.0)
    assert [side[:, 0].min(), side[:, 0].max()] == pytest.approx([7, 13])
    np.testing.assert_allclose(np.unique(np.round(side[:, 1], 12)), [-1, 1])
    # Axis tilted 30° from the line of sight: half height r cos 30° + (w/2) sin 30°.
    tilted = disc_outline(FROM_ABOVE, 0 * x, x, np.cos(np.pi / 6) * y + np.sin(np.pi / 6) * z, 3.0, 2.0)
    assert np.abs(tilted[:, 1]).max() == pytest.approx(3 * math.cos(math.pi / 6) + 0.5, rel=2e-3)


def test_near_face_is_the_one_towards_the_viewer():
    x, y, z = np.eye(3)
    tilt = np.cos(0.5) * y + np.sin(0.5) * z
    # The axis x × tilt looks up and towards −y: from above the upper face is the one at −y.
    face = near_face(FROM_ABOVE, 0 * x, x, tilt, 1.0, 1.0)
    np.testing.assert_allclose((face[:-1]).mean(axis=0), [0, -0.5 * math.sin(0.5)], atol=1e-12)


@pytest.mark.parametrize("elevation_deg", [-90.0, -40.0, 0.0, 45.0])
def test_layout_figure_everything_stands_within_the_frame(elevation_deg):
    count = 1 if elevation_deg == -90 else 3
    figure = layout_figure(ring(IdealWheel(radius=0.15), elevation_deg=elevation_deg, count=count), FROM_SIDE)
    axes = figure.axes[0]
    left, right = axes.get_xlim()
    places = np.concatenate([patch.get_xy() for patch in axes.patches if hasattr(patch, "get_xy")])
    texts = np.array([text.get_position() for text in axes.texts])
    assert np.abs(places).max() < right == -left
    assert np.abs(texts).max() < right
    numbers = texts[[text.get_text().isdigit() for text in axes.texts]]
    apart = np.linalg.norm(numbers[:, None] - numbers[None], axis=-1)[np.triu_indices(count, 1)]
    assert (apart > 0.09 * right).all()


def test_layout_figure_arrow_points_along_the_drive_direction():
    from matplotlib.patches import FancyArrowPatch

    axes = layout_figure(Design("one", Sphere(0.1), [Placement(IdealWheel(radius=0.02), (1, 0, 0), (0, 1, 0))])).axes[0]
    wheel_arrow = next(patch for patch in axes.patches if isinstance(patch, FancyArrowPatch))
    reached = wheel_arrow.get_path().vertices
    assert reached[0] == pytest.approx([100, 0], abs=1e-6)
    assert reached[:, 1].max() == pytest.approx(42, abs=2)


def test_mollweide_keeps_known_points_and_areas():
    root = math.sqrt(2)
    x, y = mollweide([0, np.pi, np.pi / 2, 0], [0, 0, 0, np.pi / 2])
    np.testing.assert_allclose(x, [0, 2 * root, root, 0], atol=1e-12)
    np.testing.assert_allclose(y, [0, 0, 0, root], atol=1e-12)
    # A zone up to elevation ε has the share sin ε of the map's half, π/2 each way of 2√2·√2: equal area.
    elevation = np.radians(np.linspace(0, 50, 2001))
    x, y = mollweide(np.pi, elevation)
    assert 2 * np.trapezoid(x, y) == pytest.approx(2 * np.pi * math.sin(elevation[-1]), rel=1e-6)


def test_map_direction_puts_positive_azimuth_to_the_right():
    x, y = map_direction([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0]])
    root = math.sqrt(2)
    np.testing.assert_allclose(x, [0, root, 0, -root], atol=1e-12)
    np.testing.assert_allclose(y, [0, 0, root, 0], atol=1e-12)


def test_perpendicular_circle_is_perpendicular_and_of_unit_length():
    axis = np.array([0.48, -0.6, 0.64])
    points = perpendicular_circle(axis)
    np.testing.assert_allclose(points @ axis, 0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1)


# Lines with fewer points.


def test_thinned_keeps_peaks_steps_and_ends():
    rng = np.random.default_rng(1)
    time = np.sort(np.concatenate([np.linspace(0, 13, 50_001), [1.0001, 1.0001, 7.5, 7.5]]))
    values = np.stack([np.sin(time), rng.normal(size=len(time))], -1)
    kept = thinned(time, values)
    assert len(kept) < 4000 and kept[0] == 0 and kept[-1] == len(time) - 1
    assert (values[kept].max(axis=0) == values.max(axis=0)).all()
    assert (values[kept].min(axis=0) == values.min(axis=0)).all()
    for i in np.flatnonzero(np.diff(time) == 0):
        assert i in kept and i + 1 in kept


def test_race_error_figure_line_reaches_the_peak():
    run = kinematics.along(ring(dual_race()), table_2_1())
    _, angle, magnitude = race_error_figure(run).axes
    assert angle.lines[0].get_ydata().max() == np.degrees(run.error_angle.max())
    assert np.abs(magnitude.lines[0].get_ydata()).max() == 100 * np.abs(run.error_magnitude).max()


@pytest.mark.parametrize(
    ("content", "unit", "shown"),
    [
        (0.025, "m", "25 mm"),
        (1e6, "N/m", "1000000 N/m"),
        (3.125e-5, "kg m^2", "3.125 × 10⁻⁵ kg m²"),
        ((0.0, 6e-17, -1.0), "", "(0, 0, −1)"),
        (math.pi / 4, "rad", "45°"),
        (2.1e11, "Pa", "210 GPa"),
    ],
)
def test_shown_quantity_reads_as_on_a_drawing(content, unit, shown):
    assert shown_quantity(content, unit) == shown


# Vibration.


def shaken(stiffness=2e5, **rest):
    wheel = StandardWheel(radius=0.03, rollers=14, roundness=0.3, mass=0.1)
    return ring(wheel, name="shaken", contact=Contact(stiffness, 0.0 if stiffness is None else 60.0), **rest)


@pytest.fixture(scope="module")
def shaken_page():
    return render_report(shaken(), speeds=np.array([3.0, 2.0, 1.0]))


def test_render_report_at_speeds_has_every_figure_of_the_vibration(shaken_page):
    for key in ("outlines", "orders", "campbell", "passing", "transmissibility"):
        assert f'<figure id="{key}">' in shaken_page
    assert "The wheels turn at 3, 2, 1 rad/s." in sentence(shaken_page, "vibration")
    assert '--speeds "3 2 1 rad/s" -o report.html' in shaken_page and "mathdefault" not in shaken_page
    names = re.findall(r'\bid="([^"]*)"', shaken_page)
    assert len(names) == len(set(names)) and len(shaken_page.encode()) < 1_500_000
    assert render_report(shaken(), speeds=np.array([3.0, 2.0, 1.0])) == shaken_page


def test_render_report_vibration_tables_hold_the_assessment(shaken_page):
    found = assess(shaken(), [3.0, 2.0, 1.0])
    sizes = found.sphere.sizes
    for number in (sizes.peak_displacement * 1e6, sizes.rms_velocity * 1e3, found.excitations[2].passing_frequency):
        assert f'<td class="number">{number:.4g}</td>' in shaken_page
    assert f"{found.sphere.comfort.total:.3g} m/s²" in sentence(shaken_page, "vibration")


def test_render_report_motion_is_shaken_at_the_mean_size_of_its_speeds():
    there_and_back = Motion("wheel-speed", Series((0.0, 1.0, 2.0), ((1, 1, 2), (1, -1, 2), (1, -3, 2))), 2.0)
    # Means of |1|, |1 − 2t| and |2| over 2 s: 1, 1.25 and 2.
    np.testing.assert_allclose(mean_speeds(shaken(), there_and_back, None), [1.0, 1.25, 2.0], rtol=1e-5)
    assert "the mean sizes of their speeds" in sentence(render_report(shaken(), there_and_back), "vibration")
    spin = Motion("sphere-velocity", Series((0.0,), ((0.0, 0.0, 1.0),)), 1.0)
    want = np.abs(kinematics.inverse(shaken(), [0.0, 0.0, 1.0]))
    np.testing.assert_allclose(mean_speeds(shaken(), spin, None), want, rtol=1e-12)


def test_render_report_vibration_that_is_not_known_says_why():
    bare = Design("bare", Sphere(0.15), shaken().placements)
    assert "The vibration is not worked out: vibration needs sphere.mass." in sentence(
        render_report(bare, speeds=[1.0, 1.0, 1.0]), "vibration"
    )
    still = ring(IdealWheel(radius=0.03), contact=Contact(2e5))
    page = render_report(still, speeds=[1.0, 1.0, 1.0])
    assert "Nothing shakes the sphere." in sentence(page, "vibration") and 'id="orders"' not in page


def test_render_report_rigid_contacts_have_no_modes_and_say_so():
    page = render_report(shaken(stiffness=None), speeds=[1.0, 2.0, 3.0])
    assert "where it has no limit" in sentence(page, "vibration")
    assert 'id="campbell"' not in page and 'id="transmissibility"' not in page and '<figure id="passing">' in page


def test_campbell_figure_draws_lines_through_the_meetings():
    found = assess(shaken(), [3.0, 2.0, 1.0])
    axes = campbell_figure(found).axes[0]
    (meetings,) = (line for line in axes.lines if line.get_label() == "meeting")
    rising = [line for line in axes.lines if line.get_xdata()[0] == 0 and line.get_ydata()[0] == 0]
    slopes = [line.get_ydata()[1] / line.get_xdata()[1] for line in rising]
    for speed, frequency in zip(*meetings.get_data(), strict=True):
        # Places are rounded to 1e-6, of speeds of some rad/s.
        assert min(abs(frequency / speed - slope) for slope in slopes) < 1e-4 * frequency / speed


def test_passing_figure_follows_the_response():
    found = assess(shaken(), [3.0, 2.0, 1.0])
    axes = passing_figure(found).axes[0]
    time, drawn = axes.lines[2].get_data()
    factor = {"m": 1e0, "mm": 1e3, "µm": 1e6, "nm": 1e9}[axes.get_ylabel().split("(")[1].rstrip(")")]
    np.testing.assert_allclose(drawn, found.response.at(time).displacement[:, 2] * factor, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("value", "text"), [(1e-3, "10⁻³"), (0.01, "0.01"), (1.0, "1"), (1e3, "1000"), (1e4, "10⁴")])
def test_power_text_is_plain_where_people_know_it(value, text):
    assert power_text(value) == text
