"""Runs of the compliant model: designs and motions in, arrays over time out."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.dynamics import rolling
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.machine import Machine, machine
from spheredrive.dynamics.compliant.station import NORMAL, PRESSED, TANGENTIAL
from spheredrive.errors import SpheredriveError
from spheredrive.kinematics import forward, inverse
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant import engine
from spheredrive.simulation.compliant.methods import METHODS, Method
from spheredrive.simulation.compliant.room import room
from spheredrive.simulation.compliant.seat import instant, seat
from spheredrive.simulation.inputs import inputs_of

if TYPE_CHECKING:
    from spheredrive.design import Design

STEPS_AT_ONCE = 20_000
FIRST_EVENTS = 512


@dataclass(frozen=True)
class Accuracy:
    """How a compliant run is integrated.

    length          error of a step as a length, m; of speeds over 10 ms or the step
    ledger          how far the energy ledger of a step may be off, as a share of the energy that moves in it
    largest_step, shortest_step   s
    method          "rodas4" or "rodas3"
    """

    length: float = 1e-9
    ledger: float = 1e-3
    largest_step: float = 0.05
    shortest_step: float = 1e-13
    method: str = "rodas4"


@dataclass(frozen=True)
class CompliantRun:
    """A run of the compliant model: k samples, n wheels, m stations, q outlines, e events; SI, inertial frame.

    states, rates       the whole state and its derivative, (k, size), as ``dynamics.compliant.layout`` orders them
    motor_torque        (k, n)
    touches             normal force, friction along û, slip speed, least gap, slip power, largest force of one roller,
                        and what the engine needs to know of rollers that begin or cease to press, of each outline, (k, q, 9)
    stored              elastic energy of the contacts, J, (k,)
    works               of motors, stage, slip, contact damping, other resistances, then slip by outline, J, (k, 5 + q)
    events              time, station, 1 where it begins to press and 0 where it ceases to, (e, 3)
    steps               accepted and refused
    """

    design: Design
    machine: Machine
    completed: bool
    reason: str
    time: np.ndarray
    states: np.ndarray
    rates: np.ndarray
    motor_torque: np.ndarray
    touches: np.ndarray
    stored: np.ndarray
    works: np.ndarray
    events: np.ndarray
    steps: tuple[int, int]

    @property
    def centre_displacement(self) -> np.ndarray:
        """c of the sphere's centre on the stage, m, (k, 3)."""
        return self.states[:, at.CENTRE : at.CENTRE + 3]

    @property
    def centre_velocity(self) -> np.ndarray:
        """ċ, m/s, (k, 3)."""
        return self.states[:, at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3]

    @property
    def angular_velocity(self) -> np.ndarray:
        """Ω, rad/s, inertial frame, (k, 3)."""
        return self.states[:, at.OMEGA : at.OMEGA + 3]

    @property
    def orientation(self) -> np.ndarray:
        """Scalar first, body to inertial, (k, 4)."""
        return self.states[:, at.QUATERNION : at.QUATERNION + 4]

    @property
    def wheel_angle(self) -> np.ndarray:
        """ϑ, rad, (k, n)."""
        return self._of_wheels(at.ANGLE)

    @property
    def wheel_speed(self) -> np.ndarray:
        """ω, rad/s, (k, n)."""
        return self._of_wheels(at.SPEED_OF_WHEEL)

    def _of_wheels(self, entry: int) -> np.ndarray:
        stop = at.WHEELS + at.WHEEL_STATES * len(self.machine.wheels)
        return self.states[:, at.WHEELS + entry : stop : at.WHEEL_STATES]

    @property
    def mount_deflection(self) -> np.ndarray:
        """Δ of each station along n̂, m, (k, m)."""
        begin = at.WHEELS + at.WHEEL_STATES * len(self.machine.wheels)
        stop = begin + at.STATION_STATES * len(self.machine.stations)
        return self.states[:, begin + at.DEFLECTION : stop : at.STATION_STATES]

    @property
    def normal_force(self) -> np.ndarray:
        """N of each wheel, all its contacts together, N, (k, n)."""
        return self._wheel_sums(self.touches[:, :, NORMAL])

    @property
    def friction_force(self) -> np.ndarray:
        """Friction along û of each wheel, all its contacts together, N, (k, n)."""
        return self._wheel_sums(self.touches[:, :, TANGENTIAL])

    def _wheel_sums(self, values: np.ndarray) -> np.ndarray:
        wheel = np.array([i - 1 for i, _ in self.machine.contacts])
        return np.stack([values[:, wheel == i].sum(axis=1) for i in range(len(self.machine.wheels))], axis=1)

    @property
    def lift_offs(self) -> np.ndarray:
        """Intervals in which nothing presses: wheel from 0, begin and end in s (the run's end where it lasts), (e, 3)."""
        found = []
        open_since = dict.fromkeys(np.flatnonzero(~self._pressed_at_start), 0.0)
        for time, station, made in self.events:
            if made:
                found.append((station, open_since.pop(int(station), 0.0), time))
            else:
                open_since[int(station)] = time
        end = float(self.time[-1]) if len(self.time) else 0.0
        found += [(station, since, max(end, since)) for station, since in open_since.items()]
        wheel = self.machine.stations[:, at.STATION_WHEEL]
        rows = sorted((begin, wheel[int(station)], stop) for station, begin, stop in found)
        return np.array([(w, begin, stop) for begin, w, stop in rows]).reshape(-1, 3)

    @property
    def _pressed_at_start(self) -> np.ndarray:
        first = {}
        for _, station, made in self.events:
            first.setdefault(int(station), not made)
        pressed = self.touches[0, :, NORMAL] > 0 if len(self.time) else np.ones(len(self.machine.outlines), bool)
        begins = self.machine.stations[:, at.FIRST_OUTLINE].astype(int)
        counts = self.machine.stations[:, at.OUTLINE_COUNT].astype(int)
        return np.array(
            [first.get(s, bool(pressed[b : b + c].any())) for s, (b, c) in enumerate(zip(begins, counts, strict=True))]
        )


