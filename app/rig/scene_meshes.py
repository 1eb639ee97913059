"""Write surfaces of a scene as meshes of a glTF file, with materials and morph targets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, render
from risorius.geometry.arrays import Floats64, Unsigned8
from risorius.geometry.colour import to_linear
from risorius.geometry.directions import unit_vectors
from risorius.geometry.gradients import TextureGradients
from risorius.geometry.texels import Texels, rates

from ..scenes import Scene
from .glb import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, Glb
from .surface import METRES_PER_MILLIMETRE, MovingSurface


@dataclass(frozen=True)
class Piece:
    """A surface with its morph targets.

    bone: the bone that moves the whole surface; None for skin, and for scenes without bones.
    normals: unit normals at rest, (V, 3).
    names: names of the K targets.
    targets: displacements of vertices by each target [mm], (K, V, 3).
    bends: changes of unit normals by each target, (K, V, 3).
    weights: weight of each target in each frame, (N, K).
    """

    surface: MovingSurface
    bone: str | None
    normals: Floats64
    names: tuple[str, ...]
    targets: npt.NDArray[np.floating]
    bends: npt.NDArray[np.floating]
    weights: Floats64


def add_mesh(
    glb: Glb, scene: Scene, piece: Piece, origin: Floats64, weights: Floats64 | None
) -> int:
    """Add a mesh whose vertices are relative to `origin` [mm], (3,); return its index.

    weights: weight of the head's motion at each vertex, 0 to 1, (V,); None if there is no head.
    """
    surface = piece.surface
    faces: npt.NDArray[Any] = surface.faces
    vertices = coordinates = np.arange(len(surface.rest))
    if surface.face_uv is not None:  # splits vertices at seams
        corners = np.column_stack([faces.ravel(), surface.face_uv.ravel()]).astype(np.int64)
        pairs, numbers = np.unique(corners, axis=0, return_inverse=True)
        (vertices, coordinates) = pairs.T
        faces = numbers.reshape(-1, 3)

    def changes_of(values: npt.NDArray[Any]) -> int:
        return glb.sparse(values[vertices].astype(np.float32))

    def of_vertices(values: npt.NDArray[Any], *, is_bounded: bool = False) -> int:
        kind = np.uint8 if values.dtype == np.uint8 else np.float32
        rows = values[vertices].astype(kind)
        return glb.accessor(rows, ARRAY_BUFFER, is_bounded=is_bounded)

    attributes = {
        "POSITION": of_vertices(METRES_PER_MILLIMETRE * (surface.rest - origin), is_bounded=True),
        "NORMAL": of_vertices(piece.normals),
    }
    if surface.uv is not None:
        top_down = np.column_stack([surface.uv[:, 0], 1.0 - surface.uv[:, 1]])
        texels = top_down[coordinates].astype(np.float32)
        attributes["TEXCOORD_0"] = glb.accessor(texels, ARRAY_BUFFER)
    if surface.colours is not None:
        attributes["COLOR_0"] = of_vertices(to_linear(surface.colours))
    if weights is not None:
        # Refinement sums weights, so rounding may exceed 0 or 1.
        weights = np.clip(weights, 0.0, 1.0)
        none = np.zeros_like(weights)
        joints = np.column_stack([none, weights > 0.0, none, none]).astype(np.uint8)
        attributes["JOINTS_0"] = of_vertices(joints)
        attributes["WEIGHTS_0"] = of_vertices(np.column_stack([1.0 - weights, weights, none, none]))
    # 16 bits suffice for this number of vertices.
    short = np.uint16 if len(vertices) <= 65535 else np.uint32
    primitive: dict[str, Any] = {
        "attributes": attributes,
        "indices": glb.accessor(faces.astype(short).ravel(), ELEMENT_ARRAY_BUFFER),
        "material": _add_material(glb, scene, surface),
    }
    mesh: dict[str, Any] = {"name": surface.name, "primitives": [primitive]}
    if len(piece.targets):
        primitive["targets"] = [
            {"POSITION": changes_of(METRES_PER_MILLIMETRE * moved), "NORMAL": changes_of(bent)}
            for moved, bent in zip(piece.targets, piece.bends, strict=True)
        ]
        mesh["weights"] = [0.0] * len(piece.targets)
        mesh["extras"] = {"targetNames": list(piece.names)}  # all programs expect names here
    return glb.add("meshes", mesh)


def _add_material(glb: Glb, scene: Scene, surface: MovingSurface) -> int:
    """Add the material of a surface; return its index."""
    rough: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 0.55}  # chosen by eye
    material: dict[str, Any] = {"name": surface.name, "pbrMetallicRoughness": rough}
    if surface.colours is not None:
        # Both are chosen by eye, for shine 0 and for shine 1.
        dull_roughness = 0.75
        wet_roughness = 0.12
        rough["roughnessFactor"] = dull_roughness + surface.shine * (wet_roughness - dull_roughness)
        return glb.add("materials", material)
    material["doubleSided"] = True
    if scene.skin.albedo is None or surface.uv is None:
        rough["baseColorFactor"] = [*to_linear(render.CLAY), 1.0]
        return glb.add("materials", material)
    rough["baseColorTexture"] = glb.texture(scene.skin.albedo)
    ambient_occlusion = scene.skin.ambient_occlusion
    if ambient_occlusion is not None:
        material["occlusionTexture"] = glb.texture(ambient_occlusion)
    if scene.skin.fine_shape is not None:
        normals = _normal_map(surface, scene.skin.fine_shape, scene.skin.wrinkles)
        material["normalTexture"] = glb.texture(normals, "png")
    return glb.add("materials", material)


def _normal_map(
    surface: MovingSurface, fine: assets.FineShape, wrinkles: assets.Wrinkles | None
) -> Unsigned8:
    """Make a normal map (H, W, 3) of fine shape and resting wrinkles.

    Its axes run along u, across u, and outward. As in pictures, gradients of texture coordinates
    are interpolated between vertices.
    """
    assert surface.uv is not None and surface.face_uv is not None
    uv = surface.uv[surface.face_uv]
    texels = Texels.within(uv.astype(np.float64), fine.slopes.shape[:2], margin=1.0)
    slopes = (fine.slopes[texels.rows, texels.columns] - 128.0) * (fine.steepest / 127.0)
    if wrinkles is not None and len(wrinkles.across) == len(surface.rest):
        slopes += _resting_slopes(surface, wrinkles, texels, len(fine.slopes))
    gradients = TextureGradients(surface.faces, surface.uv, surface.face_uv).measure(surface.rest)
    of_corners = gradients[surface.face_uv].reshape(-1, 3, 2, 3)
    rises = np.einsum("nk,nkj->nj", slopes, texels.interpolate(of_corners))  # per millimetre
    along, aside = rates(uv, surface.rest[surface.faces]).swapaxes(0, 1)
    right = unit_vectors(along)
    across = unit_vectors(np.cross(np.cross(along, aside), along))
    normals = np.ones((len(rises), 3))
    for axis, direction in enumerate((right, across)):
        normals[:, axis] = -(rises * direction[texels.faces]).sum(axis=1)
    normals = unit_vectors(normals)
    height, width = fine.slopes.shape[:2]
    image = np.full((height, width, 3), (128, 128, 255), np.uint8)  # of a flat surface
    image[texels.rows, texels.columns] = np.rint(127.5 + 127.5 * normals)
    return image


def _resting_slopes(
    surface: MovingSurface, wrinkles: assets.Wrinkles, texels: Texels, size: int
) -> Floats64:
    """Return slopes along u and v, (n, 2), of wrinkles that show at rest, such as folds of lids.

    texels: n texels of a map with (size, size) texels.
    """
    readiness = np.minimum(np.linalg.norm(wrinkles.across, axis=2), 1.0)
    amounts = wrinkles.resting[:, None] * readiness  # (V, 2)
    first, second = texels.interpolate(amounts[surface.faces].astype(np.float64)).T
    scale = len(wrinkles.map) / size
    rows = (scale * (texels.rows + 0.5)).astype(int)
    columns = (scale * (texels.columns + 0.5)).astype(int)
    found = wrinkles.map[rows, columns].astype(np.float64)
    share_of_second = found[:, 3] / 255.0
    amount = first + share_of_second * (second - first)
    levels = found[:, :2] - 128.0
    steepest = wrinkles.steepest / 127.0
    return np.asarray(amount[:, None] * levels * steepest)
