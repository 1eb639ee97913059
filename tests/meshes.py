"""Meshes for tests: small simple ones, each with one property, and random ones.

All triangles are counter-clockwise seen from +z (or from outside) unless the name says otherwise.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import trimesh
from numpy.linalg import norm

from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.directions import unit_vectors


@dataclass(frozen=True)
class Mesh:
    """Vertex positions, shape (V, 3), and triangles, shape (F, 3)."""

    vertices: Floats64
    faces: Integers32
    uv: Floats64 | None = None
    face_uv: Integers32 | None = None


def _mesh(vertices: npt.ArrayLike, faces: npt.ArrayLike) -> Mesh:
    return Mesh(np.array(vertices, dtype=np.float64), np.array(faces, dtype=np.int32))


def flat_cross(u: Floats64, v: Floats64) -> Floats64:
    """The last coordinate of the vector products of u and v, from their first two ones."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def triangle() -> Mesh:
    """One triangle: three border edges."""
    return _mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


def two_triangles() -> Mesh:
    r"""Two triangles with one inner edge 1-2.

    2---3
    | \ |
    0---1
    """
    return _mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (3, 2, 1)])


def fan(valence: int = 6) -> Mesh:
    """A flat disk: vertex 0 in the centre, and `valence` vertices around it."""
    angles = 2.0 * np.pi * np.arange(valence) / valence
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(valence)], axis=1)
    faces = [(0, 1 + k, 1 + (k + 1) % valence) for k in range(valence)]
    return _mesh(np.concatenate([np.zeros((1, 3)), ring]), faces)


def double_cone(valence: int) -> Mesh:
    """A closed double cone: two tips with many neighbours, and a ring of valence four."""
    disk = fan(valence)
    vertices = np.concatenate([disk.vertices, [[0.1, 0.0, -0.7]]])
    vertices[0, 2] = 0.6
    below = np.where(disk.faces == 0, len(vertices) - 1, disk.faces)[:, ::-1]
    return Mesh(vertices, np.concatenate([disk.faces, below]).astype(np.int32))


def tetrahedron() -> Mesh:
    """The smallest closed surface: every vertex has valence three."""
    vertices = [(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)]
    return _mesh(vertices, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def octahedron() -> Mesh:
    """A closed surface whose vertices have valence four."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return _mesh(vertices, faces)


def cube() -> Mesh:
    """A cube of twelve triangles, whose corners have coordinates 0 and 1."""
    corners = np.indices((2, 2, 2)).reshape(3, -1).T  # corner 4 x + 2 y + z
    squares = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    halves = [half for a, b, c, d in squares for half in ((a, b, c), (a, c, d))]
    return _mesh(corners, halves)


def ball(levels: int = 2) -> Mesh:
    """A sphere of radius 1: an octahedron, split `levels` times and rounded."""
    vertices = octahedron().vertices
    faces = octahedron().faces
    for _ in range(levels):
        vertices, faces = trimesh.remesh.subdivide(vertices, faces)
        vertices = unit_vectors(vertices)
    return _mesh(vertices, faces)


def open_grid(columns: int = 4, rows: int = 3) -> Mesh:
    """A flat rectangle of unit cells, each cut in two, with an open border."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    corners = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    lower = np.stack([corners, corners + 1, corners + columns + 2], axis=1)
    upper = np.stack([corners, corners + columns + 2, corners + columns + 1], axis=1)
    return _mesh(vertices, np.stack([lower, upper], axis=1).reshape(-1, 3))


def half_shut_book() -> Mesh:
    """Two triangles folded towards each other, like a half-closed book."""
    return _mesh([(0, 0, 0), (0, 1, 0), (1, 0.5, 0.3), (1, 0.5, -0.3)], [(0, 2, 1), (0, 1, 3)])


def pillow() -> Mesh:
    """Two triangles with the same three vertices, back to back: closed, with valence two."""
    return _mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 1)])


def bow_tie() -> Mesh:
    """Two triangles that share only vertex 0: a non-manifold vertex."""
    vertices = [(0, 0, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)]
    return _mesh(vertices, [(0, 1, 2), (0, 3, 4)])


def three_on_an_edge() -> Mesh:
    """Three triangles on the edge 0-1: a non-manifold edge."""
    vertices = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 1, 0), (-1, -1, 0)]
    return _mesh(vertices, [(0, 1, 2), (0, 1, 3), (1, 0, 4)])


def inconsistent_pair() -> Mesh:
    """Two triangles that run along their common edge in the same direction."""
    return _mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0)], [(0, 1, 2), (0, 1, 3)])


def with_debris() -> Mesh:
    """A grid, a second component, unused vertices, a sliver, and triangles without area."""
    grid = open_grid(3, 2)
    count = len(grid.vertices)
    extra = [(9, 0, 0), (10, 0, 0), (9, 1, 0), (50, 50, 50), (11, 0, 0)]
    faces = [
        (count, count + 1, count + 2),  # a separate component
        (count, count + 1, count + 4),  # collinear corners
        (0, 1, 1),  # names a vertex twice
        (2, 2, 2),  # names one vertex three times
        (0, 1, 5),  # names a vertex twice, like the first
    ]
    return _mesh(np.concatenate([grid.vertices, extra]), [*grid.faces.tolist(), *faces])


NAMED_MESHES = {
    function.__name__: function
    for function in (
        triangle,
        two_triangles,
        fan,
        tetrahedron,
        octahedron,
        open_grid,
        half_shut_book,
        pillow,
        bow_tie,
        three_on_an_edge,
        inconsistent_pair,
        with_debris,
    )
}
"""All named meshes; call the value to get the mesh."""


