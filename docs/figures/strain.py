"""A picture of the tension map: stretch orange, compression blue, and where folds would run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.capture.cameras import camera_for
from risorius.app.files import Image
from risorius.app.scenes import FaceScene
from risorius.assets.model import Part
from risorius.bench.canvas import image_table
from risorius.refine import Tension, TensionMap

POSES = ("joy", "surprise", "disgust")
SIZE = (330, 400)
NEUTRAL = np.array([0.87, 0.87, 0.86])
STRETCHED = np.array([0.84, 0.37, 0.0])
COMPRESSED = np.array([0.0, 0.36, 0.62])
FULL = 0.3  # stretch or compression that has the full colour
MARKED = 0.1  # above it, a stroke shows the direction of the largest stretch
STROKE = 1.6  # half its length [mm]
ABOVE = 0.5  # [mm] that strokes float over the skin
SETTLED = 1.5  # [s]


def tension_map(size: tuple[int, int] = SIZE, poses: Sequence[str] = POSES) -> Image:
    """Draw the face in some expressions, coloured by tension."""
    scene = FaceScene()
    tension = Tension(scene.faces, scene.rest_positions)
    static = refine.create("none", scene.faces, scene.rest_positions)
    camera = camera_for(scene, "-18,2,1.45")
    style = render.Style(shadows=False, background=render.WHITE)
    cells = []
    with render.open_offscreen(size, samples=4) as surface:
        renderer = render.Renderer(surface)
        for pose in poses:
            scene.reset()
            scene.pose({pose: 1.0})
            scene.step(SETTLED)
            found = tension.measure(scene.positions)
            mesh = static.refine(scene.positions)
            surface.begin()
            renderer.draw_background(style)
            renderer.draw_parts([_coloured(pose, mesh, found)], {"skin": np.eye(4)}, camera, style)
            renderer.draw_parts(scene.parts, scene.bone_transforms(), camera, style)
            strokes = render.Lines(_strokes(mesh, found), (0.1, 0.1, 0.12), 1.0, hidden_opacity=0.0)
            renderer.draw_lines(strokes, camera)
            surface.end()
            title = f"{pose}: +{found.stretch.max():.0%}, -{found.compression.max():.0%} at most"
            cells.append((title, surface.read()))
    return image_table([("stretch (orange) and compression (blue) against rest", cells)])


def _coloured(name: str, mesh: refine.RefinedMesh, found: TensionMap) -> Part:
    """The skin as a part with a colour for each vertex."""
    stretch = np.clip(found.stretch / FULL, 0.0, 1.0)[:, None]
    compression = np.clip(found.compression / FULL, 0.0, 1.0)[:, None]
    colours = NEUTRAL + stretch * (STRETCHED - NEUTRAL)
    colours = colours + compression * (COMPRESSED - colours)
    return Part(
        name=f"skin, {name}",
        vertices=mesh.positions.copy(),
        normals=mesh.normals.copy(),
        faces=mesh.triangles.astype(np.int32),
        colours=colours.astype(np.float32),
        bone="skin",
        shine=0.05,
    )


def _strokes(mesh: refine.RefinedMesh, found: TensionMap) -> list[npt.NDArray[np.float64]]:
    """Short lines along the largest stretch, where there is much tension."""
    strong = np.flatnonzero(np.maximum(found.stretch, found.compression) > MARKED)
    centres = mesh.positions[strong].astype(np.float64) + ABOVE * mesh.normals[strong]
    reach = STROKE * found.direction[strong].astype(np.float64)
    return list(np.stack([centres - reach, centres + reach], axis=1))
