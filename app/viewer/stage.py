"""The scene in the window: which meshes are drawn where, coloured and overlaid as the user wants.

Uses the paper's Figure 1 part by part (refine, upload, draw) and keeps the time of each.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from risorius import render

from ..capture.captions import captioned
from ..files import Image
from ..pipeline import DrawnMesh, Viewport, texture_of
from ..refining import options_of
from ..scenes import Scene
from ..wrinkling import wrinkling_of
from .colours import COLOURS, Amounts
from .frame_times import FrameTimes
from .level_of_detail import FULL
from .overlays import OVERLAYS, Lines, pointed_lines
from .setting_rules import SKINS
from .settings import Look
from .view import View

LEAST_SHARE = 0.08  # of the picture that each side of a comparison keeps


class Shot(NamedTuple):
    """One mesh in the picture, and the part of it in which it is seen."""

    drawn: DrawnMesh
    viewport: Viewport
    clip: Viewport
    label: str


class Stage:
    """Draws a scene into a window's surface."""

    def __init__(
        self, surface: render.WindowSurface, scene: Scene, look: Look, times: FrameTimes
    ) -> None:
        self.surface = surface
        self._times = times
        self._bind_scene(scene, look)

    def _bind_scene(self, scene: Scene, look: Look) -> None:
        self.scene = scene
        self.renderer = render.Renderer(self.surface)
        self._texture = texture_of(scene, self.renderer)
        self._wrinkling = wrinkling_of(scene, self.renderer)
        self.static = DrawnMesh.of(scene, self.renderer, "none", None)
        self.refined = self.static
        self.refiner_options: dict[str, Any] = {}  # of `refined`, with their defaults
        self._bound: object = None
        self.bind_refiner(look)

    def set_scene(self, scene: Scene, look: Look) -> None:
        """Take another scene in place of this one."""
        for stream in {id(each): each.stream for each in (self.static, self.refined)}.values():
            stream.release()
        if self._texture is not None:
            self._texture.release()
        if self._wrinkling is not None:
            self._wrinkling.map.release()
        self.renderer.release()
        self._bind_scene(scene, look)

    def bind_refiner(self, look: Look) -> None:
        """Bind the refiner that `look` names, with its options; UserError if it refuses them."""
        options = look.options.get(look.refiner)
        wanted = look.refiner, tuple(sorted((options or {}).items()))
        if wanted == self._bound:
            return
        self._bound = wanted  # refused options are refused once, not in every frame
        refined = DrawnMesh.of(self.scene, self.renderer, look.refiner, options)
        if self.refined is not self.static:
            self.refined.stream.release()
        self.refined, self.refiner_options = refined, options_of(look.refiner)

    def shots(self, look: Look, viewport: Viewport) -> list[Shot]:
        """What is drawn where."""
        left, bottom, width, height = viewport
        refined = Shot(self.refined, viewport, viewport, look.refiner)
        static = Shot(self.static, viewport, viewport, "static")
        if look.compare == "off" or width < 2:  # less than a pixel for each
            return [refined if look.is_refined else static]
        share = min(max(look.divider, LEAST_SHARE), 1.0 - LEAST_SHARE)
        middle = min(max(round(share * width), 1), width - 1)
        first = (left, bottom, middle, height)
        second = (left + middle, bottom, width - middle, height)
        if look.compare == "wipe":
            return [static._replace(clip=first), refined._replace(clip=second)]
        return [
            static._replace(viewport=first, clip=first),
            refined._replace(viewport=second, clip=second),
        ]

    def draw(self, view: View) -> None:
        """Draw the scene as it is now; the surface's `detail` says how finely."""
        camera, look, viewport, times = view.camera, view.look, view.viewport, self._times
        shots = self.shots(look, viewport)
        style = style_of(look, view.background)
        amounts = None
        if self._wrinkling is not None and style.shows_wrinkles:
            with times.timed("refinement"):
                amounts = self._wrinkling.amounts(self.scene.positions)
        for shot in shots:
            with times.timed("refinement"):
                shot.drawn.refine(self.scene.positions, camera, shot.viewport)
            with times.timed("upload"):
                shot.drawn.upload(amounts)
        with times.timed("draw"):
            self.surface.begin()
            overlays = self._overlays(view)
            self.renderer.draw_background(style, viewport)
            for shot in shots:
                values = COLOURS[look.colours].values(self.scene, shot.drawn)
                self._draw_shot(shot, camera, style, values)
                for lines in overlays:
                    self.renderer.draw_lines(
                        lines.polylines,
                        lines.colours,
                        camera,
                        viewport=shot.viewport,
                        clip=shot.clip,
                        width=lines.width,
                        hidden_opacity=lines.hidden_opacity,
                    )
            self.surface.target.flush()
            self.surface.gl.finish()

    def _draw_shot(
        self, shot: Shot, camera: render.OrbitCamera, style: render.Style, values: Amounts | None
    ) -> None:
        where: dict[str, Any] = {"viewport": shot.viewport, "clip": shot.clip}
        has_uv = shot.drawn.has_uv
        texture = self._texture if has_uv else None
        self.renderer.draw_mesh(
            shot.drawn.stream,
            camera,
            style,
            values=values,
            texture=texture,
            wrinkles=self._wrinkling.map if self._wrinkling and has_uv else None,
            **where,
        )
        # After the mesh: the skin throws its shadow on eyes and teeth.
        self.renderer.draw_parts(
            self.scene.parts, self.scene.bone_transforms(), camera, style, **where
        )
        if not self.surface.samples:
            self.renderer.draw_outline(shot.drawn.stream, camera, style, texture=texture, **where)

    def _overlays(self, view: View) -> list[Lines]:
        edges = self.static.refiner.edges
        lines = [OVERLAYS[name](self.scene, edges, view.camera) for name in view.look.overlays]
        return [*lines, pointed_lines(self.scene, view.pointed)] if view.pointed else lines

    def draw_image(self, view: View) -> Image:
        """The picture without panels, in full detail, with captions where two meshes are seen."""
        self.surface.detail = FULL
        self.draw(view)
        left, bottom, width, height = view.viewport
        top = self.surface.size[1] - bottom - height
        frame = self.surface.read_scene()[top : top + height, left : left + width]
        shots = self.shots(view.look, view.viewport)
        if len(shots) == 1:
            return np.ascontiguousarray(frame)
        texts = [f"{shot.label} · {shot.drawn.triangle_count} triangles" for shot in shots]
        places = [(shot.clip[0] - left, shot.clip[1] - bottom, *shot.clip[2:]) for shot in shots]
        return captioned(frame, texts, places)


def style_of(look: Look, background: render.Background) -> render.Style:
    """The renderer's style for what the user wants to see."""
    is_textured, albedo = SKINS[look.skin]
    return render.Style(
        shading=render.Shading(look.shading),
        wireframe=look.wireframe,
        colour_by=COLOURS[look.colours].kind,
        textured=is_textured,
        occlusion=look.occlusion,
        albedo=albedo,
        wrinkles=look.wrinkles,
        background=background,
    )
