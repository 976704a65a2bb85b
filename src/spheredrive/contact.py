"""The contact patch between sphere and roller (Hertz), and the moments that resist rolling and spinning at it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import SpheredriveError

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.wheels.base import Wheel

# Relative angular velocity (rad/s) at which a resistance has reached 1/√2 of its full value.
SMOOTHING = 1e-3


class Hertz(NamedTuple):
    """An elastic contact patch. The first semi-axis lies along the direction of the first relative radius.

    a               semi-axis along the direction of ``relative_radius_a``, m
    b               semi-axis along the direction of ``relative_radius_b``, m
    peak_pressure   p₀, at the middle of the patch, Pa
    approach        δ, by which distant points of the two bodies come closer, m
    stiffness       K = dN/dδ, N/m
    """

    a: np.ndarray
    b: np.ndarray
    peak_pressure: np.ndarray
    approach: np.ndarray
    stiffness: np.ndarray


def contact_modulus(young_1, poisson_1, young_2, poisson_2) -> np.ndarray:
    """Contact modulus E* of two elastic bodies.

        1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂

    Young's moduli E in Pa, infinite for a rigid body; Poisson's ratios ν without unit. Broadcasts, (...) → (...), Pa.
    Raises ``ValueError`` for moduli that are not positive, for ratios outside −1 < ν ≤ ½ and where both bodies are rigid.
    Assumes bodies that are elastic, isotropic and large against the patch. Source: model.md section 4, [3.16].
    """
    young = [_positive(modulus, "Young's modulus", "Pa", finite=False) for modulus in (young_1, young_2)]
    poisson = [np.asarray(ratio, float) for ratio in (poisson_1, poisson_2)]
    for ratio in poisson:
        if not ((ratio > -1) & (ratio <= 0.5)).all():
            raise ValueError("Poisson's ratio lies above -1 and up to 0.5 for every elastic body")
    if (np.isinf(young[0]) & np.isinf(young[1])).any():
        raise ValueError("two rigid bodies have no contact modulus; one Young's modulus must be finite")
    return 1 / ((1 - poisson[0] ** 2) / young[0] + (1 - poisson[1] ** 2) / young[1])


def hertz(normal_force, relative_radius_a, relative_radius_b=None, *, modulus) -> Hertz:
    """Hertz's contact patch of two elastic bodies whose gap before loading is x²/(2 R_a) + y²/(2 R_b).

    With the longer semi-axis a, k² = 1 − (b/a)², K and E the complete elliptic integrals and D = (K − E)/k²:

        R_a/R_b = (a²/b²) (K − D)/D,   a³ = 3 N R_a D/(π E*),   p₀ = 3N/(2π a b),   δ = a² K/(2 R_a D),   dN/dδ = 3N/(2δ)

    For R_a = R_b = R_e, or R_b left out, this is the circular patch a³ = 3 N R_e/(4 E*), δ = a²/R_e. Exact for any ratio of
    the radii; either may be the larger one.

    normal_force        N, not negative, N, (...)
    relative_radius_a   R_a, relative principal radius of curvature in one principal plane, 1/R_a = 1/R₁ + 1/R₂, m, (...)
    relative_radius_b   R_b in the other, m, (...); as R_a if None
    modulus             contact modulus E*, Pa, (...); see ``contact_modulus``

    Returns ``Hertz``, its fields broadcast from all four. Without force the patch is a point: all fields are zero.
    Raises ``ValueError`` for a force that is negative or not finite and for radii or a modulus that are not positive and
    finite: a flat adds no curvature, so the other body's radius stands alone; flat in one plane is a line contact, which has
    no approach of its own. Assumes smooth, elastic surfaces with aligned principal planes and a patch much smaller than the
    radii. Source: K. L. Johnson, Contact Mechanics, 4.26–4.28; model.md section 4, [3.12–3.15].
    """
    N = np.asarray(normal_force, float)
    if not (np.isfinite(N) & (N >= 0)).all():
        raise ValueError("a normal force presses two bodies together: it must be finite and not negative")
    R_a = _positive(relative_radius_a, "a relative radius", "m")
    R_b = R_a if relative_radius_b is None else _positive(relative_radius_b, "a relative radius", "m")
    E_star = _positive(modulus, "the contact modulus", "Pa")
    R_long, R_short = np.maximum(R_a, R_b), np.minimum(R_a, R_b)
    axis_ratio = _axis_ratio(R_long / R_short)
    B, D = _elliptic_integrals(axis_ratio)
    K = B + D
    long = np.cbrt(3 * N * R_long * D / (np.pi * E_star))
    short = axis_ratio * long
    first_is_long = R_a >= R_b
    # p₀ and dN/dδ from the semi-axis, not from N over it: so they need no division at N = 0.
    fields = (
        np.where(first_is_long, long, short),
        np.where(first_is_long, short, long),
        E_star * long / (2 * R_long * D * axis_ratio),
        long**2 * K / (2 * R_long * D),
        np.pi * E_star * long / K,
    )
    return Hertz(*(field[()] for field in fields))


def relative_radii(design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Relative principal radii of curvature of sphere and roller at each wheel's nominal contact, across and along û.

        across: 1/(1/R + 1/r_r),   along: 1/(1/R + 1/r_m),   barrel: r_m = (r − r_r)/sin² α + r_r

    û is the direction in which a roller cannot give way, so the roller's axis lies along it; r_r is the radius of its
    cross-section and r_m that of its meridian: a cylinder or capsule is straight (1/r_m = 0), a sphere has r_m = r_r.
    Returns two arrays (n,), m. Assumes contact at mid-roller, and takes a wheel without roller radius (ideal, measured, or
    not described) for a sphere of its own radius r, as the thesis takes every wheel: 1/R_e = 1/R + 1/r.
    Source: model.md section 4, [3.17]; section 3 for the barrel, the envelope of balls inscribed in the wheel's cylinder.
    """
    curvatures = np.array([_roller_curvatures(wheel) for wheel in design.wheels])
    across, along = 1 / (1 / design.sphere.radius + curvatures.T)
    return across, along


