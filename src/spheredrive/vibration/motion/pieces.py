"""A stretch of motion between two corners, exactly: polynomials beside decaying or ringing exponentials (compiled).

Every state obeys w′ = λ w + Σᵢ bᵢ ḣᵢ(t), or w′ = λ w + w_before + … where it is the second of a linked pair, and ḣ is a
polynomial between corners. Time runs as v = t/T from 0 to 1 over the stretch. Two exact forms serve all λ:

* |λ T| ≤ SLOW: the power series in v, whose terms fall faster than SLOWᵏ/k!;
* |λ T| ≥ ``fast_limit``: the polynomial that solves the equation, plus (w − that polynomial at 0) e^{λ t}. Its recursion
  divides by λ T, so that nothing is lost however stiff the state is.

A stretch with a state between the two is halved (see ``parts``).
"""

from __future__ import annotations

import cmath
import math

from spheredrive.compiled import njit

SLOW = 4.0
# Terms of the power series beyond the shape's degree: SLOW³³/33! is 8e-18.
TERMS = 32
BEYOND = 12
# An exponential below e to this power of its start is gone: 6e-19.
GONE = -42.0


@njit(error_model="numpy")
def fast_limit(degree):
    """Least |λ T| at which j!/(λT)^j stays near 1 or below for all j up to ``degree``."""
    return max(2.0 * SLOW, 0.5 * degree)


@njit(error_model="numpy")
def parts(lam, T, degree):
    """Into how many equal parts a stretch of T seconds is cut so that every state is slow or fast in each."""
    limit = fast_limit(degree)
    count = 1
    for _ in range(60):
        between = False
        for r in range(lam.size):
            z = abs(lam[r]) * T / count
            between = between or SLOW < z < limit
        if not between:
            break
        count *= 2
    return count


@njit(error_model="numpy")
def compose(a, u0, u1, u2, out):
    """Coefficients in v of Σ_k a_k u^k at u = u0 + u1 v + u2 v²; ``out`` has room for all and is zero beyond."""
    out[:] = 0.0
    out[0] = a[a.size - 1]
    degree, step = 0, 2 if u2 != 0.0 else 1
    for k in range(a.size - 2, -1, -1):
        degree += step
        for j in range(degree, 1, -1):
            out[j] = u0 * out[j] + u1 * out[j - 1] + u2 * out[j - 2]
        out[1] = u0 * out[1] + u1 * out[0]
        out[0] = u0 * out[0] + a[k]


@njit(error_model="numpy")
def difference(lam_a, lam_b, t):
    """(e^{λ_a t} − e^{λ_b t})/(λ_a − λ_b), also where the two are equal: what a linked state keeps of the one before it."""
    half = 0.5 * (lam_a - lam_b) * t
    if abs(half) > 0.5:
        return (cmath.exp(lam_a * t) - cmath.exp(lam_b * t)) / (lam_a - lam_b)
    # sinh(half)/half by its series: the quotient has no digits left where the two are close.
    square, term, total = half * half, 1.0 + 0j, 1.0 + 0j
    for k in range(1, 9):
        term = term * square / ((2 * k) * (2 * k + 1))
        total += term
    return t * cmath.exp(0.5 * (lam_a + lam_b) * t) * total


@njit(error_model="numpy")
def _size(z):
    return abs(z.real) + abs(z.imag)


@njit(error_model="numpy")
def expand(system, h, first, last, T, w, x, Y, amplitude):
    """The outputs over a stretch of T s: Y (outputs, terms) their polynomials in v, ``amplitude`` (states) of e^{λ t} too.

    ``h`` (inputs, terms) are the shapes' polynomials in v, of which those from ``first`` to ``last`` act; ``w`` is the state at
    the start and is left as the state at the end; ``x`` (2, terms) is room. Y may have no rows.
    """
    lam, link, b, real, imag, D0, D1, D2 = system
    terms, rows = h.shape[1], Y.shape[0]
    Y[:] = 0.0
    degree = 0
    for i in range(first, last):
        for k in range(terms - 1, degree, -1):
            if h[i, k] != 0.0:
                degree = k
                break
    before, used_before = 0j, 0
    for r in range(lam.size):
        p, other = x[r % 2], x[1 - r % 2]
        linked = link[r] == 1
        # Both states of a pair take the same form, the first one's.
        z = lam[r] * T
        size = abs(lam[r - 1]) * T if linked else abs(z)
        used = max(degree, used_before) if linked else degree
        p[:] = 0j
        for i in range(first, last):
            for k in range(degree):
                p[k] += b[r, i] * ((k + 1) * h[i, k + 1])
        if linked:
            for k in range(used):
                p[k] += T * other[k]
        start = w[r]
        value, total = start, start
        if size <= SLOW:
            k = 0
            # Beyond the shape's degree terms fall by |λT|/k each.
            while k < terms - 1 and (k < used or _size(value) > 1e-19 * _size(total)):
                value, p[k] = (z * value + p[k]) / (k + 1), value
                total += value
                k += 1
            p[k] = value
            used = k + 1
            amplitude[r] = 0j
            w[r] = total
        else:
            inverse = 1.0 / z
            value, total = 0j, 0j
            for k in range(used - 1, -1, -1):
                value = ((k + 1) * value - p[k]) * inverse
                p[k] = value
                total += value
            amplitude[r] = start - value
            w[r] = total + amplitude[r] * cmath.exp(z)
            if linked:
                w[r] += before * difference(lam[r - 1], lam[r], T)
        before, used_before = amplitude[r], used
        for j in range(rows):
            a, c = real[r, j], imag[r, j]
            for k in range(used):
                Y[j, k] += a * p[k].real - c * p[k].imag
    _add_direct(D0, D1, D2, h, first, last, T, Y)


