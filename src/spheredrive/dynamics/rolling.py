"""The equations of motion of the rolling model (model.md section 5a), compiled.

``solve`` works out everything that happens at an instant, forces included. ``driven`` is the short way to the rates of wheels
driven by torques without resistances, which most steps need; both put together the same few functions, so that no formula
is written twice. Vectors and matrices are the tuples of ``dynamics.algebra``.
"""

from __future__ import annotations

import math

import numpy as np

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.algebra import add, add_dyad, cross, dot, inverse, quaternion_rate, rotation_rows, times

# What the wheels are given.
TORQUE, WHEEL_SPEED, SPHERE_VELOCITY = 0, 1, 2
# What the stage is given.
STILL, FORCE, ACCELERATION = 0, 1, 2

# A wheel's contact state beside 0 and 1: it rests on the boundary between its races.
RESTING = 2

# Places in the state vector: Ω, quaternion, velocity and position of the stage, the ledger (work of the motors, work on the
# stage, heat of the resistances), and one angle a wheel.
OMEGA, ORIENTATION, VELOCITY, POSITION, MOTOR_WORK, STAGE_WORK, HEAT, ANGLE = np.array((0, 3, 7, 10, 13, 14, 15, 16))
# Columns of ``contacts`` (n, 3, 10), from the row at 0 on; of ``wheels`` (n, 8), from ŵ at 0 on; places in ``body`` (19,),
# from the inertia's six at 0 on. What they hold is said in ``dynamics.parameters``.
# Places that functions are handed are NumPy's numbers: of Python's, Numba would compile the functions for each anew.
NORMAL, GRIP, LEVER = 3, 6, 9
WHEEL_INERTIA, HALF_PITCH, PHASE, ROLLING_ARM, SPIN_ARM = 3, 4, 5, 6, 7
OFFSET, SPHERE_MASS, MOVING_MASS, WEIGHT, CLOSURE, FRICTION, SMOOTHING = np.array((6, 9, 10, 11, 14, 17, 18))

# What ``enter_state`` leaves in its room: G, whether it is known, and the wheels' share of the inertia.
KNOWN, SHARE, ROOM = np.array((6, 7, 13))


@kernel
def _row(contacts, w, k):
    return contacts[w, k, 0], contacts[w, k, 1], contacts[w, k, 2]


@kernel
def _normal(contacts, w, k):
    return contacts[w, k, NORMAL], contacts[w, k, NORMAL + 1], contacts[w, k, NORMAL + 2]


@kernel
def _grip(contacts, w, k):
    return contacts[w, k, GRIP], contacts[w, k, GRIP + 1], contacts[w, k, GRIP + 2]


@inlined
def _at(y, i):
    return y[i], y[i + 1], y[i + 2]


@inlined
def _orientation(y):
    return y[ORIENTATION], y[ORIENTATION + 1], y[ORIENTATION + 2], y[ORIENTATION + 3]


@inlined
def _six(array, i):
    return array[i], array[i + 1], array[i + 2], array[i + 3], array[i + 4], array[i + 5]


@inlined
def turned(own, offset, q):
    """Inertia tensor and centre of mass in the inertial frame: A I_b Aᵀ and A ρ_b, A the rotation of the quaternion ``q``.

    Stages of a step leave the unit sphere by the step's error: the rotation is taken of the quaternion's direction.
    """
    r0, r1, r2 = rotation_rows(q)
    k0, k1, k2 = times(own, r0), times(own, r1), times(own, r2)
    inertia = (dot(r0, k0), dot(r0, k1), dot(r0, k2), dot(r1, k1), dot(r1, k2), dot(r2, k2))
    return inertia, (dot(r0, offset), dot(r1, offset), dot(r2, offset))


@kernel
def turned_body(body, y):
    """``turned`` for the body's own inertia and offset and the orientation in ``y``."""
    return turned(_six(body, 0), _at(body, OFFSET), _orientation(y))


@inlined
def felt_inertia(I, W, rho, mass, share):
    """I_s + J⁻ᵀ I_w J⁻¹ (``W``), less what a freely moving stage takes off an offset mass: M_s s (ρ² E − ρ ρᵀ), s = M_s/M."""
    taken = mass * share
    square = taken * dot(rho, rho)
    M = (I[0] + W[0] - square, I[1] + W[1], I[2] + W[2], I[3] + W[3] - square, I[4] + W[4], I[5] + W[5] - square)
    return add_dyad(M, taken, rho)


