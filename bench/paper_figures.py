"""The paper's Fig. 10 (the region of the mouth), and a film strip of time-coherent splitting.

`risorius reproduce` draws them.
Kähler, Haber, Seidel 2003, sections 4.4 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.app.cameras import camera_for
from risorius.app.files import Image
from risorius.app.scenes import FaceScene, PlaneScene

from .canvas import Canvas, Drawing, image_table
from .turned_lines import Line, inner_lines, point_rows, turned

FRAME_SECONDS = 1.0 / 30.0
CLAY = render.Style(textured=False, albedo=render.CLAY, shadows=False, background=render.WHITE)
FLAT = replace(CLAY, shading=render.Shading.FLAT)
GOURAUD = replace(CLAY, shading=render.Shading.GOURAUD)
SPLIT_EDGES = replace(FLAT, wireframe=True, colour_by=render.ColourBy.SPLITS)

MOUTH_POSES = ("surprise", "joy", "disgust")  # in Fig. 10
MOUTH_ZOOM = 5.4
SETTLED = 1.5  # [s] after which the face stands still

AMPLITUDES = (0.06, 0.12, 0.22, 0.4)  # of the wave in the columns of the film strip
STEPS_BETWEEN = 8  # frames of the animation between two columns
GROWING_VIEW = "20,-25,2.6"
GROWING_PHASE = 0.18
GROWING = replace(FLAT, wireframe=True, wire_opacity=0.6)
ABOVE = 0.4  # [mm] that red lines float over the surface


def figure_10(size: tuple[int, int] = (360, 270), *, poses: Sequence[str] = MOUTH_POSES) -> Image:
    """The region of the mouth in three expressions, as it is and refined (Fig. 10).

    Refined by the paper's rule, and with what the application splits in addition: edges that are
    curved at rest, which the mouth's outline is made of.
    """
    scene = FaceScene()
    skin = replace(GOURAUD, albedo=render.SKIN)
    rest = scene.refiner_options["kahler"]["criterion"]
    looks: tuple[tuple[str, str, dict[str, str], render.Style], ...] = (
        ("static", "none", {}, skin),
        ("refined", "kahler", {}, skin),
        (f"by {rest}", "kahler", {"criterion": rest}, skin),
        ("coloured by splits", "kahler", {}, SPLIT_EDGES),
    )
    rows = []
    with Canvas(size) as canvas:
        refiners = [
            refine.create(name, scene.faces, scene.rest_positions, **options)
            for _, name, options, _ in looks
        ]
        for pose in poses:
            scene.reset()
            scene.pose({pose: 1.0})
            scene.step(SETTLED)
            bones = scene.bone_transforms()
            cells = []
            for refiner, (title, _, _, style) in zip(refiners, looks, strict=True):
                drawing = Drawing(_mouth_camera(scene), style, parts=scene.parts, bones=bones)
                image = canvas.draw_image(refiner, scene.positions, drawing)
                cells.append((f"{title} · {canvas.stream_for(refiner).triangle_count}", image))
            rows.append((pose, cells))
    return image_table(rows)


def _mouth_camera(scene: FaceScene) -> render.OrbitCamera:
    """A camera close by the lips of the moment."""
    lips = scene.positions[scene.landmarks[48:68]]
    camera = camera_for(scene, f"-22,-4,{MOUTH_ZOOM}")
    camera.target = 0.5 * (lips.min(axis=0) + lips.max(axis=0))
    return camera


def coherence(size: tuple[int, int] = (250, 200)) -> Image:
    """Draw a growing wave; each column is a moment, with the number of turned lines below it.

    Above, triangles are looked up by their splits alone, and lines that were there before turn
    (red); below they remember the order of their splits, and no line does.
    """
    scene = PlaneScene()
    rows = []
    with Canvas(size) as canvas:
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
            rows.append((title, _moments(scene, refiner, canvas)))
    return image_table(rows)


def _moments(scene: PlaneScene, refiner: refine.Refiner, canvas: Canvas) -> list[tuple[str, Image]]:
    """The columns of one row: what the plane looks like, and what turned since the last column."""
    camera = camera_for(scene, GROWING_VIEW)
    cells = []
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
            lines = [_lifted(mesh, points[a], points[b]) for _, a, b in sorted(gone)]
            drawing = Drawing(camera, GROWING, lines=lines, line_width=2.4)
            image = canvas.draw_image(refiner, scene.positions, drawing)
            cells.append((f"{len(mesh.triangles)} triangles, {len(gone)} turned", image))
            gone = set()
    return cells


def _lifted(mesh: refine.RefinedMesh, a: int, b: int) -> npt.NDArray[np.float64]:
    """A line between two vertices, a little above the surface."""
    ends = mesh.positions[[a, b]] + ABOVE * mesh.normals[[a, b]]
    return np.asarray(ends, dtype=np.float64)
