"""Time a frame of refinement, for all methods and mesh sizes in one run.

Kähler, Haber, Seidel 2003, Table 1 compares the static with the refined mesh. Here the timed span
runs from positions to a filled stream and includes everything: normals, criterion, points, table
look-up, output and the call from Python. There are two kinds of meshes. The built-in face is in six
full expressions, with the default thresholds. Large grids of jittered squares are under travelling
waves, with thresholds that split 10, 50 or 100 % of the edges. The grids are flat at rest, so every
edge bends in the waves. Wave lengths are given in cells, so edges bend equally in small and large
meshes.

The methods of a mesh run interleaved, in alternating order, with garbage collection off, and
medians are reported. On a shared machine, times drift by a third within a run. So only rows of one
mesh can be compared, and the best time is reported beside the median.

On the graphics card a frame lasts from the upload of positions until OpenGL has finished. The
processor's times do not include the upload of vertices and triangles, which drawing also needs.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from risorius import assets, refine, sim
from risorius.app.errors import UserError
from risorius.assets.sheets import make_grid
from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.refine_gl import KahlerGl
from risorius.refine_gl.context import own_context
from risorius.refine_gl.refined import GpuBuffers
from risorius.render.surface import is_software

from .report import processor, table
from .subjects import SETTLING_FRAMES, settled_positions

DEFAULT_MESHES = ("face", "20k", "200k", "1M")
"""The meshes of a run by default; 2k is for a quick look."""
WINDOWS_LOOK: Mapping[str, Any] = {"scheme": "cubic", "criterion": "displacement+rest"}
OPTIONS_OF_RULES: Mapping[str, Mapping[str, Any]] = {
    "paper's rule": {},
    "window's look": WINDOWS_LOOK,
}


@dataclass(frozen=True)
class Load:
    """A mesh, and the positions of its frames."""

    name: str
    faces: Integers32
    rest: Floats64
    frames: Sequence[Floats64]


class RefineRow(NamedTuple):
    """One method on one mesh."""

    mesh: str
    method: str
    triangles_in: int
    triangles_out: float
    """Mean over the frames."""
    milliseconds: float
    """Time of a frame, median over the rounds [ms]."""
    best_milliseconds: float
    """Time of a frame, shortest of all rounds [ms]."""


class _Case(NamedTuple):
    """A method, the mean number of triangles that it makes, and the call that refines positions."""

    method: str
    triangles: float
    call: Callable[[Floats64], object]


def measure(
    sizes: Sequence[str] = DEFAULT_MESHES,
    seconds: float = 7.0,
    progress: Callable[[str], object] = lambda _: None,
    *,
    on_card: bool = False,
) -> list[RefineRow]:
    """Measure each of `sizes`, "face" or a key of TRIANGLE_COUNTS, for about `seconds` each.

    on_card: compare the processor with the graphics card. Raises UserError without OpenGL 4.3.
    """
    rows = []
    for size in sizes:
        progress(size)
        load = load_of(size)
        of_size = _face_cases if size == "face" else _waving_cases
        cases = _card_cases(load) if on_card else of_size(load)
        rows += _timed_rows(load, cases, seconds)
    return rows


def load_of(size: str) -> Load:
    """The mesh called `size`, and its frames."""
    if size != "face":
        triangle_counts = {"2k": 2_000, "20k": 20_000, "200k": 200_000, "1M": 1_000_000}
        return waving_mesh(size, triangle_counts[size])
    head = assets.load("head")
    simulation = sim.create(head)
    full_expressions = ("joy", "sadness", "surprise", "anger", "disgust", "fear")
    frames = [
        settled_positions(simulation, head.expressions[name], SETTLING_FRAMES)
        for name in full_expressions
    ]
    return Load("face", head.faces, head.vertices, frames)


def waving_mesh(name: str, triangle_count: int) -> Load:
    """Make a waving sheet of about `triangle_count` triangles.

    The triangles lie in scan order, so neighbours in the mesh are near each other in memory.
    """
    side = round((0.5 * triangle_count) ** 0.5)
    flat, faces = make_grid(side, side, 1.0)
    seed = 2003
    aside = np.random.default_rng(seed).uniform(-0.3, 0.3, (len(flat), 2))
    rest = flat + np.pad(aside, ((0, 0), (0, 1)))
    frames = [_waved_positions(rest, phase) for phase in (0.0, 0.5)]
    return Load(name, faces, rest, frames)


def _waved_positions(rest: Floats64, phase: float) -> Floats64:
    """Positions of the mesh at a phase of its waves, which are stronger in some places."""
    x = rest[:, 0]
    y = rest[:, 1]
    strength = 0.15 + np.sin(x / 61.0) ** 2 * np.sin(y / 47.0) ** 2
    height = np.zeros(len(rest))
    waves = ((13.0, 0.4), (29.0, 1.1), (9.0, 2.5))  # length [cells], direction [radians]
    for length, direction in waves:
        along = np.cos(direction) * x + np.sin(direction) * y
        height += np.sin(2.0 * np.pi * (along / length - phase))
    moved = rest.copy()
    wave_height = 1.0  # [cells]; bends most edges by 2 to 20 degrees
    moved[:, 2] += wave_height * strength * height
    return moved


def _face_cases(load: Load) -> list[_Case]:
    fine = assets.load("head").finer(1)
    cases = [_our_case("none", load, "none")]
    # The paper's method, then the method with another scheme or option.
    methods: Mapping[str, Mapping[str, Any]] = {
        "kahler": {},
        "kahler, blend": {"blend": True},
        "kahler, coherent": {"coherent": True},
        "cubic": {"scheme": "cubic"},
        "cubic, no blend": {"scheme": "cubic", "blend": False},
        "detail": {"scheme": refine.DetailScheme((fine.vertices, fine.faces))},
        "window's look": WINDOWS_LOOK,
    }
    for method, options in methods.items():
        cases.append(_our_case(method, load, "kahler", **options))
    cases += [
        _case_of_one_topology("kahler", load, {}),
        _case_of_one_topology("window's look", load, WINDOWS_LOOK),
    ]
    return [*cases, *(_our_case(f"uniform Loop {k}x", load, "loop", levels=k) for k in (1, 2))]


def _waving_cases(load: Load) -> list[_Case]:
    """The window's look, and the paper's method with thresholds for given shares of split edges."""
    plain = refine.create("none", load.faces, load.rest)
    a, b = plain.edges.T

    def cosines(positions: Floats64) -> Floats32:
        normals = plain.refine(positions).normals
        return np.asarray(np.einsum("ei,ei->e", normals[a], normals[b]))

    at_rest = cosines(load.rest)
    drops = np.concatenate([at_rest - cosines(frame) for frame in load.frames])
    cases = [
        _our_case("smooth", load, "kahler", **WINDOWS_LOOK),
        _case_of_one_topology("smooth", load, WINDOWS_LOOK),
    ]
    # Percentage of split edges -> quantiles of the drops for the two thresholds.
    thresholds = {10: (0.90, 0.97), 50: (0.50, 0.85), 100: (0.0, 0.70)}
    for percent, quantiles in thresholds.items():
        once, twice = (max(0.0, float(np.quantile(drops, quantile))) for quantile in quantiles)
        title = f"kahler {percent} %"
        limits = {"threshold_once": once, "threshold_twice": twice}
        cases.append(_our_case(title, load, "kahler", **limits))
        cases.append(_case_of_one_topology(title, load, limits))
    return cases


def _card_cases(load: Load) -> list[_Case]:
    """The paper's rule and the window's look, on the processor and on the graphics card."""
    cases = []
    for title, options in OPTIONS_OF_RULES.items():
        card = refine.create("kahler-gl", load.faces, load.rest, **options)
        if not isinstance(card, KahlerGl):
            raise UserError("--refiner kahler-gl: needs OpenGL 4.3; `risorius doctor` shows more")
        own = own_context()
        room = card.vertex_columns, card.vertex_capacity, card.triangle_capacity
        buffers = own.run(GpuBuffers, own.gl, *room)

        def frame(positions: Floats64, card: KahlerGl = card, out: GpuBuffers = buffers) -> None:
            card.refine_on_card(positions, out)
            own_context().gl.finish()

        serial = _our_case(f"kahler, {title}", load, "kahler", **options)
        on_card = _Case(f"kahler-gl, {title}", serial.triangles, partial(own.run, frame))
        cases += [serial, on_card]
    return cases


def _our_case(method: str, load: Load, refiner: str, **options: Any) -> _Case:
    """A case of one of our refiners; a first pass compiles kernels and counts triangles."""
    bound = refine.create(refiner, load.faces, load.rest, **options)
    counts = [len(bound.refine(frame).triangles) for frame in load.frames]
    return _Case(method, float(np.mean(counts)), bound.refine)


def _case_of_one_topology(method: str, load: Load, options: Mapping[str, Any]) -> _Case:
    """A case of `kahler` with one topology in all frames: the splits that any frame needs."""
    changing = refine.create("kahler", load.faces, load.rest, **options)
    splits = refine.splits_of_clip(changing, load.frames)
    others = {name: value for name, value in options.items() if name != "criterion"}
    return _our_case(f"{method}, one topology", load, "kahler", splits=splits, **others)


def _timed_rows(load: Load, cases: Sequence[_Case], seconds: float) -> list[RefineRow]:
    """Time all cases in as many rounds as fit into `seconds`; return a row for each case."""

    def run(case: _Case) -> None:
        for frame in load.frames:
            case.call(frame)

    calls = [lambda case=case: run(case) for case in cases]
    start = time.perf_counter()
    for call in calls:
        call()
    spent = time.perf_counter() - start
    fewest_rounds = 5
    most_rounds = 200
    rounds = int(np.clip(seconds / max(spent, 1e-9), fewest_rounds, most_rounds))
    times = 1e3 * interleaved(calls, rounds) / len(load.frames)
    return [
        RefineRow(
            *(load.name, case.method, len(load.faces), case.triangles),
            *(float(np.median(column)), float(np.min(column))),
        )
        for case, column in zip(cases, times.T, strict=True)
    ]


def interleaved(calls: Sequence[Callable[[], object]], rounds: int) -> Floats64:
    """Return the seconds of each call in each round, shape (rounds, len(calls)).

    A call's speed depends on the state in which the previous call left the caches. Of three or more
    calls, each always has the same neighbours; so time only two calls for a close comparison.
    """
    seconds = np.zeros((rounds, len(calls)))
    gc.disable()
    try:
        for turn in range(rounds):
            order = range(len(calls)) if turn % 2 == 0 else reversed(range(len(calls)))
            for k in order:
                start = time.perf_counter()
                calls[k]()
                seconds[turn, k] = time.perf_counter() - start
    finally:
        gc.enable()
    return seconds


def report(found: Sequence[RefineRow]) -> str:
    """The text to print."""
    lines = [
        f"Refinement on all cores of {processor()}: medians of interleaved rounds;",
        "positions in, filled render buffers out (normals, criterion, points, table, output).",
        "Compare rows of one mesh only. Uniform ones make 4 or 16 of every triangle.",
    ]
    if any(row.method.startswith("kahler-gl") for row in found):
        own = own_context()
        card = str(own.run(own.gl.info.__getitem__, "GL_RENDERER"))
        kind = "software, not a card: its times mean nothing" if is_software(card) else "card"
        lines.append(f"kahler-gl: on {card} ({kind})")
    for mesh, group in groupby(found, key=lambda row: row.mesh):
        rows = list(group)
        cells = []
        for row in rows:
            count = row.triangles_out
            nanoseconds = 1e6 * row.milliseconds / max(count, 1.0)
            times = (row.milliseconds, row.best_milliseconds, nanoseconds)
            cells.append((row.method, count, *times))
        columns = "method:<27|out:9.0f|ms:9.4f|best:9.4f|ns/tri:7.1f"
        title = f"{mesh}, {rows[0].triangles_in} triangles"
        lines += ["", title, *table(columns, cells, indent="  ")]
    return "\n".join(lines)