@inlined
def known_moment(I, rho, Omega, mass, gravity, a, share):
    """Moments that know nothing of the unknowns, −Ω × I Ω + ρ × M_s (g − p̈); p̈ without Ω̇'s own part in it; Ω × (Ω × ρ).

    ``a`` is the stage's acceleration but for what the offset mass does to it, which ``share`` = M_s/M brings in.
    """
    centripetal = cross(Omega, cross(Omega, rho))
    a = add(a, -share, centripetal)
    moment = add(cross(times(I, Omega), Omega), mass, cross(rho, add(gravity, -1.0, a)))
    return moment, a, centripetal


@inlined
def stage_power(mass, moving, p_rate, swing, centripetal, v):
    """P·v of the force on the stage: P = M p̈ + M_s (Ω̇ × ρ + Ω × (Ω × ρ)), given or what its prescribed motion takes."""
    force = (moving * p_rate[0], moving * p_rate[1], moving * p_rate[2])
    return dot(add(force, mass, add(swing, 1.0, centripetal)), v)


@inlined
def driven(own, offset, W, mass, moving, share, gravity, a, moment, Omega, q, v):
    """Ω̇, p̈, power of the motors and on the stage for wheels driven by torques, without resistances; and whether there is Ω̇.

        (I_s + J⁻ᵀ I_w J⁻¹) Ω̇ = J⁻ᵀ T − Ω × I_s Ω + ρ × M_s (g − p̈)

    The wheels take part by ``W`` = J⁻ᵀ I_w J⁻¹ and ``moment`` = J⁻ᵀ T alone, whatever their number.
    """
    I, rho = turned(own, offset, q)
    known, a, centripetal = known_moment(I, rho, Omega, mass, gravity, a, share)
    M_inverse, fine = inverse(felt_inertia(I, W, rho, mass, share))
    x = times(M_inverse, add(known, 1.0, moment))
    swing = cross(x, rho)
    p_rate = add(a, -share, swing)
    return x, p_rate, dot(moment, Omega), stage_power(mass, moving, p_rate, swing, centripetal, v), fine


@inlined
def stage_share(body, stage_kind):
    """M_s/M of a stage that moves freely under its force, 0 of any other."""
    return body[SPHERE_MASS] / body[MOVING_MASS] if stage_kind == FORCE else 0.0


@inlined
def stage_push(body, stage_kind, stage):
    """The stage's acceleration but for the offset mass: P/M of a force, itself where it is prescribed."""
    factor = 1.0 / body[MOVING_MASS] if stage_kind == FORCE else (1.0 if stage_kind == ACCELERATION else 0.0)
    return factor * stage[0], factor * stage[1], factor * stage[2]


@kernel
def blend_rows(contacts, state, Omega):
    """Rows of wheels that rest between their races: λ h₀ + (1 − λ) h₁ with no speed, so that they neither turn nor work.

    While a sphere turns about a wheel's contact, one race drives the wheel up to their boundary and the other back down: it
    stays there, touched by both in turns without end (the sliding mode of Filippov). The mean row is the one that keeps it
    still.
    """
    for w in range(state.size):
        if state[w] == RESTING:
            s0, s1 = dot(_row(contacts, w, 0), Omega), dot(_row(contacts, w, 1), Omega)
            share = s1 / (s1 - s0) if s1 != s0 else 0.5
            for i in range(3):
                contacts[w, RESTING, i] = share * contacts[w, 0, i] + (1.0 - share) * contacts[w, 1, i]


@kernel
def enter_state(contacts, wheels, state, room):
    """Work out what depends on the contact state alone; to be called whenever ``state`` changes.

    It is G of N = R̂ᵀ G b, the inverse of Σ R̂ R̂ᵀ: N balances the force b, with least ΣN²/K where n > 3 (equal K). Contacts
    that lie in a plane leave it undetermined, which ``room[KNOWN]`` tells. And it is J⁻ᵀ I_w J⁻¹, the inertia of the wheels as
    the sphere feels it; a wheel that rests between its races has none.
    """
    S = W = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for w in range(state.size):
        S = add_dyad(S, 1.0, _normal(contacts, w, state[w]))
        if state[w] != RESTING:
            W = add_dyad(W, wheels[w, WHEEL_INERTIA], _row(contacts, w, state[w]))
    G, known = inverse(S)
    for i in range(6):
        room[i], room[SHARE + i] = G[i], W[i]
    room[KNOWN] = 1.0 if known else 0.0


