"""Batches on a graphics card: what is said where there is none, the way there and back, and that the kernel compiles."""

from contextlib import nullcontext
from dataclasses import replace
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest

from compliant_cases import WHEELS, design, run_from, speeds
from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.simulation.compliant import gpu, run
from spheredrive.simulation.compliant import room as room_module
from spheredrive.simulation.compliant.run import Accuracy, run_compliant_batch

PARTS = ("time", "states", "rates", "motor_torque", "touches", "stored", "works", "events")
ROUGH = Accuracy(1e-6)
SPEEDS = speeds((2.0, 1.0, 3.0), 0.05)
# Thrown up at 0.2 m/s: every wheel loses the sphere, and gets it back.
THROWN = speeds((0.0, 0.0, 0.0), 0.045, centre_velocity=(0.0, 0.0, 0.2))


def same(a, b) -> bool:
    return a.steps == b.steps and all(np.array_equal(getattr(a, part), getattr(b, part)) for part in PARTS)


def rubbish(shape, kind):
    """Room in which something stands that no run can go on with."""
    return np.full(shape, {np.float64: np.nan, np.bool_: True, np.int64: -1}[kind])


class Card:
    """A stand-in for ``numba.cuda``: memory of its own, full of rubbish, and threads that run one after another.

    A thread may touch its own row alone of what there is one of a run.
    """

    def __init__(self):
        self.launches = 0
        self.thread = self.runs = -1

    def is_available(self):
        return True

    def to_device(self, array):
        return Held(array.copy())

    def device_array(self, shape, kind):
        self.runs = shape[0]
        return Held(rubbish(shape, kind))

    def grid(self, dimensions):
        return self.thread

    def jit(self, function, **options):
        return Launches(self, function)


class Held:
    """An array on the card."""

    def __init__(self, array):
        self.array = array

    def copy_to_host(self, into=None):
        if into is None:
            return self.array.copy()
        into[...] = self.array
        return into


class Rows:
    """An array with a row a run, for the thread whose turn it is."""

    def __init__(self, card, array):
        self.card, self.array, self.size = card, array, array.size

    def __getitem__(self, run):
        assert run == self.card.thread
        return self.array[run]

    def __setitem__(self, run, value):
        assert run == self.card.thread
        self.array[run] = value


class Launches:
    def __init__(self, card, function):
        self.card, self.function = card, function

    def __getitem__(self, grid):
        return lambda *arguments: self.launch(grid, [self.as_seen(a) for a in arguments])

    def as_seen(self, a):
        if not isinstance(a, Held):
            return a
        return Rows(self.card, a.array) if len(a.array) == self.card.runs else a.array

    def launch(self, grid, arguments):
        blocks, threads = grid
        self.card.launches += 1
        for self.card.thread in range(blocks * threads):
            self.function(*arguments)


@pytest.fixture
def card(monkeypatch):
    found = Card()
    monkeypatch.setattr("numba.cuda", found, raising=False)
    monkeypatch.setattr(gpu, "find_spec", lambda name: True)
    monkeypatch.setattr(gpu, "rounded_products", nullcontext)
    gpu.kernel.cache_clear()
    yield found
    gpu.kernel.cache_clear()


def test_without_numba_cuda_gpu_is_refused_with_the_line_that_installs_it(monkeypatch):
    monkeypatch.setattr(gpu, "find_spec", lambda name: None)
    assert not gpu.available()
    with pytest.raises(SpheredriveError, match=r'pip install "spheredrive\[gpu\]"'):
        run_compliant_batch([design(WHEELS["ideal"])], [SPEEDS], ROUGH, device="gpu")


def test_without_a_card_auto_says_so_and_runs_on_the_cores(monkeypatch, card):
    card.is_available = lambda: False
    with pytest.warns(UserWarning, match="finds no graphics card.*processor"):
        [found] = run_compliant_batch([design(WHEELS["ideal"])], [SPEEDS], ROUGH, device="auto")
    assert card.launches == 0
    assert same(found, run_compliant_batch([design(WHEELS["ideal"])], [SPEEDS], ROUGH)[0])


def test_unknown_device_is_refused():
    with pytest.raises(UnknownNameError, match="there is no device 'gqu'; did you mean 'gpu'"):
        gpu.device_of("gqu")


def test_run_on_the_card_is_the_run_on_the_cores(monkeypatch, card):
    """The way there and back: what runs there is the engine as compiled here, so every bit is the same.

    Runs of unlike outlines, more than a block, in many launches, with more events than there is room for at first.
    """
    monkeypatch.setattr(gpu, "THREADS", 2)
    monkeypatch.setattr(gpu, "STEPS_A_LAUNCH", 7)
    monkeypatch.setattr(run, "FIRST_EVENTS", 2)
    few_points = replace(WHEELS["measured"], outline=WHEELS["measured"].outline[::2])
    designs = [design(WHEELS["ideal"]), design(few_points), design(WHEELS["half-sine"])]
    told = []
    for motion in (SPEEDS, THROWN):
        there = run_compliant_batch(designs, [motion], ROUGH, told.append, device="gpu")
        here = run_compliant_batch(designs, [motion], ROUGH)
        assert all(map(same, here, there)) and all(found.completed for found in there)
    assert len({found.machine.pieces.shape for found in there}) == 3
    assert len(here[0].events) > 2 and card.launches > 4 and told[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["dual-race", "sphere-turning"])
def test_run_depends_neither_on_what_stood_in_its_room_nor_on_where_it_is_taken_up(monkeypatch, name):
    d = design(WHEELS[name], sphere={"centre_of_mass": (0.01, 0.02, -0.02)})
    whole, _ = run_from(d, SPEEDS, ROUGH)
    monkeypatch.setattr(run, "room", lambda machine, stages: room_module.room(machine, stages, rubbish))
    monkeypatch.setattr(run, "STEPS_AT_ONCE", 5)
    pieces, _ = run_from(d, SPEEDS, ROUGH)
    assert whole.steps[0] > 10 and same(whole, pieces)


@pytest.mark.long
@pytest.mark.skipif(find_spec("numba_cuda") is None, reason="numba-cuda is not installed")
def test_kernel_compiles_for_a_card_and_rounds_every_product(monkeypatch):
    """No card is needed to compile for one. A product that is rounded is ``mul.rn`` in PTX; ``mul.f64`` may be fused."""
    import numba
    from numba import cuda
    from numba.cuda import dispatcher

    card = SimpleNamespace(compute_capability=(9, 0))
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: card)
    d, motion = gpu.example()
    arrays = run._Arrays([d, d], [motion, motion], ROUGH)
    stages = len(arrays.method.alpha)
    working = room_module.room(arrays.machines[0], stages, np.empty, (2,))
    given = (*gpu.given_arrays(arrays), *gpu.kinds(arrays), *gpu.changed_arrays(arrays), *working)
    with gpu.rounded_products():
        ptx, _ = cuda.compile(
            gpu.kernel().py_func, tuple(map(numba.typeof, given)), device=False, abi="numba", cc=(9, 0), output="ptx"
        )
    assert ".target sm_90" in ptx and "mul.rn.f64" in ptx and "\tmul.f64" not in ptx
