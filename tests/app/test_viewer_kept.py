"""Files kept after the window: settings, and unsaved work, which the next window offers."""

import errno
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.app.performances import script_for
from risorius.app.scenes import PlaneScene
from risorius.app.script.script_file import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.picture import portraits
from risorius.app.viewer.session.physics import STEP_TIME
from risorius.app.viewer.session.recovery import WRITING_INTERVAL, Recovery
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.settings import Display, Settings, load_settings, save_settings
from risorius.app.viewer.window.splash_screen import SplashScreen

from .driving import NEEDS_A_SCREEN, SIZE, run, settle, wait_for

KEPT_VALUES = {"theme": "dark", "zoom": 1.5, "folds": {"Jaw": True}, "display": {"wireframe": True}}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """The path of settings, in a separate folder."""
    return tmp_path / "viewer.json"


def test_settings_come_back(tmp_path):
    """Written settings are read again."""
    path = tmp_path / "deep" / "viewer.json"
    settings = Settings(size=(900, 700), theme="dark", folds={"Jaw": True}, recent=["a"])
    settings.display.look = "paper"
    settings.display.compare = "wipe"
    settings.display.refiner = "loop"
    settings.display.light = "/maps/room.hdr"
    settings.display.overlays = ["muscles"]
    settings.display.options = {"kahler": {"threshold_once": 0.1, "blend": True, "scheme": "cubic"}}
    save_settings(path, settings)
    assert load_settings(path) == (settings, "")
    assert [file.name for file in path.parent.iterdir()] == ["viewer.json"]


@pytest.mark.parametrize(
    ("where", "value"),
    [
        ("theme", "zzz"),
        ("is_linked", "yes"),
        ("display", 3),
        ("display.refiner", "none"),
        ("display.light", "zzz"),
        ("display.light", 3),
        ("display.wrinkles", 10**400),
        ("display.overlays", ["muscles", "zzz"]),
        ("display.options.kahler.threshold_once", float("nan")),
    ],
)
def test_one_wrong_value_gets_its_default(path, where, value):
    """A wrong value is reported by name and gets its default; all others stay."""
    stored = json.loads(json.dumps(KEPT_VALUES))
    *tables, name = where.split(".")
    table = stored
    for each in tables:
        table = table.setdefault(each, {})
    table[name] = value
    path.write_text(json.dumps(stored))
    settings, complaint = load_settings(path)
    display = Display(wireframe=True)
    expected = Settings(theme="dark", zoom=1.5, folds={"Jaw": True}, display=display)
    if len(tables) == 0 and name in KEPT_VALUES:
        setattr(expected, name, getattr(Settings(), name))
    if tables[2:]:
        expected.display.options = {"kahler": {}}
    assert settings == expected
    place = ", ".join(map(repr, where.split(".")))
    assert complaint.startswith(f"{path}: defaults replace: {place}")
    assert "must be " in complaint
    save_settings(path, settings)
    assert load_settings(path) == (settings, "")


@pytest.mark.parametrize(
    "content",
    [b"", b"not json", b"[]", b"\xff\xfe\x00", 100_000 * b'{"display":', b" " * (2**20 + 1)],
)
def test_an_unreadable_settings_file_is_reported(path, content):
    """An unreadable file gives defaults and a line; the next write makes the file valid."""
    path.write_bytes(content)
    settings, complaint = load_settings(path)
    assert settings == Settings()
    assert complaint.startswith(f"{path}: ")
    assert len(complaint) < 500
    assert "\n" not in complaint
    save_settings(path, settings)
    assert load_settings(path) == (Settings(), "")


