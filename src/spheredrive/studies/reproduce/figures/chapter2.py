"""Fig 2.7: the error of the single-race Jacobian along Table 2.1."""

from __future__ import annotations

import numpy as np

from spheredrive.report.figures.race_error import race_error_caption, race_error_figure
from spheredrive.studies.reproduce.drawing import Drawing
from spheredrive.studies.reproduce.results import race_error


def figure_2_7() -> Drawing:
    """Wheel speeds, error of the direction and of the magnitude."""
    run = race_error.run()
    return Drawing(
        "fig-2.7",
        "Errors in angle and magnitude of the sphere's angular velocity",
        race_error_caption(run),
        race_error_figure(run),
        {
            "time (s)": run.time,
            **{f"wheel speed {i + 1} (rad/s)": run.wheel_speed[:, i] for i in range(3)},
            "error of the angle (deg)": np.degrees(run.error_angle),
            "error of the magnitude (%)": 100 * run.error_magnitude,
        },
    )
