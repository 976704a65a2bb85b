"""From points to machines, on two routes that give the same bits.

The plain route writes a point's values into the design file's data and reads that as a design: any path, about a millisecond.
The vectorised one puts numbers straight into columns, for the paths in ``_SETTERS``. It takes only what it can be sure of: a
number out of range, wheels that nearly meet and the like go the plain route, which knows why a machine cannot be.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from spheredrive.design import SAME_DIRECTION, Design
from spheredrive.errors import InputError, SpheredriveError
from spheredrive.frames import heading_direction, outward
from spheredrive.io.design_file import parse_design
from spheredrive.io.design_path import Place, assigned
from spheredrive.io.study import Parameter, Study
from spheredrive.io.toml_text import toml_text
from spheredrive.studies.sweep.columns import Columns, columns_of, joined
from spheredrive.values import LARGEST, SMALLEST
from spheredrive.wheels.measured import MeasuredWheel

# Designs that are kept for points to come that differ from them in numbers alone.
KEPT = 4096
# Wheels this close (in units of the sphere's radius) are looked at by the plain route, which refuses equal places.
CLOSE = 10 * SAME_DIRECTION


@dataclass(frozen=True)
class Batch:
    """Machines of some points: ``rows`` among the points asked for, their columns, and themselves where a metric needs them."""

    rows: np.ndarray
    columns: Columns
    designs: tuple[Design, ...] | None


class Variants:
    """The machines of a study's points; ``whole`` where designs themselves are needed, which then all go the plain route."""

    def __init__(self, study: Study, whole: bool = False):
        self.study = study
        self.parameters = study.parameters
        fast = [not whole and _vectorised(p, study) for p in self.parameters]
        self._numeric = [i for i, quick in enumerate(fast) if quick]
        self._plain = [i for i, quick in enumerate(fast) if not quick]
        self.whole = whole
        self._template = lru_cache(maxsize=KEPT)(self._made)

    def data(self, row) -> dict[str, Any]:
        """The design file of a point, as plain data."""
        return assigned(self.study.data, ((p.path, p.value(x)) for p, x in zip(self.parameters, row, strict=True)))

    def design_text(self, row) -> str:
        """The design file of a point."""
        return toml_text(self.data(row))

    def design(self, row) -> Design:
        """The machine of a point. Raises ``SpheredriveError`` with the reason why there is none."""
        return self._read(self.data(row))

    def _read(self, data: dict[str, Any]) -> Design:
        try:
            return parse_design(toml_text(data), folder=self.study.folder)
        except InputError as error:
            raise SpheredriveError(error.rule) from None

    def batches(self, X: np.ndarray) -> tuple[list[Batch], dict[int, str]]:
        """The machines of points X (b, d), and by row the reason why a point has none."""
        missing: dict[int, str] = {}
        doubtful: list[int] = []
        parts: list[tuple[np.ndarray, Columns]] = []
        for rows, key in _groups(X[:, self._plain]):
            template = self._template(key)
            if not self._numeric:
                if isinstance(template, str):
                    missing.update(dict.fromkeys(rows.tolist(), template))
                else:
                    parts.append((rows, columns_of([template])[0][1].repeated(len(rows))))
                continue
            if isinstance(template, str):
                doubtful += rows.tolist()
                continue
            sure, columns = self._filled(template, X[rows])
            doubtful += rows[~sure].tolist()
            if sure.any():
                parts.append((rows[sure], columns))
        designs: dict[int, Design] = {}
        for row in doubtful:
            try:
                designs[row] = self.design(X[row])
            except SpheredriveError as error:
                missing[row] = str(error)
        places = np.array(list(designs), np.int64)
        parts += [(places[at], columns) for at, columns in columns_of(list(designs.values()))]
        return [self._batch(rows, columns, X) for rows, columns in joined(parts)], missing

    def _batch(self, rows: np.ndarray, columns: Columns, X: np.ndarray) -> Batch:
        if not self.whole:
            return Batch(rows, columns, None)
        return Batch(rows, columns, tuple(self._template(tuple(X[row])) for row in rows))  # type: ignore[arg-type]

    def _made(self, key: tuple[float, ...]) -> Design | str:
        """The base with the values that go the plain route, or why there is none."""
        chosen = [self.parameters[i] for i in self._plain]
        try:
            return self._read(assigned(self.study.data, ((p.path, p.value(x)) for p, x in zip(chosen, key, strict=True))))
        except SpheredriveError as error:
            return str(error)

    def _filled(self, template: Design, X: np.ndarray) -> tuple[np.ndarray, Columns]:
        """Which of the points X are sure to be machines, and the columns of those."""
        sure = np.ones(len(X), bool)
        for i in self._numeric:
            sure &= _in_range(X[:, i], self.parameters[i].path.meta["sign"])
        columns = columns_of([template])[0][1].repeated(len(X))
        angles: dict[int, dict[str, np.ndarray]] = {}
        for i in self._numeric:
            for place in self.parameters[i].path.places:
                if place[0] == "placement":
                    angles.setdefault(int(place[1]), {})[str(place[2])] = X[:, i]
                else:
                    columns = _SETTERS[_pattern(place)](columns, place, X[:, i], template)
        for ring, given in angles.items():
            sure &= self._place(columns, template, ring, given)
        sure &= _geometry_is_sure(columns, template, bool(angles), self._shapes_vary)
        chosen = {name: getattr(columns, name)[sure] for name in columns._arrays()}
        return sure, columns if sure.all() else replace(columns, **chosen)

    @property
    def _shapes_vary(self) -> bool:
        return any(place[0] in ("wheels", "sphere") for i in self._numeric for place in self.parameters[i].path.places)

    def _place(self, columns: Columns, template: Design, ring: int, given: dict[str, np.ndarray]) -> np.ndarray:
        """Turn the wheels of a ring as ``Placement.at`` does; which of the points are sure to have a place."""
        entry = self._entry(ring)
        b = len(columns)
        azimuth, elevation, heading = (given.get(key, np.full(b, entry[key])) for key in ("azimuth", "elevation", "heading"))
        wheels = [w for w, p in enumerate(template.placements) if p.ring == ring + 1]
        sure = np.abs(elevation) <= math.pi / 2
        for k, w in enumerate(wheels):
            around = azimuth + 2 * math.pi * k / len(wheels)
            R_hat, v_hat = _unit(outward(around, elevation)), _unit(heading_direction(around, elevation, heading))
            along = _sum(R_hat * v_hat)
            off = along != 0.0
            v_hat[off] = _unit(v_hat[off] - along[off, None] * R_hat[off])
            columns.contact_direction[:, w], columns.drive_direction[:, w] = R_hat, v_hat
        return sure

    @lru_cache(maxsize=1000)  # noqa: B019 - one study is short-lived
    def _entry(self, ring: int) -> dict[str, float]:
        """The angles of a ring in the base design, as the file gives them."""
        from spheredrive.io.design_path import resolve

        return {
            key: float(resolve(f"placement.{ring + 1}.{key}", self.study.data).base[0])
            for key in ("azimuth", "elevation", "heading")
        }


