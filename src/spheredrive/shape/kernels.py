"""Compiled: how a sphere rests on one roller, by how much the centres stand apart, and where one roller takes over.

The wheel's frame has x towards the sphere's centre, z along the wheel's axis. A roller whose centre stands at angle β is
the envelope of balls of radius ρ(s) about the points of its axis,

    p(s) = (a cos β − s sin α sin β,  a sin β + s sin α cos β,  s cos α + o),   |s| ≤ L,

and a ball that touches the sphere holds its centre at r + R, r(s, β) = p_x + √((R + ρ)² − p_y² − p_z²) − R. The roller
holds it at the largest of these. Where that is the last ball of the axis, contact is on the roller's end: that ball itself
where the end is rounded, else the edge, the circle in which the last ball touches the roller's surface.
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import njit

# Entries of the flat description of a roller under a sphere, ``body``.
A, SINE, COSINE, OFFSET, SPHERE, HALF_LENGTH, ROUNDED, BARREL = range(8)
# Columns of what ``outline`` fills in.
HEIGHT, SLOPE, CURVATURE, PLACE, ALONG, AXIAL, REGION = range(7)
# Where on a roller contact is: on its side, on the end at s = −L or s = +L. DECIDE asks for it.
BACK, SIDE, FRONT, DECIDE = -1, 0, 1, 2
# A height below every other: this roller does not reach the sphere.
NOWHERE = -1e300


@njit(error_model="numpy")
def generatrix(s, body, knots, table):
    """ρ, ρ′, ρ″ at the place s: a barrel's r_b − √(a² + s² sin² α), else the cubic pieces of ``table``."""
    if body[BARREL] > 0:
        a, S = body[A], body[SINE]
        Q = math.sqrt(a * a + s * s * S * S)
        return body[BARREL] - Q, -s * S * S / Q, -S * S * a * a / Q**3
    j = 0
    while j < table.shape[0] - 1 and s > knots[j + 1]:
        j += 1
    x = s - knots[j]
    c0, c1, c2, c3 = table[j, 0], table[j, 1], table[j, 2], table[j, 3]
    return c0 + x * (c1 + x * (c2 + x * c3)), c1 + x * (2 * c2 + x * 3 * c3), 2 * c2 + 6 * c3 * x


@njit(error_model="numpy")
def pull(s, beta, body, knots, table):
    """∂r/∂s, positive where a ball further along the axis holds the sphere higher; and ∂²r/∂s².

    Where a ball does not reach the line of centres at all, the first has the right sign only and the second is zero.
    """
    a, S, C, R = body[A], body[SINE], body[COSINE], body[SPHERE]
    sine, cosine = math.sin(beta), math.cos(beta)
    rho, rho1, rho2 = generatrix(s, body, knots, table)
    y, z = a * sine + s * S * cosine, s * C + body[OFFSET]
    W = (R + rho) ** 2 - y * y - z * z
    W_s = 2 * ((R + rho) * rho1 - y * S * cosine - z * C)
    if not W > 0:
        return W_s, 0.0
    q = math.sqrt(W)
    W_ss = 2 * (rho1 * rho1 + (R + rho) * rho2 - S * S * cosine * cosine - C * C)
    return W_s / (2 * q) - S * sine, W_ss / (2 * q) - W_s * W_s / (4 * q * W)


@njit(error_model="numpy")
def ball_height(s, beta, body, knots, table):
    """r(s, β) of one ball, written so that nothing cancels for a large sphere; NOWHERE if it cannot touch."""
    R = body[SPHERE]
    rho = generatrix(s, body, knots, table)[0]
    x = body[A] * math.cos(beta) - s * body[SINE] * math.sin(beta)
    y = body[A] * math.sin(beta) + s * body[SINE] * math.cos(beta)
    z = s * body[COSINE] + body[OFFSET]
    W = (R + rho) ** 2 - y * y - z * z
    if not W > 0:
        return NOWHERE
    return x + (2 * R * rho + rho * rho - y * y - z * z) / (math.sqrt(W) + R)


