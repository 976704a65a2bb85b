"""How figures look, and how a figure becomes SVG text that can stand inside the page. Every colour is named here."""

from __future__ import annotations

import functools
import io
import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from xml.etree import ElementTree

import matplotlib
from matplotlib.figure import Figure

# Okabe and Ito's colours, which people with any colour vision can tell apart, the ones that show on white first.
WHEELS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
AXES = {"x": "#D55E00", "y": "#009E73", "z": "#0072B2"}
INK, GREY, LIGHT, PAPER = "#222222", "#6b6b6b", "#cfcfca", "#f5f4f0"
SCALE = "cividis"

SETTINGS: dict[Any, Any] = {
    "font.family": ["sans-serif"],
    # Laid out with the first, which is wide: text in a reader's own font then fits as well.
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial", "sans-serif"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "lines.linewidth": 1.0,
    # Text is text: no formula in a wheel's name, and letters instead of outlines of letters.
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "spheredrive",
}

SVG = "{http://www.w3.org/2000/svg}"
XLINK = "{http://www.w3.org/1999/xlink}href"
_DECIMALS = re.compile(r"-?[0-9]+\.[0-9]{3,}")
_REPEATS = re.compile(r"([ML] (\S+ \S+))(?: L \2)+(?= |$)")


@contextmanager
def house_style() -> Iterator[None]:
    """matplotlib's defaults with ours on top, whatever the user's own settings are."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(SETTINGS)
        yield


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """A figure function that draws in the house style."""

    @functools.wraps(draw)
    def drawn(*args, **kwargs) -> Figure:
        with house_style():
            return draw(*args, **kwargs)

    return drawn


def wheel_colour(wheel: int) -> str:
    """Colour of a wheel, by its index from 0: the same in every figure."""
    return WHEELS[wheel % len(WHEELS)]


def wheel_dashes(wheel: int) -> str:
    """Line style that tells wheels apart whose colours repeat."""
    return ("-", "--", ":", "-.")[wheel // len(WHEELS) % 4]


def svg_text(figure: Figure, key: str, label: str) -> str:
    """``figure`` as an SVG element for an HTML page.

    ``key`` begins the names of its parts, so that several figures on a page do not share any; ``label`` is what a screen
    reader says instead of the figure.
    """
    raw = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with house_style(), warnings.catch_warnings():
        # A sign that the layout font lacks is still written as text, and the reader's font may have it.
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        _settle(figure)
        figure.savefig(raw, format="svg", metadata=nothing)
    root = ElementTree.fromstring(raw.getvalue())
    _strip(root, key)
    # Without a fixed size the figure takes the width of its place; the viewBox keeps its shape.
    root.attrib.pop("width", None)
    root.attrib.pop("height", None)
    root.set("role", "img")
    root.set("aria-label", label)
    return ElementTree.tostring(root, encoding="unicode")


def _settle(figure: Figure) -> None:
    """Lay the figure out for good, on a grid finer than can be seen: the solver leaves the last digits to chance."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    figure.set_layout_engine("none")
    for axes in figure.axes:
        left, bottom, width, height = (round(float(bound), 4) for bound in axes.get_position(original=True).bounds)
        axes.set_position((left, bottom, width, height))


def _strip(root: ElementTree.Element, key: str) -> None:
    """Make names the figure's own, and drop what HTML does not need: namespaces and the sheet that would style the page."""
    for element in root.iter():
        for child in [c for c in element if c.tag in (SVG + "metadata", SVG + "style")]:
            element.remove(child)
        element.tag = element.tag.removeprefix(SVG)
        if "id" in element.attrib:
            element.set("id", f"{key}-{element.get('id')}")
        if XLINK in element.attrib:
            element.set("href", element.attrib.pop(XLINK).replace("#", f"#{key}-", 1))
        if "d" in element.attrib:
            element.set("d", _short_path(element.get("d", "")))
        for name in ("clip-path", "style"):
            value = element.get(name)
            if value and "url(#" in value:
                element.set(name, value.replace("url(#", f"url(#{key}-"))


def _short_path(path: str) -> str:
    """A path's text with coordinates to a hundredth of a point, finer than any screen or printer, and no point twice."""
    rounded = _DECIMALS.sub(lambda found: f"{float(found[0]):.2f}", path)
    return _REPEATS.sub(r"\1", " ".join(rounded.split()))
