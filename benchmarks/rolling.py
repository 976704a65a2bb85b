"""How fast the rolling model runs, each figure against a peer at equal error in the same run.

    python benchmarks/rolling.py            needs the extra "bench" for the second part: pip install -e ".[bench]"

One run: 10 s of a sphere with an offset mass on three dual-race wheels, driven by torques, against SciPy's RK45 with the same
mechanics in NumPy (``peers/numpy_rolling.py``). A batch: 1,024 motions on round wheels, against diffrax's Tsit5 under vmap
in double precision. Every program is given the loosest tolerance at which its end is within 1e-8 of a reference that was
integrated far tighter; times are the best of several, compilation not counted.
"""

from __future__ import annotations

import math
import os
import platform
from dataclasses import replace
from importlib.metadata import version
from importlib.util import find_spec

import numpy as np

import spheredrive as sd
from peers.numpy_rolling import Machine
from spheredrive.design import Stage
from spheredrive.motion import Motion, Series
from spheredrive.simulation.rolling_run import Tolerance, run_rolling, run_rolling_batch
from spheredrive.wheels import IdealWheel
from timing import best

ERROR = 1e-8
TOLERANCES = [10.0 ** (-k / 2) for k in range(8, 27)]


def machine():
    """The dual-race Atlas with an offset payload and unequal moments of inertia."""
    design = sd.load_design(sd.design_path("atlas-dual-race"))
    sphere = replace(design.sphere, inertia=((0.03, 0, 0), (0, 0.028, 0), (0, 0, 0.026)), centre_of_mass=(0.002, 0.001, -0.004))
    return replace(design, sphere=sphere)


def round_wheels(design):
    """The same machine on wheels that never change their races."""
    placements = tuple(replace(p, wheel=IdealWheel(radius=p.wheel.radius, mass=p.wheel.mass)) for p in design.placements)
    return replace(design, placements=placements, stage=Stage(5.0, True))


def motion(duration: float = 10.0, phase: float = 0.0) -> Motion:
    """Torques that run straight between second marks."""
    t = np.arange(int(duration) + 1.0)
    values = 0.006 * np.stack([np.sin(1.3 * t + phase), np.cos(0.9 * t + phase), np.sin(0.7 * t + 1 + phase)], axis=1)
    return Motion("wheel-torque", Series(tuple(t), tuple(map(tuple, values))), duration, sample_rate=1.0)


def loosest(end_at, reference) -> tuple[float, float]:
    """The loosest tolerance whose end is within ``ERROR`` of the reference, and its error."""
    for tolerance in TOLERANCES:
        error = float(np.abs(end_at(tolerance) - reference).max())
        if error <= ERROR:
            return tolerance, error
    raise SystemExit("no tolerance reaches the error asked for")


def one_run() -> None:
    design, drive = machine(), motion()
    torque, knots = drive.series.at, drive.series.time
    peer = Machine(design)

    def ours(rtol):
        return run_rolling(design, drive, Tolerance(rtol, rtol * 1e-2)).angular_velocity[-1]

    def scipys(rtol):
        return peer.run(torque, knots, np.zeros(3), "RK45", rtol, rtol * 1e-2)[0]

    reference = ours(1e-13)
    run = run_rolling(design, drive)
    print(
        f"\none run: {drive.duration:g} s, {len(run.event_time)} changes of race; ends of the two references differ by "
        f"{np.abs(reference - peer.run(torque, knots, np.zeros(3), 'DOP853', 1e-13, 1e-14)[0]).max():.1e}"
    )
    mine, theirs = loosest(ours, reference), loosest(scipys, reference)
    a, b = best(lambda: ours(mine[0]), 9), best(lambda: scipys(theirs[0]), 1)
    print(f"  ours         {a * 1e3:10.2f} ms   error {mine[1]:.1e} at tolerance {mine[0]:.1e}")
    print(f"  SciPy RK45   {b * 1e3:10.2f} ms   error {theirs[1]:.1e} at tolerance {theirs[0]:.1e}   ratio {b / a:.0f}")


