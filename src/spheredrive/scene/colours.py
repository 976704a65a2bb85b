"""Colours of the scene: those of the report's figures, so that a wheel looks alike everywhere."""

from __future__ import annotations

# Okabe and Ito's, as in the report.
WHEELS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
INK, GREY, LIGHT, PAPER = "#222222", "#6b6b6b", "#cfcfca", "#f5f4f0"
# The sphere's octants in turn, and the mark whose path shows how it turns.
SPHERE = ("#e9e7e0", "#c9c7bf")
MARK = "#7a3fa0"
RUBBER = "#3c3f44"
STAGE = "#9a9a94"
WORKS, WARNING, FAILURE = "#00704f", "#8a5300", "#b3261e"


def wheel_colour(wheel: int) -> str:
    """Colour of a wheel, by its index from 0."""
    return WHEELS[wheel % len(WHEELS)]


def rgb(colour: str) -> tuple[int, int, int]:
    """``"#rrggbb"`` as three numbers from 0 to 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def mixed(colour: str, other: str, share: float) -> str:
    """``colour`` with ``share`` (0 to 1) of ``other``."""
    parts = (round(a + (b - a) * share) for a, b in zip(rgb(colour), rgb(other), strict=True))
    return "#" + "".join(f"{part:02x}" for part in parts)
