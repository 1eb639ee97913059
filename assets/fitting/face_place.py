"""Find the similarity from a head to the face space by its 68 landmarks."""

from __future__ import annotations

import contextlib

import numpy as np

from ...geometry.arrays import Floats64
from ..errors import AssetError
from ..loading import load
from ..model import Head
from .landmark_file import LANDMARK_COUNT, groups_in_disorder
from .warp import Similarity

# Without the jaw line, on which annotators differ most.
ORIENTING_LANDMARKS = slice(17, LANDMARK_COUNT)


def placed(points: Floats64, known: Head) -> Similarity:
    """Find the similarity from landmarks (68, 3) to the face space [mm].

    Raises AssetError if the landmarks form no face, are mirrored, or are in a wrong order.
    """
    template = known.vertices[known.landmarks]
    extent = np.ptp(points[ORIENTING_LANDMARKS], axis=0).max()
    least_size = 1e-9  # [unit of the mesh]; squares of less would lose precision
    if extent < least_size:
        raise AssetError(
            f"the landmarks lie within {extent:.3g} units; allowed are {least_size:g} and more: "
            "give 68 different ones, in metres or millimetres"
        )
    similarity = Similarity.between(points[ORIENTING_LANDMARKS], template[ORIENTING_LANDMARKS])
    off = np.linalg.norm(similarity.points(points) - template, axis=1)
    disordered = groups_in_disorder(similarity.points(points), template)
    farthest_from_a_face = 14.0  # [mm]; greatest mean distance from the built-in landmarks
    is_far = off[ORIENTING_LANDMARKS].mean() > farthest_from_a_face
    most_disordered = 3  # groups; if more are in a wrong order, the landmarks form no face
    if disordered and not (is_far and len(disordered) > most_disordered):
        _check_different(similarity.points(points), template)
        raise AssetError(disordered[0].complaint)
    if is_far:
        raise AssetError(
            f"the landmarks form no face: they are {off[ORIENTING_LANDMARKS].mean():.0f} mm off on "
            f"average, and landmark {off.argmax()} by {off.max():.0f} mm; give the 68 iBug points "
            "in their order"
        )
    if similarity.is_mirrored:
        raise AssetError(
            "left and right are swapped in the landmarks, or the mesh is mirrored; landmarks 0-16 "
            "run from the subject's right ear to the left one, 36-41 are the right eye"
        )
    _check_different(similarity.points(points), template)
    return similarity


def is_face(points: Floats64) -> bool:
    """Whether landmarks (68, 3) [unit of the mesh] form a face and are in the right order."""
    with contextlib.suppress(AssetError):
        return bool(placed(points, load("head")))
    return False


def _check_different(points: Floats64, template: Floats64) -> None:
    """Raise AssetError if two landmarks coincide that are far apart on any face; (68, 3) [mm]."""
    distances = np.linalg.norm(points[:, None] - points, axis=2)
    known = np.linalg.norm(template[:, None] - template, axis=2)
    # Landmarks with at least this distance on the built-in head must not coincide, because a muscle
    # between them needs a length.
    least_built_in_distance = 30.0  # [mm]
    compared = np.where(known > least_built_in_distance, distances, np.inf)
    a, b = np.unravel_index(compared.argmin(), compared.shape)
    least_distance = 1.0  # [mm]
    if distances[a, b] < least_distance:
        raise AssetError(
            f"landmarks {a} and {b} are {distances[a, b]:.2g} mm apart; on the built-in head "
            f"they are {known[a, b]:.0f} mm apart: give each its own place"
        )
