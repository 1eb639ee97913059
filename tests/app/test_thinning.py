"""Thinning: how far the keys may be off, and how few of them there are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.script.thinning import TOLERANCE, thinned

SAMPLE = st.tuples(st.integers(1, 10**7), st.floats(-1.0, 1.0))  # [us] after the one before


@given(
    samples=st.lists(SAMPLE, min_size=1, max_size=200), tolerance=st.sampled_from([1e-6, 2e-3, 0.3])
)
def test_no_sample_is_further_off_than_the_tolerance(
    samples: list[tuple[int, float]], tolerance: float
) -> None:
    """Whatever was recorded; and keys are at the times of samples, the first and the last too."""
    times = np.round(np.cumsum([step for step, _ in samples]) * 1e-6, 6)
    values = np.array([value for _, value in samples])
    channel = thinned(times, values, tolerance)
    played = [channel.value(time) for time in times.tolist()]
    assert np.abs(np.array(played) - values).max() <= tolerance * (1.0 + 1e-6)
    assert set(channel.times) <= set(times)
    assert channel.times[0] == times[0] and channel.times[-1] == times[-1]
    assert {key.easing for key in channel.keys} == {"linear"}


@pytest.mark.parametrize("seed", range(5))
def test_keys_are_few(seed: int) -> None:
    """No more than the fewest keys that are samples themselves, which a search finds, and a few."""
    chance = np.random.default_rng(seed)
    times = np.round(np.arange(120) / 60.0, 6)
    values = np.round(np.sin(5.0 * times) + chance.normal(0.0, 0.5 * TOLERANCE, 120), 4)
    fewest = [1]
    for end in range(1, 120):
        starts = [
            fewest[start]
            for start in range(end)
            if np.abs(
                np.interp(times[start:end], times[[start, end]], values[[start, end]])
                - values[start:end]
            ).max()
            <= TOLERANCE
        ]
        fewest.append(1 + min(starts))
    assert fewest[-1] <= len(thinned(times, values)) <= 1.15 * fewest[-1]
