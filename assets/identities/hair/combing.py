"""Where locks begin, and how they run: combed from a parting, then falling to the hem.

Lines begin on the scalp and follow a field of directions over the envelope. At the top they go to
both sides of the parting, or back; where they would hang into the face they go aside; locks from
higher up lie over lower ones.
"""

from __future__ import annotations

import numpy as np
import scipy

from ...around import HAIRLINE, direction_coordinates, line_height, rays
from ...model import IndexArray
from ...smooth import Points, Values, smooth_step, unit
from .cuts import Cut
from .envelope import Envelope

STEP = 4.0  # [mm] of a line
LEAST = 12.0  # [mm] from a root to the hem
CANDIDATES = 15  # places for each root
PARTED = 1.6  # [mm] beside the parting, where a row of locks begins
BARE = 7.0  # [mm] beside it where no other begins
STRAIGHT = 25.0  # [mm] beside it, where hair does not go straight away from it any more
IN_ROW = 3.5  # [mm] from one of these to the next
PARTED_TO = -35.0  # [mm] z of its end behind
TOGETHER = -75.0, -15.0  # [mm] z between which hair from both its sides comes together
UNPARTED = 45.0  # [mm] beside it where hair that is brushed back goes aside as far as other hair
ON_TOP = 60.0  # [mm] height above which a lock stays on its side of the parting
ROOTED = 0.2  # [mm] that they lie over the envelope at their roots
OVER_SKIN = 3.2  # [mm] that they are over the triangles of the skin there, at most
LIFTED = 60.0  # [mm] from the root, where a lock has come up to its layer
FLAT, EDGED = 0.8, 25.0  # how much closer they lie at the hairline, and from how far behind it [mm]
BROWS = 30.0, 55.0  # heights above which they do [mm]
CURLED = 10.0  # [mm] that ends turn in
UNEVEN = 5.5  # [mm] by which they end at different heights


