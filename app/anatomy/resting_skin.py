"""The skin at rest, measured near given points: heights, normals, and carriers of points."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from risorius.geometry.arrays import Floats64
from risorius.geometry.closest import closest_points
from risorius.geometry.directions import unit_vectors
from risorius.geometry.mesh_graph import path_lengths
from risorius.geometry.normals import vertex_normals

NEIGHBOUR_COUNT = 8  # number of vertices that determine the place of the skin


class RestingSkin:
    """The skin at rest, measured near given points.

    Skin that turns away, such as the inner side of lips, lids and nostrils, is left out.
    """

    def __init__(self, x: Floats64, faces: Any, bone: Floats64, middle: Floats64) -> None:
        """bone: depth of the bone below each vertex of x. middle: outward directions begin here."""
        self.x = x
        self._faces = faces
        self._bone = bone
        self._middle = middle
        self.normals = vertex_normals(x, faces)
        self._tree = scipy.spatial.cKDTree(x)

    def at(self, points: Floats64) -> tuple[Floats64, Floats64, Floats64]:
        """Return the heights of points (..., 3) above the skin, normals, and depths of the bone."""
        out = (points - self._middle) * (1.0, 0.25, 1.0)
        near, weight = self._nearest(points, out)
        weight /= weight.sum(axis=-1, keepdims=True)
        normals = self.normals[near]
        off = np.einsum("...kc,...kc->...k", points[..., None, :] - self.x[near], normals)
        normal = unit_vectors(np.einsum("...k,...kc->...c", weight, normals))
        height = (weight * off).sum(axis=-1)
        bone_depth = (weight * self._bone[near]).sum(axis=-1)
        return height, normal, bone_depth

    def heights(self, points: Floats64, out: Floats64) -> Floats64:
        """Return the heights of points above the nearest triangles.

        points: sections of b bands with r rows of s points, (b, r, s, 3).
        out: outward directions of the bands, (b, r, 3), which the triangles face.
        """
        facing = np.broadcast_to(out[:, :, None], points.shape).reshape(-1, 3)
        other_side = 20.0  # [mm] added to the distance of a triangle that faces the other way
        flat = points.reshape(-1, 3)
        near = closest_points(flat, self.x, self._faces, facing, other_side)
        off = flat - near.interpolate(self.x)
        height: Floats64 = np.einsum("nc,nc->n", off, unit_vectors(near.interpolate(self.normals)))
        return height.reshape(points.shape[:-1])

    def _nearest(
        self, points: Floats64, out: Floats64, count: int = NEIGHBOUR_COUNT, reach: float = 0.35
    ) -> tuple[Any, Floats64]:
        """Return the `count` vertices nearest to points, and their weights, (..., count) each."""
        away, near = self._tree.query(points, k=count)
        is_faced = np.einsum("...kc,...c->...k", self.normals[near], out) > 0.0
        scale = reach * np.maximum(away[..., NEIGHBOUR_COUNT - 1 : NEIGHBOUR_COUNT] ** 2, 1e-30)
        return near, 1e-9 + is_faced * np.exp(-(away**2) / scale)

    def carriers(self, points: Floats64, out: Floats64) -> Any:
        """Return weights of vertices that carry the skin over bands, a sparse matrix (n, V).

        points, out: places and outward directions over edges and middles, (3, b, r, 3).

        Where the mouth is closed, both lips have vertices near a point. A vertex carries a point
        only if the path along the skin from the band's middle is not much longer than the straight
        line.
        """
        near, weight = self._nearest(points, out, 3 * NEIGHBOUR_COUNT, 1.0)
        first = np.take_along_axis(near[1], weight[1].argmax(axis=-1)[..., None], -1)
        starts, number = np.unique(first, return_inverse=True)
        path_length = path_lengths(self.x, self._faces, starts)
        straight = np.linalg.norm(self.x[near] - self.x[first], axis=-1)
        weight *= path_length[number.reshape(first.shape), near] <= 1.5 * straight + 1e-9
        alone = weight.sum(axis=-1, keepdims=True) == 0.0
        near = np.concatenate([near, np.broadcast_to(first, alone.shape)], axis=-1)
        weight = np.concatenate([weight, alone], axis=-1)
        weight /= weight.sum(axis=-1, keepdims=True)
        rows = np.repeat(np.arange(alone.size), near.shape[-1])
        place = rows, near.ravel()
        return scipy.sparse.coo_array((weight.ravel(), place), (alone.size, len(self.x))).tocsr()
