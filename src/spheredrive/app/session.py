"""One page: the design as it stands, what turns, and what follows from a change. One thread does all of it."""

from __future__ import annotations

import dataclasses
import functools
import os
import threading
import time
import traceback
from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive import kinematics
from spheredrive.app import words
from spheredrive.app.answers import Answers, answers
from spheredrive.app.editing import edited, rings
from spheredrive.app.inbox import Inbox
from spheredrive.app.panels.drive import DrivePanel
from spheredrive.app.panels.files import FilePanel
from spheredrive.app.panels.machine import MachinePanel
from spheredrive.app.panels.playback import PlaybackPanel
from spheredrive.app.panels.study import StudyPanel
from spheredrive.app.picture import Picture
from spheredrive.app.player import Playback, Turning, advanced, instant
from spheredrive.app.study import StudyResult
from spheredrive.app.uploads import uploaded_design, uploaded_run
from spheredrive.design import Design
from spheredrive.errors import DesignError, InputError, SpheredriveError
from spheredrive.io.design_file import load_design
from spheredrive.scene.bodies import Machine, machine
from spheredrive.scene.page import shown_gain
from spheredrive.scene.track import Track, track_of_run

if TYPE_CHECKING:
    import viser
    import xarray

# Seconds between two pictures while something turns, and between two looks at the charts.
FRAME, CHART = 1 / 25, 0.4


