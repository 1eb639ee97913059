"""Gaps in recordings, and the order of time: for any rows, a Take is valid."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.recordings.gaps import take_from_rows

odd = st.sampled_from([math.nan, 0.0, 0.25, 1.0])
moments = st.one_of(st.integers(-3, 40).map(lambda number: number / 8.0), st.just(math.nan))


@given(st.lists(st.tuples(moments, odd, odd), min_size=1, max_size=30))
def test_any_rows(rows):
    """Times rise from 0, no value is missing, and all are within the range of given values."""
    times, jaw, smile = np.array(rows).T
    channels = {"jawOpen": jaw, "mouthSmileLeft": smile}
    try:
        take = take_from_rows("any", "take.csv", times, channels)
    except UserError as error:
        assert "face" in str(error) or "time" in str(error)
        assert not np.isfinite(rows).all()
        return
    assert take.times[0] == 0.0
    assert np.all(np.diff(take.times) > 0.0)
    assert take.channels
    for name, values in take.channels.items():
        there = channels[name][np.isfinite(channels[name])]
        assert values.shape == take.times.shape
        assert values.min() >= there.min()
        assert values.max() <= there.max()


def test_rows_are_put_in_the_order_of_their_times():
    """Rows are sorted by time; of two rows with one time the first is used.

    A row whose time is years away is left out.
    """
    times = np.array([0.2, 0.0, 0.1, 0.1, np.nan, 0.3, 1e9])
    take = take_from_rows("any", "x", times, {"jawOpen": np.arange(7) / 10.0})
    assert take.times == approx([0.0, 0.1, 0.2, 0.3])
    assert take.channels["jawOpen"] == approx([0.1, 0.2, 0.0, 0.5])
    assert "3 rows without a time " in take.notes[0]


def test_a_pose_is_held_and_left_at_the_end_of_the_gap():
    """A gap holds the last pose, and changes to the next pose at its end.

    The gap is 0.5 s at 10 frames per second, and values are exact.
    """
    values = np.array([0.2, 0.4, np.nan, np.nan, np.nan, np.nan, 1.0, 1.0])
    take = take_from_rows("any", "x", np.arange(8) / 10.0, {"jawOpen": values})
    expected = [0.2, 0.4, 0.4, 0.4, 0.6, 0.8, 1.0, 1.0]
    assert take.channels["jawOpen"] == approx(expected)


def test_a_slow_recording_has_no_holes():
    """At two frames per second, times are far apart, but no face is missing."""
    take = take_from_rows("any", "x", np.arange(8) / 2.0, {"jawOpen": np.arange(8) / 8.0})
    assert len(take.times) == 8
    assert not take.notes
