"""The drawn machine against the kinematics: what is drawn to touch is what touches, and turns as it should."""

import dataclasses
import json
import math
import re

import numpy as np
import pytest

from layouts import DUAL, R, atlas
from spheredrive import kinematics
from spheredrive.design import Sphere
from spheredrive.errors import SpheredriveError
from spheredrive.frames import quaternion_matrix, rotation_matrix
from spheredrive.motion import Motion, Series
from spheredrive.scene import machine, scene_html, track_of_run, track_of_speeds
from spheredrive.scene.bodies import roller_mesh
from spheredrive.scene.mesh import Mesh, arrow, cylinder, octants, prism, tube
from spheredrive.scene.page import scene_frame, script_hash, shown_gain
from spheredrive.shape import profile, roller, wander
from spheredrive.simulation.simulate import simulate
from spheredrive.wheels import (
    DualRaceWheel,
    IdealWheel,
    MeasuredWheel,
    MecanumWheel,
    SplitDualRaceWheel,
    StandardWheel,
    TripleRaceWheel,
)

WHEELS = {
    "standard": StandardWheel(radius=0.03, rollers=10, roller_radius=0.005, roundness=0.3, phase=0.2),
    "dual-race": DualRaceWheel(**DUAL, phase=-0.3),
    "split-dual-race": SplitDualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, phase=0.1),
    "triple-race": TripleRaceWheel(radius=0.025, rollers=24, roller_radius=4.85e-3, race_spacing=12.5e-3),
    "mecanum": MecanumWheel(radius=0.03, rollers=10, phase=0.15),
    "mecanum, left": MecanumWheel(radius=0.03, rollers=10, roller_angle=-math.radians(50)),
    "spheres": DualRaceWheel(**DUAL, roller_shape="sphere"),
}


def drawn_rollers(design, body, angle):
    """Surface points of each race's rollers about the sphere's centre at wheel angle ``angle``, fine enough to measure."""
    turned = body.frame @ rotation_matrix(np.array([0.0, 0.0, 1.0]), angle)
    wheel = design.wheels[body.wheel]
    by_number = {race.number: race for race in design.races(wheel)}
    for race in body.races:
        fine = roller_mesh(roller(wheel, by_number[race.number]), 160, 121).vertices
        # Those further than a pitch from the line of centres are far from the sphere.
        near = np.cos(race.angle + angle) > math.cos(1.05 * 2 * math.pi / len(race.angle))
        points = np.einsum("nij,vj->nvi", race.turn[near], fine) + race.place[near][:, None]
        yield race, points @ turned.T + body.centre


@pytest.mark.parametrize("name", WHEELS)
def test_drawn_rollers_keep_the_distance_of_the_outline_and_touch_with_the_active_race(name):
    design = atlas(WHEELS[name], -37.0, 20.0)
    wheel = design.wheels[1]
    pitch = 2 * math.pi / wheel.rollers_per_race
    checked = 0
    # Angles away from the changes of race, over more than a pitch and to both sides of zero.
    for angle in np.linspace(-0.9, 1.4, 8) * pitch + 0.013 * pitch:
        for body in (b for b in machine(design).wheels if b.wheel == 1):
            antipodal = body.label.endswith("b")
            outline = profile(wheel, R, race=2 if antipodal else (1 if name == "split-dual-race" else None))
            gaps = {
                race.number: np.linalg.norm(points, axis=-1).min() - R for race, points in drawn_rollers(design, body, angle)
            }
            nearest = min(gaps, key=gaps.get)
            # The wheel stands at its nominal distance: what the outline falls short of it is the gap. The drawn surface lies
            # within its true one by the sagitta of its facets, ρ (π/160)²/2 = 2e-4 ρ, and the places along it alike.
            rho = max(race.roller_radius for race in design.races(wheel)) + wheel.radius
            assert gaps[nearest] == pytest.approx(-outline.height(angle), abs=2e-4 * rho)
            active = wheel.alternation[int(wheel.state_index(angle))]
            # Where the races change, the true outline may take the next one a little sooner or later than the nominal one.
            settled = abs((angle + wheel.phase_angle) / wheel.half_pitch % 1 - 0.5) < 0.3
            if len(wheel.alternation) > 1 and settled:
                checked += 1
                if name == "split-dual-race":
                    assert (gaps[nearest] < 1e-6) == ((2 if antipodal else 1) in active)
                else:
                    assert nearest in active
            if len(wheel.alternation) == 1:
                # Inclined rollers touch beside the wheel's middle, to the side that their hand says.
                _, points = next(drawn_rollers(design, body, angle))
                flat = points.reshape(-1, 3)
                touch = flat[np.linalg.norm(flat, axis=-1).argmin()] @ body.frame[:, 2]
                wanted = wander(wheel, R, angle).offset
                # Along a line of contact the distance is flat: half a step of the mesh changes it by nothing.
                assert touch == pytest.approx(wanted, abs=2.5e-4 + 0.02 * abs(wanted))
                checked += 1
    assert checked >= 3


