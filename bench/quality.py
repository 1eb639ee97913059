"""How near a refined mesh comes to the true surface, for the triangles that it spends.

A coarse face moves with a dense one (subjects.py). From every dense vertex the nearest point of the
refined coarse mesh is found, exactly; its distance and the angle between the two normals there are
squared, averaged and rooted. Where lips or lids touch, the nearest point of a few per cent lies on
the other one, whatever the mesh is like, and looks the other way: they rule the root mean square of
angles, so that the median is given too.

Edges are split by one of these rules, whose threshold is searched until the mesh has as many
triangles as it may spend:

    drop        the paper's: where the mesh bends more than at rest       refine.NormalDrop
    height      where it is curved, at rest or not         refine.Curvature, relative=False
    bulge       where the scheme would move an edge most                       refine.Bulge
    bulge, grown  the same with blend=True: nothing pops, at the price of triangles that are there
                before they have grown

Beside that everything split twice (blended where that is the default), and subdivision of the whole
mesh by uniform Loop (Loop 1987, Warren's weights) and uniform PN triangles (pn.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.refine.kahler.criterion import Thresholds

from .nearest import nearest_points
from .pn import tessellate
from .subjects import PosePair, Subject, vertex_normals

Array = npt.NDArray[np.float64]
Narrow = npt.NDArray[np.float32]

SCHEMES = ("loop", "cubic", "detail")
BUDGETS = (1.6, 2.0)
"""Triangles of a refined mesh over those of the coarse one, that the targets speak of."""
CURVE_BUDGETS = (1.15, 1.3, 1.6, 2.0, 3.0, 5.0, 7.5)
"""The same for curves."""
RULES = ("drop", "height", "bulge", "bulge, grown")
RATIOS = {"drop": 4.0, "height": 2.4, "bulge": 5.0, "bulge, grown": 5.0}
"""The threshold that splits twice over the one that splits once, as by default."""
SEARCH_STEPS = 18
EVERYWHERE = float("inf")
"""The budget that splits every edge twice."""
COARSE = "coarse"
IDEAL = "ideal"
"""The mesh of `detail` with all its vertices moved to the nearest points of the true surface: about
what such triangles can come to, whatever decides where points go. Not a bound: flat triangles fit a
round surface better with corners a little outside it."""
UNIFORM = ("uniform Loop", "uniform PN")
Key = tuple[str, str, float]
"""Method, rule, budget."""


@dataclass(frozen=True)
class Score:
    """Error of one mesh in one expression."""

    method: str
    """`coarse`, a scheme, or one of UNIFORM."""
    rule: str
    """One of RULES, empty where nothing decides."""
    budget: float
    """Triangles that it was allowed, over the coarse ones; EVERYWHERE, or levels for UNIFORM."""
    expression: str
    triangles: int
    distance: float
    """Root of the mean squared distance [mm]."""
    angle: float
    """Root of the mean squared angle between normals [degrees]."""
    median_angle: float
    """Its median [degrees]."""

    @property
    def key(self) -> Key:
        """What it is a score of, whatever the expression."""
        return self.method, self.rule, self.budget


class _Everywhere:
    """The criterion that splits every edge twice."""

    def bind(self, connectivity: object, rest: object, rest_normals: object) -> None:
        """Need nothing of the mesh."""

    def measure(self, positions: object, normals: object, need: Narrow) -> None:
        """Write needs at which all points have grown."""
        need[:] = 2.0

    def mark(self, positions: object, normals: object, splits: npt.NDArray[np.uint8]) -> None:
        """Write 2 for every edge."""
        splits[:] = 2


def measure(
    subject: Subject,
    *,
    schemes: Sequence[str] = SCHEMES,
    budgets: Iterable[float] = BUDGETS,
    expressions: Sequence[str] | None = None,
    progress: Callable[[str], object] = lambda _: None,
) -> list[Score]:
    """Score all methods in all expressions of `subject` (or in those named).

    `progress`: called with the name of each expression before it is measured.
    """
    budgets = tuple(budgets)
    sliding = [
        _Sliding(subject, scheme, rule)
        for scheme in schemes
        for rule in RULES
        if scheme != "loop" or not rule.startswith("bulge")  # it has no curves that bulge
    ]
    scores = []
    for name in expressions if expressions is not None else subject.poses:
        progress(name)
        scores += _scores_of(subject, sliding, budgets, name, subject.poses[name])
    return scores


def means(scores: Iterable[Score]) -> dict[Key, Score]:
    """The mean over expressions for each method, rule and budget; triangles are rounded."""
    groups: dict[Key, list[Score]] = {}
    for score in scores:
        groups.setdefault(score.key, []).append(score)
    return {
        key: Score(
            *key,
            "mean",
            round(float(np.mean([s.triangles for s in group]))),
            float(np.mean([s.distance for s in group])),
            float(np.mean([s.angle for s in group])),
            float(np.mean([s.median_angle for s in group])),
        )
        for key, group in groups.items()
    }


class _Sliding:
    """One scheme and one rule bound to the coarse mesh, for any number of triangles."""

    def __init__(self, subject: Subject, scheme: str, rule: str) -> None:
        self.scheme, self.rule = scheme, rule
        finer = (subject.rest.dense, subject.dense_faces)
        self._criterion: refine.NormalDrop | refine.Curvature | refine.Bulge
        if rule == "drop":
            self._criterion = refine.NormalDrop()
        elif rule == "height":
            self._criterion = refine.Curvature(relative=False)
        else:
            self._criterion = refine.Bulge()
        options: dict[str, Any] = {"scheme": scheme}
        if scheme == "detail":
            options["detail"] = finer
        faces, rest = subject.coarse_faces, subject.rest.coarse
        blend = rule == "bulge, grown"
        self._refiner = refine.create(
            "kahler", faces, rest, criterion=self._criterion, blend=blend, **options
        )
        self._everywhere = refine.create("kahler", faces, rest, criterion=_Everywhere(), **options)
        self._coarse_count = len(faces)

    def within(self, positions: Array, budget: float) -> refine.RefinedMesh:
        """Refine with at most `budget` times the coarse triangles."""
        if budget == EVERYWHERE:
            return self._everywhere.refine(positions)
        low, high = np.log(1e-6), np.log(20.0)  # thresholds: too many, too few triangles
        for _ in range(SEARCH_STEPS):
            middle = 0.5 * (low + high)
            count = len(self._refined(positions, middle).triangles)
            low, high = (middle, high) if count > budget * self._coarse_count else (low, middle)
        return self._refined(positions, high)

    def _refined(self, positions: Array, logarithm: float) -> refine.RefinedMesh:
        once = float(np.exp(logarithm))
        self._criterion.thresholds = Thresholds(once, RATIOS[self.rule] * once, "distances")
        return self._refiner.refine(positions)


def _scores_of(
    subject: Subject,
    sliding: Sequence[_Sliding],
    budgets: tuple[float, ...],
    expression: str,
    pose: PosePair,
) -> list[Score]:
    normals = vertex_normals(pose.dense, subject.dense_faces)

    def score(method: str, rule: str, budget: float, mesh: Any) -> Score:
        """Measure one refined mesh against the dense pose."""
        positions, mesh_normals, triangles = mesh[:3]
        found = nearest_points(pose.dense, positions, triangles)
        near = np.einsum("ni,nij->nj", found.weights, mesh_normals[triangles[found.triangle]])
        length = np.maximum(np.linalg.norm(near, axis=1), 1e-300)
        cosine = np.einsum("ni,ni->n", near, normals) / length
        angles = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        return Score(
            method,
            rule,
            budget,
            expression,
            len(triangles),
            float(np.sqrt(np.mean(found.distance**2))),
            float(np.sqrt(np.mean(angles**2))),
            float(np.median(angles)),
        )

    faces, rest = subject.coarse_faces, subject.rest.coarse
    coarse_normals = vertex_normals(pose.coarse, faces)
    scores = [score(COARSE, "", 1.0, (pose.coarse, coarse_normals, faces))]
    for one in sliding:
        for budget in budgets:
            mesh = one.within(pose.coarse, budget)
            scores.append(score(one.scheme, one.rule, budget, mesh))
            if one.scheme == "detail":
                moved = _on_truth(mesh, pose, subject, normals)
                scores.append(score(IDEAL, one.rule, budget, moved))
    for one in {one.scheme: one for one in sliding}.values():
        mesh = one.within(pose.coarse, EVERYWHERE)
        scores.append(score(one.scheme, "", EVERYWHERE, mesh))
        if one.scheme == "detail":
            scores.append(score(IDEAL, "", EVERYWHERE, _on_truth(mesh, pose, subject, normals)))
    for levels in (1, 2):
        loop = refine.create("loop", faces, rest, levels=levels).refine(pose.coarse)
        scores.append(score(UNIFORM[0], "", levels, loop))
        pn = tessellate(pose.coarse, coarse_normals, faces, 2**levels)
        scores.append(score(UNIFORM[1], "", levels, pn))
    return scores


def _on_truth(
    mesh: refine.RefinedMesh, pose: PosePair, subject: Subject, normals: Array
) -> tuple[Array, Array, npt.NDArray[np.uint32]]:
    """The mesh with each vertex moved to the nearest point of the true surface."""
    found = nearest_points(mesh.positions, pose.dense, subject.dense_faces)
    corners = subject.dense_faces[found.triangle]
    points, turned = (
        np.einsum("ni,nij->nj", found.weights, values[corners]) for values in (pose.dense, normals)
    )
    return points, turned, mesh.triangles
