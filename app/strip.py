"""A film strip of time-coherent splitting: `risorius reproduce coherence`.

Kähler, Haber, Seidel 2003, section 4.4. A wave grows on the paper's plane; each column is a moment.
Above, triangles are looked up by their splits alone, and lines that were there before turn (red);
below they remember the order of their splits, and no line does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.bench.turned_lines import Line, inner_lines, point_rows, turned

from .cameras import camera_for
from .easel import Drawing, Easel, table_of_pictures
from .outputs import Frame
from .paper_figures import FLAT, FRAME_SECONDS
from .scenes import PlaneScene

AMPLITUDES = (0.06, 0.12, 0.22, 0.4)
STEPS_BETWEEN = 8  # frames of the animation between two columns
CAMERA = "20,-25,2.6"
STYLE = replace(FLAT, wireframe=True, wire_opacity=0.6)
ABOVE = 0.4  # [mm] that red lines float over the surface
PHASE = 0.18


def coherence_strip(size: tuple[int, int] = (250, 200)) -> Frame:
    """Draw both rows; the number of turned lines is below each moment."""
    scene = PlaneScene()
    rows = []
    with Easel(size) as easel:
        for is_coherent, title in (
            (False, "coherent=False: looked up by the splits of the moment"),
            (True, "coherent=True: split in the order in which the edges were"),
        ):
            refiner = refine.create(
                "kahler",
                scene.faces,
                scene.rest_positions,
                coherent=is_coherent,
                **scene.refiner_options["kahler"],
            )
            rows.append((title, _moments(scene, refiner, easel)))
    return table_of_pictures(rows)


def _moments(scene: PlaneScene, refiner: refine.Refiner, easel: Easel) -> list[tuple[str, Frame]]:
    """The columns of one row: what the plane looks like, and what turned since the last column."""
    camera = camera_for(scene, CAMERA)
    cells = []
    before: set[Line] = set()
    gone: set[Line] = set()
    amplitudes = np.interp(
        np.arange(1, STEPS_BETWEEN * len(AMPLITUDES) + 1) / STEPS_BETWEEN,
        np.arange(len(AMPLITUDES) + 1),
        (0.0, *AMPLITUDES),
    )
    for step, amplitude in enumerate(amplitudes, start=1):
        scene.pose({"amplitude": float(amplitude), "phase": PHASE})
        scene.step(FRAME_SECONDS)
        mesh = refiner.refine(scene.positions)
        now, points = inner_lines(refiner, mesh), point_rows(refiner)
        gone |= set(turned(before, now, points))
        before = now
        if step % STEPS_BETWEEN == 0:
            lines = [_lifted(mesh, points[a], points[b]) for _, a, b in sorted(gone)]
            drawing = Drawing(camera, STYLE, lines=lines, line_width=2.4)
            frame = easel.picture(refiner, scene.positions, drawing)
            cells.append((f"{len(mesh.triangles)} triangles, {len(gone)} turned", frame))
            gone = set()
    return cells


def _lifted(mesh: refine.RefinedMesh, a: int, b: int) -> npt.NDArray[np.float64]:
    """A line between two vertices, a little above the surface."""
    ends = mesh.positions[[a, b]] + ABOVE * mesh.normals[[a, b]]
    return np.asarray(ends, dtype=np.float64)
