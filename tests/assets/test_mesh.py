"""The skin as a surface: one clean, symmetric piece with the right holes."""

from itertools import pairwise

import numpy as np
import pytest
import trimesh
from numpy.linalg import norm

from risorius.assets.topology import boundary_loops
from risorius.geometry.intersections import self_intersections
from risorius.geometry.normals import cross_products, vertex_normals
from risorius.geometry.sides import sides_of
from tests.assets import checks
from tests.meshes import open_grid

TUCKED_ROWS = ("eye_0", "eye_1", "mouth_0", "mouth_1", "mouth_2", "nostril")


def test_triangle_count_is_that_of_the_paper(head):
    """The mesh has 2030 triangles (the paper's Table 1), and every vertex is used."""
    assert len(head.faces) == 2030
    assert np.array_equal(np.unique(head.faces), np.arange(len(head.vertices)))


def test_skin_is_one_manifold_piece(head):
    """The skin is one piece, consistently oriented, with the Euler characteristic of four holes."""
    assert checks.is_manifold(head.faces)
    assert checks.component_count(head.faces) == 1
    assert checks.euler_characteristic(head.vertices, head.faces) == 2 - 4


def test_boundary_loops_are_rim_mouth_and_eyes(head):
    """The four boundary loops are the rows with these names."""
    loops = [set(loop) for loop in boundary_loops(head.faces)]
    assert len(loops) == 4
    for name in ("rim", "mouth_0"):
        row = {*head.rings[f"{name}_left"].tolist(), *head.rings[f"{name}_right"].tolist()}
        assert row in loops
    for side in ("left", "right"):
        assert set(head.rings[f"eye_0_{side}"].tolist()) in loops


def test_mesh_is_its_own_mirror_image(head):
    """Vertices and faces equal their mirror images to the last bit.

    The mirror map is its own inverse.
    """
    assert checks.mirror_error(head.vertices, head.mirror) == 0.0
    assert checks.is_mirrored(head.faces, head.mirror)
    assert np.array_equal(head.mirror[head.mirror], np.arange(len(head.vertices)))


def test_mesh_does_not_cut_itself(head):
    """No two faces intersect, although lips are closed and lids are folded."""
    assert len(self_intersections(head.vertices, head.faces)) == 0


def test_triangles_are_well_shaped(head):
    """No triangle is a sliver; the simulation's step length and the shading depend on this."""
    corners = head.vertices[head.faces]
    angle = np.degrees(trimesh.triangles.angles(corners)).min(axis=1)
    assert angle.min() > 12.0
    assert (angle < 15.0).mean() <= 0.01
    assert np.percentile(angle, 5) > 18.5
    assert angle.mean() > 37.0


def test_lips_are_closed_but_not_welded(head):
    """Upper and lower lip have separate vertices at least 0.3 mm apart, but nearly touch."""
    row = head.rings["mouth_2_left"]
    columns = len(row) // 2
    upper = head.vertices[row[:columns]]
    lower = head.vertices[row[: -columns - 1 : -1]]
    gap = norm(upper - lower, axis=1)
    assert gap.max() < 0.6
    assert gap.min() > 0.3
    assert np.array_equal(upper[:, 0], lower[:, 0])


def test_edges_follow_the_nasolabial_fold(head):
    """A chain of mesh edges runs from the wing of the nose past the corner of the mouth.

    A smile creases the skin along it.
    """
    corner = head.vertices[head.anatomy["cheilion_left"]]
    directed = sides_of(head.faces)
    edges = {*map(tuple, directed.tolist()), *map(tuple, directed[:, ::-1].tolist())}
    for side in ("left", "right"):
        fold = head.rings[f"nasolabial_fold_{side}"]
        assert edges.issuperset(pairwise(fold.tolist()))
        assert fold[0] in head.rings[f"alar_crease_{side}"]
        points = np.abs(head.vertices[fold] * [1.0, 0.0, 0.0]) + head.vertices[fold] * [0, 1, 1]
        assert np.all(np.diff(points[:, 1]) < 0.0)
        beside = np.interp(-corner[1], -points[:, 1], points[:, 0]) - corner[0]
        assert 8.0 < beside < 12.0
        assert points[-1, 1] < corner[1] - 8.0


def test_outline_of_the_crown_is_smooth(head):
    """From all sides, the upper half of the skull has no long straight edge."""
    edges = sides_of(head.faces)
    ends = head.vertices[edges]
    on_crown = ends[:, :, 1].min(axis=1) > 45.0
    length = norm(ends[:, 0] - ends[:, 1], axis=1)
    assert on_crown.sum() > 200
    assert length[on_crown].max() < 34.5


def test_head_is_closed_behind(head):
    """The only border of the mesh is at the collar: it is low, and closed from back to front."""
    rim = head.vertices[head.rings["rim_left"]]
    assert rim[:, 1].max() < -130.0
    assert rim[0, 0] == rim[-1, 0] == 0.0
    assert rim[0, 2] < 0.0 < rim[-1, 2]


