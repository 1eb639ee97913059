"""Ways to cut triangles with split edges: the paper's table, and others.

Kähler, Haber, Seidel 2003, section 4.3. `Cutting` is the paper's. Other ways derive from it:
coherence.py cuts in the order of the splits; in beyond/blending.py points leave their edges
gradually.
"""

from ...geometry.arrays import Unsigned8, Unsigned16
from ..mesh.connectivity import Connectivity
from .criterion import Criterion
from .frame import FrameBuffers
from .scheme import Scheme
from .table import CONFIGURATION_TABLE, Patterns


class Cutting:
    """The paper's cutting: every point has its final position, and the table has 27 patterns.

    A refiner calls `bind` once, then in every frame `mark`, `number` and `place`. One object serves
    one refiner.
    """

    patterns: Patterns = CONFIGURATION_TABLE
    """The table in which triangles are looked up."""
    has_centres = False
    """Whether triangles may have a point in the middle."""
    has_memory = False
    """Whether a frame depends on those before it."""

    def bind(self, connectivity: Connectivity, frame: FrameBuffers) -> Unsigned16:
        """Bind the mesh; return the array of each triangle's row in the table, shape (F,).

        The array may have more than F entries.
        """
        return frame.configurations

    def mark(self, criterion: Criterion, frame: FrameBuffers, splits: Unsigned8) -> None:
        """Write 0, 1 or 2 for every edge into `splits`, shape (E,), as the criterion decides."""
        criterion.mark(frame.positions, frame.normals, splits)

    def number(
        self, frame: FrameBuffers, vertex_count: int, triangle_count: int
    ) -> tuple[int, int]:
        """Update the rows of triangles for a frame, after the points on edges have been numbered.

        Returns the numbers of all vertices and of all triangles.
        """
        return vertex_count, triangle_count

    def place(self, scheme: Scheme, frame: FrameBuffers) -> None:
        """Write the points inside triangles, after all others have been written."""
