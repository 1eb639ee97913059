"""Fit the form of the built-in head to a person of people's modes: `risorius bench form`.

Topology, rows, landmarks, texture and what else is no place stay as they ship. The mesh is laid on
the mean person (registration.py), carried along the modes to one who is drawn at random, and
mended there: lips shut, insides behind them, no narrow triangles, lids on the eyeballs, eyeballs,
teeth and the mouth's walls behind the skin (form_parts.py). The finer meshes follow the person's
own surface, and stay with the coarse one where they would cut through themselves. Written are
head.npz and what lies beside it, but for the light, which
`python -m risorius.app.scenes.ambient_occlusion` bakes.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from risorius import assets
from risorius.app.files import folder_atomically
from risorius.assets.data_files import read_arrays
from risorius.assets.fitting.warp import nearest_on
from risorius.assets.identities.person import ears_off_head
from risorius.assets.intersections import self_intersections
from risorius.assets.loading import HEAD_FILE, load_head
from risorius.assets.model import Eye, FineMesh, FloatArray, Head, IndexArray, Part
from risorius.assets.norms import NORMS, measures_of
from risorius.geometry.normals import cross_products, vertex_normals

from .form_parts import lids_and_eyes, placed_parts, warp_of
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
NOSTRIL_ROOF = np.array([-1.2, 12.5, -7.7])  # [mm] from the middle of the left nostril's edge
WALL = 0.38, 1.0  # of the way up there, and how wide the nostril still is
USUAL, STEPS = 0.8, 4  # how strongly measures draw a person to published means; Newton's steps
FINE_STIFFNESS, FINE_REACH, FINE_ALIKE = (0.3, 0.1, 0.05), 3.0, 0.4  # as registration has them
MODES, SHOWN = 24, (0.0, -115.0)  # that are kept; z, y [mm] above which all of a face lies
STIFF = 200.0  # [mm2] how little nostrils are bent
KEPT_ROUNDS, LEAST_SHARE = 14, 0.1  # of the way from flat triangles to the form, where they cut
LEAST_COSINE = 0.15  # between a finer triangle and the one that it is a part of
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
    modes: FloatArray
    """How people differ, (k, V, 3), each at one deviation."""
    weights: FloatArray
    """Of the modes, with which this head is one of them, (k,)."""


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
    weights = usual(head, mean, fields, weights)
    person = reference.person(weights)
    x = settled(head, mean + np.tensordot(weights, fields, 1))
    x = ears_off_head(head, relaxed(head, x, person, lying, LEAST_ANGLE))
    x, eyes = lids_and_eyes(head, x)
    x = _mirrored(head, x)
    fine = head.finer(2)
    finest = without_cuts(head, fine, x, finer_on(head, fine, x, person, lying))
    warp = warp_of(head, x)
    axis = warp.points(head.jaw_axis)
    parts = placed_parts(head, x, eyes, warp)
    modes, own = principal(head, x, fields, weights)
    return Form(x, finest, eyes, parts, 0.5 * (axis + axis[::-1] * MIRROR), modes, own)


def usual(head: Head, mean: FloatArray, fields: FloatArray, drawn: FloatArray) -> FloatArray:
    """Weights of somebody near a drawn person whose measures are nearer to published means.

    The likeliest one, where people are drawn around that person and measures around the middle
    between the means of women and men, with deviations of 1 / sqrt(USUAL). Both of shape (k,).
    """
    weights = drawn.copy()

    def scores(weights: FloatArray) -> FloatArray:
        found = measures_of(mean + np.tensordot(weights, fields, 1), head.anatomy)
        rows = [(norm.women, norm.men, found[code]) for code, norm in NORMS.items()]
        return np.array([0.5 * (women.score(x) + men.score(x)) for women, men, x in rows])

    for _ in range(STEPS):
        ways = 0.5 * np.eye(len(weights))
        slopes = np.array([scores(weights + way) - scores(weights - way) for way in ways]).T
        system = np.eye(len(weights)) + USUAL * slopes.T @ slopes
        left = scores(weights) - slopes @ (weights - drawn)
        weights = drawn - np.linalg.solve(system, USUAL * slopes.T @ left)
    return weights


def principal(
    head: Head, x: FloatArray, fields: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The MODES ways in which people differ most, (k, V, 3), and a person's weights of them.

    Differences count by the area that shows them, those of crown and neck a tenth, and not by where
    a face is. What the modes do to lips and nostrils is mended as a form is.
    """
    areas = np.linalg.norm(cross_products(x, head.faces), axis=1)
    counts: FloatArray = np.bincount(head.faces.ravel(), np.repeat(areas, 3)).astype(np.float64)
    is_shown = (x[:, 2] > SHOWN[0]) & (x[:, 1] > SHOWN[1])
    counts *= np.where(is_shown, 1.0, 0.1)
    head_alone = np.flatnonzero(x[:, 1] > SHOWN[1])
    along = np.zeros((1, *x.shape))
    along[:, head_alone, 1] = 1.0
    rim = np.r_[head.rings["rim_left"], head.rings["rim_right"]]
    along = spread(head, x, along, np.concatenate([head_alone, rim]))[0, :, 1:2]
    fields = fields - along * _motions(x, fields, counts * is_shown)
    seen = (fields * np.sqrt(counts)[:, None]).reshape(len(fields), -1)
    turn = np.linalg.svd(seen, full_matrices=False)[0][:, :MODES]
    shipped = replace(head, vertices=x)
    modes = [
        _soft(head, x, settled(shipped, x + mode) - x) for mode in np.tensordot(turn.T, fields, 1)
    ]
    return np.array(modes), turn.T @ weights


