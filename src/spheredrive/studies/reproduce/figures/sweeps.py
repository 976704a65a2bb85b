"""Fig 4.10–4.15: largest displacement over the stiffnesses of contact, mount and closure."""

from __future__ import annotations

from spheredrive.report.figures.log_axis import label_powers
from spheredrive.studies.reproduce import assumptions
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import (
    DASHED,
    GREY,
    INK,
    KILO,
    KIND,
    MICRO,
    MILLI,
    both_ways,
    drawn,
    legend_above,
)
from spheredrive.studies.reproduce.results import sweeps
from spheredrive.studies.reproduce.results.sweeps import FAST, SLOW, Sweep

DAMPED = assumptions.DAMPING.value[1]
LEFT = "as the thesis measures it (half sine, y − h)"
RIGHT = "the centre itself (exact, one body)"
KINDS = {"standard": "standard", "Mecanum": "mecanum"}


def _speeds(speeds) -> str:
    return "(" + ", ".join(f"{x:g}" for x in speeds) + ") rad/s"


@drawn
def contact_figure(number: int) -> Drawing:
    """Fig 4.10 and 4.11: over K, with κ below."""
    speeds, printed = {10: (SLOW, (0.04, 0.11)), 11: (FAST, (0.06, 0.12))}[number]
    figure, axes = both_ways(5.0, 2, LEFT, RIGHT, sharex=True, height_ratios=(1.2, 1.0))
    columns = {}
    for column, thesis in enumerate((True, False)):
        damped, bare = (sweeps.over_contact(speeds, C, thesis) for C in (DAMPED, 0.0))
        top, bottom = axes[:, column]
        scale, unit = (MICRO, "µm") if thesis else (MILLI, "mm")
        columns.setdefault("K (N/m)", damped.stiffness)
        for kind, field in KINDS.items():
            top.semilogy(
                KILO * bare.stiffness, scale * getattr(bare, field), color=KIND[kind], lw=0.7, ls=DASHED, label=f"{kind}, C = 0"
            )
            top.semilogy(
                KILO * damped.stiffness, scale * getattr(damped, field), color=KIND[kind], label=f"{kind}, C = {DAMPED:g} N s/m"
            )
            rigid = dict(zip(KINDS, sweeps.rigid(speeds, thesis), strict=True))[kind]
            top.plot(0, scale * rigid, "o", color=KIND[kind], ms=4, clip_on=False, zorder=4, label=f"{kind}, rigid (“K = 0”)")
            for C, sweep in ((DAMPED, damped), (0.0, bare)):
                columns[f"{kind} {'thesis' if thesis else 'centre'} C={C:g} ({unit})"] = scale * getattr(sweep, field)
        bottom.axhspan(*printed, color=GREY, alpha=0.2, lw=0)
        bottom.plot(KILO * bare.stiffness, bare.ratio, color=INK, lw=0.7, ls=DASHED)
        bottom.plot(KILO * damped.stiffness, damped.ratio, color=INK)
        bottom.set_ylim(0, 0.3)
        bottom.set_xlabel("contact stiffness K (kN/m)")
        label_powers(top.yaxis)
        top.set_ylabel(f"largest |ΔR| ({unit})")
        bottom.set_xlim(0, KILO * damped.stiffness[-1])
    axes[1, 0].set_ylabel("κ, Mecanum over standard (–)")
    axes[1, 1].set_ylabel("κ (–)")
    legend_above(figure, axes[0, 0], 3)
    thesis, true = sweeps.over_contact(speeds, DAMPED, True).ratio, sweeps.over_contact(speeds, DAMPED, False).ratio
    return Drawing(
        f"fig-4.{number}",
        f"Largest displacement of the centre over K, ω = {_speeds(speeds)}",
        f"Grey, the range of κ that the thesis prints, {printed[0]} … {printed[1]}. With C = {DAMPED:g} N s/m its measure "
        f"gives {thesis.min():.3f} … {thesis.max():.3f}, the centre itself {true.min():.3f} … {true.max():.3f}. Without "
        "damping (dashed) the peaks are resonances, gaps those hit exactly; κ beyond 0.3 is cut off. Points on the axis are "
        "the rigid machine.",
        figure,
        columns,
    )


@drawn
def figure_4_12() -> Drawing:
    """Over k at K = 190 kN/m."""
    found = [sweeps.over_mount(190e3, SLOW, C, thesis) for thesis in (True, False) for C in (DAMPED, 0.0)]
    thesis, true = found[0], found[2]
    drawing = _stiffness_figure(found, "mount stiffness k (kN/m)", "k (N/m)", logarithmic=True)
    return Drawing(
        "fig-4.12",
        f"Largest displacement of the centre over the mount stiffness, K = 190 kN/m, ω = {_speeds(SLOW)}",
        f"Standard wheel, C = {DAMPED:g} N s/m: stiffening the mounts takes the thesis's measure from "
        f"{MICRO * thesis.standard[0]:.0f} down to {MICRO * thesis.standard[-1]:.1f} µm and the centre from "
        f"{MILLI * true.standard[0]:.2f} to {MILLI * true.standard[-1]:.2f} mm, where the wheels' shape is all that is left.",
        *drawing,
    )


