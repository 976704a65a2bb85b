"""Files and text in and out: design and motion files, runs, the catalogue, units. Nothing below this layer knows of either."""

from __future__ import annotations

import importlib
from typing import Any

_NAMES = {
    "design_schema": "schema",
    "load_design": "design_file",
    "load_motion": "motion_file",
    "motion_schema": "schema",
    "parse_design": "design_file",
    "parse_motion": "motion_file",
    "read_run": "results",
    "starting_file": "template",
    "write_new": "template",
    "write_run": "results",
    "write_whole": "files",
}

__all__ = list(_NAMES)


def __getattr__(name: str) -> Any:
    # Loaded when first used: the reader of files needs pydantic, the converter of units pint.
    if name not in _NAMES:
        raise AttributeError(f"module 'spheredrive.io' has no attribute {name!r}")
    return getattr(importlib.import_module(f"spheredrive.io.{_NAMES[name]}"), name)
