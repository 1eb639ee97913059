"""The paper's Figure 1, end to end: simulation, triangle mesh, refinement, rendering.

`step` and `draw` are the figure. The simulation never learns that refinement exists; the
refiner reads the mesh and writes only into the buffers that the renderer lent; what it wrote is
forgotten with the frame (Kähler, Haber, Seidel 2003, section 3).
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine, render

from .anatomy import Dissection, Solids
from .refining.looks import Refinement
from .refining.refiners import refiner_for
from .refining.wrinkling import Amounts, Relief, on_rows, relief_of, wrinkling_of
from .scenes import Scene

TEXTURED_COLUMNS = 8  # position, normal, u v
Viewport = tuple[int, int, int, int]  # x, y, width, height [pixels], from the lower left corner


@dataclass
class DrawnMesh:
    """The scene's mesh as one refiner has it drawn; two of them make a comparison."""

    label: str  # what it is called under the picture
    refiner: refine.Refiner
    stream: render.Stream
    uses_view: bool  # whether the refiner has a use for where the eye is
    relief: Relief | None = None  # by which wrinkles move what was refined
    strength: float = 1.0  # how much of them shows
    mesh: refine.RefinedMesh | None = None  # what was refined last

    @classmethod
    def of(cls, scene: Scene, renderer: render.Renderer, refinement: Refinement) -> DrawnMesh:
        """Bind the refiner that is asked for to the scene's mesh; borrow render buffers for it."""
        refiner = refiner_for(scene, refinement)
        stream = renderer.lend_stream(
            refiner.vertex_capacity, refiner.triangle_capacity, refiner.vertex_columns
        )
        uses_view = "view" in inspect.signature(refiner.refine).parameters
        relief = relief_of(scene, refinement)
        return cls(refinement.label, refiner, stream, uses_view, relief)

    def refine(
        self, positions: npt.NDArray[np.float64], camera: render.OrbitCamera, viewport: Viewport
    ) -> None:
        """Fill the lent buffers with refined triangles, for whoever looks through the viewport."""
        view_option = {}
        if self.uses_view:
            focal = camera.focal(viewport[2] / viewport[3], viewport[3])
            view_option["view"] = refine.View(camera.eye, focal)
        self.mesh = self.refiner.refine(positions, out=self.stream, **view_option)

    def upload(self, wrinkling: Amounts | None = None, strength: float = 1.0) -> None:
        """Hand over what was refined last, moved as far as the scene's vertices wrinkle."""
        assert self.mesh is not None
        self.strength = strength
        rows = None if wrinkling is None else on_rows(wrinkling, self.refiner)
        if rows is not None and self.relief is not None and self.has_uv:
            self.relief.move(self.mesh, strength * rows)
        self.stream.upload(self.mesh.vertex_count, self.mesh.triangle_count, rows)

    @property
    def has_uv(self) -> bool:
        """Whether rows carry texture coordinates, which a refiner from outside may leave out."""
        return self.refiner.vertex_columns == TEXTURED_COLUMNS

    @property
    def triangle_count(self) -> int:
        """How many triangles the last frame drew."""
        return self.stream.triangle_count

    @property
    def caption(self) -> str:
        """What a picture of it says: what it is, and how many triangles that takes."""
        return f"{self.label}\n{self.triangle_count} triangles"


class Pipeline:
    """A scene, its mesh as each refiner has it drawn, and the renderer that draws."""

    def __init__(
        self,
        scene: Scene,
        renderer: render.Renderer,
        refinements: Sequence[Refinement],
    ) -> None:
        """Bind what is to be drawn of the scene, left to right."""
        self.scene = scene
        self.renderer = renderer
        self.texture: render.Texture | None = None
        self.set_tone(None)
        self.wrinkling = wrinkling_of(scene, renderer)
        self.solids = Solids(scene)
        self.bind(refinements)

    def bind(self, refinements: Sequence[Refinement]) -> None:
        """Draw these from here on; refiners begin anew."""
        self.meshes = [DrawnMesh.of(self.scene, self.renderer, each) for each in refinements]

    def set_tone(self, tone: float | None) -> None:
        """Hand the scene's albedo to the renderer, in a tone [deg] where it has any."""
        scene = self.scene
        if scene.albedo is None:
            return
        if self.texture is not None:
            self.texture.release()
        albedo = scene.albedo if tone is None or scene.in_tone is None else scene.in_tone(tone)
        self.texture = self.renderer.load_texture(albedo, scene.openness())

    def release(self) -> None:
        """Let go of what the renderer holds for the scene."""
        for drawn in self.meshes:
            drawn.stream.release()
        if self.texture is not None:
            self.texture.release()
        if self.wrinkling is not None:
            self.wrinkling.map.release()

    def step(self, seconds: float) -> None:
        """The upper half of the figure: time passes, and the triangle mesh follows."""
        self.scene.step(seconds)

    def refine(self, camera: render.OrbitCamera, viewports: Sequence[Viewport]) -> None:
        """Refine a frame that nobody draws: a refiner may remember it in the next one."""
        for drawn, viewport in zip(self.meshes, viewports, strict=True):
            drawn.refine(self.scene.positions, camera, viewport)

    def draw(
        self,
        camera: render.OrbitCamera,
        style: render.Style,
        viewports: Sequence[Viewport],
        dissection: Dissection = Dissection(),  # noqa: B008 - frozen
    ) -> None:
        """The lower half: refine the mesh by each refiner, and draw it into its viewport."""
        self.solids.follow(dissection)
        amounts = self.amounts(style)
        self.renderer.draw_background(style, *viewports)
        for drawn, viewport in zip(self.meshes, viewports, strict=True):
            drawn.refine(self.scene.positions, camera, viewport)
            drawn.upload(amounts, style.wrinkles)
            values = None
            if style.colour_by is render.ColourBy.SPLITS and drawn.mesh is not None:
                values = splits_of_source(drawn.refiner, drawn.mesh)
            where, skin = {"viewport": viewport}, self.skin_of(drawn, values)
            self.solids.draw(
                self.renderer, drawn.stream, camera, style, dissection, where=where, skin=skin
            )

    def amounts(self, style: render.Style) -> Amounts | None:
        """How far each vertex wrinkles now; None where that does not show."""
        if self.wrinkling is None or not style.shows_wrinkles:
            return None
        return self.wrinkling.amounts(self.scene.positions)

    def skin_of(self, drawn: DrawnMesh, values: npt.NDArray[Any] | None) -> dict[str, Any]:
        """What the renderer is told of a mesh's skin; values: by which it is coloured."""
        return {
            "values": values,
            "texture": self.texture if drawn.has_uv else None,
            "wrinkles": self.wrinkling.map if self.wrinkling and drawn.has_uv else None,
            "fade": self.scene.fade,
        }


def splits_of_source(refiner: refine.Refiner, mesh: refine.RefinedMesh) -> npt.NDArray[np.uint8]:
    """For each drawn triangle, how many splits its source triangle's edges have."""
    splits: npt.NDArray[np.uint8] = refiner.splits[refiner.triangle_edges].sum(
        axis=1, dtype=np.uint8
    )
    return np.take(splits, mesh.source)


def side_by_side(size: tuple[int, int], count: int) -> list[Viewport]:
    """Divide a frame of `size` pixels into `count` viewports from left to right."""
    width, height = size
    edges = [round(index * width / count) for index in range(count + 1)]
    return [(left, 0, right - left, height) for left, right in pairwise(edges)]
