"""Measure how far apart persons are for dlib's face recognition.

dlib's network (King 2017, "High Quality Face Recognition with Deep Metric Learning") describes a
face by 128 numbers. Two pictures of one person are usually closer than 0.6. Each person is drawn
once: from the front, at rest, in the light of the studio.

The network checks that persons differ as people do; their forms and colours are not fitted to it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.extras import optional_import
from risorius.app.pictures import Image
from risorius.app.scenes import FaceScene
from risorius.assets.identities import person_called
from risorius.geometry.arrays import Floats64

from .landmarks import model_of_dlib, packaged_model
from .report import Target, at_least, at_most

SAME_PERSON = 0.6  # distance below which dlib takes two pictures for one person
LEAST_MEAN = 0.6
MOST_SIMILAR_PAIRS = 0.55
LEAST_COMPONENTS = 14

Describe = Callable[[Image], Floats64 | None]


def open_network(predictor: Path | None, network: Path | None) -> Describe:
    """Return a function that describes the face in a picture by 128 numbers; None without a face.

    predictor, network: dlib's files; None takes those of the package face_recognition_models.
    Raises UserError for missing or other files.
    """
    dlib = optional_import("dlib", "face recognition", "dlib")
    network = network or packaged_model("dlib_face_recognition_resnet_model_v1.dat", "--network")
    detect = dlib.get_frontal_face_detector()
    locate = model_of_dlib(dlib.shape_predictor, predictor or packaged_model())
    recognition = model_of_dlib(dlib.face_recognition_model_v1, network)

    def describe(picture: Image) -> Floats64 | None:
        """The description of the first face that is found."""
        array = np.ascontiguousarray(picture)
        boxes = detect(array, 1)
        if not boxes:
            return None
        shape = locate(array, boxes[0])
        return np.array(recognition.compute_face_descriptor(array, shape))

    return describe


def portrait(number: int) -> Image:
    """Draw a person from the front, at rest, with 256 x 256 pixels."""
    scene = FaceScene(person_called(number))
    options = CaptureOptions((256, 256), camera="0,0,1.0", captions=False)
    with Capture(scene, options) as capture:
        return capture.draw_image()[..., :3]


def measure(numbers: range, describe: Describe) -> Floats64:
    """Describe these persons, shape (n, 128); persons whose face is not found are left out."""
    found = [describe(portrait(number)) for number in numbers]
    return np.array([each for each in found if each is not None]).reshape(-1, 128)


def distances(descriptions: Floats64) -> Floats64:
    """The distances of all pairs."""
    first, second = np.triu_indices(len(descriptions), 1)
    return np.asarray(np.linalg.norm(descriptions[first] - descriptions[second], axis=1))


def component_count(descriptions: Floats64) -> int:
    """The number of principal components that have 90 % of the variance."""
    variances = np.linalg.eigvalsh(np.cov(descriptions.T))[::-1]
    shares = np.cumsum(variances) / variances.sum()
    return int(np.searchsorted(shares, 0.9)) + 1


def targets(descriptions: Floats64) -> list[Target]:
    """The targets: persons are as far apart, and in as many directions, as people."""
    apart = distances(descriptions)
    similar = float(np.mean(apart < SAME_PERSON))
    return [
        at_least("mean distance", float(apart.mean()), LEAST_MEAN),
        at_most("share of pairs that are taken for one person", similar, MOST_SIMILAR_PAIRS),
        at_least("components with 90 %", component_count(descriptions), LEAST_COMPONENTS),
    ]
