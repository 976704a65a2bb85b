"""What a common angle of all wheels does: the four panels that the studies of elevation and of heading share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spheredrive.design import Design
from spheredrive.studies.parameters.common import DEMAND, least_preload, quality, shaken
from spheredrive.studies.reproduce.figures.common import KIND, MILLI, legend_above, panels

Variant = Callable[[str, float], Design]


def measured(angles_deg: np.ndarray, variant: Variant) -> dict[str, dict[str, np.ndarray]]:
    """ξ (k, 2), isotropy, least preload (N) and RMS displacement (m), each (k,), of both wheels that ``variant`` makes."""
    found = {}
    for kind in KIND:
        rows = []
        for angle in angles_deg:
            design = variant(kind, float(angle))
            singular = quality(design)[2] < 1e-3
            preload, moved = (np.nan, np.nan) if singular else (least_preload(design), shaken(design).rms_displacement)
            rows.append((*quality(design), preload, moved))
        table = np.array(rows)
        found[kind] = {"xi": table[:, :2], "isotropy": table[:, 2], "preload": table[:, 3], "displacement": table[:, 4]}
    return found


def four_panels(angles_deg: np.ndarray, found: dict, label: str):
    """The figure and its columns."""
    figure, axes = panels(5.4, 2, 2, sharex=True)
    columns = {f"{label} (deg)": angles_deg}
    for kind, values in found.items():
        colour = KIND[kind]
        xi = np.where(values["xi"] < 3, values["xi"], np.nan)
        axes[0, 0].fill_between(angles_deg, *xi.T, color=colour, alpha=0.2, lw=0)
        axes[0, 0].plot(angles_deg, xi[:, 0], color=colour, label=f"{kind} wheels")
        axes[0, 0].plot(angles_deg, xi[:, 1], color=colour)
        axes[0, 1].plot(angles_deg, values["isotropy"], color=colour)
        axes[1, 0].plot(angles_deg, values["preload"], color=colour)
        axes[1, 1].plot(angles_deg, MILLI * values["displacement"], color=colour)
        columns[f"least xi {kind} (-)"], columns[f"largest xi {kind} (-)"] = values["xi"].T
        columns[f"isotropy {kind} (-)"], columns[f"least preload {kind} (N)"] = values["isotropy"], values["preload"]
        columns[f"RMS displacement {kind} (mm)"] = MILLI * values["displacement"]
    for place, name in zip(
        axes.ravel(),
        ("effectiveness ξ, from and to (–)", "isotropy (–)", "least preload (N)", "RMS displacement (mm)"),
        strict=True,
    ):
        place.set_ylabel(name)
        place.set_ylim(0, None)
        place.set_xlim(angles_deg[0], angles_deg[-1])
    for place in axes[1]:
        place.set_xlabel(f"{label} (°)")
    legend_above(figure, axes[0, 0])
    return figure, axes, columns


CAPTION = (
    f"Upper left, the range of ξ over all axes; lower left, least force towards the wheels beyond the weight for {DEMAND:g} "
    "rad/s² about any axis; lower right, vibration of the centre while the sphere turns at 0.1 rad/s."
)


def best(angles_deg: np.ndarray, values: np.ndarray) -> float:
    """The angle of the largest value; of equal ones the smallest."""
    top = np.flatnonzero(values >= np.nanmax(values) - 1e-9)
    return float(angles_deg[top[int(np.argmin(np.abs(angles_deg[top])))]])
