"""Compilation where nothing can be kept on disk."""

import numba
import pytest

from spheredrive.compiled import njit

SOURCE = "def double(x):\n    return 2.0 * x\n"


def test_functions_compile_without_a_place_for_their_cache():
    """A function that comes from no file has no place beside it, as in an installation that cannot be written to."""
    space = {}
    exec(SOURCE, space)
    with pytest.raises(RuntimeError, match="cache"):
        numba.njit(cache=True)(space["double"])
    assert njit()(space["double"])(21.0) == 42.0


def test_when_compiling_says_so_once():
    from numba import njit

    from spheredrive.compiled import when_compiling

    said = []
    when_compiling(lambda: said.append(1))
    assert not said
    for step in (1, 2):
        njit(lambda x, step=step: x + step)(1.0)
    assert said == [1]
