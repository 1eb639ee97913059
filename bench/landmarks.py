"""Compare landmarks of third-party detectors with the labels of a data set.

dlib's shape predictor learned iBug's 68 points (Kazemi, Sullivan 2014; Sagonas et al. 2016).
MediaPipe's face landmarker (Google, Apache-2.0) has its own mesh. Here the 68 points are placed on
lines of this mesh by the rules of iBug's scheme: evenly along a brow or a jaw, and half way between
the peak and the corner of the lips. An error is a distance in the picture, in hundredths of the
distance between the outer corners of the eyes at their depth. It has two parts:

    constant the mean offset of a point on frontal pictures, both sides as one: another definition
    the rest   the detector's own error on these pictures

A detector checks the definition of landmarks; it does not measure a face's form. Pictures of masked
persons are left out, because a detector can only guess there.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius.app.dataset.table import NOTHING_WORN
from risorius.app.errors import UserError
from risorius.app.extras import optional_import
from risorius.app.pictures import Image
from risorius.geometry.arrays import Flags, Floats64
from risorius.geometry.polylines import arc_lengths, evenly_spaced
from risorius.sim.landmarks import MIRRORED_LANDMARKS

from .averages import mean, median
from .report import Target, at_most, table
from .seen import face_landmarker
from .subjects import LANDMARK_GROUPS

Detector = Callable[[Image], Floats64 | None]

DETECTOR_TITLES = {"dlib": "dlib", "mediapipe": "MediaPipe"}
# The points of the face's right side.
RIGHT_LANDMARKS = {
    *range(8),
    *range(17, 22),
    31,
    32,
    *range(36, 42),
    48,
    49,
    50,
    58,
    59,
    60,
    61,
    67,
}
MOST_ERROR = {"dlib": 3.0, "mediapipe": 2.8}  # percent, on frontal pictures
MOST_CONSTANT = 1.5  # percent, of any point
FAILED_ERROR = 10.0  # percent; a detector with a larger mean error in a picture missed the face
MOST_YAW = 10.0  # [degrees]; heads of frontal pictures turn less


@dataclass(frozen=True)
class DetectorErrors:
    """The errors of a detector on the pictures of a set.

    errors: error of each point in each picture [percent of the eyes' distance], (n, 68, 2); the
    first axis runs along the line of the eyes to the subject's left, the second down the face. yaw:
    yaw of each head [degrees], (n,). picture_count: number of pictures without a mask, including
    pictures in which no face was found.
    """

    detector: str
    errors: Floats64
    yaw: Floats64
    picture_count: int

    @property
    def distances(self) -> Floats64:
        """Distance of each point from its label [percent], (n, 68)."""
        return np.asarray(np.linalg.norm(self.errors, axis=2))

    @property
    def is_frontal(self) -> Flags:
        """Whether each picture is frontal, (n,)."""
        return np.abs(self.yaw) < MOST_YAW

    @property
    def constant(self) -> Floats64:
        """The mean error of each point on frontal pictures, averaged over both sides, (68, 2)."""
        if not self.is_frontal.any():
            return np.full((68, 2), np.nan)
        constant = self.errors[self.is_frontal].mean(axis=0)
        return np.asarray(0.5 * (constant + constant[MIRRORED_LANDMARKS] * [-1.0, 1.0]))


def is_installed(detector: str) -> bool:
    """Whether the library of a detector is installed."""
    return importlib.util.find_spec(detector) is not None


@contextlib.contextmanager
def opened(detector: str, model: Path | None) -> Iterator[Detector]:
    """Open a detector of `DETECTOR_TITLES` with its model; UserError for a missing or wrong file.

    The detector takes a picture (H, W, 3) and returns its 68 points, shape (68, 2) [pixels, the
    middle of the first pixel is 0.5], or None if it finds no face.
    """
    if detector == "dlib":
        yield _dlib(model)
    elif model is None:
        raise UserError("--model: MediaPipe needs its file face_landmarker.task")
    else:
        with _mediapipe(model) as found:
            yield found


def _dlib(model: Path | None) -> Detector:
    """dlib's detector of frontal faces, and its 68 points in the face."""
    dlib = optional_import("dlib", "the detector", "dlib")
    predictor = model_of_dlib(dlib.shape_predictor, model or packaged_model())
    faces = dlib.get_frontal_face_detector()
    larger = 1  # number of times that a picture is enlarged to twice its size, for small faces

    def detect(image: Image) -> Floats64 | None:
        """The 68 points of the largest face [pixels], shape (68, 2); None if no face is found."""
        array = np.ascontiguousarray(image)
        boxes = faces(array, larger)
        if not boxes:
            return None
        box = max(boxes, key=lambda each: each.area())
        # Annotations count pixels from 1, dlib from 0: the difference of half a pixel is ignored.
        points = predictor(array, box).parts()
        return np.array([(point.x, point.y) for point in points], dtype=np.float64)

    return detect


def model_of_dlib(kind: Callable[[str], Any], file: Path) -> Any:
    """Read a file as a model of dlib; kind: the class. Raises UserError for another file."""
    try:
        return kind(str(file))
    except RuntimeError as error:
        raise UserError(f"{file}: is no {kind.__name__} of dlib: {error}") from None


def packaged_model(
    name: str = "shape_predictor_68_face_landmarks.dat", option: str = "--model"
) -> Path:
    """A file of the package face_recognition_models; by default the predictor.

    option: the option that takes the file instead, for the error. Raises UserError without package.
    """
    package = importlib.util.find_spec("face_recognition_models")
    places = list(package.submodule_search_locations or ()) if package else []
    if not places:
        raise UserError(
            f"{option}: give {name}, or install the package face_recognition_models, which has it"
        )
    return Path(places[0]) / "models" / name


@contextlib.contextmanager
def _mediapipe(model: Path) -> Iterator[Detector]:
    """MediaPipe's mesh of a face, and the 68 points on it."""
    with face_landmarker(model) as look:

        def detect(image: Image) -> Floats64 | None:
            """The 68 points of the face [pixels], shape (68, 2); None if no face is found."""
            found = look(image).face_landmarks
            if not found:
                return None
            height, width = image.shape[:2]
            mesh = np.array([(each.x * width, each.y * height) for each in found[0]])
            return points_of_mesh(mesh)

        yield detect


def points_of_mesh(mesh: Floats64) -> Floats64:
    """The 68 points on MediaPipe's mesh (478, 2), shape (68, 2)."""
    right = _half_of_mesh(mesh, 0)
    left = _half_of_mesh(mesh, 1)
    points = np.empty((68, 2))
    for number, place in right.items():
        points[number] = place
    for number, place in left.items():
        points[MIRRORED_LANDMARKS[number]] = place
    return points


def _half_of_mesh(mesh: Floats64, side: int) -> dict[int, Floats64]:
    """The points of the middle and of one side, numbered as on the right side.

    side: 0 for right, 1 for left. Each pair holds the mesh's vertices on the right and the left.
    """
    jaw = [(127, 356), (234, 454), (93, 323), (132, 361), (58, 288), (172, 397), (136, 365),
           (150, 379), (149, 378), (176, 400), (148, 377), (152, 152)]  # fmt: skip
    upper_brow = [(70, 300), (63, 293), (105, 334), (66, 296), (107, 336)]
    upper_lid = [(33, 263), (246, 466), (161, 388), (160, 387), (159, 386), (158, 385),
                 (157, 384), (173, 398), (133, 362)]  # fmt: skip
    lower_lid = [(33, 263), (7, 249), (163, 390), (144, 373), (145, 374), (153, 380),
                 (154, 381), (155, 382), (133, 362)]  # fmt: skip
    upper_lip = [(61, 291), (185, 409), (40, 270), (39, 269), (37, 267)]
    lower_lip = [(91, 321), (181, 405)]
    ridge = [(168, 168), (6, 6), (197, 197), (195, 195), (5, 5), (4, 4)]
    mesh = mesh.copy()
    above, below = mesh[[(162, 389)[side], (127, 356)[side]]]
    mesh[jaw[0][side]] = 0.25 * above + 0.75 * below  # height of the eyes
    # The ends of a brow are means of the brow's upper and lower lines. The mesh's brow begins
    # farther from the nose than iBug's.
    outer, inner = mesh[[(46, 276)[side], (55, 285)[side]]]
    mesh[upper_brow[0][side]] = 0.5 * (mesh[upper_brow[0][side]] + outer)
    mesh[upper_brow[-1][side]] = 0.35 * (mesh[upper_brow[-1][side]] + inner) + 0.3 * mesh[9]
    lines = [
        (range(9), jaw),
        (range(17, 22), upper_brow),
        (range(27, 31), ridge),
        ((36, 37, 38, 39), upper_lid),
        ((36, 41, 40, 39), lower_lid),
        ((48, 49, 50), upper_lip),
    ]
    found: dict[int, Floats64] = {}
    for numbers, pairs in lines:
        corners = mesh[[pair[side] for pair in pairs]]
        places = evenly_spaced(corners, arc_lengths(corners), len(numbers))
        found.update(zip(numbers, places, strict=True))
    found[59] = mesh[[pair[side] for pair in lower_lip]].mean(axis=0)
    single = {31: (240, 460), 32: (97, 326), 33: (2, 2), 51: (0, 0), 57: (17, 17), 58: (84, 314),
              60: (78, 308), 61: (82, 312), 62: (13, 13), 66: (14, 14), 67: (87, 317)}  # fmt: skip
    return found | {number: mesh[pair[side]] for number, pair in single.items()}


def measure(folder: Path, name: str, detector: Detector) -> DetectorErrors:
    """Compare a detector with the labels of a set; raises UserError if there are no samples."""
    files = sorted(folder.glob("[0-9]*.json"))
    if not files:
        raise UserError(f"{folder}: holds no data set; make one with `risorius dataset`")
    errors = []
    yaw = []
    picture_count = 0
    for file in files:
        labels = json.loads(file.read_text("utf-8"))
        if labels["person"].get("mask", NOTHING_WORN) != NOTHING_WORN:
            continue
        picture_count += 1
        picture = PIL.Image.open(file.with_suffix(".png")).convert("RGB")
        found = detector(np.asarray(picture))
        if found is not None:
            errors.append(errors_of(found, labels))
            yaw.append(labels["head"]["yaw"])
    return DetectorErrors(name, np.array(errors).reshape(-1, 68, 2), np.array(yaw), picture_count)


def errors_of(found: Floats64, labels: Mapping[str, Any]) -> Floats64:
    """Errors of points (68, 2) against labels; see `DetectorErrors.errors`, shape (68, 2)."""
    landmarks = labels["landmarks"]
    camera = labels["camera"]
    pixels = np.array(landmarks["pixels"])[:68]
    right_corner = np.array(landmarks["points"][36])
    left_corner = np.array(landmarks["points"][45])
    forward = np.array(camera["R"])[2]
    depth = forward @ (right_corner + left_corner) / 2.0 + camera["t"][2]
    focal_length = camera["K"][0][0]
    apart = focal_length * np.linalg.norm(left_corner - right_corner) / depth
    right_eye = pixels[36:42].mean(axis=0)
    left_eye = pixels[42:48].mean(axis=0)
    across = left_eye - right_eye
    across /= np.linalg.norm(across)
    down = (-across[1], across[0])
    axes = np.array([across, down])
    percent = 100.0 * (found - pixels) / apart
    return np.asarray(percent @ axes.T)


def report(finding: DetectorErrors) -> str:
    """The text to print."""
    frontal = finding.is_frontal
    rows = []
    for name, numbers in LANDMARK_GROUPS.items():
        largest = np.linalg.norm(finding.constant[numbers], axis=1).max()
        of_group = finding.distances[:, numbers]
        rows.append((name, mean(of_group), mean(of_group[frontal]), largest))
    offsets = [
        (
            f"{MIRRORED_LANDMARKS[number]}, {number}"
            if MIRRORED_LANDMARKS[number] != number
            else str(number),
            *offset,
        )
        for number, offset in enumerate(finding.constant)
        if number not in RIGHT_LANDMARKS and np.hypot(*offset) > MOST_CONSTANT
    ]
    lines = [
        f"{finding.picture_count} pictures; {DETECTOR_TITLES[finding.detector]} finds a face in "
        f"{len(finding.yaw)}, {frontal.sum()} of them frontal (yaw below {MOST_YAW:g} degrees)",
        "mean distance from the labels, in percent of the distance of the outer eye corners",
        "",
        *table("points:<7|all:6.2f|frontal:8.2f|largest constant:17.2f", rows),
    ]
    of_pictures = finding.distances[frontal].mean(axis=1)
    failure_count = (of_pictures > FAILED_ERROR).sum()
    lines += [
        "",
        f"frontal pictures: median {median(of_pictures):.2f} %; the detector misses the face in "
        f"{failure_count} (above {FAILED_ERROR:g} %)",
    ]
    if offsets:
        lines += [
            "",
            f"constant above {MOST_CONSTANT:g} %: the detector defines these points differently:",
        ]
        lines += table("points:<7|outward:8.1f|down:6.1f", offsets)
    return "\n".join(lines)


def targets(finding: DetectorErrors) -> list[Target]:
    """The bounds of errors on frontal pictures."""
    error = mean(finding.distances[finding.is_frontal])
    constant = float(np.linalg.norm(finding.constant, axis=1).max())
    most = MOST_ERROR[finding.detector]
    return [
        at_most("frontal pictures", error, most, " %"),
        at_most("the constant part of any point", constant, MOST_CONSTANT, " %"),
    ]
