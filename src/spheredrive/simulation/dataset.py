"""A run with names, dimensions and units: what users and files get of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray

from spheredrive.dynamics import normals_known
from spheredrive.dynamics.parameters import rolling_parameters
from spheredrive.dynamics.rolling import NORMAL
from spheredrive.simulation.labels import Variable, attributes, contact_numbers, coordinates, race_numbers, variable
from spheredrive.simulation.rolling_run import RollingRun, Tolerance

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

# Contact directions whose least singular value is this small beside the largest lie in a plane.
FLAT = 1e-6


_AXIS, _WHEEL, _TIME, _EVENT = ("time", "axis"), ("time", "wheel"), ("time",), ("event",)
VARIABLES = (
    Variable("angular_velocity", _AXIS, "rad/s", "angular velocity of the sphere, inertial frame", "angular_velocity"),
    Variable(
        "angular_acceleration", _AXIS, "rad/s^2", "angular acceleration of the sphere, inertial frame", "angular_acceleration"
    ),
    Variable(
        "orientation",
        ("time", "quat_wxyz"),
        "1",
        "orientation of the sphere, unit quaternion, scalar first, body to inertial frame",
        "orientation",
    ),
    Variable("wheel_speed", _WHEEL, "rad/s", "wheel speed", "wheel_speed"),
    Variable("wheel_angle", _WHEEL, "rad", "wheel angle", "wheel_angle"),
    Variable("motor_torque", _WHEEL, "N m", "torque of the motor on the wheel", "motor_torque"),
    Variable("stage_position", _AXIS, "m", "position of the stage, inertial frame", "stage_position"),
    Variable("stage_velocity", _AXIS, "m/s", "velocity of the stage, inertial frame", "stage_velocity"),
    Variable("stage_acceleration", _AXIS, "m/s^2", "acceleration of the stage, inertial frame", "stage_acceleration"),
    Variable("motor_work", _TIME, "J", "work of the motors since the start", "motor_work"),
    Variable("stage_work", _TIME, "J", "work on the stage since the start", "stage_work"),
    Variable("heat", _TIME, "J", "heat of rolling and spin resistance since the start", "heat"),
    Variable("kinetic_energy", _TIME, "J", "kinetic energy of sphere, wheels and stage", "kinetic"),
    Variable("potential_energy", _TIME, "J", "potential energy of the sphere's mass about its centre", "potential"),
    Variable("impact_loss", _TIME, "J", "energy lost in changes of race since the start", "impact_loss"),
    Variable(
        "ledger_residual",
        _TIME,
        "J",
        "kinetic + potential energy since the start + heat + impact loss - motor work - stage work",
        "residual",
    ),
    Variable("event_time", _EVENT, "s", "time of the event", "event_time"),
    Variable("event_loss", _EVENT, "J", "energy lost in the event", "event_loss"),
    Variable(
        "event_impulse", ("event", "axis"), "N m s", "change of the sphere's moment of momentum in the event", "event_impulse"
    ),
)


def labelled(design: Design, motion: Motion, run: RollingRun, tolerance: Tolerance) -> xarray.Dataset:
    """The run of ``design`` under ``motion`` as a dataset; it holds no clock time, so equal runs are equal datasets."""
    data = {v.name: variable(v.dims, getattr(run, v.source), v.units, v.long_name) for v in VARIABLES}
    data["event_wheel"] = variable(
        _EVENT, (run.event_wheel + 1).astype(np.int32), "1", "wheel whose race changes; 0 for a step of the input"
    )
    still = np.zeros((len(run.time), 3))
    data["centre_displacement"] = variable(_AXIS, still, "m", "displacement of the sphere's centre on the stage")
    active = active_races(design, run)
    data["active_race"] = variable(
        _WHEEL, active, "1", "race that touches the sphere, numbered from 1; 0 at rest between races"
    )
    return xarray.Dataset(
        {**data, **_contact_variables(design, run, active)},
        coords=coordinates(design, run.time),
        attrs=_attributes(design, motion, run, tolerance),
    )


def active_races(design: Design, run: RollingRun) -> np.ndarray:
    """The race of each wheel that touches the sphere, numbered from 1; 0 where it rests between its races, (k, n)."""
    races = np.zeros(run.state.shape, np.int32)
    for i, wheel in enumerate(design.wheels):
        for k, active in enumerate(wheel.alternation):
            races[run.state[:, i] == k, i] = active[0]
    return races


def _contact_variables(design: Design, run: RollingRun, active: np.ndarray) -> dict[str, xarray.Variable]:
    """What acts at each contact: the race that touches carries all of its wheel's force, others nothing.

    A wheel that rests between its races touches with all that take turns; they share its force equally.
    """
    wheel, race = np.array(contact_numbers(design)).T
    turns = np.array([race in sum(w.alternation, ()) for w in design.wheels for race in race_numbers(design, w)])
    sharing = np.array([len(design.wheels[w - 1].alternation) for w in wheel])
    on = active[:, wheel - 1]
    share = np.where(on == race, 1.0, np.where((on == 0) & turns, 1.0 / sharing, 0.0))
    dims = ("time", "contact")

    def spread(values: np.ndarray) -> np.ndarray:
        # A share of nothing is a plain zero, whatever the sign of the force.
        return np.where(share > 0, values[:, wheel - 1] * share, 0.0)

    found = {
        "friction_force": variable(
            dims,
            spread(run.friction_force),
            "N",
            "force of the wheel on the sphere in the tangent plane, along the roller axis",
        ),
        "slip_speed": variable(dims, np.zeros(share.shape), "m/s", "slip speed at the contact"),
    }
    if normal_forces_known(design, run):
        found["normal_force"] = variable(dims, spread(run.normal_force), "N", "normal force, positive where pressed together")
    return found


def normal_forces_known(design: Design, run: RollingRun) -> bool:
    """Whether the contacts hold the sphere's centre in every direction, in all contact states of the run.

    Contacts whose directions R̂ lie in a plane, as those of fewer than three wheels always do, leave the normal forces
    undetermined.
    """
    if not normals_known(design):
        return False
    directions = rolling_parameters(design).contacts[..., NORMAL : NORMAL + 3]
    states = np.unique(run.state, axis=0)
    sigma = np.linalg.svd(directions[np.arange(design.wheel_count), states], compute_uv=False)
    return bool((sigma[:, 2] > FLAT * sigma[:, 0]).all())


def _attributes(design: Design, motion: Motion, run: RollingRun, tolerance: Tolerance) -> dict[str, object]:
    solver = {
        "solver": "Dormand-Prince 5(4), steps end at corners of the inputs and at changes of race",
        "relative_tolerance": tolerance.relative,
        "absolute_tolerance": tolerance.absolute,
        "fixed_step": tolerance.fixed_step,
        "largest_step": tolerance.largest_step,
    }
    found = attributes(design, motion, "rolling", run.completed, run.reason, solver)
    if not normal_forces_known(design, run):
        found["normal_force_missing"] = (
            "The contact directions lie in a plane, so the normal forces are not determined: none balances what acts "
            "across the plane."
        )
    return found
