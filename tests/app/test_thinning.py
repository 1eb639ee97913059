"""Thinning of recordings: errors at samples, and the number of keys."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.script.thinning import thinned

SAMPLE = st.tuples(st.integers(1, 10**7), st.floats(-1.0, 1.0))  # [us] after the previous sample


@given(
    samples=st.lists(SAMPLE, min_size=1, max_size=200), tolerance=st.sampled_from([1e-6, 2e-3, 0.3])
)
def test_no_sample_is_further_off_than_the_tolerance(samples, tolerance):
    """For any recording, errors at samples stay within the tolerance.

    Keys are at times of samples, including the first and the last.
    """
    times = np.round(np.cumsum([step for step, _ in samples]) * 1e-6, 6)
    values = np.array([value for _, value in samples])
    channel = thinned(times, values, tolerance)
    played = [channel.value(time) for time in times.tolist()]
    assert np.abs(np.array(played) - values).max() <= tolerance * (1.0 + 1e-6)
    assert set(channel.times) <= set(times)
    assert channel.times[0] == times[0]
    assert channel.times[-1] == times[-1]
    assert {key.easing for key in channel.keys} == {"linear"}


def test_keys_are_few():
    """A ramp has two keys, and a smooth curve of 120 samples has far fewer keys than samples."""
    times = np.round(np.arange(120) / 60.0, 6)
    assert len(thinned(times, 3.0 * times - 1.0)) == 2
    assert len(thinned(times, np.sin(times))) <= 24
