"""Compile what the tests need before they run, on two cores: else both of their processes compile the same.

    python tests/compile_kernels.py

Compiled functions are kept on disk, so that this takes seconds the next time.
"""

import subprocess
import sys

MODELS = """
import spheredrive as sd
from spheredrive.motion import Motion, Series
design = sd.load_design(sd.design_path("atlas-dual-race"))
speeds = Motion("wheel-speed", Series((0.0,), ((1.0, 2.0, 3.0),)), 0.01)
torques = Motion("wheel-torque", Series((0.0,), ((0.1, 0.2, 0.3),)), 0.01)
"""
COMPLIANT = MODELS + 'sd.simulate(design, speeds, model="compliant")'
ROLLING = (
    MODELS
    + """
sd.simulate_batch(design, [torques] * 16)
sd.kinematics.along(design, speeds)
sd.check(design)
"""
)
VIBRATION = """
import spheredrive as sd
from spheredrive.vibration import assess, response, steady_statistics, transient
from spheredrive.motion import Series
design = sd.load_design(sd.design_path("atlas-demonstrator"))
speed = [0.1, 1.2, 0.9]
response(design, wheel_speed=speed)
steady_statistics(design, speed)
steady_statistics(design, speed, peaks=False)
assess(design, speed)
transient(design, Series((0.0, 0.1), ((0.0, 0.0, 0.0), tuple(speed))), 0.1)
"""


def main() -> int:
    running = [subprocess.Popen([sys.executable, "-c", code]) for code in (COMPLIANT, ROLLING, VIBRATION)]
    return max(process.wait() for process in running)


if __name__ == "__main__":
    sys.exit(main())
