"""Scores of a face tracker on rendered faces: how they are counted, and a run with the tracker.

The run needs MediaPipe (the extra 'mediapipe') and its model, the file named by the environment
variable FACE_LANDMARKER.
"""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.scenes import FaceScene
from risorius.bench import seen
from risorius.bench.seen import face_tracker
from tests.app.command_line import risorius

MODEL = Path(os.environ.get("FACE_LANDMARKER", "not given"))
needs_model = pytest.mark.skipif(
    not MODEL.is_file(), reason="FACE_LANDMARKER names no model of the face tracker"
)
NEUTRAL_SCORES = dict.fromkeys(ARKIT_SHAPES, 0.05)


def over(**scores):
    """Scores with these differences from the neutral face."""
    return {**NEUTRAL_SCORES, **{name: 0.05 + score for name, score in scores.items()}}


def test_every_shape_is_asked_for_once():
    """All 52 shapes are scored once.

    A pair of shapes, also of jaw and mouth, has a name without side.
    """
    found = dict(seen.bases())
    assert sorted(name for names in found.values() for name in names) == sorted(ARKIT_SHAPES)
    assert found["eyeBlink"] == ("eyeBlinkLeft", "eyeBlinkRight")
    assert found["jawLeft, Right"] == ("jawLeft", "jawRight")
    assert found["jawOpen"] == ("jawOpen",)


def test_a_pair_counts_by_its_mean():
    """A pair's score is the mean of both sides, after subtraction of the neutral face's scores."""
    scores = over(mouthSmileLeft=0.5, mouthSmileRight=0.3, eyeSquintLeft=0.7)
    shape = seen.compared(scores, NEUTRAL_SCORES, ("mouthSmileLeft", "mouthSmileRight"))
    assert shape == (approx(0.4), "eyeSquint", approx(0.35))
    assert shape.verdict == "seen"
    assert seen.ScoredShape(0.2, "jawOpen", 0.3).verdict == "as jawOpen"


def test_without_mediapipe_one_line_says_so(tmp_path, monkeypatch):
    """MediaPipe is an optional extra: one line explains how to install it."""
    monkeypatch.setitem(sys.modules, "mediapipe", None)
    (tmp_path / "model.task").write_bytes(b"model")
    result = risorius("bench", "seen", "--model", tmp_path / "model.task")
    assert result.exit_code == 2
    assert result.stderr == (
        "risorius: the face tracker needs MediaPipe; install it in the checkout: "
        "pip install '.[mediapipe]'\n"
    )


@pytest.mark.parametrize("content", [b"", b"no model", b"PK\x03\x04 cut short"])
def test_a_file_without_model_is_named(tmp_path, content):
    """A file without a model is named in one line, together with the required file."""
    pytest.importorskip("mediapipe", reason="the extra 'mediapipe'")
    (tmp_path / "other.task").write_bytes(content)
    result = risorius("bench", "seen", "--model", tmp_path / "other.task")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert "other.task: is not a model of MediaPipe's face landmarker" in line


@needs_model
def test_the_tracker_sees_an_open_jaw():
    """The tracker detects an open jaw in a rendered face, and no face in an empty picture."""
    pytest.importorskip("mediapipe", reason="the extra 'mediapipe'")
    with face_tracker(MODEL) as tracker:
        assert tracker(np.zeros((64, 64, 3), dtype=np.uint8)) == {}
        with Capture(FaceScene(), CaptureOptions(size=seen.PICTURE_SIZE)) as studio:
            neutral = seen.pose_scores(tracker, studio, ())
            opened = seen.pose_scores(tracker, studio, ("jawOpen",))
        own, _, score = seen.compared(opened, neutral, ("jawOpen",))
        assert own > 0.5 > score
