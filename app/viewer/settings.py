"""What the window remembers: its size, how things are shown, where the camera stood.

One JSON file in the user's configuration folder, replaced whole or not at all. Every value stands
for itself: one that is of no use gives way to what it is at first, the others stay, and the window
names it in one line. The file as it was is kept beside it then.
"""

from __future__ import annotations

import contextlib
import json
import reprlib
import time
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from risorius import render

from ..anatomy import OPACITY, SIDES, SOLIDS, Dissection
from ..capture.formats import FORMATS as FILMS
from ..errors import UserError, in_one_line
from ..export.formats import FORMATS as MOTION
from ..files import NoSuchFileError, read_text, save_text
from ..refining.looks import CHANGED, FIRST_LOOK, LOOKS, STATIC, Refinement, named
from ..refining.refiners import refiner_for
from ..scenes import Scene
from . import setting_rules as rules
from .colours import COLOURS
from .interface.gui import THEMES
from .overlays import OVERLAYS, overlays_of


@dataclass
class PanelState:
    """Commands change it, panels follow."""

    are_hidden: bool = False  # all but the picture
    is_help_open: bool = False
    wanted_tab: str = ""  # to be brought to the front, by its title

    def toggle_hidden(self) -> str | None:
        """Hide all but the picture, or show it again."""
        self.are_hidden = not self.are_hidden
        return "Menus are at the upper edge" if self.are_hidden else None


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

MOST_RECENT = 10  # files that are remembered
LONGEST_FILE = 2**20  # [bytes]; those that we write have two thousand


@dataclass
class Display:
    """How the scene is shown; the names are those that panels show."""

    look: Annotated[str, rules.one_of(LOOKS)] = FIRST_LOOK
    refiner: Annotated[str | None, rules.refiner] = None  # None: that of the look
    # What refiners are told over the look, by their names.
    options: dict[str, dict[str, Any]] = field(default_factory=dict)
    is_refined: Annotated[bool, rules.flag] = True
    compare: Annotated[str, rules.one_of(rules.COMPARISONS)] = "off"
    a: Annotated[str, rules.side] = STATIC  # what is compared, at the left and at the right
    b: Annotated[str, rules.side] = rules.CHOSEN
    divider: Annotated[float, rules.number(0.0, 1.0)] = 0.5  # of a wipe, of the picture's width
    shading: Annotated[str, rules.one_of([each.value for each in render.Shading])] = "pixel"
    wireframe: Annotated[bool, rules.flag] = False
    colours: Annotated[str, rules.one_of(COLOURS)] = "none"
    skin: Annotated[str, rules.one_of(rules.SKINS)] = "textured"
    occlusion: Annotated[bool, rules.flag] = True  # less light in folds; of textured skin
    # How deep skin wrinkles where it is compressed.
    wrinkles: Annotated[float, rules.number(0.0, 1.0)] = 1.0
    light: Annotated[str, rules.one_of(render.LIGHTS)] = "studio"
    background: Annotated[str, rules.one_of(rules.BACKGROUNDS)] = "theme"
    tone: Annotated[str, rules.one_of(rules.TONES)] = "own"  # of textured skin
    is_orthographic: Annotated[bool, rules.flag] = False  # the camera
    overlays: Annotated[list[str], rules.several_of(OVERLAYS)] = field(default_factory=list)
    # Of the skin over muscles and skull, and on which side of the face it lets them show.
    skin_opacity: Annotated[float, rules.number(0.0, 1.0)] = OPACITY
    dissect: Annotated[str, rules.one_of(SIDES)] = "both"

    @property
    def dissection(self) -> Dissection:
        """What is seen under the skin."""
        solids = tuple(name for name in SOLIDS if name in self.overlays)
        return Dissection(solids, self.skin_opacity, self.dissect)

    def choose_look(self, name: str) -> None:
        """Refine by a look, and by nothing but it."""
        self.look, self.refiner, self.options = name, None, {}

    def refiner_on(self, scene: Scene) -> str:
        """The name of the refiner that is chosen for this scene."""
        return Refinement(self.look, self.refiner).on(scene.name)[0]

    def choose_refiner(self, scene: Scene, name: str) -> None:
        """Refine by another refiner, or by that of the look again."""
        self.refiner = None if name == LOOKS[self.look][scene.name].refiner else name

    def look_as_changed(self, scene: Scene) -> str:
        """The look's name, and whether what is seen of this scene is still what it was."""
        asked = self.refinement_on(scene)
        return self.look if asked == Refinement(self.look) else f"{self.look}{CHANGED}"

    def refinement_on(self, scene: Scene) -> Refinement:
        """How this scene is refined."""
        options = self.options.get(self.refiner_on(scene), {})
        return Refinement(self.look, self.refiner, dict(options))

    def side_on(self, scene: Scene, side: str) -> Refinement:
        """How this scene is refined on a side of a comparison, "a" or "b"."""
        name = getattr(self, side)
        return self.refinement_on(scene) if name == rules.CHOSEN else named(name, self.look)

    @property
    def share(self) -> float:
        """Of the picture's width, what is at the left of the line in a comparison."""
        return self.divider if self.compare == "wipe" else 0.5

    def toggle_overlay(self, name: str) -> None:
        """Show an overlay or hide it."""
        others = [each for each in self.overlays if each != name]
        self.overlays = others if name in self.overlays else [*others, name]

    def next_shading(self) -> None:
        """Flat, Gouraud, per pixel, and round again."""
        order = [shading.value for shading in render.Shading]
        self.shading = order[(order.index(self.shading) + 1) % len(order)]

    def remove_missing_overlays(self, scene: Scene) -> None:
        """Show none that this scene has no data for."""
        self.overlays = [name for name in self.overlays if name in overlays_of(scene)]


