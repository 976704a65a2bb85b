"""Sensitivities of a study file: what ``spheredrive sensitivity`` calls."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from spheredrive.studies.sensitivity.local import Gradient
    from spheredrive.studies.sensitivity.sobol import SobolIndices


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives at the base design, and Sobol' indices where they were asked for."""

    gradient: Gradient | None
    indices: SobolIndices | None

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "gradient": None if self.gradient is None else self.gradient.as_dict(),
            "sobol": None if self.indices is None else self.indices.as_dict(),
        }

    def text(self) -> str:
        """For a terminal."""
        return "\n\n".join(part.text() for part in (self.gradient, self.indices) if part is not None)


def sensitivity_command(study: Path, points: int | None = None) -> Sensitivity:
    """``spheredrive sensitivity``: derivatives at the base design; with ``points`` Sobol' indices over the laws instead.

    Raises as ``gradient`` and ``sobol_indices``.
    """
    from spheredrive.errors import SpheredriveError
    from spheredrive.studies.sensitivity.local import gradient
    from spheredrive.studies.sensitivity.sobol import sobol_indices
    from spheredrive.studies.sweep.command import read_study

    read = read_study(study)
    if not read.metrics:
        raise SpheredriveError(f"{read.path}: names no metrics; add metrics = [...] to it")
    if points is None:
        return Sensitivity(gradient(read), None)
    return Sensitivity(None, sobol_indices(read, points))
