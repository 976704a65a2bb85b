"""Runs of the rolling model: a design and a motion in, arrays over time out."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.dynamics.parameters import rolling_parameters
from spheredrive.dynamics.rolling import (
    ANGLE,
    HALF_PITCH,
    HEAT,
    MOTOR_WORK,
    OMEGA,
    ORIENTATION,
    POSITION,
    RESTING,
    STAGE_WORK,
    STILL,
    VELOCITY,
    WHEEL_SPEED,
)
from spheredrive.errors import SpheredriveError
from spheredrive.kinematics import active_races, jacobian, slip
from spheredrive.simulation.inputs import KINDS, inputs_of
from spheredrive.simulation.lanes import SIZE

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

# Steps between two looks at the outside world: a progress bar, a wish to stop.
STEPS_AT_ONCE = 20_000
FIRST_EVENTS = 4096
# No wheel turns faster, rad/s, a million turns a minute: races would change more often than a run can follow.
FASTEST = 1e5
TOO_FAST = 7


@dataclass(frozen=True)
class Tolerance:
    """How a run is integrated: relative and absolute error of a step, or a fixed step (s) without error control."""

    relative: float = 1e-10
    absolute: float = 1e-12
    fixed_step: float = 0.0
    largest_step: float = math.inf


@dataclass(frozen=True)
class RollingRun:
    """A run of the rolling model, k samples, n wheels, e events; SI, inertial frame.

    completed          whether the run reached its duration; ``reason`` says why not
    time               (k,)
    state              entry of each wheel's alternation in contact, 2 for a wheel that rests between its races, (k, n)
    angular_velocity, angular_acceleration, stage_position, stage_velocity, stage_acceleration   (k, 3)
    orientation        scalar first, body to inertial, (k, 4)
    wheel_angle, wheel_speed, motor_torque, normal_force, friction_force   (k, n)
    motor_work, stage_work, heat, kinetic, potential, impact_loss, residual   (k,), J: the ledger, which holds
                       kinetic + potential + heat + impact_loss − motor_work − stage_work − (its start) = residual
    event_time, event_wheel, event_loss, event_impulse   changes of race (wheel from 0) and jumps of the input (−1):
                       s, –, J, N m s as a moment on the sphere, (e,) and (e, 3)
    """

    completed: bool
    reason: str
    time: np.ndarray
    state: np.ndarray
    angular_velocity: np.ndarray
    angular_acceleration: np.ndarray
    orientation: np.ndarray
    wheel_angle: np.ndarray
    wheel_speed: np.ndarray
    motor_torque: np.ndarray
    normal_force: np.ndarray
    friction_force: np.ndarray
    stage_position: np.ndarray
    stage_velocity: np.ndarray
    stage_acceleration: np.ndarray
    motor_work: np.ndarray
    stage_work: np.ndarray
    heat: np.ndarray
    kinetic: np.ndarray
    potential: np.ndarray
    impact_loss: np.ndarray
    residual: np.ndarray
    event_time: np.ndarray
    event_wheel: np.ndarray
    event_loss: np.ndarray
    event_impulse: np.ndarray


def run_rolling(
    design: Design,
    motion: Motion,
    tolerance: Tolerance = Tolerance(),
    watch: Callable[[float], None] | None = None,
) -> RollingRun:
    """Integrate the rolling model 5a along ``motion``.

    ``watch`` is called now and then with the share that is done; what it raises stops the run. Raises ``SpheredriveError``
    for what the design lacks, ``SingularError`` where prescribed wheel speeds do not determine the sphere's motion. A run that
    cannot go on ends there, with its reason.
    """
    return run_rolling_batch([design], [motion], tolerance, watch)[0]


def run_rolling_batch(
    designs: Sequence[Design],
    motions: Sequence[Motion],
    tolerance: Tolerance = Tolerance(),
    watch: Callable[[float], None] | None = None,
) -> list[RollingRun]:
    """Runs of several designs or motions on all cores; one of either serves for all. Results do not depend on the batch.

    All runs must have the same number of wheels, kind of drive, duration and samples. Raises as ``run_rolling``.
    """
    count = max(len(designs), len(motions))
    designs, motions = spread(designs, count, "designs"), spread(motions, count, "motions")
    arrays = _Arrays(designs, motions, tolerance)
    arrays.advance(watch)
    return [arrays.run(i) for i in range(count)]


def spread(values: Sequence, count: int, name: str) -> list:
    """One value for each of ``count`` runs; a single one serves for all."""
    if len(values) not in (1, count):
        raise SpheredriveError(f"{len(values)} {name} do not fit {count} runs: give one for all or one each")
    return list(values) * (count if len(values) == 1 else 1)


class _Arrays:
    """Everything the engine reads and writes, the run on the first axis."""

    def __init__(self, designs, motions, tolerance: Tolerance):
        self.designs = designs
        first = motions[0]
        n = designs[0].wheel_count
        # A design or motion that serves for many runs is worked out once.
        known = {key: rolling_parameters(d) for key, d in {id(d): d for d in designs}.items()}
        parameters = [known[id(d)] for d in designs]
        pairs = {(id(d), id(m)): (d, m) for d, m in zip(designs, motions, strict=True)}
        asked = {key: _checked_inputs(*pair) for key, pair in pairs.items()}
        pieces, starts = zip(*(asked[id(d), id(m)] for d, m in zip(designs, motions, strict=True)), strict=True)
        _refuse_mixed_batch(designs, motions, pieces, starts)
        self.n = n
        self.kinds = np.array([KINDS[first.kind], starts[0].stage_kind])
        self.raw = parameters
        self.parameters = [np.array(arrays) for arrays in zip(*parameters, strict=True)]
        self.pieces = np.array(pieces)
        last = math.floor(first.duration * first.sample_rate * (1 + 1e-12) + 1e-9)
        self.samples = np.arange(last + 1) / first.sample_rate
        count, size, k = len(designs), ANGLE + n, len(self.samples)
        self.y = np.zeros((count, size))
        self.rate = np.zeros((count, SIZE))
        self.pitch = np.zeros((count, n), np.int64)
        self.resting = np.zeros((count, n), np.int64)
        for b, (design, motion, start) in enumerate(zip(designs, motions, starts, strict=True)):
            self.y[b] = _initial_state(design, motion, start)
            angle = self.y[b, ANGLE : ANGLE + n]
            self.pitch[b] = [
                0 if math.isinf(w.half_pitch) else w.half_pitches(a) for w, a in zip(design.wheels, angle, strict=True)
            ]
        self.clock = np.tile([0.0, min(1e-3, first.duration / 100), 0.0, 0.0], (count, 1))
        self.counters = np.zeros((count, 6))
        self.control = np.array([tolerance.relative, tolerance.absolute, tolerance.largest_step, tolerance.fixed_step])
        self.sampled = np.zeros((count, k, size))
        self.results = np.zeros((count, k, 3 * n + 6))
        self.states = np.zeros((count, k, n), np.int64)
        self.events = np.zeros((count, FIRST_EVENTS if count == 1 else 256, 6))
        self.status = np.ones(count, np.int64)
        self.energy_at_start = [self._energy_at_start(b) for b in range(count)]

    def _energy_at_start(self, b: int) -> float:
        states = np.where(np.isfinite(self.raw[b].wheels[:, HALF_PITCH]), self.pitch[b] % 2, 0)
        kinetic, potential = self._energies(b, self.y[b : b + 1], states[None])
        return kinetic[0] + potential[0]

    def advance(self, watch) -> None:
        from spheredrive.simulation import rolling_engine as engine

        machine, steps = engine.Machine(*self.parameters), STEPS_AT_ONCE
        task = engine.Task(self.kinds, self.pieces, self.samples, self.control)
        progress = engine.Progress(self.y, self.rate, self.pitch, self.resting, self.clock, self.counters)
        few = len(self.status) <= engine.LANES
        while (self.status == engine.RUNNING).any():
            record = engine.Record(self.sampled, self.results, self.states, self.events)
            if few:
                # Starting threads takes longer than a short run.
                engine.advance(machine, task, progress, record, 0, len(self.status), steps, self.status)
            else:
                engine.advance_on_all_cores(machine, task, progress, record, steps, self.status)
            full = self.status == engine.EVENTS_FULL
            if full.any():
                self.events = np.concatenate([self.events, np.zeros_like(self.events)], axis=1)
                self.status[full] = engine.RUNNING
                self.counters[full, 5] = 0
            self.status[(self.status == engine.RUNNING) & self._too_fast()] = TOO_FAST
            if watch is not None:
                watch(float(np.mean(self.clock[:, 0]) / self.pieces[0, -1, 1]))

    def _too_fast(self) -> np.ndarray:
        """Whether a wheel of each run that changes races turns faster than a machine can."""
        rows = np.array([p.contacts[:, 0, :3] * np.isfinite(p.wheels[:, HALF_PITCH])[:, None] for p in self.raw])
        speed = np.einsum("bni,bi->bn", rows, self.y[:, OMEGA : OMEGA + 3])
        return (np.abs(speed) > FASTEST).any(axis=1)

    def run(self, b: int) -> RollingRun:
        n, y = self.n, self.sampled[b]
        status, done = int(self.status[b]), int(self.counters[b, 0])
        y, out, states, time = y[:done], self.results[b, :done], self.states[b, :done], self.samples[:done]
        events = self.events[b, : int(self.counters[b, 2])]
        row = self.raw[b].contacts[np.arange(n), states, :3]
        work, stage_work, heat = y[:, MOTOR_WORK], y[:, STAGE_WORK], y[:, HEAT]
        lost = np.concatenate([[0.0], np.cumsum(events[:, 2])])[np.searchsorted(events[:, 0], time, side="right")]
        kinetic, potential = self._energies(b, y, states)
        residual = kinetic + potential - self.energy_at_start[b] + heat + lost - work - stage_work
        return RollingRun(
            completed=status == 0,
            reason=_REASONS[status].format(time=self.clock[b, 0]),
            time=time,
            state=states,
            angular_velocity=y[:, OMEGA : OMEGA + 3],
            angular_acceleration=out[:, 3 * n : 3 * n + 3],
            orientation=y[:, ORIENTATION : ORIENTATION + 4],
            wheel_angle=y[:, ANGLE : ANGLE + n],
            wheel_speed=np.where(states == RESTING, 0.0, np.einsum("kni,ki->kn", row, y[:, OMEGA : OMEGA + 3])),
            motor_torque=out[:, :n],
            normal_force=out[:, n : 2 * n],
            friction_force=out[:, 2 * n : 3 * n],
            stage_position=y[:, POSITION : POSITION + 3],
            stage_velocity=y[:, VELOCITY : VELOCITY + 3],
            stage_acceleration=out[:, 3 * n + 3 :],
            motor_work=work,
            stage_work=stage_work,
            heat=heat,
            kinetic=kinetic,
            potential=potential,
            impact_loss=lost,
            residual=residual,
            event_time=events[:, 0],
            event_wheel=events[:, 1].astype(int),
            event_loss=events[:, 2],
            event_impulse=events[:, 3:],
        )

    def _energies(self, b: int, y, states) -> tuple[np.ndarray, np.ndarray]:
        from spheredrive.dynamics.rolling import energies

        kinetic, potential = np.empty(len(y)), np.empty(len(y))
        energies(*self.raw[b], states, y, kinetic, potential)
        return kinetic, potential


def _refuse_mixed_batch(designs, motions, pieces, starts) -> None:
    shapes = {
        (d.wheel_count, m.kind, m.duration, m.sample_rate, start.stage_kind, len(piece))
        for d, m, piece, start in zip(designs, motions, pieces, starts, strict=True)
    }
    if len(shapes) > 1:
        raise SpheredriveError("runs of one batch need equal numbers of wheels, kinds of input, durations, samples and corners")


_REASONS = {
    0: "",
    2: "at {time:.9g} s the equations of motion have no solution: the wheels cannot make the motion asked for",
    3: "at {time:.9g} s the step became too small: the motion grows without limit or its inputs are too abrupt",
    4: "at {time:.9g} s races change back and forth without end",
    6: "at {time:.9g} s a number is no longer finite",
    7: "at {time:.9g} s a wheel turns faster than 1e5 rad/s: the motion grows without limit",
}


def _checked_inputs(design: Design, motion: Motion):
    motion.check_wheel_count(design.wheel_count)
    pieces, start = inputs_of(motion, design.motor.torque)
    if start.stage_kind != STILL and None in (design.sphere.mass, design.stage.mass, *(w.mass for w in design.wheels)):
        raise SpheredriveError("a moving stage needs the masses of the sphere, the stage and every wheel")
    if KINDS[motion.kind] == WHEEL_SPEED:
        _refuse_disagreeing_speeds(design, pieces)
    return pieces, start


def _refuse_disagreeing_speeds(design: Design, pieces) -> None:
    """More than three wheels must be given speeds that agree, for every contact state that differs."""
    jacobian(design)
    if design.wheel_count == 3:
        return
    n = design.wheel_count
    for first in (*pieces[:, 2 : 2 + n], *pieces[:, 2 + n : 2 + 2 * n]):
        if float(slip(design, first).overall) > 1e-9:
            raise SpheredriveError(
                f"the prescribed wheel speeds {np.array2string(first, precision=4)} rad/s disagree, so wheels would slip: the "
                "rolling model needs ω = B⁻¹AΩ for some Ω"
            )


def _initial_state(design: Design, motion: Motion, start) -> np.ndarray:
    n = design.wheel_count
    y = np.zeros(ANGLE + n)
    if motion.angular_velocity is not None:
        y[OMEGA : OMEGA + 3] = motion.angular_velocity
    y[ORIENTATION : ORIENTATION + 4] = np.array(motion.orientation) / np.linalg.norm(motion.orientation)
    y[POSITION : POSITION + 3], y[VELOCITY : VELOCITY + 3] = start.position, start.velocity
    if motion.wheel_angle is not None:
        y[ANGLE : ANGLE + n] = motion.wheel_angle
    if motion.kind != "wheel-torque":
        first = np.array(motion.series.at(0.0))
        if motion.kind == "wheel-speed":
            first = jacobian(design, active_races(design, y[ANGLE : ANGLE + n])) @ first
        y[OMEGA : OMEGA + 3] = first
    return y
