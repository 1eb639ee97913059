"""Write the surfaces of a scene, with named shapes, as the avatar of a built-in head or person."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..scenes import FaceScene, Scene
from .bodies import PartBody, Shaped
from .glb import Glb
from .scene_meshes import Piece, add_mesh
from .skeleton import Skeleton
from .surface import MovingSurface


def surface_of(scene: FaceScene, shaped: Shaped) -> MovingSurface:
    """Return the surface of a body of a scene."""
    body = shaped.body
    if isinstance(body, PartBody):
        part = body.part
        return MovingSurface(
            body.name, body.rest, body.faces, colours=part.colours, shine=part.shine
        )
    return MovingSurface(
        body.name, body.rest, body.faces, uv=scene.skin.uv, face_uv=scene.skin.face_uv
    )


def add_pieces(glb: Glb, scene: Scene, pieces: list[Piece], skeleton: Skeleton) -> list[int]:
    """Add pieces to a file as children of their bones' nodes; return the nodes without a bone."""
    roots = []
    for piece in pieces:
        node: dict[str, Any] = {"name": piece.surface.name}
        weights = None
        if piece.bone is None and scene.face is not None:
            node["skin"] = skeleton.skin
            weights = piece.surface.carried(scene.face.head_weight)
        node["mesh"] = add_mesh(glb, scene, piece, skeleton.pivot(piece.bone), weights)
        number = glb.add("nodes", node)
        if piece.bone is None:
            roots.append(number)
        else:
            skeleton.add_child(number, piece.bone)
        if len(piece.targets) and len(piece.weights):
            glb.animate(number, "weights", piece.weights)
    return roots


def piece_of(scene: FaceScene, shaped: Shaped, names: tuple[str, ...]) -> Piece:
    """Return a body of a scene with its shapes, as a piece without animation."""
    body = shaped.body
    bone = None
    normals = shaped.normals
    if isinstance(body, PartBody):
        bone = body.bone
        normals = body.part.normals.astype(np.float64)
    none = np.zeros((0, 0))
    surface = surface_of(scene, shaped)
    return Piece(surface, bone, normals, names, shaped.targets, shaped.bends, none)
