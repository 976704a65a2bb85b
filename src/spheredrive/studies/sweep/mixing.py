"""Sixty-four bits from sixty-four bits, so that one tells nothing about the other: for random numbers and for keys.

The finaliser of SplitMix64 (Steele, Lea and Flood 2014): each number is worked out from its place alone, so that any part of a
sequence can be made anywhere.
"""

from __future__ import annotations

import hashlib

import numpy as np

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_A, _B = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31 = np.uint64(30), np.uint64(27), np.uint64(31)


def mixed(x) -> np.ndarray:
    """64 bits (...) that depend on every bit of ``x`` (...), both uint64."""
    z = np.asarray(x, np.uint64)
    z = (z ^ (z >> _30)) * _A
    z = (z ^ (z >> _27)) * _B
    return z ^ (z >> _31)


def sequence(key: int, index) -> np.ndarray:
    """Numbers ``index`` (...), from 0, of the sequence of 64 random bits that ``key`` begins."""
    index = np.asarray(index, np.uint64)
    return mixed(np.uint64(key) + (index + np.uint64(1)) * _GOLDEN)


def key_of(*words) -> int:
    """64 bits of text and numbers."""
    text = "\0".join(map(str, words)).encode()
    return int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "little")
