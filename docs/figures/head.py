"""Draw the pictures of docs/head.md, and wrinkles: `python docs/figures/head.py [FOLDER]`.

Contact sheets, always with the same views and light, so that two states of the head can be
compared: `system` (one smile, from muscles to skin), `head_views` (the head at rest, as painted
skin, as clay, as flat triangles), `wrinkles` (some poses from near, without and with the wrinkles
that the simulation makes), and `persons` (at rest, then in other light).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import figures

from risorius import render
from risorius.app.anatomy import AnatomyView
from risorius.app.capture import CaptureOptions
from risorius.app.pictures import Image
from risorius.app.refining.presets import PAPERS_PRESET, STATIC_REFINER, Refinement
from risorius.app.scenes import FaceScene
from risorius.assets.identities import person_called

CELL_SIZE = (260, 320)  # [pixels] of one portrait: a contact sheet stays below 600 kB


def system() -> Image:
    """One smile: the muscles, the mesh that they move, its splits, and the skin."""
    mesh = render.Style(textured=False, albedo=render.CLAY, wireframe=True)
    splits = replace(mesh, colour_by=render.ColourBy.SPLITS)
    steps: dict[str, dict[str, Any]] = {
        "muscles pull": {"anatomy": AnatomyView(("muscles", "skull"), 0.1)},
        "on 2030 triangles": {"refinement": Refinement(refiner=STATIC_REFINER), "style": mesh},
        "split where they bend": {"refinement": Refinement(PAPERS_PRESET), "style": splits},
        "and drawn as skin": {},
    }
    scene = FaceScene()
    cells = []
    for title, how in steps.items():
        options = CaptureOptions((320, 440), camera="-26,3,1.06", captions=False, **how)
        cells.append((title, figures.shoot(scene, {"joy": 0.85}, options)))
    return figures.sheet(cells, len(steps))


def head_views() -> Image:
    """The head at rest, a row for each style."""
    scene = FaceScene()
    cells = []
    views = ("front", "three-quarter", "profile", "below")
    styles = {
        "painted": render.Style(),
        "clay": render.Style(textured=False, albedo=render.CLAY),
        "flat": render.Style(textured=False, albedo=render.CLAY, shading=render.Shading.FLAT),
    }
    for title, style in styles.items():
        for view in views:
            look = Refinement(refiner=STATIC_REFINER if title == "flat" else None)
            options = CaptureOptions(CELL_SIZE, refinement=look, style=style, camera=view)
            cells.append((f"{view}, {title}", figures.shoot(scene, {}, options)))
    return figures.sheet(cells, len(views))


def wrinkles() -> Image:
    """Some poses, side by side without and with wrinkles."""
    scene = FaceScene()
    cells = []
    cell_size = (270, 250)  # [pixels] of one picture of wrinkles
    # Pose, camera, and the camera's target [mm].
    rows = (
        ("surprise", "-22,2,2.1", (0.0, 20.0, 80.0)),
        ("anger", "-12,2,3.0", (0.0, 12.0, 90.0)),
        ("joy", "-40,2,2.5", (-30.0, -26.0, 75.0)),
        ("disgust", "-20,2,2.8", (-4.0, -6.0, 90.0)),
        ("AU17", "-20,2,2.8", (0.0, -78.0, 90.0)),
        ("kiss", "-12,2,4.5", (0.0, -64.0, 95.0)),
    )
    for pose, view, target in rows:
        for strength, how in ((0.0, "without"), (1.0, "with wrinkles")):
            options = CaptureOptions(cell_size, camera=view, style=render.Style(bumps=strength))
            cells.append((f"{pose}, {how}", figures.shoot(scene, {pose: 1.0}, options, target)))
    return figures.sheet(cells, 4)


def persons() -> Image:
    """Other persons than the built-in head, at rest and in some expression and light."""
    cells = []
    # Persons at rest; then persons with pose, light and camera.
    at_ease = ("ada", "kofi", "maria", 19, 40, 43, 47, 10)
    front = ((seed, "", "studio", "0,0,0.9") for seed in at_ease)
    in_light = (
        (30, "joy", "window", "-24,2,0.9"),
        (5, "surprise", "overcast", "0,0,0.9"),
        (18, "anger", "hard", "18,0,0.9"),
        (12, "fear", "side", "-10,0,0.9"),
    )
    for seed, pose, light, view in (*front, *in_light):
        style = render.Style(light=render.LIGHTS[light])
        options = CaptureOptions(size=CELL_SIZE, camera=view, style=style)
        name = f"{seed}: {pose}, {light}" if pose else str(seed)
        person = FaceScene(person_called(seed))
        cells.append((name, figures.shoot(person, {pose: 1.0} if pose else {}, options)))
    return figures.sheet(cells, 4)


if __name__ == "__main__":
    drawn = system, head_views, wrinkles, persons
    figures.run(__doc__, {each.__name__: each for each in drawn})
