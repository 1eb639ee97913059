"""A small file dialog in the window, the same on every desktop."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

from imgui_bundle import imgui

from ...control_names import sentence
from ...errors import UserError
from ...text import as_text
from ..interface.gui import Gui, colour
from ..interface.widgets import button, dialog, muted, shortened
from ..messages import Message

SCRIPT_SUFFIX = ".toml"  # suffix of scripts and poses
ENTER_KEYS = imgui.Key.enter, imgui.Key.keypad_enter


@dataclass
class FileRequest:
    """A request for a file: the task that receives the file, and the state of the dialog."""

    title: str
    is_saving: bool
    suffixes: tuple[str, ...]  # suffixes of the files to list
    then: Callable[[Path], Message]
    folder: Path
    name: str = ""  # text in the input line
    complaint: str = ""
    warned: Path | None = None  # an existing file, after a warning that it would be replaced
    wants_focus: bool = True  # whether the input line takes the focus in the next frame
    found: list[str] = field(default_factory=list)  # folders, which end in "/", then files

    def enter(self, folder: Path) -> None:
        """Show a folder without its hidden files; an unreadable folder gives a complaint."""
        try:
            with os.scandir(folder) as entries:
                visible = [entry for entry in entries if not entry.name.startswith(".")]
        except OSError as error:
            self.complaint = as_text(f"{folder.name}: {error.strerror}")
            return
        folders = [f"{entry.name}/" for entry in visible if entry.is_dir()]
        fitting = [each.name for each in visible if each.name.lower().endswith(self.suffixes)]
        self.found = [*sorted(folders, key=str.lower), *sorted(fitting, key=str.lower)]
        self.folder = folder.resolve()
        self.complaint = ""
        if not self.is_saving:
            self.name = ""

    @property
    def target(self) -> Path:
        """The path in the input line."""
        written = self.name.strip().strip("'\"")
        is_written = (name for name in self.found if as_text(name) == written)
        target = self.folder / Path(next(is_written, written)).expanduser()
        if self.is_saving and not target.suffix and not target.is_dir():
            target = target.with_suffix(self.suffixes[0])
        return target

    def confirmed(self) -> Path | None:
        """Return the target; None for a missing file, or an unconfirmed replacement.

        A folder is entered, unless a folder is saved.
        """
        target = self.target
        saves_folder = self.suffixes == ("",) and self.name.strip()
        if target.is_dir() and not saves_folder:
            self.enter(target)
        elif not self.is_saving and not target.is_file():
            self.complaint = as_text(f"there is no {target.name}")
        elif self.is_saving and target.exists() and target != self.warned:
            self.warned = target
            others = "; other files in it stay" if target.is_dir() else ""
            self.complaint = as_text(f"{target.name} is there already{others}")
        else:
            return target
        self.wants_focus = True
        return None


class FileDialogs:
    """A dialog for one file at a time: a list of a folder's files above an input line."""

    def __init__(self) -> None:
        self.request: FileRequest | None = None
        self._folder: Path | None = None  # folder of the last file

    @property
    def is_waiting(self) -> bool:
        """Whether the dialog is open."""
        return self.request is not None

    def open(
        self,
        title: str,
        then: Callable[[Path], Message],
        *,
        saving: bool,
        proposed: str = "",
        suffixes: tuple[str, ...] = (SCRIPT_SUFFIX,),
    ) -> None:
        """Open the dialog; unless the user cancels, a later frame calls `then` with the file."""
        target = (self._folder or Path.cwd()) / proposed
        folder = target.parent if proposed else target
        self.request = FileRequest(title, saving, suffixes, then, folder)
        self.request.enter(folder)
        self.request.name = as_text(target.name) if proposed else ""

    def draw(self, gui: Gui) -> Message:
        """Draw the open dialog, and pass the chosen file on."""
        request = self.request
        chosen = None
        if request is None:
            return None
        with dialog(request.title, width=36.0, height=26.0) as is_open:
            if not is_open:
                return None
            _draw_shortcuts(gui, request)
            chosen = _draw_listing(gui, request)
            if _is_confirmed(gui, request) and chosen is None:
                chosen = request.confirmed()
            imgui.same_line()
            is_cancelled = button(gui, "Cancel", name="path cancelled")
            is_cancelled = is_cancelled or imgui.is_key_pressed(imgui.Key.escape)
            imgui.same_line()
            room = imgui.get_content_region_avail().x
            complaint = shortened(sentence(request.complaint), room, keeps_end=True)
            imgui.text_colored(colour(gui.theme.error), complaint)
            if chosen is None and not is_cancelled:
                return None
            imgui.close_current_popup()
        self.request = None
        if chosen is None or is_cancelled:
            return None
        try:
            line = request.then(chosen)
        except (UserError, OSError) as error:
            if request.is_saving:  # the dialog stays, with the name for another try
                request.complaint = str(error)
                request.warned = None
                request.wants_focus = True
                self.request = request
            raise
        self._folder = chosen.parent
        return line


def _draw_shortcuts(gui: Gui, request: FileRequest) -> None:
    """Draw buttons for useful folders, and the path of the current folder."""
    shortcuts = {"Up": request.folder.parent, "Home": Path.home()}
    if not request.is_saving and SCRIPT_SUFFIX in request.suffixes:
        shortcuts["Examples"] = Path(str(files("risorius.assets") / "scripts"))
    for label, place in shortcuts.items():
        if button(gui, label, name=f"folder {label}"):
            request.enter(place)
        imgui.same_line()
    room = imgui.get_content_region_avail().x
    muted(gui, shortened(str(request.folder), room, keeps_end=True))


def _draw_listing(gui: Gui, request: FileRequest) -> Path | None:
    """Draw the files of the folder; returns a double-clicked file, if any."""
    chosen = None
    room = 2.2 * imgui.get_frame_height_with_spacing()
    borders = imgui.ChildFlags_.borders | imgui.ChildFlags_.nav_flattened
    imgui.begin_child("listing", (0.0, -room), borders)
    for name in request.found:
        kind = "folder" if name.endswith("/") else "file"
        text = as_text(name)
        label = text.replace("##", "# #")  # imgui hides the part of a label after ##
        twice = imgui.SelectableFlags_.allow_double_click
        is_clicked, _ = imgui.selectable(f"{label}###{kind} {text}", text == request.name, twice)
        gui.remember(f"{kind} {text.removesuffix('/')}")
        if is_clicked and kind == "folder":
            request.enter(request.folder / name)
            break
        if is_clicked:
            request.name = text
            request.complaint = ""
            if imgui.is_mouse_double_clicked(0) and not request.is_saving:
                chosen = request.folder / name
    if not request.found:
        muted(gui, f"No folders and no {' '.join(request.suffixes)} here")
    imgui.end_child()
    return chosen


def _is_confirmed(gui: Gui, request: FileRequest) -> bool:
    """Draw the input line and its button; return whether the button or Enter was pressed."""
    if request.wants_focus:
        imgui.set_keyboard_focus_here()
        request.wants_focus = False
    imgui.set_next_item_width(-1.0)
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    is_entered, request.name = imgui.input_text_with_hint(
        "##path", "A name, or a path", request.name, flags
    )
    gui.remember("path")
    label = "Open"
    if request.is_saving:
        label = "Replace" if request.warned == request.target else "Save"
    is_pressed = any(imgui.is_key_pressed(key, False) for key in ENTER_KEYS)
    is_pressed = is_pressed and bool(request.name) and not imgui.get_io().want_text_input
    return button(gui, label, name="path confirmed") or bool(is_entered) or is_pressed
