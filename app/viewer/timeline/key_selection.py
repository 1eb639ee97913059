"""The keys that are selected in the timeline, and what menus and keys do with them."""

from __future__ import annotations

from imgui_bundle import imgui

from ...errors import counted
from ...script import Pose, Script, keyframes
from ...script.keyframes import POSES
from ...script.places import NOWHERE, Places
from ..context import ApplicationContext
from ..interface.gui import em
from ..messages import Message
from ..session.session import Session
from ..settings import PanelState

COPY_OFFSET = 10  # frames by which a copy comes later, if it is not wanted elsewhere


class KeySelection:
    """Some keys of a session's script; menus, the keyboard and the timeline share it."""

    def __init__(self, session: Session, panels: PanelState) -> None:
        self._session, self._panels = session, panels
        self.places = NOWHERE
        self.is_touched = False  # the timeline was clicked last, so that its keys are meant
        self.copied: tuple[Script, Places] | None = None  # which can be pasted
        self.pose_to_name: Pose | None = None  # for which the timeline is to ask a name

    @property
    def can_edit(self) -> bool:
        """Whether the script may be changed now."""
        return not self._session.is_recording

    @property
    def can_change(self) -> bool:
        """Whether there are keys that something could be done with."""
        return bool(self.places) and self.can_edit

    def set_key(self, *, is_whole: bool = False) -> Message:
        """The face as it is becomes a key at the time shown; is_whole: of every track."""
        time = self._session.set_key(is_whole=is_whole)
        script = self._session.script
        there = keyframes.places_of(script).near(time, keyframes.SAME)
        self.places = Places({POSES: there.times[POSES]}) if POSES in there.times else there
        return f"Key set at {time:.2f} s"

    def delete(self) -> Message:
        """Take the selected keys away."""
        what = counted(len(self.places), "key")
        self._session.edit(keyframes.without(self._session.script, self.places), f"Delete {what}")
        return f"{what} deleted; [Undo] brings back"

    def delete_if_meant(self) -> Message:
        """Take them away if nothing but the timeline was touched since they were selected."""
        return self.delete() if self.is_touched else "click into the timeline to delete its keys"

    def duplicate(self) -> Message:
        """Copies of the selected keys at the time shown, or a little later if they are there."""
        offset = keyframes.key_time(self._session.script, self._session.time) - self.places.first
        if abs(offset) < 0.5 * keyframes.FRAME:
            offset = COPY_OFFSET * keyframes.FRAME
        return self._copy_from(self._session.script, self.places, offset)

    def copy(self) -> Message:
        """Keep the selected keys, to be pasted elsewhere."""
        self.copied = self._session.script, self.places
        return f"{counted(len(self.places), 'key')} copied; [Paste] pastes at the time shown"

    def paste(self) -> Message:
        """The keys that were copied, from the time shown on; also those of another script."""
        assert self.copied is not None
        time = keyframes.key_time(self._session.script, self._session.time)
        return self._copy_from(*self.copied, time - self.copied[1].first)

    def _copy_from(self, source: Script, places: Places, offset: float) -> Message:
        script, copies = keyframes.copied(self._session.script, places, offset, source)
        what = counted(len(places), "key")
        self._session.edit(script, f"Copy {what}")
        self.places, self.is_touched = copies, True
        return f"{what} copied to {places.first + offset:.2f} s"

    def nudge(self, frames: int) -> None:
        """Move the selected keys by so many frames."""
        first = self.places.first
        offset = keyframes.on_frame(first + frames * keyframes.FRAME) - first
        script, places = keyframes.moved(self._session.script, self.places, offset)
        self._session.edit(script, f"Move {counted(len(places), 'key')}")
        self.places = places

    def select_all(self) -> None:
        """All keys of the script."""
        self.is_touched = True
        self.places = keyframes.places_of(self._session.script)

    def _nameable(self) -> Pose | None:
        """The one pose that is selected, or else the one at the time shown."""
        poses = [] if POSES not in self.places.times else self.places.times[POSES].tolist()
        if len(poses) > 1:
            return None
        time = poses[0] if poses else self._session.time
        return keyframes.pose_at(self._session.script, time)

    @property
    def can_rename(self) -> bool:
        """Whether it is clear which pose would get a name."""
        return self.can_edit and self._nameable() is not None

    def rename(self) -> None:
        """Ask for the name of a pose, in the timeline."""
        self.pose_to_name = self._nameable()
        if self.pose_to_name is not None:
            self._panels.are_hidden = False

    def ease(self, easing: str) -> None:
        """How the selected keys are approached."""
        eased = keyframes.eased(self._session.script, self.places, easing)
        self._session.edit(eased, f"Easing: {easing}")

    def is_eased(self, easing: str) -> bool:
        """Whether all selected keys are approached so."""
        script = self._session.script
        return bool(self.places) and keyframes.eased(script, self.places, easing) == script


class PoseNameLine:
    """A line for a pose's name, which comes up when one is asked for."""

    def __init__(self, app: ApplicationContext, selection: KeySelection) -> None:
        self._gui, self._session, self._messages = app.gui, app.session, app.messages
        self.selection = selection
        self._time, self._name = 0.0, ""  # [s] of the pose, and what is written so far

    def draw(self) -> None:
        """Draw it, if it is open or wanted."""
        pose, self.selection.pose_to_name = self.selection.pose_to_name, None
        if pose is not None:
            self._time, self._name = pose.time, pose.name or ""
            imgui.open_popup("pose name")
        if not imgui.begin_popup("pose name"):
            return
        imgui.text(f"Name of the pose at {self._time:.2f} s")
        if pose is not None:
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(em(14.0))
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, self._name = imgui.input_text_with_hint(
            "##name", "none: no picture on a sheet", self._name, flags
        )
        self._gui.remember("pose name")
        if is_entered:
            script = keyframes.renamed(self._session.script, self._time, self._name)
            self._messages.attempt(lambda: self._session.edit(script, "Name a pose"))
        if is_entered or imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_popup()
