"""Make a separate head of the simplified mesh of a dense head, for small files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.normals import vertex_normals
from ..data_files import Image
from ..errors import AssetError
from ..loading import load
from .head import FittedHead
from .organs import with_eyelid_rims
from .painting import TextureLayout, plain_light, plain_picture, sampled, texels_within
from .simplifying import MOST_SIMULATED
from .warp import nearest_on


def simplified_head(head: FittedHead) -> FittedHead:
    """Make a head whose only mesh is the simulated mesh of `head`; both move alike.

    The texture of `head` is drawn again in the built-in layout. A head without a simplified mesh
    raises AssetError.
    """
    coarse = head.simplified
    if coarse is None:
        raise AssetError(
            f"its {len(head.faces)} triangles are simulated as they are; give a head of more than "
            f"{MOST_SIMULATED}"
        )
    known = load("head")
    normals = vertex_normals(coarse.vertices, coarse.faces)
    nearest = nearest_on(coarse.vertices, normals, head.vertices, head.faces)
    corner = nearest.weights.argmax(axis=1)
    nearest_vertex = nearest.corners[np.arange(len(corner)), corner]
    return replace(
        head,
        vertices=coarse.vertices,
        faces=coarse.faces,
        landmarks=coarse.landmarks,
        bone_depth=coarse.bone_depth,
        mandible_weight=coarse.mandible_weight,
        parts=with_eyelid_rims(coarse.parts, coarse.vertices, coarse.faces, coarse.eyes),
        uv=coarse.uv,
        face_uv=coarse.faces,
        albedo=_drawn_anew(head, plain_picture(known), TextureLayout(coarse.uv, coarse.faces)),
        wrinkles=replace(known.wrinkles, across=head.wrinkles.across[nearest_vertex]),
        segments=known.segments,
        ambient_occlusion=plain_light(known),
        file_vertices=head.file_vertices[nearest_vertex],
        simplified=None,
    )


def _drawn_anew(head: FittedHead, picture: Image, layout: TextureLayout) -> Image:
    """Draw the texture of a head over another one, in the layout of the head's simplified mesh."""
    assert head.simplified is not None
    coarse = head.simplified
    texels = texels_within(layout, picture.shape[:2])
    normals = vertex_normals(coarse.vertices, coarse.faces)
    nearest = nearest_on(
        texels.interpolate(coarse.vertices[coarse.faces]),
        texels.interpolate(normals[coarse.faces]),
        head.vertices,
        head.faces,
    )
    corners = TextureLayout(head.uv, head.face_uv).corners[nearest.triangles]
    places = np.einsum("nc,nck->nk", nearest.weights, corners)
    drawn = picture.copy()
    drawn[texels.rows, texels.columns] = sampled(head.albedo, places)
    return drawn
