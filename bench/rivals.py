"""Refinement compared with other libraries: distance to the true surface, and time.

A coarse mesh, whose vertices lie on a known surface, is refined to four times its triangles, as in
one level of Loop subdivision. For methods with a limit (a length, a tolerance, a number of splits),
the limit is chosen that leads nearest to this number without exceeding it.

    distance   RMS distance from points of the true surface to the exactly nearest points of the
               mesh, in millionths of the diagonal of the surface's box
    first      time from arrays of triangles and positions to arrays of the refined mesh [ms]
    frame      time for further positions, with all data reused that a library can reuse [ms]

Each time is the shortest of many calls, because other work on the machine affects it least. Our
method also makes normals of the refined mesh; the others do not.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from importlib.metadata import version
from typing import NamedTuple

import numpy as np
import trimesh

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.extras import optional_import
from risorius.app.scenes import PlaneScene
from risorius.assets.sheets import CELL_SIZE, SHEET_COLUMNS, SHEET_ROWS, make_grid
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.closest import closest_points
from risorius.refine.kahler.criterion import Thresholds

from .averages import root_mean_square
from .report import processor, table
from .rival_libraries import RIVAL_METHODS, Method, PointsAndFaces, RefinesFrame
from .subjects import Subject

TRIANGLE_RATIO = 4.0
"""Number of triangles of the refined mesh relative to the coarse mesh."""


class Case(NamedTuple):
    """A moved coarse mesh, and points of its true surface."""

    surface: str
    faces: Integers32
    rest: Floats64
    positions: Floats64
    truth: Floats64


class RivalRow(NamedTuple):
    """One method on one surface."""

    surface: str
    coarse_triangles: int
    method: str
    triangles: int
    """Number of triangles of the refined mesh."""
    distance: float
    """Root mean square [millionths of the diagonal]."""
    first: float
    """Set-up and one frame, shortest of all calls [ms]."""
    frame: float
    """A further frame, shortest of all calls [ms]."""


class _Frame:
    """A frame of our refiner, called like a rival's: positions in, positions and triangles out."""

    def __init__(self, refiner: refine.Refiner, criterion: refine.Displacement | None) -> None:
        self._refiner = refiner
        self._criterion = criterion

    def __call__(self, positions: Floats64, limit: float) -> PointsAndFaces:
        """Refine with the criterion's thresholds multiplied by `limit`."""
        if self._criterion is not None:
            self._criterion.thresholds = Thresholds(limit, 5.0 * limit, "measures")
        mesh = self._refiner.refine(positions)
        return mesh.positions, mesh.triangles


def _adaptive(faces: Integers32, rest: Floats64) -> RefinesFrame:
    criterion = refine.Displacement()
    refiner = refine.create("kahler", faces, rest, scheme="cubic", blend=False, criterion=criterion)
    return _Frame(refiner, criterion)


def _everywhere(faces: Integers32, rest: Floats64, scheme: str) -> RefinesFrame:
    splits = np.ones(len(refine.create("none", faces, rest).edges), dtype=np.uint8)
    refiner = refine.create("kahler", faces, rest, scheme=scheme, blend=False, splits=splits)
    return _Frame(refiner, None)


def _unrefined(faces: Integers32, rest: Floats64) -> RefinesFrame:
    return _Frame(refine.create("none", faces, rest), None)


OWN_BINDINGS: Mapping[str, Callable[[Integers32, Floats64], RefinesFrame]] = {
    "not refined": _unrefined,
    "cubic where a split moves most": _adaptive,
    "cubic, all edges": partial(_everywhere, scheme="cubic"),
    "Loop, all edges": partial(_everywhere, scheme="loop"),
}
OWN_METHODS: Sequence[Method] = tuple(
    Method(f"risorius, {title}", "risorius", "risorius.refine", bind, bind is _adaptive)
    for title, bind in OWN_BINDINGS.items()
)


def cases(subjects: Sequence[tuple[str, Subject]]) -> Iterator[Case]:
    """A sphere, the plane under its full sine, and each subject in its most moved pose."""
    coarse = trimesh.creation.icosphere(2)
    faces = np.array(coarse.faces, dtype=np.int32)
    points = np.array(coarse.vertices)
    fine = trimesh.creation.icosphere(5)
    yield Case("sphere", faces, points, points, np.array(fine.vertices))

    plane = PlaneScene()
    plane.pose({"amplitude": 1.0})
    plane.step(1.0 / 30.0)
    fineness = 12  # cells of the true sine per cell of the plane, in each direction
    flat, _ = make_grid(SHEET_COLUMNS * fineness, SHEET_ROWS * fineness, CELL_SIZE / fineness)
    sine, _ = plane.waved(flat)
    yield Case("sine plane", plane.faces, plane.rest_positions, plane.positions.copy(), sine)

    for name, subject in subjects:
        rest = subject.rest.coarse
        motion = {name: np.abs(pose.coarse - rest).mean() for name, pose in subject.poses.items()}
        most = max(motion, key=motion.__getitem__)
        pose = subject.poses[most]
        yield Case(f"{name}, {most}", subject.coarse_faces, rest, pose.coarse, pose.dense)


