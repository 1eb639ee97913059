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
from risorius.app.scenes import FaceScene, PlaneScene
from risorius.app.viewer import Viewer
from risorius.app.viewer.settings import (
    Display,
    Settings,
    load_settings,
    remove_refused_options,
    save_settings,
)
from risorius.refine.border.registry import refiners

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
    settings.display.look, settings.display.a = "paper", "smooth"
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
        ("zoom", float("nan")),
        ("size", [float("inf"), 5]),
        ("size", [900]),
        ("size", "900x700"),
        ("panel_width", float("nan")),
        ("is_linked", "yes"),
        ("tab", "Nose"),
        ("folds.Eyes", 3),
        ("cameras.face", [1, 2, 3]),
        ("cameras.face", [1, 2, 3, 4, 5, float("inf")]),
        ("cameras.face", [[[]]] * 6),
        ("display", 3),
        ("display.look", "pretty"),
        ("display.tone", 3),
        ("display.refiner", "none"),
        ("display.refiner", {"a": 1}),
        ("display.compare", "both"),
        ("display.a", "both"),
        ("display.divider", 7),
        ("display.skin", "fur"),
        ("display.wrinkles", 10**400),
        ("display.overlays", ["muscles", "zzz"]),
        ("display.options.kahler", 1),
        ("display.options.kahler.threshold_once", float("nan")),
        ("display.options.kahler.threshold_once", [0.1]),
        ("display.options.kahler.threshold_once", 10**400),
    ],
)
def test_one_value_gives_way_alone(path: Path, where: str, value: Any) -> None:
    """It is told with its name, and is as at first; all others stay; the file is kept."""
    stored = json.loads(json.dumps(GOOD))
    *tables, name = where.split(".")
    table = stored
    for each in tables:
        table = table.setdefault(each, {})
    table[name] = value
    path.write_text(json.dumps(stored))
    before = path.read_bytes()
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
    [kept] = path.parent.glob("*.unusable.json")
    assert kept.name in complaint and kept.read_bytes() == before
    assert load_settings(path) == (settings, "")  # told once


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"not json",
        b"[]",
        b"3",
        b"\xff\xfe\x00",
        b"\x00\x01",
        b'{"zoom": ' + 100_000 * b"[",
        100_000 * b'{"display":',
        b" " * (2**20 + 1),
    ],
)
def test_a_file_of_no_use_is_set_aside(path: Path, content: bytes) -> None:
    """All is as at first; a line says so, and where the file is now; the next window is quiet."""
    path.write_bytes(content)
    settings, complaint = load_settings(path)
    assert settings == Settings()
    assert complaint.startswith(f"{path}: ") and len(complaint) < 500 and "\n" not in complaint
    [kept] = path.parent.glob("*.unusable.json")
    assert kept.name in complaint and kept.read_bytes() == content
    save_settings(path, settings)
    assert load_settings(path) == (Settings(), "")


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and links of POSIX systems")
def test_what_is_no_file_is_set_aside(path: Path) -> None:
    """A folder, a pipe for which one would wait, a circle of links."""
    for make in (path.mkdir, lambda: os.mkfifo(path), lambda: path.symlink_to(path)):
        make()
        settings, complaint = load_settings(path)
        assert settings == Settings() and "the file is kept as viewer-" in complaint
        save_settings(path, settings)
        assert load_settings(path) == (Settings(), "")
        for file in path.parent.iterdir():
            file.rmdir() if file.is_dir() else file.unlink()


def test_options_that_a_refiner_refuses_give_way_alone() -> None:
    """Unknown ones, other kinds, too much: named; what remains is taken by the refiner."""
    display = Display(
        options={
            "kahler": {"threshold_once": "x", "scheme": "cubic", "foo": 3, "blend": True},
            "loop": {"levels": 50},
        }
    )
    told = remove_refused_options(display, FaceScene())
    assert display.options == {"kahler": {"scheme": "cubic", "blend": True}, "loop": {}}
    for words in ("kahler threshold_once = 'x'", "kahler foo = 3", "loop levels = 50"):
        assert words in told
    assert remove_refused_options(display, FaceScene()) == ""


def test_refiners_that_cannot_be_bound_give_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what is drawn and what it is compared with; the look is drawn, and the mesh as it is."""

    def broken(*_: Any, **__: Any) -> Any:
        raise ValueError("this mesh is too large")

    monkeypatch.setattr(refiners, "_factories", {**refiners._factories, "far": broken})
    display = Display(look="paper", refiner="far", a="far")
    told = remove_refused_options(display, PlaneScene())
    assert told == "of no use and as at first: refiner far, far"
    assert display == Display(look="paper")


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_no_settings_keep_the_window_shut(path: Path) -> None:
    """Everything wrong at once: it opens, and says so."""
    wrong: dict[str, Any] = {name: "zzz" for name in vars(Settings())}
    wrong["display"] = {name: -1 for name in vars(Display())}
    wrong["display"]["options"] = {"kahler": {"threshold_once": "x"}}
    path.write_text(json.dumps(wrong))
    with Viewer(script_for(None, "face"), SIZE, settings_path=path) as viewer:
        settle(viewer)
        assert viewer.messages.is_error and "'theme': was 'zzz'" in viewer.messages.text
        assert "kahler threshold_once = 'x'" in viewer.messages.text


@NEEDS_A_SCREEN[0]
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
        viewer.recovery.save(viewer.session)

        def full(*_: object, **__: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(Path, "write_text", full)
    assert [record.getMessage() for record in caplog.records] == [
        f"risorius: {path}: cannot be written: No space left on device; "
        "the next window does not look as this one"
    ]
    assert path.read_text() == '{"theme": "dark"}'
    viewer.recovery.find(viewer.session)
    assert viewer.recovery.found and viewer.recovery.found.pose
    viewer.recovery.close()
