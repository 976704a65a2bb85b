"""Logarithmic axes labelled in plain letters: figures hold no formulas."""

from __future__ import annotations

import math

from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power_text(value: float) -> str:
    """A power of ten as a reader knows it: plain from a hundredth to a thousand, else 10 with its raised power."""
    power = round(math.log10(value))
    return f"{10.0**power:g}" if -2 <= power <= 3 else "10" + str(power).translate(_RAISED)


def label_powers(axis: Axis, most: int = 6, minor: bool = True) -> None:
    """Ticks of a logarithmic ``axis`` at powers of ten, ``most`` at most, with unlabelled ones between where ``minor``."""
    axis.set_major_locator(LogLocator(numticks=most))
    axis.set_major_formatter(FuncFormatter(lambda value, _: power_text(value)))
    axis.set_minor_locator(LogLocator(subs=tuple(range(2, 10)), numticks=most) if minor else NullLocator())
    axis.set_minor_formatter(NullFormatter())
