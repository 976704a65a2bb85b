"""What the vibration functions take, return and refuse."""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import atlas, orthogonal
from spheredrive import vibration
from spheredrive.design import Closure, Contact, Mount, Placement, Sphere, Spring
from spheredrive.errors import DesignError, SingularError, SpheredriveError
from spheredrive.motion import Motion, Series
from spheredrive.shape import profile
from spheredrive.vibration.motion.groups import fraction, groups
from spheredrive.wheels import IdealWheel, SplitDualRaceWheel, StandardWheel

WHEEL = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25)


def machine(wheel=WHEEL, **parts):
    design = replace(atlas(wheel, radius=1.22), sphere=Sphere(1.22, 5.0), contact=Contact(188208.0, 200.0))
    return replace(design, **parts)


def test_modes_of_mounted_wheels_have_a_shape_for_every_coordinate():
    modes = vibration.modes(machine(mount=Mount(1e6)))
    assert modes.shapes.shape == (6, 6) and len(modes.labels) == 6
    assert modes.labels[0] == "sphere x" and modes.labels[-1] == "mount 3"
    assert (np.diff(modes.natural_frequencies) >= -1e-9).all()
    np.testing.assert_allclose(np.abs(modes.shapes).max(axis=1), 1.0)


def test_modes_with_an_isolator_have_the_payloads_coordinates():
    modes = vibration.modes(machine(), isolator=vibration.Isolator(2.0, (500.0, 600.0, 700.0)))
    assert modes.labels[-3:] == ("payload x", "payload y", "payload z") and modes.shapes.shape == (6, 6)


def test_modes_of_a_rigid_machine_are_none():
    assert not len(vibration.modes(machine(contact=Contact())).natural_frequencies)


def test_modes_lists_each_pole_once_where_poles_meet():
    lam = vibration.modes(machine(contact=Contact(188208.0, 0.0))).poles
    assert len(lam) == 3


@pytest.mark.parametrize(
    ("design", "words"),
    [
        (lambda: replace(machine(), sphere=Sphere(1.22)), "sphere.mass"),
        (lambda: machine(replace(WHEEL, mass=None), mount=Mount(1e6)), "wheels.wheel"),
        (lambda: replace(atlas(WHEEL, radius=1.22, count=4), sphere=Sphere(1.22, 5.0)), "4 rigid contacts"),
    ],
)
def test_linear_system_names_what_is_missing(design, words):
    with pytest.raises(SpheredriveError, match=words):
        vibration.linear_system(design())


def test_linear_system_names_the_direction_nothing_holds():
    flat = machine()
    ring = [Placement.at(WHEEL, 2 * math.pi * i / 3, 0.0) for i in range(3)]
    design = replace(flat, placements=ring)
    with pytest.raises(SingularError, match=r"along \(0, 0, -?1\)"):
        vibration.response(design, [1, 1, 1])
    held = replace(design, closure=Closure(springs=(Spring((0, 0, 1), 1e4),)))
    assert vibration.modes(held).natural_frequencies[0] == pytest.approx(math.sqrt(1e4 / 5) / (2 * math.pi))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (dict(model="copled"), "did you mean 'coupled'"),
        (dict(closure_sign="thesis"), "own model"),
        (dict(measure="thesis"), "own model"),
        (dict(measure="elastic", model="independent"), "no measure"),
        (dict(closure_sign="up", model="independent"), "no sign"),
        (dict(model="independent", isolator=vibration.Isolator(1.0, 1.0)), "isolator"),
        (dict(profiles=()), "0 profiles"),
        (dict(normal_force=math.nan), "finite"),
    ],
)
def test_linear_system_refuses_what_does_not_go_together(options, words):
    with pytest.raises(SpheredriveError, match=words):
        vibration.linear_system(machine(), **options)


@pytest.mark.parametrize(
    "values", [dict(mass=0), dict(stiffness=-1), dict(damping=math.nan), dict(stiffness=(1, 2)), dict(mass="1")]
)
def test_isolator_refuses_values_none_has(values):
    with pytest.raises(DesignError, match="isolator"):
        vibration.Isolator(**{"mass": 1.0, "stiffness": 1.0, **values})


@pytest.mark.parametrize("speed", [[1, 2], [1, 2, math.nan], 1.0])
def test_response_refuses_speeds_that_do_not_fit(speed):
    with pytest.raises(SpheredriveError, match="wheel_speed"):
        vibration.response(machine(), speed)


def test_response_says_which_harmonic_hits_an_undamped_frequency():
    design = machine(contact=Contact(188208.0))
    natural = vibration.modes(design).natural_frequencies[2]
    with pytest.raises(SingularError, match=r"harmonic 3 of wheel 2.*hits the undamped natural frequency"):
        vibration.response(design, [0, natural / 3 * 2 * math.pi / 14, 0])


