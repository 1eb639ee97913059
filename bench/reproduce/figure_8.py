"""The paper's Fig. 8: long, thin subtriangles lie along the folds of skin.

A fold bends across its direction and hardly along it. So in a triangle, the fold's direction is
that of least curvature; it is computed from the change of normals along the triangle's edges. The
paper's claim holds if subtriangles are thinner than their triangles, and more closely aligned with
this direction. The measurements are printed below each picture.

Source: Kähler, Haber, Seidel 2003, section 5 and Fig. 8; Rusinkiewicz 2004, "Estimating curvatures
and their derivatives on triangle meshes", for the curvature of a triangle.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from risorius import refine, render
from risorius.app.capture.drawing import camera_for
from risorius.app.scenes import Scene, build_scene
from risorius.geometry.arrays import Flags, Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products

from ..canvas import FLAT_STYLE, GOURAUD_STYLE, Canvas, Drawing, image_table, parts_without_hair
from .experiments import Outcome


def outcome(size: tuple[int, int] = (380, 340)) -> Outcome:
    """Compare subtriangles with their triangles: the angle to the fold, and the smallest angle.

    Pictures show the mesh, the mesh refined by the paper's rule, and the folds.
    """
    scene = build_scene("face")
    scene.pose({"disgust": 1.0})
    settling_time = 1.5  # [s] after which the face stands still
    scene.step(settling_time)
    static, refined = (
        refine.create(name, scene.faces, scene.rest_positions) for name in ("none", "kahler")
    )
    before, after = measure(refined, scene.faces, scene.positions)
    values = {
        "degrees off the fold, refined": after.off_fold,
        "degrees nearer to the fold than before": before.off_fold - after.off_fold,
        "smallest angle, refined over static": after.smallest_angle / before.smallest_angle,
    }
    camera = camera_for(scene, "-30,-5,4.6")
    camera.pan(0.12, 0.05)
    wire_style = replace(FLAT_STYLE, wireframe=True, wire_opacity=0.55)
    wire = Drawing(camera, wire_style, parts_without_hair(scene), scene.bone_transforms())
    red = (0.85, 0.1, 0.1)
    along = render.Lines(lines_along(scene), red, width=2.0, hidden_opacity=0.0)
    with Canvas(size) as canvas:
        cells = [
            (title, canvas.draw_image(refiner, scene.positions, drawing))
            for title, refiner, drawing in (
                (str(before), static, wire),
                (str(after), refined, wire),
                ("where folds run", static, replace(wire, style=GOURAUD_STYLE, lines=along)),
            )
        ]
    return Outcome(values, image_table([("the face, disgusted", cells)]))


def lines_along(scene: Scene) -> list[Floats64]:
    """For each triangle in a fold, a short line along the fold, slightly above the surface."""
    corners = scene.positions[scene.faces]
    directions, is_fold = find_folds(scene.faces, scene.positions)
    normals = cross_products(scene.positions, scene.faces)
    unit = float(np.sqrt(np.median(np.linalg.norm(normals, axis=1))))
    normals = unit_vectors(normals)
    lift = 0.1  # height of lines over the surface, in mean edge lengths
    centroids = corners.mean(axis=1) + lift * unit * normals
    line_length = 0.5  # in mean edge lengths
    half = 0.5 * line_length * unit * directions
    return list(np.stack([centroids - half, centroids + half], axis=1)[is_fold])


class Shapes(NamedTuple):
    """Means over triangles in folds, weighted by area."""

    smallest_angle: float  # [degrees]
    off_fold: float  # [degrees] from the long axis to the fold; 45 for random directions

    def __str__(self) -> str:
        return f"smallest angle {self.smallest_angle:.0f}°, {self.off_fold:.0f}° off the fold"


def measure(
    refiner: refine.Refiner, faces: Integers32, positions: Floats64
) -> tuple[Shapes, Shapes]:
    """Measure the split triangles in folds, and the subtriangles that replace them.

    This refines `positions` (V, 3) again.
    """
    mesh = refiner.refine(positions)
    directions, is_fold = find_folds(faces, positions)
    is_fold &= refiner.splits[refiner.triangle_edges].any(axis=1)
    before = _shapes(positions[faces[is_fold]], directions[is_fold])
    is_part = is_fold[mesh.source]
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    return before, _shapes(corners[is_part], directions[mesh.source[is_part]])


def find_folds(faces: Integers32, positions: Floats64) -> tuple[Floats64, Flags]:
    """Direction of least curvature of each triangle (F, 3), and flags of triangles in folds."""
    static = refine.create("none", faces, positions).refine(positions)
    corners = static.positions.astype(np.float64)[static.triangles]
    normals = static.normals.astype(np.float64)[static.triangles]
    edges = np.roll(corners, -1, axis=1) - corners
    turns = np.roll(normals, -1, axis=1) - normals
    first_edge = edges[:, 0]
    across = np.cross(first_edge, edges[:, 1])
    areas = np.linalg.norm(across, axis=1) / 2.0
    axes = np.stack([first_edge, np.cross(across, first_edge)], axis=2)  # in the triangle's plane
    lengths = np.linalg.norm(axes, axis=1, keepdims=True)
    axes /= np.maximum(lengths, 1e-12)
    curvatures = _fitted_curvatures(edges @ axes, turns @ axes)
    values, vectors = np.linalg.eigh(curvatures)
    sizes = np.abs(values)
    triangle = np.arange(len(faces))
    least = vectors[triangle, :, sizes.argmin(axis=1)]
    directions = np.einsum("fki,fi->fk", axes, least)
    low = sizes.min(axis=1)
    high = sizes.max(axis=1)
    bent_angle = 0.2  # [rad] least turn of the normal across a triangle in a fold
    is_bent = high * np.sqrt(2.0 * areas) > bent_angle
    # Largest ratio of least to greatest curvature; a triangle with a larger ratio lies on a dome.
    along_fraction = 0.4
    is_straight = low < along_fraction * high
    return directions, is_bent & is_straight


def _fitted_curvatures(edges: Floats64, turns: Floats64) -> Floats64:
    """Fit each triangle's curvature matrix by least squares: symmetric, shape (F, 2, 2).

    With curvature (a b, b c), the normal changes by (a u + b v, b u + c v) along an edge (u, v).
    edges, turns: edges and changes of normals in the triangle's plane, shape (F, 3, 2).
    """
    u = edges[:, :, 0]
    v = edges[:, :, 1]
    zero = np.zeros(u.shape)
    rows_of_u = np.stack([u, v, zero], axis=2)
    rows_of_v = np.stack([zero, u, v], axis=2)
    rows = np.concatenate([rows_of_u, rows_of_v], axis=1)
    wanted = np.concatenate([turns[:, :, 0], turns[:, :, 1]], axis=1)
    a, b, c = np.einsum("fij,fj->if", np.linalg.pinv(rows), wanted)
    first_row = np.stack([a, b], axis=1)
    second_row = np.stack([b, c], axis=1)
    return np.stack([first_row, second_row], axis=1)


def _shapes(corners: Floats64, directions: Floats64) -> Shapes:
    """Measure triangles with corners (n, 3, 3) against the fold directions (n, 3)."""
    edges = np.roll(corners, -1, axis=1) - corners
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    units = unit_vectors(edges)
    before = np.roll(units, 1, axis=1)
    cosines = -(units * before).sum(axis=2)
    angles = np.arccos(np.clip(cosines, -1.0, 1.0))
    smallest = np.average(angles.min(axis=1), weights=areas)
    centroids = corners.mean(axis=1, keepdims=True)
    _, _, axes = np.linalg.svd(corners - centroids)
    along_fold = np.abs((axes[:, 0] * directions).sum(axis=1))
    off_angles = np.arccos(np.clip(along_fold, 0.0, 1.0))
    off_fold = np.average(off_angles, weights=areas)
    return Shapes(float(np.degrees(smallest)), float(np.degrees(off_fold)))
