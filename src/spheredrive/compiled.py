"""How functions are compiled: by Numba, kept on disk where there is a place to keep them.

An installation that cannot be written to, under a user without a home, has no such place: functions are then compiled anew
in every process, instead of failing.
"""

from __future__ import annotations

import numba


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
