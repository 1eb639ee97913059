"""What the window remembers: what is of no use gives way alone, and nothing keeps it shut."""

from __future__ import annotations

import errno
import json
import os
import sys
from pathlib import Path
from typing import Any

import pytest

from risorius.app.performances import script_for
from risorius.app.viewer import Viewer
from risorius.app.viewer.session.recovery import Recovery
from risorius.app.viewer.settings import Display, Settings, load_settings, save_settings

from .driving import NEEDS_A_SCREEN, SIZE, settle

GOOD = {"theme": "dark", "zoom": 1.5, "folds": {"Jaw": True}, "display": {"wireframe": True}}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Where settings are, alone in a folder."""
    return tmp_path / "viewer.json"


def test_settings_come_back(tmp_path: Path) -> None:
    """What is written is read again."""
    path = tmp_path / "deep" / "viewer.json"
    settings = Settings(size=(900, 700), theme="dark", cameras={"face": [1.0, 2, 900, 0, 0, 0.5]})
    settings.display.look, settings.display.compare = "paper", "wipe"
    settings.display.refiner, settings.display.overlays = "loop", ["muscles"]
    settings.display.options = {"kahler": {"threshold_once": 0.1, "blend": True, "scheme": "cubic"}}
    save_settings(path, settings)
    assert load_settings(path) == (settings, "")
    assert [file.name for file in path.parent.iterdir()] == ["viewer.json"]


@pytest.mark.parametrize(
    ("where", "value"),
    [
        ("theme", "zzz"),
        ("theme", ["light"]),
        ("zoom", -5),
        ("zoom", True),
        ("size", [float("inf"), 5]),
        ("size", [900]),
        ("panel_width", float("nan")),
        ("is_linked", "yes"),
        ("folds.Eyes", 3),
        ("cameras.face", [1, 2, 3, 4, 5, float("inf")]),
        ("display", 3),
        ("display.refiner", "none"),
        ("display.refiner", {"a": 1}),
        ("display.compare", "both"),
        ("display.divider", 7),
        ("display.wrinkles", 10**400),
        ("display.overlays", ["muscles", "zzz"]),
        ("display.options.kahler", 1),
        ("display.options.kahler.threshold_once", float("nan")),
        ("display.options.kahler.threshold_once", [0.1]),
    ],
)
def test_one_value_gives_way_alone(path: Path, where: str, value: Any) -> None:
    """It is told with its name, and is as at first; all others stay."""
    stored = json.loads(json.dumps(GOOD))
    *tables, name = where.split(".")
    table = stored
    for each in tables:
        table = table.setdefault(each, {})
    table[name] = value
    path.write_text(json.dumps(stored))
    settings, complaint = load_settings(path)
    display = Display(wireframe=True)
    expected = Settings(theme="dark", zoom=1.5, folds={"Jaw": True}, display=display)
    if len(tables) == 0 and name in GOOD:
        setattr(expected, name, getattr(Settings(), name))
    if tables[2:]:
        expected.display.options = {"kahler": {}}
    assert settings == expected
    place = ", ".join(map(repr, where.split(".")))
    assert complaint.startswith(f"{path}: as at first: {place}") and "must be " in complaint
    save_settings(path, settings)
    assert load_settings(path) == (settings, "")


@pytest.mark.parametrize(
    "content",
    [b"", b"not json", b"[]", b"\xff\xfe\x00", 100_000 * b'{"display":', b" " * (2**20 + 1)],
)
def test_a_file_of_no_use_is_told(path: Path, content: bytes) -> None:
    """All is as at first; a line says so; written anew, it is of use."""
    path.write_bytes(content)
    settings, complaint = load_settings(path)
    assert settings == Settings()
    assert complaint.startswith(f"{path}: ") and len(complaint) < 500 and "\n" not in complaint
    save_settings(path, settings)
    assert load_settings(path) == (Settings(), "")


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and links of POSIX systems")
@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo, lambda path: path.symlink_to(path)])
def test_what_is_no_file_is_told(path: Path, make: Any) -> None:
    """A folder, a pipe for which one would wait, a circle of links."""
    make(path)
    settings, complaint = load_settings(path)
    assert settings == Settings() and complaint.endswith("all is as at first")


@pytest.mark.window
@NEEDS_A_SCREEN[1]
@pytest.mark.parametrize("name", ["theme", "display"])
def test_no_settings_keep_the_window_shut(path: Path, name: str) -> None:
    """Everything wrong at once, or what a refiner refuses: it opens, and says so."""
    wrong: dict[str, Any] = {name: "zzz" for name in vars(Settings())}
    if name == "display":
        wrong = {name: {"options": {"kahler": {"threshold_once": "x"}}}}
    path.write_text(json.dumps(wrong))
    with Viewer(script_for(None, "face"), SIZE, settings_path=path) as viewer:
        settle(viewer)
        told = "'theme': was 'zzz'" if name == "theme" else "threshold_once was x, must be a number"
        assert viewer.messages.is_error and told in viewer.messages.text
        assert viewer.settings.display == Display()


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_a_full_disk_is_told_and_closes_the_window(
    path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """One line on the terminal; unsaved work is left to the next window, the settings stay."""
    path.write_text('{"theme": "dark"}')
    viewer = Viewer(script_for(None, "face"), SIZE, settings_path=path)
    with viewer:
        settle(viewer)
        viewer.session.set("jaw_open", 0.5)
        viewer.recovery.save()

        def full(*_: object, **__: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(Path, "write_text", full)
    assert [record.getMessage() for record in caplog.records] == [
        f"risorius: {path}: cannot be written: No space left on device; "
        "the next window does not look as this one"
    ]
    assert path.read_text() == '{"theme": "dark"}'
    recovery = Recovery(path.parent, viewer.session)
    assert recovery.found and recovery.found.pose
    recovery.close()
