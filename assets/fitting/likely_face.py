"""The person of the program's own space most similar to a face with few known points.

The person's shape and the place of the mesh are fitted together, to three kinds of data:
the known points, with a large weight; distances of the skin around the landmarks from the planes of
the mesh's surface; and the weights of modes, which are 0 for the built-in head.

Source: Amberg, Knothe, Vetter 2008, "Expression invariant 3D face recognition with a morphable
model", section 3 (modes fitted by nearest points, with a prior).
Differs from it: the planes are those of the person, and there are no expressions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ...geometry.arrays import Floats64, Integers32
from ..data_files import read_arrays
from ..model import Head
from .warp import Similarity, nearest_on

FARTHEST_MATCH = 18.0  # [mm]: a point of a face finds no place farther off on a mesh


@dataclass
class LikelyFace:
    """A person who is fitted to a mesh.

    head: the one with the person's topology. mesh: vertices of the mesh in the person's space [mm],
        (V, 3).
    faces: those of the mesh's skin. numbers: known landmarks. given: their places [mm].
    skin: vertices of the person that are laid on the mesh.
    """

    head: Head
    mesh: Floats64
    faces: Integers32
    numbers: list[int]
    given: Floats64
    skin: Integers32

    def __post_init__(self) -> None:
        modes = read_arrays(self.head.beside("_modes.npz"))["modes"]
        self._modes = modes.astype(np.float64)
        self._weights = np.zeros(len(self._modes))
        self.moved = Similarity(1.0, np.eye(3), np.zeros(3))  # its motion since the beginning

    @property
    def vertices(self) -> Floats64:
        """The vertices of the person [mm]."""
        return self.head.vertices + np.tensordot(self._weights, self._modes, 1)

    def fit(self) -> None:
        """Fit it, first by the known points alone."""
        few_steps = 3
        steps = 8  # afterwards a median guess moves by less than 0.1 mm
        for step in range(steps):
            self._step(has_surface=step >= few_steps)

    def _step(self, *, has_surface: bool) -> None:
        """Solve once for weights, and for a small motion of the mesh: shift, turn, growth."""
        vertices = self.vertices
        count = len(self._modes)
        known = self.head.landmarks[self.numbers]
        pointing = 0.7  # [mm] of error in known points
        ways = self._modes[:, known].transpose(1, 2, 0).reshape(-1, count)
        rows = [np.hstack([ways, -_motions(self.given)]) / pointing]
        right = [(self.given - vertices[known]).ravel() / pointing]
        rows.append(np.eye(count, count + 7))
        right.append(-self._weights)
        # Of one step: [mm], [radians], share.
        reach = np.concatenate([np.full(3, 20.0), np.full(4, 0.1)])
        rows.append(np.eye(7, count + 7, count) / reach[:, None])
        right.append(np.zeros(7))
        if has_surface:
            planes, off = self._planes(vertices)
            rows.append(planes)
            right.append(off)
        found = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]
        self._weights = self._weights + found[:count]
        shift, turn, growth = found[count : count + 3], found[count + 3 : -1], found[-1]
        rotation = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
        self._move(Similarity(1.0 + float(growth), rotation, shift))

    def _planes(self, vertices: Floats64) -> tuple[Floats64, Floats64]:
        """Equations that bring skin to planes at the nearest places of the mesh."""
        normals = vertex_normals(vertices, self.head.faces)[self.skin]
        points = vertices[self.skin]
        feet = nearest_on(points, normals, self.mesh, self.faces).interpolate(self.mesh)
        distance = np.linalg.norm(feet - points, axis=1)
        is_near = distance < FARTHEST_MATCH
        normals = normals[is_near]
        feet = feet[is_near]
        motions = _motions(feet).reshape(len(feet), 3, 7)
        rows = np.hstack(
            [
                np.einsum("kni,ni->nk", self._modes[:, self.skin[is_near]], normals),
                -np.einsum("nij,ni->nj", motions, normals),
            ]
        )
        off = np.einsum("ni,ni->n", feet - points[is_near], normals)
        doubtful = 6.0  # [mm] of distance at which a place counts less
        weight = 1.0 / np.sqrt(1.0 + (distance[is_near] / doubtful) ** 2)
        rough = 2.5  # [mm] between a face and the space of persons
        independent = 60.0  # places that count as independent; neighbours are alike
        weight /= rough * np.sqrt(max(len(feet) / independent, 1.0))
        return weight[:, None] * rows, weight * off

    def _move(self, step: Similarity) -> None:
        """Move the mesh."""
        self.mesh = step.points(self.mesh)
        self.given = step.points(self.given)
        before = self.moved
        self.moved = Similarity(
            step.scale * before.scale, step.rotation @ before.rotation, step.points(before.shift)
        )


def _motions(points: Floats64) -> Floats64:
    """How shift, turn and growth move points (n, 3), shape (3 n, 7)."""
    x, y, z = points.T
    none = np.zeros_like(x)
    turns = np.stack([none, z, -y, -z, none, x, y, -x, none], axis=1).reshape(-1, 3, 3)
    shifts = np.broadcast_to(np.eye(3), turns.shape)
    return np.concatenate([shifts, turns, points[:, :, None]], axis=2).reshape(-1, 7)
