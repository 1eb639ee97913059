"""A clip as binary glTF (.glb), which Blender, browsers and game engines read: metres, y up.

Bones are animated nodes, each standing where its bone turns; all other motion is weights of morph
targets. Every frame of the clip is a keyframe.

    neck ── cranium ─┬─ eye_left, eye_right ── eyeballs
                     ├─ mandible ── lower teeth, tongue, ...
                     └─ upper teeth, ...

The skin hangs on cranium and neck; the neck does not move. The motion by the head's pose is taken
out of the skin's shapes, since the bone of the head adds it again. docs/export.md describes the
content of a file, and how other programs show it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from risorius import assets, render
from risorius.geometry.colour import to_linear
from risorius.geometry.normals import vertex_normals
from risorius.geometry.texels import Texels, rates

from ..errors import as_text
from ..scenes import FaceScene
from .clip import METRES, Clip, Surface
from .formats import Request
from .glb import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, Glb
from .morphs import TOLERANCE, Floats, decompose, follow

HEAD = "cranium"  # name of a bone


@dataclass(frozen=True)
class Piece:
    """A surface with its morph targets.

    bone: moves the whole of it; None: no bone, or the skin's own weights.
    normals: at rest, of unit length, shape (V, 3).
    targets, bends: changes of vertices [mm] and normals by each target, shape (K, V, 3).
    weights: of each target in each frame, shape (N, K).
    """

    surface: Surface
    bone: str | None
    normals: Floats
    targets: Floats
    bends: Floats
    weights: Floats


def write_gltf(clip: Clip, part: Path, request: Request) -> str | None:
    """Write the file; return a remark where it differs visibly from the clip."""
    pieces, error = moving_pieces(clip)
    part.write_bytes(_packed(clip, pieces))
    if error <= TOLERANCE:
        return None
    count = max(len(piece.targets) for piece in pieces)
    return f"{count} morph targets do not suffice: up to {error:.2f} mm off"


def moving_pieces(clip: Clip) -> tuple[list[Piece], float]:
    """The surfaces of a clip with the targets that its motion needs; how far off they are [mm]."""
    pieces = []
    error = 0.0
    for surface, part in zip(clip.surfaces, [None, *clip.scene.parts], strict=True):
        bone = None if part is None else part.bone
        if surface.shapes is None:
            none = np.zeros((0, *surface.rest.shape))
            normals = part.normals.astype(np.float64)
            pieces.append(Piece(surface, bone, normals, none, none, np.zeros((0, 0))))
            continue
        shapes = surface.shapes.astype(np.float64)
        if part is None:
            _take_pose_out(clip, shapes)
        morphs = decompose(shapes - surface.rest)
        normals = vertex_normals(surface.rest, surface.faces)
        bent = np.array([vertex_normals(shape, surface.faces) for shape in shapes])
        bends = follow(morphs.weights, bent - normals)
        pieces.append(Piece(surface, bone, normals, morphs.targets, bends, morphs.weights))
        error = max(error, morphs.error)
    return pieces, error


def _take_pose_out(clip: Clip, shapes: Floats) -> None:
    """Leave shapes of the skin, (N, V, 3), as the head's bone finds them."""
    if not isinstance(clip.scene, FaceScene):
        return
    share = clip.scene.simulation.bones.head_weight[:, None]
    for shape, matrix in zip(shapes, clip.bones[HEAD], strict=True):
        if not np.array_equal(matrix, np.eye(4)):
            turns = np.eye(3) + share[:, :, None] * (matrix[:3, :3] - np.eye(3))
            unmoved = (shape - share * matrix[:3, 3])[:, :, None]
            shape[:] = np.linalg.solve(turns, unmoved)[:, :, 0]


def _packed(clip: Clip, pieces: list[Piece]) -> bytes:
    """The whole file."""
    glb = Glb(clip.times)
    bones = {piece.bone for piece in pieces if piece.bone is not None}
    skeleton = Skeleton(clip, bones, glb)
    roots = list(skeleton.roots)
    for piece in pieces:
        node: dict[str, Any] = {"name": piece.surface.name}
        share = None
        if piece.bone is None and isinstance(clip.scene, FaceScene):
            node["skin"] = skeleton.skin
            share = clip.scene.simulation.bones.head_weight
        node["mesh"] = _add_mesh(glb, clip, piece, skeleton.pivot(piece.bone), share)
        number = glb.add("nodes", node)
        if piece.bone is None:
            roots.append(number)
        else:
            skeleton.hang(number, piece.bone)
        if len(piece.targets):
            glb.animate(number, "weights", piece.weights)
    return glb.to_bytes(as_text(clip.script.title) or "motion", roots)


