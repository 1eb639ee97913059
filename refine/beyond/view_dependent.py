"""Criteria that ask where the eye is: `silhouette` and `screen` (see measuring.py).

Kähler, Haber, Seidel 2003, section 6.
"""

import reprlib

import numpy as np

from ...jit import njit
from ..border.plugin import View
from ..mesh.arrays import Doubles, Floats, Unsigned
from ..mesh.vectors import ONE
from .blending import RAMP
from .measuring import Measuring

BAND = 0.3
"""Cosine between normal and line of sight at which an edge is no silhouette: 17 degrees away."""


class ViewDependent(Measuring):
    """A criterion that depends on where the eye is."""

    def set_view(self, view: View | None) -> None:
        """Take the view of this frame; raises ValueError if there is none, or no place for it."""
        if view is None:
            raise ValueError(
                f"{type(self).__name__} needs to know where the eye is; pass "
                "view=refine.View(eye, focal) to refine()"
            )
        try:
            eye, focal = np.asarray(view.eye, dtype=np.float64), float(view.focal)
        except (TypeError, ValueError, OverflowError):
            eye, focal = np.zeros(0), 0.0
        if eye.shape != (3,) or not np.isfinite(eye).all() or not 0.0 < focal < np.inf:
            raise ValueError(
                "view must have an eye of shape (3,) and a focal length in pixels above 0, all "
                f"finite, got {reprlib.repr(view.eye)} and {reprlib.repr(view.focal)}"
            )
        self._eye, self._focal = eye, np.float32(focal)


class Silhouette(ViewDependent):
    """Edges along which the surface turns away from the eye.

    An edge that turns by more than it takes to be grown twice on the outline itself counts no more:
    on coarse meshes its points would pop out while the eye has hardly moved.
    """

    def __init__(self, once: float = 0.005, twice: float = 0.03) -> None:
        """`once`, `twice`: 1 - the cosine between the normals at both ends."""
        super().__init__(once, twice, "1 - the cosine between two normals")

    def measure(self, positions: Doubles, normals: Floats, metric: Floats) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        limits = self.thresholds
        most = limits.once + (ONE + RAMP) * limits.width
        turns_at_silhouette(positions, normals, self._edges, self._eye, most, metric)
        limits.scale(metric)


class ScreenEdge(ViewDependent):
    """Edges that are long on the screen."""

    def __init__(self, once: float = 32.0, twice: float = 64.0) -> None:
        """`once`, `twice`: lengths in pixels."""
        super().__init__(once, twice, "lengths in pixels")

    def measure(self, positions: Doubles, normals: Floats, metric: Floats) -> None:
        """Write the refinement metric of every edge, shape (E,)."""
        lengths_on_screen(positions, self._edges, self._eye, self._focal, metric)
        self.thresholds.scale(metric)


@njit
def turns_at_silhouette(
    positions: Doubles,
    normals: Floats,
    edges: Unsigned,
    eye: Doubles,
    most: np.float32,
    turns: Floats,
) -> None:
    """Write 1 - the cosine of the normals of every edge, faded out away from the silhouette.

    What is above `most` counts as `most`.
    """
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        cosine = seen_a = seen_b = length_a = length_b = 0.0
        for i in range(3):
            to_a, to_b = eye[i] - positions[a, i], eye[i] - positions[b, i]
            cosine += normals[a, i] * normals[b, i]
            seen_a += to_a * normals[a, i]
            seen_b += to_b * normals[b, i]
            length_a += to_a * to_a
            length_b += to_b * to_b
        seen_a /= np.sqrt(max(length_a, 1e-30))
        seen_b /= np.sqrt(max(length_b, 1e-30))
        away = 0.0 if seen_a * seen_b <= 0.0 else min(abs(seen_a), abs(seen_b))
        turn = min(np.float32(1.0 - cosine), most)
        turns[e] = turn * max(0.0, 1.0 - away / BAND)


@njit
def lengths_on_screen(
    positions: Doubles, edges: Unsigned, eye: Doubles, focal: np.float32, lengths: Floats
) -> None:
    """Write the length [pixels] of every edge as if it were seen square on, shape (E,)."""
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        length = distance = 0.0
        for i in range(3):
            length += (positions[b, i] - positions[a, i]) ** 2
            distance += (0.5 * (positions[a, i] + positions[b, i]) - eye[i]) ** 2
        lengths[e] = focal * np.sqrt(length / max(distance, 1e-30))