def linear() -> None:
    design = machine()
    print("\ncost by duration and by batch")
    for duration in (10, 20, 40, 80):
        seconds = best(lambda d=duration: run_rolling(design, motion(d)), 5)
        changes = len(run_rolling(design, motion(duration)).event_time)
        print(
            f"  {duration:4d} s        {seconds * 1e3:10.2f} ms   {seconds / duration * 1e3:.3f} ms a second, "
            f"{changes / duration:.0f} changes of race in each"
        )
    for count in (64, 256, 1024):
        motions = [motion(phase=0.001 * i) for i in range(count)]
        seconds = best(lambda m=motions: run_rolling_batch([design], m), 3)
        print(f"  {count:4d} runs     {seconds * 1e3:10.2f} ms   {seconds / count * 1e3:.3f} ms a run")
    for duration in (10, 20, 40, 80):
        seconds = best(lambda d=duration: run_rolling(round_wheels(design), motion(d)), 5)
        print(f"  {duration:4d} s        {seconds * 1e3:10.2f} ms   {seconds / duration * 1e3:.3f} ms a second, round wheels")


def batch(count: int = 1024) -> None:
    if find_spec("diffrax") is None:
        print("\nbatch: diffrax is not installed, see above")
        return
    import jax

    jax.config.update("jax_enable_x64", True)
    design = round_wheels(machine())
    motions = [motion(phase=2 * math.pi * i / count) for i in range(count)]
    values = np.array([m.series.values for m in motions])
    solve = diffrax_batch(design, np.array(motions[0].series.time), values)

    def ours(rtol):
        return np.array(
            [run.angular_velocity[-1] for run in run_rolling_batch([design], motions, Tolerance(rtol, rtol * 1e-2))]
        )

    reference = ours(1e-13)
    mine, theirs = loosest(ours, reference), loosest(solve, reference)
    a, b = best(lambda: ours(mine[0]), 3), best(lambda: solve(theirs[0]), 3)
    print(f"\nbatch of {count:,} runs of 10 s, round wheels; versions: diffrax {version('diffrax')}, jax {version('jax')}")
    print(f"  ours             {a * 1e3:10.1f} ms   error {mine[1]:.1e} at tolerance {mine[0]:.1e}")
    print(f"  diffrax Tsit5    {b * 1e3:10.1f} ms   error {theirs[1]:.1e} at tolerance {theirs[0]:.1e}   ratio {b / a:.1f}")


def diffrax_batch(design, knots, values):
    """A compiled function of the tolerance: Ω at the end of every run, by Tsit5 that stops at the torques' corners."""
    import diffrax
    import jax
    import jax.numpy as jnp

    peer = Machine(design)
    H, I, rho, weight, J_w = (jnp.asarray(x) for x in (peer.rows([0, 0, 0]), peer.I, peer.rho, peer.weight, peer.J_w))
    knots_, M_w = jnp.asarray(knots), H.T @ (J_w[:, None] * H)

    def rate(t, y, table):
        Omega, q = y[:3], y[3:]
        i = jnp.clip(jnp.searchsorted(knots_, t, side="right") - 1, 0, len(knots) - 2)
        torque = table[i] + (t - knots_[i]) / (knots_[i + 1] - knots_[i]) * (table[i + 1] - table[i])
        w, v = q[0], q[1:]
        s = 2 / (q @ q)
        cross = jnp.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
        A = jnp.eye(3) + s * (w * cross + cross @ cross)
        I_s = A @ I @ A.T
        moment = H.T @ torque + jnp.cross(A @ rho, weight) - jnp.cross(Omega, I_s @ Omega)
        q_rate = 0.5 * jnp.concatenate([-(Omega @ v)[None], w * Omega + jnp.cross(Omega, v)])
        return jnp.concatenate([jnp.linalg.solve(I_s + M_w, moment), q_rate])

    start = jnp.array([0.0, 0, 0, 1, 0, 0, 0])

    def one(table, rtol):
        controller = diffrax.PIDController(rtol=rtol, atol=rtol * 1e-2)
        controller = diffrax.ClipStepSizeController(controller, jump_ts=knots_[1:-1])
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rate), diffrax.Tsit5(), 0.0, knots[-1], 1e-3, start, args=table,
            saveat=diffrax.SaveAt(t1=True), stepsize_controller=controller, max_steps=100_000, adjoint=diffrax.DirectAdjoint(),
        )  # fmt: skip
        return solution.ys[0, :3]

    compiled = jax.jit(jax.vmap(one, in_axes=(0, None)))
    return lambda rtol: np.asarray(compiled(jnp.asarray(values), rtol).block_until_ready())


if __name__ == "__main__":
    names = ", ".join(f"{name} {version(name)}" for name in ("spheredrive", "numpy", "scipy", "numba"))
    print(f"{platform.machine()}, {os.cpu_count()} cores; Python {platform.python_version()}, {names}")
    one_run()
    linear()
    batch()
