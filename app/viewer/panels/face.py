"""The controls of the face: a group for each that the scene has, a slider for each control."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from .. import commands
from ..gui import colour
from ..rows import Row, found, readable, rows_of
from .folds import fold
from .sliders import Sliders
from .words import hint, shortened, stay_in_line

if TYPE_CHECKING:
    from ..window import Viewer

LABEL_SHARE = 0.46  # of a row
FLASH = 90  # frames for which a selected slider is marked


class FacePanel:
    """Buttons, search and groups of sliders."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self._sliders = Sliders(viewer.gui)
        self.search = ""
        self._selected: str | None = None  # to be scrolled to
        self._flash = 0
        self.pointed: tuple[str, ...] = ()  # whose sliders the mouse is on

    def select(self, name: str) -> None:
        """Open the group of a control, scroll to it and mark it."""
        self.search = ""
        self._selected, self._flash = name, FLASH

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        self.pointed = ()
        self._draw_buttons()
        imgui.begin_child("controls", imgui.ImVec2(0.0, 0.0))
        for title, names in self._viewer.session.groups.items():
            self._draw_group(title, names)
        imgui.end_child()
        self._flash = max(self._flash - 1, 0)

    def _draw_buttons(self) -> None:
        viewer, session, gui = self._viewer, self._viewer.session, self._viewer.gui
        for label, meaning, run in (
            ("Neutral", "relax all (N)", session.neutral),
            ("Mirror", "exchange left and right (M)", session.mirror),
            ("Random", "a face by chance (X)", lambda: commands.randomise(viewer)),
        ):
            if label != "Neutral":
                stay_in_line(_button_width(label))
            if imgui.button(label):
                run()
            gui.remember(label)
            hint(meaning)
        stay_in_line(imgui.get_frame_height() + imgui.calc_text_size("  Link sides").x)
        is_clicked, is_linked = imgui.checkbox("Link sides", viewer.settings.is_linked)
        gui.remember("Link sides")
        hint("left and right move together")
        if is_clicked:
            viewer.settings.is_linked = is_linked
        imgui.set_next_item_width(-1.0)
        _, self.search = imgui.input_text_with_hint(
            "##search", "search: smile, AU12, lid ...", self.search
        )
        gui.remember("search")

    def _draw_group(self, title: str, names: Sequence[str]) -> None:
        viewer, session = self._viewer, self._viewer.session
        rows = rows_of(names, session.values, linked=viewer.settings.is_linked)
        if self.search:
            actions = viewer.scene.actions
            rows = found(rows, self.search, group=title, actions=actions)
            if not rows:
                return
        elif self._selected in names:
            viewer.settings.folds[title] = True
        active = sum(1 for name in names if session.values[name])
        label = f"{title}  ({active})" if active else title
        if fold(viewer, title, label, must_open=bool(self.search)):
            if names and all(name in viewer.scene.expressions for name in names):
                self._draw_expression_buttons(names)
            for row in rows:
                self._draw_row(row)

    def _draw_expression_buttons(self, names: Sequence[str]) -> None:
        """A button for each: the whole expression at once."""
        session = self._viewer.session
        for number, name in enumerate(names, start=1):
            label = f"{number} {readable(name)}" if number <= 9 else readable(name)
            if number > 1:
                stay_in_line(_button_width(label))
            is_shown = session.shown == name
            if is_shown:
                imgui.push_style_color(
                    imgui.Col_.button, colour(self._viewer.gui.theme.accent, 0.5)
                )
            if imgui.button(f"{label}##button"):
                session.show(name)
            if is_shown:
                imgui.pop_style_color()
            self._viewer.gui.remember(f"show {name}")

    def _draw_row(self, row: Row) -> None:
        viewer, session = self._viewer, self._viewer.session
        values = [session.values[name] for name in row.names]
        is_linked = viewer.settings.is_linked and len(row.names) == 2 and len(set(values)) == 1
        shown = row.names[1:] if is_linked else row.names
        # A muscle whose halves act together may have but one slider for both.
        whole = (self._selected or "").removesuffix("_left").removesuffix("_right")
        is_selected = self._selected in row.names or whole in row.names
        if is_selected:
            imgui.set_scroll_here_y(0.4)
        is_marked = any(values) or (self._flash and is_selected)
        imgui.align_text_to_frame_padding()
        theme, spacing = viewer.gui.theme, imgui.get_style().item_spacing.x
        label_width = LABEL_SHARE * imgui.get_content_region_avail().x
        ink = colour(theme.accent if is_marked else theme.muted)
        imgui.text_colored(ink, shortened(self._title(row), label_width - spacing))
        is_pointed = imgui.is_item_hovered()
        hint(self._explanation(row))
        imgui.same_line(label_width)
        room = imgui.get_content_region_avail().x - (len(shown) - 1) * spacing
        for index, name in enumerate(shown):
            if index:
                imgui.same_line()
            slid = self._sliders.draw(
                name, session.values[name], session.limits[name], width=room / len(shown)
            )
            is_pointed = is_pointed or slid.is_hovered
            if slid.is_changed:
                session.set(name, slid.value, linked=is_linked)
            if slid.is_done:
                session.note()
        if is_pointed:
            self.pointed = tuple(sorted(set().union(*map(session.moved_by, row.names))))
        if is_selected and not self._flash:
            self._selected = None

    def _title(self, row: Row) -> str:
        """The name, and where that is a code (an action unit's) what it does."""
        scene, name = self._viewer.scene, row.names[0]
        is_code = name not in self._viewer.session.muscles and name not in scene.expressions
        return f"{row.label} {scene.actions.get(name, '')}".rstrip() if is_code else row.label

    def _explanation(self, row: Row) -> str:
        """The name in full, what it does where the scene says it, and whose slider is whose."""
        action = self._viewer.scene.actions.get(row.names[0], "")
        sides = "right | left" if len(row.names) > 1 else ""
        return "\n".join(line for line in (row.label, action, sides) if line)


def _button_width(label: str) -> float:
    """Of a button that reads so [window units]."""
    return float(imgui.calc_text_size(label).x + 2.0 * imgui.get_style().frame_padding.x)