def irregular(seed: int, columns: int = 12, rows: int = 10, holes: int = 3) -> Mesh:
    """A bumpy grid with uneven valences and holes; vertices, triangles and corners shuffled."""
    generator = np.random.default_rng(seed)
    grid = open_grid(columns, rows)
    x = grid.vertices[:, 0]
    y = grid.vertices[:, 1]
    jitter = generator.uniform(-0.3, 0.3, (len(x), 2))
    waves = 0.8 * np.sin(0.5 * x) * np.cos(0.4 * y)
    height = waves + 0.1 * generator.standard_normal(len(x))
    vertices = np.column_stack([grid.vertices[:, :2] + jitter, height])

    pairs = grid.faces.reshape(-1, 2, 3)
    a = pairs[:, 0, 0]
    b = pairs[:, 0, 1]
    c = pairs[:, 0, 2]
    d = pairs[:, 1, 2]
    first = np.stack([a, b, d], axis=1)
    second = np.stack([b, c, d], axis=1)
    other = np.stack([first, second], axis=1)
    is_flipped = generator.random(len(pairs)) < 0.5
    faces = np.where(is_flipped[:, None, None], other, pairs).reshape(-1, 3)

    centres = vertices[faces].mean(axis=1)
    for centre in centres[generator.integers(len(faces), size=holes)]:
        is_far = norm(centres - centre, axis=1) > generator.uniform(0.8, 1.8)
        faces = faces[is_far]
        centres = centres[is_far]

    new_number = generator.permutation(len(vertices))
    shuffled = np.empty_like(vertices)
    shuffled[new_number] = vertices
    faces = new_number[faces][generator.permutation(len(faces))]
    turns = generator.integers(3, size=len(faces))
    corners = (np.arange(3) + turns[:, None]) % 3
    faces = np.take_along_axis(faces, corners, axis=1)
    return _mesh(shuffled, faces)


def wrinkled(mesh: Mesh, seed: int, amplitude: float = 0.25) -> Floats64:
    """Positions deformed by a few random plane waves, shape (V, 3).

    Some places bend, some do not.
    """
    generator = np.random.default_rng(seed)
    deformed = mesh.vertices.copy()
    for _ in range(3):
        wave = generator.uniform(-2.5, 2.5, 3)
        phase = generator.uniform(0.0, 2.0 * np.pi)
        direction = generator.standard_normal(3)
        deformed += amplitude * direction * np.sin(mesh.vertices @ wave + phase)[:, None]
    return deformed


def tube(segments: int = 8, rings: int = 4) -> Mesh:
    """A tube, closed in geometry, whose texture is cut open along a straight seam.

    At the seam the texture coordinate u jumps from 1 to 0: `segments + 1` columns of texture
    coordinates for `segments` columns of vertices.
    """
    angles = 2.0 * np.pi * np.arange(segments) / segments
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    vertices = [(x, y, 0.7 * z) for z in range(rings + 1) for x, y in circle]
    uv = [(u / segments, v / rings) for v in range(rings + 1) for u in range(segments + 1)]
    faces = []
    face_uv = []
    for ring in range(rings):
        for k in range(segments):
            a = ring * segments + k
            b = ring * segments + (k + 1) % segments
            faces += [(a, b, b + segments), (a, b + segments, a + segments)]
            s = ring * (segments + 1) + k
            face_uv += [(s, s + 1, s + segments + 2), (s, s + segments + 2, s + segments + 1)]
    return Mesh(
        np.array(vertices),
        np.array(faces, dtype=np.int32),
        np.array(uv),
        np.array(face_uv, dtype=np.int32),
    )


def rotation(seed: int) -> Floats64:
    """A random rotation matrix, shape (3, 3)."""
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return np.asarray(matrix * np.linalg.det(matrix))


def slit() -> Mesh:
    """A flat rectangle of unit cells around the origin, with a slit along x; symmetric in x and y.

    The two cells at each end of the middle row are not cut. The lower side of the slit has the
    vertex indices of a grid without slit; the upper side has the last indices.
    """
    columns = 10
    rows = 6
    across = columns + 1
    x, y = np.meshgrid(np.arange(across) - columns / 2, np.arange(rows + 1) - rows / 2)
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    upper = {
        across * (rows // 2) + column: len(vertices) + k
        for k, column in enumerate(range(3, columns - 2))
    }
    faces = []
    for row in range(rows):
        for column in range(columns):
            a = across * row + column
            b = across * (row + 1) + column
            corners = [a, a + 1, b + 1, b]
            if row >= rows // 2:
                corners = [upper.get(v, v) for v in corners]
            first = int((row < rows // 2) != (column < columns // 2))  # one of two diagonals
            a, b, c, d = (corners[(k + first) % 4] for k in range(4))
            faces += [(a, b, c), (a, c, d)]
    return _mesh(np.concatenate([vertices, vertices[list(upper)]]), faces)


def opened(mesh: Mesh, height: float) -> Floats64:
    """Vertices of `slit` whose sides are moved apart in its plane, to arcs; shape (V, 3)."""
    columns, rows = np.ptp(mesh.vertices, axis=0)[:2]
    positions = mesh.vertices.copy()
    x = mesh.vertices[:, 0]
    y = mesh.vertices[:, 1]
    is_upper = np.arange(len(x)) >= (columns + 1) * (rows + 1)
    side = np.where(is_upper, 1.0, np.where(y == 0.0, -1.0, np.sign(y)))
    arc = np.maximum(1.0 - (x / (columns / 2 - 2)) ** 2, 0.0)
    positions[:, 1] += height * side * arc * (1.0 - np.abs(y) / (rows / 2))
    return positions
