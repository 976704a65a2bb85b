"""An animated scene in one HTML page that needs no network and no library: bodies, poses and a small viewer."""

from __future__ import annotations

import base64
import functools
import hashlib
import json
import math
from importlib.resources import files
from typing import Any

import numpy as np

from spheredrive.design import Design
from spheredrive.scene import colours
from spheredrive.scene.bodies import Machine, WheelBody, machine
from spheredrive.scene.mesh import Mesh, arrow, joined, octants, revolved, tube
from spheredrive.scene.track import Track, track_of_run, track_of_speeds

# Samples that a page holds: more could not be told apart on a scrubber.
SAMPLES = 600
# Vibration is drawn so large that its largest displacement is this share of the sphere's radius.
SHOWN = 0.05


def scene_html(design: Design, run: Any = None, wheel_speed: Any = None) -> str:
    """A whole HTML page with the machine in motion: along a ``run`` of ``simulate``, or at constant speeds ω (n,), rad/s.

    With neither, the wheels turn at 1 rad/s. It loads nothing from anywhere; its one script is named by ``script_hash`` in its
    content security policy, as it has to be in that of a page that frames it. Raises ``SpheredriveError`` where run or
    speeds do not fit the design.
    """
    from jinja2 import Environment, StrictUndefined

    if run is not None:
        track = track_of_run(design, run)
    else:
        track = track_of_speeds(design, np.ones(design.wheel_count) if wheel_speed is None else wheel_speed)
    bodies = machine(design)
    content = json.dumps(scene_data(design, bodies, track.thinned(SAMPLES)), separators=(",", ":"), allow_nan=False)
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    template = environment.from_string((files("spheredrive.scene") / "scene.html.j2").read_text(encoding="utf-8"))
    # "<" ends a script whatever it stands in.
    return template.render(
        title=design.name, data=content.replace("<", "\\u003c"), script=_script(), script_hash=script_hash(), key=_key(bodies)
    )


def scene_frame(html: str, title: str) -> str:
    """The page as an element to stand inside another page, which must allow ``script_hash`` and nothing more."""
    from html import escape

    return (
        f'<iframe sandbox="allow-scripts" loading="lazy" title="{escape(title)}" srcdoc="{escape(html)}" '
        'style="width:100%;height:32rem;border:1px solid #d8d8d4"></iframe>'
    )


def script_hash() -> str:
    """The viewer's script as a content security policy names it, ``sha256-…``."""
    return "sha256-" + base64.b64encode(hashlib.sha256(_script().encode()).digest()).decode()


@functools.lru_cache(maxsize=1)
def _script() -> str:
    return (files("spheredrive.scene") / "viewer.js").read_text(encoding="utf-8")


def _key(bodies: Machine) -> list[str]:
    lines = ["black arrow: Ω of the sphere", "arrow on an axle: ω of a wheel", "arrow at a contact: drive direction"]
    if any(wheel.missing for wheel in bodies.wheels):
        lines.append("wheels whose rollers are not described: discs")
    return lines


def scene_data(design: Design, bodies: Machine, track: Track) -> dict[str, Any]:
    """What the viewer draws, as plain values: lengths in m, arrays as base64 of little-endian numbers."""
    meshes: list[dict[str, Any]] = []
    R, spot = bodies.sphere_radius, spot_radius(bodies)
    gain = shown_gain(track, R)
    drives = [drive_arrow(bodies, wheel) for wheel in bodies.wheels]
    return {
        "radius": R,
        "reach": bodies.extent[1],
        "aim": bodies.extent[0],
        "spot": spot,
        "gain": gain,
        "gains": sorted({1.0, 10.0, 100.0, 1000.0, gain}),
        "elevation": 0.25 if np.mean([wheel.centre[2] for wheel in bodies.wheels]) > 1e-9 else -0.2,
        "wheel_count": design.wheel_count,
        "sphere": [
            {"mesh": _kept(octants(R, parity), meshes), "colour": _share(colour)}
            for parity, colour in enumerate(colours.SPHERE)
        ],
        "cage": _kept(joined(*(tube(line, 0.012 * R) for line in bodies.cage)), meshes),
        "dot": _kept(ball(), meshes),
        "arrow": _kept(arrow(), meshes),
        "wheels": [_wheel(wheel, meshes) for wheel in bodies.wheels],
        "contacts": [{"place": _numbers(R * place)} for place in bodies.contacts.contact_direction],
        "drives": [
            {"from": _numbers(start), "vector": _numbers(vector), "colour": _share(colours.wheel_colour(wheel.wheel))}
            for wheel, (start, vector) in zip(bodies.wheels, drives, strict=True)
        ],
        "colours": {
            "ink": _share(colours.INK),
            "light": _share(colours.LIGHT),
            "mark": _share(colours.MARK),
            "stage": _share(colours.STAGE),
            "rubber": _share(colours.RUBBER),
            "contact": _share(colours.FAILURE),
        },
        "track": _track(track),
        "meshes": meshes,
    }


