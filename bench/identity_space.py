"""The space of human faces that a reference folder holds: a mean and modes of one deviation each.

The folder is one of `bench reference`, with `identity_modes.npz` beside `face.npz`: the components
of ICT-FaceKit's identity on the same vertices, `modes` (k, V, 3) [cm], each at one standard
deviation of people.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.normals import vertex_normals

from .subjects import DENSE, MILLIMETRES, read_arrays

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int32]
Labels = npt.NDArray[np.str_]

MODES = "identity_modes.npz"
REGIONS = ("forehead", "eyes", "nose", "cheek", "mouth", "chin", "jaw")
OPPOSITE = 12.0  # [mm] on a line of sight within which skin hides a vertex
NEAR_TRIANGLES = 8  # that are asked at each millimetre on the way


@dataclass(frozen=True)
class IdentitySpace:
    """People as mean + weights @ modes, all [mm]."""

    mean: Points
    """Shape (V, 3)."""
    triangles: Faces
    landmarks: Faces
    """The 68, as vertex numbers."""
    modes: Points
    """Shape (k, V, 3); a weight of 1 is one standard deviation."""

    @classmethod
    def read(cls, folder: Path) -> IdentitySpace:
        """Read a folder. Raises ValueError, naming the file, where something in it is missing."""
        face = read_arrays(folder / DENSE, ("vertices", "triangles", "landmarks68"))
        if not (folder / MODES).is_file():
            raise ValueError(f"{folder / MODES}: is not there; it holds the modes of identity")
        modes = read_arrays(folder / MODES, ("modes",))["modes"]
        if modes.shape != (len(modes), *face["vertices"].shape):
            raise ValueError(f"{folder / MODES}: 'modes' must move each vertex of {DENSE}")
        return cls(
            MILLIMETRES * face["vertices"].astype(np.float64),
            face["triangles"].astype(np.int32),
            face["landmarks68"].astype(np.int32),
            MILLIMETRES * modes.astype(np.float64),
        )

    def person(self, weights: Points) -> Points:
        """The vertices of one person [mm], shape (V, 3)."""
        return np.asarray(self.mean + np.tensordot(weights, self.modes, 1), dtype=np.float64)

    def regions(self) -> Labels:
        """The name of the region that each vertex is in, "" for what is hidden or no face, (V,)."""
        x, y, z = self.mean.T
        marks, aside = self.mean[self.landmarks], np.abs(x)
        eyes, below_nose, below_mouth = marks[36:48, 1].mean(), marks[33, 1] - 6.0, marks[57, 1] - 4
        is_high = y > marks[17:27, 1].mean() + 8.0
        rules = {
            "forehead": is_high & (y < eyes + 75.0),
            "": is_high,
            "nose": (aside < 22.0) & (y > below_nose) & (y < marks[27, 1]),
            "eyes": (np.abs(y - eyes) < 18.0) & (aside < abs(marks[36, 0]) + 10.0),
            "mouth": (aside < 32.0) & (y > below_mouth) & (y <= below_nose),
            "chin": (aside < 30.0) & (y <= below_mouth),
            "jaw": y <= marks[60:68, 1].mean() + 5.0,
        }
        found = np.select(list(rules.values()), list(rules), "cheek")
        is_face = (z > marks[36, 2] - 45.0) & (y >= marks[8, 1] - 8.0)
        found[~is_face] = ""
        asked = np.flatnonzero(found != "").astype(np.int32)
        found[asked[hidden(self.mean, self.triangles, asked)]] = ""
        return found


def hidden(vertices: Points, triangles: Faces, asked: Faces) -> npt.NDArray[np.bool_]:
    """Which of some vertices look at skin: insides that another mesh need not have, (n,).

    Straight ahead, between lips; or in most of seven directions, as in nostrils.
    """
    normals = vertex_normals(vertices, triangles)[asked]
    aside = np.cross(normals, np.roll(normals, 1, axis=1))
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-9)
    across = np.cross(normals, aside)
    is_met = [_meets(vertices, triangles, asked, normals)]
    for angle in np.radians(np.arange(0.0, 360.0, 60.0)):
        slanted = normals + np.cos(angle) * aside + np.sin(angle) * across
        slanted /= np.linalg.norm(slanted, axis=1, keepdims=True)
        is_met.append(_meets(vertices, triangles, asked, slanted))
    return np.asarray(is_met[0] | (np.sum(is_met, axis=0) > len(is_met) / 2))


def _meets(vertices: Points, triangles: Faces, asked: Faces, ways: Points) -> npt.NDArray[np.bool_]:
    """Whether a ray from each asked vertex meets a triangle within OPPOSITE, (n,)."""
    corners, found = vertices[triangles], np.zeros(len(asked), dtype=bool)
    tree = scipy.spatial.cKDTree(corners.mean(axis=1))
    for way in np.arange(0.5, OPPOSITE, 1.0):
        near = tree.query(vertices[asked] + way * ways, k=NEAR_TRIANGLES)[1].ravel()
        ray = np.repeat(np.arange(len(asked)), NEAR_TRIANGLES)
        own = (triangles[near] == asked[ray, None]).any(axis=1)
        near, ray = near[~own], ray[~own]
        first = corners[near, 0]
        # first + u (second - first) + v (third - first) = vertex + t way
        system = np.stack([corners[near, 1] - first, corners[near, 2] - first, -ways[ray]], axis=2)
        is_flat = np.abs(np.linalg.det(system)) < 1e-9
        system[is_flat] = np.eye(3)
        to_vertex = (vertices[asked[ray]] - first)[:, :, None]
        u, v, t = np.linalg.solve(system, to_vertex)[:, :, 0].T
        meets = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0) & (t < OPPOSITE)
        found[ray[meets & ~is_flat]] = True
    return found
