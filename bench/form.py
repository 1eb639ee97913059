"""Fit the form of the built-in head to a person of people's modes: `risorius bench form`.

Topology, rows, landmarks, texture and what else is no place stay as they ship. The mesh is laid on
the mean person (registration.py), carried along the modes to one who is drawn at random, and
mended there: lips shut, insides behind them, no narrow triangles, lids on the eyeballs, eyeballs,
teeth and the mouth's walls behind the skin. The finer meshes follow the person's own surface, and
stay with the coarse one where they would cut through themselves. Written are head.npz and what
lies beside it, but for the light, which `python -m risorius.app.scenes.ambient_occlusion` bakes.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy
from scipy import sparse
from scipy.sparse.linalg import splu

from risorius import assets
from risorius.app.files import folder_atomically
from risorius.assets.data_files import read_arrays
from risorius.assets.fitting.organs import FittedSkin, place_parts
from risorius.assets.fitting.warp import ThinPlateSpline, nearest_on
from risorius.assets.identities.shaping import lids_on_eyes
from risorius.assets.intersections import self_intersections
from risorius.assets.loading import HEAD_FILE, load_head
from risorius.assets.model import Eye, FineMesh, FloatArray, Head, IndexArray, Part
from risorius.geometry.normals import vertex_normals

from .identity_space import IdentitySpace
from .reference_rows import Reference, free_vertices, row_targets, warped
from .registration import (
    MIRROR,
    Target,
    bending,
    laid_on,
    neighbours,
    on_surface,
    relaxed,
    spread,
)

RMS, MOST_WEIGHT = 0.9, 2.3  # of the drawn weights: an ordinary person
MEAN_ANGLE, LEAST_ANGLE = 16.0, 14.0  # [deg] of triangles, on the mean and on the person
LID_SHARES = (1.0, 1.0, 0.9, 0.55, 0.2)  # of the way onto the eyeball, row by row around an eye
EYE_RADIUS, IRIS_RADIUS, CLEARANCE = 13.0, 5.9, 0.25  # [mm]
OUTWARD = 0.3  # [mm] that an eyeball's centre is beside the middle of its lids
GIVE = 0.5  # of the warp of parts where the skin has no row
WALL_DEPTH, WALL_ROUNDS = 1.2, 4  # [mm] of the mouth's walls behind the skin; rounds of pushing
FINE_STIFFNESS, FINE_REACH, FINE_ALIKE = (0.3, 0.1, 0.05), 3.0, 0.4  # as registration has them
KEPT_ROUNDS, LEAST_SHARE = 14, 0.1  # of the way from flat triangles to the form, where they cut
OWN = re.compile(r"head(_\w+)?\.(npz|png)")


@dataclass(frozen=True)
class Form:
    """A head of the shipped topology, at other places [mm]."""

    vertices: FloatArray
    finest: FloatArray
    """The vertices of finer(2), the first of them those of the head."""
    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    jaw_axis: FloatArray


def make(reference_folder: Path, folder: Path, seed: int) -> list[str]:
    """Fit the head to the person of that number and write its files; lines that say how it went.

    Raises ValueError for a broken reference, UserError where the folder cannot be written.
    """
    head = assets.load("head")
    reference = Reference.of(IdentitySpace.read(reference_folder), head)
    with folder_atomically(folder, OWN, overwrite=True) as part:
        form = fitted(head, reference, drawn(seed, len(reference.modes)))
        save(head, form, part)
    cuts = [
        len(self_intersections(form.finest[:count], faces))
        for count, faces in [(len(form.vertices), head.faces)]
        + [(len(fine.vertices), fine.faces) for fine in (head.finer(1), head.finer(2))]
    ]
    return [
        f"{folder}: head.npz and what lies beside it",
        "triangles that cut each other, coarse and finer: " + ", ".join(map(str, cuts)),
    ]


def drawn(seed: int, count: int) -> FloatArray:
    """Weights of an ordinary person, shape (count,)."""
    weights = np.random.default_rng(seed).normal(size=count)
    weights *= RMS / np.sqrt((weights**2).mean())
    return np.clip(weights, -MOST_WEIGHT, MOST_WEIGHT)


def fitted(head: Head, reference: Reference, weights: FloatArray) -> Form:
    """The head as the person of these weights."""
    start = warped(head, reference)
    free = free_vertices(head, start)
    mean = laid_on(head, start, reference, row_targets(head, reference), free)
    mean = settled(head, mean)
    mean = relaxed(head, mean, reference, on_surface(head, mean, reference, free), MEAN_ANGLE)
    lying = on_surface(head, mean, reference, free)
    fields = _fields(head, mean, reference, lying)
    person = reference.person(weights)
    x = settled(head, mean + np.tensordot(weights, fields, 1))
    x = relaxed(head, x, person, lying, LEAST_ANGLE)
    eyes = eyes_behind_lids(head, x)
    x = _mirrored(head, lids_on_eyes(head, x, eyes, LID_SHARES))
    fine = head.finer(2)
    finest = finer_on(head, fine, x, person, lying)
    finest = without_cuts(head, fine, x, finest)
    x_axis = ThinPlateSpline(*_pairs(head, x))
    parts = placed_parts(head, x, eyes, x_axis)
    axis = x_axis.points(head.jaw_axis)
    return Form(x, finest, eyes, parts, 0.5 * (axis + axis[::-1] * MIRROR))


def _mirrored(head: Head, x: FloatArray) -> FloatArray:
    """Vertices of which the right side is the mirror image of the left, to the last bit."""
    even = x.copy()
    right = np.flatnonzero(head.vertices[:, 0] < 0.0)
    even[right] = x[head.mirror[right]] * MIRROR
    even[head.mirror == np.arange(len(x)), 0] = 0.0
    return even


def _fields(head: Head, x: FloatArray, reference: Reference, lying: IndexArray) -> FloatArray:
    """How the head's vertices move with each mode, (k, V, 3); smooth where none is known."""
    normals = vertex_normals(x, head.faces)
    at = nearest_on(x, normals, reference.vertices, reference.triangles)
    fields = np.array([at.interpolate(mode) for mode in reference.modes])
    rim = np.r_[head.rings["rim_left"], head.rings["rim_right"]]
    fields[:, rim] = 0.0
    edges = [
        head.rings[f"{row}_{side}"] for row in ("mouth_2", "eye_1") for side in ("left", "right")
    ]
    return spread(head, x, fields, np.concatenate([lying, rim, *edges]))


