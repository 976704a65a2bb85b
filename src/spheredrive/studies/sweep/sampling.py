"""Random and evenly spread numbers by their place: number i follows from the seed and i alone.

So any chunk of a study can be made by any worker, and made again.
"""

from __future__ import annotations

import warnings

import numpy as np

from spheredrive.studies.sweep.mixing import key_of, mixed, sequence

# Bits of a Sobol' point.
SOBOL_BITS = 30


def uniforms(seed: int, name: str, index) -> np.ndarray:
    """Numbers in (0, 1), uniform, of the sequence that ``name`` has for itself, at ``index`` (...) from 0."""
    bits = sequence(key_of(seed, "uniform", name), index) >> np.uint64(11)
    return (bits.astype(float) + 0.5) * 2.0**-53


def latin_hypercube(seed: int, name: str, index, count: int) -> np.ndarray:
    """One number in each of ``count`` equal parts of (0, 1), the parts in random order."""
    place = permuted(index, count, key_of(seed, "order", name))
    return (place + uniforms(seed, name, index)) / count


def permuted(index, count: int, key: int) -> np.ndarray:
    """Where ``index`` (...) comes to stand in a random order of 0 … count − 1.

    A Feistel network of four rounds permutes the numbers of so many bits; what falls outside is sent through again, until it
    falls inside. No table is kept, so ``count`` costs no memory.
    """
    half = np.uint64(max((count - 1).bit_length() + 1, 2) // 2)
    mask = (np.uint64(1) << half) - np.uint64(1)
    x = np.array(index, np.uint64)
    outside = np.ones(x.shape, bool)
    while outside.any():
        left, right = x[outside] >> half, x[outside] & mask
        for turn in range(4):
            left, right = right, left ^ (mixed(right + np.uint64((key + turn * 0x632BE59BD9B4E019) % 2**64)) & mask)
        x[outside] = (left << half) | right
        outside = x >= np.uint64(count)
    return x.astype(np.int64)


def sobol(seed: int, names: tuple[str, ...], first: int, count: int) -> np.ndarray:
    """Points ``first`` to before ``first + count`` of the Sobol' sequence in (0, 1), (count, d), shifted digitally by the seed.

    A shift of the digits, one for each name, keeps how evenly the points are spread.
    """
    from scipy.stats.qmc import Sobol

    points = Sobol(len(names), scramble=False, bits=SOBOL_BITS)
    with warnings.catch_warnings():
        # Only whole powers of two are balanced to the last digit; the rest are as good as can be.
        warnings.simplefilter("ignore", UserWarning)
        if first:
            points.fast_forward(first)
        digits = (points.random(count) * 2.0**SOBOL_BITS).astype(np.uint64)
    shift = np.array([key_of(seed, "shift", name) >> (64 - SOBOL_BITS) for name in names], np.uint64)
    return ((digits ^ shift).astype(float) + 0.5) * 2.0**-SOBOL_BITS
