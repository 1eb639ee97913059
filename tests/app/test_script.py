"""Scripts: what they mean, and what is said when they are wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.easing import EASINGS
from app.errors import UserError
from app.script import load_script, parse_script

HELLO = """
title = "Hello"
[[pose]]
time = 1.0
[[pose]]
time = 2.0
easing = "linear"
name = "top"
joy = 1.0
jaw_open = 0.5
[[pose]]
time = 3.0
easing = "linear"
[tracks]
blink = [ { time = 1.5, value = 0 }, { time = 2.0, value = 1, easing = "hold" } ]
joy = [ { time = 0.0, value = 0.25 } ]
"""


def test_poses_and_tracks_add_up() -> None:
    """Poses interpolate, what a pose does not name is zero, tracks are added."""
    script = parse_script(HELLO, source="hello.toml")
    assert script.at(1.5) == pytest.approx({"joy": 0.75, "jaw_open": 0.25, "blink": 0.0})
    assert script.at(2.0) == pytest.approx({"joy": 1.25, "jaw_open": 0.5, "blink": 1.0})
    assert script.at(99.0) == pytest.approx({"joy": 0.25, "jaw_open": 0.0, "blink": 1.0})
    assert script.duration == 3.0
    assert [(pose.time, pose.name) for pose in script.key_poses] == [(2.0, "top")]


def test_before_the_first_key() -> None:
    """A channel keeps its first value before its first key."""
    script = parse_script("[tracks]\njoy = [{time = 2, value = 0.5}]", source="s")
    assert script.at(0.0) == {"joy": 0.5}


@given(fraction=st.floats(0.0, 1.0), name=st.sampled_from(sorted(EASINGS)))
def test_easings_stay_between_the_keys(fraction: float, name: str) -> None:
    """Every easing goes from 0 to 1 and never leaves that range."""
    ease = EASINGS[name]
    assert ease(0.0) == 0.0
    assert ease(1.0) == 1.0
    assert 0.0 <= ease(fraction) <= 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pose = = 3", r"bad.toml: not valid TOML: .*line 1"),
        ("a = " + 5000 * "[", r"bad.toml: not valid TOML"),
        ("a = " + 5000 * "9", r"bad.toml: not valid TOML"),
        ("", r"bad.toml: no \[\[pose\]\] and no \[tracks\]"),
        ("durration = 1\n[[pose]]\ntime=1", r"unknown key 'durration'; allowed are title"),
        ("[[pose]]\njoy=1", r"pose 1: 'time' is missing"),
        ("[[pose]]\ntime='x'", r"pose 1: 'time' is 'x'; it must be a number"),
        ("[[pose]]\ntime=nan", r"pose 1: 'time' is nan"),
        ("[[pose]]\ntime=inf", r"pose 1: 'time' must lie between"),
        ("[[pose]]\ntime=-1", r"pose 1: time is -1 s; it must be 0 or more"),
        ("[[pose]]\ntime=1\n[[pose]]\ntime=1", r"pose 2: time 1 s does not come after"),
        ("[[pose]]\ntime=1\neasing='x'", r"pose 1: easing 'x'; allowed are linear, smooth"),
        ("[[pose]]\ntime=1\njoy=true", r"pose 1: 'joy' is True; it must be a number"),
        ("[[pose]]\ntime=0", r"duration is 0 s; it must be above 0: write duration = 1.0, or"),
        ("[[pose]]\ntime=1\neasing=['a']", r"pose 1: easing \['a'\]; allowed are"),
        ("[[pose]]\ntime=1" + 400 * "0", r"pose 1: 'time' must lie between -86400 and 86400"),
        ("duration=1\n[[pose]]\ntime=2\nname='x'", r"pose 'x' at 2 s comes after the duration"),
        ("pose = 3", r"'pose' must be a list of tables"),
        ("[tracks]\nblink = 3", r"track 'blink' must be a list"),
        ("[tracks]\nblink = [3]", r"track 'blink', key 1 must be written"),
        ("[tracks]\nblink = [{time=1}]", r"track 'blink', key 1: 'value' is missing"),
        ("[tracks]\nblink = [{time=1,value=1,x=2}]", r"key 1: unknown key 'x'"),
        ("title = 3\n[[pose]]\ntime=1", r"'title' is 3; it must be a text in quotes"),
        ("[[pose]]\ntime=1\nname=3", r"pose 1: 'name' must be a text in quotes"),
    ],
)
def test_what_is_wrong_is_named(text: str, message: str) -> None:
    """Each mistake is told with the file, the key and what is allowed."""
    with pytest.raises(UserError, match=message):
        parse_script(text, source="bad.toml")


def test_unknown_names_get_a_suggestion() -> None:
    """A name that the scene does not have is told with the nearest ones."""
    script = parse_script(HELLO, source="hello.toml")
    with pytest.raises(UserError, match=r"hello.toml: unknown name 'joy'; did you mean joyful"):
        script.check(dict.fromkeys(("joyful", "jaw_open", "blink"), (0.0, 1.0)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[pose]]\ntime=1\njoy=7", r"bad.toml: joy is 7; it must be from 0 to 1$"),
        ("[[pose]]\ntime=1\n[[pose]]\ntime=2.5\njoy=-1", r"joy is -1 at 2.5 s; it must"),
        ("[[pose]]\ntime=1\njaw=-1.1", r"jaw is -1.1; it must be from -1 to 1"),
        (
            "[tracks]\njoy=[{time=1,value=-1},{time=2,value=1.5}]",
            r"track 'joy' is 1.5 at 2 s; it must be from -1 to 1",
        ),
    ],
)
def test_values_out_of_limits_are_named(text: str, message: str) -> None:
    """Too much, or too little, is told with the control, the moment and its limits."""
    script = parse_script(text, source="bad.toml")
    with pytest.raises(UserError, match=message):
        script.check({"joy": (0.0, 1.0), "jaw": (-1.0, 1.0)})


def test_tracks_may_take_away() -> None:
    """What a track adds to the poses may be negative, and the sum may be too much."""
    text = "[[pose]]\ntime=0\njoy=0.8\n[tracks]\njoy=[{time=0,value=-0.5},{time=1,value=1}]"
    script = parse_script(text, source="more.toml")
    script.check({"joy": (0.0, 1.0)})
    assert script.at(1.0)["joy"] == pytest.approx(1.8)


def test_missing_and_unreadable_files(tmp_path: Path) -> None:
    """A script that is not there, or is no text, is one clear line."""
    with pytest.raises(UserError, match="no such script"):
        load_script(tmp_path / "nothing.toml")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UserError, match="cannot be read as a text file"):
        load_script(binary)
    with pytest.raises(UserError, match="is longer than a script may be, 16 MB"):
        load_script(Path("/dev/zero"))


def test_scripts_of_other_editors(tmp_path: Path) -> None:
    """A byte order mark and line ends of Windows are no mistake."""
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf[[pose]]\r\ntime = 2.0\r\njoy = 1.0\r\n")
    assert load_script(path).at(2.0) == {"joy": 1.0}
