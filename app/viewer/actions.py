"""Everything that a key or a menu does, as data: menus, keys and their help come from here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from ..script.easing import EASINGS
from . import commands, dropped, key_commands

if TYPE_CHECKING:
    from .window import Viewer

_MODIFIERS = {"Ctrl": imgui.Key.mod_ctrl, "Shift": imgui.Key.mod_shift, "Alt": imgui.Key.mod_alt}

_KEY_NAMES = {"Left": "left_arrow", "Right": "right_arrow"}


@dataclass(frozen=True)
class Action:
    """One thing to do: where it stands, its key, what it does, and whether it is switched on."""

    menu: str
    label: str
    key: str
    run: Callable[[Viewer], None]
    is_on: Callable[[Viewer], bool] | None = None
    can_run: Callable[[Viewer], bool] = lambda viewer: True
    other_key: str = ""

    @property
    def shown_key(self) -> str:
        """The key as people know it."""
        return self.key.replace("Equal", "=").replace("Minus", "-")

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that do it."""
        return tuple(key for key in (self.key, self.other_key) if key)


def _chord(key: str) -> int:
    """A key as imgui counts it."""
    *modifiers, last = key.split("+")
    name = _KEY_NAMES.get(last, last.lower())
    code: Any = getattr(imgui.Key, f"_{name}" if name.isdigit() else name)
    chord = int(code)
    for modifier in modifiers:
        chord |= int(_MODIFIERS[modifier])
    return chord


def actions_of(viewer: Viewer) -> tuple[Action, ...]:
    """All that menus and keys do for a window, in the order of its menus."""
    return (*_FILE, *_EDIT, *_TIME, *_KEYS, *_VIEW, *_expressions(viewer), *_HELP)


def _expressions(viewer: Viewer) -> list[Action]:
    """Keys 1 to 9 show the first expressions of the scene."""

    def show(number: int, name: str) -> Action:
        """The expression `name`, on the key of its number."""
        return Action(
            "Expression",
            name.replace("_", " "),
            str(number),
            lambda v: v.session.show(name),
            is_on=lambda v: v.session.shown == name,
        )

    names = list(viewer.scene.expressions)[:9]
    return [show(number, name) for number, name in enumerate(names, start=1)]


def _can_undo(viewer: Viewer) -> bool:
    return viewer.session.can_undo


def _can_redo(viewer: Viewer) -> bool:
    return viewer.session.can_redo


def _is_dark(viewer: Viewer) -> bool:
    return viewer.settings.theme == "dark"


def _look(label: str, key: str, field: str, value: str, other: str) -> Action:
    """Switch a field of the look between two values."""
    return Action(
        "View",
        label,
        key,
        lambda v: commands.switch(v, field, value, other),
        lambda v: getattr(v.look, field) == value,
    )


def _flag(label: str, key: str, field: str) -> Action:
    """Switch a field of the look that is on or off."""
    return Action(
        "View",
        label,
        key,
        lambda v: commands.toggle(v, field),
        lambda v: bool(getattr(v.look, field)),
    )


def _of_keys(label: str, key: str, run: Callable[[Viewer], None]) -> Action:
    """What is done with the keys that are selected in the timeline."""
    return Action("Keys", label, key, run, None, key_commands.has_selected)


def _easing(name: str) -> Action:
    """How the selected keys are approached."""
    return Action(
        "Keys",
        f"Approach: {name}",
        "",
        lambda v: key_commands.ease(v, name),
        lambda v: key_commands.is_eased(v, name),
        key_commands.has_selected,
    )


