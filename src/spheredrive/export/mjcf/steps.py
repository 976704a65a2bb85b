"""Which time step MuJoCo needs for a given accuracy, measured against its own limit of short steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError
from spheredrive.export.mjcf.run import MujocoRun, Settings, run_mujoco

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

HALVINGS = 12


@dataclass(frozen=True)
class StepSearch:
    """How far runs of rising steps are from the one of the shortest.

    largest      the largest step that, with all shorter ones, is within the asked share of the limit, s
    timestep     steps tried, rising, s, the first stands for the limit
    difference   largest difference of each from the first, as a share; inf where MuJoCo gives up
    """

    largest: float
    timestep: tuple[float, ...]
    difference: tuple[float, ...]


def run_difference(a: MujocoRun, b: MujocoRun, by: str = "samples", skip: float = 0.25) -> float:
    """How far run ``a`` is from run ``b``, as a share of b's amounts; the larger of what follows.

    by     "samples": rms over time of the differences of N and of the centre, over the spread of N and the centre's ripple;
           "statistics": differences of mean Ω, mean and spread of N and ripple of the centre
    skip   share of the run that is left out at its start

    Means over a run forgive what single samples show: a step that smears every jump of N may leave them all in place.
    """
    first = int(skip * len(a.time))
    Omega, N, c = (
        [getattr(run, name)[first:] for run in (a, b)] for name in ("angular_velocity", "normal_force", "centre_displacement")
    )
    spread, ripple = N[1].std(axis=0), _rms(c[1] - c[1].mean(axis=0))
    if by == "samples":
        pairs = [(_rms(N[0] - N[1]), _rms(N[1] - N[1].mean(axis=0))), (_rms(c[0] - c[1]), ripple)]
    else:
        pairs = [
            (np.linalg.norm(Omega[0].mean(axis=0) - Omega[1].mean(axis=0)), np.linalg.norm(Omega[1].mean(axis=0))),
            (np.abs(N[0].mean(axis=0) - N[1].mean(axis=0)).max(), N[1].mean(axis=0).max()),
            (np.abs(N[0].std(axis=0) - spread).max(), spread.max()),
            (abs(_rms(c[0] - c[0].mean(axis=0)) - ripple), ripple),
        ]
    return float(max(apart / size for apart, size in pairs if size > 0))


def _rms(values: np.ndarray) -> float:
    """Root of the mean over time of the sum of squares."""
    return float(np.sqrt((values**2).sum(axis=1).mean()))


def largest_step(
    design: Design,
    motion: Motion,
    within: float = 0.02,
    settings: Settings | None = None,
    by: str = "samples",
    longest: float = 4e-3,
    halvings: int = HALVINGS,
) -> StepSearch:
    """The largest step with which a run stays ``within`` its own limit of short steps; ``by`` as for ``run_difference``.

    Steps are halved from ``longest`` (s), or the motion's sample time, until one changes the answer by less than a quarter of
    ``within``; that run stands for the limit. Raises ``SpheredriveError`` where so many ``halvings`` do not get there, and as
    ``run_mujoco``.
    """
    settings = settings or Settings()
    step = min(longest, 1 / motion.sample_rate)
    runs: list[tuple[float, MujocoRun | None]] = []
    for _ in range(halvings):
        runs.append((step, _tried(design, motion, replace(settings, timestep=step))))
        last = [run for _, run in runs[-2:]]
        if len(last) == 2 and None not in last and run_difference(*last, by) < within / 4:  # type: ignore[arg-type]
            break
        step /= 2
    else:
        raise SpheredriveError(f"steps down to {step:.3g} s still change MuJoCo's answer by more than {within / 4:.2g}")
    limit = runs[-1][1]
    steps = [s for s, _ in reversed(runs)]
    apart = [float("inf") if run is None else run_difference(run, limit, by) for _, run in reversed(runs)]  # type: ignore[arg-type]
    good = next((i for i, x in enumerate(apart) if x > within), len(apart)) - 1
    return StepSearch(steps[good], tuple(steps), tuple(apart))


def _tried(design: Design, motion: Motion, settings: Settings) -> MujocoRun | None:
    try:
        return run_mujoco(design, motion, settings)
    except SpheredriveError:
        return None