@kernel
def solve(body, contacts, wheels, drive_kind, stage_kind, state, drive, drive_slope, stage, y, out, room, forces):
    """Everything at an instant: sphere and stage accelerations, motor torques, normal forces, friction.

    ``drive`` (n or 3) holds torques (N m), wheel speeds or the sphere's angular velocity (rad/s), ``drive_slope`` their
    rates; ``stage`` (3) a force (N) or an acceleration (m/s²). ``out`` (3 n + 6) receives torque, normal force and friction
    of the wheels, Ω̇ and p̈. ``y`` is read, and its Ω set where the drive prescribes it. Returns False where the equations have
    no solution. Resistances depend on the normal forces and these on them: both are found by iteration. Without ``forces``
    normal forces and friction are left out where the motion does not depend on them.
    """
    n = state.size
    I, rho = turned_body(body, y)
    x = (0.0, 0.0, 0.0)
    if drive_kind == SPHERE_VELOCITY:
        for i in range(3):
            y[OMEGA + i] = drive[i]
        x = (drive_slope[0], drive_slope[1], drive_slope[2])
    elif drive_kind == WHEEL_SPEED:
        Omega, fine = sphere_from_wheels(contacts, state, drive)
        x, also = sphere_from_wheels(contacts, state, drive_slope)
        if not (fine and also):
            return False
        y[OMEGA], y[OMEGA + 1], y[OMEGA + 2] = Omega
    Omega = _at(y, OMEGA)
    blend_rows(contacts, state, Omega)
    share, mass, gravity = stage_share(body, stage_kind), body[SPHERE_MASS], _at(body, WEIGHT)
    M = felt_inertia(I, _six(room, SHARE), rho, mass, share)
    M_inverse, fine = inverse(M)
    if not fine:
        return False
    known, a, centripetal = known_moment(I, rho, Omega, mass, gravity, stage_push(body, stage_kind, stage), share)
    resisting = resists(body, wheels)
    for w in range(n):
        out[n + w] = 0.0
    for _ in range(60):
        b = known
        if resisting:
            for w in range(n):
                b = add(b, 1.0, _resisting_moment(body, contacts, wheels, w, state[w], Omega, out[n + w]))
        if drive_kind == TORQUE:
            for w in range(n):
                out[w] = drive[w]
                b = add(b, drive[w], _row(contacts, w, state[w]))
            x = times(M_inverse, b)
        elif not _needed_torque(contacts, state, add(times(M, x), -1.0, b), out):
            return False
        # The offset mass's own reaction on a free stage.
        swing = cross(x, rho)
        p_rate = add(a, -share, swing)
        if not (forces or resisting):
            _write(x, p_rate, out, n)
            return True
        # What the contacts have to carry besides friction: closure and weight less the sphere's own acceleration.
        force = add(add(gravity, -1.0, p_rate), -1.0, add(swing, 1.0, centripetal))
        force = add(_at(body, CLOSURE), mass, force)
        change, largest = _contact_forces(body, contacts, wheels, state, Omega, x, force, out, room, resisting)
        if not resisting or change <= 1e-14 * largest:
            _write(x, p_rate, out, n)
            return True
    return False


@kernel
def _contact_forces(body, contacts, wheels, state, Omega, x, force, out, room, resisting):
    """Friction from each wheel's own equation, then the normal forces that balance ``force`` and the friction, into ``out``.

    Returns by how much a normal force changed at most, and the largest of them.
    """
    n = state.size
    for w in range(n):
        k = state[w]
        gained = 0.0 if k == RESTING else wheels[w, WHEEL_INERTIA] * dot(_row(contacts, w, k), x)
        drag = _wheel_drag(body, contacts, wheels, w, k, Omega, out[n + w]) if resisting else 0.0
        friction = (out[w] + drag - gained) / contacts[w, k, LEVER]
        out[2 * n + w] = friction
        force = add(force, friction, _grip(contacts, w, k))
    change, largest = 0.0, 0.0
    if room[KNOWN] == 1.0:
        carried = times((room[0], room[1], room[2], room[3], room[4], room[5]), force)
        for w in range(n):
            normal = dot(_normal(contacts, w, state[w]), carried)
            change = max(change, abs(normal - out[n + w]))
            largest = max(largest, abs(normal))
            out[n + w] = normal
    return change, largest


