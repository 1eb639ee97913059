"""The standard face space in which a face is simulated, and the mapping to head coordinates.

A rig is written in millimetres of a head of standard size. Landmarks define the axes of a space:
lateral (to the subject's left), up and forward. One similarity maps a head of any size, place and
orientation into this space. One compiled pass turns displacements into positions of the posed head
in every frame; numpy would need eight passes.

Source: Kähler, Haber, Yamauchi, Seidel 2002 ("Head shop"): landmarks carry muscles from head to
head.
Differs from it: they warp a template by scattered data interpolation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from ..geometry.vectors import less, plus, rotated, row_of, times, toward, write_row
from ..jit import njit


@dataclass(frozen=True)
class FaceSpace:
    """A similarity between a head's own coordinates and the standard face space.

    Standard axes: lateral (to the subject's left), up, forward; millimetres; origin at the nasion.
    """

    origin: Floats64
    axes: Floats64  # rows: unit vectors lateral-left, up, forward in head coordinates
    scale: float  # head units per standard millimetre

    @classmethod
    def from_landmarks(cls, points: Floats64) -> FaceSpace:
        """The space of a head from its landmark positions [head units], shape (68, 3).

        Raises ValueError if they coincide.
        """
        lateral = points[42:48].mean(axis=0) - points[36:42].mean(axis=0)
        upward = points[27] - points[[48, 54]].mean(axis=0)
        span = float(np.linalg.norm(points[45] - points[36]))
        if min(span, float(np.linalg.norm(lateral)), float(np.linalg.norm(upward))) < 1e-9:
            raise ValueError(
                "landmarks: eyes, nasion and mouth corners must be different points; "
                "check that the 68 vertex indices belong to this mesh"
            )
        lateral = lateral / np.linalg.norm(lateral)
        upward = upward - lateral * (lateral @ upward)
        upward = upward / np.linalg.norm(upward)
        axes = np.array([lateral, upward, np.cross(lateral, upward)])
        # mm between the outer eye corners 36 and 45: the size rigs are written in (adult mean)
        standard_eye_span = 89.2
        return cls(points[27].copy(), axes, span / standard_eye_span)

    @classmethod
    def from_bounds(cls, vertices: Floats64) -> FaceSpace:
        """The space for a mesh without landmarks: the mesh's axes, scaled to the size of a head."""
        low = vertices.min(axis=0)
        high = vertices.max(axis=0)
        diagonal = float(np.linalg.norm(high - low))
        # mm, bounding box of a head; scales meshes that have no landmarks (chosen: our head's)
        standard_diagonal = 280.0
        scale = diagonal / standard_diagonal if diagonal > 0.0 else 1.0
        return cls((low + high) / 2.0, np.eye(3), scale)

    def to_standard(self, points: npt.ArrayLike) -> Floats64:
        """Map points [head units], shape (..., 3), to the standard space [mm]."""
        return self.vectors_to_standard(np.asarray(points, dtype=np.float64) - self.origin)

    def to_head(self, points: npt.ArrayLike) -> Floats64:
        """Map points [mm, standard space], shape (..., 3), to head coordinates."""
        return self.vectors_to_head(points) + self.origin

    def vectors_to_head(self, vectors: npt.ArrayLike) -> Floats64:
        """Map displacements [mm, standard space], shape (..., 3), to head units and axes."""
        return np.asarray(vectors, dtype=np.float64) @ self.axes * self.scale

    def vectors_to_standard(self, vectors: npt.ArrayLike) -> Floats64:
        """Map displacements [head units], shape (..., 3), to the standard space [mm]."""
        return np.asarray(vectors, dtype=np.float64) @ self.axes.T / self.scale


@njit
def to_posed_head(
    x: Floats64,
    rest: Floats64,
    axes: Floats64,
    head_rest: Floats64,
    turn: Floats64,
    head_weight: Floats64,
    out: Floats64,
) -> int:
    """Fill `out` (V, 3) [head units] with positions; return how many are not finite.

    Vertices with such positions are not written.

    x, rest: positions now and at rest [mm]; axes (3, 3): axes of the standard space in head
    coordinates, times the scale; head_rest: rest positions [head units]; turn (4, 4): pose of the
    head; head_weight (V, 1): how far each vertex follows it.
    """
    broken = 0
    for i in range(len(x)):
        moved = less(row_of(x, i), 1.0, row_of(rest, i))
        if not np.isfinite(moved[0] + moved[1] + moved[2]):
            broken += 1
            continue
        here = row_of(head_rest, i)
        for k in range(3):
            here = plus(here, times(moved[k], row_of(axes, k)))
        turned = plus(rotated(turn, here), (turn[0, 3], turn[1, 3], turn[2, 3]))
        write_row(out, i, toward(here, turned, head_weight[i, 0]))
    return broken
