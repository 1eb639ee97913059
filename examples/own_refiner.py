"""A refiner of one's own, registered from outside: cuts every triangle in four where edges grow.

    python examples/own_refiner.py

What a refiner has to be is `refine.Refiner`: edges and splits to tell what it did, capacities to
tell how much room it needs, `refine` to fill a stream, `origins` to tell where vertices come from.
This one cuts all edges or none, does not smooth, and is no match for triangles that name a vertex
twice. After `register` the whole program knows it by name. A package of its own needs no call; it
says in its pyproject.toml

    [project.entry-points."risorius.refiners"]
    quarters = "my_package:Quarters"

and `risorius view --refiner quarters` finds it.
"""

from types import SimpleNamespace

import numpy as np
import numpy.typing as npt

from risorius.refine import (
    Origins,
    RefinedMesh,
    Stream,
    View,
    available,
    check,
    connect,
    create,
    register,
)


class Quarters:
    """Cuts every triangle of the mesh in four as soon as one of its edges is too long."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: npt.ArrayLike | None = None,
        face_uv: npt.ArrayLike | None = None,
        longest: float = 1.5,
    ) -> None:
        """`longest`: length at which all is cut, over the longest edge at rest."""
        self._rest = np.array(rest_positions, dtype=np.float32)
        self._uv = None if uv is None else np.array(uv, dtype=np.float32)
        # Wedges and rims are vertices and edges, counted once for each side of a texture seam.
        mesh = self._mesh = connect(
            np.asarray(faces), len(self._rest), None if face_uv is None else np.asarray(face_uv)
        )
        self._limit = longest * self._longest_edge(self._rest)
        self.edges = mesh.edges
        self.triangle_edges = mesh.triangle_edges
        self.splits = np.zeros(len(self.edges), dtype=np.uint8)
        self.vertex_capacity = len(mesh.wedge_vertices) + len(mesh.rim_edges)
        self.triangle_capacity = 4 * len(mesh.faces)
        self.vertex_columns = 6 if uv is None else 8
        self._whole = mesh.corners
        self._cut = self._quartered()
        # Where rows lie on the mesh: both sides of a seam are one place, and have one normal.
        self._places = np.concatenate([mesh.wedge_vertices, len(self._rest) + mesh.rim_edges])
        self._own_stream = SimpleNamespace(
            vertices=np.zeros((self.vertex_capacity, self.vertex_columns), dtype=np.float32),
            triangles=np.zeros((self.triangle_capacity, 3), dtype=np.uint32),
            source=np.zeros(self.triangle_capacity, dtype=np.int32),
        )

    def refine(
        self,
        positions: npt.NDArray[np.floating],
        out: Stream | None = None,
        view: View | None = None,
    ) -> RefinedMesh:
        """Fill the stream for one frame; where the eye is, is all the same to this one."""
        points = np.asarray(positions, dtype=np.float32)
        stream: Stream = self._own_stream if out is None else out
        self.splits[:] = self._longest_edge(points) > self._limit
        corners, pieces = (self._cut, 4) if self.splits.any() else (self._whole, 1)
        middles = points[self.edges].mean(axis=1)
        places = self._places if pieces == 4 else self._mesh.wedge_vertices
        rows = np.concatenate([points, middles])[places]
        stream.vertices[: len(rows), :3] = rows
        stream.vertices[: len(rows), 3:6] = _normals(rows, corners, places)
        if self._uv is not None:
            ends = self._uv[self._mesh.rim_uv].mean(axis=1)
            uv = np.concatenate([self._uv[self._mesh.wedge_uv], ends])
            stream.vertices[: len(rows), 6:] = uv[: len(rows)]
        stream.triangles[: len(corners)] = corners
        stream.source[: len(corners)] = np.repeat(np.arange(len(self._whole)), pieces)
        return RefinedMesh(
            positions=stream.vertices[: len(rows), :3],
            normals=stream.vertices[: len(rows), 3:6],
            triangles=stream.triangles[: len(corners)],
            source=stream.source[: len(corners)],
            uv=None if self._uv is None else stream.vertices[: len(rows), 6:],
        )

    def origins(self) -> Origins:
        """Vertices are themselves; a new point is half of one end and half of the other."""
        vertices = np.repeat(self._mesh.wedge_vertices.astype(np.int32)[:, None], 3, axis=1)
        weights = np.tile(np.array([1.0, 0.0, 0.0], dtype=np.float32), (len(vertices), 1))
        if self.splits.any():
            a, b = self.edges[self._mesh.rim_edges].T
            ends = np.column_stack([a, b, a]).astype(np.int32)
            halves = np.tile(np.array([0.5, 0.5, 0.0], dtype=np.float32), (len(ends), 1))
            vertices, weights = np.concatenate([vertices, ends]), np.concatenate([weights, halves])
        return Origins(vertices, weights)

    def _longest_edge(self, points: npt.NDArray[np.float32]) -> float:
        a, b = points[self._mesh.edges[:, 0]], points[self._mesh.edges[:, 1]]
        return float(np.linalg.norm(a - b, axis=1).max(initial=0.0))

    def _quartered(self) -> npt.NDArray[np.uint32]:
        a, b, c = self._mesh.corners.astype(np.int64).T
        # The lowest bit of a rim tells its direction, for which a point in the middle has no use.
        ab, bc, ca = len(self._mesh.wedge_vertices) + (self._mesh.triangle_rims >> 1).T
        four = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        return np.array(four).transpose(2, 0, 1).reshape(-1, 3).astype(np.uint32)


def _normals(
    points: npt.NDArray[np.float32],
    triangles: npt.NDArray[np.uint32],
    places: npt.NDArray[np.integer],
) -> npt.NDArray[np.float32]:
    """Mean normals of the triangles around, weighted by area; rows of one place share theirs."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    sums = np.zeros((places.max(initial=0) + 1, 3), dtype=np.float32)
    for k in range(3):
        np.add.at(sums, places[triangles[:, k]], cross)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.asarray((sums / np.where(length > 0.0, length, 1.0))[places])


def main() -> list[int]:
    """Stretch a grid under the registered refiner; returns the triangles of each frame."""
    if "quarters" not in available():
        register("quarters", Quarters)
    x, y = np.meshgrid(np.arange(5.0), np.arange(2.0))
    rest = np.stack([x.ravel(), y.ravel(), np.zeros(10)], axis=1)
    faces = [(k, k + 1, k + 6) for k in range(4)] + [(k, k + 6, k + 5) for k in range(4)]
    refiner = create("quarters", faces, rest, longest=1.4)
    counts = []
    for stretch in (1.0, 1.5, 2.0, 3.0):
        positions = rest * [stretch, 1.0, 1.0]
        mesh = refiner.refine(positions)
        check(refiner, mesh, positions)  # names what a refiner does wrong
        counts.append(len(mesh.triangles))
    return counts


if __name__ == "__main__":
    print(f"triangles of each frame: {main()}")
    print(f"refiners now: {', '.join(available())}")
