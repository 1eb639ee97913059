"""A solid skull for a head, made of what the head knows of it: depth to the bone, eyes, jaw.

It is a proxy. The skin, moved inward by the tissue's depth, is the outer form; sockets, nose
opening, temporal hollows, cheekbone's arch and the outline of the mandible are put in by measures
of an adult skull, scaled by the distance of the eyes' outer corners and placed by landmarks. All is
one signed field on a grid, whose zero is meshed.
Source: Kolluri 2008, "Provably good moving least squares" (the form through points with normals);
Gibson 1998, "Constrained elastic surface nets" (the mesh of a field's zero). Measures: chosen.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.normals import vertex_normals

from .model import Part
from .smooth import smooth_maximum, smooth_minimum

Floats = npt.NDArray[np.float64]
Field = npt.NDArray[np.float32]  # half as wide: what is done to grids is as quick as memory
CELL, COARSE = 1.9, 3  # [mm] of a head of EYES, and how many of them the outer form is known at
EYES = 90.0  # [mm] from one outer corner to the other, for which all measures hold
NEIGHBOURS = 14  # points that say where the bone is
NAMES = "cranium", "mandible", "spine", "nose"
TOP, VERTEBRA = -32.0, 17.0  # [mm] the atlas below the condyles of the jaw; from one to the next
BONE, HOLLOW = np.array([0.90, 0.85, 0.735]), np.array([0.34, 0.235, 0.165])
CARTILAGE, SHADED = np.array([0.80, 0.82, 0.80]), np.array([0.50, 0.42, 0.40])
# Side views (z, y) [mm], from the middle of the condyles: outlines of what is cut from the form.
MANDIBLE = (
    (-7, 4), (-9, -12), (-5, -40), (2, -62), (10, -72), (30, -81), (52, -92), (96, -104), (92, -73),
    (74, -70), (46, -66), (33, -50), (27, -28), (23, -9), (17, -12), (9, -15), (5, -4), (3, 4),
)  # fmt: skip
BASE = (
    (-130, 140), (-130, -16), (-72, -22), (-24, -14), (-18, -27), (-10, -27), (-4, -8), (8, -7),
    (30, -30), (36, -45), (88, -46), (120, -30), (130, 140),
)  # fmt: skip
ARCH = (
    (-8, 2),
    (-4, 10),
    (14, 9),
    (34, 8),
    (52, 16),
    (60, 2),
    (56, -18),
    (44, -14),
    (30, -1),
    (4, 0),
)


class _Field(NamedTuple):
    """Where a head's bone is looked for: a grid [mm of EYES off the condyles' middle]."""

    low: Floats
    places: Field  # (3, nx, ny, nz)
    outside: Field  # distance from the skin moved inward, negative within


def build_skull(
    head: Any, pivots: Mapping[str, Floats], names: Collection[str] = NAMES
) -> dict[str, Part]:
    """Cranium, mandible, and the nose's cartilage at rest, as parts that move with their bones.

    head: with vertices, faces, landmarks, bone_depth and parts. pivots: what "mandible" and the
        eyes turn about, by the names of bones, each (3,). names: which are wanted, of NAMES; the
        nose alone takes a tenth of the time.
    """
    origin, scale = origin_and_scale(head, pivots)
    placed = {name: ((at - origin) / scale).astype(np.float32) for name, at in pivots.items()}
    marks = ((head.vertices[head.landmarks] - origin) / scale).astype(np.float32)
    eyes = [at for name, at in placed.items() if name.startswith("eye")]
    carve = {"cranium": _cranium, "mandible": _mandible, "nose": _nose, "spine": _spine}
    fields: dict[bool, _Field] = {}
    parts: dict[str, Part] = {}
    for name in names:
        is_nose = name == "nose"
        if name == "spine":
            field = _neck_form(float(head.vertices[:, 1].min() - origin[1]) / scale)
        else:
            if is_nose not in fields:
                fields[is_nose] = _outer_form(head, origin, scale, marks, eyes, is_nose=is_nose)
            field = fields[is_nose]
        shape = carve[name](field, marks, eyes)
        for part in head.parts:  # bone holds the teeth as gums do
            if part.name.startswith("gums") and part.bone == name:
                shape = smooth_minimum(shape, _around(field, (part.vertices - origin) / scale), 3.0)
        shape = scipy.ndimage.gaussian_filter(shape, 0.55)
        points, faces = _mesh(shape)
        normals = _sampled(np.gradient(shape), points)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        open_ = np.zeros(len(points))
        for reach in (2.0, 4.0, 7.0):  # [cells]
            open_ += np.clip(
                _sampled([shape], points + reach * normals)[:, 0] / (reach * CELL), 0, 1
            )
        bright, dark = (CARTILAGE, SHADED) if is_nose else (BONE, HOLLOW)
        light = np.clip(open_ / 3.0, 0.0, 1.0)[:, None] ** 1.3
        parts[name] = Part(
            f"skull_{name}",
            (origin + scale * (field.low + CELL * points)).astype(np.float32),
            normals.astype(np.float32),
            faces,
            (dark + light * (bright - dark)).astype(np.float32),
            {"nose": "cranium", "spine": "neck"}.get(name, name),
            0.28,
        )
    return parts


def origin_and_scale(head: Any, pivots: Mapping[str, Floats]) -> tuple[Floats, float]:
    """The middle of the jaw's condyles, (3,), and how large a head is, 1 where EYES holds."""
    marks = head.vertices[head.landmarks]
    scale = float(np.linalg.norm(marks[45] - marks[36])) / EYES
    return np.array([marks[27:31, 0].mean(), *pivots["mandible"][1:]]), scale


