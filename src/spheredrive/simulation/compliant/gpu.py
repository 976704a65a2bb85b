"""Batches of compliant runs on a graphics card: the engine as it is, compiled by numba-cuda, a run a thread.

Products and sums are rounded one by one, as on the processor. Sines, arctangents and powers come from another library, whose
last place may differ: so may the last place of a step's length, and runs cannot be expected to agree to the last bit.
``python -m spheredrive.simulation.compliant.gpu`` says how well they agree on this machine.
"""

from __future__ import annotations

import warnings
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.simulation.compliant.engine import EVENTS_FULL, RUNNING, advance
from spheredrive.simulation.compliant.room import room

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

DEVICES = ("cpu", "gpu", "auto")
# Runs of a block, and the steps that a launch takes each of them on: a card that also draws a screen stops long launches.
THREADS, STEPS_A_LAUNCH = 32, 200


def available() -> bool:
    """Whether numba-cuda is installed and a device is there."""
    return not lacking()


def lacking() -> str:
    """What is missing for runs on a graphics card, as a sentence; empty where nothing is."""
    if find_spec("numba_cuda") is None:
        return 'runs on a graphics card need numba-cuda: pip install "spheredrive[gpu]"'
    from numba import cuda

    if not cuda.is_available():
        return (
            "numba-cuda finds no graphics card: it needs one of NVIDIA's with its driver, and the CUDA libraries of "
            'pip install "spheredrive[gpu]"'
        )
    return ""


def device_of(asked: str) -> tuple[str, str]:
    """The device, "cpu" or "gpu", that runs asked for on "cpu", "gpu" or "auto" go to, and what is to be said about it.

    Raises ``UnknownNameError`` for another word, ``SpheredriveError`` where "gpu" is asked for and cannot be had.
    """
    if asked not in DEVICES:
        raise UnknownNameError("device", asked, DEVICES)
    if asked == "cpu":
        return "cpu", ""
    missing = lacking()
    if missing and asked == "gpu":
        raise SpheredriveError(missing)
    return ("cpu", f"{missing}; the runs go to the processor's cores") if missing else ("gpu", "")


def device_with_note(asked: str) -> str:
    """``device_of``, what is to be said going out as a warning."""
    device, note = device_of(asked)
    if note:
        warnings.warn(note, stacklevel=3)
    return device


