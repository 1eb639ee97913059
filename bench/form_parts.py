"""What lies in and on a head of another form: eyeballs, lashes, teeth, tongue, the mouth's walls.

The head has the shipped topology. Eyeballs lie behind the lids as those of a head of one's own do,
lids on the eyeballs as those of the shipped head. Lashes and tears stand on the skin as they do
when a face moves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from risorius.app.scenes.surface_attachment import SurfaceAttachment
from risorius.assets.fitting.organs import FittedSkin, lids_on_eyes, place_eyes, place_parts
from risorius.assets.fitting.warp import ThinPlateSpline, nearest_on
from risorius.assets.model import Eye, FloatArray, Head, IndexArray, Part
from risorius.geometry.normals import vertex_normals

from .registration import MIRROR

LID_SHARES = (1.0, 1.0, 0.9, 0.55, 0.2)  # of the way onto the eyeball, row by row around an eye
EYE_RADIUS, IRIS_RADIUS, CLEARANCE = 13.0, 5.9, 0.25  # [mm]
OUTWARD = 0.3  # [mm] that an eyeball's centre is beside the middle of its lids
LEAST_CLEARANCE = 0.15  # [mm] of the edges of lids, their corners too
EYE_ROUNDS = 1  # of placing an eye as that of a head of one's own, and lids on it
GIVE = 0.5  # of the warp of parts where the skin has no row
WALL_DEPTH, WALL_ROUNDS = 1.2, 4  # [mm] of the mouth's walls behind the skin; rounds of pushing


def eyes_behind_lids(head: Head, x: FloatArray) -> tuple[Eye, ...]:
    """Eyeballs that lie on the edges of the lids as well as they can, all of one size."""
    ring = head.rings["eye_1_left"]
    edge = x[np.delete(ring, [0, 1, len(ring) - 1])]  # without the inner corner
    middle = 0.5 * (x[ring[5]] + x[ring[15]])
    aside = middle[:2] + np.array([OUTWARD, 0.0])

    def off(centre: FloatArray) -> FloatArray:
        gaps = np.linalg.norm(edge - centre, axis=1) - EYE_RADIUS - CLEARANCE
        return np.concatenate([gaps, 2.0 * (centre[:2] - aside)])

    left = scipy.optimize.least_squares(off, middle - [0.0, 0.0, EYE_RADIUS]).x
    return _both(Eye("left", left, EYE_RADIUS, IRIS_RADIUS))


def _both(left: Eye) -> tuple[Eye, ...]:
    return replace(left, name="right", centre=left.centre * MIRROR), left


def lids_and_eyes(head: Head, vertices: FloatArray) -> tuple[FloatArray, tuple[Eye, ...]]:
    """Vertices with the lids on the eyeballs, and the eyeballs behind them.

    The eyes are where fitting the head as one's own would place them: lids that close over those
    do so over these.
    """
    eyes = eyes_behind_lids(head, vertices)
    for _ in range(EYE_ROUNDS):
        x = clear_of_eyes(head, lids_on_eyes(head, vertices, eyes, LID_SHARES), eyes)
        known = replace(head, vertices=x, eyes=eyes)
        skin = FittedSkin(x, vertex_normals(x, head.faces), x[head.landmarks], head.mandible_weight)
        eyes = _both(place_eyes(known, skin)[1])
    return clear_of_eyes(head, lids_on_eyes(head, vertices, eyes, LID_SHARES), eyes), eyes


def clear_of_eyes(head: Head, vertices: FloatArray, eyes: tuple[Eye, ...]) -> FloatArray:
    """Vertices of which the edges of the lids, and what is around them, are not in the eyeballs."""
    x = vertices.copy()
    for eye in eyes:
        ring = np.concatenate([head.rings[f"eye_{row}_{eye.name}"] for row in (1, 2, 3)])
        away = x[ring] - eye.centre
        least = eye.radius + LEAST_CLEARANCE
        share = np.maximum(least / np.linalg.norm(away, axis=1), 1.0)
        x[ring] = eye.centre + share[:, None] * away
    return x


def warp_of(head: Head, x: FloatArray) -> ThinPlateSpline:
    """How what lies in the head moves with its skin, the same on both sides."""
    rows = [ring for name, ring in head.rings.items() if not name.startswith("rim")]
    anatomy = np.array(list(head.anatomy.values()))
    named = np.unique(np.concatenate([*rows, head.landmarks, anatomy]))
    named = np.union1d(named, head.mirror[named])
    others = np.setdiff1d(np.arange(len(x)), named)
    others = others[head.vertices[others, 0] >= 0.0][::2]
    others = np.union1d(others, head.mirror[others])
    use = np.concatenate([named, others])
    give = np.r_[np.zeros(len(named)), np.full(len(others), GIVE)]
    return ThinPlateSpline(head.vertices[use], x[use], give)


def placed_parts(
    head: Head, x: FloatArray, eyes: tuple[Eye, ...], warp: ThinPlateSpline
) -> tuple[Part, ...]:
    """Eyeballs, lashes, teeth, tongue and walls of the mouth in the skin; the shirt stays."""
    normals = vertex_normals(x, head.faces)
    skin = FittedSkin(x, normals, x[head.landmarks], head.mandible_weight)
    parts = []
    for old, new in zip(head.parts, place_parts(head, skin, warp, eyes), strict=True):
        if old.name == "shirt":
            placed = old
        elif old.roots is not None:
            attached = SurfaceAttachment.of(old, head.vertices, head.faces)
            attached.follow(x, np.eye(4))
            placed = replace(old, vertices=attached.vertices, normals=attached.normals)
        elif old.name.startswith("oral_cavity"):
            walls = _behind(warp.points(old.vertices), x, normals, head.faces)
            placed = replace(
                new,
                vertices=walls.astype(np.float32),
                normals=vertex_normals(walls, new.faces).astype(np.float32),
            )
        else:
            placed = new
        parts.append(placed)
    return tuple(parts)


def _behind(
    points: FloatArray, vertices: FloatArray, normals: FloatArray, faces: IndexArray
) -> FloatArray:
    """Points pushed along the skin's normals until they are WALL_DEPTH behind it."""
    pushed = points.copy()
    for _ in range(WALL_ROUNDS):
        at = nearest_on(pushed, np.zeros_like(pushed), vertices, faces)
        facing = at.interpolate(normals)
        facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
        height = ((pushed - at.interpolate(vertices)) * facing).sum(axis=1)
        pushed -= np.maximum(height + WALL_DEPTH, 0.0)[:, None] * facing
    return pushed