def _outer_form(
    head: Any, origin: Floats, scale: float, marks: Field, eyes: list[Field], *, is_nose: bool
) -> _Field:
    """The skin moved inward, without ears, lids, lips and nose, as a field; or the nose alone."""
    x, faces = (head.vertices - origin) / scale, head.faces
    normals = vertex_normals(x, faces)
    across = np.abs(x[:, 0])
    is_bone = (
        (np.stack([across - 76.0, x[:, 1] - 8.0, x[:, 2] + 30.0], 1) / (27, 44, 37)) ** 2
    ).sum(1) > 1
    for eye in eyes:
        off = (x - eye)[:, :2]
        is_bone &= (np.hypot(*(off / (17.0, 12.0)).T) > 1.0) | (x[:, 2] < eye[2] - 20.0)
    mouth = marks[[48, 54, 51, 57]].mean(axis=0)
    is_bone &= np.linalg.norm((x - mouth) / (33.0, 15.0, 40.0), axis=1) > 1.0
    is_bone &= ~(
        (across < 19.0)
        & (x[:, 1] > marks[33, 1] - 3.0)
        & (x[:, 1] < marks[28, 1] - 2.0)
        & (x[:, 2] > 60.0)
    )
    step = CELL * COARSE
    low = np.array([-13.0 * step, marks[8, 1] - 14.0, x[is_bone, 2].min() - 4.0])
    high = np.array([12.9 * step, x[:, 1].max() + 4.0, marks[30, 2] + 2.0])
    is_used, depth, least = is_bone, head.bone_depth[:, None] / scale, 7.0
    if is_nose:
        away = x - (0.0, marks[30, 1], eyes[0][2])
        is_used = (across < 30.0) & (np.abs(x[:, 1] - marks[29, 1]) < 45.0) & (x[:, 2] > 50.0)
        is_used &= (normals * away).sum(axis=1) > 0.3 * np.linalg.norm(away, axis=1)
        depth, least = 3.0, 3.5
        first = np.array([-32.0, marks[33, 1] - 14.0, 48.0])
        low += step * np.floor((first - low) / step)  # a part of the same grid
        high[:2] = 32.0, marks[28, 1] + 14.0
    counts = np.ceil((high - low) / step).astype(int) + 1
    fine = [np.arange(COARSE * (n - 1) + 1) / COARSE for n in counts]
    coarse = np.meshgrid(*(np.arange(n) for n in counts), indexing="ij")
    at = (low + step * np.stack(coarse, axis=-1)).reshape(-1, 3)
    # The form through points below the skin.
    points = (x - depth * normals)[is_used]
    distance, near = scipy.spatial.cKDTree(points).query(at, k=NEIGHBOURS, workers=-1)
    weight = np.exp(-((distance / np.maximum(0.6 * distance[:, -1:], least)) ** 2)) + 1e-12
    off = ((at[:, None] - points[near]) * normals[is_used][near]).sum(axis=2)
    known = ((weight * off).sum(axis=1) / weight.sum(axis=1)).reshape(counts)
    finer = [
        scipy.interpolate.CubicSpline(np.arange(n), np.eye(n))(at)
        for n, at in zip(counts, fine, strict=True)
    ]
    form = np.einsum("ai,bj,ck,ijk->abc", *finer, known, optimize=True)
    axes = [
        (lowest + step * each).astype(np.float32) for lowest, each in zip(low, fine, strict=True)
    ]
    return _Field(low, np.stack(np.meshgrid(*axes, indexing="ij")), form.astype(np.float32))