def _stiffness_figure(found: list[Sweep], label: str, key: str, logarithmic: bool = False):
    """Two panels: ``found`` holds the thesis's measure and the centre, each with and without damping."""
    figure, axes = both_ways(3.5, 1, LEFT, RIGHT, sharex=True)
    columns = {key: found[0].stiffness}
    for column, name in enumerate(("thesis", "centre")):
        place = axes[0, column]
        scale, unit = (MICRO, "µm") if name == "thesis" else (MILLI, "mm")
        damped, bare = found[2 * column], found[2 * column + 1]
        for kind, field in KINDS.items():
            x = KILO * damped.stiffness
            place.semilogy(x, scale * getattr(bare, field), color=KIND[kind], lw=0.7, ls=DASHED, label=f"{kind}, C = 0")
            place.semilogy(x, scale * getattr(damped, field), color=KIND[kind], label=f"{kind}, C = {DAMPED:g} N s/m")
            columns[f"{kind} {name} C={DAMPED:g} ({unit})"] = scale * getattr(damped, field)
            columns[f"{kind} {name} C=0 ({unit})"] = scale * getattr(bare, field)
        if logarithmic:
            place.set_xscale("log")
            label_powers(place.xaxis)
        label_powers(place.yaxis)
        place.set_xlim(x[0], x[-1])
        place.set_xlabel(label)
        place.set_ylabel(f"largest |ΔR| ({unit})")
    legend_above(figure, axes[0, 0], 4)
    return figure, columns


@drawn
def rigid_closure_figure(number: int) -> Drawing:
    """Fig 4.13 and 4.14: over K′ with rigid contacts: each contact alone, and one body."""
    speeds = {13: FAST, 14: SLOW}[number]
    figure, axes = both_ways(
        3.2, 1, "each contact alone, summed (half sine)", "the sphere as one body (exact)", sharex=True, sharey=True
    )
    columns = {}
    for place, thesis in zip(axes[0], (True, False), strict=True):
        sweep = sweeps.over_closure(None, speeds, 0.0, thesis)
        columns.setdefault("K' (N/m)", sweep.stiffness)
        for kind, field in KINDS.items():
            values = MILLI * getattr(sweep, field)
            place.plot(KILO * sweep.stiffness, values, color=KIND[kind], label=kind)
            columns[f"{kind} {'alone' if thesis else 'one body'} (mm)"] = values
        place.set_xlabel("closure stiffness K′ (kN/m)")
        place.set_xlim(0, KILO * sweep.stiffness[-1])
        place.set_ylim(0, None)
    axes[0, 0].set_ylabel("largest |ΔR| (mm)")
    legend_above(figure, axes[0, 0])
    alone, whole = (sweeps.over_closure(None, speeds, 0.0, thesis).standard[0] for thesis in (True, False))
    return Drawing(
        f"fig-4.{number}",
        f"Largest displacement of the centre over the closure stiffness, rigid contacts, ω = {_speeds(speeds)}",
        "Rigid contacts settle where the centre is, whatever pushes on it. Summing contacts that stand alone gives "
        f"{MILLI * alone:.3f} mm for the standard wheel, the sphere as one body {MILLI * whole:.3f} mm (E7, E8).",
        figure,
        columns,
    )


@drawn
def figure_4_15() -> Drawing:
    """Over K′ with elastic contacts, both printed stiffnesses."""
    figure, axes = both_ways(3.6, 1, "as the thesis measures it, with −K′", RIGHT + ", +K′", sharex=True)
    columns = {}
    for column, thesis in enumerate((True, False)):
        place = axes[0, column]
        scale, unit = (MICRO, "µm") if thesis else (MILLI, "mm")
        for K, style in ((170e3, "-"), (1.7e6, DASHED)):
            sweep = sweeps.over_closure(K, SLOW, DAMPED, thesis)
            columns.setdefault("K' (N/m)", sweep.stiffness)
            for kind, field in KINDS.items():
                values = scale * getattr(sweep, field)
                place.plot(KILO * sweep.stiffness, values, color=KIND[kind], ls=style, label=f"{kind}, K = {KILO * K:g} kN/m")
                columns[f"{kind} K={K:g} {'thesis' if thesis else 'centre'} ({unit})"] = values
        place.set_xlabel("closure stiffness K′ (kN/m)")
        place.set_ylabel(f"largest |ΔR| ({unit})")
        place.set_xlim(0, KILO * sweep.stiffness[-1])
        place.set_ylim(0, None)
    axes[0, 0].set_ylim(0.01, 1000)
    axes[0, 0].set_yscale("log")
    label_powers(axes[0, 0].yaxis)
    legend_above(figure, axes[0, 0], 2)
    true = [sweeps.over_closure(K, SLOW, DAMPED, False).standard for K in (170e3, 1.7e6)]
    return Drawing(
        "fig-4.15",
        f"Largest displacement of the centre over the closure stiffness, elastic contacts, ω = {_speeds(SLOW)}",
        f"C = {DAMPED:g} N s/m. The caption prints K = 1 700 000 N/m, the text 170 000: both are drawn. Over the whole range "
        f"of K′ the centre's displacement falls to {true[0][-1] / true[0][0]:.3f} and {true[1][-1] / true[1][0]:.3f} of "
        "itself.",
        figure,
        columns,
    )
