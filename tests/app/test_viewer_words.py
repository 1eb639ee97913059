"""What the window says and lists: sizes, sounds, pictures of poses, lines that are sentences."""

from __future__ import annotations

from pathlib import Path

import pytest
from imgui_bundle import imgui

from risorius.app.viewer import Viewer
from risorius.app.viewer.messages import Messages
from risorius.app.viewer.settings import ExportChoices

from .driving import NEEDS_A_SCREEN, click, until, xdotool
from .sounds import noise, write_wav

window = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("nothing was recorded: no control moved", "Nothing was recorded: no control moved"),
        ("my smile.toml: opened", "my smile.toml: opened"),
        ("give it 2.5 s", "Give it 2.5 s"),
        ("", ""),
    ],
)
def test_lines_are_sentences(line: str, shown: str) -> None:
    """They begin with a capital, but names of files stay as they are."""
    messages = Messages()
    messages.say(line)
    assert messages.text == shown


class TestWindow:
    """In the window."""

    pytestmark = window

    def test_places_of_poses_come_before_their_pictures(
        self, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The heading opens at once; what is drawn in its places follows."""
        taken: list[str] = []
        take = viewer.poses._take_picture

        def noted(title: str, values: dict[str, float]) -> None:
            """Take it, and keep which it was."""
            taken.append(title)
            take(title, values)

        monkeypatch.setattr(viewer.poses, "_take_picture", noted)
        viewer.settings.folds["Pose pictures"] = True
        assert until(viewer, lambda: "pose Joy" in viewer.gui.places)
        assert not taken and "row pose joy" not in viewer.gui.places  # of the timeline
        assert until(viewer, lambda: len(taken) > 2)
        assert not viewer.messages.text

    def test_the_keyboard_passes_the_message_by(self, viewer: Viewer) -> None:
        """Ctrl+Tab goes to what has a widget to frame, while a line is shown, too."""
        viewer.messages.say("x", error=True)
        xdotool(viewer, "key", "Tab")
        context = imgui.get_current_context()
        for _ in range(3):
            xdotool(viewer, "key", "ctrl+Tab")
            assert context.nav_id_is_alive and context.nav_cursor_visible
        xdotool(viewer, "key", "Escape")

    def test_sizes_have_names(self, viewer: Viewer, tmp_path: Path) -> None:
        """Of the list in the dialog of an export, the window's own among them."""
        viewer.settings.export = ExportChoices("frames", folder=str(tmp_path))
        xdotool(viewer, "key", "F10")
        click(viewer, "Size")
        width, height = viewer.view.viewport[2:]
        assert f"Size: As in the window: {width} x {height}" in viewer.gui.places
        click(viewer, "Size: VGA: 640 x 480")
        assert viewer.settings.export.size == (640, 480)
        xdotool(viewer, "key", "Escape")

    def test_a_sound_is_opened_again(self, viewer: Viewer, tmp_path: Path) -> None:
        """By the menu of recent files, where heads stand, too."""
        sound, mesh = write_wav(tmp_path / "hum.wav", noise(0.5)), tmp_path / "gone.obj"
        viewer.drop([str(sound)])
        viewer.settings.note_recent(mesh, mesh.with_suffix(".json"))
        xdotool(viewer, "key", "ctrl+z")
        assert viewer.session.script.sound is None
        for path in (mesh, sound):
            click(viewer, "menu File")
            click(viewer, "menu File: Recent")
            click(viewer, f"menu File: {path.name}   {tmp_path}")
            assert viewer.messages.is_error == (path is mesh)
        assert viewer.session.script.sound is not None
