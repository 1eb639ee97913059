"""The paper's Fig. 9: the plane under a strong sine, static and refined, beside the true sine.

Below each picture is its difference from the true picture, in shading and in outline. The true
picture shows a mesh so dense that no triangle is visible, with the exact normals of the sine;
refiners do not use it.

`risorius reproduce figure9` draws it.
Kähler, Haber, Seidel 2003, section 5.
"""

from __future__ import annotations

import numpy as np

from risorius import refine, render
from risorius.app.capture.drawing import camera_for
from risorius.app.pictures import Image
from risorius.app.refining.presets import PAPERS_PRESET, PRESETS
from risorius.app.scenes import PlaneScene
from risorius.assets.sheets import CELL_SIZE, SHEET_COLUMNS, SHEET_ROWS, make_grid
from risorius.geometry.arrays import Floats64

from ..averages import root_mean_square
from ..canvas import FLAT_STYLE, GOURAUD_STYLE, Canvas, Drawing, image_table
from .experiments import Outcome
from .figure_10 import Variant

BACKGROUND_GREY = 250.0  # grey level: almost white, lighter than any part of the plane


def outcome(size: tuple[int, int] = (380, 230)) -> Outcome:
    """Difference of each variant's shading from the true sine's, averaged over the figure's
    columns.

    Rows are variants of each shading, with the true sine last; columns are moments.
    """
    means = {}
    rows = []
    shadings = (("flat", FLAT_STYLE), ("Gouraud", GOURAUD_STYLE))
    variants = (
        Variant("static", "none"),
        Variant("refined", "kahler"),
        Variant("refined, its own normals", "kahler", {"normals": "refined"}),
        Variant("refined, cubic curves", "kahler", {"scheme": "cubic"}),
    )
    with Canvas(size) as canvas:
        plane = Waving(canvas)
        phases = (0.0, 0.33, 0.66)  # moments of the wave
        true = [plane.true_image(phase) for phase in phases]
        for shading, style in shadings:
            for variant in variants:
                cells = []
                levels = []
                for phase, truth in zip(phases, true, strict=True):
                    image, count = plane.image(variant, style, phase)
                    off = grey_level_difference(image, truth)
                    outline = outline_difference(image, truth)
                    text = f"{count} triangles: {off:.1f} levels, outline {outline:.1%} off"
                    cells.append((text, image))
                    levels.append(off)
                means[shading, variant.title] = float(np.mean(levels))
                if style is not FLAT_STYLE or "normals" not in variant.options:
                    rows.append((f"{variant.title}, {shading} shading", cells))
        rows.append(("the sine itself", [("", truth) for truth in true]))
    values = {}
    for shading, _ in shadings:
        before, after, own = (means[shading, each.title] for each in variants[:3])
        values[f"{shading}: shading error, refined over static"] = after / before
        values[f"{shading}: with normals of the refined surface, over static"] = own / before
    return Outcome(values, image_table(rows))


class Waving:
    """Draws the waving plane of the figure, refined and true."""

    def __init__(self, canvas: Canvas) -> None:
        self._canvas = canvas
        self._scene = PlaneScene()
        view = "28,-30,0.796"  # from this view the dark underside is never visible
        self._camera = camera_for(self._scene, view)
        # Cells of the true sine per cell of the plane in each direction: smaller than pixels.
        fineness = 24
        self._dense = make_grid(
            SHEET_COLUMNS * fineness, SHEET_ROWS * fineness, CELL_SIZE / fineness
        )

    def image(self, variant: Variant, style: render.Style, phase: float) -> tuple[Image, int]:
        """The picture of a variant, and the number of its triangles."""
        scene = self._wave(phase)
        papers = PRESETS[PAPERS_PRESET][scene.name]
        options = {**papers.options_for(variant.refiner), **variant.options}
        refiner = refine.create(variant.refiner, scene.faces, scene.rest_positions, **options)
        image = self._canvas.draw_image(refiner, scene.positions, Drawing(self._camera, style))
        return image, self._canvas.mesh_of(refiner).triangle_count

    def true_image(self, phase: float) -> Image:
        """The picture of the true sine; with such small triangles, all shadings look the same."""
        vertices, faces = self._dense
        positions, normals = self._wave(phase).waved(vertices)
        drawing = Drawing(self._camera, GOURAUD_STYLE)
        return self._canvas.draw_surface(positions, normals, faces, drawing)

    def _wave(self, phase: float) -> PlaneScene:
        """The scene at a phase of the full wave."""
        self._scene.pose({"amplitude": 1.0, "phase": phase})
        self._scene.step(1.0 / 30.0)
        return self._scene


def grey_level_difference(image: Image, truth: Image) -> float:
    """Root mean square difference in grey levels (0 .. 255), where both show the surface."""
    grey = _grey(image)
    true_grey = _grey(truth)
    both = np.maximum(grey, true_grey) < BACKGROUND_GREY
    return root_mean_square((grey - true_grey)[both])


def outline_difference(image: Image, truth: Image) -> float:
    """Number of pixels that only one picture covers, relative to the true surface's pixels."""
    shows = _grey(image) < BACKGROUND_GREY
    true_shows = _grey(truth) < BACKGROUND_GREY
    return float((shows != true_shows).sum() / true_shows.sum())


def _grey(image: Image) -> Floats64:
    grey: Floats64 = image.mean(axis=2)
    return grey