def settled(head: Head, vertices: FloatArray) -> FloatArray:
    """Vertices with closed lips, and with the inner rows of lips, lids and nostrils behind them."""
    x, rest = vertices.copy(), head.vertices
    mouth = [head.rings[f"mouth_{row}_left"] for row in range(8)]
    for upper in range(7):
        lower = 14 - upper
        ends = mouth[2][[upper, lower]]
        gap = np.diff(x[ends], axis=0)[0] - np.diff(rest[ends], axis=0)[0]
        for row, share in ((2, 1.0), (3, 0.6), (4, 0.25), (5, 0.05)):
            x[mouth[row][upper]] += 0.5 * share * gap
            x[mouth[row][lower]] -= 0.5 * share * gap
    for row in (0, 1):
        x[mouth[row]] = x[mouth[2]] + rest[mouth[row]] - rest[mouth[2]]
    inside, edge = (head.rings[f"eye_{row}_left"] for row in (0, 1))
    for k in range(20):
        opening = [float(np.linalg.norm(y[edge[k]] - y[edge[-k % 20]])) for y in (x, rest)]
        share = 1.0 if k in (0, 10) else min(1.0, opening[0] / opening[1])
        x[inside[k]] = x[edge[k]] + (rest[inside[k]] - rest[edge[k]]) * [1.0, share, 1.0]
    ring, roof = head.rings["nostril_left"], head.anatomy["nostril_roof_left"]
    moved, cap = x[ring] - rest[ring], sorted(neighbours(head.faces)[roof])
    for vertex in cap:
        x[vertex] = rest[vertex] + moved[np.linalg.norm(rest[ring] - rest[vertex], axis=1).argmin()]
    for before, after in zip(cap, (*cap[1:], cap[0]), strict=True):
        x[before] = 0.75 * x[before] + 0.25 * (x[after] + rest[before] - rest[after])
    x[roof] = rest[roof] + moved.mean(axis=0)
    changed = np.unique(np.concatenate([*mouth, inside, cap, [roof]]))
    x[head.mirror[changed]] = x[changed] * MIRROR
    return x


def eyes_behind_lids(head: Head, x: FloatArray) -> tuple[Eye, ...]:
    """Eyeballs that lie on the edges of the lids as well as they can, all of one size."""
    ring = head.rings["eye_1_left"]
    edge = x[np.delete(ring, [0, 1, len(ring) - 1])]  # without the inner corner
    middle = 0.5 * (x[ring[5]] + x[ring[15]])
    aside = middle[:2] + np.array([OUTWARD, 0.0])

    def off(centre: FloatArray) -> FloatArray:
        gaps = np.linalg.norm(edge - centre, axis=1) - EYE_RADIUS - CLEARANCE
        return np.concatenate([gaps, 2.0 * (centre[:2] - aside)])

    left = scipy.optimize.least_squares(off, middle - [0.0, 0.0, EYE_RADIUS]).x
    return (
        Eye("right", left * MIRROR, EYE_RADIUS, IRIS_RADIUS),
        Eye("left", left, EYE_RADIUS, IRIS_RADIUS),
    )


