"""Lay crown, nape, neck and ears of the head on the whole head of ICT-FaceKit.

`python .ci/whole_head.py FACEKIT NEUTRAL.obj` rewrites head.npz and the meshes made from it, on the
data of revision 95b00213. FACEKIT is a folder of `bench reference`, NEUTRAL.obj is the package's
generic_neutral_mesh, whose first vertices are those of the folder. No vertex of the face moves.

The person whose face ours is ends at the hairline, where the modes do: their smoothest continuation
carries the rest of the neutral head. Our finest mesh is then laid on it, nearest points in turns,
with as little bending of the displacement as can be (after Amberg, Romdhani, Vetter 2007). Rows of
the ear go to those of the reference as seen from the side: the free edge is found, fourteen places
within it are given.
"""

import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from risorius.assets.fitting.warp import nearest_on
from risorius.assets.loading import HEAD_FILE, load
from risorius.bench import human
from risorius.geometry.normals import vertex_normals

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int32]

KEPT = 11248  # vertices of the package's mesh that are skin: face, head and neck
EAR = np.array([-19.8, -7.1])  # y and z [mm] of the middle of the reference's ear
OURS = np.array([-13.5, -10.5])  # of ours
LONGER = 0.06  # ears: published ones are 62 +- 4 mm long, the reference's 56
SOFT = 14.0  # [mm] over which the face lets go
CELL, LOW = 0.2, np.array([-75.0, -60.0])  # [mm] of the picture from the side, and where it begins
FRONT = {0: (0.2, 1.3), 15: (-11.5, 4.3), 14: (-25.0, 8.2), 13: (-39.5, 10.0)}  # of row ear_0: y, z
LOBE = (-49.8, 5.5), (-46.5, 5.6)  # of rows ear_1 and ear_2, the last before the root
RIDGE = [  # of row ear_4: antihelix, antitragus, tragus
    *((-13.5, -1.0), (-10.0, -5.0), (-8.0, -8.0), (-10.0, -10.5), (-13.8, -12.0), (-18.0, -13.0)),
    *((-22.4, -13.0), (-27.0, -12.0), (-31.0, -9.5), (-33.5, -6.0), (-35.0, -2.5), (-35.5, 1.0)),
    *((-33.5, 4.5), (-29.5, 5.5), (-24.0, 4.8), (-18.0, 2.5)),
]
FLOOR = (-17.3, -7.2), (-27.0, -1.8)  # of the concha
ROUNDS = [  # stiffness, weight of the rows of the ear, of its surface from the side
    *((300, 1.0, 0.0), (100, 1.0, 0.0), (30, 1.0, 0.0), (10, 0.5, 0.0), (5, 0.3, 0.3)),
    *((3, 0.2, 0.5), (2, 0.1, 0.7), (1, 0.05, 1.0), (1, 0.03, 1.0), (1, 0.02, 1.0)),
]
LEAST = 0.15  # cosine between a finer triangle and its parent


def smooth(x: Any) -> Any:
    """From 0 to 1 between 0 and 1, level at both ends."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def crosses(points: Points, faces: Faces) -> Points:
    """Normals of faces, as long as twice their area."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a))


def whole_person(folder: Path, obj: Path) -> tuple[Points, Faces]:
    """The reference's head as the person whom our face is closest to, in our frame."""
    head, space = load("head"), human.IdentitySpace.read(folder)
    fine = head.finer(2)
    own = human.Surface(fine.vertices, fine.faces, fine.normals, head.vertices[head.landmarks])
    weights = human.unexplained(space, space.regions(), own).weights
    lines = [line.split() for line in obj.read_text().splitlines()]
    points = 10.0 * np.array([x[1:4] for x in lines if x and x[0] == "v"], np.float64)[:KEPT]
    corners = [[int(y.split("/")[0]) - 1 for y in x[1:]] for x in lines if x and x[0] == "f"]
    faces = [(q[0], q[k], q[k + 1]) for q in corners if max(q) < KEPT for k in range(1, len(q) - 1)]
    person, count = space.person(weights), len(space.mean)
    known = np.random.default_rng(0).choice(count, 1800, replace=False)
    onward = scipy.interpolate.RBFInterpolator(
        space.mean[known], (person - space.mean)[known], kernel="linear", smoothing=1.0
    )
    whole = np.vstack([person, points[count:] + onward(points[count:])])
    seen, to = space.landmarks[human.LANDMARKS], own.landmarks[human.LANDMARKS]
    for _ in range(20):  # rigidly onto our face: by landmarks, then nearest points in turns
        middle, mean = to.mean(axis=0), whole[seen].mean(axis=0)
        turn = scipy.spatial.transform.Rotation.align_vectors(to - middle, whole[seen] - mean)[0]
        whole = turn.apply(whole - mean) + middle
        seen = np.flatnonzero(space.regions() != "")
        facing = vertex_normals(whole[:count], space.triangles)[seen]
        to = nearest_on(whole[seen], facing, fine.vertices, fine.faces).interpolate(fine.vertices)
    far = np.hypot(whole[:, 1] + 22.0, whole[:, 2] + 7.0)
    share = LONGER * smooth((70.0 - far) / 35.0) * (np.abs(whole[:, 0]) > 55.0)
    whole[:, 1] += share * (whole[:, 1] + 42.0)
    whole[:, 2] += share * (whole[:, 2] + 5.0)
    return whole, np.array(faces, np.int32)


