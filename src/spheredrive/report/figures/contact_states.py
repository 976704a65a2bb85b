"""Contact states: which races touch together, what stays free of slip, and how even each state is."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from spheredrive.checking import Check
from spheredrive.kinematics import ContactState
from spheredrive.report.figures.style import GREY, INK, LIGHT, styled

# More states than SHOWN cannot be told apart on a page: the worst WORST stand for them.
SHOWN = 64
WORST = 32
# Cells this many or fewer across have room for words.
LETTERED = 36
# A smaller spread of isotropy is rounding.
ALIKE = 1e-9
CHOICES = ("#9ecae9", "#f6c28b", "#a7d8c5", "#e6c3d9")
FREE = ("#b3261e", "#e07b39", "#f2c879", "#d5e8d4")


def shown_states(result: Check) -> list[tuple[int, ContactState]]:
    """The states to draw with their numbers from 1: all in order, or the worst first where there are too many."""
    numbered = list(enumerate(result.contact_states, 1))
    if len(numbered) <= SHOWN:
        return numbered
    return sorted(numbered, key=lambda entry: (entry[1].rotation_dof, entry[1].isotropy, entry[0]))[:WORST]


@styled
def contact_states_figure(result: Check) -> Figure:
    """Matrix of active races (columns: states, rows: wheels that alternate), slip-free rotations and isotropy below."""
    states = shown_states(result)
    # A wheel that shows the same races in every state says nothing.
    wheels = [i for i in range(len(states[0][1].races)) if len({s.races[i] for s in result.contact_states}) > 1]
    rows = len(wheels)
    figure = Figure(figsize=(7.4, 2.35 + 0.24 * rows), layout="constrained")
    matrix, bars = figure.subplots(2, 1, sharex=True, height_ratios=[rows + 1.4, 6.0])
    _draw_matrix(matrix, result, states, wheels)
    _draw_isotropy(bars, result, states)
    return figure


def _draw_matrix(axes: Axes, result: Check, states, wheels: list[int]) -> None:
    lettered = len(states) <= LETTERED
    choices = {i: sorted({s.races[i] for s in result.contact_states}) for i in wheels}
    for column, (_, state) in enumerate(states):
        for row, wheel in enumerate(wheels):
            active = state.races[wheel]
            colour = CHOICES[choices[wheel].index(active) % len(CHOICES)]
            _cell(axes, column, row, colour, "+".join(map(str, active)) if lettered else "")
        _cell(axes, column, len(wheels) + 0.25, FREE[state.rotation_dof], str(state.rotation_dof) if lettered else "")
    ticks = [*range(len(wheels)), len(wheels) + 0.25]
    axes.set_yticks(ticks, [*(f"wheel {i + 1}" for i in wheels), "slip-free rotations"])
    axes.set(xlim=(-0.5, len(states) - 0.5), ylim=(len(wheels) + 0.8, -0.55))
    axes.tick_params(length=0)
    axes.tick_params(axis="x", labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_title("Active races of each wheel, and how many of the three rotations are free of slip")


def _cell(axes: Axes, column: float, row: float, colour: str, text: str) -> None:
    axes.add_patch(Rectangle((column - 0.46, row - 0.44), 0.92, 0.88, fc=colour, ec="none"))
    if text:
        ink = "white" if colour == FREE[0] else INK
        axes.text(column, row, text, ha="center", va="center_baseline", fontsize=8, color=ink)


def _draw_isotropy(axes: Axes, result: Check, states) -> None:
    values = np.array([state.isotropy for _, state in states])
    axes.bar(range(len(states)), values, width=0.7, color=LIGHT)
    axes.axhline(result.isotropy, color=INK, lw=0.9, ls="--")
    if len(states) <= 16:
        for column, value in enumerate(values):
            # A number stands in its bar where it fits, else above it.
            place = value / 2 if value > 0.25 else value + 0.1
            axes.text(column, place, f"{value:.3f}", ha="center", va="center", fontsize=7.5, color=INK)
    axes.set_ylim(0, 1.12)
    axes.set_yticks([0, 0.5, 1])
    axes.set_ylabel("isotropy")
    axes.set_title(f"Isotropy of each state; dashed: nominal contacts, {result.isotropy:.3f}", color=GREY, fontsize=8.5)
    step = 1 if len(states) <= LETTERED else 4
    axes.set_xticks(range(0, len(states), step), [str(number) for number, _ in states[::step]])
    axes.set_xlabel("contact state")


def contact_states_sentence(result: Check) -> str | None:
    """What is said instead of the figure where there is nothing to compare, or too much to list; else None."""
    if result.contact_state_count == 1:
        return "Every wheel keeps the same race in contact: there is one contact state, and the numbers above are its own."
    if len(result.contact_states) < result.contact_state_count:
        worst = result.contact_states[0]
        return (
            f"There are {result.contact_state_count} contact states, too many to list. The worst has isotropy "
            f"{worst.isotropy:.3f} (nominal contacts: {result.isotropy:.3f}) and {worst.rotation_dof} of 3 rotations slip-free."
        )
    return None


def contact_states_caption(result: Check) -> str:
    """What the figure shows, in numbers."""
    states = result.contact_states
    free = sum(state.rotation_dof == 3 for state in states)
    worst_number, worst = min(enumerate(states, 1), key=lambda entry: entry[1].isotropy)
    best = max(state.isotropy for state in states)
    text = f"In {free} of {len(states)} contact states every rotation is free of slip. "
    if best - worst.isotropy <= ALIKE:
        text += f"Isotropy is {best:.3f} in all of them; nominal contacts have {result.isotropy:.3f}."
    else:
        text += (
            f"Isotropy runs from {worst.isotropy:.3f} (state {worst_number}, races {worst.races_text}) to {best:.3f}; nominal "
            f"contacts have {result.isotropy:.3f}."
        )
    shown = len(shown_states(result))
    if shown < len(states):
        text += f" The worst {shown} of {len(states)} states are shown, worst first."
    return text
