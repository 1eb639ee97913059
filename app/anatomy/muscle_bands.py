"""Muscles as bands along their fibres; they lie between skin and bone, and swell as they shorten.

The simulation's fibres give the present courses of linear muscles. The fibres of sphincters are
rows of landmarks around mouth and eyes, moved outward and carried by the skin. Each band has an
elliptic cross section and lies under the present skin: on the bone at its origin, and right below
the skin at its insertion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from risorius.geometry.sheets import NEAR, heights_over, sheet_of
from risorius.sim import Simulation

from ..scenes import Face

ROWS = 22  # places along a band
AROUND = 16  # places around its cross section
RELAXED = np.array([0.68, 0.29, 0.245])  # sRGB
CONTRACTED = np.array([0.50, 0.035, 0.045])  # sRGB
TENDON = np.array([0.93, 0.87, 0.77])
EYE = ((5.0, 9.0), (12.5, 9.0))
MOUTH = ((1.0, 8.0), (7.5, 8.0))
RINGS = (  # beginnings and ends of names; landmarks; bands: distance outward, width [mm]
    ("orbicularis_oculi", "right", (36, 37, 38, 39), EYE),
    ("orbicularis_oculi", "right", (36, 41, 40, 39), EYE),
    ("orbicularis_oculi", "left", (45, 44, 43, 42), EYE),
    ("orbicularis_oculi", "left", (45, 46, 47, 42), EYE),
    ("orbicularis_oris", "", (48, 49, 50, 51, 52, 53, 54), MOUTH),
    ("orbicularis_oris", "", (48, 59, 58, 57, 56, 55, 54), MOUTH),
)
AROUND_OF = {"right": range(36, 42), "left": range(42, 48), "": range(48, 60)}  # landmarks


@dataclass(eq=False)
class Muscles:
    """All bands of a face as one part that changes its shape (see render/parts.py).

    striation: place of each vertex across and along the fibres, (n, 2) [mm at rest].
    """

    vertices: Floats32
    normals: Floats32
    colours: Floats32
    faces: Integers32
    striation: Floats32
    name: str = "muscles"
    bone: str = "neck"  # stands still: vertices have their final places
    shine: float = 0.42
    is_enclosed: bool = False
    strand_radius: float = 0.0

    @classmethod
    def of(cls, face: Face) -> Muscles:
        """The muscles of a face in their present state."""
        none = np.zeros((0, 3), np.float32)
        made = cls(none, none, none, none.astype(np.int32), none[:, :2])
        made._build(face)
        made.follow(face)
        return made

    def _build(self, face: Face) -> None:
        """Set up everything constant: the bands, their lengths at rest, their faces."""
        simulation = face.simulation.clone()
        simulation.reset()
        self.names: list[tuple[str, int]] = []  # names of linear muscles, and numbers of fibres
        widths = list[float]()
        for name, lines in simulation.anatomy.fibres().items():
            stem = name.removesuffix("_left").removesuffix("_right")
            row = face.head.rig["muscle"].get(stem, {})
            if name.startswith("platysma"):  # it lies on structures without drawings
                continue
            for number, (fibre, _) in enumerate(zip(row.get("fibre", ()), lines, strict=False)):
                self.names.append((name, number))
                # Half of the rig's width is flesh. Bands are 4 to 17 mm wide.
                width = 0.5 * row.get("width", 10.0) * fibre.get("width_factor", 1.0)
                widths.append(np.clip(width, 4.0, 17.0))
        marks = face.rest_positions[face.head.landmarks]
        rings = list[Floats64]()
        self._controls: list[list[str]] = [[name] for name, _ in self.names]  # that move each band
        for start, end, numbers, bands in RINGS:
            edge = _resampled(marks[None, list(numbers)])[0]
            middle = marks[AROUND_OF[end]].mean(axis=0)
            away = unit_vectors((edge - middle) * (1.0, 1.0, 0.0))
            names = simulation.controls.sums
            own = [name for name in names if name.startswith(start) and name.endswith(end)]
            for outward, width in bands:
                rings.append(edge + outward * away)
                widths.append(width)
                self._controls.append(own)
        self._width = np.array(widths)[:, None]
        self._middle = np.array([marks[27, 0], *simulation.bones.pivots()["mandible"][1:]])
        self._bone_depth = np.asarray(face.simulated_head.bone_depth)
        self._bind(np.array(rings), face.simulation)
        self._length = _lengths(self._lines(simulation, face.simulation.rest_positions))
        self._lay_out()

    def _bind(self, rings: Floats64, simulation: Simulation) -> None:
        """Let the skin carry the sphincters (b, ROWS, 3)."""
        rest = simulation.rest_positions
        skin = _Skin(rest, simulation.faces, self._bone_depth, self._middle)
        for _ in range(4):
            outside, normal, _ = skin.at(rings)
            rings -= outside[..., None] * normal
        away, self._carriers = scipy.spatial.cKDTree(rest).query(rings, k=NEAR)
        self._share = 1.0 / (away + away.mean()) ** 2
        self._share /= self._share.sum(axis=-1, keepdims=True)
        self._shift = rings - np.einsum("brk,brkc->brc", self._share, rest[self._carriers])

    def _lines(self, simulation: Any, x: Floats64) -> Floats64:
        """The middles of all bands, (b, ROWS, 3), those of the sphincters last."""
        found = simulation.anatomy.fibres()
        fibres = _resampled(np.array([found[name][number] for name, number in self.names]))
        carried = np.einsum("brk,brkc->brc", self._share, x[self._carriers])
        return np.concatenate([fibres, carried + self._shift])

    def follow(self, face: Face) -> None:
        """Take the present shape and colours."""
        simulation = face.simulation
        sums = simulation.controls.sums
        bone = face.bone_transforms()["cranium"]
        middle = bone[:3, :3] @ self._middle + bone[:3, 3]
        skin = _Skin(simulation.positions, simulation.faces, self._bone_depth, middle)
        lines = self._lines(simulation, simulation.positions)
        swollen = np.clip(self._length / _lengths(lines), 0.75, 2.2)
        for _ in range(2):
            outside, normal, depth = skin.at(lines)
            lines = lines - outside[..., None] * normal
        u = np.linspace(0.0, 1.0, ROWS)
        arch = np.sin(np.pi * u)  # 1 in the middle
        end = np.sqrt(np.clip(1.0 - (2.0 * u - 1.0) ** 8, 0.0, 1.0))  # round
        swollen = 1.0 + (swollen[:, None] - 1.0) * arch
        half = 0.5 * self._width * swollen**0.35 * end
        # Measures [mm], chosen by eye after anatomical plates.
        most_thickness = 2.8
        plump = 0.45 + 0.55 * arch**0.8
        thick = 0.5 * most_thickness * plump * swollen**0.65 * end
        end_depth = 3.4  # below the skin, at the end of a band
        start_depth = depth[:, :1]
        deep = start_depth + (end_depth - start_depth) * u * u * (3.0 - 2.0 * u)
        deep[len(self.names) :] = end_depth  # sphincters do not begin on a bone
        side = unit_vectors(np.cross(np.gradient(lines, axis=1), normal))
        to_edge = half[..., None] * side
        rails = np.stack([lines - to_edge, lines, lines + to_edge])
        for _ in range(2):
            outside, normal, bone_depth = skin.at(rails)
            below = np.minimum(deep, np.maximum(bone_depth - thick, 0.0))
            below = np.maximum(below, thick + 1.0)  # [mm] of skin on top
            rails = rails - (outside + below)[..., None] * normal
        angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
        a = np.cos(angle)
        blend = np.stack([0.5 * a * (a - 1.0), 1.0 - a * a, 0.5 * a * (a + 1.0)])
        middle = np.tensordot(rails, blend, (0, 0))
        outward = np.tensordot(normal, blend, (0, 0))
        raised = outward * thick[:, :, None, None] * np.sin(angle)
        grid = (middle + raised).swapaxes(2, 3)
        active = [max((sums[name] for name in own), default=0.0) for own in self._controls]
        self._set(grid, np.array(active), u)

    def _set(self, grid: Floats64, active: Floats64, u: Floats64) -> None:
        """Set the shape to sections (b, ROWS, AROUND, 3) of bands with activations (b,)."""
        red = RELAXED + np.clip(active, 0.0, 1.0)[:, None] * (CONTRACTED - RELAXED)
        # This share of a band's length is tendon, at both ends.
        tendon = np.clip(1.4 - np.minimum(u, 1.0 - u) / 0.14, 0.0, 0.92)
        share = np.tile(tendon, (len(grid), 1))
        share[len(self.names) :] = 0.0
        colour = red[:, None] + share[..., None] * (TENDON - red[:, None])
        angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
        light = 0.42 + 0.58 * np.clip(0.5 + 0.75 * np.sin(angle), 0.0, 1.0)
        colours = colour[:, :, None] * light[:, None]
        along = np.gradient(grid, axis=1)
        around = np.roll(grid, -1, axis=2) - np.roll(grid, 1, axis=2)
        normals = np.cross(along, around)
        normals[:, 0] = normals[:, 1]  # the ends are points
        normals[:, -1] = normals[:, -2]
        normals = unit_vectors(normals)
        self.vertices = grid.reshape(-1, 3).astype(np.float32)
        self.normals = normals.reshape(-1, 3).astype(np.float32)
        self.colours = colours.reshape(-1, 3).astype(np.float32)

    def _lay_out(self) -> None:
        """Faces and places of striation."""
        count = len(self._width)
        number = np.arange(count * ROWS * AROUND).reshape(count, ROWS, AROUND)
        here = number[:, :-1]
        ahead = number[:, 1:]
        beside_here = np.roll(here, -1, axis=2)
        beside_ahead = np.roll(ahead, -1, axis=2)
        first = np.stack([here, ahead, beside_ahead], axis=-1)
        second = np.stack([here, beside_ahead, beside_here], axis=-1)
        faces = np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
        self.faces = faces.astype(np.int32)
        a = np.cos(2.0 * np.pi * np.arange(AROUND) / AROUND)
        # Each band has its own 40 mm of the pattern.
        start = 40.0 * np.arange(count)[:, None, None]
        across = start + 0.5 * self._width[:, None] * a
        along = self._length[:, None, None] * np.linspace(0.0, 1.0, ROWS)[:, None]
        both = np.broadcast_arrays(across, along)
        self.striation = np.stack(both, axis=-1).reshape(-1, 2).astype(np.float32)


class _Skin:
    """The present skin near some places."""

    def __init__(self, x: Floats64, faces: Any, bone: Floats64, middle: Floats64) -> None:
        """bone: how deep it is below each vertex of x; middle: from where a face looks outward."""
        self._middle = middle
        self._sheet = sheet_of(x, vertex_normals(x, faces), bone)

    def at(self, points: Floats64) -> tuple[Floats64, Floats64, Floats64]:
        """How far outside points (..., 3) are, which way is out, and how deep the bone is there.

        Skin that turns away, such as the inner side of lips, lids and nostrils, is left out.
        """
        shape = points.shape
        points = points.reshape(-1, 3)
        out = (points - self._middle) * (1.0, 0.25, 1.0)
        height, normal, depth = heights_over(self._sheet, points, out)
        return height.reshape(shape[:-1]), normal.reshape(shape), depth.reshape(shape[:-1])


def _resampled(lines: Floats64) -> Floats64:
    """ROWS points along each polyline (b, n, 3), rounded where it bends."""
    at = np.linspace(0.0, lines.shape[1] - 1.0, ROWS)
    low = np.minimum(at.astype(int), lines.shape[1] - 2)
    share = (at - low)[:, None]
    points: Floats64 = lines[:, low] * (1.0 - share) + lines[:, low + 1] * share
    for _ in range(3):
        points[:, 1:-1] = 0.25 * points[:, :-2] + 0.5 * points[:, 1:-1] + 0.25 * points[:, 2:]
    return points


def _lengths(lines: Floats64) -> Floats64:
    found: Floats64 = np.linalg.norm(np.diff(lines, axis=1), axis=2).sum(axis=1)
    return found
