"""Reads the surface in a glTF or GLB file: triangles at rest, and their paint.

Nodes place meshes, bones deform them, and morph targets are added with the file's weights. The
result is one list of triangles in the coordinates of the scene, node by node and part by part.

A vertex at a seam of the texture occurs twice in the file. Vertices of one node at the same place
are merged, unless a morph target or a bone of the file moves them apart: such vertices belong, for
example, to two lips that touch.

Source: Khronos Group, "glTF 2.0 Specification", section 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers64, Unsigned8
from ..geometry.numbering import numbered_by_first_use
from .gltf_file import GltfFile, entry
from .gltf_painter import GltfPainter
from .pictures import MeshPictures
from .topology import strip_triangles


@dataclass(frozen=True)
class GltfSurface:
    """The surface in a glTF file.

    vertices: in the coordinates of the scene, shape (V, 3). faces: shape (F, 3).
    same: for each vertex, the coinciding vertex that `faces` use instead, shape (V,). corners: the
    same triangles with the vertex indices of the file, shape (F, 3). texture: pictures and their
    places; None without pictures. colours: vertex colours, sRGB, shape (V, 3), uint8, or None.
    has_colour: flags of vertices with a colour, shape (V,).
    """

    vertices: Floats64
    faces: Integers64
    same: Integers64
    corners: Integers64
    texture: MeshPictures | None
    colours: Unsigned8 | None
    has_colour: Flags


@dataclass(frozen=True)
class StoredPiece:
    """One primitive of a mesh in one node, and where its vertices are in the file.

    node, mesh, primitive: their indices; primitives are counted within a mesh. count: number of
    vertices, which follow the vertices of earlier pieces. to_scene: maps displacements of stored
    vertices to the scene, a matrix (3, 3) or one for each vertex, (V, 3, 3). triangles: vertex
    indices within the piece, in the file's winding order, shape (F, 3). name: name of the node, or
    of its mesh.
    """

    node: int
    mesh: int
    primitive: int
    count: int
    to_scene: Floats64
    triangles: Integers64
    name: str


class _Piece(NamedTuple):
    """One primitive of a mesh, as one node shows it."""

    node: int
    mesh: int
    primitive: int
    to_scene: Floats64
    stored: Floats64  # (V, 3) positions as in the file
    seen: Floats64  # (V, 3) in the scene
    motion: Floats64  # (V, 4) mixture of shapes and bones: equal for vertices that move alike
    faces: Integers64  # (F, 3)
    is_turned: bool  # whether the file's triangles run the other way round
    picture: int  # its number, -1 for none
    uv: Floats64  # (V, 2), v up
    colours: Unsigned8 | None  # (V, 3)


def read_gltf(content: bytes, folder: Path) -> GltfSurface:
    """Read the surface in a file. folder: the folder of the file, with further files that it names.

    Raises AssetError for an unreadable kind, any other error for a broken file.
    """
    reader = _Reader(GltfFile(content, folder))
    pieces = [*reader.pieces()]
    starts = np.cumsum([0, *(len(piece.seen) for piece in pieces)])
    shifted = [piece.faces + start for piece, start in zip(pieces, starts, strict=False)]
    corners = np.vstack([np.zeros((0, 3), np.int64), *shifted])
    face_counts = [len(piece.faces) for piece in pieces]
    picture = np.repeat([piece.picture for piece in pieces], face_counts)
    same = np.concatenate([np.zeros(0, np.int64), *_same_vertices(pieces, starts)])
    faces = same[corners]
    has_area = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    faces = faces[has_area]
    corners = corners[has_area]
    picture = picture[has_area]
    texture = None
    if reader.painter.pictures:
        uv = np.vstack([piece.uv for piece in pieces])
        texture = MeshPictures(
            np.nan_to_num(uv).astype(np.float32),
            corners.astype(np.int32),
            picture.astype(np.int64),
            tuple(reader.painter.pictures.values()),
        )
    has_colour = [np.full(len(piece.seen), piece.colours is not None) for piece in pieces]
    colours = [np.zeros(piece.seen.shape, np.uint8) for piece in pieces]
    for place, piece in enumerate(pieces):
        if piece.colours is not None:
            colours[place] = piece.colours
    is_coloured = any(piece.colours is not None for piece in pieces)
    return GltfSurface(
        vertices=np.vstack([np.zeros((0, 3)), *(piece.seen for piece in pieces)]),
        faces=faces,
        same=same,
        corners=corners,
        texture=texture,
        colours=np.vstack(colours) if is_coloured else None,
        has_colour=np.concatenate([np.zeros(0, np.bool_), *has_colour]),
    )


def stored_pieces(content: bytes, folder: Path) -> list[StoredPiece]:
    """Return the pieces of a file, in the vertex order of `read_gltf`; raises the same errors."""
    reader = _Reader(GltfFile(content, folder))
    return [
        StoredPiece(
            node=each.node,
            mesh=each.mesh,
            primitive=each.primitive,
            count=len(each.seen),
            to_scene=each.to_scene,
            triangles=each.faces[:, ::-1] if each.is_turned else each.faces,
            name=reader.name_of(each.node),
        )
        for each in reader.pieces()
    ]


class _Reader:
    """Reads pieces; the painter collects their pictures."""

    STRIP = 5
    FAN = 6

    def __init__(self, file: GltfFile) -> None:
        self.painter = GltfPainter(file)
        self._file = file
        self._document = file.document
        self._worlds = _node_matrices(self._document.nodes or [])

    def pieces(self) -> Iterator[_Piece]:
        """The pieces of all nodes that the scene shows."""
        triangles = 4  # the number of this mode
        for number in self._shown():
            node = self._document.nodes[number]
            if node.mesh is None:
                continue
            mesh = self._document.meshes[node.mesh]
            weights = (node.extras or {}).get("weights") or mesh.weights or []
            for place, primitive in enumerate(mesh.primitives):
                has_surface = primitive.mode is None or primitive.mode in (
                    triangles,
                    self.STRIP,
                    self.FAN,
                )
                if has_surface and primitive.attributes.POSITION is not None:
                    yield self._piece(number, place, weights)

    def name_of(self, number: int) -> str:
        """Return the name of a node with a mesh, or of this mesh; empty if neither has a name."""
        node = self._document.nodes[number]
        return str(node.name or self._document.meshes[node.mesh].name or "")

    def _shown(self) -> list[int]:
        """The nodes of the scene, from its last root down: vertex indices follow this order."""
        document = self._document
        if document.scenes:
            waiting = [*(document.scenes[document.scene or 0].nodes or [])]
        else:
            children = {child for node in document.nodes for child in node.children or ()}
            waiting = [number for number in range(len(document.nodes)) if number not in children]
        found: dict[int, None] = {}
        while waiting:
            number = waiting.pop()
            if number not in found:
                found[number] = None
                waiting += document.nodes[number].children or []
        return [*found]

    def _piece(self, number: int, which: int, weights: list[float]) -> _Piece:
        """Return a node's primitive, by its index in the mesh. weights: those of morph targets."""
        primitive = self._document.meshes[self._document.nodes[number].mesh].primitives[which]
        attributes = vars(primitive.attributes)
        stored = self._file.values(attributes["POSITION"]).astype(np.float64)
        points = stored
        motion = np.zeros((len(stored), 4))
        mixture = np.random.default_rng(0)  # of shapes and bones: no two motions cancel
        targets = [entry(target, "POSITION") for target in primitive.targets or []]
        for place, target in enumerate(targets):
            factors = mixture.uniform(0.5, 1.5)
            if target is None:
                continue
            added = self._file.values(target).astype(np.float64)
            motion[:, :3] += factors * added
            if place < len(weights) and weights[place]:
                points = points + weights[place] * added
        node = self._document.nodes[number]
        world = self._worlds[number]
        seen = _moved(points, world)
        to_scene = world[:3, :3]
        is_turned = np.linalg.det(world[:3, :3]) < 0.0
        if node.skin is not None and attributes.get("JOINTS_0") is not None:
            is_turned = False
            seen, motion[:, 3], to_scene = self._bent(
                points, seen, world, attributes, node.skin, mixture
            )
        faces = self._faces(primitive, len(stored))
        picture, uv, factor = self.painter.painted(primitive, len(stored))
        colours = self.painter.colours(attributes, factor)
        turned = np.ascontiguousarray(faces[:, ::-1]) if is_turned else faces
        return _Piece(
            node=number,
            mesh=node.mesh,
            primitive=which,
            to_scene=to_scene,
            stored=stored,
            seen=seen,
            motion=motion,
            faces=turned,
            is_turned=is_turned,
            picture=picture,
            uv=uv,
            colours=colours,
        )

    def _bent(
        self,
        points: Floats64,
        unbent: Floats64,
        world: Floats64,
        attributes: Mapping[str, Any],
        skin: int,
        mixture: np.random.Generator,
    ) -> tuple[Floats64, Floats64, Floats64]:
        """Return points moved by bones, (V, 3), a fingerprint of each point's bones, (V,), and
        the linear parts of the motions, (V, 3, 3).

        unbent: points moved only by the node's matrix `world`, for points without a bone.
        """
        bones = self._document.skins[skin]
        motions = np.array([self._worlds[joint] for joint in bones.joints])
        if bones.inverseBindMatrices is not None:
            columns = self._file.values(bones.inverseBindMatrices)
            motions = motions @ columns.reshape(-1, 4, 4).swapaxes(1, 2)[: len(motions)]
        sets = [n for n in range(8) if attributes.get(f"JOINTS_{n}") is not None]
        joints = np.hstack([self._file.values(attributes[f"JOINTS_{n}"]) for n in sets])
        weights = np.hstack([self._file.values(attributes[f"WEIGHTS_{n}"]) for n in sets])
        names = mixture.uniform(0.5, 1.5, len(motions))
        total = weights.sum(axis=1)
        is_held = total > 0.0
        weights = weights / np.where(is_held, total, 1.0)[:, None]
        bent = np.zeros_like(points)
        turns = np.zeros((len(points), 3, 3))
        for slot in range(weights.shape[1]):
            matrices = motions[joints[:, slot].astype(int)]
            bent += weights[:, slot, None] * _moved(points, matrices)
            turns += weights[:, slot, None, None] * matrices[:, :3, :3]
        bent[~is_held] = unbent[~is_held]
        turns[~is_held] = world[:3, :3]
        return bent, (weights * names[joints.astype(int)]).sum(axis=1), turns

    def _faces(self, primitive: Any, count: int) -> Integers64:
        """The triangles of a primitive with this many vertices."""
        numbers = np.arange(count)
        if primitive.indices is not None:
            numbers = self._file.values(primitive.indices)[:, 0].astype(np.int64)
        if len(numbers) and numbers.max() >= count:
            raise IndexError(f"a triangle names vertex {numbers.max()} of {count}")
        if primitive.mode == self.STRIP:
            return strip_triangles(numbers)
        if primitive.mode == self.FAN:
            hub = np.repeat(numbers[:1], max(len(numbers) - 2, 0))
            return np.stack([hub, numbers[1:-1], numbers[2:]], axis=1)
        return numbers[: len(numbers) // 3 * 3].reshape(-1, 3)


def _moved(points: Floats64, matrices: Floats64) -> Floats64:
    """Move points (V, 3) by one matrix, (4, 4), or each by its own matrix, (V, 4, 4)."""
    rows = matrices[..., :3, :]
    # Written out, so that equal points stay equal to the last bit at any place in the list.
    x, y, z = points.T[:, :, None]
    moved: Floats64 = rows[..., 0] * x + rows[..., 1] * y + rows[..., 2] * z + rows[..., 3]
    return moved


def _node_matrices(nodes: list[Any]) -> list[Floats64]:
    """The matrix of each node to the scene, (4, 4)."""
    parents = {}
    for number, node in enumerate(nodes):
        parents.update(dict.fromkeys(node.children or (), number))
    local = [_local_matrix(node) for node in nodes]
    found = []
    for number in range(len(nodes)):
        matrix = local[number]
        above = parents.get(number)
        steps = 0
        while above is not None:
            matrix = local[above] @ matrix
            above = parents.get(above)
            steps += 1
            if steps > len(nodes):
                raise ValueError(f"node {number} is its own ancestor")
        found.append(matrix)
    return found


def _local_matrix(node: Any) -> Floats64:
    """The matrix of a node to its parent, (4, 4)."""
    from scipy.spatial.transform import Rotation  # imported late, so that loading a head is fast

    if node.matrix:
        return np.array(node.matrix, np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    if node.rotation:
        matrix[:3, :3] = Rotation.from_quat(node.rotation).as_matrix()
    matrix[:3, :3] *= np.array(node.scale or (1.0, 1.0, 1.0))
    matrix[:3, 3] = node.translation or (0.0, 0.0, 0.0)
    return matrix


def _same_vertices(pieces: list[_Piece], starts: Integers64) -> Iterator[Integers64]:
    """Return, for each vertex, node by node, the first of the vertices merged with it."""
    for node in dict.fromkeys(piece.node for piece in pieces):
        own = [piece for piece in pieces if piece.node == node]
        first = next(number for number, piece in enumerate(pieces) if piece.node == node)
        motion = np.vstack([piece.motion for piece in own])
        farthest = abs(motion[:, :3]).max(initial=0.0)
        motion[:, :3] /= max(farthest, 1e-300)
        yield starts[first] + _first_of_same(np.vstack([piece.stored for piece in own]), motion)


def _first_of_same(stored: Floats64, motion: Floats64) -> Integers64:
    """Return, for each vertex, the first vertex at its place that moves alike, shape (V,)."""
    same = np.arange(len(stored))
    left = np.arange(len(stored))
    # Two vertices move alike up to this share of the farthest motion of any vertex.
    least_distance = 1e-3
    most_in_one_place = 16  # different motions of vertices; further ones stay apart
    for _ in range(most_in_one_place):
        first, number = numbered_by_first_use(stored[left] + 0.0)  # turns -0.0 into 0.0
        same[left] = left[first[number]]
        apart = abs(motion[left] - motion[same[left]]).max(axis=1)
        left = left[apart > least_distance]
        if not len(left):
            return same
    same[left] = left
    return same
