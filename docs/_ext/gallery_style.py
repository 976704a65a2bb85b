"""How the gallery is sorted, and what its figures look like."""

from __future__ import annotations

from pathlib import Path

# As they are read; one that is not named comes last.
EXAMPLES = (
    "best_elevation",
    "dual_race_error",
    "preload_along_a_motion",
    "slip_and_lift_off",
    "mecanum_or_standard",
    "measured_wheel",
    "ballbot_top_speed",
    "pointing_stand_alignment",
    "sweep_of_layouts",
    "atlas_in_mujoco",
)


def reading_order(file_name: str) -> tuple[int, str]:
    """What examples are sorted by."""
    stem = Path(file_name).stem
    return (EXAMPLES.index(stem) if stem in EXAMPLES else len(EXAMPLES)), stem


def house_figures(gallery_conf, file_name) -> None:
    """Figures of examples look as those of the report."""
    import matplotlib

    from spheredrive.report.figures.style import SETTINGS

    # Powers of ten at an axis are formulas.
    matplotlib.rcParams.update({**SETTINGS, "text.parse_math": True})
