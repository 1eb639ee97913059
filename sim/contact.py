"""What skin must not pass through: the eyeballs and the other lip. And the seal that keeps closed
lips closed.

Each vertex of the lower lip's edge is paired with a point on the edge of the upper lip. A spring
holds the pair together as long as nothing opens the mouth (moist lips stick; without it a smile
parts them by a millimetre). It must be stiffer than any muscle or one sees teeth through closed
lips, so it is integrated implicitly, pair by pair, and costs the time step nothing. Pairs and
eyeballs are also hard constraints: after each substep positions are projected out and the
approaching part of the velocity is removed.

Source: own; contact by projection after Müller et al. 2007, "Position based dynamics", section 3.
Differs from it: all pairs are solved at once from one state and averaged (Jacobi), which keeps a
symmetric face symmetric.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from .landmarks import Array, polyline_distance, select
from .skull import Eyeball
from .surface import Surface

LIP_EDGE = 5.0  # mm around the mouth line in which lip vertices are looked for
OWN_SIDE = 0.1  # of the lip side field: nearer to the corner lips are one
PAIR_GAP = 3.0  # mm: lips further apart at rest are no pair
LEAST_SEAL_AREA = 4.0  # mm2: tiny vertices of a lip edge still carry their share
SLIDES_IN_FRONT = (
    3.0  # mm the lower lip may come forward before it passes in front of the upper one
)
SLIDE_FADE = 3.0  # mm over which it then does
SEAL_AXES = (0.5, 1.0, 0.5)  # the seal's stiffness sideways, up and down, forward (last fitted)
UNBROKEN_SEAL = 100.0  # x stiffness of a whole seal against one half broken: gaps below 0.1 mm
FULLY_PRESSED = 0.25  # activity from which they overlap in full
PRESSED_OVERLAP = 0.5  # mm sealed lips overlap when muscles act: smoothing thins a folded lip
EYE_REACH = 12.0  # mm around an eyeball in which skin is watched
EYE_CLEARANCE = 0.3  # mm of lid thickness that stay between a vertex and the eyeball


class LipPairs(NamedTuple):
    """Lower-lip vertices and the upper-lip points that lie on them when the mouth is closed."""

    lower: npt.NDArray[np.int32]  # (P,)
    upper: npt.NDArray[np.int32]  # (P, 2) ends of an edge-like segment of the upper lip
    share: Array  # (P,) of the first end
    least_gap: Array  # (P,) mm, vertical; small negative where lips overlap at rest
    seal: Array  # (P,) stiffness
    averaging: Array  # (P,) 1 / number of pairs its vertices are in
    members: npt.NDArray[np.int32]  # (M,) all vertices in pairs

    def energy(self, moved: Array, grip: Grip) -> float:
        """Energy stored in the seal for displacements (V, 3)."""
        apart = moved[self.lower] - self.share[:, None] * moved[self.upper[:, 0]]
        apart -= (1.0 - self.share)[:, None] * moved[self.upper[:, 1]]
        apart[:, 1] -= grip.overlap
        stored = self.seal * (apart**2 @ np.array(SEAL_AXES))
        return float(grip.stiffness * stored.sum() / 2.0)


class Grip(NamedTuple):
    """How firmly the lips hold each other at the moment."""

    stiffness: float  # x the stiffness of each pair; 0 = open
    overlap: float  # mm by which the lips are pressed into each other

    @classmethod
    def of(cls, strength: float, activity: float) -> Grip:
        """Grip of a seal of `strength` 0 (broken) .. 1 under muscles of `activity` 0 .. 1."""
        stiffness = strength / (1.0 - strength + 1.0 / UNBROKEN_SEAL)
        return cls(stiffness, PRESSED_OVERLAP * strength * min(activity / FULLY_PRESSED, 1.0))


SEALED = Grip.of(1.0, 0.0)


def pair_lips(surface: Surface, landmarks: Array, lip_side: Array, seal: float) -> LipPairs:
    """Pair the edges of the lips; no pairs if the mouth is open at rest or has no slit."""
    x = surface.positions
    line = (select(landmarks, (60, 61, 62, 63, 64)) + select(landmarks, (60, 67, 66, 65, 64))) / 2.0
    at_edge = polyline_distance(x, line) < LIP_EDGE
    at_edge &= np.abs(x[:, 0] - line[2, 0]) < 0.51 * abs(line[-1, 0] - line[0, 0])
    upper = np.flatnonzero(at_edge & (lip_side > OWN_SIDE))
    pairs = []
    for i in np.flatnonzero(at_edge & (lip_side < -OWN_SIDE)):
        found = _upper_point(x, int(i), upper)
        if found is not None:
            pairs.append((int(i), *found))
    return _lip_pairs(surface, pairs, seal)


def _upper_point(
    x: Array, lower: int, upper: npt.NDArray[np.int64]
) -> tuple[int, int, float] | None:
    """The upper-lip point above a lower-lip vertex: nearest vertices right and left, mixed."""
    reach = np.linalg.norm(x[upper] - x[lower], axis=1)
    right = x[upper, 0] <= x[lower, 0] + 1e-9
    left = x[upper, 0] >= x[lower, 0] - 1e-9
    if not right.any() or not left.any():
        return None
    a = int(upper[right][reach[right].argmin()])
    b = int(upper[left][reach[left].argmin()])
    span = x[b, 0] - x[a, 0]
    share = float((x[b, 0] - x[lower, 0]) / span) if span > 1e-6 else 1.0
    apart = np.linalg.norm(share * x[a] + (1.0 - share) * x[b] - x[lower])
    return (a, b, share) if apart < PAIR_GAP else None


def _lip_pairs(surface: Surface, pairs: list[tuple[int, int, int, float]], seal: float) -> LipPairs:
    """Arrays of found pairs."""
    lower = np.array([p[0] for p in pairs], dtype=np.int32)
    upper = np.array([p[1:3] for p in pairs], dtype=np.int32).reshape(-1, 2)
    share = np.array([p[3] for p in pairs], dtype=np.float64)
    x = surface.positions
    gap = share * x[upper[:, 0], 1] + (1.0 - share) * x[upper[:, 1], 1] - x[lower, 1]
    count = np.bincount(lower, minlength=surface.vertex_count)
    count += np.bincount(upper[share > 0.0, 0], minlength=surface.vertex_count)
    count += np.bincount(upper[share < 1.0, 1], minlength=surface.vertex_count)
    most = np.maximum(count[lower], count[upper].max(axis=1, initial=1))
    strength = seal * np.maximum(surface.areas[lower], LEAST_SEAL_AREA)
    members = np.flatnonzero(count).astype(np.int32)
    return LipPairs(lower, upper, share, np.minimum(gap, 0.0), strength, 1.0 / most, members)


class EyeContact(NamedTuple):
    """Skin vertices near an eyeball and how near they may come to its centre."""

    vertex: npt.NDArray[np.int32]  # (C,)
    centre: Array  # (C, 3)
    least_distance: Array  # (C,)


def watch_eyeballs(surface: Surface, eyeballs: tuple[Eyeball, ...]) -> EyeContact:
    """Find the vertices that could touch an eyeball; one that starts inside may not sink deeper."""
    vertices, centres, least = [], [], []
    for ball in eyeballs:
        distance = np.linalg.norm(surface.positions - ball.centre, axis=1)
        near = np.flatnonzero(distance < ball.radius + EYE_REACH)
        vertices.append(near)
        centres.append(np.tile(ball.centre, (len(near), 1)))
        least.append(np.minimum(distance[near], ball.radius + EYE_CLEARANCE))
    empty = np.zeros((0, 3))
    return EyeContact(
        np.concatenate([*vertices, np.zeros(0)]).astype(np.int32),
        np.vstack([*centres, empty]),
        np.concatenate([*least, np.zeros(0)]),
    )


@numba.njit(cache=True)
def hold_lips(state, rest, mass, lips, grip, h):  # type: ignore[no-untyped-def]
    """Change velocities by the seal's pull over a substep of `h` [s], as if it had already acted.

    An implicit spring on the distance c of a pair, growing at speed s, with inverse mass w:
    s' = (s - h k w c) / (1 + h^2 k w), stable for any stiffness k.
    """
    if grip.stiffness <= 0.0:
        return
    x, v, change = state.x, state.v, state.move
    change[:] = 0.0
    for p in range(len(lips.lower)):
        i, a, b = lips.lower[p], lips.upper[p, 0], lips.upper[p, 1]
        w = lips.share[p]
        inverse = 1.0 / mass[i] + w * w / mass[a] + (1.0 - w) * (1.0 - w) / mass[b]
        for k in range(3):
            apart = x[i, k] - rest[i, k]
            apart -= w * (x[a, k] - rest[a, k]) + (1.0 - w) * (x[b, k] - rest[b, k])
            if k == 1:
                apart -= grip.overlap
            speed = v[i, k] - w * v[a, k] - (1.0 - w) * v[b, k]
            give = h * inverse * grip.stiffness * lips.seal[p] * SEAL_AXES[k]
            kept = (speed - give * apart) / (1.0 + h * give)
            impulse = lips.averaging[p] * (kept - speed) / inverse
            change[i, k] += impulse / mass[i]
            change[a, k] -= w * impulse / mass[a]
            change[b, k] -= (1.0 - w) * impulse / mass[b]
    for row in range(len(lips.members)):
        i = lips.members[row]
        for k in range(3):
            v[i, k] += change[i, k]


@numba.njit(cache=True)
def keep_lips_apart(state, rest, mass, lips, overlap):  # type: ignore[no-untyped-def]
    """Project lips that cross by more than `overlap` [mm] back and stop their approach."""
    x, v, move = state.x, state.v, state.move
    crossed = False
    for p in range(len(lips.lower)):
        i, a, b = lips.lower[p], lips.upper[p, 0], lips.upper[p, 1]
        w = lips.share[p]
        gap = w * x[a, 1] + (1.0 - w) * x[b, 1] - x[i, 1]
        deep = lips.least_gap[p] - overlap - gap
        if deep <= 0.0:
            continue
        forward = x[i, 2] - rest[i, 2]
        forward -= w * (x[a, 2] - rest[a, 2]) + (1.0 - w) * (x[b, 2] - rest[b, 2])
        full = min(max(1.0 - (forward - SLIDES_IN_FRONT) / SLIDE_FADE, 0.0), 1.0)
        if full == 0.0:
            continue
        if not crossed:
            move[:] = 0.0
            crossed = True
        inverse = 1.0 / mass[i] + w * w / mass[a] + (1.0 - w) * (1.0 - w) / mass[b]
        push = full * lips.averaging[p] * deep / inverse
        approach = v[i, 1] - w * v[a, 1] - (1.0 - w) * v[b, 1]
        stop = full * lips.averaging[p] * max(approach, 0.0) / inverse
        move[i, 0] -= push / mass[i]
        move[a, 0] += w * push / mass[a]
        move[b, 0] += (1.0 - w) * push / mass[b]
        move[i, 1] -= stop / mass[i]
        move[a, 1] += w * stop / mass[a]
        move[b, 1] += (1.0 - w) * stop / mass[b]
    if crossed:
        for row in range(len(lips.members)):
            i = lips.members[row]
            x[i, 1] += move[i, 0]
            v[i, 1] += move[i, 1]


@numba.njit(cache=True)
def keep_out_of_eyeballs(state, eyes):  # type: ignore[no-untyped-def]
    """Project skin out of the eyeballs and stop its approach."""
    x, v = state.x, state.v
    vertex, centre, least_distance = eyes.vertex, eyes.centre, eyes.least_distance
    for c in range(len(vertex)):
        i = vertex[c]
        dx = x[i, 0] - centre[c, 0]
        dy = x[i, 1] - centre[c, 1]
        dz = x[i, 2] - centre[c, 2]
        squared = dx * dx + dy * dy + dz * dz
        if squared >= least_distance[c] ** 2 or squared == 0.0:
            continue
        out = least_distance[c] / np.sqrt(squared)
        x[i, 0] = centre[c, 0] + dx * out
        x[i, 1] = centre[c, 1] + dy * out
        x[i, 2] = centre[c, 2] + dz * out
        approach = (v[i, 0] * dx + v[i, 1] * dy + v[i, 2] * dz) / squared
        if approach < 0.0:
            v[i, 0] -= approach * dx
            v[i, 1] -= approach * dy
            v[i, 2] -= approach * dz
