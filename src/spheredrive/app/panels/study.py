"""The tab of a study: which two metrics the plot shows, which point is chosen, what is known of it, and its report."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.app import words
from spheredrive.app.board import LEFT, WIDTH, Board
from spheredrive.app.study import StudyResult

if TYPE_CHECKING:
    from spheredrive.app.session import Session


class StudyPanel:
    """A plot beside the machine, and a slider along its points."""

    def __init__(self, session: Session, study: StudyResult):
        self.session, self.study, self.gui = session, study, session.server.gui
        names = self._names()
        session.picture.beside = LEFT + WIDTH
        self.board = Board(session.server, lambda point: session.post("point", lambda: self.choose(point)))
        self.gui.add_html(
            words.block(f"{escape(study.title)}: {study.count:,} points. Click one in the plot beside the machine.")
        )
        self.right = self.gui.add_dropdown("To the right", tuple(study.metrics), initial_value=names[0])
        self.up = self.gui.add_dropdown("Upward", tuple(study.metrics), initial_value=names[1])
        self.along = self.gui.add_slider("Point", 1, 1, 1, 1, hint="along the plot, from left to right")
        self.text = self.gui.add_html("")
        report = self.gui.add_button("Save its report (.html)")
        for axis in (self.right, self.up):
            session.when_changed(axis, "axes", self.draw)
        session.when_changed(self.along, "along", lambda: self.choose(int(self._order[int(self.along.value) - 1])))
        report.on_click(lambda event: session.post("report", lambda: self._save_report(event.client)))
        self._order = np.zeros(0, int)
        self.point = -1

    def draw(self) -> None:
        """Draw the plot, and choose a point where none is."""
        x, y = self.right.value, self.up.value
        front = self.study.front(x, y)
        if not len(front):
            self.text.content = words.block("No point has both metrics.")
            self.board.hide()
            return
        self._order = front
        self.along.max = len(front)
        labels = tuple(f"{name} ({unit})" if (unit := self.study.units[name]) else name for name in (x, y))
        self.board.show(self.study.metrics[x], self.study.metrics[y], front, labels)  # type: ignore[arg-type]
        self.choose(self.point if self.point >= 0 else int(front[len(front) // 2]))

    def choose(self, point: int) -> None:
        """Show the machine of a point."""
        self.point = point
        self.board.mark(point)
        at = np.flatnonzero(self._order == point)
        if len(at):
            self.along.value = int(at[0]) + 1
        rows = [(name, self._value(name, column[point])) for name, column in self.study.parameters.items()]
        rows += [(name, self._value(name, column[point])) for name, column in self.study.metrics.items()]
        self.text.content = words.block(f"<b>Point {point + 1}</b>{words.pairs(rows)}")
        self.session.open_point(self.study.design(point))

    def _names(self) -> tuple[str, str]:
        wanted = [name for name in self.study.senses if name in self.study.metrics] or list(self.study.metrics)
        rest = [name for name in self.study.metrics if name != wanted[0]]
        return wanted[0], (wanted[1] if len(wanted) > 1 else (rest[0] if rest else wanted[0]))

    def _value(self, name: str, value: Any) -> str:
        if not isinstance(value, (float, np.floating)):
            return str(value)
        unit = self.study.units.get(name.replace("/", "_"), "")
        if unit == "rad":
            return f"{np.degrees(value):.5g}°".replace("-", "−")
        return f"{value:.5g} {unit}".rstrip().replace("-", "−") if np.isfinite(value) else "not known"

    def _save_report(self, client: Any) -> None:
        from spheredrive.report.page import page

        html = page(self.study.design(self.point)).html
        client.send_file_download(f"point-{self.point + 1}.html", html.encode(), save_immediately=True)
