"""Fig 4.8 and 4.9: natural frequencies in the thesis's model and in ours."""

from __future__ import annotations

from matplotlib import colormaps

from spheredrive.studies.reproduce import assumptions
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import KILO, OURS, THESIS, both_ways, drawn, legend_above
from spheredrive.studies.reproduce.results import frequencies

K_RANGE = assumptions.STIFFNESS_RANGE.value
SHOWN = (50e3, 100e3, 188208.0)


@drawn
def figure_4_8() -> Drawing:
    """Over K and k: each contact alone, and the sphere as one body (E8)."""
    figure, axes = both_ways(3.6, 1, "each contact alone [4.9]", "the sphere as one body: lowest and highest", sharey=True)
    columns = {"K (N/m)": K_RANGE}
    colours = colormaps["viridis"].resampled(len(frequencies.MOUNTS) + 1).colors  # type: ignore[attr-defined]
    for mount, colour in zip(frequencies.MOUNTS, colours, strict=False):
        name = "rigid mounts" if mount is None else f"k = {KILO * mount:g} kN/m"
        alone, whole = (frequencies.over_contact(mount, model) for model in ("independent", "coupled"))
        axes[0, 0].plot(KILO * K_RANGE, alone[:, 0], color=colour, label=name)
        axes[0, 1].fill_between(KILO * K_RANGE, *whole.T, color=colour, alpha=0.25, lw=0)
        axes[0, 1].plot(KILO * K_RANGE, whole, color=colour)
        columns[f"alone {name} (Hz)"] = alone[:, 0]
        columns[f"one body lowest {name} (Hz)"], columns[f"one body highest {name} (Hz)"] = whole.T
    for place in axes[0]:
        place.set_xlabel("contact stiffness K (kN/m)")
        place.set_xlim(0, KILO * K_RANGE[-1])
        place.set_ylim(0, None)
    axes[0, 0].set_ylabel("natural frequency (Hz)")
    legend_above(figure, axes[0, 0], 5)
    ratio = frequencies.over_contact(None, "coupled")[-1] / frequencies.over_contact(None, "independent")[-1, 0]
    return Drawing(
        "fig-4.8",
        "Natural frequency over the stiffness of the contacts and of the mounts, K′ = 0",
        f"Both stiffnesses raise it. On rigid mounts the sphere's own modes lie at {ratio[0]:.3f} (twice) and {ratio[1]:.3f} "
        "times the frequency of a contact alone (E8).",
        figure,
        columns,
    )


@drawn
def figure_4_9() -> Drawing:
    """Over K′: with the thesis's sign and with a spring that restores (E1)."""
    K_closure = assumptions.CLOSURE_RANGE.value
    figure, axes = both_ways(3.6, 1, "with the sign of [3.41], −K′", "with a spring that restores, +K′", sharey=True)
    columns = {"K' (N/m)": K_closure}
    for K, colour in zip(SHOWN, (OURS, THESIS, "#009E73"), strict=True):
        for place, sign in zip(axes[0], ("thesis", "restoring"), strict=True):
            values = frequencies.over_closure(K, sign)[:, 0]
            place.plot(KILO * K_closure, values, color=colour, label=f"K = {KILO * K:.0f} kN/m")
            columns[f"K={K:g} {sign} (Hz)"] = values
        whole = frequencies.over_closure(K, "restoring", "coupled")
        axes[0, 1].fill_between(KILO * K_closure, *whole.T, color=colour, alpha=0.18, lw=0, label="one body, lowest to highest")
        columns[f"K={K:g} one body lowest (Hz)"], columns[f"K={K:g} one body highest (Hz)"] = whole.T
    for place in axes[0]:
        place.set_xlabel("closure stiffness K′ (kN/m)")
        place.set_xlim(0, KILO * K_closure[-1])
        place.set_ylim(0, None)
    axes[0, 0].set_ylabel("natural frequency (Hz)")
    legend_above(figure, axes[0, 0])
    changes = [frequencies.over_closure(SHOWN[-1], sign)[-1, 0] / frequencies.over_closure(SHOWN[-1], sign)[0, 0] for sign in
               ("thesis", "restoring")]  # fmt: skip
    return Drawing(
        "fig-4.9",
        "Natural frequency over the stiffness of the kinematic closure, rigid mounts",
        f"From K′ = 0 to {KILO * K_closure[-1]:g} kN/m at K = 188 kN/m the frequency goes to {changes[0]:.3f} of itself with "
        f"the thesis's sign and to {changes[1]:.3f} with one that restores (E1). Bands on the right span the modes of the "
        "sphere as one body (E8).",
        figure,
        columns,
    )
