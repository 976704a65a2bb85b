"""
How well must a pointing stand be aligned?
==========================================

A calibration stand turns a sphere by counting the steps of its wheels; nothing measures where the sphere points. The wheels
were mounted at an elevation a little off the drawing. Where does the sphere point after one turn about the vertical?
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd
from spheredrive.design import Design, Placement, Sphere
from spheredrive.wheels import IdealWheel

theta = np.radians(40)
wheel = IdealWheel(radius=0.03)


def stand(*error):
    """The stand with each wheel mounted too high by an angle of its own, rad."""
    azimuth = 2 * np.pi * np.arange(3) / 3
    ring = tuple(Placement.at(wheel, a, -theta + e) for a, e in zip(azimuth, error, strict=True))
    return Design("pointing stand", Sphere(0.2), ring)


def pointing_error(design, turn=2 * np.pi):
    """Angle between where the stand is told to go and where it goes, rad, (k,), while it turns about z."""
    time = np.linspace(0, 1, 201)
    wheel_speed = sd.kinematics.inverse(stand(0, 0, 0), np.tile([0, 0, turn], (len(time), 1)))
    told, gone = (sd.kinematics.forward(machine, wheel_speed) for machine in (stand(0, 0, 0), design))
    p, q = (sd.kinematics.integrate_orientation(time, rate) for rate in (told, gone))
    return 2 * np.arccos(np.clip(np.abs(np.sum(p * q, axis=1)), 0, 1))


one, all_three = np.radians([0.1, 0.0, 0.0]), np.radians([0.1, 0.1, 0.1])
of_one, of_all = pointing_error(stand(*one)), pointing_error(stand(*all_three))
print(f"0.1° on every wheel: {np.degrees(of_all[-1]):.3f}° after a turn; on one wheel: {np.degrees(of_one[-1]):.3f}°")

angle = np.linspace(0, 360, 201)
plt.figure(figsize=(6, 3.2))
plt.plot(angle, np.degrees(of_all), label="every wheel 0.1° too high")
plt.plot(angle, np.degrees(of_one), label="wheel 1 alone")
plt.xlabel("commanded turn about z, °")
plt.ylabel("pointing error, °")
plt.legend()
plt.tight_layout()
plt.show()

# %%
# Every wheel drives the sphere about z with Ω cos θ = (r/R) ω. Mounted at θ − e it turns cos θ/cos(θ − e) as far. An error of
# one wheel does a third of that about z, to first order; what it does about the horizontal axes goes round with the sphere and
# is gone after a whole turn, but for second order.

e = np.radians(0.1)
assert abs(of_all[-1] - 2 * np.pi * (1 - np.cos(theta) / np.cos(theta - e))) < 1e-6
assert abs(of_one[-1] / (of_all[-1] / 3) - 1) < 5e-3
