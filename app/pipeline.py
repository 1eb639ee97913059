"""The paper's Figure 1, end to end: simulation, triangle mesh, refinement, rendering.

`Pipeline.step` and `Pipeline.draw` are the figure; every picture of a scene, in the window, in
films, in data sets and in the figures of the paper, goes through them. The simulation never learns
that refinement exists; the refiner reads the mesh and writes only into the buffers that the
renderer lent. The refined mesh is forgotten with the frame (Kähler, Haber, Seidel 2003, section 3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import refine, render

from .anatomy import SKIN_ALONE, Anatomy, AnatomyView, DrawOrder
from .refining.plug_ins import PlugIn, plug_ins_of, reported
from .refining.presets import ON_CARD, Refinement
from .refining.refiners import refiner_for
from .refining.wrinkling import Amounts, Compression, on_rows
from .scenes import Scene

LARGE = 20_000  # triangles from which on a graphics card refines, where it may choose
Timer = Callable[[str], AbstractContextManager[Any]]


@dataclass
class DrawnMesh:
    """The scene's mesh as one refiner has it drawn; two of them make a comparison."""

    label: str  # its name under the picture
    refiner: refine.Refiner
    stream: render.Stream | render.GpuStream
    style: render.Style = render.Style()  # noqa: RUF009 - frozen; in which it was drawn last
    mesh: refine.RefinedMesh | None = None  # the last result, refined from:
    positions: npt.NDArray[np.float64] | None = None
    plug_ins: tuple[PlugIn, ...] = ()  # somebody else's code that refines it

    def refine(self, positions: npt.NDArray[np.float64], camera: render.OrbitCamera) -> None:
        """Fill the lent buffers with refined triangles, as the camera sees them.

        Raises PlugInError where somebody else's code fails.
        """
        view = refine.View(camera.eye)
        self.positions = positions
        with reported(self.plug_ins):
            if isinstance(self.stream, render.GpuStream):
                assert isinstance(self.refiner, refine.GpuRefiner)  # see `Pipeline.bind`
                self.mesh = self.refiner.refine_on_card(positions, self.stream, view)
            else:
                self.mesh = self.refiner.refine(positions, self.stream, view)

    def upload(self, style: render.Style, wrinkling: Amounts | None = None) -> None:
        """Upload the last refined mesh, and how far the scene's vertices wrinkle."""
        assert self.mesh is not None and self.positions is not None
        self.style = style
        with reported(self.plug_ins):
            rows = None if wrinkling is None else on_rows(wrinkling, self.refiner)
            if isinstance(self.stream, render.GpuStream):
                frame: Any = self.mesh  # of a refiner that fetches rows on demand
                self.stream.show(frame, self.positions, rows)
            else:
                self.stream.upload(self.mesh.vertex_count, self.mesh.triangle_count, rows)

    def splits(self) -> npt.NDArray[np.uint8]:
        """For each triangle drawn, how many splits its source triangle's edges have."""
        assert self.mesh is not None
        with reported(self.plug_ins):
            return splits_of_source(self.refiner, self.mesh)

    @property
    def has_uv(self) -> bool:
        """Whether rows carry texture coordinates, which a refiner from outside may leave out."""
        # Position, normal, u and v.
        return self.refiner.vertex_columns == 8

    @property
    def triangle_count(self) -> int:
        """How many triangles the last frame drew."""
        return self.stream.triangle_count

    @property
    def caption(self) -> str:
        """The text under its picture: its name and its number of triangles."""
        return f"{self.label}\n{self.triangle_count} triangles"


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
    """A scene and the renderer that draws it."""

    def __init__(self, scene: Scene, renderer: render.Renderer) -> None:
        self.scene = scene
        self.renderer = renderer
        self.texture: render.Texture | None = None
        self.set_tone(None)
        self.wrinkle_map: render.BumpMap | None = None
        self._compression: Compression | None = None
        if (wrinkles := scene.wrinkles) is not None:
            self._compression = Compression(scene)
            self.wrinkle_map = render.BumpMap(renderer.surface, wrinkles.map, wrinkles.steepest)
        self.anatomy = Anatomy(scene)

    def bind(self, refinement: Refinement) -> DrawnMesh:
        """Bind the refiner that is asked for to the scene's mesh; borrow render buffers for it.

        Where a look is asked for as it is, a graphics card makes the same of a large mesh.
        """
        has_card = self.renderer.lends_gpu_streams and not self.renderer.surface.is_software
        is_open = refinement.refiner is None and not refinement.options
        suits_card = has_card and is_open and len(self.scene.faces) >= LARGE
        asked = replace(refinement, refiner=ON_CARD) if suits_card else refinement
        refiner = refiner_for(self.scene, asked)
        plug_ins = plug_ins_of(*asked.on(self.scene.name))
        stream: render.Stream | render.GpuStream
        with reported(plug_ins):
            room = refiner.vertex_capacity, refiner.triangle_capacity, refiner.vertex_columns
            if self.renderer.lends_gpu_streams and isinstance(refiner, refine.GpuRefiner):
                ends = self.scene.rest_positions[refiner.edges]
                longest = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max(initial=0.0)
                stream = self.renderer.lend_gpu_stream(*room, margin=float(longest))
            else:
                stream = self.renderer.lend_stream(*room)
        return DrawnMesh(refinement.label, refiner, stream, plug_ins=plug_ins)

    def set_tone(self, tone: float | None) -> None:
        """Hand the scene's albedo to the renderer, in a tone [deg] where it has any."""
        scene = self.scene
        if scene.albedo is not None:
            albedo = scene.albedo if tone is None or scene.in_tone is None else scene.in_tone(tone)
            maps = scene.ambient_occlusion, scene.fine_shape
            self.texture = render.Texture(self.renderer.surface, albedo, *maps)

    def step(self, seconds: float) -> None:
        """The upper half of the figure: time passes, and the triangle mesh follows."""
        self.scene.step(seconds)

    def refine(self, camera: render.OrbitCamera, viewports: Sequence[Viewport]) -> None:
        """Refine each mesh; a frame that nobody draws, too: the next one may remember it."""
        self.renderer.surface.make_current()  # where streams of the graphics card are
        for viewport in viewports:
            viewport.drawn.refine(self.scene.positions, camera)

    def draw(
        self,
        camera: render.OrbitCamera,
        style: render.Style,
        viewports: Sequence[Viewport],
        *,
        anatomy: AnatomyView = SKIN_ALONE,
        overlays: Sequence[render.Lines] = (),
        timer: Timer = nullcontext,
    ) -> None:
        """The lower half: refine the mesh for each viewport, hand it over, and draw it there.

        overlays: over every viewport. timer: measures "refinement", "upload" and "draw".
        """
        with timer("refinement"):
            measure = self._compression if style.shows_bumps else None
            amounts = None if measure is None else measure.amounts(self.scene.positions)
            self.refine(camera, viewports)
        with timer("upload"):
            for viewport in viewports:
                viewport.drawn.upload(style, amounts)
        with timer("draw"):
            order = self.anatomy.draw_order(anatomy, has_hair=style.textured)  # else form is seen
            areas = dict.fromkeys(viewport.area for viewport in viewports)
            self.renderer.draw_background(style, *areas)
            for drawn, area, clip in viewports:
                view = self.renderer.view(camera, area, clip)
                self._draw(drawn, view, style, order)
                for lines in overlays:
                    self.renderer.draw_lines(lines, view)

    def _draw(
        self, drawn: DrawnMesh, view: render.CameraView, style: render.Style, order: DrawOrder
    ) -> None:
        """Draw the skin and all parts of the scene, below it and over it, into one viewport."""
        stream = drawn.stream
        renderer = self.renderer
        bones = self.scene.bone_transforms()
        texture = self.texture if drawn.has_uv else None
        values = None
        if style.colour_by is render.ColourBy.SPLITS and drawn.mesh is not None:
            values = drawn.splits()
        if style.shadows:
            skin = None if order.is_opened else stream
            renderer.cast_shadows(order.shadow_casters, bones, view, style, stream=skin)
        for parts, cut in order.under:
            renderer.draw_parts(parts, bones, view, style, cut=cut)
        renderer.draw_mesh(
            stream,
            view,
            replace(style, opacity=style.opacity * order.opacity),
            values=values,
            texture=texture,
            bumps=self.wrinkle_map if drawn.has_uv else None,
            cut=order.cut,
            fade=self.scene.fade,
        )
        renderer.draw_parts(order.over, bones, view, style)


def splits_of_source(refiner: refine.Refiner, mesh: refine.RefinedMesh) -> npt.NDArray[np.uint8]:
    """For each drawn triangle, how many splits its source triangle's edges have."""
    splits: npt.NDArray[np.uint8] = refiner.splits[refiner.triangle_edges].sum(
        axis=1, dtype=np.uint8
    )
    return np.take(splits, mesh.source)


def side_by_side(size: tuple[int, int], meshes: Sequence[DrawnMesh]) -> list[Viewport]:
    """Divide a frame of `size` pixels among meshes, from left to right."""
    width, height = size
    edges = [round(index * width / len(meshes)) for index in range(len(meshes) + 1)]
    areas = [(left, 0, right - left, height) for left, right in pairwise(edges)]
    return [Viewport(drawn, area) for drawn, area in zip(meshes, areas, strict=True)]
