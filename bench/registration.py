"""Lay the head's mesh on another surface: its rows at given places, the rest by normals.

Vertices on rows go to places that are given; all others that are free to the nearest point of the
surface, along its normal; both with as little bending of the displacement as can be. What lies
beyond the surface (crown, neck, the inside) follows smoothly. Both sides stay alike.
Source: Amberg, Romdhani, Vetter 2007, "Optimal step nonrigid ICP algorithms for surface
registration" (stiffness that falls from stage to stage).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from risorius.assets.fitting.warp import nearest_on
from risorius.assets.model import FloatArray, Head, IndexArray
from risorius.assets.topology import boundary_loops, smallest_angles
from risorius.geometry.normals import vertex_normals

Targets = Mapping[int, tuple[FloatArray, float]]
"""Where a vertex belongs [mm], and how strongly it is drawn there (1: as a row is)."""

MIRROR = np.array([-1.0, 1.0, 1.0])
STAGES = ((30.0, 4), (8.0, 4), (2.0, 4), (0.5, 4), (0.2, 4))  # stiffness, rounds
WEAK = 0.3  # targets that are no stronger only lead the first, stiff stages
ALIKE, FARTHEST = 0.3, 12.0  # cosine of normals, and distance [mm], of what can correspond
FADE = 4.0  # [mm] from the surface at which a vertex is drawn half as strongly
ASIDE = 0.12  # how strongly it is drawn to the nearest point itself, beside along the normal
LYING = 0.6  # [mm] from the surface that a vertex lies on
SLIDES = 60  # rounds in which vertices of narrow triangles may slide


@dataclass(frozen=True)
class Target:
    """A surface to lie on, in the head's frame: vertices (V, 3) [mm], triangles (F, 3)."""

    vertices: FloatArray
    triangles: IndexArray

    @cached_property
    def normals(self) -> FloatArray:
        """Of the vertices, shape (V, 3)."""
        return vertex_normals(self.vertices, self.triangles)

    @cached_property
    def is_border(self) -> npt.NDArray[np.bool_]:
        """Which vertices are on the edge of a hole, shape (V,)."""
        found = np.zeros(len(self.vertices), dtype=bool)
        for loop in boundary_loops(self.triangles):
            found[loop] = True
        return found


def neighbours(faces: IndexArray) -> dict[int, set[int]]:
    """The vertices that share an edge with each."""
    found: dict[int, set[int]] = defaultdict(set)
    for a, b, c in faces.tolist():
        found[a] |= {b, c}
        found[b] |= {a, c}
        found[c] |= {a, b}
    return found


