"""Files that the window opens and saves, and sounds."""

import os
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from risorius.app.script.script_file import load_script
from risorius.app.sound import player
from risorius.app.viewer import Viewer
from risorius.assets.coarse import coarse_head
from risorius.assets.meshes import Mesh
from tests.heads import user_head, write_topology

from .driving import (
    NEEDS_A_SCREEN,
    click,
    drag,
    drag_and_release,
    drop,
    middle,
    moved,
    nose,
    on_screen,
    press_keys,
    put,
    settle,
    until,
    write,
    xdotool,
)
from .sounds import noise, write_wav

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

SCRIPT = "duration = 2.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"
POSE_SCRIPT = "duration = 1.0\n[[pose]]\ntime = 0.0\njaw_open = 0.5\n"


def test_files_can_be_dropped_onto_the_window(viewer, tmp_path):
    """Another program drops a script, and a pose with a difficult name, by the X protocol."""
    script = tmp_path / "smile.toml"
    pose = tmp_path / "schöner & 50% größer.toml"
    script.write_text(SCRIPT)
    pose.write_text(POSE_SCRIPT)
    drop(viewer, script)
    assert viewer.session.script.duration == 2.0
    assert "smile.toml" in viewer.messages.text
    assert not viewer.messages.is_error
    drop(viewer, pose)
    assert viewer.session.values["jaw_open"] == 0.5
    assert viewer.session.script.duration == 2.0
    script.write_bytes(bytes(range(256)))
    put(viewer, script)
    assert viewer.messages.is_error and "message" in viewer.gui.places


def test_the_chooser_walks_through_folders(viewer, tmp_path):
    """The chooser enters a folder, goes up again, and opens a script by a double click."""
    (tmp_path / "takes").mkdir()
    (tmp_path / "takes" / "smile.toml").write_text(SCRIPT)
    (tmp_path / "picture.png").write_bytes(b"")
    press_keys(viewer, "ctrl+o")
    assert "file picture.png" not in viewer.gui.places
    click(viewer, "folder takes")
    assert until(viewer, lambda: "file smile.toml" in viewer.gui.places)
    click(viewer, "folder Up")
    assert until(viewer, lambda: "folder takes" in viewer.gui.places)
    click(viewer, "folder takes")
    click(viewer, "file smile.toml", times=2)
    assert viewer.session.script.duration == 2.0
    assert not viewer.files.is_waiting
    press_keys(viewer, "ctrl+o")
    assert "file smile.toml" in viewer.gui.places  # starts in the last folder
    press_keys(viewer, "Escape")
    assert not viewer.files.is_waiting


def test_the_chooser_asks_before_it_replaces(viewer, tmp_path):
    """An existing name needs a second confirmation; a missing folder is reported."""
    taken = tmp_path / "pose.toml"
    taken.write_text("precious")
    viewer.session.set("jaw_open", 0.4)
    press_keys(viewer, "ctrl+p")
    press_keys(viewer, "Return")
    assert viewer.files.is_waiting
    assert taken.read_text() == "precious"
    press_keys(viewer, "Return")
    assert not viewer.files.is_waiting
    assert "jaw_open = 0.4" in taken.read_text()
    viewer.session.set("jaw_open", 0.5)
    press_keys(viewer, "ctrl+p")
    press_keys(viewer, "ctrl+a")
    write(viewer, "/proc/none/pose")
    press_keys(viewer, "Return")
    assert viewer.messages.is_error
    assert "/proc/none/pose.toml" in viewer.messages.text
    assert "the pose" in viewer.session.work.unsaved


