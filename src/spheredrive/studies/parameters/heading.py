"""Heading of the wheels: the drive direction turned from east towards north."""

from __future__ import annotations

import numpy as np

from spheredrive.studies.parameters.angles import CAPTION, best, four_panels, measured
from spheredrive.studies.parameters.common import Study, machine
from spheredrive.studies.reproduce import machines
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import drawn

CHI_DEG = np.arange(-90.0, 91.0, 5.0)


def variant(kind: str, chi_deg: float):
    """The demonstrator with all wheels turned by χ on their places."""
    wheel = machines.standard_wheel("exact") if kind == "standard" else machines.mecanum_wheel("exact")
    return machine(wheel, heading_deg=chi_deg)


@drawn
def study() -> Study:
    """ξ, isotropy, preload and vibration over χ."""
    found = measured(CHI_DEG, variant)
    figure, axes, columns = four_panels(CHI_DEG, found, "heading χ of the drive direction")
    axes[1, 0].set_ylim(0, 300)
    turned = {kind: (best(CHI_DEG, v["isotropy"]), float(np.nanmax(v["isotropy"]))) for kind, v in found.items()}
    worst = {kind: best(CHI_DEG, -v["isotropy"]) for kind, v in found.items()}
    shift = int(45 / (CHI_DEG[1] - CHI_DEG[0]))
    moved = np.abs(found["Mecanum"]["isotropy"][shift:] - found["standard"]["isotropy"][:-shift]).max()
    alike = "exactly " if moved < 1e-9 else ""
    east = {kind: float(v["isotropy"][CHI_DEG == 0][0]) for kind, v in found.items()}
    conclusion = (
        f"At θ = 40° standard wheels are most isotropic at χ = ±{abs(turned['standard'][0]):.0f}° "
        f"({turned['standard'][1]:.2f}, at 0° {east['standard']:.2f}), Mecanum wheels at χ = {_angle(turned['Mecanum'][0])} "
        f"({turned['Mecanum'][1]:.2f}, at 0° {east['Mecanum']:.2f}); the worst headings are {_angle(worst['standard'])} and "
        f"{_angle(worst['Mecanum'])}. Rollers at 45° act {alike}as wheels headed 45° further round, but slower: Mecanum "
        "wheels may keep χ = 0, standard wheels gain from heading halfway north where isotropy counts, and must never head "
        "north altogether, where nothing drives the sphere about z."
    )
    return Study(Drawing("study-heading", "Heading of the wheels", CAPTION, figure, columns), conclusion)


def _angle(degrees: float) -> str:
    return f"{degrees:+.0f}°".replace("-", "−")
