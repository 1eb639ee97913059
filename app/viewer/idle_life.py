"""When the face lives by itself in the window: while nobody moves it, and somebody may look.

It adds to controls that are 0, and to no other; what it adds is seen, and nothing else: no slider
moves, nothing is recorded, saved or undone. That it begins and ends softly is left to the muscles.
"""

from __future__ import annotations

from ..motion.idle import Idle
from ..motion.life import Values
from ..scenes import FaceScene
from .session import Session
from .settings import Settings
from .view import View

ASLEEP_AFTER = 600.0  # [s] without input: whoever looked has gone, and the machine may rest


class IdleLife:
    """The life of the face in a window."""

    def __init__(self, session: Session, settings: Settings, view: View) -> None:
        self._session, self._settings, self._view = session, settings, view
        self._idle = Idle(session.scene)
        self._time = 0.0  # of its life [s]
        self._without_input = 0.0  # [s]

    def note_input(self) -> None:
        """Somebody is there."""
        self._without_input = 0.0

    @property
    def is_on(self) -> bool:
        """Whether the face lives now.

        A script that is played, recorded or looked through moves it alone, until it has ended, and
        so does a live face, until it is lost.
        """
        session = self._session
        if not self._settings.is_alive or not isinstance(session.scene, FaceScene):
            return False
        is_in_script = session.is_following and session.time < session.script.duration
        is_moved = session.is_playing or session.is_recording or is_in_script
        return not (is_moved or session.live.is_on) and self._without_input < ASLEEP_AFTER

    def after(self, seconds: float, *, is_held: bool) -> Values:
        """What to add to the controls, `seconds` later than the last time.

        is_held: the user has hold of something, so that the face does no more than look at him.
        """
        if not self.is_on:
            return {}
        if self._idle.scene is not self._session.scene:
            self._idle = Idle(self._session.scene)
        self._time += seconds
        self._without_input += seconds
        viewer, session = self._view.camera.eye, self._session
        moved = session.controls.moved_by(session.values)
        return self._idle.beneath(moved, viewer, self._time, is_still=is_held)
