"""The frame rate with and without refinement: what section 5 of the paper says of its application.

Kähler, Haber, Seidel 2003: about 60 frames a second in both cases on their machine, because the
load comes from the physics and not from rendering. Here the face runs through its own script, 1/60
s of physics to a frame. Each frame is drawn static and refined, in an order that changes from one
to the next, until OpenGL has finished. So both frame rates are of the same frames under the same
load.

Software OpenGL draws its pixels on the very processor that simulates. So the share of the physics
is given of all but drawing: simulation, refinement, upload.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.app.capture.cameras import camera_for
from risorius.app.performances import script_for
from risorius.app.scenes import FaceScene

from ..canvas import Canvas, Drawing
from ..report import driver, table
from .experiments import Measured, Outcome
from .table1 import GOURAUD, SIZE, papers_refiner

FRAME_SECONDS = 1.0 / 60.0
WARM_UP = 4  # frames that are not counted
PARTS = ("simulation", "refinement and upload", "drawing")


def measure(*, rounds: int) -> tuple[npt.NDArray[np.float64], str]:
    """Run through the script in `rounds` frames; their seconds, and the name of what draws.

    Shape (N, 2, 3): static and refined; PARTS, of which the first is the same for both.
    """
    scene = FaceScene()
    script = script_for(None, scene.name)
    static = refine.create("none", scene.faces, scene.rest_positions)
    refiners = static, papers_refiner(scene)
    camera = camera_for(scene, script.camera)
    frames: list[list[tuple[float, float, float]]] = []
    with Canvas(SIZE) as canvas:
        for moment in np.linspace(0.0, script.duration, WARM_UP + rounds):
            scene.pose(script.at(float(moment)))
            simulating = _seconds(lambda: scene.step(FRAME_SECONDS))
            drawing = Drawing(camera, GOURAUD, scene.parts, scene.bone_transforms())
            both = [(0.0, 0.0, 0.0)] * 2
            for which in (0, 1) if len(frames) % 2 == 0 else (1, 0):
                refiner = refiners[which]
                both[which] = (simulating, *_of_frame(canvas, refiner, scene, drawing))
            frames.append(both)
        return np.array(frames)[WARM_UP:], driver(canvas.surface.gl.info)


def _of_frame(
    canvas: Canvas, refiner: refine.Refiner, scene: FaceScene, drawing: Drawing
) -> tuple[float, float]:
    """Seconds of refinement and upload, and of drawing the frame beyond that."""
    stream = canvas.stream_for(refiner)

    def prepare() -> None:
        mesh = refiner.refine(scene.positions, out=stream)
        stream.upload(len(mesh.positions), len(mesh.triangles))

    def draw() -> None:
        canvas.draw(refiner, scene.positions, drawing)
        canvas.surface.gl.finish()

    preparing = _seconds(prepare)
    canvas.surface.gl.finish()
    return preparing, max(0.0, _seconds(draw) - preparing)


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def outcome(*, rounds: int) -> Outcome:
    """Measure the statement, for the page and the command."""
    seconds, renderer = measure(rounds=rounds)
    static, refined = np.moveaxis(seconds.sum(axis=2), 1, 0)
    but_drawing = seconds[:, 1, :2]
    values = {
        "frames a second, static": Measured.median(1.0 / static),
        "frames a second, refined": Measured.median(1.0 / refined),
        "frames lost to refinement [%]": Measured.median(
            100.0 * (1.0 - static / refined), least=0.0
        ),
        "frames a second but for drawing, refined": Measured.median(1.0 / but_drawing.sum(axis=1)),
        "physics in all but drawing [%]": Measured.median(
            100.0 * but_drawing[:, 0] / but_drawing.sum(axis=1)
        ),
    }
    rows = [
        (name, *each, sum(each))
        for name, each in zip(("static", "refined"), 1e3 * np.median(seconds, axis=0), strict=True)
    ]
    columns = "ms of a frame:<14|" + "|".join(f"{part}:{len(part)}.2f" for part in PARTS)
    return Outcome(values, text="\n".join(table(f"{columns}|sum:7.2f", rows)), renderer=renderer)
