"""Muscles as bands along their fibres; they lie between skin and bone, and swell as they shorten.

The simulation's fibres at rest give the courses of linear muscles. The fibres of sphincters are
rows of landmarks around mouth and eyes, moved outward. Each band has an elliptic cross section and
lies under the skin: on the bone at its origin, and right below the skin at its insertion. The
origin then moves with its bone, and the insertion with the vertices that were over it at rest. A
new search in each frame would make bands jump from one lip to the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from risorius.geometry.steps import smoothstep

from ..scenes import Face
from .resting_skin import RestingSkin

ROW_COUNT = 22  # places along a band
SECTION_POINTS = 12  # places around a band's cross section
RELAXED_COLOUR = np.array([0.68, 0.29, 0.245])  # sRGB
CONTRACTED_COLOUR = np.array([0.50, 0.035, 0.045])  # sRGB
TENDON_COLOUR = np.array([0.93, 0.87, 0.77])
# For each band around an eye or the mouth: distance outward and width [mm].
EYE_BANDS = ((5.0, 9.0), (12.5, 9.0))
MOUTH_BANDS = ((1.0, 8.0), (7.5, 8.0))
# The edges of the upper and the lower lip.
LIP_EDGE_LANDMARKS = ((48, 49, 50, 51, 52, 53, 54), (48, 59, 58, 57, 56, 55, 54))
# Beginning and end of names; landmarks; bands.
SPHINCTER_BANDS = (
    ("orbicularis_oculi", "right", (36, 37, 38, 39), EYE_BANDS),
    ("orbicularis_oculi", "right", (36, 41, 40, 39), EYE_BANDS),
    ("orbicularis_oculi", "left", (45, 44, 43, 42), EYE_BANDS),
    ("orbicularis_oculi", "left", (45, 46, 47, 42), EYE_BANDS),
    *(("orbicularis_oris", "", lip, MOUTH_BANDS) for lip in LIP_EDGE_LANDMARKS),
)
ROW_FRACTIONS = np.linspace(0.0, 1.0, ROW_COUNT)  # of a band's length, at its rows
BELLY_PROFILE = np.sin(np.pi * ROW_FRACTIONS)  # 1 in the middle
WIDTH_PROFILE = np.sqrt(np.clip(1.0 - (2.0 * ROW_FRACTIONS - 1.0) ** 8, 0.0, 1.0))  # round
LANDMARKS_AROUND = {"right": range(36, 42), "left": range(42, 48), "": range(48, 60)}


class _Band(NamedTuple):
    """A band at rest, before it is placed between skin and bone.

    line: its middle line [mm], (ROW_COUNT, 3). width: [mm], (ROW_COUNT,). controls: names of the
    controls that contract it. name, fibre: the linear muscle, and the number of its fibre. bone:
    the bone of a linear muscle's origin.
    """

    line: Floats64
    width: Floats64
    controls: list[str]
    name: str = ""
    fibre: int = 0
    bone: str = "cranium"


@dataclass(eq=False)
class Muscles:
    """All bands of a face as one part that changes its shape (see render/parts.py).

    striation: coordinates of each vertex across and along the fibres, (n, 2) [mm at rest].
    """

    vertices: Floats32
    normals: Floats32
    colours: Floats32
    faces: Integers32
    striation: Floats32
    name: str = "muscles"
    bone: str = "neck"  # does not move, because vertices have their final places
    shine: float = 0.42
    is_enclosed: bool = False
    strand_radius: float = 0.0

    @classmethod
    def from_face(cls, face: Face) -> Muscles:
        """Make the muscles of a face in their current state."""
        none = np.zeros((0, 3), np.float32)
        made = cls(none, none, none, none.astype(np.int32), none[:, :2])
        made._build(face)
        made.follow(face)
        return made

    def _build(self, face: Face) -> None:
        """Set up all constants: the bands at rest, and the skin that carries them."""
        simulation = face.simulation.clone()
        simulation.reset()
        marks = face.rest_positions[face.head.landmarks]
        linear = _linear_bands(face.head.rig, simulation.anatomy.fibres(), marks)
        rings = _ring_bands(marks, simulation.controls.sums)
        self.names = [(band.name, band.fibre) for band in linear]
        self._is_mandible = np.array([band.bone == "mandible" for band in linear])
        self._controls = [band.controls for band in (*linear, *rings)]
        self._width = np.array([band.width for band in (*linear, *rings)])
        looks_from = np.array([marks[27, 0], *simulation.bones.pivots()["mandible"][1:]])
        bone_depth = np.asarray(face.simulated_head.bone_depth)
        skin = RestingSkin(simulation.rest_positions, simulation.faces, bone_depth, looks_from)
        ring_lines = np.array([band.line for band in rings])
        for _ in range(4):
            outside, normal, _ = skin.at(ring_lines)
            ring_lines -= outside[..., None] * normal
        self._place(skin, np.array([*(band.line for band in linear), *ring_lines]))
        self._length = _lengths(self._rest[1])
        self._lay_out()

    def _place(self, skin: RestingSkin, lines: Floats64) -> None:
        """Place bands along lines (b, ROW_COUNT, 3) between resting skin and bone; bind them."""
        for _ in range(2):
            outside, normal, depth = skin.at(lines)
            lines = lines - outside[..., None] * normal
        thick = _thickness(np.ones((len(lines), 1)))
        end_depth = 3.4  # [mm] below the skin, at the end of a band
        start_depth = depth[:, :1]
        deepening = smoothstep(ROW_FRACTIONS)
        deep = start_depth + (end_depth - start_depth) * deepening
        deep[len(self.names) :] = end_depth  # sphincters do not begin on a bone
        side = unit_vectors(np.cross(np.gradient(lines, axis=1), normal))
        to_edge = 0.5 * self._width[..., None] * side
        rails = np.stack([lines - to_edge, lines, lines + to_edge])
        for _ in range(2):
            outside, normal, bone_depth = skin.at(rails)
            below = np.minimum(deep, np.maximum(bone_depth - thick, 0.0))
            below = np.maximum(below, thick + 1.0)  # with 1 mm of skin on top
            rails = rails - (outside + below)[..., None] * normal
        for _ in range(2):  # heights from a few vertices are coarse where skin curves, on noses
            over_skin = skin.heights(_sections(rails, normal, thick), normal[1])
            deeper = _widened(np.maximum(over_skin.max(axis=-1) + 0.5, 0.0))  # 0.5 mm of skin
            rails = rails - deeper[..., None] * normal
            below = below + deeper
        self._rest = rails
        self._outward = normal
        self._below = below[..., None]
        self._least = thick[..., None] + 1.0  # [mm] below the skin
        self._carriers = skin.carriers(rails + self._below * normal, normal)
        x, self._facing = self._carry(skin.x, skin.normals)
        self._shift = rails + self._below * self._facing - x

    def _moved(self, face: Face) -> tuple[Floats64, Floats64]:
        """Return edges and middle lines of bands, and outward directions, (3, b, ROW_COUNT, 3).

        A band's origin moves with its bone, and its insertion with the skin.
        """
        simulation = face.simulation
        x = simulation.positions
        place, facing = self._carry(x, vertex_normals(x, simulation.faces))
        bones = face.bone_transforms()
        turn = bones["cranium"][:3, :3].T
        over = place + self._shift @ turn
        rails = over - self._below * facing
        normal = self._outward @ turn + facing - self._facing @ turn
        for name, own in (("cranium", ~self._is_mandible), ("mandible", self._is_mandible)):
            bands = np.flatnonzero(own)
            turn = bones[name][:3, :3].T
            fraction = ROW_FRACTIONS[:, None]
            fixed = self._rest[:, bands] @ turn + bones[name][:3, 3]
            rails[:, bands] = fixed + fraction * (rails[:, bands] - fixed)
            out = self._outward[:, bands] @ turn
            normal[:, bands] = out + fraction * (normal[:, bands] - out)
        outside = np.einsum("...c,...c->...", rails - over, facing)[..., None]
        rails -= np.maximum(outside + self._least, 0.0) * facing
        return rails, unit_vectors(normal)

    def _carry(self, x: Floats64, normals: Floats64) -> tuple[Floats64, Floats64]:
        """Return the points of a skin, x (V, 3), over all bands, and unit normals there."""
        found = self._carriers @ np.hstack([x, normals])
        found = found.reshape(*self._rest.shape[:3], 6)
        return found[..., :3], unit_vectors(found[..., 3:])

    def follow(self, face: Face) -> None:
        """Update shape and colours from the face's current state."""
        rails, normal = self._moved(face)
        swollen = np.clip(self._length / _lengths(rails[1]), 0.75, 2.2)
        swollen = 1.0 + (swollen[:, None] - 1.0) * BELLY_PROFILE
        rails = rails[1] + swollen[..., None] ** 0.35 * (rails - rails[1])
        thick = _thickness(swollen)
        grid = _sections(rails, normal, thick)
        sums = face.simulation.controls.sums
        active = [max((sums[name] for name in own), default=0.0) for own in self._controls]
        self._set_shape(grid, np.array(active))

    def _set_shape(self, grid: Floats64, active: Floats64) -> None:
        """Set the shape and the colours.

        grid: sections of bands, (b, ROW_COUNT, SECTION_POINTS, 3). active: activations, (b,).
        """
        change = CONTRACTED_COLOUR - RELAXED_COLOUR
        red = RELAXED_COLOUR + np.clip(active, 0.0, 1.0)[:, None] * change
        # Share of tendon in the colour: large at both ends of a band.
        tendon = np.clip(1.4 - np.minimum(ROW_FRACTIONS, 1.0 - ROW_FRACTIONS) / 0.14, 0.0, 0.92)
        fraction = np.tile(tendon, (len(grid), 1))
        fraction[len(self.names) :] = 0.0
        colour = red[:, None] + fraction[..., None] * (TENDON_COLOUR - red[:, None])
        angle = 2.0 * np.pi * np.arange(SECTION_POINTS) / SECTION_POINTS
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
        """Set the faces, and the places of the striation."""
        count = len(self._width)
        shape = (count, ROW_COUNT, SECTION_POINTS)
        number = np.arange(np.prod(shape)).reshape(shape)
        here = number[:, :-1]
        ahead = number[:, 1:]
        beside_here = np.roll(here, -1, axis=2)
        beside_ahead = np.roll(ahead, -1, axis=2)
        first = np.stack([here, ahead, beside_ahead], axis=-1)
        second = np.stack([here, beside_ahead, beside_here], axis=-1)
        faces = np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
        self.faces = faces.astype(np.int32)
        a = np.cos(2.0 * np.pi * np.arange(SECTION_POINTS) / SECTION_POINTS)
        # Each band uses a different part of the pattern, 40 mm apart.
        start = 40.0 * np.arange(count)[:, None, None]
        across = start + 0.5 * self._width.max(axis=1)[:, None, None] * a
        along = self._length[:, None, None] * ROW_FRACTIONS[:, None]
        both = np.broadcast_arrays(across, along)
        self.striation = np.stack(both, axis=-1).reshape(-1, 2).astype(np.float32)


