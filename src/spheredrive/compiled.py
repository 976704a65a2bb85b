"""How functions are compiled: by Numba, kept on disk where there is a place to keep them.

An installation that cannot be written to, under a user without a home, has no such place: functions are then compiled anew
in every process, instead of failing.
"""

from __future__ import annotations

from collections.abc import Callable

import numba
from numba.core import event


def njit(**options):
    """``numba.njit`` with an on-disk cache where one is possible."""

    def decorate(function):
        try:
            return numba.njit(cache=True, **options)(function)
        except RuntimeError as error:
            if "cache" not in str(error):
                raise
            return numba.njit(**options)(function)

    return decorate


kernel = njit(error_model="numpy", nogil=True, _nrt=False)
"""For functions that read and write the numbers and arrays they are given, and make no arrays but views.

They hold no references to arrays, so that none are counted: that took a third of the time of small ones. Numba compiles
functions of its own so.
"""

inlined = njit(error_model="numpy", _nrt=False, forceinline=True)
"""A ``kernel`` whose code is put in where it is called: for what is small, or called in one place."""


def when_compiling(say: Callable[[], None]) -> None:
    """Have ``say`` called once when a function is compiled in this process, which is not kept on disk yet."""

    class Once(event.Listener):
        said = False

        def on_start(self, _):
            if not self.said:
                self.said = True
                say()

        def on_end(self, _):
            """Nothing is said of the end."""

    event.register("numba:compile", Once())
