"""The page's section on vibration at constant wheel speeds."""

from __future__ import annotations

import numpy as np

from spheredrive import kinematics
from spheredrive.design import Design
from spheredrive.errors import SpheredriveError
from spheredrive.motion import Motion
from spheredrive.report import tables
from spheredrive.report.figures.campbell import campbell_caption, campbell_figure
from spheredrive.report.figures.order_spectrum import order_spectrum_caption, order_spectrum_figure
from spheredrive.report.figures.passing import passing_caption, passing_figure
from spheredrive.report.figures.transmissibility import transmissibility_caption, transmissibility_figure
from spheredrive.report.figures.wheel_outlines import outlines, wheel_outlines_caption, wheel_outlines_figure
from spheredrive.report.parts import Part, drawn
from spheredrive.simulation.rolling_run import RollingRun
from spheredrive.summary.vibration import band_rows, comfort_phrase, share_phrase
from spheredrive.vibration.assessment.assess import Assessment, assess

# Samples over which the mean speed of a motion is taken.
SAMPLES = 2001
BANDS = 20


def mean_speeds(design: Design, motion: Motion, run: RollingRun | None) -> np.ndarray | None:
    """Mean size of each wheel's speed over a motion, rad/s, (n,); None where only the dynamics could tell and did not."""
    if run is not None:
        time, speed = run.time, run.wheel_speed
    elif motion.kind == "wheel-torque":
        return None
    else:
        time = np.linspace(0, motion.duration, SAMPLES)
        values = motion.series.at(time)
        speed = values if motion.kind == "wheel-speed" else kinematics.inverse(design, values)
    if len(time) < 2:
        return np.abs(speed[0])
    return np.trapezoid(np.abs(speed), time, axis=0) / (time[-1] - time[0])


def assessed(design: Design, speeds) -> Assessment | str:
    """The vibration at ``speeds``, or the end of a sentence that says why it is not known."""
    try:
        return assess(design, speeds)
    except SpheredriveError as error:
        return str(error)


def vibration_parts(a: Assessment | str, given: bool) -> list[Part]:
    """Figures and tables of a vibration; ``given`` where its speeds were asked for, else they are means of a motion."""
    title = "Vibration at constant wheel speeds"
    if isinstance(a, str):
        return [Part("vibration", title, f"The vibration is not worked out: {a}.")]
    table = None if a.sphere is None else size_table(a)
    parts = [Part("vibration", title, _overview(a, given), table=table)]
    if outlines(a.design):
        caption = wheel_outlines_caption(a.design)
        parts.append(
            drawn("outlines", "Outlines of the wheels", caption, lambda: wheel_outlines_figure(a.design), table=wheel_table(a))
        )
    moving = not a.still and a.response is not None
    if moving and a.sphere is not None and len(a.sphere.spectrum.frequency):
        caption = f"{order_spectrum_caption(a)} {_capital(share_phrase(a.sphere))}."
        parts.append(drawn("orders", "Order spectrum", caption, lambda: order_spectrum_figure(a)))
    if not a.still and len(a.resonances.frequency):
        bands = band_table(a) if a.resonances.bands else None
        parts.append(drawn("campbell", "Campbell diagram", campbell_caption(a), lambda: campbell_figure(a), table=bands))
    if moving:
        parts.append(drawn("passing", "The motion while rollers pass", passing_caption(a), lambda: passing_figure(a)))
    if len(a.modes.natural_frequencies) and not a.still:
        caption = transmissibility_caption(a)
        parts.append(drawn("transmissibility", "Transmissibility", caption, lambda: transmissibility_figure(a)))
    return parts


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _overview(a: Assessment, given: bool) -> str:
    speeds = ", ".join(f"{omega:.4g}" for omega in a.wheel_speed[:12]) + (" …" if len(a.wheel_speed) > 12 else "")
    how = "" if given else ", the mean sizes of their speeds in the motion"
    text = f"The wheels turn at {speeds} rad/s{how}. ".replace("-", "−")
    natural = a.modes.natural_frequencies
    if len(natural):
        few = ", ".join(f"{f:.4g}" for f in natural[:6]) + (" …" if len(natural) > 6 else "")
        text += f"Natural frequencies: {few} Hz. "
    if a.sphere is None:
        return text + "At these speeds there is no steady motion."
    if a.still:
        return text + "Nothing shakes the sphere."
    c = a.sphere.comfort
    text += (
        f"For people aboard, seated upright along z, the weighted acceleration is {c.total:.3g} m/s²: "
        f"{comfort_phrase(c.words)} (ISO 2631-1); in the worst upright direction it is {c.worst_total:.3g} m/s²."
    )
    if a.impulses:
        text += " On rigid contacts peak and RMS acceleration are those between the corners, where it has no limit."
    return text


def size_table(a: Assessment) -> tables.Table:
    """Peak and RMS of the centre's displacement, velocity and acceleration."""
    assert a.sphere is not None, "a motion to tell of"
    s = a.sphere.sizes
    rows = (
        ("peak", s.peak_displacement, s.peak_velocity, s.peak_acceleration),
        ("RMS", s.rms_displacement, s.rms_velocity, s.rms_acceleration),
    )
    shown = tuple((name, f"{c * 1e6:.4g}", f"{v * 1e3:.4g}", f"{w:.4g}") for name, c, v, w in rows)
    return tables.Table(("Centre", "Displacement", "Velocity", "Acceleration"), ("", "µm", "mm/s", "m/s²"), shown, 0)


def wheel_table(a: Assessment) -> tables.Table:
    """What each wheel's outline does at its speed, and the forces of its contacts."""
    columns = ["Wheel", "Speed", "Passing", "Depth", "Velocity", "Acceleration", "Corner"]
    units = ["", "rad/s", "Hz", "µm", "mm/s", "m/s²", "mm/s"]
    if a.forces:
        columns += ["At the seat", "Least force", "Largest"]
        units += ["N", "N", "N"]
    rows = []
    for e in a.excitations[: tables.WHEELS_SHOWN]:
        numbers = [e.speed, e.passing_frequency, e.depth * 1e6, e.velocity * 1e3, e.acceleration, e.corner * 1e3]
        own = [f for f in a.forces if f.wheel == e.wheel]
        if own:
            numbers += [own[0].seat, min(f.least for f in own), max(f.largest for f in own)]
        rows.append((str(e.wheel), *(f"{x:.4g}".replace("-", "−") for x in numbers)))
    return tables.Table(tuple(columns), tuple(units), tuple(rows), max(0, len(a.excitations) - tables.WHEELS_SHOWN))


def band_table(a: Assessment) -> tables.Table:
    """Speeds to avoid, the worst first."""
    columns = ("Wheels", "From", "To", "Harmonic", "Mode", "Motion there")
    return tables.Table(columns, ("", "rad/s", "rad/s", "", "Hz", "µm"), tuple(band_rows(a.resonances.bands)[:BANDS]), 0)
