"""The tab of the machine: a slider for what has a place on a scale, a line of text for every other value."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

from spheredrive.app.editing import Ring, rings
from spheredrive.design import Design
from spheredrive.errors import DesignError, did_you_mean
from spheredrive.io.design_text import quantity_text
from spheredrive.io.quantity import parse
from spheredrive.wheels import TYPES, MeasuredWheel, RollerWheel

if TYPE_CHECKING:
    from spheredrive.app.session import Session

# Parts of a design whose numbers are lines of text, and what people call them.
PARTS = {"sphere": "Sphere", "contact": "Contact", "mount": "Mount", "closure": "Closure", "stage": "Stage", "motor": "Motor"}
DEGREES = math.pi / 180


class Slider(NamedTuple):
    """A slider of the key ``key``: shown values times ``factor`` are SI."""

    key: str
    label: str
    low: float
    high: float
    step: float
    value: float
    factor: float
    hint: str = ""


def sliders(design: Design, ring: Ring) -> list[Slider]:
    """Sliders for one ring, its wheel model and the sphere."""
    R, wheel = design.sphere.radius, ring.wheel
    found = [
        _length("sphere.radius", "Sphere radius (mm)", R, 0.3 * R, 3 * R, "radius of the sphere"),
        Slider("count", "Wheels in this ring", 1, max(12, ring.count), 1, ring.count, 1, "spread evenly over a circle"),
        _angle("elevation", "Elevation (°)", ring.elevation, 90, 0.5, "of the contact above the equator, negative below"),
        _angle("azimuth", "Azimuth (°)", ring.azimuth, 180, 1, "of the first wheel, anticlockwise from x"),
        _angle("heading", "Heading (°)", ring.heading, 180, 1, "of the drive direction, from east towards north"),
        _length("radius", "Wheel radius (mm)", wheel.radius or 0.0, 0.02 * R, R, "outer radius, at the contact"),
        _angle(
            "roller_angle",
            "Roller angle (°)",
            wheel.roller_angle,
            90,
            1,
            "between roller axis and wheel axis; the sign is the hand",
        ),
    ]
    return found + (_roller_sliders(wheel) if isinstance(wheel, RollerWheel) else [])


def _roller_sliders(wheel: RollerWheel) -> list[Slider]:
    found, races, r = [], wheel.race_count, wheel.radius
    if wheel.rollers is not None:
        most = max(40 * races, wheel.rollers)
        found.append(Slider("rollers", "Rollers, all races", 2 * races, most, races, wheel.rollers, 1, "all races together"))
    if wheel.roller_radius is not None:
        found.append(
            _length(
                "roller_radius", "Roller radius (mm)", wheel.roller_radius, 0.04 * r, 0.6 * r, "of a roller's cross-section"
            )
        )
    spacing = getattr(wheel, "race_spacing", None)
    if spacing is not None:
        found.append(_length("race_spacing", "Race spacing (mm)", spacing, 0.1 * r, 2 * r, "between neighbouring races"))
    roundness = getattr(wheel, "roundness", None)
    if roundness is not None:
        found.append(
            Slider("roundness", "Roundness η", 0.0, 0.95, 0.005, roundness, 1.0, "share of the turn that falls to gaps")
        )
    if wheel.roller_length is not None:
        found.append(
            _length(
                "roller_length", "Roller length (mm)", wheel.roller_length, 0.1 * r, 2 * r, "along its axis, without round ends"
            )
        )
    return [*found, _angle("phase", "Phase (°)", wheel.phase, 180, 0.5, "wheel angle by which the rollers are ahead")]


def _angle(key: str, label: str, value: float, limit: float, step: float, hint: str) -> Slider:
    shown = round(value / DEGREES, 9)
    return Slider(key, label, min(-limit, shown), max(limit, shown), step, shown, DEGREES, hint)


def _length(key: str, label: str, value: float, low: float, high: float, hint: str) -> Slider:
    shown = round(value * 1e3, 9)
    step = 10.0 ** (math.floor(math.log10(high * 1e3)) - 3)
    low, high = (round(bound * 1e3 / step) * step for bound in (low, high))
    return Slider(key, label, round(min(low, shown), 9), round(max(high, shown), 9), step, shown, 1e-3, hint)


class MachinePanel:
    """Placement, wheel and sphere of one ring; other values below."""

    def __init__(self, session: Session):
        self.session, self.gui = session, session.server.gui
        self._holder = self.gui.add_folder(None)
        self._folder: Any = None
        self._shape: tuple = ()
        self.sliders: dict[str, Any] = {}

    def refresh(self, design: Design, ring: int) -> None:
        """Show ``design``: the same controls with new values, or others where it takes others."""
        standing = rings(design)
        chosen = standing[min(ring, len(standing) - 1)]
        wanted = sliders(design, chosen)
        names = [slider.key for slider in wanted]
        shape = (len(standing), ring, chosen.wheel.type, tuple(names), self.session.generation)
        if shape == self._shape:
            for slider in wanted:
                self._settle(self.sliders[slider.key], slider)
            return
        self._shape = shape
        if self._folder is not None:
            self._folder.remove()
        with self._holder:
            self._folder = self.gui.add_folder(None)
        with self._folder:
            self._build(design, standing, ring, wanted)

    def _settle(self, handle: Any, slider: Slider) -> None:
        """Bring a slider to a value that came from elsewhere; one that is under somebody's hand is there already."""
        if abs(handle.value * slider.factor - slider.value * slider.factor) > 1e-9 * (1 + abs(slider.value)):
            handle.value = max(handle.min, min(handle.max, slider.value))

    def _build(self, design: Design, standing: list[Ring], ring: int, wanted: list[Slider]) -> None:
        self.sliders = {}
        session, gui = self.session, self.gui
        chosen = standing[ring]
        if len(standing) > 1:
            numbers, first = [], 1
            for part in standing:
                last = first + part.count - 1
                numbers.append(f"Wheel {first}" if part.count == 1 else f"Wheels {first} to {last}")
                first = last + 1
            which = gui.add_dropdown(
                "Change", tuple(numbers), initial_value=numbers[ring], hint="which wheels these sliders move"
            )
            session.when_changed(which, "ring", lambda: session.choose_ring(numbers.index(which.value)))
        kinds = tuple(kind for kind in TYPES if kind != MeasuredWheel.type or chosen.wheel.type == kind)
        kind = gui.add_dropdown("Wheel type", kinds, initial_value=chosen.wheel.type)
        session.when_changed(kind, "type", lambda: session.change("type", kind.value))
        for slider in wanted:
            self._add_slider(slider)
        if isinstance(chosen.wheel, RollerWheel):
            choices = next(f.metadata["choices"] for f in dataclasses.fields(chosen.wheel) if f.name == "roller_shape")
            form = gui.add_dropdown("Roller shape", choices, initial_value=chosen.wheel.roller_shape)
            session.when_changed(form, "roller_shape", lambda: session.change("roller_shape", form.value))
        with gui.add_folder("Masses, contact, motor …", expand_by_default=False):
            self._texts(design, chosen)

    def _add_slider(self, slider: Slider) -> None:
        session = self.session
        numbers = (slider.low, slider.high, slider.step, slider.value)
        low, high, step, value = map(int if slider.key in ("count", "rollers") else float, numbers)
        handle = self.gui.add_slider(slider.label, low, high, step, value, hint=slider.hint or None)
        self.sliders[slider.key] = handle
        session.when_changed(handle, slider.key, lambda: session.change(slider.key, from_slider(handle.value, slider)))

    def _texts(self, design: Design, chosen: Ring) -> None:
        shown = {slider for slider in self.sliders}
        for field in dataclasses.fields(chosen.wheel):
            if field.name not in shown and field.metadata.get("unit") is not None and not field.metadata["shape"]:
                self._add_text(field, field.name, "Wheel", getattr(chosen.wheel, field.name))
        for part, title in PARTS.items():
            for field in dataclasses.fields(getattr(design, part)):
                key = f"{part}.{field.name}"
                if key not in shown and field.metadata.get("unit") is not None and not field.metadata["shape"]:
                    self._add_text(field, key, title, getattr(getattr(design, part), field.name))

    def _add_text(self, field: dataclasses.Field, key: str, title: str, value: float | None) -> None:
        unit, session = field.metadata["unit"], self.session
        label = f"{title}: {field.name.replace('_', ' ')}"
        shown = "" if value is None else quantity_text(value, unit).strip('"')
        hint = (
            field.metadata["doc"]
            + (f"; such as 2 {unit}" if unit else "")
            + ("; empty: not given" if field.default is None else "")
        )
        handle = self.gui.add_text(label, shown, hint=hint)
        session.when_changed(handle, key, lambda: session.change(key, functools.partial(read_text, handle.value, field)))


def from_slider(value: float, slider: Slider) -> float | int:
    """What a slider's position means in SI, without the rounding of its steps."""
    if isinstance(value, int) and slider.factor == 1:
        return value
    if slider.factor == DEGREES:
        return math.radians(round(value, 6))
    return float(f"{round(value, 6) * slider.factor:.12g}")


def read_text(text: str, field: dataclasses.Field) -> float | None:
    """The value that a line of text gives a field: with its unit, or nothing where the field may be left out.

    Raises ``DesignError`` for anything else.
    """
    if not text.strip():
        if field.default is dataclasses.MISSING:
            raise DesignError("is needed", (field.name,))
        return field.default
    unit = field.metadata["unit"]
    try:
        value: Any = text if unit else float(text)
    except ValueError:
        raise DesignError(f"takes a plain number, not {text[:40]!r}{did_you_mean(text[:40], [])}", (field.name,)) from None
    return parse(value, unit, field.name, field.metadata["sign"])
