"""Poses of the machine over time: of a run of ``simulate``, or at constant wheel speeds."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.errors import NearSingularWarning, SpheredriveError
from spheredrive.motion import Motion, Series

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False)
class Track:
    """Poses at k times. Lengths in m, angles in rad, forces in N; what a run does not tell is None.

    time              (k,), s, rising
    orientation       of the sphere, scalar-first quaternions, body to inertial, (k, 4)
    angular_velocity  Ω, inertial frame, (k, 3), rad/s
    wheel_angle       (k, n)
    wheel_speed       (k, n), rad/s
    touching          whether each contact of ``Machine.contacts`` carries the sphere, (k, m)
    stage             position of the stage, (k, 3)
    displacement      of the sphere's centre on the stage, (k, 3)
    normal_force      (k, m)
    slip_speed        (k, m), m/s
    """

    time: np.ndarray
    orientation: np.ndarray
    angular_velocity: np.ndarray
    wheel_angle: np.ndarray
    wheel_speed: np.ndarray
    touching: np.ndarray
    stage: np.ndarray
    displacement: np.ndarray
    normal_force: np.ndarray | None = None
    slip_speed: np.ndarray | None = None

    @property
    def duration(self) -> float:
        """From the first time to the last, s."""
        return float(self.time[-1] - self.time[0])

    @property
    def shakes(self) -> bool:
        """Whether the sphere's centre moves on the stage at all."""
        return bool(np.abs(self.displacement).max() > 0)

    def index(self, time: float) -> int:
        """The last sample at or before ``time``."""
        return int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 1))

    def thinned(self, most: int) -> Track:
        """The same track on at most ``most`` of its samples, evenly by number, first and last among them."""
        if len(self.time) <= most:
            return self
        keep = np.unique(np.round(np.linspace(0, len(self.time) - 1, most)).astype(int))
        return self.at(keep)

    def at(self, keep) -> Track:
        """The track at the samples ``keep``."""
        cut: dict[str, Any] = {name: None if value is None else value[keep] for name, value in vars(self).items()}
        return Track(**cut)


def track_of_run(design: Design, run: xarray.Dataset) -> Track:
    """The track of a ``run`` of ``design``.

    Which contacts carry the sphere is told by the normal forces where a model works contacts out one by one, else by the
    races that the run names. Raises ``SpheredriveError`` for a run of a machine of another shape, or without samples.
    """
    n, pairs = design.wheel_count, _contact_numbers(design)
    if run["wheel_speed"].shape[1:] != (n,):
        raise SpheredriveError(
            f"the run is of a machine with {run['wheel_speed'].shape[-1]} wheels, but the design has {n}; "
            "open the run with the design it was made of"
        )
    if "contact" in run.sizes and run.sizes["contact"] != len(pairs):
        raise SpheredriveError(
            f"the run has {run.sizes['contact']} contacts, but the design {len(pairs)}; open it with the design it was made of"
        )
    if not run.sizes["time"]:
        raise SpheredriveError(f"the run has no samples: {run.attrs.get('reason', 'it did not begin')}")

    still, force = np.zeros((run.sizes["time"], 3)), _values(run, "normal_force")
    found = Track(
        time=np.asarray(run["time"].values, float),
        orientation=np.asarray(run["orientation"].values, float),
        angular_velocity=np.asarray(run["angular_velocity"].values, float),
        wheel_angle=np.asarray(run["wheel_angle"].values, float),
        wheel_speed=np.asarray(run["wheel_speed"].values, float),
        touching=_touching(design, run, pairs, force),
        stage=_values(run, "stage_position", still),
        displacement=_values(run, "centre_displacement", still),
        normal_force=force,
        slip_speed=_values(run, "slip_speed"),
    )
    _refuse_nonsense(found, n, len(pairs))
    return found


