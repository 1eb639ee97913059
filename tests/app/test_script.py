"""Scripts: their meaning, and messages for mistakes."""

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.script import LARGEST_NUMBER, Channel, Key, Pose, Script
from risorius.app.script.easings import EASINGS, easing_named, easing_names
from risorius.app.script.script_file import load_script, parse_script, script_text
from tests.app.command_line import refusal, risorius

HELLO_SCRIPT = """
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


def test_poses_and_tracks_add_up():
    """Poses interpolate, tracks are added, and a control that no pose names is zero."""
    script = parse_script(HELLO_SCRIPT, source="hello.toml")
    assert script.at(1.5) == approx({"joy": 0.75, "jaw_open": 0.25, "blink": 0.0})
    assert script.at(2.0) == approx({"joy": 1.25, "jaw_open": 0.5, "blink": 1.0})
    assert script.at(99.0) == approx({"joy": 0.25, "jaw_open": 0.0, "blink": 1.0})
    assert script.duration == 3.0
    assert [(pose.time, pose.name) for pose in script.key_poses] == [(2.0, "top")]


def test_lines_are_keys_as_tables_are():
    """A track of lines equals a track of tables; only the default easing differs."""
    lines = parse_script("[tracks]\njoy = '''\n0 0.5\n 1.5  1 hold\n\n2 -0\n'''", source="s")
    tables = parse_script(
        "[tracks]\njoy = [{ time = 0, value = 0.5, easing = 'linear' },"
        "{ time = 1.5, value = 1, easing = 'hold' }, { time = 2, value = 0, easing = 'linear' }]",
        source="s",
    )
    assert lines == tables
    assert lines.tracks["joy"].keys == tables.tracks["joy"].keys
    assert lines.at(1.75) == {"joy": 0.5}
    assert lines.at(1.0) == {"joy": 0.5}


@st.composite
def channels(draw):
    """Channels with few and many keys, with one easing and with all."""
    times = draw(
        st.lists(st.floats(0.0, LARGEST_NUMBER), unique=True, min_size=1, max_size=60).map(sorted)
    )
    size = {"min_size": len(times), "max_size": len(times)}
    values = draw(st.lists(st.floats(-LARGEST_NUMBER, LARGEST_NUMBER), **size))
    easings = draw(
        st.just(len(times) * ["linear"]) | st.lists(st.sampled_from([*easing_names()]), **size)
    )
    return Channel.from_keys(map(Key, times, values, easings))


@given(tracks=st.dictionaries(st.text(max_size=5), channels(), max_size=3))
def test_a_written_script_reads_back(tracks):
    """A written script is read back with each digit and in order, for both forms of tracks."""
    script = Script("t", 1.0, "t", poses=(Pose(0.0),), tracks=tracks)
    read = parse_script(script_text(script), source="t")
    assert read == script
    assert list(read.tracks) == list(tracks)
    assert script_text(read) == script_text(script)


@given(channel=channels(), data=st.data())
def test_a_channel_has_the_values_of_its_keys(channel, data):
    """At a key the channel has the key's value, and between two keys it follows their easing."""
    keys = channel.keys
    assert channel == Channel.from_keys(keys)
    assert len(channel) == len(keys)
    assert [channel.value(key.time) for key in keys] == [key.value for key in keys]
    time = data.draw(st.floats(0.0, LARGEST_NUMBER))
    before = [key for key in keys if key.time <= time][-1:] or keys[:1]
    after = [key for key in keys if key.time > time][:1] or before
    share = (time - before[0].time) / (after[0].time - before[0].time or 1.0)
    easing = easing_named(after[0].easing)
    way = (after[0].value - before[0].value) * easing.progress(min(max(share, 0.0), 1.0))
    assert channel.value(time) == before[0].value + (way if before[0].time <= time else 0.0)


