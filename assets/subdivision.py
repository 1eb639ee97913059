"""Every triangle cut into four: the connectivity of the finer heads.

        c               New vertices lie on edges and are numbered behind the old ones, so that
       / \\              every old vertex keeps its number. The four children of face f are the
     ca---bc            faces 4 f to 4 f + 3: corner a, corner b, corner c, middle.
     / \\ / \\
    a---ab--b

Nothing of this needs to be stored: the data file of the finer heads holds the places of the new
vertices and normals only. Here, apart from `generator`, because loading must not need scipy.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

IndexArray = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Quartered:
    """A triangle list after one cut.

    faces: shape (4 F, 3), int32.
    edges: the ends of the edge that each new vertex lies on, lower number first, shape (E, 2).
    """

    faces: IndexArray
    edges: IndexArray


def quarter(faces: IndexArray, vertex_count: int) -> Quartered:
    """Cut every triangle into four; edge e gets the new vertex `vertex_count` + e."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, number = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    ab, bc, ca = vertex_count + number.reshape(-1, 3).T
    a, b, c = faces.T
    children = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1)
    return Quartered(children.reshape(-1, 3).astype(np.int32), edges.astype(np.int32))
