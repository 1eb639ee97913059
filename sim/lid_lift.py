"""How near a closed lid lies to the eyeball, and how far it is lifted to cover the ball.

Lids turn over the eyeball vertex by vertex and are kept off the ball there (eye_contact.py). But
the triangle between three vertices is flat, and the cornea protrudes from the ball, so triangles of
a coarse mesh would intersect the ball. So the lids are closed once when a face is built. If a
triangle then intersects the eyeball, its corners on the upper lid move outward, each by its
barycentric weight at the deepest point. The lower lid hardly moves when the eye closes, and keeps
its form.

Source: own; projection by weights as in Müller et al. 2007, "Position based dynamics", section 3.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from ..geometry.directions import unit_vectors
from ..geometry.normals import cross_products
from ..geometry.steps import smoothstep
from .eye_contact import EYE_CLEARANCE, barycentric_grid
from .skull import Eyeball, ball_surface

LIFT_TOLERANCE = 1e-3  # mm


def laid_on_ball(x: Floats64, ball: Eyeball, column: Floats64, turn_weight: Floats64) -> Floats64:
    """Return how much nearer to the eyeball the skin of a closed upper lid lies [mm], shape (V,).

    Skin of the fold is farther from the eyeball than the margin. Without this sinking, a closed lid
    would form a pouch in front of the ball that hangs over the lashes.

    x: vertices at rest (V, 3). column: fractions of the way from the outer corner of the eye (0) to
    the inner corner (1), shape (V,). turn_weight: how far each vertex turns with the margin, 0 to
    1, shape (V,).
    """
    thickness = 2.2  # [mm] of skin, muscle and plate, from the eyeball to the front of a lid
    most_sunk = 5.0  # [mm]
    beyond = np.linalg.norm(x - ball.centre, axis=1) - ball.radius - thickness
    lies = smoothstep(2.0 * turn_weight) * np.sqrt(np.sin(np.pi * np.clip(column, 0.0, 1.0)))
    sunk: Floats64 = lies * np.clip(beyond, 0.0, most_sunk)
    return sunk


def lift_off(
    x: Floats64, rest: Floats64, faces: Integers32, moves: Floats64, ball: Eyeball
) -> Floats64:
    """Return how far each vertex of a closed lid must move outward [mm], shape (V,).

    x, rest: vertices with the lid closed, and at rest (V, 3); skin inside the ball at rest may stay
    there. moves: 1 for vertices of the upper lid, else 0, shape (V,).
    """
    away = x - ball.centre
    directions = unit_vectors(away, LIFT_TOLERANCE)
    faces = faces[moves[faces].any(axis=1)]
    outward = (cross_products(away, faces) * away[faces].sum(axis=1)).sum(axis=1)
    faces = faces[outward > 0.0]  # not the inner side of a lid
    barycentric = barycentric_grid()
    lift = np.zeros(len(x))
    before = np.linalg.norm(barycentric @ (rest - ball.centre)[faces], axis=2) - ball.radius
    kept = np.where(before < 0.0, before, EYE_CLEARANCE)
    least_share = 0.5  # least total share of the upper lid's corners in a point for which they move
    kept[moves[faces] @ barycentric.T < least_share] = -np.inf
    most_passes = 30  # most repetitions, needed because triangles share corners
    for _ in range(most_passes):
        points = barycentric @ (away + lift[:, None] * directions)[faces]  # (F, S, 3)
        distance = np.linalg.norm(points, axis=2)
        ahead = points[..., 2] / np.maximum(distance, LIFT_TOLERANCE)  # the eye looks straight on
        deep = ball_surface(ahead, ball.radius, ball.iris) + kept - distance
        weights = barycentric[deep.argmax(axis=1)] * moves[faces]
        push = deep.max(axis=1, initial=0.0) / np.maximum((weights**2).sum(axis=1), LIFT_TOLERANCE)
        if push.max(initial=0.0) < LIFT_TOLERANCE:
            break
        further = np.zeros(len(x))
        np.maximum.at(further, faces, weights * push[:, None])
        lift += further
    return lift
