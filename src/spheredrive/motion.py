"""A motion: what is asked of the machine over time, as a frozen value."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from spheredrive.errors import DesignError
from spheredrive.values import check_fields, checked_number, quantity, word

KINDS = ("wheel-speed", "wheel-torque", "sphere-velocity")


@dataclass(frozen=True)
class Series:
    """Values over time: ``time`` (k,) rising, s; ``values`` (k, c); straight lines or steps between them.

    Before the first time the first value holds, after the last the last.
    """

    time: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]
    interpolation: str = word("how values run between times", ("linear", "step"), default="linear")

    def __post_init__(self) -> None:
        check_fields(self)
        time = tuple(checked_number(t, "s", "any", ("time", i)) for i, t in enumerate(self.time))
        values = tuple(
            tuple(checked_number(v, "", "any", ("values", i, j)) for j, v in enumerate(row))
            for i, row in enumerate(self.values)
        )
        if not time:
            raise DesignError("needs at least one time", ("time",))
        for i, (earlier, later) in enumerate(itertools.pairwise(time)):
            if later <= earlier:
                raise DesignError(f"must rise from entry to entry, but {later:g} follows {earlier:g}", ("time", i + 1))
        if len(values) != len(time):
            raise DesignError(f"has {len(values)} rows for {len(time)} times", ("values",))
        for i, row in enumerate(values):
            if len(row) != len(values[0]) or not row:
                raise DesignError(f"has {len(row)} entries, the first row {len(values[0])}", ("values", i))
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "values", values)

    @property
    def columns(self) -> int:
        """How many values there are at each time."""
        return len(self.values[0])

    @cached_property
    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """``time`` (k,) and ``values`` (k, c) as arrays."""
        return np.array(self.time), np.array(self.values)

    def at(self, time, side: str = "right") -> np.ndarray:
        """Values at ``time`` (...), shape (..., c); at a step, those after it, or before it for ``side="left"``."""
        time = np.asarray(time, float)
        knots, values = self.arrays
        if self.interpolation == "linear":
            return np.stack([np.interp(time, knots, column) for column in values.T], axis=-1)
        i = np.clip(np.searchsorted(knots, time, side=side) - 1, 0, len(knots) - 1)
        return values[i]

    def integral(self, time) -> np.ndarray:
        """∫ values dt from 0 to ``time`` (...), shape (..., c): exact for straight lines and for steps."""
        return self._antiderivative(np.asarray(time, float)) - self._antiderivative(np.zeros(()))

    def _antiderivative(self, time: np.ndarray) -> np.ndarray:
        """∫ values dt from the first time on; the first and last values hold outside."""
        knots, values = self.arrays
        span, rise = np.diff(knots)[:, None], np.diff(values, axis=0)
        if self.interpolation == "step":
            rise = np.zeros_like(rise)
        before = np.concatenate([np.zeros((1, self.columns)), np.cumsum(span * (values[:-1] + rise / 2), axis=0)])
        slope = np.concatenate([rise / span, np.zeros((1, self.columns))])
        i = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(knots) - 1)
        since = (time - knots[i])[..., None]
        # Before the first time, where ``since`` is negative, the first value holds: there is no slope.
        return before[i] + since * values[i] + np.where(since > 0, slope[i], 0.0) * since**2 / 2


@dataclass(frozen=True)
class StageMotion:
    """What moves the stage: a force beyond the weight it carries (N), or its position (m), over time."""

    kind: str = word("what is given", ("force", "position"))
    series: Series = field()

    def __post_init__(self) -> None:
        check_fields(self)
        if self.series.columns != 3:
            raise DesignError(f"takes three values at a time, not {self.series.columns}", ("values", 0))


@dataclass(frozen=True)
class Motion:
    """What is asked of the machine.

    ``kind`` says what ``series`` holds: wheel speeds (rad/s), wheel torques (N m), one column a wheel, or the sphere's
    angular velocity (rad/s, x, y, z, inertial frame). Initial values that are None follow from the rest, or are zero.
    """

    kind: str = word("what is prescribed", KINDS)
    series: Series = field()
    duration: float = quantity("s", "how long the motion lasts")
    angular_velocity: tuple[float, ...] | None = quantity(
        "rad/s", "of the sphere at the start", sign="any", shape=(3,), default=None
    )
    wheel_angle: tuple[float, ...] | None = field(default=None)
    orientation: tuple[float, ...] = quantity(
        "", "at the start, scalar first, body to inertial", sign="any", shape=(4,), default=(1.0, 0.0, 0.0, 0.0)
    )
    centre_displacement: tuple[float, ...] | None = quantity(
        "m", "of the sphere's centre at the start; its static seat if absent", sign="any", shape=(3,), default=None
    )
    centre_velocity: tuple[float, ...] | None = quantity(
        "m/s", "of the sphere's centre at the start", sign="any", shape=(3,), default=None
    )
    stage: StageMotion | None = field(default=None)
    sample_rate: float = quantity("Hz", "samples a second in the results", default=1000.0)
    source: str = field(default="", compare=False, repr=False)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.kind == "sphere-velocity" and self.series.columns != 3:
            raise DesignError(f"takes three values at a time (x, y, z), not {self.series.columns}", ("motion", "values", 0))
        length = float(np.linalg.norm(self.orientation))
        if abs(length - 1) > 1e-3:
            raise DesignError(f"must be a unit quaternion, but has length {length:g}", ("initial", "orientation"))
        if self.angular_velocity is not None and self.kind != "wheel-torque":
            raise DesignError(f"is settled by the prescribed {self.kind}; leave it out", ("initial", "angular_velocity"))
        if self.wheel_angle is not None:
            checked = tuple(
                checked_number(a, "rad", "any", ("initial", "wheel_angle", i)) for i, a in enumerate(self.wheel_angle)
            )
            object.__setattr__(self, "wheel_angle", checked)
        if self.duration * self.sample_rate > 1e9:
            raise DesignError(
                "asks for more than 1e9 samples; lower the sample rate or the duration", ("output", "sample_rate")
            )

    def check_wheel_count(self, wheel_count: int) -> None:
        """Raise ``DesignError`` where the motion is for another number of wheels."""
        if self.kind != "sphere-velocity" and self.series.columns != wheel_count:
            raise DesignError(
                f"has {self.series.columns} columns, but the design has {wheel_count} wheels", ("motion", "values", 0)
            )
        if self.wheel_angle is not None and len(self.wheel_angle) != wheel_count:
            raise DesignError(
                f"has {len(self.wheel_angle)} entries, but the design has {wheel_count} wheels", ("initial", "wheel_angle")
            )