class FromTheSide:
    """How far out the reference's left side reaches, looked at along x."""

    def __init__(self, points: Points, faces: Faces) -> None:
        """Draw it, a triangle after the other."""
        self.depth = np.full((550, 550), np.nan)
        self.face = np.zeros((550, 550), np.int64)
        self.normals = crosses(points, faces)
        self.normals /= np.linalg.norm(self.normals, axis=1, keepdims=True) + 1e-12
        cells = (points[:, 1:] - LOW) / CELL
        for number, face in enumerate(faces):
            corner, out = cells[face], points[face, 0]
            low = np.maximum(np.ceil(corner.min(axis=0)), 0).astype(int)
            high = np.minimum(corner.max(axis=0), 549).astype(int) + 1
            edges = corner[1:] - corner[0]
            if out.min() < 40.0 or (low >= high).any() or abs(np.linalg.det(edges)) < 1e-9:
                continue
            grid = np.stack(np.meshgrid(*map(np.arange, low, high), indexing="ij"), axis=-1)
            share = (grid - corner[0]) @ np.linalg.inv(edges)
            depth = out[0] + share @ (out[1:] - out[0])
            place = np.s_[low[0] : high[0], low[1] : high[1]]
            within = (share > -1e-9).all(axis=-1) & (share.sum(axis=-1) < 1.0 + 1e-9)
            within &= ~(depth <= self.depth[place])
            self.depth[place][within], self.face[place][within] = depth[within], number

    def __call__(self, places: Points) -> tuple[Points, Points]:
        """x at places (y, z), and the normals there."""
        row, column = np.clip(np.rint((places - LOW) / CELL).astype(int), 0, 549).T
        return self.depth[row, column], self.normals[self.face[row, column]]

    def free_edge(self, angle: float) -> tuple[Points, float] | None:
        """Where the ear ends in a direction from its middle, 0: forward; and how far that is."""
        radii = np.linspace(8.0, 40.0, 257)
        places = EAR + np.outer(radii, [np.sin(angle), np.cos(angle)])
        out = self(places)[0]
        drops = np.flatnonzero(np.diff(out) < -1.2)
        last = drops[-1] if len(drops) else 0
        return (np.array([out[last], *places[last]]), float(radii[last])) if len(drops) else None


def ear_rows(side: FromTheSide) -> dict[int, Points]:
    """Where vertices of the left ear's rows go."""
    head, found = load("head"), dict[int, Points]()
    rows = [head.rings[f"ear_{k}_left"] for k in range(5)]
    for back, front in zip(rows[1][1:13], rows[2][1:13], strict=True):
        up, forward = head.vertices[back, 1:] - OURS
        met = side.free_edge(np.arctan2(up / 32.5 * 28.0, forward / 18.0 * 15.0))
        if met is not None:
            edge, radius = met
            within = EAR + (edge[1:] - EAR) * (1.0 - 2.2 / radius)
            found[back] = edge - [2.0, 0.0, 0.0]
            found[front] = np.array([max(side(within[None])[0][0], edge[0] - 1.0), *within])
    given = {rows[0][k]: place for k, place in FRONT.items()}
    given |= {rows[1][12]: LOBE[0], rows[2][12]: LOBE[1]}
    given |= dict(zip([*rows[4], *head.rings["concha_left"]], [*RIDGE, *FLOOR], strict=True))
    for vertex, (y, z) in given.items():
        place = np.array([y + LONGER * (y + 42.0), z + LONGER * (z + 5.0)])
        out = side(place[None])[0][0]
        found[vertex] = np.array([min(out, 71.5) if vertex == rows[0][0] else out, *place])
    return found


