"""How fast linear vibration runs, against SciPy at equal error in the same run, and what a batch and a long run cost.

    python benchmarks/vibration.py

One run: 10 s of the demonstrator on contacts of K = 188208 N/m and C = 20000 N s/m, sampled at 1 kHz, against SciPy's LSODA on
the same equations, compiled, with exact Jacobian, restarted at every corner of the shapes. Errors in the displacement are those
against SciPy's Radau at a tolerance of 1e-13; a row each for looser and tighter tolerances of LSODA.
"""

from __future__ import annotations

import os
import platform
import time
import tracemalloc
from dataclasses import replace
from importlib.metadata import version

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

import spheredrive as sd
from spheredrive import vibration
from spheredrive.design import Contact
from timing import best

SPEED = np.array([0.1, 1.2, 0.9])
TIME = np.arange(10_001) / 1000


def machine(profile: str):
    """The demonstrator with damped contacts and wheels of a profile."""
    design = sd.load_design(sd.design_path("atlas-demonstrator"))
    placements = [replace(p, wheel=replace(p.wheel, profile=profile)) for p in design.placements]
    return replace(design, placements=placements, contact=Contact(188208.0, 20000.0))


class Peer:
    """The same equations for SciPy: state (c, M ċ − B_c h), so that no rate of the shape is needed."""

    def __init__(self, design):
        ls = vibration.linear_system(design)
        e, shapes = ls.equations, ls.profiles
        inverse = np.linalg.inv(e.mass)
        n = len(e.mass)
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ e.stiffness, -inverse @ e.damping]])
        B = np.vstack([inverse @ e.input_damping, inverse @ (e.input_stiffness - e.damping @ inverse @ e.input_damping)])
        shape = shapes[0]
        self.A, self.B, self.shape = A, B, shape
        edges, coefficients, period = shape.breakpoints, shape.coefficients, shape.period

        @njit
        def rate(t, y, pieces, turns):
            out = np.zeros(y.size)
            for i in range(3):
                j = pieces[i]
                u = (SPEED[i] * t - turns[i] * period - edges[j]) / (edges[j + 1] - edges[j])
                h = 0.0
                for k in range(coefficients.shape[1] - 1, -1, -1):
                    h = h * u + coefficients[j, k]
                for r in range(y.size):
                    out[r] += B[r, i] * h
            for r in range(y.size):
                for c in range(y.size):
                    out[r] += A[r, c] * y[c]
            return out

        self.rate = rate
        corners = [0.0, TIME[-1]]
        for w in SPEED:
            k = np.arange(-1, int(TIME[-1] * w / period) + 2)[:, None]
            t = ((edges[:-1] + k * period) / w).ravel()
            corners += list(t[(t > 0) & (t < TIME[-1])])
        # Corners of several wheels at once differ by rounding, which LSODA refuses as a step.
        corners = np.unique(corners)
        self.corners = np.append(corners[:-1][np.diff(corners) > 1e-12], corners[-1])

    def start(self):
        """At rest: ċ = 0 and c = 0."""
        h = self.shape.height(0 * SPEED)
        n = len(self.A) // 2
        return np.concatenate([np.zeros(n), -self.B[:n] @ h])

    def places(self, middle):
        """Piece and pattern of each wheel at a time between corners."""
        edges, period = self.shape.breakpoints, self.shape.period
        turns = np.floor((SPEED * middle - edges[0]) / period)
        pieces = np.searchsorted(edges, SPEED * middle - turns * period, side="right") - 1
        return pieces, turns

    def plain(self, t, y, pieces, turns):
        """The same rate in NumPy."""
        edges, period = self.shape.breakpoints, self.shape.period
        u = (SPEED * t - turns * period - edges[pieces]) / (edges[pieces + 1] - edges[pieces])
        h = self.shape.coefficients[pieces, -1]
        for a in self.shape.coefficients[pieces, -2::-1].T:
            h = h * u + a
        return self.A @ y + self.B @ h

    def run(self, method: str, rtol: float, atol: float, compiled: bool = True) -> np.ndarray:
        """Displacement at every sample, (k, 3); NaN where the solver gives up."""
        out, y = np.empty((len(TIME), 3)), self.start()
        out[0] = y[:3]
        for a, b in zip(self.corners[:-1], self.corners[1:], strict=True):
            pieces, turns = self.places((a + b) / 2)
            inside = TIME[(a < TIME) & (b + 1e-12 >= TIME)]
            inside = np.minimum(inside, b)
            asked = np.unique(np.append(inside[inside < b - 1e-11], b))
            s = solve_ivp(
                self.rate if compiled else self.plain, (a, b), y, method, asked, args=(pieces, turns), rtol=rtol, atol=atol,
                jac=lambda t, y, p, q: self.A,
            )  # fmt: skip
            if not s.success or not np.isfinite(s.y).all():
                return np.full((len(TIME), 3), np.nan)
            y = s.y[:, -1]
            out[np.searchsorted(TIME, inside - 1e-11)] = s.y[:3, np.searchsorted(asked, inside - 1e-11)].T
        return out


def one_run(profile: str) -> None:
    design = machine(profile)
    peer = Peer(design)

    def ours():
        return vibration.transient(design, SPEED, TIME[-1], 1000.0).displacement

    mine = ours()
    reference = peer.run("Radau", 1e-13, 1e-17)
    scale = np.abs(reference).max()
    seconds = best(ours, 9)
    print(f"\n{profile}: 10 s, {len(peer.corners) - 2} corners, 10,001 samples")
    print(f"  ours         {seconds * 1e3:10.2f} ms   error {np.abs(mine - reference).max() / scale:.1e} (by Radau at 1e-13)")
    for kind in ("compiled", "NumPy"):
        print(f"  SciPy LSODA, right-hand side in {kind}:")
        for rtol in (1e-8, 1e-10, 1e-12, 1e-13):
            begin = time.perf_counter()
            theirs = peer.run("LSODA", rtol, rtol * 1e-6, kind == "compiled")
            cost = time.perf_counter() - begin
            error = np.abs(theirs - reference).max() / scale
            print(f"    {cost * 1e3:10.2f} ms   error {error:.1e} at tolerance {rtol:.0e}   ratio {cost / seconds:,.0f}")


def batch(count: int = 100_000) -> None:
    design = machine("exact")
    rng = np.random.default_rng(1)
    stiffness = rng.uniform(5e4, 5e5, count)
    print(f"\n{count:,} steady designs: peaks, RMS values, natural frequencies")
    cases = {
        "equal speeds": np.array([2.0, 2.0, 2.0]),
        "incommensurate speeds": rng.uniform(0.5, 3.0, (count, 3)),
    }
    for name, speed in cases.items():
        seconds = best(lambda s=speed: vibration.steady_statistics(design, s, contact_stiffness=stiffness), 1)
        print(f"  {name:24s} {seconds:8.2f} s   {seconds / count * 1e6:.0f} µs a design")


def memory() -> None:
    design = machine("exact")
    print("\nmemory of statistics over a run at 1 kHz")
    for duration in (10.0, 100.0, 1000.0):
        tracemalloc.start()
        vibration.transient_statistics(design, SPEED, duration, 1000.0, block=8192)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        print(f"  {duration:6g} s   {peak / 1e6:8.2f} MB")


if __name__ == "__main__":
    names = ", ".join(f"{name} {version(name)}" for name in ("spheredrive", "numpy", "scipy", "numba"))
    print(f"{platform.machine()}, {os.cpu_count()} cores; Python {platform.python_version()}, {names}")
    for profile in ("exact", "half-sine"):
        one_run(profile)
    batch()
    memory()
