"""The scene as viser shows it: bodies made once, poses set as things move. Everything is drawn in units of one length."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.scene import colours
from spheredrive.scene.bodies import Machine, RollerRace, WheelBody
from spheredrive.scene.mesh import Mesh, arrow, joined, octants, tube
from spheredrive.scene.page import ball, drive_arrow, spot_radius
from spheredrive.scene.track import Track

if TYPE_CHECKING:
    import viser

ROOT = "/machine"
# How far a sphere takes the colour of a warning on.
TINT = 0.45
# Angle of view, and how high a page looks from: wheels under a sphere are seen best from below.
VIEW, BELOW, ABOVE = math.radians(34), math.radians(-12), math.radians(14)
# Pages look from the front; to the right of it is their right.
FRONT, RIGHT = np.array([0.5407, -0.8412, 0.0]), np.array([0.8412, 0.5407, 0.0])
_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


class Picture:
    """The machine in a viser scene.

    ``scale`` turns metres into units of the scene; ``beside`` is how far other things reach to its right, in these.
    """

    def __init__(self, server: viser.ViserServer):
        self.server, self.scene = server, server.scene
        self.scale, self.beside = 1.0, 0.0
        self._machine: Machine | None = None
        self._wheels: list[tuple[WheelBody, Any, list[Any]]] = []
        self._parts: dict[str, Any] = {}
        self._seen: dict[int, tuple[tuple[int, int], np.ndarray]] = {}
        self._middle, self._reach, self._tilt = 0.0, 1.0, ABOVE
        self.scene.configure_environment_map(None)
        self.scene.configure_default_lights(True, cast_shadow=False)
        self.scene.add_light_ambient("/ambient", intensity=0.9)
        self.root = self.scene.add_frame(ROOT, show_axes=False)
        self.sphere = self.scene.add_frame(f"{ROOT}/sphere", show_axes=False)

    def aim(self, machine: Machine) -> None:
        """Choose the scale, and where pages look from, for ``machine``."""
        self.scale = 1.0 / machine.sphere_radius
        self._middle, self._reach = (length * self.scale for length in machine.extent)
        self._tilt = BELOW if np.mean([wheel.centre[2] for wheel in machine.wheels]) <= 1e-9 else ABOVE
        self._look(self.server.initial_camera, 1.0)
        for client in self.server.get_clients().values():
            self.look(client)

    def look(self, client: viser.ClientHandle) -> None:
        """Let one page see the whole machine, whatever the shape of its window."""
        camera = client.camera
        size = camera.image_width, camera.image_height
        self._look(camera, size[0] / max(size[1], 1))
        self._seen[client.client_id] = size, np.array(camera.position)

    def look_again(self, client: viser.ClientHandle) -> None:
        """The same where a window's shape has changed and nobody has turned the view since."""
        camera = client.camera
        size, place = self._seen.get(client.client_id, ((0, 0), np.zeros(3)))
        untouched = np.allclose(camera.position, place, atol=1e-3 * self._reach)
        if (camera.image_width, camera.image_height) != size and untouched:
            self.look(client)

    def _look(self, camera: Any, aspect: float) -> None:
        """The machine in the middle, or with what stands to its right where there is something."""
        rightmost = max(self._reach, self.beside)
        half = (self._reach + rightmost) / 2
        away = 1.12 * max(self._reach / math.sin(VIEW / 2), half / math.tan(VIEW / 2) / aspect)
        level, aim = away * math.cos(self._tilt), (rightmost - self._reach) / 2 * RIGHT + [0.0, 0.0, self._middle]
        camera.fov = VIEW
        camera.position = tuple(aim + level * FRONT + [0.0, 0.0, away * math.sin(self._tilt)])
        camera.look_at = tuple(aim)

    def show(self, machine: Machine, nearness: float, seen_through: bool = False) -> None:
        """Draw the bodies of ``machine``; those that were drawn alike before are only put in their place."""
        with self.server.atomic():
            self._show_sphere(machine, nearness, seen_through)
            for index in range(max(len(machine.wheels), len(self._wheels))):
                self._show_wheel(index, machine.wheels[index] if index < len(machine.wheels) else None)
            R = machine.sphere_radius
            self._mesh("cage", joined(*(tube(line, 0.012 * R) for line in machine.cage)), colours.STAGE)
            self._show_drives(machine)
            self._machine = machine

    def pose(self, track: Track, i: int, gain: float = 1.0, most_speed: float = 1.0, most_turn: float = 1.0) -> None:
        """Put everything where it is at sample ``i`` of ``track``; the displacement of the centre drawn ``gain`` times.

        Arrows are as long as their share of ``most_speed`` and ``most_turn``, rad/s.
        """
        machine = self._machine
        assert machine is not None, "bodies are shown before they are moved"
        with self.server.atomic():
            self.root.position = track.stage[i] * self.scale
            offset = track.displacement[i] * gain * self.scale
            self.sphere.wxyz, self.sphere.position = track.orientation[i], offset
            for body, turning, _ in self._wheels:
                turning.wxyz = _about_z(track.wheel_angle[i, body.wheel])
            self._show_contacts(machine, track.touching[i])
            self._show_speeds(machine, track.wheel_speed[i] / most_speed)
            self._show_turn(track.angular_velocity[i] / most_turn, offset)

    def trail(self, track: Track | None) -> None:
        """The path of the sphere's mark over a whole track, in the machine's frame; None takes it away."""
        if "trail" in self._parts:
            self._parts.pop("trail").remove()
        if track is None or len(track.time) < 2:
            return
        from spheredrive.frames import quaternion_matrix

        thin = track.thinned(1500)
        points = 1.006 * self._radius * quaternion_matrix(thin.orientation)[:, :, 0]
        segments = np.stack([points[:-1], points[1:]], axis=1)
        self._parts["trail"] = self.scene.add_line_segments(
            f"{ROOT}/trail", segments, colours.rgb(colours.MARK), thickness=2.0, thickness_units="screen"
        )

    @property
    def _radius(self) -> float:
        return self._machine.sphere_radius * self.scale if self._machine else 1.0

    def _show_sphere(self, machine: Machine, nearness: float, seen_through: bool) -> None:
        warning = colours.FAILURE if nearness >= 1.0 else "#e69f00"
        share = TINT if nearness >= 1.0 else TINT * nearness
        look = (machine.sphere_radius * self.scale, nearness, seen_through)
        if self._parts.get("look") == look:
            return
        self._parts["look"] = look
        for parity, colour in enumerate(colours.SPHERE):
            self._parts[f"octants {parity}"] = self._add(
                f"{ROOT}/sphere/octants {parity}",
                octants(machine.sphere_radius, parity),
                colours.mixed(colour, warning, share),
                opacity=0.4 if seen_through else None,
            )
        mark = Mesh(ball().vertices * 0.025 * machine.sphere_radius + [machine.sphere_radius, 0, 0], ball().faces)
        self._parts["mark"] = self._add(f"{ROOT}/sphere/mark", mark, colours.MARK)

    def _show_wheel(self, index: int, body: WheelBody | None) -> None:
        name = f"{ROOT}/wheel {index}"
        old = self._wheels[index] if index < len(self._wheels) else None
        if body is None:
            if old is not None:
                self.scene.remove_by_name(name)
                self._wheels = self._wheels[:index]
            return
        place, turn = body.centre * self.scale, quaternion_of(body.frame)
        if old is not None and _alike(old[0], body) and self._parts.get(name) == self.scale:
            frame, turning, rest = old[2][0], old[1], old[2]
            frame.position, frame.wxyz = place, turn
            rest[1].text = body.label
        else:
            if old is not None:
                self.scene.remove_by_name(name)
            frame = self.scene.add_frame(name, show_axes=False, position=place, wxyz=turn)
            turning = self.scene.add_frame(f"{name}/turning", show_axes=False)
            self._add(f"{name}/turning/hub", body.hub, colours.wheel_colour(body.wheel))
            for race in body.races:
                self._add_rollers(f"{name}/turning/rollers {race.number}", race)
            # Beyond the rim, on the side away from the sphere.
            above = (-1.75 * body.radius * self.scale, 0.0, 0.0)
            label = self.scene.add_label(f"{name}/number", body.label, position=above, anchor="center-center")
            rest = [frame, label]
            self._parts[name] = self.scale
        entry = (body, turning, rest)
        self._wheels[index : index + 1] = [entry]

    def _add_rollers(self, name: str, race: RollerRace) -> None:
        self.scene.add_batched_meshes_simple(
            name,
            race.body.vertices * self.scale,
            race.body.faces,
            batched_wxyzs=np.array([quaternion_of(turn) for turn in race.turn]),
            batched_positions=race.place * self.scale,
            batched_colors=colours.rgb(colours.RUBBER),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _show_drives(self, machine: Machine) -> None:
        pairs = [drive_arrow(machine, wheel) for wheel in machine.wheels]
        starts, vectors = (np.array(column) for column in zip(*pairs, strict=True))
        self._arrows("drives", machine, starts, vectors, 0.75 * np.linalg.norm(vectors, axis=1))

    def _show_speeds(self, machine: Machine, share: np.ndarray) -> None:
        starts, vectors, widths = [], [], []
        for wheel in machine.wheels:
            s = float(share[wheel.wheel])
            half = float(np.abs(wheel.hub.vertices[:, 2]).max())
            length = (1.3 * half + 1.6 * wheel.radius * abs(s)) if abs(s) > 1e-3 else 1e-6
            starts.append(wheel.centre)
            vectors.append(math.copysign(length, s) * wheel.frame[:, 2])
            widths.append(1.6 * wheel.radius if abs(s) > 1e-3 else 1e-6)
        self._arrows("speeds", machine, np.array(starts), np.array(vectors), np.array(widths))

    def _arrows(self, name: str, machine: Machine, starts, vectors, widths) -> None:
        lengths = np.linalg.norm(vectors, axis=1)
        turns = np.array([quaternion_to(vector) for vector in vectors])
        places, scales = starts * self.scale, np.stack([widths, widths, lengths], -1) * self.scale
        old = self._parts.get(name)
        if old is not None and len(old.batched_positions) == len(places):
            old.batched_positions, old.batched_wxyzs, old.batched_scales = places, turns, scales
            return
        if old is not None:
            old.remove()
        shape = arrow()
        self._parts[name] = self.scene.add_batched_meshes_simple(
            f"{ROOT}/{name}",
            shape.vertices,
            shape.faces,
            batched_wxyzs=turns,
            batched_positions=places,
            batched_scales=scales.astype(np.float32),
            batched_colors=np.array([colours.rgb(colours.wheel_colour(wheel.wheel)) for wheel in machine.wheels], np.uint8),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _show_contacts(self, machine: Machine, touching: np.ndarray) -> None:
        places = machine.sphere_radius * machine.contacts.contact_direction * self.scale
        sizes = np.where(touching, 1.0, 0.55)[:, None] * np.full(3, spot_radius(machine) * self.scale)
        shades = np.where(touching[:, None], colours.rgb(colours.FAILURE), colours.rgb(colours.LIGHT)).astype(np.uint8)
        old = self._parts.get("contacts")
        if old is not None and len(old.batched_positions) == len(places):
            old.batched_positions, old.batched_scales, old.batched_colors = places, sizes, shades
            return
        if old is not None:
            old.remove()
        shape = ball()
        self._parts["contacts"] = self.scene.add_batched_meshes_simple(
            f"{ROOT}/contacts",
            shape.vertices,
            shape.faces,
            batched_wxyzs=np.tile(_UPRIGHT, (len(places), 1)),
            batched_positions=places,
            batched_scales=sizes.astype(np.float32),
            batched_colors=shades,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _show_turn(self, share: np.ndarray, offset: np.ndarray) -> None:
        """The arrow of Ω, from the sphere's surface outward."""
        size = float(np.linalg.norm(share))
        handle = self._parts.get("turn")
        if handle is None:
            handle = self._parts["turn"] = self._add(f"{ROOT}/turn", arrow(), colours.INK, scaled=False)
        handle.visible = size > 1e-3
        if size > 1e-3:
            direction, R = share / size, self._radius
            handle.position = offset + R * direction
            handle.wxyz = quaternion_to(direction)
            handle.scale = (0.6 * R, 0.6 * R, R * (0.12 + 0.55 * min(size, 1.5)))

    def _mesh(self, name: str, mesh: Mesh, colour: str) -> None:
        old = self._parts.get(name)
        vertices = (mesh.vertices * self.scale).astype(np.float32)
        if old is None or not np.array_equal(old.vertices, vertices):
            self._parts[name] = self._add(f"{ROOT}/{name}", mesh, colour)

    def _add(self, name: str, mesh: Mesh, colour: str, opacity: float | None = None, scaled: bool = True) -> Any:
        return self.scene.add_mesh_simple(
            name,
            mesh.vertices * (self.scale if scaled else 1.0),
            mesh.faces,
            color=colours.rgb(colour),
            opacity=opacity,
            side="front",
            cast_shadow=False,
            receive_shadow=False,
        )


def quaternion_of(turn: np.ndarray) -> np.ndarray:
    """Scalar-first quaternion of a rotation matrix (3, 3), by its largest component."""
    t = np.asarray(turn, float)
    squares = np.array([1 + np.trace(t), *(1 + 2 * t[i, i] - np.trace(t) for i in range(3))])
    k = int(squares.argmax())
    if k == 0:
        q = np.array([squares[0], t[2, 1] - t[1, 2], t[0, 2] - t[2, 0], t[1, 0] - t[0, 1]])
    else:
        i, j, l = k - 1, k % 3, (k + 1) % 3
        q = np.empty(4)
        q[0], q[k] = t[l, j] - t[j, l], squares[k]
        q[1 + j], q[1 + l] = t[j, i] + t[i, j], t[l, i] + t[i, l]
    return q / np.linalg.norm(q)


def quaternion_to(vector: np.ndarray) -> np.ndarray:
    """The shortest turn that takes z to the direction of ``vector`` (3,)."""
    x, y, z = np.asarray(vector, float) / np.linalg.norm(vector)
    if z < -1 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    q = np.array([1 + z, -y, x, 0.0])
    return q / np.linalg.norm(q)


def _about_z(angle: float) -> np.ndarray:
    return np.array([math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)])


def _alike(one: WheelBody, other: WheelBody) -> bool:
    """Whether two wheels are drawn by the same bodies, wherever they stand."""
    pairs = [(one.hub.vertices, other.hub.vertices)]
    pairs += [(a.body.vertices, b.body.vertices) for a, b in zip(one.races, other.races, strict=False)]
    pairs += [(a.place, b.place) for a, b in zip(one.races, other.races, strict=False)]
    same = one.wheel == other.wheel and len(one.races) == len(other.races)
    return same and all(np.array_equal(a, b) for a, b in pairs)
