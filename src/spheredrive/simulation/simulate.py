"""The door of the simulation: a design and a motion in, a labelled run out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.simulation.rolling_run import RollingRun, Tolerance, run_rolling, run_rolling_batch, spread

if TYPE_CHECKING:
    import xarray

    from spheredrive.design import Design
    from spheredrive.motion import Motion
    from spheredrive.simulation.compliant.run import Accuracy, CompliantRun

MODELS = ("rolling", "compliant")


class Simulation(NamedTuple):
    """A run as arrays, for functions, and as a labelled dataset, for people and files."""

    run: RollingRun | CompliantRun
    dataset: xarray.Dataset


def simulate(
    design: Design,
    motion: Motion,
    model: str = "rolling",
    *,
    tolerance: Tolerance | Accuracy | None = None,
    watch: Callable[[float], None] | None = None,
) -> xarray.Dataset:
    """The run of ``design`` under ``motion`` as an ``xarray.Dataset``; units stand at each variable.

    ``model`` is ``"rolling"``: rigid wheels that roll without slip; or ``"compliant"``: every roller a contact of its own that
    gives way, slips and opens (model.md 5c). ``tolerance`` is the error allowed in a step: a ``Tolerance`` of the rolling
    model, an ``Accuracy`` of the compliant one; ``watch`` is called now and then with the share that is done, and what it
    raises stops the run. A run that cannot go on ends there: the attribute ``completed`` is then 0, and ``reason`` says why.
    Raises ``SpheredriveError`` for a model that does not exist and for what the design lacks, ``DesignError`` for a motion of
    another number of wheels, ``SingularError`` where a prescribed motion does not determine the sphere's.
    """
    return simulate_run(design, motion, model, tolerance=tolerance, watch=watch).dataset


def simulate_run(
    design: Design,
    motion: Motion,
    model: str = "rolling",
    *,
    tolerance: Tolerance | Accuracy | None = None,
    watch: Callable[[float], None] | None = None,
) -> Simulation:
    """``simulate``, with the arrays that the dataset was made of: what ``dynamics.loads`` takes."""
    _require_model(model)
    settings = _settings(model, tolerance)
    if model == "compliant":
        from spheredrive.simulation.compliant.dataset import labelled as labelled_compliant
        from spheredrive.simulation.compliant.run import run_compliant

        run = run_compliant(design, motion, settings, watch)
        return Simulation(run, labelled_compliant(design, motion, run, settings))
    from spheredrive.simulation.dataset import labelled

    run = run_rolling(design, motion, settings, watch)
    return Simulation(run, labelled(design, motion, run, settings))


@dataclass(frozen=True)
class Batch:
    """Many runs: ``runs`` as arrays, and each as a labelled dataset when it is asked for, ``batch[i]``."""

    designs: tuple[Design, ...]
    motions: tuple[Motion, ...]
    runs: tuple[RollingRun, ...] | tuple[CompliantRun, ...]
    tolerance: Tolerance | Accuracy
    model: str = "rolling"

    def __len__(self) -> int:
        return len(self.runs)

    def __getitem__(self, i: int) -> xarray.Dataset:
        if self.model == "compliant":
            from spheredrive.simulation.compliant.dataset import labelled
        else:
            from spheredrive.simulation.dataset import labelled
        return labelled(self.designs[i], self.motions[i], self.runs[i], self.tolerance)


def simulate_batch(
    designs: Design | Sequence[Design],
    motions: Motion | Sequence[Motion],
    model: str = "rolling",
    *,
    tolerance: Tolerance | Accuracy | None = None,
    watch: Callable[[float], None] | None = None,
) -> Batch:
    """Runs of many designs, many motions, or one of each a run, on all cores; a single one serves for all.

    Each run is what ``simulate`` gives, to the last bit. All must have the same number of wheels, kind of input, duration,
    sample rate and corners of the inputs. Raises ``SpheredriveError`` where they have not, and as ``simulate``.
    """
    _require_model(model)
    designs = designs if isinstance(designs, Sequence) else [designs]
    motions = motions if isinstance(motions, Sequence) else [motions]
    settings = _settings(model, tolerance)
    if model == "compliant":
        from spheredrive.simulation.compliant.run import run_compliant_batch as run_batch
    else:
        run_batch = run_rolling_batch
    runs = run_batch(designs, motions, settings, watch)
    one_each = tuple(spread(designs, len(runs), "designs")), tuple(spread(motions, len(runs), "motions"))
    return Batch(*one_each, tuple(runs), settings, model)


def _settings(model: str, tolerance):
    """How runs of a model are integrated, by default as the model's own value says."""
    from spheredrive.simulation.compliant.run import Accuracy

    kind = Accuracy if model == "compliant" else Tolerance
    if tolerance is not None and not isinstance(tolerance, kind):
        raise SpheredriveError(f"the {model} model takes {kind.__name__}(...) as its tolerance, not {type(tolerance).__name__}")
    return kind() if tolerance is None else tolerance


def _require_model(model: str) -> None:
    if model not in MODELS:
        raise UnknownNameError("model", model, MODELS)
