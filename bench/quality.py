"""Measure the error of refined meshes and of their pictures, against the number of triangles.

A coarse and a dense mesh of a face move in the same way (subjects.py). The pairs are the built-in
head and its mesh with 16 times the triangles, or a decimated scan and the scan itself. The coarse
mesh is refined by all methods of MEASURED_METHODS, and three errors are reported:

    distance   RMS distance from every dense vertex to the exactly nearest point of the refined mesh
    picture    RMS difference in grey levels from pictures of the dense mesh. Both meshes are drawn
               from MEASURED_VIEWS as plain clay without texture or shadows, shaded by the mesh's
               normals
    outline    pixels that only one of the two meshes covers. Pictures are drawn SUPERSAMPLING times
               larger, so that an error of a fraction of a pixel counts as this fraction

Edges are split by the paper's criterion `normal`, or by `displacement`, which splits the edges that
the scheme would move most. Both thresholds are scaled by one factor until the mesh has BUDGET times
the coarse triangles. The other methods are the application's preset with its own thresholds, the
split of all edges once or twice, and uniform Loop subdivision.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.refining.presets import FIRST_PRESET, PRESETS
from risorius.geometry.arrays import Flags, Floats32, Floats64
from risorius.geometry.closest import closest_points
from risorius.geometry.normals import vertex_normals
from risorius.refine.kahler.criterion import Thresholds

from .averages import root_mean_square
from .canvas import CLAY_STYLE, Canvas, Drawing
from .report import Target, at_least, table
from .subjects import Subject

AnyMesh = Any
"""Positions [mm] and unit normals, shape (N, 3), and triangles, shape (M, 3); RefinedMesh fits."""

PICTURE_SIDE = 480  # width and height of a picture [pixels]
SUPERSAMPLING = 2
MEASURED_VIEWS = ("front", "three-quarter", "profile")
STATIC_METHOD = "static"
BEST_METHOD = "cubic displacement 2x"
PRESET_OPTIONS = PRESETS[FIRST_PRESET]["face"].options_for("kahler")


def _sliding_method(scheme: str, **more: Any) -> tuple[str, dict[str, Any]]:
    return "sliding", {"scheme": scheme, "criterion": refine.Displacement, **more}


MEASURED_METHODS: Mapping[str, tuple[str, dict[str, Any]]] = {
    STATIC_METHOD: ("none", {}),
    "loop normal 2x": _sliding_method("loop", criterion=refine.NormalDrop),
    BEST_METHOD: _sliding_method("cubic", blend=False),
    "cubic displacement, blended 2x": _sliding_method("cubic", blend=True),
    "detail displacement 2x": _sliding_method("detail", blend=False),
    "detail displacement, blended 2x": _sliding_method("detail", blend=True),
    f"{FIRST_PRESET}, as set": (
        "kahler",
        {"scheme": PRESET_OPTIONS["scheme"], "criterion": PRESET_OPTIONS["criterion"]},
    ),
    "cubic once": ("everywhere", {"scheme": "cubic", "splits": 1}),
    "cubic twice": ("everywhere", {"scheme": "cubic", "splits": 2}),
    "detail twice": ("everywhere", {"scheme": "detail", "splits": 2}),
    "uniform Loop 16x": ("loop", {"levels": 2}),
}
"""Title -> refiner and options. "sliding" keeps the budget, "everywhere" splits all edges."""


class Score(NamedTuple):
    """Errors of one mesh in one expression."""

    method: str
    expression: str
    triangles: float
    """Number of triangles relative to the coarse mesh."""
    distance: float
    """Root of the mean squared distance [mm]."""
    picture: float
    """Root mean square of grey levels, 0..255, over the pixels that either mesh covers."""
    outline: float
    """Pixels that one mesh covers and the other does not, mean over views."""


class Everywhere(refine.Criterion):
    """The criterion that splits every edge once or twice."""

    def __init__(self, splits: int) -> None:
        self._splits = splits

    def measure(self, positions: object, normals: object, metric: Floats32) -> None:
        """Write the metric of every edge: its number of splits, so that blending is complete."""
        metric[:] = self._splits


def measure(
    subject: Subject,
    expressions: Collection[str] = (),
    progress: Callable[[str], object] = lambda _: None,
    methods: Collection[str] = tuple(MEASURED_METHODS),
) -> list[Score]:
    """Score methods in the named expressions of a subject, or in all.

    `progress`: called with the name of each expression before its measurement.
    """
    scores = []
    shown = np.concatenate([pose.dense for pose in (subject.rest, *subject.poses.values())])
    cameras = [render.OrbitCamera.framing(shown, view=view) for view in MEASURED_VIEWS]
    bound = {title: _bound_method(subject, *MEASURED_METHODS[title]) for title in methods}
    with Canvas((PICTURE_SIDE * SUPERSAMPLING, PICTURE_SIDE * SUPERSAMPLING), samples=0) as canvas:
        for name in expressions or subject.poses:
            progress(name)
            pose = subject.poses[name]
            faces = subject.dense_faces
            dense = pose.dense, vertex_normals(pose.dense, faces), faces
            truth = _grey_pictures(canvas, cameras, dense)
            for method, make in bound.items():
                mesh = make(pose.coarse)
                positions, _, triangles, *_ = mesh
                distances = closest_points(pose.dense, positions, triangles).distances
                ratio = len(triangles) / len(subject.coarse_faces)
                distance = root_mean_square(distances)
                errors = _differences(_grey_pictures(canvas, cameras, mesh), truth)
                scores.append(Score(method, name, ratio, distance, *errors))
    return scores


def _bound_method(
    subject: Subject, refiner: str, options: Mapping[str, Any]
) -> Callable[[Floats64], AnyMesh]:
    """Bind a method to the subject's coarse mesh: a function from positions (V, 3) to a mesh."""
    own = dict(options)
    if own.get("scheme") == "detail":
        own["scheme"] = refine.DetailScheme((subject.rest.dense, subject.dense_faces))
    if refiner == "sliding":
        own["criterion"] = own["criterion"]()
    if refiner == "everywhere":
        splits = own.pop("splits")
        own |= {"criterion": Everywhere(splits), "blend": splits == 2}
    kind = refiner if refiner in ("none", "loop") else "kahler"
    bound = refine.create(kind, subject.coarse_faces, subject.rest.coarse, **own)
    if refiner == "sliding":
        triangle_ratio = 2.0
        most = triangle_ratio * len(subject.coarse_faces)
        return lambda positions: _refined_to_count(bound, own["criterion"], positions, most)
    return bound.refine


