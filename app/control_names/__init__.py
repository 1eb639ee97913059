"""Names of controls: the names of mirrored controls, and names in plain words.

Mirroring exchanges left and right, and changes the sign of turns; it applies to controls and to
recorded channels. The plain words, and synonyms for a search, are in `words.toml` of assets.
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Mapping
from functools import cache
from typing import Any

from risorius.assets.loading import read_words

SIDE_ENDINGS = (("_left", "_right"), ("Left", "Right"))  # ends of names: ours, ARKit's
SIGNED_CONTROLS = (  # positive values turn to one side, negative values to the other
    "jaw_sideways", "gaze_horizontal", "gaze_horizontal_left", "gaze_horizontal_right",
    "eye_yaw_left", "eye_yaw_right", "head_yaw", "head_roll",
)  # fmt: skip
# Their sides are directions of one motion, so equal values cancel.
ONE_MOTION_BASES = ("AU30", "lips_sideways", "jaw", "mouth")
CACHE_SIZE = 4096  # cached names; panels need the parts of all their names in each frame
MIRROR_NAMES = {  # mirrored controls whose names show no side: eyes turn left, right ...
    "AU61": "AU62", "AU62": "AU61", "AU51": "AU52", "AU52": "AU51", "AU55": "AU56", "AU56": "AU55",
    "wink": "wink_right", "wink_right": "wink", "contempt": "contempt_right",
    "contempt_right": "contempt",
}  # fmt: skip


@functools.lru_cache(maxsize=CACHE_SIZE)
def split_side(name: str) -> tuple[str, str]:
    """Split a name into its base and its side as spelled; the side is "" for the middle."""
    for side in (side for pair in SIDE_ENDINGS for side in pair):
        if name.endswith(side):
            return name.removesuffix(side), side
    return name, ""


@functools.lru_cache(maxsize=CACHE_SIZE)
def twin_of(name: str) -> str:
    """Return the name of the mirrored control; a control in the middle mirrors itself."""
    if name in MIRROR_NAMES:
        return MIRROR_NAMES[name]
    base, side = split_side(name)
    for left, right in SIDE_ENDINGS:
        if side in (left, right):
            return base + (right if side == left else left)
    return name


def mirrored(values: Mapping[str, float]) -> dict[str, float]:
    """Return values with left and right exchanged; turns and sideways values change sign."""
    result = dict(values)
    for name, value in values.items():
        if twin_of(name) in values:
            result[twin_of(name)] = -value if name in SIGNED_CONTROLS else value
    return result


def copied(values: Mapping[str, float], source: str) -> dict[str, float]:
    """Copy the values of one side ("left" or "right") to the other; middle and gaze stay."""
    result = dict(values)
    sideways = ("gaze_horizontal", "eye_yaw", "eyeLookIn", "eyeLookOut")
    for name, value in values.items():
        base, side = split_side(name)
        twin = twin_of(name)
        is_direction = not side and split_side(twin)[0] != name  # such as AU61 and AU62
        if (
            is_direction
            or base in ONE_MOTION_BASES
            or base.startswith(sideways)
            or twin not in values
        ):
            continue
        if (side.strip("_").lower() or "left") == source:
            result[twin] = value
    return result


def readable(name: str) -> str:
    """Return a name as words with a capital letter; codes such as jawOpen do not change."""
    is_word = name.partition("_")[0].partition(" ")[0].islower()
    return (name[:1].upper() + name[1:] if is_word else name).replace("_", " ")


def sentence(text: str) -> str:
    """Capitalize a text, unless it begins with a code or a file name, such as "a.b: opened"."""
    name, colon, _ = text.partition(":")
    is_plain = text.partition(" ")[0].islower() and not (colon and "." in name)
    return text[:1].upper() + text[1:] if is_plain else text


def plain_name(name: str, *twin: str) -> str:
    """Return a control's plain name with its side, or with "both sides" if its twin is given."""
    plain = title_of(name)[1] or readable(split_side(name)[0])
    side = "both sides" if twin else split_side(name)[1].strip("_")
    return f"{plain}, {side}" if side else plain


@cache
def _table(kind: str) -> Mapping[str, Any]:
    found: Mapping[str, Any] = read_words().get(kind, {})
    return found


@cache
def _synonyms() -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple(
        (word, tuple(found))
        for words, found in _table("synonyms").items()
        for word in words.split()
    )


def title_of(name: str, action: str = "") -> tuple[str, str]:
    """Return the code and the plain name of a control; each is "" if there is none.

    name: without its side, if both sides share a name. action: effect of the control, in words.
    """
    stem = split_side(name)[0]
    plain = str(_table("names").get(name) or _table("names").get(stem) or "")
    first = action.partition(":")[0]
    if name.startswith("AU"):
        return stem, plain or first[:1].upper() + first[1:]
    if plain:
        return "", plain
    viseme_prefix = "viseme_"
    if name.startswith(viseme_prefix):
        return name.removeprefix(viseme_prefix), first
    if name != name.lower():  # as ARKit spells it
        return name, ""
    return "", readable(stem).capitalize()


def words_of_group(title: str) -> str:
    """Return more words by which a search finds a group of controls; "" for none."""
    return str(_table("groups").get(title, ""))


def is_found(words: str, text: str, names: Collection[str]) -> bool:
    """Whether each word is in the text, or begins a synonym of one of the names.

    words: as typed into a search. names: names of controls with their sides.
    """
    stems = {*names, *(split_side(name)[0] for name in names)}
    synonyms = [synonym for synonym, meant in _synonyms() if not stems.isdisjoint(meant)]
    searched = text.lower()

    def is_there(form: str) -> bool:
        """Whether a form of a word is in the text, or begins a synonym."""
        return form in searched or any(synonym.startswith(form) for synonym in synonyms)

    return all(any(map(is_there, _forms(word))) for word in words.lower().split())


def meant_by(word: str, names: Collection[str]) -> list[str]:
    """Return the names of which an everyday word is a synonym, the best match first."""
    forms = _forms(word.lower())
    meant = [name for other, found in _synonyms() if other in forms for name in found]
    return [name for name in dict.fromkeys(meant) if name in names]


def _forms(word: str) -> list[str]:
    """Return a word as typed, and its forms without an ending: chewing, chew."""
    word_endings = ("ing", "ed", "s")  # endings of a searched word
    stems = [word.removesuffix(end) for end in word_endings if word.endswith(end)]
    return [word, *(stem for stem in stems if len(stem) >= 3)]  # letters
