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

SAMPLES = 10_000_000
DESIGNS = 1_000_000


def best(function, repeat: int) -> float:
    """Least seconds of several calls, after one that is not counted."""
    function()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


@njit(parallel=True)
def triad(a, b, c, s):
    for i in prange(a.size):
        a[i] = b[i] + s * c[i]


def bandwidth(repeat: int) -> float:
    """Bytes a second of a = b + s c over arrays far larger than any cache."""
    a, b, c = (np.ones(3 * SAMPLES) for _ in range(3))
    return 3 * a.nbytes / best(lambda: triad(a, b, c, 2.0), repeat)


def maps(design, repeat: int) -> None:
    rng = np.random.default_rng(1)
    wheel_speed = rng.normal(size=(SAMPLES, 3))
    out = np.empty_like(wheel_speed)
    moved = wheel_speed.nbytes + out.nbytes
    # The triad is measured before and after, so that a machine that slows down in between is seen.
    before = bandwidth(repeat)
    rows = {
        "forward, Ω = J ω": best(lambda: sd.kinematics.forward(design, wheel_speed, out=out), repeat),
        "inverse, ω = J⁻¹ Ω": best(lambda: sd.kinematics.inverse(design, wheel_speed, out=out), repeat),
        "NumPy matmul": best(lambda: np.matmul(wheel_speed, sd.kinematics.jacobian(design).T, out=out), repeat),
    }
    after = bandwidth(repeat)
    print(f"\nmaps over {SAMPLES:,} samples; triad {before / 1e9:.1f} GB/s before, {after / 1e9:.1f} GB/s after")
    for name, seconds in rows.items():
        print(f"  {name:20s} {seconds * 1e3:8.1f} ms   {moved / seconds / max(before, after):6.1%} of the triad bandwidth")


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
