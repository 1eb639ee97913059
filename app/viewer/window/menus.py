"""The commands of all menus and keys, as data; one function for each menu.

Menus, keys and buttons are all made from these tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from imgui_bundle import imgui

from risorius import __version__, render

from ...control_names import readable
from ...performances import examples
from ...refining.presets import FIRST_PRESET, PAPERS_PRESET
from ...scenes import BUILT_IN
from ...script.easings import EASINGS
from ...text import as_text
from ..documents.export import Exporter
from ..documents.file_dialogs import FileDialogs
from ..documents.file_drop import FileDrop
from ..documents.manual import Manual, table
from ..documents.scripts import ScriptCommands
from ..interface.commands import Command
from ..messages import Message, Task
from ..picture.stage import SceneView
from ..session.live_commands import LiveCommands
from ..session.session import Session
from ..settings import Settings, switch
from ..timeline.keys import KeySelection
from ..timeline.time_axis import TimeAxis
from .splash_screen import zoom_for

Menu = tuple[Command, ...]
CITATION = """\
@article{kaehler2003refining,
  author = {K{\\"a}hler, Kolja and Haber, J{\\"o}rg and Seidel, Hans-Peter},
  title = {Dynamically refining animated triangle meshes for rendering},
  journal = {The Visual Computer},
  volume = {19},
  year = {2003},
  doi = {10.1007/s00371-002-0185-8}
}
@software{risorius,
  author = {{The Risorius authors}},
  title = {Risorius: physics-based facial animation with dynamically refined triangle meshes},
  version = {VERSION}
}
"""


def file_menu(
    scripts: ScriptCommands,
    file_drop: FileDrop,
    exporter: Exporter,
    exports: Menu,
    settings: Settings,
    close: Task,
) -> Menu:
    """Return commands for files, and to quit. exports: the commands under Export."""
    command = partial(Command, "File")

    def recent() -> Iterator[Command]:
        """Yield commands that open a recent file again."""
        for paths in (each.split("\n") for each in settings.recent):
            names = " + ".join(Path(path).name for path in paths)
            label = as_text(f"{names}   {Path(paths[0]).parent}").replace("##", "# #")
            yield command(label, "", partial(file_drop.open, paths))

    def example() -> Iterator[Command]:
        """Yield commands that open an included script."""
        for path in examples(exporter.session.script.scene):
            yield command(readable(path.stem), "", partial(file_drop.open, [str(path)]))

    other = partial(command, can_run=lambda: exporter.session.scene.called not in ("", BUILT_IN))
    export = partial(command, can_run=lambda: exporter.job is None)
    return (
        command("New script", "Ctrl+N", scripts.new),
        command("Open script or recording ...", "Ctrl+O", scripts.ask_open),
        command("Recent", "", lambda: None, submenu=recent),
        command("Examples", "", lambda: None, submenu=example),
        command("Open head ...", "Ctrl+H", file_drop.ask_head, begins_section=True),
        other("Built-in head", "", partial(file_drop.show_person, None)),
        command("Open sound ...", "Ctrl+U", scripts.ask_sound, begins_section=True),
        command("Remove sound", "", scripts.remove_sound, can_run=lambda: scripts.has_sound),
        command("Save script", "Ctrl+S", scripts.save, begins_section=True),
        command("Save script as ...", "Ctrl+Shift+S", scripts.save_as),
        command("Save pose ...", "Ctrl+P", scripts.save_pose),
        command("Screenshot", "F12", exporter.screenshot, begins_section=True),
        export("Export", "Ctrl+E, F10", exporter.open_dialog, submenu=lambda: exports),
        command("Quit", "Ctrl+Q", close, begins_section=True),
    )


def export_menu(exporter: Exporter, files: FileDialogs) -> Menu:
    """Return the submenu of File that exports a face for other programs."""
    return (
        Command(
            "File",
            "Film, pictures or motion ...",
            "Ctrl+E, F10",
            exporter.open_dialog,
            can_run=lambda: exporter.job is None,
            words="export film video mp4 gif webm pictures; motion usd glb gltf obj pc2 vtkhdf npz",
        ),
        Command(
            "File",
            "Avatar ...",
            "",
            partial(exporter.ask_avatar, files),
            can_run=lambda: exporter.job is None and exporter.session.scene.face is not None,
            words="export avatar: blendshapes, morph targets, shape keys of ARKit; rig glb gltf",
        ),
    )


def edit_menu(session: Session) -> Menu:
    """Return commands that undo changes, or that change the whole face."""
    command = partial(Command, "Edit")
    redo = partial(command, can_run=lambda: session.history.can_redo)
    of_sides = partial(command, can_run=lambda: session.scene.face is not None)
    return (
        command("Undo", "Ctrl+Z", session.undo, can_run=lambda: session.can_undo),
        redo("Redo", "Ctrl+Y, Ctrl+Shift+Z", session.redo),
        command("Neutral", "N", session.neutral, begins_section=True),
        of_sides("Mirror", "M", session.mirror),
        of_sides("Left to right", "Shift+M", partial(session.mirror, "left")),
        of_sides("Right to left", "Ctrl+M", partial(session.mirror, "right")),
    )


def time_menu(session: Session, scripts: ScriptCommands, axis: TimeAxis) -> Menu:
    """Return commands to play, to record, and to move through the script."""
    command = partial(Command, "Time")
    return (
        command("Play", "Space", session.toggle_playing, lambda: session.is_playing),
        command("Record", "Ctrl+R", scripts.toggle_recording, lambda: session.is_recording),
        switch_of(lambda: session, "Time", "Loop", "L", "is_looping"),
        command("To the start", "Home", partial(session.seek, 0.0), begins_section=True),
        command("To the key before", "Left", partial(session.seek_key, -1)),
        command("To the next key", "Right", partial(session.seek_key, 1)),
        command("Show the whole script", "Shift+F", axis.show_whole_script),
    )


def switch_of(
    part: Callable[[], object],
    menu: str,
    label: str,
    key: str,
    field: str,
    on: object = True,
    off: object = False,
    *,
    begins_section: bool = False,
) -> Command:
    """Return a command that switches a field of an object between two values."""

    def is_on() -> bool:
        return bool(getattr(part(), field) == on)

    def run() -> None:
        switch(part(), field, on, off)

    return Command(menu, label, key, run, is_on, begins_section=begins_section)


def keys_menu(session: Session, selection: KeySelection) -> Menu:
    """Return commands for the selected keys of the timeline."""
    command = partial(Command, "Keys")
    edit = partial(command, can_run=lambda: selection.can_edit)
    change = partial(command, can_run=lambda: selection.can_change)
    ease = selection.ease
    is_eased = selection.is_eased
    return (
        edit("Set key", "K", selection.set_key),
        edit("Key whole pose", "Shift+K", selection.key_whole_pose),
        command("Let go", "", session.release_controls, can_run=lambda: bool(session.differing)),
        switch_of(lambda: session, "Keys", "Auto-key", "", "is_keying"),
        change("Copy", "Ctrl+C", selection.copy, begins_section=True),
        command("Paste", "Ctrl+V", selection.paste, can_run=lambda: bool(selection.copied)),
        change("Delete", "Delete", selection.delete),
        change("A frame earlier", "Shift+Left", partial(selection.nudge, -1), begins_section=True),
        change("A frame later", "Shift+Right", partial(selection.nudge, 1)),
        command("Select all keys", "Ctrl+A", selection.select_all),
        *(
            change(f"Easing: {name}", "", partial(ease, name), partial(is_eased, name))
            for name in EASINGS
        ),
    )


def view_menu(
    settings: Settings, view: SceneView, session: Session, surface: render.WindowSurface
) -> Menu:
    """Return commands for the scene's display, and the panels around it."""

    def has_face() -> bool:
        """Whether the scene is a face: a plane has no texture, muscles and life."""
        return session.scene.face is not None

    command = partial(Command, "View")
    display_switch = partial(switch_of, lambda: settings.display, "View")
    setting = partial(switch_of, lambda: settings, "View")

    def toggle_look() -> Message:
        """Switch between the paper's rule and the first look, and drop changes of either."""
        display = settings.display
        display.choose_preset(FIRST_PRESET if display.look == PAPERS_PRESET else PAPERS_PRESET)
        return f"Look: {display.look}"

    def use_default_size() -> None:
        """Give words the size that fits the window's height."""
        settings.zoom = zoom_for(surface, surface.frame_size[1])

    is_opened = lambda: "muscles" in settings.display.overlays  # noqa: E731
    muscles = partial(command, is_on=is_opened, can_run=has_face)
    view_keys = {  # Alt: for keyboards without a number pad
        "Front": "Keypad1, Alt+1",
        "Three-quarter": "Keypad2, Alt+2",
        "Three-quarter right": "Ctrl+Keypad2, Ctrl+Alt+2",
        "Profile": "Keypad3, Alt+3",
        "Profile right": "Ctrl+Keypad3, Ctrl+Alt+3",
        "Top": "Keypad7, Alt+7",
    }
    return (
        display_switch("Refine", "R", "is_refined"),
        command("Paper's look", "P", toggle_look, lambda: settings.display.look == PAPERS_PRESET),
        display_switch("Compare: wipe", "D", "compare", "wipe", "off", begins_section=True),
        display_switch("Compare: side by side", "Shift+D", "compare", "side by side", "off"),
        display_switch("Wireframe", "W", "wireframe", begins_section=True),
        display_switch("Colour by splits", "C", "splits"),
        replace(display_switch("Texture", "T", "skin", "textured", "plain"), can_run=has_face),
        muscles("Muscles", "U", lambda: settings.display.toggle_overlay("muscles")),
        replace(setting("Idle life", "A", "is_alive", begins_section=True), can_run=has_face),
        setting("Curves", "G", "shows_curves"),
        command("Frame the face", "F", view.fit_scene, begins_section=True),
        *(command(name, key, partial(view.look_from, name)) for name, key in view_keys.items()),
        setting("Dark theme", "F2", "theme", "dark", "light", begins_section=True),
        command("Larger text", "Ctrl+Equal", partial(settings.enlarge, 1.1)),
        command("Smaller text", "Ctrl+Minus", partial(settings.enlarge, 1.0 / 1.1)),
        command("Default size", "Ctrl+0", use_default_size),
    )


