"""Distances between cylinders, and how wide a cone they leave free: wheels as bodies, many at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# How close the distance is found, in radii, and how many steps that may take.
CLOSE, STEPS = 1e-9, 4000
# Points around a rim to begin with, points of each closer look, by how much it is closer, and how many there are.
AROUND, LOOK, CLOSER, LOOKS = 64, 17, 8.0, 10


class Cylinders(NamedTuple):
    """k cylinders: centre and axis (unit vector), (k, 3); radius and half the width, m, (k,)."""

    centre: np.ndarray
    axis: np.ndarray
    radius: np.ndarray
    half: np.ndarray

    def take(self, chosen) -> Cylinders:
        """Some of them."""
        return Cylinders(*(array[chosen] for array in self))

    def nearest(self, p: np.ndarray) -> np.ndarray:
        """The point of each cylinder that is nearest to p, (k, 3)."""
        off = p - self.centre
        along = _dot(off, self.axis)
        across = off - along[:, None] * self.axis
        length = np.sqrt(_dot(across, across))
        shrink = np.where(length > self.radius, self.radius / np.where(length > 0, length, 1.0), 1.0)
        return self.centre + np.clip(along, -self.half, self.half)[:, None] * self.axis + shrink[:, None] * across

    def reach(self, n: np.ndarray) -> np.ndarray:
        """How far each reaches from its centre along unit vectors n, (k,)."""
        along = _dot(n, self.axis)
        return self.half * np.abs(along) + self.radius * np.sqrt(np.maximum(0.0, 1.0 - along * along))


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...i,...i->...", a, b)


def cylinder_gap(a: Cylinders, b: Cylinders) -> np.ndarray:
    """Distance between cylinders a and b, m, (k,); where they overlap minus how deep, by a few directions at best.

        d = min |p − q| over p in a, q in b = max over unit n of n·(c_b − c_a) − h_a(n) − h_b(n)

    The middle of the two points that are nearest to it leads to the least distance (projected gradients, with the momentum of
    Nesterov, restarted where it overshoots); the right-hand side at n = (q − p)/d says how near that is.
    """
    scale = a.radius + b.radius + a.half + b.half
    deep = _depth(a, b)
    gap = np.zeros(len(scale))
    at = np.arange(len(scale))
    middle = last = (a.centre + b.centre) / 2
    momentum = np.ones(len(scale))
    before = np.full(len(scale), np.inf)
    for _ in range(STEPS):
        p, q = a.take(at).nearest(middle), b.take(at).nearest(middle)
        apart = q - p
        d = np.sqrt(_dot(apart, apart))
        gap[at] = d
        n = apart / np.where(d > 0, d, 1.0)[:, None]
        least = _separation(a.take(at), b.take(at), n)
        going = (d - least > CLOSE * scale[at]) & (d > CLOSE * scale[at])
        if not going.any():
            break
        restart = d > before
        following = (1.0 + np.sqrt(1.0 + 4.0 * momentum**2)) / 2.0
        push = np.where(restart, 0.0, (momentum - 1.0) / following)
        momentum = np.where(restart, 1.0, following)
        now = (p + q) / 2
        middle = (now + push[:, None] * (now - last))[going]
        at, last, momentum, before = at[going], now[going], momentum[going], d[going]
    return np.where(gap > CLOSE * scale, gap, np.minimum(deep, 0.0))


def _separation(a: Cylinders, b: Cylinders, n: np.ndarray) -> np.ndarray:
    return _dot(n, b.centre - a.centre) - a.reach(n) - b.reach(n)


def _depth(a: Cylinders, b: Cylinders) -> np.ndarray:
    """The largest separation along the centres' line, the axes and the axes' common perpendicular, to either side."""
    found = np.full(len(a.radius), -np.inf)
    for n in (b.centre - a.centre, a.axis, b.axis, np.cross(a.axis, b.axis)):
        length = np.sqrt(_dot(n, n))
        unit = n / np.where(length > 1e-9, length, 1.0)[:, None]
        best = np.maximum(_separation(a, b, unit), _separation(a, b, -unit))
        found = np.maximum(found, np.where(length > 1e-9, best, -np.inf))
    return found


def free_cone(bodies: Cylinders) -> np.ndarray:
    """Half angle of the widest cone from the origin about +z that each body leaves free, rad, (k,).

    The body's least polar angle: on the lines of its mantle, p = c + ρ(t) + s ŵ, where along a line it is least at
    s = (b |p₀|² − a d)/(a − b d) with p₀ = p(s = 0), a = p₀·ẑ, b = ŵ·ẑ, d = p₀·ŵ, or at an end; zero where the axis goes
    through both faces.
    """
    c, w = bodies.centre, bodies.axis
    # Two unit vectors across the axis: the first away from whichever coordinate axis is least along it.
    helper = np.eye(3)[np.argmin(np.abs(w), axis=1)]
    u = np.cross(w, helper)
    u /= np.sqrt(_dot(u, u))[:, None]
    v = np.cross(w, u)

    def angle(t: np.ndarray) -> np.ndarray:
        """The least polar angle along the mantle's lines at t, (k, m) → (k, m)."""
        p0 = c[:, None] + bodies.radius[:, None, None] * (np.cos(t)[..., None] * u[:, None] + np.sin(t)[..., None] * v[:, None])
        a, b, d = p0[..., 2], w[:, None, 2], np.einsum("kmi,ki->km", p0, w)
        below = a - b * d
        s = (b * _dot(p0, p0) - a * d) / np.where(np.abs(below) > 1e-300, below, 1e-300)
        half = bodies.half[:, None]
        places = np.stack([np.clip(s, -half, half), -half + 0 * s, half + 0 * s], axis=-1)
        p = p0[..., None, :] + places[..., None] * w[:, None, None]
        return np.arctan2(np.hypot(p[..., 0], p[..., 1]), p[..., 2]).min(axis=-1)

    t = np.broadcast_to(2 * np.pi * np.arange(AROUND) / AROUND, (len(c), AROUND))
    width = 2 * np.pi / AROUND
    for _ in range(LOOKS):
        best = np.take_along_axis(t, np.argmin(angle(t), axis=1)[:, None], axis=1)
        t = best + width * np.linspace(-1, 1, LOOK)
        width /= CLOSER
    return np.where(_pierced(bodies), 0.0, angle(t).min(axis=1))


def _pierced(bodies: Cylinders) -> np.ndarray:
    """Whether the upper half of the z axis goes through a face of each body."""
    found = np.zeros(len(bodies.radius), bool)
    for side in (-1.0, 1.0):
        face = bodies.centre + (side * bodies.half)[:, None] * bodies.axis
        slope = bodies.axis[:, 2]
        height = _dot(face, bodies.axis) / np.where(np.abs(slope) > 1e-12, slope, 1.0)
        off = height[:, None] * np.array([0.0, 0.0, 1.0]) - face
        found |= (np.abs(slope) > 1e-12) & (height > 0) & (_dot(off, off) <= bodies.radius**2)
    return found
