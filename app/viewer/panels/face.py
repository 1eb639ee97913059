"""The controls of the face: a group for each layer and region, a row for each control."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

from ..context import ApplicationContext
from ..interface.widgets import button, button_width, heading, hint, muted, stay_in_line
from .rows import ControlRows, Row, search_rows

FLASH = 90  # frames for which a selected slider is marked


class FacePanel:
    """Buttons, search, and groups of rows."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui, self._session, self._settings = app.gui, app.session, app.settings
        self.rows = ControlRows(app)
        self.search = ""
        self._selected: str | None = None  # to be scrolled to
        self._flash = 0

    def select(self, name: str) -> None:
        """Open the group of a control, scroll to it and mark it."""
        self.search = ""
        self._selected, self._flash = name, FLASH

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        self._draw_buttons()
        imgui.begin_child("controls", (0.0, 0.0), imgui.ChildFlags_.nav_flattened)
        groups = self._session.controls.groups
        counts = [self._draw_group(title, names) for title, names in groups.items()]
        if not any(counts):
            muted(self._gui, "Nothing has such a name.")
        imgui.end_child()
        self._flash = max(self._flash - 1, 0)

    def _draw_buttons(self) -> None:
        gui, session, settings = self._gui, self._session, self._settings
        if button(gui, "Neutral", meaning="relax all ([Neutral])"):
            session.neutral()
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
        """Draw a group under its heading; how many rows it has that are asked for."""
        session, folds, current = self._session, self._settings.folds, self._session.current
        rows = self.rows.of(tuple(names))
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
