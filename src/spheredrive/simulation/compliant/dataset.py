"""A compliant run with names, dimensions and units: what users and files get of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray

from spheredrive.contact import contact_modulus, hertz, relative_radii
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.station import GAP, LARGEST, NORMAL, SLIP, TANGENTIAL
from spheredrive.simulation.compliant.ledger import ledger
from spheredrive.simulation.compliant.run import Accuracy, CompliantRun
from spheredrive.simulation.labels import attributes, contact_numbers, coordinates, variable

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

_AXIS, _WHEEL, _CONTACT, _TIME = ("time", "axis"), ("time", "wheel"), ("time", "contact"), ("time",)


def labelled(design: Design, motion: Motion, run: CompliantRun, accuracy: Accuracy) -> xarray.Dataset:
    """The run of ``design`` under ``motion`` as a dataset; it holds no clock time, so equal runs are equal datasets."""
    found = {**_motion(run), **_contacts(design, run), **_energies(run), **_lift_offs(run)}
    data = {name: variable(dims, values, units, meaning) for name, (dims, values, units, meaning) in found.items()}
    coords = coordinates(design, run.time)
    wheel = run.machine.stations[:, at.STATION_WHEEL].astype(np.int32) + 1
    coords["mount_wheel"] = variable(("mount",), wheel, "1", "wheel of the mount, numbered from 1")
    solver = {
        "solver": f"Rosenbrock method {accuracy.method}, steps end at corners and where rollers begin or cease to press",
        "accuracy": accuracy.length,
        "largest_step": accuracy.largest_step,
        "steps_accepted": np.int64(run.steps[0]),
        "steps_refused": np.int64(run.steps[1]),
    }
    attrs = attributes(design, motion, "compliant", run.completed, run.reason, solver)
    return xarray.Dataset(data, coords=coords, attrs=attrs)


def _motion(run: CompliantRun) -> dict:
    y, rate = run.states, run.rates
    stage, acceleration = slice(at.STAGE_POSITION, at.STAGE_POSITION + 3), slice(at.STAGE_VELOCITY, at.STAGE_VELOCITY + 3)
    turn = slice(at.OMEGA, at.OMEGA + 3)
    return {
        "angular_velocity": (_AXIS, run.angular_velocity, "rad/s", "angular velocity of the sphere, inertial frame"),
        "angular_acceleration": (_AXIS, rate[:, turn], "rad/s^2", "angular acceleration of the sphere, inertial frame"),
        "orientation": (
            ("time", "quat_wxyz"),
            run.orientation,
            "1",
            "orientation of the sphere, unit quaternion, scalar first, body to inertial frame",
        ),
        "centre_displacement": (_AXIS, run.centre_displacement, "m", "displacement of the sphere's centre on the stage"),
        "centre_velocity": (_AXIS, run.centre_velocity, "m/s", "velocity of the sphere's centre on the stage"),
        "wheel_speed": (_WHEEL, run.wheel_speed, "rad/s", "wheel speed"),
        "wheel_angle": (_WHEEL, run.wheel_angle, "rad", "wheel angle"),
        "motor_torque": (_WHEEL, run.motor_torque, "N m", "torque of the motor on the wheel"),
        "mount_deflection": (
            ("time", "mount"),
            run.mount_deflection,
            "m",
            "deflection of the wheel's mount towards the sphere",
        ),
        "stage_position": (_AXIS, y[:, stage], "m", "position of the stage, inertial frame"),
        "stage_velocity": (_AXIS, y[:, acceleration], "m/s", "velocity of the stage, inertial frame"),
        "stage_acceleration": (_AXIS, rate[:, acceleration], "m/s^2", "acceleration of the stage, inertial frame"),
    }


def _contacts(design: Design, run: CompliantRun) -> dict:
    order = [run.machine.contacts.index(pair) for pair in contact_numbers(design)]
    touch, slip_work = run.touches[:, order], run.works[:, at.POWERS :][:, order]
    found = {
        "normal_force": (_CONTACT, touch[..., NORMAL], "N", "normal force of the race's rollers together"),
        "friction_force": (
            _CONTACT,
            touch[..., TANGENTIAL],
            "N",
            "force of the wheel on the sphere in the tangent plane, along the roller axis",
        ),
        "slip_speed": (_CONTACT, touch[..., SLIP], "m/s", "slip speed at the roller that carries most; zero without contact"),
        "gap": (_CONTACT, np.minimum(touch[..., GAP], _FAR), "m", "least gap between rollers and sphere; negative in contact"),
        "slip_work": (_CONTACT, slip_work, "J", "energy lost by slipping since the start"),
    }
    wheel = np.array([i - 1 for i, _ in contact_numbers(design)])
    bodies = [(design.wheels[i].young_modulus, design.wheels[i].poisson_ratio) for i in wheel]
    sphere = (design.sphere.young_modulus, design.sphere.poisson_ratio)
    if None not in sphere and not any(None in body for body in bodies):
        modulus = contact_modulus(*sphere, *np.array(bodies).T)
        across, along = relative_radii(design)
        patch = hertz(np.maximum(touch[..., LARGEST], 0.0), across[wheel], along[wheel], modulus=modulus)
        found["patch_across"] = (_CONTACT, patch.a, "m", "semi-axis of the contact patch across the roller axis, by Hertz")
        found["patch_along"] = (_CONTACT, patch.b, "m", "semi-axis of the contact patch along the roller axis, by Hertz")
        found["peak_pressure"] = (_CONTACT, patch.peak_pressure, "Pa", "largest pressure of the contact patch, by Hertz")
    return found


# A gap that is not worth telling from a larger one, m: no roller is near.
_FAR = 1.0


def _energies(run: CompliantRun) -> dict:
    books = ledger(run)
    meanings = {
        "kinetic": ("kinetic_energy", "kinetic energy of sphere, wheels and stage"),
        "potential": ("potential_energy", "potential energy of weight, closure and mounts"),
        "elastic": ("elastic_energy", "elastic energy of the contacts"),
        "motor_work": ("motor_work", "work of the motors since the start"),
        "stage_work": ("stage_work", "work on the stage since the start"),
        "slip": ("slip_heat", "energy lost by slipping since the start"),
        "contact_damping": ("damping_heat", "energy lost in the contacts' damping since the start"),
        "resistances": ("heat", "energy lost in roller drag, rolling and spin resistance, mounts and closure since the start"),
        "residual": ("ledger_residual", "all energies and losses less works since the start: what does not add up"),
    }
    return {name: (_TIME, getattr(books, field), "J", meaning) for field, (name, meaning) in meanings.items()}


def _lift_offs(run: CompliantRun) -> dict:
    wheel, begin, end = run.lift_offs.T
    dims = ("lift_off",)
    return {
        "lift_off_wheel": (dims, wheel.astype(np.int32) + 1, "1", "wheel that loses contact"),
        "lift_off_begin": (dims, begin, "s", "time at which contact is lost"),
        "lift_off_end": (dims, end, "s", "time at which contact is made again, or the end of the run"),
    }
