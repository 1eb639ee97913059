"""Slide coarse vertices of ears, neck and crown to where refinement finds the form best.

`python .ci/slid_vertices.py` rewrites head.npz, the files made from it and skull.npz, on the data
of revision fd017061 with the finest mesh of revision 3d6b6507, which is the form. No vertex of the
face moves, and none leaves the form: the texture coordinates of the built-in head do not overlap,
so a place on them is a place on the form, and two numbers say where a vertex lies.

Least squares by Levenberg and Marquardt, with slopes from small steps. What is to be small, at the
vertices of the form: their distance from the refined mesh, the difference of normals, and how far
the texture is from its place there; and narrow triangles, and rows of the ear that bend.
"""

import io
import subprocess
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.app.refining.presets import FIRST_PRESET, PRESETS
from risorius.assets.intersections import self_intersections
from risorius.assets.loading import HEAD_FILE, load
from risorius.geometry.closest import SurfacePoints, closest_points
from risorius.geometry.normals import cross_products, vertex_normals

Array = npt.NDArray[Any]

STAGES = (0.5, 3.0, 17), (0.56, 3.5, 14)  # shape that counts as narrow, its weight; rounds
NORMAL, TEXTURE, IN_EARS, ROWS = 1.5, 0.3, 0.05, 0.4  # weights; of texture on ears
STEP, LONGEST, AWAY = 0.15, 0.8, 6.0  # [mm] of slopes, of a round, that texture counts
WRONG_SIDE = 6.0  # [mm] that a surface which faces the other way counts as farther
LEAST, DRAWN = 0.15, 0.15  # cosine of a finer triangle and its parent; share of a step back
LOBE = -36.0  # [mm], below which the outer rows of the ear stay

HEAD = load("head")
FORM_FACES, FINE = HEAD.finer(2).faces, HEAD.finer(2)
FACES, MIRROR, COUNT = HEAD.faces, HEAD.mirror, len(HEAD.vertices)
START, UV = HEAD.vertices.astype(float), HEAD.uv.astype(float)
SHARES = FINE.interpolate(np.eye(COUNT))  # of coarse vertices in those of the form
FORM_UV = SHARES @ UV


def finer_of(revision: str) -> dict[str, Array]:
    """The arrays of head_finer.npz in a revision."""
    command = ["git", "show", f"{revision}:assets/data/head_finer.npz"]
    return dict(np.load(io.BytesIO(subprocess.check_output(command))))


OLD = finer_of("3d6b6507")
FORM = np.concatenate([START, OLD["added_vertices"].astype(float)])
FORM_NORMALS = vertex_normals(FORM, FORM_FACES)


def flat(uv: Array) -> Array:
    """Texture coordinates (n, 2) as points in space."""
    return np.c_[uv, np.zeros(len(uv))]


def on_form(uv: Array) -> SurfacePoints:
    """Places of the form by their texture coordinates."""
    return closest_points(flat(uv), flat(FORM_UV), FORM_FACES)


def neighbours() -> list[set[int]]:
    """Of each coarse vertex."""
    found: list[set[int]] = [set() for _ in range(COUNT)]
    for face in FACES.tolist():
        for vertex in face:
            found[vertex] |= set(face) - {vertex}
    return found


NEAR = neighbours()


def grown(mask: Array, times: int = 1) -> Array:
    """Vertices and those around them."""
    for _ in range(times):
        mask = mask.copy()
        mask[[other for vertex in np.flatnonzero(mask) for other in NEAR[vertex]]] = True
    return mask