def run_compliant(design, motion, accuracy: Accuracy = Accuracy(), watch=None) -> CompliantRun:
    """One run of the compliant model; see ``run_compliant_batch``."""
    return run_compliant_batch([design], [motion], accuracy, watch)[0]


def run_compliant_batch(
    designs: Sequence[Design],
    motions: Sequence[Motion],
    accuracy: Accuracy = Accuracy(),
    watch: Callable[[float], None] | None = None,
    device: str = "cpu",
) -> list[CompliantRun]:
    """Runs of several designs or motions on all cores; one of either serves for all. Results do not depend on the batch.

    ``device`` is "cpu"; "gpu", a graphics card, whose last places may differ (see ``gpu``); or "auto", the card where
    there is one, else the cores, with a warning that says so. Raises ``SpheredriveError`` where "gpu" cannot be had.
    """
    from spheredrive.simulation.compliant.gpu import advance_batch_on_gpu, device_with_note
    from spheredrive.simulation.rolling_run import spread

    device = device_with_note(device)
    count = max(len(designs), len(motions))
    designs, motions = spread(designs, count, "designs"), spread(motions, count, "motions")
    arrays = _Arrays(designs, motions, accuracy)
    if device == "gpu":
        advance_batch_on_gpu(arrays, watch)
    else:
        arrays.advance(watch)
    return [arrays.run(b) for b in range(count)]


def wheel_motion(design: Design, motion: Motion) -> Motion:
    """``motion`` with a velocity of the sphere turned into wheel speeds by the nominal Jacobian: what a controller does."""
    if motion.kind != "sphere-velocity":
        return motion
    values = inverse(design, np.array(motion.series.values))
    series = Series(motion.series.time, tuple(map(tuple, values.tolist())), motion.series.interpolation)
    return replace(motion, kind="wheel-speed", series=series)


def packed(method: Method) -> np.ndarray:
    """A method's coefficients as the rows that ``step.trial`` takes."""
    stages = len(method.alpha)
    rows = np.zeros((stages + 3, 2 * stages + 2))
    rows[0, 0] = method.gamma
    rows[1:-2, :stages], rows[1:-2, stages : 2 * stages] = method.a, method.c
    rows[1:-2, 2 * stages], rows[1:-2, 2 * stages + 1] = method.alpha, method.gammas
    rows[-2, :stages], rows[-2, stages : 2 * stages] = method.m, method.e
    rows[-1, :stages], rows[-1, stages : 2 * stages] = method.dense
    return rows