def track_of_speeds(design: Design, wheel_speed, duration: float = 10.0, rate: float = 50.0) -> Track:
    """The machine at constant wheel speeds ω (n,), rad/s, followed by kinematics alone for ``duration`` s.

    Where the wheels do not determine the sphere's motion it stands still. Raises ``SpheredriveError`` for speeds that do not
    fit the design.
    """
    speeds = np.asarray(wheel_speed, float)
    if speeds.shape != (design.wheel_count,) or not np.isfinite(speeds).all():
        raise SpheredriveError(f"wheel_speed takes one finite number for each of the {design.wheel_count} wheels")
    series = Series((0.0, duration), (tuple(speeds), tuple(speeds)))
    motion = Motion("wheel-speed", series, duration, sample_rate=rate)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NearSingularWarning)
            found = kinematics.along(design, motion)
    except SpheredriveError:
        return _still(design)
    # A change of race stands twice among the samples; what comes after it counts.
    last = np.append(found.time[1:] != found.time[:-1], True)
    time, state = found.time[last], found.state[last]
    still = np.zeros((len(time), 3))
    return Track(
        time,
        found.orientation[last],
        found.angular_velocity[last],
        found.wheel_angle[last],
        found.wheel_speed[last],
        _of_states(design, state),
        still,
        still,
    )


def touching_at(design: Design, wheel_angle) -> np.ndarray:
    """Whether each contact of ``Machine.contacts`` carries the sphere at wheel angles (..., n): (..., m)."""
    return _of_states(design, kinematics.state_index(design, wheel_angle))


def _refuse_nonsense(track: Track, n: int, m: int) -> None:
    """Refuse arrays of other shapes than a run's, what is not finite, and times that fall: files can hold anything."""
    k = len(track.time)
    widths = {"orientation": 4, "angular_velocity": 3, "wheel_angle": n, "wheel_speed": n, "touching": m, "stage": 3}
    widths |= {"displacement": 3, "normal_force": m, "slip_speed": m}
    for name, width in widths.items():
        values = getattr(track, name)
        if values is not None and (values.shape != (k, width) or not np.isfinite(values).all()):
            raise SpheredriveError(f"the run's {name.replace('_', ' ')} is not one of numbers for each of its {k} times")
    if not np.isfinite(track.time).all() or (np.diff(track.time) < 0).any():
        raise SpheredriveError("the run's times do not rise")


def _values(run: xarray.Dataset, name: str, absent: Any = None) -> Any:
    return np.asarray(run[name].values, float) if name in run else absent


def _still(design: Design) -> Track:
    n, nothing = design.wheel_count, np.zeros((1, 3))
    angle = np.zeros((1, n))
    upright = np.array([[1.0, 0.0, 0.0, 0.0]])
    return Track(np.zeros(1), upright, nothing, angle, angle, touching_at(design, angle), nothing, nothing)


def _contact_numbers(design: Design) -> list[tuple[int, int]]:
    return [(i, race.number) for i, wheel in enumerate(design.wheels) for race in design.races(wheel)]


def _of_states(design: Design, state: np.ndarray) -> np.ndarray:
    """Contacts that touch while the wheels show the entries ``state`` (..., n) of their alternations."""
    columns = []
    for i, number in _contact_numbers(design):
        touches = np.array([number in together for together in design.wheels[i].alternation])
        columns.append(touches[state[..., i]])
    return np.stack(columns, axis=-1)


def _touching(design: Design, run: xarray.Dataset, pairs: list[tuple[int, int]], force: np.ndarray | None) -> np.ndarray:
    if run.attrs.get("model") != "rolling" and force is not None:
        return force > 0
    if "active_race" not in run:
        return touching_at(design, np.asarray(run["wheel_angle"].values, float))
    active = np.asarray(run["active_race"].values, int)
    columns = []
    for i, number in pairs:
        # 0: the wheel rests between its races, and those that take turns share it.
        turns = number in sum(design.wheels[i].alternation, ())
        together = [group for group in design.wheels[i].alternation if number in group]
        shown = np.isin(active[:, i], [race for group in together for race in group])
        columns.append(shown | ((active[:, i] == 0) & turns))
    return np.stack(columns, axis=-1)
