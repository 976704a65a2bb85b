"""Files that a page hands over: read by the same readers as files on disk, and never a way to other files."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from spheredrive.design import Design
from spheredrive.errors import InputError
from spheredrive.io.design_file import parse_design
from spheredrive.io.files import decoded
from spheredrive.io.results import read_run
from spheredrive.io.toml_file import LARGEST_FILE, parse_toml

if TYPE_CHECKING:
    import xarray

LARGEST_RUN = 256 * 2**20


def uploaded_design(content: bytes, name: str) -> Design:
    """The design in an uploaded file. Raises ``InputError`` as ``load_design``, and for one that names other files."""
    name = shown_name(name)
    if len(content) > LARGEST_FILE:
        raise InputError("is larger than 1 MiB, the most that is read", path=name)
    text = decoded(content, name)
    _refuse_other_files(text, name)
    # A folder that is empty: nothing beside the file can be meant.
    with tempfile.TemporaryDirectory() as folder:
        return parse_design(text, name, folder)


def uploaded_run(content: bytes, name: str) -> xarray.Dataset:
    """The run in an uploaded file. Raises ``InputError`` as ``read_run``."""
    name = shown_name(name)
    if len(content) > LARGEST_RUN:
        raise InputError(f"is larger than {LARGEST_RUN // 2**20} MiB; open it with spheredrive view DESIGN RUN.nc", path=name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.nc"
        path.write_bytes(content)
        try:
            return read_run(path)
        except InputError as error:
            raise InputError(error.rule, path=name) from None


def shown_name(name: str) -> str:
    """The last part of a file's name, whatever system it comes from, fit to be shown."""
    last = os.path.basename(name.replace("\\", "/"))
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in last)[:80] or "file"


def _refuse_other_files(text: str, name: str) -> None:
    document = parse_toml(text, name)
    wheels = document.data.get("wheels")
    for wheel, table in wheels.items() if isinstance(wheels, dict) else ():
        if isinstance(table, dict) and "file" in table:
            rule = "names a file, which an uploaded design cannot; open it with spheredrive view DESIGN"
            raise InputError(rule, document.locate(("wheels", wheel, "file"), "key"))