class Session:
    """What a page shows. All of its methods but ``post``, ``start`` and ``stop`` are called by its own thread."""

    def __init__(
        self, server: viser.ViserServer, design: Design, run: xarray.Dataset | None = None, study: StudyResult | None = None
    ):
        self.server, self.design = server, design
        self.ring, self.refusal, self.generation = 0, "", 0
        self.remembered: dict[str, Any] = {}
        self.speeds = np.ones(design.wheel_count)
        self.turning, self.turns = Turning.at_rest(design), False
        self.run: xarray.Dataset | None = None
        self.run_design: Design | None = None
        self.track: Track | None = None
        self.playback: Playback | None = None
        self.seconds_to_answer = 0.0
        self._answers: Answers | None = None
        self._machine: Machine | None = None
        self._inbox, self._thread = Inbox(), threading.Thread(target=self._work, daemon=True, name="spheredrive page")
        self._last = self._charted = 0.0
        self._build(study)
        if run is not None:
            self._take_run(run, design)
        self._show_design()
        if self.study_panel is not None:
            self._guarded(self.study_panel.draw)

    # ---- the thread

    def start(self) -> None:
        """Begin to answer the page."""
        self._thread.start()

    def stop(self) -> None:
        """Answer no more."""
        self._inbox.close()
        if self._thread.is_alive():
            self._thread.join(timeout=2.0)

    def post(self, key: Hashable, work: Callable[[], None]) -> None:
        """Leave work for the session's thread, in place of what waits under the same ``key``."""
        self._inbox.put(key, work)

    def when_changed(self, handle: Any, key: Hashable, work: Callable[[], None]) -> None:
        """Leave ``work`` each time that somebody, not this program, changes ``handle``."""
        handle.on_update(lambda event: None if event.client_id is None else self.post(key, work))

    def _work(self) -> None:
        while not self._inbox.closed:
            todo = self._inbox.take(FRAME if self._moves else None)
            for work in todo:
                begin = time.perf_counter()
                self._guarded(work)
                self.seconds_to_answer = time.perf_counter() - begin
            self._guarded(self._tick)

    def _guarded(self, work: Callable[[], None]) -> None:
        """Do ``work``; what is wrong with a value or a file is told on the page, and nothing stops the thread."""
        try:
            work()
        except SpheredriveError as error:
            self.error.content = words.error_html(error)
        except Exception:
            # A defect: the page goes on, and whoever started it sees what happened.
            traceback.print_exc()
            self.error.content = words.error_html("This program made a mistake; the details stand where it was started.")

    @property
    def _moves(self) -> bool:
        return self.turns or (self.playback is not None and self.playback.playing)

    def _tick(self) -> None:
        now = time.perf_counter()
        passed, self._last = min(now - self._last, 0.25), now
        if self._plays and self.playback is not None and self.track is not None:
            if self.playback.playing:
                self.playback = self.playback.after(passed, self.track)
                self.playing.refresh(self.playback, self.strange)
                self._pose()
                if now - self._charted > CHART:
                    self._mark(now)
        elif self.turns:
            self.turning = advanced(self.design, self.turning, self.speeds, passed)
            self._pose()

    # ---- what people do

    def change(self, key: str, value: Any) -> None:
        """Change one value of the design, or tell why it cannot be; ``value`` may be a function that reads it."""
        try:
            given = value() if callable(value) else value
            new = edited(self.design, self.ring, key, given, self.remembered)
        except DesignError as error:
            self.refusal = str(error)
            self._show_status()
            return
        wheel = rings(self.design)[self.ring].wheel
        self.remembered |= {
            f.name: getattr(wheel, f.name) for f in dataclasses.fields(wheel) if getattr(wheel, f.name) is not None
        }
        self._take_design(new)

    def choose_ring(self, ring: int) -> None:
        """Let the sliders move other wheels."""
        self.ring = ring
        self.machine_panel.refresh(self.design, self.ring)

    def rename(self, name: str) -> None:
        """Give the design another name."""
        if not name.strip() or not name.isprintable() or len(name) > 200:
            raise InputError("a design's name is one line of text of up to 200 characters")
        self.design = dataclasses.replace(self.design, name=name)

    def drive(self, wheel: int, speed: float) -> None:
        """Let one wheel turn at ``speed``, rad/s."""
        self.speeds = self.speeds.copy()
        self.speeds[wheel] = speed
        self._show_speeds()

    def drive_all(self, speed: float) -> None:
        """Let all wheels turn at ``speed``, rad/s."""
        self.speeds = np.full(self.design.wheel_count, speed)
        self._show_speeds()

    def drive_for(self, angular_velocity: np.ndarray) -> None:
        """Let the wheels turn as Ω (3,), rad/s, takes it."""
        self.speeds = kinematics.inverse(self.design, angular_velocity)
        self.generation += 1
        self._show_speeds()

    def turn(self, turns: bool) -> None:
        """Start or stop the wheels; the run, where there is one, is put aside."""
        self.turns = turns
        if turns:
            self._leave_run()
        self._pose()

    def restart(self) -> None:
        """Put everything back to where it stood."""
        self.turning = Turning.at_rest(self.design)
        self._leave_run()
        self._pose()

    def see_through(self) -> None:
        """Draw the sphere solid or as glass."""
        self._show_bodies()

    def load(self, path: str | os.PathLike) -> None:
        """Show the design of a file on this machine."""
        self._open(load_design(path))

    def open_design(self, content: bytes, name: str) -> None:
        """Show an uploaded design."""
        self._open(uploaded_design(content, name))

    def open_point(self, design: Design) -> None:
        """Show the machine of a point of a study; the view stays."""
        self._take_design(design)

    def open_run(self, content: bytes, name: str) -> None:
        """Show an uploaded run, with the design that it was made of where it is another one."""
        run = uploaded_run(content, name)
        design = self.design
        if str(run.attrs["design"]) != design.source:
            design = uploaded_design(str(run.attrs["design"]).encode(), name)
        track_of_run(design, run)
        self._open(design)
        self._take_run(run, design)
        self._show_design()

    def back_to_run(self) -> None:
        """Show the machine that the run is of."""
        if self.run_design is not None:
            self._take_design(self.run_design)

    def toggle_play(self) -> None:
        """Play or pause the run."""
        if self.playback is not None:
            self.set_playback(playing=not self.playback.playing)

    def step(self, button: str) -> None:
        """A sample back or on, or to an end of the run."""
        if self.playback is None or self.track is None:
            return
        by = {"|◂": -len(self.track.time), "◂": -1, "▸": 1, "▸|": len(self.track.time)}[button]
        self.set_playback(**dataclasses.asdict(self.playback.stepped(by, self.track)))

    def set_playback(self, **changes: Any) -> None:
        """Change the run's clock."""
        if self.playback is None:
            return
        self.back_to_run()
        self.turns = self.drive_panel.running.value = False
        self.playback = dataclasses.replace(self.playback, **changes)
        self.playing.refresh(self.playback, self.strange)
        self._pose()
        self._mark(time.perf_counter())

    # ---- what the panels ask

    @property
    def strange(self) -> bool:
        """Whether a run is open whose machine is not the one that is shown."""
        return self.track is not None and self.run_design != self.design

    @property
    def _plays(self) -> bool:
        return self.track is not None and not self.strange and not self.turns

    def shown_run(self) -> xarray.Dataset | None:
        """The run that is shown, or None."""
        return self.run if self._plays else None

    def contact_wheels(self) -> np.ndarray:
        """Wheel of each contact, from 0."""
        assert self._machine is not None
        return self._machine.contacts.wheel

    # ---- what follows

    def _build(self, study: StudyResult | None) -> None:
        gui = self.server.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="large", brand_color=(0, 85, 140))
        gui.set_panel_label("spheredrive")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(360)
        self.picture = Picture(self.server)
        self.server.on_client_connect(self._greet)
        self._build_answers()
        self.brief = gui.add_html("")
        self.error = gui.add_html("")
        tabs = gui.add_tab_group()
        self.study_panel = None
        if study is not None:
            with tabs.add_tab("Study"):
                self.study_panel = StudyPanel(self, study)
        with tabs.add_tab("Machine"):
            self.machine_panel = MachinePanel(self)
        with tabs.add_tab("Drive"):
            self.drive_panel = DrivePanel(self)
        with tabs.add_tab("Run"):
            self.playing = PlaybackPanel(self)
        with tabs.add_tab("File"):
            self.files = FilePanel(self)

    def _greet(self, client: viser.ClientHandle) -> None:
        """Let a page that was opened look at the machine, and again when its window has settled."""
        self.post(("look", client.client_id), lambda: self.picture.look(client))
        again = functools.partial(self.picture.look_again, client)
        client.camera.on_update(lambda _: self.post(("look again", client.client_id), again))

    def _build_answers(self) -> None:
        gui = self.server.gui
        panel = gui.add_panel()
        panel.dock_left()
        panel.set_width(310)
        with panel.add_tab("Answers"):
            self.status = gui.add_html("")
            self.jacobian = gui.add_html("")
            with gui.add_folder("Findings"):
                self.findings = gui.add_html("")
            with gui.add_folder("Picture", expand_by_default=False):
                self.glass = gui.add_checkbox("See through the sphere", False)
                self.when_changed(self.glass, "glass", self.see_through)
                self.key = gui.add_html(words.key_html())

    def _open(self, design: Design) -> None:
        """Show another design from the start; a run that was open is closed."""
        self.run = self.run_design = self.track = self.playback = None
        self.ring, self.remembered = 0, {}
        self.generation += 1
        self.turning = Turning.at_rest(design)
        self.speeds = np.ones(design.wheel_count)
        self._machine = None
        self._take_design(design)
        self.playing.load(None, None, "")

    def _take_run(self, run: xarray.Dataset, design: Design) -> None:
        track = track_of_run(design, run)
        self.run, self.run_design, self.track = run, design, track
        self.playback = Playback(float(track.time[0]), gain=shown_gain(track, design.sphere.radius))

    def _take_design(self, design: Design) -> None:
        self.design, self.refusal = design, ""
        if len(self.speeds) != design.wheel_count:
            speeds = np.resize(self.speeds, design.wheel_count) if len(self.speeds) else np.ones(design.wheel_count)
            self.speeds, self.turning = speeds, Turning.at_rest(design)
        self.ring = min(self.ring, len(rings(design)) - 1)
        self._show_design()

    def _leave_run(self) -> None:
        if self.playback is not None and self.playback.playing:
            self.playback = dataclasses.replace(self.playback, playing=False)
            self.playing.refresh(self.playback, self.strange)

    def _show_design(self) -> None:
        """Everything that depends on the design."""
        with self.server.atomic():
            self.error.content = ""
            self._answers = answers(self.design, self.speeds)
            first = self._machine is None
            self._machine = machine(self.design)
            if first:
                self.picture.aim(self._machine)
            self._show_bodies()
            self._pose()
            self._show_status()
            self.machine_panel.refresh(self.design, self.ring)
            self.drive_panel.refresh(self.design, self.speeds, self._answers)
            self.jacobian.content = words.jacobian_html(self._answers)
            self.findings.content = words.findings_html(self._answers.check.findings, self._notes())
            self.files.refresh()
            if first:
                self._show_run()
            elif self.playback is not None:
                self.playing.refresh(self.playback, self.strange)

    def _show_run(self) -> None:
        title = "" if self.run is None else words.run_title(self.run)
        self.playing.load(self.track, self.playback, title)
        self.picture.trail(self.track)
        if self.playback is not None:
            self.playing.refresh(self.playback, self.strange)

    def _show_bodies(self) -> None:
        assert self._machine is not None and self._answers is not None
        self.picture.show(self._machine, self._answers.nearness, self.glass.value)

    def _show_status(self) -> None:
        assert self._answers is not None
        self.status.content = words.status_html(self._answers, self.refusal)
        self.brief.content = words.brief_html(self._answers, self.refusal)

    def _show_speeds(self) -> None:
        assert self._answers is not None
        self.error.content = ""
        self._answers = answers(self.design, self.speeds, self._answers.check)
        self.drive_panel.refresh(self.design, self.speeds, self._answers)
        self._leave_run()
        self._pose(live=True)

    def _pose(self, live: bool = False) -> None:
        """Put the picture where the clock says: along the run, else at the speeds set."""
        if self._plays and not live and self.track is not None and self.playback is not None:
            most_speed = max(float(np.abs(self.track.wheel_speed).max()), 1e-9)
            most_turn = max(float(np.linalg.norm(self.track.angular_velocity, axis=1).max()), 1e-9)
            i = self.track.index(self.playback.time)
            self.picture.pose(self.track, i, self.playback.gain, most_speed, most_turn)
            return
        now = instant(self.design, self.turning, self.speeds)
        turn = max(float(np.linalg.norm(now.angular_velocity)), 1e-9)
        self.picture.pose(now, 0, 1.0, max(float(np.abs(self.speeds).max()), 1e-9), turn)

    def _mark(self, now: float) -> None:
        self._charted = now
        if self.playback is not None:
            self.playing.mark(self.playback.time)

    def _notes(self) -> list[str]:
        assert self._machine is not None
        reasons = sorted({wheel.missing for wheel in self._machine.wheels if wheel.missing})
        return [f"Rollers are not drawn: {reason}." for reason in reasons]
