"""What a frame of refinement costs, beside what others offer, all in one run.

Kähler, Haber, Seidel 2003, Table 1 compares the static with the refined mesh. Here the time of the
refiner is taken, from positions to a filled stream, everything counted: normals, criterion, points,
table, output and the call from Python. Meshes: the built-in face in six full expressions with the
default thresholds, and large ones (waving_meshes.py) with thresholds that split 10, 50 or 100 %
of the edges.

The methods of a mesh are run interleaved, forwards and backwards in turn, with garbage collection
off, and medians are reported: on a shared machine times drift by a third within a run, and so only
rows of one mesh can be compared. The best time is reported beside the median for the same reason.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, sim

from ..subjects import settled_positions
from ..timing import interleaved
from .peers import peers_for
from .starts import Starts, measure_starts
from .waving_meshes import Load, waving_mesh

Points = npt.NDArray[np.float64]

FULL_EXPRESSIONS = ("joy", "sadness", "surprise", "anger", "disgust", "fear")
SETTLED = 90  # steps of 1/60 s after which the face stands still
SHARES = {10: (0.90, 0.97), 50: (0.50, 0.85), 100: (0.0, 0.70)}
"""Per cent of the edges that are split -> quantiles of the drops that are the two thresholds."""
TRIANGLE_COUNTS = {"2k": 2_000, "20k": 20_000, "200k": 200_000, "1M": 1_000_000}
SIZES = ("face", "20k", "200k", "1M")
"""What is measured unless told; 2k is for a quick look."""
LARGE = 500_000  # triangles from which on two frames must do
FEWEST_ROUNDS, MOST_ROUNDS = 5, 200
SECONDS = 7.0  # of timing for each mesh
METHODS: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("kahler", {}),
    ("kahler, blend", {"blend": True}),
    ("kahler, coherent", {"coherent": True}),
    ("cubic", {"scheme": "cubic"}),
    ("cubic, no blend", {"scheme": "cubic", "blend": False}),
    ("detail", {"scheme": "detail"}),
    ("detail, no blend", {"scheme": "detail", "blend": False}),
)
"""Our methods on the face: the paper's, and what each scheme and each option costs."""


@dataclass(frozen=True)
class Row:
    """One method on one mesh."""

    mesh: str
    method: str
    is_peer: bool
    triangles_in: int
    triangles_out: float
    """Mean over the frames."""
    milliseconds: float
    """Time of a frame, median over the rounds [ms]."""
    best_milliseconds: float
    """Time of a frame, shortest of all rounds [ms]."""

    @property
    def nanoseconds_per_triangle(self) -> float:
        """Median time per output triangle [ns]."""
        return 1e6 * self.milliseconds / max(self.triangles_out, 1.0)


@dataclass
class Report:
    """All that one run found."""

    rows: list[Row] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    starts: Starts | None = None


@dataclass(frozen=True)
class _Case:
    method: str
    is_peer: bool
    triangles: float
    call: Callable[[Points], object]
    frames: Sequence[Points]

    def run(self) -> None:
        """Go through all frames."""
        for frame in self.frames:
            self.call(frame)


def measure(
    *,
    sizes: Sequence[str] = SIZES,
    seconds: float = SECONDS,
    starts: bool = True,
    progress: Callable[[str], object] = lambda _: None,
) -> Report:
    """Measure each of `sizes`, for about `seconds` each; `starts`: and how long a start takes.

    Raises ValueError for a size that there is not.
    """
    known = ("face", *TRIANGLE_COUNTS)
    unknown = [size for size in sizes if size not in known]
    if unknown:
        raise ValueError(f"unknown size {unknown[0]!r}; there are {', '.join(known)}")
    report = Report()
    for size in sizes:
        progress(size)
        load = load_of(size)
        cases = _face_cases(load, report) if size == "face" else _waving_cases(load, report)
        report.rows += _timed(load, cases, seconds)
    if starts:
        progress("starts")
        report.starts = measure_starts()
    return report


