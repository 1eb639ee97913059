"""What of the panels is to be seen, in this run of the program only."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class PanelState:
    """Commands change it, panels follow."""

    are_hidden: bool = False  # all but the picture
    is_help_open: bool = False
    wanted_tab: str = ""  # to be brought to the front, by its title

    def toggle_hidden(self) -> str | None:
        """Hide all but the picture, or show it again."""
        self.are_hidden = not self.are_hidden
        return "Menus are at the upper edge" if self.are_hidden else None
