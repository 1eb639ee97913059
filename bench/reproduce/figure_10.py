"""The paper's Fig. 10: the mouth, static and refined, compared with a dense mesh.

Kähler, Haber, Seidel 2003, section 5: "The rendered mesh is visibly smoothed, reducing shading
artifacts and improving the silhouette of the opened mouth." A smooth surface is not always a true
one. So the built-in head with 16 times the triangles is moved by the same muscles, drawn in the
same way, and taken as the truth. Below each picture is its error, in levels of 255 and in wrong
pixels of the opening between the lips. The row under the smooth pictures shows this opening dark,
with pixels in red that differ from the dense mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import PIL.Image

from risorius import assets, refine, render
from risorius.app.capture.captions import LANCZOS
from risorius.app.capture.drawing import camera_for
from risorius.app.pictures import Image
from risorius.app.scenes import FaceScene
from risorius.app.scenes.bent_part import HeadPart, at_rest
from risorius.assets import Part
from risorius.geometry.arrays import Flags, Unsigned8

from ..canvas import (
    FLAT_STYLE,
    GOURAUD_STYLE,
    Canvas,
    ComparedPicture,
    Drawing,
    image_table,
    parts_without_hair,
)
from ..subjects import SETTLING_FRAMES, fine_simulation, settled_positions
from .border_turn import BorderTurn
from .experiments import Outcome

SUPERSAMPLING = 2  # factor on the resolution of drawn pixels
SMOOTH_STYLE = replace(GOURAUD_STYLE, albedo=render.SKIN)
MOUTH_CHANNEL = 1  # channel of a picture of kinds: skin, mouth, background
BLUE_BACKGROUND = render.Background((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
GREEN_COLOUR = np.array([0.0, 1.0, 0.0], np.float32)


@dataclass(frozen=True)
class Variant:
    """One way to refine a mesh, as a row or column of a figure."""

    title: str
    refiner: str
    options: Mapping[str, Any] = field(default_factory=dict)
    splits_borders: bool = False  # by `displacement` and `BorderTurn`


STATIC_VARIANT, PAPER_VARIANT, CUBIC_VARIANT, DETAIL_VARIANT = VARIANTS = (
    Variant("static", "none"),
    Variant("refined: paper", "kahler"),
    Variant("refined: cubic", "kahler", {"scheme": "cubic"}, splits_borders=True),
    Variant("refined: detail", "kahler", {}, splits_borders=True),
)
"""One column each, and the dense mesh after them."""


@dataclass(frozen=True)
class Viewpoint:
    """An expression, and its viewpoint."""

    expression: str
    view: str  # yaw, pitch [degrees], zoom, around the lips
    aside: tuple[float, float]  # shift of the camera to the right and up, in heights of the frame


@dataclass(frozen=True)
class VariantCell(ComparedPicture):
    """The picture of one expression in one variant."""

    title: str
    kinds: Unsigned8  # skin, mouth, background; SUPERSAMPLING times as fine, (H, W)

    def wrong(self, truth: VariantCell) -> Flags:
        """Flags of fine pixels in which only one of both pictures shows the mouth's opening."""
        return np.asarray((self.kinds == MOUTH_CHANNEL) != (truth.kinds == MOUTH_CHANNEL))

    def opening(self, truth: VariantCell) -> Image:
        """The picture of the opening."""
        # by kind: skin, mouth, background
        opening_colours = np.array([(233, 222, 214), (52, 40, 42), (255, 255, 255)], np.uint8)
        picture = opening_colours[self.kinds]
        wrong_colour = (225, 30, 30)
        picture[self.wrong(truth)] = wrong_colour
        return _reduced_picture(picture)


