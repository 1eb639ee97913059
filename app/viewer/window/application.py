"""What the window is made of: the one place where all parts of the viewer meet."""

from __future__ import annotations

import contextlib
import logging
from functools import partial
from pathlib import Path

from risorius import refine
from risorius.assets.fitting import FittedHead

from ...controls.vocabulary import readable
from ...errors import UserError
from ...refining.refiners import refiner_for
from ...scenes import BUILT_IN, Scene, build_scene
from ...script import Script
from ..context import ApplicationContext
from ..documents.export_dialog import ExportDialog
from ..documents.file_dialogs import FileChooser
from ..documents.file_drop import FileDrop
from ..interface.commands import Command, MenuBar
from ..marking import Marking, Room
from ..messages import Message
from ..panels.face import FacePanel, MuscleNote
from ..panels.help import FirstSteps, Help
from ..panels.layout import Layout
from ..panels.live import LivePanel
from ..panels.mechanism import MechanismPanel
from ..panels.pose_grid import PoseGrid
from ..picture.mouse import Mouse
from ..picture.painter import Painter
from ..picture.skin_drag import SkinDrag
from ..session.physics import IdleLife, Physics
from ..session.recovery import Recovery
from ..session.session import Session
from ..session.soundtrack import Soundtrack
from ..settings import (
    Display,
    Settings,
    load_settings,
    remove_refused_options,
    rename_unusable,
    save_settings,
)
from ..timeline.dope_sheet import DopeSheet
from ..timeline.key_selection import KeySelection
from ..timeline.time_axis import TimeAxis
from ..timeline.timeline import Timeline
from ..timeline.waveform import Waveform
from . import menus
from .placement import Placement
from .splash_screen import SplashScreen

