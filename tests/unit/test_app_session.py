"""A page without a browser: what its controls do to the design, the answers and the clock."""

import dataclasses
import math
import time

import numpy as np
import pytest

from layouts import atlas
from spheredrive import kinematics
from spheredrive.app.answers import answers, nearness
from spheredrive.app.editing import rings
from spheredrive.app.inbox import Inbox
from spheredrive.app.panels.machine import Slider, from_slider, read_text, sliders
from spheredrive.app.picture import quaternion_of, quaternion_to
from spheredrive.app.player import Playback, Turning, advanced
from spheredrive.app.server import start_server
from spheredrive.app.session import Session
from spheredrive.app.uploads import shown_name, uploaded_design, uploaded_run
from spheredrive.app.words import jacobian_html, status_html
from spheredrive.checking import check
from spheredrive.design import Sphere
from spheredrive.designs import design_path, shipped_designs
from spheredrive.errors import DesignError, InputError
from spheredrive.frames import quaternion_matrix
from spheredrive.io.design_file import load_design
from spheredrive.io.design_text import design_text
from spheredrive.io.results import write_run
from spheredrive.motion import Motion, Series
from spheredrive.scene import track_of_speeds
from spheredrive.simulation.simulate import simulate

pytest.importorskip("viser")


@pytest.fixture(scope="module")
def server():
    running = start_server()
    yield running
    running.stop()


@pytest.fixture(scope="module")
def run():
    """Half a second of the dual-race Atlas, as it is shipped."""
    design = load_design(design_path("atlas-dual-race"))
    motion = Motion("wheel-speed", Series((0.0, 0.5), ((1.0, 2.0, 3.0),) * 2), 0.5, sample_rate=200.0)
    return simulate(design, motion)


@pytest.fixture
def session(server, run):
    server.gui.reset()
    server.scene.reset()
    return Session(server, load_design(design_path("atlas-dual-race")), run)


def test_session_a_slider_changes_jacobian_answers_and_picture_at_once(session):
    wheel = session.picture._wheels[0]
    before = np.array(wheel[2][0].position)
    session.change("elevation", math.radians(-25.0))
    expected = kinematics.jacobian(atlas(elevation_deg=-25.0))
    assert session._answers.check.jacobian == pytest.approx(expected, abs=1e-12)
    assert f"{expected[0, 0]:.4f}" in session.jacobian.content
    # One wheel centre is (R + height) R̂, in units of the first sphere's radius: it has risen by the change of sin ε.
    rise = (np.array(session.picture._wheels[0][2][0].position) - before)[2] / np.linalg.norm(before)
    assert rise == pytest.approx(math.sin(math.radians(-25)) - math.sin(math.radians(-40)), abs=1e-9)


def test_session_what_cannot_be_built_is_told_and_the_last_machine_stays(session):
    design = session.design
    session.change("roller_angle", 0.0)
    assert session.design == design
    assert "1 to 90 deg" in session.status.content and "1 to 90 deg" in session.brief.content
    session.change("roller_angle", math.radians(80.0))
    assert "1 to 90 deg" not in session.status.content


def test_session_near_a_singularity_the_sphere_takes_the_colour_of_a_warning(session):
    shades = []
    for elevation in (-40.0, -9.0, -6.0, 0.0):
        session.change("elevation", math.radians(elevation))
        shades.append(np.array(session.picture._parts["octants 0"].color, int))
    # Further from grey each time: blue, which no warning has, falls.
    assert np.all(np.diff([int(max(shade) - min(shade)) for shade in shades]) > 0)
    assert "does not work" in session.status.content and "no Jacobian" in session.jacobian.content


def test_session_every_type_count_and_shape_can_be_drawn(session):
    for kind in ("ideal", "standard", "split-dual-race", "triple-race", "mecanum", "dual-race"):
        session.change("type", kind)
        assert session.refusal == "" and session.design.wheels[0].type == kind
    assert session.design == load_design(design_path("atlas-dual-race"))
    for count in (1, 2, 6, 4, 3):
        session.change("count", count)
        assert len(session.speeds) == session.design.wheel_count == len(session.picture._wheels) == count


