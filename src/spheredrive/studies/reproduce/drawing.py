"""A figure with the numbers behind it: one SVG and one CSV."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from spheredrive.report.figures.style import svg_text


class Drawing(NamedTuple):
    """One figure of the page.

    key       "fig-2.7" or "study-friction": the name of its files
    title     what it shows
    caption   what to see in it, in numbers
    figure    the drawing
    columns   numbers behind it: name with unit → values; columns may differ in length
    """

    key: str
    title: str
    caption: str
    figure: Figure
    columns: Mapping[str, np.ndarray]

    def svg(self) -> str:
        """The figure as an SVG element for the page."""
        return svg_text(self.figure, self.key, f"{self.title}. {self.caption}")

    def csv(self) -> str:
        """The columns as CSV with a header; nine digits, short columns left blank at the end."""
        columns = [np.atleast_1d(np.asarray(values)) for values in self.columns.values()]
        text = io.StringIO()
        text.write(",".join(self.columns) + "\n")
        for i in range(max(map(len, columns))):
            text.write(",".join(_cell(column[i]) if i < len(column) else "" for column in columns) + "\n")
        return text.getvalue()


def _cell(value) -> str:
    if isinstance(value, (float, np.floating)):
        # A negative zero and rounding noise below it are the same number.
        return f"{value + 0.0:.9g}"
    return str(value)


def standalone(svg: str) -> str:
    """An SVG element of the page as a file of its own: with its namespace and a size."""
    width, height = re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups()  # type: ignore[union-attr]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}pt" height="{height}pt" stroke-linejoin="round"'
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + svg.replace("<svg", head, 1) + "\n"
