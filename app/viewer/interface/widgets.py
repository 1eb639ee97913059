"""Small parts of panels: headings, buttons, sliders, hints, shortened words."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from imgui_bundle import imgui

from ...control_names import readable, sentence
from ...text import as_text
from .gui import LEFT_BUTTON, RIGHT_BUTTON, Gui, colour, em, ink_of

# Colours of the knob and number of imgui's sliders; bars replace both.
HIDDEN_COLOURS = (imgui.Col_.slider_grab, imgui.Col_.slider_grab_active, imgui.Col_.text)


class SliderState(NamedTuple):
    """The changes of a slider in this frame."""

    value: float
    is_changed: bool
    is_done: bool  # whether a change is complete: released or typed
    is_hovered: bool
    is_right_clicked: bool = False  # only if the slider has a menu


def slider(
    gui: Gui,
    name: str,
    value: float,
    limits: tuple[float, float],
    *,
    width: float,
    neutral: float = 0.0,
    digits: int = 2,
    mark: str = "",
    has_menu: bool = False,
) -> SliderState:
    """Draw the slider `name`; a double or Ctrl click types a number, a right click resets.

    mark: text at the left end. has_menu: a right click does not reset, but opens the caller's menu.
    """
    io = imgui.get_io()
    label = f"##{name}"
    is_typed = imgui.internal.temp_input_is_active(imgui.get_id(label))
    has_ctrl = io.key_ctrl
    hidden = () if is_typed else HIDDEN_COLOURS
    imgui.set_next_item_width(width)
    imgui.push_style_var(imgui.StyleVar_.grab_min_size, 1.0)
    for index in hidden:
        imgui.push_style_color(index, 0)
    io.key_ctrl = has_ctrl or imgui.is_mouse_double_clicked(
        LEFT_BUTTON
    )  # imgui needs Ctrl for typing
    flags = imgui.SliderFlags_.always_clamp
    is_changed, now = imgui.slider_float(label, value, *limits, f"%.{digits}f", flags)
    io.key_ctrl = has_ctrl
    imgui.pop_style_color(len(hidden))
    imgui.pop_style_var()
    gui.remember(name)
    is_done = imgui.is_item_deactivated_after_edit()
    is_hovered = imgui.is_item_hovered()
    if not is_typed:
        _draw_bar(gui, now, limits, mark, digits)
    is_right_clicked = is_hovered and imgui.is_mouse_clicked(RIGHT_BUTTON)
    if is_right_clicked and not has_menu:
        return SliderState(neutral, neutral != value, True, True)
    is_pointed = is_hovered or imgui.is_item_active()
    return SliderState(now, is_changed, is_done, is_pointed, is_right_clicked)


def _draw_bar(gui: Gui, value: float, limits: tuple[float, float], mark: str, digits: int) -> None:
    """Draw the last slider as a bar that is filled from 0, with its number at the end."""
    theme = gui.theme
    paper = imgui.get_window_draw_list()
    padding = em(0.3)
    low = imgui.get_item_rect_min()
    high = imgui.get_item_rect_max()
    least, most = limits
    ends = sorted((value, min(max(0.0, least), most)))
    first, last = (low.x + (high.x - low.x) * (end - least) / (most - least) for end in ends)
    fill = ink_of(theme.accent, 0.6 if first < last else 0.0)
    paper.add_rect_filled((first, low.y), (last, high.y), fill, imgui.get_style().frame_rounding)
    number = f"{value:.{digits}f}" if value else "0"
    end = high.x - padding - imgui.calc_text_size(number).x
    ink = ink_of(theme.text if value else theme.muted)
    paper.push_clip_rect(low, high, True)
    if low.x + 2.0 * padding + imgui.calc_text_size(mark).x > end:
        mark = ""
    for text, x in ((number, end), (mark, low.x + padding)):
        paper.add_text((x, low.y + imgui.get_style().frame_padding.y), ink, text)
    paper.pop_clip_rect()


# Headings that are open until a user folds them.
OPEN_HEADINGS = frozenset({"Expressions", "Wave", "Refinement", "Style", "Anatomy"})


def heading(
    gui: Gui, folds: dict[str, bool], title: str, label: str = "", *, must_open: bool = False
) -> bool:
    """Draw a heading that the user can fold; return whether it is open.

    folds: title -> whether the heading is open, for headings that a user has opened or folded.
    label: displayed text, by default the title. must_open: opens the heading for now, for example
        during a search.
    """
    was_open = must_open or folds.get(title, title in OPEN_HEADINGS)
    imgui.set_next_item_open(was_open)
    is_open = imgui.collapsing_header(f"{label or title}###{title}")
    gui.remember(title)
    if is_open != was_open and not must_open:
        folds[title] = is_open
    return is_open


def button(
    gui: Gui,
    label: str,
    *,
    name: str = "",
    width: float = 0.0,
    meaning: str = "",
    highlight: Any = None,
) -> bool:
    """Draw a button; return whether it was clicked.

    name: the name for its stored place, by default its label. width: [window units], 0 for the
    label's width. meaning: a hint, see `Gui.with_keys`.
    highlight: the button's colour, None for the usual colour.
    """
    if highlight is not None:
        imgui.push_style_color(imgui.Col_.button, highlight)
    is_clicked = imgui.button(label, (width, 0.0))
    if highlight is not None:
        imgui.pop_style_color()
    gui.remember(name or label)
    hint(gui.with_keys(meaning))
    return bool(is_clicked)


@contextlib.contextmanager
def dialog(title: str, width: float = 0.0, height: float = 0.0) -> Iterator[bool]:
    """Begin a dialog in the middle of the window; yield whether it is open.

    The `with` block ends it by `imgui.close_current_popup`. width, height: [em], 0 for the
    content's size.
    """
    display = imgui.get_io().display_size
    if not imgui.is_popup_open(title):
        imgui.open_popup(title)
    imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
    flags = imgui.WindowFlags_.always_auto_resize
    if width:
        size = min(em(width), display.x), min(em(height), display.y)
        imgui.set_next_window_size(size)
        flags = imgui.WindowFlags_.no_resize
    is_open = bool(imgui.begin_popup_modal(title, None, flags)[0])
    try:
        yield is_open
    finally:
        if is_open:
            imgui.end_popup()


def choose(
    gui: Gui,
    label: str,
    present: str,
    choices: Iterable[str],
    in_words: Callable[[str], str] = readable,
) -> str | None:
    """Draw a list with imgui's current width; return a choice made in this frame, or None.

    in_words: returns the displayed text of a choice.
    """
    chosen = None
    flags = imgui.ComboFlags_.height_largest
    is_open = imgui.begin_combo(f"##{label}", in_words(present), flags)
    gui.remember(label)
    if is_open:
        for choice in choices:
            if imgui.selectable(in_words(choice), choice == present)[0]:
                chosen = choice
            gui.remember(f"{label}: {choice}")
        imgui.end_combo()
    return chosen


class LabelledRows:
    """Draws rows of a panel: a label with a hint, then a list, a slider or another widget."""

    def __init__(self, gui: Gui, share: float, hints: Mapping[str, str]) -> None:
        """share: fraction of the panel's width for labels. hints: label -> hint."""
        self._gui = gui
        self._share = share
        self.hints = dict(hints)

    @property
    def second_column(self) -> float:
        """Left end of the second column, from the left edge of the panel [window units]."""
        return float(self._share * imgui.get_window_width())

    def begin(self, label: str) -> None:
        """Draw a label; the next item takes the rest of the row."""
        imgui.align_text_to_frame_padding()
        imgui.text(readable(label))
        self.end(label)
        imgui.same_line(self.second_column)
        imgui.set_next_item_width(-1.0)

    def end(self, label: str) -> None:
        """Show the hint of a label while the mouse is on the last item."""
        hint(self._gui.with_keys(self.hints.get(label, "")))

    def choose(self, label: str, present: str, choices: Iterable[str]) -> str | None:
        """Draw a row with a list; return a choice made in this frame, or None."""
        self.begin(label)
        return choose(self._gui, label, present, choices)

    def slider_row(
        self,
        label: str,
        name: str,
        value: float,
        limits: tuple[float, float],
        neutral: float,
        *,
        digits: int = 2,
    ) -> float:
        """Draw a row with a slider; return its value."""
        self.begin(label)
        slid = slider(self._gui, name, value, limits, width=-1.0, neutral=neutral, digits=digits)
        return slid.value if slid.is_changed else value


