"""Find the person that is most similar to a mesh, by few known landmarks and the mesh's surface.

A person is the built-in head plus a weighted sum of modes. The weights are solved for together with
a similarity of the mesh. Least squares minimise three errors:

- distances of the known landmarks, with a large weight
- distances of the skin around all landmarks from tangent planes of the mesh
- the weights, which are 0 for the built-in head

Source: Amberg, Knothe, Vetter 2008, "Expression invariant 3D face recognition with a morphable
model", section 3 (modes fitted by nearest points, with a prior). Here the planes have the normals
of the person instead, and there are no expressions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ...geometry.arrays import Floats64, Integers32
from ...geometry.normals import vertex_normals
from ..data_files import read_arrays
from ..model import Head
from .warp import Similarity, nearest_on

FARTHEST_MATCH = 18.0  # [mm] between a vertex of the person and the nearest point of the mesh


@dataclass
class LikelyFace:
    """A person that is fitted to a mesh.

    head: the built-in head, which has the topology of all persons.
    mesh: vertices of the mesh in the person's space [mm], (V, 3).
    faces: triangles of the mesh's skin, (F, 3).
    indices: indices of the n known landmarks.
    given: points of the known landmarks [mm], (n, 3).
    skin: indices of the person's vertices that are fitted to the mesh, (m,).
    moved: all motion of the mesh so far.
    """

    head: Head
    mesh: Floats64
    faces: Integers32
    indices: list[int]
    given: Floats64
    skin: Integers32

    def __post_init__(self) -> None:
        modes = read_arrays(self.head.file_beside("_modes.npz"))["modes"]
        self._modes = modes.astype(np.float64)
        self._weights = np.zeros(len(self._modes))
        self.moved = Similarity(1.0, np.eye(3), np.zeros(3))

    @property
    def vertices(self) -> Floats64:
        """The vertices of the person [mm], (V, 3)."""
        return self.head.vertices + np.tensordot(self._weights, self._modes, 1)

    def fit(self) -> None:
        """Fit the person, in the first steps only by the known landmarks."""
        few_steps = 3
        steps = 8  # a further step would move the median guess by less than 0.1 mm
        for step in range(steps):
            self._step(has_surface=step >= few_steps)

    def _step(self, *, has_surface: bool) -> None:
        """Solve once for the weights and a small motion of the mesh: shift, rotation and scale."""
        vertices = self.vertices
        count = len(self._modes)
        known = self.head.landmarks[self.indices]
        pointing = 0.7  # [mm]; usual error of known landmarks
        displacements = self._modes[:, known].transpose(1, 2, 0).reshape(-1, count)
        rows = [np.hstack([displacements, -_motions(self.given)]) / pointing]
        right = [(self.given - vertices[known]).ravel() / pointing]
        rows.append(np.eye(count, count + 7))
        right.append(-self._weights)
        # Usual sizes of a motion in one step: shift [mm], rotation [rad], change of scale.
        reach = np.concatenate([np.full(3, 20.0), np.full(4, 0.1)])
        rows.append(np.eye(7, count + 7, count) / reach[:, None])
        right.append(np.zeros(7))
        if has_surface:
            planes, off = self._planes(vertices)
            rows.append(planes)
            right.append(off)
        found, *_ = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)
        self._weights = self._weights + found[:count]
        shift = found[count : count + 3]
        turn = found[count + 3 : -1]
        growth = found[-1]
        rotation = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
        self._move(Similarity(1.0 + float(growth), rotation, shift))

    def _planes(self, vertices: Floats64) -> tuple[Floats64, Floats64]:
        """Return equations for weights and motion: rows (n, modes + 7), and right sides (n,).

        They move the skin of the person onto planes at the nearest points of the mesh.
        """
        normals = vertex_normals(vertices, self.head.faces)[self.skin]
        points = vertices[self.skin]
        feet = nearest_on(points, normals, self.mesh, self.faces).interpolate(self.mesh)
        distance = np.linalg.norm(feet - points, axis=1)
        is_near = distance < FARTHEST_MATCH
        normals = normals[is_near]
        feet = feet[is_near]
        modes = self._modes[:, self.skin[is_near]]
        motions = _motions(feet).reshape(len(feet), 3, 7)
        by_weights = np.einsum("kni,ni->nk", modes, normals)
        by_motion = -np.einsum("nij,ni->nj", motions, normals)
        rows = np.hstack([by_weights, by_motion])
        off = np.einsum("ni,ni->n", feet - points[is_near], normals)
        doubtful = 6.0  # [mm]; points at greater distances count less
        weight = 1.0 / np.sqrt(1.0 + (distance[is_near] / doubtful) ** 2)
        rough = 2.5  # [mm]; usual distance between a face and the most similar person
        independent = 60.0  # effective number of points, because neighbours are correlated
        weight /= rough * np.sqrt(max(len(feet) / independent, 1.0))
        return weight[:, None] * rows, weight * off

    def _move(self, step: Similarity) -> None:
        """Move the mesh and the known landmarks."""
        self.mesh = step.points(self.mesh)
        self.given = step.points(self.given)
        before = self.moved
        self.moved = Similarity(
            step.scale * before.scale, step.rotation @ before.rotation, step.points(before.shift)
        )


def _motions(points: Floats64) -> Floats64:
    """Return the Jacobian (3 n, 7) of points (n, 3) by shift (3), rotation (3) and scale (1)."""
    x, y, z = points.T
    turns = np.zeros((len(points), 3, 3))  # point, moved coordinate, axis of rotation
    turns[:, 0, 1] = z
    turns[:, 0, 2] = -y
    turns[:, 1, 0] = -z
    turns[:, 1, 2] = x
    turns[:, 2, 0] = y
    turns[:, 2, 1] = -x
    shifts = np.broadcast_to(np.eye(3), turns.shape)
    growths = points[:, :, None]
    return np.concatenate([shifts, turns, growths], axis=2).reshape(-1, 7)