def _groups(keys: np.ndarray):
    """Rows with equal ``keys`` (b, d), and the key, in the order of their first rows."""
    if not keys.shape[1]:
        yield np.arange(len(keys)), ()
        return
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    inverse = inverse.reshape(-1)
    order = np.argsort(inverse, kind="stable")
    ends = np.cumsum(np.bincount(inverse))
    for group in np.argsort(first):
        rows = order[ends[group - 1] if group else 0 : ends[group]]
        yield rows, tuple(keys[rows[0]].tolist())


def _in_range(values: np.ndarray, sign: str) -> np.ndarray:
    """Whether numbers pass ``values.checked_number``."""
    least = {"positive": SMALLEST, "non-negative": 0.0}.get(sign, -LARGEST)
    return (values >= least) & (values <= LARGEST)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (b, 3) of nearly unit length over their length, which is rounded as ``math.hypot`` does it.

    With x² split into the double it rounds to and the rest, Σx² − 1 = e is known to twice the digits, and √(1 + e) rounds as
    1 + e/2.
    """
    square = vectors * vectors
    high = vectors * 134217729.0
    high = high - (high - vectors)
    low = vectors - high
    rest = ((high * high - square) + 2.0 * high * low) + low * low
    a, b, c = square.T
    s = a + b
    t = s - a
    lost = (a - (s - t)) + (b - t)
    total = s + c
    t = total - s
    lost = lost + ((s - (total - t)) + (c - t))
    length = 1.0 + 0.5 * ((total - 1.0) + (lost + rest.sum(axis=1)))
    return vectors / length[:, None]


def _sum(terms: np.ndarray) -> np.ndarray:
    """Σ of terms (b, 3) as Python's ``sum`` does it, which keeps what rounding loses from version 3.12 on."""
    a, b, c = terms.T
    if sys.version_info < (3, 12):
        return a + b + c
    s = a + b
    lost = np.where(np.abs(a) >= np.abs(b), (a - s) + b, (b - s) + a)
    total = s + c
    lost = lost + np.where(np.abs(s) >= np.abs(c), (s - total) + c, (c - total) + s)
    return total + lost


