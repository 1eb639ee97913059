"""Offscreen, frame by frame: a surface with the whole pipeline behind it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from risorius import render
from risorius.assets.fitting import FittedHead

from ..anatomy import SKIN_ALONE, AnatomyView
from ..files import Image
from ..motion import play
from ..passes.labelled import Labelled, labelled
from ..passes.passes import Passes
from ..pipeline import Pipeline, side_by_side
from ..refining.presets import Refinement
from ..scenes import Scene
from ..script import Script
from .cameras import camera_for
from .captions import SPLITS_BAR, captioned, labels

UNSEEN = 0.05  # [pixels] of motion: within that, the last picture is shown once more


class Picture(Protocol):
    """A scene on an offscreen surface, drawn in a way of its own, as a window shows it."""

    def refine(self, camera: render.OrbitCamera) -> None:
        """Refine a frame that nobody draws."""

    def draw_image(self, camera: render.OrbitCamera) -> Image:
        """Draw it as it is now, (H, W, 3), or (H, W, 4) and premultiplied."""


@dataclass(frozen=True)
class CaptureOptions:
    """How a script is filmed."""

    size: tuple[int, int] = (1280, 720)  # of the whole picture [pixels]
    frames_per_second: float = 30.0
    refinement: Refinement = Refinement()  # noqa: RUF009 - frozen
    beside: tuple[Refinement, ...] = ()  # what it is compared with, on its left
    captions: bool = True  # names and triangle counts under a comparison
    camera: str | render.OrbitCamera | None = None  # a view, or yaw,pitch[,zoom] in degrees
    is_turntable: bool = False  # the camera goes round once, by the last frame
    span: tuple[float, float] | None = None  # [s] of the script that is seen; None: all of it
    # What draws it instead of these refinements and this style.
    picture: Callable[[Scene, render.OffscreenSurface], Picture] | None = None
    style: render.Style = render.Style()  # noqa: RUF009 - frozen
    anatomy: AnatomyView = SKIN_ALONE
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
        self.surface = render.open_offscreen(options.size, samples=options.samples)
        self.pipeline = Pipeline(scene, render.Renderer(self.surface))
        refinements = (*options.beside, options.refinement)
        meshes = [self.pipeline.bind(each) for each in refinements]
        self._passes = Passes(self.pipeline, meshes[-1]) if options.passes else None
        self.viewports = side_by_side(self.surface.size, meshes)
        self._frame: Frame | None = None  # the last one
        self._shown = np.zeros(0)  # what it was drawn of
        self._picture = None if options.picture is None else options.picture(scene, self.surface)
        view = options.camera
        self.camera = (
            view.copy() if isinstance(view, render.OrbitCamera) else camera_for(scene, view)
        )

    def __enter__(self) -> Capture:
        return self

    def __exit__(self, *_: object) -> None:
        self.surface.close()

    def draw_image(self) -> Image:
        """Draw the scene as it is now, and read the picture back; (H, W, 4) if transparent."""
        if self._picture is not None:
            image = self._picture.draw_image(self.camera)
            return straight(image) if self.options.is_transparent else image
        self.surface.begin()
        options = self.options
        self.pipeline.draw(self.camera, options.style, self.viewports, anatomy=options.anatomy)
        self.surface.end()
        image = self.surface.read_scene(4 if self.options.is_transparent else 3)
        if self.options.beside and self.options.captions:
            texts, style = [drawn.caption for drawn, *_ in self.viewports], options.style
            areas = [viewport.area for viewport in self.viewports]
            bar = SPLITS_BAR if style.colour_by is render.ColourBy.SPLITS else None
            image = captioned(image, labels(texts, areas, bar, style), [left for left, *_ in areas])
        return straight(image) if self.options.is_transparent else image

    def refine(self) -> None:
        """Refine a frame that nobody draws: a refiner may remember it in the next one."""
        if self._picture is None:
            self.pipeline.refine(self.camera, self.viewports)
        else:
            self._picture.refine(self.camera)

    def is_still(self) -> bool:
        """Whether nothing has moved so far that anybody could see it, since this last said no.

        What is compared is the scene, not pictures: each process that plays it says the same. What
        lies beside pictures has to be exact, so with passes nothing is still.
        """
        scene, camera = self.scene, self.camera
        # Bones turn what is as far from them as the scene is wide; a control counts as 1 mm.
        bones = [
            np.vstack([each[:3, :3] * camera.scene_radius, each[:3, 3]])
            for each in scene.bone_transforms().values()
        ]
        parts = [part.vertices for part in scene.parts]
        values = [*scene.values.values()]
        now = np.concatenate([scene.positions, *bones, *parts, values, camera.eye], axis=None)
        width, height = self.viewports[0].area[2:]
        pixels = camera.focal(width / height, height) / np.linalg.norm(camera.eye - camera.target)
        is_same = len(now) == len(self._shown) and not self.options.passes
        if is_same and pixels * np.abs(now - self._shown).max() <= UNSEEN:
            return True
        self._shown = now
        return False

    def next_frame(self) -> Frame:
        """The frame of the scene as it is now: the last one again, if the scene is still."""
        if self.is_still() and self._frame is not None:
            self.refine()
        else:
            self._frame = self.draw_frame()
        return self._frame

    def draw_frame(self) -> Frame:
        """Draw the scene as it is now, and say what is known of the picture."""
        image, known = self.draw_image(), None
        triangles = max(drawn.triangle_count for drawn, *_ in self.viewports)
        if self._passes is not None:
            known = labelled(self._passes, self.camera, self.options.passes)
        return Frame(image, known, triangles)

    def play(
        self, script: Script, *, until: float | None = None, progress: bool = True
    ) -> Iterator[float]:
        """Play a script and yield the time [s] of each frame, the scene moved to it.

        Frames before the options' span are played, too: what is seen then depends on them.
        """
        options, yaw = self.options, self.camera.yaw
        viewer = self.camera.eye if options.is_alive else None
        begin, end = options.span or (0.0, script.duration if until is None else until)
        frames = max(round((end - begin) * options.frames_per_second), 1)
        for time in play(
            self.scene,
            script,
            options.frames_per_second,
            until=end,
            viewer=viewer,
            step=self.pipeline.step,
            progress=progress,
        ):
            if options.is_turntable:
                share = (time - begin) * options.frames_per_second / (frames + 1)
                self.camera.yaw = math.remainder(yaw + 360.0 * share, 360.0)
            yield time


def straight(premultiplied: Image) -> Image:
    """From premultiplied colours to those that files hold, (H, W, 4); black where nothing is."""
    image = premultiplied.copy()
    partly = (image[..., 3] > 0) & (image[..., 3] < 255)
    colours = image[partly].astype(np.float32)
    image[partly, :3] = np.minimum(colours[:, :3] * (255.0 / colours[:, 3:]) + 0.5, 255.0)
    image[image[..., 3] == 0] = 0
    return image
