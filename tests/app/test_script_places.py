"""Places of keys as arrays, compared with sets and loops over keys."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.script import Channel, Key, Pose, Script, keyframes
from risorius.app.script.easings import EASINGS
from risorius.app.script.keyframes import POSES, places_of
from risorius.app.script.places import KeyPlace, Places

TIMES = st.integers(0, 40).map(lambda step: step / 8.0)  # few values, so that keys often coincide
TRACKS = st.sampled_from([POSES, "joy", "blink"])
PLACES = st.frozensets(st.builds(KeyPlace, TRACKS, TIMES))
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
    tracks = {name: Channel.of(draw(keys())) for name in ("joy", "blink")}
    return Script("t", 5.0, "t", poses=poses, tracks=tracks)


@given(places=PLACES, ends=st.tuples(TIMES, TIMES).map(sorted), reach=st.floats(0.0, 2.0))
def test_places_in_a_stretch_and_near(places, ends, reach):
    """Keys between two times, and the key nearest to a time, are found as by a loop."""
    first, last = ends
    chosen = Places.of(*places)
    assert chosen.between(first, last) == {each for each in places if first <= each.time <= last}
    near = chosen.near(first, reach)
    least = min((abs(each.time - first) for each in places), default=np.inf)
    assert bool(near) == (least <= reach)
    assert {abs(each.time - first) for each in near} <= {least}
    assert len({each.time for each in near}) <= 1
    if near:
        assert near == {each for each in places if each.time == near.first}


@given(script=scripts(), places=PLACES, steps=st.integers(-9, 9), are_copies=st.booleans())
def test_keys_arrive_as_one_by_one(script, places, steps, are_copies):
    """Moved and copied keys change only their time, and replace other keys there."""
    places &= places_of(script)
    shift = max(steps / 8.0, -min((place.time for place in places), default=0.0))
    before = dict(keyed_by_place(script))
    arrived = {KeyPlace(track, time + shift): before[track, time] for track, time in places}
    stays = {place: key for place, key in before.items() if are_copies or place not in places}
    source = script if are_copies else None
    changed, now = keyframes.moved(script, Places.of(*places), steps / 8.0, source)
    assert now == set(arrived)
    assert changed.duration == max([script.duration, *(time for _, time in arrived)])
    assert dict(keyed_by_place(changed)) == stays | arrived
    for times in places_of(changed).times.values():
        assert np.all(np.diff(times) > 0.0)


@given(script=scripts(), places=PLACES, easing=EASING)
def test_keys_go_and_are_eased_as_one_by_one(script, places, easing):
    """Only chosen keys are deleted or eased; tracks without them are shared by both scripts."""
    chosen = Places.of(*places)
    before = dict(keyed_by_place(script))
    eased = keyframes.eased(script, chosen, easing)
    assert dict(keyed_by_place(eased)) == {
        place: (*key[:-1], easing) if place in places else key for place, key in before.items()
    }
    if not places >= set(before):
        left = keyframes.without(script, chosen)
        assert dict(keyed_by_place(left)) == {
            place: key for place, key in before.items() if place not in places
        }
    untouched = script.tracks.keys() - chosen.times.keys()
    assert all(eased.tracks[name] is script.tracks[name] for name in untouched)


@given(script=scripts(), time=TIMES)
def test_the_next_key(script, time):
    """The next key, forward or back, is among keys of all tracks; without one the time stays."""
    times = {place.time for place in places_of(script)}
    assert keyframes.time_beyond(script, time, 1) == min(
        (t for t in times if t > time), default=time
    )
    assert keyframes.time_beyond(script, time, -1) == max(
        (t for t in times if t < time), default=time
    )


def keyed_by_place(script):
    """Pairs of a key's place and the key without its time, for poses and tracks."""
    found = []
    for pose in script.poses:
        found.append((KeyPlace(POSES, pose.time), (pose.values, pose.name, pose.easing)))
    for name, track in script.tracks.items():
        found += [(KeyPlace(name, key.time), (key.value, key.easing)) for key in track.keys]
    return found
