"""The machine from two sides: sphere, wheels as discs at true scale, contact points and drive directions."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

from spheredrive.design import Design
from spheredrive.report.figures.projection import FROM_ABOVE, View, circle, disc_outline, near_face
from spheredrive.report.figures.style import AXES, GREY, INK, LIGHT, PAPER, styled, wheel_colour
from spheredrive.summary import degrees, millimetres

# Numbers and arrows of more wheels than NUMBERED could not be told apart, nor the discs of more than DRAWN.
NUMBERED = 24
DRAWN = 200
# Arrows are this share of the sphere's radius; where less than a tenth of one is seen it points at or from the viewer.
ARROW = 0.42
HEAD_ON = 0.1


@dataclass(frozen=True)
class DrawnWheel:
    """A wheel where it stands, lengths in mm: its discs (centre, width) and the unit vectors of its plane."""

    index: int
    label: str
    radius: float
    contact_direction: np.ndarray
    drive_direction: np.ndarray
    centre: np.ndarray
    discs: tuple[tuple[np.ndarray, float], ...]
    contacts: np.ndarray
    points: int = 72

    def outline(self, view: View, centre, width: float) -> np.ndarray:
        """Outline on paper of one of the discs, (k, 2)."""
        return disc_outline(view, centre, self.contact_direction, self.drive_direction, self.radius, width, self.points)

    def face(self, view: View, centre, width: float, share: float) -> np.ndarray:
        """The circle of ``share`` of the wheel's radius on the face that is seen, on paper, (k, 2)."""
        axes = self.contact_direction, self.drive_direction
        return near_face(view, centre, *axes, share * self.radius, width, self.points)

    def in_front(self, view: View) -> bool:
        """Whether the viewer sees the wheel before the sphere: the plane that touches at R̂ has them on either side."""
        return bool(view.depth(self.contact_direction) >= -1e-9)


def drawn_wheels(design: Design) -> list[DrawnWheel]:
    """Every wheel of ``design`` as it is drawn; the second wheel of a split pair is one of its own, marked b."""
    return [
        wheel
        for i in range(min(design.wheel_count, DRAWN))
        for antipodal in (False, True)
        if (wheel := _drawn_wheel(design, i, antipodal)) is not None
    ]


def _drawn_wheel(design: Design, i: int, antipodal: bool) -> DrawnWheel | None:
    placement, R = design.placements[i], design.sphere.radius
    races = [race for race in design.races(placement.wheel) if race.antipodal == antipodal]
    if not races:
        return None
    sign = -1.0 if antipodal else 1.0
    R_hat, v_hat = sign * np.array(placement.contact_direction), sign * np.array(placement.drive_direction)
    w_hat = -np.cross(R_hat, v_hat)
    deltas = np.array([race.deflection(R) for race in races])
    # The centre stands so high that the race touches: (R + r_r) cos Δθ + r − r_r, which is R + r for a race in the middle.
    heights = [(R + c.roller_radius) * np.cos(d) + c.radius - c.roller_radius for c, d in zip(races, deltas, strict=True)]
    centre = 1e3 * max(heights) * R_hat
    width = 1e3 * _race_width(races)
    discs = tuple((centre + 1e3 * race.offset * w_hat, width) for race in races)
    contacts = 1e3 * R * (np.cos(deltas)[:, None] * R_hat + np.sin(deltas)[:, None] * w_hat)
    label = f"{i + 1}b" if antipodal else str(i + 1)
    points = 72 if design.wheel_count <= NUMBERED else 20
    return DrawnWheel(i, label, 1e3 * placement.wheel.radius, R_hat, v_hat, centre, discs, contacts, points)


def _race_width(races) -> float:
    """Width (m) of one race's disc: its rollers' thickness where known, kept clear of the next race."""
    radius = races[0].radius
    width = 2 * races[0].roller_radius or 0.3 * radius
    offsets = sorted(race.offset for race in races)
    gaps = [b - a for a, b in pairwise(offsets)]
    return min([max(width, 0.1 * radius), *(0.85 * gap for gap in gaps)])


@styled
def layout_figure(design: Design, view: View = FROM_ABOVE) -> Figure:
    """``design`` seen along ``view``, scales in mm. What the sphere hides is dashed."""
    figure = Figure(figsize=(5.0, 5.0), layout="constrained")
    axes = figure.subplots()
    wheels = sorted(drawn_wheels(design), key=lambda wheel: float(view.depth(wheel.centre)))
    R = 1e3 * design.sphere.radius
    front = [wheel for wheel in wheels if wheel.in_front(view)]
    behind = [wheel for wheel in wheels if not wheel.in_front(view)]
    for wheel in behind:
        _draw_discs(axes, view, wheel, zorder=1, tint=0.8)
    _draw_sphere(axes, view, R)
    for wheel in behind:
        _draw_hidden(axes, view, wheel, R)
    for wheel in front:
        _draw_discs(axes, view, wheel, zorder=4, tint=0.6)
    limit = _limit(view, wheels, R)
    if design.wheel_count <= NUMBERED:
        for wheel in wheels:
            _draw_drive(axes, view, wheel, R)
        _draw_numbers(axes, view, wheels, limit)
    _finish(axes, view, limit)
    return figure


