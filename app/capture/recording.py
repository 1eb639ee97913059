"""Offscreen capture: a script becomes a film, a folder of frames, a picture or a contact sheet."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from risorius import render
from risorius.assets.fitting import FittedHead

from ..cameras import camera_for
from ..errors import UserError
from ..files import Image, check_file, check_png, save_png
from ..looks import Refinement
from ..motion import play, scene_of
from ..passes.files import Labelled, beside, check_wanted, labelled, save_labelled
from ..passes.passes import Passes
from ..pipeline import Pipeline, side_by_side
from ..scenes import Scene
from ..script import Script
from ..sound import load_sound
from . import outputs
from .captions import captioned, contact_sheet
from .ffmpeg import Soundtrack


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


class Capture:
    """An offscreen surface with the whole pipeline behind it; a context manager."""

    def __init__(self, scene: Scene, options: CaptureOptions) -> None:
        self.scene = scene
        self.options = options
        self.surface = render.open_offscreen(options.size, samples=options.samples)
        refinements = (*options.beside, options.refinement)
        renderer = render.Renderer(self.surface)
        self.pipeline = Pipeline(scene, renderer, refinements)
        self._passes = Passes(self.pipeline) if options.passes else None
        self.viewports = side_by_side(self.surface.size, len(refinements))
        self.camera = camera_for(scene, options.camera)
        self.most_triangles = 0

    def __enter__(self) -> Capture:
        return self

    def __exit__(self, *_: object) -> None:
        self.surface.close()

    def draw_image(self) -> Image:
        """Draw the scene as it is now, and read the picture back."""
        self.surface.begin()
        self.pipeline.draw(self.camera, self.options.style, self.viewports)
        self.surface.end()
        meshes = self.pipeline.meshes
        self.most_triangles = max(
            [self.most_triangles, *(drawn.triangle_count for drawn in meshes)]
        )
        image = self.surface.read()
        if self.options.beside and self.options.captions:
            texts = [f"{drawn.label} · {drawn.triangle_count} triangles" for drawn in meshes]
            image = captioned(image, texts, self.viewports)
        return image

    def label(self) -> Labelled | None:
        """What is known of the image that was drawn last; None where nobody wants to know."""
        if self._passes is None:
            return None
        return labelled(self._passes, self.camera, self.options.passes)

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


def capture(
    script: Script,
    options: CaptureOptions,
    *,
    output: Path | None = None,
    sheet: Path | None = None,
    time: float | None = None,
    overwrite: bool = False,
    progress: bool = True,
) -> int:
    """Play `script` into `output`, by its suffix, and its named poses into the picture `sheet`.

    time: of a picture [s]; else it is of the first pose that has a name, or of the end.
    Returns the largest number of triangles of a frame. Raises UserError on what cannot be.
    """
    _check(script, output, sheet, time)
    _check_passes(script, output, options)
    wanted = list(script.key_poses) if sheet else []
    still = output if _is_image(output) else None
    if time is None:
        time = script.key_poses[0].time if script.key_poses else script.duration
    rate = options.frames_per_second
    still_at = round(time * rate) / rate if still else -1.0
    until = still_at if still and not sheet else max(script.duration, still_at)
    named: list[tuple[str, Image]] = []
    with contextlib.ExitStack() as stack:
        recording = stack.enter_context(Capture(scene_of(script, options.head), options))
        film = None
        if output is not None and not still:
            film = stack.enter_context(_sink_for(output, options, overwrite, soundtrack_of(script)))
        for now in recording.play(script, until=until, progress=progress):
            is_wanted = bool(wanted) and wanted[0].time <= now + 0.5 / rate
            if film is None and not is_wanted and now != still_at:
                continue
            image, known = recording.draw_image(), None
            if film is not None or now == still_at:
                known = recording.label()
            if film is not None:
                film(image, known)
            if still and now == still_at:
                if known is not None:
                    save_labelled(still, known)
                save_png(still, image)
            while wanted and wanted[0].time <= now + 0.5 / rate:
                named.append((wanted.pop(0).name or "", image))
        if sheet is not None:
            save_png(sheet, contact_sheet(named, columns=2 if options.beside else 3))
        return recording.most_triangles


def _is_image(output: Path | None) -> bool:
    return output is not None and output.suffix.lower() == ".png"


def _check(script: Script, output: Path | None, sheet: Path | None, time: float | None) -> None:
    """Raise UserError, before any work is done, where one of the outputs cannot be."""
    if time is not None and not _is_image(output):
        raise UserError("--time says when a picture is taken: it goes with -o PICTURE.png")
    if output is None and sheet is None:
        raise UserError("nothing to write: give -o OUTPUT, --sheet PICTURE, or both")
    if sheet and not script.key_poses:
        raise UserError(f"{script.source}: no pose has a name, so there is nothing for a sheet")
    if sheet is not None:
        check_png(sheet)
    if output is not None and _is_image(output):
        check_png(output)
    elif output is not None and output.suffix.lower() in outputs.FILM_SUFFIXES:
        check_file(output)
        if script.sound is not None:
            load_sound(script.sound)


def _check_passes(script: Script, output: Path | None, options: CaptureOptions) -> None:
    """Raise UserError, before any work is done, where the passes cannot be had or written."""
    if not options.passes:
        return
    check_wanted(options.passes, script.scene)
    if output is None or output.suffix.lower() in outputs.FILM_SUFFIXES:
        raise UserError(
            "--passes are files beside each picture: give -o a folder, or one picture.png"
        )
    if options.beside:
        raise UserError("--passes are those of one mesh: leave --compare out")
    if _is_image(output):
        for path in beside(output):
            check_file(path)


def soundtrack_of(script: Script) -> Soundtrack | None:
    """What is heard in a film of a script: its sound, as far as the script goes."""
    return None if script.sound is None else Soundtrack(script.sound, script.duration)


def _sink_for(
    output: Path, options: CaptureOptions, overwrite: bool, soundtrack: Soundtrack | None
) -> contextlib.AbstractContextManager[outputs.FrameSink]:
    """A film or a folder of frames, by what the output is called."""
    suffix = output.suffix.lower()
    if suffix in outputs.FILM_SUFFIXES:
        return outputs.film(output, options.size, options.frames_per_second, soundtrack)
    if suffix == "" or output.is_dir():
        return outputs.folder(output, overwrite=overwrite)
    raise UserError(
        f"{output}: what is '{suffix}'? Allowed are {', '.join(outputs.FILM_SUFFIXES)} (a film), "
        ".png (one picture) and a name without suffix (a folder of frames)"
    )
