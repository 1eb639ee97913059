"""The controls of the face: a group of rows for each layer and region.

A row has the name of one control, or of one control for each side, and a bar for each control.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_

from imgui_bundle import imgui

from ...control_names import (
    ONE_MOTION_BASES,
    is_found,
    readable,
    split_side,
    title_of,
    twin_of,
    words_of_group,
)
from ..context import ApplicationContext
from ..interface.commands import Command, command_button
from ..interface.gui import em, ink_of
from ..interface.widgets import button, button_width, heading, hint, muted, slider, stay_in_line
from ..messages import Task
from ..timeline.keys import KeySelection, listed, movers_of


@dataclass(frozen=True)
class ControlRow:
    """One row: the shared name of its controls, and the controls with bars.

    names: the controls with bars, in the order: both sides, subject's right side, left side.
    sides: two controls that can be linked, or (); with is_linked, the left bar moves both.
    """

    label: str
    names: tuple[str, ...]
    sides: tuple[str, ...] = ()
    is_linked: bool = False

    @classmethod
    def of_sides(
        cls,
        label: str,
        sides: tuple[str, str],
        whole: str,
        values: Mapping[str, float],
        linked: bool,
    ) -> ControlRow:
        """Return a row for both sides, with one bar if they are linked and equal.

        whole: the control for both sides, or ""; has a bar if no side has one, or if it is not 0.
        """
        is_linked = linked and values[sides[0]] == values[sides[1]]
        if not is_linked:
            apart: tuple[str, ...] = sides
        elif values[sides[1]] or not whole:
            apart = sides[1:]
        else:
            apart = ()
        first = (whole,) if whole and (not apart or values[whole]) else ()
        return cls(label, (*first, *apart), sides, is_linked)


def rows_of(names: Sequence[str], values: Mapping[str, float], *, linked: bool) -> list[ControlRow]:
    """Return the rows of a group.

    linked: whether both sides share a bar while they are equal. While they are 0, a control for
    both sides (AU12 for AU12_left and AU12_right) has the bar instead.
    """
    known = set(names)
    rows = []
    for name in names:
        base, side = split_side(name)
        twin = twin_of(name)
        if not side:
            sides = (f"{name}_right", f"{name}_left")
            if split_side(twin)[0] == name != twin:  # a control for one side, such as a wink
                rows.append(ControlRow(name, (twin, name)))
            elif not known.issuperset(sides):
                rows.append(ControlRow(name, (name,)))
            else:
                rows.append(ControlRow.of_sides(name, sides, name, values, linked))
        elif base in ONE_MOTION_BASES or twin not in known:
            rows.append(ControlRow(name, (name,)))
        elif base not in known and side in ("_left", "Left"):
            whole = base if values.get(base) else ""  # set by a script, and in no group
            rows.append(ControlRow.of_sides(base, (twin, name), whole, values, linked))
    return rows


def search_rows(
    rows: Iterable[ControlRow], query: str, *, group: str, actions: Mapping[str, str]
) -> list[ControlRow]:
    """Return the rows in which all words of the query occur.

    Words are searched in names, groups, actions of controls, and synonyms.
    """
    return [row for row in rows if is_found(query, _text_of(row, group, actions), row.names)]


def _text_of(row: ControlRow, group: str, actions: Mapping[str, str]) -> str:
    action = actions.get(row.names[-1], "")
    names = " ".join((row.label, *row.names, *row.sides))
    groups = (group, words_of_group(group))
    return " ".join((names, readable(names), *title_of(row.label, action), *groups, action))


class ControlRows:
    """Draws rows of controls, and sets controls as the user moves their bars."""

    def __init__(self, app: ApplicationContext, selection: KeySelection) -> None:
        """selection: the selected keys, which the menu of a bar changes."""
        self._gui = app.gui
        self._session = app.session
        self._settings = app.settings
        self._messages = app.messages
        self._view = app.view
        self._selection = selection
        self._asked: tuple[str, ...] = ()  # the controls whose menu is open
        self._rows: dict[tuple[str, ...], list[ControlRow]] = {}

    def rows_for(self, names: tuple[str, ...]) -> list[ControlRow]:
        """Return the rows of these controls; during a drag, the rows from its beginning."""
        if names not in self._rows or not imgui.is_any_item_active():
            current = self._session.current
            linked = self._settings.is_linked
            self._rows[names] = rows_of(names, current, linked=linked)
        return self._rows[names]

    def draw(self, row: ControlRow, *, number: int = 0, is_marked: bool = False) -> None:
        """Draw one row; the name of an expression is also a button.

        number: the number key that shows the expression, or 0. is_marked: highlights the row.
        """
        session = self._session
        names = row.names
        spacing = imgui.get_style().item_spacing
        current = session.current
        left = imgui.get_cursor_pos_x()
        room = imgui.get_content_region_avail().x
        is_narrow = room < em(15.0)  # bars stand under their names
        label_room = room if is_narrow else min(0.5 * room, em(15.0))
        is_lit = is_marked or any(current[name] for name in names)
        pointed = names if self._draw_label(row, label_room, number, is_lit=is_lit) else ()
        if is_narrow:  # draws bars nearer to their own name than to the next
            imgui.set_cursor_pos_y(imgui.get_cursor_pos_y() - spacing.y)
        else:
            imgui.same_line(left + label_room)
        room = imgui.get_content_region_avail().x
        width = (room + spacing.x) / len(names) - spacing.x
        for index, name in enumerate(names):
            if index:
                imgui.same_line()
            limits = session.controls.limits[name]
            side = split_side(name)[1].strip("_")[:1].upper()
            is_of_both = not side and len(row.sides) > 0
            mark = "" if is_of_both or len(names) == 1 else side or "L"
            slid = slider(
                self._gui, name, current[name], limits, width=width, mark=mark, has_menu=True
            )
            pointed = (name,) if slid.is_hovered else pointed
            if slid.is_changed:
                session.set(name, slid.value, linked=row.is_linked and name in row.sides)
            if slid.is_done:
                session.note()
            if slid.is_right_clicked:
                is_linked = row.is_linked and name in row.sides
                self._asked = row.sides if is_linked else (name,)
                imgui.open_popup("control menu")
        self._draw_menu(row)
        if pointed:
            meant = (*pointed, *(row.sides if row.is_linked else ()))
            weights = (Counter(session.scene.moved_by(each)) for each in meant)
            self._view.pointed = reduce(or_, weights)  # the largest share of each muscle

    def _draw_menu(self, row: ControlRow) -> None:
        """Draw the menu of a bar, if it was opened in this row."""
        names = self._asked
        if not set(names) <= {*row.names, *row.sides} or not imgui.begin_popup("control menu"):
            return
        session = self._session
        selection = self._selection
        muted(self._gui, listed(names))
        if movers := movers_of(session.script, names[0]):
            muted(self._gui, f"moved by {movers}")
        has_track = any(name in session.script.tracks for name in names)
        has_key = bool(selection.keys_of(names))
        can_edit = selection.can_edit
        items: tuple[tuple[str, bool, Task], ...] = (
            ("Key this", can_edit, lambda: selection.key_controls(names)),
            ("Delete key", can_edit and has_key, lambda: selection.delete_keys_of(names)),
            ("Clear track", can_edit and has_track, lambda: selection.clear_tracks_of(names)),
            ("Reset to 0", True, lambda: self._reset(names)),
        )
        for label, is_possible, task in items:
            if imgui.menu_item(label, "", False, is_possible)[0]:
                self._messages.carry_out(task)
            self._gui.remember(f"control menu: {label}")
        if imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_popup()

    def _reset(self, names: Iterable[str]) -> None:
        for name in names:
            self._session.set(name, 0.0)
        self._session.note()

    def _draw_label(self, row: ControlRow, room: float, number: int, *, is_lit: bool) -> bool:
        """Draw code and name; return whether the mouse is on them."""
        theme = self._gui.theme
        session = self._session
        padding = imgui.get_style().frame_padding
        room -= em(0.3)
        action = session.scene.actions.get(row.names[-1], "")
        code, name = title_of(row.label, action)
        is_whole_face = row.label in session.scene.expressions
        widest = "AU00  " if code else ""
        if is_whole_face:  # its code is the key that shows it
            code = str(number or "")
            widest = "0 "
        indent = imgui.calc_text_size(widest).x if name else 0.0
        place = imgui.get_cursor_screen_pos()
        wrapped = room - indent - padding.x
        height = imgui.calc_text_size(name or code, wrap_width=wrapped).y + 2.0 * padding.y
        if not is_whole_face:
            imgui.dummy((room, height))
        else:
            is_solo = session.is_solo(row.label)
            if imgui.selectable(f"##show {row.label}", is_solo, 0, (room, height))[0]:
                session.toggle_solo(row.label)
        self._gui.remember(f"show {row.label}")
        is_pointed = imgui.is_item_hovered()
        hint("\n".join(filter(None, (readable(row.label), action))))
        shade = theme.accent if is_lit else theme.text
        for text, along in ((code, 0.0), (name, indent)):
            where = imgui.ImVec2(place.x + padding.x + along, place.y + padding.y)
            ink = ink_of(theme.muted if text == code and name else shade)
            imgui.get_window_draw_list().add_text(
                imgui.get_font(), imgui.get_font_size(), where, ink, text, wrap_width=wrapped
            )
        return is_pointed


class FacePanel:
    """Buttons, search, and groups of rows."""

    def __init__(
        self, app: ApplicationContext, selection: KeySelection, commands: Sequence[Command]
    ) -> None:
        """selection: the selected keys. commands: the commands that a search can find."""
        self._gui = app.gui
        self._session = app.session
        self._settings = app.settings
        self._messages = app.messages
        self._commands = [command for command in commands if command.words]
        self.rows = ControlRows(app, selection)
        self.search = ""
        self._selected: str | None = None  # name of a control to scroll to
        self._flash = 0

    def select(self, name: str) -> None:
        """Open the group of a control, scroll to it and mark it."""
        self.search = ""
        self._selected = name
        self._flash = 90  # number of frames that highlight the row

    def draw(self) -> None:
        """Draw the panel's content inside its window."""
        self._draw_buttons()
        imgui.begin_child("controls")
        has_command = self._draw_commands()
        groups = self._session.controls.groups
        counts = [self._draw_group(title, names) for title, names in groups.items()]
        if not (has_command or any(counts)):
            muted(self._gui, "Nothing has such a name.")
        imgui.end_child()
        self._flash = max(self._flash - 1, 0)

    def _draw_commands(self) -> bool:
        """Draw a button for each command that the search finds; return whether there are any."""
        least_length = 3  # letters: fewer occur in too many words
        if len(self.search) < least_length:
            return False
        found = [each for each in self._commands if is_found(self.search, each.words, ())]
        for command in found:
            name = f"found {command.label}"
            label = f"{command.menu} > Export > {command.label}"
            command_button(self._gui, self._messages, command, label, name=name, width=-1.0)
        return bool(found)

    def _draw_buttons(self) -> None:
        gui = self._gui
        session = self._session
        settings = self._settings
        if button(gui, "Neutral", meaning="relax all ([Neutral])"):
            session.neutral()
        if session.scene.face is not None:  # a plane has no sides
            stay_in_line(button_width("Mirror"))
            if button(gui, "Mirror", meaning="exchange left and right ([Mirror]), see Edit, too"):
                session.mirror()
            stay_in_line(imgui.get_frame_height() + imgui.calc_text_size("  Link sides").x)
            _, settings.is_linked = imgui.checkbox("Link sides", settings.is_linked)
            gui.remember("Link sides")
            hint("left and right move together")
        imgui.set_next_item_width(-1.0)
        _, self.search = imgui.input_text_with_hint(
            "##search", "Search: smile, AU12, lid ...", self.search
        )
        gui.remember("search")

    def _draw_group(self, title: str, names: Sequence[str]) -> int:
        """Draw a group under its heading; return how many rows the search finds."""
        session = self._session
        folds = self._settings.folds
        current = self._session.current
        rows = self.rows.rows_for(tuple(names))
        active = sum(any(current[name] for name in row.names) for row in rows)
        if self.search:
            rows = search_rows(rows, self.search, group=title, actions=session.scene.actions)
        elif self._selected in names:
            folds[title] = True
        if not rows:
            return 0
        label = f"{title}  ({active})" if active else title
        if heading(self._gui, folds, title, label, must_open=bool(self.search)):
            for row in rows:
                self._draw_row(row)
        return len(rows)

    def _draw_row(self, row: ControlRow) -> None:
        # A muscle whose halves act together may have only one bar.
        whole = (self._selected or "").removesuffix("_left").removesuffix("_right")
        is_selected = bool({self._selected, whole} & {*row.names, *row.sides})
        if is_selected:
            imgui.set_scroll_here_y(0.4)
        shown = self._session.scene.expressions[:9]
        number = shown.index(row.label) + 1 if row.label in shown else 0
        self.rows.draw(row, number=number, is_marked=is_selected and self._flash > 0)
        if is_selected and not self._flash:
            self._selected = None