def _motions(x: FloatArray, fields: FloatArray, counts: FloatArray) -> FloatArray:
    """How each field (k, V, 3) moves the head as a whole: the nearest shift and small turn."""
    units = np.eye(3)
    turns = [np.cross(axis, x - np.average(x, axis=0, weights=counts)) for axis in units]
    ways = np.array([*(np.broadcast_to(axis, x.shape) for axis in units), *turns])
    weighed = np.einsum("avi,v->avi", ways, counts)
    system = np.einsum("avi,bvi->ab", weighed, ways)
    shares = np.linalg.solve(system, np.einsum("avi,kvi->ak", weighed, fields))
    return np.asarray(np.einsum("ak,avi->kvi", shares, ways))


def _soft(head: Head, x: FloatArray, mode: FloatArray) -> FloatArray:
    """A mode in which lips go with their edges, and nostrils keep their make."""
    moved = mode.copy()
    for side in ("left", "right"):
        edge = head.rings[f"mouth_2_{side}"]
        for row, share in ((3, 0.6), (4, 0.35), (5, 0.15)):
            ring = head.rings[f"mouth_{row}_{side}"]
            moved[ring] += share * (mode[edge] - mode[ring])
        ring, roof = head.rings[f"nostril_{side}"], head.anatomy[f"nostril_roof_{side}"]
        nostril = np.concatenate([ring, sorted(neighbours(head.faces)[roof]), [roof]])
        off = x[nostril] - x[ring].mean(axis=0)
        near, still = off[: len(ring)], mode[ring] - mode[ring].mean(axis=0)
        bend = np.linalg.solve(near.T @ near + STIFF * np.eye(3), near.T @ still)
        moved[nostril] = mode[ring].mean(axis=0) + off @ bend
    return np.asarray(0.5 * (moved + moved[head.mirror] * MIRROR))


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
    known = np.concatenate([lying, rim, *edges])
    fields = spread(head, x, fields, known)
    for side in ("left", "right"):  # ears go as a whole, lest they cut into the head
        rows = [head.rings[f"{row}_{side}"] for row in (*(f"ear_{k}" for k in range(5)), "concha")]
        ear = np.unique(np.concatenate(rows))
        fields[:, ear] = fields[:, rows[0]].mean(axis=1, keepdims=True)
        known = np.union1d(known, ear)
    return spread(head, x, fields, known)


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
    beside, middle = neighbours(head.faces), x[ring].mean(axis=0)
    cap = sorted(beside[roof])
    for vertex in cap:
        edge = x[sorted(beside[vertex] & set(ring.tolist()))].mean(axis=0)
        x[vertex] = middle + WALL[0] * NOSTRIL_ROOF + WALL[1] * (edge - middle)
    x[roof] = middle + NOSTRIL_ROOF
    changed = np.unique(np.concatenate([*mouth, inside, cap, [roof]]))
    x[head.mirror[changed]] = x[changed] * MIRROR
    return x


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
    """Vertices of a finer mesh, nearer to the coarse triangles where it would cut itself.

    So at levels 1 and 2, and where a triangle would be turned over. As they are written: new
    vertices in single precision.
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
        ] + [level.faces[turned_over(head, level, x, at)] for level in levels]
        bad = np.unique(np.concatenate([faces.ravel() for faces in cutting]))
        if not len(bad):
            break
        bad = np.union1d(bad, images[bad])
        share[bad] = np.where(share[bad] > LEAST_SHARE, 0.5 * share[bad], 0.0)
    return at


def turned_over(head: Head, fine: FineMesh, x: FloatArray, at: FloatArray) -> IndexArray:
    """Numbers of a finer mesh's triangles that look another way than the coarse one there."""
    own = cross_products(at[: len(fine.vertices)], fine.faces)
    parent = np.repeat(cross_products(x, head.faces), len(fine.faces) // len(head.faces), axis=0)
    lengths = np.linalg.norm(own, axis=1) * np.linalg.norm(parent, axis=1)
    return np.flatnonzero((own * parent).sum(axis=1) < LEAST_COSINE * lengths).astype(np.int32)


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
    modes = {"modes": form.modes.astype(np.float16), "weights": form.weights}
    _write(folder / "head_modes.npz", {**modes, "made_from": made_from})
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
