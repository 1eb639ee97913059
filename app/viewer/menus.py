"""Everything that a key or a menu does, as data, a function for each menu.

Menus, the keyboard and the sheet of keys are all made from these tables.
"""

from __future__ import annotations

from functools import partial

from ..easing import EASINGS
from .command import Command
from .control_rows import readable
from .export import Exporter
from .file_drop import FileDrop
from .key_selection import KeySelection
from .messages import Line, Task
from .panel_state import PanelState
from .placement import Placement
from .script_commands import ScriptCommands
from .session import Session
from .settings import Settings
from .time_axis import TimeAxis
from .view import View

Menu = tuple[Command, ...]


def file_menu(
    scripts: ScriptCommands, file_drop: FileDrop, exporter: Exporter, close: Task
) -> Menu:
    """Files that come and go, and the end."""
    return (
        Command("File", "New script", "Ctrl+N", scripts.new),
        Command("File", "Open script or pose ...", "Ctrl+O", scripts.ask_open),
        Command("File", "Open head ...", "Ctrl+H", file_drop.ask_head),
        Command("File", "Save script", "Ctrl+S", scripts.save),
        Command("File", "Save script as ...", "Ctrl+Shift+S", scripts.save_as),
        Command("File", "Save pose ...", "Ctrl+P", scripts.save_pose),
        Command("File", "Screenshot", "F12", exporter.screenshot),
        Command("File", "Film", "F10", exporter.toggle_film, lambda: exporter.film is not None),
        Command("File", "Quit", "Ctrl+Q", close),
    )


def edit_menu(session: Session) -> Menu:
    """Undo, and whole faces."""
    return (
        Command("Edit", "Undo", "Ctrl+Z", session.undo, None, lambda: session.can_undo),
        Command("Edit", "Redo", "Ctrl+Shift+Z", session.redo, None, lambda: session.can_redo),
        Command("Edit", "Neutral", "N", session.neutral),
        Command("Edit", "Mirror", "M", session.mirror),
        Command("Edit", "Randomise", "X", session.randomise),
    )


def time_menu(session: Session, scripts: ScriptCommands, axis: TimeAxis) -> Menu:
    """Playing, recording, and ways through the script."""
    return (
        Command("Time", "Play", "Space", session.toggle_playing, lambda: session.is_playing),
        Command("Time", "Record", "Ctrl+R", scripts.toggle_recording, lambda: session.is_recording),
        Command("Time", "Loop", "L", session.toggle_looping, lambda: session.is_looping),
        Command("Time", "To the start", "Home", partial(session.seek, 0.0)),
        Command("Time", "To the key before", "Left", partial(session.seek_key, -1)),
        Command("Time", "To the next key", "Right", partial(session.seek_key, 1)),
        Command("Time", "Show the whole script", "Shift+F", axis.show_whole),
    )


def keys_menu(selection: KeySelection) -> Menu:
    """What is done with the keys that are selected in the timeline."""

    def command(label: str, key: str, run: Task, other_key: str = "") -> Command:
        """One that needs keys."""
        return Command(
            "Keys", label, key, run, None, lambda: selection.can_change, other_key=other_key
        )

    def approach(easing: str) -> Command:
        """One that says how keys are approached."""
        return Command(
            "Keys",
            f"Approach: {easing}",
            "",
            partial(selection.ease, easing),
            partial(selection.is_eased, easing),
            lambda: selection.can_change,
        )

    return (
        Command("Keys", "Set key", "K", selection.set_key, None, lambda: selection.can_edit),
        Command(
            "Keys",
            "Name of the pose ...",
            "Shift+K",
            selection.rename,
            None,
            lambda: selection.can_rename,
        ),
        command("Duplicate", "Ctrl+D", selection.duplicate),
        command("Delete", "Delete", selection.delete, "Backspace"),
        command("A frame earlier", "Shift+Left", partial(selection.nudge, -1)),
        command("A frame later", "Shift+Right", partial(selection.nudge, 1)),
        Command("Keys", "Select all keys", "Ctrl+A", selection.select_all),
        *(approach(easing) for easing in EASINGS),
    )


def view_menu(settings: Settings, view: View, placement: Placement, panels: PanelState) -> Menu:
    """How the scene is drawn, and what is around it."""

    def flag(label: str, key: str, field: str) -> Command:
        """Switch a field of the look that is on or off."""
        return Command(
            "View",
            label,
            key,
            lambda: settings.look.toggle(field),
            lambda: bool(getattr(settings.look, field)),
        )

    def choice(label: str, key: str, field: str, value: str, other: str) -> Command:
        """Switch a field of the look between two values."""
        return Command(
            "View",
            label,
            key,
            lambda: settings.look.switch(field, value, other),
            lambda: getattr(settings.look, field) == value,
        )

    return (
        flag("Refine", "R", "is_refined"),
        choice("Compare: wipe", "D", "compare", "wipe", "off"),
        choice("Compare: side by side", "Shift+D", "compare", "side by side", "off"),
        flag("Wireframe", "W", "wireframe"),
        choice("Colour by splits", "C", "colours", "splits", "none"),
        Command("View", "Next shading", "S", lambda: settings.look.next_shading()),
        choice("Texture", "T", "skin", "textured", "plain"),
        Command(
            "View",
            "Muscles",
            "U",
            lambda: settings.look.toggle_overlay("muscles"),
            lambda: "muscles" in settings.look.overlays,
        ),
        Command("View", "Frame the face", "F", view.frame_scene),
        Command("View", "Hide panels", "Tab", panels.toggle_hidden, lambda: panels.are_hidden),
        Command(
            "View",
            "Full screen",
            "F11",
            partial(_toggle_full, placement),
            lambda: placement.is_full,
            other_key="Alt+Enter",
        ),
        Command(
            "View", "Dark theme", "F2", settings.toggle_theme, lambda: settings.theme == "dark"
        ),
        Command("View", "Larger words", "Ctrl+Equal", partial(settings.enlarge, 1.1)),
        Command("View", "Smaller words", "Ctrl+Minus", partial(settings.enlarge, 1.0 / 1.1)),
    )


def _toggle_full(placement: Placement) -> Line:
    placement.toggle_full()
    return "F11 leaves the full screen" if placement.is_full else None


def expression_menu(session: Session) -> Menu:
    """Keys 1 to 9 show the first expressions of the scene."""

    def is_shown(name: str) -> bool:
        """Whether the face shows this one alone."""
        return session.sole_control == name

    return tuple(
        Command(
            "Expression",
            readable(name),
            str(number),
            partial(session.show, name),
            partial(is_shown, name),
        )
        for number, name in enumerate(session.scene.expressions[:9], start=1)
    )


def help_menu(panels: PanelState) -> Menu:
    """The sheet of keys."""
    return (
        Command("Help", "Keys and mouse", "F1", panels.toggle_help, lambda: panels.is_help_open),
    )