_FILE = (
    Action("File", "New script", "Ctrl+N", commands.new_script),
    Action("File", "Open script or pose ...", "Ctrl+O", commands.open_file),
    Action("File", "Open head ...", "Ctrl+H", dropped.ask_head),
    Action("File", "Save script", "Ctrl+S", commands.save_script),
    Action("File", "Save script as ...", "Ctrl+Shift+S", commands.save_script_as),
    Action("File", "Save pose ...", "Ctrl+P", commands.save_pose),
    Action("File", "Screenshot", "F12", commands.screenshot),
    Action("File", "Film", "F10", commands.toggle_film, lambda v: v.film is not None),
    Action("File", "Quit", "Ctrl+Q", commands.close_politely),
)
_EDIT = (
    Action("Edit", "Undo", "Ctrl+Z", lambda v: v.session.undo(), None, _can_undo),
    Action("Edit", "Redo", "Ctrl+Shift+Z", lambda v: v.session.redo(), None, _can_redo),
    Action("Edit", "Neutral", "N", lambda v: v.session.neutral()),
    Action("Edit", "Mirror", "M", lambda v: v.session.mirror()),
    Action("Edit", "Randomise", "X", commands.randomise),
)
_TIME = (
    Action("Time", "Play", "Space", commands.toggle_playing, lambda v: v.session.is_playing),
    Action("Time", "Record", "Ctrl+R", commands.toggle_recording, lambda v: v.session.is_recording),
    Action("Time", "Loop", "L", commands.toggle_looping, lambda v: v.session.is_looping),
    Action("Time", "To the start", "Home", lambda v: v.session.seek(0.0)),
    Action("Time", "To the key before", "Left", lambda v: v.session.seek_key(-1)),
    Action("Time", "To the next key", "Right", lambda v: v.session.seek_key(1)),
    Action("Time", "Show the whole script", "Shift+F", key_commands.show_whole),
)
_KEYS = (
    Action("Keys", "Set key", "K", key_commands.set_key, None, key_commands.can_edit),
    Action(
        "Keys",
        "Name of the pose ...",
        "Shift+K",
        key_commands.rename,
        None,
        key_commands.can_rename,
    ),
    _of_keys("Duplicate", "Ctrl+D", key_commands.duplicate),
    replace(_of_keys("Delete", "Delete", key_commands.delete), other_key="Backspace"),
    _of_keys("A frame earlier", "Shift+Left", lambda v: key_commands.nudge(v, -1)),
    _of_keys("A frame later", "Shift+Right", lambda v: key_commands.nudge(v, 1)),
    Action("Keys", "Select all keys", "Ctrl+A", key_commands.select_all),
    *(_easing(name) for name in EASINGS),
)
_VIEW = (
    _flag("Refine", "R", "is_refined"),
    _look("Compare: wipe", "D", "compare", "wipe", "off"),
    _look("Compare: side by side", "Shift+D", "compare", "side by side", "off"),
    _flag("Wireframe", "W", "wireframe"),
    _look("Colour by splits", "C", "colours", "splits", "none"),
    Action("View", "Next shading", "S", commands.next_shading),
    _look("Texture", "T", "skin", "textured", "plain"),
    Action(
        "View",
        "Muscles",
        "U",
        lambda v: commands.toggle_overlay(v, "muscles"),
        lambda v: "muscles" in v.look.overlays,
    ),
    Action("View", "Frame the face", "F", commands.frame_face),
    Action("View", "Hide panels", "Tab", commands.toggle_panels, lambda v: v.is_bare),
    Action(
        "View",
        "Full screen",
        "F11",
        commands.toggle_full,
        lambda v: v.placement.is_full,
        other_key="Alt+Enter",
    ),
    Action("View", "Dark theme", "F2", commands.toggle_theme, _is_dark),
    Action("View", "Larger words", "Ctrl+Equal", lambda v: commands.enlarge(v, 1.1)),
    Action("View", "Smaller words", "Ctrl+Minus", lambda v: commands.enlarge(v, 1.0 / 1.1)),
)
_HELP = (Action("Help", "Keys and mouse", "F1", commands.toggle_help, lambda v: v.is_help_open),)

MOUSE = (
    ("left on the skin", "pull; click: its muscle"),
    ("left beside, or right", "orbit"),
    ("middle, or Shift", "pan"),
    ("wheel", "zoom"),
    ("double click a slider", "type a number"),
    ("right click a slider", "back to 0"),
    ("drag a panel's edge", "make it wider"),
    ("drop files", "script, pose, a head"),
)
TIMELINE = (
    ("click a key", "select it, go there"),
    ("Shift click", "select more, or fewer"),
    ("drag a key", "move what is selected"),
    ("Ctrl while dragging", "between frames"),
    ("Escape", "leave it where it was"),
    ("drag over nothing", "select in a box"),
    ("double click a pose", "name it"),
    ("right click", "all of this"),
    ("wheel, Shift wheel", "zoom, scroll"),
    ("drag the end", "longer, shorter"),
)
# Ctrl keys that a line of text takes for itself while one writes.
WRITING = ("Ctrl+A", "Ctrl+Z", "Ctrl+Shift+Z")


def run_pressed(viewer: Viewer, actions: tuple[Action, ...]) -> None:
    """Carry out the actions whose keys were pressed in this frame."""
    is_writing = imgui.get_io().want_text_input
    for action in actions:
        for key in action.keys:
            is_for_text = is_writing and ("Ctrl" not in key or key in WRITING)
            if not is_for_text and imgui.is_key_chord_pressed(_chord(key)):
                if action.can_run(viewer):
                    viewer.attempt(partial(action.run, viewer))
