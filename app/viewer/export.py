"""Pictures of what is displayed, and exports: what `risorius capture` and `export` write.

An export goes on in a process of its own, with the script and the view as they were, and the window
stays free. The dialog is panels/export_dialog.py.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from risorius import render
from risorius.assets.fitting import FittedHead

from ..capture import CaptureOptions
from ..capture import capture as film_of
from ..errors import UserError
from ..export.formats import Request, check_request, export, format_for
from ..files import check_file, check_folder, save_png
from ..looks import STATIC, Refinement, named
from ..pipeline import DrawnMesh
from ..scenes import FaceScene, Scene
from ..script import Script, pose_script
from ..workers.crew import Crew, Outcome
from ..workers.telling import telling, told
from .colours import COLOURS, Amounts
from .export_kinds import FRAMES, KINDS, SHEET, Kind
from .gui import wake_up
from .messages import Message, Task
from .overlays import OVERLAYS, Lines
from .session import Session
from .settings import ExportChoices, Settings
from .stage import Stage, style_of
from .view import View


def free_name(folder: Path, stem: str, suffix: str) -> Path:
    """A name in a folder that no file has yet."""
    names = (f"{stem}{extra}{suffix}" for extra in ("", *(f"-{n}" for n in range(2, 1000))))
    return next((folder / each for each in names if not (folder / each).exists()), folder / stem)


@dataclass(frozen=True)
class Overlaid:
    """What the window draws over the meshes, by names, for a process that draws them, too."""

    colours: str
    overlays: tuple[str, ...]

    def values(self, scene: Scene, drawn: DrawnMesh) -> Amounts | None:
        """One value for each drawn triangle."""
        return COLOURS[self.colours].values(scene, drawn)

    def lines(self, scene: Scene, drawn: DrawnMesh, camera: render.OrbitCamera) -> Iterable[Lines]:
        """The overlays' lines."""
        edges = drawn.refiner.edges
        return [OVERLAYS[name](scene, edges, camera) for name in self.overlays]


@dataclass
class Job:
    """An export that is being made: what becomes of it, and how far it is."""

    target: Path
    frame_count: int
    crew: Crew
    log: Path
    outcome: Future[Outcome]
    began: float  # [s]
    then: Task | None = None  # what waits for it

    @property
    def share(self) -> float:
        """How much of it is done, 0..1."""
        return min(told(self.log) / self.frame_count, 1.0)


