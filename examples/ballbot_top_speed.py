"""
How fast can a ballbot go, and in which direction?
==================================================

A ballbot stands on a ball with three wheels on the ball's upper half. Its motors turn at 250 rpm at most. Along some directions
one wheel has all the work, along others two share it.
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd

design = sd.load_design(sd.design_path("ballbot"))
R, r = design.sphere.radius, design.wheel_radii[0]
limit = design.motor.speed

# The machine rides along ``heading``; seen from it, the ball turns so that its lowest point comes backwards.
heading = np.linspace(0, 2 * np.pi, 721)
ahead = np.stack([np.cos(heading), np.sin(heading), np.zeros_like(heading)], axis=-1)
ball = np.cross([0, 0, 1], ahead) / R
wheel_speed = sd.kinematics.inverse(design, ball)
top_speed = limit / np.abs(wheel_speed).max(axis=1)
print(f"top speed from {top_speed.min():.3f} to {top_speed.max():.3f} m/s, by direction")

plt.figure(figsize=(4.2, 4.2))
axes = plt.subplot(projection="polar")
axes.plot(heading, top_speed)
for place in design.placements:
    axes.plot([place.azimuth_elevation_heading[0]], [0.4], "o", color="C1")
axes.set_rlim(0, 2.4)
axes.set_rticks([0.5, 1.0, 1.5, 2.0])
axes.set_title("top speed by direction, m/s; wheels as dots", fontsize="medium")
plt.tight_layout()
plt.show()

# %%
# A wheel at elevation ε turns at (v/r) sin ε times the cosine between the ride and its own azimuth. The largest of three
# cosines 120° apart, either sign, runs from cos 30° to 1.

slowest = limit * r / np.sin(np.radians(45))
assert abs(top_speed.min() / slowest - 1) < 1e-12
assert abs(top_speed.max() / (slowest / np.cos(np.radians(30))) - 1) < 1e-12

# %%
# Torques follow from the same matrix: power in is power out, T·ω = M·Ω, so that M = J⁻ᵀ T. Three equal torques turn the ball
# about the vertical alone.

moment = sd.kinematics.inverse_jacobian(design).T @ np.ones(3)
print(f"1 N m on each wheel gives the ball {moment.round(12)} N m")
np.testing.assert_allclose(moment, [0, 0, 3 * R / r * np.cos(np.radians(45))], atol=1e-12)