def _draw_discs(axes: Axes, view: View, wheel: DrawnWheel, zorder: float, tint: float) -> None:
    colour = wheel_colour(wheel.index)
    for centre, width in sorted(wheel.discs, key=lambda disc: float(view.depth(disc[0]))):
        outline = wheel.outline(view, centre, width)
        axes.add_patch(Polygon(outline, fc=_tinted(colour, tint), ec=colour, lw=0.8, zorder=zorder))
        for share, lighter in ((1.0, 0.5), (0.25, 0.9)):
            face = wheel.face(view, centre, width, share)
            fill = _tinted(colour, tint + (1 - tint) * lighter)
            axes.add_patch(Polygon(face, fc=fill, ec=colour, lw=0.5, zorder=zorder))


def _draw_hidden(axes: Axes, view: View, wheel: DrawnWheel, R: float) -> None:
    """The outline of a wheel behind the sphere, dashed, as far as the sphere covers it."""
    for centre, width in wheel.discs:
        outline = wheel.outline(view, centre, width)
        patch = Polygon(outline, fc="none", ec=wheel_colour(wheel.index), lw=0.8, ls=(0, (4, 2.5)), alpha=0.75, zorder=3)
        axes.add_patch(patch)
        patch.set_clip_path(Circle((0, 0), R, transform=axes.transData))


def _draw_sphere(axes: Axes, view: View, R: float) -> None:
    """The sphere with the halves of its equator, 30° parallels and 30° meridians that face the viewer."""
    axes.add_patch(Circle((0, 0), R, fc=PAPER, ec="none", zorder=2))
    x, y, z = np.eye(3)
    for elevation in np.radians([-60, -30, 0, 30, 60]):
        line = circle(R * np.sin(elevation) * z, x, y, R * np.cos(elevation))
        _draw_near_half(axes, view, line, width=0.9 if elevation == 0 else 0.45)
    for azimuth in np.radians(np.arange(0, 180, 30)):
        line = circle(np.zeros(3), np.cos(azimuth) * x + np.sin(azimuth) * y, z, R)
        _draw_near_half(axes, view, line, width=0.45)
    axes.add_patch(Circle((0, 0), R, fc="none", ec=GREY, lw=1.0, zorder=2.2))


def _draw_near_half(axes: Axes, view: View, line: np.ndarray, width: float) -> None:
    paper = view.project(line)
    paper[view.depth(line) < -1e-9 * np.abs(line).max()] = np.nan
    axes.plot(*paper.T, color=LIGHT, lw=width, zorder=2.1, solid_capstyle="round")


def _draw_drive(axes: Axes, view: View, wheel: DrawnWheel, R: float) -> None:
    """Contact points, filled where they face the viewer, and the drive direction v̂ as an arrow from the contact."""
    colour = wheel_colour(wheel.index)
    near = wheel.in_front(view)
    points = view.project(wheel.contacts)
    axes.plot(*points.T, "o", ms=3.2, mfc=colour if near else "white", mec=colour, mew=0.8, ls="none", zorder=6)
    start = view.project(R * wheel.contact_direction)
    step = view.project(ARROW * R * wheel.drive_direction)
    if np.hypot(*step) < HEAD_ON * ARROW * R:
        _draw_head_on(axes, start, bool(view.depth(wheel.drive_direction) > 0), colour)
        return
    _draw_arrow(axes, start, start + step, colour, width=1.4, head=9, dashes="-" if near else (0, (3, 1.5)))


def _draw_arrow(axes: Axes, start, end, colour: str, width: float, head: float, dashes: Any = "-") -> None:
    begin, finish = (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))
    axes.add_patch(
        FancyArrowPatch(begin, finish, arrowstyle="-|>", mutation_scale=head, lw=width, ls=dashes, color=colour,
                        shrinkA=0, shrinkB=0, zorder=6)
    )  # fmt: skip


def _draw_head_on(axes: Axes, place, towards_viewer: bool, colour: str) -> None:
    """An arrow seen along itself: its point (a dot in a ring) or its feathers (a cross in a ring)."""
    axes.plot(*place, "o", ms=9, mfc="white", mec=colour, mew=1.2, zorder=6.5)
    axes.plot(
        *place, "o" if towards_viewer else "x", ms=3 if towards_viewer else 5, mfc=colour, mec=colour, mew=1.2, zorder=6.6
    )