class Exporter:
    """Screenshots of a stage; films and files of a session, one at a time."""

    save_label = "Wait for it"

    def __init__(self, session: Session, settings: Settings, stage: Stage, view: View) -> None:
        self._session, self._settings, self._stage, self._view = session, settings, stage, view
        self.job: Job | None = None
        self.is_asking = False  # the dialog is open
        self.name = ""
        self.span = (0.0, 0.0)  # [s] of the script

    @property
    def choices(self) -> ExportChoices:
        """What is exported, and how."""
        return self._settings.export

    @property
    def kind(self) -> Kind:
        """The kind of file."""
        return KINDS[self.choices.kind]

    @property
    def folder(self) -> Path:
        """Where it goes."""
        return Path(self.choices.folder).expanduser() if self.choices.folder else Path.cwd()

    @property
    def target(self) -> Path:
        """The file, or folder of frames."""
        return self.folder / f"{self.name}{self.kind.suffix}"

    def screenshot(self) -> Message:
        """Write the picture without panels, in full detail."""
        target = free_name(Path.cwd(), time.strftime("risorius-%Y%m%d-%H%M%S"), ".png")
        save_png(target, self._stage.draw_image(self._view))
        return f"{target.name}: written to {target.parent}"

    def ask(self) -> None:
        """Open the dialog, with what was used last."""
        script = self._session.script
        if not (script.posed_names or script.tracks):
            self.choices.source = "pose"
        self.span = (0.0, script.duration)
        self.name = Path(self._session.name).stem.replace("/", "-")
        self.propose()
        self.is_asking = True

    def propose(self) -> None:
        """Take a name that no file has."""
        self.name = free_name(self.folder, self.name, self.kind.suffix).name.removesuffix(
            self.kind.suffix
        )

    @property
    def script(self) -> Script:
        """What is played: the script, or the face as it is."""
        session, choices = self._session, self.choices
        if choices.source != "pose" or choices.kind == SHEET:
            return session.script
        pose = pose_script(session.current, title="pose", scene=session.script.scene)
        return replace(pose, duration=choices.seconds)

    @property
    def seconds(self) -> tuple[float, float]:
        """From when to when that is exported [s]."""
        is_part = self.choices.source == "part" and self.choices.kind != SHEET
        return self.span if is_part else (0.0, self.script.duration)

    def options(self) -> CaptureOptions:
        """How `capture` is told to draw what the window shows."""
        choices, display, scene = self.choices, self._settings.display, self._session.scene
        is_compared, is_wiped = display.compare != "off", display.compare == "wipe"
        refinement = Refinement(refiner=STATIC)
        if is_compared or display.is_refined:
            refinement = display.refinement_on(scene)
        is_clear = choices.is_transparent and self.kind.can_be_transparent
        over = Overlaid(display.colours, tuple(display.overlays))
        return CaptureOptions(
            choices.size,
            choices.rate,
            refinement,
            (named(display.beside, display.look),) if is_compared else (),
            choices.has_captions,
            display.divider if is_wiped else None,
            self._view.camera.copy(),
            choices.is_turntable and choices.kind != SHEET,
            self.seconds if choices.kind != SHEET else None,
            None if over == Overlaid("none", ()) else over,
            style_of(display, None if is_clear else self._view.background),
            head=_head_of(scene),
            is_alive=self._settings.is_alive and isinstance(scene, FaceScene),
        )

    def start(self) -> Message:
        """Check what can be checked, and begin; UserError where it cannot be."""
        choices, target, script = self.choices, self.target, self.script
        work: Callable[[], object]
        if self.kind.is_drawn:
            (partial(check_folder, overwrite=True) if choices.kind == FRAMES else check_file)(
                target
            )
            filmed = partial(film_of, script, self.options(), overwrite=True, progress=False)
            work = partial(filmed, output=target)
            if choices.kind == SHEET:
                work = partial(filmed, sheet=target)
        else:
            chosen = format_for(target, choices.kind)
            request = Request(overwrite=target.exists(), progress=False)
            check_request(target, chosen, request)
            work = partial(
                export,
                script,
                target,
                chosen,
                request,
                head=_head_of(self._session.scene),
                frames_per_second=choices.rate,
                span=self.seconds,
            )
        count = round(self.seconds[1] * choices.rate) + 1
        crew, log = Crew(1), Path(tempfile.mkstemp(prefix="risorius-", suffix=".log")[1])
        thread = ThreadPoolExecutor(1)
        outcome = thread.submit(crew.do, telling, 0, work, retries=0, log=log)
        outcome.add_done_callback(lambda _: wake_up())
        thread.shutdown(wait=False)
        self.job = Job(target, count, crew, log, outcome, time.monotonic())
        self.is_asking = False
        return None

    def poll(self) -> Message:
        """Look whether it is done, and say so."""
        job = self.job
        if job is None or not job.outcome.done():
            return None
        error = job.outcome.result().error
        self.cancel()
        if error is not None:
            raise UserError(error)
        line = f"{job.target.name}: written to {job.target.parent}"
        return line if job.then is None else job.then()

    def cancel(self) -> None:
        """End it; what is half written goes."""
        job, self.job = self.job, None
        if job is not None:
            job.crew.stop()
            job.log.unlink(missing_ok=True)

    @property
    def unsaved(self) -> str:
        """What would be lost by closing now, in words; "" for nothing."""
        job = self.job
        return "" if job is None else f"{job.target.name}, of which {job.share:.0%} are done"

    def save(self, then: Task) -> Message:
        """Go on when it is done."""
        if self.job is None:
            return then()
        self.job.then = then
        return f"waiting for {self.job.target.name} ..."


def _head_of(scene: Scene) -> FittedHead | None:
    """The head that a scene like this one is built with."""
    head = scene.head if isinstance(scene, FaceScene) else None
    return head if isinstance(head, FittedHead) else None
