"""The page: all rows, figures, studies, assumptions and errata as one HTML text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from typing import NamedTuple

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

import spheredrive
from spheredrive.scene.page import scene_frame, scene_html, script_hash
from spheredrive.simulation.simulate import simulate
from spheredrive.studies.reproduce.assumptions import ASSUMPTIONS
from spheredrive.studies.reproduce.claims import chapter
from spheredrive.studies.reproduce.errata import ERRATA, number
from spheredrive.studies.reproduce.machines import shipped, table_2_1
from spheredrive.studies.reproduce.table import Row

CHAPTERS = {
    2: "Chapter 2: kinematics",
    3: "Chapter 3: dynamics and vibration",
    4: "Chapter 4: standard and Mecanum wheels",
    5: "Chapter 5: conclusions",
}


class Shown(NamedTuple):
    """A figure on the page: key, title, caption, SVG text and, of a study, its conclusion."""

    key: str
    title: str
    caption: str
    svg: str
    conclusion: str = ""

    @property
    def markup(self) -> Markup:
        """The SVG as it stands in the page."""
        return Markup(self.svg)

    @property
    def name(self) -> str:
        """ "Figure 4.10", or nothing for a study."""
        return f"Figure {self.key.removeprefix('fig-')}" if self.key.startswith("fig-") else ""


class Chapter(NamedTuple):
    """A chapter's title, rows and figures."""

    title: str
    rows: list[Row]
    figures: list[Shown]
    scene: Markup = Markup()


def page(rows: Sequence[Row], figures: Sequence[Shown], studies: Sequence[Shown]) -> str:
    """The whole page."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(
        (files("spheredrive.studies.reproduce") / "reproduce.html.j2").read_text(encoding="utf-8")
    )
    chapters = [
        Chapter(
            title,
            [row for row in rows if chapter(row) == n],
            [figure for figure in figures if figure.key.startswith(f"fig-{n}.")],
            _atlas_in_motion() if n == 2 else Markup(),
        )
        for n, title in CHAPTERS.items()
    ]
    drawn = {figure.key for figure in figures}
    return template.render(
        chapters=chapters,
        studies=studies,
        assumptions=ASSUMPTIONS,
        errata=[(number(key), text, [row.id for row in rows if row.erratum == key]) for key, text in ERRATA.items()],
        agree=sum(row.agrees for row in rows),
        differ=sum(not row.agrees for row in rows),
        open=sum(bool(row.open) for row in rows),
        figure_of=lambda row: next((key for key in sorted(drawn, key=len, reverse=True) if _belongs(row.id, key)), ""),
        script_hash=script_hash(),
        version=spheredrive.__version__,
    )


def _atlas_in_motion() -> Markup:
    """The dual-race Atlas along Table 2.1, races changing as it turns."""
    design = shipped("atlas-dual-race")
    run = simulate(design, replace(table_2_1(), sample_rate=50.0))
    return Markup(scene_frame(scene_html(design, run), "The dual-race Atlas along Table 2.1"))


def _belongs(row: str, figure: str) -> bool:
    return row == figure or row.startswith(f"{figure}-")
