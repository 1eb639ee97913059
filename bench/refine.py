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
from itertools import groupby
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, sim

from .peers import peers_for
from .report import processor, table
from .subjects import SETTLE, settled_positions
from .timing import interleaved
from .waving_meshes import Load, waving_mesh

Points = npt.NDArray[np.float64]

FULL_EXPRESSIONS = ("joy", "sadness", "surprise", "anger", "disgust", "fear")
SHARES = {10: (0.90, 0.97), 50: (0.50, 0.85), 100: (0.0, 0.70)}
"""Per cent of the edges that are split -> quantiles of the drops that are the two thresholds."""
TRIANGLE_COUNTS = {"2k": 2_000, "20k": 20_000, "200k": 200_000, "1M": 1_000_000}
SIZES = ("face", "20k", "200k", "1M")
"""What is measured unless told; 2k is for a quick look."""
LARGE = 500_000  # triangles from which on two frames must do
FEWEST_ROUNDS, MOST_ROUNDS = 5, 200
METHODS: Mapping[str, Mapping[str, Any]] = {
    "kahler": {},
    "kahler, blend": {"blend": True},
    "kahler, coherent": {"coherent": True},
    "cubic": {"scheme": "cubic"},
    "cubic, no blend": {"scheme": "cubic", "blend": False},
    "detail": {"scheme": "detail"},
    "detail, no blend": {"scheme": "detail", "blend": False},
}
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


@dataclass(frozen=True)
class Report:
    """All that one run found."""

    processor: str
    rows: list[Row] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    """A line for each peer that is not installed."""


@dataclass(frozen=True)
class _Case:
    """A method and the mean number of its triangles."""

    method: str
    triangles: float
    call: Callable[[Points], object]
    is_peer: bool = False


def measure(
    sizes: Sequence[str] = SIZES,
    seconds: float = 7.0,
    progress: Callable[[str], object] = lambda _: None,
) -> Report:
    """Measure each of `sizes`, "face" or a key of TRIANGLE_COUNTS, for about `seconds` each."""
    report = Report(processor())
    for size in sizes:
        progress(size)
        load = load_of(size)
        cases = _face_cases(load) if size == "face" else _waving_cases(load)
        target = next(case.triangles for case in cases if case.method.startswith("kahler"))
        peers, missing = peers_for(load, round(target))
        cases += [_Case(peer.name, peer.triangles, peer.call, is_peer=True) for peer in peers]
        report.missing.extend(line for line in missing if line not in report.missing)
        report.rows.extend(_timed(load, cases, seconds))
    return report


def load_of(size: str) -> Load:
    """The mesh of a size and the frames that it goes through."""
    if size != "face":
        count = TRIANGLE_COUNTS[size]
        return waving_mesh(size, count, frame_count=4 if count < LARGE else 2)
    head = assets.load("head")
    simulation = sim.create(head)
    frames = [
        settled_positions(simulation, head.expressions[name], SETTLE) for name in FULL_EXPRESSIONS
    ]
    return Load("face", head.faces, head.vertices, frames)


def _face_cases(load: Load) -> list[_Case]:
    fine = assets.load("head").finer(1)
    cases = [_own("none", load, "none")]
    for method, options in METHODS.items():
        more = {"detail": (fine.vertices, fine.faces)} if "detail" in method else {}
        cases.append(_own(method, load, "kahler", **options, **more))
    return [*cases, *(_own(f"uniform Loop {k}x", load, "loop", levels=k) for k in (1, 2))]


def _waving_cases(load: Load) -> list[_Case]:
    """The paper's method with thresholds that split SHARES of the edges, by all frames' drops."""
    plain = refine.create("none", load.faces, load.rest)
    a, b = plain.edges.T

    def cosines(positions: Points) -> npt.NDArray[np.float32]:
        normals = plain.refine(positions).normals
        return np.asarray(np.einsum("ei,ei->e", normals[a], normals[b]))

    at_rest = cosines(load.rest)
    drops = np.concatenate([at_rest - cosines(frame) for frame in load.frames])
    cases = []
    for share, quantiles in SHARES.items():
        once, twice = (max(0.0, float(np.quantile(drops, q))) for q in quantiles)
        title = f"kahler {share} %"
        cases.append(_own(title, load, "kahler", threshold_once=once, threshold_twice=twice))
    return cases


def _own(method: str, load: Load, refiner: str, **options: Any) -> _Case:
    """One of our refiners over all frames; the first pass compiles or loads kernels, and counts."""
    bound = refine.create(refiner, load.faces, load.rest, **options)
    counts = [len(bound.refine(frame).triangles) for frame in load.frames]
    return _Case(method, float(np.mean(counts)), bound.refine)


def _timed(load: Load, cases: Sequence[_Case], seconds: float) -> list[Row]:
    """Rows of all cases, in as many rounds as fit the time."""

    def run(case: _Case) -> None:
        for frame in load.frames:
            case.call(frame)

    calls = [lambda case=case: run(case) for case in cases]
    start = time.perf_counter()
    for call in calls:
        call()
    spent = time.perf_counter() - start
    rounds = int(np.clip(seconds / max(spent, 1e-9), FEWEST_ROUNDS, MOST_ROUNDS))
    times = 1e3 * interleaved(calls, rounds) / len(load.frames)
    return [
        Row(
            *(load.name, case.method, case.is_peer, len(load.faces), case.triangles),
            *(float(np.median(column)), float(np.min(column))),
        )
        for case, column in zip(cases, times.T, strict=True)
    ]


def report(found: Report) -> str:
    """The text to print."""
    lines = [
        f"Refinement, serial, one core of {found.processor}: medians of interleaved rounds;",
        "positions in, filled render buffers out (normals, criterion, points, table, output).",
        "Compare rows of one mesh only. * is somebody else's; uniform ones make every triangle 4 "
        "or 16.",
    ]
    columns = "method:<27|out:9.0f|ms:9.4f|best:9.4f|ns/tri:7.1f"
    for mesh, group in groupby(found.rows, key=lambda row: row.mesh):
        rows = list(group)
        cells = [
            (
                row.method + (" *" if row.is_peer else ""),
                *(row.triangles_out, row.milliseconds, row.best_milliseconds),
                row.nanoseconds_per_triangle,
            )
            for row in rows
        ]
        title = f"{mesh}, {rows[0].triangles_in} triangles"
        lines += ["", title, *table(columns, cells, indent="  ")]
    return "\n".join([*lines, *(["", *found.missing] if found.missing else [])])
