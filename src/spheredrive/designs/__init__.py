"""Designs and motions that come with the package: examples to start from, and the machines the checks are made on."""

from __future__ import annotations

from pathlib import Path

from spheredrive.errors import UnknownNameError

_HERE = Path(__file__).parent


def shipped_designs() -> list[str]:
    """Names of the designs that come with the package."""
    return sorted(path.stem for path in _HERE.glob("*.toml"))


def shipped_motions() -> list[str]:
    """Names of the motions that come with the package."""
    return sorted(path.stem for path in (_HERE / "motions").glob("*.toml"))


def design_path(name: str) -> Path:
    """The file of a shipped design; raises ``UnknownNameError`` for any other name."""
    if name not in shipped_designs():
        raise UnknownNameError("shipped design", name, shipped_designs())
    return _HERE / f"{name}.toml"


def motion_path(name: str) -> Path:
    """The file of a shipped motion; raises ``UnknownNameError`` for any other name."""
    if name not in shipped_motions():
        raise UnknownNameError("shipped motion", name, shipped_motions())
    return _HERE / "motions" / f"{name}.toml"
