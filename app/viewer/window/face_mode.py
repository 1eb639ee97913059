"""The face in the window: its physics, life and sound; the menus, panels and mouse around it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from imgui_bundle import imgui

from ...control_names import readable
from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..interface.commands import Command, MenuBar
from ..messages import Message, Task
from ..panels.face import FacePanel
from ..panels.layout import PanelLayout
from ..panels.live import LivePanel
from ..panels.mechanism import MechanismPanel
from ..panels.scene import ScenePanel
from ..picture.mouse import Mouse
from ..picture.skin import SkinDrag
from ..picture.stage import Painter
from ..session.physics import IdleLife, Physics
from ..session.soundtrack import Soundtrack
from ..timeline.dope_sheet import DopeSheet
from ..timeline.key_marks import Waveform
from ..timeline.keys import KeySelection
from ..timeline.time_axis import TimeAxis
from ..timeline.timeline import Timeline
from . import menus


class FaceMode:
    """The face of the session, moved by physics; see `Mode`."""

    draws_over_picture = False  # no marks lie over the face

    def __init__(self, context: ApplicationContext, file_drop: FileDrop, close: Task) -> None:
        """close: the command that closes the window."""
        self._context = context
        self._file_drop = file_drop
        session = context.session
        settings = context.settings
        self.view = context.view
        self.soundtrack = Soundtrack(session)
        self.time_axis = TimeAxis()
        self.selection = KeySelection(session)
        self.exports = menus.export_menu(context.exporter, context.files)
        self.commands = self._commands(close)
        self.life = IdleLife(session, lambda: settings.is_alive, lambda: self.view.camera.eye)
        self.physics = Physics(session, context.times)
        self.painter = Painter(context.stage, self.view, context.messages)
        self._join_panels()
        grab = partial(SkinDrag, session, settings)
        self.mouse = Mouse(self.view, context.stage, context.messages, grab, self.select_muscle)

    def _commands(self, close: Task) -> tuple[Command, ...]:
        """Return all commands of this mode."""
        context = self._context
        session = context.session
        settings = context.settings
        scripts = context.scripts
        exporter = context.exporter
        return (
            *menus.file_menu(scripts, self._file_drop, exporter, self.exports, settings, close),
            *menus.edit_menu(session),
            *menus.time_menu(session, scripts, self.time_axis),
            *menus.keys_menu(session, self.selection),
            *menus.view_menu(settings, self.view, session, context.surface),
            *menus.expression_keys(session),
            *menus.live_menu(context.live, session),
            *menus.help_menu(context.manual, lambda: self.commands),
        )

    def _join_panels(self) -> None:
        """Make the panels around the picture."""
        context = self._context
        scene = context.session.scene
        commands = self.commands
        menu_bar = MenuBar(context.gui, context.messages, commands, lambda: self.unsaved)
        waveform = Waveform(context.gui, self.soundtrack, self.time_axis)
        dope_sheet = DopeSheet(context, self.selection, self.time_axis, menu_bar, waveform)
        self.timeline = Timeline(context, commands, dope_sheet)
        self.face_panel = FacePanel(context, self.selection, self.exports)
        mechanism = MechanismPanel(context)
        scene_panel = ScenePanel(context, self._file_drop)
        live = LivePanel(context, {each.label: each for each in commands})
        first = "Face" if scene.name == "face" else f"{readable(scene.name)}###Face"
        tabs = {
            first: self.face_panel.draw,
            "Mechanism": mechanism.draw,
            "Scene": scene_panel.draw,
        }
        if scene.face is not None:  # a plane has no live face
            tabs["Live"] = live.draw
        self.layout = PanelLayout(context, menu_bar, tabs, self.timeline)

    @property
    def name(self) -> str:
        """The name of the script."""
        return self._context.session.work.name

    @property
    def unsaved(self) -> str:
        """The unsaved work in words; "" for none."""
        return self._context.session.work.unsaved

    @property
    def is_at_rest(self) -> bool:
        """Whether everything is at rest, and stays at rest without an event."""
        return (
            self.physics.is_at_rest
            and not self.life.is_on
            and not self._context.session.is_recording
            and not self._context.live.is_busy
            and not self.soundtrack.is_heard
        )

    @property
    def is_idling(self) -> bool:
        """Whether nobody has moved the face for some time, and it only has idle life."""
        return self.physics.is_idling

    @property
    def has_news(self) -> bool:
        """Whether the state of a live face has changed."""
        return self._context.live.has_changed

    def paint(self, elapsed: float) -> bool:
        """Let time pass for the face, and draw it; return whether the picture has changed."""
        messages = self._context.messages
        live = self._context.live
        physics = self.physics
        self._context.times.next_frame(elapsed)
        messages.attempt(self.soundtrack.refresh)
        seconds = self.soundtrack.elapsed(elapsed)
        is_skin_dragged = self.mouse.is_dragging_skin
        messages.attempt(partial(live.advance, elapsed))
        is_held = is_skin_dragged or imgui.is_any_item_active()
        life = partial(self.life.after, is_held=is_held) if self.life.is_on else None
        advance = partial(physics.advance, seconds, is_skin_dragged=is_skin_dragged)
        messages.attempt(partial(advance, is_urgent=live.is_urgent, life=life))
        return self.painter.paint(elapsed, has_moved=physics.has_moved, is_alive=physics.is_idling)

    def draw_panels(self) -> None:
        """Draw the panels, and give the picture its place."""
        self.layout.draw(self.view)

    def rest(self) -> None:
        """Stop the sound while the window sleeps."""
        self.soundtrack.rest()

    def drop(self, paths: Sequence[str]) -> Message:
        """Open files that were dropped onto the window."""
        return self._file_drop.open(paths)

    def leave(self, then: Task) -> Message:
        """Run `then`; the session keeps the script, and the closing window asks about it."""
        return then()

    # The window pauses the face during a marking

    def set_aside(self) -> None:
        """Pause the script and its sound while a mesh is marked in the window."""
        self.mouse.forget()
        self._context.session.is_playing = False
        self.soundtrack.rest()

    def resume(self) -> None:
        """Mark the picture as out of date, because the window showed a mesh."""
        self.mouse.forget()
        self.painter.forget()

    def begin_anew(self) -> None:
        """Begin with another scene; the camera shows all of it."""
        self.view.fit_scene()
        self.physics.begin_anew()
        self.resume()

    def select_muscle(self, name: str) -> None:
        """Show a muscle's slider in the panel."""
        self._context.wanted_tab = "Face"
        self.face_panel.select(name)
