"""What `risorius bench quality` compares: ways to make triangles of a coarse mesh.

Edges are split by one of CRITERIA, whose thresholds are scaled together until the mesh has as many
triangles as it may spend:

    normal      the paper's: where the mesh bends more than at rest       refine.NormalDrop
    curvature   where it is curved, at rest or not         refine.Curvature, relative=False
    screen      edges that are long on the screen, as Blender dices            refine.ScreenEdge
    displacement    where the scheme would move an edge most              refine.Displacement

and `RULE, blended` is the same with blend=True: nothing pops, at the price of triangles that are
there before they have grown. Beside these stand the look of the application, with the
thresholds that the refiner has by itself; everything split once or twice; and peers that refine the
whole mesh: Loop subdivision (Loop 1987), its limit surface (loop_limit.py), curved triangles
(patches.py).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.app.refining.presets import FIRST_PRESET, PRESETS
from risorius.refine.kahler.criterion import Thresholds

from ..subjects import Points, Subject
from .loop_limit import LoopLimit
from .patches import phong_triangles, pn_triangles
from .pictures import Mesh, shaded

Narrow = npt.NDArray[np.float32]

BLENDED = ", blended"
SCHEMES: Mapping[str, tuple[str, ...]] = {
    "loop": ("screen", "normal"),
    "cubic": ("normal", "curvature", "screen", "displacement", "displacement, blended"),
    "detail": ("displacement", "displacement, blended"),
}
"""Every scheme with the rules that split its edges."""
CRITERIA: Mapping[str, Callable[[], Any]] = {
    "normal": refine.NormalDrop,
    "curvature": lambda: refine.Curvature(relative=False),
    "screen": refine.ScreenEdge,
    "displacement": refine.Displacement,
}
_TOLD = PRESETS[FIRST_PRESET]["face"].told("kahler")
LOOK: tuple[str, str] = _TOLD["scheme"], _TOLD["criterion"]
"""Scheme and criterion by which the application shows a head, with thresholds as they are."""
UNIFORM = ("uniform Loop", "Loop limit", "PN", "Phong")
STATIC = "static"
LEVELS = (1, 2)
"""How often whole meshes are refined."""
SEARCH_STEPS = 18
SCALES = (1e-5, 1e3)
"""Of thresholds: too many, too few triangles."""
ONCE = 4.0
"""The budget that splits every edge once, without blending: as many triangles as one level."""
EVERYWHERE = float("inf")
"""The budget that splits every edge twice."""
AS_SET = 0.0
"""The budget of thresholds as they are."""

Key = tuple[str, str, float]
"""Method, rule, budget: triangles that it may spend, over those of the coarse mesh."""


@dataclass(frozen=True)
class Method:
    """One way to make triangles."""

    key: Key
    make: Callable[[Points], Mesh]
    """Of positions, shape (V, 3); views of buffers that the next call overwrites."""
    refiner: refine.Refiner | None = None
    """What refines frames with the thresholds that `make` found last; None: nothing is decided."""


def methods_for(
    subject: Subject, schemes: Iterable[str], budgets: Collection[float], view: refine.View
) -> list[Method]:
    """Bind everything to the coarse mesh of `subject`; `view`: of criteria that ask for one."""
    faces, rest = subject.coarse_faces, subject.rest.coarse
    static = refine.create("none", faces, rest)
    bound = [Method((STATIC, "", 1.0), static.refine, static)]
    for scheme in schemes:
        options: dict[str, Any] = {"scheme": scheme}
        if scheme == "detail":
            options["detail"] = subject.rest.dense, subject.dense_faces

        def bind(more: dict[str, Any]) -> refine.Refiner:
            return refine.create("kahler", faces, rest, **options, **more)  # noqa: B023

        for rule in SCHEMES[scheme]:
            criterion = CRITERIA[rule.removesuffix(BLENDED)]()
            refiner = bind({"criterion": criterion, "blend": rule.endswith(BLENDED)})
            sliding = _Sliding(refiner, criterion, len(faces), view)
            for budget in budgets:
                make = sliding.within(budget)
                bound.append(Method((scheme, rule, budget), make, refiner))
        if scheme == LOOK[0]:
            refiner = bind({"criterion": LOOK[1]})
            bound.append(Method((*LOOK, AS_SET), refiner.refine, refiner))
        once = bind({"criterion": Everywhere(1), "blend": False})
        twice = bind({"criterion": Everywhere(2)})
        bound += [
            Method((scheme, "", ONCE), once.refine, once),
            Method((scheme, "", EVERYWHERE), twice.refine, twice),
        ]
    for levels in LEVELS:
        makers = _whole(faces, rest, levels)
        bound += [Method((name, "", 4.0**levels), makers[name]) for name in UNIFORM]
    return bound


def _whole(
    faces: npt.NDArray[np.integer], rest: Points, levels: int
) -> dict[str, Callable[[Points], Mesh]]:
    """Peers that refine the whole mesh."""
    pieces = 2**levels
    return {
        "uniform Loop": refine.create("loop", faces, rest, levels=levels).refine,
        "Loop limit": LoopLimit(faces, len(rest), levels).mesh,
        "PN": lambda points: pn_triangles(*shaded(points, faces), pieces),
        "Phong": lambda points: phong_triangles(*shaded(points, faces), pieces),
    }


class Everywhere(refine.Criterion):
    """The criterion that splits every edge once or twice."""

    def __init__(self, splits: int) -> None:
        self._splits = splits

    def measure(self, positions: object, normals: object, metric: Narrow) -> None:
        """Write metrics at which all points have grown."""
        metric[:] = self._splits


class _Sliding:
    """One refiner whose thresholds slide, for any number of triangles."""

    def __init__(
        self, refiner: refine.Refiner, criterion: Any, coarse_count: int, view: refine.View
    ) -> None:
        self._refiner, self._criterion = refiner, criterion
        self._coarse_count, self._view = coarse_count, view
        self._usual = criterion.thresholds

    def within(self, budget: float) -> Callable[[Points], refine.RefinedMesh]:
        """What refines with at most `budget` times the coarse triangles."""

        def make(positions: Points) -> refine.RefinedMesh:
            """Search for thresholds, and refine with them."""
            low, high = np.log(SCALES)
            for _ in range(SEARCH_STEPS):
                middle = 0.5 * (low + high)
                count = len(self._refined(positions, middle).triangles)
                low, high = (middle, high) if count > budget * self._coarse_count else (low, middle)
            return self._refined(positions, high)

        return make

    def _refined(self, positions: Points, logarithm: float) -> refine.RefinedMesh:
        scale = float(np.exp(logarithm))
        once, twice = scale * float(self._usual.once), scale * float(self._usual.twice)
        self._criterion.thresholds = Thresholds(once, twice, "measures")
        return self._refiner.refine(positions, view=self._view)
