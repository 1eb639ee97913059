"""The settings that the window remembers, each with its allowed values.

They are stored in one JSON file in the user's configuration folder, which is replaced atomically.
Each value is checked separately: the default replaces an unusable value, other values stay, and
the window reports unusable values in one line.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from risorius import refine, render
from risorius.folders import configuration_folder
from risorius.schema import (
    Flag,
    MadeFrom,
    OneOf,
    Record,
    Within,
    parsed_json,
    quoted,
    read_valid_entries,
)

from ..anatomy import SIDE_SIGNS, SKIN_ALONE, SKIN_OPACITY, STRUCTURES, AnatomyView
from ..capture.outputs import FILM_FORMATS as FILMS
from ..errors import UserError
from ..export.formats import MOTION_FORMATS as MOTION
from ..files import NoSuchFileError, read_text, save_text
from ..light_maps import LIGHT_SUFFIXES, is_light, scene_light
from ..refining.presets import CHANGED_SUFFIX, FIRST_PRESET, PRESETS, STATIC_REFINER, Refinement
from ..scenes import Drawable
from ..text import in_one_line
from .interface.gui import THEMES

SIDES_SHOWN = 200, 16384  # [screen units]: limits of the window's width and height
COMPARISON_NAMES = ("off", "wipe", "side by side")
SKIN_CHOICES = {  # whether the skin is textured, and its colour
    "textured": (True, render.SKIN),
    "plain": (False, render.SKIN),
    "clay": (False, render.CLAY),
}
BACKGROUND_NAMES = ("light", "dark", "white", "black")
BACKGROUND_CHOICES = {
    "theme": None,
    **{name: getattr(render, name.upper()) for name in BACKGROUND_NAMES},
    "map": None,  # the light's map; for a lamp, the theme's background
}
# Individual typology angles [degrees], see assets/identities/complexion.py; None: of the person.
TONE_ANGLES = {"own": None, "very light": 61.0, "light": 48.0, "intermediate": 34.0}
TONE_ANGLES |= {"tan": 19.0, "brown": -10.0, "dark": -45.0}
FRAMES_KIND = "frames"  # pictures in a folder


class ExportKind(NamedTuple):
    """One kind of export. suffix: suffix of the file, "" for a folder. fastest: [frames/s]."""

    title: str
    suffix: str
    is_drawn: bool = True  # whether it has pictures instead of motion
    can_be_transparent: bool = False
    fastest: float = 240.0


EXPORT_KINDS = {
    end[1:]: ExportKind(f"Film ({end})", end, fastest=each.fastest) for end, each in FILMS.items()
}
EXPORT_KINDS[FRAMES_KIND] = ExportKind("Pictures in a folder (.png)", "", True, True)
for _each in MOTION:
    _end = (*_each.suffixes, "")[0]
    EXPORT_KINDS[_each.name] = ExportKind(
        f"Motion: {_each.title} ({_end or 'folder'})", _end, is_drawn=False
    )


def _light(value: Any) -> str:
    if not isinstance(value, str) or not is_light(value):
        lights = ", ".join(render.LIGHTS)
        maps = " or ".join(LIGHT_SUFFIXES)
        raise ValueError(
            f"was {quoted(value)}, must be one of {lights}, or the path of a map {maps}"
        )
    return value


def _option(value: Any) -> Any:
    is_number = isinstance(value, int | float)
    if is_number and abs(value) <= sys.float_info.max:
        return value
    if is_number or not isinstance(value, str | None):
        raise ValueError(f"was {quoted(value)}, must be a number, a text, true or false")
    return value


def _refiners() -> list[str | None]:
    """Return the names of available refiners that split triangles; None: the look's refiner."""
    return [None, *(name for name in refine.refiners.available() if name != STATIC_REFINER)]


_Pair = Annotated[tuple[int, int], Within(*SIDES_SHOWN)]
WindowSize = Annotated[tuple[int, int] | None, MadeFrom(_Pair, tuple)]
Fraction = Annotated[float, Within(0.0, 1.0)]
Option = Annotated[Any, MadeFrom(Any, _option)]  # value of an option; the refiner checks it further


