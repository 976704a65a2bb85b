"""The exact outline of a wheel: the rollers of its races in the order in which they hold the sphere, strip by strip."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from spheredrive.errors import DesignError
from spheredrive.shape import kernels
from spheredrive.shape.roller import Roller, roller

if TYPE_CHECKING:
    from spheredrive.wheels.base import Race, RollerWheel, Wheel

# Steps a roller pitch in which a wheel of several races, or of rollers of uneven form, is searched for takeovers.
SEARCH = 48
# Strips narrower than this share of the pitch are rounding of the angles of their ends.
NARROW = 1e-9


class Strip(NamedTuple):
    """An interval of the wheel's angle in which one roller holds the sphere on one part of it, side or end.

    start, end   the wheel's angle with its phase, rad
    rank         the roller's race, by its place in ``Envelope.races``
    centre       wheel angle (with phase) at which this roller's middle stands on the line of centres, rad
    region       kernels.BACK, SIDE or FRONT
    """

    start: float
    end: float
    rank: int
    centre: float
    region: int


@dataclass(frozen=True, eq=False)
class Envelope:
    """The upper envelope of all rollers over one pitch. Heights are D − R, D the distance between the centres.

    races    the races whose rollers take part
    rollers  the body of a roller of each race
    bodies   their flat descriptions for the kernels, (races, 8)
    strips   in rising order, one pitch in all
    centres  wheel angle with phase at which a roller's middle of each race stands on the line of centres, rad
    pitch    2π/N, rad
    nominal  D_nominal − R: the height at the top of a roller, m
    """

    races: tuple[Race, ...]
    rollers: tuple[Roller, ...]
    bodies: np.ndarray
    strips: tuple[Strip, ...]
    centres: tuple[float, ...]
    pitch: float
    nominal: float
    knots: np.ndarray
    table: np.ndarray

    def outline(self, strip: Strip, angle: np.ndarray) -> np.ndarray:
        """``kernels.outline`` of the roller that holds ``strip``, at wheel angles with phase (k,): (k, 7)."""
        out = np.empty((len(angle), 7))
        kernels.outline(angle - strip.centre, strip.region, self.bodies[strip.rank], self.knots, self.table, out)
        return out

    def strip_numbers(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Which strip each wheel angle (with phase) lies in, and the angle brought into the pitch of the strips."""
        first = self.strips[0].start
        folded = first + np.mod(angle - first, self.pitch)
        starts = [strip.start for strip in self.strips]
        return np.clip(np.searchsorted(starts, folded, side="right") - 1, 0, len(starts) - 1), folded


def nominal_height(race: Race, sphere_radius: float) -> float:
    """D_nominal − R of a race at ±o: (R + r_r) cos Δθ + r − r_r − R = r − (R + r_r)(1 − cos Δθ), m.

    Source: model.md section 1.
    """
    sine = math.sin(race.deflection(sphere_radius))
    # 1 − cos = sin²/(1 + cos), without the loss of digits for a large sphere.
    return race.radius - race.offset * sine / (1 + math.sqrt(1 - sine * sine))


def touching_races(wheel: Wheel, sphere_radius: float, number: int | None = None) -> tuple[Race, ...]:
    """The races of one contact: all that touch at R̂, or the one of that ``number`` alone."""
    races = wheel.races(sphere_radius)
    if number is None:
        return tuple(race for race in races if not race.antipodal)
    for race in races:
        if race.number == number:
            return (race,)
    raise DesignError(f"this wheel has no race {number!r}; its races are {[race.number for race in races]}")


