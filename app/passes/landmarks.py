"""The landmarks of one picture, at the points that annotators of photographs mark.

The points of the jaw lie on the outline of the face that this camera sees. The outline is searched
along lines of `assets.annotation`. Points that stay on the jaw bone are returned separately
(`jaw_on_bone`). Those of the edges of lips and lids depend on the camera, too (`edges.py`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from risorius.assets.annotation import EDGE_LANDMARKS, FIRST_INNER
from risorius.geometry.arrays import Flags, Floats32, Floats64
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from risorius.geometry.polylines import arc_lengths, evenly_spaced
from risorius.geometry.rays import crossings
from risorius.geometry.transforms import moved_points

from ..scenes import Face
from .camera import CameraLabels
from .edges import edge_points

EYE_SIDES = ("right", "left")  # the subject's, in the order of landmarks
JAW_COUNT = 17  # the first landmarks
FARTHEST_SURFACE = 2.0  # [mm] from a visible landmark to the nearest surface in the picture


@dataclass(frozen=True)
class Landmarks:
    """The points of one picture: 68 landmarks, the right pupil, the left pupil.

    points: in the scene [mm], (70, 3). pixels: x to the right and y down; the middle of the first
    pixel is (0.5, 0.5), (70, 2). visible: flags of points in the picture that nothing hides, (70,).
    `jaw_on_bone` returns 17 points instead of 70.
    """

    points: Floats64
    pixels: Floats64
    visible: Flags


def landmarks_in(
    face: Face, camera: CameraLabels, depth: Floats32, covered: Flags | None = None
) -> Landmarks:
    """Return the landmarks of a face in a picture with the depth map `depth`, (H, W).

    covered: flags of pixels where a mask hides the face, (H, W); None: no mask.
    """
    positions = face.positions
    normals = vertex_normals(positions, face.head.faces)
    jaw = outline(face, camera, positions, normals)
    inner = face.annotation.inner_points(positions)
    edges = edge_points(face, camera, positions, normals)
    inner[np.array(EDGE_LANDMARKS) - FIRST_INNER] = edges
    points = np.vstack([jaw, inner, _pupils(face)])
    pixels = camera.project(points)
    pupil_tolerance = 0.6  # [mm]; a shut lid lies one millimetre in front of the pupil
    tolerance = np.full(len(points) - JAW_COUNT, FARTHEST_SURFACE)
    tolerance[-len(EYE_SIDES) :] = pupil_tolerance
    visible = np.concatenate(
        [
            _is_uncovered(jaw, camera, depth),
            _is_on_surface(points[JAW_COUNT:], tolerance, camera, depth),
        ]
    )
    skin = positions[face.head.faces]
    visible[-len(EYE_SIDES) :] &= _is_uncovered_by_skin(skin, points[-len(EYE_SIDES) :], camera)
    return Landmarks(points, pixels, visible & ~_is_covered(pixels, covered))


def jaw_on_bone(
    face: Face, camera: CameraLabels, depth: Floats32, covered: Flags | None = None
) -> Landmarks:
    """Return the rig's landmarks of the jaw, which stay on the bone when the head turns."""
    points = face.marked[:JAW_COUNT]
    tolerance = np.full(JAW_COUNT, FARTHEST_SURFACE)
    visible = _is_on_surface(points, tolerance, camera, depth)
    pixels = camera.project(points)
    return Landmarks(points, pixels, visible & ~_is_covered(pixels, covered))


