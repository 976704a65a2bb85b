"""Compiled: a compliant run from its start to its end, in steps that end where inputs and outlines have corners."""

from __future__ import annotations

import math

from spheredrive.compiled import inlined, kernel
from spheredrive.dynamics.compliant.energy import energies
from spheredrive.dynamics.compliant.instant import into, rates, vector
from spheredrive.dynamics.compliant.layout import (
    ANGLE,
    CENTRE,
    DEFLECTION,
    DISTANCE,
    FIRST_OUTLINE,
    FIRST_PIECE,
    FIRST_ROLLER,
    KIND,
    OUTLINE_COUNT,
    PERIOD,
    PIECE_BEGIN,
    PIECE_COUNT,
    PIECE_WIDTH,
    PITCH,
    POWERS,
    RING,
    ROLLER_COUNT,
    SPEED_OF_WHEEL,
    STAGE_WORK,
    STATION_STATES,
    STATION_WHEEL,
    STRETCH_BEGIN,
    STRETCH_END,
    WHEEL_STATES,
    WHEELS,
)
from spheredrive.dynamics.compliant.station import (
    COMING,
    DERIVATIVES,
    LEAVING,
    ROLLER_STATION,
    SLIP_POWER,
    STORED,
    TO_EVENT,
    TOUCH_SIZE,
    TOUCHES,
)
from spheredrive.simulation.compliant.step import between, normalise, trial

DONE, RUNNING, EVENTS_FULL, NOT_FINITE, STUCK, FALLEN = range(6)
# Entries of a run's clock: time, next step, piece of the inputs, whether the last try was refused.
TIME, STEP, PIECE, REFUSED = range(4)
# Entries of a run's counters.
SAMPLES_DONE, ACCEPTED, REJECTED, EVENTS = range(4)
# Kinds of event.
LIFTED, TOUCHED = 0, 1
# A wheel passes this share of a roller's pitch in a step at most, so that no contact is stepped over.
PITCH_SHARE = 0.2
# Steps shorter than this, in s, are not made to meet a corner of an outline or an event.
SHORTEST_LANDING = 1e-9
# An event is known well enough within this time, s.
EVENT_TIME = 1e-13
# A corner is met within this angle, rad; corners and events in so many tries.
LANDED, LANDINGS = 1e-11, 12


@kernel
def ring_angle(o, s, y, n, stations, turns):
    """The place of a ring's outline that faces the sphere's centre, ϑ − ζ, brought into its period."""
    i = int(stations[s, STATION_WHEEL])
    here = into(stations, s, vector(y, CENTRE))
    at = WHEELS + WHEEL_STATES * n + STATION_STATES * s
    x = stations[s, DISTANCE] + here[0] - y[at + DEFLECTION]
    return y[WHEELS + WHEEL_STATES * i + ANGLE] - math.atan2(here[1], x) - turns[o]


@kernel
def stretch_ends(piece, pieces):
    """Begin and end of the smooth stretch that a piece belongs to."""
    first, last = int(pieces[piece, STRETCH_BEGIN]), int(pieces[piece, STRETCH_END])
    return pieces[first, PIECE_BEGIN], pieces[last, PIECE_BEGIN] + pieces[last, PIECE_WIDTH]


@kernel
def settle(y, n, stations, outlines, pieces, places, turns):
    """Bring every ring whose outline has passed a corner, or stands on one that it moves over, into its next stretch.

    Returns whether there was any.
    """
    moved = False
    for s in range(stations.shape[0]):
        first = int(stations[s, FIRST_OUTLINE])
        for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
            if places[o] < 0:
                continue
            period = outlines[o, PERIOD]
            speed = y[WHEELS + WHEEL_STATES * int(stations[s, STATION_WHEEL]) + SPEED_OF_WHEEL]
            begin_row = int(outlines[o, FIRST_PIECE])
            last_row = begin_row + int(outlines[o, PIECE_COUNT]) - 1
            # A corner that is nearer than the shortest step is passed at once.
            near = LANDED + 1.01 * SHORTEST_LANDING * abs(speed)
            for _ in range(1000):
                local = ring_angle(o, s, y, n, stations, turns)
                low, high = stretch_ends(places[o], pieces)
                if local > high + near or (local > high - near and speed > 0.0):
                    after = int(pieces[places[o], STRETCH_END]) + 1
                    if after > last_row:
                        after = begin_row
                        turns[o] += period
                    places[o] = after
                elif local < low - near or (local < low + near and speed < 0.0):
                    before = int(pieces[places[o], STRETCH_BEGIN]) - 1
                    if before < begin_row:
                        before = last_row
                        turns[o] -= period
                    places[o] = before
                else:
                    break
                moved = True
                if local - period > high or local + period < low:
                    # Far away, as at the start: whole turns at once.
                    turns[o] += period * math.floor((local - pieces[begin_row, PIECE_BEGIN]) / period)
    return moved


