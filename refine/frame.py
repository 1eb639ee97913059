"""What the passes of a frame hand on to each other, as plain arrays.

Kähler, Haber, Seidel 2003, section 4. A frame has two halves: first it is decided which edges are
split (`splits`, and how far their points have grown), then points are placed and triangles written
into `rows`. Compiled code takes a `Frame` as it is; its arrays stay the same from frame to frame,
but for `rows`, which belongs to whoever draws.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]

ROWS, ONCE, TWICE, TRIANGLES, CENTRES = range(5)
"""Places in `Frame.counts`: output rows but centres, edges split, edges split twice, subtriangles,
triangles with a point in the middle."""


class Frame(NamedTuple):
    """One frame of a mesh with V vertices, F triangles, E edges and R rims."""

    positions: npt.NDArray[np.float64]
    """Deformed vertex positions, shape (V, 3)."""
    points: Floats
    """The same in single precision, which is enough for all but differences."""
    normals: Floats
    """Their unit normals, shape (V, 3)."""
    splits: npt.NDArray[np.uint8]
    """Splits of every rim, edges first, shape (R + 1,); the last stands for where no edge is."""
    growth_once: Floats
    """How far the middle point of an edge has grown, 0 to 1 (blend.py), shape (E,).

    All ones without blending, and then without a meaning where no point is.
    """
    growth_twice: Floats
    """How far its quarter points have."""
    first_points: Unsigned
    """Output row of the first point of every split rim, shape (R + 1,)."""
    split_once: Unsigned
    """The edges that are split; the first `counts[ONCE]` count."""
    split_twice: Unsigned
    """The edges that are split twice; the first `counts[TWICE]` count."""
    configurations: npt.NDArray[np.uint16]
    """s0 + 3 s1 + 9 s2 of each triangle's edges, shape (F + 1,); the last one has no meaning."""
    centre_triangles: Unsigned
    """The triangles with a point in the middle; the first `counts[CENTRES]` count. Shape (F + 1,),
    or (0,) without blending, which alone has such points."""
    counts: npt.NDArray[np.int64]
    """How many there are of what, shape (5,): see ROWS, ONCE, TWICE, TRIANGLES, CENTRES."""
    rows: Floats
    """The output: x y z, nx ny nz, attributes; row v is vertex v."""

    @property
    def is_blended(self) -> bool:
        """Whether points grow out of their edges, instead of being there or not."""
        return len(self.centre_triangles) > 0

    @property
    def once_count(self) -> int:
        """How many edges are split."""
        return int(self.counts[ONCE])

    @property
    def twice_count(self) -> int:
        """How many edges are split twice."""
        return int(self.counts[TWICE])

    @property
    def first_centre(self) -> int:
        """Output row of the first point in the middle of a triangle."""
        return int(self.counts[ROWS])

    @property
    def centre_count(self) -> int:
        """How many triangles have a point in the middle."""
        return int(self.counts[CENTRES])