def _linear_bands(
    rig: Mapping[str, Any], fibres_of: Mapping[str, Sequence[Floats64]], marks: Floats64
) -> list[_Band]:
    """Return a band for each visible fibre of the linear muscles.

    fibres_of: fibres at rest by muscle, polylines [mm]. marks: landmarks, (68, 3).
    """
    bands = []
    for name, fibres in fibres_of.items():
        stem = name.removesuffix("_left").removesuffix("_right")
        row = rig["muscle"].get(stem, {})
        if name.startswith("platysma"):  # it lies on structures that are not drawn
            continue
        for number, (fibre, line) in enumerate(zip(row.get("fibre", ()), fibres, strict=False)):
            visible = _before_mouth(_resampled(line[None])[0], marks)
            if visible is None:
                continue
            # Muscle takes half of the rig's width. Bands are 4 to 17 mm wide.
            width = 0.5 * row.get("width", 10.0) * fibre.get("width_factor", 1.0)
            profile = np.clip(width, 4.0, 17.0) * WIDTH_PROFILE
            bone = row.get("bone", "cranium")
            bands.append(
                _Band(
                    line=visible, width=profile, controls=[name], name=name, fibre=number, bone=bone
                )
            )
    return bands


def _ring_bands(marks: Floats64, names: Iterable[str]) -> list[_Band]:
    """Return the bands of sphincters around eyes and mouth; names: names of all lowest controls."""
    rings = []
    for start, end, numbers, bands in SPHINCTER_BANDS:
        edge = _resampled(marks[None, list(numbers)])[0]
        red = _lip_height(marks) if start == "orbicularis_oris" else np.full(ROW_COUNT, np.inf)
        middle = marks[LANDMARKS_AROUND[end]].mean(axis=0)
        away = unit_vectors((edge - middle) * (1.0, 1.0, 0.0))
        controls = [name for name in names if name.startswith(start) and name.endswith(end)]
        for outward, width in bands:
            profile = np.minimum(width * WIDTH_PROFILE, 2.0 * (outward + 0.06 * red**2))
            rings.append(_Band(edge + outward * away, profile, controls))
    return rings