@kernel
def share_before_corner(y0, y1, n, stations, outlines, pieces, places, turns):
    """Share of a step after which the first ring comes to a corner; 1 where none does."""
    share = 1.0
    for s in range(stations.shape[0]):
        first = int(stations[s, FIRST_OUTLINE])
        for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
            if places[o] < 0:
                continue
            low, high = stretch_ends(places[o], pieces)
            begin, end = ring_angle(o, s, y0, n, stations, turns), ring_angle(o, s, y1, n, stations, turns)
            if end > high + LANDED:
                share = min(share, (high - begin) / (end - begin))
            elif end < low - LANDED:
                share = min(share, (low - begin) / (end - begin))
    return share


@kernel
def longest_step(y, n, stations, outlines, most):
    """A step in which no wheel passes more than a share of its rollers' pitch."""
    for s in range(stations.shape[0]):
        speed = abs(y[WHEELS + WHEEL_STATES * int(stations[s, STATION_WHEEL]) + SPEED_OF_WHEEL])
        first = int(stations[s, FIRST_OUTLINE])
        for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
            if outlines[o, KIND] != RING and speed * most > PITCH_SHARE * outlines[o, PITCH]:
                most = PITCH_SHARE * outlines[o, PITCH] / speed
    return most


@kernel
def finite(y):
    """Whether every entry is a number."""
    total = 0.0
    for i in range(y.size):
        total += y[i] * 0.0
    return total == 0.0