def test_session_wheels_turn_by_the_clock_and_take_the_sphere_with_them(session):
    session.drive_for(np.array([0.0, 0.0, 1.0]))
    session.restart()
    session.turning = advanced(session.design, session.turning, session.speeds, 1.0)
    turn = quaternion_matrix(session.turning.orientation)
    # By the nominal Jacobian one radian about z; the races that touch err by a few per cent of it.
    assert math.atan2(turn[1, 0], turn[0, 0]) == pytest.approx(1.0, abs=0.05)
    assert session.turning.wheel_angle == pytest.approx(session.speeds)


def test_session_plays_steps_and_scrubs_a_run(session, run):
    session._inbox.close()
    assert session.track is not None and not session.playback.playing
    session.toggle_play()
    session._last = time.perf_counter() - 0.2
    session._tick()
    assert 0.19 < session.playback.time < 0.25
    i = session.track.index(session.playback.time)
    assert np.array(session.picture.sphere.wxyz) == pytest.approx(run["orientation"].values[i], abs=1e-12)
    session.step("◂")
    assert not session.playback.playing and session.playback.time == session.track.time[i - 1]
    session.step("▸|")
    assert session.playback.time == session.track.time[-1]
    session.set_playback(time=0.3)
    assert session.track.index(0.3) == int(np.flatnonzero(run["time"].values <= 0.3)[-1])


def test_session_a_changed_machine_puts_the_run_aside_until_it_is_asked_for(session):
    session.change("elevation", -0.5)
    assert session.strange and session.playing.again.visible
    session.back_to_run()
    assert not session.strange


