"""Commands of the window on a session alone: files, scripts, sounds, keys, a live face."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.light_maps import read_light_map, scene_light
from risorius.app.live.protocols import Listening
from risorius.app.script.key_sets import KeyId, KeySet
from risorius.app.script.keyframes import POSE_TRACK
from risorius.app.script.script_file import load_script
from risorius.app.viewer.documents import file_drop
from risorius.app.viewer.documents.file_dialogs import FileDialogs
from risorius.app.viewer.documents.file_drop import FileDrop
from risorius.app.viewer.documents.scripts import Question, ScriptCommands
from risorius.app.viewer.messages import Messages
from risorius.app.viewer.picture.stage import style_of
from risorius.app.viewer.session.live_commands import LiveCommands
from risorius.app.viewer.session.physics import IdleLife
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.session.soundtrack import Soundtrack
from risorius.app.viewer.settings import Display, Settings
from risorius.app.viewer.timeline.keys import KeySelection

from .driving import wait_for
from .light_files import HEADER, pixels, rgbe, write_map
from .sounds import noise, write_wav

POSE_SCRIPT = "duration = 1.0\n[[pose]]\ntime = 0.0\njaw_open = 0.5\n"
SCRIPT = "duration = 2.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"


@dataclass
class Desk:
    """A session with its files and messages, as in a window."""

    session: Session
    files: FileDialogs = field(default_factory=FileDialogs)
    messages: Messages = field(default_factory=Messages)
    settings: Settings = field(default_factory=Settings)

    def __post_init__(self) -> None:
        question = Question(self.session)
        note_recent = self.settings.note_recent
        self.scripts = ScriptCommands(self.session, self.files, question, note_recent)
        show = lambda *_: lambda: None  # noqa: E731
        self.file_drop = FileDrop(self.files, self.scripts, self.settings, show, show)

    def drop(self, *paths: Path) -> str:
        """Open dropped files; return the message."""
        self.messages.carry_out(partial(self.file_drop.open, [str(path) for path in paths]))
        return self.messages.text

    def finish(self) -> str:
        """Wait for the thread that reads a light; return the message."""
        wait_for(lambda: not self._is_reading())
        return self.messages.text

    def _is_reading(self) -> bool:
        if self.file_drop.has_news:
            self.messages.attempt(self.file_drop.poll)
        return self.file_drop.is_making

    def save(self) -> str:
        """Save the script; return the message."""
        self.messages.carry_out(self.scripts.save)
        return self.messages.text


@pytest.fixture
def desk(session: Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """A desk in a folder for this test alone; there is no window to wake up."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(file_drop, "wake_up", lambda: None)
    return Desk(session)


def test_an_unreadable_file_is_reported(desk, tmp_path):
    """An unreadable file gives one line, and the current script stays."""
    before = desk.session.script
    bad = tmp_path / "bad.toml"
    bad.write_text(POSE_SCRIPT.replace("jaw_open", "no_such_muscle"))
    line = desk.drop(bad)
    assert desk.messages.is_error
    assert "no_such_muscle" in line and "\n" not in line
    bad.write_bytes(bytes(range(256)))
    assert "is not text in UTF-8" in desk.drop(bad)
    assert "one of them is enough" in desk.drop(bad, tmp_path)
    assert desk.session.script is before
    bad.write_text(POSE_SCRIPT)
    desk.drop(bad)
    assert desk.session.values["jaw_open"] == 0.5


def test_a_dropped_map_lights_the_scene(desk, tmp_path):
    """A map, alone or with a script, lights the scene, and a changed file is read again."""
    sky = write_map(tmp_path / "Sky.HDR")
    desk.drop(sky)
    assert desk.finish() == "Sky.HDR: lights the scene"
    display = desk.settings.display
    assert display.light == str(sky)
    assert desk.settings.recent == [str(sky)]
    assert style_of(display, None).light == read_light_map(sky).light()
    before = scene_light(display.light)
    mirrored = rgbe(pixels())[:, ::-1]
    sky.write_bytes(HEADER + mirrored.tobytes())
    script = tmp_path / "script.toml"
    script.write_text(SCRIPT)
    desk.drop(sky, script)
    desk.finish()
    assert desk.session.script.duration == 2.0
    assert scene_light(display.light).light.to_key[0] == approx(-before.light.to_key[0], abs=0.05)


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (None, "no such file"),
        (b"#?RADIANCE\n\n-Y 32 +X 32\n", "is twice as wide as high"),
        (HEADER + b"zz", "cannot be read as a light map: it is shorter than its size requires"),
    ],
)
def test_a_broken_map_is_one_line(desk, tmp_path, content, line):
    """A missing file, a square picture and a cut-off map are reported; the light stays."""
    bad = tmp_path / "bad.hdr"
    if content is not None:
        bad.write_bytes(content)
    desk.drop(bad)
    text = desk.finish()
    assert line in text and "bad.hdr" in text and "\n" not in text
    assert desk.messages.is_error
    assert desk.settings.display == Display()


