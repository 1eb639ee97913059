"""Memory: thousands of pictures in one process need no more of it than the first ones."""

import pytest

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Studio
from risorius.app.scenes import FaceScene
from tests.memory import held_memory

pytestmark = pytest.mark.slow


def test_a_studio_forgets_the_persons_before(tmp_path):
    """Thirty samples of about as many persons take less than 15 MB, a tenth of their buffers."""
    request = request_of(tmp_path, seed=3, size=(96, 96), passes=("segmentation",))
    studio = Studio(request)
    for index in range(12):
        studio.shoot(index)
    before = held_memory()
    for index in range(12, 42):
        studio.shoot(index)
    assert held_memory() - before < 15.0


def test_captures_that_are_opened_and_closed_take_no_memory():
    """A hundred of one scene: the least that is held while the last are made is as at first.

    Memory goes up and down by tens of megabytes, as drivers give back pictures late.
    """
    scene = FaceScene()
    options = CaptureOptions(size=(96, 96))
    held = list[float]()
    for _ in range(12):
        for _ in range(10):
            with Capture(scene, options) as capture:
                capture.draw_image()
        held.append(held_memory())
    assert min(held[-4:]) - min(held[2:6]) < 15.0
