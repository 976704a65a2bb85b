"""A headless Chromium by its DevTools protocol: what the tests of the browser app look through."""

from __future__ import annotations

import base64
import itertools
import json
import re
import shutil
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path

EXECUTABLE = next((found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None)
_SWITCHES = (
    "--headless", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-background-networking", "--no-first-run", "--remote-debugging-port=0", "--remote-allow-origins=*",
)  # fmt: skip


class Chromium:
    """One page in a browser of its own, drawn in software; ``with`` it, everything is gone afterwards."""

    def __init__(self, width: int = 1280, height: int = 800):
        self.size = width, height
        self.events: list[dict] = []
        self._number = itertools.count(1)

    def __enter__(self) -> Chromium:
        from websockets.sync.client import connect

        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        command = [str(EXECUTABLE), *_SWITCHES, f"--user-data-dir={self._folder.name}", "about:blank"]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        assert self._process.stderr is not None
        # It says on its standard error where it listens.
        port = next(found[1] for line in self._process.stderr if (found := re.search(r"ws://127\.0\.0\.1:(\d+)/", line)))
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=20) as answer:
            page = next(target for target in json.load(answer) if target["type"] == "page")
        self._socket = connect(page["webSocketDebuggerUrl"], max_size=None)
        width, height = self.size
        self.do("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.do(f"{domain}.enable")
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._process.terminate()
        self._process.wait(timeout=20)
        self._process.stderr.close()
        self._folder.cleanup()

    def do(self, method: str, **parameters) -> dict:
        """The answer to one command of the protocol."""
        number = next(self._number)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=60))
            if message.get("id") == number:
                assert "error" not in message, message["error"]
                return message["result"]
            self.events.append(message)

    def value(self, expression: str):
        """What a JavaScript expression is in the page."""
        answer = self.do("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def wait(self, expression: str, seconds: float = 30.0):
        """The expression's value as soon as it is true."""
        end = time.monotonic() + seconds
        while not (found := self.value(expression)):
            assert time.monotonic() < end, f"still not so after {seconds} s: {expression}\n{self.text()[:2000]}"
            time.sleep(0.02)
        return found

    def open(self, url: str) -> None:
        """Go to a page."""
        self.do("Page.navigate", url=url)

    def text(self) -> str:
        """All text that the page shows."""
        return self.value("document.body ? document.body.innerText : ''") or ""

    def click(self, text: str) -> None:
        """Click what shows exactly ``text``."""
        find = "[...document.querySelectorAll('button, [role=tab], label, legend, div, span')]"
        shown = f".filter(e => e.innerText && e.innerText.trim() === {json.dumps(text)} && e.offsetParent)"
        middle = "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2];"
        seen = "if (!e) return null; e.scrollIntoView({block: 'center'});"
        place = self.wait(f"(() => {{ const e = {find}{shown}.at(-1); {seen} {middle} }})()")
        for kind in ("mousePressed", "mouseReleased"):
            self.do("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], button="left", clickCount=1)

    def type_into(self, label: str, content: str) -> None:
        """Put ``content`` in place of what the box beside ``label`` holds, and leave the box."""
        beside = f"""(() => {{
          const name = [...document.querySelectorAll('label, div, span')].filter(
            e => e.childElementCount === 0 && e.textContent.trim() === {json.dumps(label)} && e.offsetParent).at(-1);
          for (let e = name; e && e !== document.body; e = e.parentElement) {{
            const boxes = [...e.querySelectorAll('input')].filter(i => i.type !== 'hidden' && i.offsetParent);
            if (!boxes.length) continue;
            const box = boxes.at(-1);
            box.scrollIntoView({{block: 'center'}}); box.focus(); box.select();
            return true;
          }}
          return false;
        }})()"""
        self.wait(beside)
        self.do("Input.insertText", text=content)
        for kind in ("keyDown", "keyUp"):
            self.do("Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", windowsVirtualKeyCode=13)

    def picture(self, path: Path | None = None) -> bytes:
        """The window as a PNG, also written to ``path``."""
        found = base64.b64decode(self.do("Page.captureScreenshot", format="png")["data"])
        if path is not None:
            path.write_bytes(found)
        return found

    def requests(self) -> list[str]:
        """Addresses that the page has asked for."""
        return [e["params"]["request"]["url"] for e in self.events if e["method"] == "Network.requestWillBeSent"]

    def errors(self) -> list[str]:
        """What went wrong in the page."""
        thrown = [str(e["params"]["exceptionDetails"]) for e in self.events if e["method"] == "Runtime.exceptionThrown"]
        logged = (e["params"]["entry"] for e in self.events if e["method"] == "Log.entryAdded")
        return thrown + [entry["text"] for entry in logged if entry["level"] == "error"]