class _Arrays:
    """Everything the engine reads and writes, the run on the first axis."""

    def __init__(self, designs, motions, accuracy: Accuracy):
        self.designs = designs
        known = {key: machine(d) for key, d in {id(d): d for d in designs}.items()}
        self.machines = [known[id(d)] for d in designs]
        motions = [wheel_motion(d, m) for d, m in zip(designs, motions, strict=True)]
        first = motions[0]
        for design, motion in zip(designs, motions, strict=True):
            motion.check_wheel_count(design.wheel_count)
        self.drive_kind = _drive_kind(designs[0], first)
        asked = [inputs_of(m, d.motor.torque) for d, m in zip(designs, motions, strict=True)]
        self.inputs = np.array([pieces for pieces, _ in asked])
        starts = [start for _, start in asked]
        self.stage_kind = {rolling.STILL: at.STILL, rolling.FORCE: at.DRIVEN, rolling.ACCELERATION: at.MOVED}[
            starts[0].stage_kind
        ]
        if self.stage_kind == at.DRIVEN and any(d.stage.mass is None for d in designs):
            raise SpheredriveError("a force on the stage needs stage.mass")
        last = math.floor(first.duration * first.sample_rate * (1 + 1e-12) + 1e-9)
        self.samples = np.arange(last + 1) / first.sample_rate
        self.duration = first.duration
        self.method = METHODS[accuracy.method]
        self.control = np.array([_control(m, accuracy) for m in self.machines])
        count, size = len(designs), self.machines[0].state_size
        n, m, q = len(self.machines[0].wheels), len(self.machines[0].stations), len(self.machines[0].outlines)
        k = len(self.samples)
        self.places = np.array([m.places for m in self.machines])
        self.turns = np.zeros((count, q))
        self.y = np.zeros((count, size))
        self.acting = np.zeros((count, q), np.int64)
        self.touching = np.zeros((count, m))
        for b in range(count):
            self.y[b] = self._start(b, designs[b], motions[b], starts[b])
        self.clock = np.tile([0.0, 1e-6, 0.0, 0.0], (count, 1))
        self.counters = np.zeros((count, 4))
        self.works = np.zeros((count, at.POWERS + q))
        self.weights = np.array([_weights(m, d, accuracy.length) for m, d in zip(self.machines, designs, strict=True)])
        self.kept = [
            np.zeros((count, k, size)), np.zeros((count, k, size)), np.zeros((count, k, n)), np.zeros((count, k, q, 9)),
            np.zeros((count, k)), np.zeros((count, k, at.POWERS + q)),
        ]  # fmt: skip
        self.events = np.zeros((count, FIRST_EVENTS, 3))
        self.status = np.ones(count, np.int64)

    def _start(self, b: int, design: Design, motion: Motion, start) -> np.ndarray:
        """The static seat, or where the motion puts the centre; the sphere turning as the nominal Jacobian has it."""
        m = self.machines[b]
        y = np.zeros(m.state_size)
        y[at.QUATERNION : at.QUATERNION + 4] = np.array(motion.orientation) / np.linalg.norm(motion.orientation)
        angles = slice(at.WHEELS, at.WHEELS + at.WHEEL_STATES * design.wheel_count, at.WHEEL_STATES)
        if motion.wheel_angle is not None:
            y[angles] = motion.wheel_angle
        if motion.centre_displacement is None:
            y = seat(m, y, self.places[b], self.turns[b])
        else:
            y[at.CENTRE : at.CENTRE + 3] = motion.centre_displacement
            engine.settle(y, len(m.wheels), m.stations, m.outlines, m.pieces, self.places[b], self.turns[b])
        y[at.CENTRE_VELOCITY : at.CENTRE_VELOCITY + 3] = motion.centre_velocity or (0.0, 0.0, 0.0)
        if motion.kind == "wheel-speed":
            speed = np.array(motion.series.at(0.0))
            Omega = forward(design, speed)
        else:
            Omega = np.array(motion.angular_velocity or (0.0, 0.0, 0.0))
            speed = inverse(design, Omega)
        y[at.OMEGA : at.OMEGA + 3] = Omega
        y[at.WHEELS + at.SPEED_OF_WHEEL : angles.stop : at.WHEEL_STATES] = speed
        y[at.STAGE_POSITION : at.STAGE_POSITION + 3] = start.position
        y[at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3] = start.velocity
        now = instant(m, y, self.places[b], self.turns[b])
        self.touching[b] = now.wrenches[:, PRESSED] > 0
        return y

    def advance(self, watch) -> None:
        """Take all runs to their ends, on as many threads as Numba may use; each goes its way alone."""
        from concurrent.futures import ThreadPoolExecutor

        import numba

        running = list(range(len(self.status)))
        threads = min(len(running), numba.get_num_threads())
        with ThreadPoolExecutor(threads) as pool:
            while running:
                # A thread costs more than a short run.
                statuses = (map if threads == 1 else pool.map)(self._step, running)
                for b, status in zip(running, statuses, strict=True):
                    self.status[b] = status
                full = self.status == engine.EVENTS_FULL
                if full.any():
                    self.events = np.concatenate([self.events, np.zeros_like(self.events)], axis=1)
                    self.status[full] = engine.RUNNING
                running = list(np.flatnonzero(self.status == engine.RUNNING))
                if watch is not None:
                    watch(float(np.mean(self.clock[:, 0]) / self.duration))

    def _step(self, b: int) -> int:
        m = self.machines[b]
        return engine.advance(
            m.body, m.wheels, m.stations, m.outlines, m.pieces, self.drive_kind, self.stage_kind, self.inputs[b], self.samples,
            packed(self.method), len(self.method.alpha), self.method.order, self.control[b], self.weights[b],
            self.y[b], self.clock[b], self.counters[b], self.works[b], self.places[b], self.turns[b], self.acting[b],
            self.touching[b], *(kept[b] for kept in self.kept), self.events[b], STEPS_AT_ONCE,
            *room(m, len(self.method.alpha)),
        )  # fmt: skip

    def run(self, b: int) -> CompliantRun:
        done = int(self.counters[b, 0])
        status = int(self.status[b])
        states, rates, motors, touches, stored, works = (array[b, :done] for array in self.kept)
        return CompliantRun(
            design=self.designs[b],
            machine=self.machines[b],
            completed=status == 0,
            reason=_REASONS[status].format(time=self.clock[b, 0]),
            time=self.samples[:done],
            states=states,
            rates=rates,
            motor_torque=motors,
            touches=touches,
            stored=stored,
            works=works,
            events=self.events[b, : int(self.counters[b, 3])],
            steps=(int(self.counters[b, 1]), int(self.counters[b, 2])),
        )


