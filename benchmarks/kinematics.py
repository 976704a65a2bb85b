"""How fast the kinematics are, each figure against a peer measured in the same run.

    python benchmarks/kinematics.py            everything
    python benchmarks/kinematics.py --quick    fewer repetitions

Forward and inverse maps stand against the memory bandwidth of this machine (the triad a = b + s c on all cores), condition
numbers against ``np.linalg.cond``, commands against the limits below. Times are the best of several, all arrays touched
before; bytes count what is read and written once. Peers run at their best: NumPy's matrix product is given its output array,
and ``np.linalg.cond`` is also shown with its work split over all cores.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numba import get_num_threads, njit, prange

import spheredrive as sd
from spheredrive.kinematics.kernels import apply_matrix
from timing import best

SAMPLES = 10_000_000
DESIGNS = 1_000_000


@njit(parallel=True)
def triad(a, b, c, s):
    for i in prange(a.size):
        a[i] = b[i] + s * c[i]


def rounds(functions: dict, repeat: int) -> dict[str, np.ndarray]:
    """Seconds of each function, taken in turns: (repeat,) each, after one round that is not counted."""
    times = {name: [] for name in functions}
    for i in range(repeat + 1):
        for name, function in functions.items():
            start = time.perf_counter()
            function()
            if i > 0:
                times[name].append(time.perf_counter() - start)
    return {name: np.array(values) for name, values in times.items()}


def maps(design, repeat: int) -> None:
    """Bytes a second against those of a = b + s c, all on arrays far larger than any cache."""
    x = np.random.default_rng(1).normal(size=(SAMPLES, 3))
    y, z = np.ones_like(x), np.ones_like(x)
    J = sd.kinematics.jacobian(design)
    seconds = rounds(
        {
            "triad a = b + s c": lambda: triad(z.reshape(-1), x.reshape(-1), y.reshape(-1), 2.0),
            "forward, Ω = J ω": lambda: sd.kinematics.forward(design, x, out=z),
            "inverse, ω = J⁻¹ Ω": lambda: sd.kinematics.inverse(design, x, out=z),
            "NumPy matmul": lambda: np.matmul(x, J.T, out=z),
        },
        2 * repeat + 1,
    )
    print(f"\nmaps over {SAMPLES:,} samples; share of the triad bandwidth as the median over rounds")
    triad_rate = 3 * x.nbytes / seconds.pop("triad a = b + s c")
    low, middle, high = np.quantile(triad_rate, [0, 0.5, 1]) / 1e9
    print(f"  triad                {middle:8.1f} GB/s   ({low:.1f} to {high:.1f})")
    for name, taken in seconds.items():
        rate = 2 * x.nbytes / taken
        print(f"  {name:20s} {np.median(rate) / 1e9:8.1f} GB/s   {np.median(rate / triad_rate):6.1%}")


def condition_numbers(repeat: int) -> None:
    rng = np.random.default_rng(2)
    azimuth = 2 * math.pi * np.arange(3) / 3 + rng.normal(0, 0.3, (DESIGNS, 3))
    elevation = rng.uniform(-1.4, -0.2, (DESIGNS, 3))
    heading = rng.uniform(-1, 1, (DESIGNS, 3))
    A = sd.kinematics.constraint_row(
        sd.frames.outward(azimuth, elevation),
        sd.frames.heading_direction(azimuth, elevation, heading),
        rng.uniform(0.8, 1.57, (DESIGNS, 3)),
    )
    ours = best(lambda: sd.kinematics.condition_number(A), max(repeat, 5))
    numpy = best(lambda: np.linalg.cond(A), repeat)
    cores = os.cpu_count() or 1
    with ThreadPoolExecutor(cores) as pool:
        pieces = np.array_split(A, cores)
        threaded = best(lambda: list(pool.map(np.linalg.cond, pieces)), repeat)
    reference = np.linalg.cond(A)
    error = np.max(np.abs(sd.kinematics.condition_number(A) / reference - 1) / reference)
    print(f"\ncondition numbers of {DESIGNS:,} three-wheel designs")
    print(f"  ours                 {ours * 1e3:8.1f} ms   largest relative difference {error:.1e} × the condition number")
    print(f"  np.linalg.cond       {numpy * 1e3:8.1f} ms   ratio {numpy / ours:5.1f}")
    print(f"  the same, {cores} threads  {threaded * 1e3:8.1f} ms   ratio {threaded / ours:5.1f}")


def bits_alike(design) -> None:
    omega = np.random.default_rng(3).normal(size=(100_000, 3))
    whole = sd.kinematics.forward(design, omega)
    parts = np.concatenate([sd.kinematics.forward(design, part) for part in np.array_split(omega, 137)])
    assert np.array_equal(whole, parts)
    assert np.array_equal(whole, apply_matrix(sd.kinematics.jacobian(design), omega))


def commands(repeat: int) -> None:
    """Whole processes, from the shell's call to the exit, on a warm cache."""
    program = Path(sys.executable).with_name("spheredrive")
    design = sd.design_path("atlas-dual-race")
    print("\nwhole processes")
    for words, limit in ((["--help"], 0.3), (["check", str(design)], 1.0)):
        command = [str(program), *words]
        seconds = best(lambda c=command: subprocess.run(c, stdout=subprocess.DEVNULL, check=True), max(repeat, 5))
        print(f"  spheredrive {words[0]:10s} {seconds:6.3f} s   (limit {limit} s)")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    repeat = 3 if parser.parse_args().quick else 9
    versions = ", ".join(f"{name} {version(name)}" for name in ("spheredrive", "numpy", "numba"))
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, {get_num_threads()} threads;"
        f" Python {platform.python_version()}, {versions}"
    )
    design = sd.load_design(sd.design_path("atlas-dual-race"))
    bits_alike(design)
    maps(design, repeat)
    condition_numbers(repeat)
    commands(repeat)


if __name__ == "__main__":
    main()
