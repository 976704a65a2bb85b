"""A payload on springs and dampers inside the sphere: what reaches it, and the isolator that keeps it still enough."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spheredrive.design import GRAVITY
from spheredrive.errors import SpheredriveError
from spheredrive.vibration.aboard.comfort import comfort_of_lines
from spheredrive.vibration.spectra import lines

# How densely the search looks, as a share of frequency. Each line has its resonance and a dip beside it; dips that fall
# between two tries are followed to their ground.
STEP = 0.01


def transmissibility(frequency_ratio, damping_ratio) -> np.ndarray:
    """Payload's motion over its base's, complex: T = (1 + 2iζr)/(1 − r² + 2iζr).

        |T| = √((1 + (2ζr)²)/((1 − r²)² + (2ζr)²)),   1 at r = √2 for every ζ

    frequency_ratio   r = f/f_n, (...)
    damping_ratio     ζ = c/(2√(k m)), (...)

    Returns (...), complex; infinite where an undamped isolator is driven at its natural frequency. Assumes a payload too light
    to move its base; a heavy one adds its dynamic mass m T to the sphere, see ``loaded_centre``. Source: base excitation of
    the forced oscillator.
    """
    r, zeta = np.asarray(frequency_ratio, float), np.asarray(damping_ratio, float)
    with np.errstate(divide="ignore", invalid="ignore"):
        T = (1 + 2j * zeta * r) / (1 - r**2 + 2j * zeta * r)
    return np.where(np.isfinite(T), T, math.inf)


def relative_motion(frequency_ratio, damping_ratio) -> np.ndarray:
    """Travel in the isolator over its base's motion, complex: T − 1 = r²/(1 − r² + 2iζr); arguments as above."""
    r, zeta = np.asarray(frequency_ratio, float), np.asarray(damping_ratio, float)
    with np.errstate(divide="ignore", invalid="ignore"):
        Z = r**2 / (1 - r**2 + 2j * zeta * r)
    return np.where(np.isfinite(Z), Z, math.inf)


def dynamic_mass(frequency, payload_mass: float, natural_frequency: float, damping_ratio: float) -> np.ndarray:
    """What an isolated payload weighs on its base at a frequency: m T, complex, kg, (...).

    The base feels the force m T ω² x of the isolator. Well below f_n it is the payload's mass, well above it vanishes.
    """
    return payload_mass * transmissibility(np.asarray(frequency, float) / natural_frequency, damping_ratio)


@dataclass(frozen=True)
class ChosenIsolator:
    """Springs and dampers alike in every direction, between the sphere and its payload.

    natural_frequency   f_n of the payload on a base that stands still, Hz
    damping_ratio       ζ
    payload_mass        m, kg
    stiffness           k = m (2πf_n)², N/m
    damping             c = 2ζ√(k m), N·s/m
    sag                 m g/k, static, m
    stroke              bound on the travel to either side of the sag, m; see ``lines.peak_bound``
    acceleration        RMS of the payload, weighted where asked, m/s²
    bare_acceleration   the same with the payload fixed to the sphere, m/s²
    """

    natural_frequency: float
    damping_ratio: float
    payload_mass: float
    stiffness: float
    damping: float
    sag: float
    stroke: float
    acceleration: float
    bare_acceleration: float


def payload_lines(frequency, amplitude, natural_frequency: float, damping_ratio: float) -> np.ndarray:
    """Amplitudes of an isolated payload (l, 3) from those of its base, in the same unit: displacement or acceleration."""
    frequency, amplitude = lines.checked_lines(frequency, amplitude)
    return transmissibility(frequency / natural_frequency, damping_ratio)[:, None] * amplitude


def isolator_for(
    frequency,
    displacement,
    payload_mass: float,
    wanted_acceleration: float,
    damping_ratio: float = 0.1,
    *,
    weighted: bool = False,
    largest_sag: float = math.inf,
    largest_stroke: float = math.inf,
    gravity: float = GRAVITY,
    base: Callable[[float], np.ndarray] | None = None,
) -> ChosenIsolator:
    """The stiffest isolator that brings a payload's RMS acceleration to the wanted value.

    frequency             of the lines of the sphere's centre, Hz, (l,), as ``OrderSpectrum.combined`` gives them
    displacement          their complex amplitudes along x, y, z, m, (l, 3)
    payload_mass          m, kg
    wanted_acceleration   RMS of the vector of all three axes, m/s²
    damping_ratio         ζ of the isolator
    weighted              judge the total value of ISO 2631-1 in the worst upright direction instead of the plain RMS
    largest_sag           m; needs g/(2πf_n)² below it
    largest_stroke        travel to either side of the sag, m
    gravity               m/s²
    base                  f_n → displacement (l, 3) of the centre at the frequencies, rising, with the isolated payload inside,
                          see ``loaded_centre``; left out, the payload is too light to change the sphere's motion

    The answer is infinitely stiff where the payload may sit on the sphere directly. The payload's motion need not fall steadily
    with f_n, as each line has its resonance: all frequencies from above the highest line down are tried in steps of 1 %, and
    the first that does is refined. Raises ``SpheredriveError`` where none does, saying what the softest leaves, and for
    numbers that no isolator has. Assumes the same stiffness in all directions, through the payload's centre of mass: then
    neither the sphere's attitude nor the payload's rotation matters. Source: base excitation; thesis, future work.
    """
    frequency, displacement = lines.merged_lines(*lines.checked_lines(frequency, displacement))
    for name, value in (("payload mass", payload_mass), ("wanted acceleration", wanted_acceleration)):
        if not (math.isfinite(value) and value > 0):
            raise SpheredriveError(f"an isolator takes a {name} that is finite and above zero, not {value}")
    if not (math.isfinite(damping_ratio) and damping_ratio >= 0) or not gravity >= 0 or not (largest_sag > 0 < largest_stroke):
        raise SpheredriveError("an isolator takes damping and gravity that are not negative and sag and stroke above zero")

    def tried(f_n: float, bare: float = math.nan) -> ChosenIsolator:
        centre = displacement if base is None else base(f_n)
        return _isolator(frequency, centre, f_n, damping_ratio, payload_mass, weighted, gravity, bare)

    def excess(f_n: float) -> float:
        """Above zero where something is too large; shares, so that acceleration and stroke can be compared."""
        one = tried(f_n)
        stroke = 0.0 if math.isinf(largest_stroke) else one.stroke / largest_stroke
        return max(one.acceleration / wanted_acceleration, stroke) - 1

    direct = tried(math.inf)
    bare = direct.acceleration
    if bare <= wanted_acceleration:
        return tried(math.inf, bare)
    most = frequency.max() * 100
    least = min(most, max(math.sqrt(gravity / largest_sag) / (2 * math.pi), frequency[frequency > 0].min() * 1e-4))
    found = _highest_that_does(excess, least, most)
    if found is None:
        raise SpheredriveError(_impossible(tried(least, bare), wanted_acceleration, largest_sag, largest_stroke))
    return tried(found, bare)


