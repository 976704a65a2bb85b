"""Loads along a run of the rolling model: friction against its limit, the force that must close the machine, motor peaks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.checking import Finding
from spheredrive.design import GRAVITY
from spheredrive.dynamics.parameters import rolling_parameters
from spheredrive.dynamics.rolling import GRIP, NORMAL
from spheredrive.errors import SpheredriveError
from spheredrive.frames import quaternion_matrix

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.simulation.rolling_run import RollingRun

# A contact at its limit to the last digit is not beyond it.
SLACK = 1e-9


class Peak(NamedTuple):
    """What one wheel has to bear: number from 1; N m, rad/s, W, N and s. The last two are None where friction is not given."""

    wheel: int
    torque: float
    torque_time: float
    rms_torque: float
    speed: float
    speed_time: float
    power: float
    power_time: float
    least_normal: float
    least_normal_time: float
    largest_friction: float
    utilisation: float | None
    utilisation_time: float | None


@dataclass(frozen=True)
class Loads:
    """Loads of k samples and n wheels.

    normals_known   whether normal forces alone can balance any force; else ``normal_force`` of the run says nothing
    utilisation     |f| / (μ N), (k, n), inf where a loaded contact is not pressed; None where friction is not given
    power           T ω, W, (k, n)
    closure_force   the thesis's minimum closure force on the sphere, N, (k, 3); None where friction is not given
    peaks           one row a wheel
    findings        limits that are broken, with wheel and time
    """

    normals_known: bool
    utilisation: np.ndarray | None
    power: np.ndarray
    closure_force: np.ndarray | None
    peaks: tuple[Peak, ...]
    findings: tuple[Finding, ...]


def loads(design: Design, run: RollingRun) -> Loads:
    """Work out the loads of a run. Raises nothing: limits that are broken are findings."""
    mu = design.contact.friction
    known = normals_known(design)
    usage = utilisation(run.friction_force, run.normal_force, mu) if mu and known else None
    power = run.motor_torque * run.wheel_speed
    peaks = tuple(wheel_peak(run, power, usage, w) for w in range(design.wheel_count))
    closure = thesis_closure_force(design, run) if mu else None
    return Loads(known, usage, power, closure, peaks, tuple(_findings(design, run, usage, known)))


def normals_known(design: Design) -> bool:
    """Whether the contacts can balance a force in any direction by normal forces: R̂ of all wheels span space."""
    sigma = np.linalg.svd(design.contact_directions, compute_uv=False)
    return len(sigma) == 3 and bool(sigma[2] > 1e-7 * sigma[0])


def utilisation(friction_force, normal_force, friction: float) -> np.ndarray:
    """|f| / (μ N), shape as given: 1 at the friction limit; inf where a contact carries friction without being pressed."""
    f, N = np.abs(friction_force), np.asarray(normal_force, float)
    limit = friction * np.maximum(N, 0.0)
    return np.divide(f, limit, out=np.where(f > 0, np.inf, 0.0), where=limit > 0)


def _inertial_force(design: Design, run: RollingRun) -> np.ndarray:
    """M_s (p̈ + Ω̇ × ρ + Ω × (Ω × ρ)) − M_s g, N, (k, 3): what contacts and closure together put on the sphere."""
    mass = design.sphere.mass or 0.0
    rho = quaternion_matrix(run.orientation) @ np.array(design.sphere.centre_of_mass)
    Omega = run.angular_velocity
    acceleration = run.stage_acceleration + np.cross(run.angular_acceleration, rho) + np.cross(Omega, np.cross(Omega, rho))
    gravity = np.array([0.0, 0.0, -GRAVITY if design.stage.gravity else 0.0])
    return mass * (acceleration - gravity)


def thesis_closure_force(design: Design, run: RollingRun) -> np.ndarray:
    """Closure force at which every contact is just at its friction limit, N, (k, 3).

        Nᵢ = |fᵢ| / μ,   F_ext = Σ Nᵢ R̂ᵢ − Σ fᵢ ûᵢ − M_s g + M_s (p̈ + Ω̇ × ρ + Ω × (Ω × ρ))   [3.37, 3.45]

    with f of the full equations where the thesis's [3.46] has a closed form for a spherical inertia alone. Raises
    ``SpheredriveError`` where the design gives no friction. Source: model.md section 5a.
    """
    if not design.contact.friction:
        raise SpheredriveError("a closure force needs contact.friction above zero")
    R_hat, u_hat = _directions(design, run)
    N = np.abs(run.friction_force) / design.contact.friction
    pressed = np.einsum("kn,kni->ki", N, R_hat)
    rubbed = np.einsum("kn,kni->ki", run.friction_force, u_hat)
    return pressed - rubbed + _inertial_force(design, run)


def _directions(design: Design, run: RollingRun) -> tuple[np.ndarray, np.ndarray]:
    """R̂ and û of the active contacts, (k, n, 3) each."""
    chosen = rolling_parameters(design).contacts[np.arange(design.wheel_count), run.state]
    return chosen[..., NORMAL : NORMAL + 3], chosen[..., GRIP : GRIP + 3]


@dataclass(frozen=True)
class Preload:
    """The least force (N) along a direction, on top of the design's own closure, that keeps every contact from slipping.

    ``wheel`` (from 1) and ``time`` (s) are those of the contact that sets it; 0 and 0 where no preload is needed.
    """

    force: float
    direction: tuple[float, float, float]
    wheel: int
    time: float


def preload_gain(design: Design, run: RollingRun, direction) -> np.ndarray:
    """Normal forces that one newton on the sphere along ``direction`` makes, (k, n): R̂ᵢ · (Σ R̂ R̂ᵀ)⁻¹ d, least ΣN² for n > 3."""
    d = preload_direction(direction)
    R_hat, _ = _directions(design, run)
    return np.einsum("kni,kij,j->kn", R_hat, np.linalg.inv(np.einsum("kni,knj->kij", R_hat, R_hat)), d)


def preload_direction(direction) -> np.ndarray:
    """A direction of three numbers as a unit vector, (3,). Raises ``SpheredriveError`` for what is none."""
    d = np.asarray(direction, float)
    if d.shape != (3,) or not np.isfinite(d).all() or not np.linalg.norm(d) > 0:
        raise SpheredriveError("the direction of a preload takes three finite numbers, not all zero")
    return d / np.linalg.norm(d)


def pressing_direction(design: Design) -> np.ndarray:
    """The direction that presses the sphere on all its wheels, Σ R̂ᵢ as a unit vector; straight down where that is nothing."""
    total = design.contact_directions.sum(axis=0)
    length = np.linalg.norm(total)
    return total / length if length > 1e-9 else np.array([0.0, 0.0, -1.0])


def least_preload_of_run(design: Design, run: RollingRun, direction=(0.0, 0.0, -1.0)) -> Preload:
    """The least preload for the forces of ``run``, taken to stay as they are: exact where resistances are absent.

    A preload F d adds F nᵢ to the normal forces (``preload_gain``). Every sample then asks |fᵢ| ≤ μ (Nᵢ + F nᵢ) and
    Nᵢ + F nᵢ ≥ 0: a least F for contacts that d presses, a largest one for those it lifts.
    Raises ``SpheredriveError`` where friction is not given or no force in this direction does. Source: model.md section 5a.
    """
    mu = design.contact.friction
    if not mu:
        raise SpheredriveError("a preload needs contact.friction above zero")
    if not normals_known(design):
        raise SpheredriveError("the contacts lie in a plane, so normal forces cannot hold the sphere in every direction")
    gain = preload_gain(design, run, direction)
    d = preload_direction(direction)
    missing = np.abs(run.friction_force) / mu - run.normal_force
    pressing, lifting = gain > 1e-9, gain < -1e-9
    lowest = np.where(pressing, missing / np.where(pressing, gain, 1.0), -np.inf)
    highest = np.where(lifting, missing / np.where(lifting, gain, 1.0), np.inf)
    idle = ~pressing & ~lifting & (missing > SLACK * np.abs(run.normal_force).max(initial=0.0))
    sample, wheel = np.unravel_index(int(np.argmax(lowest)), lowest.shape)
    force = max(float(lowest[sample, wheel]), 0.0)
    if idle.any() or force > highest.min() * (1 + SLACK):
        bad = np.argwhere(idle)[0] if idle.any() else np.unravel_index(int(np.argmin(highest)), highest.shape)
        raise SpheredriveError(
            f"no force along {tuple(round(float(x), 4) for x in d)} keeps every contact from slipping: it does not press wheel "
            f"{int(bad[1]) + 1}, which needs it at {run.time[bad[0]]:.6g} s"
        )
    if force == 0.0:
        return Preload(0.0, tuple(map(float, d)), 0, 0.0)  # type: ignore[arg-type]
    return Preload(force, tuple(map(float, d)), int(wheel) + 1, float(run.time[sample]))  # type: ignore[arg-type]


def wheel_peak(run, power, usage, w: int) -> Peak:
    """The largest amounts at wheel ``w`` (from 0) of a run of any model."""
    torque, speed = np.abs(run.motor_torque[:, w]), np.abs(run.wheel_speed[:, w])
    at = {name: int(np.argmax(values)) for name, values in (("T", torque), ("w", speed), ("P", np.abs(power[:, w])))}
    low = int(np.argmin(run.normal_force[:, w]))
    used = None if usage is None else int(np.argmax(usage[:, w]))
    return Peak(
        wheel=w + 1,
        torque=float(torque[at["T"]]),
        torque_time=float(run.time[at["T"]]),
        rms_torque=_rms(run.time, torque),
        speed=float(speed[at["w"]]),
        speed_time=float(run.time[at["w"]]),
        power=float(abs(power[at["P"], w])),
        power_time=float(run.time[at["P"]]),
        least_normal=float(run.normal_force[low, w]),
        least_normal_time=float(run.time[low]),
        largest_friction=float(np.abs(run.friction_force[:, w]).max()),
        utilisation=None if used is None else float(usage[used, w]),
        utilisation_time=None if used is None else float(run.time[used]),
    )


def _rms(time: np.ndarray, values: np.ndarray) -> float:
    if len(time) < 2:
        return float(abs(values[0]))
    return math.sqrt(float(np.trapezoid(values**2, time)) / float(time[-1] - time[0]))


def _findings(design: Design, run: RollingRun, usage, known: bool):
    if not run.completed:
        yield Finding("incomplete", "failure", f"The run ended early: {run.reason}.")
    if not known:
        yield Finding(
            "normals-unknown",
            "warning",
            "The contacts lie in a plane or are fewer than three: normal forces alone cannot hold the sphere, so none are "
            "given.",
        )
    yield from limit_findings(run, "torque", run.motor_torque, design.motor.torque, "N m")
    yield from limit_findings(run, "speed", run.wheel_speed, design.motor.speed, "rad/s")
    if known:
        for w in range(design.wheel_count):
            yield from _contact_findings(run, usage, w)


def limit_findings(run, what: str, values: np.ndarray, limit: float | None, unit: str):
    """A finding for each wheel whose ``values`` (k, n) pass the motor's ``limit``."""
    if limit is None:
        return
    for w in range(values.shape[1]):
        beyond = np.flatnonzero(np.abs(values[:, w]) > limit * (1 + SLACK))
        if len(beyond):
            peak = np.abs(values[:, w]).max()
            yield Finding(
                f"motor-{what}",
                "failure",
                f"Wheel {w + 1} passes its motor's {what} limit of {limit:.4g} {unit} from {run.time[beyond[0]]:.4g} s on; its "
                f"peak is {peak:.4g} {unit}.",
            )


def _contact_findings(run: RollingRun, usage, w: int):
    lifted = np.flatnonzero(run.normal_force[:, w] <= 0)
    if len(lifted):
        yield Finding(
            "lift-off",
            "failure",
            f"Wheel {w + 1} is not pressed from {run.time[lifted[0]]:.4g} s on: its normal force falls to "
            f"{run.normal_force[:, w].min():.4g} N. The sphere needs more preload.",
        )
    if usage is None:
        return
    slipping = np.flatnonzero(usage[:, w] > 1 + SLACK)
    if len(slipping):
        first = slipping[0]
        yield Finding(
            "friction-limit",
            "failure",
            f"Wheel {w + 1} passes its friction limit from {run.time[first]:.4g} s on; it would slip, which the rolling model "
            "does not follow. The sphere needs more preload.",
        )
