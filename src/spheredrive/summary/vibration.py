"""A vibration at constant wheel speeds as text."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING

from spheredrive.summary.cells import table

if TYPE_CHECKING:
    from spheredrive.vibration.aboard.comfort import Comfort
    from spheredrive.vibration.aboard.isolation import ChosenIsolator
    from spheredrive.vibration.assessment.assess import Assessment, Moved
    from spheredrive.vibration.spectra.campbell import SpeedBand

LINES = 8
BANDS = 8
WHEELS = 24


def vibration_text(a: Assessment, chosen: ChosenIsolator | None = None) -> str:
    """What ``spheredrive vibration`` prints: sizes, wheels, lines, speeds to avoid, comfort and findings.

    ``chosen`` is the isolator that was sought for the payload, where one was.
    """
    speeds = " ".join(f"{omega:g}" for omega in a.wheel_speed[:WHEELS]) + (" …" if len(a.wheel_speed) > WHEELS else "")
    blocks = [
        [f"{a.design.name}: {a.model} model, wheels at {speeds} rad/s", "", *_mode_lines(a)],
        _size_lines(a),
        _wheel_lines(a),
        _spectrum_lines(a),
        _avoid_lines(a),
        _isolator_lines(a, chosen),
        _comfort_lines(a),
        [_verdict(a), *(f"  {f.severity}: {f.message} [{f.code}]" for f in a.findings)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _verdict(a: Assessment) -> str:
    return f"The design {'works' if a.works else 'does not work'} at these speeds."


def _mode_lines(a: Assessment) -> list[str]:
    modes = a.modes
    if not len(modes.natural_frequencies):
        return ["  natural frequencies    none: rigid contacts leave the sphere no freedom, or nothing shakes it"]
    shown = ", ".join(f"{f:.4g}" for f in modes.natural_frequencies[:12])
    more = " …" if len(modes.natural_frequencies) > 12 else ""
    zeta = modes.damping_ratios[modes.poles.imag > 0]
    damping = "all overdamped" if not len(zeta) else _range(max(float(zeta.min()), 0.0), max(float(zeta.max()), 0.0))
    return [f"  natural frequencies    {shown}{more} Hz", f"  damping ratios         {damping}"]


def _range(low: float, high: float) -> str:
    return f"{low:.4g}" if high - low <= 5e-5 * abs(high) else f"{low:.4g} to {high:.4g}"


def _size_lines(a: Assessment) -> list[str]:
    if a.sphere is None:
        return []
    rows = [("", "displacement", "velocity", "acceleration"), ("", "µm", "mm/s", "m/s²")]
    rows += [row for name, moved in (("sphere", a.sphere), ("payload", a.payload)) if moved for row in _sizes(name, moved)]
    lines = ["  Motion of the centre", *table(rows, indent=4, left=(0,))]
    if a.impulses:
        lines.append("    On rigid contacts the acceleration is that between the corners; at each corner it is without limit.")
    if a.forces:
        least = min(a.forces, key=lambda f: f.least)
        largest = max(a.forces, key=lambda f: f.largest)
        seat = _range(min(f.seat for f in a.forces), max(f.seat for f in a.forces))
        lines += ["", f"  contact forces         {least.least:.6g} N (wheel {least.wheel}) to {largest.largest:.6g} N (wheel "
                  f"{largest.wheel}); at the seat {seat} N"]  # fmt: skip
    return lines


def _sizes(name: str, moved: Moved) -> list[tuple[str, str, str, str]]:
    s = moved.sizes
    return [
        (f"{name}, peak", f"{s.peak_displacement * 1e6:.4g}", f"{s.peak_velocity * 1e3:.4g}", f"{s.peak_acceleration:.4g}"),
        (f"{name}, RMS", f"{s.rms_displacement * 1e6:.4g}", f"{s.rms_velocity * 1e3:.4g}", f"{s.rms_acceleration:.4g}"),
    ]


def _wheel_lines(a: Assessment) -> list[str]:
    rows = [
        ("wheel", "speed", "passing", "depth", "velocity", "acceleration", "corner"),
        ("", "rad/s", "Hz", "µm", "mm/s", "m/s²", "mm/s"),
    ]
    for e in a.excitations[:WHEELS]:
        numbers = (e.speed, e.passing_frequency, e.depth * 1e6, e.velocity * 1e3, e.acceleration, e.corner * 1e3)
        rows.append((str(e.wheel), *(f"{x:.4g}" for x in numbers)))
    more = [f"    and {len(a.excitations) - WHEELS} more"] if len(a.excitations) > WHEELS else []
    return ["  What each wheel's outline does at its speed", *table(rows, indent=4), *more]


def _spectrum_lines(a: Assessment) -> list[str]:
    from spheredrive.vibration.assessment.as_dict import line_rows

    if a.sphere is None or not len(a.sphere.spectrum.frequency):
        return []
    rows = [("wheel", "harmonic", "order", "frequency", "displacement", "acceleration"), ("", "", "", "Hz", "µm", "m/s²")]
    for line in line_rows(a.sphere.spectrum)[:LINES]:
        numbers = (line["order"], line["frequency_hz"], line["displacement_m"] * 1e6, line["acceleration_m_s2"])
        rows.append((str(line["wheel"]), str(line["harmonic"]), *(f"{x:.4g}" for x in numbers)))
    return [f"  Largest lines by their velocity; {share_phrase(a.sphere)}", *table(rows, indent=4)]


def share_phrase(moved: Moved) -> str:
    """How much of the motion its lines hold."""
    if moved.share is None:
        return "corners on rigid contacts put acceleration on every harmonic, so no number of lines holds it"
    kept = 100 * moved.share
    shown = "100" if kept > 99.995 else f"{math.floor(kept * 100) / 100:g}"
    return f"all lines together hold {shown} % of the mean square acceleration"


def _avoid_lines(a: Assessment) -> list[str]:
    if a.still:
        return []
    up_to = f"up to {a.largest_speed:.4g} rad/s"
    if not a.resonances.bands:
        return [f"  Speeds to avoid {up_to}: none"]
    rows = [("wheels", "from", "to", "harmonic", "mode", "there"), ("", "rad/s", "rad/s", "", "Hz", "µm")]
    rows += band_rows(a.resonances.bands)[:BANDS]
    left = len(band_rows(a.resonances.bands)) - BANDS
    more = [f"    and {left} more of less effect"] if left > 0 else []
    return [f"  Speeds to avoid {up_to}, worst first", *table(rows, indent=4, left=(0,)), *more]


def band_rows(bands: tuple[SpeedBand, ...]) -> list[tuple[str, ...]]:
    """Rows of wheels, from, to (rad/s), harmonic, mode (Hz) and displacement there (µm); wheels with one band share a row."""

    def place(band: SpeedBand):
        return round(band.least, 6), round(band.most, 6)

    shared = [list(group) for _, group in groupby(sorted(bands, key=lambda b: (*place(b), -b.severity)), key=place)]
    shared.sort(key=lambda group: -group[0].severity)
    rows = []
    for group in shared:
        worst = group[0].crossings[0]
        wheels = sorted({band.wheel for band in group})
        named = ", ".join(map(str, wheels)) if len(wheels) <= 6 else f"{len(wheels)} wheels"
        numbers = (group[0].least, group[0].most)
        rows.append(
            (
                named,
                *(f"{x:.4g}" for x in numbers),
                str(worst.harmonic),
                f"{worst.frequency:.4g}",
                f"{worst.severity * 1e6:.4g}",
            )
        )
    return rows


def _isolator_lines(a: Assessment, chosen: ChosenIsolator | None) -> list[str]:
    if chosen is not None and math.isinf(chosen.natural_frequency):
        return ["  Isolator: none needed, the payload fixed to the sphere has "
                f"{chosen.acceleration:.4g} m/s²"]  # fmt: skip
    if a.isolator is None:
        return []
    stiffness, damping = a.isolator.stiffness[0], a.isolator.damping[0]  # type: ignore[index]
    f_n = math.sqrt(stiffness / a.isolator.mass) / (2 * math.pi)
    lines = [
        f"  Isolator of a payload of {a.isolator.mass:g} kg, taken out of sphere.mass",
        f"    natural frequency      {f_n:.4g} Hz",
        f"    stiffness, damping     {stiffness:.4g} N/m, {damping:.4g} N s/m in every direction",
    ]
    if chosen is not None:
        bare = "without limit" if math.isinf(chosen.bare_acceleration) else f"{chosen.bare_acceleration:.4g} m/s²"
        lines += [
            f"    sag, stroke            {chosen.sag * 1e3:.4g} mm, {chosen.stroke * 1e3:.4g} mm to either side",
            f"    payload's RMS          {chosen.acceleration:.4g} m/s²; fixed to the sphere {bare}",
        ]
    return lines


def _comfort_lines(a: Assessment) -> list[str]:
    moved = a.payload or a.sphere
    if moved is None:
        return []
    c = moved.comfort
    return [
        f"  Comfort aboard the {'payload' if a.payload else 'sphere'}, ISO 2631-1, seated",
        f"    upright along z        {_weighted(c.total, c.words)}",
        f"    worst upright          {_weighted(c.worst_total, c.worst_words)}, along {_direction(c)}",
    ]


def _weighted(total: float, words: tuple[str, ...]) -> str:
    return f"{total:.3g} m/s², {comfort_phrase(words)}"


def comfort_phrase(words: tuple[str, ...]) -> str:
    """The words of the comfort scale; two where its ranges overlap."""
    return " to ".join(words)


def _direction(c: Comfort) -> str:
    return "(" + ", ".join(f"{round(float(x), 3) + 0.0:g}" for x in c.worst_up) + ")"
