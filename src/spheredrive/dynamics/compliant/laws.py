"""Compiled: the forces of one contact, with their derivatives (model.md 4, 5c)."""

from __future__ import annotations

import math

from spheredrive.compiled import inlined


@inlined
def normal_force(depth, rate, stiffness, damping, dissipation, hertzian):
    """N, its derivatives by depth and rate, and the part of it that stores energy.

        N = K depth^p (1 + χ rate) + C rate,   p = 1, or 3/2 after Hertz

    ``depth`` of penetration (m) and its ``rate`` (m/s). χ is Hunt's and Crossley's: such damping begins at nothing. A contact
    does not pull: who asks ends it where N falls to zero. Beyond, where depth falls below zero, the law goes on smoothly.
    """
    root = math.sqrt(abs(depth)) if hertzian else 1.0
    elastic, slope = stiffness * depth * root, (1.5 if hertzian else 1.0) * stiffness * root
    damped = 1.0 + dissipation * rate
    return elastic * damped + damping * rate, slope * damped, elastic * dissipation + damping, elastic


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

    E = −c t μN/√((μN)² + (c t)²): the drag of a roller without inertia, never more than friction turns it with.
    """
    asked, most = resistance * t, mu * N
    whole = math.sqrt(asked * asked + most * most)
    if whole == 0.0:
        return 0.0, 0.0, 0.0
    a, b = asked / whole, most / whole
    return -asked * b, -mu * a * a * a, -resistance * b * b * b
