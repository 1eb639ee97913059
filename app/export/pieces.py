"""The meshes of a clip as formats with bones have them: each in the coordinates of its bone.

The skin hangs on the head's bone by a share that fades down the neck. What the pose of the head
does to it is taken out of its shapes, since that bone does it again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.geometry.normals import vertex_normals

from ..scenes import FaceScene, Scene
from .clip import Clip, Surface
from .morphs import Floats, Singles, decompose, follow, parts_of

HEAD, JAW = "cranium", "mandible"  # names of bones


@dataclass(frozen=True)
class Piece:
    """One mesh with its morph targets.

    bone: what moves the whole of it; None: nothing, or the skin's own weights.
    vertices, normals: at rest [mm], and of unit length, shape (V, 3).
    names: of the targets.
    targets, bends: what each adds to vertices and normals, shape (K, V, 3).
    weights: of each target in each frame, shape (N, K).
    """

    surface: Surface
    bone: str | None
    vertices: Floats
    normals: Floats
    names: tuple[str, ...]
    targets: Floats
    bends: Floats
    weights: Floats


def moving_pieces(clip: Clip) -> tuple[list[Piece], float]:
    """The surfaces of a clip with the targets that its motion needs; how far off they are [mm]."""
    pieces, error = [], 0.0
    for surface, part in surfaces_with_parts(clip):
        if surface.shapes is None:
            pieces.append(rigid_piece(surface, part))
            continue
        moved = _moved(clip, surface, part, surface.shapes)
        morphs = decompose(moved)
        names = tuple(f"motion {index + 1}" for index in range(len(morphs.targets)))
        normals = vertex_normals(surface.rest, surface.faces)
        shapes = (surface.rest + moved[some] for some in parts_of(len(moved)))
        bent = (normals_of(each, surface.faces) - normals for each in shapes)
        bends = follow(morphs.weights, bent)
        bone = None if part is None else part.bone
        pieces.append(
            Piece(
                surface, bone, surface.rest, normals, names, morphs.targets, bends, morphs.weights
            )
        )
        error = max(error, morphs.error)
    return pieces, error


def _moved(clip: Clip, surface: Surface, part: Any, shapes: Singles) -> Singles:
    """How far the vertices are from rest in each frame, before bones move them, shape (N, V, 3)."""
    moved = np.empty_like(shapes)
    for some in parts_of(len(shapes)):
        there: npt.NDArray[np.floating] = shapes[some]
        if part is None:
            bones = {name: matrices[some] for name, matrices in clip.bones.items()}
            there = in_head(clip.scene, None, there, bones)
        moved[some] = there - surface.rest
    return moved


def rigid_piece(surface: Surface, part: Any) -> Piece:
    """A part that no target bends."""
    none, normals = np.zeros((0, *surface.rest.shape)), part.normals.astype(np.float64)
    return Piece(surface, part.bone, surface.rest, normals, (), none, none, np.zeros((0, 0)))


def surfaces_with_parts(clip: Clip) -> Iterator[tuple[Surface, Any]]:
    """Each surface and the scene's part that it is of; the skin first, which is of none."""
    return zip(clip.surfaces, [None, *clip.scene.parts], strict=True)


def normals_of(shapes: Floats, faces: npt.NDArray[np.int32]) -> Floats:
    """Unit normals of the vertices of each shape, shape (N, V, 3)."""
    return np.array([vertex_normals(shape, faces) for shape in shapes]).reshape(shapes.shape)


def in_head(
    scene: Scene, bone: str | None, shapes: npt.NDArray[np.floating], bones: Mapping[str, Floats]
) -> Floats:
    """Shapes of the skin (no bone), or of what hangs on a bone, as the head's bone finds them.

    shapes: (N, V, 3); of what hangs on a bone before that has moved it. bones: matrices (N, 4, 4).
    """
    if bone is not None:
        matrices = np.linalg.inv(bones[HEAD]) @ bones[bone]
        moved: Floats = shapes @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, None, :3, 3]
        return moved
    there = shapes.astype(np.float64)
    if isinstance(scene, FaceScene):
        share = scene.simulation.head_weight[:, None]
        for shape, matrix in zip(there, bones[HEAD], strict=True):
            if not np.array_equal(matrix, np.eye(4)):
                turns = np.eye(3) + share[:, :, None] * (matrix[:3, :3] - np.eye(3))
                unmoved = (shape - share * matrix[:3, 3])[:, :, None]
                shape[:] = np.linalg.solve(turns, unmoved)[:, :, 0]
    return there
