"""Measure the refined coarse head against the built-in head, and search for better edge flips.

The built-in head holds some poses. The coarse layout (assets/coarse.toml) uses the built-in head's
own vertices, so only the choice of triangles makes a difference. Every edge is split twice, and the
normals of the new triangles are compared with the normals of the built-in head nearby: shading
depends on normals.

A flip replaces the edge between two triangles by the other diagonal of their quadrilateral.
`search` tries edges in a random order, and keeps each flip that lowers the angle over the whole
face. Edge flips are from Lawson 1977, "Software for C1 surface interpolation"; the measure is ours.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy
import trimesh

from risorius import assets, refine, sim
from risorius.assets.coarse import LAYOUT_FILE, CoarseHead, coarse_head
from risorius.assets.data_files import read_toml
from risorius.geometry.arrays import Flags, Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products, vertex_normals
from risorius.geometry.sides import edges_of

from .report import table
from .subjects import settled_positions

MEASURED_POSES: tuple[Mapping[str, float], ...] = (
    {},
    {"joy": 1.0},
    {"blink": 0.5},
    {"AU1": 1.0, "AU2": 1.0},
    {"AU4": 1.0},
    {"AU5": 1.0},
    {"jaw_open": 0.6},
    {"kiss": 0.7},
    {"disgust": 0.7},
)
COMPARED_SCHEMES = ("static", "loop", "cubic")
FREE_GROUPS = ("above the mouth", "eyelids", "forehead", "cheeks")
"""Groups whose edges may be flipped: loops of lips and nostrils stay, and a chin without lumps."""
LEAST_ANGLE = 14.0  # degrees
MOST_NEIGHBOURS = 10
"""Edges at a vertex."""
LEAST_GAIN = 0.005  # degrees


class CoarseLayout(NamedTuple):
    """The left half of the coarse head: triangles, shape (F, 3), and the group of each triangle."""

    triangles: Integers32
    groups: npt.NDArray[np.str_]


class MeasuredSurface(NamedTuple):
    """The built-in head in a pose: all vertices [mm], and points with normals to compare with."""

    vertices: Floats64
    tree: scipy.spatial.cKDTree
    normals: Floats64


def layout() -> CoarseLayout:
    """The layout of assets/coarse.toml, with indices of the coarse head's vertices."""
    head = coarse_head()
    table_of_groups = read_toml(LAYOUT_FILE)["triangles"]
    triangles = np.searchsorted(head.file_vertices, np.vstack([*table_of_groups.values()]))
    groups = np.repeat(list(table_of_groups), [len(each) for each in table_of_groups.values()])
    return CoarseLayout(triangles.astype(np.int32), groups)


def surfaces() -> list[MeasuredSurface]:
    """The built-in head in all poses, refined once by the cubic scheme."""
    head = assets.load("head")
    simulation = sim.create(head)
    edge_count = len(refine.create("kahler", head.faces, head.vertices).edges)
    splits = np.ones(edge_count, np.uint8)
    refiner = refine.create("kahler", head.faces, head.vertices, scheme="cubic", splits=splits)
    found = []
    for pose in MEASURED_POSES:
        vertices = settled_positions(simulation, pose, 40)
        mesh = refiner.refine(vertices)
        tree = scipy.spatial.cKDTree(mesh.positions.copy())
        found.append(MeasuredSurface(vertices, tree, mesh.normals.astype(float)))
    return found


class Comparison:
    """Angles between a refined layout and the built-in head in all poses."""

    def __init__(self) -> None:
        self._head = coarse_head()
        self._surfaces = surfaces()

    def angles(self, tried: CoarseLayout, scheme: str = "cubic") -> Mapping[str, float]:
        """The RMS angle [degrees] of each group, weighted by area; "face" is for all
        FREE_GROUPS.
        """
        head = self._head
        faces = np.vstack([tried.triangles, head.mirror[tried.triangles][:, ::-1]])
        edge_count = len(refine.create("kahler", faces, head.vertices).edges)
        splits = np.full(edge_count, 0 if scheme == "static" else 2, np.uint8)
        chosen = "loop" if scheme == "static" else scheme
        refiner = refine.create("kahler", faces, head.vertices, scheme=chosen, splits=splits)
        sums = {group: np.zeros(2) for group in dict.fromkeys(tried.groups)}
        for surface in self._surfaces:
            mesh = refiner.refine(surface.vertices[head.file_vertices])
            is_left = mesh.source < len(tried.triangles)
            angles, areas = _angles_and_areas(mesh, is_left, surface)
            groups = tried.groups[mesh.source[is_left]]
            for group, total in sums.items():
                is_here = groups == group
                total += (angles[is_here] ** 2 @ areas[is_here], areas[is_here].sum())
        sums["face"] = sum((sums[group] for group in FREE_GROUPS), np.zeros(2))
        return {group: float(np.sqrt(total[0] / total[1])) for group, total in sums.items()}


