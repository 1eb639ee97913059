"""The mesh of a file as one body; each vertex follows the simulated skin or a bone, or is fixed.

The skin of a scene has vertices of the file, which take exactly their simulated positions. Skin
behind the lips, the bag, is not simulated. A harmonic function stretches it between the edges of
the lips and both jaws. It solves the Laplace equation with equal weights for all edges.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

from risorius.assets import Part
from risorius.assets.fitting import FittedHead
from risorius.assets.fitting.eyeballs import sphere_of
from risorius.assets.fitting.mesh_validation import with_seams_joined
from risorius.assets.meshes import Mesh
from risorius.geometry.arrays import Flags, Floats64, Integers, Integers32
from risorius.geometry.closest import closest_points
from risorius.geometry.mesh_graph import edge_graph, pieces_of
from risorius.geometry.normals import vertex_normals
from risorius.geometry.numbering import places_among
from risorius.geometry.sides import edges_of
from risorius.geometry.transforms import moved_points

from ..scenes.bent_part import FaceNow
from ..scenes.skin_part import SkinPart
from .bodies import EYE_BONES
from .pieces import FilePiece
from .poses import CRANIUM_BONE, FacePose

LIP_HEIGHT = 10.0  # [mm]; height over which motion changes from one jaw to the other
ROOT_TOLERANCE = 1.5  # [mm]; how much farther from the skin than the nearest root lashes may begin
TONGUE_NAME = "tongue"  # name of a part
TONGUE_COLOUR = (0.75, 0.42, 0.4)  # sRGB, for a tongue without a colour in the file


class FileBody:
    """A body with all vertices of a file [mm], in the file's order.

    pivots: bone of an eyeball -> centre of the eyeball [mm], (3,).
    in_bag: indices of the vertices behind the lips that are not simulated, (n,).
    between_lids: indices of vertices between the lids that are not simulated, (m,).
    """

    name = "head"

    def __init__(
        self,
        mesh: Mesh,
        head: FittedHead,
        pieces: Sequence[FilePiece],
        *,
        eyes_are_nodes: bool,
    ) -> None:
        self.rest: Floats64 = head.to_millimetres.points(mesh.vertices)
        same = merged_vertices(mesh, head)
        self.faces: Integers32 = same[mesh.faces].astype(np.int32)
        self._place = places_in_skin(head, same)
        is_simulated = np.zeros(len(same), np.bool_)
        is_simulated[head.file_vertices] = True
        self._same = np.where(is_simulated, np.arange(len(same)), same)
        by_role: dict[str, list[npt.NDArray[np.integer]]] = {}
        for each in pieces:
            by_role.setdefault(each.role, []).append(each.vertices)
        self._pieces = {role: np.concatenate(vertices) for role, vertices in by_role.items()}
        self._eyes_are_nodes = eyes_are_nodes
        self.pivots: dict[str, Floats64] = {}
        for eye in head.eyes:
            role = f"eye_{eye.name}"
            layers = [self.rest[piece.vertices] for piece in pieces if piece.role == role]
            balls = [sphere_of(points, eye.centre, eye.radius) for points in layers]
            if balls:  # the largest ball, because an iris is smaller
                self.pivots[role] = max(balls, key=lambda ball: ball[1])[0]
        piece = pieces_of(self.faces, len(self.rest))
        own = piece == piece[same[head.file_vertices[head.landmarks[0]]]]
        own &= np.isin(np.arange(len(own)), self.faces)
        self._skin = self._place >= 0
        hidden = np.flatnonzero(own & ~self._skin)
        is_eye = _is_near_eyes(self.rest[hidden], head)
        self.in_bag = hidden[~is_eye]
        self.between_lids = hidden[is_eye]
        lips = head.vertices[head.landmarks[60:68]].mean(axis=0)
        self._lip_height = float(lips[1])
        self._bag = None
        if len(hidden):
            self._bag = _Bag(hidden, is_eye, self.faces, self.rest)
        self._lashes = self._attached(head) if "on_skin" in self._pieces else None

    def at(self, pose: FacePose) -> Floats64:
        """Return the vertices in a pose [mm], (V, 3)."""
        moved = self.rest.copy()
        moved[self._skin] = pose.skin[self._place[self._skin]]
        mandible = pose.matrices["mandible"]
        for role, indices in self._pieces.items():
            if role in EYE_BONES and not self._eyes_are_nodes:
                pivot = self.pivots[role]
                turned = (self.rest[indices] - pivot) @ pose.matrices[role][:3, :3].T
                moved[indices] = pivot + turned
            elif role == "lower_teeth":
                moved[indices] = moved_points(mandible, self.rest[indices])
            elif role == "mouth":
                moved[indices] = self._between_jaws(indices, mandible)
            elif role == TONGUE_NAME:
                moved[indices] = moved_points(mandible, pose.parts[TONGUE_NAME].astype(np.float64))
        if self._lashes is not None:
            self._lashes.follow(FaceNow(pose.skin, pose.matrices))
            moved[self._pieces["on_skin"]] = self._lashes.vertices
        if self._bag is not None:
            deep = self._bag.deep
            if len(deep):
                moved[deep] = self._between_jaws(deep, mandible)
            self._bag.stretch(moved, self.rest)
        spread: Floats64 = moved[self._same]
        return spread

    def normals_at(self, points: Floats64) -> Floats64:
        """Return unit normals for vertices at `points` (V, 3)."""
        normals: Floats64 = vertex_normals(points, self.faces)[self._same]
        return normals

    def _between_jaws(self, indices: Integers, mandible: Floats64) -> Floats64:
        """Move n vertices between the jaws; low vertices far from the throat follow the mandible.

        mandible: matrix (4, 4). Returns positions [mm], (n, 3).
        """
        points = self.rest[indices]
        weights = np.clip((self._lip_height - points[:, 1]) / LIP_HEIGHT + 0.5, 0.0, 1.0)
        from_throat = points[:, 2] - points[:, 2].min()
        farthest = max(float(from_throat.max()), 1e-9)
        # At the throat the weight is 0.
        weights *= np.clip(2.0 * from_throat / farthest, 0.0, 1.0)
        with_mandible = moved_points(mandible, points)
        moved: Floats64 = points + weights[:, None] * (with_mandible - points)
        return moved

    def _attached(self, head: FittedHead) -> SkinPart:
        """Attach lashes and brows to the skin; a vertex turns with its piece's nearest root."""
        indices = self._pieces["on_skin"]
        points = self.rest[indices]
        distance = closest_points(points, head.vertices, head.faces).distances
        piece = pieces_of(self.faces, len(self.rest))[indices]
        order = np.argsort(piece, kind="stable")
        starts = np.flatnonzero(np.diff(piece[order])) + 1
        roots = np.zeros(len(indices), np.int32)
        for members in np.split(order, starts):
            farthest = distance[members].min() + ROOT_TOLERANCE
            piece_roots = members[distance[members] < farthest]
            _, nearest = scipy.spatial.cKDTree(points[piece_roots]).query(points[members])
            roots[members] = piece_roots[nearest]
        faces = _faces_among(indices, self.faces, len(self.rest))
        part = _part("on_skin", points, faces, CRANIUM_BONE, roots)
        return SkinPart(part, head.vertices, head.faces)


