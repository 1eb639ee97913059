"""Table 1 of the paper beside ours: `risorius reproduce table1`.

Kähler, Haber, Seidel 2003, section 5: the number of triangles of the static mesh, the largest
number of triangles after refinement during the animation, the time to render each mesh, and c_rt,
the factor by which the time per triangle grows. The paper times "the rendering code"; here the time
covers refinement (or passing the mesh on), upload and drawing, until OpenGL has finished.

In software OpenGL most of this time is spent on pixels, whose number does not depend on the number
of triangles. So two more times are reported: one with a picture of a few pixels, and one for
refinement alone. For a mesh as small as the plane, refinement alone is mostly the fixed cost of a
call from Python.

Static and refined meshes are timed in pairs. A refined mesh has more triangles; so if it takes less
time than the static mesh, that is, if c_rt < static / refined triangles, this is noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from risorius import refine
from risorius.app.capture.drawing import camera_for
from risorius.app.performances import script_for
from risorius.app.refining.presets import PAPERS_PRESET, PRESETS
from risorius.app.scenes import FaceScene, PlaneScene, Scene
from risorius.geometry.arrays import Floats64

from ..canvas import GOURAUD_STYLE, Canvas, Drawing
from ..refine import interleaved
from ..report import table
from .experiments import Outcome

PICTURE_SIZE = (1280, 720)  # [pixels] of the picture
SMALL_PICTURE_SIZE = (64, 36)  # so few pixels take almost no time
DRAWN_STAGE, SMALL_STAGE = (
    f"all of it, {width}x{height}" for width, height in (PICTURE_SIZE, SMALL_PICTURE_SIZE)
)
REFINING_STAGE = "refinement alone"
TIMED_STAGES = (DRAWN_STAGE, SMALL_STAGE, REFINING_STAGE)
"""The timed stages, from most to least."""


@dataclass(frozen=True)
class TableRow:
    """A row of Table 1: triangles of the static and of the refined mesh, and their times [ms]."""

    title: str
    static: int
    dynamic: int
    static_time: float
    dynamic_time: float
    ratio: float
    """The paper's c_rt: time per triangle, refined over static."""
    quartiles: Sequence[float | None] = (None, None)
    """Quartiles: half of the rounds lie between these."""

    @classmethod
    def from_seconds(cls, title: str, static: int, dynamic: int, seconds: Floats64) -> TableRow:
        """Make a row. seconds: times of static and refined mesh in each round, (rounds, 2)."""
        ratios = static / dynamic * seconds[:, 1] / seconds[:, 0]
        low, ratio, high = np.percentile(ratios, (25, 50, 75)).tolist()
        still, refined = (1e3 * np.median(seconds, axis=0)).tolist()
        return cls(title, static, dynamic, still, refined, ratio, (low, high))


PAPERS_ROWS = {
    "face": TableRow("face, the paper", 2030, 3120, 1.3, 3.5, 1.75),
    "plane": TableRow("plane, the paper", 154, 1328, 0.09, 2.0, 2.58),
}


def _measured_rows(scene: Scene, rounds: int) -> list[TableRow]:
    """Time the frame with most triangles: in a large and a tiny picture, and without drawing."""
    static = refine.create("none", scene.faces, scene.rest_positions)
    options = PRESETS[PAPERS_PRESET][scene.name].options_for("kahler")
    dynamic = refine.create("kahler", scene.faces, scene.rest_positions, **options)
    positions, count = _fullest_frame(scene, dynamic)
    drawing = Drawing(camera_for(scene, script_for(None, scene.name).camera), GOURAUD_STYLE)

    def draw(canvas: Canvas, refiner: refine.Refiner) -> None:
        canvas.draw(refiner, positions, drawing)
        canvas.surface.gl.finish()

    def timed(work: Callable[[refine.Refiner], object], rounds: int) -> Floats64:
        return interleaved([partial(work, static), partial(work, dynamic)], rounds)

    seconds = {}
    for stage, size in ((DRAWN_STAGE, PICTURE_SIZE), (SMALL_STAGE, SMALL_PICTURE_SIZE)):
        with Canvas(size) as canvas:
            seconds[stage] = timed(partial(draw, canvas), rounds)
    quick_rounds = 10  # rounds without drawing, per round with drawing
    seconds[REFINING_STAGE] = timed(
        lambda refiner: refiner.refine(positions), quick_rounds * rounds
    )
    return [
        TableRow.from_seconds(f"{scene.name}, {stage}", len(scene.faces), count, seconds[stage])
        for stage in TIMED_STAGES
    ]


def _fullest_frame(scene: Scene, refiner: refine.Refiner) -> tuple[Floats64, int]:
    """Positions (V, 3) of the frame with most triangles in the scene's script, and their number."""
    best = -1
    fullest = scene.positions
    script = script_for(None, scene.name)
    scene.reset()
    frames_per_second = 30.0
    for number in range(round(script.duration * frames_per_second) + 1):
        scene.set_controls(script.values(number / frames_per_second, scene.limits))
        scene.step(1.0 / frames_per_second)
        count = len(refiner.refine(scene.positions).triangles)
        if count > best:
            best = count
            fullest = scene.positions.copy()
    return fullest, best


def outcome(*, rounds: int) -> Outcome:
    """Measure our rows for the face and the plane, and print them beside the paper's."""
    with Canvas(SMALL_PICTURE_SIZE) as canvas:
        renderer = canvas.surface.gl.info["GL_RENDERER"]
    scenes: tuple[Scene, ...] = (FaceScene(), PlaneScene())
    measured = {scene.name: _measured_rows(scene, rounds) for scene in scenes}
    values: dict[str, float] = {}
    for name, ours in measured.items():
        values[f"{name}, static triangles"] = ours[0].static
        values[f"{name}, most triangles"] = ours[0].dynamic
        values.update({row.title: row.ratio for row in ours})
    rows = [
        (
            *(row.title, row.static, row.dynamic, row.static_time, row.dynamic_time),
            *(row.ratio, *row.quartiles),
        )
        for name, ours in measured.items()
        for row in (PAPERS_ROWS[name], *ours)
    ]
    columns = ":<26|static:7d|dynamic:8d|t static:9.3f|t dynamic:9.3f|c_rt:6.2f|25 %:6.2f|75 %:6.2f"
    lines = [
        f"{renderer}: the frame with",
        "the most triangles of the scene's own animation, Gouraud shaded; times in ms, medians of",
        "static and refined in turn; c_rt with its quartiles.",
        "",
        *table(columns, rows),
    ]
    return Outcome(values, text="\n".join(lines))
