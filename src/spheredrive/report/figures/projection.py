"""Geometry for drawing: views of the machine along an axis, outlines of wheels in them, and a map of the sphere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Points = np.ndarray


@dataclass(frozen=True)
class View:
    """An orthographic view: which directions run to the right and upward on paper, and which one towards the viewer."""

    title: str
    right_name: str
    up_name: str
    right: tuple[float, float, float]
    up: tuple[float, float, float]

    @property
    def towards(self) -> Points:
        """Unit vector from the machine to the viewer: right × up."""
        return np.cross(self.right, self.up)

    def project(self, points) -> Points:
        """Points (..., 3) on paper, (..., 2), to the right and upward."""
        return np.asarray(points, float) @ np.array([self.right, self.up]).T

    def depth(self, points) -> Points:
        """How far points (..., 3) stand towards the viewer, (...)."""
        return np.asarray(points, float) @ self.towards


FROM_ABOVE = View("From above: x to the right, y up", "x", "y", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
FROM_SIDE = View("From the right side (from −y): x to the right, z up", "x", "z", (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def circle(centre, first, second, radius: float, count: int = 72) -> Points:
    """Points of the circle about ``centre`` in the plane of two perpendicular unit vectors, (count + 1, 3), closed."""
    t = np.linspace(0, 2 * np.pi, count + 1)[:, None]
    return np.asarray(centre) + radius * (np.cos(t) * np.asarray(first) + np.sin(t) * np.asarray(second))


def disc_outline(view: View, centre, first, second, radius: float, width: float, count: int = 72) -> Points:
    """Outline on paper of a round disc with its faces in the plane of ``first`` and ``second``, (k, 2).

    A disc is its middle circle swept by ± half its width along the axis: each point of the projected circle moves to the
    side that its outward normal looks to, which draws both half ellipses and the straight lines between them.
    """
    middle = view.project(centre)
    ring = view.project(circle(centre, first, second, radius, count)) - middle
    tangent = view.project(circle((0, 0, 0), second, -np.asarray(first), 1.0, count))
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], -1)
    turning = ring[:, 0] * tangent[:, 1] - ring[:, 1] * tangent[:, 0]
    if turning.sum() < 0:
        normal = -normal
    half = view.project(np.cross(first, second)) * width / 2
    side = np.where(normal @ half >= 0, 1.0, -1.0)[:, None]
    return middle + ring + side * half


def near_face(view: View, centre, first, second, radius: float, width: float, count: int = 72) -> Points:
    """The disc's face that the viewer sees, on paper, (k, 2)."""
    axis = np.cross(first, second)
    side = 1.0 if view.depth(axis) >= 0 else -1.0
    return view.project(circle(np.asarray(centre) + side * width / 2 * axis, first, second, radius, count))


def mollweide(azimuth, elevation) -> tuple[Points, Points]:
    """Mollweide's equal-area map of directions (rad, broadcast) on an ellipse of half axes 2√2 and √2.

    x = (2√2/π) φ cos θ,  y = √2 sin θ,  2θ + sin 2θ = π sin ε. Azimuth is brought into −π..π first.
    """
    azimuth, elevation = np.broadcast_arrays(np.asarray(azimuth, float), np.asarray(elevation, float))
    # −π and π are the two edges of the map: only what lies beyond them is brought back.
    turned = np.where(np.abs(azimuth) > np.pi, np.angle(np.exp(1j * azimuth)), azimuth)
    target = np.pi * np.sin(elevation)
    low, high = np.full(elevation.shape, -np.pi / 2), np.full(elevation.shape, np.pi / 2)
    # Newton's method stalls at the poles, where the slope is zero; halving does not.
    for _ in range(50):
        theta = (low + high) / 2
        below = 2 * theta + np.sin(2 * theta) < target
        low, high = np.where(below, theta, low), np.where(below, high, theta)
    theta = (low + high) / 2
    return 2 * np.sqrt(2) / np.pi * turned * np.cos(theta), np.sqrt(2) * np.sin(theta)


def map_direction(direction) -> tuple[Points, Points]:
    """Place of directions (..., 3) on Mollweide's map."""
    d = np.asarray(direction, float)
    level = np.hypot(d[..., 0], d[..., 1])
    azimuth = np.where(level > 1e-9, np.arctan2(d[..., 1], d[..., 0]), 0.0)
    return mollweide(azimuth, np.arctan2(d[..., 2], level))


def map_path(directions) -> tuple[Points, Points]:
    """A path of directions (k, 3) on the map, cut (by NaN) where it leaves one edge and comes back at the other."""
    d = np.asarray(directions, float)
    x, y = map_direction(d)
    jump = np.flatnonzero(np.abs(np.diff(np.arctan2(d[:, 1], d[:, 0]))) > np.pi) + 1
    return np.insert(x, jump, np.nan), np.insert(y, jump, np.nan)


def perpendicular_circle(direction, count: int = 360) -> Points:
    """The directions perpendicular to one direction, (count + 1, 3)."""
    axis = np.asarray(direction, float)
    other = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, other)
    first = first / np.linalg.norm(first)
    return circle((0, 0, 0), first, np.cross(axis, first), 1.0, count)