def outcome(size: tuple[int, int] = (330, 250)) -> Outcome:
    """Error at the mouth by the paper's rule and the cubic scheme, relative to the static mesh."""
    changed = []
    left = list[float]()
    outline = list[float]()
    papers_left = list[float]()
    papers_outline = list[float]()
    rows = []
    seen_change = 8.0  # levels of 255: a visible change
    for expression, cells in _draw_cells(size):
        named = {cell.title: cell for cell in cells}
        truth = cells[-1]
        static = named[STATIC_VARIANT.title]
        changed.append(100.0 * (named[CUBIC_VARIANT.title].difference(static) > seen_change).mean())
        for variant, errors, edges in (
            (PAPER_VARIANT, papers_left, papers_outline),
            (CUBIC_VARIANT, left, outline),
        ):
            cell = named[variant.title]
            errors.append(cell.rms(truth) / static.rms(truth))
            edges.append(cell.wrong(truth).sum() / static.wrong(truth).sum())
        smooth = [
            (f"{cell.title}, {cell.triangles}, {cell.rms(truth):.1f}", cell.image) for cell in cells
        ]
        openings = [
            (f"{cell.wrong(truth).sum()} pixels wrong", cell.opening(truth)) for cell in cells
        ]
        title = f"{expression}: triangles, and RMS of the difference from the dense mesh"
        rows += [(title, smooth), (f"{expression}, opening", openings)]
    values = {
        "pixels that change visibly [%]": float(np.mean(changed)),
        "paper's rule: difference from the dense mesh, over static": float(np.mean(papers_left)),
        "paper's rule: wrong pixels of the opening, over static": float(np.mean(papers_outline)),
        "difference from the dense mesh, refined over static": float(np.mean(left)),
        "wrong pixels of the opening, refined over static": float(np.mean(outline)),
    }
    return Outcome(values, image_table(rows))


def _draw_cells(size: tuple[int, int]) -> Iterator[tuple[str, list[VariantCell]]]:
    """Draw every expression in every variant; the last cell of an expression is the dense mesh."""
    scene = FaceScene()
    head = assets.load("head")
    level = 2  # the finer head with 16 times the triangles
    fine = head.finer(level)
    simulation = fine_simulation(head, fine)
    refiners = []
    for variant in VARIANTS:
        options = dict(variant.options)
        if variant is DETAIL_VARIANT:
            options["scheme"] = refine.DetailScheme((fine.vertices, fine.faces))
        if variant.splits_borders:
            options["criterion"] = ["displacement", BorderTurn()]
        bound = refine.create(variant.refiner, head.faces, head.vertices, **options)
        refiners.append((variant.title, bound, len(head.vertices)))
    dense = refine.create("none", fine.faces, fine.vertices)
    refiners.append(("dense mesh", dense, len(fine.vertices)))
    with Canvas((SUPERSAMPLING * size[0], SUPERSAMPLING * size[1])) as canvas:
        parts_at_lids = "lashes", "wet_edges"  # far from the lips
        kinds_style = replace(
            FLAT_STYLE, albedo=(1.0, 0.0, 0.0), gloss=0.0, background=BLUE_BACKGROUND
        )
        viewpoints = (
            Viewpoint("yawn", "-24,-4,5.2", (-0.1, 0.0)),
            Viewpoint("joy", "-30,0,5.2", (-0.1, 0.05)),
        )
        for viewpoint in viewpoints:
            now = settled_positions(simulation, {viewpoint.expression: 1.0}, SETTLING_FRAMES)
            lips = now[head.landmarks[48:68]]
            camera = camera_for(scene, viewpoint.view)
            camera.target = 0.5 * (lips.min(axis=0) + lips.max(axis=0))
            camera.pan(*viewpoint.aside)
            bare = parts_without_hair(scene)
            parts = tuple(part for part in bare if part.name not in parts_at_lids)
            bones = simulation.bones.transforms()
            green = tuple(_in_green(part) for part in parts)
            cells = []
            for title, refiner, count in refiners:
                skin = now[:count]  # the first vertices of the dense mesh are the coarse one's
                smooth, kinds = (
                    canvas.draw_image(refiner, skin, Drawing(camera, style, each, bones))
                    for style, each in ((SMOOTH_STYLE, parts), (kinds_style, green))
                )
                of_kind = kinds.argmax(axis=2).astype(np.uint8)
                triangles = canvas.mesh_of(refiner).triangle_count
                cells.append(VariantCell(triangles, _reduced_picture(smooth), title, of_kind))
            yield viewpoint.expression, cells


def _in_green(part: HeadPart) -> Part:
    """Return a part in its current shape, green and without highlights."""
    return replace(
        at_rest(part),
        vertices=part.vertices,
        normals=part.normals,
        colours=np.tile(GREEN_COLOUR, (len(part.colours), 1)),
        shine=0.0,
    )


def _reduced_picture(image: Image) -> Image:
    """Reduce a picture SUPERSAMPLING times, to its final size."""
    height = image.shape[0] // SUPERSAMPLING
    width = image.shape[1] // SUPERSAMPLING
    return np.asarray(PIL.Image.fromarray(image).resize((width, height), LANCZOS))