def envelope(wheel: RollerWheel, sphere_radius: float, number: int | None = None, roller_profile=None) -> Envelope:
    """The exact outline of ``wheel`` against a sphere of ``sphere_radius`` (m), of all its races or of race ``number``.

        r_w(ϑ) = max over rollers and s of  p_x + √((R + ρ)² − p_y² − p_z²)  − R

    Raises ``DesignError`` for rollers that are not described, overlap, or let the sphere fall in between. Assumes rigid
    bodies and a wheel whose races all have N rollers. Source: model.md section 3.
    """
    races = touching_races(wheel, sphere_radius, number)
    rollers = tuple(roller(wheel, race, roller_profile) for race in races)
    pitch = 2 * math.pi / (wheel.rollers_per_race or 1)
    bodies = np.array([body.body(race.offset, sphere_radius) for body, race in zip(rollers, races, strict=True)])
    draft = Envelope(
        races,
        rollers,
        bodies,
        (),
        (),
        pitch,
        nominal_height(min(races, key=lambda race: abs(race.offset)), sphere_radius),
        np.array(rollers[0].knots),
        np.array(rollers[0].table),
    )
    centres = [_centre(wheel, race, body, draft, rank) for rank, (race, body) in enumerate(zip(races, rollers, strict=True))]
    turns = _turns(draft, centres)
    strips = tuple(strip for start, end, rank, centre in turns for strip in _cut(draft, start, end, rank, centre))
    whole = replace(draft, strips=strips, centres=tuple(centres))
    _refuse_fall(whole, sphere_radius)
    return whole


def _centre(wheel: RollerWheel, race: Race, body: Roller, draft: Envelope, rank: int) -> float:
    """Wheel angle (with phase) of a roller's middle: where the thesis has it.

    Races that take turns: in the middle of their half pitch [2.56]. Where the gap comes first: half a roller before the end of
    the pitch [3.8], so that the gap starts at 0. Else at 0 [4.6].
    """
    turns = len(wheel.alternation)
    if turns > 1:
        place = next(i for i, together in enumerate(wheel.alternation) if race.number in together)
        return (place + 0.5) * draft.pitch / turns
    if not wheel.gap_comes_first:
        return 0.0
    edge = 0.0
    if body.half_length:
        edge = abs(_passing(draft, rank, body.half_length))
    return draft.pitch - min(edge, draft.pitch / 2) if edge == edge else draft.pitch / 2


def _passing(draft: Envelope, rank: int, place: float) -> float:
    """Angle from a roller's middle at which contact passes ``place`` on its axis; NaN if not within a pitch."""
    body = draft.rollers[rank]
    if body.barrel_radius and body.square and draft.races[rank].offset == 0:
        return -math.atan2(place, body.axis_distance) * body.sine
    return kernels.passing_angle(place, _reach(draft, rank), draft.bodies[rank], draft.knots, draft.table)


def _reach(draft: Envelope, rank: int) -> float:
    """Angle from a roller's middle beyond which it holds no sphere: a pitch past its ends, below a right angle."""
    body = draft.rollers[rank]
    return min(draft.pitch + math.atan2(body.half_length * abs(body.sine), body.axis_distance), 1.5)


def _turns(draft: Envelope, centres: list[float]) -> list[tuple[float, float, int, float]]:
    """(start, end, rank, centre) of each roller's turn over one pitch."""
    if len(centres) == 1 and draft.rollers[0].symmetric and draft.races[0].offset == 0:
        row = np.empty(7)
        kernels.touch(draft.pitch / 2, kernels.DECIDE, draft.bodies[0], draft.knots, draft.table, row)
        # Each roller is its own mirror image, so neighbours change in the middle between them: unless long straight ones
        # still rise there, to hold the sphere with their ends out of turn.
        if row[kernels.SLOPE] < 0:
            return [(centres[0] - draft.pitch / 2, centres[0] + draft.pitch / 2, 0, centres[0])]
    changes = _takeovers(draft, centres)
    starts = [angle for angle, _, _ in changes]
    ends = [*starts[1:], starts[0] + draft.pitch]
    return [(start, end, rank, centre) for start, end, (_, rank, centre) in zip(starts, ends, changes, strict=True)]