def test_no_face_is_inside_out(head):
    """Every face points about the same way as its vertices' normals.

    Tucked-in rows, ears and nostrils are left out.
    """
    tucked = {
        vertex
        for name in TUCKED_ROWS
        for side in ("left", "right")
        for vertex in head.rings[f"{name}_{side}"].tolist()
    }
    outside = ~np.isin(head.faces, sorted(tucked)).any(axis=1) & ~ear_faces(head)
    cross = cross_products(head.vertices, head.faces)
    around = vertex_normals(head.vertices, head.faces)[head.faces].sum(axis=1)
    cosine = (cross * around).sum(axis=1)
    cosine /= norm(cross, axis=1) * norm(around, axis=1)
    assert cosine[outside & ~_nostril_faces(head)].min() > 0.15


def ear_faces(head):
    """Faces of both ears, which have a corner above the roots, shape (F,)."""
    on_ears = []
    for side in ("left", "right"):
        root = head.rings[f"ear_0_{side}"]
        on_ears += [np.setdiff1d(head.rings[f"ear_{row}_{side}"], root) for row in range(1, 5)]
    return np.asarray(np.isin(head.faces, np.concatenate(on_ears)).any(axis=1))


def test_ears_have_their_size_and_place(head):
    """Ears are 59 by 32 mm, from below the brow to the base of the nose.

    They lean back, and stand off the head.
    """
    edge = head.vertices[head.rings["ear_1_left"]]
    high = edge[edge[:, 1].argmax()]
    low = edge[edge[:, 1].argmin()]
    along = np.linalg.svd(edge - edge.mean(axis=0))[2][0]  # the direction of its greatest length
    along *= np.sign(along[1])
    assert 58.0 < np.ptp(edge @ along) < 67.0
    across = np.cross(along, [1.0, 0.0, 0.0])
    assert 28.0 < np.ptp(edge @ (across / norm(across))) < 37.0
    at = {name: head.vertices[vertex, 1] for name, vertex in head.anatomy.items()}
    assert abs(high[1] - head.vertices[head.landmarks[24], 1]) < 19.0
    assert abs(low[1] - at["subnasale"]) < 8.0
    assert 10.0 < np.degrees(np.arctan2(-along[2], along[1])) < 26.0
    back = edge[edge[:, 2].argmin()]
    root = head.vertices[head.rings["ear_0_left"]]
    assert 8.0 < back[0] - root[:, 0].max() < 22.0
    assert 220 < ear_faces(head).sum() < 310
    assert head.mandible_weight[head.rings["ear_1_left"]].max() == 0.0


def test_ear_looks_outward_in_front_and_toward_the_head_behind(head):
    """Neither side of an ear is turned over; from the side helix, scapha and concha are visible."""
    rows = [set(head.rings[f"ear_{row}_left"].tolist()) for row in range(5)]
    root = rows[0]
    cross = cross_products(head.vertices, head.faces)
    front = []
    behind = []
    for number, face in enumerate(head.faces.tolist()):
        corners = set(face)
        if corners <= (rows[2] | rows[3]) - root:
            front.append(cross[number, 0])
        touches_root_alone = corners <= root
        if corners <= root | rows[1] and not touches_root_alone:
            behind.append(cross[number, 2])
    assert len(front) > 15
    assert np.mean(np.array(front) > 0.0) > 0.8
    assert len(behind) > 15
    assert np.mean(np.array(behind) < 0.0) > 0.6


def _nostril_faces(head):
    """Faces of the nostrils' caps, with all corners within 6 mm of a nostril's roof, shape (F,)."""
    near = np.zeros(len(head.vertices), dtype=bool)
    for side in ("left", "right"):
        roof = head.vertices[head.anatomy[f"nostril_roof_{side}"]]
        near |= norm(head.vertices - roof, axis=1) < 6.0
    return np.asarray(near[head.faces].all(axis=1))


def test_holes_that_meet_in_a_vertex_have_loops():
    """Boundary loops are found for holes that share a vertex.

    Examples: two triangles at a vertex; a grid of five by five vertices without two squares that
    share the middle vertex.
    """
    touching = np.array([[0, 1, 2], [0, 3, 4]], dtype=np.int32)
    assert boundary_loops(touching) == [[0, 1, 2], [0, 3, 4]]
    grid = open_grid(4, 4).faces.reshape(4, 4, 2, 3)  # row, column, triangle of the square, corner
    is_kept = np.ones((4, 4), bool)
    is_kept[[1, 2], [1, 2]] = False
    outer, inner = boundary_loops(grid[is_kept].reshape(-1, 3))
    assert len(outer) == 16
    assert inner == [6, 11, 12, 17, 18, 13, 12, 7]


def test_checks_find_faults():
    """The checks detect planted faults; a check that cannot fail is useless."""
    points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 1], [2, 1.5, 0.5]])
    crossing = np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)
    assert self_intersections(points, crossing).tolist() == [[0, 1]]
    assert checks.component_count(crossing) == 2
    repeated = np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)
    assert not checks.is_manifold(repeated)
    with pytest.raises(ValueError, match="two faces run from vertex 0 to 1"):
        boundary_loops(repeated)
    assert not checks.is_mirrored(crossing, np.array([1, 0, 2, 3, 4, 5], dtype=np.int32))