def roots_of(
    cut: Cut, vertices: Points, faces: IndexArray, receded: float, random: np.random.Generator
) -> Points:
    """Where locks begin: evenly over the scalp, closer where roots are seen."""
    corners = vertices[faces]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(first, second), axis=1)
    face = random.choice(len(faces), CANDIDATES * cut.count, p=area / area.sum())
    share = random.random((2, len(face)))
    share = np.where(share.sum(axis=0) > 1.0, 1.0 - share, share)[:, :, None]
    points = corners[face, 0] + share[0] * first[face] + share[1] * second[face]

    angle, height, _ = direction_coordinates(points)
    around = np.degrees(np.abs(angle))
    behind = _behind(angle, height) - receded * (around < 70.0)
    is_ear = (np.abs(around - 95.0) < 14.0) & (height < 12.0)
    is_haired = (behind > 1.5) & (height > cut.end(angle) + LEAST) & ~is_ear
    points, behind = points[is_haired], behind[is_haired]
    angle, height, _ = direction_coordinates(points)
    closer = 1.0 + 3.0 * smooth_step(14.0, 4.0, behind) * (np.abs(angle) < 1.3)
    # The parting first, then always the farthest of all points, until there are enough.
    parted = _along_parting(cut, points[height > ON_TOP])
    points, closer = (each[near_parting(cut, points, BARE) == 0.0] for each in (points, closer))
    chosen: list[int] = []
    gap = scipy.spatial.cKDTree(parted).query(points)[0]
    while len(chosen) < cut.count - len(parted):
        chosen.append(int(np.argmax(gap * closer)))
        gap = np.minimum(gap, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.vstack([parted, points[chosen]])


def _along_parting(cut: Cut, points: Points) -> Points:
    """Roots in two rows among points on top of the head, one on each side of the parting."""
    if cut.brushed:
        return np.zeros((0, 3))
    near = points[np.abs(points[:, 0] - cut.parting) < BARE]
    fit = np.polynomial.Polynomial.fit(near[:, 2], near[:, 1], 4)
    ahead = np.linspace(max(near[:, 2].min(), PARTED_TO), near[:, 2].max(), 100)
    far = np.cumsum(np.hypot(np.gradient(ahead), np.gradient(fit(ahead))))
    ahead = np.interp(np.arange(far[0], far[-1], IN_ROW), far, ahead)
    height = fit(ahead)
    return np.vstack(
        [
            np.stack([np.full(len(ahead), cut.parting + aside), height, ahead], axis=1)
            for aside in (-PARTED, PARTED)
        ]
    )


def _behind(angle: Values, height: Values) -> Values:
    """How far places lie behind the usual hairline [mm], shape (n,)."""
    return height - line_height(HAIRLINE, np.degrees(np.abs(angle)))


def layers_of(cut: Cut, roots: Points, random: np.random.Generator) -> Values:
    """How high over the scalp locks lie, 0 to 1: those from above over others, edges flat."""
    angle, height, _ = direction_coordinates(roots)
    layer = 0.9 * smooth_step(-80.0, 120.0, height) + 0.1 * random.random(len(roots))
    layer *= 0.3 + 0.7 * smooth_step(0.0, 40.0, _behind(angle, height))
    return np.asarray(layer)


def near_parting(cut: Cut, points: Points, width: float) -> Values:
    """1 at the parting, and where it ends behind; 0 from so far on [mm], or if hair is brushed."""
    behind = np.maximum(PARTED_TO - points[:, 2], 0.0)
    away = np.hypot(points[:, 0] - cut.parting, behind)
    return (1.0 - cut.brushed) * smooth_step(width, 0.0, away)


def combed(
    cut: Cut, envelope: Envelope, roots: Points, layer: Values, random: np.random.Generator
) -> list[Points]:
    """The line of each lock, from its root to its end, shape (k, 3) with its own k."""
    count = len(roots)
    own, uneven = random.normal(0.0, 1.0, count), random.random(count)
    side = np.clip((roots[:, 0] - cut.parting) / (UNPARTED if cut.brushed else 1e-3), -1.0, 1.0)
    longest = cut.longest * (0.8 + 0.2 * uneven)
    angle, height, radius = direction_coordinates(roots)
    origin, out = rays(angle, height)
    over = np.minimum(envelope.radius(angle, height) + ROOTED - radius, OVER_SKIN)
    at = origin + (radius + over)[:, None] * out
    is_done, lengths = np.zeros(count, bool), np.zeros(count, int)
    track = [at]
    for step in range(1, int(cut.longest / STEP) + 1):
        at = at + STEP * way_of(cut, at, side, own, STEP * step)
        angle, height, _ = direction_coordinates(at)
        origin, out = rays(angle, height)
        hem = cut.end(angle) + UNEVEN * uneven
        at_hairline = smooth_step(*BROWS, height) * smooth_step(EDGED, 0.0, _behind(angle, height))
        flat = 1.0 - FLAT * at_hairline
        off = ROOTED + flat * cut.volume * layer * smooth_step(
            0.0, LIFTED, np.full(count, STEP * step)
        )
        off -= cut.hangs * curl(height - hem, height)
        at = origin + (envelope.radius(angle, height) + off)[:, None] * out
        track.append(_waved(cut, at, own, STEP * step))
        is_done |= (height < hem) | (STEP * step > longest)
        lengths += ~is_done
    tracks = np.stack(track, axis=1)
    return [line[: length + 2] for line, length in zip(tracks, lengths, strict=True)]


def way_of(cut: Cut, at: Points, side: Values, own: Values, length: float) -> Points:
    """Unit directions along the head in which hair lies, shape (n, 3)."""
    angle, height, out, across = _around(at)
    # On top away from the parting, at first straight, and back, then down.
    off = 1.0 - near_parting(cut, at, STRAIGHT)
    behind = off * (-0.3 - 0.5 * smooth_step(20.0, 70.0, at[:, 2]))
    aside = side * smooth_step(*TOGETHER, at[:, 2])
    parted = np.stack([aside, np.zeros(len(at)), behind], axis=1)
    way = 1.6 * smooth_step(0.25, 0.95, out[:, 1])[:, None] * parted
    way[:, 1] -= off
    at_front = cut.brushed * smooth_step(-15.0, 45.0, at[:, 2]) * smooth_step(25.0, 45.0, height)
    back = np.stack([0.3 * side, np.full(len(at), 0.35), np.full(len(at), -1.0)], axis=1)
    way += at_front[:, None] * (1.6 * back - way)
    # Aside, where it would hang into the face.
    share = smooth_step(-100.0, 30.0, height)
    opening = np.radians(cut.opening[0] + (cut.opening[1] - cut.opening[0]) * share)
    within = np.clip((opening + 0.05 * own - np.abs(angle)) / 0.22, 0.0, 2.5)
    within *= smooth_step(105.0, 75.0, height) * (1.0 - 0.8 * at_front)
    aside = np.where((np.abs(angle) < 0.35) | (height > ON_TOP), side, np.sign(angle))
    uneven = 0.1 * own * np.sin(0.05 * length + 3.0 * own)
    way = way + (within * aside + uneven)[:, None] * across
    way -= (way * out).sum(axis=1)[:, None] * out
    return unit(way)


def _around(at: Points) -> tuple[Values, Values, Points, Points]:
    """Angle and height of places, and the directions out of the head and around it there."""
    angle, height, _ = direction_coordinates(at)
    across = np.stack([np.cos(angle), np.zeros(len(at)), -np.sin(angle)], axis=1)
    return angle, height, rays(angle, height)[1], across


def _waved(cut: Cut, at: Points, own: Values, length: float) -> Points:
    """Lines that swing to both sides and in and out; neighbours nearly alike."""
    far, period = cut.wave
    angle, height, out, across = _around(at)
    phase = 2.0 * np.pi * length / period + 2.0 * np.sin(3.0 * angle) + 0.5 * own
    # An angle means nothing at the crown.
    swing = far * min(length / LIFTED, 1.0) * smooth_step(140.0, 110.0, height)
    aside, off = np.sin(phase)[:, None] * across, 0.1 * np.cos(phase)[:, None] * out
    return np.asarray(at + swing[:, None] * (aside + off))


def curl(over_hem: Values, height: Values) -> Values:
    """How far hair that hangs comes in at its end [mm], shape (n,)."""
    ended = smooth_step(35.0, 0.0, over_hem) * smooth_step(-40.0, -60.0, height)
    return np.asarray(CURLED * ended)