def load_of(size: str) -> Load:
    """The mesh of a size and the frames that it goes through."""
    if size == "face":
        return face_load()
    count = TRIANGLE_COUNTS[size]
    return waving_mesh(size, count, frame_count=4 if count < LARGE else 2)


def face_load() -> Load:
    """The built-in face in each of the six basic expressions, at full strength."""
    head = assets.load("head")
    simulation = sim.create(head)
    frames = [
        settled_positions(simulation, head.expressions[name], SETTLED) for name in FULL_EXPRESSIONS
    ]
    return Load("face", head.faces, head.vertices, frames)


def method_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options of one of METHODS on the built-in face: detail needs its finer mesh."""
    if options.get("scheme") != "detail":
        return dict(options)
    fine = assets.load("head").finer(1)
    return {**options, "detail": (fine.vertices, fine.faces)}


def _face_cases(load: Load, report: Report) -> list[_Case]:
    static = refine.create("none", load.faces, load.rest)
    cases = [_own("none", static, load)]
    for method, options in METHODS:
        refiner = refine.create("kahler", load.faces, load.rest, **method_options(options))
        cases.append(_own(method, refiner, load))
    for levels in (1, 2):
        uniform = refine.create("loop", load.faces, load.rest, levels=levels)
        cases.append(_own(f"uniform Loop {levels}x", uniform, load))
    return cases + _peer_cases(load, report, cases[1].triangles)


def _waving_cases(load: Load, report: Report) -> list[_Case]:
    cases = []
    for share, (once, twice) in thresholds_of(load).items():
        refiner = refine.create(
            "kahler", load.faces, load.rest, threshold_once=once, threshold_twice=twice
        )
        cases.append(_own(f"kahler {share} %", refiner, load))
    return cases + _peer_cases(load, report, cases[0].triangles)


def _peer_cases(load: Load, report: Report, target: float) -> list[_Case]:
    peers, missing = peers_for(load, round(target))
    report.missing += [line for line in missing if line not in report.missing]
    return [_Case(p.name, True, p.triangles, p.call, load.frames) for p in peers]


def _own(method: str, refiner: refine.Refiner, load: Load) -> _Case:
    """One of our refiners over all frames; the first pass compiles or loads kernels, and counts."""
    counts = [len(refiner.refine(frame).triangles) for frame in load.frames]
    return _Case(method, False, float(np.mean(counts)), refiner.refine, load.frames)


def thresholds_of(load: Load) -> dict[int, tuple[float, float]]:
    """Thresholds that split SHARES of the edges, by the drops of all frames."""
    plain = refine.create("none", load.faces, load.rest)
    a, b = plain.edges.T
    at_rest = _dots(plain.refine(load.rest).normals, a, b)
    drops = np.concatenate(
        [at_rest - _dots(plain.refine(frame).normals, a, b) for frame in load.frames]
    )
    found = {}
    for share, quantiles in SHARES.items():
        once, twice = (max(0.0, float(np.quantile(drops, q))) for q in quantiles)
        found[share] = (once, twice)
    return found


def _dots(
    normals: npt.NDArray[np.float32], a: npt.NDArray[np.int32], b: npt.NDArray[np.int32]
) -> npt.NDArray[np.float32]:
    return np.asarray(np.einsum("ei,ei->e", normals[a], normals[b]))


def _timed(load: Load, cases: Sequence[_Case], seconds: float) -> list[Row]:
    """Rows of all cases, in as many rounds as fit the time."""
    start = time.perf_counter()
    for case in cases:
        case.run()
    spent = time.perf_counter() - start
    rounds = int(np.clip(seconds / max(spent, 1e-9), FEWEST_ROUNDS, MOST_ROUNDS))
    times = interleaved([case.run for case in cases], rounds) / len(load.frames)
    return [
        Row(
            load.name,
            case.method,
            case.is_peer,
            len(load.faces),
            case.triangles,
            1e3 * float(np.median(column)),
            1e3 * float(np.min(column)),
        )
        for case, column in zip(cases, times.T, strict=True)
    ]