@kernel
def advance(
    body, wheels, stations, outlines, pieces, drive_kind, stage_kind, inputs, samples, method, stages, order, control,
    weights, y, clock, counters, works, places, turns, acting, touching,
    kept_states, kept_rates, kept_motors, kept_touches, kept_stored, kept_works, events, allowed,
    states, H, frame, sides, by_turn, pushes, to_own, from_own, own, own_sides, wrenches, touches, spins, Ks, Ds,
    powers, drives, pushing, limited, coming,
):  # fmt: skip
    """Take a run on by ``allowed`` steps, or to its end; returns its status.

    inputs        straight pieces of drive and stage, as ``simulation.inputs`` gives them
    samples       times at which the run is recorded, s
    method, stages, order   of the Rosenbrock method (``run.packed``)
    control       longest step, s; shortest step, s; how deep (m) a roller may stand in the sphere when it begins to act; how
                  far the ledger of a step may be off, as a share of what moves through it and in J
    weights       (2, state): 1/tolerance of each entry; whether it is a speed
    y, clock, counters, works, places, turns, acting, touching   where the run is: state, ``TIME`` …, ``SAMPLES_DONE`` …, works
                  so far, pieces of rings and their turns, rollers that act, whether stations press
    kept_…        what is recorded at each sample: state, its rate, motor torques, touches, elastic energy, works
    events        time, station and kind (``LIFTED``, ``TOUCHED``) where one ceases or begins to press
    states …      room to work in (``room.Room``), whatever stands there: nothing is allocated here, as a graphics card cannot
    """
    n, m, q, size = wheels.shape[0], stations.shape[0], outlines.shape[0], y.size
    turning = size - WHEELS - WHEEL_STATES * n - STATION_STATES * m
    f0, f1, y_new, y_mid, vectors, ks = states[0], states[1], states[2], states[3], states[4:10], states[10:]
    b, x, b_own, z = sides[0], sides[1], own_sides[0], own_sides[1]
    rollers, rollers_1, spare = spins[0, :turning], spins[1, :turning], spins[2, :turning]
    K, D, K_1, D_1 = Ks[0], Ds[0], Ks[1], Ds[1]
    drive, drive_slope, asked, motors = drives[0], drives[1], drives[2], drives[3]
    stage, stage_slope, pushed, power = pushing[0], pushing[1], pushing[2], powers[3, :POWERS]
    _roller_stations(stations, outlines, rollers)
    _roller_stations(stations, outlines, rollers_1)
    t, h, piece = clock[TIME], clock[STEP], int(clock[PIECE])
    sample, gamma, grown, energy = int(counters[SAMPLES_DONE]), method[0, 0], h, 0.0
    fresh, refused, to_event = True, clock[REFUSED] > 0.0, 0.0
    # Rollers that press or pull by less than this depth are left as they are, lest rounding takes them in and out.
    negligible = 0.01 * control[2]
    status = RUNNING
    while allowed > 0:
        row = inputs[piece]
        end = row[1]
        if settle(y, n, stations, outlines, pieces, places, turns):
            fresh = True
        if fresh:
            width = end - row[0]
            for i in range(n):
                drive_slope[i] = (row[2 + n + i] - row[2 + i]) / width
            for j in range(3):
                stage_slope[j] = (row[5 + 2 * n + j] - row[2 + 2 * n + j]) / width
        for i in range(n):
            drive[i] = row[2 + i] + (t - row[0]) * drive_slope[i]
        for j in range(3):
            stage[j] = row[2 + 2 * n + j] + (t - row[0]) * stage_slope[j]
        h = longest_step(y, n, stations, outlines, min(h, control[0]))
        last = t + h * 1.0001 >= end
        if last:
            h = end - t
        if fresh or (turning > 0 and refused):
            while True:
                _derived(
                    y, drive, drive_slope, stage, drive_kind, stage_kind, body, wheels, stations, outlines, pieces,
                    places, turns, acting, gamma * h, f0, power, motors, wrenches, touches, rollers, K, D,
                )  # fmt: skip
                to_event = _least_to_event(touches)
                if to_event >= -negligible:
                    break
                _change(touches, acting)
            _powers(power, touches, powers[0])
            kinetic, potential = energies(y, body, wheels, stations, outlines)
            energy = kinetic + potential + _stored(wrenches)
            if fresh and sample < samples.size and samples[sample] <= t + 1e-12 * (1.0 + t):
                _keep(sample, y, f0, motors, touches, wrenches, works, kept_states, kept_rates, kept_motors,
                      kept_touches, kept_stored, kept_works)  # fmt: skip
                sample += 1
            fresh = False
            if counters[EVENTS] + m > events.shape[0]:
                status = EVENTS_FULL
                break
            for s in range(m):
                now = presses(s, stations, acting)
                if now != (touching[s] > 0.0):
                    count = int(counters[EVENTS])
                    events[count, 0], events[count, 1], events[count, 2] = t, s, TOUCHED if now else LIFTED
                    counters[EVENTS] += 1
                    touching[s] = 1.0 if now else 0.0
        allowed -= 1
        # A step is cut where a ring comes to a corner: then ``whole`` keeps what it was.
        whole, tries = h, 0
        while True:
            tries += 1
            wrong = trial(
                y, f0, h, drive, drive_slope, stage, stage_slope, drive_kind, stage_kind,
                body, wheels, stations, outlines, pieces, places, turns, acting, method, stages, limited,
                rollers, K, D, vectors, ks, H, frame, pushes, by_turn, b, x, to_own, from_own, own, b_own, z, wrenches,
                touches, motors, power, spare, weights, y_new,
            )  # fmt: skip
            if not wrong <= 1.0 or tries == LANDINGS:
                break
            share = share_before_corner(y, y_new, n, stations, outlines, pieces, places, turns)
            if share == 1.0 or share * h <= SHORTEST_LANDING:
                break
            h *= share
            last = False
        counters[REJECTED] += tries - 1
        if not wrong <= 1.0:
            factor = 0.9 * wrong ** (-1.0 / order)
            refused = True
            counters[REJECTED] += 1
            h *= max(0.1, min(0.9, factor)) if wrong < 1e300 else 0.1
            clock[STEP], clock[REFUSED] = h, 1.0
            if h < control[1]:
                status = STUCK if finite(y) else NOT_FINITE
                break
            continue
        normalise(y_new)
        later = end if last else t + h
        for i in range(n):
            asked[i] = row[2 + i] + (later - row[0]) * drive_slope[i]
        for j in range(3):
            pushed[j] = row[2 + 2 * n + j] + (later - row[0]) * stage_slope[j]
        # The step after this one, as it will be begun.
        factor = 0.9 * wrong ** (-1.0 / order) if wrong > 0.0 else 5.0
        grown = h * min(1.0 if refused else 5.0, max(0.2, factor))
        if tries > 1:
            grown = max(grown, whole)
        grown = longest_step(y_new, n, stations, outlines, min(grown, control[0]))
        ahead = end - later if not last and later + grown * 1.0001 >= end else grown
        _derived(
            y_new, asked, drive_slope, pushed, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places,
            turns, acting, gamma * ahead, f1, power, motors, wrenches, touches, rollers_1, K_1, D_1,
        )  # fmt: skip
        # The part of the step that is kept: all, or as much as goes before a roller comes to press or ceases to.
        kept, event, y_end, at_end = 1.0, False, y_new, _least_to_event(touches)
        while True:
            _powers(power, touches, powers[2])
            kinetic, potential = energies(y_end, body, wheels, stations, outlines)
            energy_end = kinetic + potential + _stored(wrenches)
            if event:
                for o in range(q):
                    coming[o] = (acting[o] | int(touches[o, COMING])) & ~int(touches[o, LEAVING])
            _at(
                0.5 * kept, h, y, f0, y_new, f1, ks, method, stages, y_mid, drive, drive_slope, stage, stage_slope, drive_kind,
                stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting, vectors, power, motors, wrenches,
                touches, spare, K, D,
            )  # fmt: skip
            _powers(power, touches, powers[1])
            halfway = _least_to_event(touches)
            if event or (at_end >= -negligible and halfway >= -negligible):
                break
            event, y_end = True, vectors[5]
            early, before, late, behind = 0.5, halfway, 1.0, at_end
            if halfway < -negligible:
                early, before, late, behind = 0.0, to_event, 0.5, halfway
            kept = _event_share(
                early, before, late, behind, control[2], h, y, f0, y_new, f1, ks, method, stages, y_end, drive, drive_slope,
                stage, stage_slope, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting,
                vectors, power, motors, wrenches, touches, spare, K, D,
            )  # fmt: skip
            if kept < 1.0:
                last, later = False, t + kept * h
        off = abs(energy_end - energy - _gained(kept * h, powers)) / (control[3] * _moved(kept * h, powers) + control[4])
        if off > 1.0 and kept * h > SHORTEST_LANDING:
            # What the powers at begin, middle and end add up to is not what the energy changed by: look closer.
            refused = True
            counters[REJECTED] += 1
            h *= kept * max(0.2, min(0.8, off**-0.25))
            clock[STEP], clock[REFUSED] = h, 1.0
            continue
        shorter = h * max(0.5, 0.9 * off**-0.25) if off > 0.0 and not event and tries == 1 else grown
        # Rollers with inertia are eliminated with the length of the step to come.
        unlike = turning > 0 and shorter < grown
        grown = min(grown, shorter)
        if not (finite(y_new) and finite(f1)):
            status = NOT_FINITE
            break
        energy = energy_end
        counters[ACCEPTED] += 1
        refused = False
        while sample < samples.size and samples[sample] <= later:
            part = (samples[sample] - t) / h
            _at(
                part, h, y, f0, y_new, f1, ks, method, stages, y_mid, drive, drive_slope, stage, stage_slope, drive_kind,
                stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting, vectors, power, motors, wrenches,
                touches, spare, K, D,
            )  # fmt: skip
            _keep(sample, y_mid, vectors[2], motors, touches, wrenches, works, kept_states, kept_rates, kept_motors,
                  kept_touches, kept_stored, kept_works)  # fmt: skip
            sample += 1
        first_kept = int(counters[SAMPLES_DONE])
        for k in range(first_kept, sample):
            if samples[k] > t or t == 0.0:
                part = (samples[k] - t) / (kept * h)
                for p in range(POWERS + q):
                    kept_works[k, p] = works[p] + _worked(part, kept * h, powers, p)
        counters[SAMPLES_DONE] = sample
        for p in range(POWERS + q):
            works[p] += _worked(1.0, kept * h, powers, p)
            powers[0, p] = powers[2, p]
        for i in range(size):
            y[i], f0[i] = y_end[i], f1[i]
        K, K_1 = K_1, K
        D, D_1 = D_1, D
        rollers, rollers_1 = rollers_1, rollers
        fresh = event or tries > 1 or unlike
        if event:
            for o in range(q):
                acting[o] = coming[o]
        t, h, to_event = later, grown, at_end
        clock[TIME], clock[STEP], clock[REFUSED] = t, h, 0.0
        if last:
            piece += 1
            fresh = True
            clock[PIECE] = piece
            if piece >= inputs.shape[0]:
                status = DONE
                break
        if abs(y[CENTRE]) + abs(y[CENTRE + 1]) + abs(y[CENTRE + 2]) > body[0]:
            status = FALLEN
            break
    return status