def test_closing_while_recording_saves_it_first(viewer, tmp_path):
    """Answering Save stores the recording in a file, and then closes the window."""
    press_keys(viewer, "ctrl+r")
    viewer.session.set("jaw_open", 0.6)
    assert until(viewer, lambda: viewer.session.recorded_seconds > 0.3)
    viewer.surface.should_close = False
    press_keys(viewer, "ctrl+q")
    assert "the recording" in viewer.session.work.unsaved
    assert not viewer.surface.should_close
    click(viewer, "question: Save recording ...")
    press_keys(viewer, "Return")
    assert "jaw_open" in (tmp_path / "script.toml").read_text()
    assert viewer.surface.should_close
    viewer.surface.should_close = viewer.is_leaving = False


def title_of(viewer):
    """The title above the window on the desktop."""
    settle(viewer)
    command = ["xdotool", "search", "--onlyvisible", "--name", "^Risorius: "]
    window = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[-1]
    name = ["xdotool", "getwindowname", window]
    return subprocess.run(name, check=True, capture_output=True, text=True).stdout.strip()


def test_saving_goes_to_the_known_file(viewer, tmp_path):
    """An opened script is saved without a question; the title shows its name and state."""
    script = tmp_path / "smile.toml"
    script.write_text(f"# mine\n{SCRIPT}")
    put(viewer, script)
    assert title_of(viewer) == "Risorius: smile.toml"
    viewer.session.seek(1.0)
    press_keys(viewer, "shift+k")
    assert title_of(viewer) == "Risorius: smile.toml *"
    press_keys(viewer, "ctrl+s")
    assert not viewer.files.is_waiting
    assert title_of(viewer) == "Risorius: smile.toml"
    assert script.read_text().startswith("# mine\n") and len(load_script(script).poses) == 3
    press_keys(viewer, "ctrl+shift+s")
    assert viewer.files.is_waiting
    press_keys(viewer, "ctrl+a")
    write(viewer, "other")
    press_keys(viewer, "Return")
    assert title_of(viewer) == "Risorius: other.toml"
    viewer.messages.attempt(viewer.face.selection.delete)
    press_keys(viewer, "ctrl+s")
    assert len(load_script(tmp_path / "other.toml").poses) == 2
    assert len(load_script(script).poses) == 3


def test_examples_are_opened_by_the_menu(viewer):
    """*File > Examples* has the installed scripts, and opens one in the timeline."""
    click(viewer, "menu File")
    click(viewer, "menu File: Examples")
    click(viewer, "menu File: Speech")
    assert viewer.session.script.duration > 1.0
    assert "speech.toml: opened" in viewer.messages.text.lower()


@pytest.mark.slow
def test_a_head_and_a_script_are_dropped_together(viewer, tmp_path):
    """A dropped head and script: the face changes, the script plays, unsaved work stays."""
    session = viewer.session
    before = session.scene
    mesh, landmarks = user_head().write(tmp_path)
    try:
        session.set("jaw_open", 0.5)
        session.note()
        put(viewer, landmarks)
        assert viewer.messages.is_error
        assert "has only landmarks" in viewer.messages.text
        put(viewer, landmarks, mesh)
        assert until(viewer, lambda: "opened" in viewer.messages.text)
        assert len(session.scene.faces) > len(before.faces)
        assert session.values["jaw_open"] == 0.5
        assert session.work.has_unsaved_pose
        assert until(viewer, lambda: moved(viewer) > 5.0)
        assert viewer.context.stage.refined.triangle_count >= len(session.scene.faces)
        press_keys(viewer, "ctrl+z")
        assert session.values["jaw_open"] == 0.0
        script = tmp_path / "smile.toml"
        script.write_text(SCRIPT)
        put(viewer, mesh, script, landmarks)
        assert until(viewer, lambda: "smile.toml: opened with user_head" in viewer.messages.text)
        session.seek(2.0)
        assert until(viewer, lambda: moved(viewer) > 2.0)
        drag(viewer, nose(viewer), (30, 30))
        assert until(viewer, lambda: viewer.face.mouse.is_dragging_skin)
        xdotool(viewer, "mouseup", 1)
    finally:
        viewer.show_scene(before)
    assert until(viewer, lambda: viewer.schedule.is_idle)