def expression_keys(session: Session) -> Menu:
    """Return commands without a menu: keys 1 to 9 show the first expressions of the scene."""
    return tuple(
        Command("", readable(name), str(number), partial(session.toggle_solo, name))
        for number, name in enumerate(session.scene.expressions[:9], start=1)
    )


def live_menu(live: LiveCommands, session: Session) -> Menu:
    """Return commands for a live face; none for a scene without a face."""
    command = partial(Command, "Live")
    if session.scene.face is None:
        return ()
    return (
        command("Listen", "Ctrl+L", live.toggle, lambda: live.is_on),
        command("Calibrate", "Shift+N", live.calibrate, can_run=lambda: live.is_receiving),
    )


def help_menu(manual: Manual, commands: Callable[[], Menu]) -> Menu:
    """Return commands for manual, version and citation. commands: all commands of the window."""
    command = partial(Command, "Help")
    return (
        command("Manual", "F1", manual.read),
        command("Keys and mouse", "", lambda: show_keys(manual, commands())),
        command("About Risorius", "", about, begins_section=True),
        command("Copy citation", "", copy_citation),
    )


def show_keys(manual: Manual, commands: Menu) -> None:
    """Show the keys of all commands by menu, and the actions of the mouse."""
    gestures = (
        ("left button on the skin", "pull it into a pose; with Ctrl it swings back"),
        ("click on the skin", "show the muscle in the panel"),
        ("left button beside the face, right button anywhere", "orbit"),
        ("middle button, or Shift", "pan"),
        ("wheel", "zoom to the mouse"),
        ("double click on a bar", "type a number"),
        ("right click on a bar", "key it, delete its key, clear its track, reset it"),
        ("drag a key", "move all selected keys; Ctrl: anywhere"),
        ("drag over nothing in the timeline", "select keys in a box"),
        ("right click on a key", "the menu of keys"),
        ("drop files", "open them"),
    )
    sections = [table(("mouse", "action"), gestures)]
    with_keys = [each for each in commands if each.key]
    for menu in dict.fromkeys(each.menu for each in with_keys):
        rows = [(each.label, each.displayed_keys) for each in with_keys if each.menu == menu]
        sections.append(f"## {menu or 'Expressions'}\n\n{table(('command', 'keys'), rows)}")
    manual.show("Keys and mouse", "\n\n".join(sections))


def about() -> Message:
    """Return a line about the program."""
    return (
        f"Risorius {__version__}, MIT licence. Muscles and springs move the face; its mesh is "
        "refined after Kähler, Haber, Seidel 2003. [Manual] opens the manual."
    )


def copy_citation() -> Message:
    """Copy citations of the paper and the program to the clipboard, as BibTeX."""
    imgui.set_clipboard_text(CITATION.replace("VERSION", __version__))
    return "The paper and the program are in the clipboard, as BibTeX"
