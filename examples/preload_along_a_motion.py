"""
How hard must the sphere be pressed?
====================================

A sphere that lies on its wheels by its weight alone slips when it is asked for too much. Here the Atlas platform is spun up
about the vertical and stopped again; the least force from above that keeps every contact inside its friction limit is found.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd
from spheredrive.design import GRAVITY, Closure, Contact, Design, Placement, Sphere, Stage
from spheredrive.motion import Motion, Series
from spheredrive.wheels import IdealWheel

R, M, mu, theta = 0.15, 2.0, 0.6, np.radians(40)
wheel = IdealWheel(radius=0.025, mass=0.1)
ring = tuple(Placement.at(wheel, azimuth, -theta) for azimuth in 2 * np.pi * np.arange(3) / 3)
design = Design("Atlas", Sphere(R, M), ring, contact=Contact(friction=mu), stage=Stage(mass=5.0))

# Spun up at 150 and then 60 rad/s², stopped at 200.
acceleration = 200.0
spin = Series(time=(0.0, 0.4, 0.7, 1.09), values=((0, 0, 0), (0, 0, 60), (0, 0, 78), (0, 0, 0)))
motion = Motion("sphere-velocity", spin, duration=1.09)

needed = sd.least_preload(design, motion)
print(f"press with {needed.force:.3f} N along {needed.direction}; wheel {needed.wheel} sets it")

# %%
# With this force the busiest contact is at its limit and no further.

figure, axes = plt.subplots(figsize=(6, 3.2))
for force in (0.0, needed.force, 2 * needed.force):
    pressed = replace(design, closure=Closure(force=(0, 0, -force)))
    run = sd.simulate(pressed, motion)
    utilisation = sd.dynamics.utilisation(run.friction_force, run.normal_force, mu).max(axis=1)
    axes.plot(run.time, utilisation, label=f"{force:.1f} N")
    if force == needed.force:
        assert abs(utilisation.max() - 1) < 1e-9
axes.axhline(1, color="grey", linewidth=0.8, linestyle="--")
axes.set(xlabel="time, s", ylabel="friction used |f|/(μN)", ylim=(0, None))
axes.legend(title="preload", loc="upper center")
plt.tight_layout()
plt.show()

# Three contacts share the moment, 3 f R cos θ = ⅔ M R² Ω̇, and the weight and the preload, 3 N sin θ = M g + P.
friction = 2 / 3 * M * R**2 * acceleration / (3 * R * np.cos(theta))
assert abs(needed.force - (3 * np.sin(theta) * friction / mu - M * GRAVITY)) < 1e-9
