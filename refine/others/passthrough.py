"""The refiner that does nothing: the mesh itself, in the form in which refined meshes come.

Kähler, Haber, Seidel 2003, compare with the static mesh in every figure and in Table 1. Positions,
normals and texture coordinates are those that `kahler` hands out where no edge is split, to the
last bit, so that switching between the two shows nothing but refinement.
"""

from typing import Unpack

import numpy as np
import numpy.typing as npt

from ..border.base import BaseRefiner
from ..border.corner_values import Values
from ..border.plugin import Stream, View
from ..border.rows import place_unmoved


class PassThrough(BaseRefiner):
    """Hands the mesh through with normals; the refiner named `none`."""

    def __init__(
        self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike, **values: Unpack[Values]
    ) -> None:
        """Bind to a mesh (see `registry.create`); there are no options."""
        super().__init__(faces, rest_positions, **values)
        self._source = np.arange(len(self.connectivity.faces), dtype=np.int32)

    @property
    def vertex_capacity(self) -> int:
        """One output vertex per wedge."""
        return len(self.connectivity.wedge_vertices)

    @property
    def triangle_capacity(self) -> int:
        """The triangles of the input."""
        return len(self.connectivity.faces)

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write the mesh as it is."""
        vertex_count, triangle_count = self.vertex_capacity, self.triangle_capacity
        vertices, triangles, source = self.reserve(stream, vertex_count, triangle_count)
        self.find_normals()
        place_unmoved(self.points, self.normals, vertices)
        self.write_wedges(vertices)
        triangles[:triangle_count] = self.connectivity.corners
        source[:triangle_count] = self._source
        return vertex_count, triangle_count
