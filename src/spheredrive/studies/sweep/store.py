"""Finished chunks on disk: each a file of its own, written whole or not at all, with a checksum.

    DIR/points/<context>/<plan>/<number>.chunk

A file begins with its signature and the length of a header in JSON; header, keys, values and reasons follow, and a checksum of
all that. What is cut short, altered, or of another study is as if it were not there.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from spheredrive.errors import InputError
from spheredrive.io.files import write_whole
from spheredrive.studies.sweep.evaluate import Rows

_SIGNATURE = b"spheredrive chunk 1\n"
_DIGEST = 16


class Chunk(NamedTuple):
    """A finished chunk: keys (b, 2) and rows of its points."""

    keys: np.ndarray
    rows: Rows


class Store:
    """The chunks of one plan, and what other plans of the same context have."""

    def __init__(self, folder: Path, context: str, plan: str):
        self.context, self.plan = context, plan
        self.others = folder / "points" / context
        self.folder = self.others / plan

    def open(self) -> None:
        """Make the folder, and clear what writes that were cut short have left. Raises ``InputError`` where that fails."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"cannot be made: {(error.strerror or str(error)).lower()}", path=str(self.folder)) from None
        for left in self.folder.glob(".*.chunk.*"):
            with contextlib.suppress(OSError):
                left.unlink()

    def path(self, number: int) -> Path:
        """The file of a chunk."""
        return self.folder / f"{number:08d}.chunk"

    def write(self, number: int, chunk: Chunk) -> None:
        """Keep a chunk. Raises ``InputError`` where it cannot be written; nothing is then changed."""
        write_whole(self.path(number), _packed({"plan": self.plan, "number": number}, chunk))

    def has(self, number: int) -> bool:
        """Whether a chunk is there and whole."""
        return self.read(number) is not None

    def read(self, number: int) -> Chunk | None:
        """A chunk, or None where it is not there, cut short or damaged."""
        return _unpacked(self.path(number), {"plan": self.plan, "number": number})

    def relatives(self) -> Iterator[Path]:
        """Chunk files of other plans of this context, in a fixed order."""
        for folder in sorted(p for p in self.others.iterdir() if p.is_dir() and p != self.folder):
            yield from sorted(folder.glob("*.chunk"))


class Harvest:
    """Points that other plans of the same context have finished, found by their keys.

    Kept of each are 16 bytes: half of its key, and where it is. The file is read again when it is asked for.
    """

    def __init__(self, store: Store):
        self.files = list(store.relatives())
        lows, places = [np.zeros(0, np.uint64)], [np.zeros(0, np.int64)]
        for number, file in enumerate(self.files):
            chunk = _unpacked(file)
            if chunk is not None:
                lows.append(chunk.keys[:, 0])
                places.append((number << 32) + np.arange(len(chunk.keys)))
        low, place = np.concatenate(lows), np.concatenate(places)
        order = np.argsort(low, kind="stable")
        self._low, self._place = low[order], place[order]

    def __len__(self) -> int:
        return len(self._low)

    def find(self, keys: np.ndarray) -> tuple[np.ndarray, Rows | None]:
        """Which of ``keys`` (b, 2) are finished, (b,), and the rows of those."""
        found = np.zeros(len(keys), bool)
        if not len(self._low):
            return found, None
        at = np.minimum(np.searchsorted(self._low, keys[:, 0]), len(self._low) - 1)
        maybe = np.flatnonzero(self._low[at] == keys[:, 0])
        picked: dict[int, Rows] = {}
        for number in np.unique(self._place[at[maybe]] >> 32):
            chunk = _unpacked(self.files[number])
            for i in maybe[(self._place[at[maybe]] >> 32) == number]:
                row = int(self._place[at[i]] & 0xFFFFFFFF)
                if chunk is not None and row < len(chunk.keys) and (chunk.keys[row] == keys[i]).all():
                    picked[int(i)] = _row(chunk.rows, row)
        if not picked:
            return found, None
        from spheredrive.studies.sweep.evaluate import joined_rows

        rows = joined_rows([picked[i] for i in sorted(picked)])
        found[sorted(picked)] = True
        return found, rows


def _row(rows: Rows, i: int) -> Rows:
    reason = rows.reason[i : i + 1]
    said = rows.sentences[reason[0] - 1 : reason[0]] if reason[0] else ()
    return Rows(rows.values[i : i + 1], np.minimum(reason, 1), said)


def _packed(header: dict[str, Any], chunk: Chunk) -> bytes:
    points, metrics = chunk.rows.values.shape
    head = {**header, "points": points, "metrics": metrics, "sentences": list(chunk.rows.sentences)}
    text = json.dumps(head, sort_keys=True).encode()
    arrays = (chunk.keys.astype("<u8"), chunk.rows.values.astype("<f8"), chunk.rows.reason.astype("<i4"))
    body = b"".join([_SIGNATURE, len(text).to_bytes(8, "little"), text, *(a.tobytes() for a in arrays)])
    return body + hashlib.blake2b(body, digest_size=_DIGEST).digest()


def _unpacked(path: Path, expected: dict[str, Any] | None = None) -> Chunk | None:
    try:
        content = path.read_bytes()
    except OSError:
        return None
    body, digest = content[:-_DIGEST], content[-_DIGEST:]
    if not body.startswith(_SIGNATURE) or hashlib.blake2b(body, digest_size=_DIGEST).digest() != digest:
        return None
    at = len(_SIGNATURE) + 8
    length = int.from_bytes(body[at - 8 : at], "little")
    head = json.loads(body[at : at + length])
    if expected is not None and any(head[key] != value for key, value in expected.items()):
        return None
    points, metrics = head["points"], head["metrics"]
    arrays = []
    at += length
    for kind, shape in (("<u8", (points, 2)), ("<f8", (points, metrics)), ("<i4", (points,))):
        size = int(np.prod(shape)) * np.dtype(kind).itemsize
        arrays.append(np.frombuffer(body, kind, count=int(np.prod(shape)), offset=at).reshape(shape))
        at += size
    keys, values, reason = arrays
    return Chunk(keys.astype(np.uint64), Rows(values.astype(float), reason.astype(np.int64), tuple(head["sentences"])))


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of ``folder``; a process that is killed leaves no lock behind. Raises ``InputError``."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise InputError(f"cannot be used: {(error.strerror or str(error)).lower()}", path=str(folder)) from None
    try:
        try:
            import fcntl
        except ImportError:
            # A system without such locks: two sweeps in one folder are then the user's to avoid.
            yield
            return
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            rule = "another sweep is writing to this folder; wait for it, or name another"
            raise InputError(rule, path=str(folder)) from None
        yield
    finally:
        os.close(handle)