def bending(points: Points, faces: Faces) -> tuple[Any, Points]:
    """The matrix of a field's bending over the mesh, and the area of each vertex."""
    count, area = len(points), np.zeros(len(points))
    rows, columns, weights = [], [], []
    size = 0.5 * np.linalg.norm(crosses(points, faces), axis=1)
    for k in range(3):
        a, b, c = (faces[:, (k + j) % 3] for j in range(3))
        u, v = points[a] - points[c], points[b] - points[c]
        twice = np.maximum(np.linalg.norm(np.cross(u, v), axis=1), 1e-6)
        cotangent = 0.5 * np.clip((u * v).sum(axis=1) / twice, 0.05, 5.0)
        rows, columns, weights = [*rows, a, b], [*columns, b, a], [*weights, cotangent, cotangent]
        np.add.at(area, a, size / 3.0)
    flat = [np.concatenate(each) for each in (weights, rows, columns)]
    near = scipy.sparse.coo_matrix((flat[0], (flat[1], flat[2])), (count, count)).tocsr()
    laplacian = scipy.sparse.diags(np.asarray(near.sum(axis=1)).ravel()) - near
    return laplacian @ scipy.sparse.diags(1.0 / area) @ laplacian, area


def displacement(target: Points, target_faces: Faces) -> Points:
    """How far each vertex of the finest mesh goes, (n, 3)."""
    head = load("head")
    fine = head.finer(2)
    points, faces, count = fine.vertices, fine.faces, len(fine.vertices)
    mirror = scipy.spatial.cKDTree(points).query(points * [-1.0, 1.0, 1.0])[1]
    x, y, z = points.T
    deep = np.minimum.reduce([z - 30.0 - 26.0 * smooth((y - 2.0) / 30.0), y + 118.0, 66.0 - y])
    held = smooth(deep / SOFT)
    is_face = held > 0.999

    def over(*names: str, left_out: tuple[str, ...] = ()) -> Points:
        values = np.zeros(len(head.vertices))
        for side in ("left", "right"):
            for name, value in [*((n, 1.0) for n in names), *((n, 0.0) for n in left_out)]:
                values[head.rings[f"{name}_{side}"]] = value
        return fine.interpolate(values)

    root_alone = over("ear_0") - over("ear_0", left_out=("ear_3",))
    is_ear = over("ear_1", "ear_2", "ear_3", "ear_4", "concha", "ear_0", left_out=("ear_0",)) > 0.3
    is_ear |= root_alone > 0.3
    is_rim = over("rim") > 0.9
    side = FromTheSide(target, target_faces)
    rows = ear_rows(side)
    vertices, places = np.array([*rows]), np.array([*rows.values()])
    warp = scipy.interpolate.RBFInterpolator(
        points[vertices], places - points[vertices], kernel="linear", degree=1
    )
    left = np.flatnonzero(is_ear & (x > 0.0))
    wanted, rowed, is_row = np.zeros((count, 3)), np.zeros(count), np.zeros(count)
    for numbers, ways in ((left, warp(points[left])), (vertices, places - points[vertices])):
        wanted[numbers], wanted[mirror[numbers]] = ways, ways * [-1.0, 1.0, 1.0]
    rowed[left] = rowed[mirror[left]] = is_row[vertices] = is_row[mirror[vertices]] = 1.0
    edges = [(angle, side.free_edge(angle)) for angle in np.radians(np.arange(-180, 180, 6))]
    known = np.array([(angle, met[1]) for angle, met in edges if met is not None])

    def is_in_ear(at: Points) -> npt.NDArray[np.bool_]:
        up, forward = (at[:, 1:] - EAR).T
        reach = np.interp(np.arctan2(up, forward), *known.T, period=2.0 * np.pi) + 1.5
        return np.asarray((np.hypot(up, forward) < reach) & (at[:, 0] > 64.0))

    hidden = is_in_ear(target) | is_in_ear(target * [-1.0, 1.0, 1.0])
    skin = target_faces[~hidden[target_faces].any(axis=1)]
    facing = vertex_normals(target, target_faces)
    bends, area = bending(points, faces)
    ways, free = np.zeros((count, 3)), np.flatnonzero(~is_face)
    is_above = points[free, 1] > np.where(points[free, 2] > 0.0, -150.0, -132.0)
    for number, (stiffness, by_rows, from_side) in enumerate(ROUNDS):
        moved = points + ways
        own = vertex_normals(moved, faces)
        at = nearest_on(moved[free], own[free], target, skin)
        normal = at.interpolate(facing)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        way = at.interpolate(target) - moved[free]
        farthest = 25.0 if number < 4 else 14.0 if number < 6 else 8.0
        is_met = (np.linalg.norm(way, axis=1) < farthest) & is_above & ~is_ear[free]
        is_met &= ((normal * own[free]).sum(axis=1) > 0.6) & (is_row[free] == 0.0)
        along = (way * normal).sum(axis=1, keepdims=True) * normal
        near, goal = np.zeros(count), np.zeros((count, 3))
        near[free] = is_met * area[free] * (1.0 - held[free])
        goal[free] = ways[free] + along + 0.1 * (way - along)
        seen, out = np.zeros(count), np.zeros(count)
        outward = left[own[left, 0] > 0.35]
        depth, slant = side(moved[outward, 1:])
        is_same = np.abs(depth - moved[outward, 0]) < 6.0
        is_same &= (slant * own[outward]).sum(axis=1) > 0.3
        outward, depth = outward[is_same], depth[is_same]
        seen[outward] = seen[mirror[outward]] = from_side * area[outward]
        out[outward] = depth - points[outward, 0]
        out[mirror[outward]] = -out[outward]
        by_row = 2.0 * by_rows * rowed * area + 1.2 * is_row * area
        base = near + by_row + area * (50.0 * held**2 + 1e4 * is_face + 1e-6)
        for k in range(3):
            more = (seen, 20.0 * is_rim * area, 0.0 * area)[k]  # the rim keeps its height
            right = near * goal[:, k] + by_row * wanted[:, k] + (seen * out if k == 0 else 0.0)
            matrix = stiffness * bends + scipy.sparse.diags(base + more)
            ways[:, k] = scipy.sparse.linalg.spsolve(matrix.tocsc(), right)
        ways = 0.5 * (ways + ways[mirror] * [-1.0, 1.0, 1.0])
        ways[is_face] = 0.0
    return ways


