"""Write and register a refiner of your own, which cuts triangles in four when edges grow.

    python examples/own_refiner.py

It derives from `refine.BaseRefiner`, which binds the mesh, checks arguments, and carries texture
coordinates and attributes. This refiner splits all edges or none, and does not smooth. After
`refiners.register` the whole program finds it by name. A separate package needs these lines in its
pyproject.toml instead:

    [project.entry-points."risorius.refiners"]
    quarters = "my_package:Quarters"

and `risorius view --refiner quarters` finds it.
"""

from typing import Unpack

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Floats64
from risorius.refine import (
    BaseRefiner,
    Origins,
    Stream,
    Values,
    View,
    check,
    create,
    refiners,
)


class Quarters(BaseRefiner):
    """Cuts all triangles in four as soon as any edge of the mesh is too long."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        longest: float = 1.5,
        **values: Unpack[Values],
    ) -> None:
        """`longest`: limit of the longest edge, relative to its length at rest."""
        super().__init__(faces, rest_positions, **values)
        self._limit = longest * self._longest_edge(self.rest_positions)
        # Wedges and attribute edges are vertices and edges, counted once for each side of a texture
        # seam. The lowest bit of a triangle's attribute edge is its direction, which middles do
        # not need.
        mesh = self.connectivity
        sound = np.flatnonzero(~mesh.is_degenerate)
        degenerate = np.flatnonzero(mesh.is_degenerate)
        rows = mesh.triangle_attribute_edges[sound] >> 1
        corners = mesh.corners[sound]
        ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
        self._attribute_edge_ends = np.zeros((len(mesh.attribute_edges), 2), dtype=np.int64)
        self._attribute_edge_ends[rows] = ends
        a, b, c = corners.T
        ab, bc, ca = len(mesh.wedge_vertices) + rows.T
        four = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        pieces = np.array(four).transpose(2, 0, 1).reshape(-1, 3)
        self._cut = np.concatenate([pieces, mesh.corners[degenerate]])
        self._cut_source = np.concatenate([np.repeat(sound, 4), degenerate])

    @property
    def vertex_capacity(self) -> int:
        """Number of wedges, plus one midpoint for each attribute edge."""
        return len(self.connectivity.wedge_vertices) + len(self.connectivity.attribute_edges)

    @property
    def triangle_capacity(self) -> int:
        """Four for each triangle, but one for a degenerate triangle."""
        return len(self._cut)

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write one frame; the view has no effect."""
        mesh = self.connectivity
        self.edge_splits[:] = self._longest_edge(self.positions) > self._limit
        triangles = mesh.corners
        source = np.arange(len(mesh.faces))
        first = vertex_count = len(mesh.wedge_vertices)
        if self.splits.any():
            triangles = self._cut
            source = self._cut_source
            vertex_count = self.vertex_capacity
        rows, out_triangles, out_source = self.reserve(stream, vertex_count, len(triangles))

        self.find_normals()
        rows[: len(self.points), :3] = self.points
        rows[: len(self.points), 3:6] = self.normals
        self.write_wedges(rows)
        middles = rows[first:vertex_count]
        ends = self._attribute_edge_ends[: len(middles)]
        middles[:] = rows[ends].mean(axis=1)
        length = np.linalg.norm(middles[:, 3:6], axis=1, keepdims=True)
        middles[:, 3:6] /= np.where(length > 0.0, length, 1.0)
        out_triangles[: len(triangles)] = triangles
        out_source[: len(triangles)] = source
        return vertex_count, len(triangles)

    def origins(self) -> Origins:
        """The weights of new points: one half for each end of an edge."""
        if not self.splits.any():
            return super().origins()
        a, b = self.edges[self.connectivity.attribute_edges].T
        halves = np.tile([0.5, 0.5, 0.0], (len(a), 1))
        return super().origins().followed_by(np.column_stack([a, b, a]), halves)

    def _longest_edge(self, positions: Floats64) -> float:
        a, b = positions[self.edges].transpose(1, 0, 2)
        return float(np.linalg.norm(a - b, axis=1).max(initial=0.0))


def main() -> list[int]:
    """Stretch a grid under the registered refiner; returns the triangles of each frame."""
    if "quarters" not in refiners.available():
        refiners.register("quarters", Quarters)
    x, y = np.meshgrid(np.arange(5.0), np.arange(2.0))
    rest = np.stack([x.ravel(), y.ravel(), np.zeros(10)], axis=1)
    lower = [(k, k + 1, k + 6) for k in range(4)]
    upper = [(k, k + 6, k + 5) for k in range(4)]
    faces = lower + upper
    refiner = create("quarters", faces, rest, longest=1.4)
    counts = []
    for stretch in (1.0, 1.5, 2.0, 3.0):
        positions = rest * [stretch, 1.0, 1.0]
        mesh = refiner.refine(positions)
        check(refiner, mesh, positions)  # raises an error if the refiner is wrong
        counts.append(len(mesh.triangles))
    return counts


if __name__ == "__main__":
    print(f"triangles of each frame: {main()}")
    print(f"refiners now: {', '.join(refiners.available())}")
