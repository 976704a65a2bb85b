"""How fast the compliant model runs at a measured error, each figure against a peer in the same run.

    python benchmarks/compliant.py            what is said below; parts by name: peers real-time methods ensembles

peers       runs at 1 µm against SciPy's Radau and Dormand and Prince's RK45 on the same compiled right-hand side
real-time   seconds of motion a second at 1 µm: two outlines a wheel (dual-race) at a few rad/s, and other wheels
methods     rodas4, rodas4p and rodas3: steps and time by measured error
ensembles   a batch of runs on one thread and on two
(MuJoCo     see benchmarks/against_mujoco.py)

Errors are of the centre's place and of the turned surface (2 R |Δq|), the largest over all samples, against a run at
1e-12 m. Every program is given the loosest tolerance that stays within the error; times are the best of several, compilation
not counted.
"""

from __future__ import annotations

import math
import os
import platform
import sys
from dataclasses import replace
from importlib.metadata import version

import numba
import numpy as np

from spheredrive.design import Contact, Design, Placement, Sphere, Stage
from spheredrive.dynamics.compliant import layout as at
from spheredrive.dynamics.compliant.instant import rates
from spheredrive.dynamics.compliant.station import ALL, FORCES, ROLLER_SIZE, TOUCH_SIZE, WRENCH_SIZE
from spheredrive.motion import Motion, Series
from spheredrive.simulation.compliant.methods import METHODS
from spheredrive.simulation.compliant.run import Accuracy, run_compliant, run_compliant_batch
from spheredrive.wheels import DualRaceWheel, IdealWheel, MecanumWheel, StandardWheel
from timing import best

ERROR = 1e-6
REFERENCE = 1e-12
OUR_LENGTHS = [10.0 ** (-k / 4) for k in range(16, 48)]
R = 0.15
OMNI = dict(radius=0.0758, rollers=14, mass=0.25)
WHEELS = {
    "dual-race": DualRaceWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, race_spacing=12.5e-3, mass=0.1),
    "round": IdealWheel(radius=0.05, mass=0.2),
    "sphere rollers": StandardWheel(**OMNI, roller_radius=0.0125, roller_shape="sphere"),
    "barrels with gaps": StandardWheel(**OMNI, roller_radius=0.012, roundness=0.3),
    "half sine": StandardWheel(**OMNI, roundness=0.4485, profile="half-sine"),
    "mecanum": MecanumWheel(radius=0.0758, rollers=16, mass=0.25),
}


SOFT, STIFF = Contact(1e5, 200.0, 0.9), Contact(1e6, 500.0, 0.9)


def machine_on(wheel, contact: Contact = SOFT) -> Design:
    """2 kg on three wheels 40 degrees below, K = 10⁵ N/m, C = 200 N s/m, μ = 0.9."""
    places = tuple(Placement.at(wheel, 2 * math.pi * i / 3, math.radians(-40)) for i in range(3))
    return Design("bench", Sphere(R, mass=2.0), places, contact=contact, stage=Stage(5.0))


def turning(duration: float, factor: float = 1.0) -> Motion:
    """Wheels at 2, 1 and 3 rad/s."""
    return Motion("wheel-speed", Series((0.0,), ((2.0 * factor, 1.0 * factor, 3.0 * factor),)), duration, sample_rate=50.0)


def apart(states, reference) -> float:
    """Largest error of the centre or of the surface, m."""
    error = np.abs(states - reference)
    return float(max(error[:, : at.QUATERNION].max(), 2 * R * error[:, at.QUATERNION : at.QUATERNION + 4].max()))


def loosest(states_at, reference, tolerances):
    """The loosest tolerance within ``ERROR`` of the reference, and its error; None where none is."""
    for tolerance in tolerances:
        states = states_at(tolerance)
        if len(states) == len(reference) and apart(states, reference) <= ERROR:
            return tolerance, apart(states, reference)
    return None


def ours(design, motion, method="rodas4"):
    """A function of the accuracy that gives the states at the samples."""
    return lambda length: run_compliant(design, motion, Accuracy(length, method=method)).states


def right_hand_side(design, motion):
    """f(t, y) of the machine by the compiled ``rates`` alone, with all rollers acting, and the state at the start."""
    run = run_compliant(design, replace(motion, duration=0.02))
    m, start = run.machine, run.states[0]
    n, q, s = len(m.wheels), len(m.outlines), len(m.stations)
    drive, none, push, acting = motion.series.at(0.0), np.zeros(n), np.zeros(3), np.full(q, ALL)
    turns, out = np.zeros(q), np.zeros(len(start))
    power, motors, wrenches, touches = np.zeros(at.POWERS), np.zeros(n), np.zeros((s, WRENCH_SIZE)), np.zeros((q, TOUCH_SIZE))
    rollers, K, D = np.zeros((m.rollers, ROLLER_SIZE)), np.zeros((s, 7, 4)), np.zeros((s, 7, 7))

    def rate(_, y):
        rates(
            y, drive, none, push, at.SPEED, at.STILL, m.body, m.wheels, m.stations, m.outlines, m.pieces, m.places, turns,
            acting, FORCES, 1.0, out, power, motors, wrenches, touches, rollers, K, D,
        )  # fmt: skip
        return out.copy()

    return rate, start


