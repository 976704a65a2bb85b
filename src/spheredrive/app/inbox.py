"""What people do on the page, as work for one thread: the latest of each kind, in the order it came."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable


class Inbox:
    """Work by key. A slider that is dragged leaves its last position alone to be worked on."""

    def __init__(self) -> None:
        self._work: dict[Hashable, Callable[[], None]] = {}
        self._ready = threading.Condition()
        self._closed = False

    def put(self, key: Hashable, work: Callable[[], None]) -> None:
        """Leave ``work`` to be done, in place of what was left under the same ``key``."""
        with self._ready:
            self._work.pop(key, None)
            self._work[key] = work
            self._ready.notify()

    def take(self, timeout: float | None) -> list[Callable[[], None]]:
        """All work that is there, waiting up to ``timeout`` s (None: for ever) for the first."""
        with self._ready:
            self._ready.wait_for(lambda: self._work or self._closed, timeout)
            found = list(self._work.values())
            self._work.clear()
            return found

    def close(self) -> None:
        """Wake whoever waits, for the last time."""
        with self._ready:
            self._closed = True
            self._ready.notify_all()

    @property
    def closed(self) -> bool:
        """Whether no more work is taken."""
        return self._closed
