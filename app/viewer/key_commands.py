"""What menus and keys do with the keys of the script: those that are selected in the timeline."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..script import Pose
from . import keys
from .keys import POSES, KeyPlace

if TYPE_CHECKING:
    from .window import Viewer

COPY_OFFSET = 10  # frames by which a copy comes later, if it is not wanted elsewhere


def _selected(viewer: Viewer) -> frozenset[KeyPlace]:
    return viewer.timeline.sheet.selected


def has_selected(viewer: Viewer) -> bool:
    """Whether there are keys that something could be done with."""
    return bool(_selected(viewer)) and not viewer.session.is_recording


def can_edit(viewer: Viewer) -> bool:
    """Whether the script may be changed now."""
    return not viewer.session.is_recording


def set_key(viewer: Viewer) -> None:
    """The face as it is becomes a key at the time shown."""
    session = viewer.session
    time = session.set_key()
    there = [place for place in keys.places_of(session.script) if abs(place.time - time) < 1e-9]
    poses = frozenset(place for place in there if place.lane == POSES)
    viewer.timeline.sheet.selected = poses or frozenset(there)
    viewer.messages.say(f"key set at {time:.2f} s")


def delete(viewer: Viewer) -> None:
    """Take the selected keys away."""
    session, places = viewer.session, _selected(viewer)
    session.edit(keys.without(session.script, places))
    viewer.messages.say(f"{counted(len(places))} deleted; Ctrl+Z brings back")


def duplicate(viewer: Viewer) -> None:
    """Copies of the selected keys at the time shown, or a little later if they are there."""
    session, places = viewer.session, _selected(viewer)
    first = min(place.time for place in places)
    offset = keys.key_time(session.script, session.time) - first
    if abs(offset) < 0.5 * keys.FRAME:
        offset = COPY_OFFSET * keys.FRAME
    script, copies = keys.copied(session.script, places, offset)
    session.edit(script)
    viewer.timeline.sheet.selected = copies
    viewer.messages.say(f"{counted(len(copies))} copied to {first + offset:.2f} s")


def nudge(viewer: Viewer, frames: int) -> None:
    """Move the selected keys by so many frames."""
    session = viewer.session
    first = min(place.time for place in _selected(viewer))
    offset = keys.on_frame(first + frames * keys.FRAME) - first
    script, places = keys.moved(session.script, _selected(viewer), offset)
    session.edit(script)
    viewer.timeline.sheet.selected = places


def select_all(viewer: Viewer) -> None:
    """All keys of the script."""
    viewer.timeline.sheet.selected = keys.places_of(viewer.session.script)


def pose_to_name(viewer: Viewer) -> Pose | None:
    """The one pose that is selected, or else the one at the time shown."""
    script = viewer.session.script
    poses = [place.time for place in _selected(viewer) if place.lane == POSES]
    if len(poses) == 1:
        return keys.pose_at(script, poses[0])
    return None if poses else keys.pose_at(script, viewer.session.time)


def can_rename(viewer: Viewer) -> bool:
    """Whether it is clear which pose would get a name."""
    return can_edit(viewer) and pose_to_name(viewer) is not None


def rename(viewer: Viewer) -> None:
    """Ask for the name of a pose, in the timeline."""
    pose = pose_to_name(viewer)
    if pose is not None:
        viewer.is_bare = False
        viewer.timeline.sheet.ask_name(pose)


def ease(viewer: Viewer, easing: str) -> None:
    """How the selected keys are approached."""
    session = viewer.session
    session.edit(keys.eased(session.script, _selected(viewer), easing))


def is_eased(viewer: Viewer, easing: str) -> bool:
    """Whether all selected keys are approached so."""
    script, places = viewer.session.script, _selected(viewer)
    return bool(places) and keys.eased(script, places, easing) == script


def show_whole(viewer: Viewer) -> None:
    """The whole script in the timeline."""
    viewer.timeline.sheet.view.is_whole = True


def counted(number: int) -> str:
    """So many keys, in words."""
    return "1 key" if number == 1 else f"{number} keys"
