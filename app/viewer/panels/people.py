"""The list of persons, each with a picture, a name, sex and age."""

from __future__ import annotations

from functools import partial

from imgui_bundle import imgui

from risorius.assets.identities import NAMED_PERSONS

from ...scenes import BUILT_IN, COARSE_NAME, OWN_HEAD, head_in_words
from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..interface.gui import em, ink_of
from .display_rows import DisplayRows


class PeopleList:
    """The list of persons, and the button that opens it."""

    def __init__(self, app: ApplicationContext, file_drop: FileDrop, rows: DisplayRows) -> None:
        """rows: the panel's rows, among them the button."""
        self._gui = app.gui
        self._messages = app.messages
        self._portraits = app.portraits
        self._file_drop = file_drop
        self._rows = rows

    def draw(self, called: str) -> None:
        """Draw the row. called: name or number of the visible head."""
        present = int(called) if called.isdecimal() else called
        people: list[int | str] = [BUILT_IN, COARSE_NAME, *NAMED_PERSONS]
        people += range(20)  # and persons without names
        if present not in (*people, OWN_HEAD):
            people.append(present)
        self._portraits.begin(people)
        self._rows.begin("Person")
        height = em(2.8)
        if imgui.button("##Person", (-1.0, height)):
            imgui.open_popup("people")
        self._gui.remember("Person")
        self._rows.end("Person")
        self._fill(present)
        left = imgui.get_item_rect_min().x
        imgui.set_next_window_pos((left, imgui.get_item_rect_max().y))
        cell = em(11.5), height
        most_columns = 4  # so that the list fits on a small screen
        room = imgui.get_io().display_size.x - left - em(2.0)
        columns = min(max(int(room / (cell[0] + em(0.5))), 1), most_columns)
        if imgui.begin_popup("people"):
            for index, who in enumerate(people):
                if index % columns:
                    imgui.same_line()
                self._draw_choice(who, present, cell)
            imgui.end_popup()

    def _draw_choice(self, who: int | str, present: int | str, cell: tuple[float, float]) -> None:
        """Draw a person of the list, as a button; cell: width and height [window units]."""
        is_clicked, _ = imgui.selectable(f"##{who}", who == present, 0, cell)
        self._gui.remember(f"Person: {in_words(who)}")
        self._fill(who)
        if is_clicked:
            shown = None if who == BUILT_IN else who
            self._messages.carry_out(partial(self._file_drop.show_person, shown))

    def _fill(self, who: int | str) -> None:
        """Draw a person's picture and description over the last item."""
        low = imgui.get_item_rect_min()
        high = imgui.get_item_rect_max()
        side = high.y - low.y
        paper = imgui.get_window_draw_list()
        picture = self._portraits.picture_of(who)
        if picture is not None:
            paper.add_image_rounded(
                picture,
                low,
                (low.x + side, high.y),
                (0.0, 0.0),
                (1.0, 1.0),
                ink_of((1.0,) * 3),
                3.0,
            )
        name, _, about = in_words(who).partition(", ")
        theme = self._gui.theme
        x = low.x + side + em(0.4)
        middle = 0.5 * (low.y + high.y)
        line = imgui.get_text_line_height()
        top = middle - (line if about else 0.5 * line)
        paper.push_clip_rect(low, high, True)
        paper.add_text((x, top), ink_of(theme.text), name)
        paper.add_text((x, top + line), ink_of(theme.muted), about)
        paper.pop_clip_rect()


def in_words(who: int | str) -> str:
    """Describe a person in the list, such as "Person 7, woman, about 60"."""
    if who == OWN_HEAD:
        return "Own head"
    if who == BUILT_IN:
        return "Built-in"
    return head_in_words(who)