@kernel
def _roller_stations(stations, outlines, rollers):
    for s in range(stations.shape[0]):
        first = int(stations[s, FIRST_OUTLINE])
        for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
            begin = int(outlines[o, FIRST_ROLLER])
            for k in range(begin, begin + int(outlines[o, ROLLER_COUNT])):
                rollers[k, ROLLER_STATION] = s


@kernel
def _derived(
    y, drive, drive_slope, stage, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting,
    gh, rate, power, motors, wrenches, touches, rollers, K, D,
):  # fmt: skip
    """``rates`` with derivatives."""
    rates(
        y, drive, drive_slope, stage, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places, turns,
        acting, DERIVATIVES, gh, rate, power, motors, wrenches, touches, rollers, K, D,
    )  # fmt: skip


@kernel
def _event_share(
    early, before, late, behind, landed, h, y, f0, y_new, f1, ks, method, stages, y_end,
    drive, drive_slope, stage, stage_slope, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places, turns,
    acting, vectors, power, motors, wrenches, touches, spare, K, D,
):  # fmt: skip
    """The share of a step at which TO_EVENT falls below zero, a little behind it; state and touches there are filled in.

    ``before`` is its value at the share ``early``, ``behind`` (below zero) at ``late``; by false position (Illinois), until it
    is within ``landed`` below zero. A step that ends so is never shorter than ``SHORTEST_LANDING``.
    """
    side, here = 0, -1.0
    for _ in range(LANDINGS):
        if behind >= -landed or (late - early) * h <= EVENT_TIME:
            break
        share = (before + 0.5 * landed) / (before - behind) if before < 1e200 else 0.5
        here = early + (late - early) * min(0.99, max(0.01, share))
        _at(
            here, h, y, f0, y_new, f1, ks, method, stages, y_end, drive, drive_slope, stage, stage_slope, drive_kind,
            stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting, vectors, power, motors, wrenches,
            touches, spare, K, D,
        )  # fmt: skip
        value = _least_to_event(touches)
        if value < 0.0:
            late, behind = here, value
            before *= 0.5 if side < 0 else 1.0
            side = -1
        else:
            early, before = here, value
            behind *= 0.5 if side > 0 else 1.0
            side = 1
    kept = max(late, min(1.0, SHORTEST_LANDING / h))
    if here != kept:
        _at(
            kept, h, y, f0, y_new, f1, ks, method, stages, y_end, drive, drive_slope, stage, stage_slope, drive_kind,
            stage_kind, body, wheels, stations, outlines, pieces, places, turns, acting, vectors, power, motors, wrenches,
            touches, spare, K, D,
        )  # fmt: skip
    return kept


