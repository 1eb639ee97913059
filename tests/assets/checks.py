"""Questions that every head mesh must answer well: is it one clean, symmetric surface?"""

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

from risorius.assets.topology import Edge, Faces

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.int32]


def edge_faces(faces: Faces) -> dict[Edge, list[int]]:
    """Faces beside each undirected edge, in the order of the face list."""
    result: dict[Edge, list[int]] = {}
    for index, (a, b, c) in enumerate(faces.tolist()):
        for first, second in ((a, b), (b, c), (c, a)):
            result.setdefault((min(first, second), max(first, second)), []).append(index)
    return result


def is_manifold(faces: IndexArray) -> bool:
    """Whether every edge has one or two faces and its two faces run along it in opposite ways."""
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    has_no_repeat = len(np.unique(directed, axis=0)) == len(directed)
    return has_no_repeat and all(len(beside) <= 2 for beside in edge_faces(faces).values())


def component_count(faces: IndexArray) -> int:
    """Number of pieces that hang together by shared vertices."""
    used, corners = np.unique(faces, return_inverse=True)
    links = corners.reshape(-1, 3)[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = sparse.coo_array((np.ones(len(links)), links.T), shape=(len(used),) * 2)
    return int(csgraph.connected_components(graph, directed=False)[0])


def euler_characteristic(vertices: FloatArray, faces: IndexArray) -> int:
    """Vertices - edges + faces: 2 - boundary loops for a sphere with holes."""
    return len(vertices) - len(edge_faces(faces)) + len(faces)


def mirror_error(vertices: FloatArray, mirror: IndexArray) -> float:
    """Largest distance between a vertex' mirror image and the vertex that should lie there [mm]."""
    return float(np.abs(vertices * [-1.0, 1.0, 1.0] - vertices[mirror]).max())


def is_mirrored(faces: IndexArray, mirror: IndexArray) -> bool:
    """Whether the mirror image of every face is a face, turned over."""

    def normalised(triangles: IndexArray) -> set[tuple[int, ...]]:
        """Each triangle from its lowest vertex on."""
        start = triangles.argmin(axis=1)
        order = (start[:, None] + np.arange(3)) % 3
        return set(map(tuple, np.take_along_axis(triangles, order, axis=1).tolist()))

    return normalised(faces) == normalised(mirror[faces][:, ::-1])
