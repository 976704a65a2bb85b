"""What presses the sphere on its wheels: along a motion where the study has one, else at rest under the motors' torque.

At rest every motor gives its largest torque, in the worst combination of signs (none where motor.torque is absent):

    fᵢ = T/(rᵢ |sin αᵢ|),   Nᵢ = R̂ᵢ·G (F + M_s g) − Σⱼ |R̂ᵢ·G ûⱼ| fⱼ,   G = (Σ R̂ R̂ᵀ)⁻¹

with the nominal contacts, and a preload P along d adds P R̂ᵢ·G d. Each sign is at its worst by itself, as N is linear in f.
Source: model.md section 5a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spheredrive.design import GRAVITY
from spheredrive.io.study import Metric
from spheredrive.kinematics.contacts import Contacts
from spheredrive.studies.sweep.metrics.base import Conditions, Family, Found, Machines, nowhere, unless
from spheredrive.studies.sweep.metrics.simulated import RUNS_AT_ONCE, from_runs

METRICS = (
    Metric("preload", "N", "least force that presses the sphere on its wheels so that none slips, beyond weight and closure"),
    Metric("normal_force_max", "N", "largest normal force of a contact"),
    Metric("friction_utilisation", "", "largest share of the friction limit that is used"),
)
FLAT = "the contacts lie in a plane or are fewer than three: normal forces alone cannot hold the sphere"
NO_MASS = "the weight that presses the contacts needs sphere.mass; or write stage.gravity = false"
NO_FRICTION = "needs contact.friction above zero"
NOT_PRESSED = "a contact that carries friction is not pressed"
NO_PRELOAD = "no force towards the wheels presses all of them enough"
# As in dynamics.loads: a contact that a newton presses by less is not pressed by it; singular values this small are none.
IDLE, PLANE = 1e-9, 1e-7


def measure(machines: Machines, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    """The metrics ``names`` of a batch."""
    if conditions.motion is not None:
        return from_runs(machines, conditions.motion, names)
    c = machines.columns
    if c.design.stage.gravity and c.sphere_mass is None:
        return {name: nowhere(len(c), NO_MASS) for name in names}
    at_rest = _rest(machines)
    mu = np.zeros(len(c)) if c.friction is None else c.friction
    slippery = at_rest.loaded & ~(mu > 0)
    f, normal, swing = at_rest.friction, at_rest.normal, at_rest.swing
    least = normal - swing
    grip = f / np.where(mu > 0, mu, 1.0)[:, None]
    found = {"normal_force_max": unless((normal + swing).max(axis=1), (at_rest.flat, FLAT))}
    if "preload" in names:
        force, impossible = _preload(at_rest.gain, grip - least)
        found["preload"] = unless(force, (at_rest.flat, FLAT), (slippery, NO_FRICTION), (impossible, NO_PRELOAD))
    if "friction_utilisation" in names:
        open_ = (least <= 0) & (f > 0)
        used = np.where(open_, 0.0, grip / np.where(least > 0, least, 1.0)).max(axis=1)
        whys = (at_rest.flat, FLAT), (slippery, NO_FRICTION), (open_.any(axis=1), NOT_PRESSED)
        found["friction_utilisation"] = unless(used, *whys)
    return {name: found[name] for name in names}


class _Rest(NamedTuple):
    """Machines at rest: friction of each motor's torque, normal forces under weight and closure, by how much friction swings
    them, what one newton of preload adds, (b, n); contacts that lie in a plane, machines with torque, (b,)."""

    friction: np.ndarray
    normal: np.ndarray
    swing: np.ndarray
    gain: np.ndarray
    flat: np.ndarray
    loaded: np.ndarray


def _rest(machines: Machines) -> _Rest:
    c = machines.columns
    b, n = c.wheel_radius.shape
    R_hat = c.contact_direction
    # Σ R̂ R̂ᵀ has the squares of the singular values of the directions.
    S = np.einsum("bni,bnj->bij", R_hat, R_hat)
    spread = np.linalg.svd(R_hat, compute_uv=False)
    flat = (spread[:, -1] <= PLANE * spread[:, 0]) if n >= 3 else np.ones(b, bool)
    G = np.linalg.inv(np.where(flat[:, None, None], np.eye(3), S))
    pressed = np.einsum("bni,bij->bnj", R_hat, G)
    load = c.closure_force.copy()
    if c.design.stage.gravity:
        load[:, 2] -= GRAVITY * c.sphere_mass  # type: ignore[operator]
    torque = np.zeros(b) if c.motor_torque is None else c.motor_torque
    f = torque[:, None] / (c.wheel_radius * np.abs(np.sin(c.roller_angle)))
    swing = np.einsum("bij,bj->bi", np.abs(np.einsum("bni,bmi->bnm", pressed, _slip_direction(machines))), f)
    return _Rest(f, _along(pressed, load), swing, _along(pressed, _pressing_direction(R_hat)), flat, torque > 0)


def _along(pressed: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.einsum("bni,bi->bn", pressed, force)


def _slip_direction(machines: Machines) -> np.ndarray:
    """û of each nominal contact, (b, n, 3)."""
    c = machines.columns
    b, n = c.wheel_radius.shape
    R_hat, v_hat = c.contact_direction.reshape(-1, 3), c.drive_direction.reshape(-1, 3)
    nothing = np.zeros(b * n, np.int64)
    contacts = Contacts(nothing, nothing, R_hat, v_hat, c.roller_angle.ravel(), c.wheel_radius.ravel())
    return contacts.slip_direction.reshape(b, n, 3)


def _pressing_direction(R_hat: np.ndarray) -> np.ndarray:
    """``dynamics.pressing_direction`` of many machines, (b, 3)."""
    total = R_hat.sum(axis=1)
    length = np.sqrt((total * total).sum(axis=1))
    somewhere = length > IDLE
    return np.where(somewhere[:, None], total / np.where(somewhere, length, 1.0)[:, None], [0.0, 0.0, -1.0])


def _preload(gain: np.ndarray, missing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least P with P g ≥ missing for every contact, (b,), and where there is none: contacts that it lifts set an upper end."""
    pressing, lifting = gain > IDLE, gain < -IDLE
    lowest = np.where(pressing, missing / np.where(pressing, gain, 1.0), -np.inf).max(axis=1)
    highest = np.where(lifting, missing / np.where(lifting, gain, 1.0), np.inf).min(axis=1)
    force = np.maximum(lowest, 0.0)
    idle = (~pressing & ~lifting & (missing > IDLE * np.abs(missing).max(axis=1, keepdims=True))).any(axis=1)
    return force, idle | (force > highest + IDLE * np.abs(highest))


def _whole(conditions: Conditions, names: tuple[str, ...]) -> bool:
    return conditions.motion is not None


FAMILY = Family(METRICS, measure, _whole, lambda conditions, names: RUNS_AT_ONCE * 4 if conditions.motion else 16384)
