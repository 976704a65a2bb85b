"""Our compliant model against MuJoCo with explicit rollers, each as accurate as asked of its own limit, in one run.

    python benchmarks/against_mujoco.py

Both follow the same machine of 3 × 14 ball rollers. "Samples" holds normal forces and the centre's path at every sample to 2 %
of their own spread; "statistics" holds their means and spreads alone, which forgives steps that smear every touch. What is
timed records nothing and begins with a machine that is set up and seated: MuJoCo's own loop in C; of ours what a run takes more
that is twice as long.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mujoco_engine import machine, motion, mujoco_time
from spheredrive.design import Contact
from spheredrive.errors import SpheredriveError
from spheredrive.export.mjcf.run import Settings
from spheredrive.export.mjcf.steps import largest_step, run_difference
from spheredrive.simulation.compliant.run import Accuracy, run_compliant
from timing import best

WITHIN = 0.02
# Four periods that the three wheels' rollers have in common, about.
DURATION = 6.0
# MuJoCo's steps are sought from the longest by halving, s.
LONGEST, HALVINGS = 4e-3, 9
CONTACTS = {"soft": Contact(1e5, 200.0, 0.9), "stiff": Contact(1e6, 500.0, 0.9)}
# From coarse to fine; the first whose error is small enough is taken.
SETTINGS = [Accuracy(length, ledger=ledger) for length in (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8) for ledger in (1e9, 1e-2, 1e-3)]


class Ours(NamedTuple):
    """Our fastest run within the limit: s, its settings, its error by the same measure, the centre's largest error, m."""

    seconds: float
    settings: Accuracy
    error: float
    centre: float


def ours(design, asked, by: str) -> Ours:
    """Our fastest run whose difference from our own limit is no larger than what is asked of MuJoCo."""
    limit = run_compliant(design, asked, Accuracy(1e-11, ledger=1e-4))
    found = []
    for settings in SETTINGS:
        run = run_compliant(design, asked, settings)
        error = run_difference(run, limit, by)
        if error <= WITHIN:
            once, twice = (replace(asked, sample_rate=1.0, duration=k * asked.duration) for k in (1, 2))
            short, long = (best(lambda s=settings, m=m: run_compliant(design, m, s), 7) for m in (once, twice))
            seconds = long - short
            found.append(
                Ours(seconds, settings, error, float(np.abs(run.centre_displacement - limit.centre_displacement).max()))
            )
    return min(found)


def theirs(design, asked, by: str) -> tuple[float, float, str]:
    """MuJoCo's fastest time, s, its step, s, and its integrator; where no step will do, those of the shortest tried."""
    found, failed = [], []
    for integrator in ("implicitfast", "Euler", "RK4"):
        settings = Settings(integrator=integrator)
        try:
            step = largest_step(design, asked, WITHIN, settings, by, LONGEST, HALVINGS).largest
        except SpheredriveError as error:
            step = LONGEST / 2 ** (HALVINGS - 1)
            failed.append(
                (mujoco_time(design, asked, replace(settings, timestep=step)).seconds, step, f"{integrator}: {error}")
            )
            continue
        found.append((mujoco_time(design, asked, replace(settings, timestep=step)).seconds, step, integrator))
    return min(found or failed)


def main() -> None:
    asked = motion(DURATION)
    for name, contact in CONTACTS.items():
        design = replace(machine(), contact=contact)
        for by in ("samples", "statistics"):
            print(f"{name} contacts, K = {contact.stiffness:g} N/m, C = {contact.damping:g} N s/m, by {by}:")
            mine = ours(design, asked, by)
            print(
                f"  ours    {DURATION / mine.seconds:7.0f} times real time, error {100 * mine.error:.2g} %, "
                f"centre {1e6 * mine.centre:.2g} µm, length {mine.settings.length:g} m, ledger {mine.settings.ledger:g}"
            )
            seconds, step, integrator = theirs(design, asked, by)
            print(f"  MuJoCo  {DURATION / seconds:7.1f} times real time, {integrator}, step {1e6 * step:.4g} µs")
            print(f"  ratio   {seconds / mine.seconds:7.1f}")


if __name__ == "__main__":
    main()