def available() -> tuple[list[Method], list[str]]:
    """Our methods, the methods of installed libraries, and a line for each missing library."""
    found = list(OWN_METHODS)
    skipped = {}
    for method in RIVAL_METHODS:
        try:
            optional_import(method.module, method.package, "rivals", package=method.package)
        except UserError as error:
            skipped[method.package] = f"skipped: {error}"
        else:
            found.append(method)
    return found, list(skipped.values())


def measure(
    case: Case, methods: Sequence[Method], seconds: float
) -> tuple[list[RivalRow], list[str]]:
    """Measure the methods: rows, and a line for each method that does not accept the mesh.

    `seconds`: time for each, with at least five calls.
    """
    rows = []
    skipped = []
    for method in methods:
        try:
            limit = _limit_for_ratio(case, method) if method.has_limit else 0.0
            frame = partial(method.bind(case.faces, case.rest), case.positions, limit)
            surface = frame()
        except (RuntimeError, ValueError) as error:
            skipped.append(f"skipped: {method.title} of the {case.surface}: {error}")
            continue
        distance = _distance_from_truth(case, surface)
        # Not interleaved: threads of one library would slow the next library.
        time_of_each = 0.5 * seconds / len(methods)
        first = _shortest(partial(_refined_by, case, method, limit), time_of_each)
        further = _shortest(frame, time_of_each)
        kept = case.surface, len(case.faces), method.title, len(surface[1])
        rows.append(RivalRow(*kept, distance, first, further))
    return rows, skipped


def report(rows: Sequence[RivalRow], methods: Sequence[Method]) -> str:
    """The text to print."""
    packages = dict.fromkeys(method.package for method in methods)
    lines = [
        f"Refined to {TRIANGLE_RATIO:g} times the triangles, on all cores of {processor()}.",
        ", ".join(f"{package} {version(package)}" for package in packages),
    ]
    for surface in dict.fromkeys(row.surface for row in rows):
        group = [row for row in rows if row.surface == surface]
        cells = [(row.method, row.triangles, *row[4:]) for row in group]
        columns = "method:<43|triangles:9d|distance:8.0f|first ms:9.3f|frame ms:9.3f"
        title = f"{surface}, {group[0].coarse_triangles} triangles"
        lines += ["", title, *table(columns, cells, indent="  ")]
    return "\n".join(lines)


def _limit_for_ratio(case: Case, method: Method) -> float:
    """The limit that leads to TRIANGLE_RATIO times the triangles, or slightly fewer."""
    frame = method.bind(case.faces, case.rest)

    def is_over(limit: float) -> bool:
        return len(frame(case.positions, limit)[1]) > TRIANGLE_RATIO * len(case.faces)

    # Begin with few triangles: a limit that is far too low may lead to billions.
    high = 10.0 * float(np.linalg.norm(np.ptp(case.positions, axis=0)))
    smallest = 1e-9 * high
    while high > smallest and not is_over(0.5 * high):
        high *= 0.5
    low = 0.5 * high
    search_steps = 12
    for _ in range(search_steps):
        middle = (low * high) ** 0.5
        if is_over(middle):
            low = middle
        else:
            high = middle
    return high


def _distance_from_truth(case: Case, surface: PointsAndFaces) -> float:
    """Root mean square distance from the true surface [millionths of the diagonal]."""
    points, triangles = surface
    away = closest_points(case.truth, points.astype(np.float64), triangles.astype(np.int32))
    diagonal = float(np.linalg.norm(np.ptp(case.truth, axis=0)))
    return 1e6 * root_mean_square(away.distances) / diagonal


def _refined_by(case: Case, method: Method, limit: float) -> PointsAndFaces:
    return method.bind(case.faces, case.rest)(case.positions, limit)


def _shortest(call: Callable[[], object], seconds: float) -> float:
    """The shortest time [ms] of at least five calls, or of as many as fit into `seconds`."""
    fewest_rounds = 5
    times: list[float] = []
    while len(times) < fewest_rounds or sum(times) < seconds:
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)