def advance_batch_on_gpu(arrays, watch=None) -> None:
    """Take all runs of ``run._Arrays`` to their ends on the graphics card; they are changed in place, as on the processor.

    Compiling for the card takes about a minute, once a process.
    """
    from numba import cuda

    given, changed = given_arrays(arrays), changed_arrays(arrays)
    on_card, to_change = [cuda.to_device(a) for a in given], [cuda.to_device(a) for a in changed]
    working = room(arrays.machines[0], len(arrays.method.alpha), cuda.device_array, arrays.status.shape)
    blocks = -(-len(arrays.status) // THREADS)
    with rounded_products():
        while (arrays.status == RUNNING).any():
            kernel()[blocks, THREADS](*on_card, *kinds(arrays), *to_change, *working)
            to_change[0].copy_to_host(arrays.status)
            to_change[1].copy_to_host(arrays.clock)
            full = arrays.status == EVENTS_FULL
            if full.any():
                arrays.events = changed[2] = np.concatenate([to_change[2].copy_to_host(), np.zeros_like(arrays.events)], axis=1)
                arrays.status[full] = RUNNING
                to_change[0], to_change[2] = cuda.to_device(arrays.status), cuda.to_device(arrays.events)
            if watch is not None:
                watch(float(np.mean(arrays.clock[:, 0]) / arrays.duration))
    for host, device in zip(changed, to_change, strict=True):
        device.copy_to_host(host)


def given_arrays(arrays) -> list[np.ndarray]:
    """What the kernel reads of ``run._Arrays``: machines, inputs, samples, method, limits of steps, weights."""
    from spheredrive.simulation.compliant.run import packed

    machines = arrays.machines
    rows, columns = (max(m.pieces.shape[axis] for m in machines) for axis in (0, 1))
    # Outlines may have more or fewer pieces and powers: what one lacks is nothing.
    pieces = np.zeros((len(machines), rows, columns))
    for b, m in enumerate(machines):
        pieces[b, : m.pieces.shape[0], : m.pieces.shape[1]] = m.pieces
    parts = [np.array([getattr(m, part) for m in machines]) for part in ("body", "wheels", "stations", "outlines")]
    return [*parts, pieces, arrays.inputs, arrays.samples, packed(arrays.method), arrays.control, arrays.weights]


def kinds(arrays) -> tuple[int, int, int, int, int]:
    """Kinds of drive and stage, stages and order of the method, steps of a launch."""
    return arrays.drive_kind, arrays.stage_kind, len(arrays.method.alpha), arrays.method.order, STEPS_A_LAUNCH


def changed_arrays(arrays) -> list[np.ndarray]:
    """What the kernel changes of ``run._Arrays``: status, clock and events first."""
    return [
        arrays.status, arrays.clock, arrays.events, arrays.y, arrays.counters, arrays.works, arrays.places, arrays.turns,
        arrays.acting, arrays.touching, *arrays.kept,
    ]  # fmt: skip


@cache
def kernel():
    """``engine.advance`` of a batch, a run a thread."""
    from numba import cuda

    def advance_batch(
        body, wheels, stations, outlines, pieces, inputs, samples, method, control, weights,
        drive_kind, stage_kind, stages, order, allowed,
        status, clock, events, y, counters, works, places, turns, acting, touching,
        kept_states, kept_rates, kept_motors, kept_touches, kept_stored, kept_works,
        states, H, frame, sides, by_turn, pushes, to_own, from_own, own, own_sides, wrenches, touches, spins, Ks, Ds,
        powers, drives, pushing, limited, coming,
    ):  # fmt: skip
        b = cuda.grid(1)
        if b < status.size and status[b] == RUNNING:
            status[b] = advance(
                body[b], wheels[b], stations[b], outlines[b], pieces[b], drive_kind, stage_kind, inputs[b], samples, method,
                stages, order, control[b], weights[b], y[b], clock[b], counters[b], works[b], places[b], turns[b], acting[b],
                touching[b], kept_states[b], kept_rates[b], kept_motors[b], kept_touches[b], kept_stored[b], kept_works[b],
                events[b], allowed, states[b], H[b], frame[b], sides[b], by_turn[b], pushes[b], to_own[b], from_own[b], own[b],
                own_sides[b], wrenches[b], touches[b], spins[b], Ks[b], Ds[b], powers[b], drives[b], pushing[b],
                limited[b], coming[b],
            )  # fmt: skip

    return cuda.jit(advance_batch, lto=False)


@contextmanager
def rounded_products():
    """Kernels compiled within round a product before they add it, as the processor does; of itself a card does both at once.

    numba-cuda hands NVVM's option for it on, but ``cuda.jit`` has no word for it. That a batch is small for a card is no news
    either: it warns of it.
    """
    from numba.cuda import compiler, dispatcher

    compile_cuda = compiler.compile_cuda

    def unfused(*args, nvvm_options=None, **options):
        return compile_cuda(*args, nvvm_options={**(nvvm_options or {}), "fma": False}, **options)

    compiler.compile_cuda = dispatcher.compile_cuda = unfused
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Grid size")
            yield
    finally:
        compiler.compile_cuda = dispatcher.compile_cuda = compile_cuda


def largest_difference(design: Design, motion: Motion, count: int = 4) -> float:
    """Largest difference between runs on the processor and on the card, as a length, m (speeds over 10 ms).

    ``count`` runs are made of ``design`` under ``motion`` on each. Infinite where one recorded another number of samples.
    Raises ``SpheredriveError`` where there is no card.
    """
    from spheredrive.simulation.compliant.run import Accuracy, _weights, run_compliant_batch

    here, there = (run_compliant_batch([design] * count, [motion], Accuracy(), device=device) for device in ("cpu", "gpu"))
    lengths = _weights(here[0].machine, design, 1.0)
    scale = lengths[0] * np.where(lengths[1] > 0, 0.01, 1.0)
    if any(a.states.shape != b.states.shape for a, b in zip(here, there, strict=True)):
        return float("inf")
    return max(float(np.abs((a.states - b.states) * scale).max()) for a, b in zip(here, there, strict=True))


def example() -> tuple[Design, Motion]:
    """A sphere on three wheels with two races of rollers, driven for 50 ms."""
    from math import pi, radians

    from spheredrive.design import Contact, Design, Placement, Sphere
    from spheredrive.motion import Motion, Series
    from spheredrive.wheels import DualRaceWheel

    wheel = DualRaceWheel(radius=0.025, rollers=16, roller_radius=0.00485, race_spacing=0.0125, mass=0.1)
    places = tuple(Placement.at(wheel, 2 * pi * i / 3, radians(-40)) for i in range(3))
    design = Design("three wheels", Sphere(0.15, 2.0), places, Contact(1e5, 200.0, 0.9))
    return design, Motion("wheel-speed", Series((0.0,), ((2.0, 1.0, 3.0),)), 0.05)


if __name__ == "__main__":
    print(lacking() or f"card and processor differ by {largest_difference(*example()):.1e} m at most")