def loaded_centre(
    frequency, displacement, receptance, payload_mass: float, damping_ratio: float
) -> Callable[[float], np.ndarray]:
    """How the centre moves with an isolated payload inside, for each isolator: a ``base`` for ``isolator_for``.

        c = (1 − m ω² T(f/f_n) G)⁻¹ c₀

    frequency      of the lines, Hz, (l,), each once, rising
    displacement   c₀ of the centre without the payload, m, (l, 3)
    receptance     G, displacement of the centre by a force on it, without the payload, m/N, (l, 3, 3)

    Returns f_n → (l, 3). An infinite f_n fixes the payload to the sphere. Source: the payload's force on its base is its
    dynamic mass times the base's acceleration.
    """
    frequency, displacement = lines.checked_lines(frequency, displacement)
    G = np.asarray(receptance, complex)

    def centre(f_n: float) -> np.ndarray:
        inertia = dynamic_mass(frequency, payload_mass, f_n, damping_ratio) * (2 * math.pi * frequency) ** 2
        return np.linalg.solve(np.eye(3) - inertia[:, None, None] * G, displacement[:, :, None])[..., 0]

    return centre


def _isolator(frequency, displacement, f_n, zeta, mass, weighted, gravity, bare) -> ChosenIsolator:
    ratio = frequency / f_n
    acceleration = -((2 * math.pi * frequency[:, None]) ** 2) * displacement
    travel = relative_motion(ratio, zeta)[:, None] * displacement
    k = mass * (2 * math.pi * f_n) ** 2
    return ChosenIsolator(
        natural_frequency=float(f_n),
        damping_ratio=zeta,
        payload_mass=mass,
        stiffness=k,
        damping=2 * zeta * math.sqrt(k * mass) if zeta else 0.0,
        sag=mass * gravity / k,
        stroke=lines.peak_bound(frequency, travel) if np.isfinite(travel).all() else math.inf,
        acceleration=_size(frequency, transmissibility(ratio, zeta)[:, None] * acceleration, weighted),
        bare_acceleration=bare,
    )


def _size(frequency, acceleration, weighted: bool) -> float:
    if not np.isfinite(acceleration).all():
        return math.inf
    if weighted:
        return comfort_of_lines(frequency, acceleration).worst_total
    return float(np.linalg.norm(lines.rms(frequency, acceleration)))


def _highest_that_does(excess: Callable[[float], float], least: float, most: float) -> float | None:
    """The highest frequency where ``excess`` is not above zero: a scan downwards, then bisection; dips are followed."""
    from scipy import optimize

    if most <= least:
        return None
    grid = np.geomspace(most, least, max(3, math.ceil(math.log(most / least) / STEP)))
    values = [excess(grid[0])]
    for i in range(1, len(grid)):
        values.append(excess(grid[i]))
        if values[i] <= 0:
            return _edge(excess, grid[i], grid[i - 1])
        # A dip between the last three may reach zero where none of them does.
        if i >= 2 and values[i - 1] < min(values[i], values[i - 2]):
            dip = optimize.minimize_scalar(excess, bounds=(grid[i], grid[i - 2]), method="bounded", options={"xatol": 1e-9})
            if dip.fun <= 0:
                return _edge(excess, float(dip.x), grid[i - 2])
    return None


def _edge(excess: Callable[[float], float], inside: float, outside: float) -> float:
    """Where it begins to do, on the side that does, to 1e-12 of the frequency."""
    while outside - inside > 1e-12 * outside:
        middle = (inside + outside) / 2
        if middle in (inside, outside):
            break
        inside, outside = (middle, outside) if excess(middle) <= 0 else (inside, middle)
    return float(inside)


def _impossible(softest: ChosenIsolator, wanted: float, largest_sag: float, largest_stroke: float) -> str:
    limits = [
        f"{name} up to {value:g} m" for name, value in (("sag", largest_sag), ("stroke", largest_stroke)) if value < math.inf
    ]
    room = f" with {' and '.join(limits)}" if limits else ""
    return (
        f"no isolator{room} brings the payload's RMS acceleration from {softest.bare_acceleration:.3g} to {wanted:g} m/s²; the "
        f"softest, {softest.natural_frequency:.3g} Hz, leaves {softest.acceleration:.3g} m/s² and travels "
        f"{softest.stroke:.3g} m: give it more room, another damping, or rounder wheels"
    )