@dataclass
class Display(Record):
    """Display settings of the scene, with the names that the panels display."""

    look: Annotated[str, OneOf(PRESETS)] = FIRST_PRESET
    refiner: Annotated[str | None, OneOf(_refiners, "a refiner")] = None  # None: of the look
    # Options that replace options of the look: name of a refiner -> name of an option -> value.
    options: dict[str, dict[str, Option]] = field(default_factory=dict)
    is_refined: Flag = True
    compare: Annotated[str, OneOf(COMPARISON_NAMES)] = "off"  # the kind of comparison
    beside: Annotated[str, OneOf((STATIC_REFINER, *PRESETS))] = (
        STATIC_REFINER  # a look, or the unrefined mesh
    )
    divider: Fraction = 0.5  # place of a wipe's line, as a share of the picture's width
    shading: Annotated[str, OneOf([each.value for each in render.Shading])] = "pixel"
    wireframe: Flag = False
    splits: Flag = False  # colour triangles by their splits
    wires: Flag = False  # outline triangles with more splits than at rest
    skin: Annotated[str, OneOf(SKIN_CHOICES)] = "textured"
    skin_maps: Flag = True  # fine shape, and less light in folds, from texture maps
    wrinkles: Fraction = 1.0  # depth of wrinkles where skin is compressed
    light: Annotated[str, MadeFrom(Any, _light)] = "studio"  # the name of a `scene_light`
    background: Annotated[str, OneOf(BACKGROUND_CHOICES)] = "theme"
    tone: Annotated[str, OneOf(TONE_ANGLES)] = "own"  # tone of textured skin
    has_hair: Flag = True  # whether a head with textured skin has hair
    overlays: list[Annotated[str, OneOf(STRUCTURES)]] = field(default_factory=list)
    # Opacity of the skin over muscles and skull, and the side of the face that shows these.
    skin_opacity: Fraction = SKIN_OPACITY
    dissect: Annotated[str, OneOf(SIDE_SIGNS)] = "both"

    @property
    def anatomy(self) -> AnatomyView:
        """The anatomy to show under the skin."""
        structures = tuple(name for name in STRUCTURES if name in self.overlays)
        return AnatomyView(structures, self.skin_opacity, self.dissect, self.has_hair)

    def as_at_first(self) -> Display:
        """Return the default display, but keep light, background, tone and hair."""
        of_scene = ("light", "background", "tone", "has_hair")
        return Display(**{name: getattr(self, name) for name in of_scene})

    def choose_preset(self, name: str) -> None:
        """Refine by a look, with its own refiner and options."""
        self.look = name
        self.refiner = None
        self.options = {}

    def refiner_on(self, scene: Drawable) -> str:
        """Return the name of the chosen refiner for this scene."""
        return Refinement(self.look, self.refiner).for_scene(scene.name)[0]

    def choose_refiner(self, scene: Drawable, name: str) -> None:
        """Refine by another refiner, or again by the look's refiner."""
        self.refiner = None if name == PRESETS[self.look][scene.name].refiner else name

    def preset_as_changed(self, scene: Drawable) -> str:
        """Return the look's name, with a mark if the refinement of this scene differs."""
        asked = self.refinement_on(scene)
        return self.look if asked == Refinement(self.look) else f"{self.look}{CHANGED_SUFFIX}"

    def refinement_on(self, scene: Drawable) -> Refinement:
        """Return the refinement of this scene."""
        options = self.options.get(self.refiner_on(scene), {})
        return Refinement(self.look, self.refiner, dict(options))

    @property
    def refinement_beside(self) -> Refinement:
        """The refinement of a comparison's left side."""
        return (
            Refinement(refiner=STATIC_REFINER)
            if self.beside == STATIC_REFINER
            else Refinement(self.beside)
        )

    def has_equal_sides(self, scene: Drawable) -> bool:
        """Whether both sides of a comparison show this scene with the same refinement."""
        return self.refinement_beside == self.refinement_on(scene)

    @property
    def share(self) -> float:
        """The width of a comparison's left part, as a fraction of the picture's width."""
        return self.divider if self.compare == "wipe" else 0.5

    def toggle_overlay(self, name: str) -> None:
        """Show an overlay or hide it."""
        others = [each for each in self.overlays if each != name]
        self.overlays = others if name in self.overlays else [*others, name]

    def remove_missing_light(self) -> str:
        """Use the default light if the light's map cannot be read; return the reason, or ""."""
        try:
            scene_light(self.light)
        except UserError as error:
            self.light = Display.light
            return f"{error}; the default light is used"
        return ""

    def remove_missing_overlays(self, scene: Drawable) -> None:
        """Hide the overlays without data in this scene."""
        self.overlays = [] if scene.face is None else self.overlays


