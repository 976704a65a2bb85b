"""
Does another program agree?
===========================

The machine is written as a MuJoCo model, every roller a body on its own hinge, and driven at constant wheel speeds by that
program and by the compliant model. The two share the drawing and the contact law, and no line of code that moves anything.
"""

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import spheredrive as sd
from spheredrive.design import Contact, Design, Placement, Sphere, Stage
from spheredrive.export.command import export_text
from spheredrive.export.mjcf.run import run_mujoco
from spheredrive.motion import Motion, Series
from spheredrive.wheels import StandardWheel

wheel = StandardWheel(radius=0.025, rollers=12, roller_radius=4.5e-3, roller_shape="sphere", mass=0.1)
ring = tuple(Placement.at(wheel, azimuth, np.radians(-40)) for azimuth in 2 * np.pi * np.arange(3) / 3)
contact = Contact(stiffness=5e4, damping=60.0, friction=0.8, creep_speed=1e-5)
design = Design("Atlas", Sphere(0.15, 2.0), ring, contact=contact, stage=Stage(mass=5.0))

model = mujoco.MjModel.from_xml_string(export_text("mjcf", design))
print(f"{model.nbody} bodies, {model.njnt} joints, {model.body_mass.sum():.3f} kg on a stage that stands still")

# At 1, 2 and 3 rad/s the rollers of all wheels come back together after 2π/12 s: two such periods are compared.
period = 2 * np.pi / 12
motion = Motion("wheel-speed", Series((0.0,), ((2.0, 1.0, 3.0),)), duration=0.2 + 2 * period, sample_rate=1000.0)
theirs, ours = run_mujoco(design, motion), sd.simulate(design, motion, "compliant")

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
for axis, name in enumerate("xyz"):
    left.plot(theirs.time, theirs.angular_velocity[:, axis], color=f"C{axis}", linewidth=2.5, alpha=0.4)
    left.plot(ours.time, ours.angular_velocity[:, axis], color=f"C{axis}", linewidth=0.8, label=name)
right.plot(theirs.time, 1e3 * theirs.centre_displacement[:, 2], color="C2", linewidth=2.5, alpha=0.4, label="MuJoCo")
right.plot(ours.time, 1e3 * ours.centre_displacement[:, 2], color="C2", linewidth=0.8, label="compliant model")
left.set(xlabel="time, s", ylabel="Ω, rad/s; MuJoCo broad")
right.set(xlabel="time, s", ylabel="height of the centre, mm")
left.legend(ncols=3, loc="center", bbox_to_anchor=(0.5, 0.75))
right.set_ylim(None, 0)
right.legend(ncols=2, loc="upper center")
plt.tight_layout()
plt.show()

window = theirs.time >= 0.2
a, b = theirs.angular_velocity[window].mean(axis=0), ours.angular_velocity.to_numpy()[window].mean(axis=0)
print(f"MuJoCo {a.round(4)} rad/s, the compliant model {b.round(4)} rad/s")
assert np.linalg.norm(a - b) < 2e-3 * np.linalg.norm(b)

# The sphere and three wheels, as drawn; the file's numbers have seven digits.
assert abs(model.body_mass.sum() - 2.3) < 1e-6
