"""
Which layouts are worth building?
=================================

A study file varies elevation and roller angle of three wheels and asks how even the machine is. ``spheredrive sweep`` does the
same from the command line, on all cores, and goes on where it was stopped.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray

from spheredrive.studies.sweep.command import read_study, sweep

DESIGN = """
schema_version = 1
name = "three wheels"
[sphere]
radius = "150 mm"
[wheels.omni]
type = "ideal"
radius = "25 mm"
[[placement]]
count = 3
elevation = "-40 deg"
"""

STUDY = """
schema_version = 1
design = "machine.toml"
metrics = ["isotropy", "condition_number"]
[parameters]
"placement.elevation" = { from = "-85 deg", to = "-5 deg", count = 81 }
"wheels.omni.roller_angle" = { from = "30 deg", to = "90 deg", count = 61 }
"""

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    (folder / "machine.toml").write_text(DESIGN, encoding="utf-8")
    (folder / "study.toml").write_text(STUDY, encoding="utf-8")
    answer = sweep(read_study(folder / "study.toml"), folder / "result", workers=0, figures=False)
    with xarray.open_dataset(folder / "result" / "result.nc") as file:
        result = file.load()

print(answer.text().splitlines()[-1])

# %%
# Three wheels with inclined rollers have AᵀA = diag(a, a, b), a = 3/2 (sin²θ + cot²α), b = 3 cos²θ. On the dashed line a = b,
# and every direction is alike. It ends at tan²α = ½: 35.3°.

theta = -result["placement.elevation"].to_numpy()[:, None]
alpha = result["wheels.omni.roller_angle"].to_numpy()[None, :]
a, b = 1.5 * (np.sin(theta) ** 2 + 1 / np.tan(alpha) ** 2), 3 * np.cos(theta) ** 2
np.testing.assert_allclose(result.isotropy, np.sqrt(np.minimum(a, b) / np.maximum(a, b)), atol=1e-12)

elevation, roller_angle = -np.degrees(theta[:, 0]), np.degrees(alpha[0])
plt.figure(figsize=(6, 3.8))
plt.contourf(roller_angle, elevation, result.isotropy, levels=np.linspace(0, 1, 11), cmap="cividis")
plt.colorbar(label="isotropy")
plt.contour(roller_angle, elevation, a - b, levels=[0], colors="white", linestyles="--", linewidths=1)
plt.xlabel("roller angle α, °")
plt.ylabel("elevation, °")
plt.tight_layout()
plt.show()
