"""Offscreen, frame by frame: a surface with the whole pipeline behind it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from risorius import render
from risorius.assets.fitting import FittedHead

from ..cameras import camera_for
from ..files import Image
from ..keeping import is_keeping, kept
from ..looks import Refinement
from ..motion import play
from ..passes.files import Labelled, labelled
from ..passes.passes import Passes
from ..pipeline import Pipeline, side_by_side
from ..scenes import Scene
from ..script import Script
from .captions import SPLITS_BAR, captioned, labels
from .transparency import straight


@dataclass(frozen=True)
class CaptureOptions:
    """How a script is filmed."""

    size: tuple[int, int] = (1280, 720)  # of the whole picture [pixels]
    frames_per_second: float = 30.0
    refinement: Refinement = Refinement()  # noqa: RUF009 - frozen
    beside: tuple[Refinement, ...] = ()  # what it is compared with, on its left
    captions: bool = True  # names and triangle counts under a comparison
    camera: str | None = None  # a named view, or yaw,pitch[,zoom] in degrees
    style: render.Style = render.Style()  # noqa: RUF009 - frozen
    samples: int = 4
    head: FittedHead | None = None  # None: the built-in one
    is_alive: bool = False  # what the script leaves alone moves by itself
    passes: tuple[str, ...] = ()  # what is written beside pictures, by name

    @property
    def is_transparent(self) -> bool:
        """Whether pictures have an alpha channel."""
        return self.style.background is None


@dataclass(frozen=True)
class Frame:
    """A picture, what is to lie beside it, and how many triangles its finest mesh has."""

    image: Image
    known: Labelled | None
    triangle_count: int


class Capture:
    """An offscreen surface with the whole pipeline behind it; a context manager."""

    def __init__(self, scene: Scene, options: CaptureOptions) -> None:
        self.scene = scene
        self.options = options
        refinements = (*options.beside, options.refinement)

        def opened() -> tuple[render.OffscreenSurface, Pipeline]:
            """A surface, and the scene's textures on it."""
            surface = render.open_offscreen(options.size, samples=options.samples)
            return surface, Pipeline(scene, render.Renderer(surface), ())

        # What is kept holds its scene, so that no other can have this identity.
        key = (options.size, options.samples, id(scene))
        self.surface, self.pipeline = kept("surface", key, opened, lambda made: made[0].close())
        self.surface.make_current()
        self.pipeline.bind(refinements)
        self._passes = Passes(self.pipeline) if options.passes else None
        self.viewports = side_by_side(self.surface.size, len(refinements))
        self.camera = camera_for(scene, options.camera)

    def __enter__(self) -> Capture:
        return self

    def __exit__(self, *_: object) -> None:
        if not is_keeping():
            self.surface.close()

    def draw_image(self) -> Image:
        """Draw the scene as it is now, and read the picture back; (H, W, 4) if transparent."""
        self.surface.begin()
        self.pipeline.draw(self.camera, self.options.style, self.viewports)
        self.surface.end()
        image = self.surface.read_scene(4 if self.options.is_transparent else 3)
        if self.options.beside and self.options.captions:
            texts, style = [drawn.caption for drawn in self.pipeline.meshes], self.options.style
            bar = SPLITS_BAR if style.colour_by is render.ColourBy.SPLITS else None
            shown = labels(texts, self.viewports, bar, style)
            image = captioned(image, shown, self.viewports)
        return straight(image) if self.options.is_transparent else image

    def draw_frame(self) -> Frame:
        """Draw the scene as it is now, and say what is known of the picture."""
        image, known = self.draw_image(), None
        triangles = max(drawn.triangle_count for drawn in self.pipeline.meshes)
        if self._passes is not None:
            known = labelled(self._passes, self.camera, self.options.passes)
        return Frame(image, known, triangles)

    def play(
        self, script: Script, *, until: float | None = None, progress: bool = True
    ) -> Iterator[float]:
        """Play a script and yield the time [s] of each frame, the scene moved to it."""
        options = self.options
        viewer = self.camera.eye if options.is_alive else None
        return play(
            self.scene,
            script,
            options.frames_per_second,
            until=until,
            viewer=viewer,
            step=self.pipeline.step,
            progress=progress,
        )
