"""The keys of a script in rows, one per track, and the selected keys."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from ...control_names import plain_name
from ...errors import UserError
from ...script import Channel, Script, keyframes
from ...script.key_sets import NO_KEYS, KeySet
from ...script.keyframes import POSE_TRACK, all_keys
from ...text import counted
from ..messages import Message
from ..session.session import Session


@dataclass(frozen=True)
class Track:
    """One row: the keys of the poses, of several tracks, or of one control."""

    name: str  # unique among all rows
    label: str
    keys: KeySet
    channel: Channel = field(default_factory=partial(Channel, (), ()))  # keys of one control
    control: str = ""  # the name of that control
    track: str = ""  # the name of the track that has its keys
    parents: tuple[str, ...] = ()  # the names of the rows into which it is folded
    names: tuple[tuple[float, str], ...] = ()  # names of poses, by time [s]
    is_whole: bool = False  # whether its keys are whole poses
    is_sum: bool = False  # whether it sums the rows below it, which may be folded
    number: int = 0  # number of the row among all rows

    @property
    def height(self) -> float:
        """The height relative to an ordinary row; the row of poses has room for names."""
        return 1.75 if self.is_whole else 1.0


def all_tracks(script: Script, groups: Mapping[str, Sequence[str]]) -> tuple[Track, ...]:
    """Return rows for the poses and their controls, then for the tracks by groups of controls."""
    rows = list[Track]()
    times = all_keys(script).times
    if script.poses or not script.tracks:
        names = tuple((pose.time, pose.name) for pose in script.poses if pose.name)
        poses = KeySet({POSE_TRACK: times.pop(POSE_TRACK, np.empty(0))})
        whole_poses_row = "Whole poses"  # name of a row
        whole = Track(whole_poses_row, "Poses", poses, names=names, is_whole=True)
        rows.append(replace(whole, is_sum=bool(script.posed_names)))
        for name in script.posed_names:
            channel = script.posed_channel(name)
            above = (whole_poses_row,)
            row = Track(f"pose {name}", plain_name(name), poses, channel, name, POSE_TRACK, above)
            rows.append(row)
    tracks_row = "Tracks"  # name of a row
    if script.tracks:
        rows.append(Track(tracks_row, tracks_row, KeySet(times), is_sum=True))
    for title, controls in groups.items():
        inside = {name: times[name] for name in controls if name in script.tracks}
        parents: tuple[str, ...] = (tracks_row,)
        if 0 < len(inside) < len(script.tracks):
            name = f"{tracks_row}: {title}"
            group = Track(name, title, KeySet(inside), parents=parents, is_sum=True)
            rows.append(group)
            parents = tracks_row, group.name
        for name in inside:
            alone = KeySet({name: times[name]})
            channel = script.tracks[name]
            sign = "+ " if name in script.posed_names else ""  # the track adds to the poses
            label = f"{sign}{plain_name(name)}"
            rows.append(Track(f"track {name}", label, alone, channel, name, name, parents))
    return tuple(replace(row, number=number) for number, row in enumerate(rows))


def movers_of(script: Script, name: str) -> str:
    """Name the parts of a script that move a control; "" for none."""
    parts = {"the poses": name in script.posed_names, "a track": name in script.tracks}
    return " and ".join(part for part, is_there in parts.items() if is_there)


def listed(names: Collection[str]) -> str:
    """Return the name of one control in words, or the number of several controls."""
    return plain_name(min(names)) if len(names) == 1 else counted(len(names), "control")


class KeySelection:
    """The selected keys of a session's script; menus, keyboard and timeline share them."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.keys = NO_KEYS
        self.copied: tuple[Script, KeySet] | None = None  # keys to paste

    @property
    def can_edit(self) -> bool:
        """Whether the script may be changed now."""
        return not self._session.is_recording

    @property
    def can_change(self) -> bool:
        """Whether there are keys to change."""
        return bool(self.keys) and self.can_edit

    def set_key(self) -> Message:
        """Set keys at the current time for the controls that were moved since the last key."""
        return self.key_controls(self._session.touched)

    def key_controls(self, names: Collection[str]) -> Message:
        """Set keys for these controls, and no others, at the current time."""
        if not names:
            raise UserError(
                "no control was moved since the last key; [Key whole pose] sets keys for all"
            )
        time = self._session.set_key(names)
        there = (
            keyframes.all_keys(self._session.script).nearest(time, keyframes.EQUAL_TOLERANCE).times
        )
        tracks = {name: times for name, times in there.items() if name in names}
        is_posed = len(tracks) < len(names)
        poses = {POSE_TRACK: there[POSE_TRACK]} if is_posed and POSE_TRACK in there else {}
        self.keys = KeySet(poses | tracks)
        controls = listed(names)
        return f"{controls} keyed at {time:.2f} s"

    def key_whole_pose(self) -> Message:
        """Set keys for all controls, with the current face, at the current time."""
        time = self._session.set_key()
        script = self._session.script
        there = keyframes.all_keys(script).nearest(time, keyframes.EQUAL_TOLERANCE)
        self.keys = (
            KeySet({POSE_TRACK: there.times[POSE_TRACK]}) if POSE_TRACK in there.times else there
        )
        return f"Whole pose keyed at {time:.2f} s"

    def keys_of(self, names: Iterable[str]) -> KeySet:
        """Return the keys at the current time in the tracks of these controls."""
        session = self._session
        reach = 0.5 * keyframes.FRAME_TIME
        there = keyframes.all_keys(session.script).nearest(session.time, reach).times
        return KeySet({name: there[name] for name in names if name in there})

    def delete_keys_of(self, names: Collection[str]) -> Message:
        """Delete the keys at the current time in the tracks of these controls."""
        session = self._session
        session.edit(keyframes.without_keys(session.script, self.keys_of(names)))
        return f"{listed(names)}: key deleted; [Undo] reverts this"

    def clear_tracks_of(self, names: Collection[str]) -> Message:
        """Delete all keys in the tracks of these controls."""
        session = self._session
        tracks = session.script.tracks
        deleted = KeySet({name: tracks[name].times for name in names if name in tracks})
        session.edit(keyframes.without_keys(session.script, deleted))
        return f"{listed(names)}: track cleared; [Undo] reverts this"

    def delete(self) -> Message:
        """Delete the selected keys."""
        keys = counted(len(self.keys), "key")
        self._session.edit(keyframes.without_keys(self._session.script, self.keys))
        return f"{keys} deleted; [Undo] reverts this"

    def copy(self) -> Message:
        """Copy the selected keys for pasting."""
        self.copied = self._session.script, self.keys
        return f"{counted(len(self.keys), 'key')} copied; [Paste] pastes at the time shown"

    def paste(self) -> Message:
        """Paste the copied keys at the current time, even into another script."""
        assert self.copied is not None
        source, copied = self.copied
        offset = keyframes.key_time(self._session.script, self._session.time) - copied.first
        script, self.keys = keyframes.moved(self._session.script, copied, offset, source)
        keys = counted(len(copied), "key")
        self._session.edit(script)
        return f"{keys} copied to {copied.first + offset:.2f} s"

    def nudge(self, frames: int) -> None:
        """Move the selected keys by this many frames."""
        first = self.keys.first
        offset = keyframes.on_frame(first + frames * keyframes.FRAME_TIME) - first
        script, moved_keys = keyframes.moved(self._session.script, self.keys, offset)
        self._session.edit(script)
        self.keys = moved_keys

    def select_all(self) -> None:
        """Select all keys of the script."""
        self.keys = keyframes.all_keys(self._session.script)

    def ease(self, easing: str) -> None:
        """Set the easing toward the selected keys."""
        self._session.edit(keyframes.eased(self._session.script, self.keys, easing))

    def is_eased(self, easing: str) -> bool:
        """Whether all selected keys have this easing."""
        script = self._session.script
        return bool(self.keys) and keyframes.eased(script, self.keys, easing) == script
