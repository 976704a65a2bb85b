"""Compiled: how far the sphere's surface stands from a roller, and which way contact faces (model.md 3, 5c).

Everything is in the frame of a station, from the wheel's centre: x towards the sphere's place, y along v̂, z along the wheel's
axis. A roller's middle stands at (a cos β, a sin β, o), its axis along A = (−sin α sin β, sin α cos β, cos α). The sphere's
centre has the distance w from that axis and the place σ along it; as the roller is a body of revolution, its distance from the
roller is a matter of that half plane:

    gap = min over s of √(w² + (σ − s)²) − ρ(s) − R

A touch is a tuple: gap; the normal Ĝ away from the wheel; û, the roller's axis laid into the tangent plane, along which it
holds; f̂ = û × Ĝ, along which it turns freely; how these turn with a displacement of the centre, dĜ = p û + q f̂,
dû = −p Ĝ + τ f̂, by the curvatures κ_u, κ_f and κ_x of the gap, p = κ_u dd_u + κ_x dd_f, q = κ_x dd_u + κ_f dd_f, and the
twist τ by its components along Ĝ, û and f̂; the lever of the contact point about the roller's own axis; the steepness |∇gap|,
1 but on a ring; how the lever grows with a displacement along û; and, on a ring alone, p and q by a displacement along Ĝ, and
Ĝ·H Ĝ of the gap's second derivative H, by which the steepness changes.
"""

from __future__ import annotations

import math

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.compliant.layout import (
    AXIS_DISTANCE,
    BARREL,
    COSINE,
    EDGE_PLACE,
    EDGE_RADIUS,
    FIRST_PIECE,
    FLAT_ENDS,
    HALF_LENGTH,
    KIND,
    OFFSET,
    PERIOD,
    PIECE_BEGIN,
    PIECE_POWERS,
    PIECE_WIDTH,
    SECTION,
    SINE,
    STRETCH_BEGIN,
    STRETCH_END,
    THICKEST,
)


@kernel
def barrel_place(w, sigma, r_b, a, S2):
    """The place s at which a barrel ρ = r_b − √(a² + s² sin² α) is nearest to (w, σ): σ − s + ρ′ ℓ = 0, by Newton.

    Rollers across the wheel (sin α = 1) ask for the least sum of two distances, as a mirror does: there the first guess is it.
    """
    s = a * sigma / (a + w * S2)
    if S2 == 1.0:
        return s
    for _ in range(20):
        Q, ell = math.sqrt(a * a + s * s * S2), math.sqrt(w * w + (sigma - s) * (sigma - s))
        slope, bend = -s * S2 / Q, -S2 * a * a / (Q * Q * Q)
        step = (sigma - s + slope * ell) / (-1.0 + bend * ell - slope * (sigma - s) / ell)
        s -= step
        if abs(step) <= 1e-9 * a:
            # Newton's error is squared at each step.
            break
    return s


