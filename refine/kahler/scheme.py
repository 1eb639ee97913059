"""Smoothing schemes: their base class, and their names.

Kähler, Haber, Seidel 2003, section 6: "the effects of other smoothing schemes" are of interest. The
paper's own is in smoothing.py.
"""

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64
from ..border.registry import Registry
from ..mesh.connectivity import Connectivity
from .frame import FrameBuffers


class Scheme:
    """Base class of all schemes, the paper's and your own: a scheme places points.

    A subclass defines `place`; all other methods do nothing by default. A refiner calls `bind`
    once, then in every frame `prepare`, `place` and, if it blends, `place_centres`.
    """

    interpolates = False
    """Whether the original vertices stay where they are."""
    uses_normals = True
    """Whether the scheme reads normals of frames; they are computed only if needed."""
    measures = False
    """Whether the scheme defines `measure`, which the criterion `displacement` needs."""
    parts: tuple["Scheme", ...] = ()
    """Schemes that this scheme uses; each of them also serves only one refiner."""

    def bind(
        self, connectivity: Connectivity, rest_positions: Floats64, rest_normals: Floats32
    ) -> None:
        """Take the mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def keep(self, frame: FrameBuffers) -> None:
        """Prepare for frames with the same splits as `frame`; called once, after numbering."""

    def prepare(self, frame: FrameBuffers) -> None:
        """Read the deformed mesh, before the criterion decides.

        Store only differences of positions. With refined normals `place` is called twice, first for
        the mesh relative to its first vertex, with every edge split once.
        """

    def place(self, frame: FrameBuffers) -> None:
        """Write positions and normals of vertices and of points on split edges into the rows."""
        raise NotImplementedError(f"{type(self).__name__} must have a method place")

    def place_positions(self, frame: FrameBuffers) -> None:
        """Write positions only; by default this calls `place`."""
        self.place(frame)

    def place_centres(self, frame: FrameBuffers) -> None:
        """Correct the centres of triangles, after blending has written them."""

    def outlined(self, connectivity: Connectivity) -> Flags:
        """Flags of interior edges that are outlines like borders, shape (E,); by default none."""
        return np.zeros(len(connectivity.edges), np.bool_)

    def is_back(self, connectivity: Connectivity) -> Flags:
        """Flags of triangles that do not count in normals of other triangles, (F,); none here."""
        return np.zeros(len(connectivity.faces), np.bool_)

    def curved(self, connectivity: Connectivity) -> Flags:
        """Flags of interior edges that bend like borders, shape (E,); by default the outlines."""
        return self.outlined(connectivity)

    def measure(self, displacements: Floats32, turns: Floats32) -> None:
        """Write how far a split would move each edge's midpoint and turn its normal, (E,) each.

        The turn is an angle [rad] times the length of the edge. The criterion `displacement` reads
        both.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method measure")


schemes: Registry[Scheme] = Registry("scheme", "risorius.schemes")
"""Schemes by name; a factory is called without arguments, once for each refiner."""