@dataclass
class ExportChoices:
    """What was exported last, and how."""

    kind: Annotated[str, rules.one_of(KINDS)] = "mp4"
    source: Annotated[str, rules.one_of(SOURCES)] = "script"
    seconds: Annotated[float, rules.number(0.1, 600.0)] = 4.0  # of a face as it is
    size: Annotated[tuple[int, int], rules.sides] = (1280, 720)
    rate: Annotated[float, rules.number(1.0, 240.0)] = 30.0  # [frames/s]
    is_transparent: Annotated[bool, rules.flag] = False
    has_captions: Annotated[bool, rules.flag] = True
    is_turntable: Annotated[bool, rules.flag] = False
    folder: Annotated[str, rules.folder] = ""  # "" for the present one


@dataclass
class Settings:
    """Everything that is remembered."""

    size: Annotated[tuple[int, int] | None, rules.size] = None  # of the window [screen units]
    theme: Annotated[str, rules.one_of(THEMES)] = "light"
    zoom: Annotated[float, rules.number(*rules.ZOOMS)] = 1.0  # of all words and sliders
    is_linked: Annotated[bool, rules.flag] = True  # sliders of both sides
    is_alive: Annotated[bool, rules.flag] = True  # the face, where nobody moves it
    tab: Annotated[str, rules.one_of(rules.TABS)] = "Face"
    # [letters' heights]; layout.py has the limits of a screen.
    panel_width: Annotated[float, rules.number(0.0, 1000.0)] = 22.5
    shows_curves: Annotated[bool, rules.flag] = False  # of keys, instead of rows
    counts_frames: Annotated[bool, rules.flag] = False  # instead of seconds
    timeline_height: Annotated[float, rules.number(0.0, 1000.0)] = 0.0  # [letters']; 0: as needed
    folds: dict[str, bool] = field(default_factory=dict)  # which headings are open, by title
    cameras: dict[str, list[float]] = field(default_factory=dict)  # by scene
    keys: dict[str, str] = field(default_factory=dict)  # that were changed, by command
    recent: Annotated[list[str], rules.texts] = field(default_factory=list)  # files, latest first
    display: Display = field(default_factory=Display)
    knows_first_steps: Annotated[bool, rules.flag] = False
    export: ExportChoices = field(default_factory=ExportChoices)

    def note_recent(self, *paths: Path) -> None:
        """Remember files that were opened together, or saved."""
        opened = "\n".join(str(path.absolute()) for path in paths)
        self.recent = [*dict.fromkeys((opened, *self.recent))][:MOST_RECENT]

    def enlarge(self, factor: float) -> None:
        """Make words and sliders larger or smaller."""
        least, most = rules.ZOOMS
        self.zoom = min(max(self.zoom * factor, least), most)


def switch(part: object, name: str, value: object = True, other: object = False) -> None:
    """Give a field of a part this value, or the other if it has it already."""
    setattr(part, name, other if getattr(part, name) == value else value)