_REASONS = {
    0: "reached its duration",
    3: "the motion ceased to be finite at {time:.6g} s",
    4: "no step was small enough at {time:.6g} s: the motion is rougher there than the run can follow",
    5: "the sphere left its wheels by more than its radius at {time:.6g} s",
}


def _drive_kind(design: Design, motion: Motion) -> int:
    """Torques as given; speeds by the motor's loop where it has gains, else held exactly."""
    if motion.kind == "wheel-torque":
        return at.TORQUE
    return at.LOOP if design.motor.proportional_gain or design.motor.integral_gain else at.SPEED


def _control(m: Machine, accuracy: Accuracy) -> list[float]:
    """Limits of a run's steps, as ``engine.advance`` takes them."""
    load = m.body[at.WEIGHT : at.WEIGHT + 3] + m.body[at.CLOSURE_FORCE : at.CLOSURE_FORCE + 3]
    nothing = accuracy.length * max(float(np.linalg.norm(load)), 1e-3)
    landed = min(1e-9, max(1e-13, 1e-3 * accuracy.length))
    return [accuracy.largest_step, accuracy.shortest_step, landed, accuracy.ledger, nothing]


def _weights(m: Machine, design: Design, length: float) -> np.ndarray:
    """How much a metre's error of each entry is worth over ``length``, and whether it is a speed."""
    R = design.sphere.radius
    w = np.zeros((2, m.state_size))
    w[0, : at.WHEELS] = 1.0
    w[0, at.QUATERNION : at.QUATERNION + 4] = 2 * R
    w[0, at.OMEGA : at.OMEGA + 3] = R
    w[1, at.CENTRE_VELOCITY : at.OMEGA + 3] = 1.0
    w[1, at.STAGE_VELOCITY : at.STAGE_VELOCITY + 3] = 1.0
    n = design.wheel_count
    for i, wheel in enumerate(design.wheels):
        to = at.WHEELS + at.WHEEL_STATES * i
        w[0, to : to + at.WHEEL_STATES] = wheel.radius
        w[1, to + at.SPEED_OF_WHEEL] = 1.0
    to = at.WHEELS + at.WHEEL_STATES * n
    stop = to + at.STATION_STATES * len(m.stations)
    w[0, to:stop] = 1.0
    w[1, to + at.DEFLECTION_RATE : stop : at.STATION_STATES] = 1.0
    w[0, stop:] = 0.01 * R
    w[1, stop:] = 1.0
    w[0] /= length
    return w
