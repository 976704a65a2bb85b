"""Pieces of the page: figures with their captions, sentences, tables."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from markupsafe import Markup
from matplotlib.figure import Figure

from spheredrive.report import tables
from spheredrive.report.figures.style import svg_text


class Part(NamedTuple):
    """A titled piece of the page: SVG figures and their caption, or a sentence in their place; a table after them."""

    key: str
    title: str
    caption: str
    figures: tuple[Markup, ...] = ()
    table: tables.Table | None = None


def readable(content):
    """Text without the control characters and lone surrogates that no page can hold; everything else as it is."""
    if isinstance(content, str) and not isinstance(content, Markup):
        return re.sub("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]", "\N{REPLACEMENT CHARACTER}", content)
    return content


def drawn(key: str, title: str, caption: str, *draw: Callable[[], Figure], table: tables.Table | None = None) -> Part:
    """The part whose figures the functions ``draw``."""
    svg = tuple(Markup(svg_text(one(), f"{key}-{i}", readable(f"{title}. {caption}"))) for i, one in enumerate(draw, 1))
    return Part(key, title, caption, svg, table)
