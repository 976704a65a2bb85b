"""Number of wheels in the ring."""

from __future__ import annotations

import numpy as np

from spheredrive import kinematics
from spheredrive.studies.parameters.common import Study, least_preload, machine, quality, shaken
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.figures.common import GREY, MILLI, OURS, THESIS, drawn, panels

COUNTS = np.arange(3, 13)
# One wheel this much off its speed: what an unequal roller, wear or a controller's error makes of slip.
SPEED_ERROR = 0.01


@drawn
def study() -> Study:
    """ξ, slip of a wheel that is off, preload and vibration over n."""
    designs = [machine(count=int(n)) for n in COUNTS]
    table = np.array([quality(design) for design in designs])
    preload = np.array([least_preload(design) for design in designs])
    moved = np.array([shaken(design).rms_displacement for design in designs])
    slip = np.array([_slip(design) for design in designs])
    figure, axes = panels(5.4, 2, 2, sharex=True)
    axes[0, 0].fill_between(COUNTS, table[:, 0], table[:, 1], color=OURS, alpha=0.2, lw=0)
    axes[0, 0].plot(COUNTS, table[:, 0], "o-", ms=3, color=OURS, label="ξ, from and to")
    axes[0, 0].plot(COUNTS, table[:, 1], "o-", ms=3, color=OURS)
    axes[0, 0].plot(COUNTS, table[:, 2], "s--", ms=3, color=THESIS, label="isotropy")
    axes[0, 0].legend(loc="upper right", ncols=2)
    for place, values in ((axes[0, 1], 100 * slip), (axes[1, 0], preload), (axes[1, 1], MILLI * moved)):
        place.plot(COUNTS, values, "o-", ms=3, color=OURS)
    axes[1, 1].plot(COUNTS, MILLI * moved[0] * np.sqrt(3 / COUNTS), color=GREY, lw=0.8, label="as 1/√n")
    axes[1, 1].legend(loc="upper right")
    names = ("ξ and isotropy (–)", "slip S of one wheel 1 % off (%)", "least preload (N)", "RMS displacement (mm)")
    for place, name in zip(axes.ravel(), names, strict=True):
        place.set_ylabel(name)
        place.set_ylim(0, 1.35 * table[:, 1].max() if place is axes[0, 0] else None)
        place.set_xticks(COUNTS)
    for place in axes[1]:
        place.set_xlabel("number of wheels n (–)")
    columns = {
        "wheels (-)": COUNTS,
        "least xi (-)": table[:, 0],
        "largest xi (-)": table[:, 1],
        "isotropy (-)": table[:, 2],
        "slip of one wheel 1 % off (%)": 100 * slip,
        "least preload (N)": preload,
        "RMS displacement (mm)": MILLI * moved,
    }
    six = int(np.flatnonzero(COUNTS == 6)[0])
    conclusion = (
        f"From 3 to 6 wheels isotropy stays {table[0, 2]:.2f}, ξ falls from {table[0, 0]:.2f} … {table[0, 1]:.2f} to "
        f"{table[six, 0]:.2f} … {table[six, 1]:.2f} (as 1/√n, for |ω| counts every wheel), the preload goes from "
        f"{preload[0]:.0f} to {preload[six]:.0f} N and the RMS vibration from {MILLI * moved[0]:.3f} to "
        f"{MILLI * moved[six]:.3f} mm; but a wheel that is 1 % off its speed makes S = {100 * slip[six]:.2f} % of slip where "
        "three wheels make none. Take three wheels unless vibration or load decides, and then drive the others as slaves."
    )
    caption = (
        "Rings at θ = 40°, standard wheels. Upper right, overall slip while one wheel turns 1 % too fast; normal forces of "
        "more than three wheels are shared by stiffness."
    )
    return Study(Drawing("study-wheel-count", "Number of wheels", caption, figure, columns), conclusion)


def _slip(design) -> float:
    speeds = kinematics.inverse(design, (0.1, 0.2, 0.3))
    speeds[0] *= 1 + SPEED_ERROR
    return float(kinematics.slip(design, speeds).overall)
