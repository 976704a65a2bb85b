"""A comparison as an HTML page that needs nothing beside it."""

from __future__ import annotations

from importlib.resources import files

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

import spheredrive
from spheredrive.report.figures.style import svg_text
from spheredrive.report.parts import readable
from spheredrive.studies.compare.comparison import Comparison
from spheredrive.studies.compare.figures import kinematics_figure, outline_figure, outlines, vibration_figure
from spheredrive.studies.compare.text import COLUMNS, UNKNOWN, basis_sentence, cells, preload_sentence, remarks_of


def comparison_page(c: Comparison) -> str:
    """The page as text: table, figures and remarks. Equal comparisons give equal text."""
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, finalize=readable
    )
    template = environment.from_string((files("spheredrive.studies.compare") / "compare.html.j2").read_text(encoding="utf-8"))
    drawn = [
        ("kinematics", "Transmission and preload", f"ξ about the slowest and the fastest axis. {preload_sentence(c)}",
         kinematics_figure),
        ("vibration", "Vibration", "Motion of the sphere's centre. Dotted in the last panel: where discomfort begins, 0.315 "
         "m/s², and where it is extreme, 2 m/s² (ISO 2631-1).", vibration_figure),
    ]  # fmt: skip
    if outlines(c):
        caption = "Height of each wheel's outline over the way it rolls, one pattern from its highest place."
        drawn.append(("outlines", "Outlines of the wheels", caption, outline_figure))
    figures = [
        (key, title, text, Markup(svg_text(draw(c), key, readable(f"{title}. {text}")))) for key, title, text, draw in drawn
    ]
    return template.render(
        title=f"{c.first.name}: comparison of {len(c.rows)} machines",
        columns=[name for name, _ in COLUMNS],
        units=[unit for _, unit in COLUMNS],
        rows=[(row.works, ["–" if cell == UNKNOWN else cell for cell in cells(row)]) for row in c.rows],
        basis=basis_sentence(c).replace(" -", " −"),
        preload=preload_sentence(c),
        figures=figures,
        remarks=[remark for row in c.rows for remark in remarks_of(row)],
        version=spheredrive.__version__,
    )