def _angles_and_areas(
    mesh: refine.RefinedMesh, is_chosen: Flags, surface: MeasuredSurface
) -> tuple[Floats64, Floats64]:
    """Angle [degrees] between each triangle's normal and the nearest point's normal, and areas."""
    triangles = mesh.triangles[is_chosen].astype(np.int64)
    centroids = mesh.positions[triangles].mean(axis=1)
    normals = unit_vectors(mesh.normals[triangles].mean(axis=1).astype(float))
    distances, nearest = surface.tree.query(centroids, k=6)
    cosines = np.einsum("nkc,nc->nk", surface.normals[nearest], normals)
    least_cosine = 0.2  # leaves out points on the inner side of a lip or a lid
    distances = np.where(cosines > least_cosine, distances, np.inf)
    chosen = np.take_along_axis(cosines, distances.argmin(axis=1)[:, None], axis=1)[:, 0]
    areas = 0.5 * np.linalg.norm(cross_products(mesh.positions.astype(float), triangles), axis=1)
    return np.degrees(np.arccos(np.clip(chosen, -1.0, 1.0))), areas


def search(
    comparison: Comparison, start: CoarseLayout, on_flip: Callable[[str], None]
) -> CoarseLayout:
    """Flip edges of FREE_GROUPS that lower the angle by LEAST_GAIN; `on_flip` gets a line."""
    known = coarse_head()
    fine = assets.load("head")
    outward = vertex_normals(fine.vertices, fine.faces)[known.file_vertices]
    best = comparison.angles(start)["face"]
    present = start
    most_rounds = 3
    for turn in range(most_rounds):
        before = best
        for first, second in np.random.default_rng(turn).permutation(edges_of(present.triangles)):
            tried = with_flipped_edge(present, int(first), int(second))
            if tried is None or not _is_sound(tried, present, known, outward):
                continue
            angle = comparison.angles(tried)["face"]
            if angle < best - LEAST_GAIN:
                ends = known.file_vertices[[first, second]]
                on_flip(f"edge {ends[0]}-{ends[1]}: {best:.3f} -> {angle:.3f} degrees")
                best = angle
                present = tried
        if best == before:
            break
    return present


def with_flipped_edge(start: CoarseLayout, first: int, second: int) -> CoarseLayout | None:
    """The layout with the edge between two vertices flipped; None if it must not be flipped."""
    triangles = start.triangles
    beside = np.flatnonzero(_triangles_with(triangles, first, second))
    if len(beside) != 2 or not np.isin(start.groups[beside], FREE_GROUPS).all():
        return None
    rows = [list(triangles[number]) for number in beside]
    if rows[0][(rows[0].index(first) + 1) % 3] != second:
        rows.reverse()
        beside = beside[::-1]
    ahead, behind = ((set(row) - {first, second}).pop() for row in rows)
    if _triangles_with(triangles, ahead, behind).any():
        return None
    changed = triangles.copy()
    changed[beside] = [[ahead, first, behind], [ahead, behind, second]]
    return start._replace(triangles=changed)


def _triangles_with(triangles: Integers32, first: int, second: int) -> Flags:
    """Flags of the triangles (F, 3) that have both vertices."""
    has_first = (triangles == first).any(axis=1)
    has_second = (triangles == second).any(axis=1)
    return np.asarray(has_first & has_second)


def _is_sound(
    tried: CoarseLayout, start: CoarseLayout, head: CoarseHead, outward: Floats64
) -> bool:
    """Whether flipped triangles are wide and face outward, and no vertex has too many
    neighbours.
    """
    is_new = (tried.triangles != start.triangles).any(axis=1)
    triangles = tried.triangles[is_new]
    smallest = np.degrees(trimesh.triangles.angles(head.vertices[triangles])).min()
    facing = cross_products(head.vertices, triangles)
    is_outward = (facing * outward[triangles].sum(axis=1)).sum(axis=1) > 0.0
    faces = np.vstack([tried.triangles, head.mirror[tried.triangles]])
    neighbours = np.bincount(trimesh.geometry.faces_to_edges(faces).ravel()) // 2
    return bool(smallest > LEAST_ANGLE and is_outward.all() and neighbours.max() <= MOST_NEIGHBOURS)


def report(comparison: Comparison) -> str:
    """The table to print."""
    present = layout()
    by_scheme = [comparison.angles(present, scheme) for scheme in COMPARED_SCHEMES]
    rows = [(group, *(angles[group] for angles in by_scheme)) for group in by_scheme[0]]
    lines = [
        "Angle between normals of the coarse and of the built-in head [degrees], RMS over area",
        f"and {len(MEASURED_POSES)} poses; loop, cubic: every edge is split twice.",
        "",
        *table("group:<18|" + "|".join(f"{scheme}:8.2f" for scheme in COMPARED_SCHEMES), rows),
    ]
    return "\n".join(lines)
