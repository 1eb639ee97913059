"""The paper's figures, made again: Fig. 9 (the plane) and Fig. 10 (the region of the mouth).

Kähler, Haber, Seidel 2003, section 5. `risorius reproduce figure9` and `figure10` draw them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from risorius import refine, render

from .cameras import camera_for
from .easel import Drawing, Easel, table_of_pictures
from .outputs import Frame
from .scenes import FaceScene, PlaneScene

FRAME_SECONDS = 1.0 / 30.0
CLAY = render.Style(textured=False, albedo=render.CLAY, shadows=False, background=render.WHITE)
FLAT = replace(CLAY, shading=render.Shading.FLAT)
GOURAUD = replace(CLAY, shading=render.Shading.GOURAUD)
SPLIT_EDGES = replace(FLAT, wireframe=True, colour_by=render.ColourBy.SPLITS)

WAVE_PHASES = (0.0, 0.33, 0.66)  # moments of the wave in Fig. 9
WAVE_VIEW = "28,-30,0.68"  # from here no corner shows its underside, which no light reaches
MOUTH_POSES = ("surprise", "joy", "disgust")  # in Fig. 10
MOUTH_ZOOM = 5.4
SETTLED = 1.5  # [s] after which the face stands still


def figure_9(size: tuple[int, int] = (380, 230)) -> Frame:
    """The plane under a strong sine, flat and Gouraud shaded, as it is and refined (Fig. 9)."""
    scene = PlaneScene()
    camera = camera_for(scene, WAVE_VIEW)
    rows = []
    with Easel(size) as easel:
        for style, shading in ((FLAT, "flat"), (GOURAUD, "Gouraud")):
            for name, title in (("none", "static"), ("kahler", "refined")):
                options = scene.refiner_options.get(name, {})
                refiner = refine.create(name, scene.faces, scene.rest_positions, **options)
                cells = []
                for phase in WAVE_PHASES:
                    scene.pose({"amplitude": 1.0, "phase": phase})
                    scene.step(FRAME_SECONDS)
                    frame = easel.picture(refiner, scene.positions, Drawing(camera, style))
                    cells.append((f"{easel.stream_for(refiner).triangle_count} triangles", frame))
                rows.append((f"{title}, {shading} shading", cells))
    return table_of_pictures(rows)


def figure_10(size: tuple[int, int] = (360, 270), *, poses: Sequence[str] = MOUTH_POSES) -> Frame:
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
    with Easel(size) as easel:
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
                frame = easel.picture(refiner, scene.positions, drawing)
                cells.append((f"{title} · {easel.stream_for(refiner).triangle_count}", frame))
            rows.append((pose, cells))
    return table_of_pictures(rows)


def _mouth_camera(scene: FaceScene) -> render.OrbitCamera:
    """A camera close by the lips of the moment."""
    lips = scene.positions[scene.landmarks[48:68]]
    camera = camera_for(scene, f"-22,-4,{MOUTH_ZOOM}")
    camera.target = 0.5 * (lips.min(axis=0) + lips.max(axis=0))
    return camera
