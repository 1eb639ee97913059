"""Draw the figure of docs/drive_a_fine_mesh.md: `python docs/figures/embedding.py [FOLDER]`.

embedding         a rippled sheet moved by a coarse sheet's flat triangles, and by its surface
"""

from __future__ import annotations

import figures
import numpy as np

from risorius import refine, render
from risorius.app.pictures import Image
from risorius.bench.canvas import Canvas, Drawing
from risorius.bench.embedding import FlatBinding, sheet
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.directions import unit_vectors


def folded(points: Floats64) -> Floats64:
    """Bend a sheet into two folds; z is the height above the sheet."""
    along = 3.2 * points[:, 0] + points[:, 1]
    middle = np.column_stack([points[:, :2], 0.3 * np.sin(along)])
    slope = 0.3 * np.cos(along)
    normals = np.column_stack([-3.2 * slope, -slope, np.ones(len(points))])
    normals = unit_vectors(normals)
    return np.asarray(middle + points[:, 2:] * normals)


def embedding() -> Image:
    """The coarse sheet, the fine sheet moved in two ways, and the true fine sheet."""
    rest, faces = sheet(8)
    flat, fine_faces = sheet(160)
    phase = 45.0 * flat[:, [0]] + 20.0 * flat[:, [1]]
    height = np.array([0.0, 0.0, 0.012])
    fine = flat + height * np.sin(phase)
    moved = folded(rest)
    flatly = FlatBinding(faces, rest, fine).evaluate(moved, offset=True)
    smoothly = refine.Embedding(faces, rest, fine).evaluate(moved).positions
    cells = [
        ("coarse: 128 triangles", drawn(moved, faces)),
        ("flat binding with an offset", drawn(flatly, fine_faces)),
        ("refine.Embedding", drawn(smoothly, fine_faces)),
        ("where it should be", drawn(folded(fine), fine_faces)),
    ]
    return figures.sheet(cells, columns=2)


def drawn(positions: Floats64, faces: Integers32) -> Image:
    """A sheet, seen obliquely from above."""
    upright = 60.0 * positions[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0])
    camera = render.OrbitCamera.framing(upright)
    camera.orbit(-25.0, 35.0)
    camera.fit(upright)
    clay = render.Style(textured=False, albedo=render.CLAY, background=render.DARK)
    refiner = refine.create("none", faces, upright)
    with Canvas((560, 400)) as canvas:
        return canvas.draw_image(refiner, upright, Drawing(camera, clay))


if __name__ == "__main__":
    figures.run(__doc__, {"embedding": embedding})
