"""The paper's Fig. 10: the region of the mouth, static and refined, beside a dense mesh.

Kähler, Haber, Seidel 2003, section 5: "The rendered mesh is visibly smoothed, reducing shading
artifacts and improving the silhouette of the opened mouth." What is smooth need not be true; so the
built-in head with 16 times the triangles is moved by the same muscles, drawn alike and taken for
the truth. Below a picture stands how far it is off, in levels of 255 and in pixels around the
opening between the lips. For every expression these rows:

    smooth       Gouraud shaded, as in the paper
    flat         one colour for each triangle
    difference   of the smooth picture from that of the dense mesh, black where it is CLEAR levels
    opening      between the lips, dark, and in red where it is not as that of the dense mesh
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius import assets, refine, render
from risorius.app.capture.cameras import camera_for
from risorius.app.capture.captions import LANCZOS
from risorius.app.files import Image
from risorius.app.scenes import FaceScene

from ..canvas import Canvas, Drawing, image_table, without_noise
from ..subjects import SETTLE, Points, fine_simulation, settled_positions
from .experiments import Outcome

SEEN, CLEAR = 8.0, 48.0  # levels of 255: a change that is seen, one that is clear
LEVEL = 2  # of the finer head: 16 times the triangles
FINER = 2  # pixels are drawn so many times as fine
SMOOTH = render.Style(
    shading=render.Shading.GOURAUD, textured=False, albedo=render.SKIN, shadows=False,
    background=render.WHITE,
)  # fmt: skip
FLAT = replace(SMOOTH, shading=render.Shading.FLAT)
SKIN, MOUTH, BACKGROUND = range(3)  # channels of a picture of kinds
BLUE = render.Background((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
GREEN = np.array([0.0, 1.0, 0.0], np.float32)
KINDS = render.Style(
    shading=render.Shading.FLAT, textured=False, albedo=(1.0, 0.0, 0.0), gloss=0.0, subsurface=0.0,
    shadows=False, background=BLUE,
)  # fmt: skip
OPENING = np.array([(233, 222, 214), (52, 40, 42), (255, 255, 255)], np.uint8)  # by kind
WRONG = (225, 30, 30)


@dataclass(frozen=True)
class Variant:
    """One way to refine a mesh, for a row or column of a figure."""

    title: str
    refiner: str
    options: Mapping[str, Any] = field(default_factory=dict)


STATIC, PAPER, CUBIC, DETAIL = VARIANTS = (
    Variant("static", "none"),
    Variant("refined: paper", "kahler"),
    Variant("refined: cubic", "kahler", {"scheme": "cubic", "criterion": "displacement+border"}),
    Variant("refined: detail", "kahler", {"scheme": "detail", "criterion": "displacement+border"}),
)
"""One column each, and the dense mesh after them."""


@dataclass(frozen=True)
class Viewpoint:
    """An expression, and where it is looked at from."""

    expression: str
    view: str  # yaw, pitch [degrees], zoom, around the lips
    aside: tuple[float, float]  # the camera is moved right and up, in heights of the frame


VIEWPOINTS = (
    Viewpoint("yawn", "-24,-4,5.2", (-0.1, 0.0)),
    Viewpoint("joy", "-30,0,5.2", (-0.1, 0.05)),
)


@dataclass(frozen=True)
class Cell:
    """What one variant makes of one expression."""

    title: str
    triangles: int
    smooth: Image
    flat: Image
    kinds: npt.NDArray[np.uint8]  # SKIN, MOUTH, BACKGROUND, FINER times as fine, (H, W)

    def off(self, truth: Cell) -> Points:
        """How far each pixel of the smooth picture is from the truth [levels of 255], (H, W)."""
        apart = self.smooth.astype(np.float64) - truth.smooth
        return np.asarray(np.sqrt((apart**2).mean(axis=2)))

    def wrong(self, truth: Cell) -> npt.NDArray[np.bool_]:
        """Fine pixels that are the opening of the mouth here, or there, but not in both."""
        return np.asarray((self.kinds == MOUTH) != (truth.kinds == MOUTH))


def outcome(size: tuple[int, int] = (330, 250)) -> Outcome:
    """How much of the error of mouths goes away, by the interpolating scheme."""
    changed, left, outline, rows = [], [], [], []
    for viewpoint, cells in drawn(size):
        named, truth = {cell.title: cell for cell in cells}, cells[-1]
        static, refined = named[STATIC.title], named[CUBIC.title]
        changed.append(100.0 * (refined.off(static) > SEEN).mean())
        before, after = (np.sqrt((cell.off(truth) ** 2).mean()) for cell in (static, refined))
        left.append(after / before)
        outline.append(refined.wrong(truth).sum() / static.wrong(truth).sum())
        rows += _rows(viewpoint.expression, cells)
    values = {
        "pixels that change visibly [%]": float(np.mean(changed)),
        "difference from the dense mesh, refined over static": float(np.mean(left)),
        "wrong pixels of the opening, refined over static": float(np.mean(outline)),
    }
    return Outcome(values, image_table(rows))


def drawn(
    size: tuple[int, int],
    variants: Sequence[Variant] = VARIANTS,
    viewpoints: Sequence[Viewpoint] = VIEWPOINTS,
) -> list[tuple[Viewpoint, list[Cell]]]:
    """Draw every expression in every variant; the cell of the dense mesh is the last of each."""
    scene, head = FaceScene(), assets.load("head")
    fine = head.finer(LEVEL)
    simulation = fine_simulation(head, fine)
    columns = []
    for variant in variants:
        told = dict(variant.options)
        if told.get("scheme") == "detail":
            told["detail"] = fine.vertices, fine.faces
        bound = refine.create(variant.refiner, head.faces, head.vertices, **told)
        columns.append((variant.title, bound, len(head.vertices)))
    dense = refine.create("none", fine.faces, fine.vertices)
    columns.append(("dense mesh", dense, len(fine.vertices)))
    found = []
    with Canvas((FINER * size[0], FINER * size[1])) as canvas:
        for viewpoint in viewpoints:
            now = settled_positions(simulation, {viewpoint.expression: 1.0}, SETTLE)
            lips = now[head.landmarks[48:68]]
            camera = camera_for(scene, viewpoint.view)
            camera.target = 0.5 * (lips.min(axis=0) + lips.max(axis=0))
            camera.pan(*viewpoint.aside)
            frame = canvas, camera, scene.parts, simulation.bone_transforms()
            # The first vertices of the dense mesh are those of the coarse one.
            cells = [_cell(title, each, now[:count], *frame) for title, each, count in columns]
            found.append((viewpoint, cells))
    return found


def _cell(
    title: str,
    refiner: refine.Refiner,
    positions: Points,
    canvas: Canvas,
    camera: render.OrbitCamera,
    parts: Sequence[Any],
    bones: Mapping[str, Points],
) -> Cell:
    """Draw one variant of an expression, with skin, parts and background in colours, too."""

    def picture(style: render.Style, parts: Sequence[Any]) -> Image:
        return canvas.draw_image(refiner, positions, Drawing(camera, style, tuple(parts), bones))

    green = [
        replace(part, colours=np.tile(GREEN, (len(part.colours), 1)), shine=0.0) for part in parts
    ]
    smooth, flat = (_smaller(picture(style, parts)) for style in (SMOOTH, FLAT))
    kinds = picture(KINDS, green).argmax(axis=2).astype(np.uint8)
    return Cell(title, canvas.stream_for(refiner).triangle_count, smooth, flat, kinds)


def _smaller(image: Image) -> Image:
    """A picture at its final size."""
    height, width = image.shape[0] // FINER, image.shape[1] // FINER
    return np.asarray(PIL.Image.fromarray(image).resize((width, height), LANCZOS))


def _rows(expression: str, cells: Sequence[Cell]) -> list[tuple[str, list[tuple[str, Image]]]]:
    """The rows of one expression: title, and caption and picture of each cell."""
    rows: dict[str, list[tuple[str, Image]]] = {}
    truth = cells[-1]
    for cell in cells:
        off, wrong = cell.off(truth), cell.wrong(truth)
        light = 255.0 * (1.0 - np.clip(off / CLEAR, 0.0, 1.0))
        opening = OPENING[cell.kinds]
        opening[wrong] = WRONG
        for name, caption, picture in (
            ("smooth", f"{cell.title}: {cell.triangles} triangles", without_noise(cell.smooth)),
            ("flat", "", without_noise(cell.flat)),
            ("difference", f"RMS {np.sqrt((off**2).mean()):.1f}", np.dstack([light] * 3)),
            ("opening", f"{wrong.sum()} pixels wrong", _smaller(opening)),
        ):
            cells_of_row = rows.setdefault(f"{expression}, {name}", [])
            cells_of_row.append((caption, picture.astype(np.uint8)))
    return list(rows.items())
