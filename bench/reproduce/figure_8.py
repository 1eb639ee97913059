"""The paper's Fig. 8: long, thin subtriangles lie along folds, of cloth and of skin.

Below each picture stands what folds.py measures. `risorius reproduce figure8` draws it.
Kähler, Haber, Seidel 2003, section 5.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.capture.cameras import camera_for
from risorius.app.files import Image
from risorius.app.scenes import Scene, build_scene

from ..canvas import RED, Canvas, Drawing, image_table
from . import folds
from .figure_coherence import FLAT, GOURAUD

WIRE = replace(FLAT, wireframe=True, wire_opacity=0.55)
LIFT = 0.1  # mean edges that lines float over the surface
LENGTH = 0.5  # mean edges, of a line along a fold


class Pose(NamedTuple):
    """Something with folds, and where they are seen."""

    title: str
    scene: str
    values: dict[str, float]
    settled: float  # [s] after which it hangs or stands still
    view: str
    aim: tuple[float, float]  # where it looks, right of the scene's focus and above, in frames


POSES = (
    Pose("cloth over a ball", "cloth", {"drop": 1.0}, 4.0, "20,14,2.7", (-0.1, 0.08)),
    Pose("the face, disgusted", "face", {"disgust": 1.0}, 1.5, "-30,-5,4.6", (0.12, 0.05)),
)


def draw(size: tuple[int, int] = (380, 340)) -> Image:
    """The mesh, the refined mesh by the paper's rule, and where folds run; a row for each pose."""
    with Canvas(size) as canvas:
        rows = [(pose.title, _cells(canvas, pose)) for pose in POSES]
    return image_table(rows)


def _cells(canvas: Canvas, pose: Pose) -> list[tuple[str, Image]]:
    """The pictures of a row and what is said of them."""
    scene = posed(pose)
    camera = camera_for(scene, pose.view)
    camera.pan(*pose.aim)
    bones = scene.bone_transforms()
    static, refined = (
        refine.create(name, scene.faces, scene.rest_positions) for name in ("none", "kahler")
    )
    before, after = folds.measure(refined, scene.faces, scene.positions)
    lines = render.Lines(lines_along(scene), RED, width=2.0, hidden_opacity=0.0)

    def picture(refiner: refine.Refiner, style: render.Style) -> Image:
        drawn_lines = lines if style is GOURAUD else None
        drawing = Drawing(camera, style, scene.parts, bones, lines=drawn_lines)
        return canvas.draw_image(refiner, scene.positions, drawing)

    return [
        (text_of(before), picture(static, WIRE)),
        (text_of(after), picture(refined, WIRE)),
        ("where folds run", picture(static, GOURAUD)),
    ]


def posed(pose: Pose) -> Scene:
    """The scene of a pose, when nothing moves any more."""
    scene = build_scene(pose.scene)
    scene.pose(pose.values)
    scene.step(pose.settled)
    return scene


def text_of(shapes: folds.Shapes) -> str:
    """What stands below a picture."""
    return f"smallest angle {shapes.smallest_angle:.0f}°, {shapes.off_fold:.0f}° off the fold"


def lines_along(scene: Scene) -> list[npt.NDArray[np.float64]]:
    """A short line along the fold in each triangle that lies in one, a little above it."""
    corners = scene.positions[scene.faces]
    directions, is_fold = folds.find_folds(scene.faces, scene.positions)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    unit = float(np.sqrt(np.median(np.linalg.norm(normals, axis=1))))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    middles = corners.mean(axis=1) + LIFT * unit * normals
    half = 0.5 * LENGTH * unit * directions
    return list(np.stack([middles - half, middles + half], axis=1)[is_fold])
