"""spheredrive: the mechanics of a sphere driven by omnidirectional wheels.

    import spheredrive as sd
    design = sd.load_design("atlas.toml")
    print(design)
    sd.kinematics.jacobian(design)

Parts are imported when they are first used, so that ``import spheredrive`` costs next to nothing.
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_MODULES = (
    "contact",
    "design",
    "dynamics",
    "errors",
    "frames",
    "io",
    "kinematics",
    "motion",
    "report",
    "shape",
    "vibration",
    "wheels",
)
_NAMES = {
    "Design": "design",
    "DesignError": "errors",
    "InputError": "errors",
    "Motion": "motion",
    "NearSingularWarning": "errors",
    "SingularError": "errors",
    "SpheredriveError": "errors",
    "check": "checking",
    "design_path": "designs",
    "least_preload": "simulation.preload",
    "load_design": "io.design_file",
    "load_motion": "io.motion_file",
    "motion_path": "designs",
    "shipped_designs": "designs",
    "simulate": "simulation.simulate",
    "simulate_batch": "simulation.simulate",
}

__all__ = ["__version__", *_MODULES, *_NAMES]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return importlib.import_module(f"spheredrive.{name}")
    if name in _NAMES:
        return getattr(importlib.import_module(f"spheredrive.{_NAMES[name]}"), name)
    raise AttributeError(f"module 'spheredrive' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
