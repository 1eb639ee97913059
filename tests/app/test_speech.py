"""Speech in a sound file becomes visemes: at the right time, as a mouth would form them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius.app.cli import main
from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene
from risorius.app.script import Script, load_script
from risorius.app.sound.speech import Phone, phones_in
from risorius.app.sound.visemes import SHAPES, spoken

from .sounds import HUM, OPEN, noise, voice, write_wav

MAMA = (("", 0.3), (HUM, 0.12), (OPEN, 0.22), (HUM, 0.12), (OPEN, 0.3), ("", 0.3))
TWICE = (*MAMA, *MAMA[1:])
DURATION = 10.0

phone_lists = st.lists(
    st.tuples(
        st.sampled_from(sorted(SHAPES)), st.floats(0.03, 0.3), st.sampled_from([0.0, 0.0, 0.4])
    ),
    min_size=1,
    max_size=20,
)


def phones_of(parts: list[tuple[str, float, float]]) -> list[Phone]:
    """Sounds one after the other: name, how long, and the silence before it."""
    phones, now = [], 0.0
    for name, seconds, silence in parts:
        now += silence
        phones.append(Phone(name, round(now, 2), round(now + seconds, 2)))
        now += seconds
    return phones


@pytest.fixture(scope="module")
def face() -> FaceScene:
    """The built-in head."""
    return FaceScene()


# Sounds to visemes


@settings(max_examples=60, deadline=None)
@given(parts=phone_lists)
def test_visemes_stay_within_a_whole_mouth(parts: list[tuple[str, float, float]]) -> None:
    """All together never exceed 1, none is below 0, silence is neutral, lips close for p, b, m."""
    phones = phones_of(parts)
    script = spoken(phones, Path("x.wav"), DURATION)
    for time in np.arange(0.0, DURATION, 0.01):
        values = script.at(float(time))
        assert all(0.0 <= value <= 1.0 for value in values.values())
        assert sum(values.values()) <= 1.01
    for phone in phones:
        if phone.name in ("P", "B", "M"):
            around = np.linspace(max(phone.start - 0.07, 0.0), phone.end - 0.04, 30)
            assert max(script.at(float(time))["viseme_PP"] for time in around) > 0.99
    end = phones[-1].end + 0.1
    assert not any(script.at(end).values()) and not any(script.at(DURATION).values())


def test_every_sound_names_a_viseme_that_there_is(face: FaceScene) -> None:
    """The table fits the face, and no ARPABET sound is missing."""
    consonants = "B CH D DH F G HH JH K L M N NG P R S SH T TH V W Y Z ZH"
    vowels = "AA AE AH AO AW AY EH ER EY IH IY OW OY UH UW"
    assert set(SHAPES) == set(consonants.split()) | set(vowels.split())
    for shapes in SHAPES.values():
        assert all(f"viseme_{viseme}" in face.limits for viseme, _ in shapes)


def opening(face: FaceScene, script: Script) -> tuple[list[float], list[float]]:
    """How high the mouth is open [mm] at times [s] while a script plays; lips pressed: below 0."""
    marks = face.head.landmarks
    assert marks is not None
    script.check(face.limits)
    face.reset()
    face.pose(script.at(0.0))
    face.step(0.5)
    times, gaps = [], []
    for frame in range(round(script.duration * 60.0)):
        face.pose(script.at(frame / 60.0))
        if frame:
            face.step(1.0 / 60.0)
        apart = face.positions[marks[[61, 62, 63]]] - face.positions[marks[[67, 66, 65]]]
        times.append(frame / 60.0)
        gaps.append(float(apart[:, 1].mean()))
    return times, gaps


def test_lips_close_when_they_are_heard_to(face: FaceScene) -> None:
    """On the simulated face: shut within p, b, m even in fast speech, open within vowels."""
    parts = [("", 0.0, 0.3)]
    for vowel, lips in zip(("AA", "AE", "IY", "OW", "EH", "AA"), "PBMPBM", strict=True):
        parts += [(lips, 0.07, 0.0), (vowel, 0.12, 0.0)]
    phones = phones_of(parts[1:])
    times, gaps = opening(face, spoken(phones, Path("x.wav"), phones[-1].end + 0.3))
    shut = 0.3
    for phone in phones:
        within = np.interp(np.linspace(phone.start, phone.end, 20), times, gaps)
        if phone.name in ("P", "B", "M"):
            assert within.min() < shut, phone
        else:
            assert within.max() > shut + 0.2, phone
    assert gaps[-1] < shut


# What is heard


def test_words_are_laid_along_the_sound(tmp_path: Path) -> None:
    """Where lips part is found to some hundredths of a second, though nobody real speaks."""
    pytest.importorskip("pocketsphinx")
    file = write_wav(tmp_path / "mama.wav", voice(TWICE))
    phones = phones_in(file, "Mama, mama!")
    assert [phone.name for phone in phones] == ["M", "AA", "M", "AH"] * 2
    ends = np.cumsum([seconds for _, seconds in TWICE])
    parting = [end for (shape, _), end in zip(TWICE, ends, strict=True) if shape == HUM]
    found = [phone.end for phone in phones if phone.name == "M"]
    assert found == pytest.approx(parting, abs=0.05)


def test_without_words_only_what_sounds_is_taken_for_speech(tmp_path: Path) -> None:
    """Vowels are found within the voice; nothing long is found in its silence."""
    pytest.importorskip("pocketsphinx")
    file = write_wav(tmp_path / "mama.wav", voice(TWICE))
    phones = phones_in(file)
    vowels = [phone for phone in phones if phone.name in SHAPES and phone.name[0] in "AEIOU"]
    ends = np.cumsum([seconds for _, seconds in TWICE])
    spans = [
        (end - seconds, end)
        for (shape, seconds), end in zip(TWICE, ends, strict=True)
        if shape == OPEN
    ]
    for begin, end in spans:
        assert any(phone.start < end and phone.end > begin for phone in vowels)
    assert all(phone.start < phone.end <= ends[-1] + 0.02 for phone in phones)


def test_speak_writes_a_script_that_speaks(tmp_path: Path, face: FaceScene) -> None:
    """The sound lies beside it, it lasts as long, and the lips close where they are heard to."""
    pytest.importorskip("pocketsphinx")
    file = write_wav(tmp_path / "mama.wav", voice(TWICE))
    target = tmp_path / "made" / "mama.toml"
    words = ["speak", str(file), "--text", "mama mama", "-o", str(target)]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0 and "8 sounds of speech" in result.output
    script = load_script(target)
    assert script.sound == file and 'sound = "../mama.wav"' in target.read_text()
    assert script.duration == pytest.approx(sum(seconds for _, seconds in TWICE), abs=0.01)
    times, gaps = opening(face, script)
    assert np.interp(0.70, times, gaps) < gaps[0] + 0.5 < np.interp(0.55, times, gaps) - 0.5


def test_what_cannot_be_spoken_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unknown words, no words, no speech, no library, no room: one line, and nothing written."""
    file = write_wav(tmp_path / "hiss.wav", noise(1.0) * 1e-3)
    target = tmp_path / "x.toml"

    def told(*words: str) -> str:
        result = CliRunner().invoke(main, ["speak", str(file), "-o", str(target), *words])
        assert result.exit_code == 2 and not target.exists()
        assert len(result.output.splitlines()) == 1
        return result.output

    pytest.importorskip("pocketsphinx")
    assert "not in the dictionary: 42, zyxxor;" in told("--text", "hello Zyxxor 42")
    assert "there are no words" in told("--text", "?!")
    assert "would be written" in told("-o", str(file))
    monkeypatch.setitem(__import__("sys").modules, "pocketsphinx", None)
    with pytest.raises(UserError, match=r"pip install 'risorius\[speech\]'"):
        phones_in(file)
