"""Smoothing schemes: what decides where the points of split edges go.

Kähler, Haber, Seidel 2003, section 6: "it would be interesting to investigate the effects of other
smoothing schemes, since we currently don't interpolate, but only approximate". So a scheme is one
small class, bound once to the mesh and called once in every frame, when it is known which edges are
split and where in the output their points go:

    loop        the paper's rules (masks.py); original vertices at split edges move
    cubic       cubic edges from end points and normals (cubic.py); original vertices stay
    detail      cubic, plus what a finer mesh at rest has in addition (detail.py)
"""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity
from .frame import Frame
from .masks import FirstLevel, place_points
from .rings import vertex_rings

Floats = npt.NDArray[np.float32]


class Scheme(Protocol):
    """Places points; anything with these members can take the place of the built-in schemes."""

    @property
    def interpolates(self) -> bool:
        """Whether the original vertices stay where they are."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: npt.NDArray[np.float64],
        rest_normals: Floats,
    ) -> None:
        """Learn the mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def place(self, frame: Frame) -> None:
        """Write positions and normals of vertices and of points on split edges into the rows."""

    def place_centres(self, frame: Frame) -> None:
        """Correct the points in the middle of triangles, which have been written already.

        Only called for frames that are blended.
        """


class LoopScheme:
    """The paper's scheme: Loop's rules with Warren's weights (section 4.2)."""

    interpolates = False

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: npt.NDArray[np.float64],
        rest_normals: Floats,
    ) -> None:
        """Work out the weights of every vertex."""
        self._mesh = connectivity
        self._rings = vertex_rings(connectivity)
        self._first_level = FirstLevel(
            np.zeros(connectivity.vertex_count, dtype=np.float32),
            np.zeros((len(connectivity.edges), 3), dtype=np.float32),
        )

    def place(self, frame: Frame) -> None:
        """Write moved vertices, first level, second level."""
        place_points(self._mesh, frame, self._rings, self._first_level)

    def place_centres(self, frame: Frame) -> None:
        """Leave them as blending has them."""
