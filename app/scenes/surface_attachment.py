"""Parts attached to a surface: lashes, and the tears along the lids, which move with the skin.

Each root keeps its place over the triangle that was nearest to it at rest. What stands on it turns
as the skin there does: with the normal, which is smooth over triangles, and with one direction in
the triangle.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from risorius.assets.fitting.warp import nearest_on
from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from risorius.geometry.read_only import read_only


class SurfaceAttachment:
    """A part that changes its shape with the skin; drawn as any other (render/parts.py)."""

    is_enclosed = True
    striation = None
    vertices: Floats32
    normals: Floats32

    def __init__(self, part: Any, skin: Floats64, faces: Integers32) -> None:
        """A part with `roots`, as it stands on the skin at rest, (V, 3) with triangles (F, 3)."""
        self.name = part.name
        self.bone = part.bone
        self.faces = part.faces
        self.colours = part.colours
        self.shine = part.shine
        self.strand_radius = part.strand_radius
        rest = part.vertices.astype(np.float64)
        normals = part.normals.astype(np.float64)
        roots, self._row = np.unique(part.roots, return_inverse=True)  # a vertex's among roots
        # What stands there points out of the skin; what lies there has the skin's normal.
        ahead = np.zeros((len(roots), 3))
        np.add.at(ahead, self._row, rest - rest[roots][self._row] + 1e-3 * normals)
        feet = nearest_on(rest[roots], unit_vectors(ahead), skin, faces)
        is_around = np.isin(faces, feet.corners).any(axis=1)
        self._near, around = np.unique(faces[is_around], return_inverse=True)  # vertices of skin
        self._around = around.reshape(-1, 3).astype(np.int32)  # triangles among them
        corners = np.searchsorted(self._near, feet.corners).astype(np.int32)
        self._feet = replace(feet, corners=corners)
        # (R, 3) of a direction in the triangle of each root: what each corner adds to it.
        self._across = _along_x(skin[self._near][corners])
        places, frames = self._frames(skin[self._near])
        # (n, 3) from the foot of the root, in its frame at rest.
        self._local = np.einsum("nji,nj->ni", frames[self._row], rest - places[self._row])
        self._local_normals = np.einsum("nji,nj->ni", frames[self._row], normals)
        self.vertices = part.vertices
        self.normals = part.normals

    def follow(self, skin: Floats64, bone: Floats64) -> None:
        """Stand on the skin as it is now, (V, 3), seen from the part's bone, a matrix (4, 4)."""
        there = (skin[self._near] - bone[:3, 3]) @ np.linalg.inv(bone[:3, :3]).T
        places, frames = self._frames(there)
        turned = np.einsum("nij,nj->ni", frames[self._row], self._local)
        self.vertices = read_only((places[self._row] + turned).astype(np.float32))
        normals = np.einsum("nij,nj->ni", frames[self._row], self._local_normals)
        self.normals = read_only(normals.astype(np.float32))

    def _frames(self, skin: Floats64) -> tuple[Floats64, Floats64]:
        """Feet of the roots, (R, 3), and right-handed unit axes there, (R, 3, 3), in columns."""
        normal = self._feet.interpolate(vertex_normals(skin, self._around))
        along = np.einsum("rc,rci->ri", self._across, skin[self._feet.corners])
        beside = unit_vectors(np.cross(normal, along))
        outward = unit_vectors(normal)
        axes = np.stack([np.cross(beside, outward), beside, outward], axis=2)
        return self._feet.interpolate(skin), axes


def _along_x(corners: Floats64) -> Floats64:
    """The weights of triangles' corners (R, 3, 3) in the x axis of their frames, (R, 3)."""
    first = corners[:, 1] - corners[:, 0]
    second = corners[:, 2] - corners[:, 0]
    edges = np.stack([first, second], axis=2)
    shares = np.linalg.pinv(edges)[:, :, 0]
    return np.column_stack([-shares.sum(axis=1), shares])
