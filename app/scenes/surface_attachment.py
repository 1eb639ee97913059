"""Parts attached to a surface: lashes, and the tears along the lids, which move with the skin.

Each root keeps its place over the triangle that was nearest to it at rest. What stands on it turns
as the skin there does: with the normal, which is smooth over triangles, and with one direction in
the triangle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.assets.fitting.warp import nearest_on
from risorius.geometry.closest import SurfacePoints
from risorius.geometry.normals import vertex_normals

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int32]


@dataclass(eq=False)
class SurfaceAttachment:
    """A part that changes its shape with the skin; drawn as any other (render/parts.py)."""

    name: str
    vertices: Singles
    normals: Singles
    faces: Indices
    colours: Singles
    bone: str
    shine: float
    strand_radius: float
    near: npt.NDArray[np.int64]  # numbers of the skin's vertices around the roots, (P,)
    around: Indices  # the triangles among them, (Q, 3)
    feet: SurfacePoints  # of the roots, (R,)
    row: npt.NDArray[np.int64]  # of each vertex, the number of its root among them, (n,)
    across: Floats  # (R, 3) of a direction in the triangle: what each corner adds to it
    local: Floats  # (n, 3) from the foot of the root, in its frame at rest
    local_normals: Floats
    is_enclosed: bool = True
    striation: None = None

    @classmethod
    def of(cls, part: Any, skin: Floats, faces: Indices) -> SurfaceAttachment:
        """A part with `roots`, as it stands on the skin at rest, (V, 3) with triangles (F, 3)."""
        rest, normals = part.vertices.astype(np.float64), part.normals.astype(np.float64)
        roots, row = np.unique(part.roots, return_inverse=True)
        # What stands there points out of the skin; what lies there has the skin's normal.
        ahead = np.zeros((len(roots), 3))
        np.add.at(ahead, row, rest - rest[roots][row] + 1e-3 * normals)
        feet = nearest_on(rest[roots], _unit(ahead), skin, faces)
        is_around = np.isin(faces, feet.corners).any(axis=1)
        near, around = np.unique(faces[is_around], return_inverse=True)
        feet = replace(feet, corners=np.searchsorted(near, feet.corners).astype(np.int32))
        attached = cls(
            part.name, part.vertices, part.normals, part.faces, part.colours, part.bone,
            part.shine, part.strand_radius, near.astype(np.int64),
            around.reshape(-1, 3).astype(np.int32),
            feet, row, _along_x(skin[near][feet.corners]), rest, normals,
        )  # fmt: skip
        places, frames = attached._frames(skin[near])
        attached.local = np.einsum("nji,nj->ni", frames[row], rest - places[row])
        attached.local_normals = np.einsum("nji,nj->ni", frames[row], normals)
        return attached

    def follow(self, skin: Floats, bone: Floats) -> None:
        """Stand on the skin as it is now, (V, 3), told from the part's bone, a matrix (4, 4)."""
        there = (skin[self.near] - bone[:3, 3]) @ np.linalg.inv(bone[:3, :3]).T
        places, frames = self._frames(there)
        turned = np.einsum("nij,nj->ni", frames[self.row], self.local)
        self.vertices = (places[self.row] + turned).astype(np.float32)
        normals = np.einsum("nij,nj->ni", frames[self.row], self.local_normals)
        self.normals = normals.astype(np.float32)

    def _frames(self, skin: Floats) -> tuple[Floats, Floats]:
        """Feet of the roots, (R, 3), and right-handed unit axes there, (R, 3, 3), in columns."""
        normal = self.feet.interpolate(vertex_normals(skin, self.around))
        along = np.einsum("rc,rci->ri", self.across, skin[self.feet.corners])
        beside = _unit(np.cross(normal, along))
        axes = np.stack([np.cross(beside, _unit(normal)), beside, _unit(normal)], axis=2)
        return self.feet.interpolate(skin), axes


def _along_x(corners: Floats) -> Floats:
    """What the corners of triangles (R, 3, 3) add to the x axis as it lies in them, (R, 3)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    edges = np.stack([first, second], axis=2)
    shares = np.linalg.pinv(edges)[:, :, 0]
    return np.column_stack([-shares.sum(axis=1), shares])


def _unit(vectors: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, 1e-12))
