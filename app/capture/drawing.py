"""Offscreen drawing of frames, with the whole pipeline and a camera."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from risorius import render
from risorius.assets.fitting import FittedHead

from ..anatomy import SKIN_ALONE, AnatomyView
from ..errors import UserError
from ..motion import play
from ..passes.labels import Labelled, labelled
from ..passes.passes import Passes
from ..pictures import Image
from ..pipeline import Pipeline, side_by_side
from ..refining.presets import Refinement
from ..scenes import Scene
from ..script import Script
from .captions import captioned, labels

DEFAULT_VIEW = "front"  # the face looks at the viewer


HEAD_MARGIN = 0.05  # share of the frame that stays free on each side


def camera_for_whole_scene(scene: Scene, view: str | None) -> render.OrbitCamera:
    """Return the camera of `camera_for`, moved away until it sees the whole scene."""
    camera = camera_for(scene, view)
    wanted = camera.distance
    camera.fit(scene.framing.extent, HEAD_MARGIN)
    camera.distance = max(camera.distance, wanted)
    return camera


def camera_for(scene: Scene, view: str | None) -> render.OrbitCamera:
    """Return the camera of a named view, or of "yaw,pitch[,zoom]" around the scene's focus.

    Angles are in degrees. Zoom 1 fits `Framing.framed` into the picture; zoom 2 doubles its size.

    Raises UserError, which lists the views, for any other text.
    """
    view = view or DEFAULT_VIEW
    if view in render.VIEWS:
        return _framing(scene, view)
    yaw, pitch, zoom = _parsed_view(view)
    camera = _framing(scene, "front")
    camera.orbit(yaw, pitch)
    camera.target = scene.framing.focus.copy()
    _, high, near = np.stack(camera.axes()) @ (scene.framing.framed - camera.target).T
    half = (1.0 - HEAD_MARGIN) * math.tan(math.radians(0.5 * camera.field_of_view))
    camera.distance = max(camera.distance, float((near + np.abs(high) / half).max()))
    camera.zoom(zoom)
    return camera


def check_camera(view: str | None, source: str = "") -> None:
    """Raise UserError for a camera unknown to `camera_for`; source: the file that sets it."""
    if view and view not in render.VIEWS:
        try:
            _parsed_view(view)
        except UserError as error:
            raise UserError(f"{source}: {error}" if source else str(error)) from None


def _parsed_view(view: str) -> tuple[float, float, float]:
    """Parse yaw and pitch [degrees] and zoom; raise UserError for any other text."""
    try:
        yaw, pitch, zoom = [*map(float, view.split(",")), 1.0][:3]
        if view.count(",") > 2 or not np.isfinite([yaw, pitch, zoom]).all() or zoom <= 0.0:
            raise ValueError
    except ValueError:
        raise UserError(
            f"camera '{view}': allowed are {', '.join(render.VIEWS)}, "
            "or yaw,pitch[,zoom] in degrees, zoom above 0"
        ) from None
    return yaw, pitch, zoom


def _framing(scene: Scene, view: str) -> render.OrbitCamera:
    """Return a camera that frames `Framing.framed`; other parts of the scene may lie outside."""
    camera = render.OrbitCamera.framing(scene.framing.extent, view=view)
    camera.fit(scene.framing.framed)
    return camera


@dataclass(frozen=True)
class CaptureOptions:
    """Options for the capture of a script."""

    size: tuple[int, int] = (1280, 720)  # size of the whole picture [pixels]
    frames_per_second: float = 30.0
    refinement: Refinement = Refinement()  # noqa: RUF009 - frozen
    beside: tuple[Refinement, ...] = ()  # comparisons, on the left
    captions: bool = True  # names and triangle counts under a comparison
    camera: str | render.OrbitCamera | None = None  # a view, or yaw,pitch[,zoom] in degrees
    is_turntable: bool = False  # the camera circles the scene once during the film
    span: tuple[float, float] | None = None  # [s] of the visible part of the script; None: all
    style: render.Style = render.Style()  # noqa: RUF009 - frozen
    tone: float | None = None  # tone of the skin [deg]; None: that of the head
    anatomy: AnatomyView = SKIN_ALONE
    samples: int = 4
    head: FittedHead | None = None  # None: the built-in head
    is_alive: bool = False  # controls outside the script move by themselves
    passes: tuple[str, ...] = ()  # names of the passes to write beside pictures

    @property
    def is_transparent(self) -> bool:
        """Whether pictures have an alpha channel."""
        return self.style.background is None


@dataclass(frozen=True)
class DrawnFrame:
    """A picture, its labels and passes, and the number of triangles of its finest mesh."""

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
        self._frame: DrawnFrame | None = None  # the last frame
        self._shown = np.zeros(0)  # positions and values in that frame
        if options.tone is not None:
            self.pipeline.set_tone(options.tone)
        view = options.camera
        self.camera = (
            view.copy() if isinstance(view, render.OrbitCamera) else camera_for(scene, view)
        )

    def __enter__(self) -> Capture:
        return self

    def __exit__(self, *error: object) -> None:
        self.surface.__exit__(*error)

    def draw_image(self) -> Image:
        """Draw the current scene, and read the picture back; (H, W, 4) if transparent."""
        options = self.options
        style = self.options.style
        self.pipeline.draw(self.camera, style, self.viewports, anatomy=options.anatomy)
        image = self.surface.read_scene(4 if self.options.is_transparent else 3)
        has_bar = style.colour_by is not render.ColourBy.NONE
        if options.captions and (options.beside or has_bar):
            areas = [viewport.area for viewport in self.viewports]
            texts = [drawn.caption for drawn, *_ in self.viewports if options.beside]
            shown = labels(texts, areas, has_bar=has_bar)
            image = captioned(image, shown, [left for left, *_ in areas])
        return straight(image) if self.options.is_transparent else image

    def refine(self) -> None:
        """Refine a frame without drawing it, because a refiner may depend on earlier frames."""
        self.pipeline.refine(self.camera, self.viewports)

    def is_still(self) -> bool:
        """Whether nothing has moved visibly since the last call that returned False.

        Scenes are compared, not pictures, so all processes that play the script agree. Passes must
        be exact, so this is always False with passes.
        """
        scene = self.scene
        camera = self.camera
        # A turn of a bone counts as motion at the scene's radius; a control's full value as 1 mm.
        bones = [
            np.vstack([each[:3, :3] * camera.scene_radius, each[:3, 3]])
            for each in scene.bone_transforms().values()
        ]
        parts = [part.vertices for part in scene.parts]
        values = scene.values.numbers
        now = np.concatenate([scene.positions, *bones, *parts, values, camera.eye], axis=None)
        width, height = self.viewports[0].area[2:]
        pixels = camera.focal(width / height, height) / np.linalg.norm(camera.eye - camera.target)
        is_same = len(now) == len(self._shown) and not self.options.passes
        # The last picture is shown again if motion is below this number of pixels.
        if is_same and pixels * np.abs(now - self._shown).max() <= 0.05:
            return True
        self._shown = now
        return False

    def next_frame(self) -> DrawnFrame:
        """Return the frame of the current scene, or the last frame again if the scene is still."""
        if self.is_still() and self._frame is not None:
            self.refine()
        else:
            self._frame = self.draw_frame()
        return self._frame

    def draw_frame(self) -> DrawnFrame:
        """Draw the current scene, with the labels and passes of the picture."""
        image = self.draw_image()
        known = None
        triangles = max(drawn.triangle_count for drawn, *_ in self.viewports)
        if self._passes is not None:
            style = self.options.style
            wanted = self.options.passes
            known = labelled(self.scene, self._passes, self.camera, style, wanted)
        return DrawnFrame(image, known, triangles)

    def play(
        self, script: Script, *, until: float | None = None, progress: bool = True
    ) -> Iterator[float]:
        """Play a script; move the scene to each frame, and yield the frame's time [s].

        Frames before the options' span are played too, because later frames depend on them.
        """
        options = self.options
        yaw = self.camera.yaw
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
                fraction = (time - begin) * options.frames_per_second / (frames + 1)
                self.camera.yaw = math.remainder(yaw + 360.0 * fraction, 360.0)
            yield time


def straight(premultiplied: Image) -> Image:
    """Convert premultiplied alpha to straight alpha, (H, W, 4); empty pixels become black."""
    image = premultiplied.copy()
    partly = (image[..., 3] > 0) & (image[..., 3] < 255)
    colours = image[partly].astype(np.float32)
    image[partly, :3] = np.minimum(colours[:, :3] * (255.0 / colours[:, 3:]) + 0.5, 255.0)
    image[image[..., 3] == 0] = 0
    return image
