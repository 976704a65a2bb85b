"""The report: a design, its kinematic answer and its figures as one HTML page that needs nothing beside it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

__all__ = ["render_report", "write_report"]


def render_report(design: Design, motion: Motion | None = None, speeds=None) -> str:
    """The report on ``design``, and on what ``motion`` makes it do where one is given, as HTML text.

    Its section on vibration is for constant wheel ``speeds`` (n,), rad/s, or for the mean speeds of the motion.

    Equal designs and motions give equal text: no clock, no random names. Raises ``DesignError`` for a motion that is for
    another number of wheels; what a design cannot do is said in the report.
    """
    # Plotting and templates cost a second to import: only who asks for a report pays.
    from spheredrive.report.page import page

    return page(design, motion, speeds).html


def write_report(design: Design, path: str | Path, motion: Motion | None = None, speeds=None) -> Path:
    """Write ``render_report`` to ``path``, whole or not at all, and return the path. Raises as ``render_report``."""
    from spheredrive.io.files import write_whole

    html = render_report(design, motion, speeds)
    write_whole(Path(path), html)
    return Path(path)