@dataclass
class ExportChoices(Record):
    """The choices of the last export."""

    kind: Annotated[str, OneOf(EXPORT_KINDS)] = "mp4"
    size: Annotated[tuple[int, int], Within(*(16, 8192))] = (
        1280,
        720,
    )  # [pixels] of exported pictures
    rate: Annotated[float, Within(1.0, 240.0)] = 30.0  # [frames/s]
    is_transparent: Flag = False


@dataclass
class Settings(Record):
    """All remembered settings."""

    ZOOMS = 0.6, 3.0  # least and greatest zoom

    size: WindowSize = None  # size of the window [screen units]
    theme: Annotated[str, OneOf(THEMES)] = "light"
    zoom: Annotated[float, Within(*ZOOMS)] = 1.0  # scale of words and sliders
    is_linked: Flag = True  # whether sliders of both sides are linked
    is_alive: Flag = True  # whether the face has idle life
    # [em]; layout.py limits the width to the screen.
    panel_width: Annotated[float, Within(0.0, 1000.0)] = 22.5
    shows_curves: Flag = False  # whether the timeline shows curves instead of rows of keys
    folds: dict[str, Flag] = field(default_factory=dict)  # whether a heading is open, by title
    recent: list[str] = field(default_factory=list)  # paths of files, latest first
    display: Display = field(default_factory=Display)
    export: ExportChoices = field(default_factory=ExportChoices)

    def note_recent(self, *paths: Path) -> None:
        """Remember files that were opened together, or saved."""
        opened = "\n".join(str(path.absolute()) for path in paths)
        self.recent = [*dict.fromkeys((opened, *self.recent))][:10]

    def enlarge(self, factor: float) -> None:
        """Multiply the zoom by a factor, within its limits."""
        least, most = self.ZOOMS
        self.zoom = min(max(self.zoom * factor, least), most)


def switch(part: object, name: str, value: object = True, other: object = False) -> None:
    """Set a field of an object to `value`, or to `other` if it has this value already."""
    setattr(part, name, other if getattr(part, name) == value else value)


def display_of(
    refinement: Refinement,
    scene: str,
    anatomy: AnatomyView = SKIN_ALONE,
    *,
    splits: bool,
    **style: Any,
) -> Display:
    """Return the display for options of the command line. scene: its name. style: more fields."""
    display = Display(
        look=refinement.preset,
        splits=splits,
        overlays=list(anatomy.structures),
        skin_opacity=anatomy.opacity,
        dissect=anatomy.side,
        **style,
    )
    if refinement.refiner == STATIC_REFINER:
        display.is_refined = False
    else:
        display.refiner = refinement.refiner
    if refinement.options:
        display.options[refinement.for_scene(scene)[0]] = dict(refinement.options)
    return display


def settings_path() -> Path:
    """Return the path of the user's settings."""
    return configuration_folder() / "viewer.json"


def load_settings(path: Path) -> tuple[Settings, str]:
    """Return the stored settings, and a line that names unusable values in the file, or "".

    The file is rewritten when the window closes.
    """
    try:
        longest_file = 2**20  # [bytes]; settings have about two thousand
        stored = parsed_json(read_text(path, what="file of settings", longest=longest_file))
    except NoSuchFileError:
        return Settings(), ""
    except UserError as error:
        return Settings(), f"{error}; the defaults are used"
    except ValueError as error:
        return Settings(), f"{path}: {error}; the defaults are used"
    settings, refused = read_valid_entries(Settings, stored)
    if not refused:
        return settings, ""
    most_reported = 4  # unusable values; a line has room for no more
    reported = refused[:most_reported]
    if len(refused) > most_reported:
        reported.append(f"{len(refused) - most_reported} more")
    return settings, in_one_line(f"{path}: defaults replace: {'; '.join(reported)}")


def save_settings(path: Path, settings: Settings) -> None:
    """Write the file; raises UserError if this fails."""
    stored = asdict(settings)
    for table in (stored, stored["display"]):  # None stands for a default, and is left out
        for name in [name for name, value in table.items() if value is None]:
            del table[name]
    save_text(path, json.dumps(stored, indent=1))
