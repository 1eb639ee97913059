r"""Criteria beside the paper's: curvature, rest, silhouette, screen, bulge, and several at once.

Kähler, Haber, Seidel 2003, section 4.1 ("More complex criteria can be used as well, such as
measuring discrete curvature on the mesh [19]") and section 6 ("refining the mesh along silhouette
edges. To achieve this, appropriate splitting criteria have to be developed").

    curvature   height of the arc over an edge      |k| L^2 / 8, k = 2 n . (b - a) / L^2 the
                in mean edge lengths at rest        curvature along it (Taubin 1995, section 3)
    rest        much the same at rest               rest_curvature.py: the same edges in every frame
    silhouette  how far the surface turns along     (1 - n_a . n_b) x facing; facing is 1 where the
                an edge that is seen from aside     line of sight grazes the edge, 0 a BAND away;
                                                    the turn counts up to where points have grown
    screen      length of an edge as it is seen     L x focal / distance from the eye, in pixels
    bulge       how far the scheme moves a middle   for schemes with curved edges (curves.py);
                and mends normals, if it knows      `detail` does

Each has two thresholds, above which an edge is split once and twice, and says how much an edge
needs a split, so that all of them can be blended (blend.py) and any of them combined.
"""

import reprlib
from collections.abc import Callable, Sequence
from typing import cast

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .blend import RAMP
from .connectivity import Connectivity
from .criterion import Criterion, Measured, NormalDrop, Thresholds
from .curves import CurveScheme
from .plugin import View
from .rest_curvature import RestCurvature

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Small = npt.NDArray[np.uint8]
Unsigned = npt.NDArray[np.uint32]

ONE = np.float32(1.0)
BAND = 0.3
"""Cosine between normal and line of sight at which an edge is no silhouette: 17 degrees aside."""

HASTE = 0.25
"""Share of the first threshold of `bulge` in which a blended point grows. Chosen: a point that is
half grown costs as much as a whole one; and one that moves by 6 times the change of its bulge, and
no farther than that threshold, does not pop."""


class _Measuring:
    """What the criteria of this file share: thresholds, and splits that follow from needs."""

    def __init__(self, once: float, twice: float, meaning: str) -> None:
        self.thresholds = Thresholds(once, twice, meaning)

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Take the edges."""
        self._edges = connectivity.edges.view(np.uint32)
        self._need = np.zeros(len(self._edges), dtype=np.float32)

    def mark(self, positions: Doubles, normals: Floats, splits: Small) -> None:
        """Write the number of splits of every edge into `splits`, shape (E,)."""
        self.measure(positions, normals, self._need)
        splits_of_needs(self._need, splits)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        raise NotImplementedError


class Curvature(_Measuring):
    """Discrete curvature along the edges (Taubin 1995), as the height of the arc over them."""

    def __init__(self, once: float = 0.025, twice: float = 0.06, *, relative: bool = True) -> None:
        """`once`, `twice`: heights in mean edge lengths of the mesh at rest.

        `relative`: only what has been added to the height at rest counts, as in the paper; without
        it a mesh that is coarse at rest is refined where it is curved.
        """
        super().__init__(once, twice, "heights in mean edge lengths")
        self.relative = relative

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Store the heights of the undeformed mesh."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._rest = np.zeros(len(self._edges), dtype=np.float32)
        heights = np.empty_like(self._rest)
        arc_heights(rest_positions, rest_normals, self._edges, self._rest, heights)
        if self.relative:
            self._rest = heights
        self._unit = _mean_length(connectivity, rest_positions)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        limits = self.thresholds
        arc_heights(positions, normals, self._edges, self._rest, need)
        scale_needs(need, limits.once * self._unit, limits.width * self._unit, limits.most)


class _Seen(_Measuring):
    """A criterion that depends on where the eye is."""

    _view: View | None = None

    def look(self, view: View | None) -> None:
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
        self._view = View(eye, focal)

    def _looked(self) -> tuple[Doubles, np.float32]:
        if self._view is None:
            raise ValueError(f"{type(self).__name__}.look(view) must be called before every frame")
        return cast(Doubles, self._view.eye), np.float32(self._view.focal)


class Silhouette(_Seen):
    """Edges along which the surface turns away from the eye.

    An edge that turns by more than it takes to be grown twice on the outline itself counts no more:
    on coarse meshes its points would pop out while the eye has hardly moved.
    """

    def __init__(self, once: float = 0.005, twice: float = 0.03) -> None:
        """`once`, `twice`: 1 - the cosine between the normals at both ends."""
        super().__init__(once, twice, "1 - the cosine between two normals")

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        limits = self.thresholds
        most = limits.once + (ONE + RAMP) * limits.width
        turns_at_silhouette(positions, normals, self._edges, self._looked()[0], most, need)
        scale_needs(need, limits.once, limits.width, limits.most)


class ScreenEdge(_Seen):
    """Edges that are long on the screen."""

    def __init__(self, once: float = 32.0, twice: float = 64.0) -> None:
        """`once`, `twice`: lengths in pixels."""
        super().__init__(once, twice, "lengths in pixels")

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        limits, (eye, focal) = self.thresholds, self._looked()
        lengths_on_screen(positions, self._edges, eye, focal, need)
        scale_needs(need, limits.once, limits.width, limits.most)


class Bulge(_Measuring):
    """How far the scheme would move the middle of an edge: what is wrong without a split.

    For the schemes that interpolate. What is coarse at rest counts as well, unlike in the paper.
    """

    def __init__(self, once: float = 0.03, twice: float = 0.15, *, turning: float = 0.15) -> None:
        """`once`, `twice`: distances in mean edge lengths of the mesh at rest.

        `turning`: the distance that an error of normals of a radian counts that a split would mend,
        for the scheme `detail`; 0 looks at distances only.
        """
        super().__init__(once, twice, "distances in mean edge lengths")
        self.turning = turning

    def use(self, scheme: object) -> None:
        """Take the scheme of the refiner; raises ValueError for one without curves."""
        if not isinstance(scheme, CurveScheme):
            raise ValueError(
                'criterion "bulge" measures curved edges: it goes with the schemes "cubic" and '
                f'"detail", got {type(scheme).__name__}'
            )
        self._scheme = scheme

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Store the unit of length."""
        super().bind(connectivity, rest_positions, rest_normals)
        self._unit = _mean_length(connectivity, rest_positions)

    def measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        """Write the need of every edge, shape (E,)."""
        limits, turns = self.thresholds, self._scheme.turns
        bulge_sizes(self._scheme.all_bulges(positions, normals), need)
        if turns is not None and self.turning > 0.0:
            count_turns(need, turns, np.float32(self.turning) * self._unit)
        scale_needs(need, limits.once * self._unit, limits.width * self._unit, limits.most)
        hasten(need, np.float32(HASTE) * limits.once / limits.width, RAMP)


