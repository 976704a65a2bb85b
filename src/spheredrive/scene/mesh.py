"""Surfaces as triangles: bodies of revolution, parts of a sphere, prisms."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Mesh(NamedTuple):
    """``vertices`` (v, 3), m, and ``faces`` (f, 3), anticlockwise seen from outside. Corners that are sharp stand twice."""

    vertices: np.ndarray
    faces: np.ndarray


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def moved(mesh: Mesh, place, turn=None) -> Mesh:
    """The mesh turned by a matrix (3, 3), then carried to ``place`` (3,)."""
    turned = mesh.vertices if turn is None else mesh.vertices @ np.asarray(turn).T
    return Mesh(turned + np.asarray(place, float), mesh.faces)


def revolved(places, radii, sides: int = 16) -> Mesh:
    """The surface that a line of ``places`` along z and ``radii`` (k,), m, leaves when it turns about z.

    Places rise; the surface faces away from the axis.
    """
    angle = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    flat = np.asarray(radii, float)[:, None, None] * ring
    height = np.broadcast_to(np.asarray(places, float)[:, None, None], (*flat.shape[:2], 1))
    low, right = np.meshgrid(np.arange(len(flat) - 1) * sides, np.arange(sides), indexing="ij")
    a, b = low + right, low + (right + 1) % sides
    faces = np.concatenate([np.stack([a, b, b + sides], -1), np.stack([a, b + sides, a + sides], -1)]).reshape(-1, 3)
    return Mesh(np.concatenate([flat, height], axis=-1).reshape(-1, 3), faces)


def disc(place: float, radius: float, up: bool, sides: int = 16) -> Mesh:
    """A flat end of radius ``radius`` at ``place`` on z, facing along +z or, not ``up``, along −z."""
    angle = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(sides, place)], axis=-1)
    i = np.arange(sides)
    faces = np.stack([np.full(sides, sides), i, (i + 1) % sides], axis=-1)
    return Mesh(np.vstack([rim, [0, 0, place]]), faces if up else faces[:, ::-1])


def cylinder(low: float, high: float, radius: float, sides: int = 24) -> Mesh:
    """A closed cylinder about z from ``low`` to ``high``."""
    side = revolved([low, high], [radius, radius], sides)
    return joined(side, disc(low, radius, False, sides), disc(high, radius, True, sides))


def prism(outline, low: float, high: float) -> Mesh:
    """A closed body with the outline (k, 2), anticlockwise about z, from ``low`` to ``high``."""
    outline = np.asarray(outline, float)
    k = len(outline)
    i = np.arange(k)
    j = (i + 1) % k
    rims = [np.column_stack([outline, np.full(k, z)]) for z in (low, high)]
    side = np.concatenate([np.stack([i, j, j + k], -1), np.stack([i, j + k, i + k], -1)])
    ends = [
        Mesh(np.vstack([rim, [0, 0, z]]), np.stack([np.full(k, k), *((i, j) if up else (j, i))], -1))
        for rim, z, up in zip(rims, (low, high), (False, True), strict=True)
    ]
    return joined(Mesh(np.vstack(rims), side), *ends)


def octants(radius: float, parity: int, steps: int = 14) -> Mesh:
    """Four of the eight octants of a sphere, no two of which share an edge: those of one ``parity``, 0 or 1."""
    parts = []
    for k in range(8):
        east, north = k % 4, k // 4
        if (east + north) % 2 != parity:
            continue
        phi = math.pi / 2 * (east + np.linspace(0, 1, steps + 1))
        theta = math.pi / 2 * (north - 1 + np.linspace(0, 1, steps + 1))
        level, turn = np.meshgrid(theta, phi, indexing="ij")
        vertices = radius * np.stack([np.cos(level) * np.cos(turn), np.cos(level) * np.sin(turn), np.sin(level)], -1)
        low, right = np.meshgrid(np.arange(steps) * (steps + 1), np.arange(steps), indexing="ij")
        a = low + right
        b, c = a + 1, a + steps + 1
        faces = np.concatenate([np.stack([a, b, c + 1], -1), np.stack([a, c + 1, c], -1)]).reshape(-1, 3)
        parts.append(Mesh(vertices.reshape(-1, 3), faces))
    return joined(*parts)


def arrow(sides: int = 12) -> Mesh:
    """An arrow along z of unit length: a shaft of radius 0.025 and a head of radius 0.07 from 0.78 on."""
    shaft = joined(revolved([0.0, 0.8], [0.025, 0.025], sides), disc(0.0, 0.025, False, sides))
    head = joined(revolved([0.78, 1.0], [0.07, 1e-4], sides), disc(0.78, 0.07, False, sides))
    return joined(shaft, head)


def tube(line, radius: float, sides: int = 6) -> Mesh:
    """A round bar along a polyline (k, 3), without ends."""
    line = np.asarray(line, float)
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # Any direction that is nowhere along the line serves to begin with.
    least = np.eye(3)[np.argmin(np.abs(along).max(axis=0))]
    first = np.cross(along, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(along, first)
    angle = np.linspace(0, 2 * math.pi, sides, endpoint=False)[:, None, None]
    rings = line + radius * (np.cos(angle) * first + np.sin(angle) * second)
    vertices = np.swapaxes(rings, 0, 1)
    low, right = np.meshgrid(np.arange(len(line) - 1) * sides, np.arange(sides), indexing="ij")
    a, b = low + right, low + (right + 1) % sides
    faces = np.concatenate([np.stack([a, b, b + sides], -1), np.stack([a, b + sides, a + sides], -1)]).reshape(-1, 3)
    return Mesh(vertices.reshape(-1, 3), faces)
