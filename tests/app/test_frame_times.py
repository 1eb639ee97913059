"""The times of frames shown in the window."""

import time

from pytest import approx

from risorius.app.viewer.session.physics import FrameTimes


def test_phases_and_frames_agree():
    """Times of phases and of frames describe the same frames; pauses are not counted.

    A new scene begins with empty times.
    """
    times = FrameTimes()
    for elapsed in (0.0, 0.02, 0.02, 0.02):
        times.next_frame(elapsed)
        with times.timed("simulation"):
            times.steps[-1] += 2
        with times.timed("draw"):
            time.sleep(0.005)
    times.next_frame(0.02)
    for _ in range(5):  # pauses
        times.next_frame(2.0)
    assert list(times.whole)[-4:] == [approx(20.0)] * 4
    assert times.frame == approx(20.0)
    assert times.median("draw") >= 5.0
    assert times.median("refinement") == 0.0
    assert list(times.steps)[-4:] == [2] * 4
    times.clear()
    assert times.frame == times.median("draw") == 0.0