def test_saving_asks_where_it_did_not_open(desk, tmp_path):
    """New and built-in scripts ask for a name; a file changed by others is not overwritten."""
    taken = tmp_path / "script.toml"
    taken.write_text("precious")
    desk.scripts.new()
    desk.session.set_key()
    desk.save()
    assert desk.files.request.confirmed() is None  # the name exists, and a line reports this
    assert "is there already" in desk.files.request.complaint
    assert taken.read_text() == "precious"
    desk.files.request = None
    example = Path(str(resources.files("risorius.assets"))) / "scripts" / "speech.toml"
    desk.session.work.open(load_script(example))
    desk.save()
    assert desk.files.is_waiting
    desk.files.request = None
    script = tmp_path / "smile.toml"
    script.write_text(SCRIPT)
    desk.drop(script)
    script.write_text(SCRIPT.replace("joy", "anger"))
    desk.session.set_key()
    assert "another program" in desk.save()
    assert desk.files.is_waiting
    assert "anger" in script.read_text()


def test_the_sound_is_kept_with_the_script(desk, tmp_path):
    """The script's file names the sound; undo and the menu remove it.

    A lost sound file is reported once.
    """
    session = desk.session
    soundtrack = Soundtrack(session)
    script = tmp_path / "s.toml"
    script.write_text(SCRIPT)
    session.work.open(load_script(script))
    sound = write_wav(tmp_path / "noise.wav", noise(2.5))
    assert "noise.wav" in desk.drop(sound)
    desk.save()
    assert load_script(script).sound == sound
    assert not session.work.unsaved
    assert 'sound = "noise.wav"' in script.read_text()

    def is_there() -> bool:
        """Whether the window has the sound now."""
        soundtrack.refresh()
        return soundtrack.sound is not None

    assert is_there()
    session.undo()
    assert session.script.sound is None and not is_there()
    session.redo()
    assert is_there()
    desk.scripts.remove_sound()
    assert not is_there() and not desk.scripts.has_sound
    bad = tmp_path / "bad.mp3"
    bad.write_text("no sound")
    assert "holds no sound" in desk.drop(bad).lower() and desk.messages.is_error
    sound.unlink()
    session.work.open(load_script(script))
    with pytest.raises(UserError, match="no such sound file; the script plays without"):
        soundtrack.refresh()
    soundtrack.refresh()
    session.toggle_playing()
    assert soundtrack.elapsed(0.2) == 0.2


def times(session):
    """Times of the script's poses [s]."""
    return [pose.time for pose in session.script.poses]


def test_delete_and_paste(session):
    """Selected keys are pasted at the playhead and deleted; both can be undone."""
    selection = KeySelection(session)
    selection.keys = KeySet.from_keys(KeyId(POSE_TRACK, 1.0))
    session.seek(2.0)
    selection.copy()
    selection.paste()
    assert times(session) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert session.script.poses[2].name == "joy"
    assert selection.keys == {KeyId(POSE_TRACK, 2.0)}
    assert "1 key deleted" in selection.delete()
    assert times(session) == [0.0, 1.0, 3.0, 4.0]
    selection.select_all()
    with pytest.raises(UserError, match="at least one key"):
        selection.delete()
    session.undo()
    assert times(session) == [0.0, 1.0, 2.0, 3.0, 4.0]
    session.undo()
    assert not session.work.script_is_unsaved


def test_a_script_moves_the_face_alone(session):
    """A script alone moves the face during play and where it stops.

    After the script's end the face has its own life.
    """
    life = IdleLife(session, lambda: True, lambda: np.array([0.0, 0.0, 500.0]))
    assert life.is_on
    session.toggle_playing()
    assert not life.is_on
    session.advance(0.1)
    session.toggle_playing()
    assert session.is_following
    assert not life.is_on
    session.seek(session.script.duration)
    assert life.is_on


def test_live_sets_the_controls_it_names_and_sliders_the_others(session):
    """A live face sets the controls that it names; sliders set the others.

    When the live face ends, its controls have their sliders' values again.
    """
    session.set("jawOpen", 0.2)
    session.set("AU9", 0.3)
    session.live_override.override({"jawOpen": 0.8}, 1.0)
    assert session.current["jawOpen"] == approx(0.8)
    assert session.current["AU9"] == 0.3
    assert session.values["jawOpen"] == 0.2
    session.live_override.override({"jawOpen": 0.8}, 0.0)
    assert session.current["jawOpen"] == 0.2
    session.undo()
    assert session.values["jawOpen"] == 0.0


@pytest.fixture
def listening(session: Session) -> Iterator[LiveCommands]:
    """A window that listens on a free port."""
    made = LiveCommands(session, lambda: None, lambda: None)
    made.start(Listening("livelink", port=0))
    yield made
    made.stop()


def test_a_port_that_is_taken_is_refused(session, listening):
    """A port in use is refused in one line with its number, and nothing is received."""
    other = LiveCommands(session, lambda: None, lambda: None)
    other.wanted = Listening("livelink", port=listening.face.port)
    with pytest.raises(UserError, match="cannot listen"):
        other.toggle()
    assert other.face is None