def display_of(
    refinement: Refinement,
    scene: str,
    dissection: Dissection = Dissection(),  # noqa: B008 - frozen
    *,
    splits: bool,
    **style: Any,
) -> Display:
    """How the scene of this name is shown as the command line asks for; style: further fields."""
    display = Display(
        look=refinement.look,
        colours="splits" if splits else "none",
        overlays=list(dissection.solids),
        skin_opacity=dissection.opacity,
        dissect=dissection.side,
        **style,
    )
    if refinement.refiner == STATIC:
        display.is_refined = False
    else:
        display.refiner = refinement.refiner
    if refinement.options:
        display.options[refinement.on(scene)[0]] = dict(refinement.options)
    return display


def load_settings(path: Path) -> tuple[Settings, str]:
    """What is remembered, and a line that names what is in the file and of no use, "" for nothing.

    In that case the file is set aside, and what is of use of it written anew.
    """
    settings, refused = Settings(), rules.Refused()
    try:
        text = read_text(path, what="file of settings", longest=LONGEST_FILE)
        stored = json.loads(text, parse_int=rules.whole_number)
    except NoSuchFileError:
        return settings, ""
    except UserError as error:
        return settings, f"{error}; all is as at first; {rename_unusable(path)}"
    except (ValueError, RecursionError) as error:
        return (
            settings,
            f"{path}: not valid JSON: {error}; all is as at first; {rename_unusable(path)}",
        )
    accepted = refused.table("", stored, rules.rules_of(Settings).get)
    display = refused.table("display.", accepted.pop("display", {}), rules.rules_of(Display).get)
    options = refused.table("display.options.", display.pop("options", {}), rules.table_of_refiner)
    display["options"] = {
        name: refused.table(f"display.options.{name}.", found, lambda _: rules.option)
        for name, found in options.items()
    }
    export = refused.table("export.", accepted.pop("export", {}), rules.rules_of(ExportChoices).get)
    accepted["export"] = ExportChoices(**export)
    folds, cameras, keys = (accepted.pop(name, {}) for name in ("folds", "cameras", "keys"))
    accepted["folds"] = refused.table("folds.", folds, lambda _: rules.flag)
    accepted["cameras"] = refused.table("cameras.", cameras, lambda _: rules.camera)
    accepted["keys"] = refused.table("keys.", keys, lambda _: rules.shortcut)
    settings, told = Settings(**accepted, display=Display(**display)), str(refused)
    if not told:
        return settings, ""
    renamed = rename_unusable(path)
    with contextlib.suppress(UserError):  # of a full disk others speak
        save_settings(path, settings)
    return settings, in_one_line(f"{path}: of no use and as at first: {told}; {renamed}")


def rename_unusable(path: Path) -> str:
    """Give a file of no use another name, and say which; it is written anew on closing."""
    unusable = path.with_name(f"{path.stem}-{time.strftime('%Y%m%d-%H%M%S')}.unusable{path.suffix}")
    try:
        path.rename(unusable)
    except OSError as error:
        return f"it cannot be set aside ({error.strerror}), and is written anew on closing"
    return f"the file is kept as {unusable.name}"


def remove_refused_options(display: Display, scene: Scene) -> str:
    """Take out of `display` what refiners refuse for this scene; a line names it, "" for none."""
    refused = []
    suits, look = partial(_suits, scene), display.look
    for refiner, options in display.options.items():
        if not options or suits(Refinement(look, refiner, options)):
            continue
        accepted: dict[str, Any] = {}
        for name, value in options.items():
            if suits(Refinement(look, refiner, {**accepted, name: value})):
                accepted[name] = value
            else:
                refused.append(f"{refiner} {name} = {reprlib.repr(value)}")
        display.options[refiner] = accepted
    if display.refiner is not None and not suits(Refinement(look, display.refiner)):
        refused.append(display.refiner)
        display.refiner = None
    for side in ("a", "b"):
        if not suits(display.side_on(scene, side)):
            refused.append(getattr(display, side))
            setattr(display, side, getattr(Display(), side))
    line = f"of no use and as at first: refiner {', '.join(refused)}"
    return in_one_line(line) if refused else ""


def _suits(scene: Scene, refinement: Refinement) -> bool:
    try:
        refiner_for(scene, refinement)
    except UserError:
        return False
    return True


def save_settings(path: Path, settings: Settings) -> None:
    """Write the file; UserError where that cannot be."""
    save_text(path, json.dumps(asdict(settings), indent=1))
