"""Whole files in and out: read within a size, written entirely or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Iterable

from spheredrive.errors import InputError, Place

_LONGEST_LINE = 160


def read_text(path: str | os.PathLike, limit: int) -> str:
    """The text of a regular file of at most ``limit`` bytes: UTF-8, a byte order mark and CRLF taken off.

    Raises ``InputError``: without a place where there is no such file, with one where it is not text.
    """
    shown = os.fspath(path)
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise InputError("is not a file" if not os.path.isdir(path) else "is a folder, not a file", path=shown)
        with open(path, "rb") as file:
            content = file.read(limit + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(_why(error), path=shown) from None
    if len(content) > limit:
        raise InputError(f"is larger than {limit // 2**20} MiB, the most that is read", path=shown)
    return decoded(content, shown)


def decoded(content: bytes, path: str) -> str:
    """``content`` as text with plain line ends."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8-sig", "replace").replace("\r\n", "\n")
        rule = f"is not UTF-8 text: the byte 0x{content[error.start]:02x} is not part of it"
        raise InputError(rule, place_at(before, len(before), path)) from None
    text = text.replace("\r\n", "\n")
    if "\0" in text:
        raise InputError("has a NUL character, which no text has", place_at(text, text.index("\0"), path))
    return text


def place_at(text: str, offset: int, path: str, length: int = 1) -> Place:
    """The place ``offset`` characters into ``text``."""
    start = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    line = text[start : end if end >= 0 else len(text)]
    column = offset - start + 1
    # Nobody reads a line of thousands.
    shown = printable(line[:_LONGEST_LINE])
    length = max(1, min(length, len(line) - column + 1, _LONGEST_LINE - column + 1))
    shown = shown if column <= _LONGEST_LINE else ""
    return Place(path, text.count("\n", 0, offset) + 1, column, shown, length)


def printable(text: str) -> str:
    """``text`` without what a terminal would act on."""
    return "".join(c if c.isprintable() or c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in text)


def write_whole(path: str | os.PathLike, content: str | bytes, *, replace: bool = True) -> None:
    """Write a file entirely or not at all: a reader never sees half of it.

    Raises ``InputError`` where it cannot be written, or exists and ``replace`` is false.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        mode = _mode(path)
        if mode is not None and not replace:
            raise InputError("exists already and is not overwritten; choose another name", path=os.fspath(path))
        if mode is not None and stat.S_ISDIR(mode):
            raise InputError("is a folder; name a file", path=os.fspath(path))
        if mode is not None and not stat.S_ISREG(mode):
            # A pipe or a device is written to, never replaced. A pipe has no real path: /dev/stdout is its only name.
            with open(path, "wb") as file:
                file.write(data)
            return
        _write_beside(os.path.realpath(path), data, mode, replace)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(_why(error, "written"), path=os.fspath(path)) from None


def require_no_input(path: str | os.PathLike, inputs: Iterable[str | os.PathLike]) -> None:
    """Raise ``InputError`` where what is to be written at ``path`` would take the place of one of the ``inputs``."""
    for one in inputs:
        same = False
        # What does not exist is no input, by whatever name.
        with contextlib.suppress(OSError, ValueError):
            same = os.path.samefile(path, one)
        if same:
            rule = f"is the input {os.fspath(one)} and is not overwritten; choose another name for the output"
            raise InputError(rule, path=os.fspath(path))


def _mode(path: str | os.PathLike) -> int | None:
    try:
        return os.stat(path).st_mode
    except FileNotFoundError:
        return None


def _write_beside(target: str, data: bytes, mode: int | None, replace: bool) -> None:
    beside = os.path.join(os.path.dirname(target), f".{os.path.basename(target)[:100]}.{secrets.token_hex(6)}")
    handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            os.chmod(beside, stat.S_IMODE(mode))
        if replace:
            os.replace(beside, target)
        else:
            # Unlike a rename, a link fails where another process has made the file in the meantime.
            os.link(beside, target)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(beside)


def _why(error: OSError | ValueError, done: str = "read") -> str:
    """A system's error as the rest of a sentence about the file."""
    if isinstance(error, FileNotFoundError):
        return "there is no such file" if done == "read" else "there is no such folder"
    if isinstance(error, NotADirectoryError):
        return f"cannot be {done}: a part of its path is not a folder"
    if isinstance(error, PermissionError):
        return f"cannot be {done}: permission denied"
    if isinstance(error, OSError) and error.strerror:
        return f"cannot be {done}: {error.strerror.lower()}"
    return f"cannot be {done}: its name is not one a file can have"
