"""Thinning: how far the keys may be off, and how few of them there are."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.script import Script
from risorius.app.script.recorder import Recorder
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


def test_samples_that_come_no_later_are_left_out() -> None:
    """Two packets within a microsecond make one key; the first one counts."""
    channel = thinned([0.0, 1.0, 1.0, 1.0 + 1e-9, 2.0], [0.0, 1.0, 0.3, 0.4, 0.0])
    assert [(key.time, key.value) for key in channel.keys] == [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]


@given(
    values=st.lists(st.floats(0.0, 1.0) | st.just(0.5), min_size=2, max_size=60),
    looks=st.sets(st.integers(0, 60)),
)
def test_a_recording_that_is_looked_at_is_the_same(values: list[float], looks: set[int]) -> None:
    """Work files ask for it every few seconds: it stays as near to what was played."""
    recorder = Recorder(Script("t", 0.0, "t"), 0.0, {"joy": (0.0, 1.0)})
    for number, value in enumerate(values):
        recorder.add((number + 1) / 60.0, {"joy": value})
        if number in looks:
            recorder.script()
    script = recorder.script()
    if script is None:
        assert max(values) < 1e-5  # what nobody sees is no move
        return
    joy = script.tracks["joy"]
    assert all(early < late for early, late in itertools.pairwise(joy.times))
    played = [script.at(round((number + 1) / 60.0, 6))["joy"] for number in range(len(values))]
    assert np.abs(np.array(played) - values).max() <= TOLERANCE * (1.0 + 1e-6)
    assert joy == type(joy).of(joy.keys)
