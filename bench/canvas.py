"""Draw single meshes offscreen, and arrange pictures in rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image
from PIL import ImageDraw

from risorius import refine, render
from risorius.app.capture.captions import INK_COLOUR, SHADE_COLOUR, font
from risorius.app.pictures import Image
from risorius.app.refining.drawn_mesh import DrawnMesh
from risorius.app.scenes import Scene
from risorius.assets.identities import HAIR_NAME
from risorius.geometry.arrays import Floats64

from .averages import root_mean_square

Transforms = Mapping[str, Floats64]
CLAY_STYLE = render.Style(
    textured=False, albedo=render.CLAY, shadows=False, background=render.WHITE
)
FLAT_STYLE = replace(CLAY_STYLE, shading=render.Shading.FLAT)
GOURAUD_STYLE = replace(CLAY_STYLE, shading=render.Shading.GOURAUD)


@dataclass(frozen=True)
class Drawing:
    """The camera and style of a picture, and its parts and lines besides the mesh."""

    camera: render.OrbitCamera
    style: render.Style
    parts: tuple[Any, ...] = ()
    bones: Transforms = field(default_factory=dict)
    lines: render.Lines | None = None


class Canvas:
    """A context manager that draws the output of refiners, one picture at a time."""

    def __init__(self, size: tuple[int, int], *, samples: int = 4) -> None:
        self.surface = render.open_offscreen(size, samples=samples)
        self.renderer = render.Renderer(self.surface)
        self._meshes: dict[refine.Refiner, DrawnMesh] = {}

    def __enter__(self) -> Canvas:
        return self

    def __exit__(self, *_: object) -> None:
        self.surface.close()

    def mesh_of(self, refiner: refine.Refiner) -> DrawnMesh:
        """The refiner's mesh as drawn; every call for the same refiner reuses its buffers."""
        if refiner not in self._meshes:
            room = refiner.vertex_capacity, refiner.triangle_capacity, refiner.vertex_columns
            self._meshes[refiner] = DrawnMesh("", refiner, self.renderer.lend_stream(*room))
        return self._meshes[refiner]

    def draw(self, refiner: refine.Refiner, positions: Floats64, drawing: Drawing) -> None:
        """Refine, upload and draw, without reading back."""
        drawn = self.mesh_of(refiner)
        drawn.refine(positions, drawing.camera)
        drawn.upload()
        splits = drawing.style.colour_by is render.ColourBy.SPLITS
        values = drawn.splits() if splits else None
        self._draw(render.Skin(drawn.stream, values=values), drawing)

    def draw_image(self, refiner: refine.Refiner, positions: Floats64, drawing: Drawing) -> Image:
        """Draw and read back."""
        self.draw(refiner, positions, drawing)
        return self.surface.read()

    def draw_surface(
        self,
        positions: npt.NDArray[np.floating],
        normals: npt.NDArray[np.floating],
        faces: npt.NDArray[np.integer],
        drawing: Drawing,
    ) -> Image:
        """Draw a surface with given normals, without a refiner, and read back."""
        position_and_normal = 6  # columns of a vertex that has no texture coordinates
        stream = self.renderer.lend_stream(len(positions), len(faces), position_and_normal)
        stream.vertices[:] = np.hstack([positions, normals])
        stream.triangles[:] = faces
        stream.upload(len(positions), len(faces))
        self._draw(render.Skin(stream), drawing)
        return self.surface.read()

    def _draw(self, skin: render.Skin, drawing: Drawing) -> None:
        """Draw a skin, and the parts and lines of a drawing."""
        view = render.CameraView(drawing.camera)
        parts = [render.PlacedPart.on_bone(part, drawing.bones) for part in drawing.parts]
        lines = [] if drawing.lines is None else [drawing.lines]
        self.renderer.draw(render.Frame(view, drawing.style, skin, parts, overlays=lines))


@dataclass(frozen=True)
class ComparedPicture:
    """A picture for comparisons, and the number of triangles in its mesh."""

    triangles: int
    image: Image

    def difference(self, other: ComparedPicture) -> Floats64:
        """Difference of each pixel from the one in another picture [levels of 255], (H, W)."""
        apart = self.image.astype(np.float64) - other.image
        return np.asarray(np.sqrt((apart**2).mean(axis=2)))

    def rms(self, truth: ComparedPicture) -> float:
        """Root mean square difference from another picture [levels of 255]."""
        return root_mean_square(self.difference(truth))


def parts_without_hair(scene: Scene) -> tuple[Any, ...]:
    """The parts of a scene except hair, because hair hides the face's form."""
    return tuple(part for part in scene.parts if not part.name.startswith(HAIR_NAME))


def image_table(rows: Sequence[tuple[str, Sequence[tuple[str, Image]]]]) -> Image:
    """Arrange pictures of one size in rows; each row has a title, and each cell a caption."""
    _, first_cells = rows[0]
    _, first_image = first_cells[0]
    height, width = first_image.shape[:2]
    columns = max(len(cells) for _, cells in rows)
    # Pages show the table about 1000 pixels wide; its captions are then about 12 pixels high.
    size = max(16.0, min(width, height) / 17.0, columns * width / 72.0)
    title = round(2.0 * size)
    caption_height = round(1.7 * size)
    whole = title + height + caption_height
    page = PIL.Image.new("RGB", (columns * width, len(rows) * whole), SHADE_COLOUR)
    draw = ImageDraw.Draw(page)
    for k, (heading, cells) in enumerate(rows):
        top = k * whole
        draw.text(
            (0.6 * size, top + title / 2), heading, font=font(size), fill=INK_COLOUR, anchor="lm"
        )
        for column, (caption, image) in enumerate(cells):
            left = column * width
            below = top + title + height
            page.paste(PIL.Image.fromarray(image), (left, top + title))
            middle = (left + width / 2, below + caption_height / 2)
            draw.text(middle, caption, font=font(0.85 * size), fill=INK_COLOUR, anchor="mm")
    return np.asarray(page)