def _sections(rails: Floats64, normal: Floats64, thick: Floats64) -> Floats64:
    """Return the elliptic sections of bands, (b, ROW_COUNT, SECTION_POINTS, 3).

    rails, normal: edges and middles with their outward directions, (3, b, ROW_COUNT, 3).
    thick: half the thickness [mm], (b, ROW_COUNT).
    """
    angle = 2.0 * np.pi * np.arange(SECTION_POINTS) / SECTION_POINTS
    a = np.cos(angle)
    blend = np.stack([0.5 * a * (a - 1.0), 1.0 - a * a, 0.5 * a * (a + 1.0)])
    middle = np.tensordot(rails, blend, (0, 0))
    outward = np.tensordot(normal, blend, (0, 0))
    sections: Floats64 = middle + outward * thick[:, :, None, None] * np.sin(angle)
    return sections.swapaxes(2, 3)


def _widened(depths: Floats64) -> Floats64:
    """Return depths along bands (b, ROW_COUNT) without steps, and nowhere smaller."""
    padded = np.pad(depths, ((0, 0), (2, 2)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 3, axis=1).max(axis=-1)
    smooth: Floats64 = 0.25 * (windows[:, :-2] + 2.0 * windows[:, 1:-1] + windows[:, 2:])
    return smooth


def _lip_height(marks: Floats64) -> Floats64:
    """Return the height of a lip's red along the mouth [mm], (ROW_COUNT,); 0 at the corners."""
    upper, lower = _resampled(marks[np.array(LIP_EDGE_LANDMARKS)])
    height: Floats64 = 0.5 * np.linalg.norm(upper - lower, axis=1)
    return height


def _before_mouth(line: Floats64, marks: Floats64) -> Floats64 | None:
    """Return the part of a line (ROW_COUNT, 3) that ends at the mouth; None if it is short.

    Some of the rig's fibres were fitted to motion, and pull across the lips.
    """
    x, y = line[:, :2].T
    upper, lower = (marks[list(row), :2].T for row in LIP_EDGE_LANDMARKS)
    is_inside = (y < np.interp(x, *upper)) & (y > np.interp(x, *lower))
    is_inside &= (x > upper[0, 0]) & (x < upper[0, -1])
    rows = int(is_inside.argmax()) if is_inside.any() else ROW_COUNT
    return None if 2 * rows < ROW_COUNT else _resampled(line[None, :rows])[0]


def _thickness(swollen: Floats64) -> Floats64:
    """Return half the thickness of bands [mm], (b, ROW_COUNT); chosen after anatomical plates."""
    most_thickness = 2.8
    plump = 0.45 + 0.55 * BELLY_PROFILE**0.8
    thick: Floats64 = 0.5 * most_thickness * plump * swollen**0.65 * WIDTH_PROFILE
    return thick


def _resampled(lines: Floats64) -> Floats64:
    """Return ROW_COUNT points along each polyline (b, n, 3), smoothed where it bends."""
    at = np.linspace(0.0, lines.shape[1] - 1.0, ROW_COUNT)
    low = np.minimum(at.astype(int), lines.shape[1] - 2)
    fraction = (at - low)[:, None]
    points: Floats64 = lines[:, low] * (1.0 - fraction) + lines[:, low + 1] * fraction
    for _ in range(3):
        points[:, 1:-1] = 0.25 * points[:, :-2] + 0.5 * points[:, 1:-1] + 0.25 * points[:, 2:]
    return points


def _lengths(lines: Floats64) -> Floats64:
    found: Floats64 = np.linalg.norm(np.diff(lines, axis=1), axis=2).sum(axis=1)
    return found