def test_response_flags_contacts_that_would_pull():
    steady = vibration.response(machine(), [20.0, 20.0, 20.0])
    assert {lost.wheel for lost in steady.contact_lost} == {1, 2, 3}
    assert min(lost.least_force for lost in steady.contact_lost) == steady.force_min.min() < 0
    run = vibration.transient(machine(), [20.0, 20.0, 20.0], 1.0)
    wheel, time = run.first_loss
    k = int(np.searchsorted(run.time, time))
    assert run.contact_force[k, wheel - 1] < 0 and not run.contact_lost[:k].any()
    pressed = vibration.response(machine(), [20.0, 20.0, 20.0], normal_force=1e5)
    assert not pressed.contact_lost


def test_response_at_takes_any_shape():
    motion = vibration.response(machine(), [1, 2, 3]).at(np.zeros((2, 5)))
    assert motion.displacement.shape == (2, 5, 3) and motion.contact_force.shape == (2, 5, 3)
    assert vibration.response(machine(), [1, 2, 3]).at(0.3).velocity.shape == (3,)


def test_response_of_wheels_that_stand_is_still():
    steady = vibration.response(machine(), [0, 0, 0], wheel_angle=[0.0, 0.1, 0.2])
    assert steady.rms_acceleration == 0 and steady.rms_displacement == 0 and steady.peak_displacement > 0


def test_split_dual_race_wheel_has_a_contact_on_each_side():
    wheel = SplitDualRaceWheel(radius=0.05, rollers=16, roller_radius=0.008, mass=0.2)
    ls = vibration.linear_system(machine(wheel, mount=Mount(1e6)))
    np.testing.assert_array_equal(ls.contacts.wheel, [0, 0, 1, 1, 2, 2])
    np.testing.assert_allclose(ls.contacts.normal[0], -ls.contacts.normal[1])
    np.testing.assert_allclose(ls.contacts.mass, 0.1)


def test_fraction_finds_small_ratios_alone():
    assert fraction(1.0) == (1, 1) and fraction(12.0) == (12, 1) and fraction(0.75) == (3, 4)
    assert fraction(0.75 * (1 + 1e-10)) == (3, 4)
    assert fraction(math.pi) == (0, 0) and fraction(0.75 * (1 + 1e-6)) == (0, 0)


def test_groups_join_what_comes_back_together():
    group, times, joint, count = groups(np.array([12.0, 1.0, math.pi, np.inf, 12.0 / 9]))
    np.testing.assert_array_equal(group, [0, 0, 1, -1, 0])
    np.testing.assert_array_equal(times[[0, 1, 4]], [1, 12, 9])
    assert joint[0] == 12.0 and count == 2


def test_transient_takes_a_motion_with_its_own_times():
    series = Series((0.0, 1.0), ((0.0, 1.0, 2.0), (3.0, -1.0, 0.0)))
    motion = Motion("wheel-speed", series, 0.5, wheel_angle=(0.1, 0.2, 0.3), sample_rate=200.0)
    run = vibration.transient(machine(), motion)
    assert len(run.time) == 101 and run.time[-1] == 0.5
    same = vibration.transient(machine(), series, 0.5, 200.0, wheel_angle=[0.1, 0.2, 0.3])
    np.testing.assert_array_equal(run.displacement, same.displacement)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (dict(wheel_speed=[1, 2, 3]), "duration"),
        (dict(wheel_speed=[1, 2, 3], duration=-1.0), "duration"),
        (dict(wheel_speed=[1, 2, 3], duration=1.0, sample_rate=0), "sample_rate"),
        (dict(wheel_speed=[1, 2, 3], duration=1.0, start="stedy"), "did you mean 'steady'"),
        (dict(wheel_speed=[1, 2, 3], duration=1e6), "transient_blocks"),
        (dict(wheel_speed=Series((0.0,), ((1.0,),)), duration=1.0), "columns"),
        (dict(wheel_speed=Motion("wheel-torque", Series((0.0,), ((1.0, 1.0, 1.0),)), 1.0)), "wheel-speed"),
    ],
)
def test_transient_refuses_what_does_not_fit(arguments, words):
    with pytest.raises(SpheredriveError, match=words):
        vibration.transient(machine(), **arguments)


def test_transient_at_rest_starts_on_the_seat():
    for parts in (dict(), dict(mount=Mount(1e6, 30.0)), dict(contact=Contact(188208.0, 20000.0))):
        run = vibration.transient(machine(**parts), [1.0, -2.0, 0.5], 0.001, wheel_angle=[0.05, 0.1, 0.17])
        np.testing.assert_allclose(run.displacement[0], 0, atol=1e-16)
        np.testing.assert_allclose(run.velocity[0], 0, atol=1e-12)