def bending(vertices: FloatArray, faces: IndexArray) -> tuple[Any, FloatArray]:
    """How much displacements bend, a sparse quadratic form (V, V); mean length of edges [mm]."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges = np.unique(sides, axis=0)
    length = np.linalg.norm(np.diff(vertices[edges], axis=1)[:, 0], axis=1)
    count = len(vertices)
    weight = 1.0 / np.maximum(length, 0.4)
    joined = sparse.coo_matrix((weight, edges.T), shape=(count, count))
    joined = (joined + joined.T).tocsr()
    degree = np.asarray(joined.sum(axis=1)).ravel()
    mean = np.bincount(edges.ravel(), np.repeat(length, 2)) / np.bincount(edges.ravel())
    laplacian = sparse.diags(1.0 / mean / degree) @ (sparse.diags(degree) - joined)
    return (laplacian.T @ sparse.diags(mean**2) @ laplacian).tocsr(), mean


def _pulls(
    head: Head,
    x: FloatArray,
    start: FloatArray,
    surface: Target,
    free: IndexArray,
    size: FloatArray,
) -> tuple[IndexArray, FloatArray, FloatArray]:
    """Which vertices the surface draws, with what quadratic form (n, 3, 3), and its right side."""
    normals = vertex_normals(x, head.faces)
    at = nearest_on(x[free], normals[free], surface.vertices, surface.triangles)
    foot, facing = at.interpolate(surface.vertices), at.interpolate(surface.normals)
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    away = np.linalg.norm(foot - x[free], axis=1)
    fits = ~surface.is_border[at.corners].any(axis=1) & (away < FARTHEST)
    fits &= (facing * normals[free]).sum(axis=1) > ALIKE
    i, n, off = free[fits], facing[fits], foot[fits] - start[free[fits]]
    weight = size[i] ** 2 / (1.0 + (away[fits] / FADE) ** 2)
    forms = weight[:, None, None] * (n[:, :, None] * n[:, None, :] + ASIDE**2 * np.eye(3))
    return i, forms, np.einsum("nij,nj->ni", forms, off)


def laid_on(
    head: Head, start: FloatArray, surface: Target, targets: Targets, free: IndexArray
) -> FloatArray:
    """The head's vertices on a surface [mm], shape (V, 3); stage by stage less stiff.

    start: about where they belong; free: numbers of those that are drawn to the surface.
    """
    x, count = start, len(start)
    bend, size = bending(x, head.faces)
    fixed = np.array(list(targets))
    wanted = np.array([point for point, _ in targets.values()])
    weights = np.array([weight for _, weight in targets.values()])
    for stiffness, rounds in STAGES:
        start = x.copy()
        kept = np.where((stiffness < 1.0) & (weights < WEAK), 0.0, weights)
        pull = np.zeros(count)
        pull[fixed] = (3.0 * kept * size[fixed]) ** 2
        goal = np.zeros((count, 3))
        goal[fixed] = pull[fixed, None] * (wanted - start[fixed])
        for _ in range(rounds):
            i, each, pulled = _pulls(head, x, start, surface, free, size)
            blocks = np.zeros((count, 3, 3))
            blocks[i] = each
            blocks += pull[:, None, None] * np.eye(3)
            right = goal.copy()
            right[i] += pulled
            data = sparse.bsr_matrix((blocks, np.arange(count), np.arange(count + 1)))
            system = data + stiffness * sparse.kron(bend, sparse.eye(3))
            system = (system + 1e-7 * sparse.eye(3 * count)).tocsc()
            x = start + splu(system).solve(right.ravel()).reshape(-1, 3)
            x = 0.5 * (x + x[head.mirror] * MIRROR)
    return x


def on_surface(head: Head, x: FloatArray, surface: Target, free: IndexArray) -> IndexArray:
    """Those of the free vertices that lie on the surface."""
    normals = vertex_normals(x, head.faces)[free]
    at = nearest_on(x[free], normals, surface.vertices, surface.triangles)
    away = np.linalg.norm(at.interpolate(surface.vertices) - x[free], axis=1)
    is_lying = (away < LYING) & ~surface.is_border[at.corners].any(axis=1)
    return np.asarray(free[is_lying], dtype=np.int32)


def _slid(
    x: FloatArray,
    v: int,
    faces: IndexArray,
    normal: FloatArray,
    random: np.random.Generator,
    is_middle: bool,
) -> FloatArray:
    """The best of some places beside a vertex for the smallest angle of its faces."""
    tried = x.copy()
    best = smallest_angles(x, faces).min()
    place: FloatArray = x[v].copy()
    step = 0.15 * np.linalg.norm(x[faces].mean(axis=1) - x[v], axis=1).mean()
    for _ in range(8):
        way = random.normal(size=3)
        way -= normal * (way @ normal)
        tried[v] = place + step * random.random() * way / np.linalg.norm(way)
        tried[v, 0] *= not is_middle
        angle = smallest_angles(tried, faces).min()
        if angle > best:
            best, place = angle, tried[v].copy()
    return place


def relaxed(
    head: Head, vertices: FloatArray, surface: Target, lying: IndexArray, goal: float
) -> FloatArray:
    """Vertices slid along the skin until no angle is smaller than `goal` [deg], or none helps.

    lying: numbers of those that are kept on the surface. Edges of lids, lips and neck, and the
    landmarks of the nose, stay.
    """
    x, random = vertices.copy(), np.random.default_rng(0)
    held = np.zeros(len(x), dtype=bool)
    for name in ("rim", "eye_1", "mouth_2"):
        held[np.r_[head.rings[f"{name}_left"], head.rings[f"{name}_right"]]] = True
    held[head.landmarks[27:36]] = True
    around = [np.flatnonzero((head.faces == v).any(axis=1)) for v in range(len(x))]
    is_lying = np.isin(np.arange(len(x)), lying)
    for _ in range(SLIDES):
        bad = np.unique(head.faces[smallest_angles(x, head.faces) < goal])
        bad = bad[~held[bad] & (x[bad, 0] >= 0.0)]
        if not len(bad):
            break
        normals = vertex_normals(x, head.faces)
        for v in bad.tolist():
            x[v] = _slid(x, v, head.faces[around[v]], normals[v], random, head.mirror[v] == v)
            x[head.mirror[v]] = x[v] * MIRROR
        on = bad[is_lying[bad]]
        if len(on):
            at = nearest_on(x[on], normals[on], surface.vertices, surface.triangles)
            x[on] = at.interpolate(surface.vertices)
            x[on[head.mirror[on] == on], 0] = 0.0
            x[head.mirror[on]] = x[on] * MIRROR
    return x


def spread(head: Head, x: FloatArray, fields: FloatArray, known: IndexArray) -> FloatArray:
    """Fields (k, V, 3) as they are at the known vertices, and as smooth as can be at the others."""
    is_known = np.isin(np.arange(len(x)), known)
    bend = bending(x, head.faces)[0]
    told = fields[:, is_known].transpose(1, 0, 2).reshape(is_known.sum(), -1)
    rest = splu(bend[~is_known][:, ~is_known].tocsc()).solve(-bend[~is_known][:, is_known] @ told)
    whole = fields.copy()
    whole[:, ~is_known] = rest.reshape(-1, len(fields), 3).transpose(1, 0, 2)
    return np.asarray(0.5 * (whole + whole[:, head.mirror] * MIRROR))
