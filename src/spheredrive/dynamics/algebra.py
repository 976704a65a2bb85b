"""Vectors as tuples of three numbers, symmetric matrices as tuples of six (00, 01, 02, 11, 12, 22), for compiled code.

Views into arrays would cost more than the arithmetic. Every function is inlined, so that a loop over many machines that
calls them can use vector instructions.
"""

from __future__ import annotations

from spheredrive.compiled import inlined


@inlined
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def add(a, s, b):
    """a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@inlined
def times(M, a):
    """M a."""
    return (
        M[0] * a[0] + M[1] * a[1] + M[2] * a[2],
        M[1] * a[0] + M[3] * a[1] + M[4] * a[2],
        M[2] * a[0] + M[4] * a[1] + M[5] * a[2],
    )


@inlined
def add_dyad(M, s, a):
    """M + s a aᵀ."""
    return (
        M[0] + s * a[0] * a[0], M[1] + s * a[0] * a[1], M[2] + s * a[0] * a[2],
        M[3] + s * a[1] * a[1], M[4] + s * a[1] * a[2], M[5] + s * a[2] * a[2],
    )  # fmt: skip


@inlined
def inverse(M):
    """M⁻¹, and whether there is one."""
    c00, c01, c02 = M[3] * M[5] - M[4] * M[4], M[2] * M[4] - M[1] * M[5], M[1] * M[4] - M[2] * M[3]
    det = M[0] * c00 + M[1] * c01 + M[2] * c02
    size = (abs(M[0]) + abs(M[1]) + abs(M[2])) * (abs(M[1]) + abs(M[3]) + abs(M[4])) * (abs(M[2]) + abs(M[4]) + abs(M[5]))
    fine = abs(det) > 1e-14 * size
    f = 1.0 / det if fine else 0.0
    c11, c12, c22 = M[0] * M[5] - M[2] * M[2], M[1] * M[2] - M[0] * M[4], M[0] * M[3] - M[1] * M[1]
    return (f * c00, f * c01, f * c02, f * c11, f * c12, f * c22), fine


@inlined
def rotation_rows(q):
    """Rows of the rotation matrix of a quaternion (scalar first) of any length."""
    w, a, b, c = q
    s = 2.0 / (w * w + a * a + b * b + c * c)
    return (
        (1 - s * (b * b + c * c), s * (a * b - w * c), s * (a * c + w * b)),
        (s * (a * b + w * c), 1 - s * (a * a + c * c), s * (b * c - w * a)),
        (s * (a * c - w * b), s * (b * c + w * a), 1 - s * (a * a + b * b)),
    )


@inlined
def quaternion_rate(Omega, q):
    """q̇ = ½ (0, Ω) ∘ q."""
    w, v = q[0], (q[1], q[2], q[3])
    turning = add(cross(Omega, v), w, Omega)
    return -0.5 * dot(Omega, v), 0.5 * turning[0], 0.5 * turning[1], 0.5 * turning[2]
