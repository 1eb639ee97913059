"""Memory: thousands of pictures in one process need no more than the first ones."""

import subprocess
import sys
from pathlib import Path

import pytest

from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Studio
from tests.memory import held_memory

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]


def test_a_studio_forgets_the_persons_before(tmp_path):
    """Thirty samples of about thirty persons take less than 15 MB, a tenth of their buffers."""
    request = request_of(tmp_path, seed=3, size=(96, 96), passes=("segmentation",))
    studio = Studio(request)
    for index in range(12):
        studio.shoot(index)
    before = held_memory()
    for index in range(12, 42):
        studio.shoot(index)
    assert held_memory() - before < 15.0


CAPTURES_PROGRAM = """
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.scenes import FaceScene
from tests.memory import held_memory

scene = FaceScene()
options = CaptureOptions(size=(96, 96))
for _ in range(36):
    for _ in range(4):
        with Capture(scene, options) as capture:
            capture.draw_image()
    print(held_memory())
"""


def test_captures_that_are_opened_and_closed_take_no_memory():
    """The least memory during the last of a hundred captures equals that at the start.

    Memory varies by tens of megabytes, because drivers release pictures late. A separate process
    makes the captures, because pictures of other tests would also be released in it.
    """
    command = [sys.executable, "-c", CAPTURES_PROGRAM]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    held = [float(line) for line in printed.split()]
    assert min(held[-12:]) - min(held[4:16]) < 15.0