def test_a_head_is_opened_by_the_menu(viewer, tmp_path):
    """The dialog opens a mesh with the landmarks beside it; each kind of file is listed alone."""
    before = viewer.session.scene
    mesh, landmarks = user_head().write(tmp_path)
    landmarks = landmarks.rename(tmp_path / "user_head.landmarks.json")
    (tmp_path / "another.json").write_text("{}")
    click(viewer, "menu File")
    click(viewer, "menu File: Open head ...")
    assert until(viewer, lambda: "file user_head.obj" in viewer.gui.places)
    assert f"file {landmarks.name}" not in viewer.gui.places
    click(viewer, "file user_head.obj", times=2)
    assert until(viewer, lambda: viewer.session.scene is not before)
    assert viewer.settings.recent[0].split("\n") == [str(mesh), str(landmarks)]
    viewer.show_scene(before)


def written(path):
    """Write a table of a jaw that opens within a second, and an unknown column."""
    rows = [f"{k / 30:.4f},{k / 60:.4f},7" for k in range(31)]
    path.write_text("\n".join(["time,jawOpen,mood", *rows]), encoding="utf-8")
    return path


def test_a_recording_is_dropped_played_and_saved_as_a_script(viewer, tmp_path):
    """A dropped recording's kind is named; unsaved work leads to a question first.

    Saving asks for a name, because the recording itself is never overwritten.
    """
    session = viewer.session
    take = written(tmp_path / "take.csv")
    before = take.read_bytes()
    session.set("jaw_open", 0.4)
    put(viewer, take)
    assert viewer.context.question.is_open
    assert session.work.has_unsaved_pose
    click(viewer, "question: Open without saving")
    assert "take.csv: Table of named columns, 31 frames in 1.00 s" in viewer.messages.text
    assert session.script.duration == approx(1.0)
    assert not session.work.unsaved, "the file has it all"
    session.seek(1.0)
    assert until(viewer, lambda: moved(viewer) > 5.0)
    press_keys(viewer, "ctrl+s")
    assert viewer.files.is_waiting
    press_keys(viewer, "Return")
    saved = load_script(tmp_path / "take.toml")
    assert saved.at(0.5)["jawOpen"] == approx(session.script.at(0.5)["jawOpen"])
    assert take.read_bytes() == before


LONG_SCRIPT = "duration = 8.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"


