"""Sets of keys as arrays, compared with sets and loops over keys."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.script import Channel, Key, Pose, Script, keyframes
from risorius.app.script.easings import EASINGS
from risorius.app.script.key_sets import KeyId, KeySet
from risorius.app.script.keyframes import POSE_TRACK, all_keys

TIMES = st.integers(0, 40).map(lambda step: step / 8.0)  # few values, so that keys often coincide
TRACKS = st.sampled_from([POSE_TRACK, "joy", "blink"])
KEYS = st.frozensets(st.builds(KeyId, TRACKS, TIMES))
EASING = st.sampled_from(sorted(EASINGS))


def keys():
    """Keys of one track, in order of time."""
    key = st.builds(Key, TIMES, st.floats(0.0, 1.0), EASING)
    each_once = st.lists(key, min_size=1, max_size=12, unique_by=lambda each: each.time)
    return each_once.map(lambda found: sorted(found, key=lambda each: each.time))


@st.composite
def scripts(draw):
    """Scripts of poses and two tracks."""
    poses = tuple(Pose(key.time, {"joy": key.value}, key.easing) for key in draw(keys()))
    tracks = {name: Channel.from_keys(draw(keys())) for name in ("joy", "blink")}
    return Script("t", 5.0, "t", poses=poses, tracks=tracks)


@given(keys=KEYS, ends=st.tuples(TIMES, TIMES).map(sorted), reach=st.floats(0.0, 2.0))
def test_keys_between_times_and_nearest(keys, ends, reach):
    """Keys between two times, and the key nearest to a time, are found as by a loop."""
    first, last = ends
    chosen = KeySet.from_keys(*keys)
    assert chosen.between(first, last) == {each for each in keys if first <= each.time <= last}
    near = chosen.nearest(first, reach)
    least = min((abs(each.time - first) for each in keys), default=np.inf)
    assert bool(near) == (least <= reach)
    assert {abs(each.time - first) for each in near} <= {least}
    assert len({each.time for each in near}) <= 1
    if near:
        assert near == {each for each in keys if each.time == near.first}


@given(script=scripts(), keys=KEYS, steps=st.integers(-9, 9), are_copies=st.booleans())
def test_keys_arrive_as_one_by_one(script, keys, steps, are_copies):
    """Moved and copied keys change only their time, and replace other keys there."""
    keys &= all_keys(script)
    shift = max(steps / 8.0, -min((key_id.time for key_id in keys), default=0.0))
    before = dict(keys_by_id(script))
    arrived = {KeyId(track, time + shift): before[track, time] for track, time in keys}
    stays = {key_id: key for key_id, key in before.items() if are_copies or key_id not in keys}
    source = script if are_copies else None
    changed, now = keyframes.moved(script, KeySet.from_keys(*keys), steps / 8.0, source)
    assert now == set(arrived)
    assert changed.duration == max([script.duration, *(time for _, time in arrived)])
    assert dict(keys_by_id(changed)) == stays | arrived
    for times in all_keys(changed).times.values():
        assert np.all(np.diff(times) > 0.0)


@given(script=scripts(), keys=KEYS, easing=EASING)
def test_keys_go_and_are_eased_as_one_by_one(script, keys, easing):
    """Only chosen keys are deleted or eased; tracks without them are shared by both scripts."""
    chosen = KeySet.from_keys(*keys)
    before = dict(keys_by_id(script))
    eased = keyframes.eased(script, chosen, easing)
    expected = dict(before)
    for key_id in keys & before.keys():
        *unchanged, _ = before[key_id]
        expected[key_id] = (*unchanged, easing)
    assert dict(keys_by_id(eased)) == expected
    if not keys >= set(before):
        left = keyframes.without_keys(script, chosen)
        assert dict(keys_by_id(left)) == {
            key_id: key for key_id, key in before.items() if key_id not in keys
        }
    untouched = script.tracks.keys() - chosen.times.keys()
    assert all(eased.tracks[name] is script.tracks[name] for name in untouched)


@given(script=scripts(), time=TIMES)
def test_the_next_key(script, time):
    """The next key, forward or back, is among keys of all tracks; without one the time stays."""
    times = {key_id.time for key_id in all_keys(script)}
    assert keyframes.time_beyond(script, time, 1) == min(
        (t for t in times if t > time), default=time
    )
    assert keyframes.time_beyond(script, time, -1) == max(
        (t for t in times if t < time), default=time
    )


def keys_by_id(script):
    """Pairs of a key's id and the key without its time, for poses and tracks."""
    found = []
    for pose in script.poses:
        found.append((KeyId(POSE_TRACK, pose.time), (pose.values, pose.name, pose.easing)))
    for name, track in script.tracks.items():
        found += [(KeyId(name, key.time), (key.value, key.easing)) for key in track.keys]
    return found