LOG = logging.getLogger("risorius.viewer")  # what is told where there is no window any more


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

        head: a user's own, None for the built-in one. size, display: None takes what is remembered.
        splash: the window, where it is open already.
        settings_path: where that is kept, and beside it what is not saved; None for nowhere.
        Raises UserError for a script that names what the scene has not.
        """
        self._settings_path = settings_path
        settings, complaint = Settings(), ""
        if settings_path is not None:
            settings, complaint = load_settings(settings_path)
        is_own = script.scene != "face" or head is not None
        splash = splash or SplashScreen(size, settings_path, is_own=is_own)
        shown = display or settings.display
        scene = splash.during(partial(_ready_scene, script, head, shown))
        if display is None:
            refused = remove_refused_options(settings.display, scene)
            if refused and settings_path is not None and not complaint:
                refused = f"{settings_path}: {refused}; {rename_unusable(settings_path)}"
            complaint = "; ".join(filter(None, (complaint, refused)))
        else:
            settings.display = display
        settings.display.remove_missing_overlays(scene)
        with contextlib.ExitStack() as stack:  # whatever fails here closes the window again
            stack.push(splash)
            super().__init__(Session(scene, script), settings, splash.surface)
            stack.push(self.opened)
            self._resources = stack.pop_all()
        self.recovery = Recovery(settings_path and settings_path.parent / "unsaved")
        self.recovery.find(self.session)
        self.soundtrack = Soundtrack(self.session)
        self._join_commands()
        self._join_panels()
        self.is_leaving = False
        if complaint:
            self.messages.say(complaint, error=True)

    def _join_commands(self) -> None:
        """What can be done, each with what it needs for that."""
        session, settings = self.session, self.settings
        self.placement, self.time_axis = Placement(self.surface.handle), TimeAxis()
        self.selection = KeySelection(session, self.panel_state)
        self.room: Room | None = None  # a mesh whose landmarks are being marked
        self.file_drop = FileDrop(self.files, self.scripts, self.show_scene, self.mark)
        self.file_drop.has_other_head = session.scene.called not in ("", BUILT_IN)
        self.commands: tuple[Command, ...] = (
            *menus.file_menu(
                self.scripts, self.file_drop, self.exporter, settings, self.ask_to_close
            ),
            *menus.edit_menu(session),
            *menus.time_menu(session, self.scripts, self.time_axis),
            *menus.keys_menu(session, self.selection),
            *menus.view_menu(settings, self.view, self.placement, self.panel_state),
            *menus.expression_menu(session),
            *menus.live_menu(self.live),
            *menus.help_menu(self.panel_state, lambda: self.first_steps.begin()),
        )
        self.gui.keys = {each.label: each.displayed_keys for each in self.commands}
        self.life = IdleLife(session, lambda: settings.is_alive, lambda: self.view.camera.eye)
        self.physics = Physics(session, self.times)
        self.painter = Painter(self.stage, self.view, self.messages)

    def _join_panels(self) -> None:
        """What is around the picture, and the mouse in it."""
        session, settings, path = self.session, self.settings, self._settings_path
        bar = MenuBar(self.gui, self.messages, self.commands, lambda: session.unsaved)
        waveform = Waveform(self.gui, self.soundtrack, self.time_axis)
        dope_sheet = DopeSheet(self, self.selection, self.time_axis, bar, waveform)
        self.timeline = Timeline(self, self.commands, dope_sheet)
        self.poses = PoseGrid(self, path and path.parent / "poses")
        self.face_panel = FacePanel(self, self.poses)
        mechanism = MechanismPanel(self, self.file_drop)
        record = next(each for each in self.commands if each.label == "Record")
        live = LivePanel(self, record)
        first = "Face" if session.scene.name == "face" else f"{readable(session.scene.name)}###Face"
        tabs = {first: self.face_panel.draw, "Mechanism": mechanism.draw, "Live": live.draw}
        self.layout = Layout(self, bar, tabs, self.timeline)
        self.chooser = FileChooser(self.gui, self.files)
        self.help = Help(self)
        self.export_dialog = ExportDialog(self.gui, self.exporter, self.files, self.view)
        self.muscle_note = MuscleNote(self)
        grab = partial(SkinDrag, session, settings)
        self.mouse = Mouse(self.view, self.stage, self.messages, grab, self.select_muscle)
        self.first_steps = FirstSteps(self, lambda: (*self.mouse.gestures, session.is_playing))
        if self._settings_path is not None and session.scene.name == "face":
            if not settings.knows_first_steps:
                self.first_steps.begin()
            settings.knows_first_steps = True

    def close(self) -> None:
        """Remember the settings, and let go of everything."""
        try:
            self.remember()
        except UserError as error:  # a disk that is full must not keep the window open
            LOG.warning("risorius: %s; the next window does not look as this one", error)
        self.live.stop()
        self.exporter.close()
        self.leave_marking()
        self.soundtrack.close()
        self.recovery.close()
        self.poses.close()
        self._resources.close()

    def remember(self) -> None:
        """Write the settings as they are now; UserError where that cannot be."""
        if self._settings_path is not None:
            self.settings.cameras[self.session.scene.name] = self.view.camera_place
            self.settings.size = self.placement.size
            save_settings(self._settings_path, self.settings)

    # What is done to the window as a whole

    def show_scene(self, scene: Scene) -> None:
        """Take another scene with the same controls in place of this one."""
        self.session.move_to(scene)
        self.leave_marking()
        display = self.settings.display
        display.remove_missing_overlays(scene)
        refused = remove_refused_options(display, scene)
        self.stage.set_scene(scene, display)
        self.view.fit_scene()
        self.mouse.forget()
        self.physics.begin_anew()
        self.painter.forget()
        if refused:
            self.messages.say(refused)

    def mark(self, mesh: Path, landmarks: Path | None = None) -> Message:
        """Mark the landmarks of a mesh, or go on with those of a file; the face waits meanwhile.

        UserError where that cannot be.
        """
        marking = Marking(mesh, self.files)
        line = None if landmarks is None else marking.open(landmarks)
        self.leave_marking()
        self.mouse.forget()
        self.session.is_playing = False
        self.room = Room(marking, self, self.commands, self.file_drop.open, self.leave_marking)
        return line

    def leave_marking(self) -> None:
        """Back to the face."""
        if self.room is not None:
            self.room = None
            self.mouse.forget()
            self.painter.forget()

    def select_muscle(self, name: str) -> None:
        """Show a muscle's slider, in the panel and beside the mouse."""
        self.panel_state.wanted_tab = "Face"
        self.face_panel.select(name)
        self.muscle_note.name = name

    def ask_to_close(self) -> str | None:
        """Close the window, unless work would be lost: then ask first."""
        if self.exporter.job is not None and not self.exporter.job.task.is_stopped:
            name = self.exporter.job.target.name
            self.messages.say(f"{name} is being written: wait, or cancel it first", error=True)
            return None
        if self.is_leaving:
            return self._close()
        ask = partial(self.question.before, "Close", self._close)
        return ask() if self.room is None else self.room.leave(ask)

    def _close(self) -> str | None:
        self.is_leaving = self.surface.should_close = True
        return None


def _ready_scene(script: Script, head: FittedHead | None, display: Display) -> Scene:
    """The scene, at rest; what its first frames run was run once, and is compiled."""
    scene = build_scene(script.scene, head)
    script.check(scene.limits)
    scene.step(1.0 / 60.0)
    scene.reset()
    with contextlib.suppress(UserError, TypeError):  # a stage tells what it refuses
        refiner = refiner_for(scene, display.refinement_on(scene))
        refiner.refine(scene.positions, view=refine.View(scene.focus + 400.0))
    return scene