def _neck_form(lowest: float) -> _Field:
    """A grid for the spine, down to the end of the neck."""
    low, high = np.array([-23.0 * CELL, lowest, -66.0]), np.array([23.5 * CELL, -18.0, 12.0])
    axes = [np.arange(a, b, CELL, dtype=np.float32) for a, b in zip(low, high, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"))
    return _Field(low, places, places[1] - np.float32(lowest) - 1.0)


def _spine(field: _Field, marks: Field, eyes: list[Field]) -> Field:
    """Vertebrae from the skull's condyles to where the neck ends."""
    x, y, z = field.places
    across, down = np.abs(x), (TOP - y) / 120.0
    z = z - (22.0 * down * (0.64 - down) - 14.0)  # off the line of the bodies
    number = np.round((TOP - y) / VERTEBRA)
    v = y - TOP + VERTEBRA * number
    is_atlas = number < 0.5

    def lump(aside: Any, up: float, front: float, radii: Any) -> Field:
        """Distance from an ellipsoid in each vertebra, about."""
        a, b, c = radii
        off = np.sqrt(((across - aside) / a) ** 2 + ((v - up) / b) ** 2 + ((z - front) / c) ** 2)
        return np.asarray((off - 1.0) * b, np.float32)

    waist = 1.1 * np.cos(2.0 * np.pi * v / VERTEBRA) - 1.6 * np.exp(
        -(((np.abs(v) - 8.5) / 1.6) ** 2)
    )
    body = (np.hypot(x / 12.5, z / 9.5) - 1.0) * 10.0 + waist
    wing = lump(
        np.where(is_atlas, 24.0, 17.0), 0.0, -5.0, (np.where(is_atlas, 14.0, 9.5), 5.5, 7.0)
    )
    arch = lump(0.0, -1.0, -14.0, (17.0, 5.5, 9.0))
    thorn = lump(0.0, -4.0, -29.0, (3.6, 4.6, np.where(is_atlas, 6.0, 14.0)))
    form = smooth_minimum(smooth_minimum(body, wing, 4.0), smooth_minimum(arch, thorn, 4.0), 4.0)
    ends = np.maximum(y - TOP - 6.0, -field.outside)
    return np.asarray(np.maximum(form, ends), np.float32)


def _nose(field: _Field, marks: Field, eyes: list[Field]) -> Field:
    """Cartilage from the nasal bones to the wings of the nose."""
    x, y, z = field.places
    wide = 6.0 + 11.0 * np.clip((marks[28, 1] - y) / (marks[28, 1] - marks[33, 1]), 0.0, 1.0)
    box = np.maximum.reduce([np.abs(x) - wide, y - marks[28, 1], marks[33, 1] + 1.0 - y, 62.0 - z])
    return smooth_maximum(field.outside, box, 5.0)


def _cranium(field: _Field, marks: Field, eyes: list[Field]) -> Field:
    x, y, z = field.places
    across = np.abs(x)
    # Ears leave a gap in the form, which is wide there; behind it the mastoid.
    form = smooth_maximum(field.outside, across - 61.0 - 0.35 * np.maximum(y - 12.0, 0.0), 8.0)
    mastoid = (
        np.sqrt(((across - 47) / 10) ** 2 + ((y + 14) / 18) ** 2 + ((z + 20) / 12) ** 2) - 1
    ) * 11
    form = smooth_minimum(form, mastoid, 6.0)
    # The hollow for the temporal muscle, deepest behind the eye, and the arch that spans it.
    fossa = np.exp(-(((z - 26.0) / 24.0) ** 2) - ((y - 26.0) / 26.0) ** 2) * (across > 25.0)
    solid = np.maximum(form + 9.5 * fossa, np.minimum(_polygon(z, y, BASE), mastoid))
    below = _polygon(
        z, y, ((2, -90), (2, 2), (20, 6), (34, 4), (40, -10), (46, -34), (40, -60), (36, -90))
    )
    solid = _without(solid, np.maximum(below, 41.0 - across), 4.0)
    arch = np.maximum(np.maximum(form - 0.5, -6.5 - form), _polygon(z, y, ARCH))
    solid = smooth_minimum(solid, arch, 4.0)
    for eye in eyes:
        side = np.sign(eye[0])
        back = eye[2] + 12.0 - z  # behind the rim
        u = side * (x - eye[0]) - 1.0 + 0.30 * np.maximum(back, 0.0)
        v = y - eye[1] - 1.0 + 0.10 * u
        narrow = 1.0 - 0.0165 * np.clip(back, 0.0, 50.0)
        socket = ((np.abs(u) / (19.5 * narrow)) ** 2.7 + (np.abs(v) / (17.0 * narrow)) ** 2.7) ** (
            1 / 2.7
        )
        solid = _without(solid, np.maximum((socket - 1.0) * 16.0, back - 46.0), 3.0)
    # The pear-shaped opening below the nasal bones.
    top, bottom = marks[29, 1] + 1.0, marks[33, 1] - 1.0
    share = np.clip((y - bottom) / (top - bottom), 0.0, 1.0)
    half = 3.5 + 9.0 * np.sqrt(np.clip(1.0 - share, 0, 1)) * np.clip(share * 6.0 + 0.5, 0, 1)
    opening = np.maximum.reduce([across - half, y - top, bottom - y, 58.0 - z])
    return _without(solid, opening, 2.5)


def _mandible(field: _Field, marks: Field, eyes: list[Field]) -> Field:
    x, y, z = field.places
    across = np.abs(x)
    form = field.outside
    shift = marks[8, 1] + 98.0
    body = _polygon(z, y - shift * np.clip(-y / 98.0, 0, 1), MANDIBLE)
    # Below the arch the form is as wide as the cheek: the ramus stands within.
    outer = smooth_maximum(form, across - 51.0 - 0.08 * (y + 40.0), 6.0)
    thick = 8.0 + 4.0 * np.clip((z - 10.0) / 40.0, 0.0, 1.0)
    return smooth_maximum(smooth_maximum(outer, -thick - outer, 3.0), body, 5.0)


def _around(field: _Field, points: Floats) -> Field:
    """Distance from a skin of 0.8 mm over points (n, 3); far from them, more than a few mm."""
    low = np.maximum((points.min(axis=0) - 5.0 - field.low) / CELL, 0).astype(int)
    high = ((points.max(axis=0) + 5.0 - field.low) / CELL).astype(int) + 1
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    result = np.full_like(field.outside, 20.0)
    places = np.moveaxis(field.places[(slice(None), *box)], 0, -1)
    result[box] = (
        scipy.spatial.cKDTree(points).query(places, distance_upper_bound=20.0, workers=-1)[0] - 0.8
    )
    near: Field = np.minimum(result, np.float32(20.0))
    return near


def _polygon(u: Field, v: Field, corners: Any) -> Field:
    """Signed distance from a polygon, negative within; as wide as u and v."""
    at, corners = np.stack([u[0], v[0]]), np.array(corners, float)
    nearest = np.full(at.shape[1:], np.inf)
    inside = np.zeros(at.shape[1:], bool)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        edge, off = b - a, at - a[:, None, None]
        share = np.clip(np.tensordot(edge, off, 1) / (edge @ edge), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(*(off - share * edge[:, None, None])))
        crosses = (a[1] > at[1]) != (b[1] > at[1])
        slope = (at[1] - a[1]) * edge[0] / (edge[1] or 1e-9) + a[0]
        inside ^= crosses & (at[0] < slope)
    signed = np.where(inside, -nearest, nearest).astype(u.dtype)
    return np.broadcast_to(signed, u.shape)


def _without(a: Field, b: Field, round_: float) -> Field:
    """The first solid less the second, with rounded edges."""
    return smooth_maximum(a, -b, round_)


def _sampled(fields: Any, points: Floats) -> Floats:
    """Fields at places [cells], shape (n, len(fields))."""
    return np.stack(
        [scipy.ndimage.map_coordinates(each, points.T, order=1, mode="nearest") for each in fields],
        axis=1,
    )


def _mesh(shape: Field) -> tuple[Floats, npt.NDArray[np.int32]]:
    """Points [cells] and outward triangles of a field's zero: one point in each cell it crosses."""
    shape = np.pad(shape, 1, constant_values=1.0)
    inside = shape < 0.0
    counts = tuple(n - 1 for n in shape.shape)
    total, hits = np.zeros((*counts, 3)), np.zeros(counts)
    crossings = []
    for axis in range(3):
        first = tuple(slice(None, -1) if k == axis else slice(None) for k in range(3))
        second = tuple(slice(1, None) if k == axis else slice(None) for k in range(3))
        crossed = np.argwhere(inside[first] != inside[second])
        a, b = shape[first][tuple(crossed.T)], shape[second][tuple(crossed.T)]
        place = crossed.astype(float)
        place[:, axis] += a / (a - b)
        others = [k for k in range(3) if k != axis]
        cells = []
        for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
            cell = crossed.copy()
            cell[:, others[0]] -= du
            cell[:, others[1]] -= dv
            cells.append(cell)
            np.add.at(total, tuple(cell.T), place)
            np.add.at(hits, tuple(cell.T), 1.0)
        turned = (a < 0.0) == (axis != 1)
        crossings.append((np.stack(cells, 1), turned))
    is_point = hits > 0
    number = np.full(counts, -1, np.int64)
    number[is_point] = np.arange(is_point.sum())
    faces = []
    for around, turned in crossings:
        quads = number[tuple(np.moveaxis(around, 2, 0))]
        quads[~turned] = quads[~turned][:, ::-1]
        faces += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    points = total[is_point] / hits[is_point][:, None] - 1.0
    return points, np.concatenate(faces).astype(np.int32)
