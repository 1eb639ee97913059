"""Guess the 68 landmarks of a head from the few that a user has placed.

    first points  ->  similarity to the built-in head
                  ->  most similar person (likely_face.py)
                  ->  warp of this person's face to the mesh
                  ->  landmarks of this person, moved by the warp, on the mesh
                  ->  brows, moved like the placed points of brows

Form does not show the height of brows: those of scans lie above the crest of the forehead, those
of MakeHuman 8 mm below it. So one point of a brow is among the first points. It moves all brows,
and nothing else, because a person with such brows has another form.

In each step of the warp, points of the person's face move to the nearest points of the mesh with
similar normals. A smoothing thin-plate spline follows these points. It bends more in each step.

Source: Amberg, Romdhani, Vetter 2007, "Optimal step nonrigid ICP", for stiffness that falls from
step to step.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import scipy

from ...geometry.arrays import Floats64, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.normals import cross_products, vertex_normals
from ...geometry.polylines import polyline_at
from ..errors import AssetError
from ..loading import load
from ..meshes import Mesh
from ..model import Head
from .likely_face import FARTHEST_MATCH, LikelyFace
from .warp import Similarity, ThinPlateSpline, nearest_on

# Outer corners of the eyes, tip of the nose, corners of the mouth, middle of the right brow.
# Everybody finds these landmarks, and they are far apart in every direction.
FIRST_LANDMARKS = (36, 45, 30, 48, 54, 19)
BROW_LANDMARKS = range(17, 27)  # of the right brow from outside in, of the left from inside out

Known = Mapping[int, npt.ArrayLike]  # number of a landmark -> point (3,) [unit of the mesh]


def guess(mesh: Mesh, known: Known) -> Floats64:
    """Guess all 68 landmarks on a mesh; returns points [unit of the mesh], (68, 3).

    known: placed landmarks, at least four that are not of brows, which are returned unchanged. If
    they form no face, raises AssetError.
    """
    head = load("head")
    similarity = placing(known)
    indices = [number for number in sorted(known) if number not in BROW_LANDMARKS]
    given = similarity.points(np.array([known[number] for number in indices]))
    vertices = similarity.points(mesh.vertices)
    faces = skin_around(vertices, mesh.faces, given)
    # The landmarks and the face around them are fitted to the mesh.
    chosen = np.concatenate([head.landmarks, _around_landmarks(head)])
    face = LikelyFace(head, vertices, faces, indices, given, chosen)
    face.fit()
    own = face.vertices
    points = own[chosen]
    known_points = own[head.landmarks[indices]]
    is_free = ~np.isin(np.arange(len(chosen)), indices)
    laid = own
    stiffnesses = (1e3, 300.0, 100.0)  # [mm]; smoothing of the warp in each step
    for stiffness in stiffnesses:
        feet = _feet(laid, head, chosen, face.mesh, faces)
        distances = np.linalg.norm(feet - laid[chosen], axis=1)
        is_laid = is_free & (distances < FARTHEST_MATCH)
        source = np.vstack([known_points, points[is_laid]])
        target = np.vstack([face.given, feet[is_laid]])
        give = np.zeros(len(source))  # known landmarks are met exactly
        give[len(indices) :] = stiffness
        laid = ThinPlateSpline(source, target, give).points(own)
    found = _feet(laid, head, head.landmarks, face.mesh, faces)
    found[indices] = face.given
    brows = [number for number in BROW_LANDMARKS if number in known]
    if brows:
        given_brows = similarity.points(np.array([known[number] for number in brows]))
        _move_brows(found, brows, face.moved.points(given_brows), face.mesh, faces)
    return similarity.inverse.points(face.moved.inverse.points(found))


def placing(known: Known) -> Similarity:
    """Find the similarity to the face space [mm] by four or more known landmarks without brows.

    Raises AssetError if the landmarks form no face, or the mirror image of a face.
    """
    similarity, off = _landmark_similarity(known)
    right = "right is the subject's own, on your left where the face looks at you"
    most_mean_distance = 14.0  # [mm] between known landmarks and those of the built-in head
    if off.mean() > most_mean_distance:
        right_and_left = {"eyes": FIRST_LANDMARKS[:2], "corners of the mouth": FIRST_LANDMARKS[3:5]}
        for pair, (a, b) in right_and_left.items():
            other, less = _landmark_similarity({**known, a: known[b], b: known[a]})
            if less.mean() <= most_mean_distance and not other.is_mirrored:
                raise AssetError(f"the {pair} are swapped, landmarks {a} and {b}: {right}")
        raise AssetError(
            f"these points form no face: they are {off.mean():.0f} mm off on average, and landmark "
            f"{sorted(known)[int(off.argmax())]} by {off.max():.0f} mm; give each its own place"
        )
    if similarity.is_mirrored:
        raise AssetError(f"left and right are swapped, or the mesh is mirrored: {right}")
    return similarity


def _landmark_similarity(known: Known) -> tuple[Similarity, Floats64]:
    """Find the similarity from known landmarks to built-in ones, and its errors [mm], (n,)."""
    head = load("head")
    indices = np.array(sorted(known))
    own = head.vertices[head.landmarks[indices]]
    given = np.array([known[number] for number in indices], dtype=np.float64)
    if not np.ptp(given, axis=0).any():
        raise AssetError("all landmarks are one point; give each its own place")
    is_fitted = ~np.isin(indices, BROW_LANDMARKS)
    similarity = Similarity.between(given[is_fitted], own[is_fitted])
    return similarity, np.linalg.norm(similarity.points(given) - own, axis=1)


def skin_around(vertices: Floats64, faces: Integers32, given: Floats64) -> Integers32:
    """Find the triangles (n, 3) of the skin around some points, and turn them outward.

    The skin is the piece of the mesh under most points; eyeballs, teeth and hair are left out.
    vertices, given: in the face space [mm], (V, 3) and (m, 3).
    """
    centroids = vertices[faces].mean(axis=1)
    _, under = scipy.spatial.cKDTree(centroids).query(given)
    piece = pieces_of(faces, len(vertices))[faces[:, 0]]
    is_skin = piece == np.bincount(piece[under]).argmax()
    skin_under = faces[under[is_skin[under]]]
    forward = cross_products(vertices, skin_under)[:, 2]
    if forward.sum() < 0.0:  # the mesh is inside out
        faces = faces[:, ::-1]
    face_radii = np.array([60.0, 90.0, 120.0])  # [mm] around the points in x, y and z
    low = given.min(axis=0) - face_radii
    high = given.max(axis=0) + face_radii
    is_near = ((centroids > low) & (centroids < high)).all(axis=1)
    return np.ascontiguousarray(faces[is_skin & is_near])


def _around_landmarks(head: Head) -> Integers32:
    """Choose 300 to 600 vertices near the landmarks of a head; leave out the landmarks."""
    reach = 30.0  # [mm] around landmarks, within which the built-in face is fitted to the mesh
    tree = scipy.spatial.cKDTree(head.vertices[head.landmarks])
    distances, _ = tree.query(head.vertices)
    is_near = distances < reach
    is_near[head.landmarks] = False
    near = np.flatnonzero(is_near).astype(np.int32)
    most_points = 300  # more would take longer with the same result
    step = max(len(near) // most_points, 1)
    return near[::step]


def _feet(
    laid: Floats64, head: Head, chosen: Integers32, vertices: Floats64, faces: Integers32
) -> Floats64:
    """Find, for n vertices of the warped head, the nearest points of a mesh, (n, 3).

    laid: vertices of the warped head. chosen: indices of the n vertices.
    """
    normals = vertex_normals(laid, head.faces)[chosen]
    return nearest_on(laid[chosen], normals, vertices, faces).interpolate(vertices)


def _move_brows(
    found: Floats64, known: list[int], given: Floats64, vertices: Floats64, faces: Integers32
) -> None:
    """Move the brows among guessed landmarks (68, 3) as far as their n known landmarks, in place.

    A brow without a known landmark moves as the mirror image of the other.

    known: numbers of the known landmarks. given: their points [mm], (n, 3). vertices, faces: mesh.
    """
    motions = given - found[known]
    is_right = np.array(known) < BROW_LANDMARKS[5]
    for number in BROW_LANDMARKS:
        own = is_right == (number < BROW_LANDMARKS[5])
        if own.any():
            places = np.array(known)[own]
            motion = polyline_at(number, places, motions[own])
        else:
            mirrored = BROW_LANDMARKS[0] + BROW_LANDMARKS[-1] - number
            motion = polyline_at(mirrored, known, motions) * [-1.0, 1.0, 1.0]
        found[number] += motion
    brows = list(BROW_LANDMARKS)
    forward = np.zeros((len(brows), 3))
    forward[:, 2] = 1.0
    found[brows] = nearest_on(found[brows], forward, vertices, faces).interpolate(vertices)
    found[known] = given


def centred(vertices: Floats64, radius: float) -> Similarity:
    """Return the similarity that moves a mesh (V, 3) to the origin and scales it to `radius`."""
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    distances = np.linalg.norm(vertices - centre, axis=1)
    scale = radius / max(float(distances.max()), 1e-12)
    return Similarity(scale, np.eye(3), -scale * centre)


def axes_turned() -> list[Floats64]:
    """Return the 24 rotations (3, 3) that map axes to axes, the identity first."""
    turns = np.rint(scipy.spatial.transform.Rotation.create_group("O").as_matrix())
    return sorted(turns, key=lambda turn: -float(np.trace(turn)))
