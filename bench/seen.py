"""Set every shape of ARKit to 1 on our face, and recognise it with a face tracker.

A shape should be recognised by an independent tracker: MediaPipe's face landmarker (Google,
Apache-2.0) finds a face in a picture and scores each of ARKit's shapes, 0 to 1, except `tongueOut`.
Users supply the model file face_landmarker.task. Each shape is drawn from TRACKED_VIEWS, and each
picture is also mirrored, so that differences between the tracker's left and right cancel out. The
report lists mean scores minus those of the neutral face:

    own      score of the shape itself; both sides of a pair are posed, and their mean counts
    highest  the other shape with the highest score, and this score; a pair's score is its mean

A tracker does not measure anatomy: it learned which shapes occur together in real faces, and it
never reports some shapes, not even in scans of real faces (docs/capture.md).
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.drawing import camera_for
from risorius.app.control_names import split_side, twin_of
from risorius.app.errors import UserError
from risorius.app.extras import optional_import
from risorius.app.motion import SETTLING_TIME
from risorius.app.pictures import Image
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.scenes import FaceScene

from .report import table

Scores = dict[str, float]
Tracker = Callable[[Image], Scores]

TRACKED_VIEWS = ("front", "-8,0", "8,0")  # as of people in front of a camera
PICTURE_SIZE = (560, 560)  # pixels; the tracker looks at 256 x 256 of the face


@contextlib.contextmanager
def face_tracker(model: Path) -> Iterator[Tracker]:
    """Open a tracker: a function from a picture (H, W, 3) to the scores of all shapes.

    Without a face the scores are {}. Raises UserError as `face_landmarker` does.
    """
    with face_landmarker(model, output_face_blendshapes=True) as look:

        def scores(image: Image) -> Scores:
            found = look(image).face_blendshapes
            return {each.category_name: float(each.score) for each in found[0]} if found else {}

        yield scores


@contextlib.contextmanager
def face_landmarker(model: Path, **options: bool) -> Iterator[Callable[[Image], Any]]:
    """Open MediaPipe's face landmarker: a function from a picture (H, W, 3) to its result.

    Raises UserError if the file is not a model of this kind, or if MediaPipe is missing.
    """
    with silent():
        mediapipe = optional_import(
            "mediapipe", "the face tracker", "mediapipe", package="MediaPipe"
        )
        from mediapipe.tasks.python import BaseOptions, vision
    base = BaseOptions(model_asset_path=str(model))

    def look(image: Image) -> Any:
        array = np.ascontiguousarray(image)
        picture = mediapipe.Image(image_format=mediapipe.ImageFormat.SRGB, data=array)
        return landmarker.detect(picture)

    try:
        with silent():
            landmarker = vision.FaceLandmarker.create_from_options(
                vision.FaceLandmarkerOptions(base_options=base, **options)
            )
            look(np.zeros((64, 64, 3), dtype=np.uint8))  # the first call is slow
    except (OSError, RuntimeError, ValueError) as error:
        raise UserError(
            f"{model}: is not a model of MediaPipe's face landmarker, which is called "
            f"face_landmarker.task: {error}"
        ) from None
    with contextlib.closing(landmarker):  # an open landmarker fails when Python exits
        yield look


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Silence the tracker's libraries, which print their loading; errors are still raised.

    The libraries write directly to the stream's file descriptor, and no option stops them.
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


class ScoredShape(NamedTuple):
    """The scores of one shape or pair of shapes; the module's docstring defines them."""

    own: float
    highest: str
    score: float

    @property
    def verdict(self) -> str:
        """Whether the tracker recognises the shape, or which other shape it reports."""
        seen_score = 0.1  # lower scores are noise
        if max(self.own, self.score) < seen_score:
            return "not seen"
        return "seen" if self.own >= self.score else f"as {self.highest}"


def pose_scores(tracker: Tracker, studio: Capture, controls: Sequence[str]) -> Scores:
    """Scores with `controls` at 1, averaged over TRACKED_VIEWS and their mirror images."""
    scene = studio.scene
    scene.reset()
    scene.pose(dict.fromkeys(controls, 1.0))
    scene.step(SETTLING_TIME)
    found = []
    for view in TRACKED_VIEWS:
        studio.camera = camera_for(scene, view)
        image = studio.draw_image()
        mirrored = tracker(image[:, ::-1])
        found += [tracker(image), {twin_of(name): mirrored[name] for name in mirrored}]
    if not all(found):
        raise UserError(f"the tracker finds no face with {', '.join(controls) or 'nothing'} at 1")
    return {shape: float(np.mean([each[shape] for each in found])) for shape in found[0]}


def bases() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every shape of ARKit: the name without side, and the names with sides."""
    for name in ARKIT_SHAPES:
        stem, side = split_side(name)
        if not side:
            yield name, (name,)
        elif side == "Left":
            is_direction = stem in ("jaw", "mouth")  # jawLeft is a direction
            title = f"{name}, Right" if is_direction else stem
            yield title, (name, twin_of(name))


def compared(
    scores: Scores, neutral: Scores, own: Sequence[str], posed: Sequence[str] = ()
) -> ScoredShape:
    """Scores minus those of the neutral face, for a pose with the shapes `own` at 1.

    posed: further shapes of the pose, which do not count as confusions. The score of a pair is its
    mean, or the greater one of its scores if only one side was posed.
    """
    is_sided = len(own) == 1 and twin_of(own[0]) != own[0]
    over = {name: scores[name] - neutral[name] for name in scores if name in ARKIT_SHAPES}
    others: dict[str, float] = {}
    for base, sides in bases():
        found = [over[side] for side in sides if side in over]
        if found and not {*sides} & {*own, *posed}:
            others[base] = max(found) if is_sided else float(np.mean(found))
    highest = max(others, key=lambda name: others[name])
    mean = float(np.mean([over.get(name, 0.0) for name in own]))
    return ScoredShape(mean, highest, others[highest])


def measure(tracker: Tracker) -> dict[str, ScoredShape]:
    """Show every shape of the built-in head to the tracker; return scores by name without side."""
    shapes = {}
    with Capture(FaceScene(), CaptureOptions(size=PICTURE_SIZE)) as studio:
        neutral = pose_scores(tracker, studio, ())
        # The keys are shapes whose sides cannot be posed together, or that need another shape. The
        # values are shapes posed with them: both eyes look aside together, and lips close over an
        # open jaw.
        posed_beside = {
            "mouthLeft, Right": (),
            "jawLeft, Right": (),
            "eyeLookIn": ("eyeLookOutRight",),
            "eyeLookOut": ("eyeLookInRight",),
            "mouthClose": ("jawOpen",),
        }
        for base, names in bases():
            own = names
            beside = posed_beside.get(base, ())
            if base in posed_beside:
                own = names[:1]
            scores = pose_scores(tracker, studio, (*own, *beside))
            shapes[base] = compared(scores, neutral, own, beside)
    return shapes


def report(shapes: Mapping[str, ScoredShape]) -> str:
    """The text to print."""
    rows = [
        (name, shape.own, f" {shape.highest}", shape.score, f" {shape.verdict}")
        for name, shape in shapes.items()
    ]
    own = sum(shape.verdict == "seen" for shape in shapes.values())
    return "\n".join(
        [
            "Every shape at 1 on the built-in head, as a face tracker scores it over the neutral",
            f"face: mean of {len(TRACKED_VIEWS)} views and their mirror images; pairs are posed "
            "together.",
            "",
            *table("shape:<17|own:6.2f| highest:<19|score:6.2f| verdict:<1", rows),
            "",
            f"{own} of {len(shapes)} score highest under their own name",
        ]
    )