def _add_mesh(glb: Glb, clip: Clip, piece: Piece, origin: Floats, share: Floats | None) -> int:
    """Add a mesh whose vertices are relative to `origin`; return its number.

    share: of each vertex, how far it goes with the head, shape (V,); None: there is no head.
    """
    surface = piece.surface
    faces: npt.NDArray[Any] = surface.faces
    vertices = coordinates = np.arange(len(surface.rest))
    if surface.face_uv is not None:  # where there are seams, vertices are split
        corners = np.column_stack([faces.ravel(), surface.face_uv.ravel()]).astype(np.int64)
        pairs, numbers = np.unique(corners, axis=0, return_inverse=True)
        (vertices, coordinates) = pairs.T
        faces = numbers.reshape(-1, 3)

    def of_vertices(values: npt.NDArray[Any], *, is_bounded: bool = False) -> int:
        rows = values[vertices].astype(values.dtype if values.dtype == np.uint8 else np.float32)
        return glb.accessor(rows, ARRAY_BUFFER, is_bounded=is_bounded)

    attributes = {
        "POSITION": of_vertices(METRES * (surface.rest - origin), is_bounded=True),
        "NORMAL": of_vertices(piece.normals),
    }
    if surface.uv is not None:
        top_down = np.column_stack([surface.uv[:, 0], 1.0 - surface.uv[:, 1]])
        texels = top_down[coordinates].astype(np.float32)
        attributes["TEXCOORD_0"] = glb.accessor(texels, ARRAY_BUFFER)
    if surface.colours is not None:
        attributes["COLOR_0"] = of_vertices(to_linear(surface.colours))
    if share is not None:
        none = np.zeros_like(share)
        joints = np.column_stack([none, share > 0.0, none, none]).astype(np.uint8)
        attributes["JOINTS_0"] = of_vertices(joints)
        attributes["WEIGHTS_0"] = of_vertices(np.column_stack([1.0 - share, share, none, none]))
    # 16 bits can number so many vertices.
    short = np.uint16 if len(vertices) <= 65535 else np.uint32
    primitive: dict[str, Any] = {
        "attributes": attributes,
        "indices": glb.accessor(faces.astype(short).ravel(), ELEMENT_ARRAY_BUFFER),
        "material": _add_material(glb, clip, surface),
    }
    mesh: dict[str, Any] = {"name": surface.name, "primitives": [primitive]}
    if len(piece.targets):
        primitive["targets"] = [
            {"POSITION": of_vertices(METRES * moved, is_bounded=True), "NORMAL": of_vertices(bent)}
            for moved, bent in zip(piece.targets, piece.bends, strict=True)
        ]
        names = [f"motion {index + 1}" for index in range(len(piece.targets))]
        mesh["extras"] = {"targetNames": names}  # where all readers look for names
    return glb.add("meshes", mesh)


def _add_material(glb: Glb, clip: Clip, surface: Surface) -> int:
    """Add the material of a surface; return its number."""
    rough: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 0.55}  # by eye
    material: dict[str, Any] = {"name": surface.name, "pbrMetallicRoughness": rough}
    if surface.colours is not None:
        # Roughness, chosen by eye; parts go from dull to wet by their shine.
        dull_roughness = 0.75
        wet_roughness = 0.12
        rough["roughnessFactor"] = dull_roughness + surface.shine * (wet_roughness - dull_roughness)
        return glb.add("materials", material)
    material["doubleSided"] = True
    scene = clip.scene
    if scene.albedo is None or surface.uv is None:
        rough["baseColorFactor"] = [*to_linear(render.CLAY), 1.0]
        return glb.add("materials", material)
    rough["baseColorTexture"] = glb.texture(scene.albedo)
    ambient_occlusion = scene.ambient_occlusion
    if ambient_occlusion is not None:
        material["occlusionTexture"] = glb.texture(ambient_occlusion)
    if scene.fine_shape is not None:
        material["normalTexture"] = glb.texture(_normal_map(surface, scene.fine_shape), "png")
    return glb.add("materials", material)


