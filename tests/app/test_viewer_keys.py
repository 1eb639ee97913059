"""Clicks, keys and words sent to a window that draws slowly: each has its effect."""

import re

import pytest
from imgui_bundle import imgui, rich_md

import risorius
from risorius.app.viewer.documents.manual import one_document, pages
from risorius.app.viewer.settings import Display

from .driving import NEEDS_A_SCREEN, click, middle, press_keys, until, write, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def test_escape_closes_one_thing_after_another(viewer):
    """Escape closes menus, lists, the timeline's menu and dialogs, one at a time."""
    click(viewer, "tab Mechanism")
    x, y = middle(viewer, "keys")
    places = viewer.gui.places
    context = imgui.get_current_context()
    for opens, shown in (
        (lambda: click(viewer, "menu File"), "menu File: Quit"),
        (lambda: click(viewer, "Look"), "Look: paper"),
        (lambda: click(viewer, "speed"), "speed: 2 x"),
        (lambda: xdotool(viewer, "mousemove", x, y, "click", 3), "menu Keys: Set key"),
        (lambda: press_keys(viewer, "ctrl+o"), "path"),
    ):
        opens()
        assert until(viewer, lambda: shown in places), shown  # noqa: B023
        xdotool(viewer, "mousemove", 2, 2, "key", "Escape")
        assert shown not in places and not context.open_popup_stack.size(), shown
    click(viewer, "tab Face")


def test_each_command_has_its_own_name_and_keys(viewer):
    """No two commands share a name or a key."""
    doing = [each for each in viewer.face.commands if each.submenu is None]
    labels = [command.label for command in doing]
    keys = [key for command in doing for key in command.keys]
    assert len(labels) == len(set(labels))
    assert len(keys) == len(set(keys))


def test_the_manual_is_read_and_searched(viewer):
    """F1 opens all pages of the manual, in which links and Ctrl+F find their places.

    The manual gets all keys until it closes.
    """
    press_keys(viewer, "F1")
    manual = viewer.context.manual
    assert manual.is_open
    headings = rich_md.last_render_headings()
    assert headings[0].text.startswith("The window")
    assert {"Pull to pose", "Easing"} <= {each.text for each in headings}
    links = re.findall(r"\]\(([^)\s]+)\)", one_document(pages()))
    inside = {each[1:] for each in links if each.startswith("#")}
    assert len(inside) > 50 and inside <= {each.slug for each in headings}
    assert all("://" in each for each in links if not each.startswith("#"))
    press_keys(viewer, "r", "ctrl+f")
    write(viewer, "wr")
    assert imgui.get_io().want_text_input
    assert viewer.settings.display == Display()
    press_keys(viewer, "Escape")
    assert manual.is_open
    press_keys(viewer, "Escape")
    assert not manual.is_open
    press_keys(viewer, "r")
    assert not viewer.settings.display.is_refined


def test_all_keys_are_listed(viewer):
    """*Help > Keys and mouse* has a section for each menu, made from the commands."""
    click(viewer, "menu Help")
    click(viewer, "menu Help: Keys and mouse")
    assert viewer.context.manual.is_open
    menus = {each.menu or "Expressions" for each in viewer.face.commands if each.key}
    assert {each.text for each in rich_md.last_render_headings()} == menus
    press_keys(viewer, "Escape")
    assert not viewer.context.manual.is_open


def test_the_citation_is_copied(viewer):
    """*Help > Copy citation* copies the paper and the program to the clipboard, as BibTeX."""
    click(viewer, "menu Help")
    click(viewer, "menu Help: Copy citation")
    citation = imgui.get_clipboard_text()
    assert "10.1007/s00371-002-0185-8" in citation
    assert 'K{\\"a}hler' in citation
    assert f"version = {{{risorius.__version__}}}" in citation


def test_recent_files_are_opened_again(viewer, tmp_path):
    """The latest file is first; a missing one is reported in one line."""
    paths = [tmp_path / f"{name}.toml" for name in ("first", "second")]
    for path in paths:
        path.write_text("duration = 1.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 1.0\njoy = 1.0\n")
        viewer.drop([str(path)])
    assert viewer.settings.recent[:2] == [str(path) for path in reversed(paths)]

    def choose(path):
        """Open a file by the menu."""
        click(viewer, "menu File")
        click(viewer, "menu File: Recent")
        click(viewer, f"menu File: {path.name}   {path.parent}")

    choose(paths[0])
    assert viewer.session.script.source == str(paths[0])
    assert not viewer.messages.is_error
    paths[1].unlink()
    choose(paths[1])
    assert viewer.messages.is_error
    assert "no such file" in viewer.messages.text
    assert "\n" not in viewer.messages.text
    assert viewer.session.script.source == str(paths[0])
    press_keys(viewer, "Escape")
    assert not viewer.messages.text