@pytest.mark.parametrize("name", WHEELS)
def test_drawn_wheels_move_along_the_drive_direction_at_the_contact(name):
    design = atlas(WHEELS[name], -37.0, 20.0)
    for body in machine(design).wheels:
        # The point of the wheel nearest to the sphere, and where a small positive turn takes it.
        point = np.array([body.radius, 0.0, 0.0])
        moved = rotation_matrix(np.array([0.0, 0.0, 1.0]), 1e-6) @ point - point
        sign = -1.0 if body.label.endswith("b") else 1.0
        assert body.frame @ moved / (1e-6 * body.radius) == pytest.approx(sign * design.drive_directions[body.wheel], abs=1e-5)
        assert np.linalg.det(body.frame) == pytest.approx(1.0)
        assert body.centre @ body.frame[:, 0] < 0


@pytest.mark.parametrize("alpha_deg", [90, 60, -45])
@pytest.mark.parametrize("kind", ["dual-race", "split-dual-race", "triple-race", "mecanum"])
def test_drawn_rollers_stand_where_and_as_the_kinematics_have_them(kind, alpha_deg):
    design = atlas(dataclasses.replace(WHEELS[kind], roller_angle=math.radians(alpha_deg)), -37.0, 20.0)
    bodies = machine(design)
    contacts = bodies.contacts
    for body in bodies.wheels:
        for race in body.races:
            i = int(np.flatnonzero((contacts.wheel == body.wheel) & (contacts.race == race.number))[0])
            turned = body.frame @ rotation_matrix(np.array([0.0, 0.0, 1.0]), -race.angle[0])
            section = next(one for one in design.races(design.wheels[body.wheel]) if one.number == race.number)
            # A roller's axis at its contact is where it cannot give way, û = sin α v̂ − cos α Ω̂; beside the wheel's middle
            # the tangent plane, which û lies in, leans by Δθ against the wheel's axis.
            axis, lean = turned @ race.turn[0][:, 2], section.deflection(R)
            assert axis @ contacts.slip_direction[i] >= math.cos(lean) - 1e-12
            # The centre of a roller's middle stands above its race's contact, r_r further out.
            middle = body.centre + turned @ race.place[0]
            assert middle == pytest.approx((R + section.roller_radius) * contacts.contact_direction[i], abs=1e-12)


def test_machine_contacts_are_those_of_a_run_in_its_order():
    design = atlas(WHEELS["triple-race"])
    bodies = machine(design)
    assert list(zip(bodies.contacts.wheel, bodies.contacts.race, strict=True)) == [(i, r) for i in range(3) for r in (1, 2, 3)]
    assert bodies.roller_count == 72


@pytest.mark.parametrize(
    ("wheel", "missing"),
    [
        (IdealWheel(radius=0.025), ""),
        (MeasuredWheel(outline=tuple((0.1 * i, 0.025 + 1e-4 * math.sin(i)) for i in range(60))), ""),
        (StandardWheel(radius=0.025), "number of rollers"),
    ],
)
def test_machine_draws_wheels_without_rollers_as_discs(wheel, missing):
    body = machine(atlas(wheel)).wheels[0]
    assert body.races == ()
    assert missing in body.missing
    reach = np.hypot(*body.hub.vertices[:, :2].T).max()
    assert reach == pytest.approx(0.025, rel=5e-3)


def test_a_measured_wheel_shows_the_sphere_what_was_measured_at_its_angle():
    # One bump at 0.7 rad: it faces the sphere, along x of the wheel's frame, when the wheel has turned by 0.7.
    outline = tuple((0.1 * i, 0.03 if i == 7 else 0.025) for i in range(60))
    body = machine(atlas(MeasuredWheel(outline=outline))).wheels[0]
    turned = body.hub.vertices @ rotation_matrix(np.array([0.0, 0.0, 1.0]), 0.7).T
    furthest = turned[np.hypot(turned[:, 0], turned[:, 1]).argmax()]
    assert furthest[:2] == pytest.approx([0.03, 0.0], abs=1e-12)


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.sum(np.cross(a, b) * c) / 6)


def test_meshes_are_closed_and_face_outward():
    # The volume within, by the divergence theorem: positive where all faces look outward.
    assert volume(cylinder(-1.0, 1.0, 1.0, 200)) == pytest.approx(2 * math.pi, rel=1e-3)
    phi = np.linspace(0, 2 * math.pi, 200, endpoint=False)
    assert volume(prism(np.stack([np.cos(phi), np.sin(phi)], -1), 0.0, 1.0)) == pytest.approx(math.pi, rel=1e-3)
    assert volume(octants(1.0, 0, 60)) + volume(octants(1.0, 1, 60)) == pytest.approx(4 / 3 * math.pi, rel=1e-3)
    for wheel in WHEELS.values():
        body = roller(wheel, wheel.races(R)[0])
        assert volume(roller_mesh(body, 60, 41)) > 0
    assert volume(arrow()) > 0
    line = np.array([[0.0, 0, 0], [0, 0, 1], [0, 1, 2]])
    assert np.linalg.norm(tube(line, 0.1).vertices[:6] - line[0], axis=1) == pytest.approx(0.1)


