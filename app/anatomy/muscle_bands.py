"""Muscles as an atlas draws them: bands that lie between skin and bone, and bulge as they shorten.

The fibres of the simulation say where linear muscles run now. Sphincters are rings between the edge
of lids or lips and an ellipse around them, both carried by the skin. Temporal muscle and masseter
belong to no control of the face; they run from bone to bone. Each band has an elliptic cross
section, laid under the skin that is there now, thicker the shorter the fibre: its volume stays.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy

from . import muscle_forms as shape
from .near_skin import Floats, Numbers, Skin

ROWS, AROUND = 22, 16  # places along a band, and around its cross section
EYES = 90.0  # [mm] from one outer corner of the eyes to the other, for which muscle_forms.py holds
SPARE = 1.0  # [mm] of skin over a muscle, at least
# sRGB
RELAXED, CONTRACTED = np.array([0.68, 0.29, 0.245]), np.array([0.50, 0.035, 0.045])
TENDON = np.array([0.93, 0.87, 0.77])


class _Bound(NamedTuple):
    """Places that vertices carry: of vertex (n, k) by weight (n, k), off them by shift (n, 3)."""

    vertex: npt.NDArray[np.int64]
    weight: Floats
    shift: Floats

    def at(self, x: Floats) -> Floats:
        carried: Floats = np.einsum("nk,nkc->nc", self.weight, x[self.vertex]) + self.shift
        return carried


@dataclass(eq=False)
class Muscles:
    """All bands of a face as one part that changes its shape (see render/parts.py).

    striation: place across and along of each vertex, (n, 2) [mm at rest]: where its striation is.
    """

    vertices: npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    colours: npt.NDArray[np.float32]
    faces: npt.NDArray[np.int32]
    striation: npt.NDArray[np.float32]
    name: str = "muscles"
    bone: str = "neck"  # stands still: vertices are where they are
    shine: float = 0.42
    is_enclosed: bool = False
    strand_radius: float = 0.0

    @classmethod
    def of(cls, scene: Any) -> Muscles:
        """The muscles of a face, as they are now."""
        none = np.zeros((0, 3), np.float32)
        made = cls(none, none, none, none.astype(np.int32), none[:, :2])
        simulation = scene.simulation
        if any(scene.values.values()) or not np.array_equal(scene.positions, scene.rest_positions):
            simulation = simulation.clone()  # lengths and ends are those at rest
            simulation.reset()
        rest = SimpleNamespace(
            positions=scene.rest_positions,
            faces=scene.faces,
            simulation=simulation,
            bone_transforms=simulation.bone_transforms,
        )
        made._build(scene)
        made.follow(rest)
        made.follow(scene)
        return made

    def _build(self, scene: Any) -> None:
        head = scene.head
        marks, pivots = scene.rest_positions[head.landmarks], scene.simulation.pivots()
        self.scale = scale = float(np.linalg.norm(marks[45] - marks[36])) / EYES
        self._bone_depth = np.asarray(head.bone_depth)
        self._middle = np.array([marks[27:31, 0].mean(), *pivots["mandible"][1:]])
        self.names: list[tuple[str, int]] = []
        forms: list[shape.Linear] = []
        for name, lines in scene.simulation.fibres().items():
            form = shape.LINEAR.get(name.removesuffix("_left").removesuffix("_right"))
            for number in range(len(lines)):
                if form and (form.fibres is None or number in form.fibres):
                    self.names.append((name, number))
                    forms.append(form)
        self._rigid: list[tuple[Floats, tuple[str, str], str]] = []
        lowest = scene.rest_positions[:, 1].min() - 4.0 * scale
        for each in shape.RIGID:
            for side in (-1.0, 1.0):
                ends = self._middle + scale * np.array([each.origin, each.insertion]) * (side, 1, 1)
                if each.bones[1] == "neck":
                    ends[1, 1] = lowest  # necks are short or long
                control = f"{each.control}_{'left' if side > 0 else 'right'}"
                self._rigid.append((ends, each.bones, control))
                forms.append(each.form)
        self._forms = forms
        self._rings = self._bind_rings(scene, marks)
        self._rest: tuple[Floats, Floats] | None = None
        self._ends: _Bound | None = None

    def _bind_rings(self, scene: Any, marks: Floats) -> list[tuple[list[str], Any, _Bound, _Bound]]:
        """Each sphincter: its controls, its bands, inner and outer edge."""
        numbers = np.asarray(scene.head.landmarks)
        names = list(scene.simulation.sums)
        rings: list[tuple[list[str], Any, _Bound, _Bound]] = []
        pivots = scene.simulation.pivots()
        for eye in (at for name, at in pivots.items() if name.startswith("eye")):
            side = float(np.sign(eye[0] - self._middle[0]))
            inner = _along_marks(numbers, *shape.EYE_LIDS[side])
            centre = np.append(eye[:2], marks[36:48, 2].mean())
            outer = self._ellipse(scene, centre, shape.EYE_REACH, side)
            word = "left" if side > 0 else "right"
            own = [n for n in names if n.startswith("orbicularis_oculi_") and n.endswith(word)]
            rings.append((own, shape.EYE_BANDS, inner, outer))
        lips = _along_marks(numbers, shape.UPPER_LIP, shape.LOWER_LIP)
        edge = _along_marks(numbers, shape.UPPER_INNER, shape.LOWER_INNER)
        inner = _Bound(
            np.hstack([lips.vertex, edge.vertex]),
            np.hstack([0.1 * lips.weight, 0.9 * edge.weight]),
            lips.shift,
        )
        outer = self._ellipse(scene, marks[[48, 54, 51, 57]].mean(axis=0), shape.MOUTH_REACH, -1.0)
        own = [n for n in names if n.startswith(("orbicularis_oris_", "incisivus_"))]
        rings.append((own, shape.MOUTH_BANDS, inner, outer))
        return rings

    def _ellipse(self, scene: Any, centre: Floats, reach: Any, side: float) -> _Bound:
        """Places on the skin around a point, from its `side` over its top, carried by the skin."""
        x = scene.rest_positions
        angle = 2.0 * np.pi * np.arange(2 * ROWS) / (2 * ROWS)
        aside, up = np.cos(angle), np.sin(angle)
        across = np.where(aside > 0.0, reach[0], reach[1]) * aside * side
        height = np.where(up > 0.0, reach[2], reach[3]) * up
        points = centre + self.scale * np.stack([across, height, 0.0 * up], axis=1)
        skin = Skin(x, scene.faces, self._bone_depth, self._middle)
        for _ in range(4):
            outside, normal, _ = skin.at(points, skin.near(points))
            points = points - outside[:, None] * normal
        return _bound(points, x)

    def follow(self, scene: Any) -> None:
        """Take the shape and the colours of now."""
        sums = scene.simulation.sums
        found, bones = scene.simulation.fibres(), scene.bone_transforms()
        middle = bones["cranium"][:3, :3] @ self._middle + bones["cranium"][:3, 3]
        skin = Skin(scene.positions, scene.faces, self._bone_depth, middle)
        fibres = np.array([found[name][number] for name, number in self.names])
        short = np.linalg.norm(np.diff(fibres, axis=1), axis=2).sum(axis=1)
        lines = list(self._held(_resampled(fibres), skin))
        share = np.linspace(0.0, 1.0, ROWS)[:, None]
        for ends, names, _ in self._rigid:
            first, last = (
                bones[n][:3, :3] @ p + bones[n][:3, 3] for n, p in zip(names, ends, strict=True)
            )
            lines.append(first + share * (last - first))
        controls = [name for name, _ in self.names] + [name for *_, name in self._rigid]
        active = [sums.get(name, 0.0) for name in controls]
        groups = [self._open(np.array(lines), short, skin), self._closed(skin)]
        for own, bands, _, _ in self._rings:
            active += [max((sums.get(n, 0.0) for n in own), default=0.0)] * len(bands)
        if self._rest is None:
            self._rest = groups[0][1], groups[1][1]
            self._lay_out(groups)
        vertices, normals, colours = [], [], []
        for (sweep, lengths, tendon), rest, is_closed in zip(
            groups, self._rest, (False, True), strict=True
        ):
            grid, light = sweep(np.clip(rest / lengths, 0.75, 2.2))
            vertices.append(grid.reshape(-1, 3))
            normals.append(_grid_normals(grid, is_closed).reshape(-1, 3))
            own = np.clip(active[: len(grid)], 0.0, 1.0)[:, None, None, None]
            del active[: len(grid)]
            red = RELAXED + own * (CONTRACTED - RELAXED)
            colour = red + tendon[:, :, None, None] * (TENDON - red)
            colours.append((colour * light[None, None, :, None]).reshape(-1, 3))
        self.normals = np.concatenate(normals).astype(np.float32)
        self.colours = np.concatenate(colours).astype(np.float32)
        self.vertices = np.concatenate(vertices).astype(np.float32)

    def _held(self, lines: Floats, skin: Skin) -> Floats:
        """Fibres whose ends stay where they are in the skin, both where no bone holds the first."""
        ends = lines[:, [0, -1]].reshape(-1, 3)
        if self._ends is None:
            self._ends = _bound(ends, skin.x)
        off = (self._ends.at(skin.x) - ends).reshape(-1, 2, 1, 3)
        off[:, 0] *= np.array([f.origin is not None for f in self._forms[: len(lines)]])[
            :, None, None
        ]
        share = np.linspace(0.0, 1.0, ROWS)[:, None]
        held: Floats = lines + off[:, 0] * (1.0 - share) + off[:, 1] * share
        return held

    def _open(self, lines: Floats, short: Floats, skin: Skin) -> Any:
        forms, scale = self._forms, self.scale
        u = np.linspace(0.0, 1.0, ROWS)
        widths = np.array([np.interp(u, (0.0, 0.5, 1.0), f.width) for f in forms]) * scale
        # Round ends, and a belly in the middle.
        end = np.sqrt(np.clip(1.0 - (2.0 * u - 1.0) ** 8, 0.0, 1.0))
        belly = 0.45 + 0.55 * np.sin(np.pi * u) ** 0.8
        thick = np.array([f.thickness for f in forms])[:, None] * belly * scale
        tendon = np.array(
            [
                np.clip(1.4 - u / max(f.tendon[0], 1e-3), 0, 1)
                + np.clip(1.4 - (1.0 - u) / max(f.tendon[1], 1e-3), 0, 1)
                for f in forms
            ]
        )
        # A belly is as short as the fibre; where skin holds its end back, the tendon gives.
        lengths = np.linalg.norm(np.diff(lines, axis=1), axis=2).sum(axis=1)
        lengths[: len(short)] = short
        for _ in range(2):
            near = skin.near(lines)
            outside, normal, bone = skin.at(lines, near)
            lines = lines - outside[:, :, None] * normal
        side = np.cross(np.gradient(lines, axis=1), normal)
        side /= np.maximum(np.linalg.norm(side, axis=2, keepdims=True), 1e-9)
        origin = np.array([np.nan if f.origin is None else f.origin for f in forms]) * scale
        origin = np.where(np.isnan(origin), bone[:, 0] - 0.5 * thick[:, 0], origin)
        insertion = np.array([f.depth for f in forms]) * scale
        depth = origin[:, None] + (insertion - origin)[:, None] * (u * u * (3.0 - 2.0 * u)) ** 0.8

        def sweep(bulging: Floats) -> tuple[Floats, Floats]:
            swollen = 1.0 + (bulging[:, None] - 1.0) * np.sin(np.pi * u)
            half = 0.5 * widths * swollen**0.35 * end
            thickness = 0.5 * thick * swollen**0.65 * end
            return self._swept(lines, side * half[:, :, None], thickness, depth, skin, near)

        return sweep, lengths, np.clip(tendon, 0.0, 1.0) * 0.92

    def _closed(self, skin: Skin) -> Any:
        middles, halves, thick, depth = [], [], [], []
        for _, bands, inner, outer in self._rings:
            first, last = inner.at(skin.x), outer.at(skin.x)
            for low, high, thickness, deep in bands:
                middles.append(first + 0.5 * (low + high) * (last - first))
                halves.append(0.5 * (high - low) * (last - first))
                thick.append(thickness * self.scale)
                depth.append(deep * self.scale)
        lines, half = np.array(middles), np.array(halves)
        lengths = np.linalg.norm(lines - np.roll(lines, 1, axis=1), axis=2).sum(axis=1)
        near = skin.near(lines)
        along = np.roll(lines, -1, axis=1) - np.roll(lines, 1, axis=1)
        side = np.cross(along, skin.at(lines, near)[1])
        half *= np.sign((half * side).sum(axis=(1, 2)))[:, None, None]
        rows = np.ones(lines.shape[:2])

        def sweep(bulging: Floats) -> tuple[Floats, Floats]:
            swollen = 0.5 * np.array(thick)[:, None] * bulging[:, None] * rows
            return self._swept(lines, half, swollen, np.array(depth)[:, None] * rows, skin, near)

        return sweep, lengths, 0.0 * rows

    def _swept(
        self, lines: Floats, half: Floats, thick: Floats, depth: Floats, skin: Skin, near: Numbers
    ) -> tuple[Floats, Floats]:
        """Cross sections along lines (b, rows, 3), and how light is around each, (AROUND,)."""
        rails = np.stack([lines - half, lines, lines + half])
        for _ in range(2):
            outside, normal, bone = skin.at(rails, near)
            deep = np.minimum(depth, np.maximum(bone - thick, 0.0))
            deep = np.maximum(deep, thick + SPARE * self.scale)
            rails = rails - (outside + deep)[..., None] * normal
        angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
        a = np.cos(angle)
        blend = np.stack([0.5 * a * (a - 1.0), 1.0 - a * a, 0.5 * a * (a + 1.0)])
        raised = np.tensordot(normal, blend, (0, 0)) * thick[:, :, None, None] * np.sin(angle)
        grid = (np.tensordot(rails, blend, (0, 0)) + raised).swapaxes(2, 3)
        return grid, 0.42 + 0.58 * np.clip(0.5 + 0.75 * np.sin(angle), 0.0, 1.0)

    def _lay_out(self, groups: Any) -> None:
        """Faces and places of striation, which never change."""
        faces, fibres, first = [], [], 0
        a = np.cos(2.0 * np.pi * np.arange(AROUND) / AROUND)
        for (sweep, lengths, _), is_closed in zip(groups, (False, True), strict=True):
            grid, _ = sweep(np.ones(len(lengths)))
            count, rows = grid.shape[:2]
            number = first + np.arange(count * rows * AROUND).reshape(count, rows, AROUND)
            first += number.size
            ahead = np.roll(number, -1, axis=1) if is_closed else number[:, 1:]
            here = number if is_closed else number[:, :-1]
            quads = [here, ahead, np.roll(ahead, -1, axis=2), np.roll(here, -1, axis=2)]
            faces += [
                np.stack([quads[k] for k in ks], -1).reshape(-1, 3) for ks in ((0, 1, 2), (0, 2, 3))
            ]
            wide = 0.5 * np.linalg.norm(grid[:, :, 0] - grid[:, :, AROUND // 2], axis=2)
            wide = np.broadcast_to(wide.mean(axis=1)[:, None, None] * a, number.shape)
            along = np.broadcast_to(
                lengths[:, None, None] * np.linspace(0, 1, rows)[:, None], number.shape
            )
            offset = 40.0 * np.arange(count)[:, None, None]
            fibres.append(np.stack([wide + offset, along], axis=-1).reshape(-1, 2))
        self.faces = np.concatenate(faces).astype(np.int32)
        self.striation = (np.concatenate(fibres) / self.scale).astype(np.float32)


def _bound(points: Floats, x: Floats) -> _Bound:
    """Places (n, 3) carried by the vertices near them."""
    distance, vertex = scipy.spatial.cKDTree(x).query(points, k=5)
    weight = 1.0 / (distance + distance.mean()) ** 2
    weight /= weight.sum(axis=1, keepdims=True)
    carried = _Bound(vertex, weight, np.zeros_like(points))
    return carried._replace(shift=points - carried.at(x))


def _along_marks(numbers: Any, upper: Any, lower: Any) -> _Bound:
    """Places along a closed row of landmarks, as many over the upper as over the lower half."""
    vertex, weight = [], []
    for row in (upper, lower):
        at = np.linspace(0.0, len(row) - 1.0, ROWS, endpoint=False)
        low = np.minimum(at.astype(int), len(row) - 2)
        row_numbers = numbers[list(row)]
        vertex.append(np.stack([row_numbers[low], row_numbers[low + 1]], axis=1))
        weight.append(np.stack([1.0 - (at - low), at - low], axis=1))
    return _Bound(np.vstack(vertex), np.vstack(weight), np.zeros((2 * ROWS, 3)))


def _resampled(lines: Floats) -> Floats:
    """ROWS points along each polyline (b, n, 3), rounded where it bends."""
    at = np.linspace(0.0, lines.shape[1] - 1.0, ROWS)
    low = np.minimum(at.astype(int), lines.shape[1] - 2)
    share = (at - low)[:, None]
    points: Floats = lines[:, low] * (1.0 - share) + lines[:, low + 1] * share
    for _ in range(3):
        points[:, 1:-1] = 0.25 * points[:, :-2] + 0.5 * points[:, 1:-1] + 0.25 * points[:, 2:]
    return points


def _grid_normals(grid: Floats, is_closed: bool) -> Floats:
    """Unit normals of swept cross sections (b, rows, AROUND, 3)."""
    if is_closed:
        along = np.roll(grid, -1, axis=1) - np.roll(grid, 1, axis=1)
    else:
        along = np.gradient(grid, axis=1)
    normals = np.cross(along, np.roll(grid, -1, axis=2) - np.roll(grid, 1, axis=2))
    if not is_closed:  # the ends are points
        normals[:, 0], normals[:, -1] = normals[:, 1], normals[:, -2]
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    unit: Floats = normals / np.maximum(length, 1e-12)
    return unit
