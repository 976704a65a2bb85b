"""
What does a controller get wrong that ignores the two races?
============================================================

Dual-race wheels touch the sphere now on one row of rollers, now on the other. The dual-race Atlas runs through the wheel speeds
of the thesis's Table 2.1; the single-race Jacobian, which a controller would use, is compared with that of the races that touch
at each moment. This is the thesis's figure 2.7.
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd

design = sd.load_design(sd.design_path("atlas-dual-race"))
motion = sd.load_motion(sd.motion_path("atlas-table-2-1"))
run = sd.kinematics.along(design, motion)

angle = np.degrees(run.error_angle.max())
magnitude = 100 * np.abs(run.error_magnitude).max()
print(f"{len(run.race_changes)} changes of race in {motion.duration:g} s")
print(f"direction off by up to {angle:.2f}°, speed by up to {magnitude:.2f} %")

# %%
# Both errors jump at every change of race.

figure, (above, below) = plt.subplots(2, sharex=True, figsize=(6, 3.8))
above.plot(run.time, np.degrees(run.error_angle), linewidth=0.8)
above.set_ylabel("direction, °")
below.plot(run.time, 100 * run.error_magnitude, linewidth=0.8, color="C1")
below.set_ylabel("speed, %")
below.set_xlabel("time, s")
figure.align_ylabels()
plt.tight_layout()
plt.show()

# The thesis prints 3.8 % and 3.2°; the equations it gives make 3.79 % and 3.15°.
assert (round(angle, 2), round(magnitude, 2)) == (3.15, 3.79)
