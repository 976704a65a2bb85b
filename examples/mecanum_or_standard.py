"""
Do Mecanum wheels shake less than standard ones?
================================================

A standard wheel of the demonstrator's size lets the sphere dip 0.41 mm into every gap between two rollers; a Mecanum wheel,
whose rollers overlap, 0.06 mm. How much of that arrives at the sphere depends on how fast the rollers pass.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd


def damped(name):
    design = sd.load_design(sd.design_path(name))
    return replace(design, contact=replace(design.contact, damping=200.0))


machines = {"standard": damped("atlas-demonstrator"), "Mecanum": damped("atlas-mecanum")}
outlines = {name: sd.shape.profile(design.wheels[0], design.sphere.radius) for name, design in machines.items()}

speed = np.array([0.1, 1.2, 0.9])
faster = np.geomspace(0.1, 30, 60)
shaking = {
    name: [sd.vibration.response(design, wheel_speed=k * speed).rms_acceleration for k in faster]
    for name, design in machines.items()
}

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
turn = np.linspace(0, 2 * np.pi / 7, 500)
for name, outline in outlines.items():
    left.plot(np.degrees(turn), 1e3 * outline.height(turn), label=name)
    right.loglog(faster * speed.max(), shaking[name], label=name)
left.set(xlabel="wheel angle, °", ylabel="height of the outline, mm")
right.set(xlabel="speed of the fastest wheel, rad/s", ylabel="RMS acceleration, m/s²")
right.legend()
plt.tight_layout()
plt.show()

# %%
# When the wheels creep, the sphere follows their outlines: N c = h, N the wheels' normals n̂ = −R̂. Wheels that meet in every
# combination of phases add their squares, so c has the RMS value of h times √tr (NᵀN)⁻¹ = √(4/(3 cos²θ) + 1/(3 sin²θ)).

theta = np.radians(40)
gain = np.sqrt(4 / (3 * np.cos(theta) ** 2) + 1 / (3 * np.sin(theta) ** 2))
for name, design in machines.items():
    height = outlines[name].height(np.linspace(0, 2 * np.pi, 2**16, endpoint=False))
    creeping = sd.vibration.response(design, wheel_speed=0.05 * speed)
    print(f"{name}: depth {1e3 * np.ptp(height):.4f} mm, creeping sphere {1e3 * creeping.rms_displacement:.4f} mm RMS")
    # The rollers pass at a hundredth or less of the natural frequency: 1e-4 of dynamics.
    assert abs(creeping.rms_displacement / (gain * height.std()) - 1) < 1e-3

# At mid-gap the sphere rests on the edges of two rollers, whatever their shape is: the thesis's [3.6].
wheel = machines["standard"].wheels[0]
dip = sd.shape.gap_depth(wheel.radius, 1.22, wheel.roundness * 2 * np.pi / wheel.rollers)
assert abs(-outlines["standard"].height(outlines["standard"].breakpoints).min() / dip - 1) < 1e-4
