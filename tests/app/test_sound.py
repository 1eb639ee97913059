"""Sound files: read, named by scripts, in films, drawn at every zoom, played in time."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.signal
from pytest import approx

from risorius.app.capture import outputs
from risorius.app.capture.outputs import SOUND_FILM_SUFFIXES
from risorius.app.capture.outputs import FilmSound as Heard
from risorius.app.errors import UserError
from risorius.app.scenes import PlaneScene
from risorius.app.script import Script
from risorius.app.script.script_file import load_script, parse_script, save_script, script_text
from risorius.app.sound import player
from risorius.app.sound.decoding import Sound, load_sound
from risorius.app.sound.player import Player
from risorius.app.viewer.session.physics import STEP_TIME, Clock
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.session.soundtrack import Soundtrack

from .command_line import risorius
from .sounds import noise, write_wav

POSE_SCRIPT = "[[pose]]\ntime = 1.0\n"
GREY_PICTURE = np.full((48, 64, 3), 128, np.uint8)
FRAME_TIME = 1.0 / 30.0  # [s]


def lag(heard, source):
    """The delay of a sound within another sound that contains it [s]."""
    first, second = (each.samples[:, 0].astype(float) for each in (heard, source))
    length = len(first) + len(second)
    spectrum = np.fft.rfft(first, length) * np.conj(np.fft.rfft(second, length))
    best = int(np.fft.irfft(spectrum, length).argmax())
    return (best if best < len(first) else best - length) / heard.rate


# Files.


def test_a_wav_is_read_to_the_sample(tmp_path):
    """Samples at the usual rate are unchanged; sounds of more than two channels become stereo."""
    for sides in (1, 2):
        samples = np.stack([noise(0.5, 48_000, seed=seed) for seed in range(sides)], axis=1)
        sound = load_sound(write_wav(tmp_path / "a b, ü.wav", samples, 48_000))
        assert sound.samples.shape == (24_000, sides)
        assert sound.duration == 0.5
        assert np.abs(sound.samples / 32_767 - samples).max() < 1e-4
    six = load_sound(write_wav(tmp_path / "six.wav", np.zeros((100, 6)), 48_000))
    assert six.samples.shape == (100, 2)


@pytest.mark.parametrize("rate", [8_000, 22_050, 44_100])
def test_other_rates_are_in_step(tmp_path, rate):
    """A sound of another rate has the same length, and every part stays at its time."""
    source = noise(1.0, 48_000)
    write_wav(tmp_path / "high.wav", source, 48_000)
    low = scipy.signal.resample(source, rate)
    again = load_sound(write_wav(tmp_path / "low.wav", low, rate))
    assert again.duration == approx(1.0, abs=2e-3)
    assert lag(again, load_sound(tmp_path / "high.wav")) == approx(0.0, abs=5e-4)


def test_an_unreadable_sound_is_reported_in_one_line(tmp_path):
    """An unreadable sound is reported in one line with the fault and the remedy.

    Cases: missing, empty, damaged, silent, a folder, a pipe.
    """
    (tmp_path / "text.wav").write_text("no sound")
    (tmp_path / "empty.wav").touch()
    write_wav(tmp_path / "mute.wav", np.zeros(0))
    (tmp_path / "list.m3u8").write_text(f"#EXTM3U\n#EXTINF:1,\n{tmp_path}/text.wav\n")
    with outputs.film(tmp_path / "mute.mp4", (64, 48), 25.0) as add:
        add(GREY_PICTURE)
    for name in ("text.wav", "empty.wav", "mute.wav", "list.m3u8", "mute.mp4"):
        with pytest.raises(UserError, match=f"{name}: holds no sound") as raised:
            load_sound(tmp_path / name)
        assert "\n" not in str(raised.value)
    with pytest.raises(UserError, match=r"nothing\.wav: no such sound file"):
        load_sound(tmp_path / "nothing.wav")
    with pytest.raises(UserError, match="is a folder"):
        load_sound(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.wav")
        with pytest.raises(UserError, match="is a pipe"):
            load_sound(tmp_path / "pipe.wav")


# Scripts.


def test_a_script_names_its_sound_as_seen_from_itself(tmp_path):
    """A script's sound is found from any working directory, by relative or absolute path."""
    for name in ("speech.wav", "sounds/speech.wav", "../speech.wav", str(tmp_path / "speech.wav")):
        script = parse_script(
            f"sound = '{name}'\n{POSE_SCRIPT}", source=str(tmp_path / "deep" / "s.toml")
        )
        assert script.sound == Path(os.path.normpath(tmp_path / "deep" / name))
    assert parse_script(POSE_SCRIPT, source="s").sound is None
    for wrong, why in (("7", "must be a text"), ("''", "is empty")):
        with pytest.raises(UserError, match=f"'sound'.*{why}"):
            parse_script(f"sound = {wrong}\n{POSE_SCRIPT}", source="s")


