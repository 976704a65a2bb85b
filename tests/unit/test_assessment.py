"""What an engineer reads of a vibration: sizes, comfort, preload, isolators and findings, against closed forms."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import atlas, orthogonal, six_orthogonal
from spheredrive import vibration
from spheredrive.design import Closure, Contact, Design, Motor, Mount, Placement, Sphere, Stage
from spheredrive.errors import DesignError, SpheredriveError
from spheredrive.summary import vibration_text
from spheredrive.vibration.aboard.comfort import weighting
from spheredrive.vibration.assessment.assess import assess
from spheredrive.vibration.spectra.full_spectrum import full_spectrum
from spheredrive.wheels import IdealWheel, MeasuredWheel, MecanumWheel, SplitDualRaceWheel, StandardWheel

GAPPED = StandardWheel(radius=0.0758, rollers=14, roundness=0.4485, mass=0.25)
SPEEDS = (3.0, 2.0, -1.0)


def damped(wheel=GAPPED, stiffness=188208.0, damping=300.0, force=0.0, **parts) -> Design:
    """The demonstrator with enough damping for its resonances to be finite, pressed by ``force`` straight down."""
    design = replace(atlas(wheel, radius=1.22), sphere=Sphere(1.22, 5.0), contact=Contact(stiffness, damping, 0.9))
    return replace(design, stage=Stage(5.0, True), closure=Closure(force=(0.0, 0.0, -force)), **parts)


def wavy(amplitude: float, waves: int) -> MeasuredWheel:
    """A wheel whose outline is a sine, measured closely enough that smoothing leaves it as it is."""
    angles = np.arange(480) * 2 * math.pi / 480
    return MeasuredWheel(outline=tuple(zip(angles, 0.05 + amplitude * np.sin(waves * angles), strict=True)))


def codes(found) -> list[str]:
    return [finding.code for finding in found.findings]


# Numbers.


def test_assess_natural_frequencies_of_the_atlas_layout():
    # √(3/2) cos 40° twice and √3 sin 40°: model.md section 5b prints 0.938, 0.938, 1.112.
    found = assess(damped(damping=0.0), SPEEDS).as_dict()["natural_frequencies_hz"]
    ratio = 2 * math.pi * np.array(found) / math.sqrt(188208 / 5)
    theta = math.radians(40)
    plane, axis = math.sqrt(1.5) * math.cos(theta), math.sqrt(3) * math.sin(theta)
    np.testing.assert_allclose(ratio, [plane, plane, axis], rtol=1e-12)


@pytest.mark.parametrize(("wheel", "name"), [(0, "Wd"), (1, "Wd"), (2, "Wk")])
def test_assess_sine_on_rigid_contacts_has_the_sizes_and_comfort_of_one_line(wheel, name):
    # One wheel turns under orthogonal rigid contacts: c = ∓A sin(n ω t) along its axis and nothing else.
    amplitude, waves, speed = 1e-4, 12, 4.0
    design = replace(orthogonal(), sphere=Sphere(0.15, 2.0))
    placements = tuple(replace(p, wheel=wavy(amplitude, waves)) for p in design.placements)
    omega = np.zeros(3)
    omega[wheel] = speed
    found = assess(replace(design, placements=placements, stage=Stage(5.0, False)), omega)
    f = waves * speed / (2 * math.pi)
    acceleration = amplitude * (2 * math.pi * f) ** 2
    factor = abs(weighting(name, f))
    # The smoothing spline is off by about (wave's step)⁴/384 · A ~ 2e-7 A; its second derivative by (step)²/12 ~ 3e-4.
    assert found.sphere.sizes.rms_displacement == pytest.approx(amplitude / math.sqrt(2), rel=1e-4)
    assert found.sphere.sizes.rms_acceleration == pytest.approx(acceleration / math.sqrt(2), rel=2e-3)
    assert found.sphere.comfort.total == pytest.approx(factor * acceleration / math.sqrt(2), rel=2e-3)
    assert not found.impulses and found.as_dict()["peak_acceleration_m_s2"] == pytest.approx(acceleration, rel=5e-3)


def test_assess_lines_hold_the_mean_square_of_the_exact_response():
    design = damped()
    found = assess(design, SPEEDS)
    s, exact = found.sphere.spectrum, vibration.response(design, SPEEDS).rms_acceleration
    # Three speeds in ratios of whole numbers: lines of equal frequency add with their phases (Parseval).
    frequency, displacement = s.combined()
    square = ((2 * math.pi * frequency) ** 4 * (np.abs(displacement) ** 2).sum(axis=1)).sum() / 2
    assert found.sphere.share == pytest.approx(square / exact**2, rel=1e-12)
    assert 0.9999 <= found.sphere.share <= 1.0 + 1e-9


def test_assess_corners_on_rigid_contacts_leave_no_finite_acceleration():
    found = assess(damped(stiffness=None), SPEEDS)
    told = found.as_dict()
    assert told["peak_acceleration_m_s2"] is None and told["rms_acceleration_m_s2"] is None
    assert told["spectrum_share"] is None and told["peak_velocity_m_s"] > 0
    # One corner a pattern: the jump of h′ω passes to the centre through the pseudo-inverse of n̂ᵀ.
    n_hat = -found.design.contact_directions
    for impulse, wheel in zip(found.impulses, range(3), strict=True):
        jump = found.excitations[wheel].corner * np.linalg.inv(n_hat)[:, wheel]
        np.testing.assert_allclose(impulse.velocity_jump, jump, rtol=1e-9, atol=1e-15)
    assert "rigid-contact" in codes(found) and "rigid-impulse" in codes(found)
    # The band limits of the weightings keep the weighted acceleration finite: more lines change nothing.
    steady = found.response
    reach = full_spectrum(steady).spectrum.frequency.max()
    assert reach > 1000 and found.sphere.comfort.total > 0


def test_assess_as_dict_is_json_with_the_fixed_keys():
    told = assess(damped(), SPEEDS).as_dict()
    json.dumps(told, allow_nan=False)
    for key in ("natural_frequencies_hz", "peak_displacement_m", "peak_velocity_m_s", "peak_acceleration_m_s2",
                "rms_acceleration_m_s2", "order_spectrum"):  # fmt: skip
        assert told[key], key
    # Orders are multiples of the wheel's turn: harmonic times rollers.
    for line in told["order_spectrum"]:
        assert line["order"] == pytest.approx(14 * line["harmonic"])
        assert line["frequency_hz"] == pytest.approx(line["order"] * abs(SPEEDS[line["wheel"] - 1]) / (2 * math.pi))


def test_assess_split_wheels_lines_carry_numbers_of_wheels():
    wheel = SplitDualRaceWheel(radius=0.04, rollers=16, roller_radius=6e-3, mass=0.1)
    design = replace(atlas(wheel), sphere=Sphere(0.15, 2.0), contact=Contact(1e5, 50.0), mount=Mount(1e6))
    found = assess(design, SPEEDS)
    s = found.sphere.spectrum
    assert len(found.forces) == 6 and set(s.wheel.tolist()) == {1, 2, 3}
    assert len({*zip(s.wheel.tolist(), s.harmonic.tolist(), strict=True)}) == len(s.wheel)
    assert {c.wheel for c in found.resonances.crossings} <= {1, 2, 3}
    assert "loss-of-contact" not in codes(found) and "clamped" in codes(found)


def test_resonances_are_where_a_passing_line_meets_a_mode():
    found = assess(damped(motor=Motor(speed=20.0)), SPEEDS)
    assert found.largest_speed == 20.0 and found.resonances.crossings
    for c in found.resonances.crossings:
        assert c.harmonic * 14 * c.speed / (2 * math.pi) == pytest.approx(c.frequency, rel=1e-12)
    # Steady motion at the worst meeting of one wheel is about its severity: that line stands above the others.
    worst = found.resonances.crossings[0]
    omega = np.zeros(3)
    omega[worst.wheel - 1] = worst.speed
    there = assess(damped(), omega)
    line = there.as_dict()["order_spectrum"][0]
    assert line["harmonic"] == worst.harmonic and line["displacement_m"] == pytest.approx(worst.severity, rel=1e-6)
    assert "resonance" in codes(there)


# Preload.


@pytest.mark.parametrize("wheel", [GAPPED, MecanumWheel(radius=0.0758, rollers=9, mass=0.25)], ids=["standard", "mecanum"])
def test_pressing_force_just_holds_every_contact(wheel):
    design = damped(wheel, damping=20.0)
    steady = vibration.response(design, (6.0, 5.0, -4.0))
    found = vibration.pressing_force(design, steady.force_min)
    assert found.force > 0 and found.wheel == int(np.argmin(steady.force_min)) + 1

    def least(force):
        pressed = replace(design, closure=Closure(force=tuple(force * np.array(found.direction))))
        return vibration.response(pressed, (6.0, 5.0, -4.0)).force_min.min()

    assert abs(least(found.force)) < 1e-9 * found.force
    assert least(0.99 * found.force) < 0 < least(1.01 * found.force)


def test_pressing_force_that_presses_no_wheel_is_refused():
    design = replace(orthogonal(), sphere=Sphere(0.15, 2.0))
    with pytest.raises(SpheredriveError, match=r"no force along \(1, 0, 0\) .* does not press wheel 3"):
        vibration.pressing_force(design, [1.0, 1.0, -1.0], (2, 0, 0))
    with pytest.raises(SpheredriveError, match="each of the 3 contacts"):
        vibration.pressing_force(design, [1.0, math.nan, 1.0])


# A payload inside.


def test_without_payload_seat_carries_the_same_weight():
    design = damped()
    light = vibration.without_payload(design, 3.0)
    assert light.sphere.mass == 2.0
    carried = vibration.linear_system(light, isolator=vibration.isolator_of_frequency(3.0, 2.0, 0.1)).seat_force
    np.testing.assert_allclose(carried, vibration.linear_system(design).seat_force, rtol=1e-12)
    for mass in (5.0, 80.0):
        with pytest.raises(DesignError, match="leaves nothing of the sphere"):
            vibration.without_payload(design, mass)
    with pytest.raises(SpheredriveError, match="not given"):
        vibration.without_payload(replace(design, sphere=Sphere(1.22)), 1.0)


def test_isolator_for_design_brings_the_exact_response_to_the_wanted_acceleration():
    design, payload, wanted, zeta = damped(), 2.0, 0.05, 0.2
    found = vibration.isolator_for_design(design, SPEEDS, payload, wanted, zeta)
    springs = vibration.isolator_of_frequency(payload, found.natural_frequency, zeta)
    exact = assess(design, SPEEDS, isolator=springs)
    # The search follows 400 lines a wheel; what is above them hardly passes the isolator.
    assert exact.payload.sizes.rms_acceleration == pytest.approx(wanted, rel=1e-4)
    assert found.stiffness == pytest.approx(springs.stiffness[0], rel=1e-12)
    assert found.bare_acceleration == vibration.response(design, SPEEDS).rms_acceleration
    # A hair stiffer lets more through.
    stiffer = vibration.isolator_of_frequency(payload, 1.01 * found.natural_frequency, zeta)
    assert assess(design, SPEEDS, isolator=stiffer).payload.sizes.rms_acceleration > wanted


def test_assess_light_payload_follows_the_transmissibility_of_base_excitation():
    # Too light to move the sphere: each line passes by T = (1 + 2iζr)/(1 − r² + 2iζr).
    design, f_n, zeta = damped(), 3.0, 0.15
    found = assess(design, SPEEDS, isolator=vibration.isolator_of_frequency(1e-9, f_n, zeta))
    base, own = (s.displacement[s.harmonic <= 100] for s in (found.sphere.spectrum, found.payload.spectrum))
    r = found.sphere.spectrum.frequency[found.sphere.spectrum.harmonic <= 100] / f_n
    T = (1 + 2j * zeta * r) / (1 - r**2 + 2j * zeta * r)
    # The payload's share of the sphere's mass, 2e-10, is all that is left between them.
    np.testing.assert_allclose(own, T[:, None] * base, rtol=1e-6, atol=1e-12 * np.abs(own).max())
    assert len(own) == 300 and found.payload.comfort.total < found.sphere.comfort.total


def test_assess_isolator_in_the_thesis_model_is_refused():
    with pytest.raises(SpheredriveError, match="one body"):
        assess(damped(), SPEEDS, "independent", isolator=vibration.isolator_of_frequency(1.0, 3.0, 0.1))


# Findings.


def test_assess_vibration_that_lifts_a_wheel_does_not_work():
    found = assess(damped(damping=0.0), (0.1, 1.2, 0.9))
    assert not found.works and codes(found)[0] == "loss-of-contact"
    assert any(f.least < 0 for f in found.forces) and "would have to pull" in found.findings[0].message
    assert "undamped" in codes(found)
    assert assess(damped(force=500.0), (0.1, 1.2, 0.9)).works


def test_assess_wheel_that_nothing_presses_is_told_at_rest():
    found = assess(replace(orthogonal(), sphere=Sphere(0.15, 2.0)), (1.0, 1.0, 1.0))
    assert codes(found) == ["not-pressed", "round-wheels"] and not found.works
    assert found.as_dict()["peak_acceleration_m_s2"] == 0.0


def test_assess_round_wheels_shake_nothing_whatever_holds_the_sphere():
    # Six rigid contacts would contradict each other if their shapes moved.
    found = assess(replace(six_orthogonal(), sphere=Sphere(0.15, 2.0)), np.ones(6))
    assert found.works and codes(found) == ["clamped", "round-wheels"]
    # Without a mass there are no forces to tell, and still nothing shakes.
    assert assess(six_orthogonal(), np.ones(6)).forces == ()


def test_assess_wheels_that_stand_shake_nothing():
    found = assess(damped(), np.zeros(3))
    assert "standing" in codes(found) and found.works
    assert found.sphere.sizes.peak_velocity == 0.0 and found.sphere.comfort.total == 0.0


def test_assess_undamped_resonance_is_a_finding_without_a_motion():
    design = damped(damping=0.0)
    f = vibration.modes(design).natural_frequencies[2]
    found = assess(design, np.full(3, 2 * math.pi * f / 14))
    told = found.as_dict()
    assert not found.works and codes(found)[0] == "resonance" and "no steady motion" in found.findings[0].message
    assert told["peak_displacement_m"] is None and told["order_spectrum"] == []
    assert "does not work" in vibration_text(found)


def test_assess_comfort_worse_than_the_scales_first_word_is_a_warning():
    found = assess(damped(), (9.0, 7.0, 5.0))
    assert found.sphere.comfort.total > 0.315
    (warning,) = (f for f in found.findings if f.code == "comfort")
    assert warning.severity == "warning" and f"{found.sphere.comfort.total:.3g}" in warning.message


@pytest.mark.parametrize(
    ("design", "speeds", "message"),
    [
        (damped(), (1.0, 2.0), "each of the 3 wheels"),
        (damped(), (1.0, 2.0, math.nan), "finite number"),
        (replace(damped(), sphere=Sphere(1.22)), SPEEDS, "sphere.mass"),
        (damped(damping=0.0), (1e-6,) * 3, "turns so slowly"),
        (replace(damped(), placements=damped().placements[:1]), (1.0,), "nothing holds the sphere"),
    ],
)
def test_assess_what_has_no_answer_is_refused_with_a_sentence(design, speeds, message):
    with pytest.raises(SpheredriveError, match=message):
        assess(design, speeds)


def test_vibration_text_shows_the_numbers_of_the_assessment():
    found = assess(damped(), SPEEDS)
    text = vibration_text(found)
    sizes = found.sphere.sizes
    for number in (sizes.peak_displacement * 1e6, sizes.rms_acceleration, found.excitations[0].depth * 1e6):
        assert f"{number:.4g}" in text
    assert "Speeds to avoid" in text and "ISO 2631-1" in text and "wheels at 3 2 -1 rad/s" in text


def test_vibration_text_of_one_ideal_wheel_says_that_nothing_shakes():
    design = Design("one", Sphere(0.1, 1.0), [Placement(IdealWheel(radius=0.02), (0, 0, -1), (0, 1, 0))])
    assert "nothing shakes the sphere" in vibration_text(assess(design, [1.0]))
