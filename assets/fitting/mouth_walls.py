"""Fit the walls of the mouth into a head; they lie within the skin and stretch between both jaws.

The upper walls hang from the skull, beside the teeth and behind the throat. They end at the floor
of the mouth, which moves with the mandible. Each vertex has a weight of the mandible's motion
(`Part.mandible_shares`), so walls that are as long as a shut mouth suffice. They do not reach down
to the neck, which follows the head only in part. On another head, vertices that would leave the
skin are moved toward the centre of the mouth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.rays import exits
from ...geometry.sides import border_sides
from ...geometry.transforms import moved_points
from ..model import Part
from .warp import Similarity

ShareArray = Floats64 | Floats32
WALL_NAME = "oral_cavity"  # beginning of the names of these parts


@dataclass(frozen=True)
class FittedSkin:
    """The skin into which the built-in organs are fitted.

    vertices: the skin at rest [mm], (V, 3).
    normals: unit normals of the vertices, (V, 3).
    faces: triangles of the skin, counter-clockwise seen from outside, (F, 3).
    landmarks: points [mm], (68, 3).
    mandible_weight: weights of the mandible's motion, 0 to 1, (V,).
    pieces: vertices of each other piece of the file [mm], (n, 3).
    """

    vertices: Floats64
    normals: Floats64
    faces: Integers32
    landmarks: Floats64
    mandible_weight: Floats64
    pieces: tuple[Floats64, ...] = ()


def stretched_walls(walls: Floats64, weights: ShareArray, mandible: Floats64) -> Floats64:
    """Move points of walls [mm], (n, 3), by weights of the mandible's motion.

    weights: 0 (fixed to the skull) to 1 (fixed to the mandible), (n,). mandible: motion
    relative to the skull, a matrix (4, 4) for column vectors.
    """
    moved = moved_points(mandible, walls)
    return np.asarray(walls + weights[:, None] * (moved - walls))


def opened_jaws(axis: Floats64, rig: Mapping[str, Any]) -> list[Floats64]:
    """Return the mandible's motions to a half open and a fully open mouth: matrices (4, 4).

    axis: centres of the right and the left condyle [mm], (2, 3).
    """
    jaw = rig.get("jaw", {})
    right, left = axis
    hinge = (left - right) / np.linalg.norm(left - right)
    opened = []
    for fraction in (0.5, 1.0):
        angle = fraction * np.radians(float(jaw.get("opening_deg", 20.0)))
        glide = fraction * np.array(jaw.get("opening_glide", (0.0, 0.0, 0.0)))
        matrix = np.eye(4)
        matrix[:3, :3] = scipy.spatial.transform.Rotation.from_rotvec(angle * hinge).as_matrix()
        matrix[:3, 3] = right - matrix[:3, :3] @ right + glide
        opened.append(matrix)
    return opened


def within_skin(
    parts: Sequence[Part], fitted: FittedSkin, mouth: Similarity, jaws: Sequence[Floats64]
) -> list[Part]:
    """Move parts toward the centre of the mouth until they lie `wall_depth` behind all skin.

    The skin is tested at rest and with open jaws. An open jaw also opens the throat of a mask, so
    the border of the skin counts as closed only at rest.

    mouth: similarity from the built-in mouth to the head's mouth. jaws: motions of the mandible,
    which the skin follows by `mandible_weight`.
    """
    if not parts:
        return []
    walls = np.concatenate([part.vertices for part in parts]).astype(np.float64)
    weights: ShareArray = np.concatenate([_mandible_shares(part) for part in parts])
    centre = mouth.points((0.0, -71.0, 63.0))  # between the teeth and the throat
    poses = [(np.eye(4), *_closed_skin(fitted, mouth))]  # mandible's motion, and the skin's mesh
    for mandible in jaws:
        moved = stretched_walls(fitted.vertices, fitted.mandible_weight, mandible)
        poses.append((mandible, moved, fitted.faces))
    wall_depth = 6.0  # [mm] behind the skin
    least_cosine = 0.35  # bound of the cosine between the skin's normal and a ray
    for mandible, vertices, faces in poses:
        away = stretched_walls(walls, weights, mandible) - centre
        length = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
        directions = away / length[:, None]
        ray, distance, cosine = exits(centre, directions, vertices, faces)
        depth_along_ray = wall_depth / np.maximum(cosine, least_cosine)
        room = np.full(len(walls), np.inf)
        np.minimum.at(room, ray, distance - depth_along_ray)
        nearer = np.clip(room / length, 0.0, 1.0)
        walls = centre + nearer[:, None] * (walls - centre)
    ends = np.cumsum([len(part.vertices) for part in parts])[:-1]
    placed = zip(parts, np.split(walls.astype(np.float32), ends), strict=True)
    return [replace(part, vertices=vertices) for part, vertices in placed]


def _mandible_shares(part: Part) -> ShareArray:
    """Return the weight of the mandible's motion at each vertex of a part, 0 to 1, (n,)."""
    if part.mandible_shares is not None:
        return part.mandible_shares
    return np.full(len(part.vertices), 1.0 if part.bone == "mandible" else 0.0)


def _closed_skin(fitted: FittedSkin, mouth: Similarity) -> tuple[Floats64, Integers32]:
    """Close the borders of a skin by fans of triangles, except lids and lips.

    The tip of a fan is the centre of its border, for example in the plane of a cut neck. The border
    of a mask runs around the face; its fan has the tip behind the throat, which needs room. Returns
    vertices (V + n, 3) and faces (m, 3).
    """
    skin = fitted.vertices
    faces = fitted.faces
    count = len(skin)
    border = border_sides(faces)
    group = pieces_of(border, count)[border[:, 0]]
    throat = mouth.points((0.0, -71.0, -10.0))  # 28 mm behind the throat
    widest = 1.5 * np.linalg.norm(fitted.landmarks[54] - fitted.landmarks[48])  # of lids, lips
    tips: list[Floats64] = []
    fans: list[Integers32] = []
    for number in np.unique(group):
        edge = border[group == number]
        points = skin[edge[:, 0]]
        if np.linalg.norm(np.ptp(points, axis=0)) < widest:
            continue
        goes_around = points[:, 1].min() < throat[1] < points[:, 1].max()
        tip = np.full(len(edge), count + len(tips))
        fans.append(np.column_stack([edge[:, 1], edge[:, 0], tip]))
        tips.append(throat if goes_around else points.mean(axis=0))
    return np.vstack([skin, *tips]), np.vstack([faces, *fans])