def _refined_to_count(
    refiner: refine.Refiner, criterion: Any, positions: Floats64, most: float
) -> refine.RefinedMesh:
    """Refine with both thresholds scaled so that there are `most` triangles or slightly fewer."""
    usual = type(criterion)().thresholds

    def refined(logarithm: float) -> refine.RefinedMesh:
        """The mesh with thresholds scaled by exp(logarithm)."""
        scale = float(np.exp(logarithm))
        once = scale * float(usual.once)
        twice = scale * float(usual.twice)
        criterion.thresholds = Thresholds(once, twice, "measures")
        return refiner.refine(positions)

    scales = (1e-5, 1e3)  # of thresholds: the first gives too many triangles, the second too few
    low, high = np.log(scales)
    search_steps = 18
    for _ in range(search_steps):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if len(refined(middle).triangles) > most else (low, middle)
    return refined(high)


def _grey_pictures(
    canvas: Canvas, cameras: Sequence[render.OrbitCamera], mesh: AnyMesh
) -> tuple[Floats64, Flags]:
    """Grey levels over the background (views, N, N), and flags of covered fine pixels.

    N = PICTURE_SIDE. The flags have shape (views, S, S), where S = SUPERSAMPLING * N.
    """
    on_black = replace(CLAY_STYLE, bumps=0.0, background=render.BLACK)
    drawings = [Drawing(camera, on_black) for camera in cameras]
    x, normals, faces = mesh[:3]
    fine = np.stack([canvas.draw_surface(x, normals, faces, each) for each in drawings]).mean(3)
    covered = fine > 0.0  # lit clay is never black, but an empty frame is
    level_behind = 215.0  # grey level of the background, about that of the window's
    return _block_means(np.where(covered, fine, level_behind)), covered


def _differences(
    shots: tuple[Floats64, Flags], truth: tuple[Floats64, Flags]
) -> tuple[float, float]:
    """RMS difference in grey levels, and the mean number of wrong outline pixels per view."""
    (grey, covered) = shots
    (true_grey, true_covered) = truth
    either = _block_means(covered | true_covered) > 0.0
    wrong = np.count_nonzero(covered != true_covered) / SUPERSAMPLING**2 / len(MEASURED_VIEWS)
    return root_mean_square((grey - true_grey)[either]), wrong


def _block_means(fine: npt.NDArray[Any]) -> Floats64:
    """Average the fine pixels of each pixel."""
    return np.asarray(
        fine.reshape(-1, PICTURE_SIDE, SUPERSAMPLING, PICTURE_SIDE, SUPERSAMPLING).mean(axis=(2, 4))
    )


def means(scores: Sequence[Score]) -> dict[str, Score]:
    """The scores of each method, averaged over expressions."""
    found = {}
    for method in dict.fromkeys(score.method for score in scores):
        rows = [score[2:] for score in scores if score.method == method]
        found[method] = Score(method, "mean", *np.mean(rows, axis=0).tolist())
    return found


def report(scores: Sequence[Score]) -> str:
    """The text to print."""
    average = means(scores)
    static = average[STATIC_METHOD]
    rows = [
        (
            *(method, found.triangles),
            *(found.distance, f"{_gain(found, static, 'distance'):.1f}%"),
            *(found.picture, f"{_gain(found, static, 'picture'):.1f}%"),
            found.outline,
        )
        for method, found in average.items()
    ]
    columns = "mean over expressions:<31|x tri:5.2f|mm:6.3f|better:>6|levels:6.2f|better:>6"
    return "\n".join(
        [
            *table(f"{columns}|outline:7.0f", rows),
            "",
            "better   than static: per cent of error less, in the mean",
            "levels   RMS of grey levels beside pictures of the dense mesh, three views, 480 x 480",
            "outline  pixels covered by one mesh and not by the other, of one view",
        ]
    )


def _gain(found: Score, static: Score, name: str) -> float:
    return 100.0 * (1.0 - float(getattr(found, name)) / float(getattr(static, name)))


def targets(scores: Sequence[Score]) -> list[Target]:
    """The targets of the scheme `cubic` with `displacement`, at twice the triangles."""
    average = means(scores)
    names = ("distance", "picture")
    gains = {name: _gain(average[BEST_METHOD], average[STATIC_METHOD], name) for name in names}
    least_gain = 20.0  # [%] of the error of static
    return [
        at_least(f"{name}: less than static", gain, least_gain, " %")
        for name, gain in gains.items()
    ]