@kernel
def _at(
    share, h, y, f0, y_new, f1, ks, method, stages, y_there, drive, drive_slope, stage, stage_slope, drive_kind, stage_kind,
    body, wheels, stations, outlines, pieces, places, turns, acting, vectors, power, motors, wrenches, touches, spare, K, D,
):  # fmt: skip
    """State at a ``share`` of a step into ``y_there``, its rate into the vectors' third row, and what acts there."""
    n = wheels.shape[0]
    asked, pushed = vectors[3, 0:n], vectors[4, 0:3]
    for i in range(n):
        asked[i] = drive[i] + share * h * drive_slope[i]
    for j in range(3):
        pushed[j] = stage[j] + share * h * stage_slope[j]
    between(share, h, y, f0, y_new, f1, ks, method, stages, n, stations.shape[0], y_there)
    rates(
        y_there, asked, drive_slope, pushed, drive_kind, stage_kind, body, wheels, stations, outlines, pieces, places, turns,
        acting, TOUCHES, 1.0, vectors[2], power, motors, wrenches, touches, spare, K, D,
    )  # fmt: skip


@kernel
def _powers(power, touches, out):
    for p in range(POWERS):
        out[p] = power[p]
    for o in range(touches.shape[0]):
        out[POWERS + o] = touches[o, SLIP_POWER]