class Maximum:
    """Several criteria: each edge is split as often as the one that asks for most."""

    def __init__(self, criteria: Sequence[Criterion]) -> None:
        if not criteria:
            raise ValueError("criterion: an empty list decides nothing; name at least one")
        self.criteria = tuple(criteria)
        # Only a whole of measuring parts measures; others decide in whole splits.
        if all(isinstance(criterion, Measured) for criterion in self.criteria):
            self.measure = self._measure

    def bind(
        self, connectivity: Connectivity, rest_positions: Doubles, rest_normals: Floats
    ) -> None:
        """Bind them all."""
        for criterion in self.criteria:
            criterion.bind(connectivity, rest_positions, rest_normals)
        self._splits = np.zeros(len(connectivity.edges), dtype=np.uint8)
        self._need = np.zeros(len(connectivity.edges), dtype=np.float32)

    def use(self, scheme: object) -> None:
        """Show the scheme to those that want it."""
        for criterion in self.criteria:
            if hasattr(criterion, "use"):
                criterion.use(scheme)

    def look(self, view: View | None) -> None:
        """Show the view to those that want it."""
        for criterion in self.criteria:
            if hasattr(criterion, "look"):
                criterion.look(view)

    def mark(self, positions: Doubles, normals: Floats, splits: Small) -> None:
        """Write the largest number of splits of every edge into `splits`, shape (E,)."""
        splits[:] = 0
        for criterion in self.criteria:
            criterion.mark(positions, normals, self._splits)
            np.maximum(splits, self._splits, out=splits)

    def _measure(self, positions: Doubles, normals: Floats, need: Floats) -> None:
        need[:] = -np.inf
        for criterion in self.criteria:
            cast(Measured, criterion).measure(positions, normals, self._need)
            np.maximum(need, self._need, out=need)


CRITERIA: dict[str, Callable[[], Criterion]] = {
    "curvature": Curvature,
    "rest": RestCurvature,
    "bulge": Bulge,
    "silhouette": Silhouette,
    "screen": ScreenEdge,
}