@pytest.mark.window
@NEEDS_A_SCREEN[1]
@pytest.mark.parametrize(
    ("wrong", "fault"),
    [
        ({name: "zzz" for name in vars(Settings())}, "'theme': was 'zzz'"),
        pytest.param(
            {"display": {"options": {"kahler": {"threshold_once": "x"}}}},
            "threshold_once was x, must be a number",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            {"display": {"light": "/nowhere/room.hdr"}},
            "/nowhere/room.hdr: no such light map",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_no_settings_prevent_the_window_from_opening(path, wrong, fault):
    """The window opens with all values wrong, a refused option, or a removed map of light.

    A message reports the fault.
    """
    path.write_text(json.dumps(wrong))
    with Viewer(script_for(None, "face"), SIZE, settings_path=path) as viewer:
        settle(viewer)
        assert viewer.messages.is_error
        assert fault in viewer.messages.text
        assert viewer.settings.display == Display()


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_a_full_disk_is_reported_and_closes_the_window(path, monkeypatch, caplog):
    """A full disk gives one line on the terminal; unsaved work and settings are kept."""
    path.write_text('{"theme": "dark"}')
    viewer = Viewer(script_for(None, "face"), SIZE, settings_path=path)
    with viewer:
        settle(viewer)
        viewer.session.set("jaw_open", 0.5)
        viewer.recovery.save()

        def full(*_, **__):
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(Path, "write_text", full)
    assert [record.getMessage() for record in caplog.records] == [
        f"risorius: {path}: cannot be written: No space left on device; "
        "the next window opens without these settings"
    ]
    assert path.read_text() == '{"theme": "dark"}'
    recovery = Recovery(path.parent, viewer.session)
    assert recovery.found
    assert load_script(recovery.found).posed_names
    recovery.close()


ROOT = Path(__file__).parents[2]


class Clock:
    """A clock that advances when `now` is set."""

    now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock() -> Clock:
    """A clock that stands still."""
    return Clock()


@pytest.fixture
def recovery(session: Session, tmp_path: Path, clock: Clock) -> Iterator[Recovery]:
    """The recovery of an open window."""
    made = Recovery(tmp_path, session, clock)
    yield made
    made.close()


def watch(recovery, clock):
    """Advance time until a change is written."""
    recovery.watch()
    clock.now += WRITING_INTERVAL
    recovery.watch()


def stored(folder):
    """The files with unsaved work."""
    return [path.name for path in folder.glob("unsaved*.toml")]


def found_by_next(folder, session):
    """The file that a newly opened window finds."""
    other = Recovery(folder, session)
    other.close()
    return None if other.found is None else load_script(other.found)


def leave(folder, session):
    """Leave unsaved work of a window that ends."""
    recovery = Recovery(folder, session)
    recovery.save()
    recovery.close()


def test_work_is_written_soon_and_removed_by_undo(session, recovery, clock, tmp_path):
    """A pose is written soon after it is set, also during a drag; undo removes the file."""
    recovery.watch()
    assert recovery.due_in() == float("inf")
    assert not stored(tmp_path)
    for step in range(round(1.5 * WRITING_INTERVAL / STEP_TIME)):
        session.set("jaw_open", 0.2 + 0.001 * (step % 100))
        recovery.watch()
        clock.now += STEP_TIME
    recovery.close()
    (name,) = stored(tmp_path)
    assert 0.2 <= load_script(tmp_path / name).at(session.time)["jaw_open"] < 0.3
    session.note()
    session.undo()
    recovery.watch()
    assert not stored(tmp_path)


def test_a_recovered_script_is_complete(session, recovery, tmp_path):
    """A script with its current recording is recovered to each digit, with its comments."""
    session.set("jaw_open", 0.25)
    session.set_key()
    session.set("jaw_open", 1.0 / 3.0)
    session.toggle_recording()
    session.set("jaw_open", 0.5)
    run(session, 20)
    recovery.save()
    assert found_by_next(tmp_path, session) is None  # its window is still open
    recovery.close()
    found = found_by_next(tmp_path, session)
    session.toggle_recording()
    assert found == session.script and found.preface.startswith("# A smile")


def test_a_found_file_stays_and_is_found_once(session, tmp_path):
    """Changes, saves and discards do not touch a found file, nor does a window with the plane."""
    session.set("jaw_open", 0.4)
    leave(tmp_path, session)
    assert found_by_next(tmp_path, Session(PlaneScene(), script_for(None, "plane"))) is None
    session.neutral()
    recovery = Recovery(tmp_path, session)
    assert recovery.found is not None
    with recovery.guarding():
        recovery.watch()
        session.set("jaw_open", 0.1)
        recovery.save()
    recovery.close()
    assert load_script(recovery.found).at(0.0)["jaw_open"] == 0.4
    assert found_by_next(tmp_path, session) is None


def test_a_read_only_folder_is_reported_once(session, clock):
    """A message reports that work is not safe in a read-only folder, and the window continues."""
    recovery = Recovery(Path("/proc/none"), session, clock)
    session.set("jaw_open", 0.4)
    with pytest.raises(UserError, match=r"not kept safe: .*/proc/none"):
        watch(recovery, clock)
    session.set("jaw_open", 0.5)
    watch(recovery, clock)
    recovery.close()


# Real windows, real signals.


@pytest.fixture
def at_work(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """`risorius view` with its own settings, and a face changed just now."""
    process = subprocess.Popen(
        [sys.executable, "-m", "risorius", "view", "--size", "700x500"],
        cwd=ROOT, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "XDG_CONFIG_HOME": str(tmp_path)}, start_new_session=True,
        # Tests started behind `&` or `nohup` ignore signals, and so do their children.
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (1, 2, 15)],
    )  # fmt: skip
    search = ["xdotool", "search", "--onlyvisible", "--name"]

    def is_posed() -> bool:
        # Keys are lost until the window listens. The test waits for each answer: the next attempt
        # begins with "neutral", and a process that ended at that moment would leave no work to
        # recover.
        subprocess.run(["xdotool", "mousemove", "450", "200", "key", "n", "1", "m"], check=True)
        title = [*search, r"^Risorius: Untitled \*$"]
        end = time.monotonic() + 5.0
        while time.monotonic() < end:
            if subprocess.run(title, capture_output=True, check=False).stdout:
                return True
        return False

    try:
        shown = [*search[:2], "--sync", *search[2:], "^Risorius: Untitled$"]
        subprocess.run(shown, check=True, capture_output=True, timeout=60)
        wait_for(is_posed)
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.window
@NEEDS_A_SCREEN[1]
@pytest.mark.parametrize(
    "how", [pytest.param(signal.SIGHUP, marks=pytest.mark.slow), signal.SIGKILL]
)
def test_a_window_that_ended_is_recovered(at_work, tmp_path, how):
    """The work of a window that was stopped or killed is recovered by the next window.

    It was killed some seconds after the last change; a line names the file.
    """
    folder = tmp_path / "risorius"
    if how == signal.SIGKILL:
        wait_for(lambda: stored(folder))
    at_work.send_signal(how)
    assert at_work.wait(60.0) == -how
    script = script_for(None, "face")
    with Viewer(script, SIZE, settings_path=folder / "viewer.json") as viewer:
        settle(viewer)
        assert not viewer.session.work.unsaved
        assert viewer.messages.is_error
        assert "work is in File > Recent: unsaved-face-" in viewer.messages.text
        viewer.drop(viewer.settings.recent[0].split("\n"))
        moved = {name: value for name, value in viewer.session.values.items() if value}
        assert moved == {"joy": 1.0}


def test_pictures_of_persons_are_drawn_once(tmp_path, monkeypatch):
    """Pictures of persons are stored for this version; those of other versions are removed.

    Broken pictures are ignored.
    """
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(portraits, "lower_priority", lambda _: None)
    stale = tmp_path / "risorius" / "portraits-0" / "coarse.png"
    stale.parent.mkdir(parents=True)
    stale.touch()
    assert portraits.kept_portrait("coarse") is None
    sent = []
    portraits.draw_portraits(["coarse"], sent.append)
    assert np.array_equal(portraits.kept_portrait("coarse"), sent[0][1])
    assert not stale.parent.exists()
    (kept,) = tmp_path.rglob("coarse.png")
    found = threading.Event()
    shown = portraits.Portraits(None, found.set)
    shown.begin(["coarse"])
    assert found.wait(10.0)
    assert shown.has_news
    shown.close()
    kept.write_bytes(kept.read_bytes()[:1000])
    assert portraits.kept_portrait("coarse") is None
    monkeypatch.setattr(portraits, "_program", lambda: "newer")
    assert portraits.kept_portrait("coarse") is None


@pytest.mark.parametrize(
    ("remembered", "zoom"), [({}, 4 / 3), ({"size": [1280, 800]}, 1.2 * 4 / 3)]
)
def test_a_large_window_has_large_words(path, monkeypatch, remembered, zoom):
    """A window of a given size has words that fit its height; the user's own factor stays."""
    surface = SimpleNamespace(frame_size=(2560, 1440), pixel_scale=1.0, show=lambda image: None)
    monkeypatch.setattr("risorius.render.open_window", lambda *_, **__: surface)
    if remembered:
        path.write_text(json.dumps({**remembered, "zoom": 1.2}))
    splash = SplashScreen((2560, 1440), path)
    SplashScreen.LOG.removeHandler(splash)
    assert splash.settings.zoom == pytest.approx(zoom)
