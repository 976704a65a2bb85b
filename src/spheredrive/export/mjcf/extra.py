"""MuJoCo, or a sentence that says how to get it."""

from __future__ import annotations

from typing import Any

from spheredrive.errors import SpheredriveError


def mujoco_module() -> Any:
    """The module ``mujoco``. Raises ``SpheredriveError`` where it is not installed."""
    try:
        import mujoco
    except ImportError:
        raise SpheredriveError('this needs MuJoCo, which is not installed: pip install "spheredrive[mujoco]"') from None
    return mujoco
