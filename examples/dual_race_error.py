"""What a controller that ignores the two races of its wheels gets wrong (the thesis's figure 2.7).

The dual-race Atlas runs through the wheel speeds of the thesis's Table 2.1; the single-race Jacobian is compared with that of
the races which touch the sphere at each moment.
"""

import numpy as np

import spheredrive as sd

design = sd.load_design(sd.design_path("atlas-dual-race"))
motion = sd.load_motion(sd.motion_path("atlas-table-2-1"))
run = sd.kinematics.along(design, motion)

angle = np.degrees(run.error_angle.max())
magnitude = 100 * np.abs(run.error_magnitude).max()
print(f"{len(run.race_changes)} changes of race in {motion.duration:g} s")
print(f"direction off by up to {angle:.2f}°, speed by up to {magnitude:.2f} %")

assert (round(angle, 2), round(magnitude, 2)) == (3.15, 3.79)
