"""How well the wheels drive and hold the sphere, from the singular values of the nominal constraint matrix."""

from __future__ import annotations

import numpy as np

from spheredrive.io.study import Metric
from spheredrive.kinematics import condition_number, constraint_row, singular_values, worst_contact_state
from spheredrive.studies.sweep.metrics.base import Conditions, Family, Found, Machines, known, one_by_one, unless

METRICS = (
    Metric("isotropy", "", "isotropy, least over largest singular value of A"),
    Metric("condition_number", "", "condition number of A"),
    Metric("determinant", "", "determinant of A"),
    Metric("sigma_min", "", "least singular value of A, distance to the nearest singular layout"),
    Metric("effectiveness_min", "", "least transmission effectiveness over all rotations"),
    Metric("effectiveness_max", "", "largest transmission effectiveness over all rotations"),
    Metric("slip_free_dof", "", "rotations free of slip in the worst contact state"),
)
_FROM_SIGMA = {"isotropy", "sigma_min", "effectiveness_min", "effectiveness_max"}
SINGULAR = "the layout is singular: some rotation of the sphere is neither driven nor held"


def measure(machines: Machines, conditions: Conditions, names: tuple[str, ...]) -> dict[str, Found]:
    """The metrics ``names`` of a batch."""
    c = machines.columns
    A = constraint_row(c.contact_direction, c.drive_direction, c.roller_angle)
    found: dict[str, Found] = {}
    if _FROM_SIGMA & set(names):
        found.update(_from_singular_values(singular_values(A)))
    if "condition_number" in names:
        condition = condition_number(A)
        found["condition_number"] = unless(condition, (np.isinf(condition), SINGULAR))
    if "determinant" in names:
        n = c.wheel_count
        det = np.zeros(len(c)) if n != 3 else np.einsum("bi,bi->b", A[:, 0], np.cross(A[:, 1], A[:, 2]))
        found["determinant"] = unless(det, (np.full(len(c), n != 3), f"A has a determinant for three wheels, not for {n}"))
    if "slip_free_dof" in names:
        found["slip_free_dof"] = _slip_free_dof(machines)
    return {name: found[name] for name in names}


def _from_singular_values(sigma: np.ndarray) -> dict[str, Found]:
    singular = sigma[:, 2] == 0.0
    largest = 1 / np.where(singular, 1.0, sigma[:, 2])
    return {
        "isotropy": known(sigma[:, 2] / sigma[:, 0]),
        "sigma_min": known(sigma[:, 2]),
        "effectiveness_min": known(1 / sigma[:, 0]),
        "effectiveness_max": unless(largest, (singular, SINGULAR)),
    }


def _slip_free_dof(machines: Machines) -> Found:
    """Three where one race of each wheel touches at a time: each row has a wheel speed of its own to be met by."""
    c = machines.columns
    if all(len(races) == 1 for wheel in c.design.wheels for races in wheel.alternation):
        return known(np.full(len(c), 3.0))
    designs = machines.designs
    assert designs is not None, "whole designs were asked for"
    return one_by_one(len(c), lambda i: worst_contact_state(designs[i]).rotation_dof)


def _whole(conditions: Conditions, names: tuple[str, ...]) -> bool:
    return "slip_free_dof" in names


FAMILY = Family(METRICS, measure, _whole, lambda conditions, names: 512 if _whole(conditions, names) else 16384)