def stepped_back(ways: Points) -> Points:
    """The same, with finer vertices closer to the coarse mesh where triangles would turn over."""
    head = load("head")
    fine, first, count = head.finer(2), head.finer(1).faces, len(head.vertices)
    meant = fine.vertices + ways
    flat = fine.interpolate(meant[:count])
    share, points = np.zeros(len(meant)), meant
    for _ in range(60):
        points = meant + share[:, None] * (flat - meant)
        hit = np.zeros(len(meant), bool)
        for faces, children in ((first, 4), (fine.faces, 16)):
            own, parent = crosses(points, faces), crosses(points, head.faces).repeat(children, 0)
            length = np.linalg.norm(own, axis=1) * np.linalg.norm(parent, axis=1)
            hit[faces[(own * parent).sum(axis=1) < LEAST * length]] = True
        if not hit.any():
            break
        hit[:count] = False
        share[hit] = np.minimum(share[hit] + 0.1, 1.0)
    return points - fine.vertices


def write(ways: Points) -> None:
    """Move the vertices, the collar with them, and tell all that was made from the mesh."""
    head = load("head")
    fine, count, mirror = head.finer(2), len(head.vertices), head.mirror
    points = fine.vertices + ways
    own = points[:count]
    own = np.where(own[:, :1] > 0.0, own, own[mirror] * [-1.0, 1.0, 1.0])
    own[mirror == np.arange(count), 0] = 0.0
    points[:count] = own
    arrays = dict(np.load(HEAD_FILE))
    part = arrays["part_names"].tolist().index("shirt")
    ends, face_ends = (np.cumsum(arrays[f"part_{of}_counts"]) for of in ("vertex", "face"))
    shirt = slice(ends[part - 1], ends[part])
    cloth = arrays["part_vertices"][shirt].astype(np.float64)
    neck = np.flatnonzero((fine.vertices[:, 1] < -118.0) & (fine.vertices[:, 2] < 60.0))
    far, near = scipy.spatial.cKDTree(fine.vertices[neck]).query(cloth, k=24)
    share = (far + 4.0) ** -2.0
    share *= smooth(1.0 - (far[:, :1] - 15.0) / 75.0) / share.sum(axis=1, keepdims=True)
    cloth += np.einsum("ij,ijk->ik", share, (ways[neck] * [1.0, 0.3, 1.0])[near])
    faces = arrays["part_faces"][face_ends[part - 1] : face_ends[part]].astype(np.int32)
    arrays["part_vertices"][shirt] = cloth
    arrays["part_normals"][shirt] = vertex_normals(cloth, faces)
    tragion = int(head.rings["ear_0_left"][15])
    for name, vertex in (("tragion_left", tragion), ("tragion_right", mirror[tragion])):
        arrays["anatomy_vertices"][arrays["anatomy_names"] == name] = vertex
    arrays["vertices"] = own
    np.savez_compressed(HEAD_FILE, allow_pickle=False, **arrays)
    made_from = np.array(zlib.crc32(head.faces.tobytes(), zlib.crc32(own.tobytes())), np.uint32)
    normals = vertex_normals(points, fine.faces)
    normals = np.where(np.linalg.norm(ways, axis=1, keepdims=True) > 1e-9, normals, fine.normals)
    for file in HEAD_FILE.parent.glob("head_*.npz"):
        arrays = dict(np.load(file)) | {"made_from": made_from}
        if file.name == "head_finer.npz":
            arrays["added_vertices"] = points[count:].astype(np.float32)
            arrays["normals"] = normals.astype(np.float16)
        np.savez_compressed(file, allow_pickle=False, **arrays)


if __name__ == "__main__":
    write(stepped_back(displacement(*whole_person(*map(Path, sys.argv[1:3])))))
