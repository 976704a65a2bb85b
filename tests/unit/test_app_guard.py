"""The guard against requests of every kind that is none of the page's own, over a real socket and by its rules alone."""

from __future__ import annotations

import os
import re
import socket

import pytest

from spheredrive.app.guard import COOKIE, Guard
from spheredrive.app.server import LARGEST_MESSAGE, start_server
from spheredrive.errors import SpheredriveError

viser = pytest.importorskip("viser")
TOKEN = "a-token_of-letters"


class Headers:
    """Headers as a list of pairs."""

    def __init__(self, *pairs):
        self.pairs = pairs

    def get_all(self, name):
        return [value for key, value in self.pairs if key.lower() == name.lower()]


def answer(*pairs, path="/", token="", port=8080):
    return Guard(("127.0.0.1", "localhost"), port, token).answer(path, Headers(*pairs)).status


OWN = ("Host", "127.0.0.1:8080")
UPGRADE = ("Upgrade", "websocket")


def test_guard_lets_the_pages_own_requests_pass():
    assert answer(OWN) is None
    assert answer(("host", "LOCALHOST:8080"), path="/index.html?x=1") is None
    assert answer(OWN, UPGRADE, ("Origin", "http://127.0.0.1:8080")) is None
    assert answer(("Host", "127.0.0.1"), port=80) is None


def test_guard_asks_for_the_token_once():
    guard = Guard(("10.0.0.2",), 8080, TOKEN)
    own = ("Host", "10.0.0.2:8080")
    assert guard.answer("/", Headers(own)).status == 403
    assert guard.answer("/?token=wrong", Headers(own)).status == 403
    first = guard.answer(f"/?token={TOKEN}", Headers(own))
    assert (first.status, first.location) == (303, "/")
    assert first.cookie == f"{COOKIE}={TOKEN}; HttpOnly; SameSite=Strict; Path=/"
    shown = ("Cookie", f"other=1; {COOKIE}={TOKEN}")
    assert guard.answer("/", Headers(own, shown)).status is None
    sockets = (own, UPGRADE, ("Origin", "http://10.0.0.2:8080"))
    assert guard.answer("/", Headers(*sockets, shown)).status is None
    assert guard.answer("/", Headers(*sockets)).status == 403
    # A socket's address is written by a script, which a token in it would tell to anybody who reads logs.
    assert guard.answer(f"/?token={TOKEN}", Headers(*sockets)).status == 403


HOSTS = [
    "localhost.evil.com:8080", "evil.com", "evil.com:8080", "127.0.0.1.evil.com:8080", "127.0.0.1:8081", "127.0.0.1",
    "localhost", "127.0.0.1:8080.evil.com", "127.0.0.1:8080@evil.com", "evil.com#127.0.0.1:8080", "0.0.0.0:8080",
    "[::1]:8080", "127.1:8080", "2130706433:8080", "127.0.0.1:08080", "", "localhost.:8080", "xn--localhost-9za:8080",
]  # fmt: skip
ORIGINS = [
    "http://evil.com", "https://evil.com", "null", "http://localhost.evil.com:8080", "http://127.0.0.1", "http://127.0.0.1:8081",
    "https://127.0.0.1:8080", "http://localhost:8080", "http://127.0.0.1:8080.evil.com", "http://127.0.0.1:8080/",
    "http://user@127.0.0.1:8080", "HTTP://127.0.0.1:8080", "file://", "chrome-extension://abc", "",
]  # fmt: skip
PATHS = [
    "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd", "/..\\..\\windows\\win.ini", "//etc/passwd",
    "/index.html/../../../etc/passwd", "/.git/config", "/client", "/index.html%00.png", "http://evil.com/", "/\x00", "*",
]  # fmt: skip


def hostile() -> list[tuple[str, str, list[str]]]:
    """What it is, the path, and the header lines; the sound request of each kind is refused for this one reason."""
    sock = ["Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
            "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Protocol: viser-v{viser.__version__}"]  # fmt: skip
    own = "Host: 127.0.0.1:{port}"
    found = [(f"host {host!r}", "/", [f"Host: {host.replace('8080', '{port}').replace('8081', '1')}"]) for host in HOSTS]
    found += [(f"socket of origin {o!r}", "/", [own, *sock, f"Origin: {_ported(o)}"]) for o in ORIGINS]
    found += [(f"page for origin {o!r}", "/", [own, f"Origin: {_ported(o)}"]) for o in ORIGINS]
    found += [(f"path {path!r}", path, [own]) for path in PATHS]
    found += [
        ("socket without origin", "/", [own, *sock]),
        ("two hosts", "/", [own, "Host: evil.com"]),
        ("two origins", "/", [own, *sock, "Origin: http://127.0.0.1:{port}", "Origin: http://evil.com"]),
        ("no host", "/", []),
        ("socket by another path", "/anything", [own, *sock, "Origin: http://127.0.0.1:{port}"]),
        ("socket by a rebound name", "/", ["Host: evil.com:{port}", *sock, "Origin: http://evil.com:{port}"]),
        ("another protocol", "/", [own, "Upgrade: h2c", "Connection: Upgrade"]),
        ("a spelling of the upgrade that slips past", "/", [own, sock[0].upper(), *sock[1:], "Origin: http://evil.com"]),
        ("a header that is too long", "/", [own, f"X-Long: {'x' * 100_000}"]),
    ]
    return found


