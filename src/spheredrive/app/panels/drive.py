"""The tab of the drive: wheel speeds, the motion they give, and the speeds that a motion takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from spheredrive.app import words
from spheredrive.app.answers import Answers
from spheredrive.design import Design

if TYPE_CHECKING:
    from spheredrive.app.session import Session

# Wheels that have a slider each; more are driven together.
SLIDERS = 12
USUAL = 10.0


class DrivePanel:
    """A slider a wheel, in rad/s, and a clock that turns them."""

    def __init__(self, session: Session):
        self.session, self.gui = session, session.server.gui
        self.running = self.gui.add_checkbox("Turn the wheels", False, hint="at the speeds below, by kinematics alone")
        session.when_changed(self.running, "turn", lambda: session.turn(self.running.value))
        upright = self.gui.add_button("Back to the start", hint="all wheels at angle zero, the sphere upright")
        upright.on_click(lambda _: session.post("start", session.restart))
        self.text = self.gui.add_html("")
        self._holder = self.gui.add_folder("Wheel speeds (rad/s)")
        self._folder: Any = None
        self._count: tuple = ()
        self.everything: Any = None
        self.sliders: list[Any] = []
        with self.gui.add_folder("Speeds for a motion of the sphere", expand_by_default=False):
            self.wanted = self.gui.add_vector3("Ω (rad/s)", (0.0, 0.0, 1.0), step=0.01, hint="x, y, z, inertial frame")
            take = self.gui.add_button("Take these speeds", hint="ω = J⁻¹ Ω by the nominal contacts")
            take.on_click(lambda _: session.post("inverse", lambda: session.drive_for(np.array(self.wanted.value))))

    def refresh(self, design: Design, speeds: np.ndarray, answers: Answers) -> None:
        """Show speeds and what they do."""
        self.text.content = words.motion_html(answers)
        if self._count != (design.wheel_count, self.session.generation):
            self._count = (design.wheel_count, self.session.generation)
            self._build(design, speeds)
        common = speeds[0] if (speeds == speeds[0]).all() else self.everything.value
        for handle, speed in zip([self.everything, *self.sliders], [common, *speeds], strict=False):
            if abs(handle.value - speed) > 1e-9:
                handle.value = float(np.clip(speed, handle.min, handle.max))

    def _build(self, design: Design, speeds: np.ndarray) -> None:
        if self._folder is not None:
            self._folder.remove()
        limit = float(np.ceil(max(design.motor.speed or USUAL, np.abs(speeds).max(), 1.0)))
        self.sliders = []
        with self._holder:
            self._folder = self.gui.add_folder(None)
        with self._folder:
            self.everything = self.gui.add_slider("All wheels", -limit, limit, 0.05, 0.0)
            self.session.when_changed(self.everything, "all", lambda: self.session.drive_all(float(self.everything.value)))
            for i in range(min(design.wheel_count, SLIDERS)):
                self._add_slider(i, limit, float(speeds[i]))

    def _add_slider(self, i: int, limit: float, speed: float) -> None:
        handle = self.gui.add_slider(f"Wheel {i + 1}", -limit, limit, 0.05, speed)
        self.sliders.append(handle)
        self.session.when_changed(handle, ("speed", i), lambda: self.session.drive(i, float(handle.value)))
