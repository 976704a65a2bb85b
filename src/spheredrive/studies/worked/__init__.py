"""Worked studies that come with the package: questions designers ask, each with a file to start from and a known answer."""

from __future__ import annotations

from pathlib import Path

from spheredrive.errors import UnknownNameError

_HERE = Path(__file__).parent


def worked_studies() -> list[str]:
    """Names of the study files that come with the package."""
    return sorted(path.stem for path in (_HERE / "studies").glob("*.toml"))


def study_path(name: str) -> Path:
    """The file of a worked study; raises ``UnknownNameError`` for any other name."""
    if name not in worked_studies():
        raise UnknownNameError("worked study", name, worked_studies())
    return _HERE / "studies" / f"{name}.toml"
