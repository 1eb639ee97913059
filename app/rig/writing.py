"""Write an avatar as a binary glTF file in metres, y up, or as a folder of OBJs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from risorius.assets.fitting import FittedHead
from risorius.assets.gltf_file import GltfFile
from risorius.geometry.arrays import Flags, Floats64

from ..files import folder_atomically, written_atomically
from .avatar import Avatar, FileHead, PrintLine, RigRequest, avatar_of
from .bodies import EYE_BONES, Shaped
from .file_mesh import FileMeshWriter, root_matrix
from .glb import Glb
from .gltf_copy import GltfShapes, read_document
from .gltf_lips import cut_primitives, vertices_of
from .obj_folder import OBJ_NAMES, write_obj_folder
from .poses import rest_in
from .scene_file import add_pieces, piece_of
from .skeleton import Skeleton
from .surface import METRES_PER_MILLIMETRE

LOOK_SHAPES = ("eyeLookUp", "eyeLookDown", "eyeLookIn", "eyeLookOut")  # shapes, without the side


def write_avatar(avatar: Avatar, output: Path, title: str, *, is_folder: bool) -> tuple[int, int]:
    """Write an avatar completely, or not at all.

    Returns the size of the written files [bytes], and the number of meshes in the file, or the
    number of files in the folder.
    """
    if is_folder:
        with folder_atomically(output, OBJ_NAMES, overwrite=False) as folder:
            write_obj_folder(avatar, folder)
        files = [path for path in output.rglob("*") if path.is_file()]
        return sum(path.stat().st_size for path in files), 1 + len(avatar.names)
    content = avatar_glb(avatar, title)
    with written_atomically(output) as part:
        part.write_bytes(content)
    return len(content), len(read_document(content, Path())[0]["meshes"])


def make_avatar(
    head: FittedHead | None, output: Path, request: RigRequest, report: PrintLine
) -> None:
    """Make the avatar of a head, and write it; None is the built-in head."""
    title = head.files[0].stem if head is not None and head.files else output.stem
    write_avatar(avatar_of(head, request, report), output, title, is_folder=False)


def avatar_glb(avatar: Avatar, title: str) -> bytes:
    """Return the bytes of the glTF file of an avatar; title: title of the head."""
    if avatar.file is not None and avatar.file.painted is None:
        return _copied_gltf(avatar, avatar.file, title)
    glb = Glb()
    if avatar.file is None:
        roots = _add_scene(glb, avatar)
    else:
        roots = [_add_file(glb, avatar, avatar.file, title)]
    if avatar.extras:
        glb.parts["extras"] = {**glb.parts.get("extras", {}), **avatar.extras}
        for mesh in glb.parts["meshes"]:
            if "targetNames" in mesh.get("extras", {}):
                mesh["extras"].update(avatar.extras)
    return glb.to_bytes(title, roots)


def _copied_gltf(avatar: Avatar, file: FileHead, title: str) -> bytes:
    """Return a copy of a glTF file with the shapes of an avatar, and with its built-in parts."""
    content = file.path.read_bytes()
    glb = Glb(None, *read_document(content, file.path.parent))
    cut = file.head.lip_cut
    vertices = vertices_of(file.stored, cut)
    if cut is not None:
        cut_primitives(glb, GltfFile(content, file.path.parent), file.stored, vertices, cut)
    writer = GltfShapes(glb, avatar.shapes[0], file.head.to_millimetres, cut)
    writer.append(file.stored, vertices, avatar.names, avatar.extras)
    roots = [_add_parts(glb, avatar, file)] if len(avatar.shapes) > 1 else []
    return glb.to_bytes(title, roots)


def _add_scene(glb: Glb, avatar: Avatar) -> list[int]:
    """Add the surfaces of the built-in head or a person; return the nodes of the scene."""
    skeleton, roots = _add_surfaces(glb, avatar, avatar.shapes)
    return [*skeleton.roots, *roots]


def _add_surfaces(
    glb: Glb, avatar: Avatar, shapes: Sequence[Shaped], *, skins: bool = True
) -> tuple[Skeleton, list[int]]:
    """Add surfaces and their bones; return the skeleton, and the other nodes without a parent.

    skins: as in `Skeleton`.
    """
    pieces = [piece_of(avatar.scene, each, avatar.names) for each in shapes]
    used = {piece.bone for piece in pieces if piece.bone is not None}
    skeleton = Skeleton(avatar.scene, used, glb, skins=skins)
    for eye in used & set(EYE_BONES):
        skeleton.note(eye, looks_of(avatar, eye, np.eye(3)))
    return skeleton, add_pieces(glb, avatar.scene, pieces, skeleton)


def _add_file(glb: Glb, avatar: Avatar, file: FileHead, title: str) -> int:
    """Add the mesh of a file, and built-in parts; return the number of their root node."""
    to_millimetres = file.head.to_millimetres
    matrix = root_matrix(to_millimetres)
    children = _add_file_mesh(glb, avatar, file)
    if len(avatar.shapes) > 1:
        children.append(_add_parts(glb, avatar, file))
    return glb.add(
        "nodes", {"name": title, "matrix": matrix.T.ravel().tolist(), "children": children}
    )


def _add_file_mesh(glb: Glb, avatar: Avatar, file: FileHead) -> list[int]:
    """Add the mesh of a file; eyeballs may be separate nodes. Returns the indices of the nodes."""
    assert file.painted is not None
    writer = FileMeshWriter(glb, file.painted, file.head.to_millimetres, avatar.shapes[0])
    is_left = ~_is_of_role(file, "hidden")
    nodes = []
    back = file.head.to_millimetres.inverse
    pivots = file.body.pivots if avatar.eyes_are_nodes else {}
    for eye, pivot in pivots.items():
        is_own = _is_of_role(file, eye)
        is_left &= ~is_own
        centre = back.points(pivot)
        node = {
            "name": eye,
            "mesh": writer.add_rigid(eye, is_own, centre),
            "translation": centre.tolist(),
            "extras": looks_of(avatar, eye, back.rotation),
        }
        nodes.append(glb.add("nodes", node))
    mesh = writer.add(avatar.names, is_left)
    return [glb.add("nodes", {"name": "head", "mesh": mesh}), *nodes]


def _is_of_role(file: FileHead, role: str) -> Flags:
    """Return flags of the triangles of a file that belong to pieces with a role, (F,)."""
    is_vertex = np.zeros(len(file.body.rest), np.bool_)
    for piece in file.pieces:
        if piece.role == role:
            is_vertex[piece.vertices] = True
    return is_vertex[file.body.faces[:, 0]]


def _add_parts(glb: Glb, avatar: Avatar, file: FileHead) -> int:
    """Add built-in parts below a node that converts metres to the file's unit; return the node."""
    skeleton, _ = _add_surfaces(glb, avatar, avatar.shapes[1:], skins=False)
    back = file.head.to_millimetres.inverse
    matrix = np.eye(4)
    matrix[:3, :3] = back.scale / METRES_PER_MILLIMETRE * back.rotation
    matrix[:3, 3] = back.shift
    node = {
        "name": "parts",
        "matrix": matrix.T.ravel().tolist(),
        "children": skeleton.roots,
    }
    return glb.add("nodes", node)


def looks_of(avatar: Avatar, eye: str, turn: Floats64) -> dict[str, Any]:
    """Return the extras of an eye's node: for each shape of the eye, its rotation at 1.

    A rotation is a quaternion x, y, z, w. turn: matrix (3, 3) from the face's axes to the node's
    axes.
    """
    side = eye.removeprefix("eye_").capitalize()
    found = {}
    for look in LOOK_SHAPES:
        name = look + side
        if name in avatar.names:
            matrix = rest_in(avatar.scene, {name: 1.0}).matrices[eye][:3, :3]
            turned = scipy.spatial.transform.Rotation.from_matrix(turn @ matrix @ turn.T)
            found[name] = turned.as_quat(canonical=True).round(6).tolist()
    return {"rotations": found}