@njit(error_model="numpy")
def find_place(beta, region, body, knots, table):
    """The region of contact and the place s of the ball that carries it: ∂r/∂s = 0 by Newton's method between brackets."""
    L = body[HALF_LENGTH]
    if L == 0.0:
        return FRONT, 0.0
    if region in (BACK, FRONT):
        return region, region * L
    low, high = -L, L
    count = table.shape[0]
    if body[BARREL] == 0.0 and count > 1:
        # A generatrix of any form may hold the sphere in several places: look for the highest first.
        best, steps = -2e300, 8 * count
        for i in range(steps + 1):
            s = -L + 2 * L * i / steps
            height = ball_height(s, beta, body, knots, table)
            if height > best:
                best, low, high = height, max(s - 2 * L / steps, -L), min(s + 2 * L / steps, L)
    if region == DECIDE:
        if high == L and pull(L, beta, body, knots, table)[0] >= 0:
            return FRONT, L
        if low == -L and pull(-L, beta, body, knots, table)[0] <= 0:
            return BACK, -L
    s, last = 0.5 * (low + high), math.inf
    for _ in range(100):
        f, f_s = pull(s, beta, body, knots, table)
        if f > 0:
            low = s
        elif f < 0:
            high = s
        else:
            break
        step = -f / f_s if f_s < 0 else math.inf
        if abs(step) <= 1e-9 * L:
            # Newton's error is squared at each step, so the next one would be below rounding.
            s += step
            break
        new = s + step
        # Steps that leave the bracket or do not shrink by half are replaced by halving.
        if not low <= new <= high or abs(step) > 0.5 * last:
            new = 0.5 * (low + high)
        last = abs(new - s)
        if new == s:
            break
        s = new
    return SIDE, s


@njit(error_model="numpy")
def on_ball(s, beta, on_side, body, knots, table, row):
    """Contact on the ball at s: heights and derivatives by β, s fixed on an end, and free to move on the side."""
    a, S, C, R = body[A], body[SINE], body[COSINE], body[SPHERE]
    sine, cosine = math.sin(beta), math.cos(beta)
    rho, rho1, rho2 = generatrix(s, body, knots, table)
    x, y, z = a * cosine - s * S * sine, a * sine + s * S * cosine, s * C + body[OFFSET]
    W = (R + rho) ** 2 - y * y - z * z
    if not W > 0:
        row[HEIGHT], row[SLOPE], row[CURVATURE] = NOWHERE, 0.0, 0.0
        return
    q = math.sqrt(W)
    row[HEIGHT] = x + (2 * R * rho + rho * rho - y * y - z * z) / (q + R)
    row[SLOPE] = -y - x * y / q
    # (y² − x²)/q − x² y²/q³ − x
    row[CURVATURE] = -x - (x * x - y * y) / q - x * x * y * y / (q * W)
    if on_side:
        W_s = 2 * ((R + rho) * rho1 - y * S * cosine - z * C)
        W_ss = 2 * (rho1 * rho1 + (R + rho) * rho2 - S * S * cosine * cosine - C * C)
        r_ss = W_ss / (2 * q) - W_s * W_s / (4 * q * W)
        r_sb = -S * cosine - S * (x * cosine - y * sine) / q + W_s * x * y / (2 * q * W)
        row[CURVATURE] -= r_sb * r_sb / r_ss
    row[ALONG] = R * y / (R + rho)
    row[AXIAL] = R * z / (R + rho)


@njit(error_model="numpy")
def on_edge(s, beta, body, knots, table, row):
    """Contact on the edge circle of radius σ about the axis at e: its distance from the sphere's centre is R.

    With D = R + r, m = |centre − roller's middle|², u = D sin α sin β + o cos α the way from the middle back along the
    axis, and w = √(m − u²) the distance from the axis:   E = m + 2 e u + e² + σ² − 2 σ w − R² = 0.
    """
    a, S, C, R, o = body[A], body[SINE], body[COSINE], body[SPHERE], body[OFFSET]
    sine, cosine = math.sin(beta), math.cos(beta)
    rho, rho1, _ = generatrix(s, body, knots, table)
    e, sigma = s - rho * rho1, rho * math.sqrt(max(0.0, 1 - rho1 * rho1))
    r, w, E_D = math.sqrt(a * a + s * s) + rho + abs(o), 0.0, 1.0
    settled = False
    for _ in range(50):
        D = R + r
        u = D * S * sine + o * C
        w = math.sqrt(D * D - 2 * D * a * cosine + a * a + o * o - u * u)
        # D² − R² = 2 R r + r²: nothing of the size of R² is left to cancel.
        E = 2 * R * r + r * r - 2 * D * a * cosine + a * a + o * o + 2 * e * u + e * e + sigma * sigma - 2 * sigma * w
        E_D = 2 * D - 2 * a * cosine + 2 * e * S * sine - 2 * sigma * (D - a * cosine - u * S * sine) / w
        step = E / E_D
        r -= step
        # Newton's error is squared at each step, so the one after this is below rounding.
        if not abs(step) > 1e-9 * a:
            settled = abs(step) <= 1e-9 * a
            break
    if not (settled and E_D > 0):
        row[HEIGHT], row[SLOPE], row[CURVATURE] = NOWHERE, 0.0, 0.0
        return
    D = R + r
    u = D * S * sine + o * C
    v = D * D - 2 * D * a * cosine + a * a + o * o - u * u
    w = math.sqrt(v)
    m_b, u_D, u_b = 2 * D * a * sine, S * sine, D * S * cosine
    v_D, v_b = 2 * D - 2 * a * cosine - 2 * u * u_D, m_b - 2 * u * u_b
    v_DD, v_Db = 2 - 2 * u_D * u_D, 2 * a * sine - 2 * u_D * u_b - 2 * u * S * cosine
    v_bb = 2 * D * a * cosine - 2 * u_b * u_b + 2 * u * D * S * sine
    E_D = 2 * D - 2 * a * cosine + 2 * e * u_D - sigma * v_D / w
    E_b = m_b + 2 * e * u_b - sigma * v_b / w
    E_DD = 2 - sigma * (v_DD / w - v_D * v_D / (2 * w * v))
    E_Db = 2 * a * sine + 2 * e * S * cosine - sigma * (v_Db / w - v_D * v_b / (2 * w * v))
    E_bb = 2 * D * a * cosine - 2 * e * D * S * sine - sigma * (v_bb / w - v_b * v_b / (2 * w * v))
    slope = -E_b / E_D
    row[HEIGHT] = r
    row[SLOPE] = slope
    row[CURVATURE] = -(E_bb + 2 * E_Db * slope + E_DD * slope * slope) / E_D
    row[ALONG] = a * sine + e * S * cosine + sigma * (u * S * cosine - a * sine) / w
    row[AXIAL] = o + e * C + sigma * (u * C - o) / w