@inlined
def roller_touch(outlines, o, x, y, z, cosine, sine, R, acts):
    """Touch of the roller whose middle stands at β, cos β and sin β given; (x, y, z) is the sphere's centre.

    Of one that stands clear and does not act, no more than a gap that is no larger than it is.
    """
    a, S, C = outlines[o, AXIS_DISTANCE], outlines[o, SINE], outlines[o, COSINE]
    ex, ey, ez = x - a * cosine, y - a * sine, z - outlines[o, OFFSET]
    Ax, Ay, Az = -S * sine, S * cosine, C
    sigma = Ax * ex + Ay * ey + Az * ez
    px, py, pz = ex - sigma * Ax, ey - sigma * Ay, ez - sigma * Az
    w = math.sqrt(px * px + py * py + pz * pz)
    nearest = w - outlines[o, THICKEST] - R
    if not (nearest < 0.0 or acts):
        return (
            max(nearest, 1e-300),
            1.0,
            0.0,
            0.0,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            0.0,
        )
    px, py, pz = px / w, py / w, pz / w
    kind, L = outlines[o, KIND], outlines[o, HALF_LENGTH]
    s = barrel_place(w, sigma, outlines[o, SECTION], a, S * S) if kind == BARREL else sigma
    # (n_w, n_s): the normal in the half plane; far: how far the end's ball or edge is from the centre.
    if abs(s) <= L:
        if kind == BARREL:
            Q = math.sqrt(a * a + s * s * S * S)
            rho, bend = outlines[o, SECTION] - Q, -S * S * a * a / (Q * Q * Q)
            ell = math.sqrt(w * w + (sigma - s) * (sigma - s))
            n_w, n_s = w / ell, (sigma - s) / ell
            kappa = -bend / (ell * (w * w / (ell * ell * ell) - bend))
            gap, lever, growth = ell - rho - R, rho * n_w, kappa * n_s * (1.0 / (bend * n_w * n_w) - rho)
        else:
            n_w, n_s, kappa = 1.0, 0.0, 0.0
            gap, lever, growth = nearest, outlines[o, SECTION], 0.0
    elif kind in (FLAT_ENDS, BARREL):
        across, beyond = w - outlines[o, EDGE_RADIUS], sigma - math.copysign(outlines[o, EDGE_PLACE], s)
        far = math.sqrt(across * across + beyond * beyond)
        n_w, n_s, kappa = across / far, beyond / far, 1.0 / far
        gap, lever, growth = far - R, outlines[o, EDGE_RADIUS], 0.0
    else:
        beyond = sigma - math.copysign(L, s)
        far = math.sqrt(w * w + beyond * beyond)
        n_w, n_s, kappa = w / far, beyond / far, 1.0 / far
        gap, lever = far - outlines[o, SECTION] - R, outlines[o, SECTION] * n_w
        growth = -outlines[o, SECTION] * n_s * kappa
    fx, fy, fz = Ay * pz - Az * py, Az * px - Ax * pz, Ax * py - Ay * px
    return (
        gap,
        n_w * px + n_s * Ax, n_w * py + n_s * Ay, n_w * pz + n_s * Az,
        n_w * Ax - n_s * px, n_w * Ay - n_s * py, n_w * Az - n_s * pz,
        fx, fy, fz,
        kappa, n_w / w, 0.0, 0.0, 0.0, -n_s / w, lever, 1.0, growth, 0.0, 0.0, 0.0,
    )  # fmt: skip


@kernel
def ring_piece(angle, piece, pieces):
    """The row of ``pieces`` that holds ``angle``: in the smooth stretch that ``piece`` is in, whose ends reach on."""
    first, last = int(pieces[piece, STRETCH_BEGIN]), int(pieces[piece, STRETCH_END])
    while last > first:
        middle = (first + last + 1) // 2
        if pieces[middle, PIECE_BEGIN] <= angle:
            first = middle
        else:
            last = middle - 1
    return first


