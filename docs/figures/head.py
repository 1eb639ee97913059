"""Draw the pictures of docs/head.md, and wrinkles: `python docs/figures/head.py [FOLDER]`.

Contact sheets, always from the same views and under the same light, so that two states of the head
can be laid side by side: `head_views` (the head at rest, as painted skin, as clay, as flat
triangles), `head_details` (the open jaw, the mesh, the finer meshes of the same form), `wrinkles`
(some poses from near, without and with the wrinkles that the simulation makes), and `persons` (at
rest, then in other light).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import figures
import numpy as np
import numpy.typing as npt

from risorius import assets, refine, render, sim
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.captions import contact_sheet
from risorius.app.files import Image
from risorius.app.scenes import FaceScene
from risorius.app.scenes.mouth import shaded_mouth
from risorius.assets.identities import person_called
from risorius.bench.canvas import Canvas, Drawing, without_noise
from risorius.bench.subjects import settled_positions

CELL = (260, 320)  # [pixels] of one portrait: a contact sheet stays below 600 kB
VIEWS = ("front", "three-quarter", "profile", "below")
OPENED = 90  # steps of 1/60 s after which an opened jaw stands still
AT_REST = dict.fromkeys(("neck", "cranium", "mandible", "eye_left", "eye_right"), np.eye(4))

PAINTED = render.Style()
CLAY = render.Style(textured=False, albedo=render.CLAY)
FLAT = render.Style(textured=False, albedo=render.CLAY, shading=render.Shading.FLAT)
EDGES = render.Style(textured=False, albedo=render.CLAY, wireframe=True)

WRINKLED = (270, 250)  # [pixels] of one picture of wrinkles
SETTLED = 1.5  # [s]
# Pose, camera, what it looks at [mm].
WRINKLES = (
    ("surprise", "-22,2,2.1", (0.0, 20.0, 80.0)),
    ("anger", "-12,2,3.0", (0.0, 12.0, 90.0)),
    ("joy", "-40,2,2.5", (-30.0, -26.0, 75.0)),
    ("disgust", "-20,2,2.8", (-4.0, -6.0, 90.0)),
    ("AU17", "-20,2,2.8", (0.0, -78.0, 90.0)),
    ("kiss", "-12,2,4.5", (0.0, -64.0, 95.0)),
)
# Persons; and some more, with what they do, in which light, from where.
AT_EASE: tuple[int | str, ...] = ("ada", "kofi", "maria", 19, 40, 43, 47, 10)
IN_LIGHT = (
    (30, "joy", "window", "-24,2,0.9"),
    (5, "surprise", "overcast", "0,0,0.9"),
    (18, "anger", "hard", "18,0,0.9"),
    (12, "fear", "side", "-10,0,0.9"),
)

Points = npt.NDArray[np.float64]
Bones = Mapping[str, Points]


def portrait(
    canvas: Canvas,
    texture: render.Texture,
    style: render.Style,
    view: str,
    *,
    positions: Points | None = None,
    bones: Bones = AT_REST,
    level: int = 0,
) -> Image:
    """Draw the built-in head from a named view: at rest, at `positions`, or a finer mesh of it."""
    head = assets.load("head")
    fine = head.finer(level) if level else None
    faces = head.faces if fine is None else fine.faces
    vertices = head.vertices if fine is None else fine.vertices
    uv = head.uv if fine is None else fine.interpolate(head.uv).astype(np.float32)
    refiner = refine.create("none", faces, vertices, uv, faces)
    camera = render.OrbitCamera.framing(head.vertices, view=view)
    parts = shaded_mouth(head.parts)
    drawing = Drawing(camera, style, parts=parts, bones=bones, texture=texture)
    return canvas.draw_image(refiner, vertices if positions is None else positions, drawing)


def opened_jaw() -> tuple[Points, Bones]:
    """Positions [mm], shape (V, 3), and bone matrices with the jaw quite open."""
    simulation = sim.create(assets.load("head"))
    return settled_positions(simulation, {"jaw_open": 1.0}, OPENED), simulation.bone_transforms()


def views(draw: Callable[..., Image]) -> list[tuple[str, Image]]:
    """The cells of `head_views`."""
    return [
        (f"{view}, {title}", draw(style, view))
        for title, style in (("painted", PAINTED), ("clay", CLAY), ("flat", FLAT))
        for view in VIEWS
    ]


def details(draw: Callable[..., Image]) -> list[tuple[str, Image]]:
    """The cells of `head_details`."""
    positions, bones = opened_jaw()
    near = "three-quarter"
    return [
        ("jaw closed", draw(PAINTED, "front")),
        ("jaw open, front", draw(PAINTED, "front", positions=positions, bones=bones)),
        ("jaw open, three-quarter", draw(PAINTED, near, positions=positions, bones=bones)),
        ("2030 triangles", draw(EDGES, near)),
        ("8120, flat", draw(FLAT, near, level=1)),
        ("32480, flat", draw(FLAT, near, level=2)),
        ("32480, clay", draw(CLAY, near, level=2)),
        ("32480, painted", draw(PAINTED, near, level=2)),
    ]


def head_contact_sheet(
    size: tuple[int, int], cells: Callable[[Callable[..., Image]], list[tuple[str, Image]]]
) -> Image:
    """One contact sheet of portraits of `size` pixels."""
    with Canvas(size) as canvas:
        texture = canvas.renderer.load_texture(assets.load("head").albedo)
        portraits = cells(partial(portrait, canvas, texture))
        return contact_sheet(portraits, columns=len(VIEWS), cell_width=size[0])


def wrinkles() -> Image:
    """Some poses, side by side without and with wrinkles."""
    scene = FaceScene()
    cells = []
    for pose, view, target in WRINKLES:
        scene.reset()
        scene.pose({pose: 1.0})
        scene.step(SETTLED)
        for strength, how in ((0.0, "without"), (1.0, "with wrinkles")):
            style = render.Style(bumps=strength)
            options = CaptureOptions(size=WRINKLED, camera=view, style=style)
            with Capture(scene, options) as capture:
                capture.camera.target = np.array(target)
                cells.append((f"{pose}, {how}", capture.draw_image()))
    return contact_sheet(cells, columns=4, cell_width=WRINKLED[0])


def persons() -> Image:
    """Other persons than the built-in head, at rest and in some expression and light."""
    cells = []
    front = ((seed, "", "studio", "0,0,0.9") for seed in AT_EASE)
    for seed, pose, light, view in (*front, *IN_LIGHT):
        scene = FaceScene(person_called(seed))
        scene.pose({pose: 1.0} if pose else {})
        scene.step(SETTLED)
        style = render.Style(light=render.LIGHTS[light])
        with Capture(scene, CaptureOptions(size=CELL, camera=view, style=style)) as capture:
            name = str(seed) if not pose else f"{seed}: {pose}, {light}"
            cells.append((name, capture.draw_image()))
    return without_noise(contact_sheet(cells, columns=4, cell_width=CELL[0]))


def main(arguments: Sequence[str]) -> None:
    """Draw the contact sheets into the folder given."""
    given = figures.parse(arguments, __doc__, width=CELL[0])
    size = given.width, given.width * CELL[1] // CELL[0]
    every: dict[str, figures.Figure] = {
        "head_views": partial(head_contact_sheet, size, views),
        "head_details": partial(head_contact_sheet, size, details),
        "wrinkles": wrinkles,
        "persons": persons,
    }
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
