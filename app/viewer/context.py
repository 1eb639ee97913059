"""The objects that all parts of an open window share, in one `ApplicationContext`."""

from __future__ import annotations

import contextlib
from functools import partial

from risorius import render

from .documents.export import Exporter
from .documents.file_dialogs import FileDialogs
from .documents.manual import Manual
from .documents.scripts import Question, ScriptCommands
from .interface.gui import Gui, wake_up
from .messages import Messages
from .picture.portraits import Portraits
from .picture.stage import SceneView, Stage
from .session.live_commands import LiveCommands
from .session.physics import FrameTimes
from .session.session import Session
from .settings import Settings


class ApplicationContext:
    """The session and its picture, the messages and dialogs, and the commands for files."""

    def __init__(self, session: Session, settings: Settings, surface: render.WindowSurface) -> None:
        """surface: the surface of the open window, which is still empty."""
        self.session = session
        self.settings = settings
        self.surface = surface
        self.times = FrameTimes()
        self.messages = Messages()
        self.files = FileDialogs()
        with contextlib.ExitStack() as stack:
            self.gui = Gui(surface.handle)
            stack.callback(self.gui.close)
            self.manual = Manual(self.gui)
            stack.callback(self.manual.close)
            self.stage = Stage(surface, session.scene, settings.display, self.times)
            self.portraits = Portraits(surface.gl, wake_up)
            stack.callback(self.portraits.close)
            self.close = stack.pop_all().close  # called when the window closes
        self.view = SceneView(session, settings, surface)
        self.wanted_tab = ""  # title of the panel to bring to the front
        self.question = Question(session)
        self.scripts = ScriptCommands(session, self.files, self.question, settings.note_recent)
        self.exporter = Exporter(session, settings, self.stage, self.view)
        show_live = partial(setattr, self, "wanted_tab", "Live")
        self.live = LiveCommands(session, show_live, wake_up)
