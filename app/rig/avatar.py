"""Make the avatar that `risorius rig` writes: a head with named shapes from the simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.assets.fitting import FittedHead
from risorius.assets.gltf import StoredPiece, stored_pieces
from risorius.assets.meshes import read_mesh
from risorius.assets.painted import PaintedMesh, read_painted
from risorius.geometry.arrays import Floats64

from ..errors import UserError
from ..scenes import FaceScene, build_face
from ..script import Script
from .bodies import Body, Shaped, SkinBody, bodies_of_parts, moving, poses_of
from .file_body import FileBody, merged_vertices, with_own_tongue
from .linearity import Difference, corrective_poses, table, worth_correcting
from .linearity import corrected as corrected_shapes
from .pieces import FilePiece, corrected, described, find_pieces, without_helpers
from .poses import shape_names
from .take_linearity import difference_on, played_take, worth_correcting_on

GLTF_SUFFIXES = (".glb", ".gltf")


@dataclass(frozen=True)
class RigRequest:
    """Options of an avatar.

    kinds: kinds of shapes, see `poses.SHAPE_KINDS`.
    eyes: "nodes" or "targets" turn the eyeballs; None: the default of the file's format.
    corrections: corrected roles of pieces, see `pieces.corrected`.
    adds_parts: whether missing eyes, teeth and tongue are added.
    correctives: greatest number of corrective shapes; each corrects a pair of shapes.
    progress: whether a progress bar is shown.
    take: the take on which sums of ARKit's shapes are compared with the simulation, or None.
    chooses_by_take: whether the take decides which pairs get correctives.
    """

    kinds: tuple[str, ...] = ("arkit",)
    eyes: str | None = None
    corrections: tuple[str, ...] = ()
    adds_parts: bool = False
    correctives: int = 0
    progress: bool = True
    take: Script | None = None
    chooses_by_take: bool = False

    def has_eye_nodes(self, *, is_gltf: bool) -> bool:
        """Whether nodes turn the eyeballs; by default they do, except in a glTF file."""
        return self.eyes == "nodes" if is_gltf else self.eyes != "targets"


@dataclass(frozen=True)
class FileHead:
    """A head from a file, with the pieces of the file, and the body that a simulated face moves.

    painted: colours and textures of the file; None for a glTF file, which is copied.
    stored: meshes of a glTF file, see `stored_pieces`; empty for other files.
    """

    head: FittedHead
    body: FileBody
    pieces: tuple[FilePiece, ...]
    painted: PaintedMesh | None
    stored: tuple[StoredPiece, ...]
    path: Path


@dataclass(frozen=True)
class Avatar:
    """A head with named shapes.

    file: the file of a user's head; None for the built-in head or a person.
    shapes: shapes of each body; the body of the file, or the skin, comes first.
    names: names of the shapes; correctives come last, in the order of `pairs`.
    pairs: pairs of shapes that have a corrective.
    eyes_are_nodes: whether nodes turn the eyeballs.
    sums: errors of sums of shapes.
    """

    scene: FaceScene
    file: FileHead | None
    shapes: tuple[Shaped, ...]
    names: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...]
    eyes_are_nodes: bool
    sums: tuple[Difference, ...]

    @property
    def extras(self) -> dict[str, Any]:
        """The extras of a file: the rule for weights of correctives, or {} without correctives."""
        rules = [
            {"name": f"{first}_{second}", "product": [first, second]}
            for first, second in self.pairs
        ]
        return {"correctives": rules} if rules else {}


PrintLine = Callable[[str], None]


def avatar_of(head: FittedHead | None, request: RigRequest, report: PrintLine) -> Avatar:
    """Make the avatar of a head; None is the built-in head.

    The avatar of a head from a file includes all pieces of this file. `report` is called with lines
    about the avatar.
    """
    file = None
    if head is not None and head.files:
        file = file_head(head, request, report)
        head = file.head
    scene = build_face(head)
    eyes_are_nodes = request.has_eye_nodes(is_gltf=file is not None and file.painted is None)
    bodies: list[Body] = []
    if file is None:
        bodies.append(SkinBody(np.array(scene.rest_positions), scene.faces))
        bodies += bodies_of_parts(scene, eyes_are_nodes=eyes_are_nodes)
    else:
        bodies.append(file.body)
        missing = _missing(file)
        if request.adds_parts:
            added = {name for parts in missing.values() for name in parts}
            bodies += bodies_of_parts(
                scene, eyes_are_nodes=eyes_are_nodes, wanted=lambda part: part.name in added
            )
        elif missing:
            report(f"not in the file: {', '.join(missing)}; --parts adds built-in ones")
    names = shape_names(scene, request.kinds)
    poses = dict(poses_of(scene, names, progress=request.progress))
    pairs: list[tuple[str, str]] = []
    take = None
    if request.take is not None and "arkit" in request.kinds:
        take = played_take(scene, request.take)
    if request.correctives:
        count = request.correctives
        if take is not None and request.chooses_by_take:
            pairs = worth_correcting_on(take, scene, poses, count, progress=request.progress)
        else:
            pairs = worth_correcting(scene, poses, count, progress=request.progress)
        poses.update(corrective_poses(scene, pairs))
        names = tuple(poses)
        report(
            f"correctives: {', '.join(names[len(names) - len(pairs) :]) or 'none reduces an error'}"
        )
    sums = table(scene, poses, pairs)
    for difference in sums:
        report(f"error of a sum of shapes: {difference}")
    if take is not None:
        sums.append(difference_on(take, scene, poses, pairs))
        report(f"error of sums of shapes in all frames of a take, {sums[-1]}")
    shapes = tuple(_without_sums(each, pairs, names) for each in moving(bodies, poses))
    return Avatar(
        scene=scene,
        file=file,
        shapes=shapes,
        names=names,
        pairs=tuple(pairs),
        eyes_are_nodes=eyes_are_nodes,
        sums=tuple(sums),
    )


def _without_sums(shaped: Shaped, pairs: list[tuple[str, str]], names: tuple[str, ...]) -> Shaped:
    return corrected_shapes(shaped, pairs, names) if pairs else shaped


def file_head(head: FittedHead, request: RigRequest, report: PrintLine) -> FileHead:
    """Read the file of a fitted head, and find its pieces.

    Raises AssetError for unusable files, and UserError for wrong options.
    """
    path = head.files[0]
    is_gltf = path.suffix.lower() in GLTF_SUFFIXES
    painted = None if is_gltf else read_painted(path)
    mesh = read_mesh(path) if painted is None else painted.mesh
    stored = tuple(stored_pieces(path.read_bytes(), path.parent)) if is_gltf else ()
    if head.lip_cut is not None:
        mesh = head.lip_cut.applied(mesh)
        painted = painted and replace(painted, mesh=mesh)
    rest = head.to_millimetres.points(mesh.vertices)
    if not _is_as_fitted(rest, head):
        raise UserError(f"{path}: has changed since it was read; open it again")
    same = merged_vertices(mesh, head)
    faces = same[mesh.faces].astype(np.int32)
    names = _names_of_vertices(len(rest), painted, stored)
    found = find_pieces(rest, faces, head.file_vertices, head, names)
    pieces = corrected(found if is_gltf else without_helpers(found), request.corrections)
    if is_gltf and any(piece.role == "hidden" for piece in pieces):
        raise UserError(
            f"--piece: '{path}' is copied as it is, so its pieces cannot be hidden; delete them in "
            "a 3D program, or leave the option out"
        )
    tongues = [piece.vertices for piece in pieces if piece.role == "tongue"]
    if tongues:
        parts = with_own_tongue(head, rest, np.concatenate(tongues), faces)
        simplified = head.simplified and replace(head.simplified, parts=parts)
        head = replace(head, parts=parts, simplified=simplified)
    body = FileBody(mesh, head, pieces, eyes_are_nodes=request.has_eye_nodes(is_gltf=is_gltf))
    how = "simulated" if head.simplified is None else "following a simplified mesh"
    report(f"skin: {len(head.vertices)} of {len(rest)} vertices, {how}")
    if len(body.in_bag):
        report(f"skin behind the lips: {len(body.in_bag)} vertices, stretches between both jaws")
    for line in described(pieces):
        report(line)
    return FileHead(
        head=head,
        body=body,
        pieces=tuple(pieces),
        painted=painted,
        stored=stored,
        path=path,
    )


def _names_of_vertices(
    count: int, painted: PaintedMesh | None, stored: Sequence[StoredPiece]
) -> npt.NDArray[np.object_]:
    """Return the name of the object or group of each vertex, (V,); "" if it has none."""
    names = np.full(count, "", object)
    start = 0
    for piece in stored:
        names[start : start + piece.count] = piece.name
        start += piece.count
    if painted is not None:
        labels = np.array([*painted.parts, ""], object)  # the last label: no name
        names[painted.mesh.faces] = labels[painted.part][:, None]
    return names


def _is_as_fitted(rest: Floats64, head: FittedHead) -> bool:
    """Whether a file's vertices [mm] equal the vertices of the fitted head, to 0.001 mm."""
    fitted = head.file_vertices
    if len(fitted) and fitted.max() >= len(rest):
        return False
    return bool(np.allclose(rest[fitted], head.vertices, rtol=0.0, atol=1e-3))


def _missing(file: FileHead) -> dict[str, tuple[str, ...]]:
    """Return kinds of parts that a file lacks, with the names of the built-in parts."""
    roles = {piece.role for piece in file.pieces}
    found: dict[str, tuple[str, ...]] = {}
    if not roles & {"eye_left", "eye_right"} and not len(file.body.between_lids):
        found["eyes"] = ("eyeball_left", "eyeball_right", "eye_corners")
    if not roles & {"upper_teeth", "lower_teeth"}:
        found["teeth"] = ("teeth_upper", "teeth_lower", "gums_upper", "gums_lower")
    if "tongue" not in roles:
        found["tongue"] = ("tongue",)
    if "mouth" not in roles and not len(file.body.in_bag):
        found["inside of the mouth"] = ("oral_cavity_upper", "oral_cavity_lower")
    return found