def criterion_of(
    chosen: str | Criterion | Sequence[str | Criterion], normal_drop: NormalDrop
) -> Criterion:
    """Return the criterion of a name, of several, or of an object; `normal_drop` for "normal"."""
    if isinstance(chosen, str) and "+" in chosen:
        chosen = chosen.split("+")
    if isinstance(chosen, str):
        if chosen == "normal":
            return normal_drop
        if chosen not in CRITERIA:
            raise ValueError(
                f"criterion {chosen!r} is unknown; there are {['normal', *CRITERIA]}, several "
                "joined by +, and any object with bind and mark"
            )
        return CRITERIA[chosen]()
    if isinstance(chosen, Sequence):
        if any(isinstance(one, Sequence) and not isinstance(one, str) for one in chosen):
            raise ValueError("criterion: a list must hold names and objects, not other lists")
        return Maximum([criterion_of(one, normal_drop) for one in chosen])
    if isinstance(chosen, type) or not (hasattr(chosen, "bind") and hasattr(chosen, "mark")):
        raise ValueError(
            f"criterion must be a name, an object with bind and mark, or a list, got {chosen!r}"
        )
    return chosen


def _mean_length(connectivity: Connectivity, positions: Doubles) -> np.float32:
    """Mean length of the edges; 1 if there are none."""
    lengths = np.linalg.norm(np.diff(positions[connectivity.edges], axis=1)[:, 0], axis=1)
    return np.float32(lengths.mean() if len(lengths) else 1.0)


@njit
def bulge_sizes(bulges: Floats, sizes: Floats) -> None:
    """Write how far the middle of every edge bulges, shape (E,)."""
    for e in range(sizes.shape[0]):
        x, y, z = bulges[e, 1, 0], bulges[e, 1, 1], bulges[e, 1, 2]
        sizes[e] = np.sqrt(x * x + y * y + z * z)


@njit
def count_turns(sizes: Floats, turns: Floats, scale: np.float32) -> None:
    """Add what the turns of normals count to the sizes of edges, shape (E,), as squares."""
    for e in range(sizes.shape[0]):
        turn = scale * turns[e]
        sizes[e] = np.sqrt(sizes[e] * sizes[e] + turn * turn)


@njit
def hasten(need: Floats, soon: np.float32, ramp: np.float32) -> None:
    """Stretch the needs, shape (E,), so that `soon` becomes `ramp`, where points have grown."""
    if soon >= ramp:
        return
    for e in range(need.shape[0]):
        if need[e] <= np.float32(0.0) or need[e] >= np.float32(1.0):
            continue
        if need[e] < soon:
            need[e] *= ramp / soon
        else:
            rest = (np.float32(1.0) - need[e]) / (np.float32(1.0) - soon)
            need[e] = np.float32(1.0) - (np.float32(1.0) - ramp) * rest


@njit
def splits_of_needs(need: Floats, splits: Small) -> None:
    """Write 0, 1 or 2 into `splits`, shape (E,): above 0 once, above 1 twice."""
    for e in range(need.shape[0]):
        splits[e] = np.uint8(need[e] > np.float32(0.0)) + np.uint8(need[e] > np.float32(1.0))


@njit
def scale_needs(need: Floats, once: np.float32, width: np.float32, most: np.float32) -> None:
    """Turn the measures in `need`, shape (E,), into needs."""
    for e in range(need.shape[0]):
        need[e] = min((need[e] - once) / width, most)


@njit
def arc_heights(
    positions: Doubles, normals: Floats, edges: Unsigned, rest: Floats, heights: Floats
) -> None:
    """Write the height of the arc over every edge, less that at rest, shape (E,)."""
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        at_a = at_b = np.float32(0.0)
        for i in range(3):
            d = np.float32(positions[b, i] - positions[a, i])
            at_a += d * normals[a, i]
            at_b += d * normals[b, i]
        # k L^2 / 8 with k the mean of 2 n_a . d / L^2 and, from the other side, -2 n_b . d / L^2.
        heights[e] = np.float32(0.125) * abs(at_a - at_b) - rest[e]


@njit
def turns_at_silhouette(
    positions: Doubles,
    normals: Floats,
    edges: Unsigned,
    eye: Doubles,
    most: np.float32,
    turns: Floats,
) -> None:
    """Write 1 - the cosine of the normals of every edge, faded out aside of the silhouette.

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
        aside = 0.0 if seen_a * seen_b <= 0.0 else min(abs(seen_a), abs(seen_b))
        turn = min(np.float32(1.0 - cosine), most)
        turns[e] = turn * max(0.0, 1.0 - aside / BAND)


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
