"""Curved triangles for comparison: uniform PN triangles and Phong tessellation.

Both make a patch of every triangle from the positions and normals of its corners alone. Plain
numpy, not made for speed.

- Vlachos, Peters, Boyd, Mitchell 2001, "Curved PN triangles": a cubic patch through the corners,
  ten control points; normals interpolated quadratically.
- Boubekeur, Alexa 2008, "Phong tessellation": a flat point is dropped onto the tangent planes of
  the corners, and moved FULLNESS of the way to the mean of the three; normals interpolated
  linearly.
"""

import numpy as np
import numpy.typing as npt

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


FULLNESS = 0.75
"""Of Phong tessellation, as its authors propose."""


def pn_triangles(
    positions: Doubles, normals: Doubles, faces: npt.NDArray[np.integer], pieces: int
) -> tuple[Doubles, Doubles, Integers]:
    """Cut every edge into `pieces`: positions, normals and the pieces^2 F triangles.

    `positions`, `normals`: shape (V, 3); `faces`: shape (F, 3). Points on edges come once for each
    triangle, at the same place.
    """
    places, small = _grid(pieces)
    corners, at_corner = positions[faces], normals[faces]
    u, v, w = places.T
    points = np.zeros((len(faces), len(places), 3))
    turned = np.zeros_like(points)
    powers = np.stack([u, v, w])
    middle = np.zeros((len(faces), 3))
    for i in range(3):
        j = (i + 1) % 3
        near = _edge_control(corners[:, i], corners[:, j], at_corner[:, i])
        far = _edge_control(corners[:, j], corners[:, i], at_corner[:, j])
        a, b = powers[i], powers[j]
        points += _spread(a**3, corners[:, i])
        points += _spread(3 * a * a * b, near) + _spread(3 * a * b * b, far)
        middle += (near + far) / 4.0 - corners[:, i] / 6.0
        turned += _spread(a * a, at_corner[:, i])
        turned += _spread(a * b, _edge_normal(corners[:, i], corners[:, j], at_corner, i, j))
    points += _spread(6 * u * v * w, middle)
    return _joined(points, turned, small)


def phong_triangles(
    positions: Doubles, normals: Doubles, faces: npt.NDArray[np.integer], pieces: int
) -> tuple[Doubles, Doubles, Integers]:
    """Cut every edge into `pieces`, as `pn_triangles` does."""
    places, small = _grid(pieces)
    corners, at_corner = positions[faces], normals[faces]
    flat = np.einsum("pk,fki->fpi", places, corners)
    above = np.einsum("fpki,fki->fpk", flat[:, :, None] - corners[:, None], at_corner)
    dropped = np.einsum("pk,fpk,fki->fpi", places, above, at_corner)
    turned = np.einsum("pk,fki->fpi", places, at_corner)
    return _joined(flat - FULLNESS * dropped, turned, small)


def _joined(points: Doubles, turned: Doubles, small: Integers) -> tuple[Doubles, Doubles, Integers]:
    """All patches as one mesh, with unit normals; `points`, `turned`: shape (F, n, 3)."""
    unit = turned / np.maximum(np.linalg.norm(turned, axis=2, keepdims=True), 1e-300)
    firsts = points.shape[1] * np.arange(len(points))
    triangles = small[None] + firsts[:, None, None]
    return points.reshape(-1, 3), unit.reshape(-1, 3), triangles.reshape(-1, 3)


def _grid(pieces: int) -> tuple[Doubles, Integers]:
    """Barycentric points of a triangle cut into pieces^2, and these small triangles."""
    number: dict[tuple[int, int], int] = {}
    for row in range(pieces + 1):
        for column in range(pieces + 1 - row):
            number[column, row] = len(number)
    places = np.array([[pieces - x - y, x, y] for x, y in number]) / pieces
    triangles = []
    for x, y in number:
        if x + y < pieces:
            triangles.append((number[x, y], number[x + 1, y], number[x, y + 1]))
        if x + y < pieces - 1:
            triangles.append((number[x + 1, y], number[x + 1, y + 1], number[x, y + 1]))
    return places, np.array(triangles)


def _spread(weights: Doubles, vectors: Doubles) -> Doubles:
    return weights[None, :, None] * vectors[:, None, :]


def _edge_control(start: Doubles, end: Doubles, normal: Doubles) -> Doubles:
    """A third of the way from start to end, dropped onto the tangent plane at the start."""
    height = np.einsum("fi,fi->f", end - start, normal)
    return np.asarray((2.0 * start + end - height[:, None] * normal) / 3.0)


def _edge_normal(start: Doubles, end: Doubles, normals: Doubles, i: int, j: int) -> Doubles:
    """The normal in the middle of an edge: the mean, reflected at the plane across the edge."""
    along, total = end - start, normals[:, i] + normals[:, j]
    squared = np.maximum(np.einsum("fi,fi->f", along, along), 1e-300)
    share = 2.0 * np.einsum("fi,fi->f", along, total) / squared
    middle = total - share[:, None] * along
    return np.asarray(middle / np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-300))
