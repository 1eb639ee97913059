"""A film strip of time-coherent splitting: lines inside triangles that turn, or do not.

Subtriangles of one input triangle meet along lines. A line whose two end points are both still
there, and which is not, has turned: flat shaded, the triangle flickers. That is what section 4.4 of
Kähler, Haber, Seidel 2003 is against.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.capture.cameras import camera_for
from risorius.app.files import Image
from risorius.app.scenes import PlaneScene

from ..canvas import FLAT, RED, Canvas, Drawing, image_table
from .experiments import Outcome
from .table1 import papers_refiner

Point = tuple[int, int, int]
"""A point of a refined mesh for life: ends of its edge, and quarters from the lower one."""
Line = tuple[int, Point, Point]
"""Input triangle and end points."""

FRAME_SECONDS = 1.0 / 30.0
AMPLITUDES = (0.06, 0.12, 0.22, 0.4)  # of the wave in the columns of the film strip
STEPS_BETWEEN = 8  # frames of the animation between two columns
GROWING_VIEW = "20,-25,2.6"
GROWING_PHASE = 0.18
GROWING = replace(FLAT, wireframe=True, wire_opacity=0.6)
ABOVE = 0.4  # [mm] that red lines float over the surface


def outcome(size: tuple[int, int] = (250, 200)) -> Outcome:
    """Draw a growing wave; each column is a moment, with the number of turned lines below it.

    Above, triangles are looked up by their splits alone, and lines that were there before turn
    (red); below they remember the order of their splits, and no line does.
    """
    scene = PlaneScene()
    rows, values = [], {}
    with Canvas(size) as canvas:
        for is_coherent, title, memory in (
            (False, "coherent=False: looked up by the splits of the moment", "without"),
            (True, "coherent=True: split in the order in which the edges were", "with"),
        ):
            refiner = papers_refiner(scene, coherent=is_coherent)
            cells, values[f"lines turned {memory} memory"] = _moments(scene, refiner, canvas)
            rows.append((title, cells))
    return Outcome(values, image_table(rows))


def _moments(
    scene: PlaneScene, refiner: refine.Refiner, canvas: Canvas
) -> tuple[list[tuple[str, Image]], int]:
    """The columns of one row: what the plane looks like, and what turned since the last column.

    Also the number of lines that turned in all.
    """
    camera = camera_for(scene, GROWING_VIEW)
    cells, count = [], 0
    before: set[Line] = set()
    gone: set[Line] = set()
    amplitudes = np.interp(
        np.arange(1, STEPS_BETWEEN * len(AMPLITUDES) + 1) / STEPS_BETWEEN,
        np.arange(len(AMPLITUDES) + 1),
        (0.0, *AMPLITUDES),
    )
    for step, amplitude in enumerate(amplitudes, start=1):
        scene.pose({"amplitude": float(amplitude), "phase": GROWING_PHASE})
        scene.step(FRAME_SECONDS)
        mesh = refiner.refine(scene.positions)
        now, points = inner_lines(refiner, mesh), point_rows(refiner)
        gone |= set(turned(before, now, points))
        before = now
        if step % STEPS_BETWEEN == 0:
            turned_now = [_lifted(mesh, points[a], points[b]) for _, a, b in sorted(gone)]
            lines = render.Lines(turned_now, RED, width=2.4, hidden_opacity=0.0)
            drawing = Drawing(camera, GROWING, lines=lines)
            image = canvas.draw_image(refiner, scene.positions, drawing)
            cells.append((f"{len(mesh.triangles)} triangles, {len(gone)} turned", image))
            count += len(gone)
            gone = set()
    return cells, count


def _lifted(mesh: refine.RefinedMesh, a: int, b: int) -> npt.NDArray[np.float64]:
    """A line between two vertices, a little above the surface."""
    ends = mesh.positions[[a, b]] + ABOVE * mesh.normals[[a, b]]
    return np.asarray(ends, dtype=np.float64)


def point_rows(refiner: refine.Refiner) -> dict[Point, int]:
    """A row of the last frame for each of its points on edges and corners."""
    origins = refiner.origins()
    rows: dict[Point, int] = {}
    for row, (vertices, weights) in enumerate(zip(origins.vertices, origins.weights, strict=True)):
        parts = sorted(
            (int(v), round(4.0 * float(w))) for v, w in zip(vertices, weights, strict=True) if w
        )
        first, last = parts[0][0], parts[-1][0]
        if len(parts) == 3:  # a point in the middle of a triangle: blending makes them
            rows[first, parts[1][0], -1 - last] = row
        else:
            rows.setdefault((first, last, parts[-1][1] if last != first else 0), row)
    return rows


def inner_lines(refiner: refine.Refiner, mesh: refine.RefinedMesh) -> set[Line]:
    """The lines inside input triangles in the last frame."""
    names = {row: point for point, row in point_rows(refiner).items()}
    sides: Counter[Line] = Counter()
    for source, corners in zip(mesh.source.tolist(), mesh.triangles.tolist(), strict=True):
        for k in range(3):
            a, b = sorted((names[corners[k]], names[corners[(k + 1) % 3]]))
            sides[source, a, b] += 1
    return {line for line, count in sides.items() if count == 2}


def turned(before: set[Line], now: set[Line], rows: dict[Point, int]) -> list[Line]:
    """Lines of the frame before that are gone although `rows` still has both their ends."""
    return sorted(line for line in before - now if line[1] in rows and line[2] in rows)