def button_width(label: str) -> float:
    """Return the width of a button with this label [window units]."""
    return float(imgui.calc_text_size(label).x + 2.0 * imgui.get_style().frame_padding.x)


def hint(text: str) -> None:
    """Show a hint for the last drawn item while the mouse is on it."""
    if text and imgui.is_item_hovered(imgui.HoveredFlags_.allow_when_disabled):
        imgui.begin_tooltip()
        imgui.push_text_wrap_pos(em(24))
        imgui.text_unformatted(sentence(as_text(text)))
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def muted(gui: Gui, text: str) -> None:
    """Draw text in a fainter colour."""
    imgui.text_colored(colour(gui.theme.muted), as_text(text))


def shortened(text: str, room: float, *, keeps_end: bool = False) -> str:
    """Shorten a text to a width [window units]; keep its beginning, or with `keeps_end` its end."""
    cut = text = as_text(text)
    for lost in range(1, len(text) + 1):
        if imgui.calc_text_size(cut).x <= room:
            return cut
        cut = f"..{text[lost:]}" if keeps_end else f"{text[:-lost]}.."
    return ""


def stay_in_line(width: float) -> None:
    """Draw the next item beside the last one if its width fits there."""
    spacing = imgui.get_style().item_spacing.x
    right = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + spacing + width <= right:
        imgui.same_line()