def test_a_project_stays_together(tmp_path):
    """A script saved elsewhere finds its sound, and so does a project moved as a whole."""
    home = tmp_path / "home"
    (home / "sounds").mkdir(parents=True)
    sound = home / "sounds" / "a.wav"
    script = parse_script(f"sound = '{sound}'\n{POSE_SCRIPT}", source="s")
    save_script(home / "s.toml", script)
    assert 'sound = "sounds/a.wav"' in (home / "s.toml").read_text()
    save_script(home / "other" / "s.toml", script)
    assert 'sound = "../sounds/a.wav"' in (home / "other" / "s.toml").read_text()
    far = tmp_path / "quite" / "elsewhere" / "s.toml"
    save_script(far, script)
    for path in (home / "s.toml", home / "other" / "s.toml", far):
        assert load_script(path).sound == sound
    assert parse_script(script_text(script), source="anywhere") == script
    shutil.move(home, tmp_path / "moved")
    found = load_script(tmp_path / "moved" / "s.toml").sound
    assert found == tmp_path / "moved" / "sounds" / "a.wav"


# Films.


@pytest.mark.parametrize("suffix", SOUND_FILM_SUFFIXES)
@pytest.mark.parametrize(("seconds", "rate"), [(2.0, 48_000), (0.6, 22_050)])
def test_a_film_is_heard_in_step(tmp_path, suffix, seconds, rate):
    """A film's first frame is at the first sample; a longer sound is cut, a shorter one kept."""
    source = write_wav(tmp_path / "noise.wav", noise(seconds, rate), rate)
    film = tmp_path / f"film{suffix}"
    with outputs.film(film, (64, 48), 30.0, Heard(source, 1.0)) as add:
        for _ in range(31):
            add(GREY_PICTURE)
    heard = load_sound(film)
    assert abs(lag(heard, load_sound(source))) < 5e-3
    assert heard.duration == approx(min(seconds, 1.0), abs=0.05)
    import imageio_ffmpeg

    assert imageio_ffmpeg.count_frames_and_secs(str(film))[0] == 31


def test_capture_takes_the_sound_of_script_and_option(tmp_path, monkeypatch):
    """--sound overrides the script's sound; only films have sound and accept the option."""
    monkeypatch.chdir(tmp_path)
    write_wav(tmp_path / "own.wav", noise(0.4))
    write_wav(tmp_path / "other.wav", noise(0.4, seed=1))
    (tmp_path / "s.toml").write_text("scene = 'plane'\nsound = 'own.wav'\n[[pose]]\ntime = 0.2\n")

    def capture(*words):
        result = risorius("capture", "s.toml", "--size", "64x48", "--quiet", *words)
        return result.exit_code, result.output

    assert capture("-o", "own.mp4")[0] == 0
    assert capture("-o", "other.mp4", "--sound", "other.wav")[0] == 0
    for name in ("own", "other"):
        assert abs(lag(load_sound(Path(f"{name}.mp4")), load_sound(Path(f"{name}.wav")))) < 5e-3
    assert capture("-o", "frame.png")[0] == 0
    for silent in ("frame.png", "frames"):
        assert "only films with sound can hold it" in capture("-o", silent, "--sound", "own.wav")[1]
    assert "no such sound file" in capture("-o", "none.mp4", "--sound", "nothing.wav")[1]
    assert "is both an input and an output" in capture("-o", "own.mp4", "--sound", "own.mp4")[1]
    (tmp_path / "own.wav").unlink()
    assert capture("-o", "frame.png")[0] == 0
    assert "own.wav: no such sound file" in capture("-o", "gone.mp4")[1]
    assert not (tmp_path / "gone.mp4").exists()


