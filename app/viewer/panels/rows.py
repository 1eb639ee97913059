"""A control, or one of each side, as one line: its name, and a bar for each that it has."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from imgui_bundle import imgui

from ...controls.mirror import OPPOSITE, parted, twin_of
from ...controls.vocabulary import is_found, readable, title_of
from ..context import ApplicationContext
from ..interface.gui import em, ink_of
from ..interface.widgets import hint, slider


@dataclass(frozen=True)
class Row:
    """One line: what its controls are called alike, and those that it has bars for.

    names: of both sides at once before each side, the subject's right before the left. sides: what
    can be linked, () for nothing; with is_linked the left one's bar moves both.
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
    ) -> Row:
        """A row for both sides: one bar where they are linked and agree.

        whole: the control that stands for both, "" for none; it has a bar, too, where it is in use.
        """
        is_linked = linked and values[sides[0]] == values[sides[1]]
        apart = sides if not is_linked else sides[1:] if values[sides[1]] or not whole else ()
        first = (whole,) if whole and (not apart or values[whole]) else ()
        return cls(label, (*first, *apart), sides, is_linked)


def rows_of(names: Sequence[str], values: Mapping[str, float], *, linked: bool) -> list[Row]:
    """The rows of a group.

    linked: both sides share a bar as long as they agree. A control for both sides at once (AU12
    beside AU12_left and AU12_right) stands for them, unless one of them is in use.
    """
    known = set(names)
    rows = []
    for name in names:
        base, side = parted(name)
        twin = twin_of(name)
        if not side:
            sides = (f"{name}_right", f"{name}_left")
            if parted(twin)[0] == name != twin:  # of one side by itself, as a wink
                rows.append(Row(name, (twin, name)))
            elif not known.issuperset(sides):
                rows.append(Row(name, (name,)))
            else:
                rows.append(Row.of_sides(name, sides, name, values, linked))
        elif base in OPPOSITE or twin not in known:
            rows.append(Row(name, (name,)))
        elif base not in known and side in ("_left", "Left"):
            whole = base if values.get(base) else ""  # of no group; by a script
            rows.append(Row.of_sides(base, (twin, name), whole, values, linked))
    return rows


def search_rows(
    rows: Iterable[Row], query: str, *, group: str, actions: Mapping[str, str]
) -> list[Row]:
    """The rows in which all words of the query occur.

    In names, group, what a control does, or among other words for it.
    """
    return [row for row in rows if is_found(query, _text_of(row, group, actions), row.names)]


def _text_of(row: Row, group: str, actions: Mapping[str, str]) -> str:
    action = actions.get(row.names[-1], "")
    names = " ".join((row.label, *row.names, *row.sides))
    return " ".join((names, readable(names), *title_of(row.label, action), group, action))


LABEL_SHARE, MOST_LABEL = 0.5, 15.0  # of a row, and [em]
NARROW = 15.0  # [em] of room below which bars stand under their names


class ControlRows:
    """Draws rows of controls, and carries out what is done to them."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._session = app.gui, app.session
        self._settings, self._view = app.settings, app.view
        self._rows: dict[tuple[str, ...], list[Row]] = {}

    def of(self, names: tuple[str, ...]) -> list[Row]:
        """The rows of these controls as they are now, or as they were when a drag began."""
        if names not in self._rows or not imgui.is_any_item_active():
            current, linked = self._session.current, self._settings.is_linked
            self._rows[names] = rows_of(names, current, linked=linked)
        return self._rows[names]

    def draw(self, row: Row, *, number: int = 0, is_marked: bool = False) -> None:
        """Draw one row; of an expression the name is a button, too.

        number: of the key that shows it, 0 for none. is_marked: it was asked for.
        """
        session, names, spacing = self._session, row.names, imgui.get_style().item_spacing
        current = session.current
        left, room = imgui.get_cursor_pos_x(), imgui.get_content_region_avail().x
        is_narrow = room < em(NARROW)
        label_room = room if is_narrow else min(LABEL_SHARE * room, em(MOST_LABEL))
        is_lit = is_marked or any(current[name] for name in names)
        pointed = names if self._draw_label(row, label_room, number, is_lit=is_lit) else ()
        if is_narrow:  # nearer to its own name than to the next
            imgui.set_cursor_pos_y(imgui.get_cursor_pos_y() - spacing.y)
        else:
            imgui.same_line(left + label_room)
        width = (imgui.get_content_region_avail().x + spacing.x) / len(names) - spacing.x
        for index, name in enumerate(names):
            if index:
                imgui.same_line()
            limits, side = session.controls.limits[name], parted(name)[1].strip("_")[:1].upper()
            is_of_both = not side and len(row.sides) > 0
            mark = "" if is_of_both or len(names) == 1 else side or "L"
            slid = slider(self._gui, name, current[name], limits, width=width, mark=mark)
            pointed = (name,) if slid.is_hovered else pointed
            if slid.is_changed:
                session.set(name, slid.value, linked=row.is_linked and name in row.sides)
            if slid.is_done:
                session.note()
        if pointed:
            meant = (*pointed, *(row.sides if row.is_linked else ()))
            self._view.pointed = {
                muscle: share
                for each in meant
                for muscle, share in session.scene.moved_by(each).items()
            }

    def _draw_label(self, row: Row, room: float, number: int, *, is_lit: bool) -> bool:
        """Code and name; whether the mouse is on it."""
        theme, session, padding = self._gui.theme, self._session, imgui.get_style().frame_padding
        room -= em(0.3)
        action = session.scene.actions.get(row.names[-1], "")
        code, name = title_of(row.label, action)
        is_whole_face = row.label in session.scene.expressions
        code, widest = (str(number or ""), "0 ") if is_whole_face else (code, code and "AU00  ")
        indent = imgui.calc_text_size(widest).x if name else 0.0
        place, wrapped = imgui.get_cursor_screen_pos(), room - indent - padding.x
        height = imgui.calc_text_size(name or code, wrap_width=wrapped).y + 2.0 * padding.y
        if not is_whole_face:
            imgui.dummy((room, height))
        elif imgui.selectable(
            f"##show {row.label}", session.is_alone(row.label), 0, (room, height)
        )[0]:
            session.toggle_alone(row.label)
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
