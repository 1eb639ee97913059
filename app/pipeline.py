"""The paper's Figure 1, end to end: simulation, triangle mesh, refinement, rendering.

`Pipeline.step` and `Pipeline.draw` implement the figure. They make every picture of a scene: in the
window, in films, in data sets and in the figures of the paper. The simulation does not know of
refinement. The refiner reads the mesh, and writes only into buffers of the renderer. The refined
mesh is forgotten with the frame (Kähler, Haber, Seidel 2003, section 3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from risorius import render
from risorius.geometry.arrays import Integers64

from .anatomy import SKIN_ALONE, AnatomyView, Dissection, DrawnAnatomy
from .refining.drawn_mesh import DrawnMesh, bind
from .refining.presets import Refinement
from .refining.wrinkling import Compression, Wrinkling
from .scenes import Drawable

Timer = Callable[[str], AbstractContextManager[Any]]


class Viewport(NamedTuple):
    """A mesh, and the area [pixels] in which it is drawn; clip: the visible part, None: all."""

    drawn: DrawnMesh
    area: render.Rectangle
    clip: render.Rectangle | None = None

    @property
    def seen(self) -> render.Rectangle:
        """The part of the frame in which anything is drawn."""
        return self.clip or self.area


class Pipeline:
    """The visible meshes of a scene, and the renderer that draws them."""

    def __init__(self, scene: Drawable, renderer: render.Renderer) -> None:
        self.scene = scene
        self.renderer = renderer
        self.anatomy = DrawnAnatomy(scene)
        self.maps = render.NO_MAPS
        self._compression: Compression | None = None
        self._fading = _around_fading(scene)
        if (wrinkles := scene.skin.wrinkles) is not None:
            self._compression = Compression(scene)
            bumps = renderer.bump_map(wrinkles.map, wrinkles.steepest)
            self.maps = render.SkinMaps(bumps=bumps)
        self.set_tone(None)

    def bind(self, refinement: Refinement) -> DrawnMesh:
        """Bind the chosen refiner to the scene's mesh, with buffers of the renderer."""
        return bind(self.scene, self.renderer, refinement)

    def set_tone(self, tone: float | None) -> None:
        """Pass the scene's albedo to the renderer, in a skin tone [deg] if the scene has tones."""
        skin = self.scene.skin
        if skin.albedo is not None:
            albedo = skin.albedo if tone is None or skin.in_tone is None else skin.in_tone(tone)
            fine = skin.fine_shape
            bumps = None if fine is None else self.renderer.bump_map(*fine, channels=2)
            surface = self.renderer.surface
            texture = render.SkinTexture(surface, albedo, skin.ambient_occlusion, bumps, skin.oil)
            self.maps = replace(self.maps, texture=texture)

    def step(self, seconds: float) -> None:
        """Simulate `seconds`, and move the triangle mesh: the upper half of the figure."""
        self.scene.step(seconds)

    def refine(
        self,
        camera: render.OrbitCamera,
        viewports: Sequence[Viewport],
        wrinkling: Wrinkling | None = None,
    ) -> None:
        """Refine each mesh; also needed for skipped frames, because a refiner may remember them."""
        self.renderer.surface.make_current()  # streams on the card belong to its context
        for viewport in viewports:
            viewport.drawn.refine(self.scene.positions, camera, wrinkling)

    def frame_of(
        self,
        camera: render.OrbitCamera,
        style: render.Style,
        viewport: Viewport,
        seen: Dissection | None = None,
        overlays: Sequence[render.Lines | render.Shade] = (),
    ) -> render.Frame:
        """Return the renderer's frame of an uploaded mesh; seen: None for opaque skin."""
        drawn, area, clip = viewport
        seen = self.anatomy.dissect(SKIN_ALONE) if seen is None else seen
        maps = self.maps if drawn.has_uv else render.NO_MAPS
        values = None
        if drawn.mesh is not None and style.colour_by is render.ColourBy.SPLITS:
            values = drawn.splits()
        elif drawn.mesh is not None and style.colour_by is render.ColourBy.SPLIT_WIRES:
            values = drawn.splits_beyond_rest()
        fading = None
        if self._fading is not None and drawn.can_fade and drawn.positions is not None:
            fading = drawn.positions[self._fading]
        rims = self.scene.rims(render.Opening.RIM_POINTS)
        mouth = rims["mouth"].points if "mouth" in rims else None
        skin = render.Skin(drawn.stream, maps, fading, values, mouth)
        # Uploaded amounts have the strength of wrinkles, for folds of lids keep theirs.
        style = replace(style, opacity=style.opacity * seen.opacity, bumps=1.0)
        view = render.CameraView(camera, area, clip)
        return render.Frame(view, style, skin, seen.parts, seen.cut, overlays)

    def draw(
        self,
        camera: render.OrbitCamera,
        style: render.Style,
        viewports: Sequence[Viewport],
        *,
        anatomy: AnatomyView = SKIN_ALONE,
        overlays: Sequence[render.Lines | render.Shade] = (),
        timer: Timer = nullcontext,
    ) -> None:
        """Refine, upload and draw the mesh of each viewport: the lower half of the figure.

        overlays: drawn over every viewport. timer: measures "refinement", "upload" and "draw".
        """
        with timer("refinement"):
            wrinkling = None
            if self._compression is not None and style.shading is render.Shading.PIXEL:
                wrinkling = self._compression.measure(self.scene.positions, style.bumps)
            self.refine(camera, viewports, wrinkling)
        with timer("upload"):
            for viewport in viewports:
                viewport.drawn.upload()
        with timer("draw"):
            # Hair is left out of pictures of plain skin, which show its form.
            seen = self.anatomy.dissect(anatomy, has_hair=style.textured)
            self.renderer.draw(
                *(self.frame_of(camera, style, each, seen, overlays) for each in viewports)
            )


def _around_fading(scene: Drawable) -> Integers64 | None:
    """Return the vertices of triangles that fade, or None if the scene's skin does not fade."""
    fade = scene.skin.fade
    if fade is None:
        return None
    fades = (fade[scene.faces, 0] < 1.0).any(axis=1)
    return np.unique(scene.faces[fades]).astype(np.int64)


def side_by_side(size: tuple[int, int], meshes: Sequence[DrawnMesh]) -> list[Viewport]:
    """Divide a frame of `size` pixels among meshes, from left to right."""
    width, height = size
    edges = [round(index * width / len(meshes)) for index in range(len(meshes) + 1)]
    areas = [(left, 0, right - left, height) for left, right in pairwise(edges)]
    return [Viewport(drawn, area) for drawn, area in zip(meshes, areas, strict=True)]