@given(channel=channels(), start=st.floats(0.0, LARGEST_NUMBER), span=st.floats(1e-3, 1e4))
def test_a_drawn_curve_has_the_played_values(channel, start, span):
    """The drawn curve has the played values; if keys are few, each is drawn."""
    times, values = channel.outline(start, start + span, 40)
    keys = [time for time in channel.times.tolist() if start <= time <= start + span]
    if len(keys) <= 40:
        assert values.tolist() == approx([channel.value(time) for time in times.tolist()])
        assert set(keys) <= set(times.tolist())
        assert np.all(np.diff(times) > 0.0)
    assert len(times) <= 4 * 41
    assert start <= times[1]
    assert times[-1] <= start + span


@given(
    fraction=st.floats(0.0, 1.0),
    name=st.sampled_from([*easing_names()]).filter(lambda name: name != "hold"),
)
def test_easings_are_hermite_curves(fraction, name):
    """Each easing is the cubic from 0 to 1 with the slopes of its name; names are slopes, too."""
    easing = easing_named(name)
    assert easing_named(easing.name) == easing
    curve = scipy.interpolate.CubicHermiteSpline([0.0, 1.0], [0.0, 1.0], easing.slopes)
    assert easing.progress(fraction) == approx(float(curve(fraction)), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "formula"),
    [
        ("linear", lambda x: x),
        ("smooth", lambda x: x * x * (3.0 - 2.0 * x)),
        ("ease-in", lambda x: x * x),
        ("ease-out", lambda x: 1.0 - (1.0 - x) ** 2),
        ("hold", np.floor),
    ],
)
def test_words_for_easings_keep_their_formulas(name, formula):
    """Named easings follow the formulas of the page on scripts, at one time and at many."""
    fractions = np.linspace(0.0, 1.0, 41)
    found = [EASINGS[name].progress(each) for each in fractions.tolist()]
    assert found == approx(formula(fractions), abs=1e-12)
    channel = Channel([0.0, 1.0], [0.0, 1.0], name)
    assert channel.values_at(fractions) == approx(formula(fractions), abs=1e-12)
    assert [channel.value(each) for each in fractions.tolist()] == approx(found, abs=1e-12)


@given(fraction=st.floats(0.0, 1.0), name=st.sampled_from([*easing_names()]))
def test_easings_stay_between_the_keys(fraction, name):
    """Every easing goes from 0 to 1, and stays within this range."""
    ease = easing_named(name).progress
    assert ease(0.0) == 0.0
    assert ease(1.0) == 1.0
    assert -1e-12 <= ease(fraction) <= 1.0 + 1e-12


@pytest.mark.parametrize(
    ("word", "names"), [("smile", "joy or AU12"), ("frowning", "anger or sadness or AU4")]
)
def test_an_everyday_word_finds_its_control(word, names):
    """An everyday word that is not a control's name suggests the control it means."""
    assert f"did you mean {names}" in refusal(risorius("capture", "--set", word, "-o", "x.png"))


def test_a_lone_pose_is_held_for_a_second():
    """A script with one pose at 0 s lasts a second, and its duration is not written."""
    script = parse_script("[[pose]]\ntime = 0\njoy = 1.0", source="one.toml")
    assert script.duration == 1.0
    assert [pose.values for pose in script.poses] == [{"joy": 1.0}]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pose = = 3", r"bad.toml: not valid TOML: .*line 1"),
        ("durration = 1\n[[pose]]\ntime=1", r"unknown key 'durration'; did you mean 'duration'"),
        ("[[pose]]\njoy=1", r"'pose' 1, 'time': is missing"),
        ("[[pose]]\ntime=nan", r"'pose' 1, 'time': was nan"),
        ("[[pose]]\ntime=1\n[[pose]]\ntime=1", r"pose 2: time 1 s does not come after"),
        ("[[pose]]\ntime=1\neasing='x'", r"'easing': was 'x', must be linear, smooth"),
        ("duration=0\n[[pose]]\ntime=0", r"duration is 0 s; it must be above 0"),
        ("duration=1\n[[pose]]\ntime=2\nname='x'", r"pose 'x' at 2 s comes after the duration"),
        ("[tracks]\nblink = 3", r"'blink': was .*, must be a list"),
        ("[tracks]\nb='1 0 lineal'", r"key 1: was '1 0 lineal', must be .* easing: linear, smooth"),
        (
            "[tracks]\nb='''\n0 0\n2 1 hold\n2 0\n'''",
            r"key 3: time 2 s does not come after the key before it \(2 s\)",
        ),
    ],
)
def test_each_mistake_in_a_script_is_named(text, message):
    """Each mistake is reported with the file, the key and the allowed values."""
    with pytest.raises(UserError, match=message):
        parse_script(text, source="bad.toml")