@kernel
def presses(s, stations, acting):
    """Whether any roller of a station acts."""
    first, bits = int(stations[s, FIRST_OUTLINE]), 0
    for o in range(first, first + int(stations[s, OUTLINE_COUNT])):
        bits |= acting[o]
    return bits != 0


@kernel
def _least_to_event(touches):
    """Below zero where a roller has come to press or has ceased to."""
    least = 1e300
    for o in range(touches.shape[0]):
        least = min(least, touches[o, TO_EVENT])
    return least


@kernel
def _change(touches, acting):
    """Let those rollers act that press, and no others."""
    for o in range(touches.shape[0]):
        acting[o] = (acting[o] | int(touches[o, COMING])) & ~int(touches[o, LEAVING])


@kernel
def _stored(wrenches):
    """Elastic energy of all contacts."""
    total = 0.0
    for s in range(wrenches.shape[0]):
        total += wrenches[s, STORED]
    return total


@kernel
def _gained(h, powers):
    """Works less losses over a step of length h."""
    total = 0.0
    for p in range(POWERS):
        total += _worked(1.0, h, powers, p) * (1.0 if p <= STAGE_WORK else -1.0)
    return total


@kernel
def _moved(h, powers):
    """Energy that moves in a step of length h, whatever its sign."""
    total = 0.0
    for p in range(POWERS):
        total += h / 6.0 * (abs(powers[0, p]) + 4.0 * abs(powers[1, p]) + abs(powers[2, p]))
    return total


@inlined
def _worked(x, h, powers, p):
    """∫ of the parabola through the powers at begin, middle and end, up to the share x of the step."""
    a, b, c = powers[0, p], powers[1, p], powers[2, p]
    return h * x * (a + x * (0.5 * (4.0 * b - 3.0 * a - c) + x * (2.0 / 3.0) * (a - 2.0 * b + c)))


@kernel
def _keep(
    k, y, rate, motors, touches, wrenches, works, kept_states, kept_rates, kept_motors, kept_touches, kept_stored, kept_works
):  # fmt: skip
    """Record sample ``k``."""
    for i in range(y.size):
        kept_states[k, i], kept_rates[k, i] = y[i], rate[i]
    for i in range(motors.size):
        kept_motors[k, i] = motors[i]
    for o in range(touches.shape[0]):
        for j in range(TOUCH_SIZE):
            kept_touches[k, o, j] = touches[o, j]
    kept_stored[k] = _stored(wrenches)
    for p in range(works.size):
        kept_works[k, p] = works[p]