@pytest.fixture(params=["null device", "no device"])
def has_device(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """A device that plays silently, or no device."""
    is_there = request.param == "null device"
    found = [pytest.importorskip("miniaudio").Backend.NULL] if is_there else []
    monkeypatch.setattr(player, "backends", lambda: found)
    return is_there


@pytest.fixture
def sound(viewer: Viewer, tmp_path: Path) -> Iterator[Path]:
    """A sound of half a second of silence, then noise; not yet in the window."""
    samples = np.concatenate([np.zeros(8_000), noise(2.5)])
    (tmp_path / "s.toml").write_text(LONG_SCRIPT)
    viewer.session.work.open(load_script(tmp_path / "s.toml"))
    yield write_wav(tmp_path / "noise.wav", samples)
    viewer.face.soundtrack.close()


def test_a_sound_is_dropped_and_played(viewer, sound, has_device):
    """A dropped sound has its own row, and plays and pauses with the script.

    Without a device no error appears.
    """
    session = viewer.session
    before = viewer.face.timeline.height()
    put(viewer, sound)
    assert "noise.wav" in viewer.messages.text
    assert not viewer.messages.is_error
    assert session.script.sound == sound
    assert session.work.script_is_unsaved
    settle(viewer)
    assert viewer.face.timeline.height() > before
    assert viewer.face.soundtrack.sound is not None
    press_keys(viewer, "space")
    assert session.is_playing
    assert until(viewer, lambda: session.time > 0.2)
    assert until(viewer, lambda: viewer.face.soundtrack.is_heard == has_device)
    press_keys(viewer, "space")
    assert not session.is_playing
    assert not viewer.face.soundtrack.is_heard
    assert not viewer.messages.is_error
    viewer.messages.text = ""
    assert until(viewer, lambda: viewer.schedule.is_idle)


def test_the_waveform_is_seen_and_scrubs(viewer, sound, has_device):
    """Silence is drawn as a line, noise as a band; a press in it goes to that time."""
    put(viewer, sound)
    viewer.face.time_axis.show_whole_script()
    viewer.messages.text = ""
    xdotool(viewer, "mousemove", 2, 2)
    assert until(viewer, lambda: viewer.schedule.is_idle)
    left, top, _, bottom = viewer.gui.places["time"]
    axis = viewer.face.time_axis
    image = viewer.surface.read().astype(int)
    density = image.shape[1] / viewer.surface.size[0]
    upper = round((top + 0.45 * (bottom - top)) * density), round((bottom - 4) * density)

    def contrast(first, last):
        columns = slice(round(axis.x(first) * density), round(axis.x(last) * density))
        return float(image[slice(*upper), columns].std())

    assert contrast(0.6, 1.9) > 2.0 * contrast(0.1, 0.4)
    place = on_screen(viewer, axis.x(1.5), bottom - 6)
    drag_and_release(viewer, place, (0, 0))
    assert viewer.session.time == approx(1.5, abs=0.1)
    assert left < axis.x(0.0)
    assert middle(viewer, "time")


def test_a_name_that_is_no_utf8(viewer, tmp_path):
    """A file name that is not UTF-8 is shown with escapes, and never changed.

    The file is dropped, saved, chosen and opened again.
    """
    session = viewer.session
    script = Path(os.fsdecode(os.fsencode(tmp_path) + b"/l\xe4cheln.toml"))
    script.write_text(SCRIPT)
    drop(viewer, script)
    assert session.file.path == script
    assert not viewer.messages.is_error
    assert viewer.messages.text == r"l\xe4cheln.toml: opened"
    assert title_of(viewer) == r"Risorius: l\xe4cheln.toml"
    session.set("jaw_open", 0.4)
    session.note()
    press_keys(viewer, "k")
    press_keys(viewer, "ctrl+s")
    assert "jaw_open" in script.read_text("utf-8")
    put(viewer, tmp_path / "none.toml")
    press_keys(viewer, "ctrl+o")
    click(viewer, r"file l\xe4cheln.toml", times=2)
    assert session.file.path == script
    assert not viewer.files.is_waiting
    press_keys(viewer, "ctrl+shift+s")
    assert viewer.files.request.target == script
    press_keys(viewer, "Escape")
    press_keys(viewer, "F12")
    assert not viewer.messages.is_error


@pytest.mark.slow
def test_a_known_head_needs_no_marking(viewer, tmp_path):
    """A mesh with the vertices of a known head is shown with muscles, without landmarks."""
    before = viewer.session.scene
    head = coarse_head()
    known = replace(user_head(), mesh=Mesh(head.vertices, head.faces), landmarks=head.landmarks)
    mesh, _ = known.write(tmp_path)
    put(viewer, mesh)
    assert until(viewer, lambda: not viewer.file_drop.is_making)
    assert viewer.marking_mode is None
    assert len(viewer.session.scene.faces) == len(head.faces)
    assert viewer.exporter.head.files == (mesh,)
    viewer.show_scene(before)


@pytest.mark.slow
def test_a_known_head_that_does_not_fit_is_marked(viewer, tmp_path, monkeypatch):
    """A mesh of a known topology with wrong landmarks opens marking; a line gives the reason."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    other = user_head()
    write_topology(tmp_path, other, landmarks=list(range(68)))
    put(viewer, other.write(tmp_path)[0])
    try:
        assert until(viewer, lambda: viewer.marking_mode is not None)
        assert "those of mine" in viewer.messages.text
    finally:
        viewer.leave_marking()
