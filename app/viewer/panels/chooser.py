"""A small file chooser inside the window, for systems that have no dialogs of their own."""

from __future__ import annotations

import os
from importlib.resources import files
from pathlib import Path

from imgui_bundle import imgui

from ..gui import Gui, colour, em
from .words import shortened

SUFFIX = ".toml"
SIZE = (36.0, 26.0)  # [em]


def listing(folder: Path, suffixes: tuple[str, ...]) -> tuple[list[str], list[str]]:
    """The names of folders, and of files that end so, in a folder; without those that hide."""
    with os.scandir(folder) as entries:
        shown = [entry for entry in entries if not entry.name.startswith(".")]
        folders = [entry.name for entry in shown if entry.is_dir()]
        found = [entry.name for entry in shown if entry.name.lower().endswith(suffixes)]
    return sorted(folders, key=str.lower), sorted(found, key=str.lower)


class Chooser:
    """Asks for one file: a line to type in, above it what is in the folder."""

    def __init__(
        self,
        title: str,
        folder: Path,
        name: str,
        *,
        is_saving: bool,
        suffixes: tuple[str, ...] = (SUFFIX,),
    ) -> None:
        self._title = title
        self._suffixes = suffixes
        self._is_saving = is_saving
        self._name = name
        self._folders: list[str] = []
        self._found: list[str] = []
        self._complaint = ""
        self._warned: Path | None = None  # what is there already, as was said
        self._wants_focus = True  # of the line: on opening, and after each answer that was none
        self.folder = folder
        self._enter(folder)

    def draw(self, gui: Gui) -> Path | str | None:
        """Draw it; the file that was chosen, "" where none is wanted, None while it is open."""
        display = imgui.get_io().display_size
        if not imgui.is_popup_open(self._title):
            imgui.open_popup(self._title)
        width, height = min(em(SIZE[0]), display.x), min(em(SIZE[1]), display.y)
        imgui.set_next_window_size(imgui.ImVec2(width, height))
        middle = imgui.ImVec2(0.5 * display.x, 0.5 * display.y)
        imgui.set_next_window_pos(middle, 0, imgui.ImVec2(0.5, 0.5))
        flags = imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_saved_settings
        is_open, _ = imgui.begin_popup_modal(self._title, None, flags)
        if not is_open:
            return None
        self._draw_places(gui)
        answer: Path | str | None = self._draw_listing(gui)
        is_confirmed = self._draw_line(gui)
        if answer is None and is_confirmed:
            answer = self._confirmed()
        imgui.same_line()
        if imgui.button("Cancel") or imgui.is_key_pressed(imgui.Key.escape):
            answer = ""
        gui.remember("path cancelled")
        if self._complaint:
            imgui.same_line()
            imgui.text_colored(colour(gui.theme.error), self._complaint)
        if answer is not None:
            imgui.close_current_popup()
        imgui.end_popup()
        return answer

    def _draw_places(self, gui: Gui) -> None:
        """Where one may want to go, and where one is."""
        places = {"Up": self.folder.parent, "Home": Path.home()}
        if not self._is_saving and SUFFIX in self._suffixes:
            places["Examples"] = Path(str(files("risorius.assets") / "scripts"))
        for label, place in places.items():
            if imgui.button(label):
                self._enter(place)
            gui.remember(f"folder {label}")
            imgui.same_line()
        room = imgui.get_content_region_avail().x
        imgui.text_colored(
            colour(gui.theme.muted), shortened(str(self.folder), room, keeps_end=True)
        )

    def _draw_listing(self, gui: Gui) -> Path | None:
        """What is in the folder; the file that was clicked twice, if any."""
        chosen = None
        room = 2.2 * imgui.get_frame_height_with_spacing()
        imgui.begin_child("listing", imgui.ImVec2(0.0, -room), imgui.ChildFlags_.borders)
        for name in self._folders:
            is_clicked, _ = imgui.selectable(f"{_label(name)}/###folder {name}", False)
            gui.remember(f"folder {name}")
            if is_clicked:
                self._enter(self.folder / name)
                break
        for name in self._found:
            flags = imgui.SelectableFlags_.allow_double_click
            is_clicked, _ = imgui.selectable(
                f"{_label(name)}###file {name}", name == self._name, flags
            )
            gui.remember(f"file {name}")
            if is_clicked:
                self._name, self._complaint = name, ""
                if imgui.is_mouse_double_clicked(0) and not self._is_saving:
                    chosen = self.folder / name
        if not self._folders and not self._found:
            imgui.text_colored(
                colour(gui.theme.muted), f"no folders and no {' '.join(self._suffixes)} here"
            )
        imgui.end_child()
        return chosen

    def _draw_line(self, gui: Gui) -> bool:
        """The line to type in and the button below it; whether one of them was confirmed."""
        if self._wants_focus:
            imgui.set_keyboard_focus_here()
            self._wants_focus = False
        imgui.set_next_item_width(-1.0)
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        is_entered, self._name = imgui.input_text_with_hint(
            "##path", "a name, or a path", self._name, flags
        )
        gui.remember("path")
        opens = "Replace" if self._warned == self._target() else "Save"
        is_clicked = imgui.button(opens if self._is_saving else "Open")
        gui.remember("path confirmed")
        return bool(is_entered or is_clicked)

    def _target(self) -> Path:
        """What the line stands for."""
        target = self.folder / Path(self._name.strip().strip("'\"")).expanduser()
        if self._is_saving and not target.suffix and not target.is_dir():
            target = target.with_suffix(self._suffixes[0])
        return target

    def _confirmed(self) -> Path | None:
        """The file in the line, unless it is a folder, is missing or would be lost unasked."""
        target = self._target()
        if target.is_dir():
            self._enter(target)
        elif not self._is_saving and not target.is_file():
            self._complaint = f"there is no {target.name}"
        elif self._is_saving and target.exists() and target != self._warned:
            self._warned, self._complaint = target, f"{target.name} is there already"
        else:
            return target
        self._wants_focus = True
        return None

    def _enter(self, folder: Path) -> None:
        """Show a folder, if it may be read."""
        try:
            self._folders, self._found = listing(folder, self._suffixes)
        except OSError as error:
            self._complaint = f"{folder.name}: {error.strerror}"
            return
        self.folder, self._complaint = folder.resolve(), ""
        if not self._is_saving:
            self._name = ""


def _label(name: str) -> str:
    """A file's name as imgui shows it: what comes after ## would be hidden."""
    return name.replace("##", "# #")
