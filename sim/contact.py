"""Contact of each lip with the other lip, and the seal that keeps closed lips closed.

Each vertex on the edge of either lip is paired with a point on the edge of the other lip. Points
are used because a mesh may have more vertices on one lip; a vertex without a pair would make the
lip line jagged. A spring holds each pair together as long as nothing opens the mouth (moist lips
stick; without the spring a smile parts them by a millimetre). The spring must be stiffer than any
muscle, or teeth show through closed lips. So it is integrated implicitly, pair by pair, and does
not shorten the time step. Pairs are also hard constraints: after each substep, positions are
projected out of the other lip, and the approaching part of the velocity is removed.
eye_contact.py has the contact with the eyeballs.

Source: own; contact by projection after Müller et al. 2007, "Position based dynamics", section 3.
Differs from it: all pairs are solved at once from one state and averaged (Jacobi), which keeps a
symmetric face symmetric.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32, Integers64
from .landmarks import mouth_line
from .polylines import polyline_distance
from .surface import SkinSurface

PAIR_GAP = 2.2  # mm: lips further apart at rest form no pair, or their red would fold at the line
PRESSED_OVERLAP = 1.8  # mm of overlap of sealed lips when muscles act: smoothing thins a folded lip
BALANCING_PASSES = 5  # further passes hardly change a stiffness
SLIDE_DISTANCE = 3.0  # mm that the lower lip moves forward or in before it passes the upper one


class LipPairs(NamedTuple):
    """Vertices of each lip, and for each the point of the other lip that it touches when closed."""

    vertex: Integers32  # (P,)
    beside: Integers32  # (P, 2) ends of an edge-like segment of the other lip
    weight: Floats64  # (P,) of the first end
    below: Floats64  # (P,) 1 for a vertex of the lower lip, -1 for one of the upper
    least_gap: Floats64  # (P,) mm, vertical; slightly negative where lips overlap at rest
    seal: Floats64  # (P,) stiffness
    averaging: Floats64  # (P,) 1 / the number of pairs that share its vertices
    members: Integers32  # (M,) all vertices in pairs

    def separations(self, values: Floats64) -> Floats64:
        """Return for each pair the value at the vertex, minus the value at the point, (P, 3).

        values: a vector for each vertex, (V, 3).
        """
        a, b = self.beside.T
        weight = self.weight[:, None]
        apart: Floats64 = values[self.vertex] - weight * values[a] - (1.0 - weight) * values[b]
        return apart

    def deepest(self, x: Floats64, rest: Floats64, pressed: float) -> float:
        """Return the greatest depth of one lip in the other [mm], for vertices `x` (V, 3).

        rest: vertices at rest, (V, 3). pressed: depth that is subtracted, because lips are pressed.
        A lower lip in front of the upper lip, or rolled in behind it (substep.py), does not count.
        """
        forward = self.separations(x - rest)[:, 2]
        crossing = self.least_gap - pressed + self.below * self.separations(x)[:, 1]
        return float(np.where(np.abs(forward) < SLIDE_DISTANCE, crossing, 0.0).max(initial=0.0))


class Grip(NamedTuple):
    """How firmly the lips stick together now."""

    stiffness: float  # factor of the stiffness of each pair; 0 = open
    gap_stiffness: float  # the same against a gap, as lips that slide on each other stay closed
    overlap: float  # mm by which the lips are pressed into each other

    @classmethod
    def from_seal(cls, strength: float, activity: float, slid: float = 1.0) -> Grip:
        """Grip of a seal with `strength` 0 (broken) .. 1, under muscles with `activity` 0 .. 1.

        At full strength the seal is stronger than every muscle. It must weaken early, or the mouth
        would open abruptly. slid: a factor of the strength, except against a gap; lips whose factor
        is 0 are free to slide on each other.
        """
        unbroken_seal = 100.0  # factor of the rig's seal in a closed mouth: gaps below 0.1 mm

        def stiffness_of(part: float) -> float:
            return part**5 / (1.0 - part + 1.0 / unbroken_seal)

        full_press_activity = 0.25  # activity from which they overlap in full
        press = min(activity / full_press_activity, 1.0)
        return cls(
            stiffness=stiffness_of(slid * strength),
            gap_stiffness=stiffness_of(strength),
            overlap=PRESSED_OVERLAP * slid * strength * press,
        )


SEALED_GRIP = Grip.from_seal(1.0, 0.0)


def pair_lips(
    surface: SkinSurface, landmarks: Floats64, lip_side: Floats64, seal: float
) -> LipPairs:
    """Pair the edges of the lips; a mouth that is open at rest, or not cut, has no pairs."""
    x = surface.positions
    line = mouth_line(landmarks)
    lip_edge = 5.0  # mm around the mouth line in which lip vertices are looked for
    off_line = polyline_distance(x, line)
    at_edge = off_line < lip_edge
    width = abs(line[-1, 0] - line[0, 0])
    middle = (line[-1, 0] + line[0, 0]) / 2.0  # that of the lips may lie aside
    at_edge &= np.abs(x[:, 0] - middle) < 0.51 * width
    own_side_level = 0.1  # value of the lip side field: nearer to the corner the lips are one
    upper = np.flatnonzero(at_edge & (lip_side > own_side_level))
    lower = np.flatnonzero(at_edge & (lip_side < -own_side_level))
    least_reach = _least_reach(surface, off_line)
    corners = surface.nearest(line[[0, -1]])
    pairs = []
    for own, other, below in ((lower, upper, 1.0), (upper, lower, -1.0)):
        for i in own.tolist():
            found = _point_beside(x, i, _with_corner(x, i, other, corners), least_reach[i])
            if found is not None:
                pairs.append(_LipPair(i, *found, below))
    return _lip_pairs(surface, pairs, seal)


def _with_corner(x: Floats64, vertex: int, other: Integers64, corners: Integers32) -> Integers64:
    """Add the mouth's corner to the vertices of the other lip where all lie on one side.

    The last vertices of coarse lips before a corner may have none opposite. corners: vertices at
    the right and the left corner, (2,).
    """
    across = x[other, 0] - x[vertex, 0]
    is_last = np.array([(across > 0.0).all(), (across < 0.0).all()])
    added = corners[is_last & (corners != vertex)].astype(np.int64)
    return np.concatenate([other, added])


def _least_reach(surface: SkinSurface, off_line: Floats64) -> Floats64:
    """Distance to the other lip up to which a vertex forms a pair in any case [mm], shape (V,).

    Lips of a coarse mesh touch less exactly, so it is the length of the vertex's edges. It is half
    of that where one of them leads to the mouth line. off_line: distance from this line [mm], (V,).
    """
    i, j = surface.edges.T
    nearer = off_line[i] - off_line[j]
    leads_there = np.abs(nearer) > 0.5 * surface.lengths
    reach = surface.spacing
    reach[np.where(nearer > 0.0, i, j)[leads_there]] *= 0.5
    return reach


class _LipPair(NamedTuple):
    """A pair, by the names of `LipPairs`."""

    vertex: int
    beside: tuple[int, int]
    weight: float
    below: float


def _point_beside(
    x: Floats64, vertex: int, other: Integers64, least_reach: float
) -> tuple[tuple[int, int], float] | None:
    """The other lip's point beside a lip's vertex: a mix of the nearest vertices right and left.

    None if it is too far, and farther than `least_reach` [mm].
    """
    here = x[vertex]
    reach = np.linalg.norm(x[other] - here, axis=1)
    across = x[other, 0]
    right = across <= here[0] + 1e-9
    left = across >= here[0] - 1e-9
    if not right.any() or not left.any():
        return None
    a = int(other[right][reach[right].argmin()])
    b = int(other[left][reach[left].argmin()])
    span = x[b, 0] - x[a, 0]
    weight = 1.0
    if span > 1e-6:
        weight = float((x[b, 0] - here[0]) / span)
    mixed = weight * x[a] + (1.0 - weight) * x[b]
    _, gap, overhang = np.abs(mixed - here)
    most_overhang = 3.0  # mm that one lip's edge may lie in front of the other's
    if gap >= max(PAIR_GAP, least_reach) or overhang >= max(most_overhang, least_reach):
        return None
    return (a, b), weight


def _evenly_held(
    own: Floats64, vertex: Integers32, beside: Integers32, weight: Floats64
) -> Floats64:
    """Return the stiffness of each pair, (P,), such that vertices are held alike for their areas.

    Vertices of a sparse lip lie opposite every second vertex of a dense lip. Without this balance,
    a weak seal would draw those out of the line of their neighbours. own: stiffness for the area of
    each vertex, (V,).
    """
    members = np.column_stack([vertex, beside])  # (P, 3) the vertices of each pair
    shares = np.column_stack([np.ones(len(vertex)), weight, 1.0 - weight])
    strength = own[vertex]
    total = strength.sum()
    for _ in range(BALANCING_PASSES):
        load = np.zeros(len(own))
        np.add.at(load, members, strength[:, None] * shares)
        fair_factors = own[members] / np.maximum(load[members], 1e-12)
        fair_factors[shares <= 0.0] = np.inf  # such a vertex does not hold the pair
        strength = strength * fair_factors.min(axis=1, initial=np.inf)
        strength *= total / max(strength.sum(), 1e-12)
    return strength


def _lip_pairs(surface: SkinSurface, pairs: list[_LipPair], seal: float) -> LipPairs:
    """Return found pairs as arrays, with the seal's stiffness for each; seal: of an area."""
    vertex = np.array([pair.vertex for pair in pairs], dtype=np.int32)
    beside = np.array([pair.beside for pair in pairs], dtype=np.int32).reshape(-1, 2)
    weight = np.array([pair.weight for pair in pairs], dtype=np.float64)
    below = np.array([pair.below for pair in pairs], dtype=np.float64)
    first = beside[weight > 0.0, 0]
    second = beside[weight < 1.0, 1]
    paired = np.concatenate([vertex, first, second])
    pairs_at = np.bincount(paired, minlength=surface.vertex_count)  # number of each vertex's pairs
    most_pairs = np.maximum(pairs_at[vertex], pairs_at[beside].max(axis=1, initial=1))
    strength = _evenly_held(seal * surface.areas, vertex, beside, weight)
    members = np.flatnonzero(pairs_at).astype(np.int32)
    lips = LipPairs(
        vertex=vertex,
        beside=beside,
        weight=weight,
        below=below,
        least_gap=np.zeros(len(pairs)),  # measured below, by the other fields
        seal=strength,
        averaging=1.0 / most_pairs,
        members=members,
    )
    gap = -below * lips.separations(surface.positions)[:, 1]
    return lips._replace(least_gap=np.minimum(gap, 0.0))