def _normal_map(surface: Surface, fine: assets.FineShape) -> npt.NDArray[np.uint8]:
    """Normals of the fine shape (H, W, 3): along u, across it in the surface, and out of that."""
    assert surface.uv is not None and surface.face_uv is not None
    places = surface.uv[surface.face_uv]
    texels = Texels.within(places.astype(np.float64), fine.slopes.shape[:2], margin=1.0)
    # Slopes are for a unit of u and of v; here they are for a millimetre along u, and across it.
    along, aside = rates(places, surface.rest[surface.faces]).swapaxes(0, 1)
    length = np.maximum(np.linalg.norm(along, axis=1), 1e-9)
    shear = (along * aside).sum(axis=1) / length
    height = np.maximum(np.linalg.norm(np.cross(along, aside), axis=1) / length, 1e-9)
    steps = fine.slopes[texels.rows, texels.columns] - 128.0
    slope_u, slope_v = steps.T * (fine.steepest / 127.0)
    slope_u /= length[texels.faces]
    slope_v = (slope_v - shear[texels.faces] * slope_u) / height[texels.faces]
    normals = np.column_stack([-slope_u, -slope_v, np.ones_like(slope_u)])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    image = np.full((*fine.slopes.shape[:2], 3), (128, 128, 255), np.uint8)
    image[texels.rows, texels.columns] = np.rint(127.5 + 127.5 * normals)
    return image


class Skeleton:
    """The nodes of the bones that something hangs on.

    root: number of the node that they hang on, None where there are none.
    skin: number of the glTF skin of a face, None for a scene without a face.
    """

    def __init__(self, clip: Clip, used: set[str], glb: Glb) -> None:
        self._glb = glb
        neck_bone = "neck"
        self._bones = {
            neck_bone: np.broadcast_to(np.eye(4), (clip.frame_count, 4, 4)),
            **clip.bones,
        }
        self._nodes: dict[str, dict[str, Any]] = {}
        self._pivots: dict[str, Floats] = {}
        self.skin: int | None = None
        if not isinstance(clip.scene, FaceScene):
            self.roots = [self._add(bone, None) for bone in sorted(used)]
            return
        pivots = clip.scene.simulation.bones.pivots()
        self._pivots = {neck_bone: pivots[HEAD], **pivots}
        self.roots = [self._add(neck_bone, None)]
        head = self._add(HEAD, neck_bone)
        for bone in sorted(used - {HEAD, neck_bone}):
            self._add(bone, HEAD)
        to_bone = np.eye(4, dtype=np.float32)
        to_bone[3, :3] = -METRES * pivots[HEAD]  # columns first
        matrices = glb.accessor(np.stack([to_bone, to_bone]))
        joints = {"joints": [*self.roots, head], "inverseBindMatrices": matrices}
        self.skin = glb.add("skins", joints)

    def pivot(self, bone: str | None) -> Floats:
        """Where a bone's node stands at rest [mm], shape (3,); the origin for None."""
        return np.zeros(3) if bone is None else self._pivots.get(bone, np.zeros(3))

    def hang(self, node: int, bone: str) -> None:
        """Let a node hang on a bone."""
        self._nodes[bone].setdefault("children", []).append(node)

    def _add(self, bone: str, parent: str | None) -> int:
        """Add a bone's node, with its motion against the parent's."""
        local = self._places(bone)
        if parent is not None:
            local = np.linalg.inv(self._places(parent)) @ local
        shift = METRES * (self.pivot(bone) - self.pivot(parent))
        self._nodes[bone] = {"name": bone, "translation": shift.tolist()}
        node = self._glb.add("nodes", self._nodes[bone])
        translations = METRES * local[:, :3, 3]
        still_motion = 1e-7  # [m, or of a quaternion]: a node that moves less stands still
        if np.abs(translations - shift).max() > still_motion:
            self._glb.animate(node, "translation", translations)
        rotations = scipy.spatial.transform.Rotation.from_matrix(local[:, :3, :3]).as_quat(
            canonical=True
        )
        if np.abs(rotations[:, :3]).max() > still_motion:
            # q and -q turn alike, but values between two keyframes do not.
            is_opposite = (rotations[1:] * rotations[:-1]).sum(axis=1) < 0.0
            rotations[1:] *= np.cumprod(np.where(is_opposite, -1.0, 1.0))[:, None]
            self._glb.animate(node, "rotation", rotations)
        if parent is not None:
            self.hang(node, parent)
        return node

    def _places(self, bone: str) -> Floats:
        """Matrices (N, 4, 4) from a bone's node to the scene [mm]."""
        to_pivot = np.eye(4)
        to_pivot[:3, 3] = self.pivot(bone)
        places: Floats = self._bones[bone] @ to_pivot
        return places
