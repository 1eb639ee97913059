"""A mesh of fewer triangles to simulate, where a head has more than can be moved in time."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy

from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.read_only import make_read_only

from ..errors import AssetError
from ..model import Eye, Layer, Part
from ..topology import decimated
from .landmark_file import nearest_vertices
from .mesh_validation import SkinPiece, check_manifold

MOST_SIMULATED = 20_000  # triangles: with more the picture is no better, and waits for physics
SIMPLIFIED = 15_000  # triangles are left


@dataclass(frozen=True)
class SimulatedHead:
    """A mesh with all that `sim.create` reads; its attributes are those of `Head`.

    uv: of vertices in the built-in picture, shape (V, 2).
    jaw_axis: None where no ear shows it; then `sim.create` guesses it from the landmarks.
    """

    vertices: Floats64
    faces: Integers32
    landmarks: Integers32
    bone_depth: Floats64
    mandible_weight: Floats64
    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    rig: dict[str, Any]
    layers: tuple[Layer, ...]
    uv: Floats32
    jaw_axis: Floats64 | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        make_read_only(self)


def simplified(skin: SkinPiece, landmarks: Floats64) -> SkinPiece:
    """The same form with as many triangles as can be moved in time."""
    most_attempts = 8  # to simplify a mesh so that it stays a surface
    for attempt in range(most_attempts):
        vertices, faces = decimated(skin.vertices, skin.faces, SIMPLIFIED, attempt)
        with contextlib.suppress(AssetError):
            check_manifold(faces)
            break
    else:
        raise AssetError(
            f"its {len(skin.faces)} triangles cannot be simplified; reduce it to {MOST_SIMULATED} "
            "in a modelling program"
        )
    nearest = scipy.spatial.cKDTree(skin.vertices).query(vertices)[1]
    numbers = nearest_vertices(landmarks, vertices, faces)
    return SkinPiece(vertices, faces, numbers, skin.file_vertices[nearest], np.arange(0))
