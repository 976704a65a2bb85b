"""Fig 3.6–3.13: the centre's motion on real wheels, rigid and elastic."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.reproduce import assumptions
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import (
    AXES,
    DASHED,
    GREY,
    INK,
    MICRO,
    MILLI,
    OURS,
    THESIS,
    both_ways,
    drawn,
    legend_above,
    panels,
)
from spheredrive.studies.reproduce.results import imperfect

FIRST = assumptions.FIRST_PART.value


@drawn
def rigid_figure(number: int, roundness: float) -> Drawing:
    """Fig 3.6–3.9: ΔR with everything rigid, thesis's outline and exact one in each panel."""
    motions = {shape: imperfect.rigid(shape, roundness, FIRST) for shape in ("half-sine", "exact")}
    figure, axes = panels(5.2, 4, 1, sharex=True, sharey=True)
    columns = {"time (s)": motions["exact"].time}
    for shape, name, colour, style in (
        ("half-sine", "half sine of the thesis", THESIS, DASHED), ("exact", "exact outline", OURS, "-"),
    ):  # fmt: skip
        values = _with_size(motions[shape].displacement)
        for axis, label, column in zip(axes[:, 0], ("x", "y", "z", "|ΔR|"), values.T, strict=True):
            axis.plot(motions[shape].time, MILLI * column, color=colour, ls=style, label=name, lw=1.1)
            axis.set_ylabel(f"{label} (mm)")
            columns[f"{label} {shape} (mm)"] = MILLI * column
    axes[-1, 0].set_xlabel("time (s)")
    axes[-1, 0].set_xlim(0, FIRST)
    legend_above(figure, axes[0, 0])
    peaks = {shape: MILLI * imperfect.largest(motion) for shape, motion in motions.items()}
    return Drawing(
        f"fig-3.{number}",
        f"ΔR over time, rigid, η = {roundness:g}",
        f"Each wheel moves its own axis by its own shape: up to {peaks['half-sine']:.3f} mm with the half sine, "
        f"{peaks['exact']:.3f} mm with the exact outline, whose corners are in the valleys (E7). Half sines start at the edge "
        "of a gap, exact outlines there too.",
        figure,
        columns,
    )


def _with_size(vectors: np.ndarray) -> np.ndarray:
    return np.column_stack([vectors, np.linalg.norm(vectors, axis=1)])


def rigid_figures() -> list[Drawing]:
    """Fig 3.6–3.9."""
    return [rigid_figure(number, eta) for number, eta in enumerate(assumptions.ROUNDNESS_SAMPLES.value, 6)]


@drawn
def figure_3_10() -> Drawing:
    """Largest |ΔR| over η."""
    growth = imperfect.growth()
    figure, axes = panels(3.2, 1, 1)
    axes = axes[0, 0]
    axes.plot(growth.roundness, MILLI * growth.half_sine, color=THESIS, ls=DASHED, label="half sine of the thesis")
    axes.plot(growth.roundness, MILLI * growth.exact, color=OURS, label="exact outline")
    axes.plot(growth.roundness, MILLI * growth.depth, color=GREY, lw=0.8, label="Δr of one wheel")
    axes.axvline(imperfect.ROUNDNESS, color=INK, lw=0.6, ls=":", label="demonstrator, η = 0.4485")
    axes.set(xlabel="roundness ratio η (–)", ylabel="largest |ΔR| (mm)", xlim=(0, 1), ylim=(0, None))
    legend_above(figure, axes)
    return Drawing(
        "fig-3.10",
        "Largest displacement of the centre over the roundness ratio, rigid",
        "Grows as the gaps deepen, a little faster than η². The largest |ΔR| exceeds one wheel's Δr because the three wheels' "
        "valleys meet; the exact valleys are narrower at the bottom and meet less.",
        figure,
        {
            "eta (-)": growth.roundness,
            "largest half-sine (mm)": MILLI * growth.half_sine,
            "largest exact (mm)": MILLI * growth.exact,
            "depth of one wheel (mm)": MILLI * growth.depth,
        },
    )


@drawn
def elastic_figure(number: int, damping: float) -> Drawing:
    """Fig 3.11–3.13: the thesis's measure and the centre itself."""
    shown = {measure: imperfect.elastic("half-sine", damping, FIRST, measure) for measure in ("thesis", "true")}
    scales = {"thesis": (MICRO, "µm"), "true": (MILLI, "mm")}
    figure, axes = both_ways(
        4.2, 2, "as the thesis measures it: deflection y − h", "the centre of the sphere itself", sharex=True, sharey="col"
    )
    columns = {"time (s)": shown["true"].time}
    for column, (measure, motion) in enumerate(shown.items()):
        scale, unit = scales[measure]
        for i, (name, colour) in enumerate(AXES.items()):
            axes[0, column].plot(motion.time, scale * motion.displacement[:, i], color=colour, label=name)
            columns[f"{name} {measure} ({unit})"] = scale * motion.displacement[:, i]
        size = scale * np.linalg.norm(motion.displacement, axis=1)
        axes[1, column].plot(motion.time, size, color=INK)
        columns[f"|dR| {measure} ({unit})"] = size
        axes[0, column].set_ylabel(f"ΔR along x, y, z ({unit})")
        axes[1, column].set_ylabel(f"|ΔR| ({unit})")
        axes[1, column].set_xlabel("time (s)")
        axes[1, column].set_xlim(0, FIRST)
    legend_above(figure, axes[0, 0])
    small, large = (imperfect.largest(motion) for motion in shown.values())
    return Drawing(
        f"fig-3.{number}",
        f"ΔR over time on elastic contacts, η = 0.4485, K = 188208 N/m, C = {damping:g} N s/m",
        f"Left, what the thesis plots: up to {MICRO * small:.2f} µm. Right, where the centre really is: up to "
        f"{MILLI * large:.3f} mm, {large / small:.0f} times as far (E3). The scales differ.",
        figure,
        columns,
    )


def elastic_figures() -> list[Drawing]:
    """Fig 3.11–3.13."""
    return [elastic_figure(number, damping) for number, damping in enumerate(imperfect.DAMPINGS, 11)]
