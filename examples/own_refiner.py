"""A refiner of one's own, registered from outside: every triangle with a long edge is cut in four.

    python examples/own_refiner.py

What a refiner has to be is `refine.Refiner`: edges and splits to tell what it did, capacities to
tell how much room it needs, `refine` to fill a stream, `origins` to tell where vertices come from.
This one cuts all edges or none, and does not smooth. After `register` the whole program knows it by
name. A package of its own needs no call; it says in its pyproject.toml

    [project.entry-points."risorius.refiners"]
    quarters = "my_package:Quarters"

and `risorius view --refiner quarters` finds it.
"""

from types import SimpleNamespace

import numpy as np
import numpy.typing as npt

from refine import Origins, RefinedMesh, Stream, available, check, connect, create, register


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
        if uv is not None or face_uv is not None:
            raise ValueError("the refiner 'quarters' carries no texture coordinates")
        self._rest = np.array(rest_positions, dtype=np.float32)
        self._mesh = connect(np.asarray(faces), len(self._rest))
        self._limit = longest * self._longest_edge(self._rest)
        self.edges = self._mesh.edges
        self.triangle_edges = self._mesh.triangle_edges
        self.splits = np.zeros(len(self.edges), dtype=np.uint8)
        self.vertex_capacity = len(self._rest) + len(self.edges)
        self.triangle_capacity = 4 * len(self._mesh.faces)
        self.vertex_columns = 6
        self._whole = self._mesh.faces
        self._cut = self._quartered()
        self._own_stream = SimpleNamespace(
            vertices=np.zeros((self.vertex_capacity, self.vertex_columns), dtype=np.float32),
            triangles=np.zeros((self.triangle_capacity, 3), dtype=np.uint32),
            source=np.zeros(self.triangle_capacity, dtype=np.int32),
        )

    def refine(self, positions: npt.NDArray[np.floating], out: Stream | None = None) -> RefinedMesh:
        """Fill the stream for one frame."""
        points = np.asarray(positions, dtype=np.float32)
        stream: Stream = self._own_stream if out is None else out
        self.splits[:] = self._longest_edge(points) > self._limit
        corners, pieces = (self._cut, 4) if self.splits.any() else (self._whole, 1)
        rows = np.concatenate([points, points[self.edges].mean(axis=1)]) if pieces == 4 else points
        stream.vertices[: len(rows), :3] = rows
        stream.vertices[: len(rows), 3:6] = _normals(rows, corners)
        stream.triangles[: len(corners)] = corners
        stream.source[: len(corners)] = np.repeat(np.arange(len(self._whole)), pieces)
        return RefinedMesh(
            positions=stream.vertices[: len(rows), :3],
            normals=stream.vertices[: len(rows), 3:6],
            triangles=stream.triangles[: len(corners)],
            source=stream.source[: len(corners)],
            uv=None,
        )

    def origins(self) -> Origins:
        """Vertices are themselves; a new point is half of one end and half of the other."""
        vertices = np.repeat(np.arange(len(self._rest), dtype=np.int32)[:, None], 3, axis=1)
        weights = np.tile(np.array([1.0, 0.0, 0.0], dtype=np.float32), (len(vertices), 1))
        if self.splits.any():
            ends = np.column_stack([self.edges, self.edges[:, 0]]).astype(np.int32)
            halves = np.tile(np.array([0.5, 0.5, 0.0], dtype=np.float32), (len(ends), 1))
            vertices, weights = np.concatenate([vertices, ends]), np.concatenate([weights, halves])
        return Origins(vertices, weights)

    def _longest_edge(self, points: npt.NDArray[np.float32]) -> float:
        a, b = points[self._mesh.edges[:, 0]], points[self._mesh.edges[:, 1]]
        return float(np.linalg.norm(a - b, axis=1).max(initial=0.0))

    def _quartered(self) -> npt.NDArray[np.uint32]:
        a, b, c = self._mesh.faces.astype(np.int64).T
        ab, bc, ca = len(self._rest) + self._mesh.triangle_edges.astype(np.int64).T
        four = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        return np.array(four).transpose(2, 0, 1).reshape(-1, 3).astype(np.uint32)


def _normals(
    points: npt.NDArray[np.float32], triangles: npt.NDArray[np.uint32]
) -> npt.NDArray[np.float32]:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    sums = np.zeros_like(points)
    for k in range(3):
        np.add.at(sums, triangles[:, k], cross)
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.asarray(sums / np.where(length > 0.0, length, 1.0))


def main() -> list[int]:
    """Stretch a strip under the registered refiner; returns the triangles of each frame."""
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
