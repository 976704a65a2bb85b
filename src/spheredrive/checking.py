"""The kinematic answer for a design: every number and finding that ``check`` and the report show."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.kinematics.quality import NEAR_SINGULAR, describe_axes, svd3
from spheredrive.kinematics.states import LISTED, SEARCHED


@dataclass(frozen=True)
class Finding:
    """Something a designer should know. ``severity``: ``"failure"`` (the design does not work), ``"warning"``, ``"note"``."""

    code: str
    severity: str
    message: str


@dataclass(frozen=True)
class Check:
    """Results of ``check``; matrices as in ``kinematics``, angles in rad. What a singular layout lacks is None or inf.

    ``constraint`` to ``weakest`` are of the nominal contacts. ``contact_states`` lists every combination of races, or the
    worst alone where ``contact_state_count`` exceeds 256 (the worst that a search found, beyond 65,536).
    """

    name: str
    constraint: np.ndarray
    jacobian: np.ndarray | None
    inverse_jacobian: np.ndarray
    determinant: float | None
    singular_values: np.ndarray
    condition_number: float
    effectiveness: tuple[float, float]
    isotropy: float
    slowest: str
    weakest: str
    nearest_singularity: kinematics.Singularity | None
    contact_states: tuple[kinematics.ContactState, ...]
    contact_state_count: int
    findings: tuple[Finding, ...]

    @property
    def works(self) -> bool:
        """Whether no finding says that the design does not work."""
        return all(finding.severity != "failure" for finding in self.findings)

    def as_dict(self) -> dict:
        """Plain values for JSON; what is not finite becomes null."""
        near = self.nearest_singularity
        return {
            "name": self.name,
            "works": self.works,
            "constraint": self.constraint.tolist(),
            "jacobian": None if self.jacobian is None else self.jacobian.tolist(),
            "inverse_jacobian": self.inverse_jacobian.tolist(),
            "determinant": self.determinant,
            "condition_number": _finite(self.condition_number),
            "singular_values": self.singular_values.tolist(),
            "effectiveness": [_finite(bound) for bound in self.effectiveness],
            "isotropy": self.isotropy,
            "slowest_direction": self.slowest,
            "weakest_direction": self.weakest,
            "nearest_singularity": None if near is None else {"parameter": near.parameter, "change_rad": near.change},
            "contact_state_count": self.contact_state_count,
            "contact_states_all_searched": self.contact_state_count <= SEARCHED,
            "contact_states": [
                {
                    "races": [list(active) for active in state.races],
                    "contacts": state.contacts,
                    "slip_free_dof": state.slip_free_dof,
                    "rotation_dof": state.rotation_dof,
                    "isotropy": state.isotropy,
                }
                for state in self.contact_states
            ],
            "findings": [
                {"code": finding.code, "severity": finding.severity, "message": finding.message} for finding in self.findings
            ],
        }


def check(design: Design) -> Check:
    """Work out the kinematics of ``design`` and say what follows from them: trouble is a finding, not an error."""
    A, _ = kinematics.constraint(design)
    sigma, directions = svd3(A)
    singular = sigma[2] == 0.0
    states, count = _states(design)
    slowest, weakest = describe_axes(sigma, directions)
    return Check(
        name=design.name,
        constraint=A,
        jacobian=None if singular else _jacobian(design),
        inverse_jacobian=kinematics.inverse_jacobian(design),
        determinant=kinematics.determinant(design),
        singular_values=sigma,
        condition_number=math.inf if singular else float(sigma[0] / sigma[2]),
        effectiveness=kinematics.effectiveness(design),
        isotropy=float(sigma[2] / sigma[0]),
        slowest=slowest,
        weakest=weakest,
        nearest_singularity=None if singular else kinematics.nearest_singularity(design),
        contact_states=states,
        contact_state_count=count,
        findings=tuple(_findings(design, sigma, directions, states, count)),
    )


def _jacobian(design: Design) -> np.ndarray:
    with warnings.catch_warnings():
        # Near singularity is told by a finding here, not by a warning.
        warnings.simplefilter("ignore")
        return kinematics.jacobian(design)


def _states(design: Design) -> tuple[tuple[kinematics.ContactState, ...], int]:
    count = kinematics.count_contact_states(design)
    if count > LISTED:
        return (kinematics.worst_contact_state(design),), count
    return tuple(kinematics.contact_states(design)), count


def _findings(design: Design, sigma, directions, states, count):
    n = design.wheel_count
    missed = describe_axes(sigma, directions)[1]
    if n < 3:
        yield Finding(
            "under-actuated",
            "failure",
            f"{n} wheel{'' if n == 1 else 's'} cannot turn a sphere about every axis: it takes three. Nothing drives it about "
            f"{missed}.",
        )
    elif sigma[2] == 0.0:
        yield Finding(
            "singular",
            "failure",
            f"The layout is singular: no wheel drives or holds the sphere about {missed}, so there is no Jacobian. Change the "
            "elevation, the heading or the roller angle.",
        )
    elif sigma[2] < NEAR_SINGULAR * sigma[0]:
        yield Finding(
            "near-singular",
            "failure",
            f"The layout is nearly singular: an error of a wheel grows up to {sigma[0] / sigma[2]:.3g} times in rotations "
            f"about {missed}. The Jacobian given is not fit for use.",
        )
    if n > 3:
        yield Finding(
            "over-actuated",
            "note",
            f"{n} wheels drive three rotations: their speeds must agree (ω = B⁻¹AΩ), or wheels slip.",
        )
    yield from _state_findings(states, count, singular=n < 3 or sigma[2] < NEAR_SINGULAR * sigma[0])
    yield from _race_findings(design)


def _state_findings(states, count, singular):
    worst = min(states, key=lambda state: (state.rotation_dof, state.isotropy))
    if worst.rotation_dof < 3:
        held = sum(state.rotation_dof < 3 for state in states)
        alone = f"In the worst {'of' if count <= SEARCHED else 'found of'} {count} contact states"
        where = f"In {held} of {count} contact states" if len(states) == count else alone
        left = ("none", "those about one axis", "those about the axes of one plane")[worst.rotation_dof]
        yield Finding(
            "slip",
            "failure",
            f"{where} some rotations slip: races of one wheel that touch together ask for different motions. With races "
            f"{worst.races_text} in contact the rotations free of slip are: {left}.",
        )
    if not singular and worst.isotropy < NEAR_SINGULAR:
        yield Finding(
            "singular-state",
            "failure",
            f"The nominal layout works, but with races {worst.races_text} in contact it is singular or nearly so "
            f"(isotropy {worst.isotropy:.3g}).",
        )


def _race_findings(design: Design):
    deflections = [abs(race.deflection(design.sphere.radius)) for wheel in design.wheels for race in design.races(wheel)]
    if max(deflections) > 0:
        yield Finding(
            "race-offset",
            "note",
            f"Races touch up to {math.degrees(max(deflections)):.2f}° beside the wheels' middle: a controller that knows only "
            "the nominal Jacobian errs in direction and magnitude as races change.",
        )


def _finite(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None
