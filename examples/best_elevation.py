"""Where should three wheels sit? The elevation at which all directions are alike.

A ring of three wheels has AᵀA = diag(3/2 sin²θ, 3/2 sin²θ, 3 cos²θ), so its isotropy is 1 where tan θ = √2. A million
elevations are tried at once; the best one is that of the formula.
"""

import numpy as np

import spheredrive as sd

elevation = -np.linspace(np.radians(5), np.radians(85), 1_000_001)
azimuth = 2 * np.pi * np.arange(3) / 3
contact = sd.frames.outward(azimuth, elevation[:, None])
drive = sd.frames.heading_direction(azimuth, elevation[:, None], 0.0)
isotropy = 1 / sd.kinematics.condition_number(sd.kinematics.constraint_row(contact, drive))

best = np.degrees(elevation[isotropy.argmax()])
print(f"three wheels are alike in all directions at an elevation of {best:.4f}°; isotropy there {isotropy.max():.6f}")

# The grid is 8e-5° apart.
assert abs(best + np.degrees(np.arctan(np.sqrt(2)))) < 1e-4