def scipys(design, motion, method):
    """As ``ours``, by ``solve_ivp``; a tolerance is absolute, and relative by as much."""
    from scipy.integrate import solve_ivp

    rate, start = right_hand_side(design, motion)
    times = np.arange(round(motion.duration * motion.sample_rate) + 1) / motion.sample_rate

    def states(tolerance):
        found = solve_ivp(
            rate, (0, motion.duration), start, method, times, rtol=max(tolerance, 1e-12), atol=tolerance, max_step=0.01
        )
        return found.y.T

    return states


def peers(duration: float) -> None:
    for name, contact in (("dual-race", SOFT), ("dual-race", STIFF), ("barrels with gaps", SOFT)):
        design, motion = machine_on(WHEELS[name], contact), turning(duration)
        mine = ours(design, motion)
        reference = mine(REFERENCE)
        found = loosest(mine, reference, OUR_LENGTHS)
        a = best(lambda mine=mine, length=found[0]: mine(length), 5)
        print(f"\npeers: {duration:g} s on wheels of {name}, K = {contact.stiffness:g} N/m, error at most {ERROR:g} m")
        print(f"  ours           {a * 1e3:10.2f} ms   error {found[1]:.1e} at {found[0]:.1e}")
        for method in ("Radau", "RK45"):
            theirs = scipys(design, motion, method)
            found = loosest(theirs, reference, [10.0 ** (-k / 2) for k in range(6, 24)])
            if found is None:
                print(f"  SciPy {method:8s} no tolerance from 1e-3 to 3e-12 stays within the error")
                continue
            b = best(lambda theirs=theirs, tolerance=found[0]: theirs(tolerance), 1)
            print(f"  SciPy {method:8s} {b * 1e3:10.2f} ms   error {found[1]:.1e} at {found[0]:.1e}   ratio {b / a:.0f}")


def real_time(duration: float) -> None:
    print(f"\nreal time: {duration:g} s at 2, 1, 3 rad/s (and twice as fast), error at most {ERROR:g} m")
    for name, wheel in WHEELS.items():
        for factor in (1.0, 2.0):
            design, motion = machine_on(wheel), turning(duration, factor)
            mine = ours(design, motion)
            reference = mine(REFERENCE)
            found = loosest(mine, reference, OUR_LENGTHS)
            seconds = best(lambda mine=mine, found=found: mine(found[0]), 5)
            print(
                f"  {name:18s} x{factor:g}  {duration / seconds:8.0f} times real time   error {found[1]:.1e} at {found[0]:.1e}"
            )


def methods(duration: float) -> None:
    print(f"\nmethods: {duration:g} s")
    for name in ("dual-race", "sphere rollers", "mecanum"):
        design, motion = machine_on(WHEELS[name]), turning(duration)
        reference = ours(design, motion)(REFERENCE)
        for method in METHODS:
            for length in (1e-6, 1e-7, 1e-8, 1e-9):
                run = run_compliant(design, motion, Accuracy(length, method=method))
                if not run.completed:
                    print(f"  {name:16s} {method:8s} {length:.0e}   {run.reason}")
                    continue
                seconds = best(lambda d=design, m=motion, x=method, l=length: ours(d, m, x)(l), 3)
                error, (taken, refused) = apart(run.states, reference), run.steps
                print(
                    f"  {name:16s} {method:8s} {length:.0e}   error {error:.1e} m   steps {taken:6d} + {refused:4d}   "
                    f"{seconds * 1e3:8.2f} ms"
                )


def ensembles(duration: float, count: int = 64) -> None:
    design = machine_on(WHEELS["dual-race"])
    motions = [turning(duration, 1.0 + 0.01 * i) for i in range(count)]
    seconds = {}
    before = numba.get_num_threads()
    for threads in (1, 2):
        if threads > numba.config.NUMBA_NUM_THREADS:
            continue
        numba.set_num_threads(threads)
        seconds[threads] = best(lambda: run_compliant_batch([design], motions, Accuracy(1e-7)), 3)
    numba.set_num_threads(before)
    print(f"\nensembles: {count} runs of {duration:g} s")
    for threads, t in seconds.items():
        print(f"  {threads} threads  {t * 1e3:10.1f} ms   {count * duration / t:.0f} times real time   x{seconds[1] / t:.2f}")


PARTS = {"peers": peers, "real-time": real_time, "methods": methods, "ensembles": ensembles}


if __name__ == "__main__":
    names = ", ".join(f"{name} {version(name)}" for name in ("spheredrive", "numpy", "scipy", "numba"))
    print(f"{platform.machine()}, {os.cpu_count()} cores; Python {platform.python_version()}, {names}")
    asked = [name for name in sys.argv[1:] if name in PARTS] or list(PARTS)
    length = next((float(x) for x in sys.argv[1:] if x not in PARTS), 4.0)
    for part in asked:
        PARTS[part](length)
