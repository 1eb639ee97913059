"""The controls of the face: a group for each that the scene has, a slider for each control."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from imgui_bundle import imgui

from ..control_rows import Row, readable, rows_of, search_rows
from ..gui import Gui, colour
from ..session import Session
from ..settings import Settings
from ..view import View
from .sliders import Sliders
from .widgets import button, button_width, heading, hint, shortened, stay_in_line

LABEL_SHARE = 0.46  # of a row
FLASH = 90  # frames for which a selected slider is marked


class FacePanel:
    """Buttons, search and groups of sliders."""

    def __init__(self, gui: Gui, session: Session, settings: Settings, view: View) -> None:
        self._gui, self._session, self._settings, self._view = gui, session, settings, view
        self._sliders = Sliders(gui)
        self.search = ""
        self._selected: str | None = None  # to be scrolled to
        self._flash = 0
        self._current = session.current  # of the picture that is drawn

    def select(self, name: str) -> None:
        """Open the group of a control, scroll to it and mark it."""
        self.search = ""
        self._selected, self._flash = name, FLASH

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        self._current = self._session.current
        self._draw_buttons()
        imgui.begin_child("controls", (0.0, 0.0), imgui.ChildFlags_.nav_flattened)
        for title, names in self._session.controls.groups.items():
            self._draw_group(title, names)
        imgui.end_child()
        self._flash = max(self._flash - 1, 0)

    def _draw_buttons(self) -> None:
        gui, session, settings = self._gui, self._session, self._settings
        buttons: tuple[tuple[str, str, Callable[[], None]], ...] = (
            ("Neutral", "relax all (N)", session.neutral),
            ("Mirror", "exchange left and right (M)", session.mirror),
            ("Random", "a face by chance (X)", session.randomise),
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
            "##search", "search: smile, AU12, lid ...", self.search
        )
        gui.remember("search")

    def _draw_group(self, title: str, names: Sequence[str]) -> None:
        scene, folds = self._session.scene, self._settings.folds
        rows = rows_of(names, self._current, linked=self._settings.is_linked)
        if self.search:
            rows = search_rows(rows, self.search, group=title, actions=scene.actions)
            if not rows:
                return
        elif self._selected in names:
            folds[title] = True
        active = sum(1 for name in names if self._current[name])
        label = f"{title}  ({active})" if active else title
        if heading(self._gui, self._settings, title, label, must_open=bool(self.search)):
            if names and all(name in scene.expressions for name in names):
                self._draw_expression_buttons(names)
            for row in rows:
                self._draw_row(row)

    def _draw_expression_buttons(self, names: Sequence[str]) -> None:
        """A button for each: the whole expression at once."""
        for number, name in enumerate(names, start=1):
            label = f"{number} {readable(name)}" if number <= 9 else readable(name)
            if number > 1:
                stay_in_line(button_width(label))
            is_on = self._session.is_alone(name)
            highlight = colour(self._gui.theme.accent, 0.5) if is_on else None
            if button(self._gui, f"{label}##button", name=f"show {name}", highlight=highlight):
                self._session.toggle_alone(name)

    def _draw_row(self, row: Row) -> None:
        session, theme = self._session, self._gui.theme
        values = [self._current[name] for name in row.names]
        is_linked = self._settings.is_linked and len(row.names) == 2 and len(set(values)) == 1
        names = row.names[1:] if is_linked else row.names
        # A muscle whose halves act together may have but one slider for both.
        whole = (self._selected or "").removesuffix("_left").removesuffix("_right")
        is_selected = self._selected in row.names or whole in row.names
        if is_selected:
            imgui.set_scroll_here_y(0.4)
        is_marked = any(values) or (self._flash and is_selected)
        imgui.align_text_to_frame_padding()
        spacing = imgui.get_style().item_spacing.x
        label_width = LABEL_SHARE * imgui.get_content_region_avail().x
        ink = colour(theme.accent if is_marked else theme.muted)
        imgui.text_colored(ink, shortened(self._title(row), label_width - spacing))
        is_pointed = imgui.is_item_hovered()
        hint(self._explanation(row))
        imgui.same_line(label_width)
        room = imgui.get_content_region_avail().x - (len(names) - 1) * spacing
        for index, name in enumerate(names):
            if index:
                imgui.same_line()
            slid = self._sliders.draw(
                name, self._current[name], session.controls.limits[name], width=room / len(names)
            )
            is_pointed = is_pointed or slid.is_hovered
            if slid.is_changed:
                session.set(name, slid.value, linked=is_linked)
            if slid.is_done:
                session.note()
        if is_pointed:
            self._view.pointed = tuple(sorted(set().union(*map(session.scene.moved_by, row.names))))
        if is_selected and not self._flash:
            self._selected = None

    def _title(self, row: Row) -> str:
        """The name, and where that is a code (an action unit's) what it does."""
        scene, name = self._session.scene, row.names[0]
        is_code = name not in self._session.controls.muscles and name not in scene.expressions
        return f"{row.label} {scene.actions.get(name, '')}".rstrip() if is_code else row.label

    def _explanation(self, row: Row) -> str:
        """The name in full, what it does where the scene says it, and whose slider is whose."""
        action = self._session.scene.actions.get(row.names[0], "")
        sides = "right | left" if len(row.names) > 1 else ""
        return "\n".join(line for line in (row.label, action, sides) if line)
