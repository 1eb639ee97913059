"""What can be exported: films, pictures, and motion for other programs, each by a short name."""

from __future__ import annotations

from typing import NamedTuple

from ..capture.formats import FORMATS as FILMS
from ..export.formats import FORMATS as MOTION

FRAMES, SHEET = "frames", "sheet"  # pictures in a folder, and a contact sheet
SOURCES = {"script": "The whole script", "part": "A part of it", "pose": "The face as it is"}


class Kind(NamedTuple):
    """One kind of file. suffix: of its name, "" for a folder. fastest: [frames/s]."""

    title: str
    suffix: str
    is_drawn: bool = True  # else it is motion
    can_be_transparent: bool = False
    fastest: float = 240.0


KINDS = {
    end[1:]: Kind(f"Film ({end})", end, True, bool(each.transparent), each.fastest)
    for end, each in FILMS.items()
}
KINDS[FRAMES] = Kind("Pictures in a folder (.png)", "", True, True)
KINDS[SHEET] = Kind("Contact sheet of named poses (.png)", ".png")
for _each in MOTION:
    _end = (*_each.suffixes, "")[0]
    KINDS[_each.name] = Kind(f"Motion: {_each.title} ({_end or 'folder'})", _end, is_drawn=False)