def free_vertices() -> tuple[Array, Array, Array]:
    """What may slide on the left and in the middle, and which vertices are of ears."""
    x, y, z = START.T
    ears = np.zeros(COUNT, bool)
    for name, row in HEAD.rings.items():
        if name.startswith(("ear_", "concha")):
            ears[row] = True
    around = grown(ears)
    free = around | (z < 15) & (y > -60) | (y < -85) & (z < 60) | (y > 70)
    sides = np.sort(np.concatenate([FACES[:, [0, 1]], FACES[:, [1, 2]], FACES[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    fixed = (z > 15) & ~around & (y > -85) & (y < 70)
    fixed[edges[uses == 1]] = True
    fixed[list(HEAD.anatomy.values())] = fixed[HEAD.landmarks] = True
    for side in ("left", "right"):
        row = np.concatenate([HEAD.rings[f"ear_{k}_{side}"] for k in (0, 1)])
        fixed[row[y[row] < LOBE]] = True
        fixed[HEAD.rings[f"ear_0_{side}"][15]] = True
    free &= ~fixed
    return np.flatnonzero(free & (x > 1e-6)), np.flatnonzero(free & (np.abs(x) < 1e-6)), ears


LEFT, MIDDLE, EARS = free_vertices()
MOVED = np.concatenate([LEFT, MIDDLE])
PLACES = [(v, k) for v in LEFT for k in (0, 1)] + [(v, 1) for v in MIDDLE]


def metric() -> tuple[Array, Array]:
    """Area of each vertex of the form, and what makes [mm] of a step of texture, (n, 2, 2)."""
    corners, coordinates = FORM[FORM_FACES], FORM_UV[FORM_FACES]
    size = 0.5 * np.linalg.norm(cross_products(FORM, FORM_FACES), axis=1)
    ways, steps = corners[:, 1:] - corners[:, :1], coordinates[:, 1:] - coordinates[:, :1]
    slopes = np.linalg.solve(steps, ways).swapaxes(1, 2) * size[:, None, None]
    area, total = np.zeros(len(FORM)), np.zeros((len(FORM), 3, 2))
    for corner in range(3):
        np.add.at(area, FORM_FACES[:, corner], size / 3.0)
        np.add.at(total, FORM_FACES[:, corner], slopes / 3.0)
    return area, np.linalg.qr(total / area[:, None, None])[1]


AREA, TO_MM = metric()
ON_LEFT = np.flatnonzero(FORM[:, 0] >= -1e-6)
IS_FREE = np.isin(np.arange(COUNT), np.concatenate([MOVED, MIRROR[LEFT]]))
SEEN = ON_LEFT[SHARES[ON_LEFT] @ grown(IS_FREE, 2) > 0.3]
WEIGHT = np.sqrt(0.5 * AREA / AREA.mean() + 0.5)
OF_TEXTURE = np.where(SHARES @ EARS > 0.3, IN_EARS, TEXTURE)[:, None]
CHANGED = np.flatnonzero(IS_FREE[FACES].any(axis=1) & (START[FACES][:, :, 0].max(axis=1) > -1e-6))


def refined(points: Array, uv: Array) -> refine.RefinedMesh:
    """As the application shows it."""
    told = PRESETS[FIRST_PRESET]["face"].told("kahler")
    options: dict[str, Any] = {name: told[name] for name in ("scheme", "criterion")}
    options |= {"uv": uv.astype(np.float32), "face_uv": FACES}
    return refine.create("kahler", FACES, points, **options).refine(points)


def off(mesh: refine.RefinedMesh, seen: Array) -> Array:
    """What is to be small at vertices of the form, (6, n)."""
    triangles, there = mesh.triangles, FORM[seen]
    middles = mesh.positions[triangles].mean(axis=1)
    low, high = there.min(axis=0) - AWAY, there.max(axis=0) + AWAY
    triangles = triangles[((middles > low) & (middles < high)).all(axis=1)]
    place = closest_points(there, mesh.positions, triangles, FORM_NORMALS[seen], WRONG_SIDE)
    normals = place.interpolate(mesh.normals)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    out = ((there - place.interpolate(mesh.positions)) * FORM_NORMALS[seen]).sum(axis=1)
    aside = np.einsum("nij,nj->ni", TO_MM[seen], place.interpolate(mesh.uv) - FORM_UV[seen])
    length = np.linalg.norm(aside, axis=1, keepdims=True)
    aside *= OF_TEXTURE[seen] * np.minimum(1.0, AWAY / np.maximum(length, 1e-9))
    turned = NORMAL * (normals - FORM_NORMALS[seen])
    rows = np.column_stack([np.sign(out) * place.distances, turned, aside])
    return np.asarray((rows * WEIGHT[seen, None]).T)


def shape(points: Array, narrow: float, weight: float) -> Array:
    """What is to be small of the mesh itself: narrow triangles, rows of the ear that bend."""
    corners = points[FACES[CHANGED]]
    square = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    size = 0.5 * np.linalg.norm(cross_products(points, FACES[CHANGED]), axis=1)
    even = 4.0 * np.sqrt(3.0) * size / square
    moved, bend = points - START, []
    for row in (HEAD.rings[f"ear_{k}_left"] for k in (1, 2, 3, 4)):
        bend.append(0.5 * (moved[row[:-2]] + moved[row[2:]]) - moved[row[1:-1]])
    lack = 3.0 * weight * np.maximum(narrow - even, 0.0) / narrow
    return np.concatenate([lack, ROWS * np.concatenate(bend).ravel()])


def both_sides(uv: Array, vertices: Array = LEFT) -> Array:
    """Texture coordinates whose right side is the mirror image of the left one."""
    uv = uv.copy()
    uv[MIRROR[vertices]] = uv[vertices] * [-1.0, 1.0] + [1.0, 0.0]
    return uv


def positions(uv: Array, vertices: Array = MOVED, before: Array = START) -> Array:
    """Vertices [mm] where some of them lie at these texture coordinates, on both sides."""
    points, there = before.copy(), on_form(uv[vertices]).interpolate(FORM)
    there[np.isin(vertices, MIDDLE), 0] = 0.0
    points[MIRROR[vertices]] = there * [-1.0, 1.0, 1.0]
    points[vertices] = there
    return points


def slid(uv: Array, narrow: float, weight: float, rounds: int) -> Array:
    """Texture coordinates after some rounds."""
    per_unit = np.array(
        [
            np.median(
                np.linalg.norm(START[list(near)] - START[v], axis=1)
                / np.linalg.norm(UV[list(near)] - UV[v], axis=1)
            )
            for v, near in enumerate(NEAR)
        ]
    )
    touched = {
        v: np.flatnonzero(SHARES[SEEN] @ grown(np.arange(COUNT) == v, 2) > 0.05) for v in MOVED
    }
    points = positions(uv)
    here, own = off(refined(points, uv), SEEN), shape(points, narrow, weight)
    error, damping = (here**2).sum() + (own**2).sum(), 1.0
    for number in range(rounds):
        slopes = np.zeros((len(PLACES), here.size + len(own)))
        for k, (vertex, axis) in enumerate(PLACES):
            other, one = uv.copy(), np.array([vertex])
            other[vertex, axis] += STEP / per_unit[vertex]
            other = both_sides(other, one)
            there, rows = positions(other, one, points), touched[vertex]
            change = np.zeros_like(here)
            change[:, rows] = off(refined(there, other), SEEN[rows]) - here[:, rows]
            change_of_shape = shape(there, narrow, weight) - own
            slopes[k] = np.concatenate([change.ravel(), change_of_shape]) / STEP
        square, down = slopes @ slopes.T, slopes @ np.concatenate([here.ravel(), own])
        scale = np.diag(square) + 1e-3 * np.trace(square) / len(PLACES)
        for _ in range(8):
            step = np.linalg.solve(square + damping * np.diag(scale), -down)
            other = uv.copy()
            for (vertex, axis), by in zip(PLACES, np.clip(step, -LONGEST, LONGEST), strict=True):
                other[vertex, axis] += by / per_unit[vertex]
            other = both_sides(other)
            there = positions(other)
            moved, changed = off(refined(there, other), SEEN), shape(there, narrow, weight)
            found = (moved**2).sum() + (changed**2).sum()
            if found < error and cross_products(flat(other), FACES)[:, 2].min() > 2e-7:
                break
            damping *= 3.0
        else:
            break
        print(number, round(found, 1), flush=True)
        is_still = error - found < 1e-3 * error
        uv, points, here, own, error = other, there, moved, changed, found
        damping = max(damping / 3.0, 1e-3)
        if is_still:
            break
    return uv


def finest(uv: Array, points: Array) -> tuple[Array, Array]:
    """The finest mesh on the same form, and its normals; it steps back where it would turn over."""
    place = on_form(SHARES @ uv)
    fine, normals = place.interpolate(FORM), place.interpolate(OLD["normals"].astype(float))
    is_same = np.linalg.norm(SHARES @ uv - FORM_UV, axis=1) < 1e-9
    fine[is_same], normals[is_same] = FORM[is_same], OLD["normals"][is_same]
    mirrored = FORM_UV * [-1.0, 1.0] + [1.0, 0.0]
    mirror = closest_points(flat(mirrored), flat(FORM_UV), FORM_FACES)
    other = mirror.corners[np.arange(len(FORM)), mirror.weights.argmax(axis=1)]
    left, middle = np.flatnonzero(FORM_UV[:, 0] > 0.5 + 1e-9), other == np.arange(len(FORM))
    for each in (fine, normals):
        each[other[left]] = each[left] * [-1.0, 1.0, 1.0]
        each[middle, 0] = 0.0
    fine[:COUNT], flattened = points, SHARES @ points
    for _ in range(60):
        bad: set[int] = set()
        for level in (HEAD.finer(1), FINE):
            own = cross_products(fine[: len(level.vertices)], level.faces)
            parents = cross_products(points, FACES).repeat(len(own) // len(FACES), axis=0)
            cosine = (own * parents).sum(axis=1) / np.linalg.norm(own, axis=1)
            bad |= {*level.faces[cosine < LEAST * np.linalg.norm(parents, axis=1)].ravel()}
        bad |= {*FORM_FACES[np.ravel(self_intersections(fine, FORM_FACES)).astype(int)].ravel()}
        back = np.array(sorted(each for each in bad if each >= COUNT), int)
        if not len(back):
            break
        back = np.union1d(back, other[back])
        fine[back] += DRAWN * (flattened[back] - fine[back])
        fine[other[left]] = fine[left] * [-1.0, 1.0, 1.0]
    return fine, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def write(uv: Array) -> None:
    """Rewrite the data; what vertices have goes along to where they lie."""
    uv[~IS_FREE] = UV[~IS_FREE]
    points = positions(uv)
    place = closest_points(flat(uv), flat(UV), FACES)
    place.corners[MIRROR[LEFT]] = MIRROR[place.corners[LEFT]]
    place.weights[MIRROR[LEFT]] = place.weights[LEFT]

    def carried(values: Array) -> Array:
        found = values.astype(float)
        found[IS_FREE] = place.interpolate(found)[IS_FREE]
        return found.astype(values.dtype)

    fine, normals = finest(uv, points)
    made_from = np.array(zlib.crc32(FACES.tobytes(), zlib.crc32(points.tobytes())), np.uint32)
    for file in [HEAD_FILE, *sorted(HEAD_FILE.parent.glob("head_*.npz"))]:
        arrays = dict(np.load(file))
        if file == HEAD_FILE:
            arrays |= {"vertices": points, "uv": both_sides(uv).astype(np.float32)}
            arrays |= {name: carried(arrays[name]) for name in ("bone_depth", "mandible_weight")}
        else:
            arrays["made_from"] = made_from
        if "added_vertices" in arrays:
            arrays["added_vertices"] = fine[COUNT:].astype(np.float32)
            arrays["normals"] = normals.astype(np.float16)
        if "modes" in arrays:
            arrays["modes"] = np.stack([carried(mode) for mode in arrays["modes"]])
        if "across" in arrays:
            across = carried(arrays["across"])
            length = np.linalg.norm(across, axis=2, keepdims=True)
            arrays["across"] = np.where(length > 0.5, across / np.maximum(length, 1e-9), 0.0)
            arrays["across"][~IS_FREE] = np.load(file)["across"][~IS_FREE]
            arrays["across"] = arrays["across"].astype(np.float32)
        np.savez_compressed(file, **arrays)
    file = HEAD_FILE.with_name("skull.npz")
    arrays = dict(np.load(file))
    bulge = (points - place.interpolate(START))[IS_FREE]
    skin = arrays["skin"].astype(float)
    skin[IS_FREE] = place.interpolate(skin)[IS_FREE] + bulge
    np.savez_compressed(file, **arrays | {"skin": skin.astype(np.float32)})


if __name__ == "__main__":
    coordinates = UV.copy()
    for stage in STAGES:
        coordinates = slid(coordinates, *stage)
    write(coordinates)