def _ported(origin: str) -> str:
    return origin.replace("8080", "{port}").replace("8081", "1")


@pytest.fixture(scope="module")
def server():
    running = start_server()
    yield running
    running.stop()


def asked(port: int, path: str, lines: list[str], method: str = "GET") -> str:
    """The first line that the server answers, or "" where it hangs up."""
    text = f"{method} {path} HTTP/1.1\r\n" + "".join(f"{line.replace('{port}', str(port))}\r\n" for line in lines) + "\r\n"
    with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
        try:
            connection.sendall(text.encode("latin-1"))
            return connection.recv(4096).decode("latin-1").partition("\r\n")[0]
        except ConnectionError:
            return ""


def test_hostile_requests_are_fifty_or_more():
    assert len(hostile()) >= 50


@pytest.mark.parametrize(("what", "path", "lines"), hostile(), ids=[what for what, _, _ in hostile()])
def test_server_refuses(server, what, path, lines):
    first = asked(server.get_port(), path, lines)
    assert not first or re.match(r"HTTP/1.1 (400|403|404|405|414|431)", first), first


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT"])
def test_server_refuses_every_method_but_get(server, method):
    first = asked(server.get_port(), "/", ["Host: 127.0.0.1:{port}", "Content-Length: 0"], method)
    assert not first or re.match(r"HTTP/1.1 4", first), first


def test_server_answers_its_own_page_and_tells_the_browser_to_ask_nobody_else(server):
    from urllib.request import urlopen

    with urlopen(f"http://127.0.0.1:{server.get_port()}/", timeout=10) as page:
        policy = page.headers["Content-Security-Policy"]
        assert page.status == 200 and page.headers["X-Frame-Options"] == "DENY"
    assert policy.startswith("default-src 'none'") and "frame-ancestors 'none'" in policy
    sources = re.search(r"connect-src ([^;]*)", policy)[1].split()
    assert sources == [f"ws://127.0.0.1:{server.get_port()}", f"ws://localhost:{server.get_port()}", "data:", "blob:"]


def own_socket(server):
    from websockets.sync.client import connect

    port = server.get_port()
    protocol = f"viser-v{viser.__version__}"
    return connect(f"ws://127.0.0.1:{port}", origin=f"http://127.0.0.1:{port}", subprotocols=[protocol], max_size=None)


def test_server_hangs_up_on_an_oversized_message(server):
    from websockets.exceptions import ConnectionClosed

    with own_socket(server) as page:
        page.recv(timeout=10)
        with pytest.raises(ConnectionClosed) as closed:
            page.send(b"\0" * (LARGEST_MESSAGE + 1))
            while True:
                page.recv(timeout=10)
    assert closed.value.rcvd.code == 1009


def test_server_opens_no_share_link_whatever_a_page_asks(server, monkeypatch):
    import msgspec

    asked_for = []
    monkeypatch.setattr("viser._viser.ViserTunnel", lambda *args: asked_for.append(args))
    with own_socket(server) as page:
        page.recv(timeout=10)
        page.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
        # The messages of one page are answered in their order: a pong comes after it was read.
        page.ping().wait(timeout=10)
    assert server.request_share_url() is None
    assert asked_for == []


def test_server_is_bound_to_this_machine_alone(server):
    numbers = server._websock_server._background_event_loop._selector.get_map()
    listening = set()
    for number in numbers:
        with socket.socket(fileno=os.dup(number)) as one:
            if one.family in (socket.AF_INET, socket.AF_INET6):
                listening.add(one.getsockname()[0])
    assert listening == {"127.0.0.1"}


def test_start_server_notices_a_viser_that_takes_no_guard(monkeypatch):
    # As a new version may: the server is started by a name that the guard does not stand in for.
    import websockets.asyncio.server

    import spheredrive.app.server as module

    class Blind(module._Standing):
        def __init__(self, real, path, function):
            super().__init__(real, path, websockets.asyncio.server.serve if len(path) == 1 else function)

    monkeypatch.setattr(module, "_Standing", Blind)
    with pytest.raises(SpheredriveError, match="cannot be guarded"):
        start_server()


@pytest.mark.parametrize(
    ("address", "port", "sentence"), [("127.0.0.1", 0, "1 to 65535"), ("192.0.2.1", None, "cannot listen on")]
)
def test_start_server_refuses_an_address_that_cannot_be_had(address, port, sentence):
    with pytest.raises(SpheredriveError, match=sentence):
        start_server(address, port)


def test_start_server_says_that_a_port_is_taken(server):
    with pytest.raises(SpheredriveError, match="in use"):
        start_server(port=server.get_port())
