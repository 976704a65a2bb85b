"""Who may talk to the page: requests for exactly this address, from this page alone, with the token where there is one.

A page of another site can make a browser send requests here, and can point a name of its own at this machine; but it cannot
forge the headers Host and Origin. Both are compared whole.
"""

from __future__ import annotations

import hmac
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

COOKIE = "spheredrive-token"
LOOPBACK = ("127.0.0.1", "localhost")
# Nothing is fetched from anywhere else, and no other page may frame this one.
HEADERS: Mapping[str, str] = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Headers(Protocol):
    """Headers of a request: every value that a name has."""

    def get_all(self, name: str, /) -> Iterable[str]: ...


@dataclass(frozen=True)
class Answer:
    """What to do with a request: ``status`` None lets it pass."""

    status: int | None = None
    why: str = ""
    location: str = ""
    cookie: str = ""


PASS = Answer()


@dataclass(frozen=True)
class Guard:
    """The rules of one server.

    hosts  names or addresses that people open the page by, without port
    port   that it listens on
    token  what a browser must show once; "" asks for none
    files  paths that may be asked for
    """

    hosts: tuple[str, ...]
    port: int
    token: str = ""
    files: frozenset[str] = frozenset({"/", "/index.html"})

    @property
    def names(self) -> frozenset[str]:
        """What the header Host may say."""
        bare = frozenset(self.hosts) if self.port == 80 else frozenset()
        return bare | {f"{host}:{self.port}" for host in self.hosts}

    @property
    def policy(self) -> str:
        """The page's content security policy: its own script and sockets, pictures it makes itself, nothing else."""
        sockets = " ".join(f"ws://{name}" for name in sorted(self.names))
        return (
            "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval' blob: data:; "
            "worker-src blob: data:; "
            f"style-src 'unsafe-inline'; img-src data: blob:; font-src data: blob:; connect-src {sockets} data: blob:; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )

    def answer(self, path: str, headers: Headers) -> Answer:
        """What to do with a request for ``path`` (with its query) that carries ``headers``.

        The Host must be this server's, exactly. An Origin, which a socket must have, must be this page's. A path is one of
        the files that there are, a socket's is "/". Where there is a token, it comes with the address once, and as a cookie
        from then on.
        """
        host, origin = list(headers.get_all("Host")), list(headers.get_all("Origin"))
        upgrade = [word.strip().lower() for value in headers.get_all("Upgrade") for word in value.split(",")]
        if len(host) != 1 or host[0].lower() not in self.names:
            return Answer(403, "This server is not called that.")
        socket = bool(upgrade)
        if socket and upgrade != ["websocket"]:
            return Answer(400, "This server speaks no such protocol.")
        # A page's own origin is the name that it was opened by.
        if len(origin) > 1 or (origin and origin[0] != f"http://{host[0].lower()}") or (socket and not origin):
            return Answer(403, "Requests of other pages are refused.")
        plain, _, query = path.partition("?")
        if plain not in ({"/"} if socket else self.files):
            return Answer(404, "There is nothing here.")
        return self._token_answer(query, headers, socket) if self.token else PASS

    def _token_answer(self, query: str, headers: Headers, socket: bool) -> Answer:
        shown = [part.partition("=") for value in headers.get_all("Cookie") for part in value.split(";")]
        if any(name.strip() == COOKIE and _same(value.strip(), self.token) for name, _, value in shown):
            return PASS
        if not socket and query.startswith("token=") and _same(query.removeprefix("token="), self.token):
            # The token leaves the address at once, so that it is not copied with it.
            return Answer(303, "", "/", f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/")
        return Answer(403, "This page needs the token that was printed where it was started.")


def _same(one: str, other: str) -> bool:
    return hmac.compare_digest(one.encode("utf-8", "replace"), other.encode())
