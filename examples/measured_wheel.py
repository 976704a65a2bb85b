"""
What does a measured wheel do to the sphere?
============================================

A wheel was put on a dividing head and its radius read every two degrees. It runs 50 µm out of round, its twelve rollers stand
20 µm proud. Both are lines in the spectrum of the sphere: the first turn by turn, the second roller by roller.
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd
from spheredrive.design import Contact, Design, Placement, Sphere, Stage
from spheredrive.wheels import IdealWheel, MeasuredWheel

runout, roller = 50e-6, 20e-6
angle = np.radians(np.arange(0, 360, 2))
radius = 0.025 + runout * np.cos(angle) + roller * np.cos(12 * angle)
wheel = MeasuredWheel(outline=tuple(zip(angle, radius, strict=True)), mass=0.1)
round_wheel = IdealWheel(radius=0.025, mass=0.1)

theta = np.radians(40)
wheels = (wheel, round_wheel, round_wheel)
ring = tuple(Placement.at(w, azimuth, -theta) for w, azimuth in zip(wheels, 2 * np.pi * np.arange(3) / 3, strict=True))
design = Design("Atlas", Sphere(0.15, 2.0), ring, contact=Contact(stiffness=2e5, damping=50.0), stage=Stage(mass=5.0))

spectrum = sd.vibration.response(design, wheel_speed=[0.5, 0.5, 0.5]).spectrum(count=20)
size = np.linalg.norm(spectrum.displacement, axis=1)

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), width_ratios=[1, 1.3])
left.plot(np.degrees(angle), 1e6 * (radius - 0.025), ".", markersize=2)
turn = np.linspace(0, 2 * np.pi, 1000)
left.plot(np.degrees(turn), 1e6 * sd.shape.profile(wheel, 0.15).height(turn), linewidth=0.8)
left.set(xlabel="wheel angle, °", ylabel="radius less 25 mm, µm")
mine = spectrum.wheel == 1
right.stem(spectrum.order[mine], 1e6 * size[mine], basefmt=" ")
right.set(xlabel="order, cycles in a turn of the wheel", ylabel="motion of the centre, µm")
plt.tight_layout()
plt.show()

# %%
# At this speed nothing rings, and the sphere's centre moves along the column of N⁻¹ that belongs to wheel 1, by √(tr (NᵀN)⁻¹/3)
# of the wheel's own radius error: 1.06 times.

gain = np.sqrt((4 / (3 * np.cos(theta) ** 2) + 1 / (3 * np.sin(theta) ** 2)) / 3)
for order, amplitude in ((1, runout), (12, roller)):
    (line,) = size[mine & (np.round(spectrum.order) == order)]
    print(f"order {order}: {1e6 * line:.2f} µm at the centre from {1e6 * amplitude:.0f} µm at the wheel")
    # The spline through readings every 2° keeps twelve waves a turn to 1e-3.
    assert abs(line / (gain * amplitude) - 1) < 2e-3
