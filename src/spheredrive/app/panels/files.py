"""The tab of files: the design saved, others loaded, the scene as a page of its own."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from spheredrive.designs import design_path, shipped_designs
from spheredrive.io.design_text import design_files
from spheredrive.scene.page import scene_html

if TYPE_CHECKING:
    from spheredrive.app.session import Session

_EXAMPLES = "Choose …"


class FilePanel:
    """Save and load."""

    def __init__(self, session: Session):
        self.session, gui = session, session.server.gui
        self.name = gui.add_text("Name", session.design.name, hint="name of the design")
        session.when_changed(self.name, "name", lambda: session.rename(self.name.value))
        save = gui.add_button("Save the design (.toml)", hint="a file that spheredrive check accepts")
        save.on_click(lambda event: session.post("save", lambda: self._save(event.client)))
        load = gui.add_upload_button("Load a design (.toml) …", mime_type=".toml")
        load.on_upload(lambda event: session.post("load", lambda: session.open_design(load.value.content, load.value.name)))
        examples = gui.add_dropdown("Examples", (_EXAMPLES, *shipped_designs()), initial_value=_EXAMPLES)
        session.when_changed(examples, "example", lambda: self._load_example(examples.value))
        page = gui.add_button("Save the scene (.html)", hint="the machine in motion, in one file that needs no network")
        page.on_click(lambda event: session.post("page", lambda: self._save_scene(event.client)))

    def refresh(self) -> None:
        """Show the design's name."""
        if self.name.value != self.session.design.name:
            self.name.value = self.session.design.name

    def _load_example(self, name: str) -> None:
        if name != _EXAMPLES:
            self.session.load(design_path(name))

    def _save(self, client: Any) -> None:
        text, tables = design_files(self.session.design)
        for name, content in [(f"{self._stem()}.toml", text), *tables.items()]:
            client.send_file_download(name, content.encode(), save_immediately=True)

    def _save_scene(self, client: Any) -> None:
        session = self.session
        html = scene_html(session.design, session.shown_run(), session.speeds)
        client.send_file_download(f"{self._stem()}.html", html.encode(), save_immediately=True)

    def _stem(self) -> str:
        return re.sub(r"[^A-Za-z0-9_-]+", "-", self.session.design.name).strip("-").lower()[:60] or "design"
