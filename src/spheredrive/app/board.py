"""A plot that stands in the scene beside the machine: points over two metrics, of which one is chosen by a click."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.app.picture import FRONT, RIGHT, quaternion_of
from spheredrive.scene import colours
from spheredrive.scene.mesh import tube
from spheredrive.scene.page import ball

if TYPE_CHECKING:
    import viser

ROOT = "/board"
# Where the board begins, its size and that of its dots in units of the scene, and most dots that are drawn.
LEFT, WIDTH, HEIGHT, DOT, MOST = 1.75, 2.6, 2.0, 0.028, 3000


class Board:
    """Dots over two axes on a plane that faces where pages look from."""

    def __init__(self, server: viser.ViserServer, chosen: Callable[[int], None]):
        self.server, self.scene, self._chosen = server, server.scene, chosen
        self._drawn = np.zeros(0, int)
        self._places = np.zeros((0, 2))
        # Beside the machine, its face to the camera: x to the right, y up, z out of the board.
        self._frame = np.stack([RIGHT, [0.0, 0.0, 1.0], FRONT], axis=-1)
        self._origin = LEFT * RIGHT - [0.0, 0.0, 0.9]
        self._parts: dict[str, Any] = {}

    def show(self, x: np.ndarray, y: np.ndarray, front: np.ndarray, labels: tuple[str, str]) -> None:
        """Draw points (P,) over two metrics; those of ``front`` stand out."""
        self.hide()
        known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        self._drawn = np.concatenate([_some(np.setdiff1d(known, front)), _some(front)])
        self._places = np.stack([_shares(x, known) * WIDTH, _shares(y, known) * HEIGHT], axis=-1)
        self.scene.add_frame(ROOT, show_axes=False, position=self._origin, wxyz=quaternion_of(self._frame))
        self._plane()
        stands_out = np.isin(self._drawn, front)
        shades = np.where(stands_out[:, None], colours.rgb(colours.WHEELS[0]), colours.rgb(colours.STAGE)).astype(np.uint8)
        self._dots("dots", self._places[self._drawn], np.where(stands_out, DOT, 0.7 * DOT), shades)
        self._write("right", f"{labels[0]}: {_range(x, known)}", (WIDTH, -0.06, 0.0), "top-right")
        self._write("up", f"{labels[1]}: {_range(y, known)}", (0.0, HEIGHT + 0.06, 0.0), "bottom-left")

    def mark(self, point: int) -> None:
        """Show which point is chosen."""
        if "chosen" in self._parts:
            self._parts.pop("chosen").remove()
        if len(self._places) and np.isfinite(self._places[point]).all():
            shade = np.array([colours.rgb(colours.FAILURE)], np.uint8)
            self._dots("chosen", self._places[[point]], np.array([1.9 * DOT]), shade, 0.04)

    def hide(self) -> None:
        """Take the board away."""
        if self._parts:
            self.scene.remove_by_name(ROOT)
            self._parts = {}

    def _plane(self) -> None:
        behind = -0.03
        vertices = np.array([[0, 0, behind], [WIDTH, 0, behind], [WIDTH, HEIGHT, behind], [0, HEIGHT, behind]])
        plane = self.scene.add_mesh_simple(
            f"{ROOT}/plane",
            vertices,
            np.array([[0, 1, 2], [0, 2, 3]]),
            color=colours.rgb(colours.LIGHT),
            # What is seen of it is no more than a tint, but it takes the clicks between the dots.
            opacity=0.15,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        plane.on_click(lambda event: self._click(np.array(event.ray_origin), np.array(event.ray_direction)))
        self._parts["plane"] = plane
        axes = tube(np.array([[0, HEIGHT, 0], [0, 0, 0], [WIDTH, 0, 0.0]]), 0.008)
        self._parts["axes"] = self.scene.add_mesh_simple(
            f"{ROOT}/axes", axes.vertices, axes.faces, color=colours.rgb(colours.GREY), cast_shadow=False, receive_shadow=False
        )

    def _dots(self, name: str, places: np.ndarray, sizes: np.ndarray, shades: np.ndarray, before: float = 0.0) -> None:
        shape = ball(5, 8)
        dots = self.scene.add_batched_meshes_simple(
            f"{ROOT}/{name}",
            shape.vertices,
            shape.faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1)),
            batched_positions=np.column_stack([places, np.full(len(places), before)]),
            batched_scales=sizes.astype(np.float32),
            batched_colors=shades,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )
        dots.on_click(lambda event: self._click(np.array(event.ray_origin), np.array(event.ray_direction)))
        self._parts[name] = dots

    def _write(self, name: str, text: str, place: tuple, anchor: Any) -> None:
        self._parts[name] = self.scene.add_label(f"{ROOT}/{name}", text, position=place, anchor=anchor)

    def _click(self, origin: np.ndarray, direction: np.ndarray) -> None:
        """Choose the point nearest to where a ray meets the board."""
        start, along = (origin - self._origin) @ self._frame, direction @ self._frame
        if abs(along[2]) < 1e-9 or not len(self._drawn):
            return
        place = (start - start[2] / along[2] * along)[:2]
        self._chosen(int(self._drawn[np.linalg.norm(self._places[self._drawn] - place, axis=1).argmin()]))


def _some(points: np.ndarray) -> np.ndarray:
    """At most ``MOST`` of ``points``, evenly by their place."""
    if len(points) <= MOST:
        return np.asarray(points, int)
    return np.asarray(points, int)[np.round(np.linspace(0, len(points) - 1, MOST)).astype(int)]


def _shares(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Values from 0 at the smallest to 1 at the largest, a little inside of both."""
    low, high = values[known].min(), values[known].max()
    return 0.04 + 0.92 * (values - low) / (high - low or 1.0)


def _range(values: np.ndarray, known: np.ndarray) -> str:
    return f"{values[known].min():.4g} to {values[known].max():.4g}"