def test_session_contacts_move_as_races_take_turns(session, run):
    shown = []
    for i in (0, len(run["time"]) // 3, len(run["time"]) - 2):
        session.set_playback(time=float(run["time"].values[i]))
        dots = session.picture._parts["contacts"]
        large = np.array(dots.batched_scales)[:, 0] > 0.9 * np.array(dots.batched_scales).max()
        active = run["active_race"].values[i]
        shown.append(active.tolist())
        assert [k + 1 for k in range(6) if large[k]] == [2 * w + r for w, r in enumerate(active)]
    assert len({tuple(races) for races in shown}) > 1


def test_session_opens_uploaded_files_and_tells_what_is_wrong_with_others(session, run, tmp_path):
    session._guarded(lambda: session.open_design(b'name = "x"\n[sphere]\nradius = 25 mm', "C:\\designs\\bad.toml"))
    assert "bad.toml" in session.error.content and "line 3" in session.error.content
    session._guarded(lambda: session.open_run(b"not a run", "run.nc"))
    assert "not a NetCDF-4 file" in session.error.content
    session.open_design(design_text(atlas(elevation_deg=-20.0)).encode(), "a.toml")
    assert session.design == atlas(elevation_deg=-20.0) and session.track is None
    # A run brings the machine that it was made of.
    session.open_run(write_run(run, tmp_path / "run.nc").read_bytes(), "run.nc")
    assert session.design == load_design(design_path("atlas-dual-race")) and session.track is not None


def test_uploaded_design_cannot_name_other_files(tmp_path):
    text = design_text(atlas()).replace('type = "dual-race"', 'type = "measured"\nfile = "/etc/passwd"')
    with pytest.raises(InputError, match="names a file"):
        uploaded_design(text.encode(), "../../x.toml")
    with pytest.raises(InputError, match="1 MiB"):
        uploaded_design(b"#" * (2**20 + 1), "x.toml")
    with pytest.raises(InputError):
        uploaded_run(b"\x89HDF\r\n\x1a\n" + b"\0" * 100, "x.nc")
    assert shown_name("C:\\a\\..\\b\n.toml") == "b\N{REPLACEMENT CHARACTER}.toml"


def test_answers_of_every_shipped_design_are_those_of_check():
    for name in shipped_designs():
        design = load_design(design_path(name))
        found = answers(design, np.ones(design.wheel_count))
        assert found.check.findings == check(design).findings
        html = status_html(found, "<script>") + jacobian_html(found)
        assert "<script>" not in html and "&lt;script&gt;" in html


def test_nearness_rises_towards_a_singularity():
    found = [nearness(check(atlas(elevation_deg=e))) for e in (-40.0, -9.0, -5.0, -1.0, 0.0)]
    assert found[0] == 0.0 and found[-1] == 1.0 and found == sorted(found)


def test_inbox_keeps_the_latest_of_each_kind_in_order():
    inbox, done = Inbox(), []
    for k in range(5):
        inbox.put("slider", lambda k=k: done.append(k))
        inbox.put(("other", k % 2), lambda k=k: done.append(f"other {k}"))
    for work in inbox.take(0):
        work()
    assert done == ["other 3", 4, "other 4"]
    assert inbox.take(0) == []


def test_sliders_stand_where_the_design_is_and_mean_it_again():
    design = load_design(design_path("ballbot"))
    wheel = design.wheels[0]
    for slider in sliders(design, rings(design)[0]):
        assert slider.low <= slider.value <= slider.high
        if slider.key in ("radius", "roller_radius", "race_spacing", "roller_angle"):
            assert from_slider(slider.value, slider) == getattr(wheel, slider.key)
    assert from_slider(30.099999999999998, Slider("", "", 0, 90, 0.1, 30, 1e-3)) == 0.0301


@pytest.mark.parametrize(("text", "value"), [("2 kg", 2.0), ("", None), ("350 g", 0.35)])
def test_read_text_takes_units_and_nothing(text, value):
    field = next(field for field in dataclasses.fields(Sphere) if field.name == "mass")
    assert read_text(text, field) == value


@pytest.mark.parametrize("text", ["2", "2 mm", "two kg", "-1 kg", "nan kg"])
def test_read_text_refuses_what_a_file_would(text):
    field = next(field for field in dataclasses.fields(Sphere) if field.name == "mass")
    with pytest.raises(DesignError):
        read_text(text, field)


def test_advanced_follows_the_kinematics_along_the_same_speeds():
    design, legs = atlas(), ((3.0, -1.5, 6.0), (-6.0, 4.0, 1.0))
    turning = Turning.at_rest(design)
    for speeds in legs:
        for _ in range(20):
            turning = advanced(design, turning, np.array(speeds), 0.05)
    exact = kinematics.along(design, Motion("wheel-speed", Series((0.0, 1.0), legs, "step"), 2.0, sample_rate=50.0))
    # Steps see a change of race up to half a step, 0.025 rad of a wheel, early or late; the two races' motions differ by 8 %,
    # so each of fewer than 60 changes lets the sphere err by less than r/R · 0.025 · 0.08 = 3.3e-4 · ξ, to either side.
    assert quaternion_matrix(turning.orientation) == pytest.approx(quaternion_matrix(exact.orientation[-1]), abs=5e-3)


def test_playback_begins_anew_at_its_end():
    track = track_of_speeds(atlas(), [1.0, 1.0, 1.0], 1.0)
    assert Playback(0.9, True, 4.0).after(0.1, track).time == 0.0
    assert Playback(0.5, True, 0.1).after(0.1, track).time == pytest.approx(0.51)
    assert Playback(0.5, False).after(0.1, track).time == 0.5


def test_quaternions_of_matrices_and_directions(rng):
    for _ in range(200):
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        found = quaternion_of(quaternion_matrix(q))
        assert min(np.abs(found - q).max(), np.abs(found + q).max()) < 1e-12
        vector = rng.normal(size=3)
        assert quaternion_matrix(quaternion_to(vector))[:, 2] == pytest.approx(vector / np.linalg.norm(vector))
    assert quaternion_matrix(quaternion_to([0, 0, -2.0]))[:, 2] == pytest.approx([0, 0, -1])