def finer_on(
    head: Head, fine: FineMesh, x: FloatArray, person: Target, lying: IndexArray
) -> FloatArray:
    """Vertices of a finer mesh: on a person where the coarse ones lie there, smooth elsewhere."""
    rest, count, images = fine.vertices, len(fine.vertices), _images(head, fine)
    own, inner = np.zeros(len(x)), np.zeros(len(x))
    own[lying] = 1.0
    inner[_inner_rows(head)] = 1.0
    drawn_to = (fine.interpolate(own) > 0.6) & (fine.interpolate(inner) < 0.45)
    drawn_to[: len(x)] = False
    at_surface, added = np.flatnonzero(drawn_to), np.arange(len(x), count)
    bend, size = bending(rest, fine.faces)
    moved = np.zeros((count, 3))
    moved[: len(x)] = x - rest[: len(x)]
    inner_bend, outer = bend[added][:, added], bend[added][:, : len(x)] @ moved[: len(x)]
    moved[added] = splu((inner_bend + 1e-9 * sparse.eye(len(added))).tocsc()).solve(-outer)
    for stiffness in FINE_STIFFNESS:
        at = rest + moved
        normals = vertex_normals(at, fine.faces)[at_surface]
        found = nearest_on(at[at_surface], normals, person.vertices, person.triangles)
        facing = found.interpolate(person.normals)
        facing /= np.linalg.norm(facing, axis=1, keepdims=True)
        away = found.interpolate(person.vertices) - at[at_surface]
        fits = (np.linalg.norm(away, axis=1) < FINE_REACH) & (
            (facing * normals).sum(axis=1) > FINE_ALIKE
        )
        i, n = at_surface[fits], facing[fits]
        pull, goal = np.zeros(count), moved.copy()
        pull[i] = size[i] ** 2
        goal[i] += (away[fits] * n).sum(axis=1)[:, None] * n
        system = stiffness * inner_bend + sparse.diags(pull[added] + 1e-9)
        moved[added] = splu(system.tocsc()).solve(
            pull[added, None] * goal[added] - stiffness * outer
        )
        moved = 0.5 * (moved + moved[images] * MIRROR)
        moved[: len(x)] = x - rest[: len(x)]
    return rest + moved


def _inner_rows(head: Head) -> IndexArray:
    """Vertices at which the finer meshes follow the coarse one: insides, and edges of lips."""
    names = ["eye_0", "mouth_0", "mouth_1", "mouth_2", "mouth_3"]
    rows = [head.rings[f"{name}_{side}"] for name in names for side in ("left", "right")]
    return np.unique(np.concatenate(rows))


def _images(head: Head, fine: FineMesh) -> IndexArray:
    """The number of the mirror image of each vertex of a finer mesh."""
    images = head.mirror
    for edges in fine.edges:
        number = {tuple(edge): len(images) + k for k, edge in enumerate(edges.tolist())}
        ends = np.sort(images[edges], axis=1).tolist()
        images = np.r_[images, [number[tuple(edge)] for edge in ends]].astype(np.int32)
    return images


def without_cuts(head: Head, fine: FineMesh, x: FloatArray, finest: FloatArray) -> FloatArray:
    """Vertices of a finer mesh, nearer to the coarse triangles where levels 1 or 2 cut themselves.

    As they are written: new ones in single precision.
    """
    flat, images, count = fine.interpolate(x), _images(head, fine), len(x)
    share, levels = np.ones(len(finest)), (head.finer(1), fine)
    at = finest
    for _ in range(KEPT_ROUNDS):
        at = flat + share[:, None] * (finest - flat)
        at = np.vstack([x, at[count:].astype(np.float32)]).astype(np.float64)
        at[:count] = x
        cutting = [
            level.faces[np.unique(self_intersections(at[: len(level.vertices)], level.faces))]
            for level in levels
        ]
        bad = np.unique(np.concatenate([faces.ravel() for faces in cutting]))
        if not len(bad):
            break
        bad = np.union1d(bad, images[bad])
        share[bad] = np.where(share[bad] > LEAST_SHARE, 0.5 * share[bad], 0.0)
    return at


