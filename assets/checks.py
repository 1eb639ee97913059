"""Questions that every head mesh must answer well: is it one clean, symmetric surface?

Used by `assets.report` and by the tests. Plain arrays in, numbers out.
"""

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from .topology import cross_products, edge_faces

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.int32]
INSIDE = 1e-6  # relative; touching at a corner or an edge does not count as intersecting


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


def fold_angles(vertices: FloatArray, faces: IndexArray) -> FloatArray:
    """Angle between the normals of the two faces beside each inner edge [deg]."""
    cross = cross_products(vertices, faces)
    normal = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    pairs = np.array([beside for beside in edge_faces(faces).values() if len(beside) == 2])
    cosine = (normal[pairs[:, 0]] * normal[pairs[:, 1]]).sum(axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))), dtype=np.float64)


def self_intersections(vertices: FloatArray, faces: IndexArray) -> IndexArray:
    """Pairs of faces without a common vertex that cut through each other, shape (k, 2)."""
    corner = vertices[faces]
    pairs = _near_pairs(corner)
    first, second = pairs[:, 0], pairs[:, 1]
    apart = (faces[first][:, :, None] != faces[second][:, None, :]).all(axis=(1, 2))
    pairs = pairs[apart]
    hit = np.zeros(len(pairs), dtype=bool)
    for one, other in ((0, 1), (1, 0)):
        for k in range(3):
            start = corner[pairs[:, one], k]
            end = corner[pairs[:, one], (k + 1) % 3]
            hit |= _segment_cuts(start, end, corner[pairs[:, other]])
    cutting: IndexArray = pairs[hit].astype(np.int32)
    return cutting


def _near_pairs(corner: FloatArray) -> npt.NDArray[np.int64]:
    """Pairs of triangles whose surrounding balls meet, each pair once, shape (k, 2).

    By classes of size, so that a few large triangles do not make all small ones look far around.
    """
    centre = corner.mean(axis=1)
    radius = np.linalg.norm(corner - centre[:, None], axis=2).max(axis=1)
    size = np.floor(np.log2(np.maximum(radius, 1e-6)))
    classes = [np.flatnonzero(size == value) for value in np.unique(size)]
    trees = [cKDTree(centre[members]) for members in classes]
    found = []
    for i, members in enumerate(classes):
        for j in range(i + 1):
            reach = float(radius[members].max() + radius[classes[j]].max())
            near = trees[i].sparse_distance_matrix(trees[j], reach, output_type="coo_matrix")
            found.append(np.stack([members[near.row], classes[j][near.col]], axis=1))
            if i == j:
                found[-1] = found[-1][found[-1][:, 0] < found[-1][:, 1]]
    pairs = np.concatenate(found)
    distance = np.linalg.norm(centre[pairs[:, 0]] - centre[pairs[:, 1]], axis=1)
    meeting: npt.NDArray[np.int64] = pairs[distance < radius[pairs].sum(axis=1)]
    return meeting


def _segment_cuts(
    start: FloatArray, end: FloatArray, triangle: FloatArray
) -> npt.NDArray[np.bool_]:
    """Möller and Trumbore 1997, row by row."""
    direction = end - start
    edge_u, edge_v = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    p = np.cross(direction, edge_v)
    determinant = (edge_u * p).sum(axis=1)
    is_parallel = np.abs(determinant) < 1e-12
    inverse = 1.0 / np.where(is_parallel, 1.0, determinant)
    offset = start - triangle[:, 0]
    u = (offset * p).sum(axis=1) * inverse
    q = np.cross(offset, edge_u)
    v = (direction * q).sum(axis=1) * inverse
    along = (edge_v * q).sum(axis=1) * inverse
    in_triangle = (u > INSIDE) & (v > INSIDE) & (u + v < 1 - INSIDE)
    return np.asarray(in_triangle & (along > INSIDE) & (along < 1 - INSIDE) & ~is_parallel)
