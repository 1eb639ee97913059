"""The controls of the face: pads, a group for each layer and region, a row for each control.

The muscle that is clicked in the picture has its slider beside the mouse, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from imgui_bundle import imgui

from ...controls.mirror import twin_of
from ...controls.vocabulary import Pad, called, filters, pads
from ..context import ApplicationContext
from ..interface.gui import LEFT, NOTE_FLAGS, RIGHT, colour, em, ink_of
from ..interface.widgets import button, button_width, heading, hint, muted, slider, stay_in_line
from .pose_grid import PoseGrid
from .rows import ControlRows, Row, search_rows

PAD_HEIGHT, DOT = 4.6, 0.32  # [em] of a field, and half of the dot in it


class Pads:
    """Draws those for which the scene has controls."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._session = app.gui, app.session
        self._is_reset = False  # by the press that goes on

    def draw(self) -> None:
        """All of them beside each other."""
        known, spacing = self._session.controls.limits.keys(), imgui.get_style().item_spacing.x
        shown = [pad for pad in pads() if {pad.across, pad.along} <= known]
        room = imgui.get_content_region_avail().x + spacing
        for index, pad in enumerate(shown):
            if index:
                imgui.same_line()
            self._draw_pad(pad, max(room / len(shown) - spacing, 1.0))

    def _draw_pad(self, pad: Pad, width: float) -> None:
        imgui.invisible_button(f"pad {pad.title}", (width, em(PAD_HEIGHT)))
        self._gui.remember(f"pad {pad.title}")
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        mouse = imgui.get_mouse_pos()
        is_held, is_back = imgui.is_item_active(), imgui.is_item_clicked(RIGHT)
        if imgui.is_item_clicked(LEFT):
            self._is_reset = imgui.get_mouse_clicked_count(LEFT) > 1
        if is_back or (is_held and self._is_reset):
            self._move(pad, 0.0, 0.0)
        elif is_held:
            down = min(max((mouse.y - low.y) / (high.y - low.y), 0.0), 1.0)
            across = 2.0 * (mouse.x - low.x) / (high.x - low.x) - 1.0
            self._move(pad, across, pad.top + down * (pad.bottom - pad.top))
        else:
            hint(f"{pad.title}: {pad.meaning}\na double click takes it back")
        if is_back or imgui.is_item_deactivated():
            self._session.note()
        self._paint(pad, low, high)

    def _move(self, pad: Pad, across: float, along: float) -> None:
        self._session.set(pad.across, across)
        self._session.set(pad.along, along)

    def _paint(self, pad: Pad, low: imgui.ImVec2, high: imgui.ImVec2) -> None:
        theme, paper, current = self._gui.theme, imgui.get_window_draw_list(), self._session.current
        is_lit, margin = imgui.is_item_hovered() or imgui.is_item_active(), em(DOT)
        across, along = current[pad.across], current[pad.along]
        ink = theme.accent if across or along else theme.muted
        inks = ((theme.raised if is_lit else theme.field, 1.0), (theme.muted, 0.35), (ink, 1.0))
        back, faint, full = (ink_of(*shade) for shade in inks)

        def place(across: float, along: float) -> tuple[float, float]:
            down = (along - pad.top) / (pad.bottom - pad.top)
            x = low.x + margin + (0.5 + 0.5 * across) * (high.x - low.x - 2.0 * margin)
            return x, low.y + margin + down * (high.y - low.y - 2.0 * margin)

        rest, now = place(0.0, 0.0), place(across, along)
        paper.add_rect_filled(low, high, back, imgui.get_style().frame_rounding)
        paper.add_line((rest[0], low.y), (rest[0], high.y), faint)
        paper.add_line((low.x, rest[1]), (high.x, rest[1]), faint)
        paper.add_text((low.x + margin, high.y - em(1.2)), full, pad.title)
        paper.add_line(rest, now, full, em(0.12))
        paper.add_circle_filled(now, margin, full)


NOTE_WIDTH = 12.0  # [em] of the slider


