"""Table 1 of the paper beside ours: `risorius reproduce table1`.

Kähler, Haber, Seidel 2003, section 5: triangles of the static mesh, the most that refinement makes
of them during the animation, the time to render each, and c_rt, the factor by which the time per
triangle grows. What the paper timed as "the rendering code" is here refining (or handing through),
uploading and drawing, until OpenGL has finished. Where OpenGL is software, most of that is pixels,
which do not care how many triangles they belong to; so the same is given without drawing, and
without uploading, where c_rt says more about refinement. On a mesh as small as the plane even that
is mostly the fixed cost of a call from Python.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.cameras import camera_for
from risorius.app.scenes import FaceScene, PlaneScene, Scene
from risorius.app.script import script_for

from .canvas import Canvas, Drawing
from .report import table
from .timing import interleaved

Points = npt.NDArray[np.float64]

FRAMES_PER_SECOND = 30.0
SIZE = (1280, 720)  # [pixels] of what is drawn
GOURAUD = render.Style(
    textured=False, albedo=render.CLAY, shadows=False, shading=render.Shading.GOURAUD
)


@dataclass(frozen=True)
class PaperRow:
    """A row of Table 1 as it is printed in the paper, and what is asked of ours."""

    static: int
    dynamic: int
    static_milliseconds: float
    dynamic_milliseconds: float
    ratio: float
    allowed: float
    """Our limit for c_rt."""


PAPER = {
    "face": PaperRow(2030, 3120, 1.3, 3.5, 1.75, 1.5),
    "plane": PaperRow(154, 1328, 0.09, 2.0, 2.58, 2.0),
}


@dataclass(frozen=True)
class Timed:
    """One way to spend the time of a frame, for the static and for the refined mesh [ms]."""

    what: str
    static: float
    dynamic: float

    def ratio(self, static_count: int, dynamic_count: int) -> float:
        """The paper's c_rt: time per triangle, refined over static."""
        return (self.dynamic / dynamic_count) / (self.static / static_count)


@dataclass(frozen=True)
class Measured:
    """Our row of Table 1."""

    scene: str
    static: int
    dynamic: int
    """The most triangles of all frames of the scene's animation."""
    times: tuple[Timed, ...]


def run(*, rounds: int = 60) -> tuple[list[Measured], str]:
    """Measure our row for face and plane; returns them and the name of what draws."""
    with Canvas(SIZE) as canvas:
        rows = [_measured(scene, canvas, rounds) for scene in (FaceScene(), PlaneScene())]
        return rows, str(canvas.surface.gl.info["GL_RENDERER"])


def _measured(scene: Scene, canvas: Canvas, rounds: int) -> Measured:
    options = {**scene.refiner_options["kahler"], "criterion": "normal"}
    static = refine.create("none", scene.faces, scene.rest_positions)
    dynamic = refine.create("kahler", scene.faces, scene.rest_positions, **options)
    positions, count = _fullest_frame(scene, dynamic)
    drawing = Drawing(camera_for(scene, script_for(None, scene.name).camera), GOURAUD)

    def draw(refiner: refine.Refiner) -> None:
        canvas.draw(refiner, positions, drawing)
        canvas.surface.gl.finish()

    def prepare(refiner: refine.Refiner) -> None:
        stream = canvas.stream_for(refiner)
        mesh = refiner.refine(positions, out=stream)
        stream.upload(len(mesh.positions), len(mesh.triangles))

    calls: list[Callable[[], object]] = [
        lambda: draw(static),
        lambda: draw(dynamic),
        lambda: prepare(static),
        lambda: prepare(dynamic),
        lambda: static.refine(positions),
        lambda: dynamic.refine(positions),
    ]
    for call in calls:
        call()
    medians = 1e3 * np.median(interleaved(calls, rounds), axis=0)
    whats = ("all of it", "without drawing", "refinement alone")
    times = [
        Timed(what, float(medians[2 * k]), float(medians[2 * k + 1]))
        for k, what in enumerate(whats)
    ]
    return Measured(scene.name, len(scene.faces), count, tuple(times))


def _fullest_frame(scene: Scene, refiner: refine.Refiner) -> tuple[Points, int]:
    """Play the scene's own script; the frame with the most triangles."""
    script = script_for(None, scene.name)
    scene.reset()
    best, positions = -1, scene.positions.copy()
    for index in range(round(script.duration * FRAMES_PER_SECOND) + 1):
        scene.pose(script.at(index / FRAMES_PER_SECOND))
        scene.step(1.0 / FRAMES_PER_SECOND)
        count = len(refiner.refine(scene.positions).triangles)
        if count > best:
            best, positions = count, scene.positions.copy()
    return positions, best


def report(rows: Sequence[Measured], renderer: str) -> str:
    """The paper's rows and ours."""
    lines = [
        "Table 1 of Kähler, Haber, Seidel 2003, and ours: the frame with the most triangles of the",
        f"scene's own animation at {SIZE[0]}x{SIZE[1]} pixels, Gouraud shaded; medians of "
        "interleaved rounds.",
        f"OpenGL: {renderer}",
        "",
    ]
    columns = (":<24", "static:7d", "dynamic:8d", "t static:9.3f", "t dynamic:9.3f", "c_rt:6.2f")
    for number, row in enumerate(rows):
        paper = PAPER[row.scene]
        ratios = [timed.ratio(row.static, row.dynamic) for timed in row.times]
        cells: list[tuple[object, ...]] = [(f"{row.scene}, the paper", *astuple(paper)[:5])]
        for timed, ratio in zip(row.times, ratios, strict=True):
            name = f"{row.scene}, {timed.what}"
            cells.append((name, row.static, row.dynamic, timed.static, timed.dynamic, ratio))
        is_met = max(ratios) <= paper.allowed
        lines += table(columns, cells)[0 if number == 0 else 1 :]  # the titles once
        lines += [
            f"{'':24} c_rt at most {paper.allowed:g}, in each way of timing: "
            f"{'met' if is_met else 'MISSED'}",
            "",
        ]
    return "\n".join(lines).rstrip()
