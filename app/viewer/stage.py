"""The scene in the window: which meshes are drawn where, coloured and overlaid as the user wants.

Uses the paper's Figure 1 part by part (simulate, refine, upload, draw) and keeps the time of each.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from risorius import render

from ..capture.captions import captioned
from ..files import Image
from ..pipeline import DrawnMesh, Viewport, texture_of
from ..scenes import Scene
from ..wrinkling import wrinkling_of
from .colours import COLOURS
from .overlays import OVERLAYS, Lines, pointed_lines
from .quality import FULL
from .setting_rules import SKINS
from .settings import Look

STAGES = ("simulation", "refinement", "upload", "draw")
KEPT_TIMES = 180  # frames in the plot
LEAST_SHARE = 0.08  # of the picture that each side of a comparison keeps


# Camera, look, background, viewport, names of muscles that are pointed at.
SceneView = tuple[render.OrbitCamera, Look, render.Background, Viewport, Collection[str]]


class Shot(NamedTuple):
    """One mesh in the picture, and the part of it in which it is seen."""

    picture: DrawnMesh
    viewport: Viewport
    clip: Viewport
    label: str


class Stage:
    """Draws a scene into a window's surface."""

    def __init__(self, surface: render.WindowSurface, scene: Scene, look: Look) -> None:
        self.surface = surface
        self.scene = scene
        self.renderer = render.Renderer(surface)
        self._texture = texture_of(scene, self.renderer)
        self._wrinkling = wrinkling_of(scene, self.renderer)
        self.static = DrawnMesh.of(scene, self.renderer, "none", None)
        self.refined = self.static
        self._adopted: object = None
        self.adopt(look)
        self.times = {name: deque([0.0] * KEPT_TIMES, KEPT_TIMES) for name in STAGES}

    def adopt(self, look: Look) -> None:
        """Bind the refiner that `look` names, with its options; UserError if it refuses them."""
        options = look.options.get(look.refiner)
        wanted = look.refiner, tuple(sorted((options or {}).items()))
        if wanted == self._adopted:
            return
        self._adopted = wanted  # refused options are refused once, not in every frame
        refined = DrawnMesh.of(self.scene, self.renderer, look.refiner, options)
        if self.refined is not self.static:
            self.refined.stream.release()
        self.refined = refined

    def release(self) -> None:
        """Give back what only this scene needs; another stage takes its place."""
        for stream in {id(each): each.stream for each in (self.static, self.refined)}.values():
            stream.release()
        if self._texture is not None:
            self._texture.release()
        if self._wrinkling is not None:
            self._wrinkling.map.release()
        self.renderer.release()

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Add the milliseconds that the block takes to the present frame's."""
        start = time.perf_counter()
        yield
        self.times[name][-1] += 1e3 * (time.perf_counter() - start)

    def next_frame(self) -> None:
        """Start new columns in the plot of times."""
        for times in self.times.values():
            times.append(0.0)

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

    def draw(
        self,
        camera: render.OrbitCamera,
        look: Look,
        background: render.Background,
        viewport: Viewport,
        pointed: Collection[str] = (),
    ) -> None:
        """Draw the scene as it is now; the surface's `detail` says how finely."""
        shots = self.shots(look, viewport)
        style = style_of(look, background)
        amounts = None
        if self._wrinkling is not None and style.shows_wrinkles:
            with self.timed("refinement"):
                amounts = self._wrinkling.amounts(self.scene.positions)
        for shot in shots:
            with self.timed("refinement"):
                shot.picture.refine(self.scene.positions, camera, shot.viewport)
            with self.timed("upload"):
                shot.picture.upload(amounts)
        with self.timed("draw"):
            self.surface.begin()
            overlays = self._overlays(look, camera, pointed)
            self.renderer.draw_background(style, viewport)
            for shot in shots:
                self._draw(
                    shot, camera, style, COLOURS[look.colours].values(self.scene, shot.picture)
                )
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

    def _draw(
        self, shot: Shot, camera: render.OrbitCamera, style: render.Style, values: object
    ) -> None:
        self.renderer.draw_mesh(
            shot.picture.stream,
            camera,
            style,
            viewport=shot.viewport,
            clip=shot.clip,
            values=None if values is None else np.asarray(values, np.uint8),
            texture=self._texture,
            wrinkles=None if self._wrinkling is None else self._wrinkling.map,
        )
        # After the mesh: the skin throws its shadow on eyes and teeth.
        self.renderer.draw_parts(
            self.scene.parts,
            self.scene.bone_transforms(),
            camera,
            style,
            viewport=shot.viewport,
            clip=shot.clip,
        )
        if not self.surface.samples:
            self.renderer.draw_outline(
                shot.picture.stream,
                camera,
                style,
                viewport=shot.viewport,
                clip=shot.clip,
                texture=self._texture,
            )

    def _overlays(
        self, look: Look, camera: render.OrbitCamera, pointed: Collection[str]
    ) -> list[Lines]:
        edges = self.static.refiner.edges
        lines = [OVERLAYS[name](self.scene, edges, camera) for name in look.overlays]
        return [*lines, pointed_lines(self.scene, pointed)] if pointed else lines

    def photograph(
        self,
        camera: render.OrbitCamera,
        look: Look,
        background: render.Background,
        viewport: Viewport,
        pointed: Collection[str] = (),
    ) -> Image:
        """The picture without panels, in full detail, with captions where two meshes are seen."""
        self.surface.detail = FULL
        self.draw(camera, look, background, viewport, pointed)
        left, bottom, width, height = viewport
        top = self.surface.size[1] - bottom - height
        frame = self.surface.read_scene()[top : top + height, left : left + width]
        shots = self.shots(look, viewport)
        if len(shots) == 1:
            return np.ascontiguousarray(frame)
        texts = [f"{shot.label} · {shot.picture.triangle_count} triangles" for shot in shots]
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


def checked(look: Look, refiners: Sequence[str], overlays: Sequence[str]) -> Look:
    """A look without anything that there is none of for this scene."""
    look.overlays = [name for name in look.overlays if name in overlays]
    look.options = {name: dict(found) for name, found in look.options.items() if name in refiners}
    return look