def heavy(wheel=None, count=3):
    design = atlas(dataclasses.replace(wheel or WHEELS["dual-race"], mass=0.1), count=count)
    return dataclasses.replace(design, sphere=Sphere(R, 2.0))


def constant_run(design, speeds, duration=1.5):
    series = Series((0.0, duration), (tuple(speeds), tuple(speeds)))
    return simulate(design, Motion("wheel-speed", series, duration, sample_rate=100.0))


def test_track_of_run_and_track_of_speeds_agree():
    design = heavy()
    speeds = np.array([1.0, 2.0, -0.5])
    run, kinematic = track_of_run(design, constant_run(design, speeds)), track_of_speeds(design, speeds, 1.5, 100.0)
    for time in (0.33, 0.91, 1.44):
        i, j = run.index(time), kinematic.index(time)
        assert run.wheel_angle[i] == pytest.approx(kinematic.wheel_angle[j], abs=0.02 * 2)
        assert quaternion_matrix(run.orientation[i]) == pytest.approx(quaternion_matrix(kinematic.orientation[j]), abs=0.02)
    # Away from the changes, the contacts that carry are the active races'.
    for i in range(5, len(run.time), 17):
        active = kinematics.active_races(design, run.wheel_angle[i])
        shown = [tuple(r + 1 for r in range(2) if run.touching[i, 2 * k + r]) for k in range(3)]
        if all(len(s) == 1 for s in shown):
            assert tuple(shown) == active


def test_track_of_a_compliant_run_shows_the_contacts_that_carry():
    design = heavy()
    run = constant_run(design, [1.0, 1.0, 1.0], 0.2)
    run.attrs["model"] = "compliant"
    force = np.zeros(run["normal_force"].shape)
    force[:, [0, 1, 4]] = 3.0
    run["normal_force"] = (run["normal_force"].dims, force)
    shaking = np.zeros((run.sizes["time"], 3))
    shaking[:, 2] = 1e-6 * np.sin(np.arange(run.sizes["time"]))
    run["centre_displacement"] = (run["centre_displacement"].dims, shaking)
    track = track_of_run(design, run)
    assert track.touching.all(axis=0).tolist() == [True, True, False, False, True, False]
    assert track.shakes
    # 0.05 R/1e-6 = 7500: the nearest step below is 5000.
    assert shown_gain(track, R) == 5000.0
    assert '"gain":5000.0' in scene_html(design, run)


def test_track_of_run_refuses_another_machine():
    run = constant_run(heavy(), [1.0, 1.0, 1.0], 0.1)
    with pytest.raises(SpheredriveError, match="3 wheels, but the design has 4"):
        track_of_run(atlas(count=4), run)
    with pytest.raises(SpheredriveError, match="6 contacts, but the design 9"):
        track_of_run(atlas(WHEELS["triple-race"]), run)


def test_track_of_run_refuses_what_no_run_holds():
    run = constant_run(heavy(), [1.0, 1.0, 1.0], 0.1)
    falling = run.assign_coords(time=run["time"].values[::-1])
    with pytest.raises(SpheredriveError, match="do not rise"):
        track_of_run(heavy(), falling)
    for name, value in (("orientation", np.nan), ("wheel_angle", np.inf)):
        wrong = run.copy(deep=True)
        wrong[name].values[3] = value
        with pytest.raises(SpheredriveError, match=name.replace("_", " ")):
            track_of_run(heavy(), wrong)
    with pytest.raises(SpheredriveError, match="orientation"):
        track_of_run(heavy(), run.assign(orientation=run["angular_velocity"]))


def test_track_of_speeds_of_a_singular_layout_stands_still():
    track = track_of_speeds(atlas(elevation_deg=0.0), [1.0, 1.0, 1.0])
    assert len(track.time) == 1
    with pytest.raises(SpheredriveError, match="3 wheels"):
        track_of_speeds(atlas(), [1.0, 2.0])


def test_scene_html_is_one_file_that_asks_for_nothing():
    page = scene_html(atlas())
    outside = re.sub(r'<script type="application/json".*?</script>', "", page, flags=re.DOTALL)
    assert not re.search(r"https?:|url\(|import|\ssrc=|href=|fetch|XMLHttp|WebSocket|Worker", outside)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy == f"default-src 'none'; style-src 'unsafe-inline'; script-src '{script_hash()}'"
    assert len(page) < 150_000
    data = json.loads(re.search(r'<script type="application/json" id="scene">(.*?)</script>', page, re.DOTALL)[1])
    # 50 samples a second for 10 s, and a change of race each π/8 rad at 1 rad/s.
    assert data["track"]["count"] == 501 + 25
    assert len(data["contacts"]) == 6


def test_scene_html_a_name_cannot_leave_its_place():
    name = '</title></script><script>alert(1)</script>"'
    page = scene_html(dataclasses.replace(atlas(), name=name))
    assert page.count("<script") == 2
    assert scene_frame(page, "x").count("&lt;script") == 2
