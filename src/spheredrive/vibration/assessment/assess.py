"""What an engineer reads of a design's vibration at constant wheel speeds: every number that terminal, JSON and report show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.checking import Finding
from spheredrive.errors import SingularError, SpheredriveError
from spheredrive.shape import excitation, profiles
from spheredrive.vibration.aboard.comfort import Comfort, comfort_of_lines
from spheredrive.vibration.aboard.payload import without_payload
from spheredrive.vibration.assessment import findings as said
from spheredrive.vibration.model.equations import Isolator, contacts_of, seat_force
from spheredrive.vibration.model.modes import Modes, modes
from spheredrive.vibration.model.system import linear_system
from spheredrive.vibration.motion.response import Impulse, Response, Sizes, checked_wheels, response
from spheredrive.vibration.spectra.full_spectrum import full_spectrum
from spheredrive.vibration.spectra.resonances import Excited, Resonances, excited_modes, first_meeting, resonances
from spheredrive.vibration.spectra.spectrum import OrderSpectrum

if TYPE_CHECKING:
    from spheredrive.design import Design

NO_MODES = Modes(np.zeros(0), np.zeros((0, 0)), (), np.zeros(0, complex), np.zeros(0), np.zeros(0))


class WheelExcitation(NamedTuple):
    """What one wheel, numbered from 1, does to the sphere.

    speed              rad/s
    passing_frequency  at which its pattern passes, Hz
    depth              largest less smallest height of its shape, m
    velocity           largest |h′ ω|, m/s
    acceleration       largest |h″| ω² off the corners, m/s²
    corner             largest jump of h′ ω at a corner, m/s: an impulse for each kg; 0 on a shape without corners
    """

    wheel: int
    speed: float
    passing_frequency: float
    depth: float
    velocity: float
    acceleration: float
    corner: float


class ContactForce(NamedTuple):
    """Force of one contact, N: of its wheel (from 1) at the seat, and the least and largest of the steady motion."""

    wheel: int
    seat: float
    least: float
    largest: float


class Moved(NamedTuple):
    """Something that vibrates: its sizes, its lines, the share of the mean square acceleration that they hold, its comfort."""

    sizes: Sizes
    spectrum: OrderSpectrum
    share: float | None
    comfort: Comfort


@dataclass(frozen=True, eq=False)
class Assessment:
    """Vibration of a design at constant wheel speeds; what is not known is None or empty.

    design, model      as they were given
    wheel_speed        rad/s, (n,)
    isolator           between the sphere and its payload, or None
    modes              natural frequencies and damping; none where rigid contacts leave no freedom
    excitations        one a wheel
    response           the steady motion itself; None where nothing shakes, or where a resonance without damping has none
    sphere, payload    what the motion comes to
    forces             one a contact
    impulses           what corners do to rigid contacts
    resonances         critical speeds up to ``largest_speed``, and bands to avoid
    excited            modes that the wheels excite at these speeds
    findings           what a designer should know
    """

    design: Design
    model: str
    wheel_speed: np.ndarray
    isolator: Isolator | None
    modes: Modes
    excitations: tuple[WheelExcitation, ...]
    response: Response | None
    sphere: Moved | None
    payload: Moved | None
    forces: tuple[ContactForce, ...]
    impulses: tuple[Impulse, ...]
    resonances: Resonances
    largest_speed: float
    excited: tuple[Excited, ...]
    findings: tuple[Finding, ...]

    @property
    def works(self) -> bool:
        """Whether no finding says that the design does not work."""
        return all(finding.severity != "failure" for finding in self.findings)

    @property
    def still(self) -> bool:
        """Whether nothing shakes: all wheels are round, or none turns."""
        return all(e.depth == 0 or e.speed == 0 for e in self.excitations)

    def as_dict(self) -> dict:
        """Plain values for JSON, SI with units in the names; what is infinite or not known becomes null."""
        from spheredrive.vibration.assessment.as_dict import assessment_dict

        return assessment_dict(self)


def assess(
    design: Design, wheel_speed, model: str = "coupled", wheel_angle=None, isolator: Isolator | None = None
) -> Assessment:
    """The vibration of ``design`` at constant wheel speeds, with findings: trouble is a finding, not an error.

    wheel_speed   rad/s, (n,); wheel_angle  ϑ at t = 0, rad, (n,)
    model         "coupled", or "independent" for the thesis's
    isolator      springs and dampers of a payload, which is taken out of ``sphere.mass`` (see ``payload``); coupled model only

    Raises ``SpheredriveError`` for speeds that do not fit the design, for a mass that is missing and for a sphere without a
    seat; ``DesignError`` for wheels that are not described. A resonance without damping is a finding. Source: model.md
    section 5b.
    """
    speed, angle = checked_wheels(design, wheel_speed, wheel_angle)
    excited_by = _excitations(design, speed)
    carrier = design if isolator is None else without_payload(design, isolator.mass)
    if all(e.depth == 0 for e in excited_by):
        return _round(design, carrier, model, speed, isolator, excited_by)
    found = modes(carrier, model, isolator)
    system = linear_system(carrier, model, isolator)
    largest = _largest_speed(design, speed, first_meeting(system, found))
    met = resonances(system, found, largest)
    try:
        steady = response(carrier, speed, model, angle, isolator)
    except SingularError as error:
        told = (Finding("resonance", "failure", f"There is no steady motion: {error}."), *said.general(design))
        return Assessment(design, model, speed, isolator, found, excited_by, None, None, None, (), (), met, largest, (), told)
    sphere = _moved(steady, "sphere")
    payload = None if isolator is None else _moved(steady, "payload")
    near = excited_modes(found, sphere.spectrum, 0.0 if steady.impulses else steady.sphere.rms_acceleration**2)
    wheel = system.contacts.wheel + 1
    rows = zip(wheel, system.seat_force, steady.force_min, steady.force_max, strict=True)
    forces = tuple(ContactForce(int(w), *map(float, numbers)) for w, *numbers in rows)
    turning = any(e.speed for e in excited_by)
    told = (
        *said.of_forces(design, forces, turning),
        *said.of_impulses(design, steady.impulses, wheel),
        *said.of_resonance(near),
        *said.of_comfort((payload or sphere).comfort, "payload" if payload else "sphere"),
        *([] if turning else [said.standing()]),
        *said.general(design),
    )
    return Assessment(
        design,
        model,
        speed,
        isolator,
        found,
        excited_by,
        steady,
        sphere,
        payload,
        forces,
        steady.impulses,
        met,
        largest,
        near,
        told,
    )


def _round(design: Design, carrier: Design, model: str, speed, isolator, excited_by) -> Assessment:
    """Round wheels shake nothing, whatever holds the sphere: what is left to tell are its modes and the forces at the seat."""
    try:
        found = modes(carrier, model, isolator)
    except SpheredriveError:
        # Contacts that could not follow shapes of their own are no trouble where there are none.
        found = NO_MODES
    forces = ()
    if design.sphere.mass is not None:
        contacts = contacts_of(design)
        seat = seat_force(design, contacts)
        forces = tuple(ContactForce(int(w) + 1, *[float(f)] * 3) for w, f in zip(contacts.wheel, seat, strict=True))
    none = np.zeros(0)
    at_rest = Sizes(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, np.zeros(3))
    lines = OrderSpectrum(none.astype(int), none.astype(int), none, none, np.zeros((0, 3), complex))
    moved = Moved(at_rest, lines, 1.0, comfort_of_lines(none, np.zeros((0, 3))))
    met = Resonances(none, none, (), ())
    told = (*said.of_forces(design, forces, False), said.round_wheels())
    payload = None if isolator is None else moved
    largest = _largest_speed(design, speed, 0.0)
    return Assessment(
        design, model, speed, isolator, found, excited_by, None, moved, payload, forces, (), met, largest, (), told
    )


def _excitations(design: Design, speed: np.ndarray) -> tuple[WheelExcitation, ...]:
    rows = []
    for number, (outline, omega) in enumerate(zip(profiles(design), speed.tolist(), strict=True), 1):
        e = excitation(outline, omega)
        corner = float(np.abs(e.impulses).max(initial=0.0))
        numbers = (abs(omega) / outline.period, e.depth, float(e.velocity), float(e.acceleration), corner)
        rows.append(WheelExcitation(number, omega, *numbers))
    return tuple(rows)


def _largest_speed(design: Design, speed: np.ndarray, meeting: float) -> float:
    """How far critical speeds are told: to what the motor can, else past the first resonance and the speeds asked for."""
    asked = float(np.abs(speed).max(initial=0.0))
    if design.motor.speed is not None:
        return max(design.motor.speed, 1.2 * asked)
    return max(2 * asked, 1.2 * meeting)


def _moved(steady: Response, of: str) -> Moved:
    spectrum, share = full_spectrum(steady, of)
    sizes = steady.sphere if of == "sphere" else steady.payload
    assert sizes is not None, "a payload that is asked for is there"
    frequency, displacement = spectrum.combined()
    acceleration = -((2 * np.pi * frequency[:, None]) ** 2) * displacement
    return Moved(sizes, spectrum, share, comfort_of_lines(frequency, acceleration))
