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
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from risorius import refine, render
from risorius.schema import Flag, OneOf, Record, Within, read_what_fits

from ..anatomy import OPACITY, SIDES, SKIN_ALONE, STRUCTURES, AnatomyView
from ..capture.encoder import FORMATS as FILMS
from ..errors import UserError, in_one_line
from ..export.formats import FORMATS as MOTION
from ..files import NoSuchFileError, save_text
from ..refining.presets import CHANGED, FIRST_PRESET, PRESETS, STATIC, Refinement, named
from ..refining.refiners import refiner_for
from ..scenes import Scene
from . import setting_rules as rules
from .colours import COLOURS
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
MOST_TOLD = 4  # of values that are of no use; a line has room for no more


class Refiners:
    """Some names, and those of all refiners that do something and are there when somebody asks."""

    def __init__(self, *others: str | None) -> None:
        self._others = others

    def __iter__(self) -> Iterator[str | None]:
        yield from (*self._others, *(name for name in refine.available() if name != STATIC))


Side = Annotated[str, OneOf(Refiners(rules.CHOSEN, STATIC, *PRESETS), "a look or a refiner")]


@dataclass
class Display(Record):
    """How the scene is shown; the names are those that panels show."""

    look: Annotated[str, OneOf(PRESETS)] = FIRST_PRESET
    # None: that of the look.
    refiner: Annotated[str | None, OneOf(Refiners(None), "a refiner")] = None
    # What refiners are told over the look, by their names.
    options: dict[str, dict[str, rules.Option]] = field(default_factory=dict)
    is_refined: Flag = True
    compare: Annotated[str, OneOf(rules.COMPARISONS)] = "off"
    # What is compared, at the left and at the right.
    a: Side = STATIC
    b: Side = rules.CHOSEN
    divider: rules.Share = 0.5  # of a wipe, of the picture's width
    shading: Annotated[str, OneOf([each.value for each in render.Shading])] = "pixel"
    wireframe: Flag = False
    colours: Annotated[str, OneOf(COLOURS)] = "none"
    skin: Annotated[str, OneOf(rules.SKINS)] = "textured"
    occlusion: Flag = True  # less light in folds; of textured skin
    wrinkles: rules.Share = 1.0  # how deep they are where skin is compressed
    light: Annotated[str, OneOf(render.LIGHTS)] = "studio"
    background: Annotated[str, OneOf(rules.BACKGROUNDS)] = "theme"
    tone: Annotated[str, OneOf(rules.TONES)] = "own"  # of textured skin
    is_orthographic: Flag = False  # the camera
    overlays: list[Annotated[str, OneOf(OVERLAYS)]] = field(default_factory=list)
    # Of the skin over muscles and skull, and on which side of the face it lets them show.
    skin_opacity: rules.Share = OPACITY
    dissect: Annotated[str, OneOf(SIDES)] = "both"

    @property
    def anatomy(self) -> AnatomyView:
        """What is seen under the skin."""
        structures = tuple(name for name in STRUCTURES if name in self.overlays)
        return AnatomyView(structures, self.skin_opacity, self.dissect)

    def choose_preset(self, name: str) -> None:
        """Refine by a look, and by nothing but it."""
        self.look, self.refiner, self.options = name, None, {}

    def refiner_on(self, scene: Scene) -> str:
        """The name of the refiner that is chosen for this scene."""
        return Refinement(self.look, self.refiner).on(scene.name)[0]

    def choose_refiner(self, scene: Scene, name: str) -> None:
        """Refine by another refiner, or by that of the look again."""
        self.refiner = None if name == PRESETS[self.look][scene.name].refiner else name

    def preset_as_changed(self, scene: Scene) -> str:
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

    def remove_unknown_refiners(self) -> None:
        """Tell nothing to refiners that are not installed any more."""
        self.options = {
            name: self.options[name] for name in refine.available() if name in self.options
        }

    def remove_missing_overlays(self, scene: Scene) -> None:
        """Show none that this scene has no data for."""
        self.overlays = [name for name in self.overlays if name in overlays_of(scene)]


@dataclass
class ExportChoices(Record):
    """What was exported last, and how."""

    kind: Annotated[str, OneOf(KINDS)] = "mp4"
    source: Annotated[str, OneOf(SOURCES)] = "script"
    seconds: Annotated[float, Within(0.1, 600.0)] = 4.0  # of a face as it is
    size: Annotated[tuple[int, int], Within(*rules.SIDES_EXPORTED)] = (1280, 720)
    rate: Annotated[float, Within(1.0, 240.0)] = 30.0  # [frames/s]
    is_transparent: Flag = False
    has_captions: Flag = True
    is_turntable: Flag = False
    folder: rules.Folder = ""  # "" for the present one


@dataclass
class Settings(rules.WindowSettings):
    """Everything that is remembered."""

    is_linked: Flag = True  # sliders of both sides
    is_alive: Flag = True  # the face, where nobody moves it
    tab: Annotated[str, OneOf(rules.TABS)] = "Face"
    # [letters' heights]; layout.py has the limits of a screen.
    panel_width: Annotated[float, Within(0.0, 1000.0)] = 22.5
    shows_curves: Flag = False  # of keys, instead of rows
    counts_frames: Flag = False  # instead of seconds
    timeline_height: Annotated[float, Within(0.0, 1000.0)] = 0.0  # [letters']; 0: as needed
    folds: dict[str, Flag] = field(default_factory=dict)  # which headings are open, by title
    cameras: dict[str, rules.Camera] = field(default_factory=dict)  # by scene
    recent: list[str] = field(default_factory=list)  # files, latest first
    display: Display = field(default_factory=Display)
    knows_first_steps: Flag = False
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
    anatomy: AnatomyView = SKIN_ALONE,
    *,
    splits: bool,
    **style: Any,
) -> Display:
    """How the scene of this name is shown as the command line asks for; style: further fields."""
    display = Display(
        look=refinement.preset,
        colours="splits" if splits else "none",
        overlays=list(anatomy.structures),
        skin_opacity=anatomy.opacity,
        dissect=anatomy.side,
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
    try:
        stored = rules.stored_settings(path)
    except NoSuchFileError:
        return Settings(), ""
    except UserError as error:
        return Settings(), f"{error}; all is as at first; {rename_unusable(path)}"
    except ValueError as error:
        return Settings(), f"{path}: {error}; all is as at first; {rename_unusable(path)}"
    settings, refused = read_what_fits(Settings, stored)
    settings.display.remove_unknown_refiners()
    if not refused:
        return settings, ""
    renamed = rename_unusable(path)
    with contextlib.suppress(UserError):  # of a full disk others speak
        save_settings(path, settings)
    told = refused[:MOST_TOLD] + [f"{len(refused) - MOST_TOLD} more"] * (len(refused) > MOST_TOLD)
    return settings, in_one_line(f"{path}: as at first: {'; '.join(told)}; {renamed}")


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
    stored = asdict(settings)
    for table in (stored, stored["display"]):  # what is not chosen is not there
        for name in [name for name, value in table.items() if value is None]:
            del table[name]
    save_text(path, json.dumps(stored, indent=1))