@njit(error_model="numpy")
def touch(beta, region, body, knots, table, row):
    """Fill ``row`` (7,) for one angle β; see ``outline``."""
    region, s = find_place(beta, region, body, knots, table)
    if region == SIDE or body[ROUNDED] != 0.0:
        on_ball(s, beta, region == SIDE, body, knots, table, row)
    else:
        on_edge(s, beta, body, knots, table, row)
    row[PLACE], row[REGION] = s, region


@njit(error_model="numpy")
def outline(beta, region, body, knots, table, out):
    """How one roller holds the sphere at each angle of ``beta`` (k,), into ``out`` (k, 7).

    Columns: r, dr/dβ, d²r/dβ², s, the contact point's y and z, the region. ``region``: where contact is, if known.
    """
    for i in range(beta.size):
        touch(beta[i], region, body, knots, table, out[i])


@njit(error_model="numpy")
def passing_angle(s, reach, body, knots, table):
    """The angle |β| ≤ ``reach`` at which contact on the roller's side passes the place s, to the last bit; NaN if none."""
    low, high = -reach, reach
    rising = pull(s, high, body, knots, table)[0] > 0
    if (pull(s, low, body, knots, table)[0] > 0) == rising:
        return math.nan
    for _ in range(100):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if (pull(s, middle, body, knots, table)[0] > 0) == rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


@njit(error_model="numpy")
def takeover_angle(low, high, body_1, centre_1, body_2, centre_2, knots, table):
    """The wheel angle in [low, high] at which roller 2 comes to hold the sphere higher than roller 1, which does before.

    Newton's method on the difference of their heights, halving where it would leave the bracket.
    """
    one, two = np.empty(7), np.empty(7)
    x, last = 0.5 * (low + high), math.inf
    for _ in range(100):
        touch(x - centre_1, DECIDE, body_1, knots, table, one)
        touch(x - centre_2, DECIDE, body_2, knots, table, two)
        f, f_x = two[HEIGHT] - one[HEIGHT], two[SLOPE] - one[SLOPE]
        if f > 0:
            high = x
        elif f < 0:
            low = x
        else:
            break
        step = -f / f_x if f_x > 0 else math.inf
        new = x + step
        if not low <= new <= high or abs(step) > 0.5 * last:
            new = 0.5 * (low + high)
            step = new - x
        last = abs(step)
        if new == x:
            break
        x = new
    return x


@njit(error_model="numpy")
def polynomial_values(angle, period, breakpoints, coefficients, order, out):
    """Derivative of ``order`` 0, 1 or 2 of a periodic piecewise polynomial at each angle (k,), into ``out`` (k,)."""
    count, degree = coefficients.shape[0], coefficients.shape[1] - 1
    first = breakpoints[0]
    for i in range(angle.size):
        x = angle[i] - period * math.floor((angle[i] - first) / period)
        low, high = 0, count
        while high - low > 1:
            middle = (low + high) // 2
            if breakpoints[middle] <= x:
                low = middle
            else:
                high = middle
        width = breakpoints[low + 1] - breakpoints[low]
        u = (x - breakpoints[low]) / width
        total = 0.0
        if order == 0:
            for k in range(degree, -1, -1):
                total = total * u + coefficients[low, k]
        elif order == 1:
            for k in range(degree, 0, -1):
                total = total * u + k * coefficients[low, k]
            total /= width
        else:
            for k in range(degree, 1, -1):
                total = total * u + k * (k - 1) * coefficients[low, k]
            total /= width * width
        out[i] = total