def _takeovers(draft: Envelope, centres: list[float]) -> list[tuple[float, int, float]]:
    """Each angle of one pitch at which another roller takes over, with the rank and centre of the new one."""
    start = min(centres)
    grid = start + np.linspace(0, draft.pitch, SEARCH + 1)
    candidates = [
        (rank, centre + j * draft.pitch)
        for rank, centre in enumerate(centres)
        if not _twin_before(draft, rank)
        for j in range(-math.ceil(_reach(draft, rank) / draft.pitch), math.ceil(_reach(draft, rank) / draft.pitch) + 2)
    ]
    heights = np.empty((len(candidates), len(grid)))
    for height, (rank, centre) in zip(heights, candidates, strict=True):
        out = np.empty((len(grid), 7))
        kernels.outline(grid - centre, kernels.DECIDE, draft.bodies[rank], draft.knots, draft.table, out)
        near = np.abs(grid - centre) <= _reach(draft, rank)
        height[:] = np.where(near, out[:, kernels.HEIGHT], kernels.NOWHERE)
    best = heights.argmax(axis=0)
    changes: list[tuple[float, int, float]] = []
    for i in np.flatnonzero(best[1:] != best[:-1]):
        _between(draft, candidates, grid[i], grid[i + 1], best[i], best[i + 1], changes)
    return changes


def _twin_before(draft: Envelope, rank: int) -> bool:
    """Whether an earlier race is this one's mirror image and holds the sphere at the same height, as outer races do."""
    race, body = draft.races[rank], draft.rollers[rank]
    return body.square and any(
        abs(other.offset) == abs(race.offset) and other.radius == race.radius and len(draft.races) > 2
        for other in draft.races[:rank]
    )


def _between(draft: Envelope, candidates, low: float, high: float, before: int, after: int, changes: list) -> None:
    """Find where ``before`` gives way to ``after``, and to any third that holds the sphere for a moment in between."""
    (rank_1, centre_1), (rank_2, centre_2) = candidates[before], candidates[after]
    angle = kernels.takeover_angle(
        low, high, draft.bodies[rank_1], centre_1, draft.bodies[rank_2], centre_2, draft.knots, draft.table
    )
    row, heights = np.empty(7), []
    for rank, centre in candidates:
        kernels.touch(angle - centre, kernels.DECIDE, draft.bodies[rank], draft.knots, draft.table, row)
        heights.append(row[kernels.HEIGHT] if abs(angle - centre) <= _reach(draft, rank) else kernels.NOWHERE)
    third = int(np.argmax(heights))
    excess = heights[third] - max(heights[before], heights[after])
    if third not in (before, after) and excess > 1e-14 * abs(draft.nominal) and high - low > NARROW * draft.pitch:
        _between(draft, candidates, low, angle, before, third, changes)
        _between(draft, candidates, angle, high, third, after, changes)
    else:
        changes.append((angle, rank_2, centre_2))


def _cut(draft: Envelope, start: float, end: float, rank: int, centre: float) -> list[Strip]:
    """A roller's turn, cut where contact passes from its side to an end or from one piece of its generatrix to the next."""
    body = draft.rollers[rank]
    places = [] if body.half_length == 0 else [-body.half_length, body.half_length, *body.knots[1:-1]]
    inner = (centre + _passing(draft, rank, place) for place in places)
    sliver = NARROW * draft.pitch
    cuts = [start, *sorted(angle for angle in inner if start + sliver < angle < end - sliver), end]
    strips, row = [], np.empty(7)
    for low, high in itertools.pairwise(cuts):
        middle = 0.5 * (low + high)
        kernels.touch(middle - centre, kernels.DECIDE, draft.bodies[rank], draft.knots, draft.table, row)
        strips.append(Strip(low, high, rank, centre, int(row[kernels.REGION])))
    return strips


def _refuse_fall(whole: Envelope, sphere_radius: float) -> None:
    """Refuse wheels whose rollers let the sphere fall in between, down to the rollers' axes or through."""
    for strip in whole.strips:
        height = whole.outline(strip, np.array([strip.start, strip.end]))[:, kernels.HEIGHT]
        if height.min() <= kernels.NOWHERE:
            raise DesignError(
                f"a sphere of radius {sphere_radius:g} m falls through between the rollers; take more or longer ones",
                ("rollers",),
            )
        # Rollers of unknown cross-section have no axis that the sphere could reach.
        if 0 < whole.races[strip.rank].roller_radius < whole.nominal - height.min():
            raise DesignError(
                f"the sphere falls {whole.nominal - height.min():.3g} m between two rollers, down to their axes; "
                "take more, thicker or longer ones",
                ("rollers",),
            )
