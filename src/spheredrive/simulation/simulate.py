"""The door of the simulation: a design and a motion in, a labelled run out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from spheredrive.errors import UnknownNameError
from spheredrive.simulation.rolling_run import RollingRun, Tolerance, run_rolling, run_rolling_batch, spread

if TYPE_CHECKING:
    import xarray

    from spheredrive.design import Design
    from spheredrive.motion import Motion

MODELS = ("rolling",)


class Simulation(NamedTuple):
    """A run as arrays, for functions, and as a labelled dataset, for people and files."""

    run: RollingRun
    dataset: xarray.Dataset


def simulate(
    design: Design,
    motion: Motion,
    model: str = "rolling",
    *,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 - a frozen value
    watch: Callable[[float], None] | None = None,
) -> xarray.Dataset:
    """The run of ``design`` under ``motion`` as an ``xarray.Dataset``; units stand at each variable.

    ``model`` is ``"rolling"``: rigid wheels that roll without slip. ``tolerance`` is the error allowed in a step; ``watch``
    is called now and then with the share that is done, and what it raises stops the run. A run that cannot go on ends
    there: the attribute ``completed`` is then 0, and ``reason`` says why. Raises ``SpheredriveError`` for a model that does
    not exist and for what the design lacks, ``DesignError`` for a motion of another number of wheels, ``SingularError``
    where a prescribed motion does not determine the sphere's.
    """
    return simulate_run(design, motion, model, tolerance=tolerance, watch=watch).dataset


def simulate_run(
    design: Design,
    motion: Motion,
    model: str = "rolling",
    *,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 - a frozen value
    watch: Callable[[float], None] | None = None,
) -> Simulation:
    """``simulate``, with the arrays that the dataset was made of: what ``dynamics.loads`` takes."""
    from spheredrive.simulation.dataset import labelled

    _require_model(model)
    run = run_rolling(design, motion, tolerance, watch)
    return Simulation(run, labelled(design, motion, run, tolerance))


@dataclass(frozen=True)
class Batch:
    """Many runs: ``runs`` as arrays, and each as a labelled dataset when it is asked for, ``batch[i]``."""

    designs: tuple[Design, ...]
    motions: tuple[Motion, ...]
    runs: tuple[RollingRun, ...]
    tolerance: Tolerance

    def __len__(self) -> int:
        return len(self.runs)

    def __getitem__(self, i: int) -> xarray.Dataset:
        from spheredrive.simulation.dataset import labelled

        return labelled(self.designs[i], self.motions[i], self.runs[i], self.tolerance)


def simulate_batch(
    designs: Design | Sequence[Design],
    motions: Motion | Sequence[Motion],
    model: str = "rolling",
    *,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 - a frozen value
    watch: Callable[[float], None] | None = None,
) -> Batch:
    """Runs of many designs, many motions, or one of each a run, on all cores; a single one serves for all.

    Each run is what ``simulate`` gives, to the last bit. All must have the same number of wheels, kind of input, duration,
    sample rate and corners of the inputs. Raises ``SpheredriveError`` where they have not, and as ``simulate``.
    """
    _require_model(model)
    designs = designs if isinstance(designs, Sequence) else [designs]
    motions = motions if isinstance(motions, Sequence) else [motions]
    runs = run_rolling_batch(designs, motions, tolerance, watch)
    return Batch(
        tuple(spread(designs, len(runs), "designs")), tuple(spread(motions, len(runs), "motions")), tuple(runs), tolerance
    )


def _require_model(model: str) -> None:
    if model not in MODELS:
        raise UnknownNameError("model", model, MODELS)