@kernel
def _write(x, p_rate, out, n):
    for i in range(3):
        out[3 * n + i] = x[i]
        out[3 * n + 3 + i] = p_rate[i]


@kernel
def resists(body, wheels):
    found = False
    for w in range(wheels.shape[0]):
        found = found or wheels[w, ROLLING_ARM] != 0.0 or wheels[w, SPIN_ARM] * body[FRICTION] != 0.0
    return found


@kernel
def sphere_from_wheels(contacts, state, wheel_speed):
    """Ω of least slip for wheel speeds, and whether there is one; the rows r sin α · R/r a weigh wheels by physical slip."""
    S, b = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for w in range(state.size):
        h = _row(contacts, w, state[w])
        weight = contacts[w, state[w], LEVER] ** 2
        S = add_dyad(S, weight, h)
        b = add(b, weight * wheel_speed[w], h)
    S_inverse, fine = inverse(S)
    return times(S_inverse, b), fine


@kernel
def _needed_torque(contacts, state, need, out):
    """Motor torques of least square sum whose moment Σ hᵢ Tᵢ on the sphere is ``need``, into ``out``.

    False where the wheels cannot give every moment, as fewer than three of them cannot.
    """
    S = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for w in range(state.size):
        S = add_dyad(S, 1.0, _row(contacts, w, state[w]))
    S_inverse, fine = inverse(S)
    k = times(S_inverse, need)
    for w in range(state.size):
        out[w] = dot(_row(contacts, w, state[w]), k)
    return fine


@kernel
def _resistance(body, contacts, wheels, w, k, Omega):
    """Moment of resistance on the sphere for a normal force of one newton, with its sign turned, and Ω − ω ŵ.

    m = l_r w_⊥/√(w_⊥² + ε²) + μ l_s R̂ w_n/√(w_n² + ε²), w = Ω − ω ŵ; the contact's own way of turning, not the wheel's, where
    a race stands beside the middle. Source: model.md section 4.
    """
    axis = (wheels[w, 0], wheels[w, 1], wheels[w, 2])
    R_hat = _normal(contacts, w, k)
    speed = 0.0 if k == RESTING else dot(_row(contacts, w, k), Omega)
    relative = add(Omega, -speed, axis)
    spin = dot(relative, R_hat)
    rolling = add(relative, -spin, R_hat)
    roll = wheels[w, ROLLING_ARM] / math.sqrt(dot(rolling, rolling) + body[SMOOTHING] ** 2)
    twist = body[FRICTION] * wheels[w, SPIN_ARM] * spin / math.sqrt(spin * spin + body[SMOOTHING] ** 2)
    return add((roll * rolling[0], roll * rolling[1], roll * rolling[2]), twist, R_hat), relative


@kernel
def _resisting_moment(body, contacts, wheels, w, k, Omega, normal):
    """−N m on the sphere and, reflected through the wheel, + h N m·ŵ."""
    m, _ = _resistance(body, contacts, wheels, w, k, Omega)
    pressed = max(normal, 0.0)
    drag = pressed * (m[0] * wheels[w, 0] + m[1] * wheels[w, 1] + m[2] * wheels[w, 2])
    h = _row(contacts, w, k)
    return drag * h[0] - pressed * m[0], drag * h[1] - pressed * m[1], drag * h[2] - pressed * m[2]


@kernel
def _wheel_drag(body, contacts, wheels, w, k, Omega, normal):
    """Moment N m·ŵ that the contact puts on the wheel about its axis."""
    m, _ = _resistance(body, contacts, wheels, w, k, Omega)
    return max(normal, 0.0) * (m[0] * wheels[w, 0] + m[1] * wheels[w, 1] + m[2] * wheels[w, 2])


@kernel
def heat_rate(body, contacts, wheels, state, y, out):
    """Power that the resistances take: Σ N m · (Ω − ω ŵ), never negative."""
    total, n = 0.0, state.size
    if resists(body, wheels):
        for w in range(n):
            m, relative = _resistance(body, contacts, wheels, w, state[w], _at(y, OMEGA))
            total += max(out[n + w], 0.0) * dot(m, relative)
    return total


