"""A judge of our faces from outside: MediaPipe's face landmarker, which scores pictures of faces.

It finds a face in a picture and says how far each of ARKit's shapes is there, 0 to 1, all but
`tongueOut`. Its model is a file that users bring: face_landmarker.task.

    with FaceTracker(Path("face_landmarker.task")) as tracker:
        scores = tracker.scores(image)

Source: Google, MediaPipe Tasks, Face Landmarker (Apache-2.0).
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType

import numpy as np

from risorius.app.controls.mirror import twin_of
from risorius.app.errors import UserError, needed
from risorius.app.files import Image

Scores = dict[str, float]


class FaceTracker:
    """The tracker with one model loaded; a context manager, because it must be closed.

    Left open it is closed as Python ends, and fails at that.
    """

    def __init__(self, model: Path) -> None:
        """Load a model file. UserError where it is none, and where MediaPipe is not installed."""
        with _silent():
            mediapipe = needed("mediapipe", "the face tracker", "mediapipe", package="MediaPipe")
            from mediapipe.tasks.python import BaseOptions, vision
        options = vision.FaceLandmarkerOptions(
            base_options=BaseOptions(model_asset_path=str(model)), output_face_blendshapes=True
        )
        self._image, self._format = mediapipe.Image, mediapipe.ImageFormat.SRGB
        try:
            with _silent():
                self._landmarker = vision.FaceLandmarker.create_from_options(options)
                self.scores(np.zeros((64, 64, 3), dtype=np.uint8))  # what it does once, it does now
        except (OSError, RuntimeError, ValueError) as error:
            raise UserError(
                f"{model}: is no model of MediaPipe's face landmarker, which is called "
                f"face_landmarker.task: {error}"
            ) from None

    def __enter__(self) -> FaceTracker:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._landmarker.close()

    def scores(self, image: Image) -> Scores:
        """Every shape's score in a picture (H, W, 3); {} where it finds no face."""
        picture = self._image(image_format=self._format, data=np.ascontiguousarray(image))
        found = self._landmarker.detect(picture).face_blendshapes
        return {each.category_name: float(each.score) for each in found[0]} if found else {}


def in_mirror(scores: Scores) -> Scores:
    """Scores of a mirrored picture as those of the face itself: left and right change places."""
    return {twin_of(name): score for name, score in scores.items()}


def mean_of(scores: Sequence[Scores]) -> Scores:
    """The mean of each score over the pictures in which there is a face; {} where none is."""
    found = [each for each in scores if each]
    return (
        {name: float(np.mean([each[name] for each in found])) for name in found[0]} if found else {}
    )


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep the tracker's libraries from telling the error stream how they load; errors are raised.

    They write to the stream's number, past Python, and have no switch for it.
    """
    sys.stderr.flush()
    kept = os.dup(2)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
