"""Around it all: the menu bar, messages, the question before work is lost, help."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from .. import commands
from ..actions import MOUSE, TIMELINE, Action
from ..gui import colour, em

if TYPE_CHECKING:
    from ..window import Viewer

MESSAGE_SECONDS = 6.0
LONGEST_FRAME = 0.25  # [s] that counts for a message: a frame that took longer showed nothing
QUESTION = "Unsaved work"
# Menus by column of the sheet of keys, and what the mouse does.
HELP_COLUMNS = (
    ("File", "Edit", "Time"),
    ("Keys", "Expression", "Help"),
    ("View",),
    ("Mouse", "Timeline"),
)
HELP_COLUMNS_NARROW = (
    ("File", "Edit", "Time", "Help"),
    ("Keys", "View"),
    ("Mouse", "Timeline", "Expression"),
)
HELP_WIDTH = 63.0  # [em] that the wide ones take


def draw_menus(viewer: Viewer, actions: Sequence[Action]) -> float:
    """The menu bar, made of the actions; returns its height."""
    if not imgui.begin_main_menu_bar():
        return 0.0
    height = float(round(imgui.get_window_size().y))
    for title in dict.fromkeys(action.menu for action in actions):
        is_open = imgui.begin_menu(title)
        viewer.gui.remember(f"menu {title}")
        if not is_open:
            continue
        draw_actions(viewer, actions, title)
        imgui.end_menu()
    unsaved = viewer.session.unsaved
    if unsaved:
        imgui.text_colored(colour(viewer.gui.theme.muted), f"   unsaved: {unsaved}")
    imgui.end_main_menu_bar()
    return height


def draw_actions(viewer: Viewer, actions: Sequence[Action], menu: str) -> None:
    """What a menu offers, inside it."""
    for action in actions:
        if action.menu != menu:
            continue
        is_on = action.is_on is not None and action.is_on(viewer)
        is_clicked, _ = imgui.menu_item(
            action.label, action.shown_key, is_on, action.can_run(viewer)
        )
        viewer.gui.remember(f"menu {menu}: {action.label}")
        if is_clicked:
            viewer.attempt(partial(action.run, viewer))


@dataclass
class Messages:
    """One line at a time, at the foot of the picture; an error stays until it is clicked."""

    text: str = ""
    is_error: bool = False
    left: float = 0.0  # [s]

    def say(self, text: str, *, error: bool = False) -> None:
        """Show a line in place of the one before."""
        self.text, self.is_error, self.left = text, error, MESSAGE_SECONDS

    def draw(self, viewer: Viewer, seconds: float) -> None:
        """Draw the line, if there is one."""
        if not self.is_error:
            self.left -= min(seconds, LONGEST_FRAME)
        if not self.text or self.left <= 0.0:
            self.text = ""
            return
        left, top, width, height = viewer.picture_area
        imgui.set_next_window_pos(
            imgui.ImVec2(left + em(0.8), top + height - em(0.8)), 0, imgui.ImVec2(0.0, 1.0)
        )
        imgui.set_next_window_size_constraints(
            imgui.ImVec2(0.0, 0.0), imgui.ImVec2(max(width - em(1.6), 50.0), em(20))
        )
        flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_decoration
        imgui.begin("##message", None, flags | imgui.WindowFlags_.no_focus_on_appearing)
        imgui.push_text_wrap_pos(min(width - em(2.4), em(46)))
        theme = viewer.gui.theme
        if self.is_error:
            imgui.text_colored(colour(theme.error), self.text)
        else:
            imgui.text_unformatted(self.text)
        imgui.pop_text_wrap_pos()
        if imgui.is_window_hovered() and imgui.is_mouse_clicked(0):
            self.text = ""
        imgui.end()
        viewer.gui.places["message"] = (left, top, left + width, top + height)

    @property
    def is_fading(self) -> bool:
        """Whether it goes away by itself."""
        return bool(self.text) and not self.is_error


class Question:
    """Asks before work is lost: save it, lose it, or go back."""

    def __init__(self) -> None:
        self._then: Callable[[], None] | None = None
        self._doing = ""

    @property
    def is_open(self) -> bool:
        """Whether an answer is awaited."""
        return self._then is not None

    def before(self, viewer: Viewer, doing: str, then: Callable[[], None]) -> None:
        """Go on with `then` at once, or when what is unsaved was saved or given up.

        doing: the word for it, as "Close".
        """
        if viewer.session.unsaved:
            self._then, self._doing = then, doing
        else:
            then()

    def draw(self, viewer: Viewer) -> None:
        """Draw the question, if there is one."""
        then, doing = self._then, self._doing
        if then is None:
            return
        if not imgui.is_popup_open(QUESTION):
            imgui.open_popup(QUESTION)
        is_open, _ = imgui.begin_popup_modal(QUESTION, None, imgui.WindowFlags_.always_auto_resize)
        if not is_open:
            return
        imgui.text(f"Not saved: {viewer.session.unsaved or 'nothing any more'}.")
        again = partial(self.before, viewer, doing, then)  # there may be more to save
        session = viewer.session
        choices: tuple[tuple[str, bool, Callable[[], None]], ...] = (
            ("Save recording ...", session.is_recording, partial(_save_recording, viewer, again)),
            (
                "Save script" if session.file.path else "Save script ...",
                session.script_is_unsaved and not session.is_recording,
                partial(commands.save_script, viewer, again),
            ),
            ("Save pose ...", session.has_unsaved_pose, partial(commands.save_pose, viewer, again)),
            (f"{doing} without saving", True, then),
            ("Back", True, lambda: None),
        )
        for label, is_offered, run in choices:
            if not is_offered:
                continue
            is_clicked = imgui.button(label)
            viewer.gui.remember(f"question: {label}")
            imgui.same_line()
            if is_clicked or (label == "Back" and imgui.is_key_pressed(imgui.Key.escape)):
                self._then = None
                imgui.close_current_popup()
                run()
        imgui.end_popup()


def _save_recording(viewer: Viewer, then: Callable[[], None]) -> None:
    commands.toggle_recording(viewer)
    commands.save_script(viewer, then)


def draw_help(viewer: Viewer, actions: Sequence[Action]) -> bool:
    """The sheet of keys and mouse, scrolled where the window is small; whether it stays open."""
    display = imgui.get_io().display_size
    imgui.set_next_window_pos(
        imgui.ImVec2(0.5 * display.x, 0.5 * display.y), 0, imgui.ImVec2(0.5, 0.5)
    )
    imgui.set_next_window_size_constraints(imgui.ImVec2(0.0, 0.0), display)
    flags = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_collapse
    flags |= imgui.WindowFlags_.horizontal_scrollbar
    _, stays = imgui.begin("Keys and mouse (F1)", True, flags)
    with_keys = [action for action in actions if action.key]
    lines: dict[str, list[tuple[str, str]]] = {action.menu: [] for action in with_keys}
    for action in with_keys:
        key = ", ".join(filter(None, (action.shown_key, action.other_key)))
        lines[action.menu].append((key, action.label))
    lines |= {"Mouse": list(MOUSE), "Timeline": list(TIMELINE)}
    is_wide = display.x > em(HELP_WIDTH)
    for index, menus in enumerate(HELP_COLUMNS if is_wide else HELP_COLUMNS_NARROW):
        if index:
            imgui.same_line(0.0, em(1.5))
        imgui.begin_group()
        for menu in menus:
            imgui.text_colored(colour(viewer.gui.theme.muted), menu)
            _draw_lines(viewer, menu, lines.get(menu, []))
        imgui.end_group()
    place, size = imgui.get_window_pos(), imgui.get_window_size()
    viewer.gui.places["help"] = (place.x, place.y, place.x + size.x, place.y + size.y)
    imgui.end()
    return bool(stays) and not imgui.is_key_pressed(imgui.Key.escape)


def _draw_lines(viewer: Viewer, name: str, lines: Sequence[tuple[str, str]]) -> None:
    """What to press in one column, what it does in another."""
    flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
    if imgui.begin_table(name, 2, flags):
        for key, meaning in lines:
            imgui.table_next_column()
            imgui.text_colored(colour(viewer.gui.theme.accent), key)
            imgui.table_next_column()
            imgui.text(meaning)
        imgui.end_table()
