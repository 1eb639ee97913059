"""The built-in head with a quarter of its triangles, on which refinement is clearly visible.

    head = coarse_head()

The layout was made by hand (`coarse.toml`). Its vertices are vertices of the built-in head, so rig,
landmarks, teeth and picture fit unchanged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.arrays import Floats32, Floats64, Integers32
from ..geometry.numbering import places_among
from .data_files import read_toml
from .fitting.head import FittedHead
from .fitting.warp import Similarity
from .loading import load
from .model import Head, Part

COARSE_NAME = "coarse"  # its name for users
LAYOUT_FILE = Path(__file__).parent / "coarse.toml"


@dataclass(frozen=True)
class CoarseHead(FittedHead):
    """A head whose vertices are some of the built-in head's. It adds fields to a fitted head:

    mandible_weight, jaw_axis, mirror: as in `Head`.
    anatomy: the anatomical points among its vertices, name -> vertex index.
    """

    mandible_weight: Floats64
    jaw_axis: Floats64 = field(kw_only=True)
    anatomy: Mapping[str, int]
    mirror: Integers32

    def fade(self) -> None:
        """No fading: a shirt covers the edge of the neck."""


def coarse_head() -> CoarseHead:
    """The coarse head: some 500 triangles, with the landmarks and the rig of the built-in head.

    Raises AssetError if a file is missing or broken.
    """
    known = load("head")
    layout = read_toml(LAYOUT_FILE)
    kept, faces = _layout(known, layout["triangles"])
    number = places_among(kept, len(known.vertices))
    # Its lids have no lashes, and no map shows form finer than its triangles.
    parts = tuple(_behind_lids(known, part) for part in known.parts if part.roots is None)
    no_directions = np.zeros((len(kept), 2, 3), np.float32)
    still = replace(known.wrinkles, across=no_directions)
    return CoarseHead(
        vertices=known.vertices[kept],
        faces=faces,
        landmarks=number[known.landmarks],
        bone_depth=known.bone_depth[kept],
        eyes=known.eyes,
        parts=parts,
        uv=_texture_coordinates(known, layout["texture"], kept),
        face_uv=faces,
        albedo=known.albedo,
        wrinkles=still,
        segments=known.segments,
        ambient_occlusion=known.ambient_occlusion,
        rig=known.rig,
        layers=known.layers,
        to_millimetres=Similarity(1.0, np.eye(3), np.zeros(3)),
        file_vertices=kept,
        mandible_weight=known.mandible_weight[kept],
        jaw_axis=known.jaw_axis,
        anatomy={name: int(number[v]) for name, v in known.anatomy.items() if number[v] >= 0},
        mirror=number[known.mirror[kept]],
        called=COARSE_NAME,
    )


def _behind_lids(known: Head, part: Part) -> Part:
    """Return the part; an eyeball is made smaller, so that straight lid edges do not cut it."""
    factor = 0.95  # of the radius
    for eye in known.eyes:
        if part.name == f"eyeball_{eye.name}":
            vertices = eye.centre + factor * (part.vertices - eye.centre)
            return replace(part, vertices=vertices.astype(np.float32))
    return part


def _texture_coordinates(known: Head, texture: Mapping[str, int], kept: Integers32) -> Floats32:
    """Return texture coordinates, (V, 2); texture: the table of the layout."""
    rows = np.arange(len(known.vertices))
    for side in (np.arange(len(rows)), known.mirror):
        rows[side[texture["vertex"]]] = side[texture["shown"]]
    return known.uv[rows[kept]]


def _layout(known: Head, table: Mapping[str, Any]) -> tuple[Integers32, Integers32]:
    """Return the kept vertices of the built-in head, (V,), and triangles between them, (F, 3)."""
    left = np.vstack([*table.values()]).astype(np.int32)
    right = known.mirror[left][:, ::-1]
    kept, corners = np.unique(np.vstack([left, right]), return_inverse=True)
    return kept, corners.reshape(-1, 3).astype(np.int32)
