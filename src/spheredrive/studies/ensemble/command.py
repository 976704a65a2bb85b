"""An ensemble from files to a folder of results: what ``spheredrive ensemble`` calls."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spheredrive.io.quantity import parse
from spheredrive.studies.ensemble.spread import Spread

if TYPE_CHECKING:
    import xarray

    from spheredrive.design import Design
    from spheredrive.motion import Motion


@dataclass(frozen=True)
class Ensemble:
    """An ensemble that is finished: its dataset and its files."""

    data: xarray.Dataset
    files: tuple[Path, ...]

    @property
    def works(self) -> bool:
        """Whether every machine comes through."""
        return bool((self.data.reason.values == "").all())

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI."""
        from spheredrive.studies.ensemble.numbers import NUMBERS
        from spheredrive.studies.ensemble.runs import QUANTILES, quantiles

        reasons = self.data.reason.values
        found = quantiles(self.data)
        units = {n.name: n.unit for n in NUMBERS}
        return {
            "files": [str(file) for file in self.files],
            "members": len(reasons),
            "failed": int((reasons != "").sum()),
            "reasons": sorted({str(reason) for reason in reasons if reason}),
            "quantiles": list(QUANTILES),
            "numbers": {name: {"unit": units[name], "values": list(values)} for name, values in found.items()},
        }

    def text(self) -> str:
        """For a terminal."""
        from spheredrive.studies.ensemble.runs import ensemble_text

        return "\n".join([*map(str, self.files), ensemble_text(self.data)])


def spread_of(friction: float = 0.0, alignment: str | None = None, radius: float = 0.0, wear: str | None = None) -> Spread:
    """The spread that a command line names: shares as numbers, ``alignment`` and ``wear`` with their units."""
    return Spread(
        friction,
        0.0 if alignment is None else parse(alignment, "rad", "alignment spread"),
        radius,
        0.0 if wear is None else parse(wear, "m", "wear"),
    )


def ensemble_command(
    design: Design,
    motion: Motion,
    output: Path,
    spread: Spread,
    count: int,
    seed: int,
    watch: Callable[[float], None] = lambda share: None,
    device: str = "cpu",
) -> Ensemble:
    """``spheredrive ensemble``: run the ensemble and write ``ensemble.nc`` and ``distribution.svg`` into ``output``.

    What is finished is kept there: the same command goes on where it was stopped. Raises as ``ensemble``, and ``InputError``
    where the folder cannot be written.
    """
    from spheredrive.io.files import write_whole
    from spheredrive.io.results import write_run
    from spheredrive.simulation.compliant.run import Accuracy
    from spheredrive.studies.ensemble.figures import distribution_svg
    from spheredrive.studies.ensemble.runs import RUNS_AT_ONCE, ensemble
    from spheredrive.studies.sweep.store import Store, locked

    accuracy = Accuracy()
    with locked(output):
        store = Store(output, _digest(design, motion, accuracy), _digest(spread, seed, RUNS_AT_ONCE))
        store.open()
        data = ensemble(design, motion, spread, count, seed, accuracy, watch=watch, store=store, device=device)
        files = [write_run(data, output / "ensemble.nc")]
        if (data.reason.values == "").any():
            files.append(output / "distribution.svg")
            write_whole(files[-1], distribution_svg(data))
    return Ensemble(data, tuple(files))


def _digest(*values: object) -> str:
    """32 letters that tell what numbers follow from."""
    import spheredrive
    from spheredrive.studies.sweep.keys import NUMBERS

    text = "\0".join(["ensemble", spheredrive.__version__, str(NUMBERS), *map(repr, values)])
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()