@kernel
def rates(body, contacts, wheels, drive_kind, stage_kind, state, drive, drive_slope, stage, y, dy, out, room):
    """Time derivatives of the state vector ``y`` up to its ledger into ``dy``, and of ∫Ω dt in the three places behind it.

    Only Ω, quaternion and velocity are read of ``y``, and its Ω is set where the drive prescribes it. False where the
    equations have no solution.
    """
    n = state.size
    if not solve(body, contacts, wheels, drive_kind, stage_kind, state, drive, drive_slope, stage, y, out, room, False):
        return False
    Omega, v = _at(y, OMEGA), _at(y, VELOCITY)
    x, a = _at(out, 3 * n), _at(out, 3 * n + 3)
    work = 0.0
    for w in range(n):
        if state[w] != RESTING:
            work += out[w] * dot(_row(contacts, w, state[w]), Omega)
    _, rho = turned_body(body, y)
    centripetal = cross(Omega, cross(Omega, rho))
    dy[MOTOR_WORK] = work
    dy[STAGE_WORK] = stage_power(body[SPHERE_MASS], body[MOVING_MASS], a, cross(x, rho), centripetal, v)
    dy[HEAT] = heat_rate(body, contacts, wheels, state, y, out)
    turning = quaternion_rate(Omega, _orientation(y))
    for i in range(4):
        dy[ORIENTATION + i] = turning[i]
    for i in range(3):
        dy[OMEGA + i], dy[VELOCITY + i], dy[POSITION + i], dy[ANGLE + i] = x[i], a[i], v[i], Omega[i]
    return True


@kernel
def energy(body, contacts, wheels, state, y):
    """Kinetic energy of sphere, wheels and stage, and the potential −M_s g·ρ of the offset mass, J.

    ½ M v² + M_s v·(Ω × ρ) + ½ Ω·I Ω + ½ Σ I_w ω²; the weight's work on the stage's own motion is the gantry's.
    """
    I, rho = turned_body(body, y)
    Omega, v = _at(y, OMEGA), _at(y, VELOCITY)
    kinetic = (
        0.5 * body[MOVING_MASS] * dot(v, v) + body[SPHERE_MASS] * dot(v, cross(Omega, rho)) + 0.5 * dot(Omega, times(I, Omega))
    )
    for w in range(state.size):
        if state[w] != RESTING:
            kinetic += 0.5 * wheels[w, WHEEL_INERTIA] * dot(_row(contacts, w, state[w]), Omega) ** 2
    return kinetic, -body[SPHERE_MASS] * dot(_at(body, WEIGHT), rho)


@kernel
def energies(body, contacts, wheels, states, y, kinetic, potential):
    """``energy`` of the samples ``states`` (k, n), ``y`` (k, size) into ``kinetic`` and ``potential`` (k,)."""
    for i in range(y.shape[0]):
        kinetic[i], potential[i] = energy(body, contacts, wheels, states[i], y[i])


@kernel
def impact(body, contacts, wheels, stage_kind, before, after, y, room):
    """Change of race with free wheels, from contact state ``before`` to ``after``: sets Ω (and v of a free stage) in ``y``.

        (I_s + J₂⁻ᵀ I_w J₂⁻¹) Ω⁺ = I_s Ω⁻ + J₂⁻ᵀ I_w ω⁻,   ω⁻ = J₁⁻¹ Ω⁻

    A free stage takes part: M Δv = −M_s ΔΩ × ρ. A wheel that comes to rest between its races gives its spin to the sphere
    through its mean row. ``room`` is that of ``after``. False where the equations have no solution.
    """
    I, rho = turned_body(body, y)
    Omega = _at(y, OMEGA)
    blend_rows(contacts, before, Omega)
    blend_rows(contacts, after, Omega)
    share = stage_share(body, stage_kind)
    M = felt_inertia(I, _six(room, SHARE), rho, body[SPHERE_MASS], share)
    # M (Ω⁺ − Ω⁻) = J₂⁻ᵀ I_w (ω⁻ − J₂⁻¹ Ω⁻): nothing happens to wheels whose row stays.
    b = (0.0, 0.0, 0.0)
    for w in range(after.size):
        if before[w] != RESTING or after[w] != RESTING:
            h1, h2 = _row(contacts, w, before[w]), _row(contacts, w, after[w])
            b = add(b, wheels[w, WHEEL_INERTIA] * (dot(h1, Omega) - dot(h2, Omega)), h2)
            if after[w] == RESTING:
                M = add_dyad(M, wheels[w, WHEEL_INERTIA], h2)
    M_inverse, fine = inverse(M)
    x = times(M_inverse, b)
    kick = cross(x, rho)
    for i in range(3):
        y[VELOCITY + i] -= share * kick[i]
        y[OMEGA + i] += x[i]
    return fine