@njit(error_model="numpy")
def _add_direct(D0, D1, D2, h, first, last, T, Y):
    """The outputs' own shares of h, ḣ and ḧ."""
    terms, rows = h.shape[1], Y.shape[0]
    f1, f2 = 1.0 / T, 1.0 / (T * T)
    for i in range(first, last):
        for k in range(terms):
            value = h[i, k]
            slope = f1 * (k + 1) * h[i, k + 1] if k + 1 < terms else 0.0
            bend = f2 * (k + 1) * (k + 2) * h[i, k + 2] if k + 2 < terms else 0.0
            if value == 0.0 and slope == 0.0 and bend == 0.0:
                continue
            for j in range(rows):
                Y[j, k] += D0[i, j] * value + D1[i, j] * slope + D2[i, j] * bend


@njit(error_model="numpy")
def used_terms(Y):
    """How many leading coefficients are needed: those left out are below 1e-17 of the largest of their row."""
    used = 1
    for j in range(Y.shape[0]):
        largest = 0.0
        for k in range(Y.shape[1]):
            largest = max(largest, abs(Y[j, k]))
        for k in range(Y.shape[1] - 1, used - 1, -1):
            if abs(Y[j, k]) > 1e-17 * largest:
                used = k + 1
                break
    return used


@njit(error_model="numpy")
def evaluate(system, Y, terms, amplitude, v, count, T, wave, low, high, out):
    """Add the outputs ``low`` to before ``high`` at the first ``count`` of ``v``, which rise, to ``out`` (y, places).

    ``wave`` (2, places) is room.
    """
    lam, link, real, imag = system.lam, system.link, system.real, system.imag
    total = wave[0]
    for j in range(low, high):
        if count == 1:
            one = Y[j, terms - 1]
            for k in range(terms - 2, -1, -1):
                one = one * v[0] + Y[j, k]
            out[j, 0] += one
            continue
        # Places go innermost, so that the compiler uses vector instructions.
        for s in range(count):
            total[s] = Y[j, terms - 1]
        for k in range(terms - 2, -1, -1):
            y = Y[j, k]
            for s in range(count):
                total[s] = total[s] * v[s] + y
        for s in range(count):
            out[j, s] += total[s]
    for r in range(lam.size):
        leads = link[r] == 1 and amplitude[r - 1] != 0j
        if (amplitude[r] == 0j and not leads) or lam[r].real * v[0] * T < GONE:
            continue
        alive = 0
        while alive < count and lam[r].real * v[alive] * T >= GONE:
            t = v[alive] * T
            s = alive
            alive += 1
            if lam[r].imag == 0.0 and not leads:
                # The amplitude of a real pole may be complex where two such poles share a plane of vectors.
                decay = math.exp(lam[r].real * t)
                wave[0, s], wave[1, s] = amplitude[r].real * decay, amplitude[r].imag * decay
                continue
            a = amplitude[r] * cmath.exp(lam[r] * t)
            if leads:
                a += amplitude[r - 1] * difference(lam[r - 1], lam[r], t)
            wave[0, s], wave[1, s] = a.real, a.imag
        for j in range(low, high):
            p, q = real[r, j], imag[r, j]
            for s in range(alive):
                out[j, s] += p * wave[0, s] - q * wave[1, s]


@njit(error_model="numpy")
def expm1(z):
    """e^z − 1 without loss near zero."""
    a, b = z.real, z.imag
    s = math.sin(0.5 * b)
    return complex(math.expm1(a) * math.cos(b) - 2.0 * s * s, math.exp(a) * math.sin(b))