def _geometry_is_sure(columns: Columns, template: Design, turned: bool, shaped: bool) -> np.ndarray:
    """Whether no two wheels come close, and every wheel and race is far from what its type refuses."""
    sure = np.ones(len(columns), bool)
    if turned:
        split = [w for w, wheel in enumerate(template.wheels) if any(r.antipodal for r in template.races(wheel))]
        places = np.concatenate([columns.contact_direction, -columns.contact_direction[:, split]], axis=1)
        for i in range(places.shape[1]):
            for j in range(i):
                apart = places[:, i] - places[:, j]
                sure &= (apart * apart).sum(axis=1) > CLOSE**2
    if not shaped:
        return sure
    sphere = template.sphere
    sure &= math.hypot(*sphere.centre_of_mass) < 0.999 * columns.sphere_radius
    if not isinstance(sphere.inertia, str):
        sure[:] = False
    for w, wheel in enumerate(template.wheels):
        tilt, radius = np.abs(columns.roller_angle[:, w]), columns.wheel_radius[:, w]
        sure &= (tilt >= math.radians(1.001)) & (tilt <= math.pi / 2) & (wheel.roller_section < 0.999 * radius)
        for race in template.races(wheel):
            sure &= abs(race.offset) < 0.999 * (columns.sphere_radius + race.roller_radius)
    return sure


def _vectorised(parameter: Parameter, study: Study) -> bool:
    path = parameter.path
    if not path.numeric or path.whole or parameter.choices:
        return False
    return all(_pattern(place) in _SETTERS and _fits(place, study) for place in path.places)


def _fits(place: Place, study: Study) -> bool:
    if place[0] == "placement":
        return "count" in study.data["placement"][place[1]]
    if place[0] == "wheels":
        # A measured outline has its radius from its table.
        return not any(isinstance(w, MeasuredWheel) for w in study.design.wheels if w.name == place[1])
    return True


def _pattern(place: Place) -> tuple[str, ...]:
    """A place without the names and numbers in it."""
    if place[0] in ("placement", "wheels"):
        return str(place[0]), str(place[-1])
    return tuple(str(part) for part in place if isinstance(part, str))


def _column(name: str) -> Callable[..., Columns]:
    def set_column(columns: Columns, place: Place, values: np.ndarray, template: Design) -> Columns:
        return replace(columns, **{name: values.copy()})

    return set_column


def _wheel_column(name: str) -> Callable[..., Columns]:
    def set_column(columns: Columns, place: Place, values: np.ndarray, template: Design) -> Columns:
        mine = np.array([wheel.name == place[1] for wheel in template.wheels])
        own = getattr(columns, name)
        if own is None:
            if not mine.all():
                # The other models give none: what some lack, all do without.
                return columns
            own = np.empty((len(columns), columns.wheel_count))
        own[:, mine] = values[:, None]
        return replace(columns, **{name: own})

    return set_column


def _set_closure_force(columns: Columns, place: Place, values: np.ndarray, template: Design) -> Columns:
    columns.closure_force[:, int(place[2])] = values
    return columns


def _angle(*_: Any) -> Columns:
    raise AssertionError("angles of a ring are set together")


_SETTERS: dict[tuple[str, ...], Callable[..., Columns]] = {
    ("placement", "azimuth"): _angle,
    ("placement", "elevation"): _angle,
    ("placement", "heading"): _angle,
    ("wheels", "radius"): _wheel_column("wheel_radius"),
    ("wheels", "roller_angle"): _wheel_column("roller_angle"),
    ("wheels", "mass"): _wheel_column("wheel_mass"),
    ("sphere", "radius"): _column("sphere_radius"),
    ("sphere", "mass"): _column("sphere_mass"),
    ("contact", "stiffness"): _column("contact_stiffness"),
    ("contact", "damping"): _column("contact_damping"),
    ("contact", "friction"): _column("friction"),
    ("mount", "stiffness"): _column("mount_stiffness"),
    ("mount", "damping"): _column("mount_damping"),
    ("closure", "stiffness"): _column("closure_stiffness"),
    ("closure", "damping"): _column("closure_damping"),
    ("closure", "force"): _set_closure_force,
    ("motor", "torque"): _column("motor_torque"),
}
