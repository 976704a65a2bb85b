"""Dynamics of the rolling model, model.md section 5a: what a user calls, gathered from the files beside this one."""

from spheredrive.dynamics.loads import (
    Loads,
    Peak,
    Preload,
    least_preload_of_run,
    loads,
    normals_known,
    pressing_direction,
    thesis_closure_force,
    utilisation,
)

__all__ = [
    "Loads",
    "Peak",
    "Preload",
    "least_preload_of_run",
    "loads",
    "normals_known",
    "pressing_direction",
    "thesis_closure_force",
    "utilisation",
]