def _pairs(head: Head, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points of the skin before and after, and what they give: the same on both sides."""
    rows = [ring for name, ring in head.rings.items() if not name.startswith("rim")]
    anatomy = np.array(list(head.anatomy.values()))
    named = np.unique(np.concatenate([*rows, head.landmarks, anatomy]))
    named = np.union1d(named, head.mirror[named])
    others = np.setdiff1d(np.arange(len(x)), named)
    others = others[head.vertices[others, 0] >= 0.0][::2]
    others = np.union1d(others, head.mirror[others])
    use = np.concatenate([named, others])
    give = np.r_[np.zeros(len(named)), np.full(len(others), GIVE)]
    return head.vertices[use], x[use], give


def placed_parts(
    head: Head, x: FloatArray, eyes: tuple[Eye, ...], warp: ThinPlateSpline
) -> tuple[Part, ...]:
    """Eyeballs, lashes, teeth, tongue and walls of the mouth in the skin; the shirt stays."""
    normals = vertex_normals(x, head.faces)
    skin = FittedSkin(x, normals, x[head.landmarks], head.mandible_weight)
    parts = []
    for old, new in zip(head.parts, place_parts(head, skin, warp, eyes), strict=True):
        vertices = new.vertices.astype(np.float64)
        if old.name.startswith("oral_cavity"):
            vertices = _behind(vertices, x, normals, head.faces)
        placed = replace(
            new,
            vertices=vertices.astype(np.float32),
            normals=vertex_normals(vertices, new.faces).astype(np.float32),
        )
        parts.append(old if old.name == "shirt" else placed)
    return tuple(parts)


def _behind(
    points: FloatArray, vertices: FloatArray, normals: FloatArray, faces: IndexArray
) -> FloatArray:
    """Points pushed along the skin's normals until they are WALL_DEPTH behind it."""
    pushed = points.copy()
    for _ in range(WALL_ROUNDS):
        at = nearest_on(pushed, np.zeros_like(pushed), vertices, faces)
        facing = at.interpolate(normals)
        facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
        height = ((pushed - at.interpolate(vertices)) * facing).sum(axis=1)
        pushed -= np.maximum(height + WALL_DEPTH, 0.0)[:, None] * facing
    return pushed


def save(head: Head, form: Form, folder: Path) -> None:
    """Write a form's head.npz and what lies beside it into a folder."""
    arrays: dict[str, Any] = dict(read_arrays(HEAD_FILE))
    arrays["vertices"], arrays["jaw_axis"] = form.vertices, form.jaw_axis
    arrays["eye_centres"] = np.array([eye.centre for eye in form.eyes])
    arrays["eye_radii"] = np.array([[eye.radius, eye.iris_radius] for eye in form.eyes])
    arrays["part_vertices"] = np.vstack([part.vertices for part in form.parts])
    arrays["part_normals"] = np.vstack([part.normals for part in form.parts])
    _write(folder / HEAD_FILE.name, arrays)
    made_from = np.array(load_head(folder / HEAD_FILE.name).fingerprint, dtype=np.uint32)
    normals = vertex_normals(form.finest, head.finer(2).faces)
    finer = {
        "added_vertices": form.finest[len(form.vertices) :].astype(np.float32),
        "normals": normals.astype(np.float16),
        "made_from": made_from,
    }
    _write(folder / "head_finer.npz", finer)
    wrinkles = dict(read_arrays(head.wrinkles_file))
    across = turned(head, form.vertices, wrinkles["across"]).astype(np.float32)
    _write(folder / "head_wrinkles.npz", {**wrinkles, "across": across, "made_from": made_from})
    tints = dict(read_arrays(head.tints_file))
    _write(folder / "head_tints.npz", {**tints, "made_from": made_from})
    for file in (head.albedo_file, head.segments_file):
        shutil.copyfile(file, folder / file.name)


def _write(file: Path, arrays: dict[str, Any]) -> None:
    np.savez_compressed(file, allow_pickle=False, **arrays)


def turned(head: Head, x: FloatArray, across: npt.NDArray[Any]) -> FloatArray:
    """Directions in the skin (V, 2, 3) turned with the triangles around each vertex."""
    before, after = vertex_normals(head.vertices, head.faces), vertex_normals(x, head.faces)
    result = np.zeros(across.shape)
    for v, near in neighbours(head.faces).items():
        around = sorted(near)
        old = np.vstack([head.vertices[around] - head.vertices[v], 3.0 * before[v]])
        new = np.vstack([x[around] - x[v], 3.0 * after[v]])
        ways = across[v] @ np.linalg.lstsq(old, new)[0]
        ways -= (ways @ after[v])[:, None] * after[v]
        length = np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-12)
        result[v] = ways / length * np.linalg.norm(across[v], axis=1, keepdims=True)
    return result
