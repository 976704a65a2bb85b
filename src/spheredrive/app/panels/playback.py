"""The tab of a run: its clock, and what happened over time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.app import words
from spheredrive.app.player import Playback
from spheredrive.scene import colours
from spheredrive.scene.track import Track

if TYPE_CHECKING:
    from spheredrive.app.session import Session

RATES = {"1/100": 0.01, "1/10": 0.1, "1/4": 0.25, "1": 1.0, "4": 4.0, "10": 10.0}
GAINS = (1, 10, 100, 1000, 10_000)
# Points of a trace on the page, and traces in one chart.
POINTS, TRACES = 400, 8


class PlaybackPanel:
    """Play, pause, steps, a scrubber, and charts with a line at the time shown."""

    def __init__(self, session: Session):
        self.session, self.gui = session, session.server.gui
        gui = self.gui
        self.text = gui.add_html("")
        self.controls = gui.add_folder(None, visible=False)
        with self.controls:
            self.play = gui.add_button("Play")
            self.step = gui.add_button_group(
                "Step", ("|◂", "◂", "▸", "▸|"), hint="to the start, a sample back, a sample on, to the end"
            )
            self.time = gui.add_slider("Time (s)", 0.0, 1.0, 0.001, 0.0)
            self.rate = gui.add_dropdown("Speed", tuple(RATES), initial_value="1", hint="seconds of the run a second")
            self.gain: Any = gui.add_dropdown(
                "Vibration drawn", ("× 1",), hint="how many times its size the centre's displacement is drawn"
            )
            again = gui.add_button("Back to the run's machine", visible=False)
        self.again = again
        upload = gui.add_upload_button("Open a run (.nc) …", mime_type=".nc")
        upload.on_upload(lambda event: session.post("run", lambda: session.open_run(upload.value.content, upload.value.name)))
        self._charts_folder = gui.add_folder("Over time", visible=False)
        self._charts: list[tuple[Any, np.ndarray, tuple[np.ndarray, ...]]] = []
        clock, changed = session.set_playback, session.when_changed
        self.play.on_click(lambda _: session.post("play", session.toggle_play))
        self.step.on_click(lambda _: session.post("step", lambda: session.step(self.step.value)))
        changed(self.time, "time", lambda: clock(time=float(self.time.value), playing=False))
        changed(self.rate, "rate", lambda: clock(rate=RATES[self.rate.value]))
        changed(self.gain, "gain", lambda: clock(gain=_factor(self.gain.value)))
        again.on_click(lambda _: session.post("again", session.back_to_run))

    def load(self, track: Track | None, playback: Playback | None, title: str) -> None:
        """Show a run, or that there is none."""
        self.controls.visible = self._charts_folder.visible = track is not None
        for chart, *_ in self._charts:
            chart.remove()
        self._charts = []
        if track is None or playback is None:
            self.text.content = words.block(
                "No run is open. Make one with <code>spheredrive simulate</code>, or turn the wheels under Drive."
            )
            return
        self.text.content = words.block(title)
        first, last = float(track.time[0]), float(track.time[-1])
        self.time.value = self.time.min
        step = 10.0 ** (np.floor(np.log10(max(last - first, 1e-6))) - 3)
        self.time.max, self.time.min, self.time.step = last, first, float(step)
        self.gain.options = tuple(f"× {gain:g}" for gain in sorted({*GAINS, playback.gain}))
        self.gain.value = f"× {playback.gain:g}"
        self.gain.visible = track.shakes
        self._draw(track)

    def refresh(self, playback: Playback, strange: bool) -> None:
        """Bring clock and buttons to where the run stands; ``strange``: the machine is no longer the run's."""
        self.play.label = "Pause" if playback.playing else "Play"
        self.again.visible = strange
        time = float(np.clip(playback.time, self.time.min, self.time.max))
        if abs(self.time.value - time) > 1e-9:
            self.time.value = time

    def mark(self, time: float) -> None:
        """Move the line in the charts to ``time``."""
        for chart, x, columns in self._charts:
            chart.data = _with_line(time, x, columns)

    def _draw(self, track: Track) -> None:
        thin = track.thinned(POINTS)
        wheels = self.session.contact_wheels()
        names = [f"wheel {i + 1}" for i in range(wheels.max() + 1)]
        shades = [colours.wheel_colour(i) for i in range(len(names))]
        q = ["#222222", colours.WHEELS[1], colours.WHEELS[2], colours.WHEELS[0]]
        charts = [("Orientation (quaternion)", thin.orientation, ["w", "x", "y", "z"], q)]
        if thin.normal_force is not None:
            charts.append(
                ("Normal force, all contacts of a wheel (N)", _by_wheel(np.sum, thin.normal_force, wheels), names, shades)
            )
        if thin.slip_speed is not None and np.abs(thin.slip_speed).max() > 0:
            charts.append(
                ("Slip, largest of a wheel (mm/s)", 1e3 * _by_wheel(np.max, abs(thin.slip_speed), wheels), names, shades)
            )
        if thin.shakes:
            charts.append(("Vibration of the centre (µm)", 1e6 * thin.displacement, ["x", "y", "z"], q[1:]))
        with self._charts_folder:
            for title, values, names, shades in charts:
                self._add_chart(title, thin.time, values[:, :TRACES], names[:TRACES], shades)
            quiet = []
            if thin.slip_speed is not None and not np.abs(thin.slip_speed).max() > 0:
                quiet.append("no contact slips")
            if not thin.shakes:
                quiet.append("the sphere's centre stays in its place")
            if quiet:
                note = self.gui.add_html(words.block(f"In this run {' and '.join(quiet)}."))
                self._charts.append((_Text(note), np.zeros(0), ()))

    def _add_chart(self, title: str, time: np.ndarray, values: np.ndarray, names: list[str], shades: list[str]) -> None:
        columns = tuple(np.ascontiguousarray(column, float) for column in values.T)
        series: list[dict[str, Any]] = [{"label": "t (s)"}]
        series += [
            {"label": name, "stroke": shade, "width": 1.2, "points": {"show": False}}
            for name, shade in zip(names, shades, strict=False)
        ]
        series.append({"label": "now", "stroke": "#222222", "width": 1.0, "points": {"show": False}})
        chart = self.gui.add_uplot(
            _with_line(float(time[0]), time, columns),
            tuple(series),  # type: ignore[arg-type]
            title=title,
            scales={"x": {"time": False}},
            legend={"show": len(columns) <= 4},
            height=170,
        )
        self._charts.append((chart, time, columns))


class _Text:
    """A note that stands among the charts: it has no line to move."""

    def __init__(self, handle: Any):
        self._handle = handle
        self.data: Any = None

    def remove(self) -> None:
        self._handle.remove()


def _by_wheel(gather: Callable, values: np.ndarray, wheels: np.ndarray) -> np.ndarray:
    """Values of contacts (k, m) gathered by wheel, (k, n)."""
    return np.stack([gather(values[:, wheels == i], axis=1) for i in range(wheels.max() + 1)], axis=-1)


def _with_line(now: float, x: np.ndarray, columns: tuple[np.ndarray, ...]) -> tuple[np.ndarray, ...]:
    """Traces over ``x``, and one more along the lowest value that rises to the highest of all at ``now``."""
    if not columns:
        return ()
    i = int(np.searchsorted(x, now, side="right"))
    low, high = min(map(np.min, columns)), max(map(np.max, columns))
    line = np.full(len(x) + 3, low)
    line[i + 1] = high
    filled = [np.insert(column, [i] * 3, np.interp(now, x, column)) for column in columns]
    return (np.insert(x, [i] * 3, now), *filled, line)


def _factor(text: str) -> float:
    return float(text.removeprefix("× "))