def _is_near_eyes(points: Floats64, head: FittedHead) -> Flags:
    """Return flags of points (n, 3) [mm] at the eyeballs: skin between the lids of a scan."""
    near = 1.8  # radii of an eyeball
    is_near = np.zeros(len(points), np.bool_)
    for eye in head.eyes:
        distances = np.linalg.norm(points - eye.centre, axis=1)
        is_near |= distances / eye.radius < near
    return is_near


class _Bag:
    """Skin of a file that is not simulated: a bag behind the lips, and skin between the lids.

    The deep half of the bag moves with the jaws. All else is stretched between placed vertices, so
    skin between the lids does not pierce them when they shut.
    """

    def __init__(self, indices: Integers, is_eye: Flags, faces: Integers32, rest: Floats64) -> None:
        depth = rest[indices, 2]
        is_deep = ~is_eye
        if is_deep.any():
            is_deep &= depth < np.median(depth[is_deep])
        self.deep = indices[is_deep]
        self._free = indices[~is_deep]
        count = len(rest)
        edges = edges_of(faces)
        links = edge_graph(edges, np.ones(len(edges)), count)
        links = links + links.T
        degree = scipy.sparse.diags_array(np.asarray(links.sum(axis=1)).ravel())
        laplacian = (degree - links).tocsr()[self._free]
        self._others = np.setdiff1d(np.arange(count), self._free)
        self._solver = None
        if len(self._free):
            self._to_others = laplacian[:, self._others]
            self._solver = scipy.sparse.linalg.splu(laplacian[:, self._free].tocsc())

    def stretch(self, moved: Floats64, rest: Floats64) -> None:
        """Write positions of the other half into `moved` (V, 3), which has all other positions."""
        if self._solver is not None:
            displacements = (moved - rest)[self._others]
            moved[self._free] = rest[self._free] - self._solver.solve(
                self._to_others @ displacements
            )


def merged_vertices(mesh: Mesh, head: FittedHead) -> Integers:
    """Return, for each vertex of a file, the first vertex that coincides with it, (V,)."""
    same = mesh.used_vertices
    landmarks = head.file_vertices[head.landmarks]
    joined, _ = with_seams_joined(mesh.vertices, mesh.faces, landmarks)
    first = np.arange(len(same))
    first[mesh.faces] = joined
    return first[same]


def places_in_skin(head: FittedHead, same: Integers) -> Integers:
    """Return the index in the skin of each vertex of a file, or -1, (V,)."""
    places = places_among(head.file_vertices, len(same))
    return np.where(places >= 0, places, places[same])


def with_own_tongue(
    head: FittedHead, rest: Floats64, indices: Integers, faces: Integers32
) -> tuple[Part, ...]:
    """Replace the built-in tongue in a head's parts by the file's tongue, which bends like it.

    rest: all vertices of the file [mm], (V, 3). indices: vertices of the tongue, (n,). faces: all
    triangles of the file, (F, 3).
    """
    own_faces = _faces_among(indices, faces, len(rest))
    tongue = _part(TONGUE_NAME, rest[indices], own_faces, "mandible", None)
    return tuple(tongue if part.name == TONGUE_NAME else part for part in head.parts)


def _faces_among(indices: Integers, faces: Integers32, count: int) -> Integers32:
    """Return the triangles between n of `count` vertices, as rows of `indices` (n,), (m, 3)."""
    local_faces = places_among(indices, count)[faces]
    is_whole = (local_faces >= 0).all(axis=1)
    return local_faces[is_whole]


def _part(
    name: str, points: Floats64, faces: Integers32, bone: str, roots: Integers32 | None
) -> Part:
    """Make a part of points [mm] (n, 3) and faces (m, 3)."""
    colours = np.tile(np.array(TONGUE_COLOUR, np.float32), (len(points), 1))
    normals = vertex_normals(points, faces).astype(np.float32)
    return Part(
        name=name,
        vertices=points.astype(np.float32),
        normals=normals,
        faces=faces,
        colours=colours,
        bone=bone,
        shine=0.5,
        roots=roots,
    )
