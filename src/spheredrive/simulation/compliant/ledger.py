"""The energy ledger of a compliant run: what is stored, what went in, what was lost."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.energy import energies_over_time
from spheredrive.simulation.compliant.run import CompliantRun


class Ledger(NamedTuple):
    """Energies in J over time, (k,); ``residual`` is what does not add up.

        kinetic + potential + elastic + slip + contact_damping + resistances − motor_work − stage_work = constant

    kinetic          of sphere, wheels, their masses on mounts, turning rollers and the stage
    potential        of weight, closure force and springs, and mounts
    elastic          of the contacts
    slip             lost by slipping
    contact_damping  lost in the contacts' damping
    resistances      lost by roller drag, rolling and spin resistance, and the damping of mounts and closure
    """

    kinetic: np.ndarray
    potential: np.ndarray
    elastic: np.ndarray
    motor_work: np.ndarray
    stage_work: np.ndarray
    slip: np.ndarray
    contact_damping: np.ndarray
    resistances: np.ndarray
    residual: np.ndarray


def ledger(run: CompliantRun) -> Ledger:
    """The ledger at every sample of a run. Gravity acts on the sphere alone: the gantry carries the rest."""
    m, found = run.machine, np.empty((len(run.time), 2))
    energies_over_time(np.ascontiguousarray(run.states), m.body, m.wheels, m.stations, m.outlines, found)
    kinetic, potential = found.T
    motor, stage, slip, damping, other = run.works[:, : at.POWERS].T
    total = kinetic + potential + run.stored + slip + damping + other - motor - stage
    residual = total - total[0] if len(total) else total
    return Ledger(kinetic, potential, run.stored, motor, stage, slip, damping, other, residual)
