"""The real window with a sound: dropped, seen, played, gone through, saved, taken away."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from risorius.app.script import load_script
from risorius.app.sound import player
from risorius.app.viewer import Viewer

from .driving import (
    NEEDS_A_SCREEN,
    drag_and_release,
    drop,
    middle,
    on_screen,
    settle,
    until,
    xdotool,
)
from .sounds import noise, write_wav

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]
SCRIPT = "duration = 8.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"


@pytest.fixture(params=["null device", "no device"])
def has_device(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """A device that plays into nothing, or none at all."""
    is_there = request.param == "null device"
    found = [pytest.importorskip("miniaudio").Backend.NULL] if is_there else []
    monkeypatch.setattr(player, "backends", lambda: found)
    return is_there


@pytest.fixture
def sound(viewer: Viewer, tmp_path: Path) -> Iterator[Path]:
    """Half a second of silence, then noise; not in the window yet."""
    samples = np.concatenate([np.zeros(8_000), noise(2.5)])
    (tmp_path / "s.toml").write_text(SCRIPT)
    viewer.session.open(load_script(tmp_path / "s.toml"))
    yield write_wav(tmp_path / "noise.wav", samples)
    viewer.soundtrack.close()


def test_a_sound_is_dropped_and_played(viewer: Viewer, sound: Path, has_device: bool) -> None:
    """It gets a row of its own, plays and pauses with the script; without a device in peace."""
    before = viewer.timeline.height()
    drop(viewer, sound)
    assert "noise.wav" in viewer.messages.text and not viewer.messages.is_error
    assert viewer.session.script.sound == sound and viewer.session.script_is_unsaved
    settle(viewer)
    assert viewer.timeline.height() > before and viewer.soundtrack.sound is not None
    xdotool(viewer, "key", "space")
    assert viewer.session.is_playing
    assert until(viewer, lambda: viewer.session.time > 0.2)
    assert until(viewer, lambda: viewer.soundtrack.is_heard == has_device)
    xdotool(viewer, "key", "space")
    assert not viewer.session.is_playing and not viewer.soundtrack.is_heard
    assert not viewer.messages.is_error
    viewer.messages.text = ""
    assert until(viewer, lambda: viewer.is_idle)


def test_the_waveform_is_seen_and_scrubs(viewer: Viewer, sound: Path, has_device: bool) -> None:
    """Silence is a line, noise is not; a press in it goes to that time, as in the ruler."""
    drop(viewer, sound)
    viewer.time_axis.show_whole()
    viewer.messages.text = ""
    xdotool(viewer, "mousemove", 2, 2)
    assert until(viewer, lambda: viewer.is_idle)
    left, top, _, bottom = viewer.gui.places["time"]
    axis = viewer.time_axis
    image = viewer.surface.read().astype(int)
    density = image.shape[1] / viewer.surface.size[0]
    upper = round((top + 0.45 * (bottom - top)) * density), round((bottom - 4) * density)

    def contrast(first: float, last: float) -> float:
        columns = slice(round(axis.x(first) * density), round(axis.x(last) * density))
        return float(image[slice(*upper), columns].std())

    assert contrast(0.6, 1.9) > 2.0 * contrast(0.1, 0.4)
    place = on_screen(viewer, axis.x(1.5), bottom - 6)
    drag_and_release(viewer, place, (0, 0))
    assert viewer.session.time == pytest.approx(1.5, abs=0.1)
    assert left < axis.x(0.0) and middle(viewer, "time")


@pytest.mark.parametrize("has_device", ["null device"], indirect=True)
def test_the_sound_is_kept_with_the_script(viewer: Viewer, sound: Path, has_device: bool) -> None:
    """Ctrl+S writes it, undo and the menu take it away, a lost file is told once and survived."""
    drop(viewer, sound)
    xdotool(viewer, "key", "ctrl+s")
    assert load_script(sound.parent / "s.toml").sound == sound and not viewer.session.unsaved
    assert 'sound = "noise.wav"' in (sound.parent / "s.toml").read_text()
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.script.sound is None and viewer.soundtrack.sound is None
    xdotool(viewer, "key", "ctrl+shift+z")
    assert viewer.soundtrack.sound is not None
    viewer.scripts.remove_sound()
    settle(viewer)
    assert viewer.soundtrack.sound is None and not viewer.scripts.has_sound
    bad = sound.parent / "bad.mp3"
    bad.write_text("no sound")
    drop(viewer, bad)
    assert viewer.messages.is_error and "there is no sound in it" in viewer.messages.text
    sound.unlink()
    viewer.session.open(load_script(sound.parent / "s.toml"))
    settle(viewer)
    assert "no such sound file; the script plays without" in viewer.messages.text
    viewer.messages.text = ""
    xdotool(viewer, "key", "space")
    assert until(viewer, lambda: viewer.session.time > 0.2) and not viewer.messages.text