@kernel
def ring_touch(outlines, o, x, y, z, angle, piece, turn, pieces, R):
    """Touch of a ring of radius r_w − r_r and cross-section r_r at the wheel's ``angle``.

    gap = √((ϖ − r_w(φ) + r_r)² + z²) − r_r − R with (ϖ, ζ) the centre's polar coordinates and φ = ϑ − ζ. The stretch between
    two corners in which ``piece`` lies is taken beyond its ends too: a step that leaves it ends there. ``turn`` is what to take
    off the angle to come into its period. An outline without corners (``piece`` < 0) is one stretch without ends.
    """
    r_r, S, C = outlines[o, SECTION], outlines[o, SINE], outlines[o, COSINE]
    far = math.sqrt(x * x + y * y)
    cosine, sine = x / far, y / far
    local = angle - math.atan2(y, x)
    if piece < 0:
        piece = int(outlines[o, FIRST_PIECE])
        begin = pieces[piece, PIECE_BEGIN]
        local -= outlines[o, PERIOD] * math.floor((local - begin) / outlines[o, PERIOD])
    else:
        local -= turn
    p = ring_piece(local, piece, pieces)
    width = pieces[p, PIECE_WIDTH]
    u = (local - pieces[p, PIECE_BEGIN]) / width
    h = h1 = h2 = 0.0
    for k in range(pieces.shape[1] - 1, PIECE_POWERS - 1, -1):
        h2 = h2 * u + 2.0 * h1
        h1 = h1 * u + h
        h = h * u + pieces[p, k]
    h1, h2 = h1 / width, h2 / (width * width)
    across = far - outlines[o, AXIS_DISTANCE] - h
    ell = math.sqrt(across * across + z * z)
    n_b, n_z = across / ell, z / ell
    # ∇gap in (ϖ̂, ζ̂, ẑ); a wheel angle that grows moves the outline towards +ζ.
    g_z, lean = n_z, n_b * h1 / far
    steep = math.sqrt(1.0 + lean * lean)
    G_r, G_t, G_z = n_b / steep, lean / steep, g_z / steep
    along = S * G_t + C * G_z
    u_r, u_t, u_z = -along * G_r, S - along * G_t, C - along * G_z
    size = math.sqrt(u_r * u_r + u_t * u_t + u_z * u_z)
    u_r, u_t, u_z = u_r / size, u_t / size, u_z / size
    f_r, f_t, f_z = u_t * G_z - u_z * G_t, u_z * G_r - u_r * G_z, u_r * G_t - u_t * G_r
    # The Hessian in the same frame.
    l_bb, l_bz, l_zz = n_z * n_z / ell, -n_b * n_z / ell, n_b * n_b / ell
    H_rr, H_rt, H_rz = l_bb, l_bb * h1 / far - n_b * h1 / (far * far), l_bz
    H_tt, H_tz, H_zz = (l_bb * h1 * h1 - n_b * h2) / (far * far) + n_b / far, l_bz * h1 / far, l_zz
    kappa_u = (
        H_rr * u_r * u_r + H_tt * u_t * u_t + H_zz * u_z * u_z
        + 2.0 * (H_rt * u_r * u_t + H_rz * u_r * u_z + H_tz * u_t * u_z)
    )  # fmt: skip
    kappa_f = (
        H_rr * f_r * f_r + H_tt * f_t * f_t + H_zz * f_z * f_z
        + 2.0 * (H_rt * f_r * f_t + H_rz * f_r * f_z + H_tz * f_t * f_z)
    )  # fmt: skip
    kappa_x = (
        H_rr * u_r * f_r + H_tt * u_t * f_t + H_zz * u_z * f_z
        + H_rt * (u_r * f_t + u_t * f_r) + H_rz * (u_r * f_z + u_z * f_r) + H_tz * (u_t * f_z + u_z * f_t)
    ) / steep  # fmt: skip
    HG_r = H_rr * G_r + H_rt * G_t + H_rz * G_z
    HG_t = H_rt * G_r + H_tt * G_t + H_tz * G_z
    HG_z = H_rz * G_r + H_tz * G_t + H_zz * G_z
    sink_u, sink_f = (HG_r * u_r + HG_t * u_t + HG_z * u_z) / steep, (HG_r * f_r + HG_t * f_t + HG_z * f_z) / steep
    # û is the axis S ζ̂ + C ẑ laid into the tangent plane: it turns as ζ̂ does, and as the plane does.
    pace, lag = -S * f_r / (far * size), along / size
    return (
        ell - r_r - R,
        G_r * cosine - G_t * sine, G_r * sine + G_t * cosine, G_z,
        u_r * cosine - u_t * sine, u_r * sine + u_t * cosine, u_z,
        f_r * cosine - f_t * sine, f_r * sine + f_t * cosine, f_z,
        kappa_u / steep, kappa_f / steep, kappa_x,
        pace * G_t - lag * sink_f, pace * u_t - lag * kappa_x, pace * f_t - lag * kappa_f / steep,
        r_r, steep, 0.0, sink_u, sink_f, HG_r * G_r + HG_t * G_t + HG_z * G_z,
    )  # fmt: skip
