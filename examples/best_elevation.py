"""
Where should three wheels sit?
==============================

The elevation at which all directions are alike. A ring of three wheels at elevation −θ has
AᵀA = diag(3/2 sin²θ, 3/2 sin²θ, 3 cos²θ), so its isotropy is 1 where tan θ = √2. A million elevations are tried at once.
"""

import matplotlib.pyplot as plt
import numpy as np

import spheredrive as sd

elevation = -np.linspace(np.radians(5), np.radians(85), 1_000_001)
azimuth = 2 * np.pi * np.arange(3) / 3
contact = sd.frames.outward(azimuth, elevation[:, None])
drive = sd.frames.heading_direction(azimuth, elevation[:, None], 0.0)
isotropy = 1 / sd.kinematics.condition_number(sd.kinematics.constraint_row(contact, drive))

best = np.degrees(elevation[isotropy.argmax()])
print(f"three wheels are alike in all directions at an elevation of {best:.4f}°; isotropy there {isotropy.max():.6f}")

# %%
# The Atlas platform has its wheels at −40°, where there is room for them; it gives away a third of the isotropy.

shown = slice(None, None, 1000)
plt.figure(figsize=(6, 3.2))
plt.plot(np.degrees(elevation[shown]), isotropy[shown])
plt.axvline(best, color="grey", linewidth=0.8, linestyle="--", label=f"best, {best:.2f}°")
plt.axvline(-40, color="C1", linewidth=0.8, linestyle=":", label="Atlas, −40°")
plt.xlabel("elevation of the wheels, °")
plt.ylabel("isotropy σ₃/σ₁")
plt.legend(loc="lower center")
plt.tight_layout()
plt.show()

# The grid is 8e-5° apart.
assert abs(best + np.degrees(np.arctan(np.sqrt(2)))) < 1e-4
