"""Plain words for controls: what each is called, and by which other words it is found.

The words themselves are in assets, `words.toml`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cache
from typing import Any

from risorius.assets.loading import read_words

from .mirror import parted

VISEME = "viseme_"
ENDINGS, LEAST_STEM = ("ing", "ed", "s"), 3  # of a word that is looked for; letters before them


def readable(name: str) -> str:
    """A name in words, in sentence case; codes such as jawOpen stay as they are."""
    is_word = name.partition("_")[0].partition(" ")[0].islower()
    return (name[:1].upper() + name[1:] if is_word else name).replace("_", " ")


def sentence(text: str) -> str:
    """A text with a capital, unless it begins with a code or a file, as "a.b: opened"."""
    name, colon, _ = text.partition(":")
    is_plain = text.partition(" ")[0].islower() and not (colon and "." in name)
    return text[:1].upper() + text[1:] if is_plain else text


def called(name: str, *twin: str) -> str:
    """A control by its plain name and its side, or with its twin both sides of it."""
    plain = title_of(name)[1] or readable(parted(name)[0])
    side = "both sides" if twin else parted(name)[1].strip("_")
    return f"{plain}, {side}" if side else plain


@cache
def _table(kind: str) -> Mapping[str, Any]:
    found: Mapping[str, Any] = read_words().get(kind, {})
    return found


@cache
def _synonyms() -> tuple[tuple[str, frozenset[str]], ...]:
    return tuple(
        (word, frozenset(found))
        for words, found in _table("synonyms").items()
        for word in words.split()
    )


def title_of(name: str, action: str = "") -> tuple[str, str]:
    """The code that a control is known by, "" for none, and its plain name, "" for a code alone.

    name: without its side, where both sides are called alike. action: what it does, in words.
    """
    stem = parted(name)[0]
    plain = str(_table("names").get(name) or _table("names").get(stem) or "")
    first = action.partition(":")[0]
    if name.startswith("AU"):
        return stem, plain or first[:1].upper() + first[1:]
    if plain:
        return "", plain
    if name.startswith(VISEME):
        return name.removeprefix(VISEME), first
    if name != name.lower():  # as ARKit spells it
        return name, ""
    return "", readable(name).capitalize()


def is_found(words: str, text: str, names: Collection[str]) -> bool:
    """Whether each of the words is in the text, or begins another word for one of the names.

    names: of controls, with their sides.
    """
    stems = {*names, *(parted(name)[0] for name in names)}
    return all(
        any(
            form in text.lower()
            or any(other.startswith(form) and found & stems for other, found in _synonyms())
            for form in _forms(word)
        )
        for word in words.lower().split()
    )


def _forms(word: str) -> list[str]:
    """A word as it was typed, and without its ending: chewing, chew."""
    stems = [word.removesuffix(end) for end in ENDINGS if word.endswith(end)]
    return [word, *(stem for stem in stems if len(stem) >= LEAST_STEM)]