def _limit(view: View, wheels: list[DrawnWheel], R: float) -> float:
    """Half the width of the drawing: what sphere, discs and arrows reach, and room for a number."""
    reach = [R]
    for wheel in wheels:
        for centre, width in wheel.discs:
            reach.append(float(np.abs(wheel.outline(view, centre, width)).max()))
        tip = view.project(R * wheel.contact_direction + ARROW * R * wheel.drive_direction)
        reach.append(float(np.abs(tip).max()))
    return 1.16 * max(reach)


def _draw_numbers(axes: Axes, view: View, wheels: list[DrawnWheel], limit: float) -> None:
    """A number beside each wheel, moved along where another one is already there."""
    placed: list[np.ndarray] = []
    for wheel in reversed(wheels):
        place = _free_place(view, wheel, placed, room=0.095 * limit)
        placed.append(place)
        near = wheel.in_front(view)
        box = {"boxstyle": "circle,pad=0.22", "fc": "white", "ec": wheel_colour(wheel.index), "lw": 0.9}
        box["ls"] = "-" if near else (0, (2, 1.2))
        _write(axes, place, wheel.label, color=INK, bbox=box, zorder=8)


def _free_place(view: View, wheel: DrawnWheel, placed: list[np.ndarray], room: float) -> np.ndarray:
    """Where a wheel's number goes: outward of the wheel, else on a growing spiral about that place."""
    outward = view.project(wheel.contact_direction)
    length = float(np.hypot(*outward))
    middle = view.project(wheel.centre)
    if length > 0.25:
        # As far as the wheel's outline reaches on paper, and half a number more.
        outline = wheel.outline(view, wheel.centre, wheel.discs[0][1])
        reach = float(((outline - middle) @ (outward / length)).max())
        wanted = middle + (reach + 0.6 * room) * outward / length
    else:
        # Opposite to the arrow, which starts at the same point of the paper.
        drive = view.project(wheel.drive_direction)
        wanted = middle - 1.1 * room * drive / max(float(np.hypot(*drive)), 1e-9)
    for k in range(80):
        turn = 2.4 * k
        place = wanted + 0.28 * room * np.sqrt(k) * np.array([np.cos(turn), np.sin(turn)])
        if all(np.hypot(*(place - other)) >= room for other in placed):
            return place
    return wanted


def _finish(axes: Axes, view: View, limit: float) -> None:
    axes.set_aspect("equal")
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit))
    axes.set_xlabel(f"{view.right_name} (mm)")
    axes.set_ylabel(f"{view.up_name} (mm)", labelpad=0)
    axes.set_title(view.title)
    corner = np.array([-0.9, -0.9]) * limit
    for name, direction in zip("xyz", np.eye(3), strict=True):
        step = view.project(direction) * 0.17 * limit
        if np.hypot(*step) < 1e-9:
            _draw_head_on(axes, corner, bool(view.depth(direction) > 0), AXES[name])
            continue
        _draw_arrow(axes, corner, corner + step, AXES[name], width=1.0, head=7)
        _write(axes, corner + 1.2 * step, name, color=AXES[name])


def _write(axes: Axes, place, text: str, **style) -> None:
    axes.text(float(place[0]), float(place[1]), text, ha="center", va="center", fontsize=8, **style)


def _tinted(colour: str, share: float) -> tuple[float, ...]:
    """``colour`` mixed with white; opaque, so that what is behind does not shine through."""
    return tuple(1 - (1 - c) * (1 - share) for c in to_rgb(colour))


def layout_caption(design: Design) -> str:
    """What the two views show, in numbers."""
    n = design.wheel_count
    elevations = [p.azimuth_elevation_heading[1] for p in design.placements]
    low, high = (degrees(end(elevations)).replace("-", "−") for end in (min, max))
    where = f"at elevation {low}" if low == high else f"at elevations from {low} to {high}"
    radii = sorted({millimetres(r) for r in design.wheel_radii}, key=lambda text: float(text.split()[0]))
    sizes = radii[0] if len(radii) == 1 else f"{radii[0]} to {radii[-1]}"
    plural = "" if n == 1 else "s"
    text = f"{n} wheel{plural} of radius {sizes} on a sphere of radius {millimetres(design.sphere.radius)}, {where}."
    if n > DRAWN:
        text += f" The first {DRAWN} are drawn."
    if n <= NUMBERED and any(race.antipodal for wheel in design.wheels for race in design.races(wheel)):
        text += " A number with b marks the second wheel of a split pair, at the other side of the sphere."
    if n <= NUMBERED:
        text += (
            " An arrow shows where a wheel's rim moves at the contact for positive speed (a dot in a ring: towards the viewer, "
            "a cross: away). Contacts that the sphere hides are hollow."
        )
    return f"{text} What the sphere hides is dashed. Radii and places are to scale, widths are a sketch."
