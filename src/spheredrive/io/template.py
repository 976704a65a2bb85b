"""The design file a designer starts from."""

from __future__ import annotations

import os
from importlib import resources

from spheredrive.io.files import write_whole


def starting_file() -> str:
    """A design file that loads as it is, with every key explained in a comment."""
    return resources.files("spheredrive.io").joinpath("starting_design.toml").read_text("utf-8")


def write_new(path: str | os.PathLike) -> None:
    """Write the starting file to ``path``; raises ``InputError`` where there is a file already, which is left as it is."""
    write_whole(path, starting_file(), replace=False)