def test_unknown_names_get_a_suggestion():
    """An unknown name is reported with the nearest known ones."""
    script = parse_script(HELLO_SCRIPT, source="hello.toml")
    with pytest.raises(UserError, match=r"hello.toml: unknown name 'joy'; did you mean joyful"):
        script.check(dict.fromkeys(("joyful", "jaw_open", "blink"), (0.0, 1.0)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tracks]\njoy='''0 0\n2 1.5\n3 2'''", r"track 'joy' is 1.5 at 2 s; it must be from -1"),
        ("[[pose]]\ntime=1\njoy=7", r"bad.toml: joy is 7; it must be from 0 to 1$"),
        ("[[pose]]\ntime=1\njaw=-1.1", r"jaw is -1.1; it must be from -1 to 1"),
    ],
)
def test_values_out_of_limits_are_named(text, message):
    """A value beyond the limits is reported with the control, the time and the limits."""
    script = parse_script(text, source="bad.toml")
    with pytest.raises(UserError, match=message):
        script.check({"joy": (0.0, 1.0), "jaw": (-1.0, 1.0)})


def test_missing_and_unreadable_files(tmp_path):
    """A missing script, or one that is not text, gives one clear line."""
    with pytest.raises(UserError, match="no such script"):
        load_script(tmp_path / "nothing.toml")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UserError, match=r"not text in UTF-8 \(byte 0 is 0xff\); save the script"):
        load_script(binary)
    long = tmp_path / "long.toml"
    with long.open("wb") as file:
        file.truncate(2**25 + 1)
    with pytest.raises(UserError, match="is too long; a script may have 32 MB"):
        load_script(long)


def test_a_misspelt_file_names_the_one_beside_it(tmp_path):
    """For a missing script, the message has the most similar name in its folder, if any."""
    (tmp_path / "smile.toml").write_text("[tracks]\njoy = [{ time = 1, value = 1 }]\n")
    with pytest.raises(UserError, match=r"tml: no such script; did you mean .*smile\.toml\?"):
        load_script(tmp_path / "smile.tml")
    with pytest.raises(UserError, match=r"anger\.toml: no such script$"):
        load_script(tmp_path / "anger.toml")


def test_names_are_reported_on_one_line():
    """Terminal codes and line ends are escaped, and long names are shortened."""
    for name, shown in (
        ("a\\nrisorius: b", r"a\nrisorius: b"),
        ("\\u001b[2J", r"\x1b[2J"),
        ("\\u202eyoj", r"\u202eyoj"),
        ("é ü", "é ü"),
    ):
        script = parse_script(f'[[pose]]\ntime=1\n"{name}"=1', source="x.toml")
        with pytest.raises(UserError) as raised:
            script.check({"joy": (0.0, 1.0)})
        assert f"x.toml: unknown name '{shown}'; `risorius controls`" in str(raised.value)
    with pytest.raises(
        UserError, match=r"x.toml: unknown name 'aaaa.* \.\.\. aaa.*lists every"
    ) as raised:
        parse_script(f"[[pose]]\ntime=1\n{10**6 * 'a'}=1", source="x.toml").check({})
    assert len(str(raised.value)) < 2100
