"""``spheredrive view``: from files to a page that is open until it is stopped."""

from __future__ import annotations

import os
import secrets
import sys
import time
import webbrowser
from collections.abc import Callable
from typing import Any, NamedTuple

from spheredrive.app.guard import LOOPBACK
from spheredrive.app.server import start_server
from spheredrive.app.study import is_study, read_study_result
from spheredrive.io.design_file import load_design


class Page(NamedTuple):
    """A page that is open: its address, the token within it where there is one, and what ends it."""

    url: str
    port: int
    stop: Callable[[], None]


def open_page(
    design: str | os.PathLike,
    run: str | os.PathLike | None = None,
    *,
    port: int | None = None,
    address: str = "127.0.0.1",
    token: str = "",
    announce: Callable[[str], None] = lambda url: None,
) -> Page:
    """Serve the page of a design file, and of a run of it or a study around it, until ``stop`` is called.

    ``design`` may also be the folder of a study alone, ``run`` its folder or result file. ``announce`` is told the address as
    soon as a browser may be sent there: it has its own work to do while the answers are worked out.

    Raises ``InputError`` for files that cannot be used, ``SpheredriveError`` where nothing can be served or viser is missing.
    """
    loaded, opened, study = _read(design, run)
    server = start_server(address, port, token)
    host = "localhost" if address == "0.0.0.0" else address
    query = f"?token={token}" if token else ""
    url = f"http://{host}:{server.get_port()}/{query}"
    try:
        announce(url)
        from spheredrive.app.session import Session

        session = Session(server, loaded, opened, study)
    except BaseException:
        server.stop()
        raise
    session.start()

    def stop() -> None:
        session.stop()
        server.stop()

    return Page(url, server.get_port(), stop)


def _read(design: Any, run: Any) -> tuple[Any, Any, Any]:
    """Design, run and study of what was named: the last two may be None."""
    named = design if run is None and os.path.isdir(design) else run
    if named is not None and is_study(named):
        study = read_study_result(named)
        return (load_design(design) if named is run else study.base()), None, study
    loaded = load_design(design)
    if run is None:
        return loaded, None, None
    from spheredrive.io.results import read_run

    return loaded, read_run(run), None


def view(
    design: str | os.PathLike,
    run: str | os.PathLike | None = None,
    port: int | None = None,
    browser: bool = True,
    address: str = "127.0.0.1",
) -> int:
    """Open the page, say where it is, and keep it open until the program is interrupted; returns 0.

    On any other address than this machine's own it takes a token, which is part of the address printed.
    """
    token = "" if address in LOOPBACK else secrets.token_urlsafe(24)

    def announce(url: str) -> None:
        print(url, flush=True)
        print("The page is open until you press Ctrl-C.", file=sys.stderr)
        if browser and not _opened(url):
            print("No browser was found: open the address above in one.", file=sys.stderr)

    page = open_page(design, run, port=port, address=address, token=token, announce=announce)
    try:
        while True:
            time.sleep(3600)
    except KeyboardInterrupt:
        return 0
    finally:
        page.stop()


def _opened(url: str) -> bool:
    """Show the page in a browser; a machine without a screen has none to ask."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    return webbrowser.open(url)
