"""Pictures of what is displayed, and exports: what `risorius capture` and `export` write.

An export goes on in a process of its own, with script and view as they were; the window stays free.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from risorius import render
from risorius.assets.fitting import FittedHead

from ...capture import CaptureOptions, capture
from ...errors import UserError
from ...export.formats import Request, check_request, export, format_for
from ...files import Image, check_file, save_png
from ...scenes import FaceScene, Scene
from ...script import Script, pose_script
from ...workers import Task
from ..frame_times import FrameTimes
from ..interface.gui import wake_up
from ..messages import Message
from ..picture.stage import Stage, style_of
from ..picture.view import View
from ..session.session import Session
from ..settings import FRAMES, KINDS, SHEET, Display, ExportChoices, Kind, Settings


def free_name(folder: Path, stem: str, suffix: str) -> Path:
    """A name in a folder that no file has yet."""
    names = (f"{stem}{extra}{suffix}" for extra in ("", *(f"-{n}" for n in range(2, 1000))))
    return next((folder / each for each in names if not is_there(folder / each)), folder / stem)


def is_there(path: Path) -> bool:
    """Whether something would be replaced; what cannot be written is told when that is tried."""
    with contextlib.suppress(OSError):  # its name is too long, or nobody may look
        return path.exists()
    return False


@dataclass
class StagePicture:
    """Draws as the window does, in a process that makes a film; stands for a `View` there."""

    display: Display
    background: render.Background | None
    viewport: render.Rectangle
    has_captions: bool
    letter: float  # [pixels] of captions, at least
    camera: Any = None
    pointed: Mapping[str, float] = field(default_factory=dict)
    stage: Any = None

    def on(self, scene: Scene, surface: Any) -> StagePicture:
        """Draw this scene onto that surface."""
        self.stage = Stage(surface, scene, self.display, FrameTimes())
        return self

    def refine(self, camera: render.OrbitCamera) -> None:
        """Refine a frame that nobody draws."""
        self.stage.pipeline.refine(camera, self.stage.viewports(self.display, self.viewport))

    def draw_image(self, camera: render.OrbitCamera) -> Image:
        """The picture; premultiplied, where it is transparent."""
        self.camera = camera
        image: Image = self.stage.draw_image(self, has_captions=self.has_captions)
        return image


@dataclass
class ExportJob:
    """An export that is being made."""

    target: Path
    task: Task
    began: tuple[float, float] = (0.0, 0.0)  # [s] when the first of it was done, and how much
    told: float = 0.0  # how much of it was done when the user was told


class Exporter:
    """Screenshots of a stage; films and files of a session, one at a time."""

    def __init__(self, session: Session, settings: Settings, stage: Stage, view: View) -> None:
        self._session, self._settings, self._stage, self._view = session, settings, stage, view
        self.job: ExportJob | None = None
        self.is_asking = False  # the dialog is open
        self.name, self._proposed = "", ("", "")  # what was asked for, what was proposed
        self.span = (0.0, 0.0)  # [s] that is exported of a script in part

    @property
    def choices(self) -> ExportChoices:
        """What is exported, and how."""
        return self._settings.export

    @property
    def kind(self) -> Kind:
        """The kind of file."""
        return KINDS[self.choices.kind]

    @property
    def target(self) -> Path:
        """The file, or folder of frames."""
        name, suffix = self.name, self.kind.suffix
        folder = Path(self.choices.folder or ".")
        with contextlib.suppress(RuntimeError):  # "~" and the beginning of a name, as it is typed
            folder = folder.expanduser()
        return folder / f"{name.removesuffix(suffix)}{suffix}"

    def screenshot(self) -> Message:
        """Write the picture without panels, in full detail."""
        target = free_name(Path.cwd(), time.strftime("risorius-%Y%m%d-%H%M%S"), ".png")
        save_png(target, self._stage.draw_image(self._view))
        return f"Written to {target}"

    def ask(self) -> None:
        """Open the dialog, with what was used last."""
        script = self._session.script
        if not (script.posed_names or script.tracks):
            self.choices.source = "pose"
        self.choices.folder = self.choices.folder or str(Path.cwd())
        self.span, self.name = (0.0, script.duration), Path(self._session.name).stem
        self.propose()
        self.is_asking = True

    def propose(self) -> None:
        """Take a name that no file of this kind has: the one that was written, if that is free."""
        suffix, (stem, proposed) = self.kind.suffix, self._proposed
        stem = stem if self.name == proposed else self.name
        self.name = free_name(self.target.parent, stem, suffix).name.removesuffix(suffix)
        self._proposed = stem, self.name

    def played(self) -> tuple[Script, tuple[float, float]]:
        """The script, or the face as it is, and from when to when that is exported [s]."""
        session, choices = self._session, self.choices
        if choices.source == "pose" and choices.kind != SHEET:
            pose = pose_script(session.current, title="pose", scene=session.script.scene)
            return replace(pose, duration=choices.seconds), (0.0, choices.seconds)
        is_part = choices.source == "part" and choices.kind != SHEET
        return session.script, self.span if is_part else (0.0, session.script.duration)

    def _options(self, head: FittedHead | None, span: tuple[float, float]) -> CaptureOptions:
        """How `capture` is told to draw what the window shows."""
        choices, view, is_sheet = self.choices, self._view, self.choices.kind == SHEET
        is_clear = choices.is_transparent and self.kind.can_be_transparent
        background, display = None if is_clear else view.background, deepcopy(view.display)
        area = (0, 0, *choices.size)
        letter = view.letter * choices.size[1] / view.viewport[3]
        return CaptureOptions(
            choices.size,
            choices.rate,
            camera=view.camera.copy(),
            is_turntable=choices.is_turntable and not is_sheet,
            span=None if is_sheet else span,
            picture=StagePicture(display, background, area, choices.has_captions, letter).on,
            style=style_of(display, background),
            head=head,
            is_alive=self._settings.is_alive,
        )

    def start(self) -> None:
        """Check what can be checked, and begin; UserError where it cannot be."""
        if not self.name:
            raise UserError("give the file a name")
        choices, target, (script, span) = self.choices, self.target, self.played()
        scene = self._session.scene
        head = scene.head if isinstance(scene, FaceScene) else None
        head = head if isinstance(head, FittedHead) else None
        work: Callable[[], object]
        if self.kind.is_drawn:
            check_file(target / "frame.png" if choices.kind == FRAMES else target)
            draw = partial(capture, script, self._options(head, span), overwrite=True)
            name = "sheet" if choices.kind == SHEET else "output"
            work = partial(draw, progress=False, **{name: target})
        else:
            chosen = format_for(target, choices.kind)
            request = Request(overwrite=target.exists(), progress=False)
            check_request(target, chosen, request)
            rate = choices.rate
            write = partial(export, head=head, frames_per_second=rate, span=span)
            work = partial(write, script, target, chosen, request)
        task = Task(work, round(span[1] * choices.rate) + 1, wake_up)
        self.job, self.is_asking = ExportJob(target, task), False

    @property
    def has_news(self) -> bool:
        """Whether there is more to be told of it than a moment ago."""
        job = self.job
        if job is None or (job.told == job.task.share and not job.task.is_done):
            return False
        if not job.told:  # to start the process is no measure of how fast it is
            job.began = time.monotonic(), job.task.share
        job.told = job.task.share
        return True

    def poll(self) -> Message:
        """Look whether it is done, and say so; UserError where it failed."""
        job = self.job
        if job is None or not job.task.is_done:
            return None
        self.job, is_cancelled = None, job.task.is_stopped
        job.task.stop(waits=False)
        if is_cancelled:
            return f"Cancelled: {job.target.name}"
        job.task.check()
        return f"Written to {job.target}"

    def close(self) -> None:
        """End it at once; what is half written goes."""
        job, self.job = self.job, None
        if job is not None:
            job.task.stop(waits=True)
