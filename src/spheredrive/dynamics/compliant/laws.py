"""Compiled: the forces of one contact, with their derivatives (model.md 4, 5c)."""

from __future__ import annotations

import math

from spheredrive.compiled import inlined


@inlined
def normal_force(depth, rate, stiffness, damping, dissipation, hertzian):
    """N, its derivatives by depth and rate, and the part of it that stores energy.

        N = max(0, K depth^p (1 + χ rate) + C rate),   p = 1, or 3/2 after Hertz

    ``depth`` > 0 of penetration (m) and its ``rate`` (m/s). χ is Hunt's and Crossley's: such damping begins at nothing.
    """
    root = math.sqrt(depth) if hertzian else 1.0
    elastic, slope = stiffness * depth * root, (1.5 if hertzian else 1.0) * stiffness * root
    damped = 1.0 + dissipation * rate
    N = elastic * damped + damping * rate
    if N <= 0.0:
        return 0.0, 0.0, 0.0, elastic
    return N, slope * damped, elastic * dissipation + damping, elastic


@inlined
def friction(N, s, t, mu, creep):
    """Friction T against the slip s and E against the slip t, across each other, and their derivatives by N, s and t.

    (T, E) = −μ N (s, t)/√(s² + t² + v_s²)
    """
    speed = math.sqrt(s * s + t * t + creep * creep)
    T_N, E_N = -mu * s / speed, -mu * t / speed
    steep = mu * N / (speed * speed * speed)
    return (
        N * T_N, N * E_N, T_N, E_N,
        -steep * (t * t + creep * creep), steep * s * t, -steep * (s * s + creep * creep),
    )  # fmt: skip


@inlined
def drag(N, t, mu, resistance):
    """Force E of a roller's bearing against the speed t across its axis, and its derivatives by N and t.

    E = −c t/√(1 + (c t/(μ N))²): the drag of a roller without inertia, never more than friction turns it with.
    """
    asked, most = resistance * t, mu * N
    if asked == 0.0 or most == 0.0:
        return 0.0, 0.0, (0.0 if most == 0.0 else -resistance)
    ratio = asked / most
    root = math.sqrt(1.0 + ratio * ratio)
    return -asked / root, -mu * ratio * ratio * ratio / (root * root * root), -resistance / (root * root * root)
