"""A viser server behind the guard: bound to one address, without a share link, every request looked at before viser sees it."""

from __future__ import annotations

import contextlib
import errno
import http
import io
import socket
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spheredrive.app.guard import HEADERS, LOOPBACK, Guard
from spheredrive.errors import SpheredriveError

if TYPE_CHECKING:
    import viser

# A message of the page: an upload comes in parts far below this. viser's own limit is 50 MiB.
LARGEST_MESSAGE = 4 * 2**20
# Seconds that a connection has for its first request, since browsers open some that they never use, and a page for its answer
# when the server says goodbye: both are waited for at the end.
GREETING, PARTING = 2.0, 0.5
FIRST_PORT, LAST_PORT, TRIES = 8080, 8179, 5
_starting = threading.Lock()


def start_server(address: str = "127.0.0.1", port: int | None = None, token: str = "") -> viser.ViserServer:
    """A server that listens on ``address`` and ``port``, else on the first free port from 8080 on.

    Raises ``SpheredriveError`` without viser, for an address or port that cannot be had, and where this version of viser takes
    no guard: a page without one is never opened.
    """
    try:
        import viser
    except ImportError:
        raise SpheredriveError('the page needs viser; install it with: pip install "spheredrive[app]"') from None

    class Server(viser.ViserServer):
        def request_share_url(self, verbose: bool = True) -> str | None:
            # What a page asks for with one message would open this machine to everybody.
            return None

        def stop(self) -> None:
            with contextlib.redirect_stdout(io.StringIO()):
                super().stop()

    client = Path(viser.__file__).parent / "client" / "build"
    files = frozenset({"/", *(f"/{path.relative_to(client).as_posix()}" for path in client.rglob("*") if path.is_file())})
    for _ in range(TRIES if port is None else 1):
        chosen = _free_port(address, port)
        # viser prints a banner of its own, which is not wanted.
        with (
            _starting,
            guarded(Guard(_hosts(address), chosen, token, files)) as seen,
            contextlib.redirect_stdout(io.StringIO()),
        ):
            server = Server(host=address, port=chosen, verbose=False)
        if seen and server.get_port() == chosen:
            return server
        # Where another program has taken the port in the meantime, viser listens on a later one, which the guard does not know.
        server.stop()
        if not seen:
            raise SpheredriveError(
                f"viser {viser.__version__} starts its server in a way that cannot be guarded; install viser 1.1.1"
            )
    raise SpheredriveError(f"port {chosen} was taken by another program in the same moment; start again")


@contextlib.contextmanager
def guarded(guard: Guard) -> Iterator[list[bool]]:
    """Within it, a server that viser starts asks ``guard`` first; yields a list that is filled when one does.

    viser calls ``websockets.asyncio.server.serve`` by its full name and passes a ``process_request`` that serves files. For
    viser's module alone, that name stands for a function that puts the guard before it.
    """
    import websockets.asyncio.server
    from viser.infra import _infra

    seen: list[bool] = []
    real = websockets.asyncio.server.serve

    def serve(*args: Any, process_request: Any, **options: Any) -> Any:
        seen.append(True)
        options |= {"max_size": LARGEST_MESSAGE, "open_timeout": GREETING, "close_timeout": PARTING}
        return real(*args, process_request=_checked(guard, process_request), **options)

    _infra.websockets = _Standing(websockets, ("asyncio", "server", "serve"), serve)  # type: ignore[attr-defined]
    try:
        yield seen
    finally:
        _infra.websockets = websockets  # type: ignore[attr-defined]


class _Standing:
    """A module as it is, but for one function down a path of names."""

    def __init__(self, module: Any, path: tuple[str, ...], function: Any):
        self._module = module
        setattr(self, path[0], function if len(path) == 1 else _Standing(getattr(module, path[0]), path[1:], function))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


def _checked(guard: Guard, serve_file: Any) -> Any:
    """``process_request`` with the guard before it: None lets the handshake of a socket go on."""
    from websockets.datastructures import Headers
    from websockets.http11 import Response

    def process_request(connection: Any, request: Any) -> Any:
        try:
            answer = guard.answer(request.path, request.headers)
        except Exception:  # Whatever it was, it does not get in.
            return Response(500, "Internal Server Error", Headers(), b"")
        if answer.status is not None:
            headers = Headers({**HEADERS, "Content-Type": "text/plain; charset=utf-8", "Connection": "close"})
            if answer.location:
                headers["Location"], headers["Set-Cookie"] = answer.location, answer.cookie
            body = answer.why.encode()
            headers["Content-Length"] = str(len(body))
            return Response(answer.status, http.HTTPStatus(answer.status).phrase, headers, body)
        if request.headers.get_all("Upgrade"):
            return None
        response = serve_file(connection, request)
        for name, value in {**HEADERS, "Content-Security-Policy": guard.policy}.items():
            response.headers[name] = value
        return response

    return process_request


def _hosts(address: str) -> tuple[str, ...]:
    if address in LOOPBACK:
        return LOOPBACK
    if address == "0.0.0.0":
        name = socket.gethostname()
        return (*LOOPBACK, *_own_addresses(), name.lower())
    return (address,)


def _own_addresses() -> list[str]:
    """IPv4 addresses that this machine is known by."""
    found = set()
    with contextlib.suppress(OSError):
        found |= {entry[4][0] for entry in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
    # No packet is sent: connecting a datagram socket only chooses the address that would be used.
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))
        found.add(probe.getsockname()[0])
    return sorted(str(entry) for entry in found)


def _free_port(address: str, port: int | None) -> int:
    if port is not None and not 1 <= port <= 65535:
        raise SpheredriveError(f"a port is a number from 1 to 65535, not {port}")
    for candidate in [port] if port is not None else range(FIRST_PORT, LAST_PORT + 1):
        try:
            with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind((address, candidate))
                return candidate
        except (OSError, OverflowError, UnicodeError) as error:
            if port is not None or getattr(error, "errno", None) != errno.EADDRINUSE:
                raise SpheredriveError(f"cannot listen on {address}:{candidate}: {_reason(error)}") from None
    raise SpheredriveError(f"no port from {FIRST_PORT} to {LAST_PORT} is free; name one with --port")


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error).lower()