def outline(face: Face, camera: CameraLabels, positions: Floats64, normals: Floats64) -> Floats64:
    """Return the outline of a face as a camera sees it [mm], shape (17, 3), from right to left.

    positions, normals: of the skin's vertices, (V, 3) each.

    The outline takes the outermost point of each line over the skin. Outward means to the side at
    the eyes and down at the chin; further iterations use the normals of the previous outline. As
    annotators do, points are spaced evenly from the height of one eye's outer corner to the height
    of the other's. Heights are measured on the head: if a face looks down, the outline begins above
    the eyes in the picture.
    """
    paths = face.annotation.outline_paths(positions, normals)
    corner_numbers = [36 - JAW_COUNT, 45 - JAW_COUNT]
    head_axes = face.bone_transforms()["cranium"][:3, :2]
    corner_heights = face.annotation.inner_points(positions)[corner_numbers] @ head_axes[:, 1]
    seen = camera.project(paths.reshape(-1, 3)).reshape(*paths.shape[:3], 2)
    left_in_picture, up_in_picture = (camera.rotation @ head_axes)[:2].T
    aside = left_in_picture / np.linalg.norm(left_in_picture)
    up = up_in_picture / np.linalg.norm(up_in_picture)
    across = np.array([-up[1], up[0]])
    across *= np.sign(across @ aside) or 1.0  # to the subject's left
    turn = np.linspace(0.0, 0.5 * np.pi, paths.shape[1])[:, None]
    halves = []
    for side, sign in enumerate((-1.0, 1.0)):
        outward = sign * across * np.cos(turn) - up * np.sin(turn)
        for _ in range(3):
            distances = (seen[side] * outward[:, None]).sum(axis=2)
            farthest = distances.argmax(axis=1)
            line = _smoothed(paths[side, np.arange(len(farthest)), farthest])
            outward = _normals(camera.project(line), outward)
        line = _part_below(line, line @ head_axes[:, 1], float(corner_heights[side]))
        halves.append(_spread(line, camera.project(line), JAW_COUNT // 2 + 1))
    right, left = halves
    return np.vstack([right, left[-2::-1]])


def _normals(pixels: Floats64, outward: Floats64) -> Floats64:
    """Return unit normals of a line in the picture, (n, 2), on the side of `outward`, (n, 2)."""
    along = unit_vectors(np.gradient(pixels, axis=0))
    normals = along @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    return np.asarray(normals * np.sign((normals * outward).sum(axis=1, keepdims=True)))


def _smoothed(points: Floats64) -> Floats64:
    """Smooth the points of a line, (n, 3), against steps at the root of an ear; the ends stay."""
    line = points
    for _ in range(3):
        line = line.copy()
        line[1:-1] = 0.25 * line[:-2] + 0.5 * line[1:-1] + 0.25 * line[2:]
    return line


def _part_below(points: Floats64, heights: Floats64, top: float) -> Floats64:
    """Return the part of a line, (n, 3), below a height; all of it if it begins below."""
    first = int((heights < top).argmax())
    if first == 0:
        return points
    fraction = (heights[first - 1] - top) / (heights[first - 1] - heights[first])
    start = points[first - 1] + fraction * (points[first] - points[first - 1])
    return np.vstack([start, points[first:]])


def _spread(points: Floats64, pixels: Floats64, count: int) -> Floats64:
    """Return points of a line, (n, 3), evenly spaced in the picture, shape (count, 3)."""
    return evenly_spaced(points, arc_lengths(pixels), count)


def _pupils(face: Face) -> Floats64:
    """Return the positions of the pupils [mm], shape (2, 3)."""
    bones = face.bone_transforms()
    pupils = []
    for side in EYE_SIDES:
        bone = f"eye_{side}"
        ball = next(part for part in face.head.parts if part.bone == bone)
        front = ball.vertices[ball.vertices[:, 2].argmax()]
        pupils.append(moved_points(bones[bone], front))
    return np.array(pupils)


def _is_uncovered_by_skin(skin: Floats64, points: Floats64, camera: CameraLabels) -> Flags:
    """Return which points (n, 3) see the camera past the outer side of the skin, (n,).

    Depths cannot show whether a pupil is behind a lid: in small pictures, a pixel is wider than a
    lid is thick. skin: its triangles, (F, 3, 3).
    """
    eye = -camera.rotation.T @ camera.translation
    is_free = []
    for point in points:
        volume, u, v, t = crossings(point, eye - point, skin)
        # A line from a pupil to the camera leaves the head through the skin's inner side.
        is_met = (volume < 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)
        is_free.append(not is_met.any())
    return np.array(is_free)


def _is_on_surface(
    points: Floats64, tolerance: Floats64, camera: CameraLabels, depth: Floats32
) -> Flags:
    """Return which points (n, 3) are within `tolerance` [mm] of a surface in the picture, (n,).

    The nearest surface is searched in all pixels up to the largest tolerance away, because lids,
    lips and wings of the nose bend away from the camera at their edges.
    """
    middles = camera.project(points)
    seen_points = camera.to_camera(points)
    focal = camera.intrinsics[0, 0]
    reach = int(np.ceil(tolerance.max() * focal / seen_points[:, 2].min()))
    steps = np.arange(-reach, reach + 1)
    around = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    pixels = np.floor(middles)[:, None] + 0.5 + around
    depths, is_inside = _values_at(pixels.reshape(-1, 2), depth)
    surface = camera.from_picture(pixels.reshape(-1, 2), depths).reshape(*pixels.shape[:2], 3)
    distances = np.linalg.norm(surface - seen_points[:, None], axis=2)
    # Background has the depth 0.
    is_surface = (is_inside & (depths > 0.0)).reshape(distances.shape)
    nearest = np.where(is_surface, distances, np.inf).min(axis=1)
    # The surface may come nearer by a pixel's width within a pixel.
    tolerance = np.maximum(tolerance, seen_points[:, 2] / focal)
    return np.asarray(_values_at(middles, depth)[1] & (nearest <= tolerance))


def _is_uncovered(points: Floats64, camera: CameraLabels, depth: Floats32) -> Flags:
    """Return which points of an outline, (n, 3), are in the picture and not hidden, as by hair.

    A point is free if the depth is large enough at the point, or 3 mm outside of the outline: a
    pixel inside the outline may show skin that is much nearer.
    """
    pixels = camera.project(points)
    depths = camera.to_camera(points)[:, 2]
    outward = _normals(pixels, pixels - pixels.mean(axis=0))
    beside = 3.0 * camera.intrinsics[0, 0] / depths[:, None]  # [pixels] of 3 mm
    steep = 6.0  # [mm] of depth by which the skin may bend away within a pixel
    is_free = np.zeros(len(points), dtype=np.bool_)
    for points_beside in (pixels, pixels + np.maximum(beside, 1.0) * outward):
        seen, is_inside = _values_at(points_beside, depth)
        is_free |= is_inside & ((seen == 0.0) | (seen >= depths - steep))
    return np.asarray(is_free & _values_at(pixels, depth)[1])


def _values_at(pixels: Floats64, image: Floats32 | Flags) -> tuple[Floats64, Flags]:
    """Return the values of an image (H, W) at pixels (n, 2), and which pixels lie in it."""
    height, width = image.shape
    columns, rows = np.floor(pixels).astype(int).T
    is_inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    values = image[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    return values.astype(np.float64), is_inside


def _is_covered(pixels: Floats64, covered: Flags | None) -> Flags:
    """Return which pixels (n, 2) are covered; covered: flags of all pixels, (H, W)."""
    if covered is None:
        return np.zeros(len(pixels), dtype=np.bool_)
    return _values_at(pixels, covered)[0] > 0.0
