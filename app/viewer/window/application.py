"""The parts of the window: the one place where all parts of the viewer meet."""

from __future__ import annotations

import contextlib
import logging
from functools import partial
from pathlib import Path

from risorius import refine
from risorius.assets.fitting import FittedHead

from ...control_names import readable
from ...errors import UserError
from ...refining.plug_ins import plug_ins_of, reported
from ...refining.refiners import refiner_for
from ...scenes import Scene, build_scene
from ...script import Script
from ..context import ApplicationContext
from ..documents.export import ExportDialog
from ..documents.file_drop import FileDrop
from ..interface.commands import Command, MenuBar
from ..marking import Marking, MarkingMode
from ..messages import Message, Task
from ..panels.face import FacePanel
from ..panels.layout import Layout
from ..panels.live import LivePanel
from ..panels.mechanism import MechanismPanel
from ..picture.mouse import Mouse
from ..picture.skin import SkinDrag
from ..picture.stage import Painter
from ..session.physics import IdleLife, Physics
from ..session.recovery import Recovery
from ..session.session import Session
from ..session.soundtrack import Soundtrack
from ..settings import Display, save_settings
from ..timeline.dope_sheet import DopeSheet
from ..timeline.key_marks import Waveform
from ..timeline.keys import KeySelection
from ..timeline.time_axis import TimeAxis
from ..timeline.timeline import Timeline
from . import menus
from .splash_screen import SplashScreen