def test_blocks_are_the_run():
    series = Series((0.0, 0.4, 1.1), ((0.0, 1.0, 2.0), (3.0, -1.0, 0.0), (-1.0, 2.0, 2.0)))
    whole = vibration.transient(machine(), series, 1.1, 777.0)
    blocks = list(vibration.transient_blocks(machine(), series, 1.1, 777.0, block=100))
    assert max(len(b.time) for b in blocks) == 100
    np.testing.assert_array_equal(np.concatenate([b.time for b in blocks]), whole.time)
    np.testing.assert_allclose(np.concatenate([b.displacement for b in blocks]), whole.displacement, atol=1e-17)
    total = vibration.transient_statistics(machine(), series, 1.1, 777.0, block=100)
    assert total.sphere.peak_acceleration == pytest.approx(np.linalg.norm(whole.acceleration, axis=1).max(), rel=1e-9)
    assert total.sphere.rms_acceleration == pytest.approx(math.sqrt((whole.acceleration**2).sum(axis=1).mean()), rel=1e-9)
    np.testing.assert_allclose(total.force_min, whole.contact_force.min(axis=0), rtol=1e-9)


def test_steady_statistics_are_those_of_each_design_to_the_bit():
    design, rng = machine(mount=Mount(1e6, 50.0)), np.random.default_rng(3)
    stiffness, speed = rng.uniform(1e5, 3e5, 7), rng.uniform(-3, 3, (7, 3))
    all_of = vibration.steady_statistics(design, speed, contact_stiffness=stiffness)
    assert all_of.natural_frequencies.shape == (7, 6) and all_of.valid.all()
    for k in (0, 6):
        one = vibration.response(replace(design, contact=Contact(stiffness[k], 200.0)), speed[k])
        alone = vibration.steady_statistics(design, speed[k], contact_stiffness=stiffness[k])
        for name in ("peak_displacement", "peak_velocity", "peak_acceleration", "rms_displacement", "rms_acceleration"):
            assert getattr(all_of, name)[k] == getattr(one, name) == getattr(alone, name)


def test_steady_statistics_says_which_have_no_steady_motion():
    design = machine(contact=Contact(188208.0))
    natural = vibration.modes(design).natural_frequencies[2]
    speeds = np.array([[natural * 2 * math.pi / 14, 0, 0], [1.0, 1.0, 1.0]])
    answer = vibration.steady_statistics(design, speeds)
    np.testing.assert_array_equal(answer.valid, [False, True])
    assert np.isnan(answer.peak_displacement[0]) and np.isfinite(answer.peak_displacement[1])


def test_steady_statistics_varies_directions_and_profiles():
    design = machine()
    other = profile(replace(WHEEL, profile="half-sine"), 1.22)
    answer = vibration.steady_statistics(
        design, [1.0, 1.3, 1.7], contact_direction=np.stack([design.contact_directions, orthogonal().contact_directions]),
        profiles=[profile(WHEEL, 1.22), other], profile_index=np.array([1, 1, 1]),
    )  # fmt: skip
    one = vibration.response(design, [1.0, 1.3, 1.7], profiles=(other,) * 3)
    assert answer.peak_displacement[0] == one.peak_displacement != answer.peak_displacement[1]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (dict(contact_stiffness=-1.0), "above zero"),
        (dict(mount_stiffness=1e6), "rigid"),
        (dict(profile_index=np.array([0, 1, 3])), "profile_index"),
        (dict(contact_direction=np.zeros((3, 3))), "point somewhere"),
        (dict(contact_direction=np.ones((2, 3))), "3 contacts"),
    ],
)
def test_steady_statistics_refuses_values_no_machine_has(options, words):
    with pytest.raises(SpheredriveError, match=words):
        vibration.steady_statistics(machine(), [1.0, 1.0, 1.0], **options)


def test_transmissibility_asks_for_a_payload_that_is_there():
    with pytest.raises(SpheredriveError, match="isolator"):
        vibration.transmissibility(machine(), 1.0, of="payload")
    with pytest.raises(SpheredriveError, match="sphere"):
        vibration.frequency_response(machine(IdealWheel(radius=0.0758)), 1.0, of="wheel")


def test_response_refuses_wheels_that_crawl_under_a_machine_that_rings():
    """Each swing has to be followed; damping lets it die, and then any speed will do."""
    ringing = replace(machine(), contact=Contact(188208.0))
    with pytest.raises(SpheredriveError, match="wheel 2 turns so slowly"):
        vibration.response(ringing, (1.0, 1e-7, 2.0))
    damped = replace(machine(), contact=Contact(188208.0, 2000.0), mount=Mount())
    assert vibration.response(damped, (1.0, 1e-7, 2.0)).rms_acceleration > 0
