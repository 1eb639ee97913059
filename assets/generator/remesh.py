"""Improve the infill in space: flip edges, move vertices over the surface, split and collapse.

The layout that the infill came from squeezes steep places; a few rounds of these four well-known
steps (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution modeling") forget it.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from risorius.geometry.normals import cross_products

from ..topology import Edge, Faces, edge_faces, edge_key
from .fields import Points, Values, normals, project
from .form import distance
from .infill import wanted_length

LONGEST, SHORTEST = 1.38, 0.68  # of the wanted length: split above, collapse below
FLIP_NORMAL_COSINE = 0.3  # both new faces must roughly agree
COLLAPSE_NORMAL_COSINE = 0.5  # no face may turn more than 60 degrees


class Freedom(IntEnum):
    """How a vertex may move."""

    FIXED = 0
    MIDLINE = 1  # within x = 0
    FREE = 2


@dataclass
class InfillMesh:
    """The infill under work; `locked` edges are neither flipped nor split nor collapsed."""

    vertices: Points
    faces: Faces
    freedom: npt.NDArray[np.int8]
    locked: set[Edge]

    def relative_lengths(self, scale: float) -> dict[Edge, float]:
        """Length of each edge over its wanted length."""
        wanted = wanted_length(self.vertices) * scale
        edges = np.array(list(edge_faces(self.faces)))
        length = np.linalg.norm(self.vertices[edges[:, 0]] - self.vertices[edges[:, 1]], axis=1)
        relative = length / (0.5 * (wanted[edges[:, 0]] + wanted[edges[:, 1]]))
        return dict(zip(map(tuple, edges.tolist()), relative.tolist(), strict=True))


def _opposite(face: list[int], edge: Edge) -> int:
    return next(vertex for vertex in face if vertex not in edge)


def _corner_angles(vertices: Points, faces: Faces) -> Values:
    """The inner angle at every corner of every face [rad], shape (F, 3)."""
    size = np.linalg.norm(cross_products(vertices, faces), axis=1)
    angles = np.empty(faces.shape)
    for i in range(3):
        apex, first, second = (vertices[faces[:, (i + k) % 3]] for k in range(3))
        angles[:, i] = np.arctan2(size, ((first - apex) * (second - apex)).sum(axis=1))
    return angles


def flip_edges(mesh: InfillMesh, *, rounds: int = 6) -> None:
    """Flip every edge whose opposite angles add up to more than 180 degrees."""
    triangles = mesh.faces.tolist()
    for _ in range(rounds):
        faces = np.array(triangles, dtype=np.int32)
        beside, angles = edge_faces(faces), _corner_angles(mesh.vertices, faces)
        existing, flips = set(beside), 0
        changed: set[int] = set()
        for edge, pair in beside.items():
            if len(pair) != 2 or edge in mesh.locked or changed & set(pair):
                continue
            opposite = [angles[t, triangles[t].index(_opposite(triangles[t], edge))] for t in pair]
            if sum(opposite) <= np.pi + 1e-3:
                continue
            new = _flipped(mesh.vertices, triangles[pair[0]], triangles[pair[1]], edge, existing)
            if new is not None:
                triangles[pair[0]], triangles[pair[1]] = new
                changed |= set(pair)
                existing.discard(edge)
                existing.add(edge_key(new[0][0], new[0][1]))
                flips += 1
        if flips == 0:
            break
    mesh.faces = np.array(triangles, dtype=np.int32)


def _flipped(
    vertices: Points, left: list[int], right: list[int], edge: Edge, existing: set[Edge]
) -> tuple[list[int], list[int]] | None:
    """The two faces after a flip, or None if it would fold the surface."""
    a, b = edge
    c, d = _opposite(left, edge), _opposite(right, edge)
    if edge_key(c, d) in existing:
        return None
    if left[(left.index(a) + 1) % 3] == b:
        new = ([d, c, a], [c, d, b])
    else:
        new = ([c, d, a], [d, c, b])
    old_normal = cross_products(vertices, np.array([left, right])).sum(axis=0)
    first, second = cross_products(vertices, np.array(new))
    if first @ old_normal <= 0 or second @ old_normal <= 0:
        return None
    if first @ second <= FLIP_NORMAL_COSINE * np.linalg.norm(first) * np.linalg.norm(second):
        return None
    return new


def move_vertices(mesh: InfillMesh, *, rounds: int = 2, rate: float = 0.5) -> None:
    """Pull vertices toward the weighted centre of their faces, along the surface."""
    for _ in range(rounds):
        faces, vertices = mesh.faces, mesh.vertices
        wanted = wanted_length(vertices)
        weight = np.linalg.norm(cross_products(vertices, faces), axis=1)
        weight = weight / wanted[faces].mean(axis=1) ** 2
        centre = vertices[faces].mean(axis=1)
        total, target = np.zeros(len(vertices)), np.zeros_like(vertices)
        for corner in range(3):
            np.add.at(total, faces[:, corner], weight)
            np.add.at(target, faces[:, corner], centre * weight[:, None])
        step = (target / np.maximum(total, 1e-12)[:, None] - vertices) * rate
        step[mesh.freedom == Freedom.MIDLINE, 0] = 0.0
        moving = np.flatnonzero((mesh.freedom != Freedom.FIXED) & (total > 0))
        normal = normals(distance, vertices[moving])
        tangential = step[moving] - (step[moving] * normal).sum(axis=1, keepdims=True) * normal
        moved = vertices.copy()
        moved[moving] = project(distance, vertices[moving] + tangential, rounds=2)
        moved[mesh.freedom == Freedom.MIDLINE, 0] = 0.0
        mesh.vertices = moved


def split_edges(
    mesh: InfillMesh,
    *,
    scale: float,
    longest: float = LONGEST,
    limit: int = 10**6,
    face_counts: tuple[int, ...] = (1, 2),
) -> int:
    """Split edges longer than `longest` times the wanted length, longest first.

    face_counts: split only edges with so many faces beside them (1: in the mid-plane).
    """
    beside = edge_faces(mesh.faces)
    lengths = mesh.relative_lengths(scale)
    vertices, freedom = list(mesh.vertices), mesh.freedom.tolist()
    used: set[int] = set()
    new_faces: list[list[int]] = []
    new_vertices: list[int] = []
    for edge in sorted(lengths, key=lambda key: (-lengths[key], key)):
        if lengths[edge] < longest or len(new_vertices) >= limit:
            break
        pair = beside[edge]
        on_midline = len(pair) == 1 and not mesh.vertices[list(edge), 0].any()
        is_fixed = all(freedom[vertex] == Freedom.FIXED for vertex in edge)
        is_border = len(pair) == 1 and not on_midline
        is_excluded = edge in mesh.locked or len(pair) not in face_counts
        if is_excluded or is_border or used & set(pair) or (is_fixed and on_midline):
            continue
        middle = len(vertices)
        vertices.append(0.5 * (mesh.vertices[edge[0]] + mesh.vertices[edge[1]]))
        freedom.append(int(Freedom.MIDLINE if on_midline else Freedom.FREE))
        new_vertices.append(middle)
        used |= set(pair)
        for index in pair:
            new_faces += _halves(mesh.faces[index].tolist(), edge, middle)
    unsplit = [face for i, face in enumerate(mesh.faces.tolist()) if i not in used]
    mesh.vertices = np.array(vertices)
    mesh.freedom = np.array(freedom, dtype=np.int8)
    if new_vertices:
        mesh.vertices[new_vertices] = project(distance, mesh.vertices[new_vertices])
        mesh.vertices[mesh.freedom == Freedom.MIDLINE, 0] = 0.0
    mesh.faces = np.array(unsplit + new_faces, dtype=np.int32)
    return len(new_vertices)


def _halves(face: list[int], edge: Edge, middle: int) -> list[list[int]]:
    start = next(k for k in range(3) if {face[k], face[(k + 1) % 3]} == set(edge))
    a, b, c = face[start], face[(start + 1) % 3], face[(start + 2) % 3]
    return [[a, middle, c], [middle, b, c]]


def collapse_edges(
    mesh: InfillMesh, *, scale: float, shortest: float = SHORTEST, limit: int = 10**6
) -> int:
    """Collapse edges shorter than `shortest` times the wanted length, shortest first."""
    lengths = mesh.relative_lengths(scale)
    neighbours: dict[int, set[int]] = {}
    for a, b in lengths:
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    chained = {vertex for edge in mesh.locked for vertex in edge}
    blocked: set[int] = set()
    replaced: dict[int, int] = {}
    for edge in sorted(lengths, key=lambda key: (lengths[key], key)):
        if lengths[edge] > shortest or len(replaced) >= limit:
            break
        removed, remaining = sorted(edge, key=lambda vertex: mesh.freedom[vertex], reverse=True)
        if (
            mesh.freedom[removed] != Freedom.FREE
            or removed in chained
            or blocked & {removed, remaining}
        ):
            continue
        if len(neighbours[removed] & neighbours[remaining]) != 2 or not _may_merge(
            mesh, removed, remaining
        ):
            continue
        replaced[removed] = remaining
        blocked |= neighbours[removed] | neighbours[remaining] | {removed, remaining}
    merged = [[replaced.get(v, v) for v in face] for face in mesh.faces.tolist()]
    mesh.faces = np.array([face for face in merged if len(set(face)) == 3], dtype=np.int32)
    return len(replaced)


def _may_merge(mesh: InfillMesh, removed: int, remaining: int) -> bool:
    """Whether no face around `removed` turns over when it moves onto `remaining`."""
    around = mesh.faces[(mesh.faces == removed).any(axis=1)]
    around = around[~(around == remaining).any(axis=1)]
    before = cross_products(mesh.vertices, around)
    after = cross_products(mesh.vertices, np.where(around == removed, remaining, around))
    lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return bool(((before * after).sum(axis=1) > COLLAPSE_NORMAL_COSINE * lengths).all())


def remesh(mesh: InfillMesh, *, scale: float, target_faces: int) -> None:
    """Run the rounds and end with exactly `target_faces` faces."""
    for turn in range(10):
        flip_edges(mesh)
        move_vertices(mesh)
        if turn < 7:
            split_edges(mesh, scale=scale)
            collapse_edges(mesh, scale=scale)
    _reach_count(mesh, scale=scale, target=target_faces)
    for _ in range(5):
        flip_edges(mesh)
        move_vertices(mesh)
    flip_edges(mesh)


def _reach_count(mesh: InfillMesh, *, scale: float, target: int) -> None:
    """An inner split adds two faces, a split in the mid-plane one, a collapse takes two."""
    for _ in range(80):
        missing = target - len(mesh.faces)
        if missing == 0:
            return
        if missing % 2:
            split_edges(mesh, scale=scale, longest=0.0, limit=1, face_counts=(1,))
        elif missing > 0:
            amount = max(1, min(6, missing // 4))
            split_edges(mesh, scale=scale, longest=0.0, limit=amount, face_counts=(2,))
        else:
            amount = max(1, min(6, -missing // 4))
            collapse_edges(mesh, scale=scale, shortest=9.0, limit=amount)
        flip_edges(mesh)
        move_vertices(mesh)
    raise RuntimeError(f"the infill has {len(mesh.faces)} faces, {target} cannot be reached")
