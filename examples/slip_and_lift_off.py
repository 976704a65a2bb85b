"""
What if the wheels slip, or the sphere jumps?
=============================================

The rolling model says that a limit is broken; the compliant model says what happens then. First the motors pull harder than
friction can hold. Then a jolt throws the sphere off its wheels.
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd
from spheredrive.design import GRAVITY, Contact, Design, Placement, Sphere, Stage
from spheredrive.motion import Motion, Series
from spheredrive.wheels import StandardWheel

R, M, mu, theta = 0.15, 2.0, 0.3, np.radians(40)
wheel = StandardWheel(radius=0.025, rollers=16, roller_radius=4.85e-3, roundness=0.0, mass=0.1)
ring = tuple(Placement.at(wheel, azimuth, -theta) for azimuth in 2 * np.pi * np.arange(3) / 3)
contact = Contact(stiffness=1e5, friction=mu, dissipation=0.5)
design = Design("Atlas", Sphere(R, M), ring, contact=contact, stage=Stage(mass=5.0))

weight_on_a_wheel = M * GRAVITY / (3 * np.sin(theta))
grip = mu * weight_on_a_wheel * wheel.radius


def torque(share, **start):
    return Motion("wheel-torque", Series((0.0,), (3 * (share * grip,),)), duration=0.2, **start)


rolling, slipping = (sd.simulate(design, torque(share), "compliant") for share in (0.8, 2.0))
jumping = sd.simulate(design, torque(0.0, centre_velocity=(0.0, 0.0, 0.2)), "compliant")

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
for run, label in ((rolling, "80 % of the grip"), (slipping, "twice the grip")):
    left.plot(1e3 * run.time, run.angular_velocity.sel(axis="z"), label=label)
left.set(xlabel="time, ms", ylabel="Ω about z, rad/s")
left.legend()
right.plot(1e3 * jumping.time, 1e3 * jumping.centre_displacement.sel(axis="z"))
right.set(xlabel="time, ms", ylabel="height of the sphere's centre, mm")
plt.tight_layout()
plt.show()

# %%
# A sliding contact pulls with μN whatever the motor does: ⅔ M R² Ω̇ = 3 μ N R cos θ. The sag of 0.16 mm into the contacts makes
# arms and angles differ by a thousandth.

spin = slipping.angular_velocity.sel(axis="z").to_numpy()
acceleration = (spin[-1] - spin[100]) / 0.1
sliding = 3 * mu * weight_on_a_wheel * np.cos(theta) / (2 / 3 * M * R)
print(f"sliding, the sphere speeds up by {acceleration:.2f} rad/s²; friction allows {sliding:.2f}")
assert abs(acceleration / sliding - 1) < 3e-3
assert np.abs(rolling.slip_speed).max() < 1e-3 < np.abs(slipping.slip_speed).max()

# %%
# The sphere flies for 2v/g, v its speed where the contacts are free: v² = v₀² − g s, s the sag that it comes out of. Their
# damping takes about a thousandth of that.

sag = M * GRAVITY / (3 * np.sin(theta) ** 2 * contact.stiffness)
flight = 2 * np.sqrt(0.2**2 - GRAVITY * sag) / GRAVITY
begin, end = (float(jumping[f"lift_off_{name}"][0]) for name in ("begin", "end"))
print(f"the first flight lasts {1e3 * (end - begin):.2f} ms; a stone would fly {1e3 * flight:.2f} ms")
assert abs((end - begin) / flight - 1) < 3e-3