class MuscleNote:
    """A note that a click elsewhere or Escape takes away."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._session = app.gui, app.session
        self._settings, self._view = app.settings, app.view
        self.name = ""  # of the muscle, "" for none

    def draw(self) -> None:
        """Draw the note, if there is one; it comes up below the mouse."""
        session, name, twin = self._session, self.name, twin_of(self.name)
        if name not in session.values:
            return
        mouse, display = imgui.get_mouse_pos(), imgui.get_io().display_size
        place = min(mouse.x + em(), display.x - em(NOTE_WIDTH + 2.0)), mouse.y + em()
        imgui.set_next_window_pos(place, imgui.Cond_.appearing)
        imgui.begin("##muscle", None, NOTE_FLAGS)
        values, limits = session.current, session.controls.limits[name]
        is_linked = self._settings.is_linked and twin != name and values[name] == values[twin]
        names = (name, twin) if is_linked else (name,)
        imgui.text_unformatted(called(*names).capitalize())
        slid = slider(self._gui, name, values[name], limits, width=em(NOTE_WIDTH))
        self._gui.places["note"] = self._gui.places[name]
        if slid.is_changed:
            session.set(name, slid.value, linked=is_linked)
        if slid.is_done:
            session.note()
        imgui.push_text_wrap_pos(em(NOTE_WIDTH + 0.5))
        muted(self._gui, session.scene.actions.get(name, ""))
        imgui.pop_text_wrap_pos()
        is_on = imgui.is_window_hovered(imgui.HoveredFlags_.allow_when_blocked_by_active_item)
        imgui.end()
        if is_on or not self._view.pointed:  # as long as the note is there
            self._view.pointed = dict.fromkeys(names, 1.0)
        is_left = imgui.is_mouse_clicked(LEFT) and not is_on
        is_typing = imgui.get_io().want_text_input
        if is_left or (imgui.is_key_pressed(imgui.Key.escape) and not is_typing):
            self.name = ""


FLASH = 90  # frames for which a selected slider is marked
LEAST_ROOM = 20.0  # [em] below buttons and search
IN_USE = "In use"  # a filter of all groups


class FacePanel:
    """Buttons, search, filters and groups of rows."""

    def __init__(self, app: ApplicationContext, poses: PoseGrid) -> None:
        self._gui, self._session, self._settings = app.gui, app.session, app.settings
        self.rows, self._pads, self.poses = ControlRows(app), Pads(app), poses
        self.search = ""
        self.filter = ""  # the groups that are shown alone, by what their button reads
        self._in_use: set[str] = set()  # labels of rows
        self._selected: str | None = None  # to be scrolled to
        self._flash = 0

    def select(self, name: str) -> None:
        """Open the group of a control, scroll to it and mark it."""
        self.search = self.filter = ""
        self._selected, self._flash = name, FLASH

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        self._draw_buttons()
        has_room = imgui.get_content_region_avail().y > em(LEAST_ROOM)
        if has_room:
            self._draw_filters()
        imgui.begin_child("controls", (0.0, 0.0), imgui.ChildFlags_.nav_flattened)
        if not has_room:  # they scroll
            self._draw_filters()
        session, groups = self._session, self._session.controls.groups
        shown = filters().get(self.filter, tuple(groups))
        if not self.search and self.filter != IN_USE and {"Jaw", "Gaze"} & {*shown}:
            self._pads.draw()
        if not (self.search or self.filter) and session.scene.expressions:
            if heading(self._gui, self._settings.folds, "Pose pictures", "Poses"):
                self.poses.draw()
        counts = [self._draw_group(title, groups[title]) for title in groups if title in shown]
        if not any(counts):
            is_rest = self.filter == IN_USE and not self.search
            muted(self._gui, "Nothing is in use." if is_rest else "Nothing has such a name.")
        imgui.end_child()
        self._flash = max(self._flash - 1, 0)

    def _draw_buttons(self) -> None:
        gui, session, settings = self._gui, self._session, self._settings
        buttons: tuple[tuple[str, str, Callable[[], None]], ...] = (
            ("Neutral", "relax all ([Neutral])", session.neutral),
            ("Mirror", "exchange left and right ([Mirror]), see Edit, too", session.mirror),
            ("Random", "a face by chance ([Random])", session.randomise),
        )
        for label, meaning, run in buttons:
            if label != "Neutral":
                stay_in_line(button_width(label))
            if button(gui, label, meaning=meaning):
                run()
        stay_in_line(imgui.get_frame_height() + imgui.calc_text_size("  Link sides").x)
        _, settings.is_linked = imgui.checkbox("Link sides", settings.is_linked)
        gui.remember("Link sides")
        hint("left and right move together")
        imgui.set_next_item_width(-1.0)
        _, self.search = imgui.input_text_with_hint(
            "##search", "Search: smile, AU12, lid ...", self.search
        )
        gui.remember("search")

    def _draw_filters(self) -> None:
        """A button for each kind of control, which shows that kind alone; a second click all."""
        groups = self._session.controls.groups
        kinds = [title for title, titles in filters().items() if groups.keys() & {*titles}]
        for title in [IN_USE, *kinds] if kinds else ():
            if title != IN_USE:
                stay_in_line(button_width(title))
            is_on = self.filter == title
            highlight = colour(self._gui.theme.accent, 0.5) if is_on else None
            if button(self._gui, title, name=f"only {title}", highlight=highlight):
                self.filter = "" if is_on else title

    def _draw_group(self, title: str, names: Sequence[str]) -> int:
        """Draw a group under its heading; how many rows it has that are asked for."""
        session, folds, current = self._session, self._settings.folds, self._session.current
        rows = self.rows.of(tuple(names))
        active = sum(any(current[name] for name in row.names) for row in rows)
        if self.filter == IN_USE:
            rows = [row for row in rows if self._is_in_use(row)]
        if self.search:
            rows = search_rows(rows, self.search, group=title, actions=session.scene.actions)
        elif self._selected in names:
            folds[title] = True
        if not rows:
            return 0
        label = f"{title}  ({active})" if active else title
        must_open = bool(self.search or self.filter)
        if heading(self._gui, folds, title, label, must_open=must_open):
            for row in rows:
                self._draw_row(row)
        return len(rows)

    def _is_in_use(self, row: Row) -> bool:
        """Whether it is not 0, or was when the drag began that takes it there."""
        if any(self._session.current[name] for name in row.names):
            self._in_use.add(row.label)
        elif not imgui.is_any_item_active():
            self._in_use.discard(row.label)
        return row.label in self._in_use

    def _draw_row(self, row: Row) -> None:
        # A muscle whose halves act together may have but one bar for both.
        whole = (self._selected or "").removesuffix("_left").removesuffix("_right")
        is_selected = bool({self._selected, whole} & {*row.names, *row.sides})
        if is_selected:
            imgui.set_scroll_here_y(0.4)
        shown = self._session.scene.expressions[:9]
        number = shown.index(row.label) + 1 if row.label in shown else 0
        self.rows.draw(row, number=number, is_marked=is_selected and self._flash > 0)
        if is_selected and not self._flash:
            self._selected = None