def ball(points: int = 7, sides: int = 10) -> Mesh:
    """A small sphere of radius 1."""
    angle = np.linspace(-math.pi / 2, math.pi / 2, points)
    return revolved(np.sin(angle), np.maximum(np.cos(angle), 1e-6), sides)


def spot_radius(bodies: Machine) -> float:
    """Radius of the dot at a contact, m: seen beside the wheel, never larger than a roller by much."""
    return max(0.016 * bodies.sphere_radius, 0.1 * min(wheel.radius for wheel in bodies.wheels))


def drive_arrow(bodies: Machine, wheel: WheelBody) -> tuple[np.ndarray, np.ndarray]:
    """Where the arrow of a wheel's drive direction starts, beside its contact, and the arrow itself, m."""
    out, along = -wheel.frame[:, 0], wheel.frame[:, 1]
    length = max(0.34 * bodies.sphere_radius, 1.5 * wheel.radius)
    return bodies.sphere_radius * out + 0.02 * bodies.sphere_radius * out, length * along


def shown_gain(track: Track, sphere_radius: float) -> float:
    """By what factor a vibration is drawn to be seen: 1, 2 or 5 times a power of ten; 1 where nothing moves."""
    largest = float(np.abs(track.displacement).max())
    if largest == 0:
        return 1.0
    wanted = max(SHOWN * sphere_radius / largest, 1.0)
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1 + 1e-9))


def _wheel(wheel: WheelBody, meshes: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "wheel": wheel.wheel,
        "radius": wheel.radius,
        "wide": float(np.abs(wheel.hub.vertices[:, 2]).max()),
        "centre": _numbers(wheel.centre),
        **{axis: _numbers(wheel.frame[:, i]) for i, axis in enumerate("xyz")},
        "colour": _share(colours.wheel_colour(wheel.wheel)),
        "hub": _kept(wheel.hub, meshes),
        "races": [
            {"mesh": _kept(race.body, meshes), "places": _packed(race.place, "<f4"), "turns": _packed(race.turn, "<f4")}
            for race in wheel.races
        ],
    }


def _track(track: Track) -> dict[str, Any]:
    found = {
        "count": len(track.time),
        "time": _packed(track.time, "<f4"),
        "orientation": _packed(np.round(track.orientation * 32767), "<i2"),
        "angle": _packed(track.wheel_angle, "<f4"),
        "speed": _packed(track.wheel_speed, "<f4"),
        "omega": _packed(track.angular_velocity, "<f4"),
        "touching": _packed(track.touching, "u1"),
    }
    if track.shakes:
        found["displacement"] = _packed(track.displacement, "<f4")
    if np.ptp(track.stage, axis=0).max() > 0:
        found["stage"] = _packed(track.stage, "<f4")
    return found


def _kept(mesh: Mesh, meshes: list[dict[str, Any]]) -> int:
    """The number of a mesh in the list, which holds equal ones once; coordinates to a 32,767th of the largest."""
    scale = float(np.abs(mesh.vertices).max()) / 32767
    packed = {"scale": scale, "v": _packed(np.round(mesh.vertices / scale), "<i2"), "f": _packed(mesh.faces, "<u2")}
    if packed not in meshes:
        meshes.append(packed)
    return meshes.index(packed)


def _packed(values: Any, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def _numbers(vector: np.ndarray) -> list[float]:
    return [round(float(x), 7) for x in vector]


def _share(colour: str) -> list[float]:
    return [round(part / 255, 4) for part in colours.rgb(colour)]
