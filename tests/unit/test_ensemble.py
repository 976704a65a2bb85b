"""Ensembles: members from their numbers alone, and numbers that closed forms know."""

from dataclasses import replace

import numpy as np
import pytest

import spheredrive as sd
from spheredrive.errors import SpheredriveError
from spheredrive.frames import quaternion_exponential, quaternion_matrix, quaternion_product
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant.run import Accuracy, run_compliant, wheel_motion
from spheredrive.studies.ensemble import Spread, ensemble, ensemble_text, varied_design, varied_designs
from spheredrive.studies.ensemble import runs as room
from spheredrive.studies.ensemble.command import ensemble_command, spread_of
from spheredrive.studies.ensemble.numbers import NUMBERS, angle_between, numbers_of
from spheredrive.wheels import TYPES

ROUGH = Accuracy(length=1e-7)
TURN = Motion("sphere-velocity", Series((0.0, 0.05, 0.1), ((0, 0, 0), (0.4, 0.2, 0.5), (0.4, 0.2, 0.5))), 0.1)
ALL = Spread(friction=0.2, alignment=2e-3, radius=1e-3, wear=2e-5)


@pytest.fixture(scope="module")
def atlas():
    d = sd.load_design(sd.design_path("atlas-dual-race"))
    return replace(d, contact=replace(d.contact, damping=200.0), closure=replace(d.closure, force=(0.0, 0.0, -80.0)))


@pytest.fixture(scope="module")
def round_wheels(atlas):
    """The same machine on ideal wheels: its orientation follows from its Jacobian alone but for creep."""
    wheel = TYPES["ideal"](radius=0.025, mass=0.1)
    return replace(atlas, placements=tuple(replace(p, wheel=wheel) for p in atlas.placements))


def test_members_follow_from_seed_and_number_alone(atlas):
    some = varied_designs(atlas, ALL, 5, seed=3)
    assert some[4] == varied_design(atlas, ALL, 3, 4) and some[:2] == varied_designs(atlas, ALL, 2, seed=3)
    assert len({d.contact.friction for d in some}) == 5 and some[0] != varied_design(atlas, ALL, 4, 0)


def test_without_spread_members_are_the_design(atlas):
    assert varied_design(atlas, Spread(), 1, 7) == atlas


def test_scatter_has_the_deviations_asked_for(atlas):
    """Over N members a standard deviation is known to 1/√(2N) of itself, three wheels 3N: five of these are allowed."""
    N = 400
    some = varied_designs(atlas, ALL, N)
    friction = np.array([d.contact.friction for d in some]) / atlas.contact.friction
    assert abs(friction.mean() - 1) < 5 * 0.2 / np.sqrt(N) and friction.min() > 0
    # The fourth moment of a log-normal number is larger than a normal one's: twice the room.
    assert abs(friction.std() / 0.2 - 1) < 10 / np.sqrt(2 * N)
    turned = np.array([np.cross(atlas.contact_directions, d.contact_directions) for d in some])
    # sin of the angle by which a contact direction moves: two axes of the rotation act on it.
    assert abs(np.sqrt(np.sum(turned**2, axis=2).mean()) / (np.sqrt(2) * 2e-3) - 1) < 5 / np.sqrt(2 * 3 * N)
    for d in some[:20]:
        assert abs(np.sum(d.contact_directions * d.drive_directions, axis=1)).max() < 1e-15
    only_wear = varied_designs(atlas, Spread(wear=2e-5), N)
    gone = np.array([[w.radius - 0.025, w.roller_radius - 0.00485] for d in only_wear for w in d.wheels])
    np.testing.assert_allclose(gone[:, 0], gone[:, 1], atol=1e-17)
    # E z² = 1 for a half-normal number, its fourth moment that of a normal one.
    assert (gone <= 0).all() and abs(np.sqrt(np.mean(gone[:, 0] ** 2)) / 2e-5 - 1) < 5 / np.sqrt(2 * 3 * N)


def test_wheels_scatter_each_for_itself(atlas):
    d = varied_design(atlas, ALL, 1, 0)
    assert len({w.radius for w in d.wheels}) == 3
    turns = [_frame(d, i) @ _frame(atlas, i).T for i in range(3)]
    assert all(np.abs(turns[i] - turns[j]).max() > 1e-4 for i, j in ((0, 1), (1, 2), (2, 0)))


def _frame(design, i):
    contact, drive = design.contact_directions[i], design.drive_directions[i]
    return np.stack([contact, drive, np.cross(contact, drive)], axis=1)


def test_a_measured_outline_shrinks_as_a_whole(atlas):
    angle = np.arange(8) * np.pi / 4
    wheel = TYPES["measured"](outline=tuple((a, 0.025 + 1e-4 * np.cos(4 * a)) for a in angle), mass=0.1)
    d = replace(atlas, placements=tuple(replace(p, wheel=wheel) for p in atlas.placements))
    worn = varied_design(d, Spread(wear=1e-4), 1, 0).wheels[0]
    assert abs((wheel.radius - worn.radius) - (wheel.mean_radius - worn.mean_radius)) < 1e-15 and worn.radius < wheel.radius


