"""Which file: a small chooser in the window, the same on every desktop."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from imgui_bundle import imgui

from ...controls.vocabulary import sentence
from ..interface.gui import Gui, colour, em
from ..interface.widgets import button, muted, shortened
from ..messages import Message

SUFFIX = ".toml"  # of scripts and poses


@dataclass
class Request:
    """A file that is asked for, and what to do with it."""

    title: str
    is_saving: bool
    proposed: Path  # where to begin; for saving with a name
    suffixes: tuple[str, ...]  # how the names of such files end
    then: Callable[[Path], Message]


class FileDialogs:
    """Asks for one file at a time."""

    def __init__(self) -> None:
        self.request: Request | None = None
        self._folder: Path | None = None  # where the last file was

    @property
    def is_waiting(self) -> bool:
        """Whether an answer is awaited."""
        return self.request is not None

    def ask(
        self,
        title: str,
        then: Callable[[Path], Message],
        *,
        saving: bool,
        proposed: str = "",
        suffixes: tuple[str, ...] = (SUFFIX,),
    ) -> None:
        """Ask for a file; `then` is called with it in a later frame, or never."""
        target = (self._folder or Path.cwd()) / proposed
        self.request = Request(title, saving, target, suffixes, then)

    def answer(self, path: Path | None) -> Message:
        """Go on with the file that was chosen; None for none."""
        request, self.request = self.request, None
        if request is None or path is None:
            return None
        self._folder = path.parent
        return request.then(path)


SIZE = (36.0, 26.0)  # [em]


def listing(folder: Path, suffixes: tuple[str, ...]) -> tuple[list[str], list[str]]:
    """The names of folders, and of files that end so, in a folder; without those that hide."""
    with os.scandir(folder) as entries:
        visible = [entry for entry in entries if not entry.name.startswith(".")]
        folders = [entry.name for entry in visible if entry.is_dir()]
        found = [entry.name for entry in visible if entry.name.lower().endswith(suffixes)]
    return sorted(folders, key=str.lower), sorted(found, key=str.lower)


class FileChooser:
    """Answers requests for files: a line to type in, above it what is in the folder."""

    def __init__(self, gui: Gui, files: FileDialogs) -> None:
        self._gui, self._files = gui, files
        self._request: Request | None = None  # for which it is open

    def draw(self) -> Message:
        """Draw it while it is needed, and go on with the file that it gives."""
        request = self._files.request
        if request is None:
            return None
        if self._request is not request:
            self._open(request)
        is_done, chosen = self._draw_box(request)
        return self._files.answer(chosen) if is_done else None

    def _open(self, request: Request) -> None:
        self._request = request
        self._folders: list[str] = []
        self._found: list[str] = []
        self._complaint = ""
        self._warned: Path | None = None  # what is there already, as was said
        self._wants_focus = True  # of the line: on opening, and after each answer that was none
        is_folder = not request.is_saving and request.proposed.is_dir()
        self._folder = request.proposed if is_folder else request.proposed.parent
        self._enter(request, self._folder)
        self._name = "" if is_folder else request.proposed.name

    def _draw_box(self, request: Request) -> tuple[bool, Path | None]:
        """Draw what must be answered; whether it was, and the file, None where none is wanted."""
        display = imgui.get_io().display_size
        if not imgui.is_popup_open(request.title):
            imgui.open_popup(request.title)
        imgui.set_next_window_size((min(em(SIZE[0]), display.x), min(em(SIZE[1]), display.y)))
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        flags = imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_saved_settings
        if not imgui.begin_popup_modal(request.title, None, flags)[0]:
            return False, None
        self._draw_places(request)
        chosen = self._draw_listing(request)
        is_confirmed = self._draw_line(request) or self._is_entered()
        if is_confirmed and chosen is None:
            chosen = self._confirmed(request)
        imgui.same_line()
        is_cancelled = button(self._gui, "Cancel", name="path cancelled")
        is_cancelled = is_cancelled or imgui.is_key_pressed(imgui.Key.escape)
        if self._complaint:
            imgui.same_line()
            imgui.text_colored(colour(self._gui.theme.error), sentence(self._complaint))
        is_done = is_cancelled or chosen is not None
        if is_done:
            imgui.close_current_popup()
        imgui.end_popup()
        return is_done, None if is_cancelled else chosen

    def _draw_places(self, request: Request) -> None:
        """Where one may want to go, and where one is."""
        places = {"Up": self._folder.parent, "Home": Path.home()}
        if not request.is_saving and SUFFIX in request.suffixes:
            places["Examples"] = Path(str(files("risorius.assets") / "scripts"))
        for label, place in places.items():
            if button(self._gui, label, name=f"folder {label}"):
                self._enter(request, place)
            imgui.same_line()
        room = imgui.get_content_region_avail().x
        muted(self._gui, shortened(str(self._folder), room, keeps_end=True))

    def _draw_listing(self, request: Request) -> Path | None:
        """What is in the folder; the file that was clicked twice, if any."""
        chosen = None
        room = 2.2 * imgui.get_frame_height_with_spacing()
        borders = imgui.ChildFlags_.borders | imgui.ChildFlags_.nav_flattened
        imgui.begin_child("listing", (0.0, -room), borders)
        for name in self._folders:
            is_clicked, _ = imgui.selectable(f"{_label(name)}/###folder {name}", False)
            self._gui.remember(f"folder {name}")
            if is_clicked:
                self._enter(request, self._folder / name)
                break
        for name in self._found:
            flags = imgui.SelectableFlags_.allow_double_click
            is_clicked, _ = imgui.selectable(
                f"{_label(name)}###file {name}", name == self._name, flags
            )
            self._gui.remember(f"file {name}")
            if is_clicked:
                self._name, self._complaint = name, ""
                if imgui.is_mouse_double_clicked(0) and not request.is_saving:
                    chosen = self._folder / name
        if not self._folders and not self._found:
            muted(self._gui, f"No folders and no {' '.join(request.suffixes)} here")
        imgui.end_child()
        return chosen

    def _draw_line(self, request: Request) -> bool:
        """The line to type in and the button below it; whether one of them was confirmed."""
        if self._wants_focus:
            imgui.set_keyboard_focus_here()
            self._wants_focus = False
        imgui.set_next_item_width(-1.0)
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, self._name = imgui.input_text_with_hint(
            "##path", "A name, or a path", self._name, flags
        )
        self._gui.remember("path")
        label = "Open"
        if request.is_saving:
            label = "Replace" if self._warned == self._target(request) else "Save"
        return button(self._gui, label, name="path confirmed") or bool(is_entered)

    def _is_entered(self) -> bool:
        """Whether Enter was pressed where nobody types and a file was clicked."""
        keys = (imgui.Key.enter, imgui.Key.keypad_enter)
        is_pressed = any(imgui.is_key_pressed(key, False) for key in keys)
        return is_pressed and bool(self._name) and not imgui.get_io().want_text_input

    def _target(self, request: Request) -> Path:
        """What the line stands for."""
        target = self._folder / Path(self._name.strip().strip("'\"")).expanduser()
        if request.is_saving and not target.suffix and not target.is_dir():
            target = target.with_suffix(request.suffixes[0])
        return target

    def _confirmed(self, request: Request) -> Path | None:
        """The file in the line, unless it is a folder, is missing or would be lost unasked."""
        target = self._target(request)
        if target.is_dir():
            self._enter(request, target)
        elif not request.is_saving and not target.is_file():
            self._complaint = f"there is no {target.name}"
        elif request.is_saving and target.exists() and target != self._warned:
            self._warned, self._complaint = target, f"{target.name} is there already"
        else:
            return target
        self._wants_focus = True
        return None

    def _enter(self, request: Request, folder: Path) -> None:
        """Show a folder, if it may be read."""
        try:
            self._folders, self._found = listing(folder, request.suffixes)
        except OSError as error:
            self._complaint = f"{folder.name}: {error.strerror}"
            return
        self._folder, self._complaint = folder.resolve(), ""
        if not request.is_saving:
            self._name = ""


def _label(name: str) -> str:
    """A file's name as imgui shows it: what comes after ## would be hidden."""
    return name.replace("##", "# #")