class Application(ApplicationContext):
    """An open window and all its parts, each with the others that it needs; nothing moves yet."""

    def __init__(
        self,
        script: Script,
        size: tuple[int, int] | None = None,
        display: Display | None = None,
        *,
        head: FittedHead | None = None,
        settings_path: Path | None = None,
        splash: SplashScreen | None = None,
    ) -> None:
        """Open the window.

        head: a user's own, None for the built-in one. size, display: None takes those remembered.
        splash: the window, where it is open already.
        settings_path: of the settings, beside which unsaved work is kept; None for nowhere.
        Raises UserError for a script that names controls which the scene has not.
        """
        self._settings_path = settings_path
        splash = splash or SplashScreen(size, settings_path)
        settings = splash.settings
        complaint = splash.complaint
        scene = splash.during(partial(_ready_scene, script, head, display or settings.display))
        if display is not None:
            settings.display = display
            _refine_once(scene, display)
        else:
            complaint = complaint or _without_refused_options(settings.display, scene)
        settings.display.remove_missing_overlays(scene)
        with contextlib.ExitStack() as stack:  # an error here closes the window again
            stack.push(splash)
            super().__init__(Session(scene, script), settings, splash.surface)
            stack.push(self.opened)
            self._resources = stack.pop_all()
        self.recovery = Recovery(settings_path and settings_path.parent, self.session)
        self.soundtrack = Soundtrack(self.session)
        self._join_commands()
        self._join_panels()
        self.is_leaving = False
        if script.is_converted or self.session.file.path is not None:
            settings.note_recent(Path(script.source))
        if (kept := self.recovery.found) is not None:
            settings.note_recent(kept)
            complaint = complaint or f"unsaved work is in File > Recent: {kept.name}"
        if complaint:
            self.messages.say(complaint, error=True)
        elif settings_path is not None and not settings_path.exists():
            self.messages.say("Drag the skin, or open one of File > Examples; menus show every key")

    def _join_commands(self) -> None:
        """Make all commands, each with the parts that it needs."""
        session = self.session
        settings = self.settings
        self.time_axis = TimeAxis()
        self.selection = KeySelection(session)
        self.marking_mode: MarkingMode | None = None  # a mesh whose landmarks are being marked
        self.file_drop = FileDrop(self.files, self.scripts, self.show_scene, self.read)
        self.commands: tuple[Command, ...] = (
            *menus.file_menu(
                self.scripts, self.file_drop, self.exporter, settings, self.ask_to_close
            ),
            *menus.edit_menu(session),
            *menus.time_menu(session, self.scripts, self.time_axis),
            *menus.keys_menu(session, self.selection),
            *menus.view_menu(settings, self.view),
            *menus.expression_menu(session),
            *menus.live_menu(self.live),
            *menus.help_menu(),
        )
        self.gui.keys = {each.label: each.displayed_keys for each in self.commands}
        self.life = IdleLife(session, lambda: settings.is_alive, lambda: self.view.camera.eye)
        self.physics = Physics(session, self.times)
        self.painter = Painter(self.stage, self.view, self.messages)

    def _join_panels(self) -> None:
        """Make the panels around the picture, and the mouse in it."""
        session = self.session
        bar = MenuBar(self.gui, self.messages, self.commands, lambda: session.work.unsaved)
        waveform = Waveform(self.gui, self.soundtrack, self.time_axis)
        dope_sheet = DopeSheet(self, self.selection, self.time_axis, bar, waveform)
        self.timeline = Timeline(self, self.commands, dope_sheet)
        self.face_panel = FacePanel(self, self.selection)
        mechanism = MechanismPanel(self, self.file_drop)
        live = LivePanel(self, {each.label: each for each in self.commands})
        first = "Face" if session.scene.name == "face" else f"{readable(session.scene.name)}###Face"
        tabs = {first: self.face_panel.draw, "Mechanism": mechanism.draw, "Live": live.draw}
        self.layout = Layout(self, bar, tabs, self.timeline)
        self.export_dialog = ExportDialog(self.gui, self.exporter, self.files, self.view)
        grab = partial(SkinDrag, session, self.settings)
        self.mouse = Mouse(self.view, self.stage, self.messages, grab, self.select_muscle)

    def close(self) -> None:
        """Remember the settings, and let go of everything."""
        try:
            self.remember()
        except UserError as error:  # a disk that is full must not keep the window open
            log = logging.getLogger("risorius.viewer")  # reports when there is no window any more
            log.warning("risorius: %s; the next window does not look as this one", error)
        self.live.stop()
        self.exporter.close()
        self.leave_marking()
        self.soundtrack.close()
        self.recovery.close()
        self._resources.close()

    def remember(self) -> None:
        """Write the settings as they are now; UserError where that cannot be."""
        if self._settings_path is not None:
            self.settings.size = self.gui.window_size
            save_settings(self._settings_path, self.settings)

    # Changes of the window as a whole

    def show_scene(self, scene: Scene) -> None:
        """Take another scene with the same controls in place of this one."""
        if self.marking_mode is not None and self.marking_mode.marking.unsaved:
            raise UserError("landmarks were moved meanwhile: use this head once more")
        self.session.move_to(scene)
        self.leave_marking()
        display = self.settings.display
        display.remove_missing_overlays(scene)
        refused = _without_refused_options(display, scene)
        self.stage.set_scene(scene, display)
        self.view.fit_scene()
        self.mouse.forget()
        self.physics.begin_anew()
        self.painter.forget()
        if refused:
            self.messages.say(refused)

    def read(self, mesh: Path, landmarks: Path | None = None) -> Task:
        """Read a mesh, in any thread; returns a task that has its landmarks marked.

        The marking begins with those of a file, if there is one. The face waits meanwhile.
        UserError where the mesh or the file cannot be used.
        """
        marking = Marking(mesh, self.files)
        line = None if landmarks is None else marking.open(landmarks)

        def mark() -> Message:
            """Open the marking, in the window's thread."""
            self.leave_marking()
            self.mouse.forget()
            self.session.is_playing = False
            open_files = self.file_drop.open
            leave = self.leave_marking
            self.marking_mode = MarkingMode(marking, self, self.commands, open_files, leave)
            return line

        return mark

    def leave_marking(self) -> None:
        """Go back to the face."""
        if self.marking_mode is not None:
            self.marking_mode = None
            self.mouse.forget()
            self.painter.forget()

    def select_muscle(self, name: str) -> None:
        """Show a muscle's slider in the panel."""
        self.wanted_tab = "Face"
        self.face_panel.select(name)

    def ask_to_close(self) -> str | None:
        """Close the window, unless work would be lost: then ask first."""
        if self.exporter.job is not None and not self.exporter.job.task.is_stopped:
            name = self.exporter.job.target.name
            self.messages.say(f"{name} is being written: wait, or cancel it first", error=True)
            return None
        if self.is_leaving:
            return self._close()
        ask = partial(self.question.before, "Close", self._close)
        return ask() if self.marking_mode is None else self.marking_mode.leave(ask)

    def _close(self) -> str | None:
        self.is_leaving = self.surface.should_close = True
        return None


def _without_refused_options(display: Display, scene: Scene) -> str:
    """Refine by the look alone where a refiner refuses the scene; a line says why, "" for none."""
    try:
        _refine_once(scene, display)
    except UserError as error:
        display.choose_preset(display.look)
        return f"{error}; as at first"
    return ""


def _ready_scene(script: Script, head: FittedHead | None, display: Display) -> Scene:
    """The scene, at rest; the code of its first frames has run once, and is compiled."""
    scene = build_scene(script.scene, head)
    script.check(scene.limits)
    scene.step(1.0 / 60.0)
    scene.reset()
    with contextlib.suppress(UserError):  # which is reported when the window is there
        _refine_once(scene, display)
    return scene


def _refine_once(scene: Scene, display: Display) -> None:
    """Refine a scene as it is; UserError for a refiner that refuses it, or fails."""
    refinement = display.refinement_on(scene)
    refiner = refiner_for(scene, refinement)
    with reported(plug_ins_of(*refinement.on(scene.name))):
        refiner.refine(scene.positions, view=refine.View(scene.framing.focus + 400.0))