def test_angle_between_is_that_of_the_turn():
    p = quaternion_exponential(np.array([0.3, -0.2, 0.9]))
    for angle in (1e-12, 1e-3, 2.0, np.pi):
        q = quaternion_product(p, quaternion_exponential(angle * np.array([2.0, -1.0, 2.0]) / 3))
        assert abs(angle_between(p, q) - angle) < 1e-15 + 1e-14 * angle
        assert angle_between(p, -q) == angle_between(p, q)


def test_orientation_error_is_what_the_jacobians_say(round_wheels):
    """Wheels too large by δ turn the sphere by (1 + δ) times as far; a controller knows only the design as drawn.

    The sphere turns about one axis, so the error is δ ∫Ω dt, Ω rising to |Ω| in 0.05 s and held for 0.05 s. Creep, the slip by
    which friction comes up, is alike for both runs and leaves the δ-th part of itself, far below the 1 % allowed.
    """
    delta = 1e-2
    larger = replace(round_wheels.wheels[0], radius=0.025 * (1 + delta))
    d = replace(round_wheels, placements=tuple(replace(p, wheel=larger) for p in round_wheels.placements))
    asked = wheel_motion(round_wheels, TURN)
    runs = run_compliant(d, asked, ROUGH), run_compliant(round_wheels, asked, ROUGH)
    found = dict(zip([n.name for n in NUMBERS], numbers_of(*runs), strict=True))
    expected = delta * np.linalg.norm([0.4, 0.2, 0.5]) * 0.075
    assert abs(found["orientation_error"] / expected - 1) < 0.01
    assert found["orientation_error_peak"] >= found["orientation_error"] and found["lift_offs"] == 0


def test_a_turned_frame_turns_the_sphere_about_a_turned_axis(round_wheels):
    """All wheels turned by T: A T Ω = Bω, so the axis turns by T and the error is |TΩ − Ω| t, to first order in the turn."""
    small = np.array([1e-3, 2e-3, -1e-3])
    turn = quaternion_matrix(quaternion_exponential(small))
    asked = wheel_motion(round_wheels, TURN)
    run, drawn = run_compliant(round_wheels.rotated(turn), asked, ROUGH), run_compliant(round_wheels, asked, ROUGH)
    error = numbers_of(run, drawn)[0]
    assert abs(error / (np.linalg.norm(np.cross(small, [0.4, 0.2, 0.5])) * 0.075) - 1) < 0.03


def test_members_do_not_depend_on_pieces_or_threads(atlas):
    import numba

    whole = ensemble(atlas, TURN, ALL, 4, accuracy=ROUGH)
    threads = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        pieces = ensemble(atlas, TURN, ALL, 4, accuracy=ROUGH, chunk=3)
    finally:
        numba.set_num_threads(threads)
    assert whole.identical(pieces)
    assert len(set(whole.orientation_error.values)) == 4 and (whole.orientation_error > 0).all()


def test_failures_keep_their_reason(atlas):
    """Wear of the size of a roller's radius leaves some members without rollers."""
    found = ensemble(atlas, TURN, Spread(wear=3.5e-3), 6, accuracy=Accuracy(length=1e-6))
    failed = found.reason.values != ""
    assert 0 < failed.sum() < 6
    np.testing.assert_array_equal(np.isnan(found.slip_work), failed)
    assert "roller_radius" in found.reason.values[failed][0]
    assert f"{6 - failed.sum()} of 6 machines come through" in ensemble_text(found)


def test_a_design_that_cannot_move_is_refused(atlas):
    with pytest.raises(SpheredriveError, match=r"needs contact\.friction"):
        ensemble(replace(atlas, contact=replace(atlas.contact, friction=None)), TURN, ALL, 1)
    with pytest.raises(SpheredriveError, match="at least one"):
        ensemble(atlas, TURN, ALL, 0)


def test_command_goes_on_where_it_was_stopped(atlas, tmp_path, monkeypatch):
    monkeypatch.setattr(room, "RUNS_AT_ONCE", 2)
    monkeypatch.setattr(room.ensemble, "__kwdefaults__", {**room.ensemble.__kwdefaults__, "chunk": 2})

    def stop(share):
        if share > 0.4:
            raise KeyboardInterrupt

    quick = replace(TURN, duration=0.02)
    with pytest.raises(KeyboardInterrupt):
        ensemble_command(atlas, quick, tmp_path / "a", ALL, 4, 1, stop)
    assert not (tmp_path / "a" / "ensemble.nc").exists()
    ran = []
    monkeypatch.setattr(room, "members", lambda *given, f=room.members, **rest: ran.append(given[-1]) or f(*given, **rest))
    found = ensemble_command(atlas, quick, tmp_path / "a", ALL, 4, 1)
    assert ran == [range(2, 4)]
    ensemble_command(atlas, quick, tmp_path / "b", ALL, 4, 1)
    assert len(ran) == 3
    for name in ("ensemble.nc", "distribution.svg"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert found.works and found.as_dict()["members"] == 4 and "slip work (J)" in found.text()


def test_spread_takes_units():
    assert spread_of(0.1, "0.1 deg", 1e-3, "20 um") == Spread(0.1, np.radians(0.1), 1e-3, 2e-5)
    with pytest.raises(SpheredriveError, match=r"-0\.1"):
        spread_of(-0.1)