# Playing.


class HandDevice:
    """A device that requests samples on the test's call, with the test's clock."""

    def __init__(self):
        self.running = False
        self.now = 0.0
        self._samples = None

    def start(self, samples):
        self.running = True
        self._samples = samples

    def stop(self):
        self.running = False

    close = stop

    def ask(self, count):
        """Request the next frames, (count, C)."""
        return np.asarray(self._samples.send(count))


COUNT = round(player.PERIOD_TIME * 48_000)


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> HandDevice:
    """The device that players use."""
    hand_device = HandDevice()
    monkeypatch.setattr(player, "open_device", lambda rate, channels: hand_device)
    return hand_device


def ramp(seconds):
    """A sound whose samples are their own times [ms]."""
    samples = (np.arange(round(seconds * 48_000)) // 48).astype(np.int16)
    return Sound(Path("ramp"), np.stack([samples, samples], axis=1))


@pytest.mark.parametrize("speed", [0.25, 1.0, 2.0])
def test_a_player_gives_the_sound_from_the_place_on(device, speed):
    """At each speed samples are those of the current time; after the end there is silence."""
    played = Player(ramp(2.0), clock=lambda: device.now)
    played.play(1.0, speed)
    first = device.ask(COUNT)
    assert first[0, 0] == 1000
    assert abs(first[-1, 0] - (1000 + 1000 * speed * player.PERIOD_TIME)) <= 1
    second = device.ask(COUNT)
    assert abs(int(second[0, 0]) - int(first[-1, 0])) <= 2
    played.play(0.5)
    assert device.ask(COUNT)[0, 0] == 500
    assert played.speed == 1.0
    played.play(1.99)
    end = device.ask(COUNT)
    assert end[0, 0] == 1990
    assert not end[-1].any()
    assert not device.ask(COUNT).any()
    played.play(0.5, seconds=0.01)
    snippet = device.ask(COUNT)
    assert snippet[0, 0] == 500
    assert not snippet[round(0.01 * 48_000) :].any()
    played.stop()
    assert not device.ask(COUNT).any()
    assert device.running
    assert not played.is_heard
    played.rest()
    assert not device.running


@pytest.mark.parametrize("pace", [0.99, 1.0, 1.01])
@pytest.mark.parametrize("frames_per_second", [12.0, 60.0, 144.0])
def test_the_picture_keeps_to_the_sound(device, pace, frames_per_second, monkeypatch):
    """Over a minute picture and sound differ by less than a frame, for any clock of the device.

    pace: seconds of the device per second of the window, whose physics steps are unchanged.
    """
    played = []

    def play(sound):
        played.append(Player(sound, clock=lambda: device.now))
        return played[0]

    monkeypatch.setattr("risorius.app.viewer.session.soundtrack.Player", play)
    sound = ramp(30.0)
    sound = replace(sound, samples=np.tile(sound.samples, (3, 1)))
    monkeypatch.setattr("risorius.app.viewer.session.soundtrack.load_sound", lambda file: sound)
    session = Session(PlaneScene(), Script("", 80.0, "s", "plane", sound=Path("ramp")))
    soundtrack = Soundtrack(session)
    clock = Clock()
    soundtrack.refresh()
    session.toggle_playing()
    soundtrack.elapsed(0.0)  # playback starts: the device fills its buffer
    for _ in range(player.PERIOD_COUNT):
        device.ask(COUNT)
    due = player.PERIOD_TIME / pace
    off = []
    for frame in range(1, round(60.0 * frames_per_second)):
        now = frame / frames_per_second
        while due <= now:
            device.now = due
            device.ask(COUNT)
            due += player.PERIOD_TIME / pace
        device.now = now
        session.time += clock.steps(soundtrack.elapsed(1.0 / frames_per_second)) * STEP_TIME
        assert played[0].position == approx(now * pace, abs=2e-3)
        off.append(now * pace - session.time)
    assert np.abs(off).max() < FRAME_TIME
    assert abs(np.median(off)) < 0.5 * FRAME_TIME