def wheel_hertz(design: Design, normal_force, *, circular: bool = False) -> Hertz:
    """Hertz's contact patch at each wheel, from the moduli of the sphere and of the rollers.

    The semi-axis a lies across û and b along it, as ``relative_radii`` gives the radii. ``normal_force`` N (..., n) in N, a
    scalar for all wheels alike. ``circular`` takes every wheel for a sphere of its radius, as the thesis does (E5). Returns
    ``Hertz`` with fields (..., n). Raises ``SpheredriveError`` naming the moduli that the design does not give and
    ``ValueError`` for a force that is negative, not finite or not one a wheel. Assumes the nominal contact at mid-roller.
    Source: model.md section 4, [3.12–3.17].
    """
    missing = _missing_moduli(design)
    if any(missing):
        keys = list(dict.fromkeys(key for keys in missing for key in keys))
        raise SpheredriveError(f"a contact patch needs {' and '.join(keys)}, which the design does not give")
    return _patches(design, _per_wheel(design, normal_force), np.arange(design.wheel_count), circular)


def resistance_arms(design: Design, normal_force, *, circular: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Lever arms of rolling and of spin resistance at each wheel, l_r and l_s.

        l_r = √(b² sin² α + a² cos² α),   l_s = (3/8) max(a, b) E(k)      circle: l_r = a, l_s = 3π a/16

    Each arm is ``design.contact``'s where given. Else it follows from the patch of ``wheel_hertz`` where sphere and wheel
    have moduli, and is zero where they do not. l_r is how far the patch reaches along the drive direction v̂, the most by
    which its centre of pressure can run ahead (the thesis's demonstration); l_s is ∫ p |r| dA / N of the patch, E(k) the
    complete elliptic integral of its eccentricity. ``normal_force`` N (..., n) in N; a contact whose force is negative is
    open, and its patch a point. ``circular`` as in ``wheel_hertz``. Returns two arrays (..., n), m. Raises ``ValueError``
    for a force that is not finite or not one a wheel. Assumes that the sphere rolls as the wheel drives it, and spins
    about the patch's centre with the same friction all over. Source: model.md section 4, [3.22–3.30].
    """
    N = np.maximum(_per_wheel(design, normal_force), 0.0)
    rolling, spin = np.zeros(N.shape), np.zeros(N.shape)
    given = (design.contact.rolling_arm, design.contact.spin_arm)
    known = np.array([i for i, keys in enumerate(_missing_moduli(design)) if not keys], dtype=int)
    if known.size and None in given:
        patch = _patches(design, N, known, circular)
        alpha = np.array([design.wheels[i].roller_angle for i in known])
        rolling[..., known] = np.hypot(patch.b * np.sin(alpha), patch.a * np.cos(alpha))
        spin[..., known] = _spin_arm(patch)
    for arm, length in zip((rolling, spin), given, strict=True):
        if length is not None:
            arm[...] = length
    return rolling, spin


def resistance_moment(
    angular_velocity,
    wheel_speed,
    contact_direction,
    drive_direction,
    normal_force,
    rolling_arm,
    spin_arm,
    friction,
    smoothing: float = SMOOTHING,
    *,
    wheel_axis=None,
) -> np.ndarray:
    """Moment of rolling and spin resistance on the sphere at each contact; the wheel gets the opposite one.

        M = −N l_r w_⊥/√(|w_⊥|² + ε²) − μ N l_s R̂ w_n/√(w_n² + ε²)
        w = Ω − ω ŵ,   w_n = w · R̂,   w_⊥ = w − w_n R̂,   ŵ = −R̂ × v̂

    angular_velocity    Ω of the sphere, inertial frame, rad/s, (..., 3)
    wheel_speed         ω, rad/s, (..., n)
    contact_direction   R̂, unit vectors, (n, 3)
    drive_direction     v̂, unit vectors square to R̂, (n, 3)
    normal_force        N, N, (..., n); a contact whose force is negative is open and resists nothing
    rolling_arm         l_r, m, (..., n)
    spin_arm            l_s, m, (..., n)
    friction            coefficient μ, without unit, (..., n) or scalar
    smoothing           ε, rad/s: both parts vanish smoothly at rest, and are full for |w| ≫ ε
    wheel_axis          ŵ, unit vectors, (n, 3), where it is not −R̂ × v̂: at a race beside the wheel's middle

    Returns M, (..., n, 3), N m. The motor of a wheel feels the load M · ŵ: the resistances put −M · ŵ on the wheel about
    its axis. Power is never gained: M · Ω − M · ω ŵ = M · w ≤ 0. Raises ``ValueError`` where ε is not positive. Assumes
    that the roller's own turning about its axis resists nothing. Source: model.md section 4, [3.18–3.20, 3.23–3.25] with Ω
    replaced by the relative angular velocity.
    """
    epsilon = _positive(smoothing, "the smoothing speed", "rad/s")
    R_hat = np.asarray(contact_direction, float)
    w_hat = -np.cross(R_hat, np.asarray(drive_direction, float)) if wheel_axis is None else np.asarray(wheel_axis, float)
    relative = np.asarray(angular_velocity, float)[..., None, :] - np.asarray(wheel_speed, float)[..., None] * w_hat
    normal = np.sum(relative * R_hat, axis=-1, keepdims=True)
    tangential = relative - normal * R_hat
    N = np.maximum(np.asarray(normal_force, float), 0.0)
    rolling = N * np.asarray(rolling_arm, float)
    spinning = np.asarray(friction, float) * N * np.asarray(spin_arm, float)
    turning = np.sqrt(np.sum(tangential**2, axis=-1, keepdims=True) + epsilon**2)
    return -rolling[..., None] * tangential / turning - spinning[..., None] * R_hat * normal / np.sqrt(normal**2 + epsilon**2)


def _roller_curvatures(wheel: Wheel) -> tuple[float, float]:
    """Curvatures (1/m) of a wheel's surface at its contact, across û and along it."""
    section = wheel.roller_section
    if section == 0:
        return 1 / wheel.radius, 1 / wheel.radius
    shape = getattr(wheel, "roller_shape", "barrel")
    if shape == "sphere":
        return 1 / section, 1 / section
    if shape in ("cylinder", "capsule"):
        return 1 / section, 0.0
    return 1 / section, 1 / ((wheel.radius - section) / np.sin(wheel.roller_angle) ** 2 + section)


def _missing_moduli(design: Design) -> list[list[str]]:
    """For each wheel, the keys of the moduli that its contact lacks."""
    sphere = [("sphere", design.sphere)]
    bodies = [[*sphere, (f"wheels.{wheel.name}", wheel)] for wheel in design.wheels]
    names = ("young_modulus", "poisson_ratio")
    return [[f"{at}.{name}" for at, body in pair for name in names if getattr(body, name) is None] for pair in bodies]


def _patches(design: Design, N: np.ndarray, chosen: np.ndarray, circular: bool) -> Hertz:
    """``Hertz`` of the ``chosen`` wheels (indices from 0), whose moduli are known; forces (..., n)."""
    sphere, wheels = design.sphere, [design.wheels[i] for i in chosen]
    young = np.array([wheel.young_modulus for wheel in wheels], float)
    poisson = np.array([wheel.poisson_ratio for wheel in wheels], float)
    E_star = contact_modulus(sphere.young_modulus, sphere.poisson_ratio, young, poisson)
    if circular:
        return hertz(N[..., chosen], 1 / (1 / sphere.radius + 1 / design.wheel_radii[chosen]), modulus=E_star)
    across, along = relative_radii(design)
    return hertz(N[..., chosen], across[chosen], along[chosen], modulus=E_star)


def _spin_arm(patch: Hertz) -> np.ndarray:
    """l_s = ∫ p |r| dA / N = (3/8) a E(k) of a patch whose longer semi-axis is a; zero for a point."""
    long, short = np.maximum(patch.a, patch.b), np.minimum(patch.a, patch.b)
    open_contact = long == 0
    axis_ratio = np.where(open_contact, 1.0, short) / np.where(open_contact, 1.0, long)
    B, D = _elliptic_integrals(axis_ratio)
    return 3 / 8 * long * (B + axis_ratio**2 * D)


def _axis_ratio(radius_ratio: np.ndarray) -> np.ndarray:
    """b/a ≤ 1 of the patch whose relative radii have the ratio R_a/R_b ≥ 1, to rounding (Newton on its logarithm).

    The equation is R_a/R_b = (a²/b²) B/D, see ``_elliptic_integrals``. In logarithms it is nearly straight: slope −3/2 for a
    circle, towards −2 for a slender patch, so that a few steps do from a start at (R_a/R_b)^(−2/3).
    """
    target = np.log(radius_ratio)
    t = -2 / 3 * target
    for _ in range(20):
        ratio = np.exp(t)
        B, D = _elliptic_integrals(ratio)
        step = (np.log(B / D) - 2 * t - target) / _slope(ratio, B, D)
        t = np.minimum(t - step, 0.0)
        if np.all(np.abs(step) <= 1e-15 * np.maximum(1.0, np.abs(t))):
            break
    return np.exp(t)


def _slope(ratio: np.ndarray, B: np.ndarray, D: np.ndarray) -> np.ndarray:
    """Derivative of ln(B/D) − 2t by t = ln(b/a); with m = k² and m′ = 1 − m: d(B + D)/dm = B/(2m′), dD/dm = (B/m′ − D)/(2m)."""
    m, m_prime = (1 - ratio) * (1 + ratio), ratio**2
    # The difference loses its digits where m is small; its limit is 3π/32, near enough for a Newton step.
    D_change = np.where(m > 1e-4, (B / m_prime - D) / np.where(m > 1e-4, 2 * m, 1.0), 3 * np.pi / 32)
    B_change = B / (2 * m_prime) - D_change
    return -2 - 2 * m_prime * (B_change / B - D_change / D)


def _elliptic_integrals(axis_ratio) -> tuple[np.ndarray, np.ndarray]:
    """B = ∫ cos²x/Δ dx and D = ∫ sin²x/Δ dx over a quarter turn, Δ² = 1 − k² sin²x, k² = 1 − (b/a)², 0 < b/a ≤ 1.

    From them K = B + D, E = B + (b/a)² D, and D = (K − E)/k². Landen's transformation takes b/a = g to 2√g/(1 + g), in a few
    steps to 1, where B = D = π/4. On the way back every term is positive, so that nothing cancels for any g.
    Source: Abramowitz and Stegun 17.5–17.6.
    """
    ratios = [np.asarray(axis_ratio, float)]
    while len(ratios) < 20 and np.any(ratios[-1] < 1 - 1e-15):
        ratios.append(np.minimum(2 * np.sqrt(ratios[-1]) / (1 + ratios[-1]), 1.0))
    B = D = np.full(ratios[0].shape, np.pi / 4)
    for g in reversed(ratios):
        B, D = (B + 2 * g / (1 + g) * D) / (1 + g), (B + 2 / (1 + g) * D) / (1 + g)
    return B, D


def _per_wheel(design: Design, normal_force) -> np.ndarray:
    N = np.asarray(normal_force, float)
    n = design.wheel_count
    if N.ndim and N.shape[-1] not in (1, n):
        raise ValueError(f"takes one normal force a wheel, (..., {n}), not an array of shape {N.shape}")
    if not np.isfinite(N).all():
        raise ValueError("a normal force must be finite")
    return np.broadcast_to(N, (*N.shape[:-1], n))


def _positive(value, what: str, unit: str, *, finite: bool = True) -> np.ndarray:
    number = np.asarray(value, float)
    if not ((number > 0) & (np.isfinite(number) | (not finite))).all():
        raise ValueError(f"{what} must be {'finite and ' if finite else ''}greater than zero ({unit})")
    return number
