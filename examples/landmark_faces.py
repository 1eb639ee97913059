"""Cut faces with their 68 points out of the pictures of a data set, and out of photographs.

`train_landmarks.py` trains on the data set and tests on the photographs. A photograph with a `.pts`
file beside it, as in 300-W, has one face, marked by hand. In other photographs dlib finds the
faces, and its points serve as the truth.
"""

from __future__ import annotations

import functools
import importlib.util
import json
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius.bench.landmarks import packaged_model
from risorius.faces import Faces

Face = tuple[np.ndarray, np.ndarray]  # a picture (3, 144, 144) 0..255, points (68, 2) from -1 to 1

PICTURE_SIDE = 96  # side of the network's pictures [pixels]
STORED_SIDE = 144  # side of stored pictures, in which the network's pictures are turned and moved


def cut_out(picture: PIL.Image.Image, points: np.ndarray) -> Face:
    """Cut out the face around points 17 to 67. points: (68, 2) [pixels].

    Outside the picture is its mirror image. A black margin would show the network where the face
    is, in most samples but in few photographs.
    """
    low = points[17:].min(axis=0)
    high = points[17:].max(axis=0)
    size = (high - low).max()
    middle = 0.5 * (low + high) + [0.0, 0.15 * size]  # the chin is below
    half = 0.85 * size * STORED_SIDE / PICTURE_SIDE
    factor = max(round(2.0 * half / STORED_SIDE), 1)
    small = np.asarray(picture.convert("RGB").reduce(factor))
    height, width = small.shape[:2]
    corner = np.array([width, height])  # of the picture within the mirrored one
    box = (*((middle - half) / factor + corner), *((middle + half) / factor + corner))
    mirrored = np.pad(small, ((height, height), (width, width), (0, 0)), mode="reflect")
    cut = PIL.Image.fromarray(mirrored).transform(
        (STORED_SIDE, STORED_SIDE),
        PIL.Image.Transform.EXTENT,
        box,
        PIL.Image.Resampling.BILINEAR,
    )
    channels = np.array(cut).transpose(2, 0, 1)
    scaled = (points - middle) / half
    return channels, scaled.astype(np.float32)


def read_set(faces: Faces, numbers: list[int], is_on_bone: bool) -> list[Face]:
    """Read samples of a set. is_on_bone: use the rig's jaw landmarks in place of the outline's."""
    found = []
    for number in numbers:
        sample = faces[number]
        points = sample["pixels"][:68].copy()
        if is_on_bone:
            labels = json.loads(faces.files(number)["json"])["landmarks"]
            points[:17] = labels["jaw_on_bone"]["pixels"]
        picture = np.rint(255.0 * sample["image"].transpose(1, 2, 0)).astype(np.uint8)
        found.append(cut_out(PIL.Image.fromarray(picture), points))
    return found


@functools.cache
def opened_dlib() -> tuple[Any, Any]:
    """dlib's detector of faces, and its predictor of 68 points."""
    import dlib

    return dlib.get_frontal_face_detector(), dlib.shape_predictor(str(packaged_model()))


def read_by_dlib(picture: np.ndarray, doublings: int = 0) -> list[np.ndarray]:
    """The 68 points [pixels] of each face; [] without dlib.

    doublings: number of times that the picture's size is doubled before the search.
    """
    if importlib.util.find_spec("dlib") is None:
        return []
    detect, predict = opened_dlib()
    shapes = [predict(picture, box).parts() for box in detect(picture, doublings)]
    return [np.array([(point.x, point.y) for point in shape], float) for shape in shapes]


def points_of_dlib(faces: list[Face]) -> np.ndarray:
    """dlib's points in cut-out faces, (n, 68, 2) from -1 to 1; NaN if it finds no face."""
    return np.stack([_middle_face(cut) for cut, _ in faces])


def _middle_face(cut: np.ndarray) -> np.ndarray:
    """dlib's points of the face nearest to the middle, because margins may have mirrored faces."""
    found = read_by_dlib(np.ascontiguousarray(cut.transpose(1, 2, 0)), 1)
    scaled = [points / (STORED_SIDE / 2) - 1.0 for points in found]
    nothing = np.full((68, 2), np.nan)
    return min(scaled, key=_distance_from_middle, default=nothing)


def _distance_from_middle(points: np.ndarray) -> float:
    """Distance of the points' mean from the middle of the picture, along the farther axis."""
    return float(np.abs(points.mean(axis=0)).max())


def read_photographs(folder: Path) -> tuple[list[Face], list[Face]]:
    """Faces in photographs: faces with a .pts file, and faces that dlib finds."""
    by_hand = []
    by_dlib = []
    kinds = (".jpg", ".jpeg", ".png", ".ppm")
    for file in sorted(path for path in folder.iterdir() if path.suffix.lower() in kinds):
        picture = PIL.Image.open(file).convert("RGB")
        marks = file.with_suffix(".pts")
        if marks.exists():
            text = marks.read_text("utf-8").partition("{")[2].partition("}")[0]
            points = np.array(text.split(), float).reshape(68, 2)
            by_hand.append(cut_out(picture, points - 0.5))  # .pts files count pixels from 1
        else:
            by_dlib += [cut_out(picture, points) for points in read_by_dlib(np.asarray(picture))]
    return by_hand, by_dlib
